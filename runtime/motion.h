/* What a command plays: a clip, or a recorded performance. */
#pragma once

#include "cli.h"
#include "risorius/sim.h"
#include "risorius/take.h"

typedef struct motion_words {
    const char *clip, *live_link, *openface, *adjust;
} motion_words;

/* The options of every command that plays something; a cli_option table takes them as its first lines. */
#define MOTION_OPTIONS(words)                                                                                \
    {"clip", 'c', "CLIP", "the clip to play", NULL, &(words)->clip, NULL},                                   \
        {"live-link",         0,   "TAKE.csv", "a performance of Live Link Face instead", NULL,              \
         &(words)->live_link, NULL},                                                                         \
        {"openface", 0, "TAKE.csv", "a performance of OpenFace instead", NULL, &(words)->openface, NULL},    \
    {                                                                                                        \
        "adjust", 0, "LIST",                                                                                 \
            "of a performance: mirror, flip-yaw, flip-pitch, flip-roll, landscape, center, no-head, "        \
            "keep-spikes, onset, degrees, rate=HZ, confidence=C",                                            \
            NULL, &(words)->adjust, NULL                                                                     \
    }

/* The file that is played, NULL = none. */
const char *motion_file(const motion_words *words);
/* At most one file; --adjust with a performance alone, and made of its words. RIS_ERROR_USAGE. */
ris_result motion_check(const motion_words *words, ris_error *err);
/* Loads what is named (at least one file is); what was found in a performance is noted on stderr unless quiet. */
ris_result motion_load(const motion_words *words, const ris_cli *cli, const ris_model *model, ris_clip **out,
                       ris_error *err);
/* Tells the simulation that muscles are at every pose of a performance at once: it holds the actor's own onset. */
void motion_start(const motion_words *words, ris_sim *sim);
