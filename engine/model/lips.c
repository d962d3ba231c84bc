/* lips.close (no thesis source): orbicularis oris is a purse string. When the jaw drops, the arcs of both lips would grow
 * longer; contracting they lie along the chord between the corners instead, wherever the jaw is. A node that the ring of a
 * lip holds then goes with the jaw by the share the corners do, so that both lips meet as they do at rest. */
#include "model_impl.h"
#include "vec3.h"

#define MEET                                                                                                 \
    0.42f /* of the jaw's way: where the lips meet, below the middle because the lower lip is the looser one */

bool ris__muscle_rolls(const ris_muscle *muscle)
{
    return muscle->kind == RIS_MUSCLE_SPHINCTER && !muscle->def->closes_on_line && muscle->fiber_count > 1;
}

ris_result ris__bake_lips(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    bool rings = false;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        rings = rings || ris__muscle_rolls(&model->muscle[m]);
    }
    if (!rings || bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    ris_result result =
        ris__model_alloc(&model->lip_close, model->node_count, sizeof *model->lip_close, "lips", err);
    for (uint32_t i = 0; result == RIS_OK && i < model->node_count; ++i) {
        float held = 0.0f;
        for (uint32_t b = model->binding_start[i]; b < model->binding_start[i + 1]; ++b) {
            if (ris__muscle_rolls(&model->muscle[model->binding[b].muscle])) {
                held += model->binding[b].weight;
            }
        }
        model->lip_close[i] = f_min(held, 1.0f) * (MEET - model->jaw_weight[i]);
    }
    for (uint32_t k = 0; result == RIS_OK && k < model->lining_count;
         ++k) { /* it goes with the lips before it */
        const ris_lining_node *node = &model->lining[k];
        float sum = 0.0f;
        for (uint32_t s = 0; s < node->source_count; ++s) {
            sum += model->lip_close[node->source[s]];
        }
        model->lip_close[node->node] = node->keep * sum;
    }
    return result;
}
