/* Muscles that act on the ring of a lip besides the skin. Incisivi (AU18) run from the alveolar bone into it: beside
 * drawing the corner in, they tie their half of the ring to the bone, which presses the lip against the teeth instead of
 * pushing it forward. Mentalis (AU17) gathers the tissue of the chin below the lip, which pushes its half of the ring
 * (muscle_contract). Here each finds its ring, the lip whose middle fibre points pass nearest. */
#include "model_impl.h"
#include "vec3.h"

#define NO_RING UINT32_MAX

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

static uint32_t find_ring(const ris_model *model, const ris_muscle *muscle, uint8_t *out_end)
{
    uint32_t found = NO_RING;
    float best = INFINITY;
    for (uint32_t r = 0; r < model->muscle_count; ++r) {
        uint8_t end = 0;
        if (model->muscle[r].kind != RIS_MUSCLE_SPHINCTER || model->muscle[r].def->closes_on_line) {
            continue;
        }
        const float d = distance_to_ring(model, muscle, &model->muscle[r], &end);
        if (d < best) {
            best = d;
            found = r;
            *out_end = end;
        }
    }
    return found;
}

/* Towards the slit is where the muscle pulls, across the ring's axis; forward is along it. */
static ris_vec3 push_of(const ris_model *model, const ris_muscle *muscle, const ris_muscle *ring)
{
    const ris_vec3 none = {0}, axis = v3_unit_or(v3_sub(ring->axis[1], ring->axis[0]), none);
    const ris_vec3 pull =
        v3_sub(ris__muscle_point(model, muscle, model->fiber_point, 0),
               ris__muscle_point(model, muscle, model->fiber_point, muscle->point_count - 1));
    ris_vec3 up = v3_mad(pull, -v3_dot(axis, pull), axis);
    up.x = 0.0f; /* the two sides of a pair push the same way */
    const float length = ris__muscle_length(model, muscle);
    return v3_mad(v3_scale(v3_unit_or(up, none), muscle->def->push_lip[0] * length),
                  muscle->def->push_lip[1] * length, axis);
}

ris_result ris__bake_ties(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        ris_muscle *muscle = &model->muscle[m];
        const ris_muscle_def *def = muscle->def;
        const bool ties = def->acts_on == RIS_ACTS_ON_LIP,
                   pushes = def->push_lip[0] != 0.0f || def->push_lip[1] != 0.0f;
        uint8_t end = 0;
        const uint32_t ring = ties || pushes ? find_ring(model, muscle, &end) : NO_RING;
        if ((ties || pushes) && ring == NO_RING) {
            return ris_fail(err, RIS_ERROR_DATA, "muscle %s acts on a lip, but no lip has a ring",
                            muscle->name);
        }
        muscle->tied_ring = ties ? ring : NO_RING;
        muscle->pushed_ring = pushes ? ring : NO_RING;
        muscle->tied_end = muscle->pushed_end = end;
        if (pushes) {
            muscle->push = push_of(model, muscle, &model->muscle[ring]);
        }
    }
    return RIS_OK;
}
