/* risorius bench [HEAD]: what a simulated sixtieth of a second costs, stage by stage. The result is checked first. */
#include "backend.h"
#include "base/clock.h"
#include "motion.h"
#include "player.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef RISORIUS_VULKAN
#include "risorius/device.h"
#endif

#define SAMPLES_MAX 10000000u /* frames x repeats */
#define TOLERANCE_MM 1e-2     /* of a device that is not bit-identical, as `compare` allows over a clip */
#define COLUMNS (RIS_STAGE_COUNT + 4)

typedef struct bench_args {
    const char *head, *repeat_text;
    motion_words motion;
    uint32_t repeats;
    bool csv;
} bench_args;

typedef struct bench_run {
    ris_backend backend;
    ris_sim *reference;
    ris_clip *clip; /* NULL: the built-in excitation */
    char clip_path[4096];
    uint32_t ticks, sample_count, sample_capacity;
    double *sample[COLUMNS]; /* ms of each tick (sample_capacity): muscle, upload, stages, wait, frame */
    uint64_t hash, reference_hash;
    double difference_mm;
} bench_run;

static const char *column_name(uint32_t column)
{
    return column == 0                     ? "muscle"
           : column == 1                   ? "upload"
           : column < 2 + RIS_STAGE_COUNT  ? ris_stage_name((ris_stage)(column - 2))
           : column == 2 + RIS_STAGE_COUNT ? "wait"
                                           : "frame";
}

/* Every muscle rises and falls in turn: a triangle wave of two seconds, shifted from channel to channel. */
static void excite(const ris_model *model, uint32_t tick, float *pose)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        uint32_t phase = (tick + i * 17u) % 120u;
        float wave = (float)(phase < 60u ? phase : 120u - phase) / 60.0f;
        pose[i] = i < model->muscle_count ? wave * model->channel[i].maximum : 0.0f;
    }
}

/* One tick of the clip or of the excitation. */
static ris_result tick(const bench_run *bench, ris_sim *sim, uint32_t index, float *pose, ris_error *err)
{
    if (bench->clip) {
        ris_clip_sample(bench->clip, (double)(index + 1) * RIS_TICK_S, pose);
    } else {
        excite(ris_sim_get_model(sim), index + 1, pose);
    }
    return ris_sim_tick(sim, pose, err);
}

static void take_sample(bench_run *bench, double frame_ms)
{
    const ris_sim_times *times = ris_sim_get_times(bench->backend.sim);
    uint32_t at = bench->sample_count++;
    bench->sample[0][at] = times->muscle_ms;
    bench->sample[1][at] = times->upload_ms;
    for (uint32_t s = 0; s < RIS_STAGE_COUNT; s++) {
        bench->sample[2 + s][at] = times->stage_ms[s];
    }
    bench->sample[2 + RIS_STAGE_COUNT][at] = times->wait_ms;
    bench->sample[3 + RIS_STAGE_COUNT][at] = frame_ms;
}

/* The whole clip from rest; with samples when measured. */
static ris_result run_once(bench_run *bench, ris_sim *sim, bool measured, uint64_t *out_hash, ris_error *err)
{
    float *pose = calloc(ris_sim_get_model(sim)->channel_count + 1u, sizeof *pose);
    ris_result r =
        pose ? ris_sim_reset(sim, err) : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    for (uint32_t i = 0; !r && i < bench->ticks; i++) {
        uint64_t start = ris__clock_ns();
        r = tick(bench, sim, i, pose, err);
        if (!r && measured) {
            take_sample(bench, ris__clock_ms(start, ris__clock_ns()));
        }
        if (!r) {
            r = interrupt_check(err);
        }
    }
    free(pose);
    return r ? r : ris_sim_hash(sim, out_hash, err);
}

/* Largest distance between the two simulations' nodes now. */
static ris_result measure_difference(bench_run *bench, ris_error *err)
{
    uint32_t count = bench->backend.model->node_count;
    ris_vec4 *a = calloc(count, sizeof *a), *b = calloc(count, sizeof *b);
    ris_result r = a && b ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", count);
    if (!r) {
        r = ris_sim_read(bench->backend.sim, RIS_STATE_POSITION, a, err);
    }
    if (!r) {
        r = ris_sim_read(bench->reference, RIS_STATE_POSITION, b, err);
    }
    bench->difference_mm = 0;
    for (uint32_t i = 0; !r && i < count; i++) {
        double x = (double)a[i].x - b[i].x, y = (double)a[i].y - b[i].y, z = (double)a[i].z - b[i].z;
        double d = sqrt(x * x + y * y + z * z);
        bench->difference_mm = d > bench->difference_mm ? d : bench->difference_mm;
    }
    free(a);
    free(b);
    return r;
}

static bool needs_equal_bits(const bench_run *bench)
{
#ifdef RISORIUS_VULKAN
    if (bench->backend.device) {
        return strcmp(ris_device_get_info(bench->backend.device)->type, "cpu") == 0;
    }
#endif
    (void)bench;
    return true;
}

/* The result counts before the time: every repeat must end where the CPU reference ends. */
static ris_result check_result(bench_run *bench, ris_error *err)
{
    ris_result r = measure_difference(bench, err);
    if (!r && bench->hash != bench->reference_hash &&
        (needs_equal_bits(bench) || !(bench->difference_mm <= TOLERANCE_MM))) {
        r = ris_fail(err, RIS_ERROR_FAILED,
                     "the result is wrong, so its times mean nothing: %s ends at %016llx, the CPU reference "
                     "at %016llx, "
                     "%.3g mm apart",
                     ris_sim_backend(bench->backend.sim), (unsigned long long)bench->hash,
                     (unsigned long long)bench->reference_hash, bench->difference_mm);
    }
    return r;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_times(bench_run *bench, const ris_cli *cli, const bench_args *args)
{
    const char *format = cli->json   ? "%s\n    {\"stage\": \"%s\", \"min_ms\": %.4f, \"median_ms\": %.4f}"
                         : args->csv ? "%s%s,%.4f,%.4f\n"
                                     : "%s  %-14s %9.4f %9.4f\n";
    if (cli->json) {
        printf("  \"stages\": [");
    } else {
        printf(args->csv ? "stage,min_ms,median_ms\n"
                         : "  stage             min ms median ms   per frame of 1/60 s\n");
    }
    for (uint32_t c = 0; c < COLUMNS; c++) {
        double *sample = bench->sample[c];
        qsort(sample, bench->sample_count, sizeof *sample, compare_doubles);
        printf(format, cli->json && c ? "," : "", column_name(c), sample[0], sample[bench->sample_count / 2]);
    }
    const ris_model *model = bench->backend.model;
    const double *frame = bench->sample[COLUMNS - 1];
    double median = frame[bench->sample_count / 2];
    if (cli->json) {
        printf("\n  ],\n  \"model_bake_ms\": %.3f,\n  \"muscle_bake_ms\": %.3f,\n", model->bake_ms,
               model->muscle_bake_ms);
        printf("  \"real_time_factor\": %.3f\n}\n", 1000.0 * RIS_TICK_S / median);
    } else if (args->csv) {
        printf("model_bake,%.4f,%.4f\nmuscle_bake,%.4f,%.4f\n", model->bake_ms, model->bake_ms,
               model->muscle_bake_ms, model->muscle_bake_ms);
        printf("real_time_factor,%.3f,%.3f\n", 1000.0 * RIS_TICK_S / frame[0], 1000.0 * RIS_TICK_S / median);
    } else {
        printf("  once, at loading: model bake %.1f ms, of which muscle bake %.1f ms (%u muscles, grids to "
               "bindings)\n",
               model->bake_ms, model->muscle_bake_ms, model->muscle_count);
        printf("  real-time factor at 60 frames a second: %.2f (median), %.2f (best)\n",
               1000.0 * RIS_TICK_S / median, 1000.0 * RIS_TICK_S / frame[0]);
    }
}

static void print_result(bench_run *bench, const ris_cli *cli, const bench_args *args)
{
    const ris_model *model = bench->backend.model;
    const char *head = args->head ? args->head : "built-in scene";
    const char *clip = bench->clip ? bench->clip_path : "built-in excitation";
    const char *threads = getenv("LP_NUM_THREADS");
    if (cli->json) {
        printf("{\n  \"head\": ");
        cli_json_string(stdout, head);
        printf(",\n  \"clip\": ");
        cli_json_string(stdout, clip);
        printf(",\n  \"device\": ");
        cli_json_string(stdout, ris_sim_backend(bench->backend.sim));
        printf(",\n  \"moving_nodes\": %u,\n  \"springs\": %u,\n  \"substeps\": %u,\n  \"ticks\": %u,\n  "
               "\"repeats\": %u,\n",
               model->moving_count, model->spring_count, model->head->tissue.substeps, bench->ticks,
               args->repeats);
        printf("  \"hash\": \"%016llx\",\n  \"reference_hash\": \"%016llx\",\n  \"difference_mm\": %.9g,\n",
               (unsigned long long)bench->hash, (unsigned long long)bench->reference_hash,
               bench->difference_mm);
    } else {
        const char *start = args->csv ? "# " : "";
        printf("%s%s, %s: %u moving nodes, %u springs, %u substeps a frame, %u frames x %u repeats\n", start,
               head, clip, model->moving_count, model->spring_count, model->head->tissue.substeps,
               bench->ticks, args->repeats);
        printf("%sdevice %s%s%s\n", start, ris_sim_backend(bench->backend.sim),
               threads ? ", LP_NUM_THREADS=" : "", threads ? threads : "");
        printf("%shash %016llx, CPU reference %016llx: %s\n", start, (unsigned long long)bench->hash,
               (unsigned long long)bench->reference_hash,
               bench->hash == bench->reference_hash ? "equal" : "within 0.01 mm");
    }
    print_times(bench, cli, args);
}

/* clips/first_light.json beside the head folder; "" if there is none. */
static void find_clip(const char *head, char *out, size_t size)
{
    size_t length = head ? strlen(head) : 0;
    while (length > 0 && head[length - 1] == '/') {
        length--;
    }
    size_t parent = length;
    while (parent > 0 && head[parent - 1] != '/') {
        parent--;
    }
    bool named = length > parent && head[length - 1] != '.'; /* not "." or ".." */
    int written = snprintf(out, size, "%.*s%sclips/first_light.json", (int)(named ? parent : length),
                           head ? head : "", named ? "" : "/../");
    if (!head || written < 0 || (size_t)written >= size || access(out, R_OK) != 0) {
        out[0] = '\0';
    }
}

/* The clip given, else clips/first_light.json beside the head, else none. */
static ris_result open_clip(bench_run *bench, const ris_cli *cli, const bench_args *args, ris_error *err)
{
    const char *file = motion_file(&args->motion);
    ris_result r = RIS_OK;
    bench->ticks = 330;
    if (file) {
        snprintf(bench->clip_path, sizeof bench->clip_path, "%s", file);
        r = motion_load(&args->motion, cli, bench->backend.model, &bench->clip, err);
    } else {
        find_clip(args->head, bench->clip_path, sizeof bench->clip_path);
        if (bench->clip_path[0] != '\0') {
            r = ris_clip_load(bench->backend.model, bench->clip_path, &bench->clip, err);
        }
    }
    if (!r && bench->clip) {
        bench->ticks = (uint32_t)player_tick_at(ris_clip_duration_s(bench->clip));
    }
    return r;
}

static ris_result open_bench(bench_run *bench, const ris_cli *cli, const bench_args *args, ris_error *err)
{
    ris_scene_def scene = ris_default_scene_def();
    ris_result r = args->head ? backend_load(&bench->backend, args->head, err)
                              : ris_scene_model(&scene, &bench->backend.model, err);
    if (!r) {
        r = open_clip(bench, cli, args, err);
    }
    if (!r && (uint64_t)bench->ticks * args->repeats > SAMPLES_MAX) {
        r = ris_fail(err, RIS_ERROR_USAGE, "--repeat: %u frames x %u repeats are more than %u", bench->ticks,
                     args->repeats, SAMPLES_MAX);
    }
    if (!r) {
        r = backend_start(&bench->backend, cli, &(backend_need){.sim = true}, err);
    }
    if (!r) {
        r = ris_sim_create_cpu(bench->backend.model, &bench->reference, err);
    }
    if (!r) {
        motion_start(&args->motion, bench->backend.sim);
        motion_start(&args->motion, bench->reference);
    }
    bench->sample_capacity = r ? 0 : bench->ticks * args->repeats;
    for (uint32_t c = 0; !r && c < COLUMNS; c++) {
        bench->sample[c] = calloc(bench->sample_capacity + 1u, sizeof **bench->sample);
        r = bench->sample[c] ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the samples");
    }
    return r;
}

static void close_bench(bench_run *bench)
{
    for (uint32_t c = 0; c < COLUMNS; c++) {
        free(bench->sample[c]);
    }
    ris_clip_destroy(bench->clip);
    ris_sim_destroy(bench->reference);
    backend_close(&bench->backend);
}

static ris_result measure(bench_run *bench, const ris_cli *cli, const bench_args *args, ris_error *err)
{
    ris_progress bar;
    progress_start(&bar, cli, "bench");
    ris_result r = run_once(bench, bench->reference, false, &bench->reference_hash, err);
    for (uint32_t i = 0; !r && i <= args->repeats; i++) {
        progress_show(&bar, i, args->repeats + 1u);
        r = run_once(bench, bench->backend.sim, i > 0, &bench->hash, err); /* the first run warms up */
        if (!r) {
            r = check_result(bench, err);
        }
    }
    if (!r) {
        progress_show(&bar, args->repeats + 1u, args->repeats + 1u);
    }
    progress_end(&bar);
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    bench_args args = {.repeats = 5};
    const cli_option options[] = {
        MOTION_OPTIONS(&args.motion),
        {"repeat", 'n', "N", "measured repeats after one to warm up (5)", NULL, &args.repeat_text, NULL},
        {"csv", 0, NULL, "print the times as CSV", &args.csv, NULL, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_bench, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    if (args.repeat_text) {
        r = cli_count("repeat", args.repeat_text, 1, 1000, &args.repeats, err);
    }
    if (!r) {
        r = motion_check(&args.motion, err);
    }
    if (!r && motion_file(&args.motion) && !args.head) {
        r = ris_fail(err, RIS_ERROR_USAGE, "bench --clip needs a head");
    }
    if (r) {
        return r;
    }
    bench_run bench = {0};
    r = open_bench(&bench, cli, &args, err);
    if (!r) {
        r = measure(&bench, cli, &args, err);
    }
    if (!r) {
        print_result(&bench, cli, &args);
    }
    close_bench(&bench);
    return r;
}

const cli_command cmd_bench = {
    .name = "bench",
    .usage = "[HEAD] [--clip C] [--repeat N] [--csv]",
    .summary = "measure the cost of a frame, stage by stage, after checking the result",
    .detail =
        "Without a motion it runs HEAD/../clips/first_light.json, or an excitation of all muscles.\n"
        "Rows: muscle (host stages), upload, the device stages by GPU timestamps (all substeps of a frame), "
        "wait\n"
        "(record, submit and fence wait; contains the device stages), frame (everything, by the clock).\n",
    .run = run,
};
