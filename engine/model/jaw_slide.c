/* How far a node follows the mandible when that slides (jaw.forward, jaw.side) rather than opens. Opening parts the
 * lips, so the jaw's weights are steep at the corner of the mouth; a slide with the mouth closed moves the ring of the
 * lips as one soft band, and steep weights would shear its corner over. KA-05 knows no slide. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define FAR_WEIGHT 0.02f
#define RIM_EDGES 2
#define PASSES 200    /* of smoothing over the springs: about 32 mm */
#define RIM_PASSES 12 /* more, with the lining held: the lips go over into it without a step */

/* The lining of the mouth behind the rim of the lips is bound to its bone: over RIM_EDGES edges it gives up the smoothed
 * weight for its own. done counts them (0 outside, or not yet reached). */
static void bind_lining(const ris_bake *bake, uint32_t *done)
{
    ris_model *model = bake->model;
    const bool *lining = bake->lining;
    for (uint32_t edges = 1; edges <= RIM_EDGES; ++edges) {
        for (uint32_t i = 0; i < model->node_count; ++i) {
            for (uint32_t h = model->spring_start[i];
                 lining[i] && done[i] == 0 && h < model->spring_start[i + 1]; ++h) {
                const uint32_t j = model->half_spring[h].other;
                done[i] = edges == 1 ? !lining[j] : done[j] == edges - 1 ? edges : 0;
            }
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (lining[i]) {
            const float own = done[i] ? (float)done[i] / RIM_EDGES : 1.0f;
            model->jaw_slide_weight[i] += own * (bake->head->jaw_weight[i] - model->jaw_slide_weight[i]);
        }
    }
}

/* Each moving node halfway to the mean of its neighbours, passes times; the lining too, or held. before is scratch. */
static void smooth(const ris_bake *bake, uint32_t passes, bool lining_too, float *before)
{
    ris_model *model = bake->model;
    for (uint32_t pass = 0; pass < passes; ++pass) {
        memcpy(before, model->jaw_slide_weight, model->node_count * sizeof *before);
        for (uint32_t i = 0; i < model->node_count; ++i) {
            const uint32_t first = model->spring_start[i], end = model->spring_start[i + 1];
            float sum = 0.0f;
            for (uint32_t h = first; h < end; ++h) {
                sum += before[model->half_spring[h].other];
            }
            if (bake->moving[i] && end > first && (lining_too || !bake->lining[i])) {
                model->jaw_slide_weight[i] = 0.5f * before[i] + 0.5f * sum / (float)(end - first);
            }
        }
    }
}

ris_result ris__bake_jaw_slide(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t n = model->node_count;
    float *before = NULL;
    ris_result result =
        ris__model_alloc(&model->jaw_slide_weight, n, sizeof *model->jaw_slide_weight, "jaw weights", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&before, n, sizeof *before, "jaw weights", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    memcpy(model->jaw_slide_weight, bake->head->jaw_weight, n * sizeof *before);
    smooth(bake, PASSES, true, before);
    for (uint32_t i = 0; i < n; ++i) { /* what is left far away, up to the scalp, is nothing */
        model->jaw_slide_weight[i] =
            f_max((model->jaw_slide_weight[i] - FAR_WEIGHT) / (1.0f - FAR_WEIGHT), 0.0f);
    }
    uint32_t *done = NULL;
    result = ris__model_alloc(&done, n, sizeof *done, "jaw weights", err);
    if (result == RIS_OK) {
        bind_lining(bake, done);
        smooth(bake, RIM_PASSES, false, before);
    }
    free(done);
    free(before);
    return result;
}
