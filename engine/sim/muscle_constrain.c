/* muscle_constrain: KA-33 geometric resolution of the constraint groups. In the default tissue the members follow along their
 * whole length (in proportion to the arc length from the fixed end), and the displacement of a corner of the mouth becomes a drag
 * along the orbicularis oris (spec/prototype.md 5: group displacement x t^p) in place of the straightening of KA-35. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <string.h>

#define ACTIVITY_FULL 0.1f

ris_vec3 ris__resolve_group(uint32_t n, const float *contraction, const float *rest_distance_mm, const ris_vec3 *rest,
                            float lambda, ris_vec3 *point)
{
    float sum = 0.0f;
    ris_vec3 centroid = {0}, rest_centroid = {0};
    for (uint32_t k = 0; k < n; ++k) {
        const float w = 1.0f + lambda * contraction[k];
        centroid = v3_mad(centroid, w, point[k]);
        rest_centroid = v3_add(rest_centroid, rest[k]);
        sum += w;
    }
    centroid = v3(centroid.x / sum, centroid.y / sum, centroid.z / sum);
    rest_centroid = v3_scale(rest_centroid, 1.0f / (float)n);
    for (uint32_t k = 0; k < n; ++k) {
        const ris_vec3 none = {0};
        const ris_vec3 fallback = v3_unit_or(v3_sub(rest[k], rest_centroid), none);
        const ris_vec3 d = v3_sub(point[k], centroid);
        const ris_vec3 direction = v3_dot(d, d) > 1e-12f ? v3_unit_or(d, fallback) : fallback;
        point[k] = v3_mad(centroid, rest_distance_mm[k], direction);
    }
    return centroid;
}

float ris__power(float t, float power)
{
    power = f_clamp(power, 0.0f, 31.0f);
    const uint32_t whole = (uint32_t)power;
    float result = 1.0f;
    for (uint32_t k = 0; k < whole; ++k) {
        result *= t;
    }
    return result + (power - (float)whole) * (result * t - result);
}

/* Literal: the constrained point alone. Default: the whole muscle in proportion to its length from the fixed end. */
static void displace_member(ris_rig *rig, const ris_group_point *member, ris_vec3 delta, bool literal)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[member->muscle];
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
        if (literal) {
            rig->q[first + member->point] = v3_add(rig->q[first + member->point], delta);
            continue;
        }
        float total = 0.0f, length = 0.0f;
        for (uint32_t i = 1; i < muscle->point_count; ++i) {
            total += v3_distance(rig->p[first + i], rig->p[first + i - 1]);
        }
        for (uint32_t i = 1; i < muscle->point_count; ++i) {
            length += v3_distance(rig->p[first + i], rig->p[first + i - 1]);
            rig->q[first + i] = v3_mad(rig->q[first + i], length / total, delta);
        }
    }
}

static void resolve(ris_rig *rig, const ris_group *group, bool literal)
{
    const ris_model *model = rig->model;
    const ris_group_point *member = model->group_point + group->first_point;
    const uint32_t n = group->point_count;
    float contraction[RIS_GROUP_MAX], distance[RIS_GROUP_MAX];
    ris_vec3 rest[RIS_GROUP_MAX], before[RIS_GROUP_MAX], after[RIS_GROUP_MAX];
    float acting = 0.0f, pulling = 0.0f, power = 0.0f;
    for (uint32_t k = 0; k < n; ++k) {
        const ris_muscle *muscle = &model->muscle[member[k].muscle];
        contraction[k] = rig->contraction[member[k].muscle];
        distance[k] = member[k].rest_distance_mm;
        rest[k] = ris__muscle_point(model, muscle, model->fiber_point, member[k].point);
        before[k] = after[k] = ris__muscle_point(model, muscle, rig->q, member[k].point);
        acting += rig->activation[member[k].muscle];
        if (muscle->lip_drag_power > 0.0f) {
            pulling += rig->activation[member[k].muscle];
            power += rig->activation[member[k].muscle] * muscle->lip_drag_power;
        }
    }
    if (!(acting > 0.0f) && (!literal || rig->jaw.identity)) {
        return; /* nothing has moved: leave the bits alone */
    }
    ris__resolve_group(n, contraction, distance, rest, model->head->tissue.constraint_lambda, after);
    for (uint32_t k = 0; k < n; ++k) {
        const ris_muscle *muscle = &model->muscle[member[k].muscle];
        const ris_vec3 delta = v3_sub(after[k], before[k]);
        if (literal || muscle->kind == RIS_MUSCLE_LINEAR) {
            displace_member(rig, &member[k], delta, literal);
        } else if (pulling > 0.0f) {
            ris_drag *drag = &rig->drag[2 * (size_t)member[k].muscle + (member[k].point > 0)];
            drag->displacement = delta;
            drag->power = power / pulling;
            drag->strength = f_min(pulling / ACTIVITY_FULL, 1.0f);
        }
    }
}

void ris__muscle_constrain(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const bool literal = (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    memset(rig->drag, 0, 2 * (size_t)model->muscle_count * sizeof *rig->drag);
    for (uint32_t g = 0; g < model->group_count; ++g) {
        resolve(rig, &model->group[g], literal);
    }
}
