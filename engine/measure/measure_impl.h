/* Parts of the measurer, one file each. */
#pragma once

#include "measure/measure.h"
#include "measure/solid.h"
#include "model/model_impl.h"

/* Skin against bones, teeth and eyes: penetration.c */
typedef struct ris_body {
    ris_measure measure; /* at vertices; midpoints are the next */
    ris_bone bone;
    ris_solids solids;
    const char *part[4]; /* name of each source of solids */
    double *rest_mm;     /* of each point: depth, or less the clearance outside (point_count) */
} ris_body;

#define RIS_BODY_MAX 16

typedef struct ris_penetration {
    uint32_t node_count;
    uint32_t vertex_count, point_count; /* moving vertices, then midpoints of edges */
    const ris_vec4 *rest_position;
    uint32_t (*end)[2]; /* of each point; equal for a vertex (point_count) */
    uint32_t body_count;
    ris_body body[RIS_BODY_MAX];
} ris_penetration;

ris_result ris__penetration_init(ris_penetration *out, const ris_model *model, const bool *moving,
                                 ris_error *err);
void ris__penetration_finish(ris_penetration *pen);
void ris__penetration_measure(const ris_penetration *pen, const ris_vec4 *position,
                              const ris_bone_frames *frames, ris_finding *out, ris_measure_trace *trace);
/* Absolute depths of the rest pose. */
void ris__penetration_rest(const ris_penetration *pen, ris_finding *out);

/* One sheet in the one that faces it: sheets.c */
typedef struct ris_sheet {
    const char *name;
    uint32_t node_count, triangle_count;
    uint32_t *node;     /* of this sheet alone (node_count) */
    uint32_t *triangle; /* vertices of the skin (triangle_count x 3) */
    uint32_t
        *neighbor; /* triangle across edge k, from corner k to k + 1, or UINT32_MAX (triangle_count x 3) */
    bool *border;  /* vertices on the edge of the sheet (model's node_count) */
} ris_sheet;

typedef struct ris_sheet_pair {
    ris_sheet sheet[2];
    double *rest_mm[2]; /* depth of each node at rest */
} ris_sheet_pair;

/* Nothing to measure, and RIS_OK, if the head lacks one of the regions. normal: any length, around each node. */
ris_result ris__sheets_init(ris_sheet_pair *out, const ris_model *model, const char *upper, const char *lower,
                            dvec *rest, const dvec *normal, ris_error *err);
void ris__sheets_finish(ris_sheet_pair *pair);
/* worst: of the measure in a trace (node_count), or NULL. */
ris_result ris__sheets_measure(const ris_sheet_pair *pair, dvec *position, const dvec *normal,
                               ris_finding *out, float *worst, ris_error *err);
/* Absolute depths of the rest pose. */
void ris__sheets_rest(const ris_sheet_pair *pair, ris_finding *out);

/* Triangles turned over: folds.c */
typedef struct ris_folds {
    const ris_model *model;
    uint32_t tested[2];     /* of lips and lids; others */
    uint8_t *kind;          /* of each triangle: 0 still, 1 lips and lids, 2 others (triangle_count) */
    uint32_t *around_start; /* triangles that share a vertex, without itself: CSR (triangle_count + 1) */
    uint32_t *around;
    double *rest; /* cosine with the neighbours at rest (triangle_count) */
} ris_folds;

/* area: vector of each triangle, twice its area along its normal (triangle_count). */
ris_result ris__folds_init(ris_folds *out, const ris_model *model, const bool *moving, const dvec *area,
                           ris_error *err);
void ris__folds_finish(ris_folds *folds);
/* flipped: of a trace, or NULL. */
void ris__folds_measure(const ris_folds *folds, const dvec *area, ris_finding out[2], uint32_t *flipped);
/* Those turned over at rest. */
void ris__folds_rest(const ris_folds *folds, ris_finding out[2]);

/* Mirror pairs at rest, (node_count), UINT32_MAX without; how many have none. mirror.c */
uint32_t ris__mirror_pairs(const ris_model *model, uint32_t *partner);
ris_finding ris__mirror_difference(const ris_model *model, const uint32_t *partner, const ris_vec4 *position,
                                   const ris_vec4 *mirrored);

static inline dvec dv_of(ris_vec4 p)
{
    return dv((double)p.x, (double)p.y, (double)p.z);
}
