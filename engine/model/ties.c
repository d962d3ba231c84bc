/* Incisivi (AU18): small muscles from the alveolar bone into the ring of a lip. Beside drawing the corner in,
 * they tie their half of the ring to the bone: it presses the lip against the teeth instead of pushing it
 * forward (muscle_contract). Here each finds its ring, the lip whose middle fibre points pass nearest. */
#include "model_impl.h"
#include "vec3.h"

static float distance_to_ring(const ris_model *model, const ris_muscle *muscle, const ris_muscle *ring,
                              uint8_t *end)
{
    const ris_vec3 p = ris__muscle_point(model, muscle, model->fiber_point, muscle->point_count / 2);
    float best = INFINITY;
    for (uint32_t i = 0; i < ring->point_count; ++i) {
        const float d = v3_distance(p, ris__muscle_point(model, ring, model->fiber_point, i));
        if (d < best) {
            best = d;
            *end = 2 * i >= ring->point_count;
        }
    }
    return best;
}

ris_result ris__bake_ties(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        ris_muscle *muscle = &model->muscle[m];
        float best = INFINITY;
        muscle->tied_ring = UINT32_MAX;
        for (uint32_t r = 0; muscle->def->acts_on == RIS_ACTS_ON_LIP && r < model->muscle_count; ++r) {
            uint8_t end = 0;
            if (model->muscle[r].kind != RIS_MUSCLE_SPHINCTER || model->muscle[r].def->closes_on_line) {
                continue;
            }
            const float d = distance_to_ring(model, muscle, &model->muscle[r], &end);
            if (d < best) {
                best = d;
                muscle->tied_ring = r;
                muscle->tied_end = end;
            }
        }
        if (muscle->def->acts_on == RIS_ACTS_ON_LIP && muscle->tied_ring == UINT32_MAX) {
            return ris_fail(err, RIS_ERROR_DATA, "muscle %s acts on a lip, but no lip has a ring",
                            muscle->name);
        }
    }
    return RIS_OK;
}
