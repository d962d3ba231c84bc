/* Command buffers with a fence, global barriers, timestamps. */
#include "vk.h"

#include <string.h>

void ris_vk_barrier(VkCommandBuffer cmd, VkPipelineStageFlags2 src_stage, VkAccessFlags2 src_access,
                    VkPipelineStageFlags2 dst_stage, VkAccessFlags2 dst_access)
{
    VkMemoryBarrier2 barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                .srcStageMask = src_stage,
                                .srcAccessMask = src_access,
                                .dstStageMask = dst_stage,
                                .dstAccessMask = dst_access};
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(cmd, &info);
}

void ris_vk_range_barrier(VkCommandBuffer cmd, VkImage image, VkImageSubresourceRange range,
                          ris_vk_access from, ris_vk_access to)
{
    VkImageMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = from.stage,
        .srcAccessMask = from.access,
        .oldLayout = from.layout,
        .dstStageMask = to.stage,
        .dstAccessMask = to.access,
        .newLayout = to.layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = range,
    };
    VkDependencyInfo info = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                             .imageMemoryBarrierCount = 1,
                             .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(cmd, &info);
}

void ris_vk_image_barrier(VkCommandBuffer cmd, VkImage image, VkImageAspectFlags aspect, ris_vk_access from,
                          ris_vk_access to)
{
    const VkImageSubresourceRange all = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    ris_vk_range_barrier(cmd, image, all, from, to);
}

ris_result ris_vk_cmd_create(ris_device *vk, const char *name, ris_vk_cmd *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = vk->pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    memset(out, 0, sizeof *out);
    RIS_VK(vkAllocateCommandBuffers(vk->handle, &info, &out->handle));
    RIS_VK(vkCreateFence(vk->handle, &fence, NULL, &out->fence));
    ris_vk_name(vk, VK_OBJECT_TYPE_COMMAND_BUFFER, (uint64_t)(uintptr_t)out->handle, name);
    return RIS_OK;
fail:
    ris_vk_cmd_finish(vk, out);
    return result;
}

void ris_vk_cmd_finish(ris_device *vk, ris_vk_cmd *cmd)
{
    if (cmd->pending) {
        vkWaitForFences(vk->handle, 1, &cmd->fence, VK_TRUE, RIS_VK_TIMEOUT_NS);
    }
    if (cmd->fence) {
        vkDestroyFence(vk->handle, cmd->fence, NULL);
    }
    if (cmd->handle) {
        vkFreeCommandBuffers(vk->handle, vk->pool, 1, &cmd->handle);
    }
    memset(cmd, 0, sizeof *cmd);
}

ris_result ris_vk_cmd_begin(ris_device *vk, ris_vk_cmd *cmd, bool one_time, ris_error *err)
{
    ris_result result = RIS_OK;
    VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                     .flags = one_time ? VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT : 0};
    if (cmd->pending) {
        RIS_TRY(ris_vk_cmd_wait(vk, cmd, err));
    }
    RIS_VK(vkBeginCommandBuffer(cmd->handle, &info));
fail:
    return result;
}

ris_result ris_vk_cmd_end(ris_device *vk, ris_vk_cmd *cmd, ris_error *err)
{
    ris_result result = RIS_OK;
    RIS_VK(vkEndCommandBuffer(cmd->handle));
fail:
    return result;
}

ris_result ris_vk_cmd_submit(ris_device *vk, ris_vk_cmd *cmd, VkSemaphore wait, VkSemaphore signal,
                             ris_error *err)
{
    ris_result result = RIS_OK;
    VkCommandBufferSubmitInfo buffer = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                        .commandBuffer = cmd->handle};
    VkSemaphoreSubmitInfo before = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                    .semaphore = wait,
                                    .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    VkSemaphoreSubmitInfo after = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                   .semaphore = signal,
                                   .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    VkSubmitInfo2 info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                          .commandBufferInfoCount = 1,
                          .pCommandBufferInfos = &buffer,
                          .waitSemaphoreInfoCount = wait ? 1 : 0,
                          .pWaitSemaphoreInfos = &before,
                          .signalSemaphoreInfoCount = signal ? 1 : 0,
                          .pSignalSemaphoreInfos = &after};
    RIS_VK(vkResetFences(vk->handle, 1, &cmd->fence));
    RIS_VK(vkQueueSubmit2(vk->queue, 1, &info, cmd->fence));
    cmd->pending = true;
fail:
    return result;
}

ris_result ris_vk_cmd_wait(ris_device *vk, ris_vk_cmd *cmd, ris_error *err)
{
    ris_result result = RIS_OK;
    VkResult waited;
    if (!cmd->pending) {
        return RIS_OK;
    }
    waited = ris__vk_gate(vk);
    if (waited == VK_SUCCESS) {
        waited = vkWaitForFences(vk->handle, 1, &cmd->fence, VK_TRUE, RIS_VK_TIMEOUT_NS);
    }
    if (waited == VK_TIMEOUT) {
        vk->lost = true;
        return ris_fail(err, RIS_ERROR_DEVICE, "%s did not finish within %llu s", vk->info.name,
                        (unsigned long long)(RIS_VK_TIMEOUT_NS / 1000000000ull));
    }
    if (waited != VK_SUCCESS) {
        return ris__vk_fail(vk, err, waited, "vkWaitForFences", __FILE__, __LINE__);
    }
    cmd->pending = false;
    return result;
}

ris_result ris_vk_cmd_run(ris_device *vk, ris_vk_cmd *cmd, ris_error *err)
{
    ris_result result;
    RIS_TRY(ris_vk_cmd_end(vk, cmd, err));
    RIS_TRY(ris_vk_cmd_submit(vk, cmd, VK_NULL_HANDLE, VK_NULL_HANDLE, err));
    RIS_TRY(ris_vk_cmd_wait(vk, cmd, err));
fail:
    return result;
}

ris_result ris_vk_query_create(ris_device *vk, uint32_t count, ris_vk_query *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                  .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                  .queryCount = count};
    memset(out, 0, sizeof *out);
    if (count == 0 || vk->timestamp_bits == 0) {
        return RIS_OK;
    }
    RIS_VK(vkCreateQueryPool(vk->handle, &info, NULL, &out->pool));
    out->count = count;
    out->tick_ms = (double)vk->properties.limits.timestampPeriod * 1e-6;
    out->mask = vk->timestamp_bits >= 64 ? UINT64_MAX : (UINT64_C(1) << vk->timestamp_bits) - 1;
fail:
    return result;
}

void ris_vk_query_finish(ris_device *vk, ris_vk_query *query)
{
    if (query->pool) {
        vkDestroyQueryPool(vk->handle, query->pool, NULL);
    }
    memset(query, 0, sizeof *query);
}

void ris_vk_query_reset(VkCommandBuffer cmd, const ris_vk_query *query)
{
    if (query->pool) {
        vkCmdResetQueryPool(cmd, query->pool, 0, query->count);
    }
}

void ris_vk_query_write(VkCommandBuffer cmd, const ris_vk_query *query, uint32_t index)
{
    if (query->pool) {
        vkCmdWriteTimestamp2(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, query->pool, index);
    }
}

ris_result ris_vk_query_read(ris_device *vk, const ris_vk_query *query, uint64_t *out, ris_error *err)
{
    ris_result result = RIS_OK;
    if (query->pool) {
        RIS_VK(vkGetQueryPoolResults(vk->handle, query->pool, 0, query->count, query->count * sizeof *out,
                                     out, sizeof *out, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    }
fail:
    return result;
}
