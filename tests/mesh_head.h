/* A head made of a handful of vertices and faces, for the hand-computed numbers. */
#pragma once

#include "risorius/model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* faces: corner counts, then the corners in one row. All vertices move unless pinned says otherwise.
 * Release with ris_head_finish. */
static inline ris_head mesh_head(uint32_t vertex_count, const ris_vec3 *position, uint32_t face_count,
                                 const uint32_t *corners, const uint32_t *vertex, const bool *pinned)
{
    ris_head head = {.tissue = ris_default_tissue()};
    uint32_t total = 0;
    for (uint32_t f = 0; f < face_count; ++f) {
        total += corners[f];
    }
    head.skin.vertex_count = vertex_count;
    head.skin.face_count = face_count;
    head.skin.position = malloc(vertex_count * sizeof *position);
    head.skin.face_start = calloc((size_t)face_count + 1, sizeof(uint32_t));
    head.skin.face_vertex = malloc(total * sizeof(uint32_t));
    head.skin.face_uv = malloc(total * sizeof(uint32_t));
    memcpy(head.skin.position, position, vertex_count * sizeof *position);
    memcpy(head.skin.face_vertex, vertex, total * sizeof(uint32_t));
    memset(head.skin.face_uv, 0xff, total * sizeof(uint32_t));
    for (uint32_t f = 0; f < face_count; ++f) {
        head.skin.face_start[f + 1] = head.skin.face_start[f] + corners[f];
    }
    head.depth_mm = malloc(vertex_count * sizeof(float));
    head.jaw_weight = calloc(vertex_count, sizeof(float));
    head.region_count = 1;
    head.region = calloc(1, sizeof *head.region);
    head.region->vertex = malloc(vertex_count * sizeof(uint32_t));
    snprintf(head.region->name, sizeof head.region->name, "face");
    snprintf(head.simulated, sizeof head.simulated, "face");
    for (uint32_t i = 0; i < vertex_count; ++i) {
        head.depth_mm[i] = 6.0f;
        if (!pinned || !pinned[i]) {
            head.region->vertex[head.region->count++] = i;
        }
    }
    head.jaw.axis.x = 1.0f;
    head.jaw.open_deg = 20.0f;
    return head;
}

/* One muscle on a rows x columns grid; the head must have no muscle yet. */
static inline ris_muscle_def *add_muscles(ris_head *head, uint32_t count)
{
    head->muscle = calloc(count, sizeof *head->muscle);
    head->muscle_count = count;
    return head->muscle;
}

static inline void set_muscle(ris_muscle_def *def, const char *name, uint32_t rows, uint32_t columns,
                              const ris_vec3 *grid)
{
    snprintf(def->name, sizeof def->name, "%s", name);
    def->kind = RIS_MUSCLE_LINEAR;
    def->bone = RIS_BONE_SKULL;
    def->rows = rows;
    def->columns = columns;
    def->grid = malloc((size_t)rows * columns * sizeof *grid);
    memcpy(def->grid, grid, (size_t)rows * columns * sizeof *grid);
    def->thickness_mm[0] = 2.0f;
    def->thickness_mm[1] = 6.0f;
    def->max_shortening = 0.2f;
    def->radius_mm = 10.0f;
    def->gain = 1.2f;
    def->attach_auto = true;
    def->origin = calloc(1, 1);
    def->insertion = calloc(1, 1);
    def->source = calloc(1, 1);
}

/* The half spring from a to b, or NULL. */
static inline const ris_half_spring *find_spring(const ris_model *model, uint32_t a, uint32_t b)
{
    for (uint32_t h = model->spring_start[a]; h < model->spring_start[a + 1]; ++h) {
        if (model->half_spring[h].other == b) {
            return &model->half_spring[h];
        }
    }
    return NULL;
}
