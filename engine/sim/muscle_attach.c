/* muscle_attach, last stage of the muscles: KA-37 attached points follow their segments; KA-14, KA-15
 * anchors of the tick.
 *
 * Default tissue (docs/physics.md), node at rest X, bindings (muscle, weight w, activity s in 0..1):
 *     P      = X + sum f w s delta / F / max(1, sum f w s c / F)
 *              delta blended over the segments of the binding, f the muscle's strength, F its mean over w s,
 *              c = |delta| / farthest |delta| x squared cosine of delta with the sum
 *              (a ring that a corner of the mouth drags counts with t^p below the bar, t = 1 at the corner,
 *              0 at the midline); the lining of the mouth goes with the lips before it
 *     target = P + jaw_weight (J(P) - P),  normal = unit(n + jaw_weight (J n - n))
 * kaehler tissue: anchor A follows its one segment or its bone, mirror M moves by the same displacement.
 * The change of the target since the last tick is the over-relaxation of anchor_shift. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#define ROLL_RAD 1.0f /* turn of the free edge of a lip at roll 1 */
#define ROLL_MM 1.0f  /* way of the skin before it towards the slit of the mouth */
/* Where the teeth leave room a lip can be sucked in between them (AU28): it turns on, the skin before it comes after and goes
 * back over the teeth; what would go past the other lip is flattened against it. */
#define SUCK_RAD 0.2f
#define SUCK_MM 9.0f
#define SUCK_BACK_MM 4.0f
#define SUCK_FROM 2.2f /* from so many widths of the ring before the line it rolls about */
#define EDGE 0.9f      /* where the other lip is, in widths behind that line */
#define FLAT_MM 3.5f   /* over so much */
#define BONE_MM 80.0f  /* radius of forehead and brow, about */

/* down, but not past edge: a smooth minimum. */
static float flattened(float down, float edge)
{
    const float left = f_clamp(0.5f + (edge - down) / (2.0f * FLAT_MM), 0.0f, 1.0f);
    return down < edge - FLAT_MM ? down : edge - FLAT_MM * left * left;
}

/* The lip of a ring rolls about the line between its outer and its inner fibres, where the red begins: the free edge goes
 * back over the teeth, or out when roll is negative; the skin before it follows. Not at the corners. p: a point held by
 * segment k of a fibre, at the share s of it; up: outwards. */
static ris_vec3 roll_lip(const ris_rig *rig, const ris_muscle *muscle, uint32_t k, float s, ris_vec3 up,
                         ris_vec3 p)
{
    const ris_fiber *fiber = &rig->model->fiber[muscle->first_fiber];
    const ris_vec3 *outer = rig->q + fiber[0].first_point + k,
                   *inner = rig->q + fiber[muscle->fiber_count - 1].first_point + k;
    const ris_vec3 a = v3_lerp(outer[0], outer[1], s), b = v3_lerp(inner[0], inner[1], s);
    const ris_vec3 along =
        v3_unit_or(v3_add(v3_sub(outer[1], outer[0]), v3_sub(inner[1], inner[0])), v3(1, 0, 0));
    const ris_vec3 across = v3_sub(b, a),
                   edge = v3_unit_or(v3_mad(across, -v3_dot(across, along), along), v3(0, 1, 0));
    const ris_vec3 side = v3_cross(along, edge),
                   front = v3_dot(side, up) < 0.0f ? v3_scale(side, -1.0f) : side;
    const ris_vec3 r = v3_sub(p, v3_lerp(a, b, 0.5f));
    const float width = f_max(v3_length(across), 1e-3f), rest = v3_dot(r, along), down = v3_dot(r, edge),
                out = v3_dot(r, front);
    const float from_middle = 2.0f * ((float)k + s) / (float)(muscle->point_count - 1) - 1.0f;
    const float round = 1.0f - from_middle * from_middle;
    const float roll = rig->roll[muscle->on_jaw] * round * round;
    const float share = f_smoothstep((down / width + 1.0f) / 2.0f);
    const float suck = f_max(rig->roll[muscle->on_jaw], 0.0f) * rig->suck * round * (2.0f - round);
    const float after = suck * f_smoothstep(down / (width * SUCK_FROM) + 1.0f);
    double c, t;
    ris__cos_sin((double)(share * (roll * ROLL_RAD + suck * SUCK_RAD)), &c, &t);
    const float turned_down = (float)c * down + (float)t * out + ROLL_MM * roll * share + SUCK_MM * after;
    const float flat = flattened(turned_down, EDGE * width);
    const float turned_out = (float)c * out - (float)t * down - SUCK_BACK_MM * after;
    return v3_mad(v3_mad(v3_mad(v3_sub(p, r), rest, along),
                         turned_down + f_min(3.0f * suck, 1.0f) * (flat - turned_down), edge),
                  turned_out, front);
}

static ris_vec3 attached_point(const ris_rig *rig, const ris_muscle *muscle, const ris_attach *attach)
{
    const ris_model *model = rig->model;
    const ris_fiber *fiber = &model->fiber[attach->fiber];
    const uint32_t point = fiber->first_point + (attach->segment - fiber->first_segment);
    ris_segment segment = model->segment[attach->segment];
    if ((model->push.flags & RIS_TISSUE_FLAG_KAEHLER) && muscle->on_jaw) {
        segment.along = ris__rigid_rotate(&rig->jaw, segment.along);
        segment.up = ris__rigid_rotate(&rig->jaw, segment.up);
        segment.wide = ris__rigid_rotate(&rig->jaw, segment.wide);
    }
    const ris_vec3 a = rig->q[point], b = rig->q[point + 1];
    if (muscle->kind == RIS_MUSCLE_SPHINCTER && !(model->push.flags & RIS_TISSUE_FLAG_KAEHLER)) {
        /* the skin of a lip or lid goes along its ring, but does not swing about with every segment */
        const ris_vec3 on_fiber = v3_lerp(a, b, attach->local.x + 0.5f);
        const float height = segment.size.y * rig->bulge[attach->segment];
        const ris_vec3 held = v3_mad(v3_mad(on_fiber, attach->local.y * height, segment.up),
                                     attach->local.z * segment.size.z, segment.wide);
        if (rig->roll[muscle->on_jaw] == 0.0f || !ris__muscle_rolls(muscle)) {
            return held;
        }
        return roll_lip(rig, muscle, attach->segment - fiber->first_segment, attach->local.x + 0.5f,
                        segment.up, held);
    }
    return ris__segment_point(&segment, rig->p[point], rig->p[point + 1], a, b, rig->bulge[attach->segment],
                              attach->local);
}

/* How much a node of a ring counts as dragged by a corner of the mouth, 0..1; full is what the whole ring
 * does. */
static float dragged(const ris_rig *rig, const ris_binding *binding, float *full)
{
    float share = 0.0f;
    for (uint32_t end = 0; end < 2; ++end) {
        const ris_drag *drag = &rig->drag[2 * (size_t)binding->muscle + end];
        const float t = end ? 2.0f * binding->along - 1.0f : 1.0f - 2.0f * binding->along;
        *full = f_max(*full, drag->corner.strength);
        if (drag->corner.strength > 0.0f && t > 0.0f) {
            share = drag->corner.strength * ris__power(t, drag->corner.power);
        }
    }
    return share;
}

/* What one binding would move its node by. */
typedef struct binding_pull {
    ris_vec3 delta; /* mm, without the weight */
    float weight;   /* it pulls with */
    float share;    /* it counts with: less of a ring that is only dragged, in the middle of its lip */
    float strength; /* of its muscle */
} binding_pull;

static bool pull_of(const ris_rig *rig, const ris_binding *binding, binding_pull *out)
{
    const ris_model *model = rig->model;
    const ris_muscle *muscle = &model->muscle[binding->muscle];
    float activity = muscle->max_shortening > 0.0f ? rig->activity[binding->muscle] : 0.0f;
    float share = activity;
    if (muscle->kind == RIS_MUSCLE_SPHINCTER) {
        share = f_max(share, dragged(rig, binding, &activity));
    }
    if (!(activity > 0.0f)) {
        return false;
    }
    ris_vec3 delta = {0};
    for (uint32_t k = 0; k < binding->attach_count; ++k) {
        const ris_attach *attach = &model->attach[binding->first_attach + k];
        delta = v3_mad(delta, attach->share, v3_sub(attached_point(rig, muscle, attach), attach->rest));
    }
    *out = (binding_pull){delta, binding->weight * activity, binding->weight * share, muscle->strength};
    return true;
}

/* Muscles that pull the same way as far share a node, those that pull across one another add up: each counts below the
 * bar by how far it would carry the node, of the farthest, and by the squared cosine with where they carry it together. */
static ris_vec3 pull_together(const ris_rig *rig, uint32_t i)
{
    const ris_model *model = rig->model;
    ris_vec3 sum = {0};
    float farthest = 0.0f, total = 0.0f, strong = 0.0f;
    binding_pull pull;
    for (uint32_t b = model->binding_start[i]; b < model->binding_start[i + 1]; ++b) {
        if (pull_of(rig, &model->binding[b], &pull)) {
            sum = v3_mad(sum, pull.strength * pull.weight, pull.delta);
            farthest = f_max(farthest, v3_length(pull.delta));
            total += pull.share;
            strong += pull.strength * pull.share;
        }
    }
    const float mean = total > 0.0f ? strong / total : 1.0f;
    sum = v3_scale(sum, 1.0f / mean);
    const float length = v3_length(sum);
    if (!(total > 1.0f) || !(length > 0.0f)) {
        return sum;
    }
    const ris_vec3 way = v3_scale(sum, 1.0f / length);
    float bar = 0.0f;
    for (uint32_t b = model->binding_start[i]; b < model->binding_start[i + 1]; ++b) {
        if (pull_of(rig, &model->binding[b], &pull)) {
            const float far = v3_length(pull.delta), along = f_max(v3_dot(pull.delta, way), 0.0f);
            bar += far > 0.0f ? pull.strength * pull.share * (along * along) / (far * farthest) : 0.0f;
        }
    }
    return v3_scale(sum, 1.0f / f_max(bar / mean, 1.0f));
}

static ris_vec3 muscle_move(const ris_rig *rig, uint32_t i)
{
    const ris_model *model = rig->model;
    const ris_vec3 move = pull_together(rig, i), normal = v4_xyz(model->rest_normal[i]);
    if (!model->slide) {
        return move;
    }
    const float round = 0.5f * v3_dot(move, move) / BONE_MM; /* the bone itself curves away so far */
    const float inward = f_max(-v3_dot(move, normal) - round, 0.0f);
    return v3_mad(move, model->slide[i] * inward, normal); /* not into the bone */
}

/* KA-47: fat that a muscle gathers rises. */
static void raise_fat(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->fat_count; ++k) {
        const ris_fat_node *fat = &model->fat[k];
        rig->move[fat->node] = v3_mad(rig->move[fat->node], rig->squeeze[fat->muscle], fat->rise_mm);
    }
}

/* Air in the mouth moves its walls. */
static void puff_cheeks(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->puff_count; ++k) {
        const ris_puff_node *node = &model->puff[k];
        const float pressure = rig->puff[node->side];
        rig->move[node->node] =
            v3_mad(rig->move[node->node], pressure, pressure < 0.0f ? node->sink_mm : node->rise_mm);
    }
}

/* The lining of the mouth goes with the lips before it. */
static void follow_lips(ris_rig *rig)
{
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->lining_count; ++k) {
        const ris_lining_node *node = &model->lining[k];
        ris_vec3 sum = {0};
        for (uint32_t s = 0; s < node->source_count; ++s) {
            sum = v3_add(sum, rig->move[node->source[s]]);
        }
        rig->move[node->node] = v3_scale(sum, node->keep);
    }
}

static void attach_default(ris_rig *rig, uint32_t i)
{
    const ris_model *model = rig->model;
    ris_vec3 normal = v4_xyz(model->rest_normal[i]);
    ris_vec3 target = v3_add(v4_xyz(model->rest_position[i]), rig->move[i]);
    const float jaw = model->jaw_weight[i] + (model->lip_close ? rig->close * model->lip_close[i] : 0.0f);
    if (rig->slides) {
        const float slide = model->jaw_slide_weight ? model->jaw_slide_weight[i] : model->jaw_weight[i];
        const ris_vec3 open = ris__rigid_apply(&rig->jaw_open, target);
        const ris_vec3 slid = v3_sub(ris__rigid_apply(&rig->jaw, target), open);
        target = v3_mad(v3_lerp(target, open, jaw), slide, slid);
        normal = v3_unit_or(v3_lerp(normal, ris__rigid_rotate(&rig->jaw, normal), jaw), normal);
    } else if (!rig->jaw.identity && jaw > 0.0f) {
        target = v3_lerp(target, ris__rigid_apply(&rig->jaw, target), jaw);
        normal = v3_unit_or(v3_lerp(normal, ris__rigid_rotate(&rig->jaw, normal), jaw), normal);
    }
    rig->delta[i] = v4_from(v3_sub(target, rig->target[i]), 0.0f);
    rig->target[i] = target;
    rig->point[i].a = v4_from(target, 0.0f);
    rig->point[i].b = v4_from(normal, 0.0f);
}

static void attach_kaehler(ris_rig *rig, uint32_t i)
{
    const ris_model *model = rig->model;
    const ris_vec3 x = v4_xyz(model->rest_position[i]), rest = ris__anchor_at_rest(model, i);
    ris_vec3 a = rest, mirror = v3_sub(v3_scale(x, 2.0f), rest);
    if (model->binding_start[i + 1] > model->binding_start[i]) {
        const ris_binding *binding = &model->binding[model->binding_start[i]];
        a = v3(0.0f, 0.0f, 0.0f);
        for (uint32_t k = 0; k < binding->attach_count; ++k) {
            const ris_attach *attach = &model->attach[binding->first_attach + k];
            a = v3_mad(a, attach->share, attached_point(rig, &model->muscle[binding->muscle], attach));
        }
        mirror = v3_add(mirror, v3_sub(a, rest));
    } else {
        if (model->jaw_weight[i] > 0.5f) {
            a = ris__rigid_apply(&rig->jaw, a);
            mirror = ris__rigid_apply(&rig->jaw, mirror);
        }
    }
    rig->delta[i] = v4_from(v3_sub(a, rig->target[i]), 0.0f);
    rig->target[i] = a;
    rig->point[i].a = v4_from(a, 0.0f);
    rig->point[i].b = v4_from(mirror, 0.0f);
}

void ris__muscle_attach(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const bool kaehler = (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    for (uint32_t i = 0; !kaehler && i < model->node_count; ++i) {
        if (model->rest_position[i].w > 0.0f) {
            rig->move[i] = muscle_move(rig, i);
        }
    }
    raise_fat(rig);
    puff_cheeks(rig);
    follow_lips(rig);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!(model->rest_position[i].w > 0.0f)) {
            continue;
        }
        if (kaehler) {
            attach_kaehler(rig, i);
        } else {
            attach_default(rig, i);
        }
    }
}
