/* Brows and lashes: tapered, curved ribbons (KA-06). Brow hairs lie along the skin of the brow ridge; lashes start on
 * the rim of the lids. UV: u across a ribbon, v from root (0) to tip (1). */
#include "make_head.h"

#include <math.h>

#define PI 3.14159265358979323846
#define CURVE_POINTS 16

typedef struct curve {
    uint32_t count;
    dvec at[128];
} curve;

/* A small reproducible generator: the same hairs on every machine. */
static double chance(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    uint32_t x = *state ^ (*state >> 16);
    x *= 0x45d9f3bu;
    x ^= x >> 15;
    return (x & 0xffffff) / 16777216.0;
}

static double spread(uint32_t *state)
{
    return chance(state) + chance(state) - 1;
}

/* Catmull-Rom point at t in 0..1 over evenly counted points. */
static dvec curve_at(const curve *c, double t)
{
    double s = clamp(t, 0, 1) * (c->count - 1);
    uint32_t i = (uint32_t)s < c->count - 1 ? (uint32_t)s : c->count - 2;
    double f = s - i;
    dvec p1 = c->at[i], p2 = c->at[i + 1];
    dvec p0 = i ? c->at[i - 1] : v_sub(v_mul(p1, 2), p2);
    dvec p3 = i + 2 < c->count ? c->at[i + 2] : v_sub(v_mul(p2, 2), p1);
    dvec a = v_mul(v_sub(p2, p0), 0.5), b = v_mul(v_sub(p3, p1), 0.5), d = v_sub(p1, p2);
    dvec cubic = v_add(v_mul(d, 2), v_add(a, b));
    dvec square = v_sub(v_mul(d, -3), v_add(v_mul(a, 2), b));
    return v_add(p1, v_add(v_mul(a, f), v_add(v_mul(square, f * f), v_mul(cubic, f * f * f))));
}

/* Ribbon through count points; side is across it at each point, half its width at the root. */
static void add_ribbon(part *p, const dvec *points, const dvec *side, uint32_t count, double half)
{
    for (uint32_t k = 0; k < count; k++) {
        double t = (double)k / (count - 1),
               w = half * (0.55 + 0.45 * smoothstep(0, 0.3, t)) * (1 - 0.92 * t * t);
        uint32_t first = part_vertex(p, v_mad(points[k], side[k], -w), 0, t);
        part_vertex(p, v_mad(points[k], side[k], w), 1, t);
        if (k)
            part_quad(p, first - 2, first - 1, first + 1, first);
    }
}

typedef struct brow_rule {
    curve middle;         /* x, y of the brow's middle line, head to tail; z unused */
    double width[3];      /* full width at head, body and tail */
    double length[3];     /* hair length there */
    double half, lift[2]; /* half ribbon width; height over the skin at root and tip */
    uint32_t count;
} brow_rule;

static double along_brow(const double v[3], double t)
{
    return t < 0.35 ? v[0] + (v[1] - v[0]) * t / 0.35 : v[1] + (v[2] - v[1]) * (t - 0.35) / 0.65;
}

/* Angle of a hair: the head's stand nearly upright, the body's sweep outwards, upper ones bend down towards the
 * middle line, lower ones up. across is -1 (lower border) .. 1 (upper border). */
static double brow_angle(double t, double across, double slope)
{
    double sweep = t < 0.3 ? 66 - 130 * t : 27 - 30 * (t - 0.3);
    double converge = across > 0 ? -22 * across * smoothstep(0.08, 0.4, t) : -14 * across;
    return (sweep + converge) * PI / 180 + slope * smoothstep(0.1, 0.5, t);
}

static void add_brow_hair(part *p, const maker *m, const brow_rule *rule, uint32_t i, uint32_t *state)
{
    enum { POINTS = 5 };
    double t = (i + chance(state)) / rule->count, across = 0.62 * spread(state) + 0.55 * spread(state);
    t = pow(t, 0.86); /* thinner at the head */
    dvec here = curve_at(&rule->middle, t), ahead = curve_at(&rule->middle, t + 0.02),
         back = curve_at(&rule->middle, t - 0.02);
    double slope = atan2(ahead.y - back.y, ahead.x - back.x);
    double width = along_brow(rule->width, t),
           length = along_brow(rule->length, t) * (0.62 + 0.5 * chance(state));
    double angle = brow_angle(t, across, slope) + 0.24 * spread(state);
    double bend =
        (across > 0 ? -0.35 : -0.15 + 0.3 * across) * smoothstep(0.0, 0.3, t) + 0.12 * spread(state) - 0.12;
    double x = here.x - sin(slope) * across * width / 2, y = here.y + cos(slope) * across * width / 2;
    x -= 0.35 * length * cos(angle) * (t > 0.15);
    y -= 0.35 * length * sin(angle) * (t > 0.15) * 0.5;
    dvec points[POINTS], sides[POINTS];
    for (int k = 0; k < POINTS; k++) {
        double f = k / (POINTS - 1.0);
        dvec normal, at = skin_project(&m->skin, x, y, &normal);
        points[k] = v_mad(at, normal, rule->lift[0] + (rule->lift[1] - rule->lift[0]) * sin(0.75 * PI * f));
        double a = angle + bend * f * 1.4;
        dvec ahead3 = v3(cos(a), sin(a), 0);
        sides[k] = v_unit(v_cross(ahead3, normal));
        x += cos(a) * length / (POINTS - 1);
        y += sin(a) * length / (POINTS - 1) * (0.8 + 0.2 * fabs(normal.z));
        if (x < 1.2)
            x = 1.2;
    }
    add_ribbon(p, points, sides, POINTS, rule->half * (0.75 + 0.5 * chance(state)));
}

static part build_brow(const maker *m)
{
    json_t *entry = recipe_get(m->recipe, "brow"), *line = recipe_get(entry, "middle_xy");
    brow_rule rule = {.half = recipe_number(entry, "half_width_mm"), .count = recipe_index(entry, "count")};
    rule.middle.count = (uint32_t)json_array_size(line);
    if (rule.middle.count < 2 || rule.middle.count > CURVE_POINTS)
        stop("recipe: expected 2..%d points at \"middle_xy\"", CURVE_POINTS);
    for (uint32_t i = 0; i < rule.middle.count; i++) {
        json_t *xy = json_array_get(line, i);
        rule.middle.at[i] =
            v3(json_number_value(json_array_get(xy, 0)), json_number_value(json_array_get(xy, 1)), 0);
    }
    recipe_numbers(entry, "width_mm", rule.width, 3);
    recipe_numbers(entry, "length_mm", rule.length, 3);
    recipe_numbers(entry, "lift_mm", rule.lift, 2);
    part p = {0};
    uint32_t state = 2026;
    for (uint32_t i = 0; i < rule.count; i++)
        add_brow_hair(&p, m, &rule, i, &state);
    return p;
}

/* Rim of one lid of the left eye from the inner to the outer corner, between the rim ring and the lid margin inside. */
static curve lid_rim(const maker *m, bool upper)
{
    const ring_set *eye = &m->eye;
    uint32_t rim = recipe_index(recipe_get(m->recipe, "eye"), "rim_ring"), size = eye->at[rim].count;
    uint32_t inner = eye->corner[0], outer = eye->corner[1];
    curve c = {0};
    /* columns run from the top over the outer corner, the lower lid and the inner corner */
    uint32_t steps = upper ? (outer + size - inner) % size : inner - outer;
    for (uint32_t k = 0; k <= steps; k++) {
        uint32_t column = upper ? (inner + k) % size : inner - k;
        c.at[c.count++] = v_mix(m->mesh.position[eye->at[rim].vertex[column]],
                                m->mesh.position[eye->at[rim + 1].vertex[column]], 0.12);
    }
    return c;
}

typedef struct lash_rule {
    uint32_t count;
    double range[2];  /* part of the rim that bears lashes, 0 = inner corner */
    double length[3]; /* inner, middle, outer */
    double half, droop_deg, curl_deg;
} lash_rule;

static void add_lash(part *p, const curve *rim, const lash_rule *rule, dvec eye, uint32_t i, bool upper,
                     uint32_t *state)
{
    enum { POINTS = 6 };
    double t =
        rule->range[0] + (rule->range[1] - rule->range[0]) * (i + 0.5 + 0.55 * spread(state)) / rule->count;
    dvec root = curve_at(rim, t), tangent = v_unit(v_sub(curve_at(rim, t + 0.01), curve_at(rim, t - 0.01)));
    double s = (t - rule->range[0]) / (rule->range[1] - rule->range[0]);
    double length = s < 0.6 ? rule->length[0] + (rule->length[1] - rule->length[0]) * smoothstep(0, 0.6, s)
                            : rule->length[1] + (rule->length[2] - rule->length[1]) * smoothstep(0.6, 1, s);
    length *= 0.86 + 0.22 * chance(state);
    dvec radial = v_unit(v_sub(root, eye)), up = v3(0, upper ? 1 : -1, 0);
    dvec out =
        v_unit(v_add(v3(0.25 * radial.x, 0, 1), v_mul(tangent, 0.85 * (s - 0.42) + 0.10 * spread(state))));
    double from = -rule->droop_deg * PI / 180, to = rule->curl_deg * PI / 180 * (0.9 + 0.2 * chance(state));
    dvec at = v_mad(v_mad(root, up, -0.05), out, -0.08 + 0.08 * spread(state)), points[POINTS], sides[POINTS];
    for (int k = 0; k < POINTS; k++) {
        double f = k / (POINTS - 1.0), a = from + (to - from) * pow(f, 0.9);
        dvec ahead = v_add(v_mul(out, cos(a)), v_mul(up, sin(a)));
        points[k] = at;
        sides[k] = v_unit(v_cross(ahead, v_cross(tangent, ahead)));
        if (v_dot(sides[k], tangent) < 0)
            sides[k] = v_mul(sides[k], -1);
        at = v_mad(at, ahead, length / (POINTS - 1));
    }
    add_ribbon(p, points, sides, POINTS, rule->half * (0.8 + 0.4 * chance(state)));
}

static void add_lashes(part *p, const maker *m, const char *key, bool upper)
{
    json_t *entry = recipe_get(recipe_get(m->recipe, "lashes"), key);
    lash_rule rule = {.count = recipe_index(entry, "count"),
                      .half = recipe_number(entry, "half_width_mm"),
                      .droop_deg = recipe_number(entry, "droop_deg"),
                      .curl_deg = recipe_number(entry, "curl_deg")};
    recipe_numbers(entry, "range", rule.range, 2);
    recipe_numbers(entry, "length_mm", rule.length, 3);
    double eye[3];
    recipe_numbers(recipe_get(m->recipe, "eye"), "centre", eye, 3);
    curve rim = lid_rim(m, upper);
    uint32_t state = upper ? 11 : 12;
    for (uint32_t i = 0; i < rule.count; i++)
        add_lash(p, &rim, &rule, v3(eye[0], eye[1], eye[2]), i, upper, &state);
}

void write_hair(const maker *m)
{
    part brow = build_brow(m), lashes = {0};
    add_lashes(&lashes, m, "upper", true);
    add_lashes(&lashes, m, "lower", false);
    part brow_right = part_mirrored(&brow), lashes_right = part_mirrored(&lashes);
    write_part(m, &brow, "brows.L.obj");
    write_part(m, &brow_right, "brows.R.obj");
    write_part(m, &lashes, "lashes.L.obj");
    write_part(m, &lashes_right, "lashes.R.obj");
    part_finish(&brow);
    part_finish(&brow_right);
    part_finish(&lashes);
    part_finish(&lashes_right);
}
