/* risorius render HEAD: plays a clip or holds a pose and writes a video, pictures, a vertex cache or a contact sheet. */
#include "base/clock.h"
#include "layers.h"
#include "motion.h"
#include "player.h"
#include "render_out.h"
#include "sheet.h"
#include "risorius/draw.h"
#include "studio.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define POSE_SECONDS 2.0 /* length of a video or cache of a held pose */

typedef struct render_args {
    const char *head, *pose, *at, *size, *fps_text, *view, *contact, *layers, *loops_text;
    motion_words motion;
    cli_list out;
    bool wireframe, labels, no_raster;
} render_args;

/* All a rendering needs; zeroed, then filled by open_render, freed by close_render in any state. */
typedef struct render_job {
    const render_args *args;
    uint32_t width, height, fps; /* size of one view */
    uint32_t loops;              /* rounds of a clip that repeats */
    double at_s;                 /* < 0: the whole clip */
    studio_views views;
    studio_look look;
    render_out out[CLI_LIST_SIZE];
    bool draws;   /* some output is a picture */
    bool settles; /* pictures of a pose that is held until it rests */
    ris_backend backend;
    ris_clip *clip;
    float *pose;
    ris_player player;
    ris_studio *studio;
    ris_sheet sheet;
    uint64_t sim_ns, raster_ns, output_ns; /* spent on ticks, pictures, files */
    clock_t sim_work; /* of the processors, on ticks: on a busy machine the fairer measure */
} render_job;

/* Two outputs of one name would write over each other. */
static ris_result check_names(const render_args *args, ris_error *err)
{
    for (uint32_t i = 0; i < args->out.count; i++) {
        bool twice = args->contact && strcmp(args->contact, args->out.item[i]) == 0;
        for (uint32_t k = 0; k < i; k++) {
            twice = twice || strcmp(args->out.item[i], args->out.item[k]) == 0;
        }
        if (twice) {
            return ris_fail(err, RIS_ERROR_USAGE, "'%s' is named as two outputs", args->out.item[i]);
        }
    }
    return RIS_OK;
}

static ris_result check_outputs(render_job *render, ris_error *err)
{
    const render_args *args = render->args;
    bool moving = false;
    ris_result r = check_names(args, err);
    for (uint32_t i = 0; !r && i < args->out.count; i++) {
        r = render_out_name(&render->out[i], args->out.item[i], err);
        render->draws = render->draws || render_out_draws(&render->out[i]);
        moving = moving || render->out[i].kind != RENDER_PNG;
    }
    if (r) {
        return r;
    }
    bool still = args->out.count > 0 && !moving;
    if (motion_file(&args->motion) && still && !args->at) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "one picture of a clip needs --at SECONDS (or -o DIR/%%04d.png for all)");
    }
    if (args->at && (!motion_file(&args->motion) || !still)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--at is for one picture (-o FILE.png) of a clip");
    }
    if (args->no_raster && render->draws) {
        return ris_fail(err, RIS_ERROR_USAGE, "--no-raster makes no picture: -o OUT.pc2 or nothing");
    }
    for (uint32_t i = 0; moving && i < args->out.count; i++) {
        if (render->out[i].kind == RENDER_PNG) {
            return ris_fail(err, RIS_ERROR_USAGE, "-o: '%s' is one picture, the other outputs are many",
                            render->out[i].path);
        }
    }
    render->settles = args->pose && still;
    return RIS_OK;
}

/* Everything that can be said about the command line before a file is opened. */
static ris_result check_args(render_job *render, ris_error *err)
{
    const render_args *args = render->args;
    if (!motion_file(&args->motion) == !args->pose) {
        return ris_fail(err, RIS_ERROR_USAGE, "render needs --clip C, a performance or --pose P%s",
                        motion_file(&args->motion) ? ", not both" : "");
    }
    if (args->loops_text && !motion_file(&args->motion)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--loops is for a clip");
    }
    ris_result r = motion_check(&args->motion, err);
    if (r) {
        return r;
    }
    if (args->out.count == 0 && !args->contact && !args->no_raster) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "render needs -o OUT.mp4, OUT.png, DIR/%%04d.png or OUT.pc2, or --no-raster");
    }
    if (args->no_raster && (args->contact || args->pose)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--no-raster plays a motion and makes no picture");
    }
    if (args->contact && (!motion_file(&args->motion) || args->at)) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "--contact shows the key poses of a whole clip: it needs --clip, without --at");
    }
    r = cli_size("size", args->size ? args->size : "640x720", &render->width, &render->height, err);
    if (!r) {
        r = cli_count("fps", args->fps_text ? args->fps_text : "60", 1, 240, &render->fps, err);
    }
    if (!r) {
        r = cli_count("loops", args->loops_text ? args->loops_text : "1", 1, 10000, &render->loops, err);
    }
    if (!r) {
        r = studio_views_parse(args->view ? args->view : "front", &render->views, err);
    }
    render->look.wireframe = args->wireframe;
    render->look.labels = args->labels;
    if (!r && args->layers) {
        r = layers_parse(args->layers, &render->look.layers, err);
    }
    if (!r && args->labels && (render->look.layers & ~(uint32_t)RIS_LAYER_SKIN) == 0) {
        r = ris_fail(err, RIS_ERROR_USAGE, "--labels names what --layers shows beside the skin");
    }
    render->at_s = -1;
    if (!r && args->at) {
        r = cli_number("at", args->at, 0, 86400, &render->at_s, err);
    }
    if (!r && (uint64_t)render->width * render->views.count > 16384u) {
        r = ris_fail(err, RIS_ERROR_USAGE, "--size: %u views of %u pixels are wider than 16384",
                     render->views.count, render->width);
    }
    if (!r) {
        r = check_outputs(render, err);
    }
    return r;
}

static double clip_seconds(const render_job *render)
{
    return ris_clip_duration_s(render->clip) * render->loops;
}

static ris_result check_clip(const render_job *render, ris_error *err)
{
    double seconds = clip_seconds(render);
    if (render->args->loops_text && !ris_clip_repeats(render->clip)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--loops: '%s' does not repeat (\"loop\": true)",
                        motion_file(&render->args->motion));
    }
    if (render->at_s > seconds) {
        return ris_fail(err, RIS_ERROR_USAGE, "--at: the clip ends at %g s", seconds);
    }
    if (seconds * render->fps > 1e6) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "a clip of %g s at %u frames a second is more than a million frames", seconds,
                        render->fps);
    }
    return RIS_OK;
}

static ris_result open_motion(render_job *render, const ris_cli *cli, ris_error *err)
{
    const render_args *args = render->args;
    const ris_model *model = render->backend.model;
    render->pose = calloc(model->channel_count + 1u, sizeof *render->pose);
    if (!render->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    }
    ris_result r = motion_file(&args->motion) ? motion_load(&args->motion, cli, model, &render->clip, err)
                                              : ris_pose_parse(model, args->pose, render->pose, err);
    if (!r && render->clip) {
        r = check_clip(render, err);
    }
    if (!r) {
        motion_start(&args->motion, render->backend.sim);
        r = player_init(&render->player, render->backend.sim, render->clip, render->pose, err);
    }
    return r;
}

static ris_result open_render(render_job *render, const ris_cli *cli, ris_error *err)
{
    const render_args *args = render->args;
    bool draws = render->draws || args->contact;
    ris_result r =
        backend_open(&render->backend, cli, args->head, &(backend_need){.sim = true, .draw = draws}, err);
    if (!r) {
        r = open_motion(render, cli, err);
    }
    if (!r && !cli->quiet && !cli->json) {
        fprintf(stderr, "device: %s\n", ris_sim_backend(render->backend.sim));
    }
    if (!r && render->draws) {
        r = studio_create(&render->backend, &render->views, render->width, render->height, &render->look,
                          &render->studio, err);
    }
    if (!r && args->contact) {
        r = sheet_init(&render->sheet, args->contact, &render->backend, render->clip, &render->look, err);
    }
    for (uint32_t i = 0; !r && i < args->out.count; i++) {
        r = render_out_open(&render->out[i], render->width * render->views.count, render->height, render->fps,
                            render->backend.model->node_count, err);
    }
    return r;
}

static void close_render(render_job *render)
{
    for (uint32_t i = 0; i < render->args->out.count; i++) {
        render_out_abandon(&render->out[i]);
    }
    sheet_finish(&render->sheet);
    studio_destroy(render->studio);
    player_finish(&render->player);
    ris_clip_destroy(render->clip);
    free(render->pose);
    backend_close(&render->backend);
}

/* Adds the time since *start to sum and starts anew. */
static void count_time(uint64_t *start, uint64_t *sum)
{
    const uint64_t now = ris__clock_ns();
    *sum += now - *start;
    *start = now;
}

/* Looks at time_s and gives the frame to every output. */
static ris_result put_frame(render_job *render, double time_s, ris_error *err)
{
    const ris_vec4 *position = NULL, *normal = NULL;
    const uint8_t *rgba = NULL;
    const bool looks = render->args->out.count > 0;
    ris_result r = RIS_OK;
    uint64_t start = ris__clock_ns();
    const clock_t work = clock();
    if (!render->settles) {
        r = player_advance(&render->player, time_s, err);
        if (!r && looks) {
            r = player_look(&render->player, time_s, &position, &normal, err);
        }
    }
    count_time(&start, &render->sim_ns);
    render->sim_work += clock() - work;
    if (!r && render->studio) {
        r = studio_shoot(render->studio, render->backend.sim, position, normal, &rgba, err);
    }
    count_time(&start, &render->raster_ns);
    for (uint32_t i = 0; !r && i < render->args->out.count; i++) {
        r = render_out_frame(&render->out[i], rgba, position, err);
    }
    count_time(&start, &render->output_ns);
    return r;
}

static uint32_t frame_count(const render_job *render)
{
    if (render->settles || render->at_s >= 0) {
        return 1;
    }
    double duration_s = render->clip ? clip_seconds(render) : POSE_SECONDS;
    double frames = floor(duration_s * render->fps + 0.5);
    return frames < 1 ? 1 : (uint32_t)frames;
}

static ris_result run_frames(render_job *render, const ris_cli *cli, uint32_t *out_frames, ris_error *err)
{
    uint32_t count = frame_count(render);
    ris_progress bar;
    progress_start(&bar, cli, "render");
    ris_result r = RIS_OK;
    if (render->settles) {
        r = ris_sim_settle(render->backend.sim, render->pose, NULL, err);
    }
    for (uint32_t i = 0; !r && i < count; i++) {
        double time_s = render->at_s >= 0 ? render->at_s : (double)i / render->fps;
        progress_show(&bar, i, count);
        if (render->args->contact) {
            r = sheet_take(&render->sheet, &render->player, time_s, err);
        }
        if (!r && (render->args->out.count > 0 || render->args->no_raster)) {
            r = put_frame(render, time_s, err);
        }
        if (!r) {
            r = interrupt_check(err);
        }
    }
    if (!r && render->args->contact) {
        r = sheet_take(&render->sheet, &render->player, ris_clip_duration_s(render->clip), err);
    }
    if (!r) {
        progress_show(&bar, count, count);
    }
    progress_end(&bar);
    *out_frames = count;
    return r;
}

static ris_result finish_outputs(render_job *render, ris_error *err)
{
    ris_result r = RIS_OK;
    if (render->args->contact) {
        r = sheet_write(&render->sheet, err);
    }
    for (uint32_t i = 0; !r && i < render->args->out.count; i++) {
        r = render_out_close(&render->out[i], err);
    }
    return r;
}

/* Simulated seconds a second, without pictures and with them; nothing for a pose. */
static void report_speed(const render_job *render, bool json)
{
    const double played_s = (double)render->player.tick * RIS_TICK_S, sim_s = (double)render->sim_ns * 1e-9;
    const double raster_s = (double)render->raster_ns * 1e-9, output_s = (double)render->output_ns * 1e-9;
    const double work_s = (double)render->sim_work / CLOCKS_PER_SEC, all_s = sim_s + raster_s + output_s;
    if (render->settles || render->player.tick == 0 || !(sim_s > 0)) {
        return;
    }
    if (json) {
        printf(", \"simulated_s\": %.3f, \"simulation_s\": %.3f, \"simulation_processor_s\": %.3f, "
               "\"raster_s\": %.3f, \"output_s\": %.3f, \"real_time_factor\": %.3f, "
               "\"real_time_factor_with_output\": %.3f",
               played_s, sim_s, work_s, raster_s, output_s, played_s / sim_s, played_s / all_s);
        return;
    }
    fprintf(stderr, "%.2f s simulated in %.2f s: %.2f times real time (%.2f s of all processors)", played_s,
            sim_s, played_s / sim_s, work_s);
    if (render->args->out.count > 0) {
        fprintf(stderr, "; with pictures (%.2f s) and files (%.2f s) %.2f times", raster_s, output_s,
                played_s / all_s);
    }
    fprintf(stderr, "\n");
}

static void report(const render_job *render, const ris_cli *cli, uint32_t frames, double seconds)
{
    const cli_list *out = &render->args->out;
    if (cli->json) {
        printf("{\"device\": ");
        cli_json_string(stdout, ris_sim_backend(render->backend.sim));
        printf(", \"frames\": %u, \"seconds\": %.3f, \"outputs\": [", frames, seconds);
        for (uint32_t i = 0; i < out->count; i++) {
            printf("%s", i ? ", " : "");
            cli_json_string(stdout, out->item[i]);
        }
        if (render->args->contact) {
            printf("%s", out->count ? ", " : "");
            cli_json_string(stdout, render->args->contact);
        }
        printf("]");
        report_speed(render, true);
        printf("}\n");
    } else if (!cli->quiet) {
        for (uint32_t i = 0; i < out->count; i++) {
            fprintf(stderr, "wrote %s (%u frame%s)\n", out->item[i], frames, frames == 1 ? "" : "s");
        }
        if (render->args->contact) {
            fprintf(stderr, "wrote %s (%u key poses)\n", render->args->contact, render->sheet.pose_count);
        }
        report_speed(render, false);
        fprintf(stderr, "%.1f s\n", seconds);
    }
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    render_args args = {0};
    const cli_option options[] = {
        MOTION_OPTIONS(&args.motion),
        {"pose", 'p', "POSE", "the pose to hold: name=value[,name=value...]", NULL, &args.pose, NULL},
        {"output", 'o', "FILE", "OUT.mp4, OUT.png, DIR/%04d.png or OUT.pc2; may be repeated", NULL, NULL,
         &args.out},
        {"contact", 0, "FILE.png", "a labelled sheet of the clip's key poses", NULL, &args.contact, NULL},
        {"at", 't', "SECONDS", "the moment of one picture of a clip", NULL, &args.at, NULL},
        {"no-raster", 0, NULL, "play without pictures and tell the speed", &args.no_raster, NULL, NULL},
        {"size", 's', "WxH", "size of one view in pixels (640x720)", NULL, &args.size, NULL},
        {"fps", 0, "N", "frames a second (60); the simulation ticks at 60 whatever it is", NULL,
         &args.fps_text, NULL},
        {"loops", 0, "N", "rounds of a clip that repeats (1)", NULL, &args.loops_text, NULL},
        {"view", 0, "LIST", "front, 34, profile, 34.R, profile.R; several stand side by side (front)", NULL,
         &args.view, NULL},
        {"layers", 0, "LIST", LAYER_NAMES " (skin)", NULL, &args.layers, NULL},
        {"labels", 0, NULL, "names and colour scales of the layers", &args.labels, NULL, NULL},
        {"wireframe", 'w', NULL, "draw edges", &args.wireframe, NULL, NULL},
        {0},
    };
    uint32_t count, frames;
    ris_result r = cli_parse(cli, &cmd_render, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_render, count, err);
    if (r) {
        return r;
    }
    render_job render = {.args = &args};
    uint64_t start = ris__clock_ns();
    r = check_args(&render, err);
    if (!r) {
        r = open_render(&render, cli, err);
    }
    if (!r) {
        r = run_frames(&render, cli, &frames, err);
    }
    if (!r) {
        r = finish_outputs(&render, err);
    }
    if (!r) {
        report(&render, cli, frames, ris__clock_ms(start, ris__clock_ns()) / 1000.0);
    }
    close_render(&render);
    return r;
}

const cli_command cmd_render = {
    .name = "render",
    .usage =
        "HEAD (--clip C | --live-link T | --openface T | --pose P) -o OUT.mp4|OUT.png|DIR/%04d.png|OUT.pc2",
    .summary = "play a clip or hold a pose into a video, pictures, a vertex cache or a contact sheet",
    .detail = "A held pose gives one picture at rest, or two seconds of motion into it as video or cache.\n"
              "With --device cpu the simulation runs on the CPU; pictures still need a Vulkan device.\n",
    .run = run,
};
