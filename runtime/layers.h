/* Names of the layers on the command line. */
#pragma once

#include "risorius/base.h"

#define LAYER_NAMES "skin, muscles, skull, springs, landmarks, strain"

/* "skin,muscles": the mask of risorius/draw.h. RIS_ERROR_USAGE with the nearest names for an unknown one. */
ris_result layers_parse(const char *text, uint32_t *out, ris_error *err);
/* Name of the layer with that bit number, NULL beyond the last. */
const char *layers_name(uint32_t bit);
