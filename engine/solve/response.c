/* Columns of the response: from the present equilibrium each control is changed by a step and the face simulated for a few
 * ticks. The shift of the anchors (KA-37) does nearly all of the way in the first tick, so that a few tell what a hold would
 * to about a tenth; the solver's own holds correct the rest. */
#include "solve/solver.h"

#include "model/model_impl.h"
#include "risorius/timeline.h"
#include "sim/sim_impl.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define TICKS 3

static const ris_state kept[4] = {RIS_STATE_POSITION, RIS_STATE_VELOCITY_HALF, RIS_STATE_VELOCITY_PREV,
                                  RIS_STATE_NORMAL};

ris_result ris__snapshot_make(const ris_model *model, ris_snapshot *out, ris_error *err)
{
    ris_result r = RIS_OK;
    *out = (ris_snapshot){0};
    for (int k = 0; !r && k < 4; ++k) {
        r = ris__model_alloc(&out->state[k], model->node_count, sizeof *out->state[k], "a state", err);
    }
    return r;
}

void ris__snapshot_free(ris_snapshot *snapshot)
{
    for (int k = 0; k < 4; ++k) {
        free(snapshot->state[k]);
    }
    *snapshot = (ris_snapshot){0};
}

ris_result ris__snapshot_take(ris_sim *sim, ris_snapshot *out, ris_error *err)
{
    ris_result r = RIS_OK;
    for (int k = 0; !r && k < 4; ++k) {
        r = ris_sim_read(sim, kept[k], out->state[k], err);
    }
    return r;
}

ris_result ris__snapshot_put(ris_sim *sim, const ris_snapshot *snapshot, ris_error *err)
{
    ris_result r = RIS_OK;
    for (int k = 0; !r && k < 4; ++k) {
        r = ris_sim_write(sim, kept[k], snapshot->state[k], err);
    }
    return r ? r : ris_sim_write(sim, RIS_STATE_FREE, snapshot->state[0], err);
}

void ris__solver_pose(const ris_solver *solver, const double *u, float *pose)
{
    const uint32_t channels = solver->model->channel_count;
    for (uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (uint32_t k = 0; k < solver->n; ++k) {
            sum += u[k] * (double)solver->unit[(size_t)k * channels + c];
        }
        pose[c] = (float)sum;
    }
    ris_pose_clamp(solver->model, pose);
}

void ris__solver_see(const ris_solver *solver, const ris_sim *sim, const ris_vec4 *position, float *seen)
{
    const ris_target *target = solver->target;
    for (uint32_t i = 0; i < target->count; ++i) {
        ris_vec3 at;
        if (target->landmarks) {
            at = ris_sim_landmark(sim, target->index[i], position, NULL);
        } else {
            const ris_vec4 *p = &position[target->index[i]];
            at = (ris_vec3){p->x, p->y, p->z};
        }
        seen[3 * i] = at.x;
        seen[3 * i + 1] = at.y;
        seen[3 * i + 2] = at.z;
    }
}

typedef struct worker {
    ris_solver *solver;
    ris_sim *sim;
    uint32_t first, stride;
    const bool *wanted;
    const float *still; /* what is seen after the ticks without a change (rows) */
    ris_vec4 *position; /* (node_count) */
    float *pose, *changed;
    double *u;
    atomic_bool *stop;
    ris_result result;
    ris_error err;
} worker;

/* What the target sees a few ticks after the pose became `changed`; the simulation comes from the solver's state. */
static ris_result look(worker *w, const float *changed, float *seen)
{
    ris_anchor_frame frame;
    ris_result r = ris__snapshot_put(w->sim, &w->solver->now, &w->err);
    if (!r) { /* where the anchors stand, so that the first tick shifts by the change alone */
        r = ris__sim_pose(w->sim, w->pose, &frame, &w->err);
    }
    for (int k = 0; !r && k < TICKS; ++k) {
        r = ris_sim_tick(w->sim, changed, &w->err);
    }
    if (!r) {
        r = ris_sim_read(w->sim, RIS_STATE_POSITION, w->position, &w->err);
    }
    if (!r) {
        ris__solver_see(w->solver, w->sim, w->position, seen);
    }
    return r;
}

static void *work(void *data)
{
    worker *w = data;
    ris_solver *solver = w->solver;
    for (uint32_t k = w->first; !w->result && k < solver->n; k += w->stride) {
        if (!w->wanted[k]) {
            continue;
        }
        if (w->first == 0 && solver->def->go_on &&
            !solver->def->go_on(solver->def->user, solver->iteration, solver->rms_mm)) {
            atomic_store(w->stop, true);
        }
        if (atomic_load(w->stop)) {
            break;
        }
        float *column = solver->column + (size_t)k * solver->rows;
        memcpy(w->u, solver->u, solver->n * sizeof *w->u);
        w->u[k] += solver->step[k];
        ris__solver_pose(solver, w->u, w->changed);
        w->result = look(w, w->changed, column);
        for (uint32_t i = 0; !w->result && i < solver->rows; ++i) {
            column[i] = (column[i] - w->still[i]) / (float)solver->step[k];
        }
    }
    return NULL;
}

static ris_result open_worker(worker *w, ris_error *err)
{
    const ris_model *model = w->solver->model;
    ris_result r = ris__model_alloc(&w->position, model->node_count, sizeof *w->position, "a column", err);
    if (!r) {
        r = ris__model_alloc(&w->pose, model->channel_count, sizeof *w->pose, "a pose", err);
    }
    if (!r) {
        r = ris__model_alloc(&w->changed, model->channel_count, sizeof *w->changed, "a pose", err);
    }
    if (!r) {
        r = ris__model_alloc(&w->u, w->solver->n, sizeof *w->u, "a pose", err);
    }
    if (!r) {
        memcpy(w->pose, w->solver->pose, model->channel_count * sizeof *w->pose);
    }
    return r;
}

static ris_result run_workers(worker *list, uint32_t count, ris_error *err)
{
    pthread_t thread[RIS_SOLVE_SIMS];
    uint32_t started = 1;
    ris_result r = RIS_OK;
    while (started < count && pthread_create(&thread[started], NULL, work, &list[started]) == 0) {
        ++started;
    }
    for (uint32_t t = started; t < count; ++t) { /* no thread to be had: one after the other */
        work(&list[t]);
    }
    work(&list[0]);
    for (uint32_t t = 1; t < started; ++t) {
        pthread_join(thread[t], NULL);
    }
    for (uint32_t t = 0; !r && t < count; ++t) {
        if (list[t].result) {
            r = ris_fail(err, list[t].result, "%s", list[t].err.text);
        }
    }
    return r;
}

ris_result ris__solver_respond(ris_solver *solver, const bool *wanted, ris_error *err)
{
    worker list[RIS_SOLVE_SIMS] = {0};
    const uint32_t count = solver->def->sim_count;
    atomic_bool stop = false;
    float *still = NULL;
    ris_result r = ris__model_alloc(&still, solver->rows, sizeof *still, "a column", err);
    for (uint32_t t = 0; !r && t < count; ++t) {
        list[t] = (worker){.solver = solver,
                           .sim = solver->def->sim[t],
                           .first = t,
                           .stride = count,
                           .wanted = wanted,
                           .still = still,
                           .stop = &stop};
        r = open_worker(&list[t], err);
    }
    if (!r && (r = look(&list[0], list[0].pose, still))) {
        *err = list[0].err;
    }
    if (!r) {
        r = run_workers(list, count, err);
    }
    if (!r && atomic_load(&stop)) {
        r = ris_fail(err, RIS_ERROR_FAILED, "interrupted");
    }
    ris_anchor_frame frame;
    if (!r) {
        r = ris__snapshot_put(solver->def->sim[0], &solver->now, err);
    }
    if (!r) {
        r = ris__sim_pose(solver->def->sim[0], solver->pose, &frame, err);
    }
    for (uint32_t t = 0; t < count; ++t) {
        free(list[t].position);
        free(list[t].pose);
        free(list[t].changed);
        free(list[t].u);
    }
    free(still);
    return r;
}
