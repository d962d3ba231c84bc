/* Distance grids: near the surface the exact distance to the nearest triangle, farther out a chamfer sum; the sign by
 * counting signed crossings along z, so that overlapping crowns and bones make a union. */
#include "distance_grid.h"

#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define BAND_CELLS 2.5f /* exact so far from the surface */
#define JITTER_X 1.3e-4 /* of a cell: lines along z miss the meshes' own vertices */
#define JITTER_Y 2.9e-4

/* Closest point of a triangle (Ericson, Real-Time Collision Detection 5.1.5); single precision and nothing
 * shared, because a grid asks this some million times. */
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

ris_grid_place ris__grid_place(ris_vec3 low, ris_vec3 high, float cell_mm)
{
    ris_grid_place place = {.low = low, .cell_mm = cell_mm};
    const float size[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int k = 0; k < 3; ++k) {
        const float cells = ceilf(f_max(size[k], cell_mm) / cell_mm);
        place.count[k] = (uint32_t)cells + 1;
    }
    return place;
}

size_t ris__grid_count(const ris_grid_place *place)
{
    return (size_t)place->count[0] * place->count[1] * place->count[2];
}

static ris_vec3 sample_at(const ris_grid_place *place, uint32_t x, uint32_t y, uint32_t z)
{
    return v3_mad(place->low, place->cell_mm, v3((float)x, (float)y, (float)z));
}

/* Samples x0..x1 of an axis that lie within low..high; false if none. */
static bool axis_range(float origin, float cell, uint32_t count, float low, float high, uint32_t out[2])
{
    const float a = f_max(ceilf((low - origin) / cell), 0.0f), b = floorf((high - origin) / cell);
    if (!(b >= a) || a >= (float)count) {
        return false;
    }
    out[0] = (uint32_t)a;
    out[1] = b < (float)(count - 1) ? (uint32_t)b : count - 1;
    return true;
}

/* Lowers the squared distance of the samples near one triangle. */
static void splat(const ris_grid_place *place, const ris_vec3 t[3], float *out)
{
    const float band = BAND_CELLS * place->cell_mm;
    const ris_vec3 low =
        v3(f_min(t[0].x, f_min(t[1].x, t[2].x)) - band, f_min(t[0].y, f_min(t[1].y, t[2].y)) - band,
           f_min(t[0].z, f_min(t[1].z, t[2].z)) - band);
    const ris_vec3 high =
        v3(f_max(t[0].x, f_max(t[1].x, t[2].x)) + band, f_max(t[0].y, f_max(t[1].y, t[2].y)) + band,
           f_max(t[0].z, f_max(t[1].z, t[2].z)) + band);
    uint32_t rx[2], ry[2], rz[2];
    if (!axis_range(place->low.x, place->cell_mm, place->count[0], low.x, high.x, rx) ||
        !axis_range(place->low.y, place->cell_mm, place->count[1], low.y, high.y, ry) ||
        !axis_range(place->low.z, place->cell_mm, place->count[2], low.z, high.z, rz)) {
        return;
    }
    const ris_vec3 normal =
        v3_unit_or(v3_cross(v3_sub(t[1], t[0]), v3_sub(t[2], t[0])), v3(0.0f, 0.0f, 0.0f));
    for (uint32_t z = rz[0]; z <= rz[1]; ++z) {
        for (uint32_t y = ry[0]; y <= ry[1]; ++y) {
            float *row = out + ((size_t)z * place->count[1] + y) * place->count[0];
            for (uint32_t x = rx[0]; x <= rx[1]; ++x) {
                const ris_vec3 p = sample_at(place, x, y, z);
                const float off = v3_dot(normal, v3_sub(p, t[0])); /* of its plane: no nearer than that */
                if (off * off < f_min(row[x], band * band)) {
                    const ris_vec3 d = v3_sub(p, closest_on_triangle(p, t[0], t[1], t[2]));
                    row[x] = f_min(row[x], v3_dot(d, d));
                }
            }
        }
    }
}

/* One pass of the chamfer sum over samples in the order of step (1 or -1): axis neighbours at one cell, diagonal ones
 * at sqrt 2 and sqrt 3 cells. */
static void chamfer(const ris_grid_place *place, int step, float *value)
{
    const int n[3] = {(int)place->count[0], (int)place->count[1], (int)place->count[2]};
    const float length[4] = {0.0f, place->cell_mm, place->cell_mm * 1.41421356f,
                             place->cell_mm * 1.73205081f};
    for (int kz = 0; kz < n[2]; ++kz) {
        for (int ky = 0; ky < n[1]; ++ky) {
            for (int kx = 0; kx < n[0]; ++kx) {
                const int z = step > 0 ? kz : n[2] - 1 - kz, y = step > 0 ? ky : n[1] - 1 - ky,
                          x = step > 0 ? kx : n[0] - 1 - kx;
                float best = value[((size_t)z * n[1] + y) * n[0] + x];
                for (int k = 0; k < 13; ++k) { /* the half of the 26 neighbours that comes before */
                    const int dx = (k % 3 - 1) * step, dy = (k / 3 % 3 - 1) * step, dz = (k / 9 - 1) * step;
                    if (x + dx < 0 || x + dx >= n[0] || y + dy < 0 || y + dy >= n[1] || z + dz < 0 ||
                        z + dz >= n[2]) {
                        continue;
                    }
                    const float far = value[((size_t)(z + dz) * n[1] + (y + dy)) * n[0] + (x + dx)];
                    best = f_min(best, far + length[(dx != 0) + (dy != 0) + (dz != 0)]);
                }
                value[((size_t)z * n[1] + y) * n[0] + x] = best;
            }
        }
    }
}

/* Where a line along z pierces a triangle: upwards through it +1 leaves the mesh, -1 enters. */
typedef struct crossing {
    uint32_t column;
    float z;
    int turn;
} crossing;

typedef struct crossing_list {
    crossing *item;
    size_t count, room;
} crossing_list;

static bool add_crossing(crossing_list *list, crossing c)
{
    if (list->count == list->room) {
        const size_t room = list->room ? 2 * list->room : 4096;
        crossing *grown = realloc(list->item, room * sizeof *grown);
        if (!grown) {
            return false;
        }
        list->item = grown;
        list->room = room;
    }
    list->item[list->count++] = c;
    return true;
}

static double edge_side(const double a[2], const double b[2], double x, double y)
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* Adds the crossings of one triangle with the grid's lines along z. */
static bool cross_columns(const ris_grid_place *place, const ris_vec3 t[3], crossing_list *list)
{
    const float low_x = f_min(t[0].x, f_min(t[1].x, t[2].x)), high_x = f_max(t[0].x, f_max(t[1].x, t[2].x));
    const float low_y = f_min(t[0].y, f_min(t[1].y, t[2].y)), high_y = f_max(t[0].y, f_max(t[1].y, t[2].y));
    const double p[3][2] = {{t[0].x, t[0].y}, {t[1].x, t[1].y}, {t[2].x, t[2].y}};
    const double area = edge_side(p[0], p[1], p[2][0], p[2][1]);
    const float cell = place->cell_mm;
    uint32_t rx[2], ry[2];
    if (area == 0.0 || !axis_range(place->low.x, cell, place->count[0], low_x - cell, high_x + cell, rx) ||
        !axis_range(place->low.y, cell, place->count[1], low_y - cell, high_y + cell, ry)) {
        return true;
    }
    for (uint32_t iy = ry[0]; iy <= ry[1]; ++iy) {
        for (uint32_t ix = rx[0]; ix <= rx[1]; ++ix) {
            const double x = (double)place->low.x + (ix + JITTER_X) * (double)cell;
            const double y = (double)place->low.y + (iy + JITTER_Y) * (double)cell;
            const double a = edge_side(p[1], p[2], x, y) / area, b = edge_side(p[2], p[0], x, y) / area,
                         c = 1.0 - a - b;
            if (a < 0.0 || b < 0.0 || c < 0.0) {
                continue;
            }
            const double z = a * (double)t[0].z + b * (double)t[1].z + c * (double)t[2].z;
            if (!add_crossing(list, (crossing){iy * place->count[0] + ix, (float)z, area > 0.0 ? 1 : -1})) {
                return false;
            }
        }
    }
    return true;
}

static int compare_crossings(const void *a, const void *b)
{
    const crossing *p = a, *q = b;
    if (p->column != q->column) {
        return p->column < q->column ? -1 : 1;
    }
    return p->z < q->z ? -1 : p->z > q->z;
}

/* Makes the samples inside negative. */
static void apply_sign(const ris_grid_place *place, crossing_list *list, float *value)
{
    const size_t slice = (size_t)place->count[0] * place->count[1];
    qsort(list->item, list->count, sizeof *list->item, compare_crossings);
    for (size_t first = 0, end; first < list->count; first = end) {
        const uint32_t column = list->item[first].column;
        size_t k = first;
        int inside = 0;
        for (end = first; end < list->count && list->item[end].column == column; ++end) {
        }
        for (uint32_t z = 0; z < place->count[2]; ++z) {
            const float at = place->low.z + (float)z * place->cell_mm;
            for (; k < end && list->item[k].z < at; ++k) {
                inside -= list->item[k].turn;
            }
            if (inside > 0) {
                value[z * slice + column] = -value[z * slice + column];
            }
        }
    }
}

/* Calls splat and cross_columns for every triangle. */
static bool visit_triangles(const ris_mesh *mesh, const ris_grid_place *place, crossing_list *list,
                            float *out)
{
    for (uint32_t f = 0; f < mesh->face_count; ++f) {
        const uint32_t *v = mesh->face_vertex + mesh->face_start[f];
        for (uint32_t k = 2; k < mesh->face_start[f + 1] - mesh->face_start[f]; ++k) {
            const ris_vec3 t[3] = {mesh->position[v[0]], mesh->position[v[k - 1]], mesh->position[v[k]]};
            splat(place, t, out);
            if (!cross_columns(place, t, list)) {
                return false;
            }
        }
    }
    return true;
}

ris_result ris__distance_grid(const ris_mesh *const *mesh, uint32_t mesh_count, const ris_grid_place *place,
                              float *out, ris_error *err)
{
    const size_t count = ris__grid_count(place);
    const float band = BAND_CELLS * place->cell_mm;
    crossing_list list = {0};
    bool room = true;
    for (size_t k = 0; k < count; ++k) {
        out[k] = 1e12f;
    }
    for (uint32_t m = 0; m < mesh_count && room; ++m) {
        room = visit_triangles(mesh[m], place, &list, out);
    }
    if (!room) {
        free(list.item);
        return ris_fail(err, RIS_ERROR_MEMORY, "not enough memory for a distance grid of %zu samples", count);
    }
    for (size_t k = 0; k < count; ++k) { /* beyond the band a sample may have missed its nearest triangle */
        out[k] = out[k] <= band * band ? sqrtf(out[k]) : 1e6f;
    }
    chamfer(place, 1, out);
    chamfer(place, -1, out);
    apply_sign(place, &list, out);
    free(list.item);
    return RIS_OK;
}

/* 1/4, 1/2, 1/4 along one axis; the ends stay. */
static void smooth_axis(const ris_grid_place *place, int axis, float *value)
{
    const size_t stride[3] = {1, place->count[0], (size_t)place->count[0] * place->count[1]};
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (uint32_t j = 0; j < place->count[b]; ++j) {
        for (uint32_t i = 0; i < place->count[a]; ++i) {
            float *line = value + i * stride[a] + j * stride[b];
            float before = line[0];
            for (uint32_t k = 1; k + 1 < place->count[axis]; ++k) {
                const float own = line[k * stride[axis]];
                line[k * stride[axis]] = 0.25f * before + 0.5f * own + 0.25f * line[(k + 1) * stride[axis]];
                before = own;
            }
        }
    }
}

void ris__grid_smooth(const ris_grid_place *place, uint32_t passes, float *value)
{
    for (uint32_t k = 0; k < passes; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            smooth_axis(place, axis, value);
        }
    }
}

/* Difference of the neighbours of a sample along an axis, one-sided at the ends. */
static float slope(const ris_grid_place *place, const float *value, const uint32_t at[3], int axis)
{
    const size_t stride[3] = {1, place->count[0], (size_t)place->count[0] * place->count[1]};
    const size_t own = at[0] + at[1] * stride[1] + at[2] * stride[2];
    const size_t before = at[axis] > 0 ? own - stride[axis] : own;
    const size_t after = at[axis] + 1 < place->count[axis] ? own + stride[axis] : own;
    const size_t steps = (after - before) / stride[axis]; /* 2, or 1 at an end */
    return (value[after] - value[before]) / (float)steps;
}

void ris__grid_directions(const ris_grid_place *place, const float *value, ris_vec4 *out)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < place->count[2]; ++at[2]) {
        for (at[1] = 0; at[1] < place->count[1]; ++at[1]) {
            for (at[0] = 0; at[0] < place->count[0]; ++at[0]) {
                const size_t k = at[0] + place->count[0] * (at[1] + (size_t)place->count[1] * at[2]);
                const ris_vec3 g =
                    v3(slope(place, value, at, 0), slope(place, value, at, 1), slope(place, value, at, 2));
                out[k] = v4_from(v3_unit_or(g, v3(0.0f, 0.0f, 0.0f)), value[k]);
            }
        }
    }
}

static ris_vec4 blend(ris_vec4 a, ris_vec4 b, float t)
{
    const ris_vec4 r = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z),
                        a.w + t * (b.w - a.w)};
    return r;
}

bool ris__grid_blend(const ris_vec4 *grid, ris_vec3 low, float per_mm, const uint32_t count[3], ris_vec3 p,
                     ris_vec4 *out)
{
    const ris_vec3 q = v3((p.x - low.x) * per_mm, (p.y - low.y) * per_mm, (p.z - low.z) * per_mm);
    if (!(q.x >= 0.0f && q.x < (float)(count[0] - 1) && q.y >= 0.0f && q.y < (float)(count[1] - 1) &&
          q.z >= 0.0f && q.z < (float)(count[2] - 1))) {
        return false;
    }
    const uint32_t x = (uint32_t)q.x, y = (uint32_t)q.y, z = (uint32_t)q.z;
    const float fx = q.x - (float)x, fy = q.y - (float)y, fz = q.z - (float)z;
    const size_t row = count[0], slice = row * count[1];
    const ris_vec4 *v = grid + (z * slice + y * row + x);
    const ris_vec4 near = blend(blend(v[0], v[1], fx), blend(v[row], v[row + 1], fx), fy);
    const ris_vec4 far =
        blend(blend(v[slice], v[slice + 1], fx), blend(v[slice + row], v[slice + row + 1], fx), fy);
    *out = blend(near, far, fz);
    return true;
}

bool ris__grid_sample(const ris_vec4 *grid, const ris_grid_place *place, ris_vec3 p, ris_vec4 *out)
{
    return ris__grid_blend(grid, place->low, 1.0f / place->cell_mm, place->count, p, out);
}
