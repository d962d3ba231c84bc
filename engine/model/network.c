/* KA-29 the spring network of merged muscles: a node for each point in a group and a fixed one at the bone end of each linear
 * muscle that ends in a group; springs along the muscles and within the groups. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

static uint32_t find_node(const ris_model *model, uint32_t muscle, uint32_t point)
{
    for (uint32_t k = 0; k < model->network_node_count; ++k) {
        const ris_network_node *node = &model->network_node[k];
        if (!node->fixed && node->muscle == muscle && node->point == point) {
            return k;
        }
    }
    return UINT32_MAX;
}

static void add_node(ris_model *model, uint32_t muscle, uint32_t point, bool fixed)
{
    model->network_node[model->network_node_count++] = (ris_network_node){muscle, point, fixed};
}

static void add_spring(ris_model *model, uint32_t a, uint32_t b, float rest_mm)
{
    model->network_spring[model->network_spring_count++] = (ris_network_spring){a, b, rest_mm};
}

static ris_vec3 rest_point(const ris_model *model, uint32_t node)
{
    const ris_network_node *n = &model->network_node[node];
    return ris__muscle_point(model, &model->muscle[n->muscle], model->fiber_point, n->point);
}

/* Moving nodes by muscle and point, then the fixed ones. */
static void list_nodes(ris_model *model)
{
    for (uint32_t g = 0; g < model->group_point_count; ++g) {
        const ris_group_point *p = &model->group_point[g];
        if (find_node(model, p->muscle, p->point) == UINT32_MAX) {
            add_node(model, p->muscle, p->point, false);
        }
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        if (muscle->kind == RIS_MUSCLE_LINEAR && find_node(model, m, muscle->point_count - 1) != UINT32_MAX) {
            add_node(model, m, 0, true);
        }
    }
}

/* Springs a and b of the thesis: between constrained points that follow each other, and from the bone to the end. Their rest
 * length is what the muscle itself wants this tick. */
static void spring_muscles(ris_model *model)
{
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        uint32_t last = UINT32_MAX;
        for (uint32_t i = 0; i < model->muscle[m].point_count; ++i) {
            const uint32_t node = find_node(model, m, i);
            if (node != UINT32_MAX && last != UINT32_MAX) {
                add_spring(model, last, node, -1.0f);
            }
            last = node != UINT32_MAX ? node : last;
        }
    }
    for (uint32_t k = 0; k < model->network_node_count; ++k) {
        const ris_network_node *node = &model->network_node[k];
        if (node->fixed) {
            add_spring(model, k, find_node(model, node->muscle, model->muscle[node->muscle].point_count - 1),
                       -1.0f);
        }
    }
}

/* Springs c: all pairs of different muscles in a group, at their distance in the rest pose. */
static void spring_groups(ris_model *model)
{
    for (uint32_t g = 0; g < model->group_count; ++g) {
        const ris_group *group = &model->group[g];
        const ris_group_point *p = model->group_point + group->first_point;
        for (uint32_t i = 0; i < group->point_count; ++i) {
            for (uint32_t j = i + 1; j < group->point_count; ++j) {
                if (p[i].muscle != p[j].muscle) {
                    const uint32_t a = find_node(model, p[i].muscle, p[i].point),
                                   b = find_node(model, p[j].muscle, p[j].point);
                    add_spring(model, a, b, v3_distance(rest_point(model, a), rest_point(model, b)));
                }
            }
        }
    }
}

ris_result ris__bake_network(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const size_t nodes = (size_t)model->group_point_count + model->muscle_count;
    size_t springs = nodes + model->muscle_count;
    for (uint32_t g = 0; g < model->group_count; ++g) {
        springs += (size_t)model->group[g].point_count * model->group[g].point_count;
    }
    if (bake->head->tissue.model != RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    ris_result result =
        ris__model_alloc(&model->network_node, nodes, sizeof *model->network_node, "the muscle network", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->network_spring, springs, sizeof *model->network_spring,
                                  "the muscle network", err);
    }
    if (result == RIS_OK) {
        list_nodes(model);
        spring_muscles(model);
        spring_groups(model);
    }
    return result;
}
