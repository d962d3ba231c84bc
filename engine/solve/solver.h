/* The solver inside: how the face answers to its controls, steps, and leaving out what is not needed. */
#pragma once

#include "risorius/solve.h"

/* A control in the solver: its value over scale is u, between low and high, rest 0. */
typedef struct ris_knob {
    double scale, low, high;
} ris_knob;

/* Positions and velocities of a simulation, (node_count) each, in one allocation. */
typedef struct ris_snapshot {
    ris_vec4 *state[4];
} ris_snapshot;

#define RIS_SOLVER_JAW 3 /* open, forward, side */

typedef struct ris_solver {
    const ris_solve_def *def;
    const ris_model *model;
    const ris_target *target;
    uint32_t n, rows;                 /* controls; 3 x points of the target */
    ris_knob *knob;                   /* (n) */
    float *unit;                      /* pose of each control at u = 1, not clamped (n x channel_count) */
    double *u;                        /* present values (n) */
    float *pose;                      /* (channel_count) */
    ris_snapshot now;                 /* sim[0] at u */
    float *seen;                      /* what the target sees at u (rows) */
    float *column;                    /* response per unit of u at u (n x rows), and room for as many */
    double *step;                     /* secant step of each column in u, with sign (n) */
    bool *frozen;                     /* stays as it is (n) */
    double *drive;                    /* of the jaw by each control at u = 1 (RIS_SOLVER_JAW x n) */
    uint32_t jaw_own[RIS_SOLVER_JAW]; /* the control that is this channel of the jaw alone, or n */
    uint32_t holds, iteration;
    double rms_mm, damping;
    double ridge_mm; /* rms that a control at full value must save to be worth it */
    double caution;  /* the ridge as a share of the distance that is left, at least */
    bool glanced;    /* the face was not held until at rest */
    /* the normal equations of a step, per point of the target, and what solves them */
    double *gram, *damped, *work; /* gram: room for 2 n x 2 n; damped: n x n; work: 4 n^2 + 2 n */
    double *g, *right, *low, *high, *d, *tried_u; /* (n) */
    bool *wanted;                                 /* (n) */
    float *tried_seen, *tried_pose;               /* (rows), (channel_count) */
    ris_vec4 *position;                           /* (node_count) */
} ris_solver;

/* pose of values u into pose (channel_count), clamped. */
void ris__solver_pose(const ris_solver *solver, const double *u, float *pose);
/* What the target looks at, of the sim and its positions, into seen (3 x points). */
void ris__solver_see(const ris_solver *solver, const ris_sim *sim, const ris_vec4 *position, float *seen);
ris_result ris__snapshot_take(ris_sim *sim, ris_snapshot *out, ris_error *err);
ris_result ris__snapshot_put(ris_sim *sim, const ris_snapshot *snapshot, ris_error *err);
ris_result ris__snapshot_make(const ris_model *model, ris_snapshot *out, ris_error *err);
void ris__snapshot_free(ris_snapshot *snapshot);

/* Where a search stands: values, what is seen, and the simulation there. */
typedef struct ris_place {
    double *u, *step; /* (n) */
    bool *frozen;     /* (n) */
    float *seen;      /* (rows) */
    float *pose;      /* (channel_count) */
    ris_snapshot now;
    double rms_mm;
    bool glanced;
} ris_place;

ris_result ris__place_make(const ris_solver *solver, ris_place *out, ris_error *err);
void ris__place_free(ris_place *place);
void ris__place_remember(const ris_solver *solver, ris_place *out);
/* The solver and sim[0] stand there again. */
ris_result ris__place_return(ris_solver *solver, const ris_place *place, ris_error *err);

#define RIS_SOLVER_NOTHING 0.004 /* u as good as rest */
#define RIS_SOLVER_LITTLE 0.1    /* u in which a muscle's hold on the skin still grows */
#define RIS_SOLVER_LITTLE_CAUTION 0.01
#define RIS_SOLVER_LAST_DAMPING 1e-3
#define RIS_SOLVER_NEAR_MM 0.003 /* rms nearer than which no control is missing */

/* A secant that stays in the range; up unless it cannot or the last one went down; of a little, to rest: a muscle's first tenth
 * is unlike the rest of its range. */
void ris__solver_choose_step(ris_solver *solver, uint32_t control, double size);
/* Columns and normal equations at u, of what is not frozen: all anew, or those of what acts. */
ris_result ris__solver_linearise(ris_solver *solver, bool all, ris_error *err);
/* Holds the pose of tried_u from where sim[0] stands and looks: tried_pose, tried_seen. *out_rms in mm. */
ris_result ris__solver_try(ris_solver *solver, double *out_rms, ris_error *err);
/* What was tried becomes the state. */
ris_result ris__solver_keep(ris_solver *solver, ris_error *err);
/* Steps of growing damping until one brings the face nearer, after ris__solver_linearise. *out_gain: share of the cost that it
 * saved, 0 = none. */
ris_result ris__solver_improve(ris_solver *solver, double *out_gain, ris_error *err);

/* A control with two sides at rest: only the side that helps is open. */
bool ris__solver_is_at_fork(const ris_solver *solver, uint32_t control);
/* Bounds of a step of the control from u, each side of 0. */
void ris__solver_bounds(const ris_solver *solver, uint32_t control, double *out_low, double *out_high);
/* Steps of what is not frozen until nothing more is gained. caution as in ris_solver, first damping of its steps. */
ris_result ris__solver_search(ris_solver *solver, double caution, double damping, ris_error *err);
/* From rest, few controls: one more at a time, then in exchange for each other. */
ris_result ris__solver_pursue(ris_solver *solver, ris_error *err);

void ris__solver_find_drives(ris_solver *solver);
/* Secants that lead out of the jaw's range, where nothing answers, go the other way where they can. */
void ris__solver_step_inwards(ris_solver *solver);
/* Into u, reached by the step d: the jaw as the response promised it, by its own channels. */
void ris__solver_keep_jaw(const ris_solver *solver, const double *d, double *u);
/* Jaw channels that only hold against others at the end of the range go to rest in u; false if there are none. */
bool ris__solver_let_jaw_go(const ris_solver *solver, double *u);

/* Leaves out controls that others stand in for or that the target hardly needs, as long as the face stays as near. */
ris_result ris__solver_thin_out(ris_solver *solver, ris_error *err);

/* Fills the columns of the wanted controls (n) by secants of step from the state now: a few ticks with each control changed,
 * less the same ticks without. Uses all simulations. RIS_ERROR_FAILED when go_on says so. */
ris_result ris__solver_respond(ris_solver *solver, const bool *wanted, ris_error *err);
