/* The tongue: the base mesh's tongue group, divided once (KA-06). UV: seen from above, u across, v to the tip. */
#include "make_head.h"

#include <stdlib.h>
#include <string.h>

typedef struct edge_table {
    uint32_t count, (*ends)[2], *middle, (*faces)[2];
} edge_table;

static uint32_t edge_of(edge_table *t, uint32_t a, uint32_t b, uint32_t face)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    for (uint32_t i = 0; i < t->count; i++)
        if (t->ends[i][0] == low && t->ends[i][1] == high) {
            t->faces[i][1] = face;
            return i;
        }
    t->ends[t->count][0] = low;
    t->ends[t->count][1] = high;
    t->faces[t->count][0] = face;
    t->faces[t->count][1] = NONE;
    return t->count++;
}

static uint32_t collect(const maker *m, uint32_t range[2], dvec **position, uint32_t (**face)[4])
{
    uint32_t count = 0;
    *position = need(range[1] - range[0] + 1, sizeof **position);
    *face = need(m->mesh.quad_count, sizeof **face);
    for (uint32_t i = range[0]; i <= range[1]; i++)
        (*position)[i - range[0]] = m->mesh.position[i];
    for (uint32_t f = 0; f < m->mesh.quad_count; f++) {
        const uint32_t *q = m->mesh.quad[f];
        if (q[0] < range[0] || q[0] > range[1])
            continue;
        for (int k = 0; k < 4; k++)
            (*face)[count][k] = q[k] - range[0];
        count++;
    }
    return count;
}

/* Scaled about a point and moved, so that it lies inside our dental arch. */
static void fit(const maker *m, dvec *position, uint32_t count)
{
    json_t *rule = recipe_get(m->recipe, "tongue");
    double about[3], scale[3], move[3];
    recipe_numbers(rule, "about", about, 3);
    recipe_numbers(rule, "scale", scale, 3);
    recipe_numbers(rule, "move", move, 3);
    for (uint32_t i = 0; i < count; i++) {
        dvec p = position[i];
        position[i] = v3(about[0] + (p.x - about[0]) * scale[0] + move[0],
                         about[1] + (p.y - about[1]) * scale[1] + move[1],
                         about[2] + (p.z - about[2]) * scale[2] + move[2]);
    }
}

static void uv_from_above(part *p)
{
    if (!p->vertex_count || !p->position)
        stop("the mesh has no tongue");
    dvec low = p->position[0], high = p->position[0];
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        dvec v = p->position[i];
        low = v3(v.x < low.x ? v.x : low.x, 0, v.z < low.z ? v.z : low.z);
        high = v3(v.x > high.x ? v.x : high.x, 0, v.z > high.z ? v.z : high.z);
    }
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        p->uv[i][0] = (p->position[i].x - low.x) / (high.x - low.x);
        p->uv[i][1] = (p->position[i].z - low.z) / (high.z - low.z);
    }
}

/* One Catmull-Clark step: corners, then edge points, then face points. */
static part divide(const dvec *position, uint32_t vertices, uint32_t (*face)[4], uint32_t faces)
{
    part p = {0};
    edge_table t = {0, need(4 * faces, sizeof *t.ends), NULL, need(4 * faces, sizeof *t.faces)};
    uint32_t(*edges)[4] = need(faces, sizeof *edges), *valence = need(vertices, sizeof *valence);
    dvec *centre = need(faces, sizeof *centre), *sum = need(vertices, sizeof *sum);
    for (uint32_t f = 0; f < faces; f++)
        for (int k = 0; k < 4; k++) {
            centre[f] = v_mad(centre[f], position[face[f][k]], 0.25);
            edges[f][k] = edge_of(&t, face[f][k], face[f][(k + 1) % 4], f);
        }
    for (uint32_t f = 0; f < faces; f++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = face[f][k];
            dvec middle = v_mix(position[v], position[face[f][(k + 1) % 4]], 0.5);
            dvec before = v_mix(position[v], position[face[f][(k + 3) % 4]], 0.5);
            sum[v] =
                v_add(sum[v], v_add(centre[f], v_add(middle, before))); /* each edge counts twice: Q + 2 R */
            valence[v]++;
        }
    for (uint32_t v = 0; v < vertices; v++) {
        double n = valence[v];
        part_vertex(&p, v_mul(v_add(v_mul(sum[v], 1 / n), v_mul(position[v], n - 3)), 1 / n), 0, 0);
    }
    for (uint32_t e = 0; e < t.count; e++) {
        dvec at = v_mix(position[t.ends[e][0]], position[t.ends[e][1]], 0.5);
        if (t.faces[e][1] != NONE)
            at = v_mix(at, v_mix(centre[t.faces[e][0]], centre[t.faces[e][1]], 0.5), 0.5);
        part_vertex(&p, at, 0, 0);
    }
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t middle = part_vertex(&p, centre[f], 0, 0);
        for (int k = 0; k < 4; k++)
            part_quad(&p, face[f][k], vertices + edges[f][k], middle, vertices + edges[f][(k + 3) % 4]);
    }
    free(t.ends);
    free(t.faces);
    free(edges);
    free(valence);
    free(centre);
    free(sum);
    return p;
}

void write_tongue(const maker *m)
{
    uint32_t range[2], (*face)[4];
    dvec *position;
    recipe_range(recipe_get(m->recipe, "helpers"), "tongue", range);
    uint32_t faces = collect(m, range, &position, &face);
    fit(m, position, range[1] - range[0] + 1);
    part p = divide(position, range[1] - range[0] + 1, face, faces);
    uv_from_above(&p);
    write_part(m, &p, "tongue.obj");
    part_finish(&p);
    free(position);
    free(face);
}
