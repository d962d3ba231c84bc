/* Every Vulkan call of the raster pass fails once, from its creation to the read-back, on a small scene. */
#include "fault/fault.h"

#include <stdlib.h>

#include "gpu/gpu.h"
#include "risorius/draw.h"
#include "scenes/scenes.h"

static ris_device *vk;
static ris_model *model;
static ris_sim *sim;

static ris_result run_draw(ris_error *err)
{
    static uint8_t pixels[24 * 24 * 4];
    const ris_draw_def def = {.width = 16, .height = 16};
    ris_camera camera;
    ris_draw *draw = NULL;
    ris_result result = ris_draw_create(vk, model, &def, &draw, err);
    assert_true(ris_camera_named(model, "front", &camera));
    if (result == RIS_OK) {
        result = ris_draw_frame(draw, sim, &camera, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_set_layers(draw, (1u << RIS_LAYER_COUNT) - 1, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_resize(draw, 24, 24, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_frame(draw, sim, &camera, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_read(draw, pixels, err);
    }
    ris_draw_destroy(draw);
    return result;
}

static void drawing_survives_each_failure(void **state)
{
    (void)state;
    fail_each_call(run_draw, VK_ERROR_OUT_OF_DEVICE_MEMORY, RIS_ERROR_MEMORY, 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(drawing_survives_each_failure)};
    ris_scene_def def = ris_default_scene_def();
    ris_error err = {0};
    int failed = 1;
    test_gpu_small();
    vk = test_gpu_open();
    def.columns = 7;
    def.rows = 9;
    def.rig = false;
    if (ris_scene_model(&def, &model, &err) == RIS_OK && ris_sim_create_vk(model, vk, &sim, &err) == RIS_OK) {
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    } else {
        print_error("%s\n", err.text);
    }
    ris_sim_destroy(sim);
    ris_model_destroy(model);
    ris_device_destroy(vk);
    return failed;
}
