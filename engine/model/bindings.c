/* KA-42 muscle to skin. Default tissue (docs/physics.md): every moving node within radius_mm of the
 * muscle, blended over the near segments, with an insertion profile along the fibre. kaehler tissue: the
 * one nearest attachment, distances divided by n_s . n_d. A node is never bound through the skin (n_s .
 * n_d <= 0), nor to a muscle of the other lip. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define MAX_BLEND 8      /* segments blended into one binding */
#define BLEND_RATIO 1.6f /* segments up to BLEND_RATIO x nearest + BLEND_MM take part */
#define BLEND_MM 2.0f
#define FACING_FULL 0.2f /* n_s . n_d from which on the facing rule does not weaken a binding */
#define ABOVE_FULL 0.6f  /* from -0.5 to 0.5 of this n_s . up a binding goes from none to full */

#define DEEP_MM 6.0f          /* of tissue over a muscle between bones: from here on its bulge shows less, */
#define SUNK_MM 22.0f         /* and from here on not at all */
#define SMALLEST_FACING 1e-3f /* of a vertex that a list binds though it faces away */
#define TWIN_MM 1e-3f

#define HANGS_MM 5.0f   /* the red of a lip hangs as a whole on the skin that levators and depressors hold */
#define BORDER_MM 8.0f  /* from the skin beside the lip to where it does */
#define CORNER_MM 18.0f /* from the corner of the mouth to where they move the lip in full */

enum { LIP_UPPER = 1, LIP_LOWER = 2 };

/* Where a node meets a segment's flat sheet. */
typedef struct touch {
    uint32_t fiber, segment;
    ris_vec3 local; /* y = +-0.5: the muscle surface on the node's side */
    ris_vec3 at;    /* the point of the sheet; of the surface in the kaehler tissue */
    float distance; /* to it, mm */
    float depth;    /* of the sheet below the skin there, mm */
    float facing;   /* n_s . n_d */
    float above;    /* n_s . up of the segment */
    float along;    /* arc-length parameter along the fibre */
    float share;
} touch;

/* Box around the flat sheets of a muscle, as far as it reaches. */
typedef struct reach_box {
    ris_vec3 low, high;
} reach_box;

typedef struct binder {
    ris_bake *bake;
    const reach_box *box; /* (muscle_count) */
    const float *arc;     /* arc-length parameter of each fibre point */
    uint8_t *lip;         /* per node: LIP_UPPER, LIP_LOWER bits */
    uint8_t *muscle_lip;
    float *corner_mm;     /* per node: to the nearest corner of the mouth */
    float *border_mm;     /* per node of a lip: to the skin beside it */
    bool *lining;         /* per node: the mouth's lining, which follows the lips */
    uint8_t *muscle_node; /* explicit attach lists (muscle_count x node_count), NULL if none */
    size_t binding_room, attach_room;
} binder;

static touch meet_segment(const binder *b, uint32_t m, uint32_t fiber, uint32_t row, uint32_t node)
{
    const ris_model *model = b->bake->model;
    const uint32_t columns = b->bake->grid[m].columns;
    const float *depth = b->bake->grid[m].depth + row * columns + (fiber - model->muscle[m].first_fiber);
    const uint32_t point = model->fiber[fiber].first_point + row;
    touch t = {.fiber = fiber, .segment = model->fiber[fiber].first_segment + row};
    const ris_segment *segment = &model->segment[t.segment];
    const ris_vec3 x = v4_xyz(model->rest_position[node]), rel = v3_sub(x, segment->origin);
    t.local.x = f_clamp(v3_dot(rel, segment->along) / segment->size.x, -0.5f, 0.5f);
    t.local.z = f_clamp(v3_dot(rel, segment->wide) / segment->size.z, -0.5f, 0.5f);
    const float up = v3_dot(rel, segment->up) / segment->size.y;
    t.local.y = f_clamp(up, -0.5f, 0.5f);
    t.at = v3_mad(segment->origin, t.local.x * segment->size.x, segment->along);
    t.at = v3_mad(t.at, t.local.z * segment->size.z, segment->wide);
    if (b->bake->head->tissue.model == RIS_TISSUE_KAEHLER) { /* KA-42: the surface, not the sheet inside it */
        const bool inside = fabsf(up) < 0.5f && fabsf(t.local.x) < 0.5f && fabsf(t.local.z) < 0.5f;
        t.local.y = !inside ? t.local.y : up < 0.0f ? -0.5f : 0.5f;
        t.at = v3_mad(t.at, t.local.y * segment->size.y, segment->up);
    }
    const ris_vec3 d = v3_sub(x, t.at);
    t.distance = v3_length(d);
    t.facing = v3_dot(v3_unit_or(d, segment->up), v4_xyz(model->rest_normal[node]));
    const float near_depth = 0.5f * (depth[0] + depth[1]),
                far_depth = 0.5f * (depth[columns] + depth[columns + 1]);
    t.depth = near_depth + (t.local.x + 0.5f) * (far_depth - near_depth);
    t.above = v3_dot(segment->up, v4_xyz(model->rest_normal[node]));
    t.along = b->arc[point] + (t.local.x + 0.5f) * (b->arc[point + 1] - b->arc[point]);
    return t;
}

static bool within_reach(const binder *b, uint32_t m, uint32_t node)
{
    const reach_box *box = &b->box[m];
    const ris_vec4 x = b->bake->model->rest_position[node];
    return x.x >= box->low.x && x.y >= box->low.y && x.z >= box->low.z && x.x <= box->high.x &&
           x.y <= box->high.y && x.z <= box->high.z;
}

static bool may_bind(const binder *b, uint32_t m, uint32_t node)
{
    if (!within_reach(b, m, node) && b->bake->model->muscle[m].def->attach_auto) {
        return false; /* nearly always */
    }
    const uint8_t lip = b->muscle_lip[m];
    const ris_muscle *muscle = &b->bake->model->muscle[m];
    const bool thesis_ring =
        b->bake->head->tissue.model == RIS_TISSUE_KAEHLER && muscle->kind == RIS_MUSCLE_SPHINCTER;
    if (b->lining[node] || (muscle->def->acts_on == RIS_ACTS_ON_LID && !thesis_ring)) {
        return false;
    }
    if ((lip == LIP_UPPER && b->lip[node] == LIP_LOWER) || (lip == LIP_LOWER && b->lip[node] == LIP_UPPER)) {
        return false;
    }
    const ris_muscle_def *def = b->bake->model->muscle[m].def;
    if (def->end_bone != RIS_BONE_AUTO &&
        (b->bake->head->tissue.model == RIS_TISSUE_KAEHLER || !(def->max_shortening > 0.0f))) {
        return false; /* the thesis's muscles all end in the skin */
    }
    if (def->kind == RIS_MUSCLE_LINEAR && def->lip_drag_power > 0.0f && b->lip[node]) {
        /* the pulled corner drags both lips along the oris; a direct pull on one of them would part them */
        return false;
    }
    return def->attach_auto || b->muscle_node[(size_t)m * b->bake->model->node_count + node];
}

static ris_result grow(void *array, size_t *room, size_t count, size_t size, ris_error *err)
{
    if (count <= *room) {
        return RIS_OK;
    }
    size_t wanted = *room ? *room * 2 : 1024;
    wanted = wanted < count ? count : wanted;
    void *old;
    memcpy(&old, array, sizeof old);
    void *memory = realloc(old, wanted * size);
    if (!memory) {
        return ris_fail(err, RIS_ERROR_MEMORY, "not enough memory for muscle attachments (%zu x %zu bytes)",
                        wanted, size);
    }
    memcpy(array, &memory, sizeof memory);
    *room = wanted;
    return RIS_OK;
}

static ris_result add_binding(binder *b, uint32_t m, uint32_t node, const touch *touches, uint32_t count,
                              float weight, float along, ris_error *err)
{
    ris_model *model = b->bake->model;
    const uint32_t binding_count = model->binding_start[node + 1];
    ris_result result =
        grow(&model->binding, &b->binding_room, (size_t)binding_count + 1, sizeof *model->binding, err);
    if (result == RIS_OK) {
        result = grow(&model->attach, &b->attach_room, (size_t)model->attach_count + count,
                      sizeof *model->attach, err);
    }
    if (result != RIS_OK) {
        return result;
    }
    ris_binding *binding = &model->binding[binding_count];
    *binding = (ris_binding){.muscle = m,
                             .first_attach = model->attach_count,
                             .attach_count = count,
                             .weight = weight,
                             .along = along};
    for (uint32_t k = 0; k < count; ++k) {
        const ris_segment *segment = &model->segment[touches[k].segment];
        const ris_vec3 *p = model->fiber_point + model->fiber[touches[k].fiber].first_point +
                            (touches[k].segment - model->fiber[touches[k].fiber].first_segment);
        ris_attach *attach = &model->attach[model->attach_count++];
        attach->fiber = touches[k].fiber;
        attach->segment = touches[k].segment;
        attach->local = touches[k].local;
        attach->rest = ris__segment_point(segment, p[0], p[1], p[0], p[1], 1.0f, touches[k].local);
        attach->share = touches[k].share;
    }
    ++model->binding_start[node + 1];
    if (model->muscle[m].def->end_bone == RIS_BONE_AUTO) { /* the others do not hold the skin */
        b->bake->muscle_weight[node] = f_max(b->bake->muscle_weight[node], weight);
    }
    return RIS_OK;
}

/* Nearest segments first, at most MAX_BLEND. */
static void keep_nearest(touch *list, uint32_t *count, touch t)
{
    uint32_t slot = *count;
    while (slot > 0 && list[slot - 1].distance > t.distance) {
        --slot;
    }
    if (slot == MAX_BLEND) {
        return;
    }
    uint32_t last = *count < MAX_BLEND ? (*count)++ : MAX_BLEND - 1;
    memmove(list + slot + 1, list + slot, (last - slot) * sizeof *list);
    list[slot] = t;
}

/* Default tissue: weight of node on muscle, blended over the near segments. */
static ris_result bind_blended(binder *b, uint32_t m, uint32_t node, ris_error *err)
{
    const ris_model *model = b->bake->model;
    const ris_muscle *muscle = &model->muscle[m];
    touch list[MAX_BLEND] = {0};
    uint32_t count = 0;
    for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
        for (uint32_t r = 0; r + 1 < muscle->point_count; ++r) {
            keep_nearest(list, &count, meet_segment(b, m, muscle->first_fiber + f, r, node));
        }
    }
    /* a stored list (KA-44) decides alone who is bound, so that no borderline vertex comes or goes */
    const bool listed = !muscle->def->attach_auto;
    const bool lifts_lip = muscle->kind == RIS_MUSCLE_LINEAR && b->muscle_lip[m] != 0;
    float beyond = f_max(list[0].distance - list[0].depth, 0.0f);
    if (lifts_lip && b->lip[node]) {
        beyond = f_max(beyond - HANGS_MM * f_smoothstep(b->border_mm[node] / BORDER_MM), 0.0f);
    }
    if (!(beyond < muscle->radius_mm) && !listed) {
        return RIS_OK;
    }
    const float limit = BLEND_RATIO * list[0].distance + BLEND_MM;
    float sum = 0.0f, along = 0.0f, facing = 0.0f, above = 0.0f;
    uint32_t kept = 0;
    for (uint32_t k = 0; k < count; ++k) {
        float s = f_max(1.0f - list[k].distance / limit, 0.0f) / f_max(list[k].distance, 0.01f);
        list[k].share = s * s;
        sum += list[k].share;
        kept += list[k].share > 0.0f; /* nearest first: those kept are the first */
    }
    for (uint32_t k = 0; k < kept; ++k) {
        list[k].share /= sum;
        along += list[k].share * list[k].along;
        facing += list[k].share * list[k].facing;
        above += list[k].share * list[k].above;
    }
    if (lifts_lip && b->lip[node]) {
        facing = FACING_FULL;
        above = ABOVE_FULL;
    }
    const float ratio = f_min(beyond / muscle->radius_mm, 1.0f), bell = 1.0f - ratio * ratio;
    float weight = bell * bell * f_clamp(facing / FACING_FULL, 0.0f, 1.0f);
    if (b->lip[node] && muscle->kind == RIS_MUSCLE_SPHINCTER) {
        weight = 1.0f; /* the red of a lip is rolled round the muscle within it */
    }
    if (lifts_lip) {
        weight *= f_smoothstep(b->corner_mm[node] / CORNER_MM);
    }
    if (muscle->kind == RIS_MUSCLE_LINEAR) {
        const float start = muscle->insertion_start, held = muscle->def->held_at;
        const float from_held = along >= held ? (along - held) / (1.0f - held) : (held - along) / held;
        /* a muscle of the face does not move the lining of the mouth behind it */
        weight *= f_clamp(0.5f + above / ABOVE_FULL, 0.0f, 1.0f);
        if (muscle->def->end_bone == RIS_BONE_AUTO) {
            weight *= f_smoothstep(muscle->gain * (from_held - start) / f_max(1.0f - start, 1e-3f));
        } else {
            const float over = list[0].depth - 0.5f * model->segment[list[0].segment].size.y;
            weight *=
                f_min(muscle->gain, 1.0f) * (1.0f - f_smoothstep((over - DEEP_MM) / (SUNK_MM - DEEP_MM)));
        }
    }
    if (!(weight > 1e-4f) && !listed) {
        return RIS_OK;
    }
    return add_binding(b, m, node, list, kept, weight, along, err);
}

static bool mirrors(ris_vec3 a, ris_vec3 b)
{
    return v3_distance(a, v3(-b.x, b.y, b.z)) < TWIN_MM;
}

/* Smallest distance / (n_s . n_d) of a node to any muscle, among touches that mirror `twin` if that is given; INFINITY if there
 * is none. */
static float nearest_touch(const binder *b, uint32_t node, const touch *twin, touch *out,
                           uint32_t *out_muscle)
{
    const ris_model *model = b->bake->model;
    const float radius = b->bake->head->tissue.muscle_radius_mm;
    float best = INFINITY;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const bool listed = !muscle->def->attach_auto, allowed = may_bind(b, m, node);
        const uint32_t segments = muscle->point_count - 1;
        for (uint32_t k = 0; allowed && k < muscle->fiber_count * segments; ++k) {
            const touch t = meet_segment(b, m, muscle->first_fiber + k / segments, k % segments, node);
            const float facing = listed ? f_max(t.facing, SMALLEST_FACING) : t.facing;
            if (facing > 0.0f && (listed || t.distance <= radius) && t.distance / facing < best &&
                (!twin || mirrors(t.at, twin->at))) {
                best = t.distance / facing;
                *out = t;
                *out_muscle = m;
            }
        }
    }
    return best;
}

/* kaehler tissue: the attachment of smallest distance / (n_s . n_d) over all muscles. A node of the midline that hangs on one side
 * hangs on the other alike, or the face would not be its own mirror image. */
static ris_result bind_nearest(binder *b, uint32_t node, ris_error *err)
{
    uint32_t muscle = 0, other = 0;
    touch nearest[2] = {{0}};
    const float best = nearest_touch(b, node, NULL, &nearest[0], &muscle);
    if (!(best < INFINITY)) {
        return RIS_OK;
    }
    bool both = fabsf(b->bake->model->rest_position[node].x) < TWIN_MM && fabsf(nearest[0].at.x) > TWIN_MM;
    both = both && nearest_touch(b, node, &nearest[0], &nearest[1], &other) - best < TWIN_MM;
    nearest[0].share = both ? 0.5f : 1.0f;
    nearest[1].share = 0.5f;
    return add_binding(b, muscle, node, nearest, both ? 2 : 1, 1.0f, nearest[0].along, err);
}

ris_vec3 ris__anchor_at_rest(const ris_model *model, uint32_t node)
{
    ris_vec3 a = {0};
    if (model->binding_start[node + 1] == model->binding_start[node]) {
        return model->bone_anchor[node];
    }
    const ris_binding *binding = &model->binding[model->binding_start[node]];
    for (uint32_t k = 0; k < binding->attach_count; ++k) {
        const ris_attach *attach = &model->attach[binding->first_attach + k];
        a = v3_mad(a, attach->share, attach->rest);
    }
    return a;
}

static uint32_t nearest_node(const ris_model *model, ris_vec3 p)
{
    float best = INFINITY;
    uint32_t nearest = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        ris_vec3 d = v3_sub(v4_xyz(model->rest_position[i]), p);
        if (v3_dot(d, d) < best) {
            best = v3_dot(d, d);
            nearest = i;
        }
    }
    return nearest;
}

/* Distance of every node to the corners of the mouth, the nodes of both lips, and of lips to the skin around. */
static void measure_lips(binder *b)
{
    const ris_model *model = b->bake->model;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        b->corner_mm[i] = CORNER_MM;
    }
    for (uint32_t c = 0; c < model->node_count; ++c) {
        for (uint32_t i = 0; b->lip[c] == (LIP_UPPER | LIP_LOWER) && i < model->node_count; ++i) {
            const float d = v3_distance(v4_xyz(model->rest_position[i]), v4_xyz(model->rest_position[c]));
            b->corner_mm[i] = f_min(b->corner_mm[i], d);
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        b->border_mm[i] = b->lip[i] ? BORDER_MM : 0.0f;
        for (uint32_t k = 0; b->lip[i] && k < model->node_count; ++k) {
            if (!b->lip[k] && !b->lining[k] && model->rest_position[k].w > 0.0f) {
                b->border_mm[i] = f_min(b->border_mm[i], v3_distance(v4_xyz(model->rest_position[i]),
                                                                     v4_xyz(model->rest_position[k])));
            }
        }
    }
}

/* Lips and lining of the nodes by region; lips of a muscle by the nodes nearest to its grid. */
static ris_result sort_lips(binder *b, ris_error *err)
{
    const ris_model *model = b->bake->model;
    const ris_head *head = b->bake->head;
    ris_result result = ris__model_alloc(&b->lip, model->node_count, sizeof *b->lip, "lip flags", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&b->border_mm, model->node_count, sizeof *b->border_mm, "lip flags", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&b->corner_mm, model->node_count, sizeof *b->corner_mm, "lip flags", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&b->lining, model->node_count, sizeof *b->lining, "lip flags", err);
    }
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&b->muscle_lip, model->muscle_count, sizeof *b->muscle_lip, "lip flags", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    if (model->lining_count > 0) {
        ris__region_flags(head, "mouth_cavity", b->lining);
    }
    const ris_region *upper = ris_head_region(head, "lip_upper"), *lower = ris_head_region(head, "lip_lower");
    for (uint32_t k = 0; upper && k < upper->count; ++k) {
        b->lip[upper->vertex[k]] |= LIP_UPPER;
    }
    for (uint32_t k = 0; lower && k < lower->count; ++k) {
        b->lip[lower->vertex[k]] |= LIP_LOWER;
    }
    measure_lips(b);
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle_def *def = model->muscle[m].def;
        uint32_t votes[2] = {0};
        for (uint32_t k = 0; k < def->rows * def->columns; ++k) {
            uint8_t lip = b->lip[nearest_node(model, def->grid[k])];
            votes[0] += lip == LIP_UPPER;
            votes[1] += lip == LIP_LOWER;
        }
        /* a muscle of both corners of the mouth belongs to both lips */
        b->muscle_lip[m] = votes[0] > 2 * votes[1] ? LIP_UPPER : votes[1] > 2 * votes[0] ? LIP_LOWER : 0;
        if (def->kind == RIS_MUSCLE_LINEAR && def->lip_drag_power > 0.0f) {
            b->muscle_lip[m] = 0;
        }
    }
    return RIS_OK;
}

static ris_result mark_lists(binder *b, ris_error *err)
{
    const ris_model *model = b->bake->model;
    bool any = false;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        any = any || !model->muscle[m].def->attach_auto;
    }
    if (!any) {
        return RIS_OK;
    }
    ris_result result = ris__model_alloc(&b->muscle_node, (size_t)model->muscle_count * model->node_count, 1,
                                         "attach lists", err);
    for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
        const ris_muscle_def *def = model->muscle[m].def;
        for (uint32_t k = 0; !def->attach_auto && k < def->attach_count; ++k) {
            if (def->attach[k] >= model->node_count) {
                return ris_fail(err, RIS_ERROR_DATA,
                                "muscle %s is attached to vertex %u, but the skin has %u", def->name,
                                def->attach[k], model->node_count);
            }
            b->muscle_node[(size_t)m * model->node_count + def->attach[k]] = 1;
        }
    }
    return result;
}

static float *measure_arcs(const ris_model *model, ris_error *err)
{
    float *arc = NULL;
    if (ris__model_alloc(&arc, model->fiber_point_count, sizeof *arc, "fibre lengths", err) != RIS_OK) {
        return NULL;
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
            float *t = arc + model->fiber[muscle->first_fiber + f].first_point;
            const ris_vec3 *p = model->fiber_point + model->fiber[muscle->first_fiber + f].first_point;
            for (uint32_t i = 1; i < muscle->point_count; ++i) {
                t[i] = t[i - 1] + v3_distance(p[i], p[i - 1]);
            }
            for (uint32_t i = 1; i < muscle->point_count; ++i) {
                t[i] /= t[muscle->point_count - 1];
            }
        }
    }
    return arc;
}

static void measure_reach(const ris_bake *bake, reach_box *box)
{
    const ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const ris_bake_grid *grid = &bake->grid[m];
        float reach = 0.0f;
        for (uint32_t k = 0; k < grid->rows * grid->columns; ++k) {
            reach = f_max(reach, grid->depth[k]);
        }
        reach = f_max(reach + muscle->radius_mm, tissue->muscle_radius_mm) + 0.1f;
        box[m] = (reach_box){v3(INFINITY, INFINITY, INFINITY), v3(-INFINITY, -INFINITY, -INFINITY)};
        for (uint32_t k = 0; k < muscle->fiber_count * (muscle->point_count - 1); ++k) {
            const ris_segment *s = &model->segment[model->fiber[muscle->first_fiber].first_segment + k];
            for (uint32_t c = 0; c < 4; ++c) {
                const ris_vec3 edge =
                    v3_mad(s->origin, c & 1 ? 0.5f * s->size.x : -0.5f * s->size.x, s->along);
                const ris_vec3 p = v3_mad(edge, c & 2 ? 0.5f * s->size.z : -0.5f * s->size.z, s->wide);
                box[m].low = v3(f_min(box[m].low.x, p.x - reach), f_min(box[m].low.y, p.y - reach),
                                f_min(box[m].low.z, p.z - reach));
                box[m].high = v3(f_max(box[m].high.x, p.x + reach), f_max(box[m].high.y, p.y + reach),
                                 f_max(box[m].high.z, p.z + reach));
            }
        }
    }
}

ris_result ris__bake_bindings(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const bool literal = bake->head->tissue.model == RIS_TISSUE_KAEHLER;
    binder b = {.bake = bake};
    reach_box *box = NULL;
    ris_result result = ris__model_alloc(&model->binding_start, (size_t)model->node_count + 1,
                                         sizeof *model->binding_start, "bindings", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->muscle_weight, model->node_count, sizeof *bake->muscle_weight,
                                  "bindings", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&box, model->muscle_count, sizeof *box, "bindings", err);
    }
    if (result == RIS_OK) {
        measure_reach(bake, box);
        b.box = box;
    }
    float *arc = result == RIS_OK ? measure_arcs(model, err) : NULL;
    result = result == RIS_OK && !arc ? RIS_ERROR_MEMORY : result;
    b.arc = arc;
    if (result == RIS_OK) {
        result = sort_lips(&b, err);
    }
    if (result == RIS_OK) {
        result = mark_lists(&b, err);
    }
    for (uint32_t i = 0; result == RIS_OK && i < model->node_count; ++i) {
        model->binding_start[i + 1] = model->binding_start[i];
        if (!bake->moving[i]) {
            continue;
        }
        if (literal) {
            result = bind_nearest(&b, i, err);
            continue;
        }
        for (uint32_t m = 0; result == RIS_OK && m < model->muscle_count; ++m) {
            if (may_bind(&b, m, i)) {
                result = bind_blended(&b, m, i, err);
            }
        }
    }
    free(arc);
    free(box);
    free(b.lip);
    free(b.muscle_lip);
    free(b.lining);
    free(b.corner_mm);
    free(b.border_mm);
    free(b.muscle_node);
    return result;
}
