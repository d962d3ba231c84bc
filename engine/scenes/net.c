/* Bare masses and springs as a model: what the mechanics tests need and no head can give. */
#include "scenes/scenes.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <stdlib.h>

static void add_half(ris_model *model, uint32_t node, uint32_t other, const ris_scene_spring *spring)
{
    ris_half_spring *half = &model->half_spring[model->spring_start[node]++];
    half->other = other;
    half->rest_mm = spring->rest_mm;
    half->area_ratio = spring->area_ratio;
}

static ris_result allocate(ris_model *model, const ris_scene_net_def *def, ris_error *err)
{
    const size_t n = def->node_count;
    const struct {
        void *field;
        size_t count, size;
    } arrays[] = {
        {&model->owned_head, 1, sizeof *model->owned_head},
        {&model->rest_position, n, sizeof *model->rest_position},
        {&model->rest_normal, n, sizeof *model->rest_normal},
        {&model->spring_start, n + 1, sizeof *model->spring_start},
        {&model->half_spring, 2 * (size_t)def->spring_count, sizeof *model->half_spring},
        {&model->ring_start, n + 1, sizeof *model->ring_start},
        {&model->ring, 1, sizeof *model->ring},
        {&model->triangle, 1, sizeof *model->triangle},
        {&model->triangle_corner, 1, sizeof *model->triangle_corner},
        {&model->anchor_param, n, sizeof *model->anchor_param},
        {&model->heft, n, sizeof *model->heft},
        {&model->node_area_mm2, n, sizeof *model->node_area_mm2},
        {&model->binding_start, n + 1, sizeof *model->binding_start},
        {&model->bone_anchor, n, sizeof *model->bone_anchor},
        {&model->muscle, 0, sizeof *model->muscle},
        {&model->fiber, 0, sizeof *model->fiber},
        {&model->fiber_point, 0, sizeof *model->fiber_point},
        {&model->segment, 0, sizeof *model->segment},
        {&model->binding, 0, sizeof *model->binding},
        {&model->attach, 0, sizeof *model->attach},
        {&model->group, 0, sizeof *model->group},
        {&model->group_point, 0, sizeof *model->group_point},
    };
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; ++k) {
        ris_result result = ris__model_alloc(arrays[k].field, arrays[k].count, arrays[k].size, "a net", err);
        if (result != RIS_OK) {
            return result;
        }
    }
    return RIS_OK;
}

static ris_result fill(ris_model *model, const ris_scene_net_def *def, ris_error *err)
{
    const ris_tissue_def *tissue = &def->tissue;
    model->head = model->owned_head;
    model->owned_head->tissue = *tissue;
    model->owned_head->jaw.axis = v3(1, 0, 0);
    if (ris__model_alloc(&model->owned_head->jaw_weight, def->node_count, sizeof(float), "a net", err) !=
        RIS_OK) {
        return RIS_ERROR_MEMORY;
    }
    model->jaw_weight = model->owned_head->jaw_weight;
    model->node_count = def->node_count;
    model->spring_count = def->spring_count;
    model->half_spring_count = 2 * def->spring_count;
    model->mass_g = def->mass_g;
    for (uint32_t i = 0; i < def->node_count; ++i) {
        const bool pinned = def->pinned && def->pinned[i];
        model->rest_position[i] = v4_from(def->position[i], pinned ? 0.0f : 1.0f / def->mass_g);
        model->rest_normal[i].z = 1.0f;
        model->bone_anchor[i] =
            v3_sub(def->position[i], v3(0, 0, def->anchor ? def->anchor[i].rest_mm : 0.0f));
        model->heft[i] = 1.0f;
        if (def->anchor) {
            model->anchor_param[i] = def->anchor[i];
        }
    }
    for (uint32_t s = 0; s < def->spring_count; ++s) {
        ++model->spring_start[def->spring[s].a + 1];
        ++model->spring_start[def->spring[s].b + 1];
    }
    for (uint32_t i = 0; i < def->node_count; ++i) {
        model->spring_start[i + 1] += model->spring_start[i];
    }
    for (uint32_t s = 0; s < def->spring_count; ++s) { /* the starts are cursors here */
        add_half(model, def->spring[s].a, def->spring[s].b, &def->spring[s]);
        add_half(model, def->spring[s].b, def->spring[s].a, &def->spring[s]);
    }
    for (uint32_t i = def->node_count; i > 0; --i) {
        model->spring_start[i] = model->spring_start[i - 1];
    }
    model->spring_start[0] = 0;
    model->push = (ris_sim_push){
        .node_count = def->node_count,
        .flags = (tissue->model == RIS_TISSUE_KAEHLER ? RIS_TISSUE_FLAG_KAEHLER : 0u) |
                 (tissue->continuous ? RIS_TISSUE_FLAG_CONTINUOUS : 0u),
        .dt_s = (float)(1.0 / 60.0 / tissue->substeps),
        .modulus_low = tissue->modulus[0],
        .modulus_high = tissue->modulus[1],
        .switch_stretch = tissue->switch_stretch,
        .compression = tissue->compression,
        .damping_per_s = def->damping_per_s,
    };
    return ris__list_moving(model, err);
}

static ris_bake net_bake(ris_model *model)
{
    ris_bake bake = {.model = model, .head = model->head};
    return bake;
}

ris_result ris_scene_net(const ris_scene_net_def *def, ris_model **out, ris_error *err)
{
    *out = NULL;
    for (uint32_t s = 0; s < def->spring_count; ++s) {
        if (def->spring[s].a >= def->node_count || def->spring[s].b >= def->node_count) {
            return ris_fail(err, RIS_ERROR_USAGE, "spring %u of the net ends at no node", s);
        }
    }
    ris_model *model = NULL;
    ris_result result = ris__model_alloc(&model, 1, sizeof *model, "a net", err);
    if (result == RIS_OK) {
        result = allocate(model, def, err);
    }
    if (result == RIS_OK) {
        result = fill(model, def, err);
    }
    if (result == RIS_OK) {
        ris_bake bake = net_bake(model);
        result = ris__bake_channels(&bake, err);
    }
    if (result != RIS_OK) {
        ris_model_destroy(model);
        return result;
    }
    *out = model;
    return RIS_OK;
}
