/* Descriptor sets and pipelines of the raster pass. */
#include "draw/draw_impl.h"

#include "draw/background_frag.h"
#include "draw/background_vert.h"
#include "draw/cornea_frag.h"
#include "draw/eye_frag.h"
#include "draw/fold_comp.h"
#include "draw/hair_frag.h"
#include "draw/mesh_vert.h"
#include "draw/mouth_frag.h"
#include "draw/refine_comp.h"
#include "draw/ride_comp.h"
#include "draw/shadow_frag.h"
#include "draw/shadow_vert.h"
#include "draw/skin_frag.h"
#include "draw/skin_squeeze_comp.h"
#include "draw/skin_vert.h"
#include "draw/surface_normal_comp.h"
#include "draw/wire_frag.h"
#include "draw/wire_vert.h"

#include <stdlib.h>

static ris_result create_compute(ris_draw *draw, ris_error *err)
{
    ris_device *device = draw->device;
    const ris_draw_store *store = &draw->store;
    VkDescriptorType type[RIS_DRAW_BIND_COMPUTE_COUNT];
    ris_result result;
    for (uint32_t i = 0; i < RIS_DRAW_BIND_COMPUTE_COUNT; i++) {
        type[i] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    }
    RIS_TRY(ris_vk_sets_create(device, type, RIS_DRAW_BIND_COMPUTE_COUNT, VK_SHADER_STAGE_COMPUTE_BIT, 1,
                               &draw->compute_sets, err));
    const ris_vk_buffer *bound[RIS_DRAW_BIND_COMPUTE_COUNT] = {
        [RIS_DRAW_BIND_NODE] = &store->node,     [RIS_DRAW_BIND_TERM_START] = &store->term_start,
        [RIS_DRAW_BIND_TERM] = &store->term,     [RIS_DRAW_BIND_POSITION] = &store->position,
        [RIS_DRAW_BIND_NORMAL] = &store->normal, [RIS_DRAW_BIND_RING_START] = &store->ring_start,
        [RIS_DRAW_BIND_RING] = &store->ring,     [RIS_DRAW_BIND_RIDE] = &store->ride,
        [RIS_DRAW_BIND_AT_REST] = &store->rest,  [RIS_DRAW_BIND_SQUEEZE_OUT] = &store->squeeze,
        [RIS_DRAW_BIND_FOLD] = &store->fold};
    for (uint32_t i = 0; i < RIS_DRAW_BIND_COMPUTE_COUNT; i++) {
        ris_vk_sets_write_buffer(device, &draw->compute_sets, 0, i, bound[i]->handle, 0, VK_WHOLE_SIZE);
    }
    RIS_TRY(ris_vk_layout_create(device, draw->compute_sets.layout, VK_SHADER_STAGE_COMPUTE_BIT,
                                 sizeof(ris_draw_count), &draw->compute_layout, err));
    RIS_TRY(ris_vk_compute_create(device, draw->compute_layout, RIS_VK_CODE(ris_spv_refine_comp), NULL,
                                  "draw refine", &draw->refine, err));
    RIS_TRY(ris_vk_compute_create(device, draw->compute_layout, RIS_VK_CODE(ris_spv_surface_normal_comp),
                                  NULL, "draw normal", &draw->normal, err));
    RIS_TRY(ris_vk_compute_create(device, draw->compute_layout, RIS_VK_CODE(ris_spv_skin_squeeze_comp), NULL,
                                  "draw squeeze", &draw->squeeze, err));
    RIS_TRY(ris_vk_compute_create(device, draw->compute_layout, RIS_VK_CODE(ris_spv_fold_comp), NULL,
                                  "draw fold", &draw->fold, err));
    RIS_TRY(ris_vk_compute_create(device, draw->compute_layout, RIS_VK_CODE(ris_spv_ride_comp), NULL,
                                  "draw ride", &draw->ride, err));
fail:
    return result;
}

/* One set per texture: every binding but the texture is the same. */
static ris_result create_sets(ris_draw *draw, ris_error *err)
{
    ris_device *device = draw->device;
    const ris_draw_store *store = &draw->store;
    VkDescriptorType type[RIS_DRAW_BIND_GRAPHICS_COUNT];
    const ris_vk_buffer *bound[RIS_DRAW_BIND_COLOR] = {
        [RIS_DRAW_BIND_FRAME] = &store->view,    [RIS_DRAW_BIND_AT] = &store->position,
        [RIS_DRAW_BIND_FACING] = &store->normal, [RIS_DRAW_BIND_REST] = &store->rest,
        [RIS_DRAW_BIND_CORNER] = &store->corner, [RIS_DRAW_BIND_SQUEEZE] = &store->squeeze};
    ris_result result = RIS_OK;
    for (uint32_t i = 0; i < RIS_DRAW_BIND_GRAPHICS_COUNT; i++) {
        type[i] = i < RIS_DRAW_BIND_COLOR ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                          : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    }
    draw->graphics_sets = calloc(store->texture_count + 1, sizeof *draw->graphics_sets);
    if (draw->graphics_sets == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for descriptor sets");
    }
    for (uint32_t t = 0; t <= store->texture_count; t++) {
        ris_vk_sets *sets = &draw->graphics_sets[t];
        RIS_TRY(ris_vk_sets_create(device, type, RIS_DRAW_BIND_GRAPHICS_COUNT,
                                   VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 1, sets, err));
        for (uint32_t i = 0; i < RIS_DRAW_BIND_COLOR; i++) {
            ris_vk_sets_write_buffer(device, sets, 0, i, bound[i]->handle, 0, VK_WHOLE_SIZE);
        }
        ris_vk_sets_write_image(device, sets, 0, RIS_DRAW_BIND_COLOR, store->texture[t].view,
                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
        uint32_t detail = store->detail[t].handle ? t : store->texture_count;
        ris_vk_sets_write_image(device, sets, 0, RIS_DRAW_BIND_DETAIL, store->detail[detail].view,
                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
        uint32_t wrinkle = store->wrinkle[t].handle ? t : store->texture_count;
        ris_vk_sets_write_image(device, sets, 0, RIS_DRAW_BIND_WRINKLE, store->wrinkle[wrinkle].view,
                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
        ris_vk_sets_write_image(device, sets, 0, RIS_DRAW_BIND_SHADOW, draw->shadow.view,
                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->shadow_sampler);
    }
fail:
    return result;
}

ris_vk_graphics_def ris__draw_picture_def(const ris_draw *draw, ris_vk_code fragment, const char *name)
{
    return (ris_vk_graphics_def){.layout = draw->graphics_layout,
                                 .vertex = RIS_VK_CODE(ris_spv_mesh_vert),
                                 .fragment = fragment,
                                 .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                 .polygon = VK_POLYGON_MODE_FILL,
                                 .cull = VK_CULL_MODE_BACK_BIT,
                                 .depth_test = true,
                                 .depth_write = true,
                                 .samples = VK_SAMPLE_COUNT_4_BIT,
                                 .color_format = RIS_DRAW_COLOR_FORMAT,
                                 .depth_format = RIS_DRAW_DEPTH_FORMAT,
                                 .name = name};
}

ris_vk_graphics_def ris__draw_skin_def(const ris_draw *draw, ris_vk_code fragment, const char *name)
{
    ris_vk_graphics_def def = ris__draw_picture_def(draw, fragment, name);
    def.vertex = RIS_VK_CODE(ris_spv_skin_vert);
    return def;
}

static ris_result create_graphics(ris_draw *draw, ris_error *err)
{
    ris_vk_graphics_def def[RIS_DRAW_PIPE_COUNT];
    def[RIS_DRAW_PIPE_SHADOW] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_shadow_frag), "draw shadow");
    def[RIS_DRAW_PIPE_SHADOW].vertex = RIS_VK_CODE(ris_spv_shadow_vert);
    def[RIS_DRAW_PIPE_SHADOW].samples = VK_SAMPLE_COUNT_1_BIT;
    def[RIS_DRAW_PIPE_SHADOW].color_format = VK_FORMAT_UNDEFINED;
    def[RIS_DRAW_PIPE_BACKGROUND] =
        ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_background_frag), "draw background");
    def[RIS_DRAW_PIPE_BACKGROUND].vertex = RIS_VK_CODE(ris_spv_background_vert);
    def[RIS_DRAW_PIPE_BACKGROUND].cull = VK_CULL_MODE_NONE;
    def[RIS_DRAW_PIPE_BACKGROUND].depth_test = def[RIS_DRAW_PIPE_BACKGROUND].depth_write = false;
    def[RIS_DRAW_PIPE_SKIN] = ris__draw_skin_def(draw, RIS_VK_CODE(ris_spv_skin_frag), "draw skin");
    def[RIS_DRAW_PIPE_EYE] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_eye_frag), "draw eye");
    def[RIS_DRAW_PIPE_MOUTH] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_mouth_frag), "draw mouth");
    def[RIS_DRAW_PIPE_HAIR] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_hair_frag), "draw hair");
    def[RIS_DRAW_PIPE_HAIR].cull = VK_CULL_MODE_NONE;
    def[RIS_DRAW_PIPE_HAIR].blend = true;
    def[RIS_DRAW_PIPE_HAIR].depth_write = false;
    def[RIS_DRAW_PIPE_CORNEA] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_cornea_frag), "draw cornea");
    def[RIS_DRAW_PIPE_CORNEA].blend = true;
    def[RIS_DRAW_PIPE_CORNEA].depth_write = false;
    def[RIS_DRAW_PIPE_WIRE] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_wire_frag), "draw wire");
    def[RIS_DRAW_PIPE_WIRE].vertex = RIS_VK_CODE(ris_spv_wire_vert);
    def[RIS_DRAW_PIPE_WIRE].topology = VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
    def[RIS_DRAW_PIPE_WIRE].cull = VK_CULL_MODE_NONE;
    ris_result result = RIS_OK;
    for (int i = 0; i < RIS_DRAW_PIPE_COUNT && result == RIS_OK; i++) {
        result = ris_vk_graphics_create(draw->device, &def[i], &draw->pipe[i], err);
    }
    return result;
}

ris_result ris__draw_pipes_create(ris_draw *draw, ris_error *err)
{
    ris_result result;
    RIS_TRY(create_compute(draw, err));
    RIS_TRY(create_sets(draw, err));
    RIS_TRY(ris_vk_layout_create(draw->device, draw->graphics_sets[0].layout,
                                 VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                                 sizeof(ris_draw_object), &draw->graphics_layout, err));
    RIS_TRY(create_graphics(draw, err));
fail:
    return result;
}

void ris__draw_pipes_finish(ris_draw *draw)
{
    VkDevice device = draw->device->handle;
    for (int i = 0; i < RIS_DRAW_PIPE_COUNT; i++) {
        vkDestroyPipeline(device, draw->pipe[i], NULL);
    }
    vkDestroyPipeline(device, draw->refine, NULL);
    vkDestroyPipeline(device, draw->normal, NULL);
    vkDestroyPipeline(device, draw->squeeze, NULL);
    vkDestroyPipeline(device, draw->fold, NULL);
    vkDestroyPipeline(device, draw->ride, NULL);
    vkDestroyPipelineLayout(device, draw->compute_layout, NULL);
    vkDestroyPipelineLayout(device, draw->graphics_layout, NULL);
    for (uint32_t t = 0; draw->graphics_sets != NULL && t <= draw->store.texture_count; t++) {
        ris_vk_sets_finish(draw->device, &draw->graphics_sets[t]);
    }
    free(draw->graphics_sets);
    draw->graphics_sets = NULL;
    ris_vk_sets_finish(draw->device, &draw->compute_sets);
}
