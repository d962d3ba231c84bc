/* What the raster pass and the tests may know of a simulation that lives on a Vulkan device. */
#pragma once

#include "risorius/sim.h"
#include "vk/vk.h"

/* Device buffers of a Vulkan simulation. Valid until the sim is destroyed; between ticks all writes are
 * visible to every later command and to host reads. */
typedef struct ris_vk_sim_view {
    ris_device *device;
    VkBuffer buffer;                             /* one buffer holds all state */
    VkDeviceSize position_offset, normal_offset; /* of ris_vec4 arrays (node_count), 64-byte aligned */
    VkDeviceSize array_size;                     /* bytes of one array: node_count x 16 */
} ris_vk_sim_view;

/* False if sim does not run on Vulkan. */
bool ris_vk_sim_get_view(ris_sim *sim, ris_vk_sim_view *out);

/* Per-stage device timestamps of the next ticks (on after create, where the device has them). */
void ris_vk_sim_set_timestamps(ris_sim *sim, bool on);

/* ---- for tests ---- */

/* Every array of the simulation is followed by this many bytes of RIS__VK_SENTINEL words, inside the
 * descriptor's range, so that a stage that writes past its end is seen. */
#define RIS__VK_GUARD 64
#define RIS__VK_SENTINEL 0x51a7e5edu

/* Checks all guards: RIS_ERROR_FAILED naming binding and word if one changed. */
ris_result ris__vk_sim_check_guards(ris_sim *sim, ris_error *err);
/* Writes word into the guard behind a binding's array (negative control). */
ris_result ris__vk_sim_spoil_guard(ris_sim *sim, uint32_t binding, uint32_t word, ris_error *err);
/* Exchanges the buffers of two bindings (negative control). */
ris_result ris__vk_sim_swap_bindings(ris_sim *sim, uint32_t a, uint32_t b, ris_error *err);
