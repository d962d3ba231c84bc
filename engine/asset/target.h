/* Sculpted expression units as MakeHuman stores them: NAME.target, displacements of vertices of base.obj, in a checkout
 * or in a plain folder. Nothing of a head; what simulated expressions are measured against. */
#pragma once

#include "risorius/head.h"

#define RIS_MM_PER_BASE_UNIT 100.0 /* base.obj is in decimetres */

/* Where base.obj and the targets of a reference folder are. */
typedef struct ris_reference {
    char *base_path;        /* of base.obj */
    char *target_directory; /* of the .target files */
    ris_mesh base;          /* in its own unit */
} ris_reference;

/* Looks into directory itself (base.obj, expression/) and where a MakeHuman checkout keeps them, then reads base.obj.
 * RIS_ERROR_DATA names what was looked for. On failure *out is zeroed. */
ris_result ris__reference_load(const char *directory, ris_reference *out, ris_error *err);
void ris__reference_finish(ris_reference *reference);

/* Adds the displacements of one target to sum (vertex_count x 3, in the unit of base.obj). Lines are
 * "vertex x y z"; '#' starts a comment line. RIS_ERROR_DATA: name:line:col. */
ris_result ris__target_add(const char *name, const char *text, size_t size, uint32_t vertex_count,
                           double *sum, ris_error *err);
/* The sum of the targets whose names a unit joins with '+'; sum is zeroed first. */
ris_result ris__reference_unit(const ris_reference *reference, const char *unit, double *sum, ris_error *err);
