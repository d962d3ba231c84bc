/* Muscles as closed bodies for drawing, not the shapes of KA-25: one for each muscle, its section spans all fibres side by side with the
 * width and height of their segments, its ends are rounded. Knows no Vulkan. */
#pragma once

#include "risorius/sim.h"

#include "draw_shared.h"

/* The body of one muscle: rows of ring_count vertices along it. */
typedef struct ris_muscle_body {
    uint32_t first_vertex, row_count, ring_count;
    uint32_t first_index, index_count;
    bool reversed; /* fibres taken from the last, so that sections run against `wide` */
} ris_muscle_body;

/* What a fibre is at one row. */
typedef struct ris_muscle_slice {
    ris_vec3 centre, up, wide;
    float height, width; /* mm */
} ris_muscle_slice;

typedef struct ris_muscle_mesh {
    const ris_model *model;
    uint32_t vertex_count, index_count;
    ris_muscle_body *body; /* (model->muscle_count) */
    uint32_t *index;       /* triangles, counter-clockwise outward (index_count) */
    float *across,
        *along;      /* place of a vertex: in fibres from one edge, 0..1 from the fixed end (vertex_count) */
    float *tendon;   /* 0 flesh .. 1 tendon (vertex_count) */
    ris_vec3 *point; /* scratch of ris__muscle_mesh_place */
    ris_segment *segment;
    ris_muscle_slice *slice;
} ris_muscle_mesh;

/* RIS_ERROR_MEMORY; on failure *out is zeroed. */
ris_result ris__muscle_mesh_build(const ris_model *model, ris_muscle_mesh *out, ris_error *err);
void ris__muscle_mesh_finish(ris_muscle_mesh *mesh);
/* Bodies at the last tick of sim, or at rest without one: positions with w 1, unit normals with w 0 (vertex_count). */
void ris__muscle_mesh_place(ris_muscle_mesh *mesh, const ris_sim *sim, ris_vec4 *position, ris_vec4 *normal);
