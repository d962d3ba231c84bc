/* KA-50: keys and eases; a value at any time, whatever was asked before. */
#pragma once

#include "risorius/head.h"

/* In the order of ris__ease_names. */
typedef enum ris_ease {
    RIS_EASE_STEP,
    RIS_EASE_LINEAR,
    RIS_EASE_CUBIC, /* spline through the neighbours; the others know their two keys only */
    RIS_EASE_IN,
    RIS_EASE_OUT,
    RIS_EASE_IN_OUT,
    RIS_EASE_MINIMUM_JERK,
    RIS_EASE_BACK_IN,
    RIS_EASE_BACK_OUT
} ris_ease;

/* NULL-ended: as files write them. */
extern const char *const ris__ease_names[];

typedef struct ris_key {
    double t_s;
    double value;
    double slope;  /* 1/s, of the cubic through this key */
    ris_ease ease; /* from this key to the next */
} ris_key;

typedef struct ris_track_term {
    uint32_t channel;
    float factor;
} ris_track_term;

typedef struct ris_track {
    char target[RIS_NAME_SIZE];
    uint32_t key_count, term_count;
    double period_s; /* > 0: repeats; key[key_count - 1] is then key[0] a round later */
    ris_key *key;    /* ascending in time (key_count >= 1) */
    ris_track_term *term;
} ris_track;

/* Share of the way done at share u (0 .. 1) of the time; RIS_EASE_CUBIC as between two extremes. */
double ris__ease(ris_ease ease, double u);
/* Makes the track repeat every period_s, in which all its keys lie; room for one more key. */
void ris__track_repeat(ris_track *track, double period_s);
/* Sets the slopes of the keys: monotone cubic of Fritsch and Carlson; after ris__track_repeat. */
void ris__track_set_slopes(ris_track *track);
/* Value at time_s; the ends hold, or meet if the track repeats. */
double ris__track_value(const ris_track *track, double time_s);
void ris__track_finish(ris_track *track);
