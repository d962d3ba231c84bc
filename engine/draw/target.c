/* The images a frame is drawn into: 4-sample colour and depth, the resolved picture, and the buffer it is read through. */
#include "draw/draw_impl.h"

ris_result ris__draw_target_create(ris_device *device, uint32_t width, uint32_t height, ris_draw_target *out,
                                   ris_error *err)
{
    const ris_vk_image_def many = {.width = width,
                                   .height = height,
                                   .format = RIS_DRAW_COLOR_FORMAT,
                                   .mip_count = 1,
                                   .samples = VK_SAMPLE_COUNT_4_BIT,
                                   .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                   .name = "draw samples"};
    const ris_vk_image_def depth = {.width = width,
                                    .height = height,
                                    .format = RIS_DRAW_DEPTH_FORMAT,
                                    .mip_count = 1,
                                    .samples = VK_SAMPLE_COUNT_4_BIT,
                                    .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                                    .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                    .name = "draw depth"};
    const ris_vk_image_def color = {.width = width,
                                    .height = height,
                                    .format = RIS_DRAW_COLOR_FORMAT,
                                    .mip_count = 1,
                                    .usage =
                                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                    .name = "draw picture"};
    ris_result result;
    *out = (ris_draw_target){.width = width, .height = height};
    RIS_TRY(ris_vk_image_create(device, &many, &out->many, err));
    RIS_TRY(ris_vk_image_create(device, &depth, &out->depth, err));
    RIS_TRY(ris_vk_image_create(device, &color, &out->color, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_READBACK, (VkDeviceSize)width * height * 4, 0,
                                 "draw readback", &out->readback, err));
    return RIS_OK;
fail:
    ris__draw_target_finish(device, out);
    return result;
}

void ris__draw_target_finish(ris_device *device, ris_draw_target *target)
{
    ris_vk_image_finish(device, &target->many);
    ris_vk_image_finish(device, &target->depth);
    ris_vk_image_finish(device, &target->color);
    ris_vk_buffer_finish(device, &target->readback);
    *target = (ris_draw_target){0};
}
