/* lavapipe stops the loops of an invocation after 65,535 iterations, summed over all its loops, without a
 * word. That is why the substeps of a tick are separate dispatches and why a vertex may have at most
 * 30,000 springs (engine/sim/vk/vk_state.c). This test pins what is known, so that whoever moves a loop
 * into a shader meets it here first. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

#include "gpu/gpu.h"
#include "test/loop_limit_comp.h"
#include "vk/vk.h"

#define LIMIT 65535u

typedef struct loops {
    uint32_t first_wanted, second_wanted, first_run, second_run, step;
} loops;

static ris_device *vk;

/* Runs the shader with the wanted counts and returns the counts it reached. */
static loops run(uint32_t first, uint32_t second)
{
    ris_error err = {0};
    ris_vk_buffer buffer;
    ris_vk_sets sets;
    ris_vk_cmd cmd;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    const VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    loops value = {first, second, 0, 0, 1};
    assert_int_equal(ris_vk_buffer_create(vk, RIS_VK_DEVICE, sizeof value, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                          "loops", &buffer, &err),
                     RIS_OK);
    assert_int_equal(ris_vk_buffer_write(vk, &buffer, 0, &value, sizeof value, &err), RIS_OK);
    assert_int_equal(ris_vk_sets_create(vk, &type, 1, VK_SHADER_STAGE_COMPUTE_BIT, 1, &sets, &err), RIS_OK);
    ris_vk_sets_write_buffer(vk, &sets, 0, 0, buffer.handle, 0, sizeof value);
    assert_int_equal(ris_vk_layout_create(vk, sets.layout, 0, 0, &layout, &err), RIS_OK);
    assert_int_equal(ris_vk_compute_create(vk, layout, RIS_VK_CODE(ris_spv_loop_limit_comp), NULL,
                                           "loop_limit", &pipeline, &err),
                     RIS_OK);
    assert_int_equal(ris_vk_cmd_create(vk, "loop_limit", &cmd, &err), RIS_OK);
    assert_int_equal(ris_vk_cmd_begin(vk, &cmd, true, &err), RIS_OK);
    vkCmdBindPipeline(cmd.handle, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(cmd.handle, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, sets.set, 0, NULL);
    vkCmdDispatch(cmd.handle, 1, 1, 1);
    assert_int_equal(ris_vk_cmd_run(vk, &cmd, &err), RIS_OK);
    assert_int_equal(ris_vk_buffer_read(vk, &buffer, 0, &value, sizeof value, &err), RIS_OK);
    ris_vk_cmd_finish(vk, &cmd);
    vkDestroyPipeline(vk->handle, pipeline, NULL);
    vkDestroyPipelineLayout(vk->handle, layout, NULL);
    ris_vk_sets_finish(vk, &sets);
    ris_vk_buffer_finish(vk, &buffer);
    return value;
}

/* What the engine allows itself is right on every device. */
static void the_bound_of_the_engine_holds(void **state)
{
    (void)state;
    loops value = run(30000, 30000);
    assert_int_equal(value.first_run, 30000);
    assert_int_equal(value.second_run, 30000);
    value = run(LIMIT, 0);
    assert_int_equal(value.first_run, LIMIT);
}

/* On the pinned lavapipe the next iteration is lost, and so is the rest of every later loop. */
static void lavapipe_stops_silently(void **state)
{
    (void)state;
    const loops value = run(LIMIT + 1, 1000);
    print_message("wanted %u + 1000 iterations, ran %u + %u\n", LIMIT + 1, value.first_run, value.second_run);
    if (strstr(ris_device_get_info(vk)->driver, "Mesa 22.3")) {
        assert_int_equal(value.first_run, LIMIT);
        assert_true(value.second_run <= 1);
    } else if (!test_gpu_is_lavapipe(vk)) {
        assert_int_equal(value.first_run, LIMIT + 1);
        assert_int_equal(value.second_run, 1000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bound_of_the_engine_holds),
        cmocka_unit_test(lavapipe_stops_silently),
    };
    test_gpu_small();
    vk = test_gpu_open();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    ris_device_destroy(vk);
    return failed;
}
