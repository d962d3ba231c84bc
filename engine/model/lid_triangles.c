/* Triangles of the lids that must not turn over when lids close and muscles draw: those with a node of a lid, and which
 * of them share a vertex. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define KEEPS 0.3f         /* of its area that a triangle keeps, seen along the mean normal around it, ... */
#define KEEPS_CORNER 0.18f /* ... in the corners of the eye, since closed lids must meet, ... */
#define MAY_LEAN 0.4f      /* ... or how far it may turn from that, in cosines */

typedef struct lid_fans {
    uint32_t *lid;          /* of each node: into ris_model.lid, or UINT32_MAX (node_count) */
    uint32_t *start, *list; /* triangles at each node, CSR: (node_count + 2), (3 x lid_triangle_count) */
} lid_fans;

static ris_vec3 cross_at_rest(const ris_model *model, const uint32_t *node)
{
    const ris_vec3 a = v4_xyz(model->rest_position[node[0]]);
    return v3_cross(v3_sub(v4_xyz(model->rest_position[node[1]]), a),
                    v3_sub(v4_xyz(model->rest_position[node[2]]), a));
}

static bool has_lid(const uint32_t *lid, const uint32_t *node)
{
    return lid[node[0]] != UINT32_MAX || lid[node[1]] != UINT32_MAX || lid[node[2]] != UINT32_MAX;
}

/* Fills the triangles and, at start[i + 2], how many there are at node i. */
static void list_triangles(const ris_model *model, const lid_fans *fans)
{
    ris_lid_triangle *out = model->lid_triangle;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *node = model->triangle + 3 * (size_t)t;
        if (!has_lid(fans->lid, node)) {
            continue;
        }
        const ris_vec3 cross = cross_at_rest(model, node);
        for (int k = 0; k < 3; ++k) {
            out->node[k] = node[k];
            out->lid[k] = fans->lid[node[k]];
            ++fans->start[node[k] + 2];
        }
        out->normal = v3_unit_or(cross, v3(0.0f, 0.0f, 0.0f));
        out++->rest_mm2 = v3_length(cross);
    }
}

static void list_fans(const ris_model *model, const lid_fans *fans)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        fans->start[i + 2] += fans->start[i + 1];
    }
    for (uint32_t t = 0; t < model->lid_triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            fans->list[fans->start[model->lid_triangle[t].node[k] + 1]++] = t;
        }
    }
}

static bool in_corner(const ris_model *model, const ris_lid_triangle *t)
{
    for (int k = 0; k < 3; ++k) {
        const ris_lid_node *node = t->lid[k] != UINT32_MAX ? &model->lid[t->lid[k]] : NULL;
        if (node && !node->lining && !(node->share > 0.0f)) {
            return true;
        }
    }
    return false;
}

/* The triangles that share a vertex with each, once; what it keeps. */
static void list_around(ris_model *model, const lid_fans *fans)
{
    for (uint32_t t = 0; t < model->lid_triangle_count; ++t) {
        ris_lid_triangle *triangle = &model->lid_triangle[t];
        ris_vec3 sum = v3(0.0f, 0.0f, 0.0f);
        triangle->around_first = model->lid_around_count;
        for (int k = 0; k < 3; ++k) {
            for (uint32_t f = fans->start[triangle->node[k]]; f < fans->start[triangle->node[k] + 1]; ++f) {
                const uint32_t other = fans->list[f];
                bool known = other == t;
                for (uint32_t j = triangle->around_first; j < model->lid_around_count && !known; ++j) {
                    known = model->lid_around[j] == other;
                }
                if (!known) {
                    model->lid_around[model->lid_around_count++] = other;
                    sum = v3_add(sum, cross_at_rest(model, model->lid_triangle[other].node));
                }
            }
        }
        triangle->around_end = model->lid_around_count;
        const float agreement = v3_dot(triangle->normal, v3_unit_or(sum, triangle->normal));
        triangle->keeps = f_min(in_corner(model, triangle) ? KEEPS_CORNER : KEEPS, agreement - MAY_LEAN);
    }
}

static ris_result list_all(ris_model *model, lid_fans *fans, ris_error *err)
{
    const size_t n = model->lid_triangle_count;
    ris_result result =
        ris__model_alloc(&model->lid_triangle, n, sizeof *model->lid_triangle, "the lids", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&fans->start, (size_t)model->node_count + 2, sizeof *fans->start,
                                  "the lids", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&fans->list, 3 * n, sizeof *fans->list, "the lids", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    size_t most = 0;
    list_triangles(model, fans);
    list_fans(model, fans);
    for (uint32_t t = 0; t < n; ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t i = model->lid_triangle[t].node[k];
            most += fans->start[i + 1] - fans->start[i];
        }
    }
    result = ris__model_alloc(&model->lid_around, most, sizeof *model->lid_around, "the lids", err);
    if (result == RIS_OK) {
        list_around(model, fans);
    }
    return result;
}

ris_result ris__bake_lid_triangles(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    lid_fans fans = {0};
    ris_result result = ris__model_alloc(&fans.lid, model->node_count, sizeof *fans.lid, "the lids", err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        fans.lid[i] = UINT32_MAX;
    }
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        fans.lid[model->lid[k].node] = k;
    }
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        model->lid_triangle_count += has_lid(fans.lid, model->triangle + 3 * (size_t)t);
    }
    result = list_all(model, &fans, err);
    free(fans.lid);
    free(fans.start);
    free(fans.list);
    return result;
}
