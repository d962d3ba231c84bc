/* verlet: KA-17 leapfrog with velocity evaluation, KA-16 damping, KA-18 start (v_half = v_prev = v0).
 * Order: docs/physics.md. Besides, what is felt of the head's motion (head_inertia). */
#include "sim/cpu/cpu_stage.h"

static void integrate(float *x, float *half, float *prev, float force, float inverse_mass, float felt,
                      const ris_sim_push *push)
{
    const float h = *half;
    const float v = 1.5f * h - 0.5f * *prev;
    const float a = (inverse_mass * force - push->damping_per_s * v) + felt;
    const float u = h + push->dt_s * a;
    *prev = h;
    *half = u;
    *x = *x + push->dt_s * u;
}

static float felt(ris_vec4 row, ris_vec4 x)
{
    return ((row.x * x.x + row.y * x.y) + row.z * x.z) + row.w;
}

void ris__cpu_verlet(ris_cpu_state *state)
{
    const ris_sim_push push = state->model->push;
    const ris_inertia head = state->inertia;
    for (uint32_t m = 0; m < state->model->moving_count; ++m) {
        const uint32_t i = state->model->moving[m];
        ris_vec4 *x = &state->position[i], *half = &state->velocity_half[i], *prev = &state->velocity_prev[i];
        const ris_vec4 *f = &state->force[i];
        const float w = x->w, heft = state->model->heft[i];
        const ris_vec4 at = *x;
        integrate(&x->x, &half->x, &prev->x, f->x, w, heft * felt(head.row_x, at), &push);
        integrate(&x->y, &half->y, &prev->y, f->y, w, heft * felt(head.row_y, at), &push);
        integrate(&x->z, &half->z, &prev->z, f->z, w, heft * felt(head.row_z, at), &push);
        state->free[i] = *x;
    }
}
