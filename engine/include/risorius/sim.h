/* The simulation: a pose in, skin positions and normals out, on the CPU or on a Vulkan device. One thread
 * per sim. One tick = 1/60 s: activation .. head_inertia on the host, then on the backend anchor_shift, substeps of
 * [bend, spring_force, verlet, lip_normal, contact], normal. */
#pragma once

#include "risorius/model.h"

#ifdef __cplusplus
extern "C" {
#endif

#define RIS_TICK_S (1.0 / 60.0)

typedef struct ris_sim ris_sim;
struct ris_device;

/* Stages that have a shader and a CPU twin, in frame order. */
typedef enum ris_stage {
    RIS_STAGE_ANCHOR_SHIFT,
    RIS_STAGE_BEND,
    RIS_STAGE_SPRING_FORCE,
    RIS_STAGE_VERLET,
    RIS_STAGE_LIP_NORMAL,
    RIS_STAGE_CONTACT,
    RIS_STAGE_NORMAL,
    RIS_STAGE_COUNT
} ris_stage;
const char *ris_stage_name(ris_stage stage);

/* State buffers that can be read and written, ris_vec4 per node. */
typedef enum ris_state {
    RIS_STATE_POSITION,
    RIS_STATE_VELOCITY_HALF,
    RIS_STATE_VELOCITY_PREV,
    RIS_STATE_FORCE,
    RIS_STATE_BEND,
    RIS_STATE_NORMAL,
    RIS_STATE_FREE, /* position before contact */
    RIS_STATE_COUNT
} ris_state;
const char *ris_state_name(ris_state state);

/* Backend times of the last tick, ms; host and wait filled by every backend, stages where it can measure
 * them. */
typedef struct ris_sim_times {
    double muscle_ms;                 /* activation .. head_inertia on the host */
    double upload_ms;                 /* anchor upload */
    double stage_ms[RIS_STAGE_COUNT]; /* sum over substeps */
    double wait_ms;                   /* record, submit and fence wait (0 on the CPU) */
} ris_sim_times;

ris_result ris_sim_create_cpu(const ris_model *model, ris_sim **out, ris_error *err);
/* device must outlive the sim. Defined in sim/vk; absent from cpu-only builds. */
ris_result ris_sim_create_vk(const ris_model *model, struct ris_device *device, ris_sim **out,
                             ris_error *err);
void ris_sim_destroy(ris_sim *sim);

/* Puts every node at rest, velocities zero, pose neutral. */
ris_result ris_sim_reset(ris_sim *sim, ris_error *err);
/* Advances one tick with the pose (channel_count floats, clamped by the caller) that the muscles are asked for; they
 * follow in their own time (ris_dynamics_def). RIS_ERROR_DIVERGED names
 * stage and vertex. */
ris_result ris_sim_tick(ris_sim *sim, const float *pose, ris_error *err);
/* Whether muscles take their time, as they do unless told, or are at every pose at once: a recorded performance already holds
 * the actor's own onset. What the skin feels of the head stays. */
void ris_sim_set_onset(ris_sim *sim, bool on);
/* Ticks until no node is faster than 0.1 mm/s for 0.25 s; after 20 s RIS_ERROR_FAILED naming the vertex.
 * out_time_s may be NULL. */
ris_result ris_sim_settle(ris_sim *sim, const float *pose, double *out_time_s, ris_error *err);

/* How a pose was held: for how long, and what moved fastest at the end. */
typedef struct ris_hold {
    bool at_rest; /* no node faster than 0.1 mm/s for 0.25 s */
    double time_s;
    float speed_mm_s;
    uint32_t vertex;
} ris_hold;

/* Ticks until at rest or for limit_s, whichever is first; not at rest is no error. All muscles are at the pose from the
 * first tick on, without onset: what counts is the equilibrium. */
ris_result ris_sim_hold(ris_sim *sim, const float *pose, double limit_s, ris_hold *out, ris_error *err);

ris_result ris_sim_read(ris_sim *sim, ris_state state, ris_vec4 *out, ris_error *err); /* (node_count) */
ris_result ris_sim_write(ris_sim *sim, ris_state state, const ris_vec4 *in,
                         ris_error *err); /* (node_count) */
/* FNV-1a 64 over position, velocity_half and velocity_prev bits in node order. */
ris_result ris_sim_hash(ris_sim *sim, uint64_t *out, ris_error *err);
const ris_sim_times *ris_sim_get_times(const ris_sim *sim);
const ris_model *ris_sim_get_model(const ris_sim *sim);
/* "cpu", or the device and driver names. */
const char *ris_sim_backend(const ris_sim *sim);

/* Rigid transform of a bone this tick: row-major 3x4, mm. bone: JAW, EYE_L, EYE_R, SKULL (identity). Head
 * pose is not in it. */
void ris_sim_bone_transform(const ris_sim *sim, ris_bone bone, float out[12]);
/* Head pose channels as a row-major 3x4, applied to everything when drawing. */
void ris_sim_head_transform(const ris_sim *sim, float out[12]);

/* Muscles of the last tick in skull space (without the head pose): control points of the fibres
 * (fiber_point_count), and the segments as they are now, height with its bulge (segment_count). What is on
 * the jaw or the lower lip is turned with the jaw in every tissue. */
void ris_sim_muscles(const ris_sim *sim, ris_vec3 *point, ris_segment *segment);
/* Activation of a muscle at the last tick, 0..1: what its onset or release has left of what the pose asks for. */
float ris_sim_activation(const ris_sim *sim, uint32_t muscle);

/* Where a landmark of the head is, in skull space: on the skin at position (node_count, as read from sim), or with
 * its bone. out_tip (may be NULL) is the end of its dowel, the same point on the skin. */
ris_vec3 ris_sim_landmark(const ris_sim *sim, uint32_t landmark, const ris_vec4 *position, ris_vec3 *out_tip);

/* Vertices of a part that changes its shape (the tongue) in the frame of its bone (vertex_count of its mesh, w 1); false
 * and nothing for rigid and riding parts. */
bool ris_sim_part_shape(const ris_sim *sim, uint32_t part, ris_vec4 *out);

/* Vertices of part `part` of the head (vertex_count of its mesh, w 1): by its bone, or riding on the skin
 * at position (node_count, as read from sim). Without the head pose, as the skin. RIS_ERROR_USAGE: no such
 * part. */
ris_result ris_sim_part(const ris_sim *sim, uint32_t part, const ris_vec4 *position, ris_vec4 *out,
                        ris_error *err);

#ifdef __cplusplus
}
#endif
