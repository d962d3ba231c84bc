/* The CPU reference behind ris_sim: every device stage in the same order on plain arrays. Written from
 * the thesis and docs/physics.md, apart from the shaders, so that parity means something. */
#include "sim/cpu/cpu_stage.h"
#include "sim/sim_impl.h"

#include "base/clock.h"
#include "model/model_impl.h"

#include <stdlib.h>
#include <string.h>

static void cpu_destroy(void *self)
{
    ris_cpu_state *state = self;
    if (!state) {
        return;
    }
    free(state->position);
    free(state->velocity_half);
    free(state->velocity_prev);
    free(state->force);
    free(state->bend);
    free(state->normal);
    free(state->free);
    free(state->anchor_point);
    free(state->anchor_delta);
    free(state->list);
    free(state);
}

static void take_anchors(ris_cpu_state *state, const ris_anchor_frame *anchors)
{
    memcpy(state->anchor_point, anchors->point, state->model->node_count * sizeof *state->anchor_point);
    memcpy(state->anchor_delta, anchors->delta, state->model->node_count * sizeof *state->anchor_delta);
    if (anchors->body) {
        memcpy(state->contact_body, anchors->body, sizeof state->contact_body);
    }
    if (anchors->inertia) {
        state->inertia = *anchors->inertia;
    }
}

static void (*const stages[RIS_STAGE_COUNT])(ris_cpu_state *) = {
    [RIS_STAGE_ANCHOR_SHIFT] = ris__cpu_anchor_shift,
    [RIS_STAGE_BEND] = ris__cpu_bend,
    [RIS_STAGE_SPRING_FORCE] = ris__cpu_spring_force,
    [RIS_STAGE_VERLET] = ris__cpu_verlet,
    [RIS_STAGE_LIP_NORMAL] = ris__cpu_lip_normal,
    [RIS_STAGE_CONTACT] = ris__cpu_contact,
    [RIS_STAGE_NORMAL] = ris__cpu_normal,
};

static void timed_stage(ris_cpu_state *state, ris_stage stage, ris_sim_times *times)
{
    const uint64_t start = ris__clock_ns();
    stages[stage](state);
    times->stage_ms[stage] += ris__clock_ms(start, ris__clock_ns());
}

static ris_result cpu_frame(void *self, const ris_anchor_frame *anchors, uint32_t substeps,
                            ris_sim_times *times, ris_error *err)
{
    ris_cpu_state *state = self;
    const uint64_t start = ris__clock_ns();
    take_anchors(state, anchors);
    times->upload_ms += ris__clock_ms(start, ris__clock_ns());
    if (substeps > state->list_substeps) {
        uint8_t *grown = realloc(state->list, 5 * (size_t)substeps + 2);
        if (!grown) {
            return ris_fail(err, RIS_ERROR_MEMORY, "no memory for the stages of %u substeps", substeps);
        }
        state->list = grown;
        state->list_substeps = substeps;
    }
    const uint32_t count = ris__sim_stages(state->model, substeps, state->list);
    for (uint32_t k = 0; k < count; ++k) {
        timed_stage(state, (ris_stage)state->list[k], times);
    }
    return RIS_OK;
}

static ris_result cpu_stage(void *self, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err)
{
    (void)err;
    if (anchors) {
        take_anchors(self, anchors);
    }
    stages[stage](self);
    return RIS_OK;
}

static ris_vec4 *array_of(ris_cpu_state *state, ris_state which)
{
    switch (which) {
    case RIS_STATE_POSITION: return state->position;
    case RIS_STATE_VELOCITY_HALF: return state->velocity_half;
    case RIS_STATE_VELOCITY_PREV: return state->velocity_prev;
    case RIS_STATE_FORCE: return state->force;
    case RIS_STATE_BEND: return state->bend;
    case RIS_STATE_FREE: return state->free;
    case RIS_STATE_NORMAL:
    case RIS_STATE_COUNT: break;
    }
    return state->normal;
}

static ris_result cpu_read(void *self, ris_state which, ris_vec4 *out, ris_error *err)
{
    ris_cpu_state *state = self;
    (void)err;
    memcpy(out, array_of(state, which), state->model->node_count * sizeof *out);
    return RIS_OK;
}

static ris_result cpu_write(void *self, ris_state which, const ris_vec4 *in, ris_error *err)
{
    ris_cpu_state *state = self;
    (void)err;
    memcpy(array_of(state, which), in, state->model->node_count * sizeof *in);
    return RIS_OK;
}

static const ris_sim_impl cpu_impl = {cpu_destroy, cpu_frame, cpu_stage, cpu_read, cpu_write};

ris_result ris_sim_create_cpu(const ris_model *model, ris_sim **out, ris_error *err)
{
    *out = NULL;
    ris_cpu_state *state = NULL;
    ris_result result = ris__model_alloc(&state, 1, sizeof *state, "the CPU simulation", err);
    if (result != RIS_OK) {
        return result;
    }
    state->model = model;
    ris_vec4 **const arrays[] = {&state->position, &state->velocity_half, &state->velocity_prev,
                                 &state->force,    &state->bend,          &state->normal,
                                 &state->free,     &state->anchor_delta};
    for (size_t k = 0; result == RIS_OK && k < sizeof arrays / sizeof arrays[0]; ++k) {
        result =
            ris__model_alloc(arrays[k], model->node_count, sizeof **arrays[k], "the CPU simulation", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&state->anchor_point, model->node_count, sizeof *state->anchor_point,
                                  "the CPU simulation", err);
    }
    if (result != RIS_OK) {
        cpu_destroy(state);
        return result;
    }
    return ris__sim_create(model, &cpu_impl, state, "cpu", out, err);
}
