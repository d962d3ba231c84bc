/* risorius soak HEAD: random poses held until at rest, and what each of them breaks, measured on the meshes. */
#include "soak.h"
#include "risorius/timeline.h"

#include <stdlib.h>

#define EVENT_TICKS 20

/* Frames near each other show one event, of which the worst is kept. False if a worse one is there. */
static bool replace_neighbour(const soak *run, soak_row *row, const ris_finding *finding, ris_soak_id id)
{
    const uint32_t near = EVENT_TICKS / run->args.every;
    for (uint32_t k = 0; k < row->worst_count; k++) {
        if (row->worst[k].id.number + near >= id.number) {
            if (row->worst[k].finding.value >= finding->value) {
                return false;
            }
            --row->worst_count;
            for (uint32_t n = k--; n < row->worst_count; n++) {
                row->worst[n] = row->worst[n + 1];
            }
        }
    }
    return true;
}

static void keep(const soak *run, soak_row *row, const ris_finding *finding, ris_soak_id id)
{
    const uint32_t room = run->args.worst ? run->args.worst : 1;
    if (run->clip && !replace_neighbour(run, row, finding, id)) {
        return;
    }
    uint32_t at = row->worst_count;
    while (at > 0 && row->worst[at - 1].finding.value < finding->value) {
        --at;
    }
    if (at == room) {
        return;
    }
    row->worst_count += row->worst_count < room;
    for (uint32_t k = row->worst_count - 1; k > at; --k) {
        row->worst[k] = row->worst[k - 1];
    }
    row->worst[at] = (soak_record){*finding, id};
}

void soak_record_finding(soak *run, uint32_t which, const ris_finding *finding, ris_soak_id id)
{
    soak_row *row = &run->row[which];
    ++row->pose_count;
    if (!(finding->value > 0)) {
        return;
    }
    ++row->found_count;
    row->sum += finding->value;
    row->broken_count += which == RIS_MEASURE_FLIPPED || (row->bounded && finding->value > row->bound);
    if (id.kind == RIS_SOAK_SINGLE && finding->value > row->single.finding.value) {
        row->single = (soak_record){*finding, id};
    }
    keep(run, row, finding, id);
}

/* From rest, so that every pose can be had again alone. A run that leaves the numbers is a finding, no error. */
static ris_result hold(soak *run, const float *pose, ris_vec4 *out, ris_hold *held, ris_error *err)
{
    ris_result r = ris_sim_reset(run->backend.sim, err);
    if (!r) {
        r = ris_sim_hold(run->backend.sim, pose, run->args.hold_s, held, err);
        run->held_s += held->time_s;
        r = r == RIS_ERROR_DIVERGED ? RIS_OK : r;
    }
    return r ? r : ris_sim_read(run->backend.sim, RIS_STATE_POSITION, out, err);
}

static ris_result measure_mirror(soak *run, ris_soak_id id, ris_error *err)
{
    ris_hold held = {0};
    ris__measure_mirror_pose(run->backend.model, run->pose, run->mirrored_pose);
    ris_result r = hold(run, run->mirrored_pose, run->mirrored, &held, err);
    if (!r) {
        const ris_finding found = ris__measure_mirror(run->measurer, run->position, run->mirrored);
        soak_record_finding(run, RIS_MEASURE_MIRROR, &found, id);
    }
    return r;
}

ris_result soak_measure_skin(soak *run, ris_soak_id id, ris_finding *found, ris_error *err)
{
    ris_bone_frames frames;
    for (int b = 0; b < RIS_BONE_SKIN; b++) {
        ris_sim_bone_transform(run->backend.sim, (ris_bone)b, frames.bone[b]);
    }
    ris_result r = ris__measure_pose(run->measurer, run->position, &frames, found, &run->trace, err);
    for (uint32_t m = 0; !r && m < RIS_MEASURE_MIRROR; m++) {
        if (run->row[m].measured) {
            soak_record_finding(run, m, &found[m], id);
        }
    }
    return r;
}

static ris_result measure_one(soak *run, ris_soak_id id, ris_error *err)
{
    ris_finding found[RIS_MEASURE_COUNT];
    ris_hold held = {0};
    char *text = soak_pose_text(run, id);
    if (!text) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    }
    ris_result r = ris_pose_parse(run->backend.model, text, run->pose, err);
    free(text);
    if (!r) {
        r = hold(run, run->pose, run->position, &held, err);
    }
    if (!r) {
        r = soak_measure_skin(run, id, found, err);
    }
    if (!r) {
        const ris_finding speed = {.value = held.at_rest ? 0 : (double)held.speed_mm_s,
                                   .vertex_count = 1,
                                   .vertex = {held.vertex},
                                   .part = ""};
        soak_record_finding(run, SOAK_SPEED, &speed, id);
    }
    const bool wild = !r && found[RIS_MEASURE_FINITE].value > 0;
    if (!r && !wild && run->row[RIS_MEASURE_MIRROR].measured && run->done % run->args.mirror_every == 0) {
        r = measure_mirror(run, id, err);
    }
    return r;
}

static ris_result measure_all(soak *run, const ris_cli *cli, ris_error *err)
{
    ris_progress bar;
    ris_result r = RIS_OK;
    progress_start(&bar, cli, "soak");
    for (int kind = 0; kind < 3; kind++) {
        for (uint32_t i = 0; !r && !run->interrupted && i < run->kind_count[kind]; i++) {
            progress_show(&bar, run->done, run->total);
            r = measure_one(run, (ris_soak_id){(ris_soak_kind)kind, i}, err);
            run->done += !r;
            run->interrupted = interrupt_seen();
        }
    }
    if (!r && !run->interrupted) {
        progress_show(&bar, run->total, run->total);
    }
    progress_end(&bar);
    return r;
}

static double bound_of(const soak_args *args, uint32_t row)
{
    switch (row) {
    case RIS_MEASURE_FINITE: return 0;
    case RIS_MEASURE_SKULL:
    case RIS_MEASURE_UPPER_TEETH:
    case RIS_MEASURE_MANDIBLE:
    case RIS_MEASURE_LOWER_TEETH:
    case RIS_MEASURE_EYES: return args->vertex_mm;
    case RIS_MEASURE_SKULL_MIDPOINT:
    case RIS_MEASURE_UPPER_TEETH_MIDPOINT:
    case RIS_MEASURE_MANDIBLE_MIDPOINT:
    case RIS_MEASURE_LOWER_TEETH_MIDPOINT:
    case RIS_MEASURE_EYES_MIDPOINT: return args->midpoint_mm;
    case RIS_MEASURE_LIPS:
    case RIS_MEASURE_LIDS: return args->lip_mm;
    case RIS_MEASURE_FLIPPED: return args->flipped_share;
    case RIS_MEASURE_MIRROR: return args->mirror_mm;
    case SOAK_SPEED: return args->speed_mm_s;
    default: return -1;
    }
}

static ris_result open_rows(soak *run, ris_error *err)
{
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        soak_row *row = &run->row[k];
        row->measured = k == SOAK_SPEED || ris__measurer_has(run->measurer, (ris_measure)k);
        row->bound = bound_of(&run->args, k);
        row->bounded = row->bound >= 0;
        row->worst = calloc(run->args.worst + 1u, sizeof *row->worst);
        if (!row->worst) {
            return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the worst poses");
        }
    }
    if (run->args.mirror_every == 0) {
        run->row[RIS_MEASURE_MIRROR].measured = false;
    }
    return RIS_OK;
}

static ris_result open_soak(soak *run, const ris_cli *cli, ris_error *err)
{
    ris_result r = backend_open(&run->backend, cli, run->args.head, &(backend_need){.sim = true}, err);
    if (r) {
        return r;
    }
    const ris_model *model = run->backend.model;
    r = ris__measurer_create(model, &run->measurer, err);
    if (!r) {
        r = open_rows(run, err);
    }
    if (r) {
        return r;
    }
    run->pose = calloc(model->channel_count + 1u, sizeof *run->pose);
    run->mirrored_pose = calloc(model->channel_count + 1u, sizeof *run->mirrored_pose);
    run->position = calloc(model->node_count, sizeof *run->position);
    run->mirrored = calloc(model->node_count, sizeof *run->mirrored);
    run->trace.flipped = calloc(model->triangle_count + 1u, sizeof *run->trace.flipped);
    run->trace.worst = calloc((size_t)RIS_MEASURE_COUNT * model->node_count, sizeof *run->trace.worst);
    if (!run->pose || !run->mirrored_pose || !run->position || !run->mirrored || !run->trace.flipped ||
        !run->trace.worst) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", model->node_count);
    }
    if (model->channel_count == 0) {
        return ris_fail(err, RIS_ERROR_FAILED, "%s has no channels to pose", run->args.head);
    }
    run->kind_count[RIS_SOAK_FEW] = run->args.poses;
    run->kind_count[RIS_SOAK_ALL] = run->args.poses / 10;
    run->kind_count[RIS_SOAK_SINGLE] = run->args.no_single ? 0 : ris__soak_single_count(model);
    if (run->args.pose || motion_file(&run->args.motion)) {
        run->kind_count[RIS_SOAK_FEW] = 1;
        run->kind_count[RIS_SOAK_ALL] = run->kind_count[RIS_SOAK_SINGLE] = 0;
    }
    run->total = run->kind_count[0] + run->kind_count[1] + run->kind_count[2];
    return motion_file(&run->args.motion) ? soak_motion_open(run, cli, err) : RIS_OK;
}

static void close_soak(soak *run)
{
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        free(run->row[k].worst);
    }
    free(run->pose);
    free(run->mirrored_pose);
    free(run->position);
    free(run->mirrored);
    free(run->trace.flipped);
    free(run->trace.worst);
    soak_motion_close(run);
    ris__measurer_destroy(run->measurer);
    backend_close(&run->backend);
}

typedef struct soak_words {
    const char *poses, *seed, *mirror_every, *worst, *hold, *vertex, *midpoint, *lips, *flipped, *mirror,
        *speed, *every;
} soak_words;

static ris_result read_words(const soak_words *words, soak_args *args, ris_error *err)
{
    const struct {
        const char *name, *text;
        uint32_t low, high, *out;
    } count[] = {{"poses", words->poses, 0, 10000000, &args->poses},
                 {"seed", words->seed, 0, UINT32_MAX, &args->seed},
                 {"mirror-every", words->mirror_every, 0, 1000000, &args->mirror_every},
                 {"worst", words->worst, 0, SOAK_WORST_MAX, &args->worst},
                 {"every", words->every, 1, 10000, &args->every}};
    const struct {
        const char *name, *text;
        double high, *out;
    } number[] = {{"hold", words->hold, 60, &args->hold_s},
                  {"vertex", words->vertex, 1000, &args->vertex_mm},
                  {"midpoint", words->midpoint, 1000, &args->midpoint_mm},
                  {"lips", words->lips, 1000, &args->lip_mm},
                  {"flipped", words->flipped, 1, &args->flipped_share},
                  {"mirror", words->mirror, 1000, &args->mirror_mm},
                  {"speed", words->speed, 1e6, &args->speed_mm_s}};
    ris_result r = RIS_OK;
    for (size_t k = 0; !r && k < sizeof count / sizeof *count; k++) {
        if (count[k].text) {
            r = cli_count(count[k].name, count[k].text, count[k].low, count[k].high, count[k].out, err);
        }
    }
    for (size_t k = 0; !r && k < sizeof number / sizeof *number; k++) {
        if (number[k].text) {
            r = cli_number(number[k].name, number[k].text, 0, number[k].high, number[k].out, err);
        }
    }
    return r;
}

static ris_result parse(ris_cli *cli, int argc, char **argv, soak_args *args, ris_error *err)
{
    soak_words w = {0};
    *args = (soak_args){.poses = 200,
                        .seed = 1,
                        .mirror_every = 10,
                        .every = 1,
                        .hold_s = 5,
                        .vertex_mm = 0.5,
                        .midpoint_mm = 1,
                        .lip_mm = 0.5,
                        .flipped_share = 0.0001,
                        .mirror_mm = 0.05,
                        .speed_mm_s = 0.1};
    const cli_option options[] = {
        {"poses", 'n', "N", "random poses of 1 to 6 channels; N/10 of all channels follow (200)", NULL,
         &w.poses, NULL},
        {"seed", 's', "S", "which random poses (1)", NULL, &w.seed, NULL},
        {"pose", 'p', "POSE", "measure this pose alone: name=value[,name=value...]", NULL, &args->pose, NULL},
        MOTION_OPTIONS(&args->motion),
        {"every", 0, "N", "of a motion, measure every N-th sixtieth of a second (1)", NULL, &w.every, NULL},
        {"no-single", 0, NULL, "leave out every channel alone at the ends of its range", &args->no_single,
         NULL, NULL},
        {"mirror-every", 0, "N", "hold the mirror image of every N-th pose too; 0 = never (10)", NULL,
         &w.mirror_every, NULL},
        {"hold", 0, "SECONDS", "longest time until a pose must be at rest (5)", NULL, &w.hold, NULL},
        {"worst", 'k', "K", "list the K worst poses of every measure (0)", NULL, &w.worst, NULL},
        {"vertex", 0, "MM", "bound of a vertex's depth in bone, teeth, eyes (0.5)", NULL, &w.vertex, NULL},
        {"midpoint", 0, "MM", "bound of an edge's midpoint's depth in them (1)", NULL, &w.midpoint, NULL},
        {"lips", 0, "MM", "bound of a vertex's depth in the other lip or lid (0.5)", NULL, &w.lips, NULL},
        {"flipped", 0, "SHARE", "bound of turned-over triangles of lips and lids (0.0001)", NULL, &w.flipped,
         NULL},
        {"mirror", 0, "MM", "bound of a mirrored pose's distance from the mirrored skin (0.05)", NULL,
         &w.mirror, NULL},
        {"speed", 0, "MM/S", "bound of the fastest node of a pose that is not at rest in time (0.1)", NULL,
         &w.speed, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_soak, options, argc, argv, &args->head, 1, &count, err);
    if (!r && !cli->done) {
        r = cli_need_head(&cmd_soak, count, err);
    }
    if (!r && !cli->done) {
        r = read_words(&w, args, err);
    }
    if (!r && !cli->done) {
        r = motion_check(&args->motion, err);
    }
    if (!r && motion_file(&args->motion)) {
        args->flipped_share = w.flipped ? args->flipped_share : 0;
        args->speed_mm_s = w.speed ? args->speed_mm_s : -1; /* a face may move */
        if (args->pose) {
            r = ris_fail(err, RIS_ERROR_USAGE, "soak takes --pose or a motion, not both");
        }
    } else if (!r && w.every) {
        r = ris_fail(err, RIS_ERROR_USAGE, "--every is for the frames of a motion");
    }
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    soak run = {0};
    ris_result r = parse(cli, argc, argv, &run.args, err);
    if (r || cli->done) {
        return r;
    }
    r = open_soak(&run, cli, err);
    if (!r) {
        r = run.clip ? soak_motion_measure(&run, cli, err) : measure_all(&run, cli, err);
    }
    if (!r) {
        (cli->json ? soak_print_json : soak_print_text)(&run);
        r = run.interrupted ? interrupt_check(err) : soak_verdict(&run, err);
    }
    close_soak(&run);
    return r;
}

const cli_command cmd_soak = {
    .name = "soak",
    .usage = "HEAD [--poses N | --live-link T | --clip C] [--seed S | --pose P] [--worst K] [--no-single]",
    .summary = "hold random poses and measure what they break",
    .detail =
        "Each pose is held from rest until no vertex is faster than 0.1 mm/s for 0.25 s. Depths in bone, "
        "teeth\n"
        "and eyes are measured by rays and distances on the meshes, beyond what the resting head has; that "
        "is\n"
        "printed besides. The same seed gives the same poses on every machine, and a pose's words can be "
        "given\n"
        "to render --pose. Fails with the first broken bound; one broken by a single channel counts like "
        "any,\n"
        "and a single channel may turn over no triangle of lips and lids. Ctrl-C prints what was measured.\n"
        "With a motion its frames are measured as it moves, every sixtieth of a second; none may turn over "
        "a\n"
        "triangle of lips and lids, and --speed bounds how fast a vertex goes.\n",
    .run = run,
};
