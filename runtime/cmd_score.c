/* risorius score HEAD --reference DIR: held poses against sculpted expressions of the same base mesh. */
#include "asset/score_list.h"
#include "asset/target.h"
#include "backend.h"
#include "base/file.h"
#include "base/text.h"
#include "measure/score.h"
#include "risorius/timeline.h"

#include <stdlib.h>
#include <string.h>

/* What the reference head must hold. */
#define MEAN_COS 0.80
#define LEAST_COS 0.55
#define LEAST_GAIN 0.7
#define MOST_GAIN 1.4
#define MOST_FAR 0.2

typedef struct score_args {
    const char *head, *reference, *recipes, *pose;
    cli_list unit;
} score_args;

typedef struct score_row {
    const ris_score_unit *unit;
    bool measured, counts;
    ris_score score;
    char broken[160]; /* its first broken bound, or "" */
} score_row;

typedef struct score_run {
    score_args args;
    ris_backend backend;
    ris_score_list list;
    ris_reference reference;
    ris_scorer scorer;
    double *sculpt;     /* (base_count x 3) */
    ris_vec4 *position; /* (node_count) */
    float *pose;        /* (channel_count) */
    score_row *row;     /* (row_count) */
    uint32_t row_count, counted, broken;
    double mean_cos;
} score_run;

static bool is_wanted(const score_run *run, const char *unit)
{
    for (uint32_t k = 0; k < run->args.unit.count; k++) {
        if (strcmp(run->args.unit.item[k], unit) == 0) {
            return true;
        }
    }
    return run->args.unit.count == 0;
}

/* The rows of the list that are asked for; RIS_ERROR_USAGE for a unit that is not in it. */
static ris_result choose_rows(score_run *run, ris_error *err)
{
    for (uint32_t k = 0; k < run->args.unit.count; k++) {
        const char *wanted = run->args.unit.item[k];
        char names[256];
        ris_nearest nearest;
        bool found = false;
        ris__nearest_init(&nearest, wanted);
        for (uint32_t i = 0; i < run->list.count; i++) {
            found = found || strcmp(run->list.unit[i].unit, wanted) == 0;
            ris__nearest_add(&nearest, run->list.unit[i].unit);
        }
        if (!found) {
            return ris_fail(err, RIS_ERROR_USAGE, "--unit: unknown unit '%.64s'; nearest: %s", wanted,
                            ris__nearest_text(&nearest, names, sizeof names));
        }
    }
    for (uint32_t i = 0; i < run->list.count; i++) {
        if (is_wanted(run, run->list.unit[i].unit)) {
            run->row[run->row_count++].unit = &run->list.unit[i];
        }
    }
    return RIS_OK;
}

static ris_result open_run(score_run *run, const ris_cli *cli, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    ris_result r = run->args.recipes ? RIS_OK : ris__path_join(path, run->args.head, "score.json", err);
    if (!r) {
        r = ris__score_list_load(run->args.recipes ? run->args.recipes : path, &run->list, err);
    }
    if (!r) {
        run->row = calloc(run->list.count, sizeof *run->row);
        r = run->row ? choose_rows(run, err) : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the units");
    }
    if (!r) {
        r = ris__reference_load(run->args.reference, &run->reference, err);
    }
    if (!r) {
        r = backend_open(&run->backend, cli, run->args.head, &(backend_need){.sim = true}, err);
    }
    if (r) {
        return r;
    }
    const ris_model *model = run->backend.model;
    run->sculpt = calloc((size_t)run->reference.base.vertex_count * 3 + 1, sizeof *run->sculpt);
    run->position = calloc(model->node_count + 1u, sizeof *run->position);
    run->pose = calloc(model->channel_count + 1u, sizeof *run->pose);
    if (!run->sculpt || !run->position || !run->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", model->node_count);
    }
    r = ris_sim_settle(run->backend.sim, run->pose, NULL, err);
    if (!r) {
        r = ris_sim_read(run->backend.sim, RIS_STATE_POSITION, run->position, err);
    }
    return r ? r : ris__scorer_create(model, &run->reference.base, run->position, &run->scorer, err);
}

static void close_run(score_run *run)
{
    ris__scorer_finish(&run->scorer);
    ris__score_list_finish(&run->list);
    ris__reference_finish(&run->reference);
    backend_close(&run->backend);
    free(run->sculpt);
    free(run->position);
    free(run->pose);
    free(run->row);
}

static void judge(score_run *run, score_row *row)
{
    const ris_score *s = &row->score;
    if (s->cos < LEAST_COS) {
        snprintf(row->broken, sizeof row->broken, "cos %.3f, expected at least %.2f", s->cos, LEAST_COS);
    } else if (s->gain < LEAST_GAIN || s->gain > MOST_GAIN) {
        snprintf(row->broken, sizeof row->broken, "gain %.2f, expected %.1f to %.1f", s->gain, LEAST_GAIN,
                 MOST_GAIN);
    } else if (s->far >= MOST_FAR) {
        snprintf(row->broken, sizeof row->broken, "far %.3f, expected less than %.1f", s->far, MOST_FAR);
    }
    run->broken += row->broken[0] != '\0';
}

/* An error of one unit, with its name before it. */
static ris_result name_unit(const score_row *row, ris_result r, ris_error *err)
{
    char text[sizeof err->text];
    snprintf(text, sizeof text, "%s", err->text);
    return ris_fail(err, r, "%s: %.*s", row->unit->unit, (int)(sizeof text - RIS_UNIT_SIZE - 3), text);
}

/* The pose a row is measured with. */
static const char *recipe_of(const score_run *run, const score_row *row)
{
    return run->args.pose ? run->args.pose : row->unit->recipe;
}

static ris_result measure_row(score_run *run, score_row *row, ris_error *err)
{
    const char *recipe = recipe_of(run, row);
    ris_result r = ris__reference_unit(&run->reference, row->unit->unit, run->sculpt, err);
    if (r || !recipe[0]) {
        return r;
    }
    /* a name in the file that the head has not is bad data, one on the command line is wrong usage */
    r = ris_pose_parse(run->backend.model, recipe, run->pose, err);
    if (r == RIS_ERROR_USAGE && !run->args.pose) {
        r = RIS_ERROR_DATA;
    }
    if (!r) {
        r = ris_sim_reset(run->backend.sim, err);
    }
    if (!r) {
        r = ris_sim_settle(run->backend.sim, run->pose, NULL, err);
    }
    if (!r) {
        r = ris_sim_read(run->backend.sim, RIS_STATE_POSITION, run->position, err);
    }
    if (!r) {
        r = ris__score_pose(&run->scorer, run->sculpt, run->position, &row->score, err);
    }
    if (r) {
        return name_unit(row, r, err);
    }
    row->measured = true;
    row->counts = row->unit->argument[0] == '\0' || run->args.pose;
    if (row->counts) {
        run->mean_cos = (run->mean_cos * run->counted + row->score.cos) / (run->counted + 1u);
        run->counted++;
        judge(run, row);
    }
    return RIS_OK;
}

static ris_result measure_rows(score_run *run, const ris_cli *cli, ris_error *err)
{
    ris_progress bar;
    ris_result r = RIS_OK;
    progress_start(&bar, cli, "score");
    for (uint32_t i = 0; !r && i < run->row_count; i++) {
        progress_show(&bar, i, run->row_count);
        r = measure_row(run, &run->row[i], err);
        if (!r) {
            r = interrupt_check(err);
        }
    }
    if (!r) {
        progress_show(&bar, run->row_count, run->row_count);
    }
    progress_end(&bar);
    return r;
}

static void print_row(const score_run *run, const score_row *row)
{
    const ris_score *s = &row->score;
    char size[32];
    snprintf(size, sizeof size, "%.1f/%.1f", s->simulated_mm, s->sculpted_mm);
    printf("%-44s %6.3f %6.2f %7.3f %6.3f %6.3f  %-10s  %s\n", row->unit->unit, s->cos, s->gain, s->r2,
           s->r2fit, s->far, size, recipe_of(run, row));
}

static void print_text(const score_run *run)
{
    printf("%u mapped vertices, 1 asset unit = %.4f mm\n", run->scorer.used_count, run->scorer.mm);
    printf("%-44s %6s %6s %7s %6s %6s  %-10s  recipe\n", "unit", "cos", "gain", "r2", "r2fit", "far",
           "max_mm");
    for (uint32_t i = 0; i < run->row_count; i++) {
        if (run->row[i].counts) {
            print_row(run, &run->row[i]);
        }
    }
    if (run->counted) {
        printf("mean cos %.3f over %u units\n", run->mean_cos, run->counted);
    }
    for (uint32_t i = 0; i < run->row_count; i++) {
        const score_row *row = &run->row[i];
        if (row->broken[0]) {
            printf("BROKEN  %s: %s\n", row->unit->unit, row->broken);
        }
        if (!row->counts) {
            printf("not counted  %s: %s\n", row->unit->unit, row->unit->argument);
        }
        if (!row->counts && row->measured) {
            print_row(run, row);
        }
    }
}

static void print_json(const score_run *run)
{
    printf("{\"mapped\": %u, \"unit_mm\": %.9g, \"counted\": %u, \"mean_cos\": %.9g, \"broken\": %u, "
           "\"units\": [",
           run->scorer.used_count, run->scorer.mm, run->counted, run->mean_cos, run->broken);
    for (uint32_t i = 0; i < run->row_count; i++) {
        const score_row *row = &run->row[i];
        const ris_score *s = &row->score;
        printf("%s\n  {\"unit\": ", i ? "," : "");
        cli_json_string(stdout, row->unit->unit);
        printf(", \"recipe\": ");
        cli_json_string(stdout, recipe_of(run, row));
        printf(", \"argument\": ");
        cli_json_string(stdout, row->unit->argument);
        if (row->measured) {
            printf(", \"cos\": %.9g, \"gain\": %.9g, \"r2\": %.9g, \"r2fit\": %.9g, \"far\": %.9g, "
                   "\"simulated_mm\": %.9g, \"sculpted_mm\": %.9g",
                   s->cos, s->gain, s->r2, s->r2fit, s->far, s->simulated_mm, s->sculpted_mm);
        }
        printf(", \"broken\": ");
        cli_json_string(stdout, row->broken);
        printf("}");
    }
    printf("\n]}\n");
}

/* The first broken bound; the mean of a few chosen units is none. */
static ris_result verdict(const score_run *run, ris_error *err)
{
    for (uint32_t i = 0; i < run->row_count; i++) {
        if (run->row[i].broken[0]) {
            return ris_fail(err, RIS_ERROR_FAILED, "%s: %s (%u of %u units broken)", run->row[i].unit->unit,
                            run->row[i].broken, run->broken, run->counted);
        }
    }
    if (run->args.unit.count == 0 && run->mean_cos < MEAN_COS) {
        return ris_fail(err, RIS_ERROR_FAILED, "mean cos %.3f, expected at least %.2f", run->mean_cos,
                        MEAN_COS);
    }
    return RIS_OK;
}

static ris_result parse(ris_cli *cli, int argc, char **argv, score_args *args, ris_error *err)
{
    const cli_option options[] = {
        {"reference", 'r', "DIR", "a MakeHuman checkout, or a folder with base.obj and expression/*.target",
         NULL, &args->reference, NULL},
        {"unit", 'u', "NAME", "this unit of the list alone; may be given again", NULL, NULL, &args->unit},
        {"pose", 'p', "POSE", "with one --unit: measure this pose instead of its recipe", NULL, &args->pose,
         NULL},
        {"recipes", 0, "FILE", "the list of units (default: score.json of the head)", NULL, &args->recipes,
         NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_score, options, argc, argv, &args->head, 1, &count, err);
    if (!r && !cli->done) {
        r = cli_need_head(&cmd_score, count, err);
    }
    if (!r && !cli->done && !args->reference) {
        r = ris_fail(err, RIS_ERROR_USAGE, "score needs --reference DIR; usage: risorius score %s",
                     cmd_score.usage);
    }
    if (!r && !cli->done && args->pose && args->unit.count != 1) {
        r = ris_fail(err, RIS_ERROR_USAGE, "score --pose needs one --unit to measure it by");
    }
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    score_run run = {0};
    ris_result r = parse(cli, argc, argv, &run.args, err);
    if (r || cli->done) {
        return r;
    }
    r = open_run(&run, cli, err);
    if (!r) {
        r = measure_rows(&run, cli, err);
    }
    if (!r) {
        (cli->json ? print_json : print_text)(&run);
        r = verdict(&run, err);
    }
    close_run(&run);
    return r;
}

const cli_command cmd_score = {
    .name = "score",
    .usage = "HEAD --reference DIR [--unit NAME [--pose POSE]] [--recipes FILE]",
    .summary = "measure expressions against sculpted ones",
    .detail =
        "Each recipe of HEAD/score.json is held from rest until at rest, and its displacements are compared\n"
        "with the sculpted unit over the mapped vertices, weighted by area: cos (shape), gain (size), r2\n"
        "(identity), far (spill, where the sculpt moves less than 0.3 mm), largest displacements in mm.\n"
        "Fails with the first broken bound: mean cos 0.80 over all, and for each unit cos 0.55, gain 0.7 to\n"
        "1.4, far below 0.2. Units that no muscle makes are listed with the reason and do not count.\n",
    .run = run,
};
