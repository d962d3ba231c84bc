/* anchor_shift: KA-37 over-relaxation, every free node moves with its anchor once a tick. Order:
 * docs/physics.md. */
#include "sim/cpu/cpu_stage.h"

void ris__cpu_anchor_shift(ris_cpu_state *state)
{
    for (uint32_t m = 0; m < state->model->moving_count; ++m) {
        const uint32_t i = state->model->moving[m];
        ris_vec4 *x = &state->position[i];
        const ris_vec4 *delta = &state->anchor_delta[i];
        x->x = x->x + delta->x;
        x->y = x->y + delta->y;
        x->z = x->z + delta->z;
    }
}
