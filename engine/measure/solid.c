/* Closed components of a mesh (KA-04's bones, KA-06's parts) with rays for inside and distances for depth. Teeth are
 * sixteen crowns in one mesh, an eye is open at its back, a cornea is a cap: each is made a solid of its own. */
#include "measure/solid.h"

#include <stdlib.h>
#include <string.h>

typedef struct edge {
    uint32_t a, b;
} edge;

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static int compare_edges(const void *left, const void *right)
{
    const edge *x = left, *y = right;
    if (x->a != y->a) {
        return x->a < y->a ? -1 : 1;
    }
    return (x->b > y->b) - (x->b < y->b);
}

/* Edges whose other direction no triangle has. The caller frees. */
static edge *find_border(const tri_mesh *mesh, uint32_t *out_count)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    edge *all = malloc((count + 1) * sizeof *all), *border = malloc((count + 1) * sizeof *border);
    *out_count = 0;
    if (!all || !border) {
        free(all);
        free(border);
        return NULL;
    }
    for (size_t i = 0; i < count; ++i) {
        all[i] = (edge){mesh->triangle[i], mesh->triangle[i % 3 == 2 ? i - 2 : i + 1]};
    }
    qsort(all, count, sizeof *all, compare_edges);
    for (size_t i = 0; i < count; ++i) {
        const edge twin = {all[i].b, all[i].a};
        if (!bsearch(&twin, all, count, sizeof *all, compare_edges)) {
            border[(*out_count)++] = all[i];
        }
    }
    free(all);
    return border;
}

/* Puts a vertex in the middle of every hole (or at apex) and a fan to it. The mesh must have room for as many more
 * vertices and triangles as border edges. */
static ris_result cap_holes(tri_mesh *mesh, const edge *border, uint32_t border_count, const dvec *apex)
{
    const uint32_t n = mesh->vertex_count;
    uint32_t *parent = malloc((n + 1) * sizeof *parent), *middle = calloc(n + 1, sizeof *middle);
    uint32_t *size = calloc(n + 1, sizeof *size);
    const bool ok = parent && middle && size;
    for (uint32_t i = 0; ok && i < n; ++i) {
        parent[i] = i;
    }
    for (uint32_t k = 0; ok && k < border_count; ++k) {
        parent[root_of(parent, border[k].a)] = root_of(parent, border[k].b);
    }
    for (uint32_t k = 0; ok && k < border_count; ++k) {
        const uint32_t root = root_of(parent, border[k].a);
        if (size[root]++ == 0) {
            middle[root] = mesh->vertex_count++;
            mesh->position[middle[root]] = dv(0, 0, 0);
        }
        dvec *sum = &mesh->position[middle[root]];
        *sum = dv_add(*sum, mesh->position[border[k].a]); /* every border vertex starts one border edge */
        uint32_t *t = mesh->triangle + 3 * (size_t)mesh->triangle_count++;
        t[0] = border[k].b;
        t[1] = border[k].a;
        t[2] = middle[root];
    }
    for (uint32_t i = 0; ok && i < n; ++i) {
        if (size[i]) {
            dvec *m = &mesh->position[middle[i]];
            *m = apex ? *apex : dv(m->x / size[i], m->y / size[i], m->z / size[i]);
        }
    }
    free(parent);
    free(middle);
    free(size);
    return ok ? RIS_OK : RIS_ERROR_MEMORY;
}

/* Number of the component of every vertex; how many there are. */
static uint32_t number_components(const tri_mesh *mesh, uint32_t *component)
{
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        component[i] = i;
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i += 3) {
        for (int k = 1; k < 3; ++k) {
            const uint32_t a = root_of(component, mesh->triangle[i]);
            const uint32_t b = root_of(component, mesh->triangle[i + k]);
            /* towards the lower vertex, so that every root comes before its members */
            component[a < b ? b : a] = a < b ? a : b;
        }
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        component[i] = component[i] == i ? count++ : component[component[i]];
    }
    return count;
}

/* The triangles [0, limit) of mesh that belong to a component, on the mesh's own positions. */
static ris_result pick(const tri_mesh *mesh, const uint32_t *component, uint32_t which, uint32_t limit,
                       tri_mesh *out)
{
    *out = (tri_mesh){.vertex_count = mesh->vertex_count, .position = mesh->position};
    uint32_t count = 0;
    for (uint32_t t = 0; t < limit; ++t) {
        count += component[mesh->triangle[3 * (size_t)t]] == which;
    }
    out->triangle = malloc(((size_t)count + 1) * 3 * sizeof *out->triangle);
    if (!out->triangle) {
        return RIS_ERROR_MEMORY;
    }
    for (uint32_t t = 0; t < limit; ++t) {
        const uint32_t *v = mesh->triangle + 3 * (size_t)t;
        if (component[v[0]] == which) {
            memcpy(out->triangle + 3 * (size_t)out->triangle_count++, v, 3 * sizeof *v);
        }
    }
    return RIS_OK;
}

static ris_result split(ris_solids *solids, const tri_mesh *mesh, uint32_t surface_count, ris_error *err)
{
    uint32_t *component = malloc(((size_t)mesh->vertex_count + 1) * sizeof *component);
    if (!component) {
        return RIS_ERROR_MEMORY;
    }
    const uint32_t count = number_components(mesh, component), old = solids->count;
    ris_solid *grown = realloc(solids->solid, ((size_t)old + count + 1) * sizeof *grown);
    ris_result result = grown ? RIS_OK : RIS_ERROR_MEMORY;
    if (grown) {
        solids->solid = grown;
        memset(grown + old, 0, count * sizeof *grown);
        solids->count += count;
        /* the trees point at meshes that have just moved */
        for (uint32_t i = 0; i < old; ++i) {
            grown[i].closed_tree.mesh = &grown[i].closed;
            grown[i].surface_tree.mesh = &grown[i].surface;
        }
    }
    for (uint32_t c = 0; result == RIS_OK && c < count; ++c) {
        ris_solid *s = &solids->solid[old + c];
        s->source = solids->source_count - 1;
        result = pick(mesh, component, c, mesh->triangle_count, &s->closed);
        if (result == RIS_OK) {
            result = pick(mesh, component, c, surface_count, &s->surface);
        }
        if (result == RIS_OK && s->surface.triangle_count == s->closed.triangle_count) {
            s->surface.triangle_count = 0;
        }
        if (result == RIS_OK) {
            result = ris__bvh_build(&s->closed_tree, &s->closed, err);
        }
        if (result == RIS_OK) {
            result = ris__bvh_build(&s->surface_tree, &s->surface, err);
        }
    }
    free(component);
    return result;
}

ris_result ris__solids_add(ris_solids *solids, const ris_mesh *mesh, const dvec *apex, const char *name,
                           ris_error *err)
{
    tri_mesh whole = {0};
    uint32_t border_count = 0;
    ris_result result = ris__tri_from_mesh(mesh, name, &whole, err);
    if (result != RIS_OK) {
        return result;
    }
    const uint32_t surface_count = whole.triangle_count;
    edge *border = find_border(&whole, &border_count);
    const size_t vertices = (size_t)whole.vertex_count + border_count + 1;
    const size_t triangles = (size_t)surface_count + border_count + 1;
    dvec *position = border ? realloc(whole.position, vertices * sizeof *position) : NULL;
    whole.position = position ? position : whole.position;
    uint32_t *triangle = position ? realloc(whole.triangle, 3 * triangles * sizeof *triangle) : NULL;
    whole.triangle = triangle ? triangle : whole.triangle;
    dvec **list = triangle ? realloc(solids->position, (solids->source_count + 1) * sizeof *list) : NULL;
    result = list ? cap_holes(&whole, border, border_count, apex) : RIS_ERROR_MEMORY;
    if (list) {
        solids->position = list;
    }
    if (result == RIS_OK) {
        solids->position[solids->source_count++] = whole.position;
        result = split(solids, &whole, surface_count, err);
        whole.position = NULL;
    }
    ris__tri_finish(&whole);
    free(border);
    return result == RIS_ERROR_MEMORY ? ris_fail(err, result, "%s: out of memory", name) : result;
}

void ris__solids_finish(ris_solids *solids)
{
    for (uint32_t i = 0; i < solids->count; ++i) {
        ris__bvh_finish(&solids->solid[i].closed_tree);
        ris__bvh_finish(&solids->solid[i].surface_tree);
        free(solids->solid[i].closed.triangle);
        free(solids->solid[i].surface.triangle);
    }
    for (uint32_t i = 0; i < solids->source_count; ++i) {
        free(solids->position[i]);
    }
    free(solids->position);
    free(solids->solid);
    *solids = (ris_solids){0};
}

static bool in_box(const bvh *tree, dvec p)
{
    const bvh_node *box = &tree->node[0];
    return p.x >= box->low[0] && p.x <= box->high[0] && p.y >= box->low[1] && p.y <= box->high[1] &&
           p.z >= box->low[2] && p.z <= box->high[2];
}

double ris__solids_depth(const ris_solids *solids, dvec p, uint32_t *out_solid)
{
    double deepest = 0;
    for (uint32_t i = 0; i < solids->count; ++i) {
        const ris_solid *s = &solids->solid[i];
        /* not zero, whichever way the component faces */
        if (!in_box(&s->closed_tree, p) || ris__bvh_winding(&s->closed_tree, p) == 0) {
            continue;
        }
        const bvh *tree = s->surface.triangle_count ? &s->surface_tree : &s->closed_tree;
        const double depth = ris__bvh_closest(tree, p).distance;
        if (depth > deepest) {
            deepest = depth;
            *out_solid = i;
        }
    }
    return deepest;
}

double ris__solids_clearance(const ris_solids *solids, dvec p)
{
    double nearest = HUGE_VAL;
    for (uint32_t i = 0; i < solids->count; ++i) {
        nearest = fmin(nearest, ris__bvh_closest(&solids->solid[i].closed_tree, p).distance);
    }
    return nearest;
}
