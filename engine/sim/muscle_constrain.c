/* muscle_constrain: KA-33 geometric resolution of the constraint groups, literal in the kaehler tissue, where
 * the muscle network follows (KA-34, muscle_network.c). In
 * the default tissue the groups are the corners of the mouth: the corner's displacement is the weighted
 * mean of its members', which follow it along their whole length, and it drags the lips along the
 * orbicularis oris (group displacement x t^p) in place of the straightening of KA-35, which pulls lips
 * flat. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <string.h>

#define ACTIVITY_FULL 0.1f
#define LARGEST_POWER 64.0f /* of lip_drag_power in muscles.json */

ris_vec3 ris__resolve_group(uint32_t n, const float *contraction, const float *rest_distance_mm,
                            const ris_vec3 *rest, float lambda, ris_vec3 *point)
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
    power = f_clamp(power, 0.0f, LARGEST_POWER);
    const uint32_t whole = (uint32_t)power;
    float result = 1.0f;
    for (uint32_t k = 0; k < whole; ++k) {
        result *= t;
    }
    return result + (power - (float)whole) * (result * t - result);
}

void ris__displace_point(ris_rig *rig, uint32_t m, uint32_t point, ris_vec3 delta)
{
    const ris_muscle *muscle = &rig->model->muscle[m];
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        ris_vec3 *q = &rig->q[rig->model->fiber[muscle->first_fiber + f].first_point + point];
        *q = v3_add(*q, delta);
    }
}

/* Moves a whole muscle in proportion to the arc length from its fixed end. */
static void displace_muscle(ris_rig *rig, uint32_t m, ris_vec3 delta)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[m];
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
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

/* kaehler tissue: KA-33 as it stands. */
static void resolve_literal(ris_rig *rig, const ris_group *group)
{
    const ris_model *model = rig->model;
    const ris_group_point *member = model->group_point + group->first_point;
    float contraction[RIS_GROUP_MAX] = {0}, distance[RIS_GROUP_MAX] = {0};
    ris_vec3 rest[RIS_GROUP_MAX] = {{0}}, before[RIS_GROUP_MAX] = {{0}}, after[RIS_GROUP_MAX] = {{0}};
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const ris_muscle *muscle = &model->muscle[member[k].muscle];
        contraction[k] = rig->contraction[member[k].muscle];
        distance[k] = member[k].rest_distance_mm;
        rest[k] = ris__muscle_point(model, muscle, model->fiber_point, member[k].point);
        before[k] = after[k] = ris__muscle_point(model, muscle, rig->q, member[k].point);
    }
    ris__resolve_group(group->point_count, contraction, distance, rest, model->head->tissue.constraint_lambda,
                       after);
    for (uint32_t k = 0; k < group->point_count; ++k) {
        ris__displace_point(rig, member[k].muscle, member[k].point, v3_sub(after[k], before[k]));
    }
}

/* How far the end of a member of a corner has moved, and the end of a ring that lies there. */
static ris_vec3 moved_by(const ris_rig *rig, const ris_group_point *member)
{
    const ris_muscle *muscle = &rig->model->muscle[member->muscle];
    return v3_sub(ris__muscle_point(rig->model, muscle, rig->q, member->point),
                  ris__muscle_point(rig->model, muscle, rig->p, member->point));
}

static ris_drag *drag_of(ris_rig *rig, const ris_group_point *member)
{
    return &rig->drag[2 * (size_t)member->muscle + (member->point > 0)];
}

/* Farthest way along side that a linear muscle of a corner would move it by itself, or 0. */
static float pulled_by(const ris_rig *rig, const ris_group *group, ris_vec3 side)
{
    float farthest = 0.0f;
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const ris_group_point *member = &rig->model->group_point[group->first_point + k];
        if (rig->model->muscle[member->muscle].kind == RIS_MUSCLE_LINEAR) {
            farthest = f_max(farthest, v3_dot(side, moved_by(rig, member)));
        }
    }
    return farthest;
}

/* Default tissue: the corner moves by the mean displacement of its members, weighted with 1 + lambda x
 * activation (activation, not contraction, because contractions end at max_shortening, far below 1). */
static ris_corner measure_corner(ris_rig *rig, const ris_group *group)
{
    const ris_model *model = rig->model;
    const ris_group_point *member = model->group_point + group->first_point;
    const float lambda = model->head->tissue.constraint_lambda;
    ris_vec3 sum = {0};
    float weight = 0.0f, pulling = 0.0f, power = 0.0f;
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const ris_muscle *muscle = &model->muscle[member[k].muscle];
        const float activation = rig->activation[member[k].muscle], w = 1.0f + lambda * activation;
        sum = v3_mad(sum, w, moved_by(rig, &member[k]));
        weight += w;
        if (muscle->lip_drag_power > 0.0f) {
            pulling += activation;
            power += activation * muscle->lip_drag_power;
        }
    }
    if (!(pulling > 0.0f)) {
        return (ris_corner){{0}, 0.0f, 0.0f, 0.0f};
    }
    ris_corner corner = {v3(sum.x / weight, sum.y / weight, sum.z / weight), 0.0f, power / pulling,
                         f_min(pulling / ACTIVITY_FULL, 1.0f)};
    for (uint32_t k = 0; k < group->point_count; ++k) {
        if (model->muscle[member[k].muscle].kind == RIS_MUSCLE_SPHINCTER) {
            const ris_vec3 side = ris__ring_side(model, &model->muscle[member[k].muscle]);
            corner.outward = pulled_by(rig, group, member[k].point > 0 ? side : v3_scale(side, -1.0f));
            drag_of(rig, &member[k])->corner = corner;
        }
    }
    return corner;
}

/* A ring that contracts while muscles hold one of its corners draws to that corner, not to its middle: all of it, and so
 * both corners, goes the way of the farthest pull outwards, as far as the ring is taut. Pulls of both sides cancel: a
 * corner that is pulled back, were it half as far, holds the ring where it is. */
static ris_vec3 carried_along(const ris_rig *rig, uint32_t m)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[m];
    const ris_drag *drag = &rig->drag[2 * (size_t)m];
    const ris_vec3 side = ris__ring_side(model, muscle);
    const float taut = muscle->max_shortening > 0.0f ? rig->contraction[m] / muscle->max_shortening : 0.0f;
    const float left = drag[1].corner.outward, right = drag[0].corner.outward, most = f_max(left, right);
    if (!(most > 0.0f)) {
        return v3(0.0f, 0.0f, 0.0f);
    }
    const float free = (left - right) / most; /* 0.5 where one corner pulls half as far as the other */
    return v3_scale(side, taut * (left - right) * (free * free * free * free));
}

/* Of a corner: the mean of its rings. */
static ris_vec3 carried_by(const ris_rig *rig, const ris_group *group)
{
    ris_vec3 sum = {0};
    float rings = 0.0f;
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const uint32_t m = rig->model->group_point[group->first_point + k].muscle;
        if (rig->model->muscle[m].kind == RIS_MUSCLE_SPHINCTER) {
            sum = v3_add(sum, carried_along(rig, m));
            rings += 1.0f;
        }
    }
    return v3_scale(sum, rings > 0.0f ? 1.0f / rings : 0.0f);
}

static void resolve_corner(ris_rig *rig, const ris_group *group, ris_corner corner)
{
    const ris_model *model = rig->model;
    const ris_group_point *member = model->group_point + group->first_point;
    if (!(corner.strength > 0.0f)) {
        return;
    }
    const ris_vec3 carried = carried_by(rig, group);
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const ris_vec3 lacks = v3_sub(corner.moved, moved_by(rig, &member[k]));
        if (model->muscle[member[k].muscle].kind == RIS_MUSCLE_LINEAR) {
            displace_muscle(rig, member[k].muscle, v3_add(lacks, carried));
            continue;
        }
        ris_drag *drag = drag_of(rig, &member[k]);
        drag->displacement = lacks;
        drag->carried = carried;
    }
}

/* The ends of a ring go where their corners are, the points between them by t^p. */
static void drag_ring(ris_rig *rig, uint32_t m)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[m];
    const ris_drag *drag = rig->drag + 2 * (size_t)m;
    const ris_vec3 carried = v3_scale(v3_add(drag[0].carried, drag[1].carried), 0.5f);
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
        float total = 0.0f, length = 0.0f;
        for (uint32_t i = 1; i < muscle->point_count; ++i) {
            total += v3_distance(rig->p[first + i], rig->p[first + i - 1]);
        }
        for (uint32_t i = 0; i < muscle->point_count; ++i) {
            length += i > 0 ? v3_distance(rig->p[first + i], rig->p[first + i - 1]) : 0.0f;
            const float along = 2.0f * length / total - 1.0f;
            const ris_drag *end = drag + (along > 0.0f);
            const float t = f_min(along > 0.0f ? along : -along, 1.0f);
            ris_vec3 *q = &rig->q[first + i];
            *q = v3_mad(*q, end->corner.strength * ris__power(t, end->corner.power), end->displacement);
            *q = v3_add(*q, carried);
        }
    }
}

/* False in the neutral pose, whose bits are to be left alone. */
static bool anything_acts(const ris_rig *rig)
{
    bool acting = !rig->jaw.identity;
    for (uint32_t m = 0; m < rig->model->muscle_count; ++m) {
        acting = acting || rig->contraction[m] > 0.0f;
    }
    return acting;
}

static void constrain_literal(ris_rig *rig)
{
    if (!anything_acts(rig)) {
        return;
    }
    ris__network_measure(rig);
    for (uint32_t g = 0; g < rig->model->group_count; ++g) {
        resolve_literal(rig, &rig->model->group[g]);
    }
    ris__network_apply(rig);
}

void ris__muscle_constrain(ris_rig *rig)
{
    const ris_model *model = rig->model;
    memset(rig->drag, 0, 2 * (size_t)model->muscle_count * sizeof *rig->drag);
    if (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) {
        constrain_literal(rig);
        return;
    }
    for (uint32_t g = 0; g < model->group_count; ++g) {
        rig->corner[g] = measure_corner(rig, &model->group[g]);
    }
    for (uint32_t g = 0; g < model->group_count; ++g) {
        resolve_corner(rig, &model->group[g], rig->corner[g]);
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        if (model->muscle[m].kind == RIS_MUSCLE_SPHINCTER &&
            (rig->drag[2 * (size_t)m].corner.strength > 0.0f ||
             rig->drag[2 * (size_t)m + 1].corner.strength > 0.0f)) {
            drag_ring(rig, m);
        }
    }
}
