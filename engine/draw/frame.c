/* One picture, in the order it happens: nodes -> surface -> normals -> riding parts -> key light depth -> picture. */
#include "draw/draw_impl.h"

#include "sim/vk/vk_sim.h"

#include <string.h>

#define RELIEF_MM 0.5f /* height between black and white of a detail texture */

static void dispatch(const ris_draw *draw, VkCommandBuffer cmd, VkPipeline pipeline, uint32_t count)
{
    const ris_draw_count push = {count};
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdPushConstants(cmd, draw->compute_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    vkCmdDispatch(cmd, (count + RIS_DRAW_GROUP - 1) / RIS_DRAW_GROUP, 1, 1);
}

static void record_surface(const ris_draw *draw, VkCommandBuffer cmd)
{
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkAccessFlags2 write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                         read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, draw->compute_layout, 0, 1,
                            draw->compute_sets.set, 0, NULL);
    dispatch(draw, cmd, draw->refine, draw->scene.skin_count);
    ris_vk_barrier(cmd, compute, write, compute, read);
    dispatch(draw, cmd, draw->normal, draw->scene.skin_count);
    dispatch(draw, cmd, draw->squeeze, draw->scene.skin_count);
    ris_vk_barrier(cmd, compute, write, compute, read | write);
    dispatch(draw, cmd, draw->fold, draw->scene.skin_count);
    if (draw->scene.ride_count > 0) {
        ris_vk_barrier(cmd, compute, write, compute,
                       read | write); /* one buffer holds skin and riding parts */
        dispatch(draw, cmd, draw->ride, draw->scene.ride_count);
    }
    ris_vk_barrier(cmd, compute, write,
                   VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, read);
}

/* row-major 3x4: a after b */
static void chain(const float a[12], const float b[12], float out[12])
{
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 4; c++) {
            float sum = c == 3 ? a[4 * r + 3] : 0.0f;
            for (int k = 0; k < 3; k++) {
                sum += a[4 * r + k] * b[4 * k + c];
            }
            out[4 * r + c] = sum;
        }
    }
}

void ris__draw_place(const ris_sim *sim, ris_bone bone, float out[12])
{
    static const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    float head[12], own[12];
    ris_sim_head_transform(sim, head);
    memcpy(own, identity, sizeof own);
    if (bone != RIS_BONE_SKIN) {
        ris_sim_bone_transform(sim, bone, own);
    }
    chain(head, own, out);
}

VkDescriptorSet ris__draw_set_of(const ris_draw *draw, const ris_draw_item *item)
{
    return draw->graphics_sets[item->texture != UINT32_MAX ? item->texture : draw->store.texture_count]
        .set[0];
}

void ris__draw_object(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim,
                      const ris_draw_item *item, VkDescriptorSet set)
{
    float place[12];
    bool textured = item->texture != UINT32_MAX;
    ris__draw_place(sim, item->bone, place);
    ris_draw_object object = {.tint = {item->tint.x, item->tint.y, item->tint.z, textured ? 1.0f : 0.0f},
                              .pivot = {item->pivot.x, item->pivot.y, item->pivot.z, RELIEF_MM}};
    memcpy(object.place, place, sizeof place);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->graphics_layout, 0, 1, &set, 0, NULL);
    vkCmdPushConstants(cmd, draw->graphics_layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                       0, sizeof object, &object);
    vkCmdDrawIndexed(cmd, item->index_count, 1, item->first_index, 0, 0);
}

static void draw_item(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim,
                      const ris_draw_item *item)
{
    ris__draw_object(draw, cmd, sim, item, ris__draw_set_of(draw, item));
}

static ris_draw_pipe pipe_of(ris_material material)
{
    switch (material) {
    case RIS_MATERIAL_EYE: return RIS_DRAW_PIPE_EYE;
    case RIS_MATERIAL_CORNEA: return RIS_DRAW_PIPE_CORNEA;
    case RIS_MATERIAL_TEETH:
    case RIS_MATERIAL_GUM:
    case RIS_MATERIAL_TONGUE: return RIS_DRAW_PIPE_MOUTH;
    case RIS_MATERIAL_HAIR: return RIS_DRAW_PIPE_HAIR;
    case RIS_MATERIAL_SKIN: break;
    }
    return RIS_DRAW_PIPE_SKIN;
}

static void set_area(VkCommandBuffer cmd, uint32_t width, uint32_t height)
{
    const VkViewport viewport = {0.0f, 0.0f, (float)width, (float)height, 0.0f, 1.0f};
    const VkRect2D scissor = {{0, 0}, {width, height}};
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    vkCmdSetScissor(cmd, 0, 1, &scissor);
}

static void record_shadow(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_vk_access before = {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
    const ris_vk_access target = {
        VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
        VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL};
    const ris_vk_access sampled = {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkRenderingAttachmentInfo none = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    const VkRenderingAttachmentInfo depth = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                             .imageView = draw->shadow.view,
                                             .imageLayout = target.layout,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .clearValue.depthStencil.depth = 1.0f};
    const VkRenderingInfo info = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .layerCount = 1,
                                  .renderArea.extent = {RIS_DRAW_SHADOW_SIDE, RIS_DRAW_SHADOW_SIDE},
                                  .colorAttachmentCount = 1,
                                  .pColorAttachments = &none,
                                  .pDepthAttachment = &depth};
    ris_vk_image_barrier(cmd, draw->shadow.handle, VK_IMAGE_ASPECT_DEPTH_BIT, before, target);
    vkCmdBeginRendering(cmd, &info);
    set_area(cmd, RIS_DRAW_SHADOW_SIDE, RIS_DRAW_SHADOW_SIDE);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->pipe[RIS_DRAW_PIPE_SHADOW]);
    /* lips and lids cast the shadows that matter; what is behind them is darkened by its own shader */
    ris_draw_item skin = draw->scene.item[0];
    skin.first_index = 0;
    skin.index_count = draw->scene.cast_count;
    if (draw->shown & (RIS_LAYER_SKULL | RIS_LAYER_MUSCLES)) {
        ris__draw_layer_shadow(draw, cmd, sim);
    } else {
        vkCmdBindIndexBuffer(cmd, draw->store.cast.handle, 0, VK_INDEX_TYPE_UINT32);
        draw_item(draw, cmd, sim, &skin);
    }
    vkCmdEndRendering(cmd);
    ris_vk_image_barrier(cmd, draw->shadow.handle, VK_IMAGE_ASPECT_DEPTH_BIT, target, sampled);
}

static void begin_picture(const ris_draw *draw, VkCommandBuffer cmd)
{
    const ris_vk_access none = {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                                VK_IMAGE_LAYOUT_UNDEFINED};
    const ris_vk_access color = {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                 VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const ris_vk_access depth = {
        VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
        VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL};
    const ris_draw_target *target = &draw->target;
    ris_vk_image_barrier(cmd, target->many.handle, VK_IMAGE_ASPECT_COLOR_BIT, none, color);
    ris_vk_image_barrier(cmd, target->color.handle, VK_IMAGE_ASPECT_COLOR_BIT, none, color);
    ris_vk_image_barrier(cmd, target->depth.handle, VK_IMAGE_ASPECT_DEPTH_BIT, none, depth);
    const VkRenderingAttachmentInfo samples = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                               .imageView = target->many.view,
                                               .imageLayout = color.layout,
                                               .resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT,
                                               .resolveImageView = target->color.view,
                                               .resolveImageLayout = color.layout,
                                               .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                               .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE};
    const VkRenderingAttachmentInfo nearest = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                               .imageView = target->depth.view,
                                               .imageLayout = depth.layout,
                                               .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                               .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                               .clearValue.depthStencil.depth = 1.0f};
    const VkRenderingInfo info = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .layerCount = 1,
                                  .renderArea.extent = {target->width, target->height},
                                  .colorAttachmentCount = 1,
                                  .pColorAttachments = &samples,
                                  .pDepthAttachment = &nearest};
    vkCmdBeginRendering(cmd, &info);
    set_area(cmd, target->width, target->height);
}

/* Skin and parts, in their order. */
static void draw_scene(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    int bound = -1;
    for (uint32_t i = 0; i < draw->scene.item_count; i++) {
        const ris_draw_item *item = &draw->scene.item[i];
        int pipe = (int)pipe_of(item->material);
        if (pipe != bound) {
            vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->pipe[pipe]);
            bound = pipe;
        }
        draw_item(draw, cmd, sim, item);
    }
}

static void record_picture(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_vk_access color = {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                 VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const ris_vk_access copied = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    begin_picture(draw, cmd);
    const VkDescriptorSet set = ris__draw_set_of(draw, &draw->scene.item[0]);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->graphics_layout, 0, 1, &set, 0, NULL);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->pipe[RIS_DRAW_PIPE_BACKGROUND]);
    vkCmdDraw(cmd, 3, 1, 0, 0);
    if (ris__draw_is_plain(draw)) {
        draw_scene(draw, cmd, sim);
    } else {
        ris__draw_layer_picture(draw, cmd, sim);
    }
    if (draw->wireframe) {
        ris_draw_item lines = draw->scene.item[0];
        lines.first_index = 0;
        lines.index_count = draw->scene.line_count;
        vkCmdBindIndexBuffer(cmd, draw->store.line.handle, 0, VK_INDEX_TYPE_UINT32);
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw->pipe[RIS_DRAW_PIPE_WIRE]);
        draw_item(draw, cmd, sim, &lines);
    }
    vkCmdEndRendering(cmd);
    ris_vk_image_barrier(cmd, draw->target.color.handle, VK_IMAGE_ASPECT_COLOR_BIT, color, copied);
}

/* Nodes are bound at buffer + offset; everything else is already in place. host (node_count): the same nodes where the
 * host can read them, NULL = read from sim when needed. */
static ris_result draw_nodes(ris_draw *draw, ris_sim *sim, VkBuffer buffer, VkDeviceSize offset,
                             const ris_vec4 *host, const ris_camera *camera, ris_error *err)
{
    ris_result result;
    float head[12];
    ris_draw_view view;
    VkDeviceSize size = (VkDeviceSize)draw->model->node_count * sizeof(ris_vec4);
    ris_sim_head_transform(sim, head);
    ris__draw_view_fill(draw, camera, head, &view);
    RIS_TRY(ris_vk_cmd_wait(draw->device, &draw->cmd, err));
    memcpy(draw->store.view.data, &view, sizeof view);
    RIS_TRY(ris_vk_buffer_flush(draw->device, &draw->store.view, err));
    if (!ris__draw_is_plain(draw)) {
        RIS_TRY(ris__draw_layers_update(draw, sim, host, camera, err));
    }
    ris_vk_sets_write_buffer(draw->device, &draw->compute_sets, 0, RIS_DRAW_BIND_NODE, buffer, offset, size);
    RIS_TRY(ris_vk_cmd_begin(draw->device, &draw->cmd, true, err));
    VkCommandBuffer cmd = draw->cmd.handle;
    ris_vk_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                   VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_MEMORY_READ_BIT,
                   VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                       VK_ACCESS_2_TRANSFER_WRITE_BIT);
    RIS_TRY(ris__draw_soft_record(draw, cmd, sim, err));
    ris_vk_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    record_surface(draw, cmd);
    record_shadow(draw, cmd, sim);
    vkCmdBindIndexBuffer(cmd, draw->store.index.handle, 0, VK_INDEX_TYPE_UINT32);
    record_picture(draw, cmd, sim);
    RIS_TRY(ris_vk_cmd_run(draw->device, &draw->cmd, err));
    draw->drawn = true;
fail:
    return result;
}

ris_result ris_draw_frame_at(ris_draw *draw, ris_sim *sim, const ris_vec4 *position, const ris_vec4 *normal,
                             const ris_camera *camera, ris_error *err)
{
    (void)normal; /* the drawn surface is smoother than the nodes and has its own normals */
    memcpy(draw->store.node.data, position, (size_t)draw->model->node_count * sizeof *position);
    ris_result result = ris_vk_buffer_flush(draw->device, &draw->store.node, err);
    return result == RIS_OK
               ? draw_nodes(draw, sim, draw->store.node.handle, 0, draw->store.node.data, camera, err)
               : result;
}

ris_result ris_draw_frame(ris_draw *draw, ris_sim *sim, const ris_camera *camera, ris_error *err)
{
    ris_vk_sim_view there;
    if (ris_vk_sim_get_view(sim, &there) && there.device == draw->device) {
        return draw_nodes(draw, sim, there.buffer, there.position_offset, NULL, camera, err);
    }
    ris_result result = ris_sim_read(sim, RIS_STATE_POSITION, draw->store.node.data, err);
    if (result == RIS_OK) {
        result = ris_vk_buffer_flush(draw->device, &draw->store.node, err);
    }
    return result == RIS_OK
               ? draw_nodes(draw, sim, draw->store.node.handle, 0, draw->store.node.data, camera, err)
               : result;
}

ris_result ris_draw_read(ris_draw *draw, uint8_t *out, ris_error *err)
{
    ris_device *device = draw->device;
    ris_draw_target *target = &draw->target;
    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {target->width, target->height, 1}};
    ris_result result;
    if (!draw->drawn) {
        return ris_fail(err, RIS_ERROR_USAGE, "no frame has been drawn yet");
    }
    RIS_TRY(ris_vk_cmd_begin(device, &draw->copy, true, err));
    vkCmdCopyImageToBuffer(draw->copy.handle, target->color.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           target->readback.handle, 1, &copy);
    ris_vk_barrier(draw->copy.handle, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    RIS_TRY(ris_vk_cmd_run(device, &draw->copy, err));
    RIS_TRY(ris_vk_buffer_invalidate(device, &target->readback, err));
    memcpy(out, target->readback.data, (size_t)target->width * target->height * 4);
fail:
    return result;
}
