/* The reference head with a CPU simulation of it, for the tests of its motion: one per test program. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "model/vec3.h"
#include "risorius/sim.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ris_error err;
static ris_model *model;
static ris_sim *sim;
static float *pose;
static ris_vec4 *x;      /* positions last read (node_count) */
static uint32_t *mirror; /* node at the mirrored place, or UINT32_MAX (node_count) */

static inline void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static inline void find_mirrors(void)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec3 p = v4_xyz(model->rest_position[i]);
        mirror[i] = UINT32_MAX;
        for (uint32_t j = 0; j < model->node_count && mirror[i] == UINT32_MAX; ++j) {
            if (v3_distance(v3(-p.x, p.y, p.z), v4_xyz(model->rest_position[j])) < 1e-3f) {
                mirror[i] = j;
            }
        }
    }
}

/* 0, or -1 with the reason printed. */
static inline int load_head(void)
{
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err) != RIS_OK ||
        ris_sim_create_cpu(model, &sim, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    pose = calloc(model->channel_count, sizeof *pose);
    x = malloc(model->node_count * sizeof *x);
    mirror = malloc(model->node_count * sizeof *mirror);
    if (!pose || !x || !mirror) {
        return -1;
    }
    find_mirrors();
    return 0;
}

static inline void free_head(void)
{
    ris_sim_destroy(sim);
    ris_model_destroy(model);
    free(pose);
    free(x);
    free(mirror);
}

/* Group fixtures of a test program that needs nothing but the head. */
static inline int open_loaded_head(void **state)
{
    (void)state;
    return load_head();
}

static inline int close_loaded_head(void **state)
{
    (void)state;
    free_head();
    return 0;
}

/* Resets, settles with pose and reads the positions; the time it took, s. */
static inline double settle(void)
{
    double time_s = 0.0;
    need(ris_sim_reset(sim, &err));
    need(ris_sim_settle(sim, pose, &time_s, &err));
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    return time_s;
}

static inline ris_vec3 triangle_cross(const ris_vec4 *p, const uint32_t *v)
{
    return v3_cross(v3_sub(v4_xyz(p[v[1]]), v4_xyz(p[v[0]])), v3_sub(v4_xyz(p[v[2]]), v4_xyz(p[v[0]])));
}
