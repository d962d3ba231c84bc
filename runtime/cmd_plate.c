/* risorius plate HEAD: one labelled picture of every muscle, as an atlas has it: from the front with the deep layer on
 * one half, and in profile. What is deep the program finds out: it peels off what lies over others. */
#include "anatomy.h"
#include "backend.h"
#include "risorius/output.h"
#include "risorius/timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEEP_SHARE 0.5f   /* a muscle of which less is seen lies deep */
#define COVERS_SHARE 0.1f /* a muscle that hides so much of a deep one is peeled off */

#define LEAST_PX 24u /* a muscle of which less is seen has no name in a figure */

static const uint8_t ink[3] = {38, 34, 32}, faint[3] = {120, 112, 104};

typedef struct plate_args {
    const char *head, *out, *size, *pose;
} plate_args;

typedef struct plate_figure {
    const char *view, *title;
    bool half;           /* the deep layer on the subject's right, the picture's left */
    bool below;          /* only deep muscles and those not named before, the mandible taken off */
    label_side side;     /* of the names */
    float area[4];       /* left, top, width and height, of the plate's */
    float right, nearer; /* shift of the head in the picture, in heights of it; size */
} plate_figure;

static const plate_figure figures[] = {
    {.view = "front",
     .title = "Anterior view; on the right half of the face the deep layer",
     .half = true,
     .side = LABEL_EITHER,
     .area = {0.0f, 0.0f, 1.0f, 0.52f},
     .nearer = 1.0f},
    {.view = "profile",
     .title = "Left lateral view",
     .side = LABEL_LEFT,
     .area = {0.0f, 0.52f, 0.60f, 0.48f},
     .right = 0.11f,
     .nearer = 0.95f},
    {.view = "profile",
     .title = "The same, deep layer, mandible taken off",
     .below = true,
     .side = LABEL_LEFT,
     .area = {0.60f, 0.52f, 0.40f, 0.48f},
     .right = 0.14f,
     .nearer = 1.0f},
};

/* Zeroed, then filled by open_plate, freed by close_plate in any state. */
typedef struct plate_job {
    uint32_t width, height;
    ris_backend backend;
    float *pose;
    ris_draw *draw;
    uint8_t *rgba, *figure;
    muscle_sight *sight;
    uint32_t *cover;
    bool *shown, *deep, *named; /* (muscle_count); named: its name stands on the plate */
    ris_label *label;
} plate_job;

static ris_result open_plate(plate_job *plate, const ris_cli *cli, const plate_args *args, ris_error *err)
{
    ris_result r =
        backend_open(&plate->backend, cli, args->head, &(backend_need){.sim = true, .draw = true}, err);
    if (r) {
        return r;
    }
    const ris_model *model = plate->backend.model;
    const size_t count = model->muscle_count + 1u, pixels = (size_t)plate->width * plate->height;
    plate->pose = calloc(model->channel_count + 1u, sizeof *plate->pose);
    plate->rgba = malloc(pixels * 4);
    plate->figure = malloc(pixels * 4);
    plate->sight = calloc(count, sizeof *plate->sight);
    plate->cover = calloc(count * count, sizeof *plate->cover);
    plate->shown = calloc(3 * count, sizeof *plate->shown);
    plate->label = calloc(count, sizeof *plate->label);
    if (!plate->pose || !plate->rgba || !plate->figure || !plate->sight || !plate->cover || !plate->shown ||
        !plate->label) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a plate of %ux%u", plate->width,
                        plate->height);
    }
    plate->deep = plate->shown + count;
    plate->named = plate->deep + count;
    if (args->pose) {
        r = ris_pose_parse(model, args->pose, plate->pose, err);
    }
    if (!r) {
        r = ris_sim_settle(plate->backend.sim, plate->pose, NULL, err);
    }
    const ris_draw_def def = {
        .width = 64, .height = 64, .layers = RIS_LAYER_MUSCLES | RIS_LAYER_SKULL, .paper = true};
    return r ? r : ris_draw_create(plate->backend.device, model, &def, &plate->draw, err);
}

static void close_plate(plate_job *plate)
{
    ris_draw_destroy(plate->draw);
    free(plate->pose);
    free(plate->rgba);
    free(plate->figure);
    free(plate->sight);
    free(plate->cover);
    free(plate->shown);
    free(plate->label);
    backend_close(&plate->backend);
}

/* Which muscles lie below others in a view, and which of those above them must go for them to be seen. */
static ris_result peel(plate_job *plate, const ris_camera *camera, uint32_t width, uint32_t height,
                       ris_error *err)
{
    const ris_model *model = plate->backend.model;
    const uint32_t count = model->muscle_count;
    ris_draw_set_muscles(plate->draw, NULL);
    ris_result r = anatomy_look(plate->draw, plate->backend.sim, camera, width / 2, height / 2, plate->sight,
                                plate->cover, err);
    for (uint32_t m = 0; !r && m < count; m++) {
        const muscle_sight *s = &plate->sight[m];
        plate->deep[m] = (float)s->seen_px < DEEP_SHARE * (float)s->whole_px;
    }
    for (uint32_t m = 0; !r && m < count; m++) {
        plate->shown[m] = true;
    }
    for (uint32_t m = 0; !r && m < count; m++) {
        for (uint32_t k = 0; plate->deep[m] && k < count; k++) {
            const float covered = (float)plate->cover[(size_t)m * count + k];
            if (!plate->deep[k] && covered > COVERS_SHARE * (float)plate->sight[m].whole_px) {
                plate->shown[k] = false;
            }
        }
    }
    return r;
}

static ris_result choose(plate_job *plate, const plate_figure *figure, const ris_camera *camera,
                         uint32_t width, uint32_t height, ris_error *err)
{
    const ris_model *model = plate->backend.model;
    ris_result r = RIS_OK;
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        plate->shown[m] = true;
        plate->deep[m] = false;
    }
    if (figure->half || figure->below) {
        r = peel(plate, camera, width, height, err);
    }
    for (uint32_t m = 0; !r && m < model->muscle_count; m++) {
        const char side = anatomy_side(model->muscle[m].name);
        plate->shown[m] = figure->below  ? side != 'R' && (plate->deep[m] || !plate->named[m])
                          : figure->half ? side != 'R' || plate->shown[m]
                                         : side != 'R';
    }
    ris_draw_set_muscles(plate->draw, plate->shown);
    return r;
}

static bool same_name(const ris_model *model, uint32_t m, const char *title)
{
    char text[LABEL_TEXT_SIZE];
    anatomy_title(model->muscle[m].name, text);
    return strcmp(text, title) == 0;
}

/* On a half-and-half figure a deep muscle is named on the deep half. */
static void name_deep_on_its_half(plate_job *plate)
{
    const ris_model *model = plate->backend.model;
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        char title[LABEL_TEXT_SIZE];
        bool deep = plate->deep[m];
        anatomy_title(model->muscle[m].name, title);
        for (uint32_t k = 0; k < model->muscle_count; k++) { /* deep on one side is deep on both */
            deep = deep || (plate->deep[k] && same_name(model, k, title));
        }
        if (deep && anatomy_side(model->muscle[m].name) == 'L') {
            plate->sight[m].seen_px = 0;
        }
    }
}

/* Columns of a picture between which something other than paper is seen. */
static void find_content(const uint8_t *rgba, uint32_t width, uint32_t height, float column[2])
{
    uint32_t low = width, high = 0;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        if (abs((int)rgba[4 * i] - (int)rgba[0]) > 12) {
            low = i % width < low ? (uint32_t)(i % width) : low;
            high = i % width > high ? (uint32_t)(i % width) : high;
        }
    }
    column[0] = (float)low;
    column[1] = (float)high;
}

static ris_result add_names(plate_job *plate, const plate_figure *figure, uint32_t width, uint32_t height,
                            float scale, ris_error *err)
{
    const ris_model *model = plate->backend.model;
    uint32_t count;
    if (figure->half) {
        name_deep_on_its_half(plate);
    }
    ris_result r = anatomy_labels(model, plate->sight, LEAST_PX, plate->label, &count, err);
    for (uint32_t i = 0; !r && i < count; i++) {
        ris_label *label = &plate->label[i];
        label->side = figure->side != LABEL_EITHER ? figure->side : label->side;
        for (uint32_t m = 0; m < model->muscle_count; m++) {
            plate->named[m] = plate->named[m] || same_name(model, m, label->text);
        }
    }
    if (!r) {
        float column[2];
        find_content(plate->figure, width, height, column);
        column[0] -= 22.0f * scale;
        column[1] += 22.0f * scale;
        labels_draw(plate->figure, width, height, plate->label, count, column, scale, ink);
    }
    return r;
}

/* Moves the head to the right of the picture by a share of its height, and nearer. */
static void shift(ris_camera *camera, const plate_figure *figure)
{
    const float away[3] = {camera->eye.x - camera->target.x, camera->eye.y - camera->target.y,
                           camera->eye.z - camera->target.z};
    const float distance = sqrtf(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
    const float tall = 2.0f * distance * tanf(camera->fov_y_deg * 3.14159265f / 360.0f),
                k = figure->right * tall / distance;
    /* the picture's right of a level camera is (away.z, 0, -away.x) / distance */
    camera->target.x -= k * away[2];
    camera->target.z += k * away[0];
    camera->eye.x = camera->target.x + away[0] / figure->nearer;
    camera->eye.y = camera->target.y + away[1] / figure->nearer;
    camera->eye.z = camera->target.z + away[2] / figure->nearer;
}

/* The picture of a figure, into plate->figure, and what is seen in it. */
static ris_result shoot_figure(plate_job *plate, const plate_figure *figure, uint32_t width, uint32_t height,
                               ris_error *err)
{
    ris_camera camera;
    if (!ris_camera_named(plate->backend.model, figure->view, &camera)) {
        return ris_fail(err, RIS_ERROR_USAGE, "there is no view '%s' of this head", figure->view);
    }
    shift(&camera, figure);
    ris_draw_set_mandible(plate->draw, true);
    ris_result r = ris_draw_resize(plate->draw, width, height, err);
    if (!r) {
        r = choose(plate, figure, &camera, width, height, err);
    }
    ris_draw_set_mandible(plate->draw, !figure->below);
    if (!r) {
        r = ris_draw_frame(plate->draw, plate->backend.sim, &camera, err);
    }
    if (!r) {
        r = ris_draw_read(plate->draw, plate->figure, err);
    }
    return r ? r
             : anatomy_look(plate->draw, plate->backend.sim, &camera, width, height, plate->sight, NULL, err);
}

static ris_result draw_figure(plate_job *plate, const plate_figure *figure, float scale, ris_error *err)
{
    const uint32_t left = (uint32_t)(figure->area[0] * (float)plate->width),
                   top = (uint32_t)(figure->area[1] * (float)plate->height),
                   right = (uint32_t)((figure->area[0] + figure->area[2]) * (float)plate->width + 0.5f),
                   bottom = (uint32_t)((figure->area[1] + figure->area[3]) * (float)plate->height + 0.5f);
    const uint32_t width = right - left, foot = (uint32_t)(18.0f * scale), height = bottom - top - foot;
    ris_result r = shoot_figure(plate, figure, width, height, err);
    if (!r) {
        r = add_names(plate, figure, width, height, scale, err);
    }
    for (uint32_t y = 0; !r && y < height; y++) {
        memcpy(plate->rgba + ((size_t)(top + y) * plate->width + left) * 4,
               plate->figure + (size_t)y * width * 4, (size_t)width * 4);
    }
    for (uint32_t y = top + height; !r && y < bottom; y++) {
        for (uint32_t x = left; x < right; x++) {
            memcpy(plate->rgba + ((size_t)y * plate->width + x) * 4, plate->figure, 4); /* paper */
        }
    }
    if (!r) {
        const float own = ris_label_width(scale, figure->title);
        ris_label_ink(plate->rgba, plate->width, plate->height, (float)left + 0.5f * ((float)width - own),
                      (float)(top + height) + 4.0f * scale, scale, faint, figure->title);
    }
    return r;
}

static ris_result draw_plate(plate_job *plate, ris_error *err)
{
    const float scale = (float)plate->height / 1150.0f;
    ris_result r = RIS_OK;
    for (size_t i = 0; !r && i < sizeof figures / sizeof figures[0]; i++) {
        r = draw_figure(plate, &figures[i], scale, err);
    }
    return r;
}

/* Muscles that no figure shows are said, not passed over. */
static void report(const plate_job *plate, const ris_cli *cli, const plate_args *args)
{
    const ris_model *model = plate->backend.model;
    uint32_t named = 0;
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        named += plate->named[m];
    }
    if (cli->json) {
        printf("{\"muscles\": %u, \"named\": %u, \"hidden\": [", model->muscle_count, named);
        for (uint32_t m = 0, k = 0; m < model->muscle_count; m++) {
            if (!plate->named[m]) {
                printf("%s", k++ ? ", " : "");
                cli_json_string(stdout, model->muscle[m].name);
            }
        }
        printf("]}\n");
    } else if (!cli->quiet) {
        fprintf(stderr, "wrote %s (%u of %u muscles named)\n", args->out, named, model->muscle_count);
        for (uint32_t m = 0; m < model->muscle_count; m++) {
            if (!plate->named[m]) {
                fprintf(stderr, "hidden behind others or bone: %s\n", model->muscle[m].name);
            }
        }
    }
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    plate_args args = {0};
    const cli_option options[] = {
        {"output", 'o', "FILE.png", "the picture", NULL, &args.out, NULL},
        {"size", 's', "WxH", "size in pixels (1400x1500)", NULL, &args.size, NULL},
        {"pose", 'p', "POSE", "a pose to hold: name=value[,name=value...]", NULL, &args.pose, NULL},
        {0},
    };
    plate_job plate = {0};
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_plate, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_plate, count, err);
    if (!r && !args.out) {
        r = ris_fail(err, RIS_ERROR_USAGE, "plate needs -o FILE.png");
    }
    if (!r) {
        r = cli_size("size", args.size ? args.size : "1400x1500", &plate.width, &plate.height, err);
    }
    if (!r && (plate.width < 320 || plate.height < 128)) {
        r = ris_fail(err, RIS_ERROR_USAGE, "--size: a plate needs 320x128 pixels or more");
    }
    if (!r) {
        r = open_plate(&plate, cli, &args, err);
    }
    if (!r) {
        r = draw_plate(&plate, err);
    }
    if (!r) {
        r = ris_png_write(args.out, plate.rgba, plate.width, plate.height, err);
    }
    if (!r) {
        report(&plate, cli, &args);
    }
    close_plate(&plate);
    return r;
}

const cli_command cmd_plate = {
    .name = "plate",
    .usage = "HEAD -o FILE.png",
    .summary = "one labelled picture of all muscles, superficial and deep",
    .run = run,
};
