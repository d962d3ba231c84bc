/* risorius pairs HEAD: action units that people combine, at full strength, brought about on several ways. One and the same face
 * must come of each; what it breaks is measured. */
#include "backend.h"

#include "measure/measure.h"
#include "risorius/timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RAMP_S 2.0
#define OVERSHOOT 1.3f /* of every node's way */
#define HOLD_S 5.0

static const char *const usual[] = {
    "AU1,AU2",   "AU1,AU4",   "AU2,AU4",   "AU4,AU5",   "AU4,AU7",   "AU5,AU26",  "AU6,AU7",   "AU6,AU12",
    "AU7,AU12",  "AU9,AU10",  "AU10,AU12", "AU10,AU17", "AU12,AU15", "AU12,AU17", "AU12,AU25", "AU12,AU26",
    "AU14,AU17", "AU15,AU17", "AU16,AU25", "AU17,AU23", "AU17,AU24", "AU18,AU25", "AU18,AU26", "AU20,AU25",
    "AU20,AU26", "AU22,AU25", "AU23,AU26", "AU25,AU26", "AU5,AU27",  "AU12,AU27", "AU16,AU27", "AU20,AU27",
};

enum { TOGETHER, FIRST_THEN_SECOND, SECOND_THEN_FIRST, RAMP, FROM_OVERSHOOT, FROM_OTHER, WAYS };
static const char *const way_name[WAYS] = {"together", "A then B",  "B then A",
                                           "ramp",     "overshoot", "other face"};

typedef struct pairs_args {
    const char *head;
    cli_list pair;
    double path_mm;
    uint32_t flipped;
} pairs_args;

typedef struct pairs_run {
    const ris_cli *cli;
    pairs_args args;
    ris_backend backend;
    ris_measurer *measurer;
    float *first, *second, *both, *other, *moving; /* poses (channel_count) */
    ris_vec4 *reference, *position, *still;        /* (node_count); still: zero */
    uint32_t count, far, flipped;
    double worst_mm;
} pairs_run;

/* What became of one pair. */
typedef struct pair_found {
    double apart_mm[WAYS];
    uint32_t vertex[WAYS];
    bool restless;
    ris_finding measured[RIS_MEASURE_COUNT];
} pair_found;

static ris_result hold(pairs_run *run, const float *pose, pair_found *found, ris_error *err)
{
    ris_hold held;
    ris_result r = ris_sim_hold(run->backend.sim, pose, HOLD_S, &held, err);
    found->restless = found->restless || (!r && !held.at_rest);
    return r ? r : interrupt_check(err);
}

/* Both poses grow evenly from rest. */
static ris_result ramp(pairs_run *run, ris_error *err)
{
    const int ticks = (int)(RAMP_S / RIS_TICK_S + 0.5);
    ris_result r = RIS_OK;
    ris_sim_set_onset(run->backend.sim, false);
    for (int t = 1; !r && t <= ticks; t++) {
        for (uint32_t c = 0; c < run->backend.model->channel_count; c++) {
            run->moving[c] = run->both[c] * (float)t / (float)ticks;
        }
        r = ris_sim_tick(run->backend.sim, run->moving, err);
    }
    ris_sim_set_onset(run->backend.sim, true);
    return r;
}

/* From the held pose every node is thrown outwards from rest, without velocity. */
static ris_result throw_out(pairs_run *run, ris_error *err)
{
    static const ris_state speeds[] = {RIS_STATE_VELOCITY_HALF, RIS_STATE_VELOCITY_PREV};
    const ris_model *model = run->backend.model;
    for (uint32_t i = 0; i < model->node_count; i++) {
        const ris_vec4 rest = model->rest_position[i], at = run->reference[i];
        run->position[i] =
            (ris_vec4){rest.x + OVERSHOOT * (at.x - rest.x), rest.y + OVERSHOOT * (at.y - rest.y),
                       rest.z + OVERSHOOT * (at.z - rest.z), at.w};
    }
    ris_result r = ris_sim_write(run->backend.sim, RIS_STATE_POSITION, run->position, err);
    for (int k = 0; !r && k < 2; k++) {
        r = ris_sim_write(run->backend.sim, speeds[k], run->still, err);
    }
    return r;
}

/* Leads the face up to where the last hold begins. */
static ris_result approach(pairs_run *run, int way, pair_found *found, ris_error *err)
{
    ris_result r = ris_sim_reset(run->backend.sim, err);
    if (r) {
        return r;
    }
    switch (way) {
    case FIRST_THEN_SECOND: return hold(run, run->first, found, err);
    case SECOND_THEN_FIRST: return hold(run, run->second, found, err);
    case RAMP: return ramp(run, err);
    case FROM_OVERSHOOT: r = hold(run, run->both, found, err); return r ? r : throw_out(run, err);
    case FROM_OTHER: return hold(run, run->other, found, err);
    default: return RIS_OK;
    }
}

static void compare(const pairs_run *run, int way, pair_found *found)
{
    for (uint32_t i = 0; i < run->backend.model->node_count; i++) {
        const ris_vec4 a = run->reference[i], b = run->position[i];
        const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y,
                     z = (double)a.z - (double)b.z;
        const double apart = sqrt((x * x + y * y) + z * z);
        if (!(apart <= found->apart_mm[way])) {
            found->apart_mm[way] = apart;
            found->vertex[way] = i;
        }
    }
}

static ris_result measure(pairs_run *run, pair_found *found, ris_error *err)
{
    ris_bone_frames frames;
    for (int b = 0; b < RIS_BONE_SKIN; b++) {
        ris_sim_bone_transform(run->backend.sim, (ris_bone)b, frames.bone[b]);
    }
    return ris__measure_pose(run->measurer, run->reference, &frames, found->measured, NULL, err);
}

static ris_result walk(pairs_run *run, int way, pair_found *found, ris_error *err)
{
    ris_vec4 *out = way == TOGETHER ? run->reference : run->position;
    ris_result r = approach(run, way, found, err);
    if (!r) {
        r = hold(run, run->both, found, err);
    }
    if (!r) {
        r = ris_sim_read(run->backend.sim, RIS_STATE_POSITION, out, err);
    }
    if (!r && way == TOGETHER) {
        r = measure(run, found, err);
    } else if (!r) {
        compare(run, way, found);
    }
    return r;
}

/* "A,B" into the two poses and their sum. The pose of the pair before is the other face. */
static ris_result read_pair(pairs_run *run, const char *text, ris_error *err)
{
    const ris_model *model = run->backend.model;
    const size_t length = strcspn(text, ",");
    char first[RIS_NAME_SIZE];
    if (!text[length] || length == 0 || length >= sizeof first || !text[length + 1] ||
        strchr(text + length + 1, ',')) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "--pair \"%.80s\": expected two names with a comma between them", text);
    }
    memcpy(first, text, length);
    first[length] = '\0';
    memcpy(run->other, run->both, model->channel_count * sizeof *run->other);
    memset(run->first, 0, model->channel_count * sizeof *run->first);
    memset(run->second, 0, model->channel_count * sizeof *run->second);
    memset(run->both, 0, model->channel_count * sizeof *run->both);
    ris_result r = ris_pose_add(model, first, 1, run->first, err);
    if (!r) {
        r = ris_pose_add(model, text + length + 1, 1, run->second, err);
    }
    for (uint32_t c = 0; c < model->channel_count; c++) {
        run->both[c] = run->first[c] + run->second[c];
    }
    ris_pose_clamp(model, run->first);
    ris_pose_clamp(model, run->second);
    ris_pose_clamp(model, run->both);
    return r;
}

static void print_pair(const pairs_run *run, const char *name, const pair_found *f)
{
    if (run->cli->json) {
        printf("%s\n  {\"pair\": ", run->count ? "," : "");
        cli_json_string(stdout, name);
        for (int w = 1; w < WAYS; w++) {
            printf(", \"%s\": %.6g", way_name[w], f->apart_mm[w]);
        }
        printf(", \"at_rest\": %s, \"flipped\": %u, \"flipped_other\": %u}", f->restless ? "false" : "true",
               f->measured[RIS_MEASURE_FLIPPED].count, f->measured[RIS_MEASURE_FLIPPED_OTHER].count);
        return;
    }
    printf("%-12s", name);
    int worst = 1;
    for (int w = 1; w < WAYS; w++) {
        printf(" %10.4f", f->apart_mm[w]);
        worst = f->apart_mm[w] > f->apart_mm[worst] ? w : worst;
    }
    const char *region = ris__measure_region(run->backend.model, f->vertex[worst]);
    printf(" %8u %8u  vertex %u%s%s%s%s\n", f->measured[RIS_MEASURE_FLIPPED].count,
           f->measured[RIS_MEASURE_FLIPPED_OTHER].count, f->vertex[worst], *region ? " (" : "", region,
           *region ? ")" : "", f->restless ? ", not at rest" : "");
    fflush(stdout);
}

static ris_result test_pair(pairs_run *run, const char *name, ris_error *err)
{
    pair_found found = {0};
    ris_result r = read_pair(run, name, err);
    for (int way = 0; !r && way < WAYS; way++) {
        r = walk(run, way, &found, err);
    }
    if (r) {
        return r;
    }
    double most = 0;
    for (int way = 1; way < WAYS; way++) {
        most = found.apart_mm[way] > most ? found.apart_mm[way] : most;
    }
    print_pair(run, name, &found);
    run->count++;
    run->worst_mm = most > run->worst_mm ? most : run->worst_mm;
    run->far += !(most <= run->args.path_mm);
    run->flipped +=
        found.measured[RIS_MEASURE_FLIPPED].count + found.measured[RIS_MEASURE_FLIPPED_OTHER].count >
        run->args.flipped;
    return RIS_OK;
}

static ris_result open_run(pairs_run *run, ris_error *err)
{
    ris_result r = backend_open(&run->backend, run->cli, run->args.head, &(backend_need){.sim = true}, err);
    if (r) {
        return r;
    }
    const ris_model *model = run->backend.model;
    float **const pose[] = {&run->first, &run->second, &run->both, &run->other, &run->moving};
    ris_vec4 **const skin[] = {&run->reference, &run->position, &run->still};
    bool there = true;
    for (size_t k = 0; k < sizeof pose / sizeof *pose; k++) {
        there = (*pose[k] = calloc(model->channel_count + 1u, sizeof **pose[k])) && there;
    }
    for (size_t k = 0; k < sizeof skin / sizeof *skin; k++) {
        there = (*skin[k] = calloc(model->node_count + 1u, sizeof **skin[k])) && there;
    }
    return there ? ris__measurer_create(model, &run->measurer, err)
                 : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", model->node_count);
}

static void close_run(pairs_run *run)
{
    void *const list[] = {run->first,  run->second,    run->both,     run->other,
                          run->moving, run->reference, run->position, run->still};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        free(list[k]);
    }
    ris__measurer_destroy(run->measurer);
    backend_close(&run->backend);
}

static ris_result test_all(pairs_run *run, ris_error *err)
{
    const cli_list *own = &run->args.pair;
    const uint32_t count = own->count ? own->count : (uint32_t)(sizeof usual / sizeof *usual);
    ris_result r = RIS_OK;
    if (run->cli->json) {
        printf("{\"pairs\": [");
    } else {
        printf("mm from together:");
        printf("%*s %10s %10s %10s %10s %8s %8s\n%-12s\n", 6, way_name[1], way_name[2], way_name[3],
               way_name[4], way_name[5], "flipped", "other", "");
    }
    for (uint32_t k = 0; !r && k < count; k++) {
        r = test_pair(run, own->count ? own->item[k] : usual[k], err);
    }
    if (run->cli->json) {
        printf("\n ], \"worst_mm\": %.6g, \"apart\": %u, \"flipped\": %u}\n", run->worst_mm, run->far,
               run->flipped);
    } else if (!r) {
        printf(
            "%u pairs: ways end at most %.4f mm apart, %u pairs above %g mm; %u pairs turn over more than %u "
            "triangles\n",
            run->count, run->worst_mm, run->far, run->args.path_mm, run->flipped, run->args.flipped);
    }
    if (!r && run->far) {
        r = ris_fail(err, RIS_ERROR_FAILED, "%u of %u pairs end more than %g mm apart on different ways",
                     run->far, run->count, run->args.path_mm);
    } else if (!r && run->flipped) {
        r = ris_fail(err, RIS_ERROR_FAILED, "%u of %u pairs turn over more than %u triangles", run->flipped,
                     run->count, run->args.flipped);
    }
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    pairs_run run = {.cli = cli, .args = {.path_mm = 0.1, .flipped = 0}};
    const char *path = NULL, *flipped = NULL;
    const cli_option options[] = {
        {"pair", 'p', "A,B", "these two names at full strength instead of the usual pairs; up to 8 times",
         NULL, NULL, &run.args.pair},
        {"path", 0, "MM", "bound of the distance between the ways (0.1)", NULL, &path, NULL},
        {"flipped", 0, "N", "bound of the triangles that a pair turns over (0)", NULL, &flipped, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_pairs, options, argc, argv, &run.args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_pairs, count, err);
    if (!r && path) {
        r = cli_number("path", path, 0, 1000, &run.args.path_mm, err);
    }
    if (!r && flipped) {
        r = cli_count("flipped", flipped, 0, 1000000, &run.args.flipped, err);
    }
    if (!r) {
        r = open_run(&run, err);
        if (!r) {
            r = test_all(&run, err);
        }
        close_run(&run);
    }
    return r;
}

const cli_command cmd_pairs = {
    .name = "pairs",
    .usage = "HEAD [--pair A,B] [--path MM] [--flipped N]",
    .summary = "combine strong action units on several ways and measure what comes of it",
    .detail = "Every pair is held from rest at once; then after the one, after the other, by a ramp of 2 s, "
              "from a skin "
              "thrown\n"
              "out to 1.3 times its way, and from the face of the pair before. Printed is the largest "
              "distance of a "
              "vertex\n"
              "from the face reached at once, and how many triangles of lips and lids, and of other skin, "
              "are turned "
              "over.\n",
    .run = run,
};
