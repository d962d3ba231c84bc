/* One step of Catmull-Clark subdivision baked into weights: a smooth surface from a coarse animated mesh. The skin is
 * simulated on its own vertices; what is drawn is a weighted sum of them, the same sum every frame. */
#pragma once

#include "risorius/head.h"

#include "draw_shared.h"

typedef struct ris_refined {
    uint32_t vertex_count, term_count, quad_count, corner_count, index_count;
    uint32_t *term_start; /* (vertex_count + 1); the weights of a vertex sum to 1 */
    ris_draw_term *term;  /* (term_count) */
    uint32_t *quad;       /* counter-clockwise outward (quad_count x 4) */
    uint32_t *quad_face;  /* coarse face each quad came from (quad_count) */
    uint32_t *ring_start; /* (vertex_count + 1) */
    uint32_t *ring; /* next and previous vertex of each quad around a vertex (ring_start[vertex_count] x 2) */
    ris_draw_corner *corner;      /* (corner_count) unique (vertex, uv) pairs */
    uint32_t *index;              /* triangles of the quads, into corner (index_count) */
    uint32_t *drawn, drawn_count; /* triangles that are drawn, into corner: index, or finer (fold_mesh.h) */
} ris_refined;

/* levels 0 keeps the faces as they are, 1 refines once. A triangle is a quad whose last two corners are equal.
 * RIS_ERROR_MEMORY. On failure *out is zeroed. */
ris_result ris__refine(const ris_mesh *mesh, uint32_t levels, ris_refined *out, ris_error *err);
void ris__refined_finish(ris_refined *refined);
/* Positions of the drawn surface for positions of the coarse one. */
void ris__refined_position(const ris_refined *refined, const ris_vec3 *source, ris_vec3 *out);
/* Unit area-weighted normals of the drawn surface. */
void ris__refined_normal(const ris_refined *refined, const ris_vec3 *position, ris_vec3 *out);
