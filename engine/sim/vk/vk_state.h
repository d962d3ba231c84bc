/* Device memory of one simulation: few large buffers cut into the arrays of sim_shared.h, and the set that
 * binds them. */
#pragma once

#include "sim/sim_impl.h"
#include "sim/vk/vk_sim.h"

typedef struct vk_range {
    const ris_vk_buffer *buffer;
    VkDeviceSize offset, size; /* size without the guard */
} vk_range;

typedef struct vk_state {
    ris_vk_buffer state;         /* written by the stages: position .. normal */
    ris_vk_buffer table;         /* constants of the model */
    ris_vk_buffer anchor;        /* anchors as the host writes them */
    ris_vk_buffer anchor_device; /* their copy where host memory is far from the device; else empty */
    ris_vk_buffer readback;      /* one array, where state cannot be read in place; else empty */
    vk_range range[RIS_BIND_COUNT];
    VkBufferView texel[RIS_TEXEL_END - RIS_BIND_COUNT]; /* of the bindings RIS_TEXEL_... */
    ris_vk_sets sets;
} vk_state;

/* Allocates, uploads the model's tables, puts every node at rest with zero velocities, writes guards and
 * descriptors. */
ris_result ris__vk_state_create(ris_device *vk, const ris_model *model, vk_state *out, ris_error *err);
void ris__vk_state_finish(ris_device *vk, vk_state *state);
/* Binds array `array` where array `binding` belongs, as buffer and as texels. */
void ris__vk_state_bind(ris_device *vk, vk_state *state, uint32_t binding, uint32_t array);
/* Binding of a state array. */
uint32_t ris__vk_state_binding(ris_state state);
