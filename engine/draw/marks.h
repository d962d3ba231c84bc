/* Flat marks in the picture: springs as ribbons, landmarks as discs, dowels as ribbons; all turned to the camera. Knows
 * no Vulkan. */
#pragma once

#include "risorius/draw.h"

/* Marks in drawing order: dowels and landmarks on bone, springs, landmarks on the skin. */
typedef struct ris_marks {
    uint32_t vertex_count, index_count;
    uint32_t bone_index_count, spring_index_count, skin_index_count; /* follow each other in index */
    uint32_t *index; /* triangles, seen from both sides (index_count) */
} ris_marks;

ris_result ris__marks_build(const ris_model *model, ris_marks *out, ris_error *err);
void ris__marks_finish(ris_marks *marks);
/* Marks for these node positions seen from eye (skull space): position with w 1, colour as linear RGB and opacity
 * (vertex_count). layers: what is not in it is left out of the arrays. */
void ris__marks_place(const ris_marks *marks, const ris_sim *sim, const ris_vec4 *node, uint32_t layers,
                      ris_vec3 eye, ris_vec4 *position, ris_vec4 *color);
