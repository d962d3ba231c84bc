/* Recorded performances as clips: Live Link Face CSV (the 52 ARKit shapes, head and eyes) and OpenFace CSV (action units, gaze,
 * head). docs/performances.md tells the formats and what is done to the samples. */
#pragma once

#include "risorius/timeline.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ris_take_format { RIS_TAKE_LIVE_LINK, RIS_TAKE_OPENFACE } ris_take_format;

/* What may be set right while reading. ris_default_take_def: nothing, but spikes are taken out. */
typedef struct ris_take_def {
    ris_take_format format;
    bool mirror;                          /* left and right change places, also of head and eyes */
    bool flip_yaw, flip_pitch, flip_roll; /* of the head */
    bool center;                          /* the median of each angle of the head becomes its zero */
    bool no_head;                         /* the head stays where it is */
    bool keep_spikes;                     /* leaves samples that leap for one frame */
    bool onset;        /* muscles take their own time besides (ris_sim_set_onset); the player's matter */
    double rate_hz;    /* frames a second of the timecode, 0 = from the timecode itself */
    double confidence; /* OpenFace rows below it are bridged (0.7) */
    bool degrees;      /* Live Link Face angles are in degrees; so they are taken anyway if one is above pi */
} ris_take_def;

ris_take_def ris_default_take_def(ris_take_format format);
/* "mirror,flip-yaw,flip-pitch,flip-roll,landscape,center,no-head,keep-spikes,onset,degrees,rate=HZ,confidence=C" into def;
 * landscape is flip-yaw,flip-pitch. RIS_ERROR_USAGE for another word. */
ris_result ris_take_adjust(ris_take_def *def, const char *words, ris_error *err);

/* What was found and done. */
typedef struct ris_take_info {
    uint32_t rows, samples; /* data rows of the file, rows that are played */
    uint32_t columns;       /* that move */
    uint32_t lost;          /* rows without a face, or below the confidence */
    uint32_t repeated;      /* rows whose time does not advance by more than a thousandth of a frame */
    uint32_t other_faces;   /* OpenFace rows of another face_id than the first */
    uint32_t gaps;          /* places where samples are more than one and a half frames apart, bridged */
    double longest_gap_s;   /* between two samples */
    uint32_t spikes;        /* samples replaced, of all columns */
    uint32_t unknown;       /* columns that move nothing on this head */
    char first_unknown[RIS_NAME_SIZE]; /* its name */
    uint32_t clamped;                  /* values outside their range */
    double rate_hz, duration_s;
    bool degrees; /* angles of the head were degrees */
} ris_take_info;

/* Reads a take and binds its columns to the names of the model. *out is a clip like any: a cubic key per sample and column,
 * time 0 at the first row, labels where columns are highest; ris_clip_destroy. Errors: RIS_ERROR_DATA with line and column,
 * RIS_ERROR_MEMORY. out_info may be NULL. */
ris_result ris_take_load(const ris_model *model, const char *path, const ris_take_def *def, ris_clip **out,
                         ris_take_info *out_info, ris_error *err);
/* "10742 of 10800 rows, 61 columns, 179.98 s at 60 Hz; 58 gaps bridged, the longest 0.1 s; ..." Returns out. */
const char *ris_take_describe(const ris_take_info *info, char *out, size_t size);

#ifdef __cplusplus
}
#endif
