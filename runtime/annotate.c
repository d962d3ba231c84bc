#include "annotate.h"

#include "anatomy.h"
#include "risorius/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_PX 60u /* a muscle of which less is seen gets no name */

/* A picture that is written on. */
typedef struct page {
    uint8_t *rgba;
    uint32_t width, height;
} page;

static int text_scale(const page *to)
{
    return to->height < 1000 ? 1 : (int)(to->height / 700);
}

static ris_result name_muscles(ris_draw *draw, ris_sim *sim, const ris_camera *camera, const page *to,
                               ris_error *err)
{
    static const uint8_t ink[3] = {236, 236, 232};
    const ris_model *model = ris_sim_get_model(sim);
    const float scale = fmaxf((float)to->height / 620.0f, 1.0f), middle = 0.5f * (float)to->width;
    const float column[2] = {middle - 0.35f * (float)to->height, middle + 0.35f * (float)to->height};
    muscle_sight *sight = calloc(model->muscle_count + 1u, sizeof *sight);
    ris_label *label = calloc(model->muscle_count + 1u, sizeof *label);
    uint32_t count = 0;
    ris_result r = sight && label ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    if (!r) {
        r = anatomy_look(draw, sim, camera, to->width, to->height, sight, NULL, err);
    }
    if (!r) {
        r = anatomy_labels(model, sight, LEAST_PX, label, &count, err);
    }
    if (!r) {
        labels_draw(to->rgba, to->width, to->height, label, count, column, scale, ink);
    }
    free(sight);
    free(label);
    return r;
}

/* Point of skull space in the picture; false behind the camera. */
static bool project(const ris_sim *sim, const ris_camera *camera, const page *to, ris_vec3 p, float out[2])
{
    float h[12];
    ris_sim_head_transform(sim, h);
    const ris_vec3 world = {h[0] * p.x + h[1] * p.y + h[2] * p.z + h[3],
                            h[4] * p.x + h[5] * p.y + h[6] * p.z + h[7],
                            h[8] * p.x + h[9] * p.y + h[10] * p.z + h[11]};
    return ris_camera_project(camera, to->width, to->height, world, &out[0], &out[1], NULL);
}

/* True when the skin or bone around a landmark faces the camera: its triangle is seen counter-clockwise. */
static bool faces(const ris_sim *sim, const ris_camera *camera, const page *to, const ris_landmark *mark,
                  const ris_vec4 *position)
{
    const ris_head *head = ris_sim_get_model(sim)->head;
    float at[3][2], jaw[12];
    ris_sim_bone_transform(sim, mark->mesh == RIS_LANDMARK_MANDIBLE ? RIS_BONE_JAW : RIS_BONE_SKULL, jaw);
    for (int k = 0; k < 3; k++) {
        const ris_vec4 n = position[mark->mesh == RIS_LANDMARK_SKIN ? mark->vertex[k] : 0];
        ris_vec3 p = {n.x, n.y, n.z};
        if (mark->mesh != RIS_LANDMARK_SKIN) {
            const ris_mesh *bone = mark->mesh == RIS_LANDMARK_SKULL ? &head->skull : &head->mandible;
            const ris_vec3 b = bone->position[mark->vertex[k]];
            p = (ris_vec3){jaw[0] * b.x + jaw[1] * b.y + jaw[2] * b.z + jaw[3],
                           jaw[4] * b.x + jaw[5] * b.y + jaw[6] * b.z + jaw[7],
                           jaw[8] * b.x + jaw[9] * b.y + jaw[10] * b.z + jaw[11]};
        }
        if (!project(sim, camera, to, p, at[k])) {
            return false;
        }
    }
    const float area =
        (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
    return area < 0 || (area == 0 && mark->mesh != RIS_LANDMARK_SKIN);
}

typedef struct box {
    float x0, y0, x1, y1;
} box;

/* The first place around a mark that is free; false when there is none. */
static bool find_room(const page *to, const box *taken, uint32_t count, const float at[2], float w, float h,
                      box *out)
{
    const float off = 5.0f * (float)text_scale(to);
    const float place[4][2] = {{at[0] + off, at[1] - 0.5f * h},
                               {at[0] - off - w, at[1] - 0.5f * h},
                               {at[0] - 0.5f * w, at[1] - off - h},
                               {at[0] - 0.5f * w, at[1] + off}};
    for (int k = 0; k < 4; k++) {
        const box b = {place[k][0], place[k][1], place[k][0] + w, place[k][1] + h};
        bool free_place = b.x0 >= 0 && b.y0 >= 0 && b.x1 <= (float)to->width && b.y1 <= (float)to->height;
        for (uint32_t i = 0; i < count && free_place; i++) {
            free_place =
                b.x1 <= taken[i].x0 || b.x0 >= taken[i].x1 || b.y1 <= taken[i].y0 || b.y0 >= taken[i].y1;
        }
        if (free_place) {
            *out = b;
            return true;
        }
    }
    return false;
}

/* Names of the skin's landmarks first; one that finds no free place stays a mark. */
static ris_result name_landmarks(const ris_sim *sim, const ris_camera *camera, const ris_vec4 *position,
                                 const page *to, ris_error *err)
{
    const ris_head *head = ris_sim_get_model(sim)->head;
    const int scale = text_scale(to);
    box *taken = calloc(head->landmark_count + 1u, sizeof *taken);
    uint32_t count = 0;
    if (!taken) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    }
    for (uint32_t i = 0; i < head->landmark_count; i++) {
        const ris_landmark *mark = &head->landmark[i];
        char text[sizeof mark->name + 8];
        float at[2];
        if (!faces(sim, camera, to, mark, position) ||
            !project(sim, camera, to, ris_sim_landmark(sim, i, position, NULL), at)) {
            continue;
        }
        snprintf(text, sizeof text, "%s%s", mark->name, mark->mesh == RIS_LANDMARK_SKIN ? "" : "'");
        if (find_room(to, taken, count, at, ris_label_width((float)scale, text) + (float)scale,
                      9.0f * (float)scale, &taken[count])) {
            ris_label_draw(to->rgba, to->width, to->height, (int)taken[count].x0, (int)taken[count].y0, scale,
                           text);
            count++;
        }
    }
    free(taken);
    return RIS_OK;
}

/* Blue, white, red, from -full to full, with its title over it, bottom end at y. */
static void draw_scale(const page *to, int y, const char *title, float full)
{
    const int scale = text_scale(to), wide = 120 * scale, high = 8 * scale, left = 12 * scale,
              top = y - 14 * scale - high;
    char text[32];
    for (int row = 0; row < high; row++) {
        for (int x = 0; x < wide; x++) {
            const float s = 2.0f * ((float)x + 0.5f) / (float)wide - 1.0f, t = fabsf(s);
            const float end[3] = {s < 0 ? 40.0f : 225.0f, s < 0 ? 90.0f : 45.0f, s < 0 ? 225.0f : 38.0f};
            const int px = left + x, py = top + row;
            if (px >= 0 && py >= 0 && px < (int)to->width && py < (int)to->height) {
                uint8_t *at = to->rgba + 4 * ((size_t)py * to->width + (size_t)px);
                for (int c = 0; c < 3; c++) {
                    at[c] = (uint8_t)(235.0f + t * (end[c] - 235.0f));
                }
            }
        }
    }
    ris_label_draw(to->rgba, to->width, to->height, left, top - 12 * scale, scale, title);
    snprintf(text, sizeof text, "-%.0f %%", (double)(100.0f * full));
    ris_label_draw(to->rgba, to->width, to->height, left, top + high + 3 * scale, scale, text);
    ris_label_draw(to->rgba, to->width, to->height, left + wide / 2 - 3 * scale, top + high + 3 * scale,
                   scale, "0");
    snprintf(text, sizeof text, "+%.0f %%", (double)(100.0f * full));
    ris_label_draw(to->rgba, to->width, to->height, left + wide - (int)ris_label_width((float)scale, text),
                   top + high + 3 * scale, scale, text);
}

ris_result annotate_picture(ris_draw *draw, ris_sim *sim, const ris_camera *camera, const ris_vec4 *position,
                            uint32_t layers, uint8_t *rgba, uint32_t width, uint32_t height, ris_error *err)
{
    const page to = {rgba, width, height};
    ris_result r = RIS_OK;
    ris_vec4 *own = NULL;
    int foot = (int)height;
    if (layers & RIS_LAYER_MUSCLES) {
        r = name_muscles(draw, sim, camera, &to, err);
    }
    if (!r && (layers & RIS_LAYER_LANDMARKS) && !position) {
        own = calloc(ris_sim_get_model(sim)->node_count + 1u, sizeof *own);
        r = own ? ris_sim_read(sim, RIS_STATE_POSITION, own, err)
                : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for labels");
    }
    if (!r && (layers & RIS_LAYER_LANDMARKS)) {
        r = name_landmarks(sim, camera, position ? position : own, &to, err);
    }
    if (!r && (layers & RIS_LAYER_STRAIN)) {
        draw_scale(&to, foot, "strain (area)", RIS_STRAIN_FULL);
        foot -= 38 * text_scale(&to);
    }
    if (!r && (layers & RIS_LAYER_SPRINGS)) {
        draw_scale(&to, foot, "stretch of springs", RIS_STRETCH_FULL);
    }
    free(own);
    return r;
}
