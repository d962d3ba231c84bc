/* KA-25, KA-26: shapes around the segments of a fibre, at rest or as it is deformed. Shapes decide which muscles merge
 * (KA-28) and are drawn; the simulation itself needs the frames alone. */
#pragma once

#include "risorius/model.h"

/* A hexahedron: corner k lies at the segment's end if k & 1, on its upper side if k & 2, on its wide side if k & 4. */
typedef struct ris_box {
    ris_vec3 corner[8];
} ris_box;

typedef struct ris_ellipsoid {
    ris_vec3 centre;
    ris_vec3 axis[3]; /* unit: along, up, wide */
    float half[3];    /* mm */
} ris_ellipsoid;

/* A fibre's control points at rest (p) and now (q; p itself for rest), and its bulge per segment (NULL = 1). */
typedef struct ris_fiber_pose {
    const ris_segment *segment; /* (segment_count) */
    const ris_vec3 *p, *q;      /* (segment_count + 1) */
    const float *bulge;         /* (segment_count) */
    uint32_t segment_count;
} ris_fiber_pose;

/* The pose of fibre `fiber` of a muscle at rest. */
ris_fiber_pose ris__fiber_at_rest(const ris_model *model, const ris_muscle *muscle, uint32_t fiber);

/* KA-26: a closed chain of boxes; neighbours share the mean of their corners. */
void ris__fiber_boxes(const ris_fiber_pose *pose, ris_box *out);
/* Distances of the hits of a ray on the outside of a chain, ascending, at most `room` of them; the number of all hits.
 * Even for every ray that starts outside and goes through. */
uint32_t ris__chain_hits(const ris_box *box, uint32_t count, ris_vec3 origin, ris_vec3 direction,
                         float *distance, uint32_t room);
bool ris__box_inside(const ris_box *box, ris_vec3 p);
/* Separating axes of the two hulls. */
bool ris__boxes_meet(const ris_box *a, const ris_box *b);

/* KA-25: length and width enlarged by a tenth, so that neighbours overlap. */
ris_ellipsoid ris__segment_ellipsoid(const ris_fiber_pose *pose, uint32_t segment);
/* Where the line enters and leaves; false if it passes by. */
bool ris__ellipsoid_ray(const ris_ellipsoid *e, ris_vec3 origin, ris_vec3 direction, float out[2]);
bool ris__ellipsoid_inside(const ris_ellipsoid *e, ris_vec3 p);
