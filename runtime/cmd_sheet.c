/* risorius sheet HEAD: one labelled picture of many poses at rest: a vocabulary, or poses of one's own; shuffled and
 * without names for blind readings. */
#include "backend.h"
#include "base/file.h"
#include "measure/soak_pose.h"
#include "risorius/output.h"
#include "risorius/timeline.h"
#include "studio.h"

#include <stdlib.h>
#include <string.h>

#define TILE_TEXT_SIZE 320
#define TILES_MAX 1024
#define HOLD_S 6.0 /* simulated time a pose may take; a twitching one is shown as it is then */
#define MARGIN 6
#define STRIP_ROWS 26u   /* of text under a tile */
#define LEAST_TITLE 0.9f /* pixels per font unit; a title that must be smaller is left out */

static const uint8_t paper[3] = {46, 48, 52}, ink[3] = {235, 235, 230}, faint[3] = {170, 172, 176};

typedef struct sheet_args {
    const char *head, *out, *set, *poses, *size, *view, *columns, *value, *shuffle, *key, *zoom;
    bool hide_names;
} sheet_args;

typedef struct sheet_tile {
    char pose[TILE_TEXT_SIZE], name[TILE_TEXT_SIZE], title[TILE_TEXT_SIZE];
} sheet_tile;

/* Zeroed, then filled by open_sheet, freed by close_sheet in any state. */
typedef struct sheet_job {
    const sheet_args *args;
    uint32_t tile_width, height, columns, tile_count,
        unrested; /* width of all views of a tile; height of one */
    uint32_t picture_width, picture_height;
    uint64_t seed;
    double value, zoom;
    ris_word_kind kind; /* of --set */
    studio_views views;
    ris_backend backend;
    ris_studio *studio;
    sheet_tile *tile;
    float *pose;
    uint8_t *rgba;
} sheet_job;

static ris_result check_args(sheet_job *sheet, ris_error *err)
{
    const sheet_args *args = sheet->args;
    uint32_t width = 0;
    if (!args->out) {
        return ris_fail(err, RIS_ERROR_USAGE, "sheet needs -o FILE.png");
    }
    if (!args->set == !args->poses) {
        return ris_fail(err, RIS_ERROR_USAGE, "sheet needs --set NAME or --poses LIST%s",
                        args->set ? ", not both" : "");
    }
    if (args->hide_names && !args->key) {
        return ris_fail(err, RIS_ERROR_USAGE, "--hide-names needs --key FILE to keep the names");
    }
    if (args->key && strcmp(args->key, args->out) == 0) {
        return ris_fail(err, RIS_ERROR_USAGE, "'%s' is named as two outputs", args->out);
    }
    ris_result r = cli_size("size", args->size ? args->size : "240x270", &width, &sheet->height, err);
    r = r ? r : studio_views_parse(args->view ? args->view : "front,34", &sheet->views, err);
    r = r ? r : cli_count("columns", args->columns ? args->columns : "4", 1, 64, &sheet->columns, err);
    r = r ? r : cli_number("value", args->value ? args->value : "1", -1000, 1000, &sheet->value, err);
    r = r ? r : cli_number("zoom", args->zoom ? args->zoom : "1.3", 0.25, 8, &sheet->zoom, err);
    r = r || !args->set ? r : cli_set(args->set, &sheet->kind, err);
    sheet->tile_width = width * sheet->views.count;
    if (!r && args->shuffle) {
        uint32_t seed = 0;
        r = cli_count("shuffle", args->shuffle, 0, UINT32_MAX, &seed, err);
        sheet->seed = seed;
    }
    return r;
}

static ris_result add_tile(sheet_job *sheet, const char *pose, const char *name, const char *title,
                           ris_error *err)
{
    if (sheet->tile_count == TILES_MAX || strlen(pose) >= TILE_TEXT_SIZE || *pose == 0) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "--poses: expected at most %d poses of 1 to %d bytes between semicolons", TILES_MAX,
                        TILE_TEXT_SIZE - 1);
    }
    sheet_tile *tile = &sheet->tile[sheet->tile_count++];
    snprintf(tile->pose, sizeof tile->pose, "%s", pose);
    snprintf(tile->name, sizeof tile->name, "%s", name);
    snprintf(tile->title, sizeof tile->title, "%s", title);
    return RIS_OK;
}

static ris_result add_set(sheet_job *sheet, ris_error *err)
{
    const ris_vocabulary *vocabulary = &sheet->backend.model->vocabulary;
    ris_result r = RIS_OK;
    for (uint32_t i = 0; i < vocabulary->word_count && !r; i++) {
        const ris_word *word = &vocabulary->word[i];
        char pose[TILE_TEXT_SIZE];
        if (word->kind == sheet->kind) {
            snprintf(pose, sizeof pose, "%s=%.9g", word->name, sheet->value);
            r = add_tile(sheet, pose, word->name, word->title, err);
        }
    }
    return r;
}

/* "AU6+12=1;AU1=1,AU4=0.5": each stands under its picture. */
static ris_result add_poses(sheet_job *sheet, ris_error *err)
{
    ris_result r = RIS_OK;
    for (const char *at = sheet->args->poses; !r;) {
        const size_t length = strcspn(at, ";");
        char pose[TILE_TEXT_SIZE + 1];
        snprintf(pose, sizeof pose, "%.*s", (int)(length < TILE_TEXT_SIZE ? length : TILE_TEXT_SIZE), at);
        r = add_tile(sheet, pose, pose, "", err);
        if (at[length] == 0) {
            break;
        }
        at += length + 1;
    }
    return r;
}

static void shuffle(sheet_job *sheet)
{
    ris_pcg pcg = ris__pcg_start(sheet->seed, 0);
    for (uint32_t i = sheet->tile_count; i > 1; i--) {
        const uint32_t k = ris__pcg_below(&pcg, i);
        const sheet_tile other = sheet->tile[k];
        sheet->tile[k] = sheet->tile[i - 1];
        sheet->tile[i - 1] = other;
    }
}

static ris_result make_picture(sheet_job *sheet, ris_error *err)
{
    sheet->columns = sheet->tile_count < sheet->columns ? sheet->tile_count : sheet->columns;
    const uint64_t width = (uint64_t)sheet->columns * sheet->tile_width;
    const uint64_t rows = (sheet->tile_count + sheet->columns - 1) / sheet->columns;
    const uint64_t height = rows * (sheet->height + STRIP_ROWS);
    if (width > 16384 || height > 16384) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "a sheet of %ux%u pixels is larger than 16384; see --size, --columns",
                        (unsigned)width, (unsigned)height);
    }
    sheet->picture_width = (uint32_t)width;
    sheet->picture_height = (uint32_t)height;
    sheet->rgba = malloc((size_t)(width * height * 4));
    if (!sheet->rgba) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a sheet of %ux%u", (unsigned)width,
                        (unsigned)height);
    }
    for (size_t i = 0; i < (size_t)(width * height); i++) {
        memcpy(sheet->rgba + i * 4, paper, 3);
        sheet->rgba[i * 4 + 3] = 255;
    }
    return RIS_OK;
}

static ris_result open_sheet(sheet_job *sheet, const ris_cli *cli, ris_error *err)
{
    const sheet_args *args = sheet->args;
    const backend_need need = {.sim = true, .draw = true};
    ris_result r = backend_open(&sheet->backend, cli, args->head, &need, err);
    if (r) {
        return r;
    }
    sheet->tile = calloc(TILES_MAX, sizeof *sheet->tile);
    sheet->pose = calloc(sheet->backend.model->channel_count + 1u, sizeof *sheet->pose);
    if (!sheet->tile || !sheet->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %d poses", TILES_MAX);
    }
    r = args->set ? add_set(sheet, err) : add_poses(sheet, err);
    for (uint32_t i = 0; i < sheet->tile_count && !r; i++) { /* before the long work */
        r = ris_pose_parse(sheet->backend.model, sheet->tile[i].pose, sheet->pose, err);
    }
    if (!r && args->shuffle) {
        shuffle(sheet);
    }
    r = r ? r : make_picture(sheet, err);
    const studio_look look = {.zoom = (float)sheet->zoom};
    return r ? r
             : studio_create(&sheet->backend, &sheet->views, sheet->tile_width / sheet->views.count,
                             sheet->height, &look, &sheet->studio, err);
}

static void close_sheet(sheet_job *sheet)
{
    studio_destroy(sheet->studio);
    backend_close(&sheet->backend);
    free(sheet->tile);
    free(sheet->pose);
    free(sheet->rgba);
}

static void write_name(sheet_job *sheet, uint32_t index, uint32_t x, uint32_t y)
{
    const sheet_tile *tile = &sheet->tile[index];
    char number[16];
    snprintf(number, sizeof number, "%u", index + 1);
    const char *name = sheet->args->hide_names ? number : tile->name;
    const float room = (float)sheet->tile_width - 2.0f * MARGIN;
    float scale = 1.6f, width = ris_label_width(scale, name);
    if (width > room) {
        scale *= room / width;
        width = room;
    }
    ris_label_ink(sheet->rgba, sheet->picture_width, sheet->picture_height, (float)x + MARGIN,
                  (float)y + 0.5f * (float)STRIP_ROWS - 3.5f * scale, scale, ink, name);
    const float left = width + 12.0f;
    if (!sheet->args->hide_names && left < room) {
        const float whole = ris_label_width(1.3f, tile->title);
        const float small = whole > room - left ? 1.3f * (room - left) / whole : 1.3f;
        if (small > LEAST_TITLE) {
            ris_label_ink(sheet->rgba, sheet->picture_width, sheet->picture_height, (float)x + MARGIN + left,
                          (float)y + 0.5f * (float)STRIP_ROWS - 3.5f * small, small, faint, tile->title);
        }
    }
}

/* From rest, so that a picture depends on its pose alone. */
static ris_result take_tile(sheet_job *sheet, uint32_t index, ris_error *err)
{
    ris_hold hold = {.at_rest = true};
    const uint8_t *rgba = NULL;
    ris_result r = ris_pose_parse(sheet->backend.model, sheet->tile[index].pose, sheet->pose, err);
    r = r ? r : ris_sim_reset(sheet->backend.sim, err);
    r = r ? r : ris_sim_hold(sheet->backend.sim, sheet->pose, HOLD_S, &hold, err);
    r = r ? r : studio_shoot(sheet->studio, sheet->backend.sim, NULL, NULL, &rgba, err);
    if (r) {
        return r;
    }
    sheet->unrested += !hold.at_rest;
    const uint32_t x = index % sheet->columns * sheet->tile_width;
    const uint32_t y = index / sheet->columns * (sheet->height + STRIP_ROWS);
    for (uint32_t row = 0; row < sheet->height; row++) {
        memcpy(sheet->rgba + ((size_t)(y + row) * sheet->picture_width + x) * 4,
               rgba + (size_t)row * sheet->tile_width * 4, (size_t)sheet->tile_width * 4);
    }
    write_name(sheet, index, x, y + sheet->height);
    return RIS_OK;
}

static ris_result write_key(const sheet_job *sheet, ris_error *err)
{
    ris_output_file file = {0};
    ris_result r = ris__output_open(&file, sheet->args->key, err);
    for (uint32_t i = 0; i < sheet->tile_count && !r; i++) {
        r = ris__output_printf(&file, err, "%u %s\n", i + 1, sheet->tile[i].name);
    }
    r = r ? r : ris__output_commit(&file, err);
    ris__output_discard(&file);
    return r;
}

static ris_result run_sheet(sheet_job *sheet, const ris_cli *cli, ris_error *err)
{
    ris_progress bar;
    ris_result r = RIS_OK;
    progress_start(&bar, cli, "sheet");
    for (uint32_t i = 0; i < sheet->tile_count && !r; i++) {
        progress_show(&bar, i, sheet->tile_count);
        r = take_tile(sheet, i, err);
        r = r ? r : interrupt_check(err);
    }
    if (!r) {
        progress_show(&bar, sheet->tile_count, sheet->tile_count);
    }
    progress_end(&bar);
    if (!r && sheet->args->key) {
        r = write_key(sheet, err);
    }
    r = r ? r
          : ris_png_write(sheet->args->out, sheet->rgba, sheet->picture_width, sheet->picture_height, err);
    if (!r && cli->json) {
        printf("{\"poses\": %u, \"not_at_rest\": %u, \"width\": %u, \"height\": %u, \"output\": ",
               sheet->tile_count, sheet->unrested, sheet->picture_width, sheet->picture_height);
        cli_json_string(stdout, sheet->args->out);
        printf("}\n");
    } else if (!r && !cli->quiet) {
        fprintf(stderr, "wrote %s (%u poses, %u not at rest after %g s)\n", sheet->args->out,
                sheet->tile_count, sheet->unrested, HOLD_S);
    }
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    sheet_args args = {0};
    const cli_option options[] = {
        {"set", 0, "NAME", "facs, arkit, visemes or expressions: every name of it", NULL, &args.set, NULL},
        {"poses", 0, "LIST", "poses of your own instead, with semicolons between them", NULL, &args.poses,
         NULL},
        {"output", 'o', "FILE.png", "the sheet", NULL, &args.out, NULL},
        {"value", 0, "X", "value of each name of a set (1)", NULL, &args.value, NULL},
        {"size", 's', "WxH", "size of one view of one pose in pixels (240x270)", NULL, &args.size, NULL},
        {"view", 0, "LIST", "front, 34, profile, 34.R, profile.R side by side (front,34)", NULL, &args.view,
         NULL},
        {"zoom", 0, "X", "nearer than the views of render, about the nose (1.3)", NULL, &args.zoom, NULL},
        {"columns", 0, "N", "poses in a row (4)", NULL, &args.columns, NULL},
        {"shuffle", 0, "SEED", "in an order that the seed decides", NULL, &args.shuffle, NULL},
        {"hide-names", 0, NULL, "numbers instead of names", &args.hide_names, NULL, NULL},
        {"key", 0, "FILE", "write numbers and names to a text file", NULL, &args.key, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_sheet, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    sheet_job sheet = {.args = &args};
    r = cli_need_head(&cmd_sheet, count, err);
    r = r ? r : check_args(&sheet, err);
    r = r ? r : ris__output_try(args.out, err);
    r = r || !args.key ? r : ris__output_try(args.key, err);
    r = r ? r : open_sheet(&sheet, cli, err);
    r = r ? r : run_sheet(&sheet, cli, err);
    close_sheet(&sheet);
    return r;
}

const cli_command cmd_sheet = {
    .name = "sheet",
    .usage = "HEAD (--set facs|arkit|visemes|expressions | --poses LIST) -o FILE.png",
    .summary = "one labelled picture of many poses at rest: action units, shapes, visemes, expressions",
    .detail = "Each pose starts at rest, so that a picture depends on its pose alone.\n"
              "For a blind reading: --shuffle SEED --hide-names --key FILE.\n",
    .run = run,
};
