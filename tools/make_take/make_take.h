/* Synthetic performances. Only + - * / on doubles and PCG32: the same bytes on every machine. */
#pragma once

#include "asset/take.h"
#include "measure/soak_pose.h"

typedef struct take_options {
    double seconds, fps;
    double jitter; /* standard deviation of the noise of a shape, 0..1 units; angles 0.3 rad x this */
    double drop,
        lose;     /* chance a frame that frames are dropped (up to 6), that the face is lost (up to 0.5 s) */
    double spike; /* chance a frame that a shape leaps for that frame */
    uint32_t seed;
    bool still; /* a neutral face: only the noise */
    bool openface, camel, sides;
} take_options;

/* Where the shapes are in ris__arkit_name. */
uint32_t shape_index(const char *name);

/* One frame without noise. Angles in degrees, to the subject's left, up, to the left shoulder. */
typedef struct take_frame {
    double shape[RIS__ARKIT_COUNT];
    double head_yaw, head_pitch, head_roll;
    double eye_yaw[2], eye_pitch[2]; /* L, R */
} take_frame;

#define MAX_TERMS 10
typedef struct take_term {
    const char *shape; /* without its side: both sides; NULL ends the list */
    double amount;
} take_term;

/* What people do with their faces: all terms together rise and fall. */
typedef struct take_recipe {
    const char *name;
    double hold_s[2]; /* least, most */
    double rise_s, fall_s;
    take_term term[MAX_TERMS];
} take_recipe;
extern const take_recipe acts[], vowels[], consonants[];
extern const uint32_t act_count, vowel_count, consonant_count;

typedef struct take_act {
    const take_recipe *recipe;
    double start_s, rise_s, hold_s, fall_s, amount;
    double shape[RIS__ARKIT_COUNT]; /* the recipe's amounts */
} take_act;

typedef struct take_look {
    double start_s, move_s, yaw, pitch; /* arrived at start_s + move_s */
} take_look;

typedef struct take_knot {
    double value[3]; /* yaw, pitch, roll */
} take_knot;

typedef struct take_play {
    take_act *act;
    uint32_t act_count;
    take_look *look;
    uint32_t look_count;
    take_knot *knot; /* of a cubic B-spline, KNOT_S apart */
    uint32_t knot_count;
} take_play;

ris_result play_make(const take_options *options, take_play *out, ris_error *err);
void play_finish(take_play *play);
void play_at(const take_play *play, double time_s, take_frame *out);

ris_result write_take(const take_options *options, const take_play *play, const char *path,
                      uint32_t *out_rows, ris_error *err);
