/* KA-47 fat pads. A muscle that runs below fat, as zygomaticus major below the malar pad, gathers that fat when
 * it shortens: what lies over the middle of the muscle is squeezed, keeps its volume and rises, up the muscle
 * and out of the face. Here every node over such a muscle learns how much fat it has below it. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define PAD_FROM 0.15f /* of the muscle's length: where the pad begins, */
#define PAD_TO 0.9f    /* and where it ends, before the insertion */
#define FAT_MAX_MM 10.0f
#define FACING_NONE 0.2f /* the side of the nose looks away from the cheek */
#define LIFT 0.7f        /* of a rise goes along the muscle, towards its fixed end */

float ris__muscle_length(const ris_model *model, const ris_muscle *muscle)
{
    float length = 0.0f;
    for (uint32_t i = 1; i < muscle->point_count; ++i) {
        length += v3_distance(ris__muscle_point(model, muscle, model->fiber_point, i),
                              ris__muscle_point(model, muscle, model->fiber_point, i - 1));
    }
    return length;
}

static float half_thickness(const ris_model *model, const ris_muscle *muscle)
{
    float sum = 0.0f;
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        sum += model->segment[model->fiber[muscle->first_fiber + f].first_segment].size.y;
    }
    return 0.5f * sum / (float)muscle->fiber_count;
}

bool ris__find_over_muscle(const ris_model *model, const ris_muscle *muscle, uint32_t node, float length,
                           ris_over_muscle *out)
{
    const ris_vec3 x = v4_xyz(model->rest_position[node]), n = v4_xyz(model->rest_normal[node]);
    float own = 0.0f, best = INFINITY;
    for (uint32_t i = 0; i + 1 < muscle->point_count; ++i) {
        const ris_vec3 a = ris__muscle_point(model, muscle, model->fiber_point, i),
                       b = ris__muscle_point(model, muscle, model->fiber_point, i + 1), ab = v3_sub(b, a);
        const float step = v3_length(ab);
        const float s = f_clamp(v3_dot(v3_sub(x, a), ab) / (step * step), 0.0f, 1.0f);
        const ris_vec3 r = v3_sub(x, v3_mad(a, s, ab));
        const float out_mm = v3_dot(r, n), beside = v3_length(v3_mad(r, -out_mm, n));
        if (out_mm > 0.0f && v3_length(r) < best) {
            best = v3_length(r);
            out->facing = out_mm / v3_length(r);
            out->along = (own + s * step) / length;
            out->beside_mm = beside;
            out->out_mm = out_mm;
            out->pull = v3_scale(ab, -1.0f / step);
        }
        own += step;
    }
    return best < INFINITY;
}

/* 0 at the ends of the pad, 1 in its middle. */
static float pad_window(float along)
{
    const float s = 2.0f * (along - PAD_FROM) / (PAD_TO - PAD_FROM) - 1.0f;
    const float bell = f_max(1.0f - s * s, 0.0f);
    return bell * bell;
}

static void find_pad(ris_bake *bake, uint32_t m, const bool *apart)
{
    ris_model *model = bake->model;
    const ris_muscle *muscle = &model->muscle[m];
    const float half = half_thickness(model, muscle);
    const float reach = muscle->def->fat_radius_mm, length = ris__muscle_length(model, muscle);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        ris_over_muscle place = {0};
        if (!bake->moving[i] || apart[i] || !ris__find_over_muscle(model, muscle, i, length, &place) ||
            !(place.beside_mm < reach)) {
            continue;
        }
        const float ratio = place.beside_mm / reach, bell = 1.0f - ratio * ratio;
        const float facing = f_smoothstep((place.facing - FACING_NONE) / (1.0f - FACING_NONE));
        const float fat_mm = f_clamp(place.out_mm - half - bake->head->tissue.skin_mm, 0.0f, FAT_MAX_MM);
        const float rise = muscle->def->fat * fat_mm * bell * bell * pad_window(place.along) * facing;
        if (rise > 1e-3f) {
            const ris_vec3 n = v4_xyz(model->rest_normal[i]);
            const ris_vec3 along_skin = v3_mad(place.pull, -v3_dot(place.pull, n), n);
            ris_fat_node *node = &model->fat[model->fat_count++];
            node->node = i;
            node->muscle = m;
            node->rise_mm = v3_scale(v3_mad(n, LIFT, along_skin), rise);
        }
    }
}

ris_result ris__bake_fat(ris_bake *bake, ris_error *err)
{
    static const char *const regions[] = {"lips", "mouth_cavity", "lids", "eye_socket", "nose"};
    ris_model *model = bake->model;
    size_t pads = 0;
    bool *apart = NULL;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        pads += model->muscle[m].def->fat > 0.0f;
    }
    if (pads == 0 || bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    ris_result result =
        ris__model_alloc(&model->fat, pads * model->node_count, sizeof *model->fat, "fat pads", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&apart, model->node_count, sizeof *apart, "fat pads", err);
    }
    for (size_t k = 0; result == RIS_OK && k < sizeof regions / sizeof *regions; ++k) {
        ris__region_flags(bake->head, regions[k], apart);
    }
    for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
        if (model->muscle[m].def->fat > 0.0f) {
            find_pad(bake, m, apart);
        }
    }
    free(apart);
    return result;
}
