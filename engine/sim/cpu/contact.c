/* contact (beyond the thesis; KF-04): nodes stay off the other lip, then out of bone, teeth and eyes. All but a node's own
 * place is read from before contact, so the order of nodes means nothing; both ends of an edge give way for its middle. A
 * node that does both stands in the list twice. Order: docs/physics.md. */
#include "sim/cpu/cpu_stage.h"

#include "model/distance_grid.h"
#include "model/model_impl.h"
#include "model/vec3.h"

#define SHARE 0.5f /* of what is missing, a substep: each lip gives way by half, and notches cannot throw */
#define GLIDE 0.5f /* of its speed a touching node keeps, a substep */
/* The moist film slows that much farther off, or pressed lips tremble by microns. */
#define FILM_MM 0.1f
#define FILM_WEIGHT_FULL 0.03f /* with less of the other lip near it fades */
#define LIP_WEIGHT_FULL 0.6f   /* with less of the other lip near, contact fades */

/* What contact may change of a node. */
typedef struct touch {
    ris_vec3 x, half, prev;
} touch;

/* Speed v along what is touched: nothing into it, and half of the rest is lost to the moist film between. */
static ris_vec3 glide(ris_vec3 n, ris_vec3 v)
{
    const float c = v3_dot(n, v);
    const ris_vec3 u = c < 0.0f ? v3(v.x - c * n.x, v.y - c * n.y, v.z - c * n.z) : v;
    return v3_scale(u, GLIDE);
}

/* Moves the node by push along the unit vector n and takes the speed against n from it. */
static void push_off(touch *t, ris_vec3 n, float push)
{
    if (push > 0.0f) {
        t->x = v3_mad(t->x, push, n);
        t->half = glide(n, t->half);
        t->prev = glide(n, t->prev);
    }
}

static void touch_lip(const ris_cpu_state *state, const ris_contact_node *contact, touch *t)
{
    const float limit = contact->lip_limit_mm;
    ris_vec3 away;
    float weight;
    const float d = ris__lip_distance(state->model, state->free, state->normal, contact, &away, &weight);
    const float l = v3_length(away);
    if (!(weight > 0.0f) || !(l > 0.0f)) {
        return;
    }
    const float gap = d - limit;
    if (gap < 0.0f) {
        const float share = SHARE * f_min(weight / LIP_WEIGHT_FULL, 1.0f);
        push_off(t, v3(away.x / l, away.y / l, away.z / l), share * (limit - d));
    } else if (gap < FILM_MM) {
        const float film = (1.0f - gap / FILM_MM) * f_min(weight / FILM_WEIGHT_FULL, 1.0f);
        const float keep = 1.0f - (1.0f - GLIDE) * film;
        t->half = v3_scale(t->half, keep);
        t->prev = v3_scale(t->prev, keep);
    }
}

/* x: the node, or the middle of an edge that goes with it. */
static void touch_body(const ris_vec4 *grid, const ris_contact_body *body, ris_vec3 x, float limit, touch *t)
{
    const ris_vec4 rx = body->row_x, ry = body->row_y, rz = body->row_z;
    const ris_vec3 p =
        v3(((rx.x * x.x + rx.y * x.y) + rx.z * x.z) + rx.w, ((ry.x * x.x + ry.y * x.y) + ry.z * x.z) + ry.w,
           ((rz.x * x.x + rz.y * x.y) + rz.z * x.z) + rz.w);
    const uint32_t count[3] = {body->count_x, body->count_y, body->count_z};
    ris_vec4 g;
    if (!ris__grid_blend(grid + body->first, v4_xyz(body->low), body->low.w, count, p, &g) ||
        !(g.w < limit)) {
        return;
    }
    const ris_vec3 w = v3((rx.x * g.x + ry.x * g.y) + rz.x * g.z, (rx.y * g.x + ry.y * g.y) + rz.y * g.z,
                          (rx.z * g.x + ry.z * g.y) + rz.z * g.z);
    const float l = v3_length(w);
    if (l > 0.0f) {
        push_off(t, v3(w.x / l, w.y / l, w.z / l), SHARE * (limit - g.w));
    }
}

void ris__cpu_contact(ris_cpu_state *state)
{
    const ris_model *model = state->model;
    for (uint32_t c = 0; c < model->contact_node_count; ++c) {
        const ris_contact_node *contact = &model->contact_node[c];
        const uint32_t i = contact->node;
        touch t = {v4_xyz(state->position[i]), v4_xyz(state->velocity_half[i]),
                   v4_xyz(state->velocity_prev[i])};
        touch_lip(state, contact, &t);
        for (uint32_t k = contact->touch_first; k < contact->touch_end; ++k) {
            const ris_contact_touch *with = &model->contact_touch[k];
            const ris_vec3 half_edge =
                v3_scale(v3_sub(v4_xyz(state->free[with->other]), v4_xyz(state->free[i])), 0.5f);
            touch_body(model->contact_grid, &state->contact_body[with->body], v3_add(t.x, half_edge),
                       with->limit_mm, &t);
        }
        state->position[i] = v4_from(t.x, state->free[i].w);
        state->velocity_half[i] = v4_from(t.half, 0.0f);
        state->velocity_prev[i] = v4_from(t.prev, 0.0f);
    }
}
