/* Rings, columns and sides of the lining, from the regions and the mesh (KA-48). */
#include "lay_lining.h"

#include <stdlib.h>
#include <string.h>

#define FIRST_RING 4 /* rings before it are the rim of the lips, which is seen */
#define VESTIBULE 5  /* rings up to it lie between lips and teeth */
#define CHEEK_RING 7 /* and these columns of rings up to it between cheek and teeth */
#define CHEEK_FIRST 10
#define CHEEK_LAST 14
#define BEHIND_RING 8  /* behind the last molars vestibule and mouth are one; */
#define BEHIND_LAST 12 /* columns of this ring up to here still come from the cheek */

static bool in_region(const ris_region *region, uint32_t vertex)
{
    for (uint32_t k = 0; region && k < region->count; k++)
        if (region->vertex[k] == vertex)
            return true;
    return false;
}

static ris_result alloc_all(lining *l, ris_error *err)
{
    const size_t n = l->count, corners = l->head->skin.face_start[l->head->skin.face_count];
    l->ring = malloc(n * sizeof *l->ring);
    l->column = malloc(n * sizeof *l->column);
    l->mirror = malloc(n * sizeof *l->mirror);
    l->moves = calloc(n, sizeof *l->moves);
    l->outside = calloc(n, sizeof *l->outside);
    l->border = calloc(n, sizeof *l->border);
    l->start = calloc(n + 1, sizeof *l->start);
    l->other = malloc(2 * corners * sizeof *l->other);
    l->from = malloc(n * sizeof *l->from);
    l->at = malloc(n * sizeof *l->at);
    l->cast_at = malloc(n * sizeof *l->at);
    l->edge = malloc(2 * corners * sizeof *l->edge);
    if (!l->ring || !l->column || !l->mirror || !l->moves || !l->outside || !l->border || !l->start ||
        !l->other || !l->from || !l->at || !l->cast_at || !l->edge)
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", l->count);
    return RIS_OK;
}

static uint32_t next_corner(const ris_mesh *m, uint32_t f, uint32_t c)
{
    return m->face_vertex[c + 1 < m->face_start[f + 1] ? c + 1 : m->face_start[f]];
}

/* Every edge twice; the mesh is closed about the mouth, so following each face's direction meets both ends. */
static void find_neighbours(lining *l)
{
    const ris_mesh *m = &l->head->skin;
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++)
            l->start[m->face_vertex[c] + 1]++;
    for (uint32_t i = 0; i < l->count; i++)
        l->start[i + 1] += l->start[i];
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++)
            l->other[l->start[m->face_vertex[c]]++] = next_corner(m, f, c);
    for (uint32_t i = l->count; i > 0; i--)
        l->start[i] = l->start[i - 1];
    l->start[0] = 0;
}

static ris_result find_mirrors(lining *l, ris_error *err)
{
    for (uint32_t i = 0; i < l->count; i++) {
        const ris_vec3 p = l->head->skin.position[i];
        l->mirror[i] = LINING_NONE;
        for (uint32_t k = 0; k < l->count && l->mirror[i] == LINING_NONE; k++) {
            const ris_vec3 q = l->head->skin.position[k];
            if (q.x == -p.x && q.y == p.y && q.z == p.z)
                l->mirror[i] = k;
        }
        if (l->mirror[i] == LINING_NONE)
            return ris_fail(err, RIS_ERROR_DATA, "skin.obj: vertex %u has no mirror image", i);
    }
    return RIS_OK;
}

static void find_rings(lining *l)
{
    const ris_region *mouth = ris_head_region(l->head, "mouth_cavity"),
                     *lips = ris_head_region(l->head, "lips");
    bool grown = true;
    for (uint32_t i = 0; i < l->count; i++)
        l->ring[i] = in_region(lips, i) ? 0 : LINING_NONE;
    for (uint32_t ring = 0; grown; ring++) {
        grown = false;
        for (uint32_t i = 0; i < l->count; i++)
            for (uint32_t e = l->start[i]; l->ring[i] == ring && e < l->start[i + 1]; e++)
                if (l->ring[l->other[e]] == LINING_NONE && in_region(mouth, l->other[e])) {
                    l->ring[l->other[e]] = ring + 1;
                    grown = true;
                }
    }
}

/* Walks the left half of the first ring from its top, then hands the numbers on inwards. */
static ris_result find_columns(lining *l, ris_error *err)
{
    uint32_t at = LINING_NONE, column = 0;
    memset(l->column, 0xff, l->count * sizeof *l->column);
    for (uint32_t i = 0; i < l->count; i++)
        if (l->ring[i] == 1 && l->mirror[i] == i && (at == LINING_NONE || l->from[i].y > l->from[at].y))
            at = i;
    while (at != LINING_NONE) {
        uint32_t next = LINING_NONE;
        l->column[at] = l->column[l->mirror[at]] = column++;
        for (uint32_t e = l->start[at]; e < l->start[at + 1]; e++) {
            const uint32_t k = l->other[e];
            if (l->ring[k] == 1 && l->column[k] == LINING_NONE && l->from[k].x >= 0)
                next = k;
        }
        at = next;
    }
    if (column <= CHEEK_LAST)
        return ris_fail(err, RIS_ERROR_DATA,
                        "the lining of the mouth has %u columns a side, expected more than %d", column,
                        CHEEK_LAST);
    for (uint32_t ring = 1; ring <= CHEEK_RING; ring++)
        for (uint32_t i = 0; i < l->count; i++)
            for (uint32_t e = l->start[i]; l->ring[i] == ring && e < l->start[i + 1]; e++)
                if (l->ring[l->other[e]] == ring + 1)
                    l->column[l->other[e]] = l->column[i];
    return RIS_OK;
}

bool lining_joined(const lining *l, uint32_t a, uint32_t b)
{
    return l->outside[a] == l->outside[b] || (l->ring[a] >= BEHIND_RING && l->ring[b] >= BEHIND_RING);
}

static void find_sides(lining *l)
{
    for (uint32_t i = 0; i < l->count; i++) {
        const uint32_t r = l->ring[i], c = l->column[i];
        const bool inner = r != LINING_NONE && r > 0;
        l->moves[i] = inner && r >= FIRST_RING;
        l->outside[i] =
            inner && (r <= VESTIBULE || (r <= CHEEK_RING && c >= CHEEK_FIRST && c <= CHEEK_LAST) ||
                      (r == BEHIND_RING && c >= CHEEK_FIRST && c <= BEHIND_LAST));
    }
    for (uint32_t i = 0; i < l->count; i++)
        for (uint32_t e = l->start[i]; l->moves[i] && e < l->start[i + 1]; e++)
            l->border[i] |= !lining_joined(l, i, l->other[e]);
}

static void add_edge(lining *l, uint32_t a, uint32_t b)
{
    if ((l->moves[a] || l->moves[b]) && l->from[a].x >= 0 && l->from[b].x >= 0) {
        l->edge[l->edge_count][0] = a;
        l->edge[l->edge_count++][1] = b;
    }
}

static void find_edges(lining *l)
{
    const ris_mesh *m = &l->head->skin;
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t c = m->face_start[f]; c < m->face_start[f + 1]; c++) {
            const uint32_t v = m->face_vertex[c], w = next_corner(m, f, c);
            if (v < w)
                add_edge(l, v, w);
            if (c - m->face_start[f] < 2 && m->face_start[f + 1] - m->face_start[f] == 4)
                add_edge(l, v, m->face_vertex[c + 2]); /* either diagonal may be the shorter one in the end */
        }
}

ris_result lining_build(lining *l, const ris_head *head, const bvh *body, ris_error *err)
{
    *l = (lining){.head = head, .count = head->skin.vertex_count, .body = body};
    ris_result result = alloc_all(l, err);
    if (result != RIS_OK)
        return result;
    for (uint32_t i = 0; i < l->count; i++) {
        const ris_vec3 p = head->skin.position[i];
        l->at[i] = l->from[i] = dv((double)p.x, (double)p.y, (double)p.z);
    }
    find_neighbours(l);
    result = find_mirrors(l, err);
    if (result == RIS_OK) {
        find_rings(l);
        result = find_columns(l, err);
    }
    if (result == RIS_OK) {
        find_sides(l);
        find_edges(l);
    }
    return result;
}

void lining_finish(lining *l)
{
    free(l->ring);
    free(l->column);
    free(l->mirror);
    free(l->moves);
    free(l->outside);
    free(l->border);
    free(l->start);
    free(l->other);
    free(l->from);
    free(l->at);
    free(l->cast_at);
    free(l->edge);
    *l = (lining){0};
}
