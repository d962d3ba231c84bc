/* KA-28 constraint groups. The thesis intersects segment shapes, and so does the kaehler tissue (shape_groups.c). In the
 * default tissue the groups are the corners of the mouth, all else being blended by weights: sphincter ends and the
 * ends of muscles with a lip drag join when the distance of their muscle-level points is below the sum of half the
 * larger of thickness and width, plus 6 mm. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define REACH_MM 6.0f

typedef struct end_point {
    uint32_t muscle, point;
} end_point;

static bool is_end(const ris_muscle *muscle, uint32_t point)
{
    return point + 1 == muscle->point_count || (muscle->kind == RIS_MUSCLE_SPHINCTER && point == 0);
}

/* Half extent across the fibres at an end, from the author's grid: refinement must not change who joins whom. */
static float half_extent(const ris_muscle *muscle, uint32_t point)
{
    const ris_muscle_def *def = muscle->def;
    const ris_vec3 *row = def->grid + (point == 0 ? 0 : (def->rows - 2) * def->columns);
    float width = 0.0f;
    for (uint32_t c = 0; c + 1 < def->columns; ++c) {
        const ris_vec3 *next = row + def->columns;
        width += 0.5f * (v3_distance(row[c + 1], row[c]) + v3_distance(next[c + 1], next[c]));
    }
    return 0.5f * f_max(width, 0.5f * (def->thickness_mm[0] + def->thickness_mm[1]));
}

static uint32_t root_of(const uint32_t *parent, uint32_t k)
{
    while (parent[k] != k) {
        k = parent[k];
    }
    return k;
}

/* Candidates of the bake; the count is returned, list may be NULL to count only. */
static uint32_t list_candidates(const ris_bake *bake, end_point *list)
{
    const ris_model *model = bake->model;
    uint32_t count = 0;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        for (uint32_t i = 0; i < muscle->point_count; ++i) {
            if (!is_end(muscle, i) ||
                !(muscle->kind == RIS_MUSCLE_SPHINCTER || muscle->lip_drag_power > 0.0f)) {
                continue;
            }
            if (list) {
                list[count] = (end_point){m, i};
            }
            ++count;
        }
    }
    return count;
}

/* Joins ends to the closest near point of every other muscle. linked marks the points that take part. */
static void join(const ris_model *model, const end_point *list, uint32_t count, uint32_t *parent,
                 bool *linked)
{
    for (uint32_t a = 0; a < count; ++a) {
        const ris_muscle *ma = &model->muscle[list[a].muscle];
        const ris_vec3 pa = ris__muscle_point(model, ma, model->fiber_point, list[a].point);
        const float reach = half_extent(ma, list[a].point) + REACH_MM;
        for (uint32_t b = 0; b < count;) {
            uint32_t muscle = list[b].muscle, closest = UINT32_MAX;
            float best = INFINITY;
            for (; b < count && list[b].muscle == muscle; ++b) {
                const ris_muscle *mb = &model->muscle[muscle];
                float d = v3_distance(pa, ris__muscle_point(model, mb, model->fiber_point, list[b].point));
                if (muscle != list[a].muscle && d < reach + half_extent(mb, list[b].point) && d < best) {
                    best = d;
                    closest = b;
                }
            }
            if (closest != UINT32_MAX) {
                linked[a] = linked[closest] = true;
                parent[root_of(parent, closest)] = root_of(parent, a);
            }
        }
    }
}

void ris__measure_group(ris_model *model, const ris_group *group)
{
    ris_group_point *point = model->group_point + group->first_point;
    ris_vec3 sum = {0};
    for (uint32_t k = 0; k < group->point_count; ++k) {
        sum = v3_add(sum, ris__muscle_point(model, &model->muscle[point[k].muscle], model->fiber_point,
                                            point[k].point));
    }
    const ris_vec3 centroid = v3_scale(sum, 1.0f / (float)group->point_count);
    for (uint32_t k = 0; k < group->point_count; ++k) {
        const ris_vec3 p =
            ris__muscle_point(model, &model->muscle[point[k].muscle], model->fiber_point, point[k].point);
        point[k].rest_distance_mm = v3_distance(p, centroid);
    }
}

static ris_result fill_groups(ris_model *model, const end_point *list, uint32_t count, const uint32_t *parent,
                              const bool *linked, ris_error *err)
{
    ris_result result =
        ris__model_alloc(&model->group, count, sizeof *model->group, "constraint groups", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->group_point, count, sizeof *model->group_point, "constraint groups",
                                  err);
    }
    for (uint32_t root = 0; result == RIS_OK && root < count; ++root) {
        ris_group group = {model->group_point_count, 0};
        for (uint32_t k = 0; k < count; ++k) {
            if (linked[k] && root_of(parent, k) == root) {
                ris_group_point *point = &model->group_point[model->group_point_count++];
                point->muscle = list[k].muscle;
                point->point = list[k].point;
                ++group.point_count;
            }
        }
        if (group.point_count == 0) {
            continue;
        }
        if (group.point_count > RIS_GROUP_MAX) {
            return ris_fail(err, RIS_ERROR_DATA, "%u muscle ends meet near muscle %s, at most %d can",
                            group.point_count,
                            model->muscle[model->group_point[group.first_point].muscle].name, RIS_GROUP_MAX);
        }
        ris__measure_group(model, &group);
        model->group[model->group_count++] = group;
    }
    return result;
}

ris_result ris__bake_groups(ris_bake *bake, ris_error *err)
{
    if (bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return ris__bake_shape_groups(bake, err);
    }
    const uint32_t count = list_candidates(bake, NULL);
    end_point *list = NULL;
    uint32_t *parent = NULL;
    bool *linked = NULL;
    ris_result result = ris__model_alloc(&list, count, sizeof *list, "constraint groups", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&parent, count, sizeof *parent, "constraint groups", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&linked, count, sizeof *linked, "constraint groups", err);
    }
    if (result == RIS_OK) {
        list_candidates(bake, list);
        for (uint32_t k = 0; k < count; ++k) {
            parent[k] = k;
        }
        join(bake->model, list, count, parent, linked);
        result = fill_groups(bake->model, list, count, parent, linked, err);
    }
    free(list);
    free(parent);
    free(linked);
    return result;
}
