/* muscle_contract: KA-31 linear and KA-32 sphincter contraction of every fibre. Beyond the thesis, a
 * sphincter may close on a line: the eyelids' corners are held by ligaments, so its fibres draw together
 * across the slit between them. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <string.h>

#define LARGEST_CONTRACTION 0.95f
#define SMALLEST_PARAMETER 0.01f
#define ROOM_MM 6.0f       /* way of the lower incisors that lets a lip in between the teeth */
#define CARRY 0.85f        /* of a push on one lip across the slit, taken over by the other that lies on it */
#define CARRY_MM 3.0f      /* way of the lower incisors at which the lips lie on each other no more */
#define ACTIVITY_FULL 0.1f /* activation from which on a muscle counts fully among those that act */

void ris__contract_linear(const ris_vec3 *p, uint32_t n, float c, ris_vec3 *q)
{
    ris__contract_about(p, n, c, 0.0f, q);
}

void ris__contract_about(const ris_vec3 *p, uint32_t n, float c, float held_at, ris_vec3 *q)
{
    if (!(c > 0.0f)) {
        memcpy(q, p, n * sizeof *q);
        return;
    }
    float total = 0.0f;
    for (uint32_t i = 1; i < n; ++i) {
        total += v3_distance(p[i], p[i - 1]);
    }
    q[0] = p[0];
    const float held = held_at * total;
    float own = 0.0f; /* length up to point i */
    for (uint32_t i = held > 0.0f ? 0 : 1; i < n; ++i) {
        own += i > 0 ? v3_distance(p[i], p[i - 1]) : 0.0f;
        const float wanted = f_max(held + (1.0f - c) * (own - held), SMALLEST_PARAMETER * total);
        /* the segment k, k + 1 that holds the wanted length: a <= wanted <= b */
        uint32_t k = 0;
        float a = 0.0f, b = v3_distance(p[1], p[0]);
        while (b < wanted && k + 2 < n) {
            ++k;
            a = b;
            b += v3_distance(p[k + 1], p[k]);
        }
        q[i] = v3_lerp(p[k], p[k + 1], b > a ? (wanted - a) / (b - a) : 0.0f);
    }
}

void ris__bowstring(uint32_t n, float share, ris_vec3 *q)
{
    const ris_vec3 from = q[0], to = q[n - 1];
    float total = 0.0f, own = 0.0f;
    for (uint32_t i = 1; i < n; ++i) {
        total += v3_distance(q[i], q[i - 1]);
    }
    if (!(share > 0.0f) || !(total > 0.0f)) {
        return;
    }
    ris_vec3 before = from;
    for (uint32_t i = 1; i + 1 < n; ++i) {
        own += v3_distance(q[i], before);
        before = q[i];
        q[i] = v3_lerp(q[i], v3_lerp(from, to, own / total), share);
    }
}

ris_vec3 ris__contract_sphincter(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, float a, uint32_t j, uint32_t f,
                                 float c)
{
    const ris_vec3 axis = v3_sub(a1, a0), moving = v3_mad(a0, a, axis);
    const float length2 = v3_dot(axis, axis);
    ris_vec3 centre = moving;
    if (length2 > 0.0f && f > 1) {
        const ris_vec3 foot = v3_mad(a0, v3_dot(axis, v3_sub(p, a0)) / length2, axis);
        centre = v3_lerp(foot, moving, (float)j / (float)(f - 1));
    }
    return v3_mad(centre, 1.0f - c, v3_sub(p, centre));
}

ris_vec3 ris__contract_slit(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, float c)
{
    const ris_vec3 axis = v3_sub(a1, a0);
    const float length2 = v3_dot(axis, axis);
    const float t = length2 > 0.0f ? f_clamp(v3_dot(axis, v3_sub(p, a0)) / length2, 0.0f, 1.0f) : 0.0f;
    return v3_lerp(p, v3_mad(a0, t, axis), c);
}

ris_vec3 ris__contract_lip(ris_vec3 p, ris_vec3 a0, ris_vec3 a1, ris_vec3 side, uint32_t j, uint32_t f,
                           float c, float tie)
{
    const ris_vec3 axis = v3_unit_or(v3_sub(a1, a0), v3(0, 0, 1)), from = v3_sub(p, a0);
    const float out = v3_dot(axis, from), goal = v3_distance(a0, a1);
    const float inner = f > 1 ? (float)j / (float)(f - 1) : 1.0f;
    const ris_vec3 across = v3_sub(from, v3_scale(axis, out));
    const ris_vec3 beside = v3_scale(side, v3_dot(side, across)), above = v3_sub(across, beside);
    const float forward = 1.0f - RIS__LIP_TIED * tie;
    ris_vec3 q = v3_mad(p, -c * (1.0f + RIS__LIP_ARCH * f_max(forward, 0.0f)), beside);
    const float thicken = RIS__LIP_ABOVE_OUTER + (RIS__LIP_ABOVE_INNER - RIS__LIP_ABOVE_OUTER) * inner;
    q = v3_mad(q, -c * (thicken + tie * (RIS__LIP_ABOVE_TIED - thicken)), above);
    return v3_mad(q, forward * c * (RIS__LIP_OUTER + (1.0f - RIS__LIP_OUTER) * inner) * (goal - out), axis);
}

float ris__lip_middle(float along)
{
    const float from_middle = 2.0f * along - 1.0f;
    return 1.0f - from_middle * from_middle;
}

ris_vec3 ris__protrude(ris_vec3 a0, ris_vec3 a1, uint32_t j, uint32_t f, float along)
{
    const float inner = f > 1 ? (float)j / (float)(f - 1) : 1.0f;
    const float share = (RIS__LIP_OUTER + (1.0f - RIS__LIP_OUTER) * inner) * ris__lip_middle(along);
    return v3_scale(v3_sub(a1, a0), RIS__PROTRUDE * share);
}

ris_vec3 ris__ring_side(const ris_model *model, const ris_muscle *muscle)
{
    const ris_vec3 none = {0}, axis = v3_unit_or(v3_sub(muscle->axis[1], muscle->axis[0]), none);
    const ris_vec3 d = v3_sub(ris__muscle_point(model, muscle, model->fiber_point, muscle->point_count - 1),
                              ris__muscle_point(model, muscle, model->fiber_point, 0));
    return v3_unit_or(v3_mad(d, -v3_dot(axis, d), axis), none);
}

/* How a sphincter contracts this tick. */
typedef struct ring_pose {
    ris_vec3 axis[2], side;
    float c, protrude; /* 0..1 */
    float arch;        /* 0..1, how far both lips protrude: one alone is held at its ends by the other */
    float tie[2];      /* of the halves of a lip to the bone, 0..1 */
    ris_vec3 push[2];  /* of its halves, at the middle of the lip, mm */
    float pushed;      /* activation of the strongest pusher, 0..1 */
    bool literal, lip;
} ring_pose;

/* Of a muscle of activation a that pushes ring `pushed`, on ring m: its own, or that of the other lip, which lies on it and is
 * lifted, but not brought forward. */
static void add_push(const ris_rig *rig, ring_pose *ring, uint32_t m, const ris_muscle *pusher, float a)
{
    const ris_vec3 none = {0}, axis = v3_unit_or(v3_sub(ring->axis[1], ring->axis[0]), none);
    const bool own = pusher->pushed_ring == m;
    const float share = own ? a : rig->carry * a;
    const ris_vec3 push = own ? pusher->push : v3_mad(pusher->push, -v3_dot(axis, pusher->push), axis);
    ris_vec3 *half = &ring->push[pusher->pushed_end];
    *half = v3_mad(*half, share * pusher->max_shortening, push);
    ring->pushed = f_max(ring->pushed, share);
}

static ring_pose pose_ring(const ris_rig *rig, uint32_t m, float c, const float *pose)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[m];
    ring_pose ring = {.axis = {muscle->axis[0], muscle->axis[1]},
                      .side = ris__ring_side(model, muscle),
                      .c = c,
                      .literal = (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0};
    if (muscle->protrude_channel < model->channel_count) {
        ring.protrude = f_clamp(pose[muscle->protrude_channel], 0.0f, 1.0f);
    }
    ring.arch = ring.protrude;
    for (uint32_t k = 0; k < model->muscle_count; ++k) {
        const uint32_t channel = model->muscle[k].protrude_channel;
        if (ris__muscle_rolls(&model->muscle[k]) && channel < model->channel_count) {
            ring.arch = f_min(ring.arch, f_clamp(pose[channel], 0.0f, 1.0f));
        }
    }
    if (ring.literal && muscle->on_jaw) {
        ring.axis[0] = ris__rigid_apply(&rig->jaw, ring.axis[0]);
        ring.axis[1] = ris__rigid_apply(&rig->jaw, ring.axis[1]);
    }
    ring.lip = !ring.literal && !muscle->def->closes_on_line && v3_dot(ring.side, ring.side) > 0.5f;
    for (uint32_t k = 0; ring.lip && k < model->muscle_count; ++k) {
        const ris_muscle *other = &model->muscle[k];
        const float a = f_clamp(pose[k], 0.0f, 1.0f);
        if (other->tied_ring == m) {
            ring.tie[other->tied_end] = f_max(ring.tie[other->tied_end], a);
        }
        if (a > 0.0f && other->pushed_ring < model->muscle_count && ris__muscle_rolls(muscle)) {
            add_push(rig, &ring, m, other, a);
        }
    }
    return ring;
}

/* Point p of fibre f of a sphincter. In the default tissue the centre lies at the end of the axis whenever the muscle
 * contracts, and protruding is an act of its own. along: 0 at the ring's first end, 1 at its last. */
static ris_vec3 contract_ring(const ris_muscle *muscle, const ring_pose *ring, ris_vec3 p, uint32_t f,
                              float along)
{
    const ris_vec3 *axis = ring->axis;
    ris_vec3 q = p;
    if (ring->c > 0.0f && ring->lip) {
        q = ris__contract_lip(p, axis[0], axis[1], ring->side, f, muscle->fiber_count, ring->c,
                              ring->tie[0] + f_smoothstep(along) * (ring->tie[1] - ring->tie[0]));
    } else if (ring->c > 0.0f && muscle->def->closes_on_line) {
        q = ris__contract_slit(p, axis[0], axis[1], ring->c);
    } else if (ring->c > 0.0f) {
        q = ris__contract_sphincter(p, axis[0], axis[1], ring->literal ? ring->protrude : 1.0f, f,
                                    muscle->fiber_count, ring->c);
    }
    if (ring->pushed > 0.0f) {
        const ris_vec3 push = v3_lerp(ring->push[0], ring->push[1], f_smoothstep(along));
        const float middle = ris__lip_middle(along); /* squared, or the corners crumple */
        q = v3_mad(q, middle * middle, push);
    }
    if (ring->protrude > 0.0f && !ring->literal) {
        const float middle = ring->lip ? along : 0.5f; /* a closed ring has no ends to stay */
        q = v3_mad(q, ring->protrude, ris__protrude(axis[0], axis[1], f, muscle->fiber_count, middle));
        const float beside = v3_dot(ring->side, v3_sub(p, axis[0]));
        q = v3_mad(q, -RIS__PROTRUDE_ARCH * ring->arch * beside, ring->side);
    }
    return q;
}

/* How far the jaw lets the lips lie on each other, so that one lifts the other, 0..1. */
static float lips_carry(const ris_rig *rig)
{
    const ris_vec3 incisor = rig->model->head->jaw.incisor;
    const float drop = incisor.y - ris__rigid_apply(&rig->jaw, incisor).y;
    return CARRY * rig->meets * (1.0f - f_smoothstep(drop / CARRY_MM));
}

/* How far a lip that rolls in gets in between the teeth, 0..1: they must part and stand above each other, and it must not
 * be held out in front of them. */
static float room_for_lips(const ris_rig *rig, const float *pose)
{
    const ris_model *model = rig->model;
    const ris_vec3 incisor = model->head->jaw.incisor;
    float room = 0.4f + 0.6f * f_smoothstep((incisor.y - ris__rigid_apply(&rig->jaw, incisor).y) / ROOM_MM);
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const uint32_t channel = model->muscle[m].protrude_channel;
        if (channel < model->channel_count) {
            room *= 1.0f - f_clamp(pose[channel], 0.0f, 1.0f);
        }
    }
    return room * rig->meets;
}

void ris__muscle_contract(ris_rig *rig, const float *pose)
{
    const ris_model *model = rig->model;
    for (uint32_t side = 0; side < 2; ++side) {
        rig->roll[side] = f_clamp(pose[rig->first_beside + RIS__LIP_UPPER_ROLL + side], -1.0f, 1.0f);
        rig->puff[side] = f_clamp(pose[rig->first_beside + RIS__CHEEK_PUFF_L + side], -1.0f, 1.0f);
    }
    rig->suck = room_for_lips(rig, pose);
    rig->carry = lips_carry(rig);
    rig->close = f_clamp(pose[rig->first_beside + RIS__LIPS_CLOSE], 0.0f, 1.0f);
    const bool literal = (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const float activation = f_clamp(pose[m], 0.0f, 1.0f);
        const float c = f_min(activation * muscle->max_shortening, LARGEST_CONTRACTION);
        const bool sphincter = muscle->kind == RIS_MUSCLE_SPHINCTER;
        const ring_pose ring = sphincter ? pose_ring(rig, m, c, pose) : (ring_pose){.literal = true};
        /* a lip that protrudes takes its corner along as one that contracts does */
        rig->activation[m] = ring.literal ? activation : f_max(activation, ring.protrude);
        if (!ring.literal && ris__muscle_rolls(muscle)) {
            const float roll = rig->roll[muscle->on_jaw];
            rig->activation[m] = f_max(rig->activation[m], f_max(roll, -roll));
        }
        /* one that is pushed moves its skin too, but does not hold its corner */
        rig->activity[m] = f_min(f_max(rig->activation[m], ring.pushed) / ACTIVITY_FULL, 1.0f);
        rig->contraction[m] = c;
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            const uint32_t first = model->fiber[muscle->first_fiber + f].first_point;
            if (!sphincter) { /* between bones, these alone decide the length */
                const float shorter = muscle->def->end_bone == RIS_BONE_AUTO ? c : 0.0f;
                ris__contract_about(rig->p + first, muscle->point_count, shorter, muscle->def->held_at,
                                    rig->q + first);
                if (!literal) {
                    ris__bowstring(muscle->point_count, activation * muscle->def->bowstring, rig->q + first);
                }
                continue;
            }
            for (uint32_t i = 0; i < muscle->point_count; ++i) {
                rig->q[first + i] = contract_ring(muscle, &ring, rig->p[first + i], f,
                                                  (float)i / (float)(muscle->point_count - 1));
            }
        }
    }
}
