/* Marching tetrahedra of the left half of a bone, on cubes cut into six along the diagonal: always a
 * manifold. */
#include "make_skull.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK 4

typedef struct lattice {
    dvec low;
    double step;
    int nx, ny, nz;
    float *value;
    int32_t *edge; /* vertex on the edge from a node in direction 1..7, or -1 (node x 7) */
    tri_mesh *out;
    uint32_t vertex_room, triangle_room;
    bool full;
} lattice;

static size_t node_at(const lattice *l, int x, int y, int z)
{
    return ((size_t)z * l->ny + y) * l->nx + x;
}

static dvec place(const lattice *l, int x, int y, int z)
{
    return dv(l->low.x + x * l->step, l->low.y + y * l->step, l->low.z + z * l->step);
}

/* Blocks far from the surface take the distance of their middle. */
static void sample(const lattice *l, const solid *s)
{
    for (int z = 0; z < l->nz; z += BLOCK)
        for (int y = 0; y < l->ny; y += BLOCK)
            for (int x = 0; x < l->nx; x += BLOCK) {
                double half = 0.5 * (BLOCK - 1), reach = half * sqrt(3) * l->step;
                dvec middle = dv_add(place(l, x, y, z), dv(half * l->step, half * l->step, half * l->step));
                double d = solid_distance(s, middle);
                bool far = fabs(d) > 2.2 * reach + l->step;
                for (int k = 0; k < BLOCK * BLOCK * BLOCK; k++) {
                    int i = x + k % BLOCK, j = y + k / BLOCK % BLOCK, m = z + k / (BLOCK * BLOCK);
                    if (i >= l->nx || j >= l->ny || m >= l->nz)
                        continue;
                    double v = far ? d : solid_distance(s, place(l, i, j, m));
                    l->value[node_at(l, i, j, m)] = fabs(v) < 1e-6 ? 1e-6f : (float)v;
                }
            }
}

static int32_t vertex_on(lattice *l, size_t a, size_t b, const int ca[3], const int cb[3])
{
    if (b < a) {
        size_t swap = a;
        const int *c = ca;
        a = b;
        b = swap;
        ca = cb;
        cb = c;
    }
    int direction = (cb[0] - ca[0]) + 2 * (cb[1] - ca[1]) + 4 * (cb[2] - ca[2]);
    int32_t *known = &l->edge[a * 7 + (size_t)direction - 1];
    if (*known >= 0)
        return *known;
    if (l->out->vertex_count == l->vertex_room) {
        l->full = true;
        return 0;
    }
    double t = l->value[a] / ((double)l->value[a] - l->value[b]);
    t = fmax(0.12, fmin(0.88, t)); /* no slivers; the vertex is moved onto the surface later */
    dvec p = place(l, ca[0], ca[1], ca[2]), q = place(l, cb[0], cb[1], cb[2]);
    l->out->position[l->out->vertex_count] = dv_mad(p, t, dv_sub(q, p));
    return *known = (int32_t)l->out->vertex_count++;
}

static void emit(lattice *l, int32_t a, int32_t b, int32_t c)
{
    if (l->out->triangle_count == l->triangle_room) {
        l->full = true;
        return;
    }
    uint32_t *t = l->out->triangle + 3 * (size_t)l->out->triangle_count++;
    t[0] = (uint32_t)a;
    t[1] = (uint32_t)b;
    t[2] = (uint32_t)c;
}

/* corner: four lattice corners in positive orientation. */
static void march_tetrahedron(lattice *l, int corner[4][3])
{
    size_t node[4];
    int order[4], inside = 0, n = 0;
    for (int k = 0; k < 4; k++)
        node[k] = node_at(l, corner[k][0], corner[k][1], corner[k][2]);
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < 4; k++)
            if ((l->value[node[k]] < 0) == (pass == 0)) {
                order[n++] = k;
                inside += pass == 0;
            }
    if (inside == 0 || inside == 4)
        return;
    int odd = 0;
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            odd ^= order[i] > order[j];
    if (odd) { /* keep positive orientation by an exchange within one side */
        int at = inside == 3 ? 0 : 2, swap = order[at];
        order[at] = order[at + 1];
        order[at + 1] = swap;
    }
#define ON(i, j) vertex_on(l, node[order[i]], node[order[j]], corner[order[i]], corner[order[j]])
    if (inside == 1) {
        emit(l, ON(0, 1), ON(0, 2), ON(0, 3));
    } else if (inside == 3) { /* (3, 0, 1, 2) is an odd order, so this one faces away from the inside */
        emit(l, ON(3, 0), ON(3, 1), ON(3, 2));
    } else {
        int32_t ac = ON(0, 2), ad = ON(0, 3), bd = ON(1, 3), bc = ON(1, 2);
        emit(l, ac, ad, bd);
        emit(l, ac, bd, bc);
    }
#undef ON
}

static void march(lattice *l)
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int z = 0; z + 1 < l->nz; z++)
        for (int y = 0; y + 1 < l->ny; y++)
            for (int x = 0; x + 1 < l->nx; x++) {
                int below = 0;
                for (int k = 0; k < 8; k++)
                    below += l->value[node_at(l, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] < 0;
                for (int p = 0; below % 8 && p < 6; p++) {
                    int corner[4][3] = {{x, y, z}, {x, y, z}, {x, y, z}, {x + 1, y + 1, z + 1}};
                    corner[1][order[p][0]]++;
                    corner[2][order[p][0]]++;
                    corner[2][order[p][1]]++;
                    for (int k = 0; p >= 3 && k < 3; k++) { /* odd permutation */
                        int swap = corner[1][k];
                        corner[1][k] = corner[2][k];
                        corner[2][k] = swap;
                    }
                    march_tetrahedron(l, corner);
                }
            }
}

ris_result mesh_half(const solid *s, dvec low, dvec high, double step, tri_mesh *out, ris_error *err)
{
    *out = (tri_mesh){0};
    lattice l = {.low = dv(0, low.y, low.z), .step = step, .out = out};
    l.nx = (int)(high.x / step) + 2;
    l.ny = (int)((high.y - low.y) / step) + 2;
    l.nz = (int)((high.z - low.z) / step) + 2;
    size_t nodes = (size_t)l.nx * l.ny * l.nz;
    l.vertex_room = 600000;
    l.triangle_room = 1200000;
    l.value = malloc(nodes * sizeof *l.value);
    l.edge = malloc(nodes * 7 * sizeof *l.edge);
    out->position = malloc(l.vertex_room * sizeof *out->position);
    out->triangle = malloc((size_t)l.triangle_room * 3 * sizeof *out->triangle);
    ris_result result = RIS_OK;
    if (!l.value || !l.edge || !out->position || !out->triangle) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a lattice of %zu nodes", nodes);
    } else {
        memset(l.edge, 0xff, nodes * 7 * sizeof *l.edge);
        sample(&l, s);
        march(&l);
        if (l.full)
            result = ris_fail(err, RIS_ERROR_FAILED, "the %s has more than %u triangles at %g mm", s->name,
                              l.triangle_room, step);
    }
    free(l.value);
    free(l.edge);
    if (result != RIS_OK)
        ris__tri_finish(out);
    return result;
}

static void to_surface(dvec *p, const solid *s, double limit)
{
    for (int i = 0; i < 2; i++) {
        double d = solid_distance(s, *p);
        dvec g = solid_gradient(s, *p);
        double scale = -d / fmax(dv_dot(g, g), 0.25), move = fabs(scale) * dv_length(g);
        if (move > limit)
            scale *= limit / move;
        dvec q = dv_mad(*p, scale, g);
        if (p->x == 0 || q.x < 0)
            q.x = 0;
        *p = q;
    }
}

void mesh_project(tri_mesh *half, const solid *s, double limit_mm)
{
    for (uint32_t i = 0; i < half->vertex_count; i++) {
        bool middle = half->position[i].x == 0;
        to_surface(&half->position[i], s, limit_mm);
        if (!middle && half->position[i].x < 1e-3)
            half->position[i].x = 1e-3; /* only border vertices lie on the mirror plane */
    }
}

void mesh_round(tri_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        dvec *p = &mesh->position[i];
        *p = dv(round(p->x * 1e4) / 1e4, round(p->y * 1e4) / 1e4, round(p->z * 1e4) / 1e4);
    }
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

ris_result mesh_keep_largest(tri_mesh *mesh, ris_error *err)
{
    uint32_t n = mesh->vertex_count, *parent = malloc((n + 1) * sizeof *parent),
             *size = calloc(n + 1, sizeof *size);
    if (!parent || !size) {
        free(parent);
        free(size);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", n);
    }
    for (uint32_t i = 0; i < n; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
        parent[root_of(parent, mesh->triangle[i])] = root_of(parent, mesh->triangle[i - i % 3]);
    for (uint32_t i = 0; i < n; i++)
        size[root_of(parent, i)]++;
    uint32_t best = 0, kept = 0, count = 0;
    for (uint32_t i = 0; i < n; i++)
        if (size[i] > size[best])
            best = i;
    for (uint32_t i = 0; i < n; i++) { /* size becomes the new index */
        bool keep = root_of(parent, i) == best;
        parent[i] = keep ? best : parent[i];
        size[i] = keep ? kept : UINT32_MAX;
        if (keep)
            mesh->position[kept++] = mesh->position[i];
    }
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        uint32_t t[3];
        for (int k = 0; k < 3; k++)
            t[k] = size[mesh->triangle[3 * (size_t)i + k]];
        if (t[0] != UINT32_MAX)
            memcpy(mesh->triangle + 3 * (size_t)count++, t, sizeof t);
    }
    mesh->vertex_count = kept;
    mesh->triangle_count = count;
    free(parent);
    free(size);
    return RIS_OK;
}

ris_result mesh_mirror(const tri_mesh *half, tri_mesh *out, ris_error *err)
{
    uint32_t n = half->vertex_count, *twin = malloc((n + 1) * sizeof *twin);
    *out = (tri_mesh){0};
    out->position = malloc((2 * (size_t)n + 1) * sizeof *out->position);
    out->triangle = malloc((6 * (size_t)half->triangle_count + 1) * sizeof *out->triangle);
    if (!twin || !out->position || !out->triangle) {
        free(twin);
        ris__tri_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", 2 * n);
    }
    memcpy(out->position, half->position, n * sizeof *out->position);
    out->vertex_count = n;
    for (uint32_t i = 0; i < n; i++) {
        dvec p = half->position[i];
        twin[i] = p.x == 0 ? i : out->vertex_count;
        if (p.x != 0)
            out->position[out->vertex_count++] = dv(-p.x, p.y, p.z);
    }
    for (uint32_t i = 0; i < half->triangle_count; i++) {
        const uint32_t *t = half->triangle + 3 * (size_t)i;
        uint32_t *a = out->triangle + 6 * (size_t)i;
        memcpy(a, t, 3 * sizeof *a);
        a[3] = twin[t[0]];
        a[4] = twin[t[2]];
        a[5] = twin[t[1]];
    }
    out->triangle_count = 2 * half->triangle_count;
    free(twin);
    return RIS_OK;
}
