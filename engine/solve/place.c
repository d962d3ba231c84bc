/* Where a search stands, to come back to. */
#include "model/model_impl.h"
#include "solve/solver.h"

#include <stdlib.h>
#include <string.h>

ris_result ris__place_make(const ris_solver *s, ris_place *out, ris_error *err)
{
    *out = (ris_place){0};
    const struct {
        void *out;
        size_t count, size;
    } room[] = {{&out->u, s->n, sizeof *out->u},
                {&out->step, s->n, sizeof *out->step},
                {&out->frozen, s->n, sizeof *out->frozen},
                {&out->seen, s->rows, sizeof *out->seen},
                {&out->pose, s->model->channel_count, sizeof *out->pose}};
    ris_result r = ris__snapshot_make(s->model, &out->now, err);
    for (size_t k = 0; !r && k < sizeof room / sizeof *room; ++k) {
        r = ris__model_alloc(room[k].out, room[k].count, room[k].size, "the solver", err);
    }
    return r;
}

void ris__place_free(ris_place *place)
{
    void *const list[] = {place->u, place->step, place->frozen, place->seen, place->pose};
    ris__snapshot_free(&place->now);
    for (size_t k = 0; k < sizeof list / sizeof *list; ++k) {
        free(list[k]);
    }
    *place = (ris_place){0};
}

void ris__place_remember(const ris_solver *s, ris_place *out)
{
    memcpy(out->u, s->u, s->n * sizeof *s->u);
    memcpy(out->step, s->step, s->n * sizeof *s->step);
    memcpy(out->frozen, s->frozen, s->n * sizeof *s->frozen);
    memcpy(out->seen, s->seen, s->rows * sizeof *s->seen);
    memcpy(out->pose, s->pose, s->model->channel_count * sizeof *s->pose);
    for (int k = 0; k < 4; ++k) {
        memcpy(out->now.state[k], s->now.state[k], s->model->node_count * sizeof(ris_vec4));
    }
    out->rms_mm = s->rms_mm;
    out->glanced = s->glanced;
}

ris_result ris__place_return(ris_solver *s, const ris_place *place, ris_error *err)
{
    memcpy(s->u, place->u, s->n * sizeof *s->u);
    memcpy(s->step, place->step, s->n * sizeof *s->step);
    memcpy(s->frozen, place->frozen, s->n * sizeof *s->frozen);
    memcpy(s->seen, place->seen, s->rows * sizeof *s->seen);
    memcpy(s->pose, place->pose, s->model->channel_count * sizeof *s->pose);
    for (int k = 0; k < 4; ++k) {
        memcpy(s->now.state[k], place->now.state[k], s->model->node_count * sizeof(ris_vec4));
    }
    s->rms_mm = place->rms_mm;
    s->glanced = place->glanced;
    return ris__snapshot_put(s->def->sim[0], &s->now, err);
}
