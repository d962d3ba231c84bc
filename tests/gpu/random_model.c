#include "random_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "asset/channel.h"
#include "model/model_impl.h"

#define DEGREE_MAX 9u

static uint32_t random_word(uint32_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    *seed ^= *seed << 5;
    return *seed;
}

float random_unit(uint32_t *seed)
{
    return (float)(random_word(seed) >> 8) * (1.0f / 16777216.0f);
}

float random_between(uint32_t *seed, float low, float high)
{
    return low + (high - low) * random_unit(seed);
}

ris_vec4 random_vec(uint32_t *seed, float size, float w)
{
    ris_vec4 v = {random_between(seed, -size, size), random_between(seed, -size, size),
                  random_between(seed, -size, size), w};
    return v;
}

static float length_between(ris_vec4 a, ris_vec4 b)
{
    const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf(x * x + y * y + z * z);
}

static void fill_nodes(ris_model *model, uint32_t *seed)
{
    for (uint32_t i = 0; i < model->node_count; i++) {
        ris_vec4 n = random_vec(seed, 1.0f, 0.0f);
        const float l = length_between(n, (ris_vec4){0});
        const bool is_static = model->node_count > 1 && random_unit(seed) < 0.15f;
        model->rest_position[i] =
            random_vec(seed, 40.0f, is_static ? 0.0f : random_between(seed, 2.0f, 6.0f));
        model->rest_normal[i] = (ris_vec4){n.x / l, n.y / l, n.z / l, 0.0f};
        if (!is_static) {
            model->heft[i] = random_between(seed, 0.1f, 2.0f);
            model->anchor_param[i] =
                (ris_anchor_param){random_between(seed, 5.0f, 60.0f), random_between(seed, 5.0f, 60.0f),
                                   random_between(seed, 3.0f, 20.0f), random_between(seed, 0.0f, 20.0f)};
        }
        ((float *)model->jaw_weight)[i] = random_unit(seed);
        model->bone_anchor[i] = (ris_vec3){model->rest_position[i].x - 2.0f, model->rest_position[i].y,
                                           model->rest_position[i].z - 4.0f};
    }
}

static void fill_springs(ris_model *model, uint32_t *seed)
{
    const uint32_t n = model->node_count;
    uint32_t h = 0, t = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t degree = n > 1 ? random_word(seed) % (DEGREE_MAX + 1) : 0;
        model->spring_start[i] = h;
        model->ring_start[i] = t;
        for (uint32_t k = 0; k < degree; k++) {
            const uint32_t other = (i + 1 + random_word(seed) % (n - 1)) % n;
            const float now = length_between(model->rest_position[i], model->rest_position[other]);
            /* from compressed to far beyond the switch of the biphasic law */
            model->half_spring[h++] = (ris_half_spring){other, now * random_between(seed, 0.4f, 1.3f),
                                                        random_between(seed, 0.2f, 1.2f),
                                                        random_unit(seed) * 0.2f, random_unit(seed) * 3.0f};
        }
        for (uint32_t k = 0; n > 2 && k + 1 < degree; k++) {
            const uint32_t b = (i + 1 + random_word(seed) % (n - 1)) % n;
            model->ring[t++] = (ris_ring){b, random_word(seed) % n};
        }
    }
    model->spring_start[n] = h;
    model->ring_start[n] = t;
    model->half_spring_count = h;
    model->spring_count = h / 2;
    model->triangle_count = (t + 2) / 3; /* the ring has room for three times as many */
}

/* Nodes with random ones of the other lip. */
static void fill_lips(ris_model *model, uint32_t *seed)
{
    const uint32_t n = model->node_count;
    for (uint32_t i = 0; i < n; i++) {
        ris_contact_node c = {.node = i, .lip_first = model->contact_pair_count};
        c.lip_limit_mm = random_between(seed, -2.0f, 2.0f);
        if (!(model->rest_position[i].w > 0.0f) || random_unit(seed) < 0.3f) {
            continue;
        }
        for (uint32_t k = random_word(seed) % (DEGREE_MAX + 1); n > 1 && k > 0; k--) {
            model->contact_other[model->contact_pair_count++] = (i + 1 + random_word(seed) % (n - 1)) % n;
        }
        c.lip_end = model->contact_pair_count;
        if (c.lip_end > c.lip_first) {
            model->contact_node[model->contact_node_count++] = c;
        }
    }
    model->push.lip_node_count = model->contact_node_count;
}

/* Nodes with random bodies, some of them at the middle of an edge. */
static void fill_touches(ris_model *model, uint32_t *seed)
{
    const uint32_t n = model->node_count;
    for (uint32_t i = 0; i < n; i++) {
        ris_contact_node c = {.node = i, .touch_first = model->contact_touch_count};
        for (uint32_t k = 0; k < 3 && model->rest_position[i].w > 0.0f; k++) {
            if (random_unit(seed) < 0.7f) {
                const uint32_t other = random_unit(seed) < 0.5f ? i : random_word(seed) % n;
                model->contact_touch[model->contact_touch_count++] =
                    (ris_contact_touch){k, other, random_between(seed, -2.0f, 2.0f)};
            }
        }
        c.touch_end = model->contact_touch_count;
        if (c.touch_end > c.touch_first) {
            model->contact_node[model->contact_node_count++] = c;
        }
    }
}

/* Some nodes feel others as the other lip, all feel some of three bodies. Nothing in the kaehler tissue. */
static void fill_contact(ris_model *model, uint32_t *seed)
{
    if (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) {
        return;
    }
    model->push.lip_radius_mm = 30.0f;
    model->contact_solid_count = 3;
    for (uint32_t k = 0; k < 3; k++) {
        ris_contact_solid *solid = &model->contact_solid[k];
        solid->bone = k == 1 ? RIS_BONE_JAW : k == 2 ? RIS_BONE_EYE_L : RIS_BONE_SKULL;
        solid->low = (ris_vec3){-30.0f, -25.0f, -35.0f};
        solid->cell_mm = 5.0f + (float)k;
        solid->count[0] = 9 + k;
        solid->count[1] = 8;
        solid->count[2] = 10;
        solid->first = model->contact_sample_count;
        model->contact_sample_count += solid->count[0] * solid->count[1] * solid->count[2];
    }
    for (uint32_t s = 0; s < model->contact_sample_count; s++) {
        model->contact_grid[s] = random_vec(seed, 1.0f, random_between(seed, -3.0f, 9.0f));
    }
    fill_lips(model, seed);
    fill_touches(model, seed);
    model->push.contact_node_count = model->contact_node_count;
}

static bool allocate(ris_model *model)
{
    const size_t n = model->node_count;
    ris_head *head = calloc(1, sizeof *head);
    model->head = head;
    model->rest_position = calloc(n, sizeof *model->rest_position);
    model->spring_start = calloc(n + 1, sizeof *model->spring_start);
    model->half_spring = calloc(n * DEGREE_MAX + 1, sizeof *model->half_spring);
    model->ring_start = calloc(n + 1, sizeof *model->ring_start);
    model->ring = calloc(n * DEGREE_MAX + 3, sizeof *model->ring);
    model->heft = calloc(n, sizeof *model->heft);
    model->anchor_param = calloc(n, sizeof *model->anchor_param);
    model->rest_normal = calloc(n, sizeof *model->rest_normal);
    model->binding_start = calloc(n + 1, sizeof *model->binding_start);
    model->bone_anchor = calloc(n, sizeof *model->bone_anchor);
    model->jaw_weight = calloc(n, sizeof *model->jaw_weight);
    model->fiber_point = calloc(1, sizeof *model->fiber_point);
    model->contact_grid = calloc(4096, sizeof *model->contact_grid);
    model->contact_node = calloc(2 * n, sizeof *model->contact_node);
    model->contact_touch = calloc(3 * n, sizeof *model->contact_touch);
    model->contact_other = calloc(n * DEGREE_MAX + 1, sizeof *model->contact_other);
    model->channel_count = ris__beside_channel_count;
    model->channel = calloc(model->channel_count, sizeof *model->channel);
    return head && model->rest_position && model->spring_start && model->half_spring && model->ring_start &&
           model->ring && model->anchor_param && model->heft && model->rest_normal && model->binding_start &&
           model->bone_anchor && model->jaw_weight && model->fiber_point && model->channel &&
           model->contact_grid && model->contact_node && model->contact_touch && model->contact_other;
}

ris_model *random_model_create(uint32_t node_count, uint32_t flags, uint32_t seed)
{
    ris_model *model = calloc(1, sizeof *model);
    ris_head *head;
    if (!model) {
        return NULL;
    }
    model->node_count = node_count;
    if (!allocate(model)) {
        random_model_free(model);
        return NULL;
    }
    head = (ris_head *)model->head;
    head->tissue = ris_default_tissue();
    head->tissue.substeps = 8;
    head->jaw = ris_default_jaw();
    head->dynamics = ris_default_dynamics();
    for (uint32_t c = 0; c < model->channel_count; c++) {
        strncpy(model->channel[c].name, ris__beside_channel[c].name, RIS_NAME_SIZE - 1);
        model->channel[c].minimum = ris__beside_channel[c].minimum;
        model->channel[c].maximum = ris__beside_channel[c].maximum;
    }
    fill_nodes(model, &seed);
    fill_springs(model, &seed);
    model->mass_g = 0.25f;
    model->push =
        (ris_sim_push){node_count, flags, 1.0f / 480.0f, 100.0f, 1000.0f, 1.5f, 0.3f, 12.0f, 0, 0, 0.0f, 0};
    fill_contact(model, &seed);
    if (ris__list_moving(model, NULL) != RIS_OK) {
        random_model_free(model);
        return NULL;
    }
    model->stable_dt_s = 0.01f;
    return model;
}

void random_model_free(ris_model *model)
{
    if (!model) {
        return;
    }
    free((void *)model->head);
    free(model->rest_position);
    free(model->moving);
    free(model->spring_start);
    free(model->half_spring);
    free(model->ring_start);
    free(model->ring);
    free(model->anchor_param);
    free(model->heft);
    free(model->rest_normal);
    free(model->binding_start);
    free(model->bone_anchor);
    free((void *)model->jaw_weight);
    free(model->fiber_point);
    free(model->contact_grid);
    free(model->contact_node);
    free(model->contact_touch);
    free(model->contact_other);
    free(model->channel);
    free(model);
}
