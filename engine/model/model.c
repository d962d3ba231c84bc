/* Bake of a head into a flat const model: the order of the builders, and its end. KA-01, KA-09, KA-48. */
#include "asset/channel.h"
#include "asset/vocabulary.h"
#include "base/clock.h"
#include "model_impl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ris_result ris__model_alloc(void *out, size_t count, size_t size, const char *what, ris_error *err)
{
    void *memory = calloc(count ? count : 1, size);
    memcpy(out, &memory, sizeof memory);
    if (!memory) {
        return ris_fail(err, RIS_ERROR_MEMORY, "not enough memory for %s (%zu x %zu bytes)", what, count,
                        size);
    }
    return RIS_OK;
}

void ris__region_flags(const ris_head *head, const char *name, bool *flags)
{
    const ris_region *region = ris_head_region(head, name);
    for (uint32_t k = 0; region && k < region->count; ++k) {
        flags[region->vertex[k]] = true;
    }
}

static void bake_finish(ris_bake *bake)
{
    free(bake->ring_triangle);
    free(bake->triangle_area);
    free(bake->moving);
    free(bake->lining);
    free(bake->muscle_weight);
    for (uint32_t m = 0; bake->grid && m < bake->head->muscle_count; ++m) {
        ris__grid_finish(&bake->grid[m]);
    }
    free(bake->grid);
    ris__bvh_finish(&bake->skin_tree);
    ris__tri_finish(&bake->skin);
}

/* What the parser cannot know: arrays that a head made in code may have left out. */
static ris_result check_head(const ris_head *head, ris_error *err)
{
    const ris_tissue_def *tissue = &head->tissue;
    if (head->skin.vertex_count == 0 || head->skin.face_count == 0) {
        return ris_fail(err, RIS_ERROR_DATA, "the skin has no faces");
    }
    if (!head->depth_mm || !head->jaw_weight) {
        return ris_fail(err, RIS_ERROR_DATA, "the head has no tissue depth or no jaw weight");
    }
    if (tissue->substeps == 0 || tissue->substeps > 1024) {
        return ris_fail(err, RIS_ERROR_DATA, "substeps is %u, expected 1..1024", tissue->substeps);
    }
    if (!(tissue->modulus[0] >= 0.0f) || !(tissue->modulus[1] >= tissue->modulus[0])) {
        return ris_fail(err, RIS_ERROR_DATA, "modulus is %g, %g, expected 0 <= low <= high",
                        (double)tissue->modulus[0], (double)tissue->modulus[1]);
    }
    if (!ris_head_region(head, head->simulated)) {
        return ris_fail(err, RIS_ERROR_DATA, "simulated region \"%s\" is not among the regions",
                        head->simulated);
    }
    return RIS_OK;
}

ris_result ris_model_create(const ris_head *head, ris_model **out, ris_error *err)
{
    static const struct {
        ris_result (*build)(ris_bake *, ris_error *);
        bool muscles; /* part of rebuilding all muscles after an edit (KA-43) */
    } builders[] = {
        /* clang-format off */
        {ris__bake_triangles, false},
        {ris__bake_mass, false},
        {ris__bake_springs, false},
        {ris__bake_jaw_slide, false},
        {ris__bake_lining, false},
        {ris__bake_grids, true},
        {ris__bake_muscles, true},
        {ris__bake_groups, true},
        {ris__bake_network, true},
        {ris__bake_ties, true},
        {ris__bake_fat, true},
        {ris__bake_puff, true},
        {ris__bake_bindings, true},
        {ris__bake_lips, true},
        {ris__bake_anchors, false},
        {ris__bake_slide, false},
        {ris__bake_lids, false},
        {ris__bake_lid_triangles, false},
        {ris__bake_contact, false},
        {ris__bake_push, false},
        {ris__bake_channels, false},
        {ris__bake_vocabulary, false},
        /* clang-format on */
    };
    *out = NULL;
    ris_result result = check_head(head, err);
    if (result != RIS_OK) {
        return result;
    }
    ris_bake bake = {0};
    result = ris__model_alloc(&bake.model, 1, sizeof *bake.model, "the model", err);
    if (result != RIS_OK) {
        return result;
    }
    bake.head = head;
    bake.model->head = head;
    bake.model->node_count = head->skin.vertex_count;
    bake.model->jaw_weight = head->jaw_weight;
    for (size_t k = 0; k < sizeof builders / sizeof builders[0] && result == RIS_OK; ++k) {
        const uint64_t start = ris__clock_ns();
        result = builders[k].build(&bake, err);
        const double ms = ris__clock_ms(start, ris__clock_ns());
        bake.model->bake_ms += ms;
        bake.model->muscle_bake_ms += builders[k].muscles ? ms : 0.0;
    }
    bake_finish(&bake);
    if (result != RIS_OK) {
        ris_model_destroy(bake.model);
        return result;
    }
    *out = bake.model;
    return RIS_OK;
}

ris_result ris_model_load(const char *directory, ris_model **out, ris_error *err)
{
    *out = NULL;
    ris_head *head = NULL;
    ris_result result = ris__model_alloc(&head, 1, sizeof *head, "the head", err);
    if (result != RIS_OK) {
        return result;
    }
    result = ris_head_load(directory, head, err);
    if (result != RIS_OK) {
        goto fail;
    }
    result = ris_model_create(head, out, err);
    if (result != RIS_OK) {
        goto fail;
    }
    (*out)->owned_head = head;
    return RIS_OK;
fail:
    ris_head_finish(head);
    free(head);
    return result;
}

void ris_model_destroy(ris_model *model)
{
    if (!model) {
        return;
    }
    free(model->rest_position);
    free(model->moving);
    free(model->spring_start);
    free(model->half_spring);
    free(model->ring_start);
    free(model->ring);
    free(model->anchor_param);
    free(model->heft);
    free(model->rest_normal);
    free(model->triangle);
    free(model->triangle_corner);
    free(model->node_area_mm2);
    free(model->channel);
    free(model->muscle);
    free(model->fiber);
    free(model->fiber_point);
    free(model->segment);
    free(model->binding_start);
    free(model->binding);
    free(model->attach);
    free(model->group);
    free(model->group_point);
    free(model->network_node);
    free(model->network_spring);
    free(model->bone_anchor);
    free(model->jaw_slide_weight);
    free(model->contact_grid);
    free(model->contact_node);
    free(model->contact_touch);
    free(model->contact_other);
    free(model->lid);
    free(model->lid_triangle);
    free(model->lid_around);
    free(model->lining);
    free(model->lip_close);
    free(model->fat);
    free(model->puff);
    free(model->slide);
    ris__vocabulary_finish(&model->vocabulary);
    if (model->owned_head) {
        ris_head_finish(model->owned_head);
        free(model->owned_head);
    }
    free(model);
}

uint32_t ris_model_channel(const ris_model *model, const char *name)
{
    for (uint32_t k = 0; k < model->channel_count; ++k) {
        if (strcmp(model->channel[k].name, name) == 0) {
            return k;
        }
    }
    return UINT32_MAX;
}

/* The channel of the movable centre of muscle m, if it has one. */
static ris_result add_protrude(ris_model *model, uint32_t m, ris_error *err)
{
    char name[RIS_NAME_SIZE];
    model->muscle[m].protrude_channel = UINT32_MAX;
    if (!ris__protrude_channel(model->muscle[m].def, name)) {
        return RIS_OK;
    }
    if (strlen(name) + 1 == RIS_NAME_SIZE) {
        return ris_fail(err, RIS_ERROR_DATA, "muscle %s: its name leaves no room for that of its channel %s",
                        model->muscle[m].name, name);
    }
    ris_channel *channel = &model->channel[model->channel_count];
    memcpy(channel->name, name, sizeof channel->name);
    channel->maximum = 1.0f;
    model->muscle[m].protrude_channel = model->channel_count++;
    return RIS_OK;
}

ris_result ris__bake_channels(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t fixed = ris__beside_channel_count;
    ris_result result = ris__model_alloc(&model->channel, 2 * (size_t)model->muscle_count + fixed,
                                         sizeof *model->channel, "channels", err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        memcpy(model->channel[m].name, model->muscle[m].name, sizeof model->channel[m].name);
        model->channel[m].maximum = 1.0f;
    }
    for (uint32_t k = 0; k < fixed; ++k) {
        ris_channel *channel = &model->channel[model->muscle_count + k];
        snprintf(channel->name, sizeof channel->name, "%s", ris__beside_channel[k].name);
        channel->minimum = ris__beside_channel[k].minimum;
        channel->maximum = ris__beside_channel[k].maximum;
    }
    model->channel_count = model->muscle_count + fixed;
    for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
        result = add_protrude(model, m, err);
    }
    return result;
}
