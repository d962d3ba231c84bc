/* Life of a ris_draw and of a window. The picture itself: frame.c. */
#include "draw/draw_impl.h"

#include <stdlib.h>

static ris_result check_size(uint32_t width, uint32_t height, ris_error *err)
{
    if (width == 0 || height == 0 || width > 8192 || height > 8192) {
        return ris_fail(err, RIS_ERROR_USAGE, "picture size must be 1 to 8192 each way, found %ux%u",
                        (unsigned)width, (unsigned)height);
    }
    return RIS_OK;
}

ris_result ris_draw_create(ris_device *device, const ris_model *model, const ris_draw_def *def,
                           ris_draw **out, ris_error *err)
{
    *out = NULL;
    ris_result result = check_size(def->width, def->height, err);
    if (result != RIS_OK) {
        return result;
    }
    ris_draw *draw = calloc(1, sizeof *draw);
    if (draw == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing");
    }
    draw->device = device;
    draw->model = model;
    draw->wireframe = def->wireframe;
    draw->paper = def->paper;
    draw->shown = RIS_LAYER_SKIN;
    RIS_TRY(ris__draw_scene_build(model, &draw->scene, err));
    RIS_TRY(ris__draw_store_create(draw, err));
    RIS_TRY(ris__draw_target_create(device, def->width, def->height, &draw->target, err));
    RIS_TRY(ris__draw_pipes_create(draw, err));
    RIS_TRY(ris_vk_cmd_create(device, "draw", &draw->cmd, err));
    RIS_TRY(ris_vk_cmd_create(device, "draw copy", &draw->copy, err));
    RIS_TRY(ris_draw_set_layers(draw, def->layers, err));
    *out = draw;
    return RIS_OK;
fail:
    ris_draw_destroy(draw);
    return result;
}

void ris_draw_destroy(ris_draw *draw)
{
    if (draw == NULL) {
        return;
    }
    ris_vk_cmd_finish(draw->device, &draw->cmd);
    ris_vk_cmd_finish(draw->device, &draw->copy);
    ris__draw_layers_finish(draw);
    ris__draw_pipes_finish(draw);
    ris__draw_target_finish(draw->device, &draw->target);
    ris__draw_store_finish(draw);
    ris__draw_scene_finish(&draw->scene);
    free(draw);
}

ris_result ris_draw_resize(ris_draw *draw, uint32_t width, uint32_t height, ris_error *err)
{
    ris_result result = check_size(width, height, err);
    if (result != RIS_OK || (width == draw->target.width && height == draw->target.height)) {
        return result;
    }
    ris_draw_target fresh;
    result = ris__draw_target_create(draw->device, width, height, &fresh, err);
    if (result == RIS_OK) {
        ris__draw_target_finish(draw->device, &draw->target);
        draw->target = fresh;
        draw->drawn = false;
    }
    return result;
}

void ris_draw_set_wireframe(ris_draw *draw, bool wireframe)
{
    draw->wireframe = wireframe;
}

ris_result ris_draw_set_layers(ris_draw *draw, uint32_t layers, ris_error *err)
{
    if (layers >> RIS_LAYER_COUNT != 0) {
        return ris_fail(err, RIS_ERROR_USAGE, "there is no layer %#x", (unsigned)layers);
    }
    layers = layers == 0 ? RIS_LAYER_SKIN : layers;
    ris_result result = layers == RIS_LAYER_SKIN ? RIS_OK : ris__draw_layers_create(draw, err);
    draw->shown = result == RIS_OK ? layers : draw->shown;
    return result;
}

void ris_draw_set_muscles(ris_draw *draw, const bool *shown)
{
    for (uint32_t m = 0; draw->layers.ready && m < draw->model->muscle_count; m++) {
        draw->layers.shown[m] = shown == NULL || shown[m];
    }
}

void ris_draw_set_mandible(ris_draw *draw, bool shown)
{
    draw->jawless = !shown;
}

void *ris_device_instance(ris_device *device)
{
    return device->instance;
}

struct ris_window {
    ris_device *device;
    ris_vk_swapchain *swapchain;
};

ris_result ris_window_create(ris_device *device, uint64_t surface, uint32_t width, uint32_t height,
                             ris_window **out, ris_error *err)
{
    VkSurfaceKHR handle;
    *out = NULL;
#if defined(__LP64__) || defined(_WIN64)
    handle = (VkSurfaceKHR)(uintptr_t)surface;
#else
    handle = surface;
#endif
    ris_window *window = calloc(1, sizeof *window);
    if (window == NULL) {
        vkDestroySurfaceKHR(device->instance, handle, NULL);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the window");
    }
    window->device = device;
    ris_result result = ris_vk_swapchain_create(device, handle, width, height, &window->swapchain, err);
    if (result != RIS_OK) {
        free(window);
        return result;
    }
    *out = window;
    return RIS_OK;
}

ris_result ris_window_present(ris_window *window, ris_draw *draw, uint32_t width, uint32_t height,
                              ris_error *err)
{
    const ris_vk_access from = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    if (!draw->drawn) {
        return ris_fail(err, RIS_ERROR_USAGE, "no frame has been drawn yet");
    }
    return ris_vk_swapchain_present(window->swapchain, draw->target.color.handle, from, draw->target.width,
                                    draw->target.height, width, height, err);
}

void ris_window_destroy(ris_window *window)
{
    if (window != NULL) {
        ris_vk_swapchain_destroy(window->swapchain);
        free(window);
    }
}
