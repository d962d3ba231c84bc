/* muscle_relax: KA-35, sections of a lengthened fibre between constrained points are straightened. Literal
 * in the kaehler tissue; in the default tissue muscle_constrain has spread the pull along the fibre
 * already, and lips must not be straightened. */
#include "sim/rig.h"

#include "model/vec3.h"

#define MU 4.0f

float ris__relax_weight(float length_mm, float rest_length_mm)
{
    return f_clamp(MU * (length_mm - rest_length_mm) / rest_length_mm, 0.0f, 1.0f);
}

static float closed_length(const ris_vec3 *p, uint32_t n)
{
    float length = v3_distance(p[n - 1], p[0]);
    for (uint32_t i = 1; i < n; ++i) {
        length += v3_distance(p[i], p[i - 1]);
    }
    return length;
}

static void straighten(ris_vec3 *q, uint32_t u, uint32_t v, float w)
{
    float total = 0.0f, length = 0.0f;
    for (uint32_t j = u + 1; j <= v; ++j) {
        total += v3_distance(q[j], q[j - 1]);
    }
    if (!(total > 0.0f)) {
        return;
    }
    const ris_vec3 from = q[u], to = q[v];
    ris_vec3 previous = q[u];
    for (uint32_t i = u + 1; i < v; ++i) {
        length += v3_distance(q[i], previous);
        previous = q[i];
        q[i] = v3_lerp(q[i], v3_lerp(from, to, length / total), w);
    }
}

void ris__muscle_relax(ris_rig *rig)
{
    const ris_model *model = rig->model;
    if (!(model->push.flags & RIS_TISSUE_FLAG_KAEHLER)) {
        return;
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const uint32_t n = model->muscle[m].point_count;
        for (uint32_t f = 0; f < model->muscle[m].fiber_count; ++f) {
            const uint32_t first = model->fiber[model->muscle[m].first_fiber + f].first_point;
            const float w =
                ris__relax_weight(closed_length(rig->q + first, n), closed_length(rig->p + first, n));
            uint32_t u = 0;
            for (uint32_t v = 1; v < n && w > 0.0f; ++v) {
                if (rig->constrained[first + v] || v + 1 == n) {
                    straighten(rig->q + first, u, v, w);
                    u = v;
                }
            }
        }
    }
}
