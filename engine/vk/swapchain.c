/* Presents an offscreen image in a window: acquire, blit, present, rebuild when the size or the surface
 * changed. The source is drawn by engine/draw; nothing is drawn here, so that pictures and windows show
 * the same pixels. */
#include "vk.h"

#include <stdlib.h>
#include <string.h>

#define IMAGES_MAX 8

struct ris_vk_swapchain {
    ris_device *vk;
    VkSurfaceKHR surface;
    VkSwapchainKHR handle;
    VkExtent2D extent;
    uint32_t image_count;
    VkImage image[IMAGES_MAX];
    VkSemaphore acquired;
    VkSemaphore blitted[IMAGES_MAX]; /* one per image: presentation holds it until that image comes back */
    ris_vk_cmd cmd;
};

/* sRGB 8 bit where there is one, since the source is sRGB; else the first format offered. */
static ris_result choose_format(ris_device *vk, VkSurfaceKHR surface, VkSurfaceFormatKHR *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkSurfaceFormatKHR *formats = NULL;
    uint32_t count = 0;
    RIS_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(vk->physical, surface, &count, NULL));
    formats = calloc(count ? count : 1, sizeof *formats);
    if (!formats || count == 0) {
        result = ris_fail(err, formats ? RIS_ERROR_DEVICE : RIS_ERROR_MEMORY,
                          "%s offers %u formats for the window", vk->info.name, count);
        goto fail;
    }
    RIS_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(vk->physical, surface, &count, formats));
    *out = formats[0];
    for (uint32_t i = count; i-- > 0;) {
        if (formats[i].format == VK_FORMAT_B8G8R8A8_SRGB || formats[i].format == VK_FORMAT_R8G8B8A8_SRGB) {
            *out = formats[i];
        }
    }
fail:
    free(formats);
    return result;
}

static uint32_t clamp(uint32_t value, uint32_t low, uint32_t high)
{
    return value < low ? low : value > high ? high : value;
}

static void drop_images(ris_vk_swapchain *swapchain)
{
    for (uint32_t i = 0; i < IMAGES_MAX; i++) {
        vkDestroySemaphore(swapchain->vk->handle, swapchain->blitted[i], NULL);
        swapchain->blitted[i] = VK_NULL_HANDLE;
    }
    swapchain->image_count = 0;
}

static ris_result take_images(ris_vk_swapchain *swapchain, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_device *vk = swapchain->vk;
    const VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    uint32_t count = 0;
    RIS_VK(vkGetSwapchainImagesKHR(vk->handle, swapchain->handle, &count, NULL));
    if (count > IMAGES_MAX) {
        return ris_fail(err, RIS_ERROR_DEVICE, "swapchain of %u images, at most %d expected", count,
                        IMAGES_MAX);
    }
    RIS_VK(vkGetSwapchainImagesKHR(vk->handle, swapchain->handle, &count, swapchain->image));
    for (uint32_t i = 0; i < count; i++) {
        RIS_VK(vkCreateSemaphore(vk->handle, &info, NULL, &swapchain->blitted[i]));
    }
    swapchain->image_count = count;
fail:
    return result;
}

/* Makes the swapchain anew for the given size; leaves extent 0 when the surface has none now (minimised). */
static ris_result build(ris_vk_swapchain *swapchain, uint32_t width, uint32_t height, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_device *vk = swapchain->vk;
    VkSwapchainKHR old = swapchain->handle;
    VkSurfaceCapabilitiesKHR caps;
    VkSurfaceFormatKHR format = {0};
    VkSwapchainCreateInfoKHR info = {.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                     .surface = swapchain->surface,
                                     .imageArrayLayers = 1,
                                     .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                     .presentMode = VK_PRESENT_MODE_FIFO_KHR,
                                     .clipped = VK_TRUE,
                                     .oldSwapchain = old};
    RIS_VK(vkQueueWaitIdle(vk->queue));
    RIS_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(vk->physical, swapchain->surface, &caps));
    if (!(caps.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) {
        return ris_fail(err, RIS_ERROR_DEVICE, "%s cannot copy into window images", vk->info.name);
    }
    swapchain->extent = caps.currentExtent;
    if (caps.currentExtent.width == UINT32_MAX) { /* the window takes the size of the swapchain */
        swapchain->extent.width = clamp(width, caps.minImageExtent.width, caps.maxImageExtent.width);
        swapchain->extent.height = clamp(height, caps.minImageExtent.height, caps.maxImageExtent.height);
    }
    if (swapchain->extent.width == 0 || swapchain->extent.height == 0) {
        return RIS_OK;
    }
    RIS_TRY(choose_format(vk, swapchain->surface, &format, err));
    info.minImageCount = caps.minImageCount + 1;
    if (caps.maxImageCount && info.minImageCount > caps.maxImageCount) {
        info.minImageCount = caps.maxImageCount;
    }
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = swapchain->extent;
    info.preTransform = caps.currentTransform;
    info.compositeAlpha = caps.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    drop_images(swapchain);
    swapchain->handle = VK_NULL_HANDLE;
    RIS_VK(vkCreateSwapchainKHR(vk->handle, &info, NULL, &swapchain->handle));
    RIS_TRY(take_images(swapchain, err));
fail:
    if (swapchain->handle != old) {
        vkDestroySwapchainKHR(vk->handle, old, NULL);
    }
    return result;
}

ris_result ris_vk_swapchain_create(ris_device *vk, VkSurfaceKHR surface, uint32_t width, uint32_t height,
                                   ris_vk_swapchain **out, ris_error *err)
{
    ris_result result = RIS_OK;
    const VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkBool32 supported = VK_FALSE;
    ris_vk_swapchain *swapchain = calloc(1, sizeof *swapchain);
    *out = NULL;
    if (!swapchain) {
        vkDestroySurfaceKHR(vk->instance, surface, NULL);
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for a swapchain");
    }
    swapchain->vk = vk;
    swapchain->surface = surface;
    if (!vk->present) {
        result = ris_fail(err, RIS_ERROR_DEVICE, "%s was opened without present", vk->info.name);
        goto fail;
    }
    RIS_VK(vkGetPhysicalDeviceSurfaceSupportKHR(vk->physical, vk->family, surface, &supported));
    if (!supported) {
        result = ris_fail(err, RIS_ERROR_DEVICE, "%s cannot present to this window", vk->info.name);
        goto fail;
    }
    RIS_VK(vkCreateSemaphore(vk->handle, &info, NULL, &swapchain->acquired));
    RIS_TRY(ris_vk_cmd_create(vk, "present", &swapchain->cmd, err));
    RIS_TRY(build(swapchain, width, height, err));
    *out = swapchain;
    return RIS_OK;
fail:
    ris_vk_swapchain_destroy(swapchain);
    return result;
}

void ris_vk_swapchain_destroy(ris_vk_swapchain *swapchain)
{
    if (!swapchain) {
        return;
    }
    vkQueueWaitIdle(swapchain->vk->queue);
    ris_vk_cmd_finish(swapchain->vk, &swapchain->cmd);
    drop_images(swapchain);
    vkDestroySemaphore(swapchain->vk->handle, swapchain->acquired, NULL);
    vkDestroySwapchainKHR(swapchain->vk->handle, swapchain->handle, NULL);
    vkDestroySurfaceKHR(swapchain->vk->instance, swapchain->surface, NULL);
    free(swapchain);
}

static void record_blit(ris_vk_swapchain *swapchain, uint32_t index, VkImage source, ris_vk_access from,
                        uint32_t source_width, uint32_t source_height)
{
    const ris_vk_access read = {VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const ris_vk_access fresh = {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
    const ris_vk_access write = {VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const ris_vk_access shown = {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    const VkImageSubresourceLayers color = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkExtent2D size = swapchain->extent;
    VkImageBlit blit = {.srcSubresource = color,
                        .srcOffsets = {{0, 0, 0}, {(int32_t)source_width, (int32_t)source_height, 1}},
                        .dstSubresource = color,
                        .dstOffsets = {{0, 0, 0}, {(int32_t)size.width, (int32_t)size.height, 1}}};
    const bool same = source_width == size.width && source_height == size.height;
    VkCommandBuffer cmd = swapchain->cmd.handle;
    ris_vk_image_barrier(cmd, source, VK_IMAGE_ASPECT_COLOR_BIT, from, read);
    ris_vk_image_barrier(cmd, swapchain->image[index], VK_IMAGE_ASPECT_COLOR_BIT, fresh, write);
    vkCmdBlitImage(cmd, source, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, swapchain->image[index],
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                   same ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
    ris_vk_image_barrier(cmd, swapchain->image[index], VK_IMAGE_ASPECT_COLOR_BIT, write, shown);
}

static bool is_stale(VkResult result)
{
    return result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
}

ris_result ris_vk_swapchain_present(ris_vk_swapchain *swapchain, VkImage source, ris_vk_access from,
                                    uint32_t source_width, uint32_t source_height, uint32_t width,
                                    uint32_t height, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_device *vk = swapchain->vk;
    VkResult state;
    uint32_t index = 0;
    VkPresentInfoKHR present = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .waitSemaphoreCount = 1,
                                .swapchainCount = 1,
                                .pSwapchains = &swapchain->handle,
                                .pImageIndices = &index};
    if (width == 0 || height == 0) {
        return RIS_OK;
    }
    if (!swapchain->handle || swapchain->extent.width != width || swapchain->extent.height != height) {
        RIS_TRY(build(swapchain, width, height, err));
    }
    if (swapchain->extent.width == 0 || swapchain->extent.height == 0) {
        return RIS_OK;
    }
    state = vkAcquireNextImageKHR(vk->handle, swapchain->handle, RIS_VK_TIMEOUT_NS, swapchain->acquired,
                                  VK_NULL_HANDLE, &index);
    if (state == VK_ERROR_OUT_OF_DATE_KHR) {
        return build(swapchain, width, height, err); /* this frame is skipped, the next is shown */
    }
    if (state != VK_SUCCESS && state != VK_SUBOPTIMAL_KHR) {
        return ris__vk_fail(vk, err, state, "vkAcquireNextImageKHR", __FILE__, __LINE__);
    }
    present.pWaitSemaphores = &swapchain->blitted[index];
    RIS_TRY(ris_vk_cmd_begin(vk, &swapchain->cmd, true, err));
    record_blit(swapchain, index, source, from, source_width, source_height);
    RIS_TRY(ris_vk_cmd_end(vk, &swapchain->cmd, err));
    RIS_TRY(ris_vk_cmd_submit(vk, &swapchain->cmd, swapchain->acquired, swapchain->blitted[index], err));
    state = vkQueuePresentKHR(vk->queue, &present);
    if (state != VK_SUCCESS && !is_stale(state)) {
        return ris__vk_fail(vk, err, state, "vkQueuePresentKHR", __FILE__, __LINE__);
    }
    RIS_TRY(ris_vk_cmd_wait(vk, &swapchain->cmd, err));
    if (is_stale(state)) {
        RIS_TRY(build(swapchain, width, height, err));
    }
fail:
    return result;
}
