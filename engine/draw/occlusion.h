/* How much of the surroundings each point of the head sees at rest, from depth pictures taken all around by a small
 * software rasteriser at load: dark nostrils, eye corners, ears, the inside of the mouth. */
#pragma once

#include "risorius/base.h"

typedef struct ris_occluder {
    uint32_t position_count;
    const ris_vec3 *position;
    const uint32_t *index; /* triangles (index_count) */
    uint32_t index_count;
} ris_occluder;

/* out (point_count) in 0..1: cosine-weighted visible share of the hemisphere of each point. RIS_ERROR_MEMORY. */
ris_result ris__occlusion(const ris_occluder *occluder, uint32_t occluder_count, const ris_vec3 *point,
                          const ris_vec3 *normal, uint32_t point_count, float *out, ris_error *err);
