/* 2D images: targets and mip-mapped textures uploaded by staging and blits. */
#include "vk.h"

#include <string.h>

static uint32_t full_chain(uint32_t width, uint32_t height)
{
    uint32_t largest = width > height ? width : height, count = 1;
    while (largest > 1) {
        largest /= 2;
        count++;
    }
    return count;
}

static ris_result create_view(ris_device *vk, ris_vk_image *image, ris_error *err)
{
    ris_result result = RIS_OK;
    VkImageViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                  .image = image->handle,
                                  .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                  .format = image->format,
                                  .subresourceRange = {image->aspect, 0, image->mip_count, 0, 1}};
    RIS_VK(vkCreateImageView(vk->handle, &info, NULL, &image->view));
fail:
    return result;
}

ris_result ris_vk_image_create(ris_device *vk, const ris_vk_image_def *def, ris_vk_image *out, ris_error *err)
{
    ris_result result = RIS_OK;
    const uint32_t limit = vk->properties.limits.maxImageDimension2D;
    VkMemoryRequirements requirements;
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = def->format,
                              .extent = {def->width, def->height, 1},
                              .arrayLayers = 1,
                              .samples = def->samples ? def->samples : VK_SAMPLE_COUNT_1_BIT,
                              .usage = def->usage};
    memset(out, 0, sizeof *out);
    if (def->width == 0 || def->height == 0 || def->width > limit || def->height > limit) {
        return ris_fail(err, RIS_ERROR_DEVICE, "image %s of %ux%u pixels, expected 1..%u each way on %s",
                        def->name, def->width, def->height, limit, vk->info.name);
    }
    out->format = def->format;
    out->aspect = def->aspect ? def->aspect : VK_IMAGE_ASPECT_COLOR_BIT;
    out->width = def->width;
    out->height = def->height;
    out->mip_count = def->mip_count ? def->mip_count : full_chain(def->width, def->height);
    info.mipLevels = out->mip_count;
    RIS_VK(vkCreateImage(vk->handle, &info, NULL, &out->handle));
    ris_vk_name(vk, VK_OBJECT_TYPE_IMAGE, (uint64_t)out->handle, def->name);
    vkGetImageMemoryRequirements(vk->handle, out->handle, &requirements);
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex =
        ris__vk_memory_type(vk, requirements.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    RIS_VK(vkAllocateMemory(vk->handle, &allocate, NULL, &out->memory));
    RIS_VK(vkBindImageMemory(vk->handle, out->handle, out->memory, 0));
    RIS_TRY(create_view(vk, out, err));
    return RIS_OK;
fail:
    ris_vk_image_finish(vk, out);
    return result;
}

void ris_vk_image_finish(ris_device *vk, ris_vk_image *image)
{
    if (image->view) {
        vkDestroyImageView(vk->handle, image->view, NULL);
    }
    if (image->handle) {
        vkDestroyImage(vk->handle, image->handle, NULL);
    }
    if (image->memory) {
        vkFreeMemory(vk->handle, image->memory, NULL);
    }
    memset(image, 0, sizeof *image);
}

/* Layout change of one level. */
static void level_barrier(VkCommandBuffer cmd, const ris_vk_image *image, uint32_t level, ris_vk_access from,
                          ris_vk_access to)
{
    const VkImageSubresourceRange one = {image->aspect, level, 1, 0, 1};
    ris_vk_range_barrier(cmd, image->handle, one, from, to);
}

static int32_t half(int32_t size)
{
    return size > 1 ? size / 2 : 1;
}

/* Level 0 is in TRANSFER_DST and written; makes the rest and leaves all levels readable by shaders. */
static void record_mips(VkCommandBuffer cmd, const ris_vk_image *image)
{
    const ris_vk_access written = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const ris_vk_access source = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const ris_vk_access sampled = {VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    int32_t width = (int32_t)image->width, height = (int32_t)image->height;
    for (uint32_t level = 1; level < image->mip_count; level++) {
        VkImageBlit blit = {.srcSubresource = {image->aspect, level - 1, 0, 1},
                            .srcOffsets = {{0, 0, 0}, {width, height, 1}},
                            .dstSubresource = {image->aspect, level, 0, 1},
                            .dstOffsets = {{0, 0, 0}, {half(width), half(height), 1}}};
        level_barrier(cmd, image, level - 1, written, source);
        vkCmdBlitImage(cmd, image->handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image->handle,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
        level_barrier(cmd, image, level - 1, source, sampled);
        width = half(width);
        height = half(height);
    }
    level_barrier(cmd, image, image->mip_count - 1, written, sampled);
}

ris_result ris_vk_image_upload(ris_device *vk, ris_vk_image *image, const void *pixels, ris_error *err)
{
    ris_result result = RIS_OK;
    const VkDeviceSize size = (VkDeviceSize)image->width * image->height * 4;
    const ris_vk_access nothing = {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_UNDEFINED};
    const ris_vk_access target = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    VkBufferImageCopy copy = {.imageSubresource = {image->aspect, 0, 0, 1},
                              .imageExtent = {image->width, image->height, 1}};
    ris_vk_buffer staging = {0};
    ris_vk_cmd cmd = {0};
    RIS_TRY(ris_vk_buffer_create(vk, RIS_VK_UPLOAD, size, 0, "image staging", &staging, err));
    memcpy(staging.data, pixels, (size_t)size);
    RIS_TRY(ris_vk_buffer_flush(vk, &staging, err));
    RIS_TRY(ris_vk_cmd_create(vk, "image upload", &cmd, err));
    RIS_TRY(ris_vk_cmd_begin(vk, &cmd, true, err));
    ris_vk_image_barrier(cmd.handle, image->handle, image->aspect, nothing, target);
    vkCmdCopyBufferToImage(cmd.handle, staging.handle, image->handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &copy);
    record_mips(cmd.handle, image);
    RIS_TRY(ris_vk_cmd_run(vk, &cmd, err));
fail:
    ris_vk_cmd_finish(vk, &cmd);
    ris_vk_buffer_finish(vk, &staging);
    return result;
}

ris_result ris_vk_sampler_create(ris_device *vk, VkSamplerAddressMode address, float anisotropy,
                                 VkSampler *out, ris_error *err)
{
    ris_result result = RIS_OK;
    const float limit = vk->properties.limits.maxSamplerAnisotropy;
    VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                .magFilter = VK_FILTER_LINEAR,
                                .minFilter = VK_FILTER_LINEAR,
                                .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                .addressModeU = address,
                                .addressModeV = address,
                                .addressModeW = address,
                                .maxLod = VK_LOD_CLAMP_NONE};
    *out = VK_NULL_HANDLE;
    if (anisotropy > 1.0f && vk->features.samplerAnisotropy) {
        info.anisotropyEnable = VK_TRUE;
        info.maxAnisotropy = anisotropy < limit ? anisotropy : limit;
    }
    RIS_VK(vkCreateSampler(vk->handle, &info, NULL, out));
fail:
    return result;
}
