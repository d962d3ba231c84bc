/* What `risorius soak` keeps of its poses, and how it says it. */
#pragma once

#include "backend.h"
#include "measure/measure.h"
#include "measure/soak_pose.h"
#include "motion.h"
#include "player.h"

#define SOAK_WORST_MAX 1000

/* Beside the measures of a skin: how fast the fastest node still was when the pose was given up. */
#define SOAK_SPEED RIS_MEASURE_COUNT
#define SOAK_COUNT (RIS_MEASURE_COUNT + 1)

/* One finding and the pose or frame it was found in. */
typedef struct soak_record {
    ris_finding finding;
    ris_soak_id id;
} soak_record;

/* One measure over all poses. */
typedef struct soak_row {
    bool measured, bounded;
    double bound;          /* mm, mm/s, nodes; of FLIPPED a share of all triangles of all poses */
    soak_record *worst;    /* highest value first (worst_count, room for args.worst, at least 1) */
    uint32_t worst_count;  /* poses with a value above 0 that are kept */
    uint32_t pose_count;   /* poses that were measured */
    uint32_t found_count;  /* poses with a value above 0 */
    uint32_t broken_count; /* poses above the bound (of FLIPPED: with any) */
    double sum;            /* of all values: triangles */
    soak_record single;    /* worst single channel */
} soak_row;

typedef struct soak_args {
    const char *head, *pose;                          /* pose: this one alone */
    motion_words motion;                              /* instead of poses */
    uint32_t poses, seed, mirror_every, worst, every; /* every: ticks from frame to frame of a motion */
    bool no_single;
    double hold_s, vertex_mm, midpoint_mm, lip_mm, flipped_share, mirror_mm, speed_mm_s;
} soak_args;

typedef struct soak {
    ris_backend backend;
    ris_measurer *measurer;
    soak_args args;
    soak_row row[SOAK_COUNT];
    uint32_t kind_count[3]; /* poses of each kind that are wanted */
    uint32_t done, total;
    ris_clip *clip; /* NULL: poses */
    ris_player player;
    ris_vec4 *before; /* a tick earlier (node_count) */
    ris_measure_trace trace;
    float *pose, *mirrored_pose;
    ris_vec4 *position, *mirrored;
    double held_s; /* simulated */
    bool interrupted;
} soak;

/* The words of a pose; malloced, the caller frees; NULL without memory. */
char *soak_pose_text(const soak *run, ris_soak_id id);
const char *soak_row_name(const soak *run, uint32_t row);
const char *soak_row_unit(uint32_t row);
/* The value that is held against the bound. */
double soak_row_value(const soak *run, uint32_t row);
bool soak_row_broken(const soak *run, uint32_t row);

/* Counts a finding of a measure; those above 0 are kept while they are among the worst. */
void soak_record_finding(soak *run, uint32_t row, const ris_finding *finding, ris_soak_id id);
/* The skin at run->position measured, all but its mirror: into found (RIS_MEASURE_COUNT) and the rows. */
ris_result soak_measure_skin(soak *run, ris_soak_id id, ris_finding *found, ris_error *err);
/* Frames of a motion instead of poses. */
ris_result soak_motion_open(soak *run, const ris_cli *cli, ris_error *err);
ris_result soak_motion_measure(soak *run, const ris_cli *cli, ris_error *err);
void soak_motion_close(soak *run);
/* End of the tick that was measured as this frame. */
double soak_motion_time_s(const soak *run, uint32_t frame);

void soak_print_text(const soak *run);
void soak_print_json(const soak *run);
/* The first broken bound as one sentence; RIS_OK if all hold. */
ris_result soak_verdict(const soak *run, ris_error *err);
