/* Triangles of the lids that must not turn over when lids close and muscles draw: those with a node of a lid. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

/* Number of each node among those of the triangles: lid nodes as they stand in ris_model.lid, then the others. */
static void number_nodes(ris_model *model, uint32_t *number)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        number[i] = UINT32_MAX;
    }
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        number[model->lid[k].node] = k;
    }
    model->lid_node_count = model->lid_count;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *node = model->triangle + 3 * (size_t)t;
        bool lid = false;
        for (int k = 0; k < 3; ++k) {
            lid = lid || number[node[k]] < model->lid_count;
        }
        for (int k = 0; lid && k < 3; ++k) {
            if (number[node[k]] == UINT32_MAX) {
                number[node[k]] = model->lid_node_count++;
            }
        }
        model->lid_triangle_count += lid;
    }
}

static ris_vec3 cross_at_rest(const ris_model *model, const uint32_t *node)
{
    const ris_vec3 a = v4_xyz(model->rest_position[node[0]]);
    return v3_cross(v3_sub(v4_xyz(model->rest_position[node[1]]), a),
                    v3_sub(v4_xyz(model->rest_position[node[2]]), a));
}

static void list_triangles(const ris_model *model, const uint32_t *number, ris_vec3 *around)
{
    ris_lid_triangle *out = model->lid_triangle;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *node = model->triangle + 3 * (size_t)t;
        if (number[node[0]] >= model->lid_count && number[node[1]] >= model->lid_count &&
            number[node[2]] >= model->lid_count) {
            continue;
        }
        const ris_vec3 cross = cross_at_rest(model, node);
        for (int k = 0; k < 3; ++k) {
            out->node[k] = node[k];
            out->number[k] = number[node[k]];
            around[number[node[k]]] = v3_add(around[number[node[k]]], cross);
        }
        out->normal = v3_unit_or(cross, v3(0.0f, 0.0f, 0.0f));
        out++->rest_mm2 = v3_length(cross);
    }
}

/* Cosine between each triangle and those around it. */
static void measure_agreement(const ris_model *model, const ris_vec3 *around)
{
    for (uint32_t k = 0; k < model->lid_triangle_count; ++k) {
        ris_lid_triangle *t = &model->lid_triangle[k];
        ris_vec3 sum = v3_scale(t->normal, -3.0f * t->rest_mm2);
        for (int c = 0; c < 3; ++c) {
            sum = v3_add(sum, around[t->number[c]]);
        }
        t->agreement = v3_dot(t->normal, v3_unit_or(sum, v3(0.0f, 0.0f, 0.0f)));
    }
}

ris_result ris__bake_lid_triangles(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    uint32_t *number = NULL;
    ris_vec3 *around = NULL;
    ris_result result = ris__model_alloc(&number, model->node_count, sizeof *number, "the lids", err);
    if (result == RIS_OK) {
        number_nodes(model, number);
        result = ris__model_alloc(&model->lid_triangle, model->lid_triangle_count,
                                  sizeof *model->lid_triangle, "the lids", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&around, model->lid_node_count, sizeof *around, "the lids", err);
    }
    if (result == RIS_OK) {
        list_triangles(model, number, around);
        measure_agreement(model, around);
    }
    free(around);
    free(number);
    return result;
}
