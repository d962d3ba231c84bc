/* Which muscle is seen where, by a small software rasteriser: for labels, and to measure what hides what. */
#include "draw/draw_impl.h"

#include "model/vec3.h"

#include <math.h>
#include <stdlib.h>

#define BONE (UINT32_MAX - 1)

/* One picture: what is nearest at the middle of each pixel. */
typedef struct canvas {
    const ris_camera *camera;
    uint32_t width, height;
    uint32_t *id;
    float *nearness; /* 1 / distance along the view */
} canvas;

typedef struct spot {
    float x, y, nearness;
} spot;

static bool project(const canvas *to, const float place[12], ris_vec4 p, spot *out)
{
    const ris_vec3 world = {place[0] * p.x + place[1] * p.y + place[2] * p.z + place[3],
                            place[4] * p.x + place[5] * p.y + place[6] * p.z + place[7],
                            place[8] * p.x + place[9] * p.y + place[10] * p.z + place[11]};
    float distance;
    if (!ris_camera_project(to->camera, to->width, to->height, world, &out->x, &out->y, &distance) ||
        distance < 1.0f) {
        return false;
    }
    out->nearness = 1.0f / distance;
    return true;
}

static float cross2(const spot *a, const spot *b, float x, float y)
{
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

static void fill(const canvas *to, const spot s[3], uint32_t id)
{
    const float area = cross2(&s[0], &s[1], s[2].x, s[2].y);
    if (!(area < 0.0f)) { /* seen from behind, or on edge: rows of a picture run down */
        return;
    }
    const float low_x = f_max(floorf(f_min(s[0].x, f_min(s[1].x, s[2].x))), 0.0f),
                low_y = f_max(floorf(f_min(s[0].y, f_min(s[1].y, s[2].y))), 0.0f),
                high_x = f_min(ceilf(f_max(s[0].x, f_max(s[1].x, s[2].x))), (float)to->width),
                high_y = f_min(ceilf(f_max(s[0].y, f_max(s[1].y, s[2].y))), (float)to->height);
    for (float y = low_y + 0.5f; y < high_y; y += 1.0f) {
        for (float x = low_x + 0.5f; x < high_x; x += 1.0f) {
            const float a = cross2(&s[1], &s[2], x, y) / area, b = cross2(&s[2], &s[0], x, y) / area,
                        c = 1.0f - a - b;
            if (a < 0.0f || b < 0.0f || c < 0.0f) {
                continue;
            }
            const float nearness = a * s[0].nearness + b * s[1].nearness + c * s[2].nearness;
            const size_t at = (size_t)y * to->width + (size_t)x;
            if (nearness > to->nearness[at]) {
                to->nearness[at] = nearness;
                to->id[at] = id;
            }
        }
    }
}

static void fill_all(const canvas *to, const float place[12], const ris_vec4 *position, const uint32_t *index,
                     uint32_t count, uint32_t id)
{
    for (uint32_t i = 0; i < count; i += 3) {
        spot s[3];
        if (project(to, place, position[index[i]], &s[0]) &&
            project(to, place, position[index[i + 1]], &s[1]) &&
            project(to, place, position[index[i + 2]], &s[2])) {
            fill(to, s, id);
        }
    }
}

static void fill_layers(const ris_draw *draw, const ris_sim *sim, const canvas *to)
{
    const ris_draw_layers *layers = &draw->layers;
    const ris_vec4 *position = layers->position.data;
    float head[12];
    ris_sim_head_transform(sim, head);
    for (uint32_t b = 0; b < layers->bone_count && (draw->shown & RIS_LAYER_SKULL); b++) {
        float place[12];
        if (draw->jawless && layers->bone[b].bone == RIS_BONE_JAW) {
            continue;
        }
        ris__draw_place(sim, layers->bone[b].bone, place);
        fill_all(to, place, position, layers->bone_index + layers->bone[b].first_index,
                 layers->bone[b].index_count, BONE);
    }
    for (uint32_t m = 0; m < draw->model->muscle_count && (draw->shown & RIS_LAYER_MUSCLES); m++) {
        const ris_muscle_body *body = &layers->muscles.body[m];
        if (layers->shown[m]) {
            fill_all(to, head, position + layers->bone_vertex_count,
                     layers->muscles.index + body->first_index, body->index_count, m);
        }
    }
}

ris_result ris_draw_muscle_map(ris_draw *draw, const ris_sim *sim, const ris_camera *camera, uint32_t width,
                               uint32_t height, uint32_t *out, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    const size_t pixels = (size_t)width * height;
    if (!layers->ready) {
        return ris_fail(err, RIS_ERROR_USAGE, "no layer of muscles is shown");
    }
    float *nearness = calloc(pixels + 1, sizeof *nearness);
    if (nearness == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a map of %ux%u", (unsigned)width,
                        (unsigned)height);
    }
    ris__muscle_mesh_place(&layers->muscles, sim,
                           (ris_vec4 *)layers->position.data + layers->bone_vertex_count,
                           (ris_vec4 *)layers->normal.data + layers->bone_vertex_count);
    for (size_t i = 0; i < pixels; i++) {
        out[i] = UINT32_MAX;
    }
    const canvas to = {camera, width, height, out, nearness};
    fill_layers(draw, sim, &to);
    for (size_t i = 0; i < pixels; i++) {
        out[i] = out[i] == BONE ? UINT32_MAX : out[i];
    }
    free(nearness);
    return RIS_OK;
}
