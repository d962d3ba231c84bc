/* bend: umbrella vector L(x - x0) of the default tissue's bending energy. Order: docs/physics.md. */
#include "sim/cpu/cpu_stage.h"

#include "model/vec3.h"

void ris__cpu_bend(ris_cpu_state *state)
{
    const ris_model *model = state->model;
    for (uint32_t m = 0; m < model->moving_count; ++m) {
        const uint32_t i = model->moving[m];
        const ris_vec3 d0 = v3_sub(v4_xyz(state->position[i]), v4_xyz(model->rest_position[i]));
        ris_vec3 b = {0};
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            const ris_half_spring *half = &model->half_spring[h];
            const ris_vec3 dj =
                v3_sub(v4_xyz(state->position[half->other]), v4_xyz(model->rest_position[half->other]));
            b = v3_mad(b, half->bend_out, v3_sub(dj, d0));
        }
        state->bend[i] = v4_from(b, 0.0f);
    }
}
