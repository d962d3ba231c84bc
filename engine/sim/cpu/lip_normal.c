/* lip_normal (KA-20): normals of the lips' nodes anew each substep, before contact pushes along them; with the normals
 * of the last tick pressed lips would swing for ever. Order: docs/physics.md, normal. */
#include "sim/cpu/cpu_stage.h"

#include "model/vec3.h"

void ris__cpu_lip_normal(ris_cpu_state *state)
{
    const ris_model *model = state->model;
    for (uint32_t c = 0; c < model->push.lip_node_count; ++c) {
        const uint32_t i = model->contact_node[c].node;
        const ris_vec3 n = ris__area_normal(model, state->free, i);
        const float l = v3_length(n);
        if (l > 0.0f) {
            state->normal[i] = v4_from(v3(n.x / l, n.y / l, n.z / l), 0.0f);
        }
    }
}
