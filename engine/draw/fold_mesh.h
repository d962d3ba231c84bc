/* A drawn skin fine enough to fold along the painted lines: its triangles are split where the map of the wrinkles has relief. */
#pragma once

#include "draw/refine.h"

typedef struct ris_fold_map {
    uint32_t width, height;
    uint8_t *height_of; /* (width x height), rows from above; RIS_DRAW_WRINKLE_FLAT x 255 = smooth */
} ris_fold_map;

/* Reads "<stem>_wrinkles.png" beside the colour texture; *out zeroed where there is none. RIS_ERROR_DATA names the file. */
ris_result ris__fold_map_read(const char *color_path, ris_fold_map *out, ris_error *err);
void ris__fold_map_finish(ris_fold_map *map);

/* Splits the drawn triangles at the middle of their edges where the map has relief; vertices, corners, terms and rings grow,
 * what was there before keeps its number. The quads stay as they are. RIS_ERROR_MEMORY. */
ris_result ris__fold_split(const ris_fold_map *map, const ris_vec3 *source, ris_refined *refined,
                           ris_error *err);
/* For each vertex: unit direction across the line at rest, and how far a whole fold moves it out, mm. RIS_ERROR_MEMORY. */
ris_result ris__fold_lines(const ris_fold_map *map, const ris_refined *refined, const ris_vec3 *position,
                           ris_vec4 *out, ris_error *err);
