/* Signed-distance shapes, melted together in order, warped by the fit and kept under the skin (KA-04). */
#include "make_skull.h"

#include <stdlib.h>
#include <string.h>

#define DEGREE 0.017453292519943295

static double clamp01(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Polynomial smooth minimum: differs from min only where the two are within k. */
static double smooth_min(double a, double b, double k)
{
    if (!(k > 0))
        return fmin(a, b);
    double h = fmax(k - fabs(a - b), 0) / k;
    return fmin(a, b) - h * h * k * 0.25;
}

ris_result solid_init(solid *s, const char *name, ris_error *err)
{
    *s = (solid){.name = name};
    s->part = calloc(SOLID_PARTS, sizeof *s->part);
    if (!s->part)
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the shapes of the %s", name);
    return RIS_OK;
}

void solid_finish(solid *s)
{
    free(s->part);
    *s = (solid){0};
}

static void rotation_of(dvec turn, double r[3][3])
{
    double cx = cos(turn.x * DEGREE), sx = sin(turn.x * DEGREE), cy = cos(turn.y * DEGREE),
           sy = sin(turn.y * DEGREE);
    double cz = cos(turn.z * DEGREE), sz = sin(turn.z * DEGREE);
    /* transpose of Rz Ry Rx: world to shape */
    double m[3][3] = {{cy * cz, cy * sz, -sy},
                      {sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy},
                      {cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy}};
    memcpy(r, m, sizeof m);
}

static dvec catmull(const dvec *p, int n, int i, double t)
{
    dvec p0 = p[i > 0 ? i - 1 : 0], p1 = p[i], p2 = p[i + 1], p3 = p[i + 2 < n ? i + 2 : n - 1];
    double a = -0.5 * t + t * t - 0.5 * t * t * t, b = 1 - 2.5 * t * t + 1.5 * t * t * t;
    double c = 0.5 * t + 2 * t * t - 1.5 * t * t * t, d = -0.5 * t * t + 0.5 * t * t * t;
    return dv(a * p0.x + b * p1.x + c * p2.x + d * p3.x, a * p0.y + b * p1.y + c * p2.y + d * p3.y,
              a * p0.z + b * p1.z + c * p2.z + d * p3.z);
}

static void sample_curve(solid_part *part)
{
    const shape *d = &part->def;
    for (int i = 0; i + 1 < d->count; i++)
        for (int k = 0; k < SHAPE_STEPS; k++) {
            double t = (double)k / SHAPE_STEPS;
            int n = part->step_count++;
            part->step[n] = catmull(d->point, d->count, i, t);
            for (int j = 0; j < 2; j++)
                part->step_size[n][j] = d->size[i][j] + t * (d->size[i + 1][j] - d->size[i][j]);
        }
    int n = part->step_count++;
    part->step[n] = d->point[d->count - 1];
    memcpy(part->step_size[n], d->size[d->count - 1], sizeof part->step_size[n]);
}

/* Centre and radius of a ball that holds the shape. */
static void bound_part(solid_part *part)
{
    const shape *d = &part->def;
    dvec sum = {0};
    double reach = 0;
    for (int i = 0; i < d->count; i++) {
        dvec p = d->point[i];
        if (d->kind == SHAPE_PLATE)
            p = dv(d->sheet[0] + d->sheet[1] * p.y + d->sheet[2] * p.x, p.y, p.x);
        sum = dv_mad(sum, 1.0 / d->count, p);
    }
    for (int i = 0; i < d->count; i++) {
        dvec p = d->point[i];
        if (d->kind == SHAPE_PLATE)
            p = dv(d->sheet[0] + d->sheet[1] * p.y + d->sheet[2] * p.x, p.y, p.x);
        reach = fmax(reach, dv_length(dv_sub(p, sum)) + fmax(d->size[i][0], d->size[i][1]));
    }
    if (d->kind == SHAPE_CURVE)
        reach += 4;
    part->centre = sum;
    part->reach = reach + dv_length(d->radius) + d->rounding;
    if (d->kind == SHAPE_ELLIPSOID)
        part->reach = fmax(d->radius.x, fmax(d->radius.y, d->radius.z));
}

void solid_add(solid *s, const shape *def)
{
    if (s->part_count == SOLID_PARTS)
        return;
    solid_part *part = &s->part[s->part_count++];
    *part = (solid_part){.def = *def};
    if (part->def.count == 0)
        part->def.count = def->kind == SHAPE_CAPSULE ? 2 : 1;
    if (def->up.x == 0 && def->up.y == 0 && def->up.z == 0)
        part->def.up = dv(0, 1, 0);
    rotation_of(def->turn, part->rotation);
    if (def->kind == SHAPE_CURVE)
        sample_curve(part);
    bound_part(part);
}

static dvec to_shape(const solid_part *part, dvec p)
{
    dvec q = dv_sub(p, part->def.point[0]);
    const double(*r)[3] = part->rotation;
    return dv(r[0][0] * q.x + r[0][1] * q.y + r[0][2] * q.z, r[1][0] * q.x + r[1][1] * q.y + r[1][2] * q.z,
              r[2][0] * q.x + r[2][1] * q.y + r[2][2] * q.z);
}

/* First-order distance to an ellipsoid about the origin. */
static double ellipsoid(dvec q, dvec r)
{
    dvec a = dv(q.x / r.x, q.y / r.y, q.z / r.z), b = dv(a.x / r.x, a.y / r.y, a.z / r.z);
    double k0 = dv_length(a), k1 = dv_length(b);
    return k1 > 1e-12 ? k0 * (k0 - 1) / k1 : -fmin(r.x, fmin(r.y, r.z));
}

static double capsule(const shape *d, dvec p)
{
    dvec axis = dv_sub(d->point[1], d->point[0]), q = dv_sub(p, d->point[0]);
    double t = clamp01(dv_dot(q, axis) / dv_dot(axis, axis));
    return dv_length(dv_mad(q, -t, axis)) - (d->size[0][0] + t * (d->size[1][0] - d->size[0][0]));
}

static double box(const shape *d, dvec q)
{
    dvec e = dv(fabs(q.x) - d->radius.x + d->rounding, fabs(q.y) - d->radius.y + d->rounding,
                fabs(q.z) - d->radius.z + d->rounding);
    dvec out = dv(fmax(e.x, 0), fmax(e.y, 0), fmax(e.z, 0));
    return dv_length(out) + fmin(fmax(e.x, fmax(e.y, e.z)), 0) - d->rounding;
}

static double curve(const solid_part *part, dvec p)
{
    double best = HUGE_VAL;
    for (int i = 0; i + 1 < part->step_count; i++) {
        dvec axis = dv_sub(part->step[i + 1], part->step[i]), q = dv_sub(p, part->step[i]);
        double length = dv_length(axis), t = clamp01(dv_dot(q, axis) / (length * length));
        double a = part->step_size[i][0] + t * (part->step_size[i + 1][0] - part->step_size[i][0]);
        double b = part->step_size[i][1] + t * (part->step_size[i + 1][1] - part->step_size[i][1]);
        dvec o = dv_mad(q, -t, axis), along = dv(axis.x / length, axis.y / length, axis.z / length);
        dvec up = dv_unit(dv_mad(part->def.up, -dv_dot(part->def.up, along), along));
        dvec side = dv_cross(up, along);
        double d = ellipsoid(dv(dv_dot(o, side), dv_dot(o, up), dv_dot(o, along)), dv(a, b, fmin(a, b)));
        best = fmin(best, d);
    }
    return best;
}

/* Distance to a polygon in the (z, y) plane, negative inside. */
static double polygon(const shape *d, double z, double y)
{
    double best = HUGE_VAL, sign = 1;
    for (int i = 0, j = d->count - 1; i < d->count; j = i++) {
        double ex = d->point[j].x - d->point[i].x, ey = d->point[j].y - d->point[i].y;
        double wx = z - d->point[i].x, wy = y - d->point[i].y;
        double t = clamp01((wx * ex + wy * ey) / (ex * ex + ey * ey)), bx = wx - ex * t, by = wy - ey * t;
        best = fmin(best, bx * bx + by * by);
        bool c1 = y >= d->point[i].y, c2 = y<d->point[j].y, c3 = ex * wy> ey * wx;
        if ((c1 && c2 && c3) || (!c1 && !c2 && !c3))
            sign = -sign;
    }
    return sign * sqrt(best);
}

static double plate(const shape *d, dvec p)
{
    double across = fabs(p.x - (d->sheet[0] + d->sheet[1] * p.y + d->sheet[2] * p.z)) /
                    sqrt(1 + d->sheet[1] * d->sheet[1] + d->sheet[2] * d->sheet[2]);
    double r = fmin(d->rounding, d->radius.x), a = polygon(d, p.z, p.y) - d->rounding + r,
           b = across - d->radius.x + r;
    return hypot(fmax(a, 0), fmax(b, 0)) + fmin(fmax(a, b), 0) - r;
}

static double part_distance(const solid_part *part, dvec p)
{
    switch (part->def.kind) {
    case SHAPE_ELLIPSOID: return ellipsoid(to_shape(part, p), part->def.radius);
    case SHAPE_CAPSULE: return capsule(&part->def, p);
    case SHAPE_BOX: return box(&part->def, to_shape(part, p));
    case SHAPE_CURVE: return curve(part, p);
    case SHAPE_PLATE: return plate(&part->def, p);
    }
    return HUGE_VAL;
}

static dvec warped(const solid *s, dvec p)
{
    dvec q = p;
    for (int i = 0; i < s->warp_count; i++) {
        const solid_warp *w = &s->warp[i];
        dvec o = dv_sub(p, w->at);
        double r2 = dv_dot(o, o) / (w->radius * w->radius);
        if (r2 < 9)
            q = dv_mad(q, -exp(-r2), w->shift);
    }
    return q;
}

double solid_distance(const solid *s, dvec sample)
{
    dvec at = dv(fabs(sample.x), sample.y, sample.z), p = warped(s, at);
    double d = 1e3;
    p.x = fabs(p.x);
    for (int i = 0; i < s->part_count; i++) {
        const solid_part *part = &s->part[i];
        double least = dv_length(dv_sub(p, part->centre)) - part->reach, k = part->def.blend;
        if (part->def.op == SHAPE_ADD) {
            if (least < d + k)
                d = smooth_min(d, part_distance(part, p), k);
        } else if (least < k - d) {
            d = -smooth_min(-d, part_distance(part, p), k);
        }
    }
    if (s->skin && d < 20)
        d = -smooth_min(-d, depth_grid_at(s->skin, at) - s->clearance(at), 2);
    return d;
}

dvec solid_gradient(const solid *s, dvec p)
{
    const double h = 0.05;
    dvec g = dv(solid_distance(s, dv(p.x + h, p.y, p.z)) - solid_distance(s, dv(p.x - h, p.y, p.z)),
                solid_distance(s, dv(p.x, p.y + h, p.z)) - solid_distance(s, dv(p.x, p.y - h, p.z)),
                solid_distance(s, dv(p.x, p.y, p.z + h)) - solid_distance(s, dv(p.x, p.y, p.z - h)));
    return dv(g.x / (2 * h), g.y / (2 * h), g.z / (2 * h));
}

/* Rounds the coarse facets of the scalp off: a binomial blur of the depths above the brow. */
static void blur_scalp(depth_grid *g, float *copy)
{
    const ptrdiff_t stride[3] = {1, g->count[0], (ptrdiff_t)g->count[0] * g->count[1]};
    for (int pass = 0; pass < 3 * 4; pass++) {
        size_t total = (size_t)stride[2] * g->count[2];
        memcpy(copy, g->value, total * sizeof *copy);
        for (size_t i = 0; i < total; i++) {
            int c[3] = {(int)(i % g->count[0]), (int)(i / stride[1] % g->count[1]), (int)(i / stride[2])},
                k = pass % 3;
            double blend = fmin(1, (g->low[1] + c[1] * g->step - 56) / 20);
            if (blend <= 0 || c[k] + 1 >= g->count[k] || (c[k] == 0 && k != 0))
                continue;
            float before = copy[c[k] ? i - stride[k] : i + stride[k]],
                  after = copy[i + stride[k]]; /* mirrored at x = 0 */
            g->value[i] += (float)(blend * (0.25 * before + 0.25 * after - 0.5 * copy[i]));
        }
    }
}

ris_result depth_grid_build(depth_grid *g, const hull *h, double step, ris_error *err)
{
    dvec low = dv(0, -100, -100), high = dv(84, 144, 118);
    *g = (depth_grid){.low = {low.x, low.y, low.z}, .step = step};
    const double size[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
    size_t total = 1;
    for (int k = 0; k < 3; k++) {
        g->count[k] = (int)(size[k] / step) + 2;
        total *= (size_t)g->count[k];
    }
    g->value = malloc(total * sizeof *g->value);
    if (!g->value)
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a grid of %zu depths", total);
    size_t i = 0;
    for (int z = 0; z < g->count[2]; z++)
        for (int y = 0; y < g->count[1]; y++)
            for (int x = 0; x < g->count[0]; x++)
                g->value[i++] =
                    (float)ris__bvh_depth(&h->tree, dv(low.x + x * step, low.y + y * step, low.z + z * step));
    float *copy = malloc(total * sizeof *copy);
    if (!copy) {
        depth_grid_finish(g);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a grid of %zu depths", total);
    }
    blur_scalp(g, copy);
    free(copy);
    return RIS_OK;
}

double depth_grid_at(const depth_grid *g, dvec p)
{
    const double c[3] = {fabs(p.x), p.y, p.z};
    int i[3];
    double f[3];
    for (int k = 0; k < 3; k++) {
        double t = (c[k] - g->low[k]) / g->step;
        t = fmax(0, fmin(t, g->count[k] - 1.001));
        i[k] = (int)t;
        f[k] = t - i[k];
    }
    double sum = 0;
    for (int k = 0; k < 8; k++) {
        size_t at =
            (((size_t)i[2] + (k >> 2)) * g->count[1] + i[1] + (k >> 1 & 1)) * g->count[0] + i[0] + (k & 1);
        sum +=
            (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]) * g->value[at];
    }
    return sum;
}

void depth_grid_finish(depth_grid *g)
{
    free(g->value);
    *g = (depth_grid){0};
}
