/* A clip in memory: layers of tracks, other clips, idle life and speech, targets already resolved to channels. */
#pragma once

#include "anim/idle.h"
#include "anim/pose_names.h"
#include "anim/speech.h"
#include "anim/track.h"
#include "risorius/timeline.h"

typedef struct ris_clip_layer {
    char name[RIS_NAME_SIZE];
    bool overrides; /* replaces the channels it touches, else adds */
    bool repeats;
    ris_track weight; /* in the clip's time; no keys = 1 */
    double start_s;   /* of the clip, where the layer's own time is 0 */
    double speed;     /* of the layer's own time */
    double duration_s;
    uint32_t track_count;
    ris_track *track; /* in the layer's own time, and so is what else it plays (NULL but one) */
    ris_clip *clip;
    ris_idle *idle;
    ris_speech *speech;
    bool *touches; /* (channel_count) of a layer that overrides */
} ris_clip_layer;

typedef struct ris_label {
    char name[RIS_NAME_SIZE];
    double t_s;
} ris_label;

struct ris_clip {
    double duration_s;
    bool repeats;
    uint32_t channel_count, layer_count, label_count;
    float *minimum, *maximum; /* of the model's channels (channel_count) */
    ris_clip_layer *layer;    /* bottom to top; plain tracks are the first */
    ris_label *label;
};

/* Channel count and ranges of the model's channels. False: no memory. */
bool ris__clip_take_ranges(ris_clip *clip, const ris_model *model);
/* track->term: the channels that track->target moves, and by how much; scratch: (channel_count). *out_unknown is NULL, or the
 * name that is none, and then there are no terms. False: no memory. */
bool ris__clip_bind(const ris_pose_names *names, ris_track *track, float *scratch, const char **out_unknown);
/* Makes labels of the key times at which the pose differs from the one labelled before. */
ris_result ris__clip_make_labels(ris_clip *clip, ris_error *err);
/* ris_clip_load from memory, which cannot name other files; name stands for the file in errors. */
ris_result ris__clip_parse(const ris_model *model, const char *name, const char *text, size_t size,
                           ris_clip **out, ris_error *err);
