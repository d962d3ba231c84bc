/* normal: KA-20, area-weighted vertex normals once a tick. Order: docs/physics.md. */
#include "sim/cpu/cpu_stage.h"

#include "model/vec3.h"

ris_vec3 ris__area_normal(const ris_model *model, const ris_vec4 *position, uint32_t i)
{
    const ris_vec3 x = v4_xyz(position[i]);
    ris_vec3 s = {0};
    for (uint32_t k = model->ring_start[i]; k < model->ring_start[i + 1]; ++k) {
        const ris_vec3 u = v3_sub(v4_xyz(position[model->ring[k].b]), x);
        const ris_vec3 v = v3_sub(v4_xyz(position[model->ring[k].c]), x);
        s = v3_add(s, v3_cross(u, v));
    }
    return s;
}

void ris__cpu_normal(ris_cpu_state *state)
{
    const ris_model *model = state->model;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec3 s = ris__area_normal(model, state->position, i);
        const float l = v3_length(s);
        if (l > 0.0f) {
            state->normal[i] = v4_from(v3(s.x / l, s.y / l, s.z / l), 0.0f);
        }
    }
}
