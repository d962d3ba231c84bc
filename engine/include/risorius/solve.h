/* From a face to its pose: activations within their ranges whose simulated skin comes nearest to targets
 * (docs/solve.md). */
#pragma once

#include "risorius/sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where points of the face are wanted, in the space of the head at rest. */
typedef struct ris_target {
    bool landmarks; /* index counts landmarks of the head, else skin vertices */
    uint32_t count;
    uint32_t *index;             /* ascending (count) */
    ris_vec3 *at;                /* mm (count) */
    double moved_mm, turned_deg; /* what the alignment took back; 0 without one */
} ris_target;

/* The moving vertices of an OBJ with the vertices of skin.obj in their order. align: first takes back the rigid motion of
 * the vertices that are not simulated. RIS_ERROR_DATA: unreadable, another number of vertices, nothing to align by. */
ris_result ris_target_load_skin(const ris_model *model, const char *path, bool align, ris_target *out,
                                ris_error *err);
/* Landmarks by name: JSON "risorius-targets", or CSV "landmark,x_mm,y_mm,z_mm". RIS_ERROR_DATA with the place in the
 * file: an unknown landmark (three nearest), one twice, one of the skull, which nothing moves. */
ris_result ris_target_load_landmarks(const ris_model *model, const char *path, ris_target *out,
                                     ris_error *err);
/* The moving vertices of a simulated skin: position (node_count). */
ris_result ris_target_from_skin(const ris_model *model, const ris_vec4 *position, ris_target *out,
                                ris_error *err);
/* Makes a target of skin vertices one of the head's landmarks on skin that moves. RIS_ERROR_DATA: the head has none. */
ris_result ris_target_reduce(const ris_model *model, ris_target *target, ris_error *err);
/* Safe on a zeroed target. */
void ris_target_finish(ris_target *target);

/* Something that may act: a channel, or any name that ris_pose_add knows; nothing that moves the head as a whole (head.*). */
typedef struct ris_control {
    char name[RIS_NAME_SIZE];
    float minimum, maximum; /* one of them may be 0, rest is 0 */
} ris_control;

#define RIS_SOLVE_SIMS 16      /* most simulations */
#define RIS_SOLVE_CONTROLS 512 /* most controls */

typedef struct ris_solve_def {
    const ris_control *control; /* (control_count, at least 1) */
    uint32_t control_count;
    ris_sim *const
        *sim; /* equal simulations of one model; each runs in a thread of its own. The result does not depend
                            on how many there are (sim_count, at least 1) */
    uint32_t sim_count;
    uint32_t iteration_limit;
    double enough_mm; /* rms at which to stop */
    /* Called now and then on the caller's thread; false stops with RIS_ERROR_FAILED "interrupted". May be NULL. */
    bool (*go_on)(void *user, uint32_t iteration, double rms_mm);
    void *user;
} ris_solve_def;

/* How a control shows at the pose that was found. */
typedef struct ris_control_found {
    float value;     /* in its unit, 0 = rest */
    double reach_mm; /* rms over the targets of its response at full range, linear from here */
    double
        share; /* 0..1: part of the response that no mixture of the other controls gives: sine of the angle to their span */
} ris_control_found;

typedef struct ris_solve_result {
    double rest_rms_mm, rest_max_mm; /* the resting face from the targets */
    double rms_mm, max_mm;           /* the pose that was found, held from rest */
    uint32_t worst;                  /* point of the target with max_mm */
    uint32_t iterations, holds;
    bool at_rest;
} ris_solve_result;

/* found: (control_count). pose: channel_count floats that give this face, rounded to thousandths of a range. Leaves that
 * pose in sim[0], and all simulations with onset. */
ris_result ris_solve(const ris_solve_def *def, const ris_target *target, ris_solve_result *out,
                     ris_control_found *found, float *pose, ris_error *err);

/* The bounds of docs/solve.md between a control that a target shows and one that others stand in for. */
#define RIS_INDEPENDENT_SHARE 0.15
#define RIS_INDEPENDENT_MM 0.02
bool ris_control_independent(const ris_control_found *found);

#ifdef __cplusplus
}
#endif
