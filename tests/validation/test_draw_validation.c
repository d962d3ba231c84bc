/* The raster pass under validation and synchronization validation: the reference head with all its parts,
 * an image size that changes, wireframe, layers, and arrays given from outside. Not one message; test_validation
 * proves that messages would be seen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>

#include "gpu/gpu.h"
#include "risorius/draw.h"

static ris_device *vk;
static ris_model *model;

/* One drawn frame of size x size pixels that is not all one colour. */
static void draw_frame(ris_draw *draw, ris_sim *sim, uint32_t size, bool outside)
{
    ris_error err = {0};
    ris_camera camera;
    ris_vec4 *position = calloc(model->node_count, sizeof *position),
             *normal = calloc(model->node_count, sizeof *normal);
    uint8_t *pixels = calloc(size, (size_t)size * 4);
    bool varied = false;
    ris_result result;
    assert_true(position && normal && pixels);
    assert_true(ris_camera_named(model, "front", &camera));
    assert_int_equal(ris_sim_read(sim, RIS_STATE_POSITION, position, &err), RIS_OK);
    assert_int_equal(ris_sim_read(sim, RIS_STATE_NORMAL, normal, &err), RIS_OK);
    result = outside ? ris_draw_frame_at(draw, sim, position, normal, &camera, &err)
                     : ris_draw_frame(draw, sim, &camera, &err);
    if (result != RIS_OK || ris_draw_read(draw, pixels, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    for (uint32_t i = 4; i < size * size * 4; i++) {
        varied = varied || pixels[i] != pixels[i % 4];
    }
    assert_true(varied);
    free(position);
    free(normal);
    free(pixels);
}

static void drawing_is_silent(void **state)
{
    const ris_draw_def def = {.width = 96, .height = 96};
    ris_error err = {0};
    ris_draw *draw = NULL;
    ris_sim *sim[2] = {NULL, NULL};
    float *pose = calloc(model->channel_count, sizeof *pose);
    const char *first;
    (void)state;
    assert_non_null(pose);
    pose[ris_model_channel(model, "jaw.open")] = 0.5f;
    if (ris_sim_create_vk(model, vk, &sim[0], &err) != RIS_OK ||
        ris_sim_create_cpu(model, &sim[1], &err) != RIS_OK ||
        ris_draw_create(vk, model, &def, &draw, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ris_sim_tick(sim[k], pose, &err), RIS_OK);
        draw_frame(draw, sim[k], 96, false);
        assert_int_equal(ris_sim_tick(sim[k], pose, &err), RIS_OK);
        draw_frame(draw, sim[k], 96, true);
    }
    assert_int_equal(ris_draw_resize(draw, 64, 64, &err), RIS_OK);
    ris_draw_set_wireframe(draw, true);
    draw_frame(draw, sim[0], 64, false);
    for (uint32_t layers = 1; layers < 1u << RIS_LAYER_COUNT; layers = 2 * layers + (layers & 1u)) {
        /* one layer more each time, then each alone */
        assert_int_equal(ris_draw_set_layers(draw, layers, &err), RIS_OK);
        draw_frame(draw, sim[0], 64, false);
    }
    for (uint32_t k = 0; k < RIS_LAYER_COUNT; k++) {
        assert_int_equal(ris_draw_set_layers(draw, 1u << k, &err), RIS_OK);
        draw_frame(draw, sim[k & 1u], 64, k == 2);
    }
    ris_draw_destroy(draw);
    ris_sim_destroy(sim[0]);
    ris_sim_destroy(sim[1]);
    free(pose);
    if (ris_device_message_count(vk, &first) > 0) {
        fail_msg("%u validation messages, the first: %s", ris_device_message_count(vk, NULL), first);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(drawing_is_silent)};
    ris_error err = {0};
    int failed = 1;
    setenv("RIS_VALIDATION", "1", 1);
    vk = test_gpu_open();
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err) == RIS_OK) {
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    } else {
        print_error("%s\n", err.text);
    }
    ris_model_destroy(model);
    ris_device_destroy(vk);
    return failed;
}
