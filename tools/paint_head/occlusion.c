/* Ray casting on the head: how much sky a vertex sees (ambient occlusion) and how thin the tissue behind
 * it is. A bounding-volume tree split at the median of the longest axis; rays go in fixed spiral
 * directions. */
#include "paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAF_SIZE 4u

typedef struct tree_node {
    ris_vec3 low, high;
    uint32_t first, count; /* count 0: an inner node, its children are first and first + 1 */
} tree_node;

struct ris_paint_tree {
    const ris_vec3 *position;
    const uint32_t *triangle;
    uint32_t *order;
    ris_vec3 *centre;
    tree_node *node;
    uint32_t node_count;
};

static float axis_of(ris_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static void fit_box(const ris_paint_tree *tree, tree_node *node)
{
    node->low = vec3(1e30f, 1e30f, 1e30f);
    node->high = vec3(-1e30f, -1e30f, -1e30f);
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
        for (int k = 0; k < 3; k++) {
            const ris_vec3 p = tree->position[tree->triangle[3 * tree->order[i] + (uint32_t)k]];
            node->low = vec3(fminf(node->low.x, p.x), fminf(node->low.y, p.y), fminf(node->low.z, p.z));
            node->high = vec3(fmaxf(node->high.x, p.x), fmaxf(node->high.y, p.y), fmaxf(node->high.z, p.z));
        }
    }
}

/* Puts the middle element by centre along the axis in its place (quickselect; ties by index, so the order
 * is fixed). */
static void select_median(const ris_paint_tree *tree, uint32_t first, uint32_t count, int axis)
{
    uint32_t low = first, high = first + count - 1;
    const uint32_t middle = first + count / 2;
    while (low < high) {
        const float pivot = axis_of(tree->centre[tree->order[(low + high) / 2]], axis);
        uint32_t i = low, j = high;
        for (;;) {
            while (axis_of(tree->centre[tree->order[i]], axis) < pivot)
                i++;
            while (axis_of(tree->centre[tree->order[j]], axis) > pivot)
                j--;
            if (i >= j)
                break;
            const uint32_t swap = tree->order[i];
            tree->order[i++] = tree->order[j];
            tree->order[j--] = swap;
        }
        if (j < middle)
            low = j + 1;
        else
            high = j;
    }
}

static void split(ris_paint_tree *tree, uint32_t index)
{
    tree_node *node = &tree->node[index];
    fit_box(tree, node);
    if (node->count <= LEAF_SIZE)
        return;
    const ris_vec3 size = vec3_sub(node->high, node->low);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    select_median(tree, node->first, node->count, axis);
    const uint32_t half = node->count / 2, child = tree->node_count;
    tree->node_count += 2;
    tree->node[child] = (tree_node){.first = node->first, .count = half};
    tree->node[child + 1] = (tree_node){.first = node->first + half, .count = node->count - half};
    node->first = child;
    node->count = 0;
    split(tree, child);
    split(tree, child + 1);
}

ris_paint_tree *ris_paint_tree_create(const ris_vec3 *position, const uint32_t *triangle,
                                      uint32_t triangle_count)
{
    ris_paint_tree *tree = calloc(1, sizeof *tree);
    if (!tree || triangle_count == 0)
        goto fail;
    tree->position = position;
    tree->triangle = triangle;
    tree->order = malloc(triangle_count * sizeof *tree->order);
    tree->centre = malloc(triangle_count * sizeof *tree->centre);
    tree->node = malloc(2 * (size_t)triangle_count * sizeof *tree->node);
    if (!tree->order || !tree->centre || !tree->node)
        goto fail;
    for (uint32_t i = 0; i < triangle_count; i++) {
        const uint32_t *t = &triangle[3 * i];
        tree->order[i] = i;
        tree->centre[i] = vec3_add(position[t[0]], vec3_add(position[t[1]], position[t[2]]));
    }
    tree->node[0] = (tree_node){.first = 0, .count = triangle_count};
    tree->node_count = 1;
    split(tree, 0);
    return tree;
fail:
    ris_paint_tree_destroy(tree);
    return NULL;
}

void ris_paint_tree_destroy(ris_paint_tree *tree)
{
    if (!tree)
        return;
    free(tree->order);
    free(tree->centre);
    free(tree->node);
    free(tree);
}

static bool hits_box(const tree_node *node, ris_vec3 origin, ris_vec3 inverse, float limit)
{
    const float ax = (node->low.x - origin.x) * inverse.x, bx = (node->high.x - origin.x) * inverse.x;
    const float ay = (node->low.y - origin.y) * inverse.y, by = (node->high.y - origin.y) * inverse.y;
    const float az = (node->low.z - origin.z) * inverse.z, bz = (node->high.z - origin.z) * inverse.z;
    const float enter = fmaxf(fmaxf(fminf(ax, bx), fminf(ay, by)), fmaxf(fminf(az, bz), 0));
    const float leave = fminf(fminf(fmaxf(ax, bx), fmaxf(ay, by)), fminf(fmaxf(az, bz), limit));
    return enter <= leave;
}

/* Moeller-Trumbore; both sides count. */
static float hit_triangle(const ris_paint_tree *tree, uint32_t index, ris_vec3 origin, ris_vec3 direction,
                          float limit)
{
    const uint32_t *t = &tree->triangle[3 * index];
    const ris_vec3 a = tree->position[t[0]];
    const ris_vec3 e1 = vec3_sub(tree->position[t[1]], a), e2 = vec3_sub(tree->position[t[2]], a);
    const ris_vec3 p = vec3_cross(direction, e2);
    const float det = vec3_dot(e1, p);
    if (det == 0)
        return limit;
    const ris_vec3 s = vec3_sub(origin, a);
    const float u = vec3_dot(s, p) / det;
    const ris_vec3 q = vec3_cross(s, e1);
    const float v = vec3_dot(direction, q) / det, d = vec3_dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && d > 0 && d < limit ? d : limit;
}

float ris_paint_tree_cast(const ris_paint_tree *tree, ris_vec3 origin, ris_vec3 direction, float limit)
{
    const ris_vec3 inverse =
        vec3(1 / (direction.x != 0 ? direction.x : 1e-20f), 1 / (direction.y != 0 ? direction.y : 1e-20f),
             1 / (direction.z != 0 ? direction.z : 1e-20f));
    uint32_t stack[64], depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const tree_node *node = &tree->node[stack[--depth]];
        if (!hits_box(node, origin, inverse, limit))
            continue;
        if (node->count == 0) {
            stack[depth++] = node->first;
            stack[depth++] = node->first + 1;
            continue;
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++)
            limit = hit_triangle(tree, tree->order[i], origin, direction, limit);
    }
    return limit;
}

/* The i-th of n directions in the hemisphere around the unit normal, cosine-weighted when power is 1,
 * narrower below. */
static ris_vec3 spiral(ris_vec3 normal, uint32_t i, uint32_t n, float power)
{
    const float square = ((float)i + 0.5f) / (float)n * power, turn = 2.3999632f * (float)i;
    const float radius = sqrtf(square), height = sqrtf(1 - square);
    const ris_vec3 aside = fabsf(normal.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
    const ris_vec3 u = ris_paint_unit(vec3_cross(aside, normal)), v = vec3_cross(normal, u);
    return vec3_add(vec3_scale(normal, height),
                    vec3_add(vec3_scale(u, radius * cosf(turn)), vec3_scale(v, radius * sinf(turn))));
}

static void bake_vertex(ris_paint_surface *surface, const ris_paint_tree *all, const ris_paint_tree *skin,
                        uint32_t i)
{
    enum { SKY_RAYS = 160, DEPTH_RAYS = 24 };
    const float reach = 50.0f;
    const ris_vec3 p = surface->mesh->position[i], n = surface->normal[i];
    const ris_vec3 above = vec3_add(p, vec3_scale(n, 0.25f)), below = vec3_sub(p, vec3_scale(n, 0.25f));
    float open = 0, thin = 0;
    for (uint32_t k = 0; k < SKY_RAYS; k++) {
        /* far hits darken less: light reaches there from elsewhere */
        const float d = ris_paint_tree_cast(all, above, spiral(n, k, SKY_RAYS, 0.98f), reach);
        open += powf(d / reach, 0.75f);
    }
    for (uint32_t k = 0; k < DEPTH_RAYS; k++) {
        const float d =
            ris_paint_tree_cast(skin, below, spiral(vec3_scale(n, -1), k, DEPTH_RAYS, 0.4f), 40.0f);
        thin += expf(-d / 7.0f);
    }
    surface->occlusion[i] = open / SKY_RAYS;
    surface->thinness[i] = thin / DEPTH_RAYS;
}

/* Appends the triangles of a mesh (fan of each face) to the soup at *v / *t. */
static void append(const ris_mesh *mesh, ris_vec3 *position, uint32_t *triangle, uint32_t *v, uint32_t *t)
{
    memcpy(position + *v, mesh->position, mesh->vertex_count * sizeof *position);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t c = mesh->face_start[f] + 1; c + 1 < mesh->face_start[f + 1]; c++) {
            triangle[3 * *t] = *v + mesh->face_vertex[mesh->face_start[f]];
            triangle[3 * *t + 1] = *v + mesh->face_vertex[c];
            triangle[3 * *t + 2] = *v + mesh->face_vertex[c + 1];
            ++*t;
        }
    }
    *v += mesh->vertex_count;
}

ris_result ris_paint_bake_occlusion(ris_paint_surface *surface, const ris_mesh *extra, uint32_t extra_count,
                                    ris_error *err)
{
    const ris_mesh *mesh = surface->mesh;
    ris_result result = RIS_OK;
    ris_paint_tree *all = NULL, *skin = NULL;
    size_t vertices = mesh->vertex_count, corners = mesh->face_start[mesh->face_count];
    for (uint32_t i = 0; i < extra_count; i++) {
        vertices += extra[i].vertex_count;
        corners += extra[i].face_start[extra[i].face_count];
    }
    ris_vec3 *position = malloc(vertices * sizeof *position);
    uint32_t *triangle = malloc(corners * 3 * sizeof *triangle), v = 0, t = 0;
    if (!position || !triangle)
        goto fail;
    append(mesh, position, triangle, &v, &t);
    skin = ris_paint_tree_create(position, triangle, t);
    for (uint32_t i = 0; i < extra_count; i++)
        append(&extra[i], position, triangle, &v, &t);
    all = ris_paint_tree_create(position, triangle, t);
    if (!skin || !all)
        goto fail;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        bake_vertex(surface, all, skin, i);
    goto done;
fail:
    result = ris_fail(err, RIS_ERROR_MEMORY, "no memory to cast rays on %zu vertices", vertices);
done:
    ris_paint_tree_destroy(all);
    ris_paint_tree_destroy(skin);
    free(position);
    free(triangle);
    return result;
}
