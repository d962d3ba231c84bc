/* lid_unfold, the end of lid_pose: no triangle of a lid turns over. Where the lids run together in the corners of the
 * eye, triangles of half a millimetre lie between nodes that turn and nodes that stay, and what muscles do comes on top. So
 * a triangle keeps its side, seen along its rest normal turned with the lid, and a share of its area, seen along the mean
 * normal of the triangles around it; if it lacks any, it pushes its nodes apart across that direction. All at once from
 * the places before, so that left and right mirror each other. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <string.h>

#define MARGIN_GIVES 0.25f /* of what other nodes give way: lids must still meet */
#define CORNER_GIVES 0.4f  /* and the corners of the eye must stay */
#define SHARE 0.4f         /* of what is missing, a pass: a node has several triangles */
#define PASSES 40
#define ENOUGH_MM2 1e-4f /* missing area that nobody sees, twice */

static ris_vec3 corner(const ris_rig *rig, const ris_lid_triangle *t, int k)
{
    return rig->target[t->node[k]];
}

static ris_vec3 cross_of(const ris_rig *rig, const ris_lid_triangle *t)
{
    const ris_vec3 a = corner(rig, t, 0);
    return v3_cross(v3_sub(corner(rig, t, 1), a), v3_sub(corner(rig, t, 2), a));
}

/* The rest normal turned as the nodes of the lid turn. */
static ris_vec3 turned_normal(const ris_rig *rig, const ris_lid_triangle *t)
{
    float cosine = 0.0f, sine = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const bool turns = t->lid[k] != UINT32_MAX;
        cosine += turns ? rig->lid_turn[t->lid[k]].cosine : 1.0f;
        sine += turns ? rig->lid_turn[t->lid[k]].sine : 0.0f;
    }
    const float l = sqrtf(cosine * cosine + sine * sine);
    cosine /= l;
    sine /= l;
    const ris_vec3 n = t->normal;
    return v3(n.x, cosine * n.y + sine * n.z, cosine * n.z - sine * n.y);
}

static ris_vec3 mean_normal(const ris_rig *rig, const ris_lid_triangle *t)
{
    ris_vec3 sum = v3(0.0f, 0.0f, 0.0f);
    for (uint32_t k = t->around_first; k < t->around_end; ++k) {
        sum = v3_add(sum, rig->lid_cross[rig->model->lid_around[k]]);
    }
    return v3_unit_or(sum, t->normal);
}

/* How readily a node gives way. */
static float mobility(const ris_model *model, uint32_t lid)
{
    if (lid == UINT32_MAX) {
        return 0.0f;
    }
    const ris_lid_node *node = &model->lid[lid];
    return node->margin ? MARGIN_GIVES : node->share > 0.0f || node->lining ? 1.0f : CORNER_GIVES;
}

/* Adds to lid_push what the triangle lacks seen along n; false if it lacks nothing. */
static bool push_apart(ris_rig *rig, const ris_lid_triangle *t, ris_vec3 cross, ris_vec3 n, float least)
{
    const float missing = least * t->rest_mm2 - v3_dot(n, cross);
    if (!(missing > ENOUGH_MM2)) {
        return false;
    }
    const ris_vec3 a = corner(rig, t, 0), b = corner(rig, t, 1), c = corner(rig, t, 2);
    const ris_vec3 slope[3] = {v3_cross(v3_sub(b, c), n), v3_cross(v3_sub(c, a), n),
                               v3_cross(v3_sub(a, b), n)};
    float mobile[3], square = 0.0f;
    for (int k = 0; k < 3; ++k) {
        mobile[k] = mobility(rig->model, t->lid[k]);
        square += mobile[k] * v3_dot(slope[k], slope[k]);
    }
    for (int k = 0; k < 3 && square > 0.0f; ++k) {
        if (t->lid[k] != UINT32_MAX) {
            ris_vec3 *push = &rig->lid_push[t->lid[k]];
            *push = v3_mad(*push, SHARE * missing * mobile[k] / square, slope[k]);
        }
    }
    return square > 0.0f;
}

/* Returns whether a node of the triangle gave way in the last pass. */
static bool has_moved(const ris_rig *rig, const ris_lid_triangle *t)
{
    bool moved = false;
    for (int k = 0; k < 3; ++k) {
        moved = moved || (t->lid[k] != UINT32_MAX && rig->lid_moved[t->lid[k]]);
    }
    return moved;
}

static void move_nodes(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        const ris_vec3 push = rig->lid_push[k];
        rig->lid_moved[k] = push.x != 0.0f || push.y != 0.0f || push.z != 0.0f;
        if (rig->lid_moved[k]) {
            const uint32_t i = model->lid[k].node;
            rig->target[i] = v3_add(rig->target[i], push);
            rig->delta[i] = v4_from(v3_add(v4_xyz(rig->delta[i]), push), 0.0f);
            rig->point[i].a = v4_from(rig->target[i], 0.0f);
            rig->lid_push[k] = v3(0.0f, 0.0f, 0.0f);
        }
    }
}

/* Triangles that moved, or that see one that moved, must be looked at again; others lack nothing still. */
static void wake(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t t = 0; t < model->lid_triangle_count; ++t) {
        const ris_lid_triangle *triangle = &model->lid_triangle[t];
        if (has_moved(rig, triangle)) {
            rig->lid_cross[t] = cross_of(rig, triangle);
            rig->lid_awake[t] = true;
            for (uint32_t k = triangle->around_first; k < triangle->around_end; ++k) {
                rig->lid_awake[model->lid_around[k]] = true;
            }
        }
    }
}

void ris__lid_unfold(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t t = 0; t < model->lid_triangle_count; ++t) {
        rig->lid_cross[t] = cross_of(rig, &model->lid_triangle[t]);
        rig->lid_awake[t] = true;
    }
    bool some = true;
    for (int pass = 0; pass < PASSES && some; ++pass) {
        some = false;
        for (uint32_t k = 0; k < model->lid_triangle_count; ++k) {
            const ris_lid_triangle *t = &model->lid_triangle[k];
            if (rig->lid_awake[k]) {
                bool lacks = push_apart(rig, t, rig->lid_cross[k], turned_normal(rig, t), 0.0f);
                lacks = push_apart(rig, t, rig->lid_cross[k], mean_normal(rig, t), t->keeps) || lacks;
                rig->lid_awake[k] = lacks;
                some = some || lacks;
            }
        }
        move_nodes(rig);
        wake(rig);
    }
}
