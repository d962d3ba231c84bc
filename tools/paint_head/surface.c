/* The painter's view of a mesh: triangles, normals, hollows, and the points of the brows. */
#include "paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ris_result triangulate(ris_paint_surface *surface, ris_error *err)
{
    const ris_mesh *mesh = surface->mesh;
    const size_t corners = mesh->face_start[mesh->face_count];
    surface->triangle = malloc((corners * 3 + 1) * sizeof *surface->triangle);
    surface->triangle_uv = malloc((corners * 3 + 1) * sizeof *surface->triangle_uv);
    surface->shell = calloc(corners + 1, 1);
    if (!surface->triangle || !surface->triangle_uv || !surface->shell)
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %zu corners", corners);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t first = mesh->face_start[f];
        for (uint32_t c = first + 1; c + 1 < mesh->face_start[f + 1]; c++) {
            const uint32_t corner[3] = {first, c, c + 1}, at = 3 * surface->triangle_count++;
            for (uint32_t k = 0; k < 3; k++) {
                surface->triangle[at + k] = mesh->face_vertex[corner[k]];
                surface->triangle_uv[at + k] = mesh->face_uv[corner[k]];
                if (mesh->face_uv[corner[k]] >= mesh->uv_count)
                    return ris_fail(err, RIS_ERROR_DATA,
                                    "face %u has no texture coordinates, so it cannot be painted", f);
            }
        }
    }
    return RIS_OK;
}

static void make_normals(ris_paint_surface *surface)
{
    const ris_vec3 *p = surface->mesh->position;
    for (uint32_t i = 0; i < surface->triangle_count; i++) {
        const uint32_t *t = &surface->triangle[3 * i];
        const ris_vec3 n = vec3_cross(vec3_sub(p[t[1]], p[t[0]]), vec3_sub(p[t[2]], p[t[0]]));
        for (int k = 0; k < 3; k++)
            surface->normal[t[k]] = vec3_add(surface->normal[t[k]], n);
    }
    for (uint32_t i = 0; i < surface->mesh->vertex_count; i++)
        surface->normal[i] = ris_paint_unit(surface->normal[i]);
}

/* Mean normal curvature over the edges of each vertex, smoothed once; positive where the neighbours rise
 * above. */
static ris_result make_curvature(ris_paint_surface *surface, ris_error *err)
{
    const uint32_t count = surface->mesh->vertex_count;
    const ris_vec3 *p = surface->mesh->position;
    float *sum = calloc(count, sizeof *sum), *weight = calloc(count, sizeof *weight);
    if (!sum || !weight) {
        free(sum);
        free(weight);
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for the curvature of %u vertices", count);
    }
    for (int pass = 0; pass < 2; pass++) {
        memset(sum, 0, count * sizeof *sum);
        memset(weight, 0, count * sizeof *weight);
        for (uint32_t i = 0; i < 3 * surface->triangle_count; i++) {
            const uint32_t a = surface->triangle[i], b = surface->triangle[i % 3 == 2 ? i - 2 : i + 1];
            const ris_vec3 d = vec3_sub(p[b], p[a]);
            const float square = vec3_dot(d, d) + 1e-6f;
            sum[a] += pass ? surface->curvature[b] : 2 * vec3_dot(surface->normal[a], d) / square;
            sum[b] += pass ? surface->curvature[a] : -2 * vec3_dot(surface->normal[b], d) / square;
            weight[a] += 1;
            weight[b] += 1;
        }
        for (uint32_t i = 0; i < count; i++) {
            const float mean = weight[i] > 0 ? sum[i] / weight[i] : 0;
            surface->curvature[i] = pass ? 0.5f * (surface->curvature[i] + mean) : mean;
        }
    }
    free(sum);
    free(weight);
    return RIS_OK;
}

static ris_result take_brows(ris_paint_surface *surface, const ris_mesh *brow, uint32_t brow_count,
                             ris_error *err)
{
    size_t total = 0;
    for (uint32_t i = 0; i < brow_count; i++)
        total += brow[i].vertex_count;
    surface->brow = malloc((total + 1) * sizeof *surface->brow);
    if (!surface->brow)
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %zu brow points", total);
    surface->brow_low = vec3(1e30f, 1e30f, 1e30f);
    surface->brow_high = vec3(-1e30f, -1e30f, -1e30f);
    for (uint32_t i = 0; i < brow_count; i++) {
        for (uint32_t k = 0; k < brow[i].vertex_count; k++) {
            const ris_vec3 p = brow[i].position[k];
            surface->brow[surface->brow_count++] = p;
            surface->brow_low = vec3(fminf(surface->brow_low.x, p.x), fminf(surface->brow_low.y, p.y),
                                     fminf(surface->brow_low.z, p.z));
            surface->brow_high = vec3(fmaxf(surface->brow_high.x, p.x), fmaxf(surface->brow_high.y, p.y),
                                      fmaxf(surface->brow_high.z, p.z));
        }
    }
    return RIS_OK;
}

ris_result ris_paint_surface_init(ris_paint_surface *surface, const ris_mesh *mesh, const ris_mesh *extra,
                                  uint32_t extra_count, const ris_mesh *brow, uint32_t brow_count,
                                  ris_error *err)
{
    *surface = (ris_paint_surface){.mesh = mesh};
    const size_t count = mesh->vertex_count;
    if (count == 0 || mesh->face_count == 0 || mesh->uv_count == 0)
        return ris_fail(err, RIS_ERROR_DATA, "a mesh without faces or texture coordinates cannot be painted");
    float **fields[] = {&surface->lip_ring, &surface->lid_ring, &surface->curvature, &surface->occlusion,
                        &surface->thinness};
    ris_result result = triangulate(surface, err);
    if (result)
        goto fail;
    surface->normal = calloc(count, sizeof *surface->normal);
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        *fields[i] = calloc(count, sizeof(float));
    if (!surface->normal || !surface->lip_ring || !surface->lid_ring || !surface->curvature ||
        !surface->occlusion || !surface->thinness) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %zu vertices", count);
        goto fail;
    }
    make_normals(surface);
    if ((result = make_curvature(surface, err)) || (result = take_brows(surface, brow, brow_count, err)) ||
        (result = ris_paint_find_islands(surface, err)) ||
        (result = ris_paint_bake_occlusion(surface, extra, extra_count, err)))
        goto fail;
    return RIS_OK;
fail:
    ris_paint_surface_finish(surface);
    return result;
}

void ris_paint_surface_finish(ris_paint_surface *surface)
{
    free(surface->triangle);
    free(surface->triangle_uv);
    free(surface->shell);
    free(surface->normal);
    free(surface->lip_ring);
    free(surface->lid_ring);
    free(surface->curvature);
    free(surface->occlusion);
    free(surface->thinness);
    free(surface->brow);
    *surface = (ris_paint_surface){0};
}
