/* How parts move with the head (KA-06): rigid parts by their bone, skin-bound parts (lashes, brows) by the skin triangle
 * below them. Shared by `export --parts` (evaluated here) and by the raster pass (evaluated in shaders/draw/ride.comp). */
#pragma once

#include "risorius/sim.h"

/* A vertex on a triangle. Frame of the triangle: x along its first edge, z its normal, y across; the origin is the
 * barycentric point. The vertices of a strand or card that stands off the skin share the triangle and the point of the
 * vertex nearest to the skin, their root, so that a lash keeps its shape. Those of the lower lid follow little of its turn: its
 * edge turns in before a squint, while lashes are rooted in the tarsus, which does not. */
typedef struct ris_ride {
    uint32_t vertex[3];
    float share[3];  /* barycentric, sums to 1 */
    ris_vec3 offset; /* mm in the frame */
    ris_vec3 still;  /* the same at rest, mm in the space of the head */
    float turn;      /* share of the triangle's turn that the offset follows, 0..1 */
    bool standing;   /* of a strand that stands off the skin */
} ris_ride;

/* Binds the vertices of mesh to the skin of model at rest: out and out_triangle (mesh->vertex_count); out_triangle is the
 * index into model->triangle. out_triangle may be NULL. RIS_ERROR_MEMORY. */
ris_result ris__ride_bind(const ris_model *model, const ris_mesh *mesh, ris_ride *out, uint32_t *out_triangle,
                          ris_error *err);
/* Point of triangle (a, b, c) nearest to p as barycentric shares; returns the squared distance, mm^2. */
float ris__ride_nearest(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c, float share[3]);
/* Rows x, y, z of the frame of triangle (a, b, c); false if it has no area. */
bool ris__ride_frame(ris_vec3 a, ris_vec3 b, ris_vec3 c, ris_vec3 frame[3]);
/* Offset of p from the barycentric point in the frame of the triangle. */
ris_vec3 ris__ride_offset(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c, const float share[3]);
/* An offset at rest and as the triangle turned it, of the same length: the share `turn` of the way. */
ris_vec3 ris__ride_turn(ris_vec3 still, ris_vec3 turned, float turn);
/* Where a ridden vertex is for these vertex positions. */
ris_vec3 ris__ride_place(const ris_ride *ride, const ris_vec4 *position);
