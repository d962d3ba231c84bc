/* Eyelids (they turn about the eyeball; KA-48 names the movement, the thesis does not say how the
 * lid mesh moves). Nodes of lid_upper and lid_lower are sorted into rings, counted from the lining of the
 * socket (eye_socket): rings up to the margin are the ledge of the lid, which moves with it as one; the rings
 * behind it form columns up to the border of the region. Each column of an upper lid learns by what angle it
 * meets the lower margin. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define LEDGE_MAX 3         /* the margin is one of the first rings */
#define LID_ANCHOR 20000.0f /* g/s^2 at the margin: the tarsal plate is stiff, not skin on springs */
#define LID_SKIN 0.1f       /* stiffness of the thinnest skin of the face, relative to the rest */
#define STRETCHES 0.95f     /* outer part of a column that stretches; the rest is as rigid as the ledge */
#define LOWER_FOLD 0.4f     /* a raised lower lid folds here, counted from the border of its region ... */
#define LOWER_ROLL 0.42f    /* ... and is one roll from so much farther on */
#define PRESS_MM 0.15f      /* closed margins press into each other: the drawn surface rounds their edges */
#define LEDGE_KEEPS 0.6f    /* share of the ledge's turn beyond its inner corner */
#define LEDGE_BACK 0.75f /* share of the margin's closing turn that the ledge's inner edge takes: bevelled */
#define LINING_FOLLOWS 0.15f /* of a closing lid: farther and it would show its folds */
#define LINING_OPENS 0.3f    /* of an opening one: it lies inside the eye */
#define LINING_RINGS 2
#define NO_RING INT32_MAX

enum { KIND_NONE, KIND_UPPER = 1, KIND_LOWER = 2, KIND_CORNER = 3 };

/* One eye while it is baked; arrays are per skin vertex. */
typedef struct lid_bake {
    ris_model *model;
    const ris_head *head;
    uint8_t eye;
    uint8_t *kind;
    bool *socket;
    int32_t *ring; /* 0 at the lining, -1, -2 in it */
    float *along, *total, *count;
    ris_lid_node *node;
    uint32_t *lower;      /* scratch: one ring of a lid, sorted by x */
    int32_t margin, step; /* ring of the margin; direction in which columns are handed on, 1 or -1 */
} lid_bake;

static ris_vec3 from_eye(const lid_bake *b, uint32_t i)
{
    return v3_sub(v4_xyz(b->model->rest_position[i]), b->model->lid_eye[b->eye].centre);
}

static float elevation(const lid_bake *b, uint32_t i)
{
    const ris_vec3 p = from_eye(b, i);
    return atan2f(p.y, p.z);
}

float ris__eye_surface(const ris_lid_eye *eye, ris_vec3 direction, ris_vec3 gaze)
{
    const float c = v3_dot(direction, gaze), d = eye->cornea_at_mm;
    const float inside = eye->cornea_mm * eye->cornea_mm - d * d * (1.0f - c * c);
    if (!(d > 0.0f) || !(c > 0.0f) || !(inside > 0.0f)) {
        return eye->ball_mm;
    }
    return f_max(eye->ball_mm, d * c + sqrtf(inside));
}

/* Ball: largest radius of the eye's part. Cornea: the sphere through its apex that fits the rest of the
 * bulge. */
static bool measure_eye(lid_bake *b, ris_bone bone)
{
    ris_lid_eye *eye = &b->model->lid_eye[b->eye];
    const ris_part_def *ball = NULL, *cornea = NULL;
    for (uint32_t k = 0; k < b->head->part_count; ++k) {
        const ris_part_def *part = &b->head->part[k];
        ball = part->bone == bone && part->material == RIS_MATERIAL_EYE ? part : ball;
        cornea = part->bone == bone && part->material == RIS_MATERIAL_CORNEA ? part : cornea;
    }
    if (!ball) {
        return false;
    }
    eye->centre = ball->pivot;
    for (uint32_t k = 0; k < ball->mesh.vertex_count; ++k) {
        eye->ball_mm = f_max(eye->ball_mm, v3_distance(ball->mesh.position[k], eye->centre));
    }
    float apex = 0.0f, sum = 0.0f, count = 0.0f;
    for (uint32_t k = 0; cornea && k < cornea->mesh.vertex_count; ++k) {
        apex = f_max(apex, v3_sub(cornea->mesh.position[k], eye->centre).z);
    }
    for (uint32_t k = 0; cornea && k < cornea->mesh.vertex_count; ++k) {
        const ris_vec3 p = v3_sub(cornea->mesh.position[k], eye->centre);
        if (v3_length(p) > eye->ball_mm + 0.3f && apex - p.z > 0.2f) {
            sum += (apex * apex - v3_dot(p, p)) / (2.0f * (apex - p.z));
            count += 1.0f;
        }
    }
    if (count > 0.0f && sum > 0.0f && apex > sum / count) {
        eye->cornea_at_mm = sum / count;
        eye->cornea_mm = apex - eye->cornea_at_mm;
    }
    return true;
}

static bool mark_regions(lid_bake *b)
{
    static const char *const names[2][2] = {{"lid_upper.L", "lid_lower.L"}, {"lid_upper.R", "lid_lower.R"}};
    bool all = true;
    for (uint32_t lid = 0; lid < 2; ++lid) {
        const ris_region *region = ris_head_region(b->head, names[b->eye][lid]);
        all = all && region;
        for (uint32_t k = 0; region && k < region->count; ++k) {
            b->kind[region->vertex[k]] |= lid ? KIND_LOWER : KIND_UPPER;
        }
    }
    ris__region_flags(b->head, "eye_socket", b->socket);
    return all;
}

/* Calls visit for both directions of every edge of the skin's faces (quads: no diagonals). */
static void each_edge(const lid_bake *b, void (*visit)(const lid_bake *, uint32_t, uint32_t, int32_t),
                      int32_t argument)
{
    const ris_mesh *skin = &b->head->skin;
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        const uint32_t first = skin->face_start[f], end = skin->face_start[f + 1];
        for (uint32_t c = first; c < end; ++c) {
            const uint32_t v = skin->face_vertex[c], w = skin->face_vertex[c + 1 < end ? c + 1 : first];
            visit(b, v, w, argument);
            visit(b, w, v, argument);
        }
    }
}

static void start_rings(const lid_bake *b, uint32_t from, uint32_t to, int32_t argument)
{
    (void)argument;
    if (b->kind[from] && b->socket[to]) {
        b->ring[from] = 0;
        b->ring[to] = -1;
    }
}

static bool moves(const lid_bake *b, uint32_t i)
{
    return b->model->rest_position[i].w > 0.0f;
}

/* From ring to the next one away from the margin's edge; a node of the lining takes the lid it hangs on. */
static void grow_ring(const lid_bake *b, uint32_t from, uint32_t to, int32_t ring)
{
    if (b->ring[from] != ring || !moves(b, to)) {
        return;
    }
    if (ring >= 0 && b->kind[to] && !b->socket[to] && b->ring[to] == NO_RING) {
        b->ring[to] = ring + 1;
    } else if (ring < 0 && b->socket[to] && b->ring[to] == NO_RING) {
        b->ring[to] = ring - 1;
    }
}

static void lining_kind(const lid_bake *b, uint32_t from, uint32_t to, int32_t ring)
{
    if (b->ring[from] == ring && b->ring[to] == ring - 1 && b->socket[to]) {
        b->kind[to] |= b->kind[from];
    }
}

static int32_t make_rings(const lid_bake *b)
{
    const uint32_t n = b->model->node_count;
    for (uint32_t i = 0; i < n; ++i) {
        b->ring[i] = NO_RING;
    }
    each_edge(b, start_rings, 0);
    for (int32_t ring = -1; ring > -LINING_RINGS; --ring) {
        each_edge(b, grow_ring, ring);
    }
    for (int32_t ring = 0; ring > -LINING_RINGS; --ring) {
        each_edge(b, lining_kind, ring);
    }
    int32_t last = 0;
    for (bool grown = true; grown; ++last) {
        each_edge(b, grow_ring, last);
        grown = false;
        for (uint32_t i = 0; i < n && !grown; ++i) {
            grown = b->ring[i] == last + 1;
        }
    }
    return last - 1;
}

/* Nodes of one ring of a lid with its corners, ascending x (insertion: a ring is short); of equal x the higher one is
 * nearer to the nose, so that the eyes mirror each other. */
static uint32_t sorted_ring(const lid_bake *b, int32_t ring, uint8_t kind)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        if (b->ring[i] != ring || !(b->kind[i] & kind)) {
            continue;
        }
        const ris_vec4 p = b->model->rest_position[i];
        uint32_t k = count++;
        for (; k > 0; --k) {
            const ris_vec4 q = b->model->rest_position[b->lower[k - 1]];
            if (!(q.x > p.x || (q.x == p.x && (b->eye ? q.y > p.y : q.y < p.y)))) {
                break;
            }
            b->lower[k] = b->lower[k - 1];
        }
        b->lower[k] = i;
    }
    return count;
}

/* Segment of the sorted ring over x: first node and share of the next. */
static uint32_t find_segment(const lid_bake *b, uint32_t count, float x, float *share)
{
    uint32_t k = 0;
    while (k + 2 < count && b->model->rest_position[b->lower[k + 1]].x < x) {
        ++k;
    }
    const float from = b->model->rest_position[b->lower[k]].x,
                to = b->model->rest_position[b->lower[k + 1]].x;
    *share = to > from ? f_clamp((x - from) / (to - from), 0.0f, 1.0f) : x > from ? 1.0f : 0.0f;
    return k;
}

static float mean_elevation(const lid_bake *b, int32_t ring, uint8_t kind)
{
    float sum = 0.0f, count = 0.0f;
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        if (b->ring[i] == ring && b->kind[i] == kind) {
            sum += elevation(b, i);
            count += 1.0f;
        }
    }
    return count > 0.0f ? sum / count : 0.0f;
}

/* The margin is the ring with the narrowest opening: inside it the ledge faces the other lid, outside it the
 * skin leaves. */
static void find_margin(lid_bake *b, int32_t last)
{
    float narrowest = 1e9f;
    for (int32_t ring = 0; ring <= last && ring <= LEDGE_MAX; ++ring) {
        const float opening = mean_elevation(b, ring, KIND_UPPER) - mean_elevation(b, ring, KIND_LOWER);
        if (opening < narrowest) {
            narrowest = opening;
            b->margin = ring;
        }
    }
}

/* Angle and distance from the axis that carry every node of the margin to the same x on the other lid. */
static void measure_margin(lid_bake *b, uint8_t kind)
{
    const uint32_t count = sorted_ring(b, b->margin, (uint8_t)(KIND_CORNER - kind));
    for (uint32_t i = 0; count > 1 && i < b->model->node_count; ++i) {
        if (b->ring[i] != b->margin || b->kind[i] != kind) {
            continue;
        }
        ris_lid_node *node = &b->node[i];
        float s;
        const uint32_t k = find_segment(b, count, b->model->rest_position[i].x, &s);
        const uint32_t j0 = b->lower[k], j1 = b->lower[k + 1];
        const ris_vec3 meet = v3_lerp(from_eye(b, j0), from_eye(b, j1), s), p = from_eye(b, i);
        const float turn = elevation(b, i) - atan2f(meet.y, meet.z);
        node->close_rad = f_max(kind == KIND_UPPER ? turn : -turn, 0.0f);
        node->close_mm = sqrtf(meet.y * meet.y + meet.z * meet.z) - sqrtf(p.y * p.y + p.z * p.z);
        node->facing[0] = j0;
        node->facing[1] = j1;
        node->facing_share = s;
    }
}

/* Adds what a column's node hands on to the next ring. */
static void hand_on(const lid_bake *b, uint32_t from, uint32_t to, int32_t ring)
{
    if (b->ring[from] != ring || b->ring[to] != ring + b->step) {
        return;
    }
    const ris_lid_node *source = &b->node[from];
    ris_lid_node *node = &b->node[to];
    node->close_rad += source->close_rad;
    node->close_mm += source->close_mm;
    b->along[to] += b->along[from] + v3_distance(from_eye(b, from), from_eye(b, to));
    if (b->count[to] == 0.0f || source->close_rad > b->node[node->facing[0]].close_rad) {
        memcpy(node->facing, source->facing, sizeof node->facing);
        node->facing_share = source->facing_share;
    }
    b->count[to] += 1.0f;
}

static void hand_back(const lid_bake *b, uint32_t from, uint32_t to, int32_t ring)
{
    if (b->ring[from] == ring && b->ring[to] == ring - 1) {
        b->total[to] = f_max(b->total[to], b->total[from]);
    }
}

/* Means over the edges that came in. */
static void settle_ring(const lid_bake *b, int32_t ring)
{
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        if (b->ring[i] == ring && b->count[i] > 0.0f) {
            b->node[i].close_rad /= b->count[i];
            b->node[i].close_mm /= b->count[i];
            b->along[i] /= b->count[i];
        }
    }
}

static void make_columns(lid_bake *b, int32_t last)
{
    b->step = -1;
    for (int32_t ring = b->margin; ring > -LINING_RINGS; --ring) {
        each_edge(b, hand_on, ring);
        settle_ring(b, ring - 1);
    }
    b->step = 1;
    for (int32_t ring = b->margin; ring < last; ++ring) {
        each_edge(b, hand_on, ring);
        settle_ring(b, ring + 1);
    }
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        b->total[i] = b->along[i];
    }
    for (int32_t ring = last; ring > b->margin; --ring) {
        each_edge(b, hand_back, ring);
    }
}

/* Columns fan out towards the corners of the eye, so there the skin behind the margin lies over less of the opening than
 * its column, or beside it: it turns no farther than down to the lower margin (or the corner) at its own x, else it
 * would sink past the corner, which stays, and fold over. The same for the ledge over the inner edge of the lower lid, of
 * which the corner lies deeper in; but it must go with the margin, and keeps a share of what is beyond.
 * ring: of the lower lid; first, last: rings of the upper lid. */
static void limit_columns(const lid_bake *b, int32_t ring, int32_t first, int32_t last, float keep)
{
    const uint32_t count = sorted_ring(b, ring, KIND_LOWER);
    for (uint32_t i = 0; count > 1 && i < b->model->node_count; ++i) {
        if (b->ring[i] < first || b->ring[i] > last || b->kind[i] != KIND_UPPER) {
            continue;
        }
        ris_lid_node *node = &b->node[i];
        float s;
        const uint32_t k = find_segment(b, count, b->model->rest_position[i].x, &s);
        const float from = elevation(b, b->lower[k]), to = elevation(b, b->lower[k + 1]);
        const float room = f_max(elevation(b, i) - (from + s * (to - from)), 0.0f);
        if (room < node->close_rad) {
            const float turn = room + keep * (node->close_rad - room);
            node->close_mm *= turn / node->close_rad;
            node->close_rad = turn;
        }
    }
}

/* Weights by what is left of the column: 1 at the margin. Closing spreads the skin of the whole lid, opening
 * slides it under the fold, so its weight stays near 1 for longer. */
static void weigh(const lid_bake *b, uint32_t i)
{
    ris_lid_node *node = &b->node[i];
    float rest = 1.0f;
    if (b->ring[i] < 0) {
        rest = 0.0f;
    } else if (b->ring[i] > b->margin) {
        rest = b->total[i] > 0.0f ? f_clamp(1.0f - b->along[i] / b->total[i], 0.0f, 1.0f) : 0.0f;
    }
    const float skin = f_min(rest / STRETCHES, 1.0f);
    node->upper = (b->kind[i] & KIND_UPPER) != 0;
    node->lining = b->ring[i] < 0;
    node->margin = b->ring[i] == b->margin;
    node->weight_close = node->upper ? skin * skin * skin : f_smoothstep((rest - LOWER_FOLD) / LOWER_ROLL);
    node->weight_open = node->upper ? rest * (1.5f - 0.5f * rest) : node->weight_close;
    if (node->lining) { /* inside the ball, loose: takes little of what its lid does */
        const float first = b->ring[i] == -1 ? 1.0f : 0.0f; /* the next ring is tied to the fornix */
        node->weight_open = first * LINING_OPENS;
        node->weight_close = first * LINING_FOLLOWS * f_min(2.0f * node->share, 1.0f);
    }
    if (b->ring[i] >= 0 &&
        b->ring[i] < b->margin) { /* its inner edge keeps off the eye, towards the corners all of it */
        const float near = (float)b->ring[i] / (float)b->margin;
        node->weight_close *= LEDGE_BACK + (1.0f - LEDGE_BACK) * near;
        node->close_mm *= near + (near > 0.0f ? (1.0f - near) * f_min(2.0f * node->share, 1.0f) : 0.0f);
    }
    node->close_mm *= skin * skin;
}

static void finish_nodes(lid_bake *b)
{
    ris_lid_eye *eye = &b->model->lid_eye[b->eye];
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        if (b->ring[i] == b->margin) {
            eye->open_rad = f_max(eye->open_rad, b->node[i].close_rad);
        }
    }
    for (uint32_t i = 0; eye->open_rad > 0.0f && i < b->model->node_count; ++i) {
        b->node[i].share = f_clamp(b->node[i].close_rad / eye->open_rad, 0.0f, 1.0f);
    }
    for (uint32_t i = 0; i < b->model->node_count; ++i) {
        ris_lid_node *node = &b->node[i];
        if (b->ring[i] == NO_RING) {
            continue;
        }
        const ris_vec3 p = from_eye(b, i);
        const float r = v3_length(p);
        node->lower_share =
            b->node[node->facing[0]].share +
            node->facing_share * (b->node[node->facing[1]].share - b->node[node->facing[0]].share);
        node->gap_mm = r - ris__eye_surface(eye, v3_scale(p, 1.0f / r), v3(0, 0, 1));
        weigh(b, i);
        if (node->upper) {
            node->close_rad += PRESS_MM / eye->ball_mm * f_min(4.0f * node->share, 1.0f);
        }
    }
}

static ris_result alloc_lid_bake(lid_bake *b, ris_error *err)
{
    const uint32_t n = b->model->node_count;
    const struct {
        void *field;
        size_t size;
    } arrays[] = {
        {&b->kind, sizeof *b->kind},   {&b->socket, sizeof *b->socket}, {&b->ring, sizeof *b->ring},
        {&b->along, sizeof *b->along}, {&b->total, sizeof *b->total},   {&b->count, sizeof *b->count},
        {&b->lower, sizeof *b->lower}, {&b->node, sizeof *b->node},
    };
    ris_result result = RIS_OK;
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0] && result == RIS_OK; ++k) {
        result = ris__model_alloc(arrays[k].field, n, arrays[k].size, "the lids", err);
    }
    return result;
}

static void free_lid_bake(lid_bake *b)
{
    free(b->kind);
    free(b->socket);
    free(b->ring);
    free(b->along);
    free(b->total);
    free(b->count);
    free(b->lower);
    free(b->node);
}

/* The first ring of the lining hangs on the nearest node of the lid's inner edge; the next one has to itself. */
static void hang_lining(const lid_bake *b, uint32_t from, uint32_t to, int32_t ring)
{
    if (b->ring[from] != ring || b->ring[to] != ring - 1) {
        return;
    }
    uint32_t *facing = b->node[to].facing;
    const ris_vec3 p = from_eye(b, to);
    if (b->ring[facing[0]] != ring ||
        v3_distance(p, from_eye(b, from)) < v3_distance(p, from_eye(b, facing[0]))) {
        facing[0] = facing[1] = from;
    }
}

/* Appends the moving nodes of one eye to the model, facing turned into lid indices. */
static void keep_nodes(const lid_bake *b)
{
    ris_model *model = b->model;
    const uint32_t first = model->lid_count;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (b->ring[i] != NO_RING && moves(b, i)) {
            b->lower[i] = model->lid_count;
            model->lid[model->lid_count] = b->node[i];
            model->lid[model->lid_count].node = i;
            model->lid[model->lid_count++].eye = b->eye;
        }
    }
    for (uint32_t k = first; k < model->lid_count; ++k) {
        for (int end = 0; end < 2; ++end) {
            const uint32_t j = model->lid[k].facing[end];
            model->lid[k].facing[end] = b->ring[j] != NO_RING && moves(b, j) ? b->lower[j] : k;
        }
    }
}

static ris_result bake_eye(ris_bake *bake, uint8_t eye, ris_error *err)
{
    lid_bake b = {.model = bake->model, .head = bake->head, .eye = eye};
    ris_result result = alloc_lid_bake(&b, err);
    if (result == RIS_OK && measure_eye(&b, eye ? RIS_BONE_EYE_R : RIS_BONE_EYE_L) && mark_regions(&b)) {
        for (uint32_t i = 0; i < b.model->node_count; ++i) {
            b.node[i].facing[0] = b.node[i].facing[1] = i;
        }
        const int32_t last = make_rings(&b);
        find_margin(&b, last);
        measure_margin(&b, KIND_UPPER);
        measure_margin(&b, KIND_LOWER);
        make_columns(&b, last);
        limit_columns(&b, b.margin, b.margin + 1, last, 0.0f);
        limit_columns(&b, 0, 0, b.margin - 1, LEDGE_KEEPS);
        finish_nodes(&b);
        for (uint32_t i = 0; i < b.model->node_count; ++i) {
            if (b.ring[i] < 0) {
                b.node[i].facing[0] = b.node[i].facing[1] = i;
            }
        }
        each_edge(&b, hang_lining, 0);
        keep_nodes(&b);
    }
    free_lid_bake(&b);
    return result;
}

/* The skin of a lid is thin and loose, its margin firm: soft springs and umbrellas, stiff anchors. */
static void soften(ris_model *model, const float *soft)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            ris_half_spring *half = &model->half_spring[h];
            half->area_ratio *= f_min(soft[i], soft[half->other]);
            half->bend_in *= soft[half->other];
        }
        model->anchor_param[i].bend *= soft[i];
    }
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        const ris_lid_node *lid = &model->lid[k];
        ris_anchor_param *param = &model->anchor_param[lid->node];
        param->normal += lid->weight_open * f_max(LID_ANCHOR - param->normal, 0.0f);
        param->tangential += lid->weight_open * f_max(LID_ANCHOR - param->tangential, 0.0f);
    }
}

ris_result ris__bake_lids(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    float *soft = NULL;
    if (bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    ris_result result = ris__model_alloc(&model->lid, model->node_count, sizeof *model->lid, "the lids", err);
    for (uint8_t eye = 0; eye < 2 && result == RIS_OK; ++eye) {
        result = bake_eye(bake, eye, err);
    }
    if (result == RIS_OK && model->lid_count > 0) {
        result = ris__model_alloc(&soft, model->node_count, sizeof *soft, "the lids", err);
    }
    if (result != RIS_OK || model->lid_count == 0) {
        return result;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        soft[i] = 1.0f;
    }
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        soft[model->lid[k].node] = 1.0f - (1.0f - LID_SKIN) * model->lid[k].weight_open;
    }
    soften(model, soft);
    free(soft);
    return RIS_OK;
}
