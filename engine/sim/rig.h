/* The host half of a tick (KA-30): pose -> jaw and bones -> muscles -> anchors. One ris_rig per
 * simulation; each stage is a file with the stage's name. The stages are called in the order of their
 * declarations. */
#pragma once

#include "sim/sim_impl.h"

/* Channels beside muscles, in the order of asset/channel.c; tests/unit/test_model.c checks it. */
enum {
    RIS__JAW_OPEN,
    RIS__JAW_FORWARD,
    RIS__JAW_SIDE,
    RIS__EYE_YAW_L,
    RIS__EYE_YAW_R,
    RIS__EYE_PITCH_L,
    RIS__EYE_PITCH_R,
    RIS__HEAD_YAW,
    RIS__HEAD_PITCH,
    RIS__HEAD_ROLL,
    RIS__HEAD_X,
    RIS__HEAD_Y,
    RIS__HEAD_Z,
    RIS__LID_UPPER_L,
    RIS__LID_UPPER_R,
    RIS__LID_LOWER_L,
    RIS__LID_LOWER_R,
    RIS__TONGUE_OUT,
    RIS__TONGUE_TIP,
    RIS__TONGUE_WIDE,
    RIS__CHEEK_PUFF_L,
    RIS__CHEEK_PUFF_R,
    RIS__LIPS_CLOSE,
    RIS__LIP_UPPER_ROLL,
    RIS__LIP_LOWER_ROLL
};

/* x -> rotation (x - point) + point + shift; identity leaves bits alone. */
typedef struct ris_rigid {
    float rotation[9]; /* row-major */
    ris_vec3 point, shift;
    bool identity;
} ris_rigid;

/* A corner of the mouth, what all that ends there moves it by. */
typedef struct ris_corner {
    ris_vec3 moved; /* mm */
    float outward;  /* from a ring, the farthest way of those that pull there, mm */
    float power;    /* activation-weighted mean of the pulling muscles' lip_drag_power */
    float strength; /* 0..1, activity of the pull */
} ris_corner;

/* How far a corner of the mouth drags the lips: one for each end of a sphincter. */
typedef struct ris_drag {
    ris_corner corner;
    ris_vec3 displacement; /* what the end lacks to be where its corner is, mm */
    ris_vec3 carried;      /* what a taut ring brings through from the other corner, mm */
} ris_drag;

/* A turn about +x. */
typedef struct ris_turn {
    float cosine, sine;
} ris_turn;

#define RIS__TONGUE_STATIONS 33
#define RIS__TONGUE_STEPS 64

/* One section of the tongue: place of its middle, turn from rest, scales. */
typedef struct ris_tongue_frame {
    float y, z;         /* mm, in the frame of the jaw */
    float cosine, sine; /* of the turn, the tip upwards */
    float height, width;
} ris_tongue_frame;

/* The head's tongue: sections at rest from back to tip, and as the pose bends them. */
typedef struct ris_tongue {
    const ris_mesh *mesh; /* NULL: the head has none */
    float back_z, length; /* mm */
    float middle[RIS__TONGUE_STATIONS], half_height[RIS__TONGUE_STATIONS],
        half_width[RIS__TONGUE_STATIONS]; /* mm */
    bool still;                           /* at rest in the jaw */
    ris_tongue_frame frame[RIS__TONGUE_STEPS + 1];
} ris_tongue;

/* What a tick leaves of the two stages of activation: of each stage's own way to go, and of the first's in the second. */
typedef struct ris_pace {
    double keep, pass; /* exp(-x), x exp(-x); x = tick over time constant; both 0 = at once */
} ris_pace;

/* Motion of the head up to the last tick. */
typedef struct ris_head_motion {
    double rotation[9], place[3]; /* row-major; mm */
    double spin[3], speed[3];     /* rad/s in the head's frame; mm/s */
    uint32_t known;               /* 0 nothing, 1 rotation and place, 2 all */
    double first[12], second[12]; /* both stages of the smoothing of the rows of the field */
} ris_head_motion;

typedef struct ris_rig {
    const ris_model *model;
    uint32_t first_beside; /* channel number of jaw.open */
    /* activation; (channel_count) each */
    ris_pace *onset, *release;    /* constant */
    double *excitation, *reached; /* first and second stage */
    float *pose;                  /* the second: the pose that all later stages see */
    /* jaw_pose */
    ris_rigid jaw, eye[2], head;
    ris_rigid jaw_open; /* the jaw without its slide; equal to jaw when it does not slide */
    bool slides;
    float
        meets; /* 1 where the teeth stand above each other, 0 where the jaw is thrust or shifted as far as it goes */
    ris_vec3 *p; /* rest control points, turned with the jaw in the kaehler tissue (fiber_point_count) */
    /* muscle_contract */
    float *contraction; /* c per muscle */
    float *activation;  /* 0..1 per muscle */
    float *activity;    /* min(1, activation / 0.1) per muscle */
    ris_vec3 *q;        /* deformed control points (fiber_point_count) */
    float puff[2];      /* pressure in the left and right cheek, -1..1 */
    float close;        /* of the lips over an open jaw, 0..1 */
    float roll[2];      /* upper and lower lip, 1 = in, -1 = out */
    float carry;        /* share of a push on one lip that lifts the other, 0..1 */
    float suck;         /* how far the teeth make room for a lip that rolls in, 0..1 */
    /* muscle_constrain */
    ris_corner *corner; /* of the mouth (group_count) */
    ris_drag *drag;     /* (2 x muscle_count): first and last end of sphincters */
    bool *constrained;  /* per fibre point (fiber_point_count) */
    ris_vec3 *network_x,
        *network_v;      /* kaehler: positions, and 3 x velocities and forces (network_node_count) */
    float *network_rest; /* mm (network_spring_count) */
    /* muscle_bulge */
    float
        *squeeze; /* KA-47: shortening over remaining length, 0 or more, mean of the fibres (muscle_count) */
    float *bulge; /* height scale per segment (segment_count) */
    /* muscle_shape */
    float *muscle_jaw; /* how far each control point turns with the jaw, 0..1 (fiber_point_count); constant */
    /* muscle_attach */
    ris_vec3 *move;          /* what muscles move the nodes by, mm (node_count) */
    ris_vec3 *target;        /* of the previous tick (node_count) */
    ris_anchor_point *point; /* (node_count) */
    ris_vec4 *delta;         /* (node_count) */
    /* tongue_pose */
    ris_tongue tongue;
    /* lid_pose */
    ris_vec3 *lid_move; /* what muscles and jaw move the nodes of the lids by, mm (lid_count) */
    ris_turn *lid_turn; /* about the lateral axis (lid_count) */
    /* lid_unfold */
    ris_vec3 *lid_push;  /* scratch, zero between ticks, mm (lid_count) */
    bool *lid_moved;     /* scratch: gave way in the last pass (lid_count) */
    bool *lid_awake;     /* scratch: may lack something (lid_triangle_count) */
    ris_vec3 *lid_cross; /* scratch: normal of each triangle times twice its area (lid_triangle_count) */
    /* contact_pose */
    ris_contact_body body[RIS_CONTACT_BODIES];
    /* head_inertia */
    ris_head_motion head_motion;
    ris_inertia inertia;
} ris_rig;

ris_result ris__rig_init(ris_rig *rig, const ris_model *model, ris_error *err);
void ris__rig_finish(ris_rig *rig);
/* Neutral pose: targets at rest, deltas zero. */
void ris__rig_reset(ris_rig *rig);

/* The stages; pose has channel_count floats: what is asked for in activation, rig->pose in all others. */
/* at_once: no onset, everything is where it is asked to be. */
void ris__activation(ris_rig *rig, const float *pose, bool at_once);
void ris__jaw_pose(ris_rig *rig, const float *pose);
void ris__muscle_contract(ris_rig *rig, const float *pose);
void ris__muscle_constrain(ris_rig *rig);
void ris__muscle_relax(ris_rig *rig);
void ris__muscle_bulge(ris_rig *rig);
void ris__muscle_attach(ris_rig *rig);
void ris__lid_pose(ris_rig *rig, const float *pose);
/* Called by lid_pose: no triangle of a lid turns over. */
void ris__lid_unfold(ris_rig *rig);
void ris__tongue_pose(ris_rig *rig, const float *pose);
void ris__contact_pose(ris_rig *rig);
/* at_once: the head is held where it is, however it came there. */
void ris__head_inertia(ris_rig *rig, bool at_once);

/* The paces of all channels. */
void ris__activation_init(ris_rig *rig);
/* Finds the tongue among the parts. */
void ris__tongue_init(ris_tongue *tongue, const ris_head *head);
/* Where a point of the tongue at rest is now, in the frame of the jaw. */
ris_vec3 ris__tongue_place(const ris_tongue *tongue, ris_vec3 p);

/* How far each control point turns with the jaw when shown (fiber_point_count). */
ris_result ris__muscle_jaw_weights(const ris_model *model, float *weight, ris_error *err);
/* Muscles of the tick in skull space: control points (fiber_point_count), segments (segment_count). */
void ris__muscle_shape(const ris_rig *rig, ris_vec3 *point, ris_segment *segment);

/* Formulas of the stages, alone for the hand-computed numbers of the tests. */

/* exp(-x), x >= 0, from a fixed series: the same bits on every machine. */
double ris__decay(double x);
/* Pace that does 90 % of a step in ms; 0 = at once. */
ris_pace ris__pace(float ms);
/* One tick of both stages towards u, exact for a constant u. second never leaves the range of itself, first and u. */
void ris__follow(ris_pace pace, double u, double *first, double *second);
/* Cosine and sine from fixed series: the same bits on every machine. */
void ris__cos_sin(double angle_rad, double *out_cos, double *out_sin);
/* KA-05. Rotation by angle_rad about the unit axis through point. */
ris_rigid ris__rigid_turn(ris_vec3 point, ris_vec3 axis, double angle_rad);
/* The mandible for values of jaw.open, jaw.forward and jaw.side: condyles on the eminences, teeth that guide. */
ris_rigid ris__jaw_path(const ris_jaw_def *def, const ris_guidance *guidance, float open, float forward,
                        float side);
/* Least opening, degrees, at which the teeth pass forward_mm ahead and at side (0..1). */
double ris__jaw_guidance(const ris_guidance *guidance, double forward_mm, double side);
ris_vec3 ris__rigid_apply(const ris_rigid *rigid, ris_vec3 x);
ris_vec3 ris__rigid_rotate(const ris_rigid *rigid, ris_vec3 v);
/* The same as a row-major 3x4. */
void ris__rigid_matrix(const ris_rigid *rigid, float out[12]);
/* KA-31. n points of a fibre at rest, contraction c, result q (n). */
void ris__contract_linear(const ris_vec3 *p, uint32_t n, float c, ris_vec3 *q);
/* The same towards the point at the share held_at of the length: both ends of the fibre move. */
void ris__contract_about(const ris_vec3 *p, uint32_t n, float c, float held_at, ris_vec3 *q);
/* A muscle that spans a hollow straightens when it tightens (default tissue): the points between its ends go the share of
 * their way to the straight line. */
void ris__bowstring(uint32_t n, float share, ris_vec3 *q);
/* KA-32. Point p of fibre j of f (0 outermost), axis a0-a1, position a on it. */
ris_vec3 ris__contract_sphincter(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, float a, uint32_t j, uint32_t f,
                                 float c);
/* A lip (default tissue): it draws together sideways and comes forward along the axis as a sphincter with
 * a = 1, the outer fibres by the share RIS__LIP_OUTER of what the inner ones do, but grows thicker. side:
 * unit, from corner to corner. */
/* tie 0..1: how far incisivi tie the ring to the bone; then it presses the lip flat against the teeth. */
#define RIS__LIP_ABOVE_TIED 0.6f
#define RIS__LIP_TIED 1.25f
#define RIS__LIP_ARCH                                                                                        \
    0.3f /* the chord of a lip that comes forward shortens by so much more than its fibres do */
#define RIS__LIP_OUTER 0.6f
#define RIS__LIP_ABOVE_OUTER (-0.5f)
#define RIS__LIP_ABOVE_INNER 0.5f
ris_vec3 ris__contract_lip(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, ris_vec3 side, uint32_t j, uint32_t f,
                           float c, float tie);
/* Unit vector from one end of a sphincter to the other, across its axis; zero for a closed ring. */
ris_vec3 ris__ring_side(const ris_model *model, const ris_muscle *muscle);
/* 1 in the middle of a lip, 0 at its ends. */
float ris__lip_middle(float along);
/* What full protrusion moves fibre j of f by in the default tissue: along the axis, by the share RIS__PROTRUDE of its length in the
 * middle of the ring, less the outer fibres, not at all the ends. along: 0 at one end, 1 at the other. */
#define RIS__PROTRUDE 0.13f
ris_vec3 ris__protrude(ris_vec3 a0, ris_vec3 a1, uint32_t j, uint32_t f, float along);
/* Fibres keep their length: where both lips protrude their ends come in by this share of the way to the axis. */
#define RIS__PROTRUDE_ARCH 0.12f
/* A sphincter that closes on a line: p goes the share c of its way to the nearest point of a0-a1. */
ris_vec3 ris__contract_slit(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, float c);
/* KA-33. Moves n points to their rest distance from the centroid weighted with 1 + lambda c; rest gives
 * the fallback direction. Returns the centroid. */
ris_vec3 ris__resolve_group(uint32_t n, const float *contraction, const float *rest_distance_mm,
                            const ris_vec3 *rest, float lambda, ris_vec3 *point);
/* Moves a point of a muscle in all its fibres (KA-27). */
void ris__displace_point(ris_rig *rig, uint32_t muscle, uint32_t point, ris_vec3 delta);
/* KA-34. Rest lengths of the network before the groups are resolved; then the run, and what it does to the muscles. */
void ris__network_measure(ris_rig *rig);
void ris__network_apply(ris_rig *rig);
/* KA-34. A network with its rest lengths this tick; force is scratch (node_count). */
typedef struct ris_network {
    const ris_network_node *node;
    const ris_network_spring *spring;
    uint32_t node_count, spring_count;
    const float *rest_mm; /* (spring_count) */
    ris_vec3 *force;
} ris_network;
/* Moves x from rest for 20 ms; half and previous are scratch (node_count each). */
void ris__network_run(const ris_network *net, ris_vec3 *x, ris_vec3 *half, ris_vec3 *previous);
/* KA-35. Weight of straightening for closed-loop lengths now and at rest. */
float ris__relax_weight(float length_mm, float rest_length_mm);
/* KA-36. Height scale of segment i of count for length ratio rho; nu while it is below 1. */
float ris__bulge_factor(ris_muscle_kind kind, float nu, float rho, uint32_t i, uint32_t count);
/* t^power for t in 0..1 from whole powers, linear between them: no libm. */
float ris__power(float t, float power);
