#include "anatomy.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void anatomy_title(const char *name, char *out)
{
    size_t length = strlen(name);
    if (anatomy_side(name)) {
        length -= 2;
    }
    snprintf(out, LABEL_TEXT_SIZE, "%.*s", (int)length, name);
    for (char *c = out; *c; c++) {
        *c = *c == '_' ? ' ' : *c;
    }
    out[0] = (char)toupper((unsigned char)out[0]);
}

char anatomy_side(const char *name)
{
    size_t length = strlen(name);
    return length > 2 && name[length - 2] == '.' ? name[length - 1] : '\0';
}

/* True when the pixels around are of the same muscle: a leader must not end on an edge. */
static bool is_inside(const uint32_t *map, uint32_t width, uint32_t height, uint32_t x, uint32_t y,
                      uint32_t reach)
{
    if (x < reach || y < reach || x + reach >= width || y + reach >= height) {
        return false;
    }
    const uint32_t *at = map + (size_t)y * width + x;
    const size_t row = (size_t)reach * width;
    return at[-(ptrdiff_t)reach] == *at && at[reach] == *at && *(at - row) == *at && *(at + row) == *at;
}

/* For each muscle in the map its count of pixels, and the inner pixel nearest to the middle of them. */
static void measure(const uint32_t *map, uint32_t width, uint32_t height, uint32_t count, muscle_sight *sight,
                    double *sum, float *best)
{
    memset(sum, 0, 2 * (size_t)count * sizeof *sum);
    for (uint32_t m = 0; m < count; m++) {
        sight[m].seen_px = 0;
        best[m] = INFINITY;
    }
    for (size_t i = 0; i < (size_t)width * height; i++) {
        if (map[i] < count) {
            const size_t column = i % width, row = i / width;
            sight[map[i]].seen_px++;
            sum[2 * (size_t)map[i]] += (double)column;
            sum[2 * (size_t)map[i] + 1] += (double)row;
        }
    }
    for (uint32_t reach = 7; reach > 1; reach -= 2) { /* well inside where there is such a place */
        for (size_t i = 0; i < (size_t)width * height; i++) {
            const uint32_t m = map[i], x = (uint32_t)(i % width), y = (uint32_t)(i / width);
            if (m >= count || (best[m] < INFINITY && best[m] < 0) ||
                !is_inside(map, width, height, x, y, reach - 2)) {
                continue;
            }
            double n = (double)sight[m].seen_px;
            double dx = (double)x - sum[2 * (size_t)m] / n, dy = (double)y - sum[2 * (size_t)m + 1] / n;
            float d = (float)(dx * dx + dy * dy);
            if (d < best[m]) {
                best[m] = d;
                sight[m].x = (float)x + 0.5f;
                sight[m].y = (float)y + 0.5f;
            }
        }
        for (uint32_t m = 0; m < count; m++) {
            best[m] = best[m] < INFINITY ? -1.0f : INFINITY; /* settled */
        }
    }
}

/* What each muscle shows alone, and which muscle of the whole picture lies over it. */
static ris_result look_alone(ris_draw *draw, const ris_sim *sim, const ris_camera *camera, uint32_t width,
                             uint32_t height, const uint32_t *map, uint32_t *alone, muscle_sight *sight,
                             uint32_t *cover, ris_error *err)
{
    const uint32_t count = ris_sim_get_model(sim)->muscle_count;
    bool *only = calloc(count + 1u, sizeof *only);
    if (!only) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    }
    ris_result r = RIS_OK;
    for (uint32_t m = 0; !r && m < count; m++) {
        only[m] = true;
        ris_draw_set_muscles(draw, only);
        only[m] = false;
        r = ris_draw_muscle_map(draw, sim, camera, width, height, alone, err);
        double x = 0, y = 0;
        for (size_t i = 0; !r && i < (size_t)width * height; i++) {
            if (alone[i] == m) {
                const size_t column = i % width, row = i / width;
                sight[m].whole_px++;
                x += (double)column;
                y += (double)row;
                if (map[i] != m && map[i] < count) {
                    cover[(size_t)m * count + map[i]]++;
                }
            }
        }
        if (sight[m].seen_px == 0 && sight[m].whole_px > 0) {
            sight[m].x = (float)(x / sight[m].whole_px);
            sight[m].y = (float)(y / sight[m].whole_px);
        }
    }
    free(only);
    return r;
}

ris_result anatomy_look(ris_draw *draw, const ris_sim *sim, const ris_camera *camera, uint32_t width,
                        uint32_t height, muscle_sight *sight, uint32_t *cover, ris_error *err)
{
    const uint32_t count = ris_sim_get_model(sim)->muscle_count;
    const size_t pixels = (size_t)width * height;
    uint32_t *map = malloc(2 * pixels * sizeof *map);
    double *sum = calloc(2 * (size_t)count + 1, sizeof *sum);
    float *best = calloc(count + 1u, sizeof *best);
    ris_result r = map && sum && best ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    memset(sight, 0, count * sizeof *sight);
    if (!r) {
        r = ris_draw_muscle_map(draw, sim, camera, width, height, map, err);
    }
    if (!r) {
        measure(map, width, height, count, sight, sum, best);
    }
    if (!r && cover) {
        memset(cover, 0, (size_t)count * count * sizeof *cover);
        r = look_alone(draw, sim, camera, width, height, map, map + pixels, sight, cover, err);
    }
    free(map);
    free(sum);
    free(best);
    return r;
}

/* The muscles of one name that are seen: one, or one of each side. */
typedef struct name_sight {
    const muscle_sight *sight[2]; /* more first; the second may be NULL */
    char text[LABEL_TEXT_SIZE];
} name_sight;

static int by_height(const void *a, const void *b)
{
    const float p = ((const name_sight *)a)->sight[0]->y, q = ((const name_sight *)b)->sight[0]->y;
    return p < q ? -1 : p > q;
}

static uint32_t collect(const ris_model *model, const muscle_sight *sight, uint32_t least_px,
                        name_sight *name)
{
    uint32_t count = 0;
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        char text[LABEL_TEXT_SIZE];
        uint32_t at = 0;
        if (sight[m].seen_px < least_px || sight[m].seen_px == 0) {
            continue;
        }
        anatomy_title(model->muscle[m].name, text);
        while (at < count && strcmp(name[at].text, text) != 0) {
            at++;
        }
        if (at == count) {
            name[count] = (name_sight){.sight = {&sight[m], NULL}};
            memcpy(name[count++].text, text, sizeof text);
        } else {
            bool more = sight[m].seen_px > name[at].sight[0]->seen_px;
            name[at].sight[1] = more ? name[at].sight[0] : &sight[m];
            name[at].sight[0] = more ? &sight[m] : name[at].sight[0];
        }
    }
    return count;
}

ris_result anatomy_labels(const ris_model *model, const muscle_sight *sight, uint32_t least_px,
                          ris_label *out, uint32_t *out_count, ris_error *err)
{
    name_sight *name = calloc(model->muscle_count + 1u, sizeof *name);
    if (!name) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    }
    bool left = false; /* of muscles that are seen alike on both sides every second is named on the left */
    *out_count = collect(model, sight, least_px, name);
    qsort(name, *out_count, sizeof *name, by_height);
    for (uint32_t i = 0; i < *out_count; i++) {
        const muscle_sight *a = name[i].sight[0], *b = name[i].sight[1];
        out[i] = (ris_label){.x = a->x, .y = a->y, .side = LABEL_EITHER};
        memcpy(out[i].text, name[i].text, sizeof out[i].text);
        if (b && (float)b->seen_px > 0.8f * (float)a->seen_px) {
            const muscle_sight *to = (a->x < b->x) == left ? a : b;
            out[i].x = to->x;
            out[i].y = to->y;
            out[i].side = left ? LABEL_LEFT : LABEL_RIGHT;
            left = !left;
        }
    }
    free(name);
    return RIS_OK;
}
