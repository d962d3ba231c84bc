/* The simulation on a Vulkan device (KA-11..20, KA-37): the stages of shaders/sim in this order.
 *
 *   upload anchors -> anchor_shift -> [ bend -> spring_force -> verlet -> lip_normal -> contact ] x substeps -> normal
 *
 * All of it is one command buffer, recorded once and submitted again every tick, with one fence. In place is
 * safe: spring_force reads all positions and writes its own node's force, verlet touches its own node only and
 * leaves its position once more for contact, which reads all of those; a global barrier stands between stages. The substep loop is here and never inside a shader (lavapipe stops
 * long loops silently). */
#include "sim/vk/vk_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "sim/anchor_shift_comp.h"
#include "sim/bend_comp.h"
#include "sim/contact_comp.h"
#include "sim/lip_normal_comp.h"
#include "sim/normal_comp.h"
#include "sim/spring_force_comp.h"
#include "sim/verlet_comp.h"

#define TIMESTAMP_MAX 4096u

typedef struct vk_sim {
    ris_device *vk;
    const ris_model *model;
    vk_state mem;
    VkPipelineLayout layout;
    VkPipeline pipeline[RIS_STAGE_COUNT], contact_bodies; /* the second pass of contact */
    ris_vk_cmd frame, single;                             /* a whole tick; one stage or one copy */
    uint32_t recorded_substeps;                           /* of frame, 0 = none */
    bool timestamps, recorded_timestamps;
    ris_vk_query query;   /* one per dispatch and one before all */
    uint8_t *query_stage; /* stage that ends at each query (query.count) */
    uint64_t *query_tick; /* (query.count) */
    uint32_t query_used;
} vk_sim;

static const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
static const VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
static const VkAccessFlags2 shader_access =
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
    VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
static const VkAccessFlags2 any_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

static void vk_destroy(void *self)
{
    vk_sim *sim = self;
    if (!sim) {
        return;
    }
    ris_vk_cmd_finish(sim->vk, &sim->frame);
    ris_vk_cmd_finish(sim->vk, &sim->single);
    ris_vk_query_finish(sim->vk, &sim->query);
    for (uint32_t s = 0; s < RIS_STAGE_COUNT; s++) {
        vkDestroyPipeline(sim->vk->handle, sim->pipeline[s], NULL);
    }
    vkDestroyPipeline(sim->vk->handle, sim->contact_bodies, NULL);
    vkDestroyPipelineLayout(sim->vk->handle, sim->layout, NULL);
    ris__vk_state_finish(sim->vk, &sim->mem);
    free(sim->query_stage);
    free(sim->query_tick);
    free(sim);
}

static ris_result create_pipelines(vk_sim *sim, ris_error *err)
{
    static const ris_vk_code code[RIS_STAGE_COUNT] = {
        [RIS_STAGE_ANCHOR_SHIFT] = {ris_spv_anchor_shift_comp, sizeof ris_spv_anchor_shift_comp},
        [RIS_STAGE_BEND] = {ris_spv_bend_comp, sizeof ris_spv_bend_comp},
        [RIS_STAGE_SPRING_FORCE] = {ris_spv_spring_force_comp, sizeof ris_spv_spring_force_comp},
        [RIS_STAGE_VERLET] = {ris_spv_verlet_comp, sizeof ris_spv_verlet_comp},
        [RIS_STAGE_LIP_NORMAL] = {ris_spv_lip_normal_comp, sizeof ris_spv_lip_normal_comp},
        [RIS_STAGE_CONTACT] = {ris_spv_contact_comp, sizeof ris_spv_contact_comp},
        [RIS_STAGE_NORMAL] = {ris_spv_normal_comp, sizeof ris_spv_normal_comp},
    };
    const uint32_t flags = sim->model->push.flags;
    VkBool32 value[] = {[RIS_CONSTANT_KAEHLER] = (flags & RIS_TISSUE_FLAG_KAEHLER) != 0,
                        [RIS_CONSTANT_CONTINUOUS] = (flags & RIS_TISSUE_FLAG_CONTINUOUS) != 0,
                        [RIS_CONSTANT_LIPS] = VK_TRUE};
    VkSpecializationMapEntry entry[sizeof value / sizeof *value];
    const VkSpecializationInfo constants = {.mapEntryCount = sizeof value / sizeof *value,
                                            .pMapEntries = entry,
                                            .dataSize = sizeof value,
                                            .pData = value};
    ris_result result = RIS_OK;
    for (uint32_t c = 0; c < constants.mapEntryCount; c++) {
        entry[c] = (VkSpecializationMapEntry){c, c * (uint32_t)sizeof *value, sizeof *value};
    }
    RIS_TRY(ris_vk_layout_create(sim->vk, sim->mem.sets.layout, VK_SHADER_STAGE_COMPUTE_BIT,
                                 sizeof(ris_sim_push), &sim->layout, err));
    for (uint32_t s = 0; s < RIS_STAGE_COUNT; s++) {
        RIS_TRY(ris_vk_compute_create(sim->vk, sim->layout, code[s], &constants, ris_stage_name((ris_stage)s),
                                      &sim->pipeline[s], err));
    }
    value[RIS_CONSTANT_LIPS] = VK_FALSE;
    RIS_TRY(ris_vk_compute_create(sim->vk, sim->layout, code[RIS_STAGE_CONTACT], &constants,
                                  "contact, bodies", &sim->contact_bodies, err));
fail:
    return result;
}

/* ---- recording ---- */

static void record_start(const vk_sim *sim, VkCommandBuffer cmd)
{
    /* whatever read or wrote the state before (the raster pass, copies) is done */
    ris_vk_barrier(cmd, everything, any_access, compute | VK_PIPELINE_STAGE_2_COPY_BIT, any_access);
    if (sim->mem.anchor_device.handle) {
        VkBufferCopy copy = {.size = sim->mem.anchor_device.size};
        vkCmdCopyBuffer(cmd, sim->mem.anchor.handle, sim->mem.anchor_device.handle, 1, &copy);
        ris_vk_barrier(cmd, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, compute,
                       shader_access);
    }
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, sim->layout, 0, 1, sim->mem.sets.set, 0,
                            NULL);
    vkCmdPushConstants(cmd, sim->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof sim->model->push,
                       &sim->model->push);
}

static void record_between(VkCommandBuffer cmd)
{
    ris_vk_barrier(cmd, compute, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, compute, shader_access);
}

static void record_dispatch(VkCommandBuffer cmd, VkPipeline pipeline, uint32_t count)
{
    if (count > 0) {
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdDispatch(cmd, (count + RIS_GROUP_NODE - 1) / RIS_GROUP_NODE, 1, 1);
    }
}

static void record_stage(const vk_sim *sim, VkCommandBuffer cmd, ris_stage stage)
{
    const ris_sim_push *push = &sim->model->push;
    switch (stage) {
    case RIS_STAGE_LIP_NORMAL: record_dispatch(cmd, sim->pipeline[stage], push->lip_node_count); break;
    case RIS_STAGE_CONTACT:
        record_dispatch(cmd, sim->pipeline[stage], push->lip_node_count);
        record_between(cmd);
        record_dispatch(cmd, sim->contact_bodies, push->contact_node_count - push->lip_node_count);
        break;
    case RIS_STAGE_NORMAL: record_dispatch(cmd, sim->pipeline[stage], push->node_count); break;
    default: record_dispatch(cmd, sim->pipeline[stage], push->moving_count); break;
    }
}

static void record_end(VkCommandBuffer cmd)
{
    ris_vk_barrier(cmd, compute, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                   everything | VK_PIPELINE_STAGE_2_HOST_BIT, any_access | VK_ACCESS_2_HOST_READ_BIT);
}

/* Room for the stage list and the timestamps of a tick. More substeps than fit the pool go untimed. */
static ris_result reserve(vk_sim *sim, uint32_t count, ris_error *err)
{
    uint8_t *stage = realloc(sim->query_stage, count);
    uint64_t *tick;
    if (stage) {
        sim->query_stage = stage;
    }
    tick = realloc(sim->query_tick, (count + 1) * sizeof *tick);
    if (tick) {
        sim->query_tick = tick;
    }
    if (!stage || !tick) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for the stages of %u dispatches", count);
    }
    ris_vk_query_finish(sim->vk, &sim->query);
    if (sim->timestamps && count < TIMESTAMP_MAX) {
        return ris_vk_query_create(sim->vk, count + 1, &sim->query, err);
    }
    return RIS_OK;
}

static ris_result record_frame(vk_sim *sim, uint32_t substeps, ris_error *err)
{
    ris_result result = RIS_OK;
    VkCommandBuffer cmd = sim->frame.handle;
    uint32_t count;
    sim->recorded_substeps = 0;
    RIS_TRY(reserve(sim, 5 * substeps + 2, err));
    RIS_TRY(ris_vk_cmd_begin(sim->vk, &sim->frame, false, err));
    ris_vk_query_reset(cmd, &sim->query);
    record_start(sim, cmd);
    ris_vk_query_write(cmd, &sim->query, 0);
    count = ris__sim_stages(sim->model, substeps, sim->query_stage);
    for (uint32_t k = 0; k < count; k++) {
        if (k > 0) {
            record_between(cmd);
        }
        record_stage(sim, cmd, (ris_stage)sim->query_stage[k]);
        ris_vk_query_write(cmd, &sim->query, k + 1);
    }
    /* the pool may be larger (no bend, no contact): every query must be written to be read with WAIT */
    for (uint32_t k = count + 1; k < sim->query.count; k++) {
        ris_vk_query_write(cmd, &sim->query, k);
    }
    record_end(cmd);
    RIS_TRY(ris_vk_cmd_end(sim->vk, &sim->frame, err));
    sim->query_used = count;
    sim->recorded_substeps = substeps;
    sim->recorded_timestamps = sim->timestamps;
fail:
    return result;
}

/* ---- the table ---- */

static ris_result upload(vk_sim *sim, const ris_anchor_frame *anchors, ris_error *err)
{
    const vk_state *mem = &sim->mem;
    char *data = mem->anchor.data;
    /* both buffers hold the same arrays at the same offsets */
    memcpy(data + mem->range[RIS_BIND_ANCHOR_POINT].offset, anchors->point,
           (size_t)mem->range[RIS_BIND_ANCHOR_POINT].size);
    memcpy(data + mem->range[RIS_BIND_ANCHOR_DELTA].offset, anchors->delta,
           (size_t)mem->range[RIS_BIND_ANCHOR_DELTA].size);
    memcpy(data + mem->range[RIS_BIND_CONTACT_BODY].offset, anchors->body,
           (size_t)mem->range[RIS_BIND_CONTACT_BODY].size);
    memcpy(data + mem->range[RIS_BIND_INERTIA].offset, anchors->inertia,
           (size_t)mem->range[RIS_BIND_INERTIA].size);
    return ris_vk_buffer_flush(sim->vk, &mem->anchor, err);
}

static ris_result read_times(vk_sim *sim, ris_sim_times *times, ris_error *err)
{
    ris_result result = RIS_OK;
    for (uint32_t s = 0; s < RIS_STAGE_COUNT; s++) {
        times->stage_ms[s] = 0.0;
    }
    if (sim->query.count == 0) {
        return RIS_OK;
    }
    RIS_TRY(ris_vk_query_read(sim->vk, &sim->query, sim->query_tick, err));
    for (uint32_t k = 0; k < sim->query_used; k++) {
        uint64_t ticks = (sim->query_tick[k + 1] - sim->query_tick[k]) & sim->query.mask;
        times->stage_ms[sim->query_stage[k]] += (double)ticks * sim->query.tick_ms;
    }
fail:
    return result;
}

static ris_result vk_frame(void *self, const ris_anchor_frame *anchors, uint32_t substeps,
                           ris_sim_times *times, ris_error *err)
{
    vk_sim *sim = self;
    ris_result result = RIS_OK;
    const uint64_t start = ris__clock_ns();
    uint64_t uploaded;
    RIS_TRY(upload(sim, anchors, err));
    uploaded = ris__clock_ns();
    if (sim->recorded_substeps != substeps || sim->recorded_timestamps != sim->timestamps) {
        RIS_TRY(record_frame(sim, substeps, err));
    }
    RIS_TRY(ris_vk_cmd_submit(sim->vk, &sim->frame, VK_NULL_HANDLE, VK_NULL_HANDLE, err));
    RIS_TRY(ris_vk_cmd_wait(sim->vk, &sim->frame, err));
    times->upload_ms = ris__clock_ms(start, uploaded);
    times->wait_ms = ris__clock_ms(uploaded, ris__clock_ns());
    RIS_TRY(read_times(sim, times, err));
fail:
    return result;
}

static ris_result vk_stage(void *self, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err)
{
    vk_sim *sim = self;
    ris_result result = RIS_OK;
    if (anchors) {
        RIS_TRY(upload(sim, anchors, err));
    }
    RIS_TRY(ris_vk_cmd_begin(sim->vk, &sim->single, true, err));
    record_start(sim, sim->single.handle);
    record_stage(sim, sim->single.handle, stage);
    record_end(sim->single.handle);
    RIS_TRY(ris_vk_cmd_run(sim->vk, &sim->single, err));
fail:
    return result;
}

static ris_result vk_read(void *self, ris_state state, ris_vec4 *out, ris_error *err)
{
    vk_sim *sim = self;
    ris_result result = RIS_OK;
    const vk_range *range = &sim->mem.range[ris__vk_state_binding(state)];
    const ris_vk_buffer *source = &sim->mem.state;
    VkBufferCopy copy = {.srcOffset = range->offset, .size = range->size};
    VkDeviceSize offset = range->offset;
    if (sim->mem.readback.handle) {
        RIS_TRY(ris_vk_cmd_begin(sim->vk, &sim->single, true, err));
        ris_vk_barrier(sim->single.handle, everything, any_access, VK_PIPELINE_STAGE_2_COPY_BIT,
                       VK_ACCESS_2_TRANSFER_READ_BIT);
        vkCmdCopyBuffer(sim->single.handle, sim->mem.state.handle, sim->mem.readback.handle, 1, &copy);
        ris_vk_barrier(sim->single.handle, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
        RIS_TRY(ris_vk_cmd_run(sim->vk, &sim->single, err));
        source = &sim->mem.readback;
        offset = 0;
    }
    RIS_TRY(ris_vk_buffer_invalidate(sim->vk, source, err));
    memcpy(out, (const char *)source->data + offset, (size_t)range->size);
fail:
    return result;
}

static ris_result vk_write(void *self, ris_state state, const ris_vec4 *in, ris_error *err)
{
    vk_sim *sim = self;
    const vk_range *range = &sim->mem.range[ris__vk_state_binding(state)];
    return ris_vk_buffer_write(sim->vk, &sim->mem.state, range->offset, in, range->size, err);
}

static const ris_sim_impl vk_impl = {vk_destroy, vk_frame, vk_stage, vk_read, vk_write};

ris_result ris_sim_create_vk(const ris_model *model, struct ris_device *device, ris_sim **out, ris_error *err)
{
    char name[600];
    ris_result result;
    vk_sim *sim = calloc(1, sizeof *sim);
    *out = NULL;
    if (!sim) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for a simulation");
    }
    sim->vk = device;
    sim->model = model;
    sim->timestamps = true;
    RIS_TRY(ris__vk_state_create(device, model, &sim->mem, err));
    RIS_TRY(create_pipelines(sim, err));
    RIS_TRY(ris_vk_cmd_create(device, "sim frame", &sim->frame, err));
    RIS_TRY(ris_vk_cmd_create(device, "sim single", &sim->single, err));
    snprintf(name, sizeof name, "%s, %s", device->info.name, device->info.driver);
    return ris__sim_create(model, &vk_impl, sim, name, out, err);
fail:
    vk_destroy(sim);
    return result;
}

/* ---- vk_sim.h ---- */

bool ris_vk_sim_get_view(ris_sim *front, ris_vk_sim_view *out)
{
    vk_sim *sim = ris__sim_self(front, &vk_impl);
    if (!sim) {
        return false;
    }
    out->device = sim->vk;
    out->buffer = sim->mem.state.handle;
    out->position_offset = sim->mem.range[RIS_BIND_POSITION].offset;
    out->normal_offset = sim->mem.range[RIS_BIND_NORMAL].offset;
    out->array_size = sim->mem.range[RIS_BIND_POSITION].size;
    return true;
}

void ris_vk_sim_set_timestamps(ris_sim *front, bool on)
{
    vk_sim *sim = ris__sim_self(front, &vk_impl);
    if (sim) {
        sim->timestamps = on;
    }
}

ris_result ris__vk_sim_check_guards(ris_sim *front, ris_error *err)
{
    vk_sim *sim = ris__sim_self(front, &vk_impl);
    uint32_t guard[RIS__VK_GUARD / sizeof(uint32_t)];
    for (uint32_t b = 0; b < RIS_BIND_COUNT; b++) {
        const vk_range *range = &sim->mem.range[b];
        ris_vk_buffer buffer = *range->buffer;
        ris_result result =
            ris_vk_buffer_read(sim->vk, &buffer, range->offset + range->size, guard, sizeof guard, err);
        if (result != RIS_OK) {
            return result;
        }
        for (uint32_t w = 0; w < RIS__VK_GUARD / sizeof(uint32_t); w++) {
            if (guard[w] != RIS__VK_SENTINEL) {
                return ris_fail(err, RIS_ERROR_FAILED, "word %u behind the array of binding %u is 0x%08x", w,
                                b, guard[w]);
            }
        }
    }
    return RIS_OK;
}

ris_result ris__vk_sim_spoil_guard(ris_sim *front, uint32_t binding, uint32_t word, ris_error *err)
{
    vk_sim *sim = ris__sim_self(front, &vk_impl);
    const vk_range *range = &sim->mem.range[binding];
    ris_vk_buffer buffer = *range->buffer;
    return ris_vk_buffer_write(sim->vk, &buffer, range->offset + range->size, &word, sizeof word, err);
}

ris_result ris__vk_sim_swap_bindings(ris_sim *front, uint32_t a, uint32_t b, ris_error *err)
{
    vk_sim *sim = ris__sim_self(front, &vk_impl);
    if (a >= RIS_BIND_COUNT || b >= RIS_BIND_COUNT) {
        return ris_fail(err, RIS_ERROR_FAILED, "bindings %u and %u, expected below %d", a, b, RIS_BIND_COUNT);
    }
    ris__vk_state_bind(sim->vk, &sim->mem, a, b);
    ris__vk_state_bind(sim->vk, &sim->mem, b, a);
    sim->recorded_substeps = 0; /* the recorded frame holds the old set */
    return RIS_OK;
}
