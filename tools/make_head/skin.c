/* Cutting head and neck out of the body, and the Frankfort frame (KA-01). */
#include "make_head.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void frame_build(maker *m)
{
    dvec po = m->mesh.position[recipe_index(m->recipe, "porion")];
    dvec or = m->mesh.position[recipe_index(m->recipe, "orbitale")];
    m->frame.origin = v3(0, po.y, po.z);
    m->frame.front = v_unit(v3(0, or.y - po.y, or.z - po.z));
    m->frame.up = v_cross(m->frame.front, v3(1, 0, 0));
}

dvec to_head(const head_frame *frame, dvec p)
{
    dvec d = v_sub(p, frame->origin);
    return v3(p.x, v_dot(d, frame->up), v_dot(d, frame->front));
}

static bool on_ring(const edge_loop *cut, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < cut->count; i++) {
        uint32_t p = cut->vertex[i], q = cut->vertex[(i + 1) % cut->count];
        if ((p == a && q == b) || (p == b && q == a))
            return true;
    }
    return false;
}

/* Marks the quads on the seed's side of the ring. */
static uint8_t *flood_quads(const maker *m, const edge_loop *cut, uint32_t seed)
{
    const topology *topo = &m->topo;
    uint8_t *in = need(m->mesh.quad_count, 1);
    uint32_t *stack = need(m->mesh.quad_count, sizeof *stack), depth = 0;
    in[stack[depth++] = topo->quad_of[topo->quad_start[seed]]] = 1;
    while (depth) {
        const uint32_t *quad = m->mesh.quad[stack[--depth]];
        for (int k = 0; k < 4; k++) {
            uint32_t a = quad[k], b = quad[(k + 1) % 4];
            if (on_ring(cut, a, b))
                continue;
            for (uint32_t i = topo->quad_start[a]; i < topo->quad_start[a + 1]; i++) {
                uint32_t f = topo->quad_of[i];
                const uint32_t *q = m->mesh.quad[f];
                if (!in[f] && (q[0] == b || q[1] == b || q[2] == b || q[3] == b))
                    in[stack[depth++] = f] = 1;
            }
        }
    }
    free(stack);
    return in;
}

static void number_vertices(maker *m, const uint8_t *in)
{
    skin *s = &m->skin;
    s->index_of = need(m->mesh.vertex_count, sizeof *s->index_of);
    memset(s->index_of, 0xff, m->mesh.vertex_count * sizeof *s->index_of);
    for (uint32_t f = 0; f < m->mesh.quad_count; f++)
        for (int k = 0; k < 4 && in[f]; k++)
            s->index_of[m->mesh.quad[f][k]] = 0;
    for (uint32_t i = 0; i < m->mesh.vertex_count; i++)
        if (s->index_of[i] == 0)
            s->index_of[i] = s->vertex_count++;
    s->base = need(s->vertex_count, sizeof *s->base);
    s->mirror = need(s->vertex_count, sizeof *s->mirror);
    s->position = need(s->vertex_count, sizeof *s->position);
    for (uint32_t i = 0; i < m->mesh.vertex_count; i++)
        if (s->index_of[i] != NONE)
            s->base[s->index_of[i]] = i;
    for (uint32_t i = 0; i < s->vertex_count; i++) {
        uint32_t other = m->topo.mirror[s->base[i]];
        if (other == NONE || s->index_of[other] == NONE)
            stop("vertex %u has no mirror", s->base[i]);
        s->mirror[i] = s->index_of[other];
        s->position[i] = m->mesh.position[s->base[i]];
    }
}

static double corner_distance(const skin *s, const uint32_t quad[4], int a, int b)
{
    return v_length(v_sub(s->position[quad[a]], s->position[quad[b]]));
}

/* Turns a quad so that the diagonal 0-2 is the shorter one; a right quad follows its left twin, so that splitting
 * along 0-2 is mirror-symmetric. Returns the first corner. */
static int first_corner(const skin *s, const uint32_t quad[4])
{
    uint32_t q[4];
    double x = 0;
    for (int k = 0; k < 4; k++) {
        x += s->position[quad[k]].x;
        q[k] = quad[k];
    }
    for (int k = 0; k < 4 && x < 0; k++)
        q[k] = s->mirror[quad[k]];
    int odd = corner_distance(s, q, 1, 3) < corner_distance(s, q, 0, 2);
    return q[odd] < q[odd + 2] ? odd : odd + 2;
}

static void take_quads(maker *m, const uint8_t *in)
{
    skin *s = &m->skin;
    for (uint32_t f = 0; f < m->mesh.quad_count; f++)
        s->quad_count += in[f];
    s->quad = need(s->quad_count, sizeof *s->quad);
    s->quad_uv = need(s->quad_count, sizeof *s->quad_uv);
    for (uint32_t f = 0, n = 0; f < m->mesh.quad_count; f++) {
        if (!in[f])
            continue;
        uint32_t quad[4];
        for (int k = 0; k < 4; k++)
            quad[k] = s->index_of[m->mesh.quad[f][k]];
        int first = first_corner(s, quad);
        for (int k = 0; k < 4; k++) {
            s->quad[n][k] = quad[(first + k) % 4];
            s->quad_uv[n][k] = m->mesh.quad_uv[f][(first + k) % 4];
        }
        n++;
    }
}

static void build_normals(skin *s)
{
    s->normal = need(s->vertex_count, sizeof *s->normal);
    for (uint32_t f = 0; f < s->quad_count; f++) {
        const uint32_t *q = s->quad[f];
        dvec n =
            v_cross(v_sub(s->position[q[2]], s->position[q[0]]), v_sub(s->position[q[3]], s->position[q[1]]));
        for (int k = 0; k < 4; k++)
            s->normal[q[k]] = v_add(s->normal[q[k]], n);
    }
    for (uint32_t i = 0; i < s->vertex_count; i++)
        s->normal[i] = v_unit(s->normal[i]);
}

void skin_cut(maker *m)
{
    edge_loop cut;
    double edge[2];
    recipe_numbers(m->recipe, "neck_ring", edge, 2);
    ring_walk(&m->topo, (uint32_t)edge[0], (uint32_t)edge[1], &cut);
    uint8_t *in = flood_quads(m, &cut, recipe_index(m->recipe, "head_seed"));
    number_vertices(m, in);
    take_quads(m, in);
    build_normals(&m->skin);
    free(in);
}

void skin_finish(skin *s)
{
    free(s->base);
    free(s->index_of);
    free(s->mirror);
    free(s->position);
    free(s->normal);
    free(s->quad);
    free(s->quad_uv);
    free(s->depth_mm);
    free(s->jaw_weight);
    free(s->outer);
    for (uint32_t i = 0; i < s->region_count; i++)
        free(s->regions[i].has);
    *s = (skin){0};
}

static bool triangle_is_outer(const skin *s, const uint32_t t[3])
{
    return s->outer[t[0]] && s->outer[t[1]] && s->outer[t[2]];
}

/* Height over x, y inside a triangle; false outside it. */
static bool triangle_at(const skin *s, const uint32_t t[3], double x, double y, double w[3])
{
    dvec a = s->position[t[0]], b = s->position[t[1]], c = s->position[t[2]];
    double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (fabs(area) < 1e-12)
        return false;
    w[1] = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
    w[2] = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
    w[0] = 1 - w[1] - w[2];
    return w[0] >= -1e-9 && w[1] >= -1e-9 && w[2] >= -1e-9;
}

static dvec weighted(const dvec *values, const uint32_t t[3], const double w[3])
{
    return v_add(v_add(v_mul(values[t[0]], w[0]), v_mul(values[t[1]], w[1])), v_mul(values[t[2]], w[2]));
}

dvec skin_project(const skin *s, double x, double y, dvec *normal)
{
    dvec best = v3(0, 0, -INFINITY);
    for (uint32_t i = 0; i < s->quad_count * 2; i++) {
        const uint32_t *q = s->quad[i / 2];
        uint32_t t[3] = {q[0], q[1 + i % 2], q[2 + i % 2]};
        double w[3];
        if (!triangle_is_outer(s, t) || !triangle_at(s, t, x, y, w))
            continue;
        dvec p = weighted(s->position, t, w);
        if (p.z > best.z) {
            best = p;
            if (normal)
                *normal = v_unit(weighted(s->normal, t, w));
        }
    }
    if (best.z == -INFINITY)
        stop("no skin in front of x %.2f, y %.2f", x, y);
    return best;
}

static void nearest_weights(dvec p, dvec a, dvec b, dvec c, double w[3])
{
    dvec ab = v_sub(b, a), ac = v_sub(c, a), ap = v_sub(p, a);
    double d00 = v_dot(ab, ab), d01 = v_dot(ab, ac), d11 = v_dot(ac, ac), d20 = v_dot(ap, ab),
           d21 = v_dot(ap, ac);
    double det = d00 * d11 - d01 * d01;
    w[1] = (d11 * d20 - d01 * d21) / det;
    w[2] = (d00 * d21 - d01 * d20) / det;
    w[0] = 1 - w[1] - w[2];
    if (w[0] >= 0 && w[1] >= 0 && w[2] >= 0)
        return;
    dvec corner[3] = {a, b, c};
    double best = INFINITY, kept[3] = {1, 0, 0};
    for (int k = 0; k < 3; k++) {
        dvec e = v_sub(corner[(k + 1) % 3], corner[k]);
        double t = clamp(v_dot(v_sub(p, corner[k]), e) / v_dot(e, e), 0, 1);
        double d = v_length(v_sub(p, v_mad(corner[k], e, t)));
        if (d < best) {
            best = d;
            kept[k] = 1 - t;
            kept[(k + 1) % 3] = t;
            kept[(k + 2) % 3] = 0;
        }
    }
    memcpy(w, kept, sizeof kept);
}

dvec skin_nearest(const skin *s, dvec p, dvec *normal)
{
    dvec best = p;
    double nearest = INFINITY;
    for (uint32_t i = 0; i < s->quad_count * 2; i++) {
        const uint32_t *q = s->quad[i / 2];
        uint32_t t[3] = {q[0], q[1 + i % 2], q[2 + i % 2]};
        double w[3];
        if (!triangle_is_outer(s, t))
            continue;
        nearest_weights(p, s->position[t[0]], s->position[t[1]], s->position[t[2]], w);
        dvec at = weighted(s->position, t, w);
        double d = v_length(v_sub(at, p));
        if (d < nearest) {
            nearest = d;
            best = at;
            if (normal)
                *normal = v_unit(weighted(s->normal, t, w));
        }
    }
    return best;
}
