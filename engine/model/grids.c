/* KA-38 grid initialisation (without refinement, KA-39): a muscle's grid is projected on the skin and sunk
 * to the middle of the muscle layer, skin_mm + (min + max) / 4 below it. A grid point that lies deeper
 * than that keeps its place, as the control points of KA-39 do: real muscles dive below fat on their way
 * to the bone. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define FACING                                                                                               \
    0.3f /* a triangle belongs to the skin over the grid if the cosine of the normals exceeds this */
#define FARTHEST_MM 40.0f /* a grid point this far from the skin is a mistake */

/* Closest point of a triangle (Ericson, Real-Time Collision Detection 5.1.5). */
static ris_vec3 closest_on_triangle(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c)
{
    ris_vec3 ab = v3_sub(b, a), ac = v3_sub(c, a), ap = v3_sub(p, a);
    float d1 = v3_dot(ab, ap), d2 = v3_dot(ac, ap);
    if (d1 <= 0.0f && d2 <= 0.0f) {
        return a;
    }
    ris_vec3 bp = v3_sub(p, b);
    float d3 = v3_dot(ab, bp), d4 = v3_dot(ac, bp);
    if (d3 >= 0.0f && d4 <= d3) {
        return b;
    }
    float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
        return v3_mad(a, d1 / (d1 - d3), ab);
    }
    ris_vec3 cp = v3_sub(p, c);
    float d5 = v3_dot(ab, cp), d6 = v3_dot(ac, cp);
    if (d6 >= 0.0f && d5 <= d6) {
        return c;
    }
    float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
        return v3_mad(a, d2 / (d2 - d6), ac);
    }
    float va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
        return v3_mad(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), v3_sub(c, b));
    }
    float sum = va + vb + vc;
    return v3_mad(v3_mad(a, vb / sum, ab), vc / sum, ac);
}

/* Nearest skin point whose triangle faces along normal; false if none within FARTHEST_MM. */
static bool project_on_skin(const ris_bake *bake, ris_vec3 p, ris_vec3 normal, ris_vec3 *out)
{
    const ris_model *model = bake->model;
    const ris_vec3 *position = bake->head->skin.position;
    float best = FARTHEST_MM * FARTHEST_MM;
    bool found = false;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        ris_vec3 a = position[v[0]], b = position[v[1]], c = position[v[2]];
        ris_vec3 low =
            v3(f_min(a.x, f_min(b.x, c.x)), f_min(a.y, f_min(b.y, c.y)), f_min(a.z, f_min(b.z, c.z)));
        ris_vec3 high =
            v3(f_max(a.x, f_max(b.x, c.x)), f_max(a.y, f_max(b.y, c.y)), f_max(a.z, f_max(b.z, c.z)));
        ris_vec3 gap =
            v3(f_max(f_max(low.x - p.x, p.x - high.x), 0.0f), f_max(f_max(low.y - p.y, p.y - high.y), 0.0f),
               f_max(f_max(low.z - p.z, p.z - high.z), 0.0f));
        if (!(v3_dot(gap, gap) < best)) {
            continue;
        }
        ris_vec3 cross = v3_cross(v3_sub(b, a), v3_sub(c, a));
        if (v3_dot(cross, normal) < FACING * v3_length(cross)) {
            continue;
        }
        ris_vec3 q = closest_on_triangle(p, a, b, c), d = v3_sub(q, p);
        if (v3_dot(d, d) < best) {
            best = v3_dot(d, d);
            *out = q;
            found = true;
        }
    }
    return found;
}

static ris_vec3 nearest_skin_normal(const ris_bake *bake, ris_vec3 p)
{
    uint32_t nearest = 0;
    float best = INFINITY;
    for (uint32_t i = 0; i < bake->model->node_count; ++i) {
        ris_vec3 d = v3_sub(bake->head->skin.position[i], p);
        if (v3_dot(d, d) < best) {
            best = v3_dot(d, d);
            nearest = i;
        }
    }
    return v4_xyz(bake->model->rest_normal[nearest]);
}

/* Balanced plane of each cell (cross of the diagonals), averaged over the cells at a grid point, outwards. */
static void grid_normals(const ris_bake *bake, const ris_muscle_def *def, ris_vec3 *normal)
{
    const uint32_t columns = def->columns;
    for (uint32_t r = 0; r + 1 < def->rows; ++r) {
        for (uint32_t c = 0; c + 1 < columns; ++c) {
            uint32_t a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
            ris_vec3 cross = v3_cross(v3_sub(def->grid[e], def->grid[a]), v3_sub(def->grid[d], def->grid[b]));
            ris_vec3 unit = v3_unit_or(cross, v3(0.0f, 0.0f, 0.0f));
            normal[a] = v3_add(normal[a], unit);
            normal[b] = v3_add(normal[b], unit);
            normal[d] = v3_add(normal[d], unit);
            normal[e] = v3_add(normal[e], unit);
        }
    }
    float vote = 0.0f;
    for (uint32_t k = 0; k < def->rows * columns; ++k) {
        vote += v3_dot(normal[k], nearest_skin_normal(bake, def->grid[k]));
    }
    for (uint32_t k = 0; k < def->rows * columns; ++k) {
        normal[k] = v3_scale(v3_unit_or(normal[k], v3(0.0f, 0.0f, 0.0f)), vote < 0.0f ? -1.0f : 1.0f);
    }
}

static ris_result check_def(const ris_muscle_def *def, ris_error *err)
{
    if (def->rows < 2 || def->columns < 2 || def->rows > 1000 || def->columns > 1000) {
        return ris_fail(err, RIS_ERROR_DATA,
                        "muscle %s has a grid of %u x %u points, expected 2..1000 rows and columns",
                        def->name, def->rows, def->columns);
    }
    if (!(def->max_shortening >= 0.0f && def->max_shortening <= 0.95f)) {
        return ris_fail(err, RIS_ERROR_DATA, "muscle %s: max_shortening is %g, expected 0..0.95", def->name,
                        (double)def->max_shortening);
    }
    if (!(def->thickness_mm[0] > 0.0f && def->thickness_mm[1] >= def->thickness_mm[0])) {
        return ris_fail(err, RIS_ERROR_DATA, "muscle %s: thickness is %g..%g mm, expected 0 < min <= max",
                        def->name, (double)def->thickness_mm[0], (double)def->thickness_mm[1]);
    }
    return RIS_OK;
}

static ris_result sink_grid(ris_bake *bake, uint32_t m, ris_error *err)
{
    const ris_muscle_def *def = &bake->head->muscle[m];
    ris_vec3 *point = bake->grid_point + bake->grid_first[m],
             *normal = bake->grid_normal + bake->grid_first[m];
    const float depth = bake->head->tissue.skin_mm + (def->thickness_mm[0] + def->thickness_mm[1]) / 4.0f;
    grid_normals(bake, def, normal);
    uint32_t row = 0, column = 0;
    for (uint32_t k = 0; k < def->rows * def->columns; ++k) {
        ris_vec3 on_skin = {0};
        if (!project_on_skin(bake, def->grid[k], normal[k], &on_skin)) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "muscle %s: grid row %u, column %u has no skin within %g mm that faces it",
                            def->name, row, column, (double)FARTHEST_MM);
        }
        column = column + 1 < def->columns ? column + 1 : 0;
        row += column == 0;
        const float own = v3_dot(v3_sub(on_skin, def->grid[k]), normal[k]);
        point[k] = own > depth ? def->grid[k] : v3_mad(on_skin, -depth, normal[k]);
        bake->grid_depth[bake->grid_first[m] + k] = f_max(own, depth);
    }
    return RIS_OK;
}

ris_result ris__bake_grids(ris_bake *bake, ris_error *err)
{
    const ris_head *head = bake->head;
    ris_result result = ris__model_alloc(&bake->grid_first, (size_t)head->muscle_count + 1,
                                         sizeof *bake->grid_first, "muscle grids", err);
    uint32_t total = 0;
    for (uint32_t m = 0; result == RIS_OK && m < head->muscle_count; ++m) {
        result = check_def(&head->muscle[m], err);
        bake->grid_first[m] = total;
        total += head->muscle[m].rows * head->muscle[m].columns;
        bake->grid_first[m + 1] = total;
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->grid_point, total, sizeof *bake->grid_point, "muscle grids", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->grid_normal, total, sizeof *bake->grid_normal, "muscle grids", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->grid_depth, total, sizeof *bake->grid_depth, "muscle grids", err);
    }
    for (uint32_t m = 0; result == RIS_OK && m < head->muscle_count; ++m) {
        result = sink_grid(bake, m, err);
    }
    return result;
}
