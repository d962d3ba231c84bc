/* muscle_constrain, second half in the kaehler tissue: KA-34 dynamic constraint resolution. The muscle network (KA-29) runs
 * from rest for 20 ms in 10 steps of the skin's integrator, whatever the tick, and what its nodes move by moves the
 * muscles: so a pull at one group reaches the far ends of the muscles in it. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <string.h>

#define MASS_G 0.01f
#define DAMPING_G_S 3.0f
#define STIFFNESS_G_S2 40.0f
#define STEPS 10
#define STEP_S 0.002f

void ris__network_run(const ris_network *net, ris_vec3 *x, ris_vec3 *half, ris_vec3 *previous)
{
    memset(half, 0, net->node_count * sizeof *half);
    memset(previous, 0, net->node_count * sizeof *previous);
    for (int step = 0; step < STEPS; ++step) {
        memset(net->force, 0, net->node_count * sizeof *net->force);
        for (uint32_t s = 0; s < net->spring_count; ++s) {
            const ris_network_spring *spring = &net->spring[s];
            const ris_vec3 d = v3_sub(x[spring->b], x[spring->a]);
            const float l = v3_length(d);
            if (l > 1e-6f) {
                const ris_vec3 f = v3_scale(d, STIFFNESS_G_S2 * (l - net->rest_mm[s]) / l);
                net->force[spring->a] = v3_add(net->force[spring->a], f);
                net->force[spring->b] = v3_sub(net->force[spring->b], f);
            }
        }
        for (uint32_t k = 0; k < net->node_count; ++k) {
            if (net->node[k].fixed) {
                continue;
            }
            const ris_vec3 v = v3_sub(v3_scale(half[k], 1.5f), v3_scale(previous[k], 0.5f));
            const ris_vec3 a = v3_scale(v3_mad(net->force[k], -DAMPING_G_S, v), 1.0f / MASS_G);
            previous[k] = half[k];
            half[k] = v3_mad(half[k], STEP_S, a);
            x[k] = v3_mad(x[k], STEP_S, half[k]);
        }
    }
}

static ris_vec3 place_of(const ris_rig *rig, uint32_t node)
{
    const ris_model *model = rig->model;
    const ris_network_node *n = &model->network_node[node];
    return ris__muscle_point(model, &model->muscle[n->muscle], n->fixed ? rig->p : rig->q, n->point);
}

void ris__network_measure(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->network_node_count; ++k) {
        rig->network_x[k] = place_of(rig, k);
    }
    for (uint32_t s = 0; s < model->network_spring_count; ++s) {
        const ris_network_spring *spring = &model->network_spring[s];
        rig->network_rest[s] = spring->rest_mm >= 0.0f
                                   ? spring->rest_mm
                                   : v3_distance(rig->network_x[spring->a], rig->network_x[spring->b]);
    }
}

void ris__network_apply(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const uint32_t n = model->network_node_count;
    const ris_network net = {
        model->network_node,         model->network_spring, n,
        model->network_spring_count, rig->network_rest,     rig->network_v + 2 * (size_t)n};
    for (uint32_t k = 0; k < n; ++k) {
        rig->network_x[k] = place_of(rig, k);
    }
    ris__network_run(&net, rig->network_x, rig->network_v, rig->network_v + n);
    for (uint32_t k = 0; k < n; ++k) {
        const ris_network_node *node = &model->network_node[k];
        if (!node->fixed) {
            ris__displace_point(rig, node->muscle, node->point, v3_sub(rig->network_x[k], place_of(rig, k)));
        }
    }
}
