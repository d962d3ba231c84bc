/* Plays a clip or a held pose: simulation ticks of 1/60 s, looked at from any time between them. */
#pragma once

#include "risorius/sim.h"
#include "risorius/timeline.h"

#include <stdio.h>

typedef struct ris_player {
    ris_sim *sim;         /* not owned */
    const ris_clip *clip; /* not owned; NULL = pose is held */
    float *pose;          /* (channel_count) */
    uint64_t tick;        /* ticks done; the state stands at tick / 60 s */
    ris_vec4 *position[2],
        *normal[2]; /* states before and after the last tick (node_count), w as in the sim */
    ris_vec4 *mixed_position, *mixed_normal;
    bool loaded; /* the arrays hold the present tick */
} ris_player;

/* pose (channel_count floats, copied) is held when clip is NULL; it may be NULL for the neutral pose. */
ris_result player_init(ris_player *out, ris_sim *sim, const ris_clip *clip, const float *pose,
                       ris_error *err);
void player_finish(ris_player *player);
/* Back to rest and time 0. */
ris_result player_restart(ris_player *player, ris_error *err);

/* Tick of a time, rounded up: the state that lies at or just after it. */
uint64_t player_tick_at(double time_s);
/* One tick with the pose at its end. */
ris_result player_tick(ris_player *player, ris_error *err);
/* Ticks until time_s lies within the last tick; never goes back. */
ris_result player_advance(ris_player *player, double time_s, ris_error *err);
/* Positions and normals at time_s, which lies within the last tick; arrays stay valid until the next call. */
ris_result player_look(ris_player *player, double time_s, const ris_vec4 **out_position,
                       const ris_vec4 **out_normal, ris_error *err);
