/* Idle life (beyond the theses; KA-50 as one more layer): blinks, gaze shifts, micro-saccades, a head that never
 * stands quite still, breath. All of it is drawn by a seed when the clip is read, so that a sample depends on the
 * time alone. */
#pragma once

#include "risorius/model.h"

#define RIS_BLINK_HOLD_S 0.03   /* the lids stay down: what they hang on needs that to arrive */
#define RIS_IDLE_ROUND_S 1800.0 /* after half an hour the same life again */

typedef struct ris_idle_def {
    uint32_t seed;
    double blinks_per_min; /* beside those with gaze shifts */
    double gazes_per_min;  /* shifts of gaze */
    double gaze_deg;       /* deviation of where they go, across; 0.6 of it up and down */
    double saccades_per_s; /* micro-saccades */
    double saccade_deg;    /* their usual size */
    double head_deg;       /* deviation of the head's yaw and pitch; half of it in roll */
    double breaths_per_min;
    double breath_deg; /* by which the head rises with each breath */
} ris_idle_def;

extern const ris_idle_def ris__idle_default;

typedef struct ris_blink {
    double start_s, close_s, open_s; /* the lid falls for close_s, rises for open_s */
    double depth;                    /* 1 = onto the lower lid */
} ris_blink;

/* A shift of the eyes; they stay at the end of it until the next. */
typedef struct ris_shift {
    double start_s, duration_s;
    double yaw_deg, pitch_deg;
} ris_shift;

typedef struct ris_idle {
    ris_idle_def def;
    uint32_t blink_count, gaze_count, saccade_count, drift_count;
    ris_blink *blink;
    ris_shift *gaze, *saccade; /* each begins with one at 0 to the middle */
    float *drift;     /* (drift_count, 3) control values of a closed cubic B-spline: yaw, pitch, roll */
    uint32_t lid[4];  /* channels, UINT32_MAX = the model has none: upper L R, lower L R */
    uint32_t eye[4];  /* yaw L R, pitch L R */
    uint32_t head[4]; /* yaw, pitch, roll, y */
} ris_idle;

/* NULL: no memory. ris__idle_destroy takes NULL. */
ris_idle *ris__idle_create(const ris_idle_def *def, const ris_model *model);
void ris__idle_destroy(ris_idle *idle);
/* Adds the life at time_s to pose, channels first .. first + count - 1. Before 0 there is none. */
void ris__idle_add(const ris_idle *idle, double time_s, uint32_t first, uint32_t count, float *pose);
/* Sets touches (channel_count) of the channels it moves. */
void ris__idle_touch(const ris_idle *idle, bool *touches);
