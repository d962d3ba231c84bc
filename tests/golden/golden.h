/* Comparing pictures with committed references: tests/golden/reference/<name>.png. */
#pragma once

#include "risorius/base.h"

/* Absolute differences of the 8-bit colour channels, over all pixels. */
typedef struct golden_difference {
    double mean;
    unsigned p99, max;
} golden_difference;

/* What still counts as the same picture: rounding and edge samples of another driver, not a moved or repainted one. */
typedef struct golden_limit {
    double mean;
    unsigned p99, max;
} golden_limit;
#define GOLDEN_LIMIT ((golden_limit){0.5, 8, 96})

golden_difference golden_compare(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height);
bool golden_within(golden_difference difference, golden_limit limit);
/* Compares rgba with the reference `name`; on failure writes <build>/golden/<name>.actual.png and .difference.png and
 * says so. A missing reference fails. With RIS_UPDATE_GOLDEN=name (or "all") writes the reference instead. */
bool golden_check(const char *name, const uint8_t *rgba, uint32_t width, uint32_t height);
