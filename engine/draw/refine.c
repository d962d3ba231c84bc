/* Catmull-Clark weights (Catmull and Clark 1978, boundary rules of the usual cubic B-spline edge). */
#include "draw/refine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One edge of the coarse mesh with the faces on it. */
typedef struct edge {
    uint32_t a, b;       /* a < b */
    uint32_t face[2];    /* UINT32_MAX = none */
    uint32_t face_count; /* more than two: treated as a boundary */
} edge;

typedef struct half {
    uint32_t a, b, face, corner;
} half;

/* Everything the rules need about the coarse mesh. */
typedef struct topology {
    const ris_mesh *mesh;
    uint32_t edge_count;
    edge *edge;
    uint32_t *corner_edge;  /* edge from each corner to the next (face_start[face_count]) */
    uint32_t *vertex_start; /* edges around each vertex (vertex_count + 1) */
    uint32_t *vertex_edge;  /* (2 x edge_count) */
    uint32_t *face_start;   /* faces around each vertex (vertex_count + 1) */
    uint32_t *vertex_face;
} topology;

/* A sparse row under construction. */
typedef struct row {
    float *weight; /* (vertex_count), zero where untouched */
    uint32_t *touched, count;
} row;

static int compare_half(const void *left, const void *right)
{
    const half *l = left, *r = right;
    if (l->a != r->a) {
        return l->a < r->a ? -1 : 1;
    }
    if (l->b != r->b) {
        return l->b < r->b ? -1 : 1;
    }
    return l->corner < r->corner ? -1 : l->corner > r->corner;
}

static uint32_t next_corner(const ris_mesh *mesh, uint32_t face, uint32_t corner)
{
    return corner + 1 < mesh->face_start[face + 1] ? corner + 1 : mesh->face_start[face];
}

static bool find_edges(topology *top)
{
    const ris_mesh *mesh = top->mesh;
    uint32_t corners = mesh->face_start[mesh->face_count];
    half *halves = malloc((corners + 1) * sizeof *halves);
    top->edge = malloc((corners + 1) * sizeof *top->edge);
    top->corner_edge = malloc((corners + 1) * sizeof *top->corner_edge);
    if (halves == NULL || top->edge == NULL || top->corner_edge == NULL) {
        free(halves);
        return false;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
            uint32_t v = mesh->face_vertex[c], w = mesh->face_vertex[next_corner(mesh, f, c)];
            halves[c] = (half){v < w ? v : w, v < w ? w : v, f, c};
        }
    }
    qsort(halves, corners, sizeof *halves, compare_half);
    for (uint32_t i = 0; i < corners; i++) {
        const half *h = &halves[i];
        if (i == 0 || h->a != halves[i - 1].a || h->b != halves[i - 1].b) {
            top->edge[top->edge_count++] = (edge){h->a, h->b, {UINT32_MAX, UINT32_MAX}, 0};
        }
        edge *e = &top->edge[top->edge_count - 1];
        if (e->face_count < 2) {
            e->face[e->face_count] = h->face;
        }
        e->face_count++;
        top->corner_edge[h->corner] = top->edge_count - 1;
    }
    free(halves);
    return true;
}

static bool find_rings(topology *top)
{
    const ris_mesh *mesh = top->mesh;
    uint32_t n = mesh->vertex_count, corners = mesh->face_start[mesh->face_count];
    top->vertex_start = calloc(n + 2, sizeof *top->vertex_start);
    top->face_start = calloc(n + 2, sizeof *top->face_start);
    top->vertex_edge = malloc((2 * (size_t)top->edge_count + 1) * sizeof *top->vertex_edge);
    top->vertex_face = malloc((corners + 1) * sizeof *top->vertex_face);
    if (!top->vertex_start || !top->face_start || !top->vertex_edge || !top->vertex_face) {
        return false;
    }
    for (uint32_t e = 0; e < top->edge_count; e++) {
        top->vertex_start[top->edge[e].a + 2]++;
        top->vertex_start[top->edge[e].b + 2]++;
    }
    for (uint32_t c = 0; c < corners; c++) {
        top->face_start[mesh->face_vertex[c] + 2]++;
    }
    for (uint32_t v = 1; v <= n; v++) {
        top->vertex_start[v + 1] += top->vertex_start[v];
        top->face_start[v + 1] += top->face_start[v];
    }
    /* entries are placed through start[v + 1], which ends up as the start of v + 1 */
    for (uint32_t e = 0; e < top->edge_count; e++) {
        top->vertex_edge[top->vertex_start[top->edge[e].a + 1]++] = e;
        top->vertex_edge[top->vertex_start[top->edge[e].b + 1]++] = e;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
            top->vertex_face[top->face_start[mesh->face_vertex[c] + 1]++] = f;
        }
    }
    return true;
}

static void topology_finish(topology *top)
{
    free(top->edge);
    free(top->corner_edge);
    free(top->vertex_start);
    free(top->vertex_edge);
    free(top->face_start);
    free(top->vertex_face);
}

static void add(row *to, uint32_t vertex, float weight)
{
    for (uint32_t i = 0; i < to->count; i++) {
        if (to->touched[i] == vertex) {
            to->weight[vertex] += weight;
            return;
        }
    }
    to->touched[to->count++] = vertex;
    to->weight[vertex] = weight;
}

static void add_face(row *to, const ris_mesh *mesh, uint32_t face, float weight)
{
    uint32_t first = mesh->face_start[face], end = mesh->face_start[face + 1];
    for (uint32_t c = first; c < end; c++) {
        add(to, mesh->face_vertex[c], weight / (float)(end - first));
    }
}

static void edge_rule(const topology *top, const edge *e, row *to)
{
    if (e->face_count == 2) {
        add(to, e->a, 0.25f);
        add(to, e->b, 0.25f);
        add_face(to, top->mesh, e->face[0], 0.25f);
        add_face(to, top->mesh, e->face[1], 0.25f);
    } else {
        add(to, e->a, 0.5f);
        add(to, e->b, 0.5f);
    }
}

static void vertex_rule(const topology *top, uint32_t v, row *to)
{
    uint32_t first = top->vertex_start[v], end = top->vertex_start[v + 1], border = 0;
    for (uint32_t i = first; i < end; i++) {
        border += top->edge[top->vertex_edge[i]].face_count != 2;
    }
    float n = (float)(end - first);
    uint32_t faces = top->face_start[v + 1] - top->face_start[v];
    if (border == 0 && end - first >= 3 && faces == end - first) {
        add(to, v, (n - 2.0f) / n);
        for (uint32_t i = first; i < end; i++) {
            const edge *e = &top->edge[top->vertex_edge[i]];
            add(to, e->a == v ? e->b : e->a, 1.0f / (n * n));
        }
        for (uint32_t i = top->face_start[v]; i < top->face_start[v + 1]; i++) {
            add_face(to, top->mesh, top->vertex_face[i], 1.0f / (n * n));
        }
    } else if (border == 2) {
        add(to, v, 0.75f);
        for (uint32_t i = first; i < end; i++) {
            const edge *e = &top->edge[top->vertex_edge[i]];
            if (e->face_count != 2) {
                add(to, e->a == v ? e->b : e->a, 0.125f);
            }
        }
    } else {
        add(to, v, 1.0f);
    }
}

/* Ends a row: appends its terms and clears it. The term array is grown as needed. */
static bool end_row(ris_refined *out, row *from, size_t *capacity)
{
    if (out->term_count + from->count > *capacity) {
        size_t bigger = (*capacity + from->count) * 2;
        ris_draw_term *grown = realloc(out->term, bigger * sizeof *grown);
        if (grown == NULL) {
            return false;
        }
        out->term = grown;
        *capacity = bigger;
    }
    for (uint32_t i = 0; i < from->count; i++) {
        out->term[out->term_count++] = (ris_draw_term){from->touched[i], from->weight[from->touched[i]]};
    }
    from->count = 0;
    out->term_start[++out->vertex_count] = out->term_count;
    return true;
}

/* Vertices of the refined mesh: old vertices, then edges, then faces. */
static bool make_terms(const topology *top, uint32_t levels, ris_refined *out)
{
    const ris_mesh *mesh = top->mesh;
    size_t total = (size_t)mesh->vertex_count + (levels ? (size_t)top->edge_count + mesh->face_count : 0);
    size_t capacity = 8 * total;
    row work = {calloc(mesh->vertex_count + 1, sizeof(float)),
                calloc(mesh->vertex_count + 1, sizeof(uint32_t)), 0};
    out->term_start = calloc(total + 1, sizeof *out->term_start);
    out->term = malloc((capacity + 1) * sizeof *out->term);
    bool good = work.weight && work.touched && out->term_start && out->term;
    for (uint32_t v = 0; v < mesh->vertex_count && good; v++) {
        if (levels) {
            vertex_rule(top, v, &work);
        } else {
            add(&work, v, 1.0f);
        }
        good = end_row(out, &work, &capacity);
    }
    for (uint32_t e = 0; e < top->edge_count && good && levels; e++) {
        edge_rule(top, &top->edge[e], &work);
        good = end_row(out, &work, &capacity);
    }
    for (uint32_t f = 0; f < mesh->face_count && good && levels; f++) {
        add_face(&work, mesh, f, 1.0f);
        good = end_row(out, &work, &capacity);
    }
    free(work.weight);
    free(work.touched);
    return good;
}

static void corner_uv(const ris_mesh *mesh, uint32_t corner, float uv[2])
{
    uint32_t i = mesh->face_uv != NULL ? mesh->face_uv[corner] : UINT32_MAX;
    uv[0] = i == UINT32_MAX ? 0.0f : mesh->uv[2 * (size_t)i];
    uv[1] = i == UINT32_MAX ? 0.0f : 1.0f - mesh->uv[2 * (size_t)i + 1];
}

static void half_way(const float a[2], const float b[2], float out[2])
{
    out[0] = 0.5f * (a[0] + b[0]);
    out[1] = 0.5f * (a[1] + b[1]);
}

static ris_draw_corner plain_corner(const ris_mesh *mesh, uint32_t corner)
{
    float uv[2];
    corner_uv(mesh, corner, uv);
    return (ris_draw_corner){mesh->face_vertex[corner], uv[0], uv[1]};
}

/* A face as it is: a quad, or a fan of triangles (a triangle repeats its last corner). */
static void plain_face(const ris_mesh *mesh, uint32_t f, ris_refined *out, ris_draw_corner *raw)
{
    uint32_t first = mesh->face_start[f], count = mesh->face_start[f + 1] - first;
    for (uint32_t k = 1; k + 1 < count; k += count == 4 ? 2 : 1) {
        ris_draw_corner *quad = raw + 4 * (size_t)out->quad_count;
        quad[0] = plain_corner(mesh, first);
        quad[1] = plain_corner(mesh, first + k);
        quad[2] = plain_corner(mesh, first + k + 1);
        quad[3] = count == 4 ? plain_corner(mesh, first + 3) : quad[2];
        out->quad_face[out->quad_count++] = f;
    }
}

/* A face as one quad per corner: corner, edge to the next, centre, edge from the previous. */
static void split_face(const topology *top, uint32_t f, ris_refined *out, ris_draw_corner *raw)
{
    const ris_mesh *mesh = top->mesh;
    uint32_t first = mesh->face_start[f], end = mesh->face_start[f + 1];
    uint32_t edges = mesh->vertex_count, faces = mesh->vertex_count + top->edge_count;
    float centre[2] = {0.0f, 0.0f}, here[2], there[2], back[2], to_next[2], to_prev[2];
    for (uint32_t c = first; c < end; c++) {
        corner_uv(mesh, c, here);
        centre[0] += here[0] / (float)(end - first);
        centre[1] += here[1] / (float)(end - first);
    }
    for (uint32_t c = first; c < end; c++) {
        ris_draw_corner *quad = raw + 4 * (size_t)out->quad_count;
        uint32_t prev = c > first ? c - 1 : end - 1, next = next_corner(mesh, f, c);
        corner_uv(mesh, c, here);
        corner_uv(mesh, next, there);
        corner_uv(mesh, prev, back);
        half_way(here, there, to_next);
        half_way(here, back, to_prev);
        quad[0] = (ris_draw_corner){mesh->face_vertex[c], here[0], here[1]};
        quad[1] = (ris_draw_corner){edges + top->corner_edge[c], to_next[0], to_next[1]};
        quad[2] = (ris_draw_corner){faces + f, centre[0], centre[1]};
        quad[3] = (ris_draw_corner){edges + top->corner_edge[prev], to_prev[0], to_prev[1]};
        out->quad_face[out->quad_count++] = f;
    }
}

/* Corners of all drawn polygons before equal ones are merged, four per quad. */
static bool make_quads(const topology *top, uint32_t levels, ris_refined *out, ris_draw_corner **out_raw)
{
    const ris_mesh *mesh = top->mesh;
    size_t room = mesh->face_start[mesh->face_count]; /* at least as many as quads, either way */
    ris_draw_corner *raw = calloc(4 * room + 1, sizeof *raw);
    out->quad = malloc((4 * room + 1) * sizeof *out->quad);
    out->quad_face = malloc((room + 1) * sizeof *out->quad_face);
    *out_raw = raw;
    if (raw == NULL || out->quad == NULL || out->quad_face == NULL) {
        return false;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        if (levels) {
            split_face(top, f, out, raw);
        } else {
            plain_face(mesh, f, out, raw);
        }
    }
    for (size_t i = 0; i < 4 * (size_t)out->quad_count; i++) {
        out->quad[i] = raw[i].vertex;
    }
    return true;
}

/* Merges equal corners through a list per vertex, and makes the triangle list. */
static bool make_index(ris_refined *out, const ris_draw_corner *raw)
{
    size_t count = 4 * (size_t)out->quad_count;
    uint32_t *head = malloc((out->vertex_count + 1) * sizeof *head),
             *link = malloc((count + 1) * sizeof *link);
    uint32_t *merged = calloc(count + 1, sizeof *merged);
    out->corner = malloc((count + 1) * sizeof *out->corner);
    out->index = malloc((6 * (size_t)out->quad_count + 1) * sizeof *out->index);
    bool good = head && link && merged && out->corner && out->index;
    if (good) {
        memset(head, 0xff, out->vertex_count * sizeof *head);
        for (size_t i = 0; i < count; i++) {
            uint32_t at = head[raw[i].vertex];
            while (at != UINT32_MAX && (fabsf(out->corner[at].u - raw[i].u) > 1e-6f ||
                                        fabsf(out->corner[at].v - raw[i].v) > 1e-6f)) {
                at = link[at];
            }
            if (at == UINT32_MAX) {
                at = out->corner_count++;
                out->corner[at] = raw[i];
                link[at] = head[raw[i].vertex];
                head[raw[i].vertex] = at;
            }
            merged[i] = at;
        }
        static const uint32_t split[6] = {0, 1, 2, 0, 2, 3};
        for (uint32_t q = 0; q < out->quad_count; q++) {
            bool triangle = out->quad[4 * q + 2] == out->quad[4 * q + 3];
            for (uint32_t k = 0; k < (triangle ? 3u : 6u); k++) {
                out->index[out->index_count++] = merged[4 * q + split[k]];
            }
        }
    }
    free(head);
    free(link);
    free(merged);
    return good;
}

static bool make_ring(ris_refined *out)
{
    size_t count = 4 * (size_t)out->quad_count;
    out->ring_start = calloc((size_t)out->vertex_count + 2, sizeof *out->ring_start);
    out->ring = malloc((2 * count + 2) * sizeof *out->ring);
    if (out->ring_start == NULL || out->ring == NULL) {
        return false;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < count; i++) {
            size_t quad = i / 4 * 4;
            uint32_t corners = out->quad[quad + 2] == out->quad[quad + 3] ? 3 : 4;
            uint32_t k = (uint32_t)(i - quad);
            if (k >= corners) {
                continue;
            }
            uint32_t vertex = out->quad[i];
            if (pass == 0) {
                out->ring_start[vertex + 2]++;
            } else {
                uint32_t at = out->ring_start[vertex + 1]++;
                out->ring[2 * (size_t)at] = out->quad[quad + (k + 1) % corners];
                out->ring[2 * (size_t)at + 1] = out->quad[quad + (k + corners - 1) % corners];
            }
        }
        for (uint32_t v = 1; v <= out->vertex_count && pass == 0; v++) {
            out->ring_start[v + 1] += out->ring_start[v];
        }
    }
    return true;
}

ris_result ris__refine(const ris_mesh *mesh, uint32_t levels, ris_refined *out, ris_error *err)
{
    topology top = {.mesh = mesh};
    ris_draw_corner *raw = NULL;
    *out = (ris_refined){0};
    bool good = find_edges(&top) && find_rings(&top) && make_terms(&top, levels, out) &&
                make_quads(&top, levels, out, &raw) && make_index(out, raw) && make_ring(out);
    out->drawn = good ? malloc(((size_t)out->index_count + 1) * sizeof *out->drawn) : NULL;
    good = out->drawn != NULL;
    if (good) {
        memcpy(out->drawn, out->index, out->index_count * sizeof *out->drawn);
        out->drawn_count = out->index_count;
    }
    free(raw);
    topology_finish(&top);
    if (!good) {
        ris__refined_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing a mesh of %u vertices",
                        (unsigned)mesh->vertex_count);
    }
    return RIS_OK;
}

void ris__refined_finish(ris_refined *refined)
{
    free(refined->term_start);
    free(refined->term);
    free(refined->quad);
    free(refined->quad_face);
    free(refined->ring_start);
    free(refined->ring);
    free(refined->corner);
    free(refined->index);
    free(refined->drawn);
    *refined = (ris_refined){0};
}

void ris__refined_position(const ris_refined *refined, const ris_vec3 *source, ris_vec3 *out)
{
    for (uint32_t v = 0; v < refined->vertex_count; v++) {
        ris_vec3 sum = {0.0f, 0.0f, 0.0f};
        for (uint32_t i = refined->term_start[v]; i < refined->term_start[v + 1]; i++) {
            ris_vec3 p = source[refined->term[i].source];
            float w = refined->term[i].weight;
            sum = (ris_vec3){sum.x + w * p.x, sum.y + w * p.y, sum.z + w * p.z};
        }
        out[v] = sum;
    }
}

void ris__refined_normal(const ris_refined *refined, const ris_vec3 *position, ris_vec3 *out)
{
    for (uint32_t v = 0; v < refined->vertex_count; v++) {
        ris_vec3 n = {0.0f, 0.0f, 0.0f}, p = position[v];
        for (uint32_t i = refined->ring_start[v]; i < refined->ring_start[v + 1]; i++) {
            ris_vec3 b = position[refined->ring[2 * (size_t)i]],
                     c = position[refined->ring[2 * (size_t)i + 1]];
            ris_vec3 x = {b.x - p.x, b.y - p.y, b.z - p.z}, y = {c.x - p.x, c.y - p.y, c.z - p.z};
            n.x += x.y * y.z - x.z * y.y;
            n.y += x.z * y.x - x.x * y.z;
            n.z += x.x * y.y - x.y * y.x;
        }
        float length = sqrtf(n.x * n.x + n.y * n.y + n.z * n.z);
        out[v] = length > 0.0f ? (ris_vec3){n.x / length, n.y / length, n.z / length}
                               : (ris_vec3){0.0f, 0.0f, 1.0f};
    }
}
