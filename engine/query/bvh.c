/* Exact closest points, rays and inside tests on a triangle mesh, over a tree of boxes. */
#include "query/query.h"

#include <stdlib.h>

#define LEAF 4

static double component(dvec p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

static dvec centre_of(const tri_mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangle + 3 * (size_t)triangle;
    dvec a = mesh->position[t[0]], b = mesh->position[t[1]], c = mesh->position[t[2]];
    return dv((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3);
}

static void bound(const bvh *tree, bvh_node *node)
{
    for (int k = 0; k < 3; k++) {
        node->low[k] = HUGE_VAL;
        node->high[k] = -HUGE_VAL;
    }
    for (uint32_t i = node->first; i < node->first + node->count; i++)
        for (int j = 0; j < 3; j++) {
            dvec p = tree->mesh->position[tree->mesh->triangle[3 * (size_t)tree->order[i] + j]];
            for (int k = 0; k < 3; k++) {
                node->low[k] = fmin(node->low[k], component(p, k));
                node->high[k] = fmax(node->high[k], component(p, k));
            }
        }
}

/* Splits in the middle of the longest side (by count when that separates nothing). */
static void split(bvh *tree, uint32_t index)
{
    bvh_node *node = &tree->node[index];
    bound(tree, node);
    if (node->count <= LEAF)
        return;
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (node->high[k] - node->low[k] > node->high[axis] - node->low[axis])
            axis = k;
    double middle = 0.5 * (node->low[axis] + node->high[axis]);
    uint32_t i = node->first, j = node->first + node->count;
    while (i < j) {
        if (component(centre_of(tree->mesh, tree->order[i]), axis) < middle) {
            i++;
        } else {
            uint32_t swap = tree->order[--j];
            tree->order[j] = tree->order[i];
            tree->order[i] = swap;
        }
    }
    uint32_t left = i - node->first;
    if (left == 0 || left == node->count)
        left = node->count / 2;
    uint32_t child = tree->node_count;
    tree->node_count += 2;
    tree->node[child] = (bvh_node){.first = node->first, .count = left};
    tree->node[child + 1] = (bvh_node){.first = node->first + left, .count = node->count - left};
    node->first = child;
    node->count = 0;
    split(tree, child);
    split(tree, child + 1);
}

ris_result ris__bvh_build(bvh *out, const tri_mesh *mesh, ris_error *err)
{
    uint32_t n = mesh->triangle_count;
    *out = (bvh){.mesh = mesh};
    out->node = malloc((2 * (size_t)n + 2) * sizeof *out->node);
    out->order = malloc((n + 1) * sizeof *out->order);
    if (!out->node || !out->order) {
        ris__bvh_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a tree of %u triangles", n);
    }
    for (uint32_t i = 0; i < n; i++)
        out->order[i] = i;
    out->node[0] = (bvh_node){.first = 0, .count = n};
    out->node_count = 1;
    if (n)
        split(out, 0);
    return RIS_OK;
}

void ris__bvh_finish(bvh *tree)
{
    free(tree->node);
    free(tree->order);
    *tree = (bvh){0};
}

/* Ericson, Real-Time Collision Detection, 5.1.5. */
static dvec closest_on_triangle(dvec p, dvec a, dvec b, dvec c)
{
    dvec ab = dv_sub(b, a), ac = dv_sub(c, a), ap = dv_sub(p, a), bp = dv_sub(p, b), cp = dv_sub(p, c);
    double d1 = dv_dot(ab, ap), d2 = dv_dot(ac, ap), d3 = dv_dot(ab, bp), d4 = dv_dot(ac, bp);
    double d5 = dv_dot(ab, cp), d6 = dv_dot(ac, cp);
    if (d1 <= 0 && d2 <= 0)
        return a;
    if (d3 >= 0 && d4 <= d3)
        return b;
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return dv_mad(a, d1 / (d1 - d3), ab);
    if (d6 >= 0 && d5 <= d6)
        return c;
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return dv_mad(a, d2 / (d2 - d6), ac);
    double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return dv_mad(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), dv_sub(c, b));
    double scale = 1 / (va + vb + vc);
    return dv_mad(dv_mad(a, vb * scale, ab), vc * scale, ac);
}

static double box_distance2(const bvh_node *node, dvec p)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double x = component(p, k), d = fmax(fmax(node->low[k] - x, 0), x - node->high[k]);
        sum += d * d;
    }
    return sum;
}

/* What ris__bvh_closest_facing asks for; cosine -2 takes every triangle. */
typedef struct facing_filter {
    dvec normal;
    double cosine;
} facing_filter;

static void closest_in(const bvh *tree, uint32_t index, dvec p, const facing_filter *filter, bvh_hit *best)
{
    const bvh_node *node = &tree->node[index];
    if (node->count == 0) {
        double d0 = box_distance2(node + (node->first - index), p);
        double d1 = box_distance2(node + (node->first + 1 - index), p);
        uint32_t near = d0 <= d1 ? 0 : 1;
        if ((near ? d1 : d0) < best->distance)
            closest_in(tree, node->first + near, p, filter, best);
        if ((near ? d0 : d1) < best->distance)
            closest_in(tree, node->first + 1 - near, p, filter, best);
        return;
    }
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
        const uint32_t *t = tree->mesh->triangle + 3 * (size_t)tree->order[i];
        const dvec *v = tree->mesh->position;
        dvec q = closest_on_triangle(p, v[t[0]], v[t[1]], v[t[2]]);
        double d = dv_dot(dv_sub(p, q), dv_sub(p, q));
        if (d < best->distance &&
            dv_dot(ris__tri_normal(tree->mesh, tree->order[i]), filter->normal) >= filter->cosine)
            *best = (bvh_hit){true, tree->order[i], d, q};
    }
}

bvh_hit ris__bvh_closest_facing(const bvh *tree, dvec p, dvec normal, double cosine, double within)
{
    const facing_filter filter = {normal, cosine};
    bvh_hit best = {.distance = within * within};
    if (tree->mesh->triangle_count)
        closest_in(tree, 0, p, &filter, &best);
    best.distance = sqrt(best.distance);
    return best;
}

bvh_hit ris__bvh_closest(const bvh *tree, dvec p)
{
    return ris__bvh_closest_facing(tree, p, dv(0, 0, 0), -2, HUGE_VAL);
}

static bool ray_meets_box(const bvh_node *node, dvec origin, dvec inverse, double from, double to)
{
    for (int k = 0; k < 3; k++) {
        double i = component(inverse, k), o = component(origin, k);
        double a = (node->low[k] - o) * i, b = (node->high[k] - o) * i;
        if (isnan(a) || isnan(b))
            continue; /* parallel and on the side's plane */
        from = fmax(from, fmin(a, b));
        to = fmin(to, fmax(a, b));
    }
    return from <= to;
}

static double ray_triangle(dvec o, dvec d, dvec a, dvec b, dvec c)
{
    dvec e1 = dv_sub(b, a), e2 = dv_sub(c, a), h = dv_cross(d, e2);
    double det = dv_dot(e1, h);
    if (fabs(det) < 1e-14)
        return NAN;
    dvec s = dv_sub(o, a), q = dv_cross(s, e1);
    double u = dv_dot(s, h) / det, v = dv_dot(d, q) / det;
    return u < 0 || v < 0 || u + v > 1 ? NAN : dv_dot(e2, q) / det;
}

/* All hits of a ray, and those that leave through the front less those that enter through it. */
typedef struct ray_count {
    uint32_t crossings;
    int32_t leaving;
} ray_count;

/* count counts all hits when it is given, and then the ray is not shortened. */
static void ray_in(const bvh *tree, uint32_t index, dvec o, dvec d, dvec inverse, double from, bvh_hit *best,
                   ray_count *count)
{
    const bvh_node *node = &tree->node[index];
    if (!ray_meets_box(node, o, inverse, from, best->distance))
        return;
    if (node->count == 0) {
        ray_in(tree, node->first, o, d, inverse, from, best, count);
        ray_in(tree, node->first + 1, o, d, inverse, from, best, count);
        return;
    }
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
        const uint32_t *t = tree->mesh->triangle + 3 * (size_t)tree->order[i];
        const dvec *v = tree->mesh->position;
        double at = ray_triangle(o, d, v[t[0]], v[t[1]], v[t[2]]);
        if (!(at > from && at < best->distance))
            continue;
        if (count) {
            count->crossings++;
            count->leaving += dv_dot(ris__tri_normal(tree->mesh, tree->order[i]), d) > 0 ? 1 : -1;
        } else
            *best = (bvh_hit){true, tree->order[i], at, dv_mad(o, at, d)};
    }
}

bvh_hit ris__bvh_ray(const bvh *tree, dvec origin, dvec direction, double from, double to)
{
    bvh_hit best = {.distance = to};
    dvec inverse = dv(1 / direction.x, 1 / direction.y, 1 / direction.z);
    if (tree->mesh->triangle_count)
        ray_in(tree, 0, origin, direction, inverse, from, &best, NULL);
    return best;
}

static ray_count count_ray(const bvh *tree, dvec p, int ray)
{
    static const dvec skew[3] = {
        {0.5773, 0.6211, 0.5301}, {-0.3127, 0.8011, -0.5107}, {0.2111, -0.4433, 0.8713}};
    dvec d = dv_unit(skew[ray]), inverse = dv(1 / d.x, 1 / d.y, 1 / d.z);
    bvh_hit best = {.distance = 1e9};
    ray_count count = {0};
    if (tree->mesh->triangle_count)
        ray_in(tree, 0, p, d, inverse, 0, &best, &count);
    return count;
}

bool ris__bvh_inside(const bvh *tree, dvec p)
{
    int votes = 0;
    for (int k = 0; k < 3; k++)
        votes += count_ray(tree, p, k).crossings & 1;
    return votes >= 2;
}

int32_t ris__bvh_winding(const bvh *tree, dvec p)
{
    const int32_t a = count_ray(tree, p, 0).leaving, b = count_ray(tree, p, 1).leaving;
    if (a == b)
        return a;
    const int32_t c = count_ray(tree, p, 2).leaving, low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

double ris__bvh_depth(const bvh *tree, dvec p)
{
    double d = ris__bvh_closest(tree, p).distance;
    return ris__bvh_inside(tree, p) ? d : -d;
}
