/* KA-25 ellipsoids and KA-26 boxes of muscle segments: building, ray and inside tests, intersection. */
#include "shapes.h"

#include "model_impl.h"
#include "vec3.h"

#define OVERLAP 1.1f /* of an ellipsoid's length and width */

/* Two triangles a face, both split along the same diagonal in the two boxes that share it; outward. The first two faces
 * are the start and the end of a segment. */
static const uint8_t box_triangle[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 7, 5}, {1, 3, 7}, {0, 2, 3}, {0, 3, 1},
                                            {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3}};
static const uint8_t box_edge[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                        {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

ris_fiber_pose ris__fiber_at_rest(const ris_model *model, const ris_muscle *muscle, uint32_t fiber)
{
    const ris_fiber *f = &model->fiber[muscle->first_fiber + fiber];
    const ris_vec3 *p = model->fiber_point + f->first_point;
    return (ris_fiber_pose){model->segment + f->first_segment, p, p, NULL, muscle->point_count - 1};
}

static ris_vec3 point_of(const ris_fiber_pose *pose, uint32_t s, ris_vec3 local)
{
    return ris__segment_point(&pose->segment[s], pose->p[s], pose->p[s + 1], pose->q[s], pose->q[s + 1],
                              pose->bulge ? pose->bulge[s] : 1.0f, local);
}

void ris__fiber_boxes(const ris_fiber_pose *pose, ris_box *out)
{
    for (uint32_t s = 0; s < pose->segment_count; ++s) {
        for (uint32_t k = 0; k < 8; ++k) {
            const ris_vec3 local = v3(k & 1 ? 0.5f : -0.5f, k & 2 ? 0.5f : -0.5f, k & 4 ? 0.5f : -0.5f);
            out[s].corner[k] = point_of(pose, s, local);
        }
    }
    for (uint32_t s = 1; s < pose->segment_count; ++s) {
        for (uint32_t k = 0; k < 8; k += 2) {
            ris_vec3 *end = &out[s - 1].corner[k + 1], *start = &out[s].corner[k];
            *end = *start = v3_scale(v3_add(*end, *start), 0.5f);
        }
    }
}

typedef struct line {
    ris_vec3 origin, direction;
} line;

/* On which side of the edge a-b the line passes. Swapping a and b flips the sign exactly, so that triangles that share an
 * edge never both miss a line nor both take it. */
static double side(const line *l, ris_vec3 a, ris_vec3 b)
{
    const dvec o = dv((double)l->origin.x, (double)l->origin.y, (double)l->origin.z);
    const dvec d = dv((double)l->direction.x, (double)l->direction.y, (double)l->direction.z);
    return dv_dot(d, dv_cross(dv_sub(dv((double)a.x, (double)a.y, (double)a.z), o),
                              dv_sub(dv((double)b.x, (double)b.y, (double)b.z), o)));
}

/* Distance of the triangle's hit in units of the direction's length, or NAN. */
static double hit_triangle(const line *l, ris_vec3 a, ris_vec3 b, ris_vec3 c)
{
    const double u = side(l, b, c), v = side(l, c, a), w = side(l, a, b);
    if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) || u + v + w == 0) {
        return NAN;
    }
    const double sum = u + v + w;
    const ris_vec3 at = v3_add(v3_add(v3_scale(a, (float)(u / sum)), v3_scale(b, (float)(v / sum))),
                               v3_scale(c, (float)(w / sum)));
    return (double)(v3_dot(v3_sub(at, l->origin), l->direction) / v3_dot(l->direction, l->direction));
}

static uint32_t keep_hit(float *distance, uint32_t room, uint32_t count, float at)
{
    uint32_t slot = count < room ? count : room;
    while (slot > 0 && distance[slot - 1] > at) {
        if (slot < room) {
            distance[slot] = distance[slot - 1];
        }
        --slot;
    }
    if (slot < room) {
        distance[slot] = at;
    }
    return count + 1;
}

uint32_t ris__chain_hits(const ris_box *box, uint32_t count, ris_vec3 origin, ris_vec3 direction,
                         float *distance, uint32_t room)
{
    const line l = {origin, direction};
    uint32_t hits = 0;
    for (uint32_t s = 0; s < count; ++s) {
        const ris_vec3 *c = box[s].corner;
        for (uint32_t t = s > 0 ? 2 : 0; t < 12; ++t) {
            const uint8_t *v = box_triangle[t];
            if ((t == 2 || t == 3) && s + 1 < count) {
                continue; /* between two boxes: inside */
            }
            const double at = hit_triangle(&l, c[v[0]], c[v[1]], c[v[2]]);
            hits = at > 0 ? keep_hit(distance, room, hits, (float)at) : hits;
        }
    }
    return hits;
}

bool ris__box_inside(const ris_box *box, ris_vec3 p)
{
    return ris__chain_hits(box, 1, p, v3(0.5773f, 0.6211f, 0.5301f), NULL, 0) & 1;
}

static void extent(const ris_box *box, ris_vec3 axis, float *low, float *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (uint32_t k = 0; k < 8; ++k) {
        const float x = v3_dot(box->corner[k], axis);
        *low = f_min(*low, x);
        *high = f_max(*high, x);
    }
}

static bool separates(const ris_box *a, const ris_box *b, ris_vec3 axis)
{
    float low[2], high[2];
    if (!(v3_dot(axis, axis) > 1e-12f)) {
        return false;
    }
    extent(a, axis, &low[0], &high[0]);
    extent(b, axis, &low[1], &high[1]);
    return high[0] < low[1] || high[1] < low[0];
}

static ris_vec3 face_normal(const ris_box *box, uint32_t triangle)
{
    const uint8_t *v = box_triangle[triangle];
    const ris_vec3 *c = box->corner;
    return v3_cross(v3_sub(c[v[1]], c[v[0]]), v3_sub(c[v[2]], c[v[0]]));
}

bool ris__boxes_meet(const ris_box *a, const ris_box *b)
{
    if (separates(a, b, v3(1, 0, 0)) || separates(a, b, v3(0, 1, 0)) || separates(a, b, v3(0, 0, 1))) {
        return false; /* nearly all pairs */
    }
    for (uint32_t t = 0; t < 12; ++t) {
        if (separates(a, b, face_normal(a, t)) || separates(a, b, face_normal(b, t))) {
            return false;
        }
    }
    for (uint32_t k = 0; k < 144; ++k) {
        const uint8_t *i = box_edge[k / 12], *j = box_edge[k % 12];
        const ris_vec3 u = v3_sub(a->corner[i[1]], a->corner[i[0]]),
                       v = v3_sub(b->corner[j[1]], b->corner[j[0]]);
        if (separates(a, b, v3_cross(u, v))) {
            return false;
        }
    }
    return true;
}

ris_ellipsoid ris__segment_ellipsoid(const ris_fiber_pose *pose, uint32_t s)
{
    const ris_vec3 none = {0};
    ris_ellipsoid e = {.centre = point_of(pose, s, none)};
    const ris_vec3 tip[3] = {point_of(pose, s, v3(0.5f, 0, 0)), point_of(pose, s, v3(0, 0.5f, 0)),
                             point_of(pose, s, v3(0, 0, 0.5f))};
    for (int k = 0; k < 3; ++k) {
        const ris_vec3 d = v3_sub(tip[k], e.centre);
        e.half[k] = v3_length(d) * (k == 1 ? 1.0f : OVERLAP);
        e.axis[k] = v3_unit_or(d, none);
    }
    return e;
}

/* In coordinates where the ellipsoid is the unit sphere. */
static ris_vec3 to_sphere(const ris_ellipsoid *e, ris_vec3 d)
{
    return v3(v3_dot(d, e->axis[0]) / e->half[0], v3_dot(d, e->axis[1]) / e->half[1],
              v3_dot(d, e->axis[2]) / e->half[2]);
}

bool ris__ellipsoid_ray(const ris_ellipsoid *e, ris_vec3 origin, ris_vec3 direction, float out[2])
{
    const ris_vec3 o = to_sphere(e, v3_sub(origin, e->centre)), d = to_sphere(e, direction);
    const float a = v3_dot(d, d), b = v3_dot(o, d), c = v3_dot(o, o) - 1.0f, root2 = b * b - a * c;
    if (!(root2 >= 0.0f) || !(a > 0.0f)) {
        return false;
    }
    const float root = sqrtf(root2);
    out[0] = (-b - root) / a;
    out[1] = (-b + root) / a;
    return true;
}

bool ris__ellipsoid_inside(const ris_ellipsoid *e, ris_vec3 p)
{
    const ris_vec3 q = to_sphere(e, v3_sub(p, e->centre));
    return v3_dot(q, q) < 1.0f;
}
