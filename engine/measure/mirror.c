/* Mirror images of poses and skins: whatever the mirrored pose does must be the mirrored thing. */
#include "measure/measure_impl.h"
#include "asset/names.h"

#include <string.h>

#define PAIR_MM 1e-3f /* a partner stands this near to the mirrored place at rest */

void ris__measure_mirror_pose(const ris_model *model, const float *pose, float *out)
{
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        const char *name = model->channel[c].name;
        uint32_t from = c;
        for (uint32_t k = 0; k < model->channel_count; ++k) {
            if (ris__name_is_opposite(model->channel[k].name, name)) {
                from = k;
            }
        }
        out[c] = ris__name_turns_sign(name) ? 0.0f - pose[from] : pose[from];
    }
}

uint32_t ris__mirror_pairs(const ris_model *model, uint32_t *partner)
{
    uint32_t unpaired = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec4 p = model->rest_position[i];
        partner[i] = UINT32_MAX;
        float best = PAIR_MM * PAIR_MM;
        for (uint32_t j = 0; j < model->node_count; ++j) {
            const ris_vec4 q = model->rest_position[j];
            const float x = p.x + q.x, y = p.y - q.y, z = p.z - q.z, d = x * x + y * y + z * z;
            if (d <= best) {
                best = d;
                partner[i] = j;
            }
        }
        unpaired += partner[i] == UINT32_MAX;
    }
    return unpaired;
}

ris_finding ris__mirror_difference(const ris_model *model, const uint32_t *partner, const ris_vec4 *position,
                                   const ris_vec4 *mirrored)
{
    ris_finding worst = {.part = ""};
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (partner[i] == UINT32_MAX) {
            continue;
        }
        const dvec p = dv_of(position[i]), q = dv_of(mirrored[partner[i]]);
        const double d = dv_length(dv(p.x + q.x, p.y - q.y, p.z - q.z));
        const uint32_t count = worst.count + (d > 0);
        if (!(d <= worst.value)) {
            worst = (ris_finding){.value = d, .vertex_count = 1, .vertex = {i}, .part = ""};
        }
        worst.count = count;
    }
    return worst;
}
