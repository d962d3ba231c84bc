/* The outer skin as a closed surface: without the eye sockets and the mouth's lining, openings closed by
 * fans (KA-01). */
#include "make_skull.h"

#include "risorius/head.h"

#include <stdlib.h>
#include <string.h>

static void mark(const ris_head *head, const char *name, bool *mark)
{
    const ris_region *r = ris_head_region(head, name);
    for (uint32_t i = 0; r && i < r->count; i++)
        mark[r->vertex[i]] = true;
}

/* Triangles of all faces that keep a vertex outside the marked ones. */
static void keep_outer(const ris_mesh *skin, const bool *inner, tri_mesh *out)
{
    for (uint32_t f = 0; f < skin->face_count; f++) {
        const uint32_t *v = skin->face_vertex + skin->face_start[f];
        uint32_t n = skin->face_start[f + 1] - skin->face_start[f], inside = 0;
        for (uint32_t k = 0; k < n; k++)
            inside += inner[v[k]];
        for (uint32_t k = 2; inside < n && k < n; k++) {
            uint32_t *t = out->triangle + 3 * (size_t)out->triangle_count++;
            t[0] = v[0];
            t[1] = v[k - 1];
            t[2] = v[k];
        }
    }
}

/* next[v] = the vertex after v along the border (against its triangle's direction), UINT32_MAX inside. */
static void border_links(const tri_mesh *mesh, uint32_t *next)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        next[i] = UINT32_MAX;
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t a = mesh->triangle[i], b = mesh->triangle[i % 3 == 2 ? i - 2 : i + 1];
        bool paired = false;
        for (uint32_t k = 0; k < 3 * mesh->triangle_count && !paired; k++)
            paired = mesh->triangle[k] == b && mesh->triangle[k % 3 == 2 ? k - 2 : k + 1] == a;
        if (!paired)
            next[b] = a;
    }
}

/* Fan from the middle of each border loop. */
static void close_borders(tri_mesh *mesh, uint32_t *next)
{
    uint32_t count = mesh->vertex_count;
    for (uint32_t s = 0; s < count; s++) {
        if (next[s] == UINT32_MAX)
            continue;
        dvec sum = {0};
        uint32_t n = 0, middle = mesh->vertex_count++;
        for (uint32_t v = s; next[v] != UINT32_MAX;) {
            uint32_t w = next[v], *t = mesh->triangle + 3 * (size_t)mesh->triangle_count++;
            next[v] = UINT32_MAX;
            t[0] = v;
            t[1] = w;
            t[2] = middle;
            sum = dv_add(sum, mesh->position[v]);
            n++;
            v = w;
        }
        mesh->position[middle] = dv(sum.x / n, sum.y / n, sum.z / n);
    }
}

ris_result hull_load(const char *directory, hull *out, ris_error *err)
{
    *out = (hull){0};
    ris_head head;
    ris_result result = ris_head_load(directory, &head, err);
    if (result != RIS_OK)
        return result;
    uint32_t n = head.skin.vertex_count, corners = head.skin.face_start[head.skin.face_count];
    bool *inner = calloc(n + 1, sizeof *inner);
    uint32_t *next = malloc((n + 1) * sizeof *next);
    tri_mesh *mesh = &out->mesh;
    mesh->position = malloc(((size_t)n + 64) * sizeof *mesh->position);
    mesh->triangle = malloc(((size_t)corners + n) * 3 * sizeof *mesh->triangle);
    if (!inner || !next || !mesh->position || !mesh->triangle) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "%s: out of memory for the skin", directory);
        goto fail;
    }
    mesh->vertex_count = out->skin_vertices = n;
    for (uint32_t i = 0; i < n; i++)
        mesh->position[i] = dv(head.skin.position[i].x, head.skin.position[i].y, head.skin.position[i].z);
    mark(&head, "mouth_cavity", inner);
    mark(&head, "inner_lip_rim", inner);
    mark(&head, "eye_socket", inner);
    keep_outer(&head.skin, inner, mesh);
    out->skin_triangles = mesh->triangle_count;
    border_links(mesh, next);
    close_borders(mesh, next);
    uint32_t open = 0;
    result = tri_open_edges(mesh, &open, err);
    if (result == RIS_OK && open)
        result = ris_fail(err, RIS_ERROR_DATA, "%s: the outer skin cannot be closed, %u open edges",
                          directory, open);
    if (result == RIS_OK)
        result = ris__bvh_build(&out->tree, mesh, err);
fail:
    free(inner);
    free(next);
    ris_head_finish(&head);
    if (result != RIS_OK)
        hull_finish(out);
    return result;
}

void hull_finish(hull *h)
{
    ris__bvh_finish(&h->tree);
    ris__tri_finish(&h->mesh);
    *h = (hull){0};
}
