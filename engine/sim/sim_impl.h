/* The table behind ris_sim: what a backend (sim/cpu, sim/vk) gives. The front (sim.c) has checked every argument. */
#pragma once

#include "risorius/sim.h"

/* Host results of one tick, inputs of anchor_shift, spring_force, contact and verlet; (node_count) each, body
 * (RIS_CONTACT_BODIES), inertia (1). */
typedef struct ris_anchor_frame {
    const ris_anchor_point *point;
    const ris_vec4 *delta;
    const ris_contact_body *body;
    const ris_inertia *inertia;
} ris_anchor_frame;

typedef struct ris_sim_impl {
    void (*destroy)(void *self);
    /* uploads the anchors, runs the stages of a tick (ris__sim_stages); returns when done */
    ris_result (*frame)(void *self, const ris_anchor_frame *anchors, uint32_t substeps, ris_sim_times *times,
                        ris_error *err);
    /* runs one stage once on the present state (parity tests); anchors NULL = keep those last uploaded */
    ris_result (*stage)(void *self, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err);
    ris_result (*read)(void *self, ris_state state, ris_vec4 *out, ris_error *err);
    ris_result (*write)(void *self, ris_state state, const ris_vec4 *in, ris_error *err);
} ris_sim_impl;

/* The stages of a tick of the model in order into list (room for 5 x substeps + 2); returns how many. */
uint32_t ris__sim_stages(const ris_model *model, uint32_t substeps, uint8_t *list);
/* Wraps a backend in the front; takes ownership of self. backend_name is copied. */
ris_result ris__sim_create(const ris_model *model, const ris_sim_impl *impl, void *self,
                           const char *backend_name, ris_sim **out, ris_error *err);
/* The backend object of a sim if it is of this impl, else NULL. */
void *ris__sim_self(ris_sim *sim, const ris_sim_impl *impl);
/* Runs one stage through the front (parity tests, compare). */
ris_result ris__sim_stage(ris_sim *sim, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err);
/* Host part of a tick only: muscle stages for pose; anchors stay valid until the next call. */
ris_result ris__sim_pose(ris_sim *sim, const float *pose, ris_anchor_frame *out, ris_error *err);
