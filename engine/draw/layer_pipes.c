/* Descriptor sets and pipelines of the layers. */
#include "draw/draw_impl.h"

#include "draw/bone_frag.h"
#include "draw/clear_depth_frag.h"
#include "draw/flat_frag.h"
#include "draw/muscle_frag.h"
#include "draw/skin_clear_frag.h"
#include "draw/strain_frag.h"

static ris_result create_set(ris_draw *draw, const ris_vk_buffer *const bound[RIS_DRAW_BIND_COLOR],
                             ris_vk_sets *out, ris_error *err)
{
    const ris_draw_store *store = &draw->store;
    const uint32_t plain = store->texture_count;
    VkDescriptorType type[RIS_DRAW_BIND_GRAPHICS_COUNT];
    for (uint32_t i = 0; i < RIS_DRAW_BIND_GRAPHICS_COUNT; i++) {
        type[i] = i < RIS_DRAW_BIND_COLOR ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                          : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    }
    ris_result result =
        ris_vk_sets_create(draw->device, type, RIS_DRAW_BIND_GRAPHICS_COUNT,
                           VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 1, out, err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t i = 0; i < RIS_DRAW_BIND_COLOR; i++) {
        ris_vk_sets_write_buffer(draw->device, out, 0, i, bound[i]->handle, 0, VK_WHOLE_SIZE);
    }
    ris_vk_sets_write_image(draw->device, out, 0, RIS_DRAW_BIND_COLOR, store->texture[plain].view,
                            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
    ris_vk_sets_write_image(draw->device, out, 0, RIS_DRAW_BIND_DETAIL, store->detail[plain].view,
                            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
    ris_vk_sets_write_image(draw->device, out, 0, RIS_DRAW_BIND_WRINKLE, store->wrinkle[plain].view,
                            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->sampler);
    ris_vk_sets_write_image(draw->device, out, 0, RIS_DRAW_BIND_SHADOW, draw->shadow.view,
                            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, store->shadow_sampler);
    return RIS_OK;
}

ris_result ris__draw_layer_pipes_create(ris_draw *draw, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    const ris_draw_store *store = &draw->store;
    const ris_vk_buffer *inner[RIS_DRAW_BIND_COLOR] = {
        [RIS_DRAW_BIND_FRAME] = &store->view,     [RIS_DRAW_BIND_AT] = &layers->position,
        [RIS_DRAW_BIND_FACING] = &layers->normal, [RIS_DRAW_BIND_REST] = &layers->rest,
        [RIS_DRAW_BIND_CORNER] = &layers->corner, [RIS_DRAW_BIND_SQUEEZE] = &store->squeeze};
    const ris_vk_buffer *strain[RIS_DRAW_BIND_COLOR] = {
        [RIS_DRAW_BIND_FRAME] = &store->view,    [RIS_DRAW_BIND_AT] = &store->position,
        [RIS_DRAW_BIND_FACING] = &store->normal, [RIS_DRAW_BIND_REST] = &layers->strain,
        [RIS_DRAW_BIND_CORNER] = &store->corner, [RIS_DRAW_BIND_SQUEEZE] = &store->squeeze};
    ris_vk_graphics_def def[RIS_LAYER_PIPE_COUNT] = {
        [RIS_LAYER_PIPE_BONE] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_bone_frag), "draw bone"),
        [RIS_LAYER_PIPE_MUSCLE] =
            ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_muscle_frag), "draw muscle"),
        [RIS_LAYER_PIPE_FLAT] = ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_flat_frag), "draw flat"),
        [RIS_LAYER_PIPE_DEPTH] =
            ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_clear_depth_frag), "draw clear depth"),
        [RIS_LAYER_PIPE_CLEAR] =
            ris__draw_skin_def(draw, RIS_VK_CODE(ris_spv_skin_clear_frag), "draw clear skin"),
        [RIS_LAYER_PIPE_STRAIN] =
            ris__draw_picture_def(draw, RIS_VK_CODE(ris_spv_strain_frag), "draw strain"),
    };
    def[RIS_LAYER_PIPE_FLAT].cull = VK_CULL_MODE_NONE;
    def[RIS_LAYER_PIPE_FLAT].blend = def[RIS_LAYER_PIPE_DEPTH].blend = true;
    def[RIS_LAYER_PIPE_CLEAR].blend = def[RIS_LAYER_PIPE_STRAIN].blend = true;
    ris_result result;
    RIS_TRY(create_set(draw, inner, &layers->set, err));
    RIS_TRY(create_set(draw, strain, &layers->strain_set, err));
    for (int i = 0; i < RIS_LAYER_PIPE_COUNT; i++) {
        RIS_TRY(ris_vk_graphics_create(draw->device, &def[i], &layers->pipe[i], err));
    }
fail:
    return result;
}

void ris__draw_layer_pipes_finish(ris_draw *draw)
{
    ris_draw_layers *layers = &draw->layers;
    for (int i = 0; i < RIS_LAYER_PIPE_COUNT; i++) {
        vkDestroyPipeline(draw->device->handle, layers->pipe[i], NULL);
    }
    ris_vk_sets_finish(draw->device, &layers->set);
    ris_vk_sets_finish(draw->device, &layers->strain_set);
}
