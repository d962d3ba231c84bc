/* Structs, bindings and group sizes of the simulation, read by C and GLSL.
 * Blocks use layout(scalar); tests/layout checks offsets, strides, bindings and group sizes against the SPIR-V. */
/* clang-format off */ /* the macros below read as structs to C and GLSL, not to the formatter */
#ifndef RIS_SIM_SHARED_H
#define RIS_SIM_SHARED_H

#ifdef RIS_GLSL
#define ris_float float
#define ris_uint uint
#define RIS_STRUCT(name) struct name
#define RIS_STRUCT_END(name)
#define ris_v4 vec4
#else
#include <stdint.h>
#include "risorius/base.h"
#define ris_float float
#define ris_uint uint32_t
#define RIS_STRUCT(name) typedef struct name
#define RIS_STRUCT_END(name) name
#define ris_v4 ris_vec4
#endif

#define RIS_GROUP_NODE 64

/* Binding numbers in set 0 of every simulation stage: storage buffers, those of fixed size uniform buffers. */
#define RIS_BIND_POSITION 0      /* ris_v4 (node_count): xyz mm, w inverse mass 1/g, 0 = static */
#define RIS_BIND_REST 1          /* ris_v4 (node_count): xyz mm at rest, w as position */
#define RIS_BIND_VELOCITY_HALF 2 /* ris_v4: v at t - dt/2, mm/s, w 0 */
#define RIS_BIND_VELOCITY_PREV 3 /* ris_v4: v at t - 3dt/2, mm/s, w 0 */
#define RIS_BIND_FORCE 4         /* ris_v4: g mm/s^2, w 0 */
#define RIS_BIND_BEND 5          /* ris_v4: umbrella vector of the displacement, mm, w 0 */
#define RIS_BIND_NORMAL 6        /* ris_v4: unit normal, w 0 */
#define RIS_BIND_SPRING_START 7  /* ris_uint (node_count + 1) */
#define RIS_BIND_HALF_SPRING 8   /* ris_half_spring (half_spring_count), sorted by node */
#define RIS_BIND_RING_START 9    /* ris_uint (node_count + 1) */
#define RIS_BIND_RING 10         /* ris_ring (ring_count), sorted by node */
#define RIS_BIND_ANCHOR_PARAM 11 /* ris_anchor_param (node_count) */
#define RIS_BIND_ANCHOR_POINT 12 /* ris_anchor_point (node_count), written once a frame */
#define RIS_BIND_ANCHOR_DELTA 13 /* ris_v4 (node_count): change of the anchor since last frame, mm, w 0 */
#define RIS_BIND_FREE 14         /* ris_v4 (node_count): position before contact, mm; written by verlet, read by contact */
#define RIS_BIND_CONTACT_NODE 15  /* ris_contact_node (contact_node_count): lip_node_count with lips, then those with bodies */
#define RIS_BIND_CONTACT_TOUCH 16 /* ris_contact_touch (contact_touch_count), sorted by contact node */
#define RIS_BIND_CONTACT_OTHER 17 /* ris_uint (contact_pair_count): nodes of the other lip, sorted by contact node */
#define RIS_BIND_CONTACT_GRID 18  /* ris_v4 (contact_sample_count): xyz unit, away from the body; w distance, mm, negative inside */
#define RIS_BIND_CONTACT_BODY 19  /* ris_contact_body (RIS_CONTACT_BODIES), written once a frame */
#define RIS_BIND_INERTIA 20       /* ris_inertia (1), written once a frame */
#define RIS_BIND_HEFT 21          /* ris_float (node_count): what the tissue at the node weighs over 25 mm^2 x 10 mm of it */
#define RIS_BIND_MOVING 22        /* ris_uint (moving_count): the nodes that move; the others stay as they were written */
#define RIS_BIND_COUNT 23

/* Texel buffers over some of these arrays, of vec4 or of words, for gathers: lavapipe reads a storage buffer lane by lane. */
#define RIS_TEXEL_POSITION 23
#define RIS_TEXEL_REST 24
#define RIS_TEXEL_BEND 25
#define RIS_TEXEL_NORMAL 26
#define RIS_TEXEL_FREE 27
#define RIS_TEXEL_CONTACT_GRID 28
#define RIS_TEXEL_HALF_SPRING 29 /* words: shaders/lib/half_spring.glsl */
#define RIS_TEXEL_END 30

/* Specialization constants, booleans. */
#define RIS_CONSTANT_KAEHLER 0    /* spring_force: anchor pair instead of normal + tangential anchor */
#define RIS_CONSTANT_CONTINUOUS 1 /* spring_force: continuous biphasic law */
#define RIS_CONSTANT_LIPS 2       /* contact: keep off the other lip; false: off bodies */

/* One spring seen from one of its nodes. Each spring appears twice. */
RIS_STRUCT(ris_half_spring) {
    ris_uint other;      /* node at the far end */
    ris_float rest_mm;   /* rest length r */
    ris_float area_ratio;/* g = sum of incident triangle areas / r^2 (KA-11), no unit */
    ris_float bend_out;  /* weight of `other` in this node's umbrella, sums to 1 over the node */
    ris_float bend_in;   /* bending stiffness of `other` x weight of this node in its umbrella, g/s^2; 0 if not simulated */
} RIS_STRUCT_END(ris_half_spring);

/* One triangle around a node: node, b, c counter-clockwise. */
RIS_STRUCT(ris_ring) {
    ris_uint b;
    ris_uint c;
} RIS_STRUCT_END(ris_ring);

/* Anchor stiffness of a node, g/s^2, already scaled. Zero for static nodes.
 * risorius: normal and tangential; kaehler: normal = k of each of the pair's springs, rest_mm their length. */
RIS_STRUCT(ris_anchor_param) {
    ris_float normal;
    ris_float tangential;
    ris_float rest_mm;
    ris_float bend; /* bending stiffness of this node's umbrella, g/s^2, 0 if not simulated */
} RIS_STRUCT_END(ris_anchor_param);

/* Anchor of a node this frame. risorius: a = target position mm, b = unit normal of the anchor.
 * kaehler: a = anchor A mm, b = mirror M mm (KA-15). */
RIS_STRUCT(ris_anchor_point) {
    ris_v4 a;
    ris_v4 b;
} RIS_STRUCT_END(ris_anchor_point);

#define RIS_CONTACT_BODIES 6 /* at most: two eyes, skull, mandible, two rows of teeth */

/* A node that can touch the other lip, or bodies; one that can do both stands in the list twice. */
RIS_STRUCT(ris_contact_node) {
    ris_uint node;
    ris_uint lip_first; /* of its nodes of the other lip, up to lip_end */
    ris_uint lip_end;
    ris_float lip_limit_mm; /* least distance from the other lip */
    ris_uint touch_first;   /* of its bodies, up to touch_end */
    ris_uint touch_end;
} RIS_STRUCT_END(ris_contact_node);

/* A body that a node can touch, or that the middle of one of its edges can. */
RIS_STRUCT(ris_contact_touch) {
    ris_uint body;
    ris_uint other;     /* far end of the edge; the node itself for the node */
    ris_float limit_mm; /* least distance from it */
} RIS_STRUCT_END(ris_contact_touch);

/* A rigid body that the skin stays off: its distance grid (x fastest) in its rest frame, and its place this frame. */
RIS_STRUCT(ris_contact_body) {
    ris_v4 row_x; /* world -> rest frame, rows of a 3x4 */
    ris_v4 row_y;
    ris_v4 row_z;
    ris_v4 low;      /* xyz: first sample, mm; w: samples per mm */
    ris_uint count_x; /* samples along each axis; 0 = no body */
    ris_uint count_y;
    ris_uint count_z;
    ris_uint first; /* of its samples in the grid array */
} RIS_STRUCT_END(ris_contact_body);

/* What the flesh feels of the head's motion: acceleration = rows of a 3x4 applied to the position, mm/s^2. */
RIS_STRUCT(ris_inertia) {
    ris_v4 row_x;
    ris_v4 row_y;
    ris_v4 row_z;
} RIS_STRUCT_END(ris_inertia);

#define RIS_TISSUE_FLAG_KAEHLER 1u    /* anchor pair instead of normal + tangential anchor */
#define RIS_TISSUE_FLAG_CONTINUOUS 2u /* continuous biphasic law */

/* Push constants of every stage (<= 128 bytes). */
RIS_STRUCT(ris_sim_push) {
    ris_uint node_count;
    ris_uint flags;
    ris_float dt_s;
    ris_float modulus_low;   /* g/s^2 */
    ris_float modulus_high;  /* g/s^2 */
    ris_float switch_stretch;
    ris_float compression;   /* factor on modulus_low when l < r */
    ris_float damping_per_s; /* gamma / m, 1/s */
    ris_uint contact_node_count;
    ris_uint lip_node_count; /* the first of the contact nodes, those with lips */
    ris_float lip_radius_mm; /* lips feel each other this far */
    ris_uint moving_count;
} RIS_STRUCT_END(ris_sim_push);

#ifdef RIS_GLSL
#undef RIS_STRUCT
#undef RIS_STRUCT_END
#endif
#endif
