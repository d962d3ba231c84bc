/* KA-38 grid initialisation: a muscle's grid is projected on the skin and sunk to the middle of the muscle
 * layer, skin_mm + (min + max) / 4 below it, then refined (refine_grid.c). A grid point that lies deeper
 * than that keeps its place, as the control points of KA-39 do: real muscles dive below fat on their way
 * to the bone. The grid of a mirrored muscle is the mirror image of the other side's, so that refinement
 * never decides differently on the two sides. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define FACING                                                                                               \
    0.3f /* a triangle belongs to the skin over the grid if the cosine of the normals exceeds this */
#define FARTHEST_MM 40.0f /* a grid point this far from the skin is a mistake */
#define RAY_STEPS 8       /* triangles that face elsewhere a ray may pass */

static dvec to_double(ris_vec3 p)
{
    return dv((double)p.x, (double)p.y, (double)p.z);
}

static ris_vec3 to_float(dvec p)
{
    return v3((float)p.x, (float)p.y, (float)p.z);
}

static bool faces(const ris_bake *bake, uint32_t triangle, ris_vec3 normal)
{
    return dv_dot(ris__tri_normal(&bake->skin, triangle), to_double(normal)) >= (double)FACING;
}

/* Folds of the lining of the mouth face the cheek from within: no skin that a muscle could lie above. */
static bool in_lining(const ris_bake *bake, uint32_t triangle)
{
    const uint32_t *v = bake->skin.triangle + 3 * (size_t)triangle;
    return bake->lining && bake->lining[v[0]] && bake->lining[v[1]] && bake->lining[v[2]];
}

/* First triangle along direction that faces along normal; its distance, or NAN. */
static double ray_facing(const ris_bake *bake, ris_vec3 p, ris_vec3 direction, ris_vec3 normal,
                         uint32_t *triangle)
{
    double from = -1e-9;
    for (int step = 0; step < RAY_STEPS; ++step) {
        const bvh_hit hit =
            ris__bvh_ray(&bake->skin_tree, to_double(p), to_double(direction), from, (double)FARTHEST_MM);
        if (!hit.found) {
            return NAN;
        }
        const bool down = v3_dot(direction, normal) < 0.0f;
        if (faces(bake, hit.triangle, normal) && !(down && in_lining(bake, hit.triangle))) {
            *triangle = hit.triangle;
            return hit.distance;
        }
        from = hit.distance + 1e-6;
    }
    return NAN;
}

bool ris__project_on_skin(const ris_bake *bake, ris_vec3 p, ris_vec3 normal, ris_vec3 *out)
{
    const bvh_hit hit = ris__bvh_closest_facing(&bake->skin_tree, to_double(p), to_double(normal),
                                                (double)FACING, (double)FARTHEST_MM);
    *out = to_float(hit.at);
    if (hit.found && in_lining(bake, hit.triangle)) { /* straight up, then */
        uint32_t triangle;
        const double up = ray_facing(bake, p, normal, normal, &triangle);
        *out = up < INFINITY ? v3_mad(p, (float)up, normal) : *out;
    }
    return hit.found;
}

float ris__depth_along(const ris_bake *bake, ris_vec3 p, ris_vec3 normal, uint32_t *triangle)
{
    uint32_t hit[2] = {0};
    const double out = ray_facing(bake, p, normal, normal, &hit[0]);
    const double in = ray_facing(bake, p, v3_scale(normal, -1.0f), normal, &hit[1]);
    const bool above = !(out <= in) && in == in; /* nearer, or the only one */
    if (triangle) {
        *triangle = hit[above];
    }
    return (float)(above ? -in : out);
}

/* Of the nearest vertex of the outer skin: deep in the cheek the lining of the mouth, which looks the other way, may be
 * nearer. */
static ris_vec3 skin_normal_near(const ris_bake *bake, ris_vec3 p)
{
    uint32_t nearest = 0;
    float best = INFINITY;
    for (uint32_t i = 0; i < bake->model->node_count; ++i) {
        const ris_vec3 d = v3_sub(bake->head->skin.position[i], p);
        if (v3_dot(d, d) < best && !(bake->lining && bake->lining[i])) {
            best = v3_dot(d, d);
            nearest = i;
        }
    }
    return v4_xyz(bake->model->rest_normal[nearest]);
}

void ris__grid_normals(const ris_bake *bake, const ris_vec3 *point, uint32_t rows, uint32_t columns,
                       ris_vec3 *normal)
{
    memset(normal, 0, (size_t)rows * columns * sizeof *normal);
    for (uint32_t r = 0; r + 1 < rows; ++r) {
        for (uint32_t c = 0; c + 1 < columns; ++c) { /* balanced plane of the cell: cross of its diagonals */
            const uint32_t a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
            const ris_vec3 cross = v3_cross(v3_sub(point[e], point[a]), v3_sub(point[d], point[b]));
            const ris_vec3 unit = v3_unit_or(cross, v3(0.0f, 0.0f, 0.0f));
            normal[a] = v3_add(normal[a], unit);
            normal[b] = v3_add(normal[b], unit);
            normal[d] = v3_add(normal[d], unit);
            normal[e] = v3_add(normal[e], unit);
        }
    }
    float vote = 0.0f;
    for (uint32_t k = 0; k < rows * columns; ++k) {
        vote += v3_dot(normal[k], skin_normal_near(bake, point[k]));
    }
    for (uint32_t k = 0; k < rows * columns; ++k) {
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

ris_result ris__grid_create(uint32_t rows, uint32_t columns, ris_bake_grid *out, ris_error *err)
{
    const size_t points = (size_t)rows * columns;
    *out = (ris_bake_grid){.rows = rows, .columns = columns};
    const struct {
        void *field;
        size_t size;
    } arrays[] = {{&out->point, sizeof *out->point},
                  {&out->normal, sizeof *out->normal},
                  {&out->depth, sizeof *out->depth},
                  {&out->deep, sizeof *out->deep},
                  {&out->thickness, sizeof *out->thickness}};
    ris_result result = RIS_OK;
    for (size_t k = 0; result == RIS_OK && k < sizeof arrays / sizeof arrays[0]; ++k) {
        result = ris__model_alloc(arrays[k].field, points, arrays[k].size, "muscle grids", err);
    }
    if (result != RIS_OK) {
        ris__grid_finish(out);
    }
    return result;
}

void ris__grid_finish(ris_bake_grid *grid)
{
    free(grid->point);
    free(grid->normal);
    free(grid->depth);
    free(grid->deep);
    free(grid->thickness);
    *grid = (ris_bake_grid){0};
}

/* From bone to bone: every point where the author drew it, with its depth for the skin above it. */
static void keep_grid(const ris_bake *bake, const ris_muscle_def *def, ris_bake_grid *grid)
{
    for (uint32_t k = 0; k < def->rows * def->columns; ++k) {
        ris_vec3 on_skin = {0};
        const bool below = ris__project_on_skin(bake, def->grid[k], grid->normal[k], &on_skin);
        grid->deep[k] = true;
        grid->point[k] = def->grid[k];
        grid->depth[k] = below ? v3_distance(on_skin, def->grid[k]) : FARTHEST_MM;
    }
}

static ris_result sink_grid(ris_bake *bake, uint32_t m, ris_error *err)
{
    const ris_muscle_def *def = &bake->head->muscle[m];
    ris_bake_grid *grid = &bake->grid[m];
    ris_result result = ris__grid_create(def->rows, def->columns, grid, err);
    if (result != RIS_OK) {
        return result;
    }
    const float depth = bake->head->tissue.skin_mm + (def->thickness_mm[0] + def->thickness_mm[1]) / 4.0f;
    ris__grid_normals(bake, def->grid, def->rows, def->columns, grid->normal);
    if (def->end_bone != RIS_BONE_AUTO) {
        keep_grid(bake, def, grid);
        return RIS_OK;
    }
    uint32_t row = 0, column = 0;
    for (uint32_t k = 0; k < def->rows * def->columns; ++k) {
        ris_vec3 on_skin = {0};
        if (!ris__project_on_skin(bake, def->grid[k], grid->normal[k], &on_skin)) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "muscle %s: grid row %u, column %u has no skin within %g mm that faces it",
                            def->name, row, column, (double)FARTHEST_MM);
        }
        column = column + 1 < def->columns ? column + 1 : 0;
        row += column == 0;
        const float own = v3_dot(v3_sub(on_skin, def->grid[k]), grid->normal[k]);
        grid->deep[k] = own > depth;
        grid->point[k] = own > depth ? def->grid[k] : v3_mad(on_skin, -depth, grid->normal[k]);
        grid->depth[k] = f_max(own, depth);
    }
    return RIS_OK;
}

/* Point k of a grid in the order of its mirror image: the rows of a linear muscle stay (row 0 is the fixed
 * end) and columns turn round; of a sphincter columns stay (outer to inner) and rows turn round. */
static uint32_t mirrored_index(bool linear, uint32_t rows, uint32_t columns, uint32_t k)
{
    const uint32_t r = k / columns, c = k % columns;
    return linear ? r * columns + columns - 1 - c : (rows - 1 - r) * columns + c;
}

static bool is_mirror(const ris_muscle_def *a, const ris_muscle_def *b)
{
    if (a->kind != b->kind || a->rows != b->rows || a->columns != b->columns ||
        a->thickness_mm[0] != b->thickness_mm[0] || a->thickness_mm[1] != b->thickness_mm[1]) {
        return false;
    }
    for (uint32_t k = 0; k < a->rows * a->columns; ++k) {
        const ris_vec3 p = a->grid[k],
                       q = b->grid[mirrored_index(a->kind == RIS_MUSCLE_LINEAR, a->rows, a->columns, k)];
        if (p.x != -q.x || p.y != q.y || p.z != q.z) {
            return false;
        }
    }
    return true;
}

static ris_result copy_mirrored(bool linear, const ris_bake_grid *from, ris_bake_grid *to, ris_error *err)
{
    ris_result result = ris__grid_create(from->rows, from->columns, to, err);
    for (uint32_t k = 0; result == RIS_OK && k < from->rows * from->columns; ++k) {
        const uint32_t other = mirrored_index(linear, from->rows, from->columns, k);
        const ris_vec3 p = from->point[other], n = from->normal[other];
        to->point[k] = v3(-p.x, p.y, p.z);
        to->normal[k] = v3(-n.x, n.y, n.z);
        to->depth[k] = from->depth[other];
        to->deep[k] = from->deep[other];
    }
    const uint32_t rows = from->rows - 1, columns = from->columns - 1;
    for (uint32_t k = 0; result == RIS_OK && k < rows * columns; ++k) {
        to->thickness[k] = from->thickness[mirrored_index(linear, rows, columns, k)];
    }
    return result;
}

static ris_result bake_skin_tree(ris_bake *bake, ris_error *err)
{
    const ris_model *model = bake->model;
    const size_t corners = 3 * (size_t)model->triangle_count;
    ris_result result =
        ris__model_alloc(&bake->skin.position, model->node_count, sizeof *bake->skin.position, "a tree", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->skin.triangle, corners, sizeof *bake->skin.triangle, "a tree", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    bake->skin.vertex_count = model->node_count;
    bake->skin.triangle_count = model->triangle_count;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        bake->skin.position[i] = to_double(bake->head->skin.position[i]);
    }
    memcpy(bake->skin.triangle, model->triangle, corners * sizeof *model->triangle);
    return ris__bvh_build(&bake->skin_tree, &bake->skin, err);
}

ris_result ris__bake_grids(ris_bake *bake, ris_error *err)
{
    const ris_head *head = bake->head;
    ris_result result = bake_skin_tree(bake, err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->grid, head->muscle_count, sizeof *bake->grid, "muscle grids", err);
    }
    for (uint32_t m = 0; result == RIS_OK && m < head->muscle_count; ++m) {
        uint32_t twin = 0;
        result = check_def(&head->muscle[m], err);
        while (result == RIS_OK && twin < m && !is_mirror(&head->muscle[twin], &head->muscle[m])) {
            ++twin;
        }
        if (result == RIS_OK && twin < m) {
            result = copy_mirrored(head->muscle[m].kind == RIS_MUSCLE_LINEAR, &bake->grid[twin],
                                   &bake->grid[m], err);
            continue;
        }
        if (result == RIS_OK) {
            result = sink_grid(bake, m, err);
        }
        if (result == RIS_OK) {
            result = ris__refine_grid(bake, m, &bake->grid[m], err);
        }
    }
    return result;
}
