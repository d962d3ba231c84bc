/* Front of every simulation: argument checks, the order of the host stages (KA-30), divergence, settling,
 * hash. The device half of the frame is the backend's `frame` (sim/cpu/cpu_sim.c, sim/vk/vk_sim.c). */
#include "sim/rig.h"

#include "base/clock.h"
#include "base/hash.h"
#include "model/model_impl.h"
#include "model/vec3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_MM 1e5f         /* a node this far out has diverged */
#define REST_SPEED_MM_S 0.1f    /* at rest, docs/physics.md */
#define SUBSTEP_SPEED_MM_S 2.0f /* 4 um a substep */
#define REST_TICKS 15           /* 0.25 s */
#define SETTLE_S 20

struct ris_sim {
    const ris_model *model;
    const ris_sim_impl *impl;
    void *self;
    char backend[256];
    ris_rig rig;
    bool at_once;       /* the pose is held: only its equilibrium counts, and no onset */
    bool without_onset; /* ris_sim_set_onset */
    ris_vec4 *scratch;  /* (node_count) */
    ris_sim_times times;
};

const char *ris_stage_name(ris_stage stage)
{
    static const char *const names[RIS_STAGE_COUNT] = {"anchor_shift", "bend",    "spring_force", "verlet",
                                                       "lip_normal",   "contact", "normal"};
    return (unsigned)stage < RIS_STAGE_COUNT ? names[stage] : "?";
}

const char *ris_state_name(ris_state state)
{
    static const char *const names[RIS_STATE_COUNT] = {"position", "velocity_half", "velocity_prev", "force",
                                                       "bend",     "normal",        "free"};
    return (unsigned)state < RIS_STATE_COUNT ? names[state] : "?";
}

uint32_t ris__sim_stages(const ris_model *model, uint32_t substeps, uint8_t *list)
{
    const bool bend = !(model->push.flags & RIS_TISSUE_FLAG_KAEHLER);
    uint32_t count = 0;
    list[count++] = RIS_STAGE_ANCHOR_SHIFT;
    for (uint32_t k = 0; k < substeps; ++k) {
        if (bend) {
            list[count++] = RIS_STAGE_BEND;
        }
        list[count++] = RIS_STAGE_SPRING_FORCE;
        list[count++] = RIS_STAGE_VERLET;
        if (model->push.lip_node_count > 0) {
            list[count++] = RIS_STAGE_LIP_NORMAL;
        }
        if (model->push.contact_node_count > 0) {
            list[count++] = RIS_STAGE_CONTACT;
        }
    }
    list[count++] = RIS_STAGE_NORMAL;
    return count;
}

ris_result ris__sim_create(const ris_model *model, const ris_sim_impl *impl, void *self,
                           const char *backend_name, ris_sim **out, ris_error *err)
{
    *out = NULL;
    ris_sim *sim = NULL;
    ris_result result = ris__model_alloc(&sim, 1, sizeof *sim, "the simulation", err);
    if (result != RIS_OK) {
        impl->destroy(self);
        return result;
    }
    sim->model = model;
    sim->impl = impl;
    sim->self = self;
    snprintf(sim->backend, sizeof sim->backend, "%s", backend_name);
    result = ris__rig_init(&sim->rig, model, err);
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&sim->scratch, model->node_count, sizeof *sim->scratch, "the simulation", err);
    }
    if (result == RIS_OK) {
        result = ris_sim_reset(sim, err);
    }
    if (result != RIS_OK) {
        ris_sim_destroy(sim);
        return result;
    }
    *out = sim;
    return RIS_OK;
}

void ris_sim_destroy(ris_sim *sim)
{
    if (!sim) {
        return;
    }
    sim->impl->destroy(sim->self);
    ris__rig_finish(&sim->rig);
    free(sim->scratch);
    free(sim);
}

void *ris__sim_self(ris_sim *sim, const ris_sim_impl *impl)
{
    return sim && sim->impl == impl ? sim->self : NULL;
}

ris_result ris_sim_reset(ris_sim *sim, ris_error *err)
{
    const ris_model *model = sim->model;
    static const ris_state zeroed[] = {RIS_STATE_VELOCITY_HALF, RIS_STATE_VELOCITY_PREV, RIS_STATE_FORCE,
                                       RIS_STATE_BEND};
    ris__rig_reset(&sim->rig);
    ris_result result = sim->impl->write(sim->self, RIS_STATE_POSITION, model->rest_position, err);
    if (result == RIS_OK) {
        result = sim->impl->write(sim->self, RIS_STATE_NORMAL, model->rest_normal, err);
    }
    if (result == RIS_OK) {
        result = sim->impl->write(sim->self, RIS_STATE_FREE, model->rest_position, err);
    }
    memset(sim->scratch, 0, model->node_count * sizeof *sim->scratch);
    for (size_t k = 0; result == RIS_OK && k < sizeof zeroed / sizeof zeroed[0]; ++k) {
        result = sim->impl->write(sim->self, zeroed[k], sim->scratch, err);
    }
    return result;
}

/* The host stages, in order. */
static void run_muscle_stages(ris_sim *sim, const float *asked)
{
    const float *pose = sim->rig.pose;
    ris__activation(&sim->rig, asked, sim->at_once || sim->without_onset);
    ris__jaw_pose(&sim->rig, pose);
    ris__muscle_contract(&sim->rig, pose);
    ris__muscle_constrain(&sim->rig);
    ris__muscle_relax(&sim->rig);
    ris__muscle_bulge(&sim->rig);
    ris__muscle_attach(&sim->rig);
    ris__lid_pose(&sim->rig, pose);
    ris__tongue_pose(&sim->rig, pose);
    ris__contact_pose(&sim->rig);
    ris__head_inertia(&sim->rig, sim->at_once);
}

ris_result ris__sim_pose(ris_sim *sim, const float *pose, ris_anchor_frame *out, ris_error *err)
{
    for (uint32_t k = 0; k < sim->model->channel_count; ++k) {
        if (!isfinite(pose[k])) {
            return ris_fail(err, RIS_ERROR_USAGE, "channel %s of the pose is %g, expected a number",
                            sim->model->channel[k].name, (double)pose[k]);
        }
    }
    run_muscle_stages(sim, pose);
    out->point = sim->rig.point;
    out->delta = sim->rig.delta;
    out->body = sim->rig.body;
    out->inertia = &sim->rig.inertia;
    return RIS_OK;
}

ris_result ris__sim_stage(ris_sim *sim, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err)
{
    if ((unsigned)stage >= RIS_STAGE_COUNT) {
        return ris_fail(err, RIS_ERROR_USAGE, "there is no stage %d", (int)stage);
    }
    return sim->impl->stage(sim->self, stage, anchors, err);
}

/* Lowest node that is not finite or is absurdly far out, or node_count. */
static uint32_t first_wild(const ris_vec4 *value, uint32_t count, float limit)
{
    for (uint32_t i = 0; i < count; ++i) {
        if (!(fabsf(value[i].x) < limit && fabsf(value[i].y) < limit && fabsf(value[i].z) < limit)) {
            return i;
        }
    }
    return count;
}

/* Names the first stage whose result at the wild vertex is no number; a finite but huge position is the
 * integrator's. */
static ris_result report_divergence(ris_sim *sim, uint32_t vertex, ris_error *err)
{
    const char *stage = ris_stage_name(RIS_STAGE_VERLET);
    const ris_vec3 anchor = v4_xyz(sim->rig.point[vertex].a);
    if (!isfinite(anchor.x) || !isfinite(anchor.y) || !isfinite(anchor.z)) {
        stage = "muscle_attach";
    } else if (sim->impl->read(sim->self, RIS_STATE_FORCE, sim->scratch, err) == RIS_OK) {
        const ris_vec4 *f = &sim->scratch[vertex];
        if (!isfinite(f->x) || !isfinite(f->y) || !isfinite(f->z)) {
            stage = ris_stage_name(RIS_STAGE_SPRING_FORCE);
        }
    }
    return ris_fail(err, RIS_ERROR_DIVERGED, "the simulation diverged: stage %s, vertex %u", stage, vertex);
}

ris_result ris_sim_tick(ris_sim *sim, const float *pose, ris_error *err)
{
    const ris_model *model = sim->model;
    ris_anchor_frame anchors;
    memset(&sim->times, 0, sizeof sim->times);
    const uint64_t start = ris__clock_ns();
    ris_result result = ris__sim_pose(sim, pose, &anchors, err);
    sim->times.muscle_ms = ris__clock_ms(start, ris__clock_ns());
    if (result == RIS_OK) {
        result = sim->impl->frame(sim->self, &anchors, model->head->tissue.substeps, &sim->times, err);
    }
    if (result == RIS_OK) {
        result = sim->impl->read(sim->self, RIS_STATE_POSITION, sim->scratch, err);
    }
    if (result == RIS_OK) {
        uint32_t wild = first_wild(sim->scratch, model->node_count, LARGEST_MM);
        if (wild < model->node_count) {
            return report_divergence(sim, wild, err);
        }
    }
    return result;
}

/* Fastest node of the last tick: by the way it made, or by its velocity where that is more than SUBSTEP_SPEED_MM_S.
 * (A node squeezed between two bodies may keep a velocity that contact undoes within the substep.) Before are the
 * positions a tick ago; they become the present ones. */
static ris_result find_fastest(ris_sim *sim, ris_vec4 *before, ris_hold *out, ris_error *err)
{
    const uint32_t n = sim->model->node_count;
    ris_result result = sim->impl->read(sim->self, RIS_STATE_POSITION, sim->scratch, err);
    out->speed_mm_s = 0.0f;
    for (uint32_t i = 0; i < n && result == RIS_OK; ++i) {
        const float way = v3_distance(v4_xyz(sim->scratch[i]), v4_xyz(before[i])) / (float)RIS_TICK_S;
        before[i] = sim->scratch[i];
        if (way > out->speed_mm_s) {
            out->speed_mm_s = way;
            out->vertex = i;
        }
    }
    if (result == RIS_OK) {
        result = sim->impl->read(sim->self, RIS_STATE_VELOCITY_HALF, sim->scratch, err);
    }
    for (uint32_t i = 0; i < n && result == RIS_OK; ++i) {
        const float speed = v3_length(v4_xyz(sim->scratch[i]));
        if (speed > SUBSTEP_SPEED_MM_S && speed > out->speed_mm_s) {
            out->speed_mm_s = speed;
            out->vertex = i;
        }
    }
    return result;
}

void ris_sim_set_onset(ris_sim *sim, bool on)
{
    sim->without_onset = !on;
}

ris_result ris_sim_hold(ris_sim *sim, const float *pose, double limit_s, ris_hold *out, ris_error *err)
{
    uint32_t quiet = 0;
    ris_vec4 *before = NULL;
    *out = (ris_hold){0};
    sim->at_once = true;
    ris_result result =
        ris__model_alloc(&before, sim->model->node_count, sizeof *before, "the simulation", err);
    for (uint32_t tick = 1; result == RIS_OK && !out->at_rest && (tick - 0.5) * RIS_TICK_S < limit_s;
         ++tick) {
        result = ris_sim_tick(sim, pose, err);
        if (result == RIS_OK) {
            result = find_fastest(sim, before, out, err);
        }
        quiet = out->speed_mm_s <= REST_SPEED_MM_S ? quiet + 1 : 0;
        out->at_rest = result == RIS_OK && quiet >= REST_TICKS;
        out->time_s = tick * RIS_TICK_S;
    }
    sim->at_once = false;
    free(before);
    return result;
}

ris_result ris_sim_settle(ris_sim *sim, const float *pose, double *out_time_s, ris_error *err)
{
    ris_hold hold;
    ris_result result = ris_sim_hold(sim, pose, SETTLE_S, &hold, err);
    if (result == RIS_OK && !hold.at_rest) {
        result = ris_fail(err, RIS_ERROR_FAILED,
                          "the pose did not come to rest in %d s: vertex %u still moves at %.3f mm/s",
                          SETTLE_S, hold.vertex, (double)hold.speed_mm_s);
    }
    if (result == RIS_OK && out_time_s) {
        *out_time_s = hold.time_s;
    }
    return result;
}

ris_result ris_sim_read(ris_sim *sim, ris_state state, ris_vec4 *out, ris_error *err)
{
    if ((unsigned)state >= RIS_STATE_COUNT) {
        return ris_fail(err, RIS_ERROR_USAGE, "there is no state %d", (int)state);
    }
    return sim->impl->read(sim->self, state, out, err);
}

ris_result ris_sim_write(ris_sim *sim, ris_state state, const ris_vec4 *in, ris_error *err)
{
    if ((unsigned)state >= RIS_STATE_COUNT) {
        return ris_fail(err, RIS_ERROR_USAGE, "there is no state %d", (int)state);
    }
    return sim->impl->write(sim->self, state, in, err);
}

ris_result ris_sim_hash(ris_sim *sim, uint64_t *out, ris_error *err)
{
    static const ris_state states[] = {RIS_STATE_POSITION, RIS_STATE_VELOCITY_HALF, RIS_STATE_VELOCITY_PREV};
    uint64_t hash = RIS_HASH_START;
    for (size_t k = 0; k < sizeof states / sizeof states[0]; ++k) {
        ris_result result = sim->impl->read(sim->self, states[k], sim->scratch, err);
        if (result != RIS_OK) {
            return result;
        }
        hash = ris__hash(hash, sim->scratch, sim->model->node_count * sizeof *sim->scratch);
    }
    *out = hash;
    return RIS_OK;
}

const ris_sim_times *ris_sim_get_times(const ris_sim *sim)
{
    return &sim->times;
}

const ris_model *ris_sim_get_model(const ris_sim *sim)
{
    return sim->model;
}

const char *ris_sim_backend(const ris_sim *sim)
{
    return sim->backend;
}

void ris_sim_bone_transform(const ris_sim *sim, ris_bone bone, float out[12])
{
    static const ris_rigid skull = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0}, true};
    switch (bone) {
    case RIS_BONE_JAW: ris__rigid_matrix(&sim->rig.jaw, out); return;
    case RIS_BONE_EYE_L: ris__rigid_matrix(&sim->rig.eye[0], out); return;
    case RIS_BONE_EYE_R: ris__rigid_matrix(&sim->rig.eye[1], out); return;
    case RIS_BONE_AUTO:
    case RIS_BONE_SKULL:
    case RIS_BONE_SKIN: break;
    }
    ris__rigid_matrix(&skull, out);
}

bool ris_sim_part_shape(const ris_sim *sim, uint32_t part, ris_vec4 *out)
{
    const ris_mesh *mesh = &sim->model->head->part[part].mesh;
    if (mesh != sim->rig.tongue.mesh) {
        return false;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        out[v] = v4_from(ris__tongue_place(&sim->rig.tongue, mesh->position[v]), 1.0f);
    }
    return true;
}

void ris_sim_head_transform(const ris_sim *sim, float out[12])
{
    ris__rigid_matrix(&sim->rig.head, out);
}

void ris_sim_muscles(const ris_sim *sim, ris_vec3 *point, ris_segment *segment)
{
    ris__muscle_shape(&sim->rig, point, segment);
}

float ris_sim_activation(const ris_sim *sim, uint32_t muscle)
{
    return muscle < sim->model->muscle_count ? sim->rig.activation[muscle] : 0.0f;
}

ris_vec3 ris_sim_landmark(const ris_sim *sim, uint32_t landmark, const ris_vec4 *position, ris_vec3 *out_tip)
{
    const ris_landmark *mark = &sim->model->head->landmark[landmark];
    ris_vec3 at = {0}, tip;
    if (mark->mesh == RIS_LANDMARK_SKIN) {
        for (int k = 0; k < 3; ++k) {
            at = v3_mad(at, mark->weight[k], v4_xyz(position[mark->vertex[k]]));
        }
        tip = at;
    } else {
        const bool jaw = mark->mesh == RIS_LANDMARK_MANDIBLE;
        tip = v3_mad(mark->at, mark->depth_mm, mark->dowel);
        at = jaw ? ris__rigid_apply(&sim->rig.jaw, mark->at) : mark->at;
        tip = jaw ? ris__rigid_apply(&sim->rig.jaw, tip) : tip;
    }
    if (out_tip) {
        *out_tip = tip;
    }
    return at;
}
