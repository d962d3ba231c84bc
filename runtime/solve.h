/* What `risorius solve` shares: the controls, the simulations and what was found. */
#pragma once

#include "backend.h"
#include "risorius/solve.h"

typedef struct solve_args {
    const char *head, *target, *out, *channels;
    bool landmarks, align, self_test;
    uint32_t iterations, threads, poses, first, seed;
    double enough_mm, near_mm;
} solve_args;

typedef struct solve_run {
    const ris_cli *cli;
    solve_args args;
    ris_backend backend;
    ris_sim *sim[RIS_SOLVE_SIMS]; /* sim[0] is the backend's (sim_count) */
    uint32_t sim_count, control_count;
    ris_control control[RIS_SOLVE_CONTROLS];
    ris_target target;
    ris_solve_result result;
    ris_control_found found[RIS_SOLVE_CONTROLS];
    float *pose; /* (channel_count) */
} solve_run;

/* The controls that --channels names: NULL, groups ("muscles", "all", "au", "arkit") or names. RIS_ERROR_USAGE for an unknown name. */
ris_result solve_controls(solve_run *run, ris_error *err);

/* "name=value,..." of what was found, "neutral" rests left out; malloced, the caller frees; NULL without memory. */
char *solve_pose_text(const solve_run *run);
void solve_print_text(const solve_run *run);
void solve_print_json(const solve_run *run);
/* The pose into a file: .json a clip of one key with an expression "solved", anything else its words. */
ris_result solve_write(const solve_run *run, const char *path, ris_error *err);

/* Random poses of `soak` are held, solved and compared; RIS_ERROR_FAILED if one is not found again. */
ris_result solve_self_test(solve_run *run, ris_error *err);
/* The target is solved for into run->result, found and pose, with progress by the name of title. */
ris_result solve_target(solve_run *run, const char *title, ris_error *err);
