/* Neighbourhood of the body's quads, edge loops and the mirror map (KA-02). */
#include "make_head.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_body(const topology *topo, const uint32_t quad[4])
{
    for (int k = 0; k < 4; k++)
        if (quad[k] >= topo->body_end)
            return false;
    return true;
}

static void build_quads_of(topology *topo)
{
    const base_mesh *mesh = topo->mesh;
    topo->quad_start = need(mesh->vertex_count + 1, sizeof *topo->quad_start);
    for (uint32_t f = 0; f < mesh->quad_count; f++)
        for (int k = 0; k < 4 && is_body(topo, mesh->quad[f]); k++)
            topo->quad_start[mesh->quad[f][k] + 1]++;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        topo->quad_start[i + 1] += topo->quad_start[i];
    topo->quad_of = need(topo->quad_start[mesh->vertex_count], sizeof *topo->quad_of);
    uint32_t *fill = need(mesh->vertex_count, sizeof *fill);
    for (uint32_t f = 0; f < mesh->quad_count; f++)
        for (int k = 0; k < 4 && is_body(topo, mesh->quad[f]); k++) {
            uint32_t v = mesh->quad[f][k];
            topo->quad_of[topo->quad_start[v] + fill[v]++] = f;
        }
    free(fill);
}

/* The body is a closed quad mesh: around each vertex, the next corner of each of its quads is each neighbour once. */
static void build_neighbours(topology *topo)
{
    const base_mesh *mesh = topo->mesh;
    uint32_t n = mesh->vertex_count;
    topo->edge_start = need(n + 1, sizeof *topo->edge_start);
    memcpy(topo->edge_start, topo->quad_start, (n + 1) * sizeof *topo->edge_start);
    topo->neighbour = need(topo->quad_start[n], sizeof *topo->neighbour);
    for (uint32_t v = 0; v < n; v++)
        for (uint32_t i = topo->quad_start[v]; i < topo->quad_start[v + 1]; i++) {
            const uint32_t *quad = mesh->quad[topo->quad_of[i]];
            for (int k = 0; k < 4; k++)
                if (quad[k] == v)
                    topo->neighbour[i] = quad[(k + 1) % 4];
        }
}

static const base_mesh *sort_mesh;

static int by_position(const void *a, const void *b)
{
    dvec p = sort_mesh->position[*(const uint32_t *)a], q = sort_mesh->position[*(const uint32_t *)b];
    return p.y < q.y ? -1 : p.y > q.y ? 1 : p.z < q.z ? -1 : p.z > q.z ? 1 : p.x < q.x ? -1 : p.x > q.x;
}

/* Pairs (x, y, z) with (-x, y, z): the source is symmetric to the last digit, so equality is the test. */
static void build_mirror(topology *topo)
{
    uint32_t n = topo->body_end;
    uint32_t *order = need(n, sizeof *order);
    topo->mirror = need(topo->mesh->vertex_count, sizeof *topo->mirror);
    memset(topo->mirror, 0xff, topo->mesh->vertex_count * sizeof *topo->mirror);
    for (uint32_t i = 0; i < n; i++)
        order[i] = i;
    sort_mesh = topo->mesh;
    qsort(order, n, sizeof *order, by_position);
    for (uint32_t first = 0, last; first < n; first = last) {
        dvec p = topo->mesh->position[order[first]];
        for (last = first; last < n; last++) {
            dvec q = topo->mesh->position[order[last]];
            if (q.y != p.y || q.z != p.z)
                break;
        }
        for (uint32_t i = first; i < last; i++)
            for (uint32_t k = first; k < last; k++)
                if (topo->mesh->position[order[k]].x == -topo->mesh->position[order[i]].x)
                    topo->mirror[order[i]] = order[k];
    }
    free(order);
}

void topology_build(topology *topo, const base_mesh *mesh, uint32_t body_end)
{
    topo->mesh = mesh;
    topo->body_end = body_end;
    build_quads_of(topo);
    build_neighbours(topo);
    build_mirror(topo);
}

void topology_finish(topology *topo)
{
    free(topo->quad_start);
    free(topo->quad_of);
    free(topo->edge_start);
    free(topo->neighbour);
    free(topo->mirror);
    *topo = (topology){0};
}

static bool share_quad(const topology *topo, uint32_t vertex, uint32_t a, uint32_t b)
{
    for (uint32_t i = topo->quad_start[vertex]; i < topo->quad_start[vertex + 1]; i++) {
        const uint32_t *quad = topo->mesh->quad[topo->quad_of[i]];
        bool has_a = false, has_b = false;
        for (int k = 0; k < 4; k++) {
            has_a |= quad[k] == a;
            has_b |= quad[k] == b;
        }
        if (has_a && has_b)
            return true;
    }
    return false;
}

uint32_t next_on_loop(const topology *topo, uint32_t from, uint32_t at)
{
    if (topo->edge_start[at + 1] - topo->edge_start[at] != 4)
        return NONE;
    for (uint32_t i = topo->edge_start[at]; i < topo->edge_start[at + 1]; i++) {
        uint32_t to = topo->neighbour[i];
        if (to != from && !share_quad(topo, at, from, to))
            return to;
    }
    return NONE;
}

void ring_walk(const topology *topo, uint32_t first, uint32_t second, edge_loop *out)
{
    uint32_t from = first, at = second;
    out->count = 1;
    out->vertex[0] = first;
    while (at != first) {
        if (at == NONE || out->count == 128)
            stop("the edge loop from vertices %u, %u does not close", first, second);
        out->vertex[out->count++] = at;
        uint32_t to = next_on_loop(topo, from, at);
        from = at;
        at = to;
    }
}

static void load_ring_set(const maker *m, const char *key, ring_set *set)
{
    json_t *rings = recipe_get(recipe_get(m->recipe, key), "rings");
    set->count = (uint32_t)json_array_size(rings);
    if (!set->count || set->count > MAX_RINGS)
        stop("recipe: expected 1..%d rings at \"%s\"", MAX_RINGS, key);
    for (uint32_t r = 0; r < set->count; r++) {
        json_t *pair = json_array_get(rings, r);
        uint32_t first = (uint32_t)json_integer_value(json_array_get(pair, 0));
        uint32_t second = (uint32_t)json_integer_value(json_array_get(pair, 1));
        if (first >= m->topo.body_end || second >= m->topo.body_end)
            stop("recipe: ring %u of \"%s\" leaves the body", r, key);
        ring_walk(&m->topo, first, second, &set->at[r]);
        if (set->at[r].count != set->at[0].count)
            stop("recipe: ring %u of \"%s\" has %u vertices, the first has %u", r, key, set->at[r].count,
                 set->at[0].count);
    }
}

void rings_load(maker *m)
{
    load_ring_set(m, "mouth", &m->mouth);
    load_ring_set(m, "eye", &m->eye);
    m->mouth.corner[0] = recipe_index(recipe_get(m->recipe, "mouth"), "corner_column");
    m->mouth.corner[1] = m->mouth.at[0].count - m->mouth.corner[0];
    uint32_t rim = recipe_index(recipe_get(m->recipe, "eye"), "rim_ring");
    if (rim >= m->eye.count)
        stop("recipe: rim_ring %u of %u eye rings", rim, m->eye.count);
    double low = INFINITY, high = -INFINITY;
    for (uint32_t k = 0; k < m->eye.at[rim].count; k++) {
        double x = m->mesh.position[m->eye.at[rim].vertex[k]].x;
        if (x < low) {
            low = x;
            m->eye.corner[0] = k;
        }
        if (x > high) {
            high = x;
            m->eye.corner[1] = k;
        }
    }
}
