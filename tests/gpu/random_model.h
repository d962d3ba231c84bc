/* A model with random but legal tables (any topology, not a mesh), so that stages meet inputs no head
 * gives them: static nodes, nodes without springs or triangles, springs shorter, longer and much longer
 * than at rest. */
#pragma once

#include "risorius/model.h"

/* flags: RIS_TISSUE_FLAG_*. Same seed, same model. NULL without memory; freed by random_model_free. */
ris_model *random_model_create(uint32_t node_count, uint32_t flags, uint32_t seed);
void random_model_free(ris_model *model);

/* xorshift32: the same numbers everywhere. */
float random_unit(uint32_t *seed); /* 0 <= x < 1 */
float random_between(uint32_t *seed, float low, float high);
ris_vec4 random_vec(uint32_t *seed, float size, float w); /* each of x, y, z in -size..size */
