/* spring_force: KA-11 area-based stiffness, KA-12 biphasic modulus, KA-14 and KA-15 anchors, KA-16 sum of
 * forces (the damping is verlet's), and the bending and anchors of the default tissue. Order:
 * docs/physics.md. */
#include "sim/cpu/cpu_stage.h"

#include "model/vec3.h"

#define SMALLEST_RATIO 1e-6f

float ris__spring_pull(const ris_sim_push *push, float area_ratio, float rest_mm, float length_mm)
{
    float tension;
    if (length_mm < rest_mm) {
        tension = (push->compression * push->modulus_low) * (length_mm - rest_mm);
    } else if (push->flags & RIS_TISSUE_FLAG_CONTINUOUS) {
        const float s = push->switch_stretch * rest_mm;
        tension = push->modulus_low * (f_min(length_mm, s) - rest_mm) +
                  push->modulus_high * f_max(length_mm - s, 0.0f);
    } else {
        const float modulus =
            length_mm < push->switch_stretch * rest_mm ? push->modulus_low : push->modulus_high;
        tension = modulus * (length_mm - rest_mm);
    }
    return length_mm < SMALLEST_RATIO * rest_mm ? 0.0f : (area_ratio * tension) / length_mm;
}

/* Linear spring of stiffness k from x to a static end. */
static ris_vec3 add_anchor_spring(ris_vec3 f, ris_vec3 x, ris_vec3 end, float k, float rest_mm)
{
    const ris_vec3 d = v3_sub(end, x);
    const float l = v3_length(d);
    const float q = l < SMALLEST_RATIO * rest_mm ? 0.0f : (k * (l - rest_mm)) / l;
    return v3_mad(f, q, d);
}

static ris_vec3 add_anchor(ris_vec3 f, ris_vec3 x, const ris_anchor_param *param,
                           const ris_anchor_point *anchor)
{
    const ris_vec3 d = v3_sub(x, v4_xyz(anchor->a)), n = v4_xyz(anchor->b);
    const ris_vec3 m = v3_scale(n, v3_dot(n, d));
    const ris_vec3 pull = v3_mad(v3_scale(m, param->normal), param->tangential, v3_sub(d, m));
    return v3_sub(f, pull);
}

void ris__cpu_spring_force(ris_cpu_state *state)
{
    const ris_model *model = state->model;
    const ris_sim_push push = model->push;
    const bool kaehler = (push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    for (uint32_t m = 0; m < model->moving_count; ++m) {
        const uint32_t i = model->moving[m];
        ris_vec3 f = {0}, g = {0};
        const ris_vec3 x = v4_xyz(state->position[i]);
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            const ris_half_spring *half = &model->half_spring[h];
            const ris_vec3 d = v3_sub(v4_xyz(state->position[half->other]), x);
            f = v3_mad(f, ris__spring_pull(&push, half->area_ratio, half->rest_mm, v3_length(d)), d);
            if (!kaehler) {
                g = v3_mad(g, half->bend_in, v4_xyz(state->bend[half->other]));
            }
        }
        const ris_anchor_param *param = &model->anchor_param[i];
        const ris_anchor_point *anchor = &state->anchor_point[i];
        if (kaehler) {
            f = add_anchor_spring(f, x, v4_xyz(anchor->a), param->normal, param->rest_mm);
            f = add_anchor_spring(f, x, v4_xyz(anchor->b), param->normal, param->rest_mm);
        } else {
            f = v3_add(f, v3_sub(v3_scale(v4_xyz(state->bend[i]), param->bend), g));
            f = add_anchor(f, x, param, anchor);
        }
        state->force[i] = v4_from(f, 0.0f);
    }
}
