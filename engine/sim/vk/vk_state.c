#include "sim/vk/vk_state.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Longest gather of one invocation: lavapipe silently stops loops after 65,535 iterations in all
 * (tests/parity pins it). */
#define GATHER_MAX 30000u

static const uint32_t state_bindings[] = {RIS_BIND_POSITION, RIS_BIND_VELOCITY_HALF, RIS_BIND_VELOCITY_PREV,
                                          RIS_BIND_FORCE,    RIS_BIND_BEND,          RIS_BIND_NORMAL,
                                          RIS_BIND_FREE};
static const uint32_t table_bindings[] = {
    RIS_BIND_REST,          RIS_BIND_SPRING_START, RIS_BIND_HALF_SPRING,  RIS_BIND_RING_START,
    RIS_BIND_RING,          RIS_BIND_ANCHOR_PARAM, RIS_BIND_CONTACT_NODE, RIS_BIND_CONTACT_TOUCH,
    RIS_BIND_CONTACT_OTHER, RIS_BIND_CONTACT_GRID, RIS_BIND_HEFT,         RIS_BIND_MOVING};
static const uint32_t anchor_bindings[] = {RIS_BIND_ANCHOR_POINT, RIS_BIND_ANCHOR_DELTA,
                                           RIS_BIND_CONTACT_BODY, RIS_BIND_INERTIA};
#define COUNT(list) ((uint32_t)(sizeof(list) / sizeof(list)[0]))

_Static_assert(sizeof(ris_vec4) == 16 && sizeof(ris_half_spring) == 20 && sizeof(ris_ring) == 8 &&
                   sizeof(ris_anchor_param) == 16 && sizeof(ris_anchor_point) == 32 &&
                   sizeof(ris_contact_body) == 80 && sizeof(ris_contact_node) == 24 &&
                   sizeof(ris_contact_touch) == 12 && sizeof(ris_inertia) == 48,
               "scalar layout");
_Static_assert(offsetof(ris_half_spring, rest_mm) == 4 && offsetof(ris_half_spring, area_ratio) == 8 &&
                   offsetof(ris_half_spring, bend_out) == 12 && offsetof(ris_half_spring, bend_in) == 16,
               "words of shaders/lib/half_spring.glsl");
_Static_assert(sizeof(ris_sim_push) <= 128, "push constants");
_Static_assert(sizeof state_bindings / sizeof(uint32_t) + sizeof table_bindings / sizeof(uint32_t) +
                       sizeof anchor_bindings / sizeof(uint32_t) ==
                   RIS_BIND_COUNT,
               "every binding belongs to one buffer");

/* Small, of fixed size and read by every invocation. */
static bool is_uniform(uint32_t binding)
{
    return binding == RIS_BIND_CONTACT_BODY || binding == RIS_BIND_INERTIA;
}

uint32_t ris__vk_state_binding(ris_state state)
{
    switch (state) {
    case RIS_STATE_POSITION: return RIS_BIND_POSITION;
    case RIS_STATE_VELOCITY_HALF: return RIS_BIND_VELOCITY_HALF;
    case RIS_STATE_VELOCITY_PREV: return RIS_BIND_VELOCITY_PREV;
    case RIS_STATE_FORCE: return RIS_BIND_FORCE;
    case RIS_STATE_BEND: return RIS_BIND_BEND;
    case RIS_STATE_FREE: return RIS_BIND_FREE;
    case RIS_STATE_NORMAL:
    case RIS_STATE_COUNT: break;
    }
    return RIS_BIND_NORMAL;
}

/* What the model gives for a binding at the start (NULL = zeros) and the size of its array in bytes. */
static const void *initial(const ris_model *model, uint32_t binding, VkDeviceSize *out_size)
{
    const VkDeviceSize nodes = model->node_count;
    switch (binding) {
    case RIS_BIND_POSITION:
    case RIS_BIND_FREE:
    case RIS_BIND_REST: *out_size = nodes * sizeof(ris_vec4); return model->rest_position;
    case RIS_BIND_NORMAL: *out_size = nodes * sizeof(ris_vec4); return model->rest_normal;
    case RIS_BIND_SPRING_START: *out_size = (nodes + 1) * sizeof(uint32_t); return model->spring_start;
    case RIS_BIND_HALF_SPRING:
        *out_size = model->half_spring_count * sizeof(ris_half_spring);
        return model->half_spring;
    case RIS_BIND_RING_START: *out_size = (nodes + 1) * sizeof(uint32_t); return model->ring_start;
    case RIS_BIND_RING:
        *out_size = 3 * (VkDeviceSize)model->triangle_count * sizeof(ris_ring);
        return model->ring;
    case RIS_BIND_ANCHOR_PARAM: *out_size = nodes * sizeof(ris_anchor_param); return model->anchor_param;
    case RIS_BIND_CONTACT_NODE:
        *out_size = model->contact_node_count * sizeof(ris_contact_node);
        return model->contact_node;
    case RIS_BIND_CONTACT_TOUCH:
        *out_size = model->contact_touch_count * sizeof(ris_contact_touch);
        return model->contact_touch;
    case RIS_BIND_CONTACT_OTHER:
        *out_size = model->contact_pair_count * sizeof(uint32_t);
        return model->contact_other;
    case RIS_BIND_CONTACT_GRID:
        *out_size = model->contact_sample_count * sizeof(ris_vec4);
        return model->contact_grid;
    case RIS_BIND_CONTACT_BODY: *out_size = RIS_CONTACT_BODIES * sizeof(ris_contact_body); return NULL;
    case RIS_BIND_HEFT: *out_size = nodes * sizeof(float); return model->heft;
    case RIS_BIND_MOVING: *out_size = model->moving_count * sizeof(uint32_t); return model->moving;
    case RIS_BIND_INERTIA: *out_size = sizeof(ris_inertia); return NULL;
    case RIS_BIND_ANCHOR_POINT: *out_size = nodes * sizeof(ris_anchor_point); return NULL;
    default: *out_size = nodes * sizeof(ris_vec4); return NULL;
    }
}

static ris_result check_model(const ris_device *vk, const ris_model *model, ris_error *err)
{
    const uint64_t groups = ((uint64_t)model->node_count + RIS_GROUP_NODE - 1) / RIS_GROUP_NODE;
    if (model->node_count == 0) {
        return ris_fail(err, RIS_ERROR_DATA, "a model without vertices cannot be simulated");
    }
    if (groups > vk->properties.limits.maxComputeWorkGroupCount[0]) {
        return ris_fail(
            err, RIS_ERROR_DATA, "%u vertices, at most %llu can be simulated on %s", model->node_count,
            (unsigned long long)vk->properties.limits.maxComputeWorkGroupCount[0] * RIS_GROUP_NODE,
            vk->info.name);
    }
    for (uint32_t i = 0; i < model->node_count; i++) {
        uint32_t springs = model->spring_start[i + 1] - model->spring_start[i];
        uint32_t faces = model->ring_start[i + 1] - model->ring_start[i];
        if (springs > GATHER_MAX || faces > GATHER_MAX) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "vertex %u has %u springs and %u triangles, expected at most %u", i, springs,
                            faces, GATHER_MAX);
        }
    }
    return RIS_OK;
}

/* Allocates one buffer for the listed arrays, each with its guard, and fills it from the model. */
static ris_result fill_buffer(ris_device *vk, const ris_model *model, ris_vk_use use,
                              const uint32_t *bindings, uint32_t count, const char *name, vk_state *state,
                              ris_vk_buffer *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkDeviceSize size = 0;
    const uint32_t sentinel = RIS__VK_SENTINEL;
    char *bytes = NULL;
    for (uint32_t k = 0; k < count; k++) {
        vk_range *range = &state->range[bindings[k]];
        initial(model, bindings[k], &range->size);
        range->buffer = out;
        range->offset = ris_vk_range(vk, &size, range->size + RIS__VK_GUARD);
        if (range->size + RIS__VK_GUARD > vk->properties.limits.maxStorageBufferRange) {
            return ris_fail(err, RIS_ERROR_DATA, "%s array of %llu bytes, at most %u fit on %s", name,
                            (unsigned long long)range->size, vk->properties.limits.maxStorageBufferRange,
                            vk->info.name);
        }
    }
    bytes = calloc(1, (size_t)size);
    if (!bytes) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %llu bytes of %s", (unsigned long long)size,
                        name);
    }
    for (uint32_t k = 0; k < count; k++) {
        const vk_range *range = &state->range[bindings[k]];
        VkDeviceSize same;
        const void *data = initial(model, bindings[k], &same);
        if (data && range->size) {
            memcpy(bytes + range->offset, data, (size_t)range->size);
        }
        for (uint32_t g = 0; g < RIS__VK_GUARD; g += sizeof sentinel) {
            memcpy(bytes + range->offset + range->size + g, &sentinel, sizeof sentinel);
        }
    }
    RIS_TRY(ris_vk_buffer_create(vk, use, size,
                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                     VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT,
                                 name, out, err));
    RIS_TRY(ris_vk_buffer_write(vk, out, 0, bytes, size, err));
fail:
    free(bytes);
    return result;
}

/* Host memory that is not on the device is copied there every frame. */
static ris_result create_anchor_copy(ris_device *vk, const ris_model *model, vk_state *state, ris_error *err)
{
    if (state->anchor.device_local) {
        return RIS_OK;
    }
    return fill_buffer(vk, model, RIS_VK_DEVICE, anchor_bindings, COUNT(anchor_bindings), "sim anchor copy",
                       state, &state->anchor_device, err);
}

/* The array that texel binding `texel` shows. */
static uint32_t array_of(uint32_t texel)
{
    switch (texel) {
    case RIS_TEXEL_POSITION: return RIS_BIND_POSITION;
    case RIS_TEXEL_REST: return RIS_BIND_REST;
    case RIS_TEXEL_BEND: return RIS_BIND_BEND;
    case RIS_TEXEL_NORMAL: return RIS_BIND_NORMAL;
    case RIS_TEXEL_FREE: return RIS_BIND_FREE;
    case RIS_TEXEL_HALF_SPRING: return RIS_BIND_HALF_SPRING;
    default: return RIS_BIND_CONTACT_GRID;
    }
}

static ris_result create_texels(ris_device *vk, vk_state *state, ris_error *err)
{
    ris_result result = RIS_OK;
    const uint32_t most = vk->properties.limits.maxTexelBufferElements;
    for (uint32_t t = RIS_BIND_COUNT; t < RIS_TEXEL_END; t++) {
        const bool words = t == RIS_TEXEL_HALF_SPRING;
        const vk_range *range = &state->range[array_of(t)];
        const VkBufferViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                             .buffer = range->buffer->handle,
                                             .format =
                                                 words ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32B32A32_SFLOAT,
                                             .offset = range->offset,
                                             .range = range->size + RIS__VK_GUARD};
        const VkDeviceSize texels = info.range / (words ? sizeof(uint32_t) : sizeof(ris_vec4));
        if (texels > most) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "an array of %llu elements to gather from, at most %u fit on %s",
                            (unsigned long long)texels, most, vk->info.name);
        }
        RIS_VK(vkCreateBufferView(vk->handle, &info, NULL, &state->texel[t - RIS_BIND_COUNT]));
    }
fail:
    return result;
}

void ris__vk_state_bind(ris_device *vk, vk_state *state, uint32_t binding, uint32_t array)
{
    const vk_range *range = &state->range[array];
    VkBufferView view = VK_NULL_HANDLE;
    ris_vk_sets_write_buffer(vk, &state->sets, 0, binding, range->buffer->handle, range->offset,
                             range->size + (is_uniform(binding) ? 0 : RIS__VK_GUARD));
    for (uint32_t t = RIS_BIND_COUNT; t < RIS_TEXEL_END; t++) {
        view = array_of(t) == array ? state->texel[t - RIS_BIND_COUNT] : view;
    }
    for (uint32_t t = RIS_BIND_COUNT; t < RIS_TEXEL_END && view; t++) {
        if (array_of(t) == binding) {
            ris_vk_sets_write_texels(vk, &state->sets, 0, t, view);
        }
    }
}

ris_result ris__vk_state_create(ris_device *vk, const ris_model *model, vk_state *out, ris_error *err)
{
    ris_result result;
    VkDescriptorType type[RIS_TEXEL_END];
    memset(out, 0, sizeof *out);
    RIS_TRY(check_model(vk, model, err));
    RIS_TRY(fill_buffer(vk, model, RIS_VK_DEVICE, state_bindings, COUNT(state_bindings), "sim state", out,
                        &out->state, err));
    RIS_TRY(fill_buffer(vk, model, RIS_VK_DEVICE, table_bindings, COUNT(table_bindings), "sim table", out,
                        &out->table, err));
    RIS_TRY(fill_buffer(vk, model, RIS_VK_UPLOAD, anchor_bindings, COUNT(anchor_bindings), "sim anchor", out,
                        &out->anchor, err));
    RIS_TRY(create_anchor_copy(vk, model, out, err));
    if (!out->state.data || !out->state.cached) {
        RIS_TRY(ris_vk_buffer_create(vk, RIS_VK_READBACK, out->range[RIS_BIND_POSITION].size, 0,
                                     "sim readback", &out->readback, err));
    }
    for (uint32_t b = 0; b < RIS_TEXEL_END; b++) {
        type[b] = b >= RIS_BIND_COUNT ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                  : is_uniform(b)     ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                      : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    }
    RIS_TRY(create_texels(vk, out, err));
    RIS_TRY(ris_vk_sets_create(vk, type, RIS_TEXEL_END, VK_SHADER_STAGE_COMPUTE_BIT, 1, &out->sets, err));
    for (uint32_t b = 0; b < RIS_BIND_COUNT; b++) {
        ris__vk_state_bind(vk, out, b, b);
    }
    return RIS_OK;
fail:
    ris__vk_state_finish(vk, out);
    return result;
}

void ris__vk_state_finish(ris_device *vk, vk_state *state)
{
    for (uint32_t t = 0; t < RIS_TEXEL_END - RIS_BIND_COUNT; t++) {
        vkDestroyBufferView(vk->handle, state->texel[t], NULL);
    }
    ris_vk_sets_finish(vk, &state->sets);
    ris_vk_buffer_finish(vk, &state->readback);
    ris_vk_buffer_finish(vk, &state->anchor_device);
    ris_vk_buffer_finish(vk, &state->anchor);
    ris_vk_buffer_finish(vk, &state->table);
    ris_vk_buffer_finish(vk, &state->state);
    memset(state, 0, sizeof *state);
}
