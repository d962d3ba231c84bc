/* The rigid motion between two sets of points. */
#pragma once

#include "risorius/base.h"

typedef struct ris_motion {
    double turn[9], shift[3]; /* x -> turn x + shift, row-major, mm */
} ris_motion;

/* The motion that takes from (count) nearest to onto (count) in the mean square (Horn 1987, unit quaternions). False if the
 * points lie on a line or less. */
bool ris__align(uint32_t count, const ris_vec3 *from, const ris_vec3 *onto, ris_motion *out);
ris_vec3 ris__motion_apply(const ris_motion *motion, ris_vec3 p);
double ris__motion_degrees(const ris_motion *motion);
