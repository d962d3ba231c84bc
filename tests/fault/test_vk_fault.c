/* Every Vulkan call of a small simulation fails once: from opening the device to the last read, n = 0, 1,
 * 2 ... until nothing fails any more. Each time the result must be an error of the right code with a
 * sentence that names the call, and everything must be freed (the sanitizer build checks that). */
#include "fault/fault.h"

#include <stdio.h>
#include <stdlib.h>

#include "gpu/gpu.h"
#include "gpu/random_model.h"
#include "sim/vk/vk_sim.h"

static ris_model *model;

static ris_device *shared; /* NULL: each run opens its own */

static ris_result open_device(ris_device **out, ris_error *err)
{
    *out = shared;
    return shared ? RIS_OK : ris_device_create(NULL, out, err);
}

static void close_device(ris_device *vk)
{
    if (!shared) {
        ris_device_destroy(vk);
    }
}

/* A simulation, two ticks, a read and a write. Frees all. */
static ris_result run_sim(ris_error *err)
{
    static float pose[64];
    ris_vec4 value[20];
    ris_device *vk = NULL;
    ris_sim *sim = NULL;
    ris_result result = open_device(&vk, err);
    if (result == RIS_OK) {
        result = ris_sim_create_vk(model, vk, &sim, err);
    }
    for (int tick = 0; tick < 2 && result == RIS_OK; tick++) {
        result = ris_sim_tick(sim, pose, err);
    }
    if (result == RIS_OK) {
        result = ris_sim_read(sim, RIS_STATE_FORCE, value, err);
    }
    if (result == RIS_OK) {
        result = ris_sim_write(sim, RIS_STATE_FORCE, value, err);
    }
    ris_sim_destroy(sim);
    close_device(vk);
    return result;
}

/* An image with mips and a sampler. */
static ris_result run_image(ris_error *err)
{
    static const uint32_t pixels[16 * 8];
    const ris_vk_image_def def = {
        16,
        8,
        VK_FORMAT_R8G8B8A8_UNORM,
        0,
        0,
        VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        0,
        "picture"};
    ris_vk_image image = {0};
    VkSampler sampler = VK_NULL_HANDLE;
    ris_device *vk = NULL;
    ris_result result = open_device(&vk, err);
    if (result == RIS_OK) {
        result = ris_vk_image_create(vk, &def, &image, err);
    }
    if (result == RIS_OK) {
        result = ris_vk_image_upload(vk, &image, pixels, err);
    }
    if (result == RIS_OK) {
        result = ris_vk_sampler_create(vk, VK_SAMPLER_ADDRESS_MODE_REPEAT, 4.0f, &sampler, err);
    }
    if (vk) {
        vkDestroySampler(vk->handle, sampler, NULL);
        ris_vk_image_finish(vk, &image);
    }
    close_device(vk);
    return result;
}

static ris_result run_device(ris_error *err)
{
    ris_device *vk = NULL;
    ris_result result = ris_device_create(NULL, &vk, err);
    ris_device_destroy(vk);
    return result;
}

static ris_result run_list(ris_error *err)
{
    ris_device_info info[4];
    uint32_t count;
    return ris_device_list(info, 4, &count, err);
}

static void open_shared(void)
{
    ris_error err = {0};
    if (ris_device_create(NULL, &shared, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static void close_shared(void)
{
    ris_device_destroy(shared);
    shared = NULL;
}

static void out_of_memory(void **state)
{
    (void)state;
    fail_each_call(run_list, VK_ERROR_OUT_OF_HOST_MEMORY, RIS_ERROR_MEMORY, 4);
    fail_each_call(run_device, VK_ERROR_OUT_OF_DEVICE_MEMORY, RIS_ERROR_MEMORY, 6);
    open_shared();
    fail_each_call(run_sim, VK_ERROR_OUT_OF_DEVICE_MEMORY, RIS_ERROR_MEMORY, 40);
    fail_each_call(run_image, VK_ERROR_OUT_OF_HOST_MEMORY, RIS_ERROR_MEMORY, 15);
    close_shared();
}

static void out_of_memory_with_staging(void **state)
{
    (void)state;
    setenv("RIS_STAGING", "1", 1);
    open_shared();
    fail_each_call(run_sim, VK_ERROR_OUT_OF_DEVICE_MEMORY, RIS_ERROR_MEMORY, 80);
    close_shared();
    unsetenv("RIS_STAGING");
}

static void device_lost(void **state)
{
    (void)state;
    fail_each_call(run_sim, VK_ERROR_DEVICE_LOST, RIS_ERROR_DEVICE, 40);
    fail_each_call(run_image, VK_ERROR_DEVICE_LOST, RIS_ERROR_DEVICE, 15);
}

/* Once lost, always lost: later calls fail at once, and everything can still be freed. */
static void loss_is_sticky(void **state)
{
    static float pose[64];
    ris_device *vk = NULL;
    ris_sim *sim = NULL;
    ris_error err = {0};
    int64_t calls;
    (void)state;
    assert_int_equal(ris_device_create(NULL, &vk, &err), RIS_OK);
    assert_int_equal(ris_sim_create_vk(model, vk, &sim, &err), RIS_OK);
    assert_int_equal(ris_sim_tick(sim, pose, &err), RIS_OK);
    ris__vk_fault_set(1, VK_ERROR_DEVICE_LOST);
    assert_int_equal(ris_sim_tick(sim, pose, &err), RIS_ERROR_DEVICE);
    ris__vk_fault_set(-1, VK_SUCCESS);
    calls = ris__vk_fault_count();
    assert_int_equal(ris_sim_tick(sim, pose, &err), RIS_ERROR_DEVICE);
    assert_int_equal(ris__vk_fault_count(), calls);
    assert_non_null(strstr(err.text, "VK_ERROR_DEVICE_LOST"));
    ris_sim_destroy(sim);
    ris_device_destroy(vk);
}

static void wrong_devices_are_refused(void **state)
{
    static const char *const wrong[] = {"9999", "no such device", "18446744073709551616"};
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        const ris_device_def def = {.select = wrong[k]};
        ris_device *vk = NULL;
        ris_error err = {0};
        assert_int_equal(ris_device_create(&def, &vk, &err), RIS_ERROR_DEVICE);
        assert_null(vk);
        assert_non_null(strstr(err.text, wrong[k]));
    }
}

static void names_and_numbers_choose(void **state)
{
    ris_device_info info[8];
    uint32_t count = 0;
    ris_error err = {0};
    (void)state;
    assert_int_equal(ris_device_list(info, 8, &count, &err), RIS_OK);
    for (uint32_t i = 0; i < count && i < 8; i++) {
        char number[16];
        const ris_device_def by_number = {.select = number}, by_name = {.select = info[i].name};
        ris_device *vk = NULL;
        snprintf(number, sizeof number, "%u", i);
        if (!info[i].usable) {
            assert_int_equal(ris_device_create(&by_number, &vk, &err), RIS_ERROR_DEVICE);
            continue;
        }
        assert_int_equal(ris_device_create(&by_number, &vk, &err), RIS_OK);
        assert_string_equal(ris_device_get_info(vk)->name, info[i].name);
        ris_device_destroy(vk);
        assert_int_equal(ris_device_create(&by_name, &vk, &err), RIS_OK);
        assert_string_equal(ris_device_get_info(vk)->name, info[i].name);
        ris_device_destroy(vk);
    }
    ris_device_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(out_of_memory),
        cmocka_unit_test(out_of_memory_with_staging),
        cmocka_unit_test(device_lost),
        cmocka_unit_test(loss_is_sticky),
        cmocka_unit_test(wrong_devices_are_refused),
        cmocka_unit_test(names_and_numbers_choose),
    };
    int failed;
    test_gpu_small();
    ris_device_destroy(test_gpu_open()); /* ends the program where there is none */
    model = random_model_create(20, RIS_TISSUE_FLAG_CONTINUOUS, 3);
    failed = model ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
    random_model_free(model);
    return failed;
}
