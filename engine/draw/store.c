/* Uploads a scene: constant weights, rings, corners and indices, textures, and the buffers written every frame. */
#include "draw/draw_impl.h"

#include <stdlib.h>

static ris_result fill(ris_device *device, const char *name, const void *data, size_t size,
                       VkBufferUsageFlags usage, ris_vk_buffer *out, ris_error *err)
{
    VkDeviceSize room = size > 0 ? size : 16; /* an empty buffer cannot be bound */
    ris_result result = ris_vk_buffer_create(device, RIS_VK_DEVICE, room, usage, name, out, err);
    if (result == RIS_OK && size > 0) {
        result = ris_vk_buffer_write(device, out, 0, data, size, err);
    }
    return result;
}

static ris_result load_textures(ris_draw *draw, ris_error *err)
{
    ris_draw_store *store = &draw->store;
    static const uint8_t white[4] = {255, 255, 255, 255}, flat[4] = {128, 110, 0, 255};
    const uint8_t smooth[4] = {(uint8_t)(255.0 * RIS_DRAW_WRINKLE_FLAT + 0.5), 0, 0, 255};
    uint32_t count = draw->scene.texture_count;
    store->texture = calloc(count + 1, sizeof *store->texture);
    store->detail = calloc(count + 1, sizeof *store->detail);
    store->wrinkle = calloc(count + 1, sizeof *store->wrinkle);
    if (store->texture == NULL || store->detail == NULL || store->wrinkle == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u textures", (unsigned)count);
    }
    store->texture_count = count;
    for (uint32_t i = 0; i < count; i++) {
        const char *path = draw->scene.texture[i];
        ris_result result =
            ris__draw_texture_load(draw->device, path, VK_FORMAT_R8G8B8A8_UNORM, &store->texture[i], err);
        if (result == RIS_OK) {
            result = ris__draw_texture_beside(draw->device, path, "detail", &store->detail[i], err);
        }
        if (result == RIS_OK) {
            result = ris__draw_texture_beside(draw->device, path, "wrinkles", &store->wrinkle[i], err);
        }
        if (result != RIS_OK) {
            return result;
        }
    }
    const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
    ris_result result = ris__draw_texture_plain(draw->device, white, format, &store->texture[count], err);
    if (result == RIS_OK) {
        result = ris__draw_texture_plain(draw->device, flat, format, &store->detail[count], err);
    }
    return result != RIS_OK
               ? result
               : ris__draw_texture_plain(draw->device, smooth, format, &store->wrinkle[count], err);
}

static ris_result create_shadow_sampler(ris_draw *draw, ris_error *err)
{
    ris_device *vk = draw->device;
    ris_result result = RIS_OK;
    const VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                      .magFilter = VK_FILTER_NEAREST,
                                      .minFilter = VK_FILTER_NEAREST,
                                      .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                      .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    RIS_VK(vkCreateSampler(vk->handle, &info, NULL, &draw->store.shadow_sampler));
fail:
    return result;
}

ris_result ris__draw_store_create(ris_draw *draw, ris_error *err)
{
    ris_device *device = draw->device;
    const ris_draw_scene *scene = &draw->scene;
    ris_draw_store *store = &draw->store;
    const VkBufferUsageFlags data = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             index = VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    const size_t skin = (size_t)scene->skin_count, vertices = (size_t)scene->vertex_count;
    const ris_vk_image_def shadow = {.width = RIS_DRAW_SHADOW_SIDE,
                                     .height = RIS_DRAW_SHADOW_SIDE,
                                     .mip_count = 1,
                                     .format = RIS_DRAW_DEPTH_FORMAT,
                                     .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                                     .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                              VK_IMAGE_USAGE_SAMPLED_BIT,
                                     .name = "key light depth"};
    ris_result result;
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_UPLOAD,
                                 (VkDeviceSize)draw->model->node_count * sizeof(ris_vec4), data, "draw nodes",
                                 &store->node, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_UPLOAD, sizeof(ris_draw_view), data, "draw view",
                                 &store->view, err));
    RIS_TRY(
        fill(device, "draw term start", scene->term_start, (skin + 1) * 4, data, &store->term_start, err));
    RIS_TRY(fill(device, "draw terms", scene->term, scene->term_count * sizeof *scene->term, data,
                 &store->term, err));
    RIS_TRY(
        fill(device, "draw ring start", scene->ring_start, (skin + 1) * 4, data, &store->ring_start, err));
    RIS_TRY(fill(device, "draw rings", scene->ring, (size_t)scene->ring_count * 8, data, &store->ring, err));
    RIS_TRY(fill(device, "draw rides", scene->ride, scene->ride_count * sizeof *scene->ride, data,
                 &store->ride, err));
    RIS_TRY(fill(device, "draw positions", scene->position, vertices * 16, data, &store->position, err));
    RIS_TRY(fill(device, "draw normals", scene->normal, vertices * 16, data, &store->normal, err));
    RIS_TRY(fill(device, "draw rest", scene->rest, vertices * 16, data, &store->rest, err));
    RIS_TRY(fill(device, "draw folds", scene->fold, skin * 16, data, &store->fold, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_DEVICE, (skin + 1) * sizeof(ris_draw_squeeze), data,
                                 "draw squeeze", &store->squeeze, err));
    RIS_TRY(fill(device, "draw corners", scene->corner, scene->corner_count * sizeof *scene->corner, data,
                 &store->corner, err));
    RIS_TRY(fill(device, "draw triangles", scene->index, (size_t)scene->index_count * 4, index, &store->index,
                 err));
    RIS_TRY(
        fill(device, "draw casters", scene->cast, (size_t)scene->cast_count * 4, index, &store->cast, err));
    RIS_TRY(fill(device, "draw lines", scene->line, (size_t)scene->line_count * 4, index, &store->line, err));
    RIS_TRY(ris_vk_image_create(device, &shadow, &draw->shadow, err));
    RIS_TRY(ris_vk_sampler_create(device, VK_SAMPLER_ADDRESS_MODE_REPEAT, 0.0f, &store->sampler, err));
    RIS_TRY(create_shadow_sampler(draw, err));
    RIS_TRY(load_textures(draw, err));
fail:
    return result; /* the caller finishes what there is */
}

void ris__draw_store_finish(ris_draw *draw)
{
    ris_device *device = draw->device;
    ris_draw_store *store = &draw->store;
    ris_vk_buffer *all[] = {&store->node,       &store->view, &store->term_start, &store->term,
                            &store->ring_start, &store->ring, &store->ride,       &store->position,
                            &store->normal,     &store->rest, &store->squeeze,    &store->corner,
                            &store->index,      &store->line, &store->cast,       &store->fold};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        ris_vk_buffer_finish(device, all[i]);
    }
    const bool textures = store->texture != NULL && store->detail != NULL && store->wrinkle != NULL;
    for (uint32_t i = 0; textures && i <= store->texture_count; i++) {
        ris_vk_image_finish(device, &store->texture[i]);
        ris_vk_image_finish(device, &store->detail[i]);
        ris_vk_image_finish(device, &store->wrinkle[i]);
    }
    free(store->texture);
    free(store->detail);
    free(store->wrinkle);
    vkDestroySampler(device->handle, store->sampler, NULL);
    vkDestroySampler(device->handle, store->shadow_sampler, NULL);
    ris_vk_image_finish(device, &draw->shadow);
    *store = (ris_draw_store){0};
}
