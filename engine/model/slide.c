/* Skin close to bone slides over it: what muscles move it by goes along the bone, not into it. Forehead, brow
 * and bridge of the nose glide so; the cheek, with centimetres of fat below, does not mind. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define THIN_MM 5.0f   /* tissue so thin slides, */
#define THICK_MM 10.0f /* and so thick gives way */

ris_result ris__bake_slide(ris_bake *bake, ris_error *err)
{
    static const char *const regions[] = {"lips", "mouth_cavity", "lids", "eye_socket"};
    ris_model *model = bake->model;
    bool *apart = NULL;
    ris_result result =
        ris__model_alloc(&model->slide, model->node_count, sizeof *model->slide, "skin over bone", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&apart, model->node_count, sizeof *apart, "skin over bone", err);
    }
    for (size_t k = 0; result == RIS_OK && k < sizeof regions / sizeof *regions; ++k) {
        ris__region_flags(bake->head, regions[k], apart);
    }
    for (uint32_t i = 0; result == RIS_OK && i < model->node_count; ++i) {
        const float depth = v3_distance(v4_xyz(model->rest_position[i]), model->bone_anchor[i]);
        model->slide[i] = apart[i] ? 0.0f : 1.0f - f_smoothstep((depth - THIN_MM) / (THICK_MM - THIN_MM));
    }
    free(apart);
    return result;
}
