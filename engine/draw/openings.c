/* Mouth and lids as openings: the rims through which light gets to what lies behind them. */
#include "draw/openings.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Directed edges between the faces that touch flagged vertices and the rest, as a successor of each vertex. */
static void find_border(const ris_mesh *mesh, const bool *flag, uint32_t *next)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        next[v] = UINT32_MAX;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t f = 0; f < mesh->face_count; f++) {
            uint32_t first = mesh->face_start[f], end = mesh->face_start[f + 1];
            bool inside = false;
            for (uint32_t c = first; c < end; c++) {
                inside |= flag[mesh->face_vertex[c]];
            }
            for (uint32_t c = first; c < end; c++) {
                uint32_t a = mesh->face_vertex[c], b = mesh->face_vertex[c + 1 < end ? c + 1 : first];
                if (inside && pass == 0 && !flag[a] && !flag[b]) {
                    next[a] = b;
                } else if (inside && pass == 1 && next[b] == a) {
                    next[b] = UINT32_MAX; /* both sides of the edge touch the region */
                }
            }
        }
    }
}

/* Rim points from an extreme of x to the other along next, evenly by count. */
static void sample(const uint32_t *loop, uint32_t count, const ris_vec3 *at, uint32_t *out)
{
    uint32_t left = 0, right = 0;
    for (uint32_t i = 1; i < count; i++) {
        left = at[loop[i]].x > at[loop[left]].x ? i : left;
        right = at[loop[i]].x < at[loop[right]].x ? i : right;
    }
    const uint32_t half = RIS_DRAW_RIM / 2, there = (right + count - left) % count;
    for (uint32_t k = 0; k < RIS_DRAW_RIM; k++) {
        uint32_t step =
            k < half ? k * there / half : there + (k - half) * (count - there) / half; /* from the left one */
        out[k] = loop[(left + step) % count];
    }
}

/* The longest loop along next whose centre lies on that side (0 = either). */
static void find_rim(const ris_mesh *mesh, const uint32_t *next, int side, uint32_t *loop, uint32_t *out)
{
    uint32_t longest = 2;
    for (uint32_t start = 0; start < mesh->vertex_count; start++) {
        uint32_t count = 0, v = start;
        float sum = 0.0f;
        do {
            loop[count++] = v;
            sum += mesh->position[v].x;
            v = next[v];
        } while (v != UINT32_MAX && v > start && count < mesh->vertex_count);
        if (v == start && count > longest && (float)side * sum >= 0.0f) {
            longest = count;
            sample(loop, count, mesh->position, out);
        }
    }
}

/* Flags the region, and `rings` rings of neighbours more. */
static bool flag_region(const ris_head *head, const char *name, int rings, bool *flag, bool *more)
{
    const ris_mesh *mesh = &head->skin;
    const ris_region *region = ris_head_region(head, name);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        flag[v] = false;
    }
    for (uint32_t i = 0; region != NULL && i < region->count; i++) {
        flag[region->vertex[i]] = true;
    }
    for (int ring = 0; ring < rings; ring++) {
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            more[v] = flag[v];
        }
        for (uint32_t f = 0; f < mesh->face_count; f++) {
            bool touched = false;
            for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
                touched |= flag[mesh->face_vertex[c]];
            }
            for (uint32_t c = mesh->face_start[f]; touched && c < mesh->face_start[f + 1]; c++) {
                more[mesh->face_vertex[c]] = true;
            }
        }
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            flag[v] = more[v];
        }
    }
    return region != NULL;
}

ris_result ris__draw_openings(const ris_head *head, uint32_t rim[RIS_DRAW_RIM_COUNT][RIS_DRAW_RIM],
                              ris_error *err)
{
    /* the lips touch a ring outside the lining; the lids end where their lining does */
    static const struct {
        const char *region;
        int rings, side;
    } def[RIS_DRAW_RIM_COUNT] = {[RIS_DRAW_RIM_MOUTH] = {"mouth_cavity", 1, 0},
                                 [RIS_DRAW_RIM_EYE_L] = {"eye_socket", 0, 1},
                                 [RIS_DRAW_RIM_EYE_R] = {"eye_socket", 0, -1}};
    const size_t n = (size_t)head->skin.vertex_count + 1;
    bool *flag = calloc(2 * n, sizeof *flag);
    uint32_t *next = calloc(2 * n, sizeof *next);
    if (flag == NULL || next == NULL) {
        free(flag);
        free(next);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the rims of mouth and lids");
    }
    for (int k = 0; k < RIS_DRAW_RIM_COUNT; k++) {
        for (int i = 0; i < RIS_DRAW_RIM; i++) {
            rim[k][i] = 0;
        }
        if (flag_region(head, def[k].region, def[k].rings, flag, flag + n)) {
            find_border(&head->skin, flag, next);
            find_rim(&head->skin, next, def[k].side, next + n, rim[k]);
        }
    }
    free(flag);
    free(next);
    return RIS_OK;
}
