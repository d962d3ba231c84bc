/* Buffers by use: device local, upload, readback. One allocation per buffer; callers cut few large ones
 * into ranges. */
#include "vk.h"

#include <string.h>

uint32_t ris__vk_memory_type(const ris_device *vk, uint32_t type_bits, VkMemoryPropertyFlags wanted,
                             VkMemoryPropertyFlags preferred)
{
    for (int pass = 0; pass < 2; pass++) {
        VkMemoryPropertyFlags need = pass == 0 ? wanted | preferred : wanted;
        for (uint32_t i = 0; i < vk->memory.memoryTypeCount; i++) {
            if ((type_bits >> i & 1) && (vk->memory.memoryTypes[i].propertyFlags & need) == need) {
                return i;
            }
        }
    }
    return UINT32_MAX;
}

/* Flags a memory type must and should have, by use. */
static void memory_flags(ris_vk_use use, VkMemoryPropertyFlags *wanted, VkMemoryPropertyFlags *preferred)
{
    switch (use) {
    case RIS_VK_UPLOAD:
        *wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
        *preferred = VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
        break;
    case RIS_VK_READBACK:
        *wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
        *preferred = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
        break;
    case RIS_VK_DEVICE:
    default:
        *wanted = 0;
        *preferred = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
        break;
    }
}

ris_result ris_vk_buffer_create(ris_device *vk, ris_vk_use use, VkDeviceSize size, VkBufferUsageFlags usage,
                                const char *name, ris_vk_buffer *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkMemoryRequirements requirements;
    VkMemoryPropertyFlags wanted, preferred, flags;
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = size,
                               .usage = usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                        VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    memset(out, 0, sizeof *out);
    if (size == 0) {
        return ris_fail(err, RIS_ERROR_DEVICE, "buffer %s has size 0", name);
    }
    RIS_VK(vkCreateBuffer(vk->handle, &info, NULL, &out->handle));
    ris_vk_name(vk, VK_OBJECT_TYPE_BUFFER, (uint64_t)out->handle, name);
    vkGetBufferMemoryRequirements(vk->handle, out->handle, &requirements);
    memory_flags(use, &wanted, &preferred);
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = ris__vk_memory_type(vk, requirements.memoryTypeBits, wanted, preferred);
    if (allocate.memoryTypeIndex == UINT32_MAX) {
        result = ris_fail(err, RIS_ERROR_DEVICE, "%s has no memory type for buffer %s", vk->info.name, name);
        goto fail;
    }
    flags = vk->memory.memoryTypes[allocate.memoryTypeIndex].propertyFlags;
    out->coherent = (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
    out->cached = (flags & VK_MEMORY_PROPERTY_HOST_CACHED_BIT) != 0;
    out->device_local =
        (flags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0 && !(vk->staging && use != RIS_VK_DEVICE);
    out->size = size;
    RIS_VK(vkAllocateMemory(vk->handle, &allocate, NULL, &out->memory));
    RIS_VK(vkBindBufferMemory(vk->handle, out->handle, out->memory, 0));
    if ((flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) && !(vk->staging && use == RIS_VK_DEVICE)) {
        RIS_VK(vkMapMemory(vk->handle, out->memory, 0, VK_WHOLE_SIZE, 0, &out->data));
    }
    return RIS_OK;
fail:
    ris_vk_buffer_finish(vk, out);
    return result;
}

void ris_vk_buffer_finish(ris_device *vk, ris_vk_buffer *buffer)
{
    if (buffer->handle) {
        vkDestroyBuffer(vk->handle, buffer->handle, NULL);
    }
    if (buffer->memory) {
        vkFreeMemory(vk->handle, buffer->memory, NULL); /* unmaps */
    }
    memset(buffer, 0, sizeof *buffer);
}

ris_result ris_vk_buffer_flush(ris_device *vk, const ris_vk_buffer *buffer, ris_error *err)
{
    ris_result result = RIS_OK;
    VkMappedMemoryRange range = {
        .sType = VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, .memory = buffer->memory, .size = VK_WHOLE_SIZE};
    if (!buffer->coherent) {
        RIS_VK(vkFlushMappedMemoryRanges(vk->handle, 1, &range));
    }
fail:
    return result;
}

ris_result ris_vk_buffer_invalidate(ris_device *vk, const ris_vk_buffer *buffer, ris_error *err)
{
    ris_result result = RIS_OK;
    VkMappedMemoryRange range = {
        .sType = VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, .memory = buffer->memory, .size = VK_WHOLE_SIZE};
    if (!buffer->coherent) {
        RIS_VK(vkInvalidateMappedMemoryRanges(vk->handle, 1, &range));
    }
fail:
    return result;
}

/* Copies between a buffer and a fresh staging buffer on the queue; writes when data is given, else reads
 * into out. */
static ris_result staged(ris_device *vk, ris_vk_buffer *buffer, VkDeviceSize offset, const void *data,
                         void *out, VkDeviceSize size, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_vk_buffer staging = {0};
    ris_vk_cmd cmd = {0};
    VkBufferCopy copy = {.size = size};
    const VkPipelineStageFlags2 all = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    const VkAccessFlags2 any = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    RIS_TRY(
        ris_vk_buffer_create(vk, data ? RIS_VK_UPLOAD : RIS_VK_READBACK, size, 0, "staging", &staging, err));
    RIS_TRY(ris_vk_cmd_create(vk, "staging", &cmd, err));
    RIS_TRY(ris_vk_cmd_begin(vk, &cmd, true, err));
    ris_vk_barrier(cmd.handle, all, any, VK_PIPELINE_STAGE_2_COPY_BIT,
                   VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    if (data) {
        memcpy(staging.data, data, (size_t)size);
        RIS_TRY(ris_vk_buffer_flush(vk, &staging, err));
        copy.dstOffset = offset;
        vkCmdCopyBuffer(cmd.handle, staging.handle, buffer->handle, 1, &copy);
        ris_vk_barrier(cmd.handle, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, all, any);
    } else {
        copy.srcOffset = offset;
        vkCmdCopyBuffer(cmd.handle, buffer->handle, staging.handle, 1, &copy);
        ris_vk_barrier(cmd.handle, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    }
    RIS_TRY(ris_vk_cmd_run(vk, &cmd, err));
    if (out) {
        RIS_TRY(ris_vk_buffer_invalidate(vk, &staging, err));
        memcpy(out, staging.data, (size_t)size);
    }
fail:
    ris_vk_cmd_finish(vk, &cmd);
    ris_vk_buffer_finish(vk, &staging);
    return result;
}

ris_result ris_vk_buffer_write(ris_device *vk, ris_vk_buffer *buffer, VkDeviceSize offset, const void *data,
                               VkDeviceSize size, ris_error *err)
{
    if (buffer->data) {
        memcpy((char *)buffer->data + offset, data, (size_t)size);
        return ris_vk_buffer_flush(vk, buffer, err);
    }
    return staged(vk, buffer, offset, data, NULL, size, err);
}

ris_result ris_vk_buffer_read(ris_device *vk, ris_vk_buffer *buffer, VkDeviceSize offset, void *out,
                              VkDeviceSize size, ris_error *err)
{
    return staged(vk, buffer, offset, NULL, out, size, err);
}

VkDeviceSize ris_vk_range(const ris_device *vk, VkDeviceSize *cursor, VkDeviceSize size)
{
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    VkDeviceSize align = 64, start; /* a cache line, and the alignment of copies */
    if (align < limits->minStorageBufferOffsetAlignment) {
        align = limits->minStorageBufferOffsetAlignment;
    }
    if (align < limits->minUniformBufferOffsetAlignment) {
        align = limits->minUniformBufferOffsetAlignment;
    }
    if (align < limits->minTexelBufferOffsetAlignment) {
        align = limits->minTexelBufferOffsetAlignment;
    }
    start = (*cursor + align - 1) / align * align;
    *cursor = start + size;
    return start;
}
