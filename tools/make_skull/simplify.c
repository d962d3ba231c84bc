/* Quadric edge collapse (Garland, Heckbert 1997) that keeps a manifold and the border on the mirror plane. */
#include "make_skull.h"

#include <stdlib.h>
#include <string.h>

typedef struct list {
    uint32_t *item, count, room;
} list;

typedef struct candidate {
    double cost;
    uint32_t a, b, stamp;
} candidate;

typedef struct collapser {
    tri_mesh *mesh;
    double (*quadric)[10]; /* xx xy xz xw yy yz yw zz zw ww */
    list *around;          /* live triangles of each vertex */
    bool *dead;            /* triangles */
    uint32_t *stamp;       /* of vertices, raised when they move */
    candidate *heap;
    size_t heap_count, heap_room;
    uint32_t live;
    bool failed; /* out of memory */
} collapser;

static bool push(list *l, uint32_t item)
{
    if (l->count == l->room) {
        uint32_t room = l->room ? 2 * l->room : 8, *grown = realloc(l->item, room * sizeof *grown);
        if (!grown)
            return false;
        l->item = grown;
        l->room = room;
    }
    l->item[l->count++] = item;
    return true;
}

static const uint32_t *corners(const collapser *c, uint32_t triangle)
{
    return c->mesh->triangle + 3 * (size_t)triangle;
}

static bool has_corner(const uint32_t *t, uint32_t v)
{
    return t[0] == v || t[1] == v || t[2] == v;
}

static void add_plane(double q[10], dvec n, double w, double weight)
{
    const double p[4] = {n.x, n.y, n.z, w};
    for (int i = 0, k = 0; i < 4; i++)
        for (int j = i; j < 4; j++)
            q[k++] += weight * p[i] * p[j];
}

static double evaluate(const double q[10], dvec p)
{
    return q[0] * p.x * p.x + 2 * q[1] * p.x * p.y + 2 * q[2] * p.x * p.z + 2 * q[3] * p.x +
           q[4] * p.y * p.y + 2 * q[5] * p.y * p.z + 2 * q[6] * p.y + q[7] * p.z * p.z + 2 * q[8] * p.z +
           q[9];
}

/* Least point of a quadric; false when it is not well determined. */
static bool least(const double q[10], dvec *out)
{
    dvec r0 = dv(q[0], q[1], q[2]), r1 = dv(q[1], q[4], q[5]), r2 = dv(q[2], q[5], q[7]),
         b = dv(-q[3], -q[6], -q[8]);
    dvec c = dv_cross(r1, r2);
    double det = dv_dot(r0, c), trace = q[0] + q[4] + q[7];
    if (!(fabs(det) > 1e-4 * trace * trace * trace))
        return false;
    dvec d = dv_cross(r2, r0), e = dv_cross(r0, r1);
    *out = dv((c.x * b.x + d.x * b.y + e.x * b.z) / det, (c.y * b.x + d.y * b.y + e.y * b.z) / det,
              (c.z * b.x + d.z * b.y + e.z * b.z) / det);
    return true;
}

/* Where a and b would meet, and what it costs. */
static double meeting(const collapser *c, uint32_t a, uint32_t b, dvec *out)
{
    dvec p = c->mesh->position[a], r = c->mesh->position[b], best = p,
         option[3] = {p, r, dv_mad(p, 0.5, dv_sub(r, p))};
    double q[10], cost = HUGE_VAL, length = dv_length(dv_sub(p, r));
    for (int k = 0; k < 10; k++)
        q[k] = c->quadric[a][k] + c->quadric[b][k];
    bool border = p.x == 0 || r.x == 0;
    for (int k = 0; k < 3; k++) {
        if (border && option[k].x != 0)
            continue;
        double e = evaluate(q, option[k]);
        if (e < cost) {
            cost = e;
            best = option[k];
        }
    }
    dvec o;
    if (!border && least(q, &o) && dv_length(dv_sub(o, option[2])) < length && o.x > 1e-3 &&
        evaluate(q, o) < cost) {
        cost = evaluate(q, o);
        best = o;
    }
    *out = best;
    return fmax(cost, 0) +
           2e-5 * length * length * length * length; /* keeps flat parts from long triangles */
}

static void heap_push(collapser *c, uint32_t a, uint32_t b)
{
    dvec at;
    candidate item = {meeting(c, a, b, &at), a, b, c->stamp[a] + c->stamp[b]};
    if (c->heap_count == c->heap_room) {
        size_t room = 2 * c->heap_room;
        candidate *grown = realloc(c->heap, room * sizeof *grown);
        if (!grown) {
            c->failed = true;
            return;
        }
        c->heap = grown;
        c->heap_room = room;
    }
    size_t i = c->heap_count++;
    for (; i && c->heap[(i - 1) / 2].cost > item.cost; i = (i - 1) / 2)
        c->heap[i] = c->heap[(i - 1) / 2];
    c->heap[i] = item;
}

static candidate heap_pop(collapser *c)
{
    candidate top = c->heap[0], last = c->heap[--c->heap_count];
    size_t i = 0;
    for (;;) {
        size_t k = 2 * i + 1;
        if (k >= c->heap_count)
            break;
        if (k + 1 < c->heap_count && c->heap[k + 1].cost < c->heap[k].cost)
            k++;
        if (c->heap[k].cost >= last.cost)
            break;
        c->heap[i] = c->heap[k];
        i = k;
    }
    c->heap[i] = last;
    return top;
}

/* Live triangles with both vertices. */
static uint32_t shared_triangles(const collapser *c, uint32_t a, uint32_t b)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < c->around[a].count; i++)
        n += !c->dead[c->around[a].item[i]] && has_corner(corners(c, c->around[a].item[i]), b);
    return n;
}

/* Vertices next to both: each must be of a triangle on the edge, or the collapse would pinch the surface. */
static uint32_t shared_neighbours(const collapser *c, uint32_t a, uint32_t b)
{
    uint32_t seen[64], n = 0;
    for (uint32_t i = 0; i < c->around[a].count; i++) {
        if (c->dead[c->around[a].item[i]])
            continue;
        const uint32_t *t = corners(c, c->around[a].item[i]);
        for (int k = 0; k < 3; k++) {
            bool known = t[k] == a || t[k] == b;
            for (uint32_t j = 0; j < n && !known; j++)
                known = seen[j] == t[k];
            if (known || shared_triangles(c, b, t[k]) == 0)
                continue;
            if (n == 64)
                return UINT32_MAX;
            seen[n++] = t[k];
        }
    }
    return n;
}

/* Would moving v to p turn or crush one of its triangles that stay (those without other)? */
static bool turns(const collapser *c, uint32_t v, uint32_t other, dvec p)
{
    for (uint32_t i = 0; i < c->around[v].count; i++) {
        uint32_t triangle = c->around[v].item[i];
        const uint32_t *t = corners(c, triangle);
        if (c->dead[triangle] || has_corner(t, other))
            continue;
        dvec q[3];
        for (int k = 0; k < 3; k++)
            q[k] = t[k] == v ? p : c->mesh->position[t[k]];
        dvec n = dv_cross(dv_sub(q[1], q[0]), dv_sub(q[2], q[0])), old = ris__tri_normal(c->mesh, triangle);
        double longest = 0, area = dv_length(n);
        for (int k = 0; k < 3; k++)
            longest = fmax(longest, dv_length(dv_sub(q[k], q[(k + 1) % 3])));
        if (dv_dot(n, old) < 0.3 * area || area < 0.12 * longest * longest)
            return true;
    }
    return false;
}

static bool allowed(const collapser *c, uint32_t a, uint32_t b, dvec p)
{
    uint32_t triangles = shared_triangles(c, a, b);
    bool border_a = c->mesh->position[a].x == 0, border_b = c->mesh->position[b].x == 0;
    if (triangles == 0 || triangles > 2 || (border_a && border_b && triangles != 1))
        return false;
    return shared_neighbours(c, a, b) == triangles && !turns(c, a, b, p) && !turns(c, b, a, p);
}

static void collapse(collapser *c, uint32_t a, uint32_t b, dvec p)
{
    c->mesh->position[a] = p;
    for (int k = 0; k < 10; k++)
        c->quadric[a][k] += c->quadric[b][k];
    for (uint32_t i = 0; i < c->around[b].count; i++) {
        uint32_t triangle = c->around[b].item[i], *t = c->mesh->triangle + 3 * (size_t)triangle;
        if (c->dead[triangle])
            continue;
        if (has_corner(t, a)) {
            c->dead[triangle] = true;
            c->live--;
            continue;
        }
        for (int k = 0; k < 3; k++)
            t[k] = t[k] == b ? a : t[k];
        if (!push(&c->around[a], triangle))
            c->failed = true;
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < c->around[a].count; i++)
        if (!c->dead[c->around[a].item[i]])
            c->around[a].item[kept++] = c->around[a].item[i];
    c->around[a].count = kept;
    c->around[b].count = 0;
    c->stamp[a]++;
    c->stamp[b] += 1u << 20;
    for (uint32_t i = 0; i < kept; i++) {
        const uint32_t *t = corners(c, c->around[a].item[i]);
        for (int k = 0; k < 3; k++)
            if (t[k] != a)
                heap_push(c, a, t[k]);
    }
}

static void run(collapser *c, uint32_t target)
{
    const tri_mesh *mesh = c->mesh;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = corners(c, i);
        dvec n = dv_cross(dv_sub(mesh->position[t[1]], mesh->position[t[0]]),
                          dv_sub(mesh->position[t[2]], mesh->position[t[0]]));
        double area = 0.5 * dv_length(n);
        n = dv_unit(n);
        for (int k = 0; k < 3; k++) {
            add_plane(c->quadric[t[k]], n, -dv_dot(n, mesh->position[t[0]]), area / 3);
            if (!push(&c->around[t[k]], i))
                c->failed = true;
        }
    }
    for (uint32_t i = 0; i < mesh->triangle_count && !c->failed; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t a = corners(c, i)[k], b = corners(c, i)[(k + 1) % 3];
            if (a < b || shared_triangles(c, a, b) == 1)
                heap_push(c, a, b);
        }
    while (c->live > target && c->heap_count && !c->failed) {
        candidate top = heap_pop(c);
        dvec at;
        if (top.stamp != c->stamp[top.a] + c->stamp[top.b] || c->around[top.a].count == 0 ||
            c->around[top.b].count == 0)
            continue;
        meeting(c, top.a, top.b, &at);
        if (allowed(c, top.a, top.b, at))
            collapse(c, top.a, top.b, at);
    }
}

/* Drops dead triangles and unused vertices. */
static void compact(const collapser *c, uint32_t *renumber)
{
    tri_mesh *mesh = c->mesh;
    uint32_t triangles = 0, vertices = 0;
    memset(renumber, 0xff, mesh->vertex_count * sizeof *renumber);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; !c->dead[i] && k < 3; k++)
            renumber[corners(c, i)[k]] = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        if (renumber[i] == 0) {
            mesh->position[vertices] = mesh->position[i];
            renumber[i] = vertices++;
        }
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        if (c->dead[i])
            continue;
        for (int k = 0; k < 3; k++)
            mesh->triangle[3 * (size_t)triangles + k] = renumber[corners(c, i)[k]];
        triangles++;
    }
    mesh->triangle_count = triangles;
    mesh->vertex_count = vertices;
}

ris_result mesh_simplify(tri_mesh *mesh, uint32_t target, ris_error *err)
{
    uint32_t n = mesh->vertex_count;
    collapser c = {.mesh = mesh, .live = mesh->triangle_count, .heap_room = 1024};
    c.quadric = calloc((size_t)n + 1, sizeof *c.quadric);
    c.around = calloc((size_t)n + 1, sizeof *c.around);
    c.dead = calloc((size_t)mesh->triangle_count + 1, sizeof *c.dead);
    c.stamp = calloc((size_t)n + 1, sizeof *c.stamp);
    c.heap = malloc(c.heap_room * sizeof *c.heap);
    c.failed = !c.quadric || !c.around || !c.dead || !c.stamp || !c.heap;
    if (!c.failed)
        run(&c, target);
    for (uint32_t i = 0; c.around && i < n; i++)
        free(c.around[i].item);
    if (!c.failed)
        compact(&c, c.stamp);
    free(c.quadric);
    free(c.around);
    free(c.dead);
    free(c.stamp);
    free(c.heap);
    return c.failed
               ? ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the simplification of %u vertices", n)
               : RIS_OK;
}
