/* A held pose against a sculpted expression of the same base mesh: two displacement fields s (simulated) and u (sculpted)
 * over the mapped vertices, weighted by vertex area w.
 *   cos    sum w s.u / sqrt(sum w s^2 sum w u^2)      1 = the same shape of motion
 *   gain   sqrt(sum w s^2 / sum w u^2)                1 = as much of it
 *   r2     1 - sum w |s - u|^2 / sum w u^2            1 = identical
 *   r2fit  the same after the best scaling of s: cos^2 where cos > 0
 *   far    share of sum w s^2 where the sculpt moves less than 0.3 mm: spill */
#pragma once

#include "risorius/model.h"

typedef struct ris_score {
    double cos, gain, r2, r2fit, far;
    double simulated_mm, sculpted_mm; /* largest displacements */
} ris_score;

typedef struct ris_scorer {
    const ris_model *model;
    uint32_t used_count;
    uint32_t *node;      /* mapped nodes, ascending (used_count) */
    double *area;        /* a third of the faces around, at rest, mm^2 (node_count) */
    double mm;           /* of the base mesh, per unit of the head */
    ris_vec4 *neutral;   /* (node_count) */
    uint32_t base_count; /* vertices of the base mesh */
} ris_scorer;

/* model must outlive it; neutral: positions at rest (node_count), copied. base: the base mesh that the head's skin.map
 * speaks of, in decimetres. RIS_ERROR_DATA: no map, a map that names no vertex, or one that base has not. */
ris_result ris__scorer_create(const ris_model *model, const ris_mesh *base, const ris_vec4 *neutral,
                              ris_scorer *out, ris_error *err);
void ris__scorer_finish(ris_scorer *scorer);

/* sculpt: displacements of the base mesh in its unit (base_count x 3). position: (node_count).
 * RIS_ERROR_DATA: the sculpt moves no mapped vertex. RIS_ERROR_FAILED: a position is not finite. */
ris_result ris__score_pose(const ris_scorer *scorer, const double *sculpt, const ris_vec4 *position,
                           ris_score *out, ris_error *err);
