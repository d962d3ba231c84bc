/* Muscles as they are shown: KA-24 segments with their present frames (KA-37) and extents, in skull space. The default tissue
 * moves muscles in closed-jaw space and turns the skin's targets with the jaw; what is shown turns with it: a control
 * point by the mean jaw weight of the skin the muscle holds there, its fixed end with its bone. Points of a ring round
 * the lids go where the lids take their skin. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <stdlib.h>

#define NEAR_MM 3.0f    /* skin this near to a control point counts fully */
#define LID_MM 1.0f     /* the same for lids, which turn by very different angles from row to row */
#define LID_FROM 0.5f   /* share of the length of a lid's lifter from which on it goes with the lid */
#define BONE_UNTIL 0.5f /* share of a fibre's length along which its bone lets go */

/* Weight of a node bound to a muscle, seen from one of its control points. */
static float nearness(const ris_binding *binding, ris_vec3 point, ris_vec3 node, float near_mm)
{
    const ris_vec3 d = v3_sub(point, node);
    const float s = v3_dot(d, d) + near_mm * near_mm;
    return binding->weight / (s * s);
}

/* From the bone of the first row to that of the last, by the way along the fibre; the ends go with their bones. */
static void hang_on_both(const ris_model *model, const ris_muscle *muscle, uint32_t first, float *weight)
{
    const float start = muscle->on_jaw ? 1.0f : 0.0f,
                end = muscle->def->end_bone == RIS_BONE_JAW ? 1.0f : 0.0f;
    float total = 0.0f, length = 0.0f;
    for (uint32_t i = 1; i < muscle->point_count; ++i) {
        total += v3_distance(model->fiber_point[first + i], model->fiber_point[first + i - 1]);
    }
    for (uint32_t i = 0; i < muscle->point_count; ++i) {
        length +=
            i > 0 ? v3_distance(model->fiber_point[first + i], model->fiber_point[first + i - 1]) : 0.0f;
        weight[first + i] = start + f_smoothstep(length / total) * (end - start);
    }
}

ris_result ris__muscle_jaw_weights(const ris_model *model, float *weight, ris_error *err)
{
    float *sum = NULL;
    ris_result result =
        ris__model_alloc(&sum, model->fiber_point_count, sizeof *sum, "weights of the muscles", err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t i = 0; i < model->fiber_point_count; ++i) {
        weight[i] = 0.0f;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        for (uint32_t b = model->binding_start[i]; b < model->binding_start[i + 1]; ++b) {
            const ris_muscle *muscle = &model->muscle[model->binding[b].muscle];
            const uint32_t first = model->fiber[muscle->first_fiber].first_point;
            for (uint32_t k = first; k < first + muscle->fiber_count * muscle->point_count; ++k) {
                const float s = nearness(&model->binding[b], model->fiber_point[k],
                                         v4_xyz(model->rest_position[i]), NEAR_MM);
                weight[k] += s * model->jaw_weight[i];
                sum[k] += s;
            }
        }
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
            if (muscle->def->end_bone != RIS_BONE_AUTO) {
                hang_on_both(model, muscle, first, weight);
                continue;
            }
            for (uint32_t i = 0; i < muscle->point_count; ++i) {
                const float t = (float)i / (float)(muscle->point_count - 1),
                            bone = muscle->on_jaw ? 1.0f : 0.0f,
                            skin = sum[first + i] > 0.0f ? weight[first + i] / sum[first + i] : bone;
                weight[first + i] = muscle->kind == RIS_MUSCLE_LINEAR
                                        ? bone + f_smoothstep(t / BONE_UNTIL) * (skin - bone)
                                        : skin;
            }
        }
    }
    free(sum);
    return RIS_OK;
}

/* How much of a lid's node muscle m holds: as it is bound to the skin, or all of the upper lid that it lifts. */
static float holds_lid(const ris_model *model, uint32_t m, const ris_lid_node *lid, ris_vec3 point,
                       ris_vec3 rest)
{
    const ris_binding whole = {.weight = 1.0f};
    if ((lid->upper || model->muscle[m].kind == RIS_MUSCLE_SPHINCTER) &&
        model->muscle[m].lid_eye == lid->eye + 1) {
        return nearness(&whole, point, rest, LID_MM);
    }
    for (uint32_t b = model->binding_start[lid->node]; b < model->binding_start[lid->node + 1]; ++b) {
        if (model->binding[b].muscle == m) {
            return nearness(&model->binding[b], point, rest, LID_MM);
        }
    }
    return 0.0f;
}

/* What the lids take their skin by beside muscles and jaw, near a control point of muscle m, mm. */
static ris_vec3 lid_carry(const ris_rig *rig, uint32_t m, ris_vec3 point)
{
    const ris_model *model = rig->model;
    ris_vec3 sum = {0};
    float total = 0.0f;
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        const ris_lid_node *lid = &model->lid[k];
        const ris_vec3 rest = v4_xyz(model->rest_position[lid->node]);
        const float s = lid->lining ? 0.0f : holds_lid(model, m, lid, point, rest);
        sum = v3_mad(sum, s, v3_sub(v3_sub(rig->target[lid->node], rest), rig->lid_move[k]));
        total += s;
    }
    const ris_vec3 none = {0};
    return total > 0.0f ? v3_scale(sum, 1.0f / total) : none;
}

/* The kaehler tissue has turned the muscles on the jaw in jaw_pose, but those between bones. */
static bool turned_before(const ris_model *model, const ris_muscle *muscle)
{
    return (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) && muscle->def->end_bone == RIS_BONE_AUTO;
}

static void place_points(const ris_rig *rig, uint32_t m, ris_vec3 *point)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[m];
    const bool kaehler = turned_before(model, muscle);
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
        for (uint32_t i = 0; i < muscle->point_count; ++i) {
            ris_vec3 p = rig->q[first + i];
            if (!kaehler) {
                p = v3_lerp(p, ris__rigid_apply(&rig->jaw, p), rig->muscle_jaw[first + i]);
            }
            const float t = (float)i / (float)(muscle->point_count - 1);
            if (muscle->def->closes_on_line || (muscle->lid_eye != 0 && t > LID_FROM)) {
                const float share = muscle->kind == RIS_MUSCLE_LINEAR
                                        ? f_smoothstep((t - LID_FROM) / (1.0f - LID_FROM))
                                        : 1.0f;
                p = v3_mad(p, share, lid_carry(rig, m, model->fiber_point[first + i]));
            }
            point[first + i] = p;
        }
    }
}

/* Axis v of a segment turned with the jaw, then by the smallest rotation from `from` to `to`. */
static ris_vec3 turn_axis(ris_vec3 v, ris_vec3 from, ris_vec3 to)
{
    const float cosine = v3_dot(from, to);
    if (cosine < -0.9999f) {
        return v;
    }
    const ris_vec3 k = v3_cross(from, to), once = v3_cross(k, v), twice = v3_cross(k, once);
    return v3_add(v, v3_mad(once, 1.0f / (1.0f + cosine), twice));
}

static void place_segment(const ris_rig *rig, const ris_muscle *muscle, uint32_t segment, uint32_t first,
                          const ris_vec3 *point, ris_segment *out)
{
    const ris_model *model = rig->model;
    const bool kaehler = turned_before(model, muscle);
    const float w = kaehler ? (muscle->on_jaw ? 1.0f : 0.0f)
                            : 0.5f * (rig->muscle_jaw[first] + rig->muscle_jaw[first + 1]);
    const ris_segment *rest = &model->segment[segment];
    ris_vec3 along = rest->along, up = rest->up;
    if (!rig->jaw.identity && w > 0.0f) {
        along = v3_unit_or(v3_lerp(along, ris__rigid_rotate(&rig->jaw, along), w), along);
        up = v3_unit_or(v3_lerp(up, ris__rigid_rotate(&rig->jaw, up), w), up);
    }
    const ris_vec3 now = v3_sub(point[first + 1], point[first]);
    out->origin = v3_scale(v3_add(point[first], point[first + 1]), 0.5f);
    out->size = v3(v3_length(now), rest->size.y * rig->bulge[segment], rest->size.z);
    out->along = v3_unit_or(now, along);
    out->wide = v3_unit_or(v3_cross(out->along, turn_axis(up, along, out->along)), rest->wide);
    out->up = v3_cross(out->wide, out->along);
}

void ris__muscle_shape(const ris_rig *rig, ris_vec3 *point, ris_segment *segment)
{
    const ris_model *model = rig->model;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        place_points(rig, m, point);
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            const ris_fiber *fiber = &model->fiber[muscle->first_fiber + f];
            for (uint32_t i = 0; i + 1 < muscle->point_count; ++i) {
                place_segment(rig, muscle, fiber->first_segment + i, fiber->first_point + i, point,
                              &segment[fiber->first_segment + i]);
            }
        }
    }
}
