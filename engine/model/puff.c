/* Air in the mouth (cheek.puff; no thesis source). The buccinator walls the vestibule, before the masseter and between both
 * gums, where no bone backs the cheek: a pressure bulges it out as a membrane that is held all round, a suction draws
 * it in until it meets the teeth (contact). Here every node over such a muscle learns how far. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define FREE_FROM 0.3f /* of the muscle's length: where the unbacked middle of the wall begins, */
#define FREE_TO 0.5f   /* and where it ends, before the corner of the mouth */
#define SUCTION 0.6f   /* of the pressure: the teeth stand close behind, */
#define SUCKED 0.8f    /* and of its radius: the lips stay where the teeth hold them */

static void find_wall(ris_bake *bake, uint32_t m, const bool *apart)
{
    ris_model *model = bake->model;
    const ris_muscle *muscle = &model->muscle[m];
    const float reach = muscle->def->puff_radius_mm, length = ris__muscle_length(model, muscle);
    const char *name = muscle->name;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        ris_over_muscle place = {0};
        if (!bake->moving[i] || apart[i] || !ris__find_over_muscle(model, muscle, i, length, &place)) {
            continue;
        }
        const float beyond = length * f_max(f_max(FREE_FROM - place.along, place.along - FREE_TO), 0.0f);
        const float ratio2 = (place.beside_mm * place.beside_mm + beyond * beyond) / (reach * reach);
        const float most = muscle->def->puff_mm * f_smoothstep(2.0f * place.facing);
        const float bell = f_max(1.0f - ratio2, 0.0f), sunk = f_max(1.0f - ratio2 / (SUCKED * SUCKED), 0.0f);
        const float rise = most * bell * bell, sink = SUCTION * most * sunk * sunk;
        if (rise > 1e-3f) {
            ris_puff_node *node = &model->puff[model->puff_count++];
            node->node = i;
            node->side = name[strlen(name) - 1] == 'R';
            node->rise_mm = v3_scale(v4_xyz(model->rest_normal[i]), rise);
            node->sink_mm = v3_scale(v4_xyz(model->rest_normal[i]), sink);
        }
    }
}

ris_result ris__bake_puff(ris_bake *bake, ris_error *err)
{
    static const char *const regions[] = {"lips", "mouth_cavity", "inner_lip_rim",
                                          "lids", "eye_socket",   "nose"};
    ris_model *model = bake->model;
    size_t walls = 0;
    bool *apart = NULL;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        walls += model->muscle[m].def->puff_mm > 0.0f;
    }
    if (walls == 0 || bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    ris_result result =
        ris__model_alloc(&model->puff, walls * model->node_count, sizeof *model->puff, "cheeks", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&apart, model->node_count, sizeof *apart, "cheeks", err);
    }
    for (size_t k = 0; result == RIS_OK && k < sizeof regions / sizeof *regions; ++k) {
        ris__region_flags(bake->head, regions[k], apart);
    }
    for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
        if (model->muscle[m].def->puff_mm > 0.0f) {
            find_wall(bake, m, apart);
        }
    }
    free(apart);
    return result;
}
