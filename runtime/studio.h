/* Pictures of a simulated head: one or several named views side by side. */
#pragma once

#include "backend.h"

#define STUDIO_VIEW_CAPACITY 4

typedef struct ris_studio ris_studio;

/* "front,34,profile": up to four names. RIS_ERROR_USAGE for an unknown one. */
typedef struct studio_views {
    char name[STUDIO_VIEW_CAPACITY][16];
    uint32_t count;
} studio_views;
ris_result studio_views_parse(const char *text, studio_views *out, ris_error *err);

/* What the pictures show beside the head itself. */
typedef struct studio_look {
    bool wireframe;
    uint32_t layers; /* of risorius/draw.h; 0 = skin */
    float zoom;      /* 0 = as the views frame the head; above 1 nearer to its nose and mouth */
    bool labels;     /* names of what the layers show, and their colour scales */
} studio_look;

/* width and height of one view; the picture is count x width wide. backend has a device. */
ris_result studio_create(const ris_backend *backend, const studio_views *views, uint32_t width,
                         uint32_t height, const studio_look *look, ris_studio **out, ris_error *err);
void studio_destroy(ris_studio *studio);
/* Draws sim with these positions and normals, or its present state when both are NULL. *out_rgba belongs to the
 * studio and stays until the next call (picture width x height x 4). */
ris_result studio_shoot(ris_studio *studio, ris_sim *sim, const ris_vec4 *position, const ris_vec4 *normal,
                        const uint8_t **out_rgba, ris_error *err);
