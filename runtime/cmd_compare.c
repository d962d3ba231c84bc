/* risorius compare HEAD --clip C: the same clip on a Vulkan device and on the CPU reference, stage by stage. */
#include "sim/compare.h"
#include "backend.h"
#include "motion.h"
#include "player.h"

#include <string.h>

typedef struct compare_args {
    const char *head, *tolerance_text;
    motion_words motion;
    double tolerance_mm; /* < 0: the default of the device */
} compare_args;

typedef struct compare_run {
    const ris_clip *clip;
    ris_progress bar;
} compare_run;

static void sample_pose(void *user, uint32_t tick, float *out_pose)
{
    ris_clip_sample(((compare_run *)user)->clip, (double)tick * RIS_TICK_S, out_pose);
}

static void show_progress(void *user, uint32_t done, uint32_t total)
{
    progress_show(&((compare_run *)user)->bar, done, total);
}

static void print_stage_line(const char *name, const ris_compare_stage *step, const ris_compare_stage *clip)
{
    printf("  %-14s %12.3g %12.3g %10llu   %12.3g %12.3g %10llu\n", name, step->max_mm, step->rms_mm,
           (unsigned long long)step->differing_words, clip->max_mm, clip->rms_mm,
           (unsigned long long)clip->differing_words);
}

static uint64_t differing_words(const ris_compare_report *report)
{
    uint64_t words = 0;
    for (int s = 0; s < RIS_STAGE_COUNT; s++) {
        words += report->clip[s].differing_words;
    }
    return words;
}

static void print_text(const ris_compare_report *report, bool over)
{
    printf("A  %s\nB  %s\n", report->backend[0], report->backend[1]);
    printf("%u nodes, %u simulated, %u moved by 2 mm or more; %u frames of %u substeps\n\n",
           report->node_count, report->moving_count, report->moved_count, report->tick_count,
           report->substeps);
    printf("                        after one step, from equal states              over the whole clip\n");
    printf("  stage                max mm       rms mm      words         max mm       rms mm      words\n");
    for (int s = 0; s < RIS_STAGE_COUNT; s++) {
        print_stage_line(ris_stage_name((ris_stage)s), &report->step[s], &report->clip[s]);
    }
    printf("\nhash A %016llx\nhash B %016llx\n", (unsigned long long)report->hash[0],
           (unsigned long long)report->hash[1]);
    if (report->differs) {
        printf("first %s: stage %s, frame %u, substep %u, vertex %u\n",
               over ? "over tolerance" : "difference", ris_stage_name(report->first_stage),
               report->first_tick, report->first_substep, report->first_vertex);
        printf("GPU and CPU differ: %llu words over the clip, %llu of %u frames\n",
               (unsigned long long)differing_words(report), (unsigned long long)report->differing_ticks,
               report->tick_count);
    } else {
        printf("GPU and CPU are equal: 0 differing bits over %u frames\n", report->tick_count);
    }
}

static void print_json_stages(const char *name, const ris_compare_stage *stage)
{
    printf("  \"%s\": {", name);
    for (int s = 0; s < RIS_STAGE_COUNT; s++) {
        printf("%s\n    \"%s\": {\"max_mm\": %.9g, \"rms_mm\": %.9g, \"differing_words\": %llu}",
               s ? "," : "", ris_stage_name((ris_stage)s), stage[s].max_mm, stage[s].rms_mm,
               (unsigned long long)stage[s].differing_words);
    }
    printf("\n  },\n");
}

static void print_json(const ris_compare_report *report, bool over)
{
    printf("{\n  \"backends\": [");
    cli_json_string(stdout, report->backend[0]);
    printf(", ");
    cli_json_string(stdout, report->backend[1]);
    printf("],\n  \"nodes\": %u,\n  \"moving_nodes\": %u,\n  \"moved_nodes\": %u,\n  \"frames\": %u,\n  "
           "\"substeps\": %u,\n",
           report->node_count, report->moving_count, report->moved_count, report->tick_count,
           report->substeps);
    print_json_stages("step", report->step);
    print_json_stages("clip", report->clip);
    printf("  \"hash\": [\"%016llx\", \"%016llx\"],\n  \"differing_frames\": %llu,\n",
           (unsigned long long)report->hash[0], (unsigned long long)report->hash[1],
           (unsigned long long)report->differing_ticks);
    if (report->differs) {
        printf("  \"%s\": {\"stage\": \"%s\", \"frame\": %u, \"substep\": %u, \"vertex\": %u},\n",
               over ? "first_over_tolerance" : "first_difference", ris_stage_name(report->first_stage),
               report->first_tick, report->first_substep, report->first_vertex);
    }
    printf("  \"equal\": %s\n}\n", report->differs ? "false" : "true");
}

static ris_result compare(const ris_cli *cli, const compare_args *args, ris_backend *backend,
                          ris_sim *reference, ris_error *err)
{
    ris_clip *clip = NULL;
    ris_result r = motion_load(&args->motion, cli, backend->model, &clip, err);
    if (r) {
        return r;
    }
    motion_start(&args->motion, reference);
    motion_start(&args->motion, backend->sim);
    compare_run user = {.clip = clip};
    ris_compare_report report = {0};
    ris_compare_def def = ris_default_compare_def(reference, backend->sim);
    def.tick_count = (uint32_t)player_tick_at(ris_clip_duration_s(clip));
    def.pose = sample_pose;
    def.progress = show_progress;
    def.user = &user;
    if (args->tolerance_mm >= 0) {
        def.step_tolerance_mm = def.clip_tolerance_mm = (float)args->tolerance_mm;
    }
    progress_start(&user.bar, cli, "compare");
    r = ris_compare_run(&def, &report, err);
    progress_end(&user.bar);
    if (!r || report.differs) {
        (cli->json ? print_json : print_text)(&report, r != RIS_OK);
    }
    ris_clip_destroy(clip);
    return r;
}

static ris_result check_args(const ris_cli *cli, compare_args *args, ris_error *err)
{
    args->tolerance_mm = -1;
    ris_result r = motion_check(&args->motion, err);
    if (r) {
        return r;
    }
    if (!motion_file(&args->motion)) {
        return ris_fail(err, RIS_ERROR_USAGE, "compare needs --clip C, --live-link T or --openface T");
    }
    if (backend_is_cpu(cli)) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "compare sets a Vulkan device against the CPU reference; the CPU against "
                        "itself would prove nothing");
    }
    return args->tolerance_text
               ? cli_number("tolerance", args->tolerance_text, 0, 1000, &args->tolerance_mm, err)
               : RIS_OK;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    compare_args args = {0};
    const cli_option options[] = {
        MOTION_OPTIONS(&args.motion),
        {"tolerance", 0, "MM",
         "allowed difference; without it 0 bits on lavapipe, else 1e-4 mm a step and 1e-2 mm over the clip",
         NULL, &args.tolerance_text, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_compare, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_compare, count, err);
    if (!r) {
        r = check_args(cli, &args, err);
    }
    if (r) {
        return r;
    }
    ris_backend backend;
    ris_sim *reference = NULL;
    r = backend_open(&backend, cli, args.head, &(backend_need){.sim = true}, err);
    if (!r) {
        r = ris_sim_create_cpu(backend.model, &reference, err);
    }
    if (!r) {
        r = compare(cli, &args, &backend, reference, err);
    }
    ris_sim_destroy(reference);
    backend_close(&backend);
    return r;
}

const cli_command cmd_compare = {
    .name = "compare",
    .usage = "HEAD (--clip C | --live-link T | --openface T) [--tolerance MM]",
    .summary = "run a clip on a Vulkan device and on the CPU reference and compare every stage",
    .detail =
        "Exit code 1 names the stage, frame, substep and vertex over tolerance. Words are 32-bit numbers "
        "that differ\n"
        "in any bit. A clip that moves fewer than 500 nodes by 2 mm is refused: it would prove too little.\n",
    .run = run,
};
