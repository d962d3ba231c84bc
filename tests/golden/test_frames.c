/* Offscreen frames against committed pictures, and what must hold between frames: a simulation read in place gives the
 * picture of the same positions uploaded; drawing twice gives the same bits; poses and cameras change the picture. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"
#include "gpu/gpu.h"
#include "risorius/draw.h"
#include "risorius/timeline.h"
#include "scenes/scenes.h"

enum { WIDTH = 160, HEIGHT = 180, BYTES = WIDTH * HEIGHT * 4 };

static ris_device *device;
static ris_model *head, *scene;

#define GOOD(call)                                                                                           \
    do {                                                                                                     \
        if ((call) != RIS_OK) {                                                                              \
            fail_msg("%s: %s", #call, err.text);                                                             \
        }                                                                                                    \
    } while (0)

/* A simulation of model held at pose ("" = rest). */
static ris_sim *hold(const ris_model *model, const char *pose, ris_device *on)
{
    ris_error err = {0};
    ris_sim *sim = NULL;
    float *values = calloc(model->channel_count + 1, sizeof *values);
    assert_non_null(values);
    if (on) {
        GOOD(ris_sim_create_vk(model, on, &sim, &err));
    } else {
        GOOD(ris_sim_create_cpu(model, &sim, &err));
    }
    if (pose[0]) {
        GOOD(ris_pose_parse(model, pose, values, &err));
        for (int i = 0; i < 40; i++) {
            GOOD(ris_sim_tick(sim, values, &err));
        }
    }
    free(values);
    return sim;
}

/* One frame of sim into pixels. */
static void picture(ris_draw *draw, ris_sim *sim, const char *view, uint8_t *pixels)
{
    ris_error err = {0};
    ris_camera camera;
    assert_true(ris_camera_named(ris_sim_get_model(sim), view, &camera));
    GOOD(ris_draw_frame(draw, sim, &camera, &err));
    GOOD(ris_draw_read(draw, pixels, &err));
}

static ris_draw *open_draw(const ris_model *model)
{
    ris_error err = {0};
    ris_draw *draw = NULL;
    const ris_draw_def def = {.width = WIDTH, .height = HEIGHT};
    GOOD(ris_draw_create(device, model, &def, &draw, &err));
    return draw;
}

static void golden_frames(void **state)
{
    (void)state;
    static const struct {
        const char *name, *pose, *view;
        bool built, wireframe;
        uint32_t layers;
    } frame[] = {
        {"scene-front", "", "front", true, false, 0},
        {"scene-wire", "", "34", true, true, 0},
        {"head-front", "", "front", false, false, 0},
        {"head-34", "", "34", false, false, 0},
        {"head-jaw-open", "jaw.open=1", "front", false, false, RIS_LAYER_SKIN},
        {"head-tongue", "jaw.open=0.6,tongue.out=1,tongue.tip=-0.5", "34", false, false, RIS_LAYER_SKIN},
        {"scene-muscles", "zygomaticus_major=1,jaw.open=0.5", "front", true, false, RIS_LAYER_MUSCLES},
        {"head-glass", "jaw.open=1", "34", false, false,
         RIS_LAYER_SKIN | RIS_LAYER_SKULL | RIS_LAYER_LANDMARKS},
        {"scene-strain", "zygomaticus_major=1", "front", true, false, RIS_LAYER_STRAIN},
    };
    static uint8_t pixels[BYTES];
    ris_error err = {0};
    ris_draw *draw[2] = {open_draw(scene), open_draw(head)};
    int different = 0;
    for (size_t i = 0; i < sizeof frame / sizeof frame[0]; i++) {
        ris_draw *with = draw[frame[i].built ? 0 : 1];
        ris_sim *sim = hold(frame[i].built ? scene : head, frame[i].pose, NULL);
        ris_draw_set_wireframe(with, frame[i].wireframe);
        GOOD(ris_draw_set_layers(with, frame[i].layers, &err));
        picture(with, sim, frame[i].view, pixels);
        different += !golden_check(frame[i].name, pixels, WIDTH, HEIGHT);
        ris_sim_destroy(sim);
    }
    ris_draw_destroy(draw[0]);
    ris_draw_destroy(draw[1]);
    assert_int_equal(different, 0);
}

/* The comparison must see a picture moved by one pixel, a small change of light everywhere, and a missing reference. */
static void golden_controls(void **state)
{
    (void)state;
    static uint8_t pixels[BYTES], moved[BYTES];
    ris_draw *draw = open_draw(head);
    ris_sim *sim = hold(head, "", NULL);
    picture(draw, sim, "front", pixels);
    assert_true(golden_within(golden_compare(pixels, pixels, WIDTH, HEIGHT), GOLDEN_LIMIT));
    memcpy(moved, pixels, 4);
    memcpy(moved + 4, pixels, BYTES - 4);
    assert_false(golden_within(golden_compare(pixels, moved, WIDTH, HEIGHT), GOLDEN_LIMIT));
    for (int i = 0; i < BYTES; i++) {
        moved[i] = (uint8_t)(pixels[i] < 254 ? pixels[i] + 2 : 255);
    }
    assert_false(golden_within(golden_compare(pixels, moved, WIDTH, HEIGHT), GOLDEN_LIMIT));
    char *update = getenv("RIS_UPDATE_GOLDEN") ? strdup(getenv("RIS_UPDATE_GOLDEN")) : NULL;
    unsetenv("RIS_UPDATE_GOLDEN");
    assert_false(golden_check("no-such-reference", pixels, WIDTH, HEIGHT));
    if (update) {
        setenv("RIS_UPDATE_GOLDEN", update, 1);
        free(update);
    }
    ris_sim_destroy(sim);
    ris_draw_destroy(draw);
}

static void in_place_equals_uploaded(void **state)
{
    (void)state;
    static uint8_t there[BYTES], here[BYTES], given[BYTES];
    ris_error err = {0};
    ris_camera camera;
    ris_draw *draw = open_draw(head);
    ris_sim *vk = hold(head, "zygomaticus_major=1,jaw.open=0.3", device),
            *cpu = hold(head, "zygomaticus_major=1,jaw.open=0.3", NULL);
    ris_vec4 *position = calloc(head->node_count, sizeof *position),
             *normal = calloc(head->node_count, sizeof *normal);
    assert_true(position && normal && ris_camera_named(head, "34", &camera));
    picture(draw, vk, "34", there);
    picture(draw, cpu, "34", here);
    GOOD(ris_sim_read(vk, RIS_STATE_POSITION, position, &err));
    GOOD(ris_sim_read(vk, RIS_STATE_NORMAL, normal, &err));
    GOOD(ris_draw_frame_at(draw, vk, position, normal, &camera, &err));
    GOOD(ris_draw_read(draw, given, &err));
    assert_memory_equal(there, given, BYTES);
    if (test_gpu_is_lavapipe(device)) {
        assert_memory_equal(there, here, BYTES);
    }
    assert_true(golden_within(golden_compare(there, here, WIDTH, HEIGHT), GOLDEN_LIMIT));
    ris_sim_destroy(cpu);
    cpu = hold(head, "", NULL);
    picture(draw, cpu, "34", here);
    assert_false(
        golden_within(golden_compare(there, here, WIDTH, HEIGHT), GOLDEN_LIMIT)); /* the pose is seen */
    free(position);
    free(normal);
    ris_sim_destroy(vk);
    ris_sim_destroy(cpu);
    ris_draw_destroy(draw);
}

/* Pixels where the map of muscles and a picture of muscles alone disagree: flesh is red, the backdrop is not. */
static uint32_t disagreements(const uint32_t *map, const uint8_t *pixels)
{
    uint32_t different = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const bool red = pixels[4 * i] > pixels[4 * i + 2] + 12;
        different += red != (map[i] != UINT32_MAX);
    }
    return different;
}

static void the_map_is_the_picture(void **state)
{
    (void)state;
    static uint8_t pixels[BYTES];
    static uint32_t map[WIDTH * HEIGHT];
    ris_error err = {0};
    ris_camera camera;
    ris_draw *draw = open_draw(scene);
    ris_sim *sim = hold(scene, "zygomaticus_major=1,jaw.open=1,head.yaw=10", NULL);
    uint32_t seen = 0;
    assert_true(ris_camera_named(scene, "34.R", &camera));
    assert_int_equal(ris_draw_muscle_map(draw, sim, &camera, WIDTH, HEIGHT, map, &err), RIS_ERROR_USAGE);
    GOOD(ris_draw_set_layers(draw, RIS_LAYER_MUSCLES, &err));
    picture(draw, sim, "34.R", pixels);
    GOOD(ris_draw_muscle_map(draw, sim, &camera, WIDTH, HEIGHT, map, &err));
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        seen += map[i] != UINT32_MAX;
        assert_true(map[i] == UINT32_MAX || map[i] < scene->muscle_count);
    }
    assert_true(seen > 1000);
    assert_true(disagreements(map, pixels) < seen / 8); /* edges, and white tendons */
    picture(draw, sim, "34", pixels);
    assert_true(disagreements(map, pixels) > seen / 3); /* the control: another view */
    /* one muscle alone is the only one on the map */
    bool *only = calloc(scene->muscle_count, sizeof *only);
    assert_non_null(only);
    only[1] = true;
    ris_draw_set_muscles(draw, only);
    GOOD(ris_draw_muscle_map(draw, sim, &camera, WIDTH, HEIGHT, map, &err));
    seen = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        seen += map[i] == 1;
        assert_true(map[i] == 1 || map[i] == UINT32_MAX);
    }
    assert_true(seen > 100);
    free(only);
    ris_sim_destroy(sim);
    ris_draw_destroy(draw);
}

/* What the skin alone looks like does not depend on the layers that were shown before. */
static void layers_leave_no_trace(void **state)
{
    (void)state;
    static uint8_t before[BYTES], after[BYTES];
    ris_error err = {0};
    ris_draw *draw = open_draw(head);
    ris_sim *sim = hold(head, "jaw.open=0.5", device);
    picture(draw, sim, "front", before);
    GOOD(ris_draw_set_layers(draw, (1u << RIS_LAYER_COUNT) - 1, &err));
    picture(draw, sim, "front", after);
    assert_memory_not_equal(before, after, BYTES);
    assert_int_equal(ris_draw_set_layers(draw, 1u << RIS_LAYER_COUNT, &err), RIS_ERROR_USAGE);
    GOOD(ris_draw_set_layers(draw, 0, &err));
    picture(draw, sim, "front", after);
    assert_memory_equal(before, after, BYTES);
    ris_sim_destroy(sim);
    ris_draw_destroy(draw);
}

/* Mean second difference of brightness down the forehead, 0..255: what lines across it make. */
static float lines_on_the_forehead(ris_draw *draw, const char *pose, int width, int height, uint8_t *pixels)
{
    ris_sim *sim = hold(head, pose, device);
    picture(draw, sim, "front", pixels);
    ris_sim_destroy(sim);
    float sum = 0, count = 0;
    const int across = height / 8, step = height / 180;
    for (int y = height * 25 / 100; y < height * 30 / 100; y++) {
        for (int x = width / 2 - across; x < width / 2 + across; x++) {
            const uint8_t *p = pixels + 4 * ((size_t)y * (size_t)width + (size_t)x) + 1;
            const int down = 4 * step * width;
            sum += (float)abs(p[-down] - 2 * p[0] + p[down]);
            count += 1;
        }
    }
    return sum / count;
}

/* Lines open where the skin is squeezed across them, and stay shut where it is stretched or squeezed along them. */
static void wrinkles_open_across_the_squeeze(void **state)
{
    (void)state;
    enum { W = 320, H = 360 };
    ris_error err = {0};
    ris_draw *draw = open_draw(head);
    uint8_t *pixels = malloc((size_t)W * H * 4);
    assert_non_null(pixels);
    GOOD(ris_draw_resize(draw, W, H, &err));
    const float rest = lines_on_the_forehead(draw, "", W, H, pixels);
    const float raised =
        lines_on_the_forehead(draw, "frontalis_inner=1,frontalis_middle=1,frontalis_outer=1", W, H, pixels);
    const float half = lines_on_the_forehead(
        draw, "frontalis_inner=0.5,frontalis_middle=0.5,frontalis_outer=0.5", W, H, pixels);
    const float lowered =
        lines_on_the_forehead(draw, "depressor_supercilii=1,corrugator_supercilii=1", W, H, pixels);
    print_message("lines on the forehead: rest %.2f, half %.2f, raised %.2f, lowered %.2f\n", (double)rest,
                  (double)half, (double)raised, (double)lowered);
    assert_true(raised > 1.8f * rest);
    assert_true(half > rest && half < raised);
    assert_true(lowered < 1.25f * rest);
    free(pixels);
    ris_draw_destroy(draw);
}

static void resize_and_repeat(void **state)
{
    (void)state;
    static uint8_t first[BYTES], again[BYTES];
    ris_error err = {0};
    ris_draw *draw = open_draw(scene);
    ris_sim *sim = hold(scene, "", NULL);
    assert_int_equal(ris_draw_read(draw, first, &err), RIS_ERROR_USAGE); /* nothing drawn yet */
    picture(draw, sim, "front", first);
    picture(draw, sim, "front", again);
    assert_memory_equal(first, again, BYTES);
    GOOD(ris_draw_resize(draw, 33, 77, &err));
    assert_int_equal(ris_draw_read(draw, again, &err), RIS_ERROR_USAGE);
    picture(draw, sim, "front", again);
    GOOD(ris_draw_resize(draw, WIDTH, HEIGHT, &err));
    picture(draw, sim, "front", again);
    assert_memory_equal(first, again, BYTES);
    assert_int_equal(ris_draw_resize(draw, 0, 5, &err), RIS_ERROR_USAGE);
    assert_int_equal(ris_draw_resize(draw, 5, 100000, &err), RIS_ERROR_USAGE);
    picture(draw, sim, "profile", again);
    assert_memory_not_equal(first, again, BYTES);
    ris_camera camera;
    assert_false(ris_camera_named(scene, "back", &camera));
    ris_sim_destroy(sim);
    ris_draw_destroy(draw);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_frames),
        cmocka_unit_test(golden_controls),
        cmocka_unit_test(in_place_equals_uploaded),
        cmocka_unit_test(the_map_is_the_picture),
        cmocka_unit_test(layers_leave_no_trace),
        cmocka_unit_test(wrinkles_open_across_the_squeeze),
        cmocka_unit_test(resize_and_repeat),
    };
    ris_error err = {0};
    const ris_scene_def def = ris_default_scene_def();
    device = test_gpu_open();
    int failed = 1;
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &head, &err) != RIS_OK ||
        ris_scene_model(&def, &scene, &err) != RIS_OK) {
        fprintf(stderr, "%s\n", err.text);
    } else {
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    }
    ris_model_destroy(head);
    ris_model_destroy(scene);
    ris_device_destroy(device);
    return failed;
}
