/* KA-28 constraint groups as the thesis finds them, for the kaehler tissue: end segments whose shapes (KA-26) intersect
 * segments of other muscles; what hangs together is a group, and of each pair of segments the closest end points are
 * its members. */
#include "model_impl.h"
#include "shapes.h"
#include "vec3.h"

#include <stdlib.h>

#define TENDON_MM                                                                                            \
    4.0f /* a fibre reaches this far beyond its last control point, by tendon into the muscle it ends in */

/* Muscle segment j of muscle m: all fibres' segments j together. */
typedef struct unit {
    uint32_t muscle, segment, first_box, root;
    bool linked;
} unit;

typedef struct union_find {
    const ris_model *model;
    unit *unit;
    ris_box *box; /* of unit u: one per fibre */
    uint32_t unit_count;
} union_find;

/* Muscles between bones meet no other: bones alone hold their ends. */
static bool takes_part(const ris_muscle *muscle)
{
    return muscle->def->end_bone == RIS_BONE_AUTO;
}

static bool is_end(const ris_muscle *muscle, uint32_t segment)
{
    return segment + 2 == muscle->point_count || (muscle->kind == RIS_MUSCLE_SPHINCTER && segment == 0);
}

static uint32_t root_of(const union_find *u, uint32_t k)
{
    while (u->unit[k].root != k) {
        k = u->unit[k].root;
    }
    return k;
}

static bool shapes_meet(const union_find *u, uint32_t a, uint32_t b)
{
    const uint32_t na = u->model->muscle[u->unit[a].muscle].fiber_count,
                   nb = u->model->muscle[u->unit[b].muscle].fiber_count;
    for (uint32_t k = 0; k < na * nb; ++k) {
        if (ris__boxes_meet(&u->box[u->unit[a].first_box + k / nb], &u->box[u->unit[b].first_box + k % nb])) {
            return true;
        }
    }
    return false;
}

/* The last box of a linear muscle, longer by its tendon. */
static void add_tendon(ris_box *box)
{
    const ris_vec3 none = {0};
    for (uint32_t k = 0; k < 8; k += 2) {
        const ris_vec3 along = v3_unit_or(v3_sub(box->corner[k + 1], box->corner[k]), none);
        box->corner[k + 1] = v3_mad(box->corner[k + 1], TENDON_MM, along);
    }
}

/* Lists all muscle segments with the boxes of their fibres. */
static ris_result list_units(union_find *u, ris_error *err)
{
    const ris_model *model = u->model;
    ris_box *chain = NULL;
    uint32_t longest = 0, boxes = 0;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        longest = model->muscle[m].point_count > longest ? model->muscle[m].point_count : longest;
    }
    ris_result result =
        ris__model_alloc(&u->unit, model->segment_count, sizeof *u->unit, "muscle shapes", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&u->box, model->segment_count, sizeof *u->box, "muscle shapes", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&chain, longest, sizeof *chain, "muscle shapes", err);
    }
    for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const uint32_t segments = muscle->point_count - 1;
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            const ris_fiber_pose pose = ris__fiber_at_rest(model, muscle, f);
            ris__fiber_boxes(&pose, chain);
            if (muscle->kind == RIS_MUSCLE_LINEAR) {
                add_tendon(&chain[segments - 1]);
            }
            for (uint32_t s = 0; s < segments; ++s) {
                u->box[boxes + s * muscle->fiber_count + f] = chain[s];
            }
        }
        for (uint32_t s = 0; s < segments; ++s) {
            u->unit[u->unit_count] = (unit){m, s, boxes + s * muscle->fiber_count, u->unit_count, false};
            ++u->unit_count;
        }
        boxes += segments * muscle->fiber_count;
    }
    free(chain);
    return result;
}

static void link_units(union_find *u)
{
    for (uint32_t a = 0; a < u->unit_count; ++a) {
        const ris_muscle *muscle = &u->model->muscle[u->unit[a].muscle];
        if (!takes_part(muscle) || !is_end(muscle, u->unit[a].segment)) {
            continue;
        }
        for (uint32_t b = 0; b < u->unit_count; ++b) {
            if (u->unit[b].muscle != u->unit[a].muscle && takes_part(&u->model->muscle[u->unit[b].muscle]) &&
                shapes_meet(u, a, b)) {
                u->unit[a].linked = u->unit[b].linked = true;
                u->unit[root_of(u, b)].root = root_of(u, a);
            }
        }
    }
}

/* Adds a member once. */
static ris_result add_point(ris_model *model, ris_group *group, uint32_t muscle, uint32_t point,
                            ris_error *err)
{
    ris_group_point *list = model->group_point + group->first_point;
    for (uint32_t k = 0; k < group->point_count; ++k) {
        if (list[k].muscle == muscle && list[k].point == point) {
            return RIS_OK;
        }
    }
    if (group->point_count == RIS_GROUP_MAX) {
        return ris_fail(err, RIS_ERROR_DATA, "more than %d muscle ends meet near muscle %s", RIS_GROUP_MAX,
                        model->muscle[muscle].name);
    }
    list[group->point_count++] = (ris_group_point){.muscle = muscle, .point = point};
    ++model->group_point_count;
    return RIS_OK;
}

/* The closest end points of two segments become members. */
static ris_result add_pair(ris_model *model, ris_group *group, const unit *a, const unit *b, ris_error *err)
{
    float best = INFINITY;
    uint32_t closest = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const ris_vec3 p =
            ris__muscle_point(model, &model->muscle[a->muscle], model->fiber_point, a->segment + k / 2);
        const ris_vec3 q =
            ris__muscle_point(model, &model->muscle[b->muscle], model->fiber_point, b->segment + k % 2);
        if (v3_distance(p, q) < best) {
            best = v3_distance(p, q);
            closest = k;
        }
    }
    ris_result result = add_point(model, group, a->muscle, a->segment + closest / 2, err);
    return result == RIS_OK ? add_point(model, group, b->muscle, b->segment + closest % 2, err) : result;
}

static ris_result fill_group(const union_find *u, ris_model *model, uint32_t root, ris_error *err)
{
    ris_group group = {model->group_point_count, 0};
    for (uint32_t a = 0; a < u->unit_count; ++a) {
        for (uint32_t b = a + 1; b < u->unit_count && u->unit[a].linked && root_of(u, a) == root; ++b) {
            if (u->unit[b].linked && u->unit[a].muscle != u->unit[b].muscle && root_of(u, b) == root) {
                ris_result result = add_pair(model, &group, &u->unit[a], &u->unit[b], err);
                if (result != RIS_OK) {
                    return result;
                }
            }
        }
    }
    if (group.point_count > 0) {
        ris__measure_group(model, &group);
        model->group[model->group_count++] = group;
    }
    return RIS_OK;
}

ris_result ris__bake_shape_groups(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    union_find u = {.model = model};
    ris_result result = list_units(&u, err);
    if (result == RIS_OK) {
        link_units(&u);
        result =
            ris__model_alloc(&model->group, u.unit_count, sizeof *model->group, "constraint groups", err);
    }
    if (result ==
        RIS_OK) { /* a segment is in one group and gives it both ends at most; add_point needs room to look */
        result = ris__model_alloc(&model->group_point, 2 * (size_t)u.unit_count, sizeof *model->group_point,
                                  "constraint groups", err);
    }
    for (uint32_t root = 0; result == RIS_OK && root < u.unit_count; ++root) {
        result = u.unit[root].root == root ? fill_group(&u, model, root, err) : RIS_OK;
    }
    free(u.unit);
    free(u.box);
    return result;
}
