/* Memory of the host half of a tick (KA-30). */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <stdlib.h>
#include <string.h>

ris_result ris__rig_init(ris_rig *rig, const ris_model *model, ris_error *err)
{
    memset(rig, 0, sizeof *rig);
    rig->model = model;
    rig->first_beside = model->muscle_count;
    ris__tongue_init(&rig->tongue, model->head);
    const struct {
        void *field;
        size_t count, size;
    } arrays[] = {
        {&rig->onset, model->channel_count, sizeof *rig->onset},
        {&rig->release, model->channel_count, sizeof *rig->release},
        {&rig->excitation, model->channel_count, sizeof *rig->excitation},
        {&rig->reached, model->channel_count, sizeof *rig->reached},
        {&rig->pose, model->channel_count, sizeof *rig->pose},
        {&rig->p, model->fiber_point_count, sizeof *rig->p},
        {&rig->q, model->fiber_point_count, sizeof *rig->q},
        {&rig->constrained, model->fiber_point_count, sizeof *rig->constrained},
        {&rig->network_x, model->network_node_count, sizeof *rig->network_x},
        {&rig->network_v, 3 * (size_t)model->network_node_count, sizeof *rig->network_v},
        {&rig->network_rest, model->network_spring_count, sizeof *rig->network_rest},
        {&rig->contraction, model->muscle_count, sizeof *rig->contraction},
        {&rig->activation, model->muscle_count, sizeof *rig->activation},
        {&rig->activity, model->muscle_count, sizeof *rig->activity},
        {&rig->corner, model->group_count, sizeof *rig->corner},
        {&rig->drag, 2 * (size_t)model->muscle_count, sizeof *rig->drag},
        {&rig->squeeze, model->muscle_count, sizeof *rig->squeeze},
        {&rig->bulge, model->segment_count, sizeof *rig->bulge},
        {&rig->muscle_jaw, model->fiber_point_count, sizeof *rig->muscle_jaw},
        {&rig->move, model->node_count, sizeof *rig->move},
        {&rig->target, model->node_count, sizeof *rig->target},
        {&rig->point, model->node_count, sizeof *rig->point},
        {&rig->delta, model->node_count, sizeof *rig->delta},
        {&rig->lid_move, model->lid_count, sizeof *rig->lid_move},
        {&rig->lid_turn, model->lid_count, sizeof *rig->lid_turn},
        {&rig->lid_push, model->lid_count, sizeof *rig->lid_push},
        {&rig->lid_moved, model->lid_count, sizeof *rig->lid_moved},
        {&rig->lid_awake, model->lid_triangle_count, sizeof *rig->lid_awake},
        {&rig->lid_cross, model->lid_triangle_count, sizeof *rig->lid_cross},
    };
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; ++k) {
        ris_result result =
            ris__model_alloc(arrays[k].field, arrays[k].count, arrays[k].size, "the muscle stages", err);
        if (result != RIS_OK) {
            ris__rig_finish(rig);
            return result;
        }
    }
    for (uint32_t g = 0; g < model->group_point_count; ++g) {
        const ris_muscle *muscle = &model->muscle[model->group_point[g].muscle];
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            rig->constrained[model->fiber[muscle->first_fiber + f].first_point +
                             model->group_point[g].point] = true;
        }
    }
    ris_result result = ris__muscle_jaw_weights(model, rig->muscle_jaw, err);
    if (result != RIS_OK) {
        ris__rig_finish(rig);
        return result;
    }
    ris__activation_init(rig);
    ris__rig_reset(rig);
    return RIS_OK;
}

void ris__rig_finish(ris_rig *rig)
{
    free(rig->onset);
    free(rig->release);
    free(rig->excitation);
    free(rig->reached);
    free(rig->pose);
    free(rig->p);
    free(rig->q);
    free(rig->constrained);
    free(rig->network_x);
    free(rig->network_v);
    free(rig->network_rest);
    free(rig->contraction);
    free(rig->activation);
    free(rig->activity);
    free(rig->corner);
    free(rig->drag);
    free(rig->squeeze);
    free(rig->bulge);
    free(rig->muscle_jaw);
    free(rig->move);
    free(rig->target);
    free(rig->point);
    free(rig->delta);
    free(rig->lid_move);
    free(rig->lid_turn);
    free(rig->lid_push);
    free(rig->lid_moved);
    free(rig->lid_awake);
    free(rig->lid_cross);
    memset(rig, 0, sizeof *rig);
}

void ris__rig_reset(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const bool kaehler = (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    rig->jaw = ris__rigid_turn(v3(0, 0, 0), v3(1, 0, 0), 0.0);
    rig->eye[0] = rig->eye[1] = rig->head = rig->jaw;
    rig->tongue.still = true;
    rig->head_motion = (ris_head_motion){0};
    rig->inertia = (ris_inertia){0};
    memset(rig->excitation, 0, model->channel_count * sizeof *rig->excitation);
    memset(rig->reached, 0, model->channel_count * sizeof *rig->reached);
    memset(rig->pose, 0, model->channel_count * sizeof *rig->pose);
    memcpy(rig->p, model->fiber_point, model->fiber_point_count * sizeof *rig->p);
    memcpy(rig->q, model->fiber_point, model->fiber_point_count * sizeof *rig->q);
    memset(rig->contraction, 0, model->muscle_count * sizeof *rig->contraction);
    memset(rig->activation, 0, model->muscle_count * sizeof *rig->activation);
    memset(rig->activity, 0, model->muscle_count * sizeof *rig->activity);
    memset(rig->drag, 0, 2 * (size_t)model->muscle_count * sizeof *rig->drag);
    memset(rig->squeeze, 0, model->muscle_count * sizeof *rig->squeeze);
    memset(rig->puff, 0, sizeof rig->puff);
    memset(rig->roll, 0, sizeof rig->roll);
    rig->close = 0.0f;
    memset(rig->move, 0, model->node_count * sizeof *rig->move);
    memset(rig->delta, 0, model->node_count * sizeof *rig->delta);
    memset(rig->lid_move, 0, model->lid_count * sizeof *rig->lid_move);
    for (uint32_t s = 0; s < model->segment_count; ++s) {
        rig->bulge[s] = 1.0f;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        ris_vec3 x = v4_xyz(model->rest_position[i]);
        rig->target[i] = x;
        rig->point[i].a = v4_from(x, 0.0f);
        rig->point[i].b = model->rest_normal[i];
        if (kaehler) {
            const ris_vec3 a = ris__anchor_at_rest(model, i);
            rig->target[i] = a;
            rig->point[i].a = v4_from(a, 0.0f);
            rig->point[i].b = v4_from(v3_sub(v3_scale(x, 2.0f), a), 0.0f);
        }
    }
}
