/* Every allocation the engine makes fails once (the linker sends its malloc, calloc and realloc here;
 * libraries keep theirs): baking a scene, both simulations, a tick, comparing, drawing, and loading the
 * reference head. Each time the result must be RIS_ERROR_MEMORY with a sentence, and all that was made
 * before must be freed (the sanitizer build checks that). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>

#include "gpu/gpu.h"
#include "risorius/draw.h"
#include "scenes/scenes.h"
#include "sim/compare.h"

static ris_device *vk;
static ris_model *model;
static ris_sim *cpu, *gpu;

/* ---- the failing allocator ---- */

static int64_t fail_at = -1, made; /* made: allocations since fail_at was set */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

static bool fails(void)
{
    return made++ == fail_at;
}

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return fails() ? NULL : __real_realloc(old, size);
}

/* Fails allocation 0, step, 2 step ... of run until there are no more. */
static void fail_each_allocation(ris_result (*run)(ris_error *), int64_t step, int64_t at_least)
{
    int64_t n = 0, runs = 0;
    for (;; n += step, runs++) {
        ris_error err = {0};
        ris_result result;
        fail_at = n;
        made = 0;
        result = run(&err);
        fail_at = -1;
        if (made <= n) {
            if (result != RIS_OK) {
                fail_msg("nothing failed, but the result is %d: \"%s\"", (int)result, err.text);
            }
            break;
        }
        if (result != RIS_ERROR_MEMORY || err.text[0] == '\0') {
            fail_msg("allocation %lld failed, but the result is %d: \"%s\"", (long long)n, (int)result,
                     err.text);
        }
    }
    print_message("%lld allocations, %lld of them failed in turn\n", (long long)made, (long long)runs);
    assert_true(made >= at_least);
}

/* ---- what runs ---- */

static ris_result run_bake(ris_error *err)
{
    ris_scene_def def = ris_default_scene_def();
    ris_model *baked = NULL;
    ris_result result = ris_scene_model(&def, &baked, err);
    ris_model_destroy(baked);
    return result;
}

static ris_result run_cpu(ris_error *err)
{
    ris_sim *sim = NULL;
    ris_result result = ris_sim_create_cpu(model, &sim, err);
    ris_sim_destroy(sim);
    return result;
}

static ris_result run_gpu(ris_error *err)
{
    static float pose[128];
    ris_sim *sim = NULL;
    ris_result result = ris_sim_create_vk(model, vk, &sim, err);
    if (result == RIS_OK) {
        result = ris_sim_tick(sim, pose, err);
    }
    ris_sim_destroy(sim);
    return result;
}

static ris_result run_device(ris_error *err)
{
    ris_device *device = NULL;
    ris_result result = ris_device_create(NULL, &device, err);
    ris_device_destroy(device);
    return result;
}

static void rest(void *user, uint32_t tick, float *out)
{
    (void)user;
    (void)tick;
    for (uint32_t c = 0; c < model->channel_count; c++) {
        out[c] = 0.0f;
    }
}

static ris_result run_compare(ris_error *err)
{
    ris_compare_report report;
    ris_compare_def def = ris_default_compare_def(cpu, gpu);
    def.tick_count = 1;
    def.pose = rest;
    def.moved_minimum = 0;
    return ris_compare_run(&def, &report, err);
}

static ris_result run_draw(ris_error *err)
{
    const ris_draw_def def = {.width = 16, .height = 16};
    ris_camera camera;
    ris_draw *draw = NULL;
    ris_result result = ris_draw_create(vk, model, &def, &draw, err);
    assert_true(ris_camera_named(model, "front", &camera));
    if (result == RIS_OK) {
        result = ris_draw_frame(draw, cpu, &camera, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_set_layers(draw, (1u << RIS_LAYER_COUNT) - 1, err);
    }
    if (result == RIS_OK) {
        result = ris_draw_frame(draw, cpu, &camera, err);
    }
    if (result == RIS_OK) {
        static uint32_t map[16 * 16];
        result = ris_draw_muscle_map(draw, cpu, &camera, 16, 16, map, err);
    }
    ris_draw_destroy(draw);
    return result;
}

static ris_result run_head(ris_error *err)
{
    ris_model *human = NULL;
    ris_result result = ris_model_load(RIS_SOURCE_DIR "/assets/human", &human, err);
    ris_model_destroy(human);
    return result;
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    fail_each_allocation(run_bake, 1, 50);
    fail_each_allocation(run_cpu, 1, 10);
    fail_each_allocation(run_device, 1, 3);
    fail_each_allocation(run_gpu, 1, 10);
    fail_each_allocation(run_compare, 1, 10);
    fail_each_allocation(run_draw, 1, 10);
}

/* The head makes hundreds: every 11th passes through all of its files. */
static void loading_the_head_may_fail(void **state)
{
    (void)state;
    fail_each_allocation(run_head, 11, 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_allocation_may_fail),
        cmocka_unit_test(loading_the_head_may_fail),
    };
    ris_scene_def def = ris_default_scene_def();
    ris_error err = {0};
    int failed = 1;
    test_gpu_small();
    vk = test_gpu_open();
    def.columns = 7;
    def.rows = 9;
    def.rig = false;
    if (ris_scene_model(&def, &model, &err) == RIS_OK && ris_sim_create_cpu(model, &cpu, &err) == RIS_OK &&
        ris_sim_create_vk(model, vk, &gpu, &err) == RIS_OK) {
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    } else {
        print_error("%s\n", err.text);
    }
    ris_sim_destroy(cpu);
    ris_sim_destroy(gpu);
    ris_model_destroy(model);
    ris_device_destroy(vk);
    return failed;
}
