/* Growing meshes for the procedural parts. */
#include "make_head.h"

#include <stdlib.h>
#include <string.h>

static void *grow(void *items, uint32_t *room, uint32_t count, size_t size)
{
    if (count < *room)
        return items;
    *room = *room ? *room * 2 : 256;
    items = realloc(items, *room * size);
    if (!items)
        stop("out of memory for %u items", *room);
    return items;
}

uint32_t part_vertex(part *p, dvec position, double u, double v)
{
    uint32_t room = p->vertex_room;
    p->position = grow(p->position, &room, p->vertex_count, sizeof *p->position);
    p->uv = grow(p->uv, &p->vertex_room, p->vertex_count, sizeof *p->uv);
    p->position[p->vertex_count] = position;
    p->uv[p->vertex_count][0] = u;
    p->uv[p->vertex_count][1] = v;
    return p->vertex_count++;
}

void part_quad(part *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    p->face = grow(p->face, &p->face_room, p->face_count, sizeof *p->face);
    memcpy(p->face[p->face_count++], (uint32_t[4]){a, b, c, d}, sizeof *p->face);
}

void part_triangle(part *p, uint32_t a, uint32_t b, uint32_t c)
{
    part_quad(p, a, b, c, NONE);
}

part part_mirrored(const part *p)
{
    part out = {0};
    for (uint32_t i = 0; i < p->vertex_count; i++)
        part_vertex(&out, v3(-p->position[i].x, p->position[i].y, p->position[i].z), p->uv[i][0],
                    p->uv[i][1]);
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t *q = p->face[f];
        if (q[3] == NONE)
            part_triangle(&out, q[0], q[2], q[1]);
        else
            part_quad(&out, q[0], q[3], q[2], q[1]);
    }
    return out;
}

void part_append(part *to, const part *from)
{
    uint32_t first = to->vertex_count;
    for (uint32_t i = 0; i < from->vertex_count; i++)
        part_vertex(to, from->position[i], from->uv[i][0], from->uv[i][1]);
    for (uint32_t f = 0; f < from->face_count; f++) {
        const uint32_t *q = from->face[f];
        part_quad(to, first + q[0], first + q[1], first + q[2], q[3] == NONE ? NONE : first + q[3]);
    }
}

void part_finish(part *p)
{
    free(p->position);
    free(p->uv);
    free(p->face);
    *p = (part){0};
}
