/* A head baked for simulation: const, flat, shared by every simulation and drawing of it.
 * Node i is skin vertex i, so that caches and targets keep the order of skin.obj. */
#pragma once

#include "risorius/head.h"
#include "sim_shared.h" /* GPU-side structs: ris_half_spring, ris_ring, ris_anchor_param */

#ifdef __cplusplus
extern "C" {
#endif

/* One animation channel: a muscle, or a channel beside muscles (jaw.open, eye.yaw.L, head.x ...). KA-48 */
typedef struct ris_channel {
    char name[RIS_NAME_SIZE];
    float minimum, maximum; /* in file units: 0..1, degrees or mm; rest is 0 */
} ris_channel;

/* A fibre control polygon of a muscle and its segment frames at rest (KA-23, KA-24). */
typedef struct ris_fiber {
    uint32_t first_point;   /* into ris_model.fiber_point; point_count of the muscle follow */
    uint32_t first_segment; /* into ris_model.segment; point_count - 1 follow */
} ris_fiber;

/* Segment at rest: origin = centre, axes unit, size full extents in mm (length, height, width). */
typedef struct ris_segment {
    ris_vec3 origin, along, up, wide; /* along the fibre, towards the skin, across */
    ris_vec3 size;                    /* x length, y height, z width, mm */
} ris_segment;

typedef struct ris_muscle {
    char name[RIS_NAME_SIZE];
    ris_muscle_kind kind;
    bool on_jaw;                       /* KA-41 */
    uint32_t fiber_count, point_count; /* points per fibre */
    uint32_t first_fiber;
    float max_shortening, insertion_start, lip_drag_power, radius_mm, gain, strength;
    ris_vec3 axis[2];
    uint32_t tied_ring;        /* ring of the lip that it ties to the bone, UINT32_MAX: none */
    uint8_t lid_eye;           /* eye whose lids it moves: 1 = L, 2 = R, 0 = none */
    uint8_t tied_end;          /* half of the ring: 0 from its first point, 1 from its last */
    uint32_t pushed_ring;      /* ring of the lip that it pushes, UINT32_MAX: none */
    uint8_t pushed_end;        /* half of that ring */
    ris_vec3 push;             /* of the middle of that lip at contraction 1, mm */
    uint32_t protrude_channel; /* of the movable centre (KA-32), UINT32_MAX = none */
    const ris_muscle_def *def;
} ris_muscle;

/* One segment share of a node's attachment to a muscle (KA-42): the point `local` of the segment's frame. */
typedef struct ris_attach {
    uint32_t fiber, segment; /* fibre index within the model, segment index within the model */
    ris_vec3 local;          /* unscaled affine coordinates: divided by the rest size per axis */
    ris_vec3 rest;           /* the same point in space at rest, mm */
    float share;             /* blend weights of one binding sum to 1 */
} ris_attach;

/* A node bound to one muscle with a weight; its attaches are blended. */
typedef struct ris_binding {
    uint32_t muscle, first_attach, attach_count;
    float weight; /* 0..1; times the activity of the muscle */
    float along;  /* arc-length parameter of the nearest fibre point, 0 = row 0 .. 1 = last row */
} ris_binding;

/* A point of a muscle in a constraint group (KA-28). */
typedef struct ris_group_point {
    uint32_t muscle, point;
    float rest_distance_mm; /* from the group's centroid at rest */
} ris_group_point;

typedef struct ris_group {
    uint32_t first_point, point_count;
} ris_group;

/* Nodes and springs of the muscle network (KA-29). */
typedef struct ris_network_node {
    uint32_t muscle, point;
    bool fixed; /* at the bone end of its muscle */
} ris_network_node;

typedef struct ris_network_spring {
    uint32_t a, b; /* into network_node */
    float rest_mm; /* negative: the distance that contraction alone gives this tick */
} ris_network_spring;

/* A body of the contact stage (engine/model/contact.c). */
typedef struct ris_contact_solid {
    char name[16]; /* "skull", "teeth_lower", "eye.L" ... */
    ris_bone bone; /* it moves with: SKULL, JAW, EYE_L or EYE_R */
    ris_vec3 low;  /* first sample, mm at rest */
    float cell_mm;
    uint32_t count[3]; /* samples along x, y, z */
    uint32_t first;    /* into ris_model.contact_grid, x fastest */
} ris_contact_solid;

/* An eyeball under its lids, at rest looking along +z: a ball with the cornea's sphere in front. */
typedef struct ris_lid_eye {
    ris_vec3 centre;                        /* mm */
    float ball_mm, cornea_mm, cornea_at_mm; /* radii; distance between their centres, 0 = no bulge */
    float open_rad;                         /* largest opening between the margins, seen from the centre */
} ris_lid_eye;

/* A node of a lid, or of the socket's lining just behind it. Lids turn about the lateral axis through the
 * centre of the eye. Weights are 1 at the margin and 0 at the border of the lid's region. */
typedef struct ris_lid_node {
    uint32_t node;
    /* lower margin that the node's column meets when closed; of the lining twice the node it hangs on: into
     * ris_model.lid */
    uint32_t facing[2];
    float facing_share; /* 0..1, of facing[1] */
    uint8_t eye;        /* 0 = L, 1 = R */
    bool upper, lining, margin;
    float weight_close, weight_open;
    float close_rad, close_mm; /* upper: down to the lower margin at rest, change of distance from axis */
    float share, lower_share;  /* opening of the column over open_rad, own and at the lower margin it meets */
    float gap_mm;              /* from the surface of the eye at rest; negative in the lining */
} ris_lid_node;

/* A triangle with at least one node of a lid. */
typedef struct ris_lid_triangle {
    uint32_t node[3], lid[3]; /* of the skin; into ris_model.lid, UINT32_MAX = of no lid */
    uint32_t around_first; /* those that share a vertex with it: of ris_model.lid_around, up to around_end */
    uint32_t around_end;
    ris_vec3 normal; /* at rest, unit */
    float rest_mm2;  /* twice its area at rest */
    float keeps;     /* share of that which it keeps, seen along the mean normal around it */
} ris_lid_triangle;

/* KA-47. A node of a fat pad rises by rise_mm times the squeeze of the muscle below it: shortening over what is
 * left of its length. */
typedef struct ris_fat_node {
    uint32_t node, muscle;
    ris_vec3 rise_mm;
} ris_fat_node;

/* A node of a cheek moves by the pressure within, cheek.puff, times rise_mm, below 0 times sink_mm. */
typedef struct ris_puff_node {
    uint32_t node, side; /* 0 = L, 1 = R */
    ris_vec3 rise_mm, sink_mm;
} ris_puff_node;

#define RIS_LINING_SOURCES 4
/* A node of the mouth's lining moves by keep times the sum of its sources' displacements. Sources are nodes
 * of the lips or nodes of the lining that stand before it. */
typedef struct ris_lining_node {
    uint32_t node, source_count, source[RIS_LINING_SOURCES];
    float keep;
} ris_lining_node;

typedef struct ris_model {
    const ris_head *head; /* not owned when built by ris_model_create */
    ris_head *owned_head; /* the same head when built by ris_model_load, else NULL */
    uint32_t node_count, moving_count;
    uint32_t spring_count;      /* each once */
    uint32_t half_spring_count; /* 2 x spring_count */
    uint32_t triangle_count;

    /* baked for the stages (layout of sim_shared.h) */
    ris_vec4 *rest_position;        /* mm, w inverse mass (node_count) */
    uint32_t *moving;               /* nodes that move, in the order the stages take them (moving_count) */
    uint32_t *spring_start;         /* (node_count + 1) */
    ris_half_spring *half_spring;   /* (half_spring_count) */
    uint32_t *ring_start;           /* (node_count + 1) */
    ris_ring *ring;                 /* (3 x triangle_count) */
    ris_anchor_param *anchor_param; /* (node_count) */
    ris_vec4 *rest_normal;          /* unit (node_count) */
    uint32_t *triangle;             /* mirror-symmetric triangulation of the skin (triangle_count x 3) */
    uint32_t *triangle_corner; /* corner of head->skin each triangle vertex came from (triangle_count x 3) */
    float *node_area_mm2;      /* third of the incident triangles (node_count) */
    float *heft; /* what the tissue down to the bone weighs over 25 mm^2 x 10 mm of it (node_count) */
    float mass_g;
    ris_sim_push push; /* constants of the stages with dt_s = 1/60/substeps */
    float stable_dt_s; /* bound of docs/physics.md, stable step */

    /* rig */
    uint32_t channel_count, muscle_count, fiber_count, fiber_point_count, segment_count;
    ris_channel *channel; /* channel m of the first muscle_count is muscle m, then those beside muscles */
    ris_muscle *muscle;
    ris_fiber *fiber;
    ris_vec3 *fiber_point; /* rest control points p, mm (fiber_point_count) */
    ris_segment *segment;
    uint32_t *binding_start; /* (node_count + 1) */
    ris_binding *binding;    /* sorted by node */
    uint32_t attach_count;
    ris_attach *attach;
    uint32_t group_count, group_point_count;
    ris_group *group;
    ris_group_point *group_point;
    uint32_t network_node_count, network_spring_count; /* 0 outside the kaehler tissue */
    ris_network_node *network_node;
    ris_network_spring *network_spring;
    uint32_t lid_count; /* 0 without eyes, lids or in the kaehler tissue */
    ris_lid_node *lid;  /* ascending node (lid_count) */
    ris_lid_eye lid_eye[2];
    uint32_t lid_triangle_count, lid_around_count;
    ris_lid_triangle *lid_triangle;
    uint32_t *lid_around; /* triangles around each of them (lid_around_count) */
    float *slide;         /* 0..1: how far muscles move the node along the bone only (node_count) */
    uint32_t fat_count;   /* 0 in the kaehler tissue */
    ris_fat_node *fat;
    uint32_t puff_count; /* 0 in the kaehler tissue */
    ris_puff_node *puff;
    float *
        lip_close; /* what lips.close 1 adds to the jaw weight; NULL: no lips, or the kaehler tissue (node_count) */
    uint32_t lining_count; /* 0 without lips, mouth_cavity or in the kaehler tissue */
    ris_lining_node *lining;
    /* contact: nothing in the kaehler tissue */
    uint32_t contact_solid_count, contact_sample_count, contact_node_count, contact_touch_count,
        contact_pair_count;
    ris_contact_solid contact_solid[RIS_CONTACT_BODIES];
    ris_vec4 *contact_grid;         /* xyz unit, away from the body; w distance, mm (contact_sample_count) */
    ris_contact_node *contact_node; /* those with pairs first, then those with touches (contact_node_count) */
    ris_contact_touch *contact_touch; /* (contact_touch_count) */
    uint32_t *contact_other;          /* nodes of the other lip (contact_pair_count) */
    ris_vec3 *bone_anchor;            /* KA-14: point on the bone below the node at rest, mm (node_count) */
    const float *jaw_weight;          /* (node_count) */
    float *jaw_slide_weight;          /* the same for slides of the jaw; NULL = jaw_weight (node_count) */

    ris_vocabulary vocabulary; /* KA-55; the same for all heads, its values are this model's channels */

    double bake_ms,
        muscle_bake_ms; /* what ris_model_create took, and its part from muscle grids to bindings */
} ris_model;

/* Bakes a head; head must outlive the model. Errors: RIS_ERROR_DATA with what is wrong (unstable dt, node
 * without anchor ...). */
ris_result ris_model_create(const ris_head *head, ris_model **out, ris_error *err);
/* Loads directory and bakes it; the model owns the head. */
ris_result ris_model_load(const char *directory, ris_model **out, ris_error *err);
void ris_model_destroy(ris_model *model);

/* Channel index by exact name, or UINT32_MAX. */
uint32_t ris_model_channel(const ris_model *model, const char *name);

#ifdef __cplusplus
}
#endif
