/* The simulation under the Khronos validation layer with synchronization validation: not one message. Then
 * a missing barrier, a wrong size and a wrong layout, which must each fire, or the silence above means
 * nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "gpu/gpu.h"
#include "gpu/random_model.h"
#include "sim/sim_impl.h"
#include "sim/vk/vk_sim.h"

static ris_device *vk;

static uint32_t messages(void)
{
    return ris_device_message_count(vk, NULL);
}

static void fail_on_messages(void)
{
    const char *first;
    if (ris_device_message_count(vk, &first) > 0) {
        fail_msg("%u validation messages, the first: %s", messages(), first);
    }
}

static void run_sim(uint32_t flags)
{
    ris_model *model = random_model_create(200, flags, 31);
    ris_sim *sim = NULL;
    ris_error err = {0};
    ris_vec4 value[200];
    float *pose;
    assert_non_null(model);
    pose = calloc(model->channel_count, sizeof *pose);
    assert_non_null(pose);
    if (ris_sim_create_vk(model, vk, &sim, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    for (int tick = 0; tick < 6; tick++) {
        pose[0] = 0.1f * (float)tick;
        ris_vk_sim_set_timestamps(sim, tick % 2 == 0); /* records anew */
        assert_int_equal(ris_sim_tick(sim, pose, &err), RIS_OK);
        for (int s = 0; s < RIS_STATE_COUNT; s++) {
            assert_int_equal(ris_sim_read(sim, (ris_state)s, value, &err), RIS_OK);
            assert_int_equal(ris_sim_write(sim, (ris_state)s, value, &err), RIS_OK);
        }
        for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
            assert_int_equal(ris__sim_stage(sim, (ris_stage)stage, NULL, &err), RIS_OK);
        }
    }
    assert_int_equal(ris__vk_sim_check_guards(sim, &err), RIS_OK);
    ris_sim_destroy(sim);
    free(pose);
    random_model_free(model);
}

static void the_simulation_is_silent(void **state)
{
    (void)state;
    run_sim(RIS_TISSUE_FLAG_CONTINUOUS);
    run_sim(RIS_TISSUE_FLAG_KAEHLER);
    fail_on_messages();
}

static void images_are_silent(void **state)
{
    const ris_vk_image_def def = {
        64,
        48,
        VK_FORMAT_R8G8B8A8_SRGB,
        0,
        0,
        VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        0,
        "picture"};
    static uint32_t pixels[64 * 48];
    ris_vk_image image;
    VkSampler sampler;
    ris_error err = {0};
    (void)state;
    assert_int_equal(ris_vk_image_create(vk, &def, &image, &err), RIS_OK);
    assert_int_equal(image.mip_count, 7);
    assert_int_equal(ris_vk_image_upload(vk, &image, pixels, &err), RIS_OK);
    assert_int_equal(ris_vk_sampler_create(vk, VK_SAMPLER_ADDRESS_MODE_REPEAT, 8.0f, &sampler, &err), RIS_OK);
    vkDestroySampler(vk->handle, sampler, NULL);
    ris_vk_image_finish(vk, &image);
    fail_on_messages();
}

/* Two copies into one buffer, with or without the barrier between them; returns the messages they caused. */
static uint32_t copy_twice(bool barrier)
{
    const uint32_t before = messages();
    const VkBufferCopy copy = {.size = 64};
    ris_vk_buffer a, b;
    ris_vk_cmd cmd;
    assert_int_equal(ris_vk_buffer_create(vk, RIS_VK_DEVICE, 64, 0, "a", &a, NULL), RIS_OK);
    assert_int_equal(ris_vk_buffer_create(vk, RIS_VK_DEVICE, 64, 0, "b", &b, NULL), RIS_OK);
    assert_int_equal(ris_vk_cmd_create(vk, "copy", &cmd, NULL), RIS_OK);
    assert_int_equal(ris_vk_cmd_begin(vk, &cmd, true, NULL), RIS_OK);
    vkCmdCopyBuffer(cmd.handle, a.handle, b.handle, 1, &copy);
    if (barrier) {
        ris_vk_barrier(cmd.handle, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_2_COPY_BIT,
                       VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    }
    vkCmdCopyBuffer(cmd.handle, b.handle, a.handle, 1, &copy);
    assert_int_equal(ris_vk_cmd_run(vk, &cmd, NULL), RIS_OK);
    ris_vk_cmd_finish(vk, &cmd);
    ris_vk_buffer_finish(vk, &a);
    ris_vk_buffer_finish(vk, &b);
    return messages() - before;
}

static void a_missing_barrier_fires(void **state)
{
    (void)state;
    assert_int_equal(copy_twice(true), 0);
    assert_true(copy_twice(false) > 0);
    assert_non_null(strstr(vk->message, "SYNC-HAZARD"));
}

static void a_copy_past_the_end_fires(void **state)
{
    const uint32_t before = messages();
    const VkBufferCopy copy = {.size = 128};
    ris_vk_buffer a;
    ris_vk_cmd cmd;
    (void)state;
    assert_int_equal(ris_vk_buffer_create(vk, RIS_VK_DEVICE, 64, 0, "short", &a, NULL), RIS_OK);
    assert_int_equal(ris_vk_cmd_create(vk, "copy", &cmd, NULL), RIS_OK);
    assert_int_equal(ris_vk_cmd_begin(vk, &cmd, true, NULL), RIS_OK);
    vkCmdCopyBuffer(cmd.handle, a.handle, a.handle, 1, &copy); /* recorded, never submitted */
    assert_int_equal(ris_vk_cmd_end(vk, &cmd, NULL), RIS_OK);
    assert_true(messages() > before);
    ris_vk_cmd_finish(vk, &cmd);
    ris_vk_buffer_finish(vk, &a);
}

int main(void)
{
    /* in this order: the silent ones first */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_simulation_is_silent),
        cmocka_unit_test(images_are_silent),
        cmocka_unit_test(a_missing_barrier_fires),
        cmocka_unit_test(a_copy_past_the_end_fires),
    };
    int failed;
    test_gpu_small();
    setenv("RIS_VALIDATION", "1", 1);
    vk = test_gpu_open();
    if (!ris_device_validates(vk)) {
        test_gpu_missing("validation is not on");
    }
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    ris_device_destroy(vk);
    return failed;
}
