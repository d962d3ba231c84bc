/* risorius validate: a short check of the installation on a small model: device, parity with the CPU, validation layer,
 * one picture. */
#include "backend.h"
#include "risorius/device.h"
#include "risorius/draw.h"
#include "scenes/scenes.h"
#include "sim/compare.h"

#include <stdlib.h>
#include <string.h>

#define TICKS 30u
#define RISE 15u  /* ticks until all muscles are contracted */
#define SIDE 128u /* pixels of the trial picture */

typedef struct check {
    const char *name, *verdict;
    char detail[700];
} check;

/* All muscles contract over RISE ticks and hold. */
static void contract_all(void *user, uint32_t tick, float *out_pose)
{
    const ris_model *model = user;
    float share = tick < RISE ? (float)tick / (float)RISE : 1.0f;
    for (uint32_t i = 0; i < model->channel_count; i++) {
        out_pose[i] = i < model->muscle_count ? share * model->channel[i].maximum : 0.0f;
    }
}

static ris_result check_parity(const ris_backend *backend, ris_sim *reference, check *out, ris_error *err)
{
    ris_compare_report report = {0};
    ris_compare_def def = ris_default_compare_def(reference, backend->sim);
    def.tick_count = TICKS;
    def.pose = contract_all;
    def.user = backend->model;
    def.moved_minimum = 0;
    ris_result r = ris_compare_run(&def, &report, err);
    out->verdict = r ? "FAILED" : report.differs ? "within tolerance" : "equal";
    snprintf(out->detail, sizeof out->detail, "%u nodes, %u frames of %u substeps, hash %016llx and %016llx",
             report.node_count, report.tick_count, report.substeps, (unsigned long long)report.hash[0],
             (unsigned long long)report.hash[1]);
    return r;
}

/* The trial picture must show something before the background. */
static ris_result check_picture(const ris_backend *backend, check *out, ris_error *err)
{
    ris_camera camera;
    if (!ris_camera_named(backend->model, "front", &camera)) {
        return ris_fail(err, RIS_ERROR_FAILED, "there is no front view of the small model");
    }
    ris_draw *draw = NULL;
    uint8_t *rgba = malloc(SIDE * SIDE * 4);
    uint32_t different = 0;
    ris_result r = rgba ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a picture");
    if (!r) {
        r = ris_draw_create(backend->device, backend->model, &(ris_draw_def){.width = SIDE, .height = SIDE},
                            &draw, err);
    }
    if (!r) {
        r = ris_draw_frame(draw, backend->sim, &camera, err);
    }
    if (!r) {
        r = ris_draw_read(draw, rgba, err);
    }
    for (uint32_t i = 0; !r && i < SIDE * SIDE; i++) {
        different +=
            abs(rgba[i * 4] - rgba[0]) + abs(rgba[i * 4 + 1] - rgba[1]) + abs(rgba[i * 4 + 2] - rgba[2]) > 60;
    }
    if (!r && different < SIDE * SIDE / 20) {
        r = ris_fail(err, RIS_ERROR_FAILED,
                     "the trial picture is blank: only %u of %u pixels differ from its corner", different,
                     SIDE * SIDE);
    }
    out->verdict = r ? "FAILED" : "drawn";
    snprintf(out->detail, sizeof out->detail, "%ux%u, %u pixels of the model", SIDE, SIDE, different);
    ris_draw_destroy(draw);
    free(rgba);
    return r;
}

static ris_result check_messages(const ris_backend *backend, check *out, ris_error *err)
{
    const char *first = "";
    uint32_t count = ris_device_message_count(backend->device, &first);
    if (!ris_device_validates(backend->device)) {
        out->verdict = "not installed";
        snprintf(out->detail, sizeof out->detail, "Debian: apt install vulkan-validationlayers");
        return RIS_OK;
    }
    out->verdict = count ? "FAILED" : "silent";
    snprintf(out->detail, sizeof out->detail, "%u messages, synchronization validation on", count);
    return count ? ris_fail(err, RIS_ERROR_FAILED, "the validation layer has %u messages, the first: %.600s",
                            count, first)
                 : RIS_OK;
}

/* With the validation layer where it is installed. */
static ris_result start(ris_backend *backend, const ris_cli *cli, ris_error *err)
{
    const backend_need need = {.sim = true};
    setenv("RIS_VALIDATION", "1", 1);
    ris_result r = backend_start(backend, cli, &need, err);
    if (r == RIS_ERROR_DEVICE) {
        unsetenv("RIS_VALIDATION");
        *err = (ris_error){0};
        r = backend_start(backend, cli, &need, err);
    }
    return r;
}

static void print_checks(const ris_cli *cli, const check *checks, uint32_t count, bool good)
{
    if (cli->json) {
        printf("{\"good\": %s, \"checks\": [", good ? "true" : "false");
    }
    for (uint32_t i = 0; i < count; i++) {
        if (cli->json) {
            printf("%s\n  {\"name\": \"%s\", \"verdict\": \"%s\", \"detail\": ", i ? "," : "", checks[i].name,
                   checks[i].verdict);
            cli_json_string(stdout, checks[i].detail);
            printf("}");
        } else {
            printf("%-10s %-16s %s\n", checks[i].name, checks[i].verdict, checks[i].detail);
        }
    }
    printf(cli->json ? "\n]}\n" : good ? "this installation works\n" : "");
}

static ris_result run_checks(const ris_cli *cli, ris_backend *backend, ris_sim *reference, ris_error *err)
{
    check checks[4] = {
        {.name = "device", .verdict = "usable"}, {.name = "parity"}, {.name = "picture"}, {.name = "layer"}};
    snprintf(checks[0].detail, sizeof checks[0].detail, "%s", ris_sim_backend(backend->sim));
    uint32_t done = 2;
    ris_result r = check_parity(backend, reference, &checks[1], err);
    if (!r) {
        done = 3;
        r = check_picture(backend, &checks[2], err);
    }
    if (!r) {
        done = 4;
        r = check_messages(backend, &checks[3], err);
    }
    print_checks(cli, checks, done, !r);
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    const cli_option options[] = {{0}};
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_validate, options, argc, argv, NULL, 0, &count, err);
    if (r || cli->done) {
        return r;
    }
    if (backend_is_cpu(cli)) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "validate checks a Vulkan device against the CPU; --device cpu leaves nothing to "
                        "check");
    }
    ris_backend backend = {0};
    ris_sim *reference = NULL;
    ris_scene_def scene = ris_default_scene_def();
    r = ris_scene_model(&scene, &backend.model, err);
    if (!r) {
        r = start(&backend, cli, err);
    }
    if (!r) {
        r = ris_sim_create_cpu(backend.model, &reference, err);
    }
    if (!r) {
        r = run_checks(cli, &backend, reference, err);
    }
    ris_sim_destroy(reference);
    backend_close(&backend);
    return r;
}

const cli_command cmd_validate = {
    .name = "validate",
    .usage = "",
    .summary = "check this installation: device, parity with the CPU, a picture, validation messages",
    .run = run,
};
