/* KA-23 fibres, KA-24 segment frames, KA-27 muscle-level points, KA-37 smallest rotation, KA-40 muscle
 * creation, KA-41 skull or jaw. A fibre lies between two grid columns, a control point midway between the
 * two points of a row. */
#include "model_impl.h"
#include "vec3.h"

#include <string.h>

ris_vec3 ris__segment_point(const ris_segment *segment, ris_vec3 p0, ris_vec3 p1, ris_vec3 a, ris_vec3 b,
                            float bulge, ris_vec3 local)
{
    const ris_vec3 v = v3_sub(p1, p0), w = v3_sub(b, a);
    const float stretch = f_max(v3_length(w) / v3_length(v), 0.01f);
    ris_vec3 offset = v3_scale(segment->along, local.x * segment->size.x * stretch);
    offset = v3_mad(offset, local.y * segment->size.y * bulge, segment->up);
    offset = v3_mad(offset, local.z * segment->size.z, segment->wide);
    const ris_vec3 from = segment->along, to = v3_unit_or(w, segment->along);
    const float cosine = v3_dot(from, to);
    if (cosine < -0.9999f) { /* antiparallel: half a turn about the axis across */
        offset = v3_sub(v3_scale(segment->wide, 2.0f * v3_dot(segment->wide, offset)), offset);
    } else { /* R = I + [k] + [k]^2 / (1 + cos), k = from x to */
        const ris_vec3 k = v3_cross(from, to), once = v3_cross(k, offset), twice = v3_cross(k, once);
        offset = v3_add(offset, v3_mad(once, 1.0f / (1.0f + cosine), twice));
    }
    return v3_add(v3_scale(v3_add(a, b), 0.5f), offset);
}

ris_vec3 ris__muscle_point(const ris_model *model, const ris_muscle *muscle, const ris_vec3 *points,
                           uint32_t point)
{
    ris_vec3 sum = {0};
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        sum = v3_add(sum, points[model->fiber[muscle->first_fiber + f].first_point + point]);
    }
    return v3_scale(sum, 1.0f / (float)muscle->fiber_count);
}

/* KA-41: a ray outward through the skin from each point of a row; the closest vertex of the triangle it meets hangs on
 * the jaw or not. */
static bool hangs_on_jaw(const ris_bake *bake, ris_vec3 p, ris_vec3 normal)
{
    uint32_t triangle = 0;
    if (!(fabsf(ris__depth_along(bake, p, normal, &triangle)) < INFINITY)) {
        const dvec at = dv((double)p.x, (double)p.y, (double)p.z);
        triangle = ris__bvh_closest(&bake->skin_tree, at).triangle;
    }
    const uint32_t *v = bake->model->triangle + 3 * (size_t)triangle;
    uint32_t nearest = v[0];
    for (int k = 1; k < 3; ++k) {
        if (v3_distance(bake->head->skin.position[v[k]], p) <
            v3_distance(bake->head->skin.position[nearest], p)) {
            nearest = v[k];
        }
    }
    return bake->head->jaw_weight[nearest] > 0.5f;
}

/* Majority of the points in a row, then of the rows. */
static bool votes_for_jaw(const ris_bake *bake, const ris_bake_grid *grid)
{
    uint32_t rows_on_jaw = 0;
    for (uint32_t r = 0; r < grid->rows; ++r) {
        uint32_t on_jaw = 0;
        for (uint32_t c = 0; c < grid->columns; ++c) {
            const uint32_t k = r * grid->columns + c;
            on_jaw += hangs_on_jaw(bake, grid->point[k], grid->normal[k]);
        }
        rows_on_jaw += 2 * on_jaw > grid->columns;
    }
    return 2 * rows_on_jaw > grid->rows;
}

static ris_result make_segment(ris_bake *bake, uint32_t m, uint32_t fiber, uint32_t row, ris_segment *out,
                               ris_error *err)
{
    const ris_bake_grid *grid = &bake->grid[m];
    const ris_model *model = bake->model;
    const uint32_t local_fiber = fiber - model->muscle[m].first_fiber;
    const ris_vec3 *p = model->fiber_point + model->fiber[fiber].first_point + row;
    const uint32_t a = row * grid->columns + local_fiber, b = a + grid->columns;
    ris_vec3 up =
        v3_add(v3_add(grid->normal[a], grid->normal[a + 1]), v3_add(grid->normal[b], grid->normal[b + 1]));
    out->origin = v3_scale(v3_add(p[0], p[1]), 0.5f);
    out->size.x = v3_distance(p[1], p[0]);
    out->size.y = grid->thickness[row * (grid->columns - 1) + local_fiber];
    out->size.z = 0.5f * (v3_distance(grid->point[a + 1], grid->point[a]) +
                          v3_distance(grid->point[b + 1], grid->point[b]));
    const ris_vec3 none = {0};
    out->along = v3_unit_or(v3_sub(p[1], p[0]), none);
    out->wide = v3_unit_or(v3_cross(out->along, up), none);
    out->up = v3_cross(out->wide, out->along);
    if (!(out->size.x > 1e-3f) || !(out->size.z > 1e-3f) || !(v3_dot(out->wide, out->wide) > 0.5f)) {
        return ris_fail(err, RIS_ERROR_DATA,
                        "muscle %s: the cell at row %u, column %u of its grid is flat or turned on edge",
                        bake->head->muscle[m].name, row, local_fiber);
    }
    return RIS_OK;
}

static ris_result make_muscle(ris_bake *bake, uint32_t m, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_muscle_def *def = &bake->head->muscle[m];
    const ris_bake_grid *grid = &bake->grid[m];
    ris_muscle *muscle = &model->muscle[m];
    memcpy(muscle->name, def->name, sizeof muscle->name);
    muscle->kind = def->kind;
    muscle->on_jaw = def->bone == RIS_BONE_JAW || (def->bone == RIS_BONE_AUTO && votes_for_jaw(bake, grid));
    muscle->fiber_count = grid->columns - 1;
    muscle->point_count = grid->rows;
    muscle->first_fiber = model->fiber_count;
    muscle->max_shortening = def->max_shortening;
    muscle->insertion_start = def->insertion_start;
    muscle->lip_drag_power = def->lip_drag_power;
    muscle->radius_mm = def->radius_mm;
    muscle->gain = def->gain;
    muscle->strength = def->strength > 0.0f ? def->strength : 1.0f;
    muscle->axis[0] = def->axis[0];
    muscle->axis[1] = def->axis[1];
    muscle->def = def;
    if (def->acts_on == RIS_ACTS_ON_LID) {
        muscle->lid_eye = def->name[strlen(def->name) - 1] == 'L' ? 1 : 2;
    }
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        ris_fiber *fiber = &model->fiber[model->fiber_count];
        fiber->first_point = model->fiber_point_count;
        fiber->first_segment = model->segment_count;
        for (uint32_t r = 0; r < grid->rows; ++r) {
            const ris_vec3 *p = grid->point + r * grid->columns + f;
            model->fiber_point[model->fiber_point_count++] = v3_scale(v3_add(p[0], p[1]), 0.5f);
        }
        for (uint32_t r = 0; r + 1 < grid->rows; ++r) {
            ris_result result =
                make_segment(bake, m, model->fiber_count, r, &model->segment[model->segment_count], err);
            if (result != RIS_OK) {
                return result;
            }
            ++model->segment_count;
        }
        ++model->fiber_count;
    }
    return RIS_OK;
}

ris_result ris__bake_muscles(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_head *head = bake->head;
    size_t fibers = 0, points = 0;
    for (uint32_t m = 0; m < head->muscle_count; ++m) {
        fibers += bake->grid[m].columns - 1;
        points += (size_t)(bake->grid[m].columns - 1) * bake->grid[m].rows;
    }
    ris_result result =
        ris__model_alloc(&model->muscle, head->muscle_count, sizeof *model->muscle, "muscles", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->fiber, fibers, sizeof *model->fiber, "fibres", err);
    }
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&model->fiber_point, points, sizeof *model->fiber_point, "fibre points", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->segment, points, sizeof *model->segment, "segments", err);
    }
    for (uint32_t m = 0; result == RIS_OK && m < head->muscle_count; ++m) {
        result = make_muscle(bake, m, err);
        ++model->muscle_count;
    }
    return result;
}
