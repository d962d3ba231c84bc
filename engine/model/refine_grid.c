/* KA-39 adaptive refinement of a muscle's grid between skin and bone. The grid is the middle of the muscle
 * (errata 12, convention A): its cells may lie skin_mm + min/2 .. skin_mm + max/2 below the skin, and a cell
 * is 2 (d - skin_mm) thick, d its smallest depth. A cell that leaves this range splits its row and its column
 * at the sample that is farthest off; new points are moved along the normal to the depth of KA-38, the author's stay. No
 * piece gets shorter than the skin's triangles over it, so the splitting ends. Cells with a point that the
 * author drew below the layer are the author's own: new points there stay on the cell's plane. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define LEAST_SAMPLES 4         /* along each side of a cell */
#define MOST_SAMPLES 24         /* more tell nothing new */
#define SAMPLES_PER_EXTENT 1.8f /* per side: 3 and a bit per triangle */
#define MOST_LINES 64           /* rows or columns */

/* Where a row or column wants to be split, and how badly. */
typedef struct split {
    float at, error; /* 0 < at < 1, error 0 = not */
    float least;     /* share of the way that the smallest piece must keep, of all cells along the line */
} split;

typedef struct cell_fit {
    float nearest, farthest;     /* depth, mm; negative above the skin */
    float near_at[2], far_at[2]; /* u along the fibre, v across */
    float extent[2];             /* mean extent of the triangles above, mm */
    float length[2];             /* of the cell, mm */
    bool sampled;
} cell_fit;

typedef struct patch {
    ris_vec3 point[4], normal[4]; /* (0,0), (0,1), (1,0), (1,1) in (u, v) */
} patch;

static ris_vec3 blend(const ris_vec3 *q, float u, float v)
{
    return v3_lerp(v3_lerp(q[0], q[1], v), v3_lerp(q[2], q[3], v), u);
}

static patch patch_of(const ris_bake_grid *grid, uint32_t r, uint32_t c)
{
    patch result;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint32_t at = (r + k / 2) * grid->columns + c + k % 2;
        result.point[k] = grid->point[at];
        result.normal[k] = grid->normal[at];
    }
    return result;
}

static void add_extent(const ris_bake *bake, uint32_t triangle, const ris_vec3 axis[2], float extent[2])
{
    const uint32_t *v = bake->model->triangle + 3 * (size_t)triangle;
    for (int k = 0; k < 2; ++k) {
        float low = INFINITY, high = -INFINITY;
        for (int i = 0; i < 3; ++i) {
            const float x = v3_dot(bake->head->skin.position[v[i]], axis[k]);
            low = f_min(low, x);
            high = f_max(high, x);
        }
        extent[k] += high - low;
    }
}

/* Samples the depth below the skin on a regular pattern of n[0] x n[1]. */
static void sample(const ris_bake *bake, const patch *p, const ris_vec3 axis[2], const uint32_t n[2],
                   cell_fit *out)
{
    uint32_t hits = 0;
    out->nearest = INFINITY;
    out->farthest = -INFINITY;
    out->extent[0] = out->extent[1] = 0.0f;
    for (uint32_t k = 0; k < n[0] * n[1]; ++k) {
        const uint32_t row = k / n[1], column = k % n[1];
        const float u = (float)row / (float)(n[0] - 1), v = (float)column / (float)(n[1] - 1);
        uint32_t triangle = 0;
        const float d = ris__depth_along(bake, blend(p->point, u, v),
                                         v3_unit_or(blend(p->normal, u, v), p->normal[0]), &triangle);
        if (!(fabsf(d) < INFINITY)) {
            continue;
        }
        add_extent(bake, triangle, axis, out->extent);
        ++hits;
        if (d < out->nearest) {
            out->nearest = d;
            out->near_at[0] = u;
            out->near_at[1] = v;
        }
        if (d > out->farthest) {
            out->farthest = d;
            out->far_at[0] = u;
            out->far_at[1] = v;
        }
    }
    out->sampled = hits > 0;
    for (int k = 0; k < 2 && hits; ++k) {
        out->extent[k] /= (float)hits;
    }
}

/* minMaxDistances of the thesis: coarse once to learn the size of the triangles, then dense enough for them. */
static cell_fit measure(const ris_bake *bake, const ris_bake_grid *grid, uint32_t r, uint32_t c)
{
    const patch p = patch_of(grid, r, c);
    const ris_vec3 none = {0}, along = v3_sub(blend(p.point, 1, 0.5f), blend(p.point, 0, 0.5f)),
                   across = v3_sub(blend(p.point, 0.5f, 1), blend(p.point, 0.5f, 0));
    const ris_vec3 axis[2] = {v3_unit_or(along, none), v3_unit_or(across, none)};
    cell_fit result = {.length = {v3_length(along), v3_length(across)}};
    uint32_t n[2] = {LEAST_SAMPLES, LEAST_SAMPLES};
    sample(bake, &p, axis, n, &result);
    for (int k = 0; k < 2 && result.sampled; ++k) {
        const float wanted = SAMPLES_PER_EXTENT * result.length[k] / f_max(result.extent[k], 1e-3f) + 1.0f;
        n[k] = (uint32_t)f_clamp(wanted, (float)LEAST_SAMPLES, (float)MOST_SAMPLES);
    }
    if (n[0] > LEAST_SAMPLES || n[1] > LEAST_SAMPLES) {
        sample(bake, &p, axis, n, &result);
    }
    return result;
}

static bool is_deep(const ris_bake_grid *grid, uint32_t r, uint32_t c)
{
    const bool *deep = grid->deep + (size_t)r * grid->columns + c;
    return deep[0] || deep[1] || deep[grid->columns] || deep[grid->columns + 1];
}

static void propose(split *line, float at, float error)
{
    if (error > line->error) {
        line->at = at;
        line->error = error;
    }
}

/* What one cell asks of its row and its column (minMaxError, trySubdivide). */
static void judge(const ris_bake *bake, const ris_muscle_def *def, const cell_fit *cell, split *row,
                  split *column)
{
    const float skin = bake->head->tissue.skin_mm, least = skin + 0.5f * def->thickness_mm[0],
                most = skin + 0.5f * def->thickness_mm[1];
    const float slack = 1e-3f; /* rounding of a sunken point must not split a cell */
    float near = f_max(f_max(least - cell->nearest, cell->nearest - most), 0.0f);
    float far = f_max(f_max(least - cell->farthest, cell->farthest - most), 0.0f);
    if (cell->farthest - cell->nearest > def->thickness_mm[0]) {
        near = fabsf(cell->nearest);
        far = fabsf(cell->farthest);
    }
    if (near <= slack && far <= slack) {
        return;
    }
    const float *at = far > near ? cell->far_at : cell->near_at;
    propose(row, at[0], f_max(near, far));
    propose(column, at[1], f_max(near, far));
}

/* A line whose pieces would be shorter than the skin's triangles over them is not split; a split too near its end moves
 * inwards. */
static void keep_size(split *line, uint32_t count)
{
    for (uint32_t k = 0; k < count; ++k) {
        line[k].error = line[k].least <= 0.5f ? line[k].error : 0.0f;
        line[k].at = f_clamp(line[k].at, line[k].least, 1.0f - line[k].least);
    }
}

/* A grid that is its own mirror image is split symmetrically. */
static void make_symmetric(split *line, uint32_t count)
{
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t other = count - 1 - k;
        if (k == other) {
            line[k].at = 0.5f;
        } else if (line[k].error > line[other].error || (line[k].error == line[other].error && k < other)) {
            line[other] = (split){1.0f - line[k].at, line[k].error, line[k].least};
        }
    }
}

static bool is_symmetric(const ris_muscle_def *def)
{
    const bool linear = def->kind == RIS_MUSCLE_LINEAR;
    for (uint32_t r = 0; r < def->rows; ++r) {
        for (uint32_t c = 0; c < def->columns; ++c) {
            const ris_vec3 p = def->grid[r * def->columns + c];
            const ris_vec3 q = linear ? def->grid[r * def->columns + def->columns - 1 - c]
                                      : def->grid[(def->rows - 1 - r) * def->columns + c];
            if (fabsf(p.x + q.x) > 1e-3f || fabsf(p.y - q.y) > 1e-3f || fabsf(p.z - q.z) > 1e-3f) {
                return false;
            }
        }
    }
    return true;
}

/* Old line and share of the way to the next one, for each line of the split grid; the new count. */
static uint32_t line_up(const split *line, uint32_t lines, uint32_t *from, float *share)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < lines; ++k) {
        from[count] = k;
        share[count++] = 0.0f;
        if (k + 1 < lines && line[k].error > 0.0f && lines < MOST_LINES) {
            from[count] = k;
            share[count++] = line[k].at;
        }
    }
    return count;
}

/* A new point between old ones (moveNewGridPoints): along the normal to the muscle layer, or on the plane of
 * a deep cell. */
static void place(const ris_bake *bake, float depth, ris_bake_grid *grid, uint32_t k, const patch *p,
                  const float old_depth[4], bool deep, float u, float v)
{
    const ris_vec3 flat = blend(p->point, u, v), normal = v3_unit_or(blend(p->normal, u, v), p->normal[0]);
    const float own = ris__depth_along(bake, flat, normal, NULL);
    grid->normal[k] = normal;
    grid->deep[k] = deep;
    if (!deep && fabsf(own) < INFINITY) {
        grid->point[k] = v3_mad(flat, own - depth, normal);
        grid->depth[k] = depth;
        return;
    }
    const float low = old_depth[0] + v * (old_depth[1] - old_depth[0]),
                high = old_depth[2] + v * (old_depth[3] - old_depth[2]);
    grid->point[k] = flat;
    grid->depth[k] = low + u * (high - low);
}

static ris_result rebuild(const ris_bake *bake, const ris_muscle_def *def, const split *row,
                          const split *column, ris_bake_grid *grid, ris_error *err)
{
    uint32_t from[2][2 * MOST_LINES];
    float share[2][2 * MOST_LINES];
    const uint32_t rows = line_up(row, grid->rows, from[0], share[0]),
                   columns = line_up(column, grid->columns, from[1], share[1]);
    const float depth = bake->head->tissue.skin_mm + (def->thickness_mm[0] + def->thickness_mm[1]) / 4.0f;
    ris_bake_grid old = *grid;
    ris_result result = ris__grid_create(rows, columns, grid, err);
    for (uint32_t k = 0; result == RIS_OK && k < rows * columns; ++k) {
        const uint32_t r = from[0][k / columns], c = from[1][k % columns];
        const float u = share[0][k / columns], v = share[1][k % columns];
        const uint32_t at = r * old.columns + c;
        if (u == 0.0f && v == 0.0f) {
            grid->point[k] = old.point[at];
            grid->normal[k] = old.normal[at];
            grid->depth[k] = old.depth[at];
            grid->deep[k] = old.deep[at];
            continue;
        }
        /* on an old line only the points at its two ends count */
        const uint32_t down = u > 0.0f ? old.columns : 0, right = v > 0.0f ? 1 : 0;
        const uint32_t corner[4] = {at, at + right, at + down, at + down + right};
        patch p;
        float old_depth[4];
        bool deep = false;
        for (int i = 0; i < 4; ++i) {
            p.point[i] = old.point[corner[i]];
            p.normal[i] = old.normal[corner[i]];
            old_depth[i] = old.depth[corner[i]];
            deep = deep || old.deep[corner[i]];
        }
        place(bake, depth, grid, k, &p, old_depth, deep, u, v);
    }
    ris__grid_finish(&old);
    return result;
}

/* One pass over the cells; true if a row or column was split. */
static ris_result refine_once(const ris_bake *bake, const ris_muscle_def *def, bool symmetric,
                              ris_bake_grid *grid, bool *out_split, ris_error *err)
{
    split row[MOST_LINES] = {{0}}, column[MOST_LINES] = {{0}};
    const uint32_t rows = grid->rows - 1, columns = grid->columns - 1;
    for (uint32_t r = 0; r < rows; ++r) {
        for (uint32_t c = 0; c < columns; ++c) {
            const cell_fit cell = measure(bake, grid, r, c);
            const float middle = 0.5f * (def->thickness_mm[0] + def->thickness_mm[1]);
            grid->thickness[r * columns + c] =
                cell.sampled ? f_clamp(2.0f * (cell.nearest - bake->head->tissue.skin_mm),
                                       def->thickness_mm[0], def->thickness_mm[1])
                             : middle;
            row[r].least = f_max(row[r].least, cell.extent[0] / cell.length[0]);
            column[c].least = f_max(column[c].least, cell.extent[1] / cell.length[1]);
            if (cell.sampled && !is_deep(grid, r, c)) {
                judge(bake, def, &cell, &row[r], &column[c]);
            }
        }
    }
    keep_size(row, rows);
    keep_size(column, columns);
    if (symmetric && def->kind == RIS_MUSCLE_LINEAR) {
        make_symmetric(column, columns);
    } else if (symmetric) {
        make_symmetric(row, rows);
    }
    *out_split = false;
    for (uint32_t k = 0; k < MOST_LINES; ++k) {
        *out_split = *out_split || (k < rows && row[k].error > 0.0f && grid->rows < MOST_LINES) ||
                     (k < columns && column[k].error > 0.0f && grid->columns < MOST_LINES);
    }
    return *out_split ? rebuild(bake, def, row, column, grid, err) : RIS_OK;
}

ris_result ris__refine_grid(const ris_bake *bake, uint32_t m, ris_bake_grid *grid, ris_error *err)
{
    const ris_muscle_def *def = &bake->head->muscle[m];
    const bool symmetric = is_symmetric(def);
    bool again = grid->rows <= MOST_LINES && grid->columns <= MOST_LINES;
    ris_result result = RIS_OK;
    while (result == RIS_OK && again) {
        result = refine_once(bake, def, symmetric, grid, &again, err);
    }
    return result;
}
