/* A clip in memory: tracks of keys, targets already resolved to channels. */
#pragma once

#include "risorius/timeline.h"

typedef enum ris_ease { RIS_EASE_STEP, RIS_EASE_LINEAR, RIS_EASE_CUBIC } ris_ease;

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
    ris_key *key; /* ascending in time (key_count >= 1) */
    ris_track_term *term;
} ris_track;

typedef struct ris_label {
    char name[RIS_NAME_SIZE];
    double t_s;
} ris_label;

struct ris_clip {
    double duration_s;
    uint32_t channel_count, track_count, label_count;
    float *minimum, *maximum; /* of the model's channels (channel_count) */
    ris_track *track;
    ris_label *label;
};

/* Sets the slopes of the keys: monotone cubic of Fritsch and Carlson. */
void ris__track_set_slopes(ris_track *track);
/* Value at time_s; the ends hold. */
double ris__track_value(const ris_track *track, double time_s);
/* Makes labels of the key times at which the pose differs from the one labelled before. */
ris_result ris__clip_make_labels(ris_clip *clip, ris_error *err);
/* ris_clip_load from memory; name stands for the file in errors. */
ris_result ris__clip_parse(const ris_model *model, const char *name, const char *text, size_t size,
                           ris_clip **out, ris_error *err);
