/* What a simulation needs of a mesh (docs/file-formats.md): finite, no zero area, no isolated vertex,
 * manifold, oriented. */
#include "risorius/head.h"

#include <math.h>
#include <stdlib.h>

/* Twice the area of a triangle below this share of its longest edge squared counts as zero. */
#define ZERO_AREA_SHARE 1e-7

typedef struct half_edge {
    uint32_t low, high, face;
    uint32_t forward; /* 1 = the face runs from low to high */
} half_edge;

static ris_result check_numbers(const ris_mesh *mesh, const char *name, ris_error *err)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        const ris_vec3 *p = &mesh->position[i];
        if (!isfinite(p->x) || !isfinite(p->y) || !isfinite(p->z)) {
            return ris_fail(err, RIS_ERROR_DATA, "%s: vertex %u has a coordinate that is not a finite number",
                            name, i);
        }
    }
    for (uint32_t i = 0; i < 2 * mesh->uv_count; i++) {
        if (!isfinite(mesh->uv[i])) {
            return ris_fail(err, RIS_ERROR_DATA, "%s: texture vertex %u is not a finite number", name, i / 2);
        }
    }
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        for (uint32_t c = mesh->face_start[face]; c < mesh->face_start[face + 1]; c++) {
            if (mesh->face_vertex[c] >= mesh->vertex_count ||
                (mesh->face_uv && mesh->face_uv[c] != UINT32_MAX && mesh->face_uv[c] >= mesh->uv_count)) {
                return ris_fail(err, RIS_ERROR_DATA, "%s: face %u names vertex %u of %u", name, face,
                                mesh->face_vertex[c], mesh->vertex_count);
            }
        }
    }
    return RIS_OK;
}

static bool zero_area(const ris_vec3 *a, const ris_vec3 *b, const ris_vec3 *c)
{
    double u[3] = {(double)b->x - a->x, (double)b->y - a->y, (double)b->z - a->z};
    double v[3] = {(double)c->x - a->x, (double)c->y - a->y, (double)c->z - a->z};
    double w[3] = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    double vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    double ww = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    double longest = fmax(uu, fmax(vv, ww));
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) <= ZERO_AREA_SHARE * longest;
}

/* Triangles and quads: every corner, since a quad may be split either way. Polygons: the fan of their first
 * corner. */
static ris_result check_areas(const ris_mesh *mesh, const char *name, ris_error *err)
{
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        uint32_t count = mesh->face_start[face + 1] - mesh->face_start[face];
        const uint32_t *v = &mesh->face_vertex[mesh->face_start[face]];
        uint32_t triangles = count == 3 ? 1 : count == 4 ? 4 : count < 3 ? 0 : count - 2;
        if (count < 3) {
            return ris_fail(err, RIS_ERROR_DATA, "%s: face %u has %u corners", name, face, count);
        }
        for (uint32_t i = 0; i < triangles; i++) {
            uint32_t a = count == 4 ? v[i] : v[0];
            uint32_t b = count == 4 ? v[(i + 1) % 4] : v[i + 1];
            uint32_t c = count == 4 ? v[(i + 2) % 4] : v[i + 2];
            if (zero_area(&mesh->position[a], &mesh->position[b], &mesh->position[c])) {
                return ris_fail(err, RIS_ERROR_DATA,
                                "%s: face %u has a triangle of zero area (vertices %u, %u, %u)", name, face,
                                a, b, c);
            }
        }
    }
    return RIS_OK;
}

static int compare_half_edges(const void *left, const void *right)
{
    const half_edge *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->face < b->face ? -1 : a->face > b->face;
}

static ris_result check_edges(const ris_mesh *mesh, const char *name, half_edge *edge, ris_error *err)
{
    uint32_t count = 0;
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        uint32_t first = mesh->face_start[face], end = mesh->face_start[face + 1];
        for (uint32_t c = first; c < end; c++) {
            uint32_t a = mesh->face_vertex[c], b = mesh->face_vertex[c + 1 < end ? c + 1 : first];
            edge[count++] = (half_edge){a < b ? a : b, a < b ? b : a, face, a < b};
        }
    }
    qsort(edge, count, sizeof *edge, compare_half_edges);
    for (uint32_t i = 1; i < count; i++) {
        const half_edge *e = &edge[i], *before = &edge[i - 1];
        if (e->low != before->low || e->high != before->high) {
            continue;
        }
        if (i >= 2 && edge[i - 2].low == e->low && edge[i - 2].high == e->high) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "%s: the edge of vertices %u and %u is in more than two faces (%u, %u, %u)", name,
                            e->low, e->high, edge[i - 2].face, before->face, e->face);
        }
        if (e->forward == before->forward) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "%s: faces %u and %u run the same way along vertices %u and %u", name,
                            before->face, e->face, e->low, e->high);
        }
    }
    return RIS_OK;
}

static ris_result check_isolated(const ris_mesh *mesh, const char *name, ris_error *err)
{
    ris_result result = RIS_OK;
    uint8_t *used = calloc(mesh->vertex_count ? mesh->vertex_count : 1, 1);
    if (!used) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory to check %u vertices", name,
                        mesh->vertex_count);
    }
    for (uint32_t c = 0; c < mesh->face_start[mesh->face_count]; c++) {
        used[mesh->face_vertex[c]] = 1;
    }
    for (uint32_t i = 0; i < mesh->vertex_count && result == RIS_OK; i++) {
        if (!used[i]) {
            result = ris_fail(err, RIS_ERROR_DATA, "%s: vertex %u is isolated: no face uses it", name, i);
        }
    }
    free(used);
    return result;
}

ris_result ris_mesh_check(const ris_mesh *mesh, const char *name, ris_error *err)
{
    ris_result result;
    if (mesh->vertex_count == 0 || mesh->face_count == 0) {
        return ris_fail(err, RIS_ERROR_DATA, "%s: the mesh has %u vertices and %u faces", name,
                        mesh->vertex_count, mesh->face_count);
    }
    if ((result = check_numbers(mesh, name, err)) || (result = check_areas(mesh, name, err)) ||
        (result = check_isolated(mesh, name, err))) {
        return result;
    }
    size_t corner_count = mesh->face_start[mesh->face_count];
    half_edge *edge = malloc(corner_count * sizeof *edge);
    if (!edge) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory to check %zu edges", name, corner_count);
    }
    result = check_edges(mesh, name, edge, err);
    free(edge);
    return result;
}
