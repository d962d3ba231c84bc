/* Where the lining goes (KA-48). A bag round the teeth cannot pass the ridges that bear them: mucosa is broken at every
 * tooth. So between the gums of lips and cheeks and those of palate and tongue the sheet crosses the ridge, and the rest is
 * laid over bone and teeth: the inner side by rays out of the mouth, then both by pushing vertices and edges along the
 * distance while the sheet is smoothed. Only the left half is reckoned. */
#include "lay_lining.h"

#include <stdlib.h>
#include <string.h>

#define CLEAR_MM 1.9      /* of a vertex from bone and teeth, aimed at */
#define EDGE_CLEAR_MM 1.2 /* of the points of an edge */
#define TONGUE_MM 1.0
#define FIRST_PASSES 4 /* that spread what the rays left */
#define PASSES 160
#define LAST_PASSES 40 /* without smoothing */
#define SMOOTHING 0.35
#define SWELLING (-0.36)   /* after each, so that the bag keeps its size (Taubin 1995) */
#define MOUTH_Y_MM (-50.0) /* of the axis that the rays leave */
#define MOUTH_Z_MM 60.0

#define SIDE_COLUMN 10 /* the top of the vestibule at the side, ... */
#define SIDE_RING 7    /* ... in front of the ramus */
#define SIDE_CLEAR_MM 0.5
#define SIDE_STEP_MM 0.25
#define SIDE_STEPS 56
#define FAR_MM 14.0 /* nothing pushes from so far, inside or out */

typedef struct near_body {
    double distance_mm; /* negative inside */
    dvec away;          /* unit */
} near_body;

static near_body ask(const bvh *body, dvec p)
{
    const bvh_hit hit = ris__bvh_closest(body, p);
    if (!hit.found || hit.distance > FAR_MM)
        return (near_body){HUGE_VAL, dv(0, 0, 0)};
    const bool inside = ris__bvh_inside(body, p);
    const dvec d = dv_sub(p, hit.at);
    const double l = dv_length(d);
    const dvec u = l > 1e-9 ? dv(d.x / l, d.y / l, d.z / l) : ris__tri_normal(body->mesh, hit.triangle);
    return inside ? (near_body){-l, dv(-u.x, -u.y, -u.z)} : (near_body){l, u};
}

enum {
    OFF_BONE = 1 << BODY_SKULL | 1 << BODY_MANDIBLE,
    OFF_TEETH = 1 << BODY_UPPER | 1 << BODY_LOWER,
    OFF_TONGUE = 1 << BODY_TONGUE
};

/* Sum of the pushes out of those bodies that are nearer than clear. */
static dvec push_at(const lining *l, dvec p, double clear, unsigned bodies)
{
    dvec sum = {0};
    for (int k = 0; k < BODY_COUNT; k++) {
        if (!(bodies & 1u << k))
            continue;
        const double want = k == BODY_TONGUE ? TONGUE_MM : clear;
        const near_body near = ask(&l->body[k], p);
        if (near.distance_mm < want)
            sum = dv_mad(sum, want - near.distance_mm, near.away);
    }
    return sum;
}

/* Oral vertices go along the ray from the axis of the mouth to where they were, as far as it is free. */
static void cast(lining *l, uint32_t i)
{
    const dvec p = l->from[i], c = dv(0, MOUTH_Y_MM, fmin(p.z, MOUTH_Z_MM));
    const dvec d = dv_sub(p, c), u = dv_unit(d);
    double far = dv_length(d);
    for (int k = 0; k < BODY_TONGUE; k++) {
        const bvh_hit hit = ris__bvh_ray(&l->body[k], c, u, 0, far + CLEAR_MM);
        if (hit.found)
            far = fmin(far, hit.distance - CLEAR_MM);
    }
    l->at[i] = dv_mad(c, far, u);
}

/* The lining at the side of the upper jaw goes sideways out of the bone, for the shortest way leads down onto the teeth;
 * the cheek below follows. */
static void slide_out(lining *l, uint32_t i)
{
    static const double share[] = {1, 0.8, 0.4};
    double aside = 0;
    dvec p = l->from[i];
    for (int step = 0; step < SIDE_STEPS && dv_length(push_at(l, p, SIDE_CLEAR_MM, OFF_BONE | OFF_TEETH)) > 0;
         step++) {
        aside += SIDE_STEP_MM;
        p.x += SIDE_STEP_MM;
    }
    for (uint32_t k = 0; k < l->count; k++)
        if (l->ring[k] == l->ring[i] && l->column[k] >= SIDE_COLUMN && l->column[k] < SIDE_COLUMN + 3 &&
            l->from[k].x >= 0)
            l->at[k].x += share[l->column[k] - SIDE_COLUMN] * aside;
}

static bool left(const lining *l, uint32_t i)
{
    return l->moves[i] && l->from[i].x >= 0;
}

static void mirror(lining *l)
{
    for (uint32_t i = 0; i < l->count; i++)
        if (left(l, i)) {
            if (l->mirror[i] == i)
                l->at[i].x = 0;
            l->at[l->mirror[i]] = dv(-l->at[i].x, l->at[i].y, l->at[i].z);
        }
}

/* Oral vertices towards the mean of their neighbours, those at the gums along the gums; of the vestibule, which lies well
 * but for single places, the way moved is smoothed instead. */
static void smooth(lining *l, double oral, bool by_place, dvec *next)
{
    for (uint32_t i = 0; i < l->count; i++) {
        next[i] = l->at[i];
        if (!left(l, i) || (by_place && l->outside[i]))
            continue;
        const bool by_shift = !by_place && (l->outside[i] || l->border[i]);
        dvec sum = {0};
        double count = 0;
        for (uint32_t e = l->start[i]; e < l->start[i + 1]; e++) {
            const uint32_t k = l->other[e];
            if (!lining_joined(l, i, k) || (l->border[i] && !l->outside[i] && !l->border[k]))
                continue;
            sum = dv_add(sum, by_shift ? dv_sub(l->at[k], l->cast_at[k]) : l->at[k]);
            count++;
        }
        if (count > 1) { /* else the end of the gums */
            const dvec base = by_shift ? dv_sub(l->at[i], l->cast_at[i]) : l->at[i];
            next[i] = dv_mad(l->at[i], by_shift ? SMOOTHING : oral,
                             dv_sub(dv(sum.x / count, sum.y / count, sum.z / count), base));
        }
    }
    for (uint32_t i = 0; i < l->count; i++)
        l->at[i] = next[i];
}

/* What an edge keeps off: one that crosses the gums only the crowns, beside the last molars nothing. */
static unsigned bodies_of(const lining *l, uint32_t a, uint32_t b)
{
    if (!lining_joined(l, a, b))
        return l->ring[a] <= SIDE_RING && l->ring[b] <= SIDE_RING ? OFF_TEETH : 0;
    return OFF_BONE | OFF_TEETH | (l->outside[a] || l->outside[b] ? 0 : OFF_TONGUE);
}

static void push(lining *l, dvec *shift, double share)
{
    for (uint32_t i = 0; i < l->count; i++)
        shift[i] = left(l, i) ? push_at(l, l->at[i], CLEAR_MM,
                                        OFF_BONE | OFF_TEETH | (l->outside[i] ? 0 : OFF_TONGUE))
                              : dv(0, 0, 0);
    for (uint32_t e = 0; e < l->edge_count; e++) {
        const uint32_t a = l->edge[e][0], b = l->edge[e][1];
        const unsigned bodies = bodies_of(l, a, b);
        for (int q = 1; q < 4; q++) {
            const double t = 0.25 * q;
            const dvec p = dv_mad(l->at[a], t, dv_sub(l->at[b], l->at[a])),
                       out = push_at(l, p, EDGE_CLEAR_MM, bodies);
            const double d = dv_length(out);
            if (d > 0) {
                shift[a] = dv_mad(shift[a], 0.5 * (1 - t), out);
                shift[b] = dv_mad(shift[b], 0.5 * t, out);
            }
        }
    }
    for (uint32_t i = 0; i < l->count; i++)
        if (left(l, i)) {
            const double d = dv_length(shift[i]);
            l->at[i] = dv_mad(l->at[i], d > 1 ? share / d : share, shift[i]);
        }
}

ris_result lining_lay(lining *l, ris_error *err)
{
    dvec *work = malloc(l->count * sizeof *work);
    if (!work)
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", l->count);
    for (uint32_t i = 0; i < l->count; i++)
        if (left(l, i)) {
            if (!l->outside[i])
                cast(l, i);
            else if (l->column[i] == SIDE_COLUMN && l->ring[i] <= SIDE_RING)
                slide_out(l, i);
        }
    mirror(l);
    for (int pass = 0; pass < FIRST_PASSES; pass++) {
        smooth(l, SMOOTHING, true, work);
        mirror(l);
        push(l, work, 0.7);
        mirror(l);
    }
    memcpy(l->cast_at, l->at, l->count * sizeof *l->at);
    for (int pass = 0; pass < PASSES + LAST_PASSES; pass++) {
        mirror(l);
        if (pass < PASSES) {
            smooth(l, SMOOTHING, false, work);
            mirror(l);
            smooth(l, SWELLING, false, work);
            mirror(l);
        }
        push(l, work, pass < PASSES ? 0.7 : 0.4);
    }
    mirror(l);
    free(work);
    return RIS_OK;
}

static double least(const lining *l, dvec p)
{
    double d = HUGE_VAL;
    for (int k = 0; k < BODY_TONGUE; k++)
        d = fmin(d, -ris__bvh_depth(&l->body[k], p));
    return d;
}

lining_report lining_measure(const lining *l)
{
    lining_report r = {.vertex_mm = HUGE_VAL, .midpoint_mm = HUGE_VAL};
    for (uint32_t i = 0; i < l->count; i++) {
        if (!left(l, i))
            continue;
        const double d = least(l, l->at[i]);
        r.buried += d < 0;
        r.moved_mm = fmax(r.moved_mm, dv_length(dv_sub(l->at[i], l->from[i])));
        if (d < r.vertex_mm) {
            r.vertex_mm = d;
            r.vertex = i;
        }
    }
    for (uint32_t e = 0; e < l->edge_count; e++) {
        const uint32_t a = l->edge[e][0], b = l->edge[e][1];
        if (!lining_joined(l, a, b))
            continue;
        const double d = least(l, dv_mad(l->at[a], 0.5, dv_sub(l->at[b], l->at[a])));
        r.buried_midpoints += d < 0;
        if (d < r.midpoint_mm) {
            r.midpoint_mm = d;
            r.edge[0] = a;
            r.edge[1] = b;
        }
    }
    return r;
}
