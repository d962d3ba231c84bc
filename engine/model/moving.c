/* The list of the nodes that move, in the order in which the stages take them: within a window of the mesh by the
 * number of their springs, so that the lanes of a wide device gather equally long and still read near by. */
#include "model_impl.h"

#include <stdlib.h>

#define WINDOW 512 /* nodes sorted at a time */

typedef struct entry {
    uint32_t node, springs;
} entry;

static int compare_springs(const void *a, const void *b)
{
    const entry *p = a, *q = b;
    if (p->springs != q->springs) {
        return p->springs > q->springs ? -1 : 1;
    }
    return p->node < q->node ? -1 : p->node > q->node;
}

ris_result ris__list_moving(ris_model *model, ris_error *err)
{
    entry *list = NULL;
    ris_result result = ris__model_alloc(&list, model->node_count, sizeof *list, "the moving nodes", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->moving, model->node_count, sizeof *model->moving,
                                  "the moving nodes", err);
    }
    if (result != RIS_OK) {
        free(list);
        return result;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (model->rest_position[i].w > 0.0f) {
            list[count++] = (entry){i, model->spring_start[i + 1] - model->spring_start[i]};
        }
    }
    for (uint32_t first = 0; first < count; first += WINDOW) {
        const uint32_t rest = count - first;
        qsort(list + first, rest < WINDOW ? rest : WINDOW, sizeof *list, compare_springs);
    }
    for (uint32_t k = 0; k < count; ++k) {
        model->moving[k] = list[k].node;
    }
    model->moving_count = model->push.moving_count = count;
    free(list);
    return RIS_OK;
}
