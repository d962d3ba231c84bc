/* KA-02 adjacency: mirror-symmetric triangulation of the skin, the triangle ring of every node, areas and
 * rest normals (KA-20). */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define DIAGONAL_TIE 1e-4f /* relative difference below which two diagonals count as equally long */

/* true if a comes after b in (y, z, |x|): an order that a reflection of x leaves alone. */
static bool is_above(ris_vec3 a, ris_vec3 b)
{
    if (a.y != b.y) {
        return a.y > b.y;
    }
    if (a.z != b.z) {
        return a.z > b.z;
    }
    return fabsf(a.x) > fabsf(b.x);
}

/* true if the quad is split along corners 0-2: the shorter diagonal, and on a tie the one with the topmost
 * vertex. */
static bool splits_along_02(const ris_vec3 *position, const uint32_t *corner)
{
    ris_vec3 a = position[corner[0]], b = position[corner[1]], c = position[corner[2]],
             d = position[corner[3]];
    float ac = v3_distance(a, c), bd = v3_distance(b, d);
    if (fabsf(ac - bd) > DIAGONAL_TIE * f_max(ac, bd)) {
        return ac < bd;
    }
    ris_vec3 top_ac = is_above(a, c) ? a : c;
    ris_vec3 top_bd = is_above(b, d) ? b : d;
    return is_above(top_ac, top_bd);
}

static void add_triangle(ris_model *model, const ris_mesh *skin, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t corner[3] = {a, b, c};
    for (uint32_t k = 0; k < 3; ++k) {
        model->triangle_corner[3 * model->triangle_count + k] = corner[k];
        model->triangle[3 * model->triangle_count + k] = skin->face_vertex[corner[k]];
    }
    ++model->triangle_count;
}

static ris_result triangulate(ris_model *model, const ris_mesh *skin, ris_error *err)
{
    size_t total = 0;
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        uint32_t corners = skin->face_start[f + 1] - skin->face_start[f];
        if (corners < 3) {
            return ris_fail(err, RIS_ERROR_DATA, "face %u of the skin has %u corners, expected at least 3", f,
                            corners);
        }
        total += corners - 2;
    }
    ris_result result =
        ris__model_alloc(&model->triangle, 3 * total, sizeof *model->triangle, "triangles", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->triangle_corner, 3 * total, sizeof *model->triangle_corner,
                                  "corners", err);
    }
    for (uint32_t f = 0; result == RIS_OK && f < skin->face_count; ++f) {
        uint32_t first = skin->face_start[f], corners = skin->face_start[f + 1] - first;
        if (corners == 4 && !splits_along_02(skin->position, skin->face_vertex + first)) {
            add_triangle(model, skin, first, first + 1, first + 3);
            add_triangle(model, skin, first + 1, first + 2, first + 3);
            continue;
        }
        for (uint32_t k = 2; k < corners; ++k) {
            add_triangle(model, skin, first, first + k - 1, first + k);
        }
    }
    return result;
}

static ris_result build_ring(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t n = model->node_count, corners = 3 * model->triangle_count;
    ris_result result =
        ris__model_alloc(&model->ring_start, (size_t)n + 1, sizeof *model->ring_start, "the ring", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->ring, corners, sizeof *model->ring, "the ring", err);
    }
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&bake->ring_triangle, corners, sizeof *bake->ring_triangle, "the ring", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t e = 0; e < corners; ++e) {
        ++model->ring_start[model->triangle[e] + 1];
    }
    for (uint32_t i = 0; i < n; ++i) {
        model->ring_start[i + 1] += model->ring_start[i];
    }
    /* fill with the starts as cursors, then move them back one place */
    for (uint32_t e = 0; e < corners; ++e) {
        uint32_t t = e / 3, k = e % 3;
        uint32_t slot = model->ring_start[model->triangle[e]]++;
        model->ring[slot].b = model->triangle[3 * t + (k + 1) % 3];
        model->ring[slot].c = model->triangle[3 * t + (k + 2) % 3];
        bake->ring_triangle[slot] = t;
    }
    for (uint32_t i = n; i > 0; --i) {
        model->ring_start[i] = model->ring_start[i - 1];
    }
    model->ring_start[0] = 0;
    return RIS_OK;
}

/* Every directed edge leaves a node once: else three triangles share an edge or two disagree about the
 * outside. */
static ris_result check_edges(const ris_model *model, ris_error *err)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        uint32_t first = model->ring_start[i], end = model->ring_start[i + 1];
        if (first == end) {
            return ris_fail(err, RIS_ERROR_DATA, "vertex %u of the skin belongs to no face", i);
        }
        for (uint32_t k = first; k < end; ++k) {
            for (uint32_t j = k + 1; j < end; ++j) {
                if (model->ring[k].b == model->ring[j].b) {
                    return ris_fail(err, RIS_ERROR_DATA,
                                    "edge %u-%u of the skin is used twice in one direction: not a manifold, "
                                    "or faces turned over",
                                    i, model->ring[k].b);
                }
            }
        }
    }
    return RIS_OK;
}

static ris_result measure(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_vec3 *position = bake->head->skin.position;
    ris_result result = ris__model_alloc(&bake->triangle_area, model->triangle_count,
                                         sizeof *bake->triangle_area, "areas", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->node_area_mm2, model->node_count, sizeof *model->node_area_mm2,
                                  "areas", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->rest_normal, model->node_count, sizeof *model->rest_normal,
                                  "normals", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        ris_vec3 cross =
            v3_cross(v3_sub(position[v[1]], position[v[0]]), v3_sub(position[v[2]], position[v[0]]));
        float area = 0.5f * v3_length(cross);
        if (!(area > 0.0f)) {
            return ris_fail(err, RIS_ERROR_DATA, "triangle %u-%u-%u of the skin has no area", v[0], v[1],
                            v[2]);
        }
        bake->triangle_area[t] = area;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        ris_vec3 sum = {0};
        float area = 0.0f;
        for (uint32_t k = model->ring_start[i]; k < model->ring_start[i + 1]; ++k) {
            ris_vec3 u = v3_sub(position[model->ring[k].b], position[i]);
            ris_vec3 v = v3_sub(position[model->ring[k].c], position[i]);
            sum = v3_add(sum, v3_cross(u, v));
            area += bake->triangle_area[bake->ring_triangle[k]];
        }
        model->rest_normal[i] = v4_from(v3_unit_or(sum, v3(0.0f, 0.0f, 1.0f)), 0.0f);
        model->node_area_mm2[i] = area / 3.0f;
    }
    return RIS_OK;
}

ris_result ris__bake_triangles(ris_bake *bake, ris_error *err)
{
    ris_result result = triangulate(bake->model, &bake->head->skin, err);
    if (result == RIS_OK) {
        result = build_ring(bake, err);
    }
    if (result == RIS_OK) {
        result = check_edges(bake->model, err);
    }
    if (result == RIS_OK) {
        result = measure(bake, err);
    }
    return result;
}
