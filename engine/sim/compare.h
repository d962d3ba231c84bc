/* Runs two simulations of one model through the same poses and measures how far they are apart, stage by
 * stage. Knows no backend: `risorius compare` and tests/parity give it a CPU and a Vulkan simulation. */
#pragma once

#include "risorius/sim.h"

typedef struct ris_compare_def {
    ris_sim *a, *b;      /* a is the reference; both are reset by the run */
    uint32_t tick_count; /* ticks of the clip, at least 1 */
    void (*pose)(void *user, uint32_t tick,
                 float *out_pose); /* fills channel_count floats for tick 1..tick_count */
    void *user;
    void (*progress)(void *user, uint32_t done, uint32_t total); /* may be NULL */
    float step_tolerance_mm; /* allowed after one step from equal states; 0 = not one bit may differ */
    float clip_tolerance_mm; /* allowed anywhere in the clip; 0 = not one bit may differ */
    uint32_t moved_minimum;  /* refuse a clip in which fewer nodes move by 2 mm */
} ris_compare_def;

/* Fills a and b and the defaults: 0 and 0 when either side runs on lavapipe (bit equality),
 * else 1e-4 mm after a step and 1e-2 mm over the clip; 500 moved nodes. The caller sets tick_count, pose,
 * user. */
ris_compare_def ris_default_compare_def(ris_sim *a, ris_sim *b);

/* Differences of one stage's output in mm: positions and umbrella vectors as they are, forces as the way
 * they move their node in one substep (f w dt^2), normals as the distance of the tips of unit vectors. */
typedef struct ris_compare_stage {
    double max_mm, rms_mm; /* NaN if a number was not finite on one side only */
    uint64_t differing_words;
} ris_compare_stage;

typedef struct ris_compare_report {
    char backend[2][512];
    uint32_t tick_count, substeps;
    uint32_t node_count, moving_count, moved_count; /* moved: at least 2 mm from rest at some tick of a */
    ris_compare_stage step[RIS_STAGE_COUNT];        /* after one step from equal states, at every 30th tick */
    ris_compare_stage
        clip[RIS_STAGE_COUNT]; /* over all steps of the clip, each side going on from its own state */
    bool differs; /* some bit differs; then the first place over tolerance, or if none is, the first: */
    ris_stage first_stage;
    uint32_t first_tick;    /* 1 .. tick_count */
    uint32_t first_substep; /* 0 .. substeps - 1; 0 for anchor_shift and normal */
    uint32_t first_vertex;
    uint64_t hash[2];         /* state hash of each side after the clip */
    uint64_t differing_ticks; /* ticks whose end states differ when run as whole frames */
} ris_compare_report;

/* Two passes: whole ticks (the way the engine runs), then the same clip stage by stage in lockstep; the
 * end hash of each side must be the same in both. out is filled as far as the run came. RIS_ERROR_USAGE:
 * both sides are the same backend. RIS_ERROR_FAILED: over tolerance (names stage, tick, substep, vertex),
 * or a clip that moves too little; also what the simulations report. */
ris_result ris_compare_run(const ris_compare_def *def, ris_compare_report *out, ris_error *err);
