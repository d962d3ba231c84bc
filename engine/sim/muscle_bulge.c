/* muscle_bulge: KA-36, height of the segments from the change of the fibre's length. */
#include "sim/rig.h"

#include "model/vec3.h"

#define NU_STRETCH 1.0f
#define NU_BELLY 5.0f /* between bones: what cannot shorten has to swell */
#define SMALLEST 0.1f

float ris__bulge_factor(ris_muscle_kind kind, float nu, float rho, uint32_t i, uint32_t count)
{
    nu = rho > 1.0f ? NU_STRETCH : nu;
    float shape = 1.0f;
    if (kind == RIS_MUSCLE_LINEAR && count >= 3) {
        const float s = 2.0f * (float)i / (float)(count - 1) - 1.0f;
        shape = 1.0f - s * s;
    }
    return f_max(1.0f + nu * (1.0f - rho) * shape, SMALLEST);
}

static float length_of(const ris_vec3 *p, uint32_t n)
{
    float length = 0.0f;
    for (uint32_t i = 1; i < n; ++i) {
        length += v3_distance(p[i], p[i - 1]);
    }
    return length;
}

/* Length of a fibre between the bones as they stand, of that at rest. */
static float stretch(const ris_rig *rig, const ris_fiber *fiber, uint32_t n)
{
    const ris_vec3 *rest = rig->model->fiber_point + fiber->first_point;
    const float *w = rig->muscle_jaw + fiber->first_point;
    float now = 0.0f;
    ris_vec3 last = {0};
    for (uint32_t i = 0; i < n; ++i) {
        const ris_vec3 p = v3_lerp(rest[i], ris__rigid_apply(&rig->jaw, rest[i]), w[i]);
        now += i > 0 ? v3_distance(p, last) : 0.0f;
        last = p;
    }
    return now / length_of(rest, n);
}

/* Muscles between bones: the bones alone decide the length, contraction makes the belly swell. */
static void bulge_between_bones(ris_rig *rig, uint32_t m)
{
    const ris_muscle *muscle = &rig->model->muscle[m];
    const uint32_t segments = muscle->point_count - 1;
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        const ris_fiber *fiber = &rig->model->fiber[muscle->first_fiber + f];
        const float rho = rig->jaw.identity ? 1.0f : stretch(rig, fiber, muscle->point_count);
        for (uint32_t s = 0; s < segments; ++s) {
            rig->bulge[fiber->first_segment + s] =
                ris__bulge_factor(muscle->kind, NU_BELLY, rho, s, segments) *
                ris__bulge_factor(muscle->kind, NU_BELLY, 1.0f - rig->contraction[m], s, segments);
        }
    }
}

void ris__muscle_bulge(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const ris_tissue_def *tissue = &model->head->tissue;
    const float nu = model->push.flags & RIS_TISSUE_FLAG_KAEHLER ? tissue->bulge_kaehler : tissue->bulge;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        if (muscle->def->end_bone != RIS_BONE_AUTO) {
            bulge_between_bones(rig, m);
            continue;
        }
        float squeeze = 0.0f;
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            const ris_fiber *fiber = &model->fiber[muscle->first_fiber + f];
            const float rho = length_of(rig->q + fiber->first_point, muscle->point_count) /
                              length_of(rig->p + fiber->first_point, muscle->point_count);
            squeeze += f_max(1.0f - rho, 0.0f) / f_max(rho, SMALLEST);
            for (uint32_t s = 0; s + 1 < muscle->point_count; ++s) {
                rig->bulge[fiber->first_segment + s] =
                    ris__bulge_factor(muscle->kind, nu, rho, s, muscle->point_count - 1);
            }
        }
        rig->squeeze[m] = squeeze / (float)muscle->fiber_count;
    }
}
