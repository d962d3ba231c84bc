/* Names and scales written into a picture of layers. */
#pragma once

#include "risorius/draw.h"

/* Muscles in columns at the margins, landmarks beside their marks, colour scales of springs and strain at the foot, as
 * far as layers asks for them. draw has just drawn rgba (width x height x 4) with camera; position (node_count) or NULL
 * for the present state of sim. */
ris_result annotate_picture(ris_draw *draw, ris_sim *sim, const ris_camera *camera, const ris_vec4 *position,
                            uint32_t layers, uint8_t *rgba, uint32_t width, uint32_t height, ris_error *err);
