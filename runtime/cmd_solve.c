/* risorius solve HEAD TARGET: the activations whose simulated face comes nearest to vertices or landmarks. */
#include "solve.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_DEFAULT_THREADS 4

static bool has_ending(const char *path, const char *ending)
{
    const size_t length = strlen(path), end = strlen(ending);
    return length > end && strcmp(path + length - end, ending) == 0;
}

/* One line that is redrawn: there is no telling how many iterations it will take. */
typedef struct watch {
    const solve_run *run;
    const char *title;
    bool terminal;
    uint32_t shown; /* iteration + 1 */
} watch;

static bool go_on(void *user, uint32_t iteration, double rms_mm)
{
    watch *w = user;
    if (!w->run->cli->quiet && w->shown != iteration + 1) {
        w->shown = iteration + 1;
        fprintf(stderr, "%s%s: iteration %u, %.4f mm rms%s", w->terminal ? "\r" : "", w->title, iteration + 1,
                rms_mm, w->terminal ? "  " : "\n");
        fflush(stderr);
    }
    return !interrupt_seen();
}

ris_result solve_target(solve_run *run, const char *title, ris_error *err)
{
    watch w = {.run = run, .title = title, .terminal = isatty(STDERR_FILENO) != 0};
    const ris_solve_def def = {.control = run->control,
                               .control_count = run->control_count,
                               .sim = run->sim,
                               .sim_count = run->sim_count,
                               .iteration_limit = run->args.iterations,
                               .enough_mm = run->args.enough_mm,
                               .go_on = go_on,
                               .user = &w};
    ris_result r = ris_solve(&def, &run->target, &run->result, run->found, run->pose, err);
    if (w.shown && w.terminal) {
        fputc('\n', stderr);
    }
    return r;
}

static ris_result open_sims(solve_run *run, ris_error *err)
{
    const bool cpu = backend_is_cpu(run->cli);
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t wanted = cores > MOST_DEFAULT_THREADS ? MOST_DEFAULT_THREADS : cores > 1 ? (uint32_t)cores : 1;
    wanted = run->args.threads ? run->args.threads : wanted;
    ris_result r = backend_start(&run->backend, run->cli, &(backend_need){.sim = true}, err);
    if (!r) {
        run->sim[0] = run->backend.sim;
        run->sim_count = 1;
    }
    while (!r && cpu && run->sim_count < wanted) { /* a device works on many cores by itself */
        r = ris_sim_create_cpu(run->backend.model, &run->sim[run->sim_count], err);
        run->sim_count += !r;
    }
    return r;
}

static ris_result load_target(solve_run *run, ris_error *err)
{
    const solve_args *args = &run->args;
    const ris_model *model = run->backend.model;
    if (!has_ending(args->target, ".obj")) {
        return args->align ? ris_fail(err, RIS_ERROR_USAGE, "--align needs a skin (.obj) as target")
                           : ris_target_load_landmarks(model, args->target, &run->target, err);
    }
    ris_result r = ris_target_load_skin(model, args->target, args->align, &run->target, err);
    return r || !args->landmarks ? r : ris_target_reduce(model, &run->target, err);
}

static void close_run(solve_run *run)
{
    for (uint32_t t = 1; t < run->sim_count; t++) {
        ris_sim_destroy(run->sim[t]);
    }
    ris_target_finish(&run->target);
    free(run->pose);
    backend_close(&run->backend);
    free(run);
}

static ris_result solve(solve_run *run, ris_error *err)
{
    ris_result r = run->args.out ? ris__output_try(run->args.out, err) : RIS_OK;
    if (!r) {
        r = backend_load(&run->backend, run->args.head, err);
    }
    if (!r && !(run->pose = calloc(run->backend.model->channel_count + 1u, sizeof *run->pose))) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    }
    if (!r) {
        r = solve_controls(run, err);
    }
    if (!r && !run->args.self_test) {
        r = load_target(run, err);
    }
    if (!r) {
        r = open_sims(run, err);
    }
    if (!r && run->args.self_test) {
        return solve_self_test(run, err);
    }
    if (!r) {
        r = solve_target(run, "solve", err);
    }
    if (!r) {
        (run->cli->json ? solve_print_json : solve_print_text)(run);
    }
    if (!r && run->args.out) {
        r = solve_write(run, run->args.out, err);
    }
    return r;
}

typedef struct solve_words {
    const char *iterations, *threads, *poses, *first, *seed, *enough, *near;
} solve_words;

static ris_result read_words(const solve_words *words, solve_args *args, ris_error *err)
{
    const struct {
        const char *name, *text;
        uint32_t low, high, *out;
    } count[] = {{"iterations", words->iterations, 1, 10000, &args->iterations},
                 {"threads", words->threads, 1, RIS_SOLVE_SIMS, &args->threads},
                 {"self-test", words->poses, 1, 1000000, &args->poses},
                 {"first", words->first, 0, 1000000, &args->first},
                 {"seed", words->seed, 0, UINT32_MAX, &args->seed}};
    ris_result r = RIS_OK;
    for (size_t k = 0; !r && k < sizeof count / sizeof *count; k++) {
        if (count[k].text) {
            r = cli_count(count[k].name, count[k].text, count[k].low, count[k].high, count[k].out, err);
        }
    }
    if (!r && words->enough) {
        r = cli_number("enough", words->enough, 0, 1000, &args->enough_mm, err);
    }
    if (!r && words->near) {
        r = cli_number("near", words->near, 0, 1000, &args->near_mm, err);
    }
    args->self_test = words->poses != NULL;
    return r;
}

static ris_result check_args(const solve_args *args, uint32_t count, ris_error *err)
{
    if (args->self_test && (count > 1 || args->out || args->landmarks || args->align)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--self-test makes its own targets and writes no file");
    }
    if (!args->self_test && args->first) {
        return ris_fail(err, RIS_ERROR_USAGE, "--first says with which pose --self-test begins");
    }
    if (!args->self_test && count < 2) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "solve needs a target: an OBJ of the skin, or landmarks as JSON or CSV");
    }
    return RIS_OK;
}

static ris_result parse(ris_cli *cli, int argc, char **argv, solve_args *args, ris_error *err)
{
    solve_words w = {0};
    const char *positional[2] = {0};
    *args = (solve_args){.iterations = 30, .enough_mm = 0.002, .near_mm = 0.5, .seed = 1};
    const cli_option options[] = {
        {"output", 'o', "FILE", "write the pose: .json a clip of one key, else words for --pose", NULL,
         &args->out, NULL},
        {"channels", 'c', "LIST",
         "what may act: muscles (with jaw and lips' protrusion; the default), all, au, arkit, or names: "
         "name[,name...], eye.*",
         NULL, &args->channels, NULL},
        {"landmarks", 'l', NULL, "of an OBJ only the head's landmarks count", &args->landmarks, NULL, NULL},
        {"align", 'a', NULL, "take back the rigid motion of the skin on the skull first", &args->align, NULL,
         NULL},
        {"iterations", 'i', "N", "most iterations (30)", NULL, &w.iterations, NULL},
        {"enough", 0, "MM", "rms at which to stop (0.002)", NULL, &w.enough, NULL},
        {"near", 0, "MM", "rms up to which a target counts as reached (0.5)", NULL, &w.near, NULL},
        {"threads", 'j', "N", "simulations at once on the CPU; changes no result (cores, at most 4)", NULL,
         &w.threads, NULL},
        {"self-test", 0, "N", "hold N random poses of 1 to 6 channels and find them again", NULL, &w.poses,
         NULL},
        {"first", 0, "K", "number of the first of them (0)", NULL, &w.first, NULL},
        {"seed", 's', "S", "which random poses (1)", NULL, &w.seed, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_solve, options, argc, argv, positional, 2, &count, err);
    if (!r && !cli->done) {
        r = cli_need_head(&cmd_solve, count, err);
    }
    args->head = positional[0];
    args->target = positional[1];
    if (!r && !cli->done) {
        r = read_words(&w, args, err);
    }
    return r || cli->done ? r : check_args(args, count, err);
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    solve_run *run = calloc(1, sizeof *run);
    if (!run) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the solver");
    }
    run->cli = cli;
    ris_result r = parse(cli, argc, argv, &run->args, err);
    if (!r && !cli->done) {
        r = solve(run, err);
    }
    close_run(run);
    return r;
}

const cli_command cmd_solve = {
    .name = "solve",
    .usage = "HEAD (TARGET [-o FILE] [--channels LIST] | --self-test N [--first K] [--seed S])",
    .summary = "find the pose whose face comes nearest to vertices or landmarks",
    .detail =
        "TARGET is an OBJ with the vertices of skin.obj in their order, as export writes it, or landmarks "
        "with their\n"
        "places: JSON {\"format\": \"risorius-targets\", \"version\": 1, \"points\": {\"ch.L\": [x, y, "
        "z], ...}} or CSV with the\n"
        "header landmark,x_mm,y_mm,z_mm. Steps of bounded least squares on the response of the simulated "
        "face, each\n"
        "held until at rest. Told are the distance that is left, the channels, and which of them the "
        "target does\n"
        "not tell apart. Ctrl-C stops. --self-test fails with the first pose that is not found again.\n",
    .run = run,
};
