/* Bake of the contact stage (beyond the thesis, which names it as future work: KF-04). Bodies are the bones, the rows
 * of teeth and the eyes as distance grids, each in its own rest frame; every moving node learns how near it may come to
 * each, which is never nearer than it is at rest. The lips are told apart by region and by the mesh (the lining follows
 * its lip); each node near the slit gets the nodes of the other lip that face it at rest. */
#include "distance_grid.h"
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define BONE_CELL_MM 2.0f
#define TEETH_CELL_MM 1.0f
#define EYE_CELL_MM 1.5f
#define MARGIN_MM 8.0f     /* of a grid around what its meshes and the moving skin have in common */
#define BONE_CLEAR_MM 1.2f /* the least tissue over bone: skin without its fat */
#define TEETH_CLEAR_MM 0.8f
/* The lining of the mouth keeps farther off both: its edges are long and the ridges narrow. But not where it lies nearer
 * than LINING_ROOM_MM to both jaws: it would be squeezed. */
#define LINING_CLEAR_MM 1.5f
#define LINING_ROOM_MM 6.0f
/* Edges of the lip's inner rim and the lining are long against a canine: their middles keep off the teeth too. */
#define MIDDLE_CLEAR_MM 0.3f
#define MIDDLE_LONG_MM 2.5f   /* shorter edges do without */
#define MIDDLE_REACH_MM 12.0f /* from the teeth at rest */
#define EYE_CLEAR_MM 0.2f
#define SLACK_MM 0.01f /* rest stays a fixed point in spite of rounding */
/* A body farther than this from a node at rest is never asked: tissue does not move so far. */
#define BONE_REACH_MM 15.0f
#define JAW_REACH_MM 22.0f
#define EYE_REACH_MM 6.0f

#define LIP_RADIUS_MM 5.0f /* nodes of the other lip count this far */
#define LIP_LIST_MM 11.0f  /* and may come from this far at rest: lips slide */
#define LIP_RINGS 5        /* of the mesh beyond the lips' regions that follow a lip: lining, skin around */
#define LIP_APART_MM 0.1f  /* lips in contact keep this far apart, or as far as at rest */
#define LIP_BEHIND_MM 0.2f /* a pair that lies farther behind each other at rest never meets face to face */
#define LIP_CORNER_EDGES 3 /* nor one this near on the mesh: there the lips join in the corner */
#define LIP_FACING 0.5f    /* nor one whose normals agree more than this */
#define LIP_CORNER_MM 8.0f /* so near the corner of the mouth the lips are one fold of flesh, ... */
#define LIP_FOLD_MM 1.0f   /* ... which may press into itself so deep at the corner */

enum { LIP_NONE, LIP_UPPER = 1, LIP_LOWER = 2, LIP_BOTH = 3 };

/* One body as it is looked for in the head. */
typedef struct body_source {
    const char *name;
    ris_bone bone;
    const ris_mesh *mesh;
    float cell_mm;
    uint32_t smoothing; /* passes */
} body_source;

static void bound(const ris_vec3 *position, uint32_t count, ris_vec3 *low, ris_vec3 *high)
{
    for (uint32_t k = 0; k < count; ++k) {
        const ris_vec3 p = position[k];
        *low = v3(f_min(low->x, p.x), f_min(low->y, p.y), f_min(low->z, p.z));
        *high = v3(f_max(high->x, p.x), f_max(high->y, p.y), f_max(high->z, p.z));
    }
}

/* Box of the mesh and of the moving skin, what both have in common with a margin; false if nothing. */
static bool place_grid(const ris_bake *bake, const body_source *source, ris_grid_place *out)
{
    const ris_model *model = bake->model;
    ris_vec3 low = v3(INFINITY, INFINITY, INFINITY), high = v3(-INFINITY, -INFINITY, -INFINITY);
    ris_vec3 skin_low = low, skin_high = high;
    bound(source->mesh->position, source->mesh->vertex_count, &low, &high);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (bake->moving[i]) {
            bound(&bake->head->skin.position[i], 1, &skin_low, &skin_high);
        }
    }
    const float m = MARGIN_MM;
    low = v3(f_max(low.x, skin_low.x) - m, f_max(low.y, skin_low.y) - m, f_max(low.z, skin_low.z) - m);
    high = v3(f_min(high.x, skin_high.x) + m, f_min(high.y, skin_high.y) + m, f_min(high.z, skin_high.z) + m);
    if (!(low.x < high.x && low.y < high.y && low.z < high.z)) {
        return false;
    }
    if (low.x < 0.0f &&
        high.x > 0.0f) { /* samples at mirrored places, so that the grid is as symmetric as the bone */
        const float half = ceilf(f_max(-low.x, high.x) / source->cell_mm) * source->cell_mm;
        low.x = -half;
        high.x = half;
    }
    *out = ris__grid_place(low, high, source->cell_mm);
    return true;
}

/* Appends a grid of distances as a new body. */
static ris_result add_solid(ris_model *model, const char *name, ris_bone bone, const ris_grid_place *place,
                            const float *value, ris_error *err)
{
    const size_t more = ris__grid_count(place), count = model->contact_sample_count + more;
    ris_vec4 *grown = count < 100000000u ? realloc(model->contact_grid, count * sizeof *grown) : NULL;
    if (!grown) {
        return ris_fail(err, RIS_ERROR_MEMORY, "not enough memory for %zu samples of the contact grids",
                        count);
    }
    model->contact_grid = grown;
    ris__grid_directions(place, value, grown + model->contact_sample_count);
    ris_contact_solid *solid = &model->contact_solid[model->contact_solid_count++];
    strncpy(solid->name, name, sizeof solid->name - 1);
    solid->bone = bone;
    solid->low = place->low;
    solid->cell_mm = place->cell_mm;
    memcpy(solid->count, place->count, sizeof solid->count);
    solid->first = model->contact_sample_count;
    model->contact_sample_count = (uint32_t)count;
    return RIS_OK;
}

static ris_grid_place place_of(const ris_contact_solid *solid)
{
    return (ris_grid_place){solid->low, solid->cell_mm, {solid->count[0], solid->count[1], solid->count[2]}};
}

/* The ball and the cornea's sphere; the grid is exact everywhere. */
static void fill_eye(const ris_lid_eye *eye, const ris_grid_place *place, float *out)
{
    for (uint32_t z = 0; z < place->count[2]; ++z) {
        for (uint32_t y = 0; y < place->count[1]; ++y) {
            for (uint32_t x = 0; x < place->count[0]; ++x) {
                const ris_vec3 at = v3_mad(place->low, place->cell_mm, v3((float)x, (float)y, (float)z));
                const ris_vec3 p = v3_sub(at, eye->centre);
                float d = v3_length(p) - eye->ball_mm;
                if (eye->cornea_at_mm > 0.0f) {
                    d = f_min(d, v3_length(v3_sub(p, v3(0.0f, 0.0f, eye->cornea_at_mm))) - eye->cornea_mm);
                }
                *out++ = d;
            }
        }
    }
}

static ris_result add_eye(ris_model *model, uint32_t e, ris_error *err)
{
    const ris_lid_eye *eye = &model->lid_eye[e];
    const float r = f_max(eye->ball_mm, eye->cornea_at_mm + eye->cornea_mm) + EYE_REACH_MM;
    const ris_vec3 size = v3(r, r, r);
    const ris_grid_place place =
        ris__grid_place(v3_sub(eye->centre, size), v3_add(eye->centre, size), EYE_CELL_MM);
    float *value = NULL;
    ris_result result =
        ris__model_alloc(&value, ris__grid_count(&place), sizeof *value, "a contact grid", err);
    if (result == RIS_OK) {
        fill_eye(eye, &place, value);
        result =
            add_solid(model, e ? "eye.R" : "eye.L", e ? RIS_BONE_EYE_R : RIS_BONE_EYE_L, &place, value, err);
    }
    free(value);
    return result;
}

static ris_result add_body(ris_bake *bake, const body_source *source, ris_error *err)
{
    ris_grid_place place;
    if (!source->mesh || source->mesh->vertex_count == 0 || !place_grid(bake, source, &place)) {
        return RIS_OK;
    }
    float *value = NULL;
    ris_result result =
        ris__model_alloc(&value, ris__grid_count(&place), sizeof *value, "a contact grid", err);
    if (result == RIS_OK) {
        result = ris__distance_grid(&source->mesh, 1, &place, value, err);
    }
    if (result == RIS_OK) {
        ris__grid_smooth(&place, source->smoothing, value);
        result = add_solid(bake->model, source->name, source->bone, &place, value, err);
    }
    free(value);
    return result;
}

static const ris_mesh *teeth_of(const ris_head *head, ris_bone bone)
{
    for (uint32_t k = 0; k < head->part_count; ++k) {
        if (head->part[k].material == RIS_MATERIAL_TEETH && head->part[k].bone == bone) {
            return &head->part[k].mesh;
        }
    }
    return NULL;
}

static ris_result add_bodies(ris_bake *bake, ris_error *err)
{
    const ris_head *head = bake->head;
    const body_source source[] = {
        {"skull", RIS_BONE_SKULL, &head->skull, BONE_CELL_MM, 1},
        {"mandible", RIS_BONE_JAW, &head->mandible, BONE_CELL_MM, 1},
        {"teeth_upper", RIS_BONE_SKULL, teeth_of(head, RIS_BONE_SKULL), TEETH_CELL_MM, 1},
        {"teeth_lower", RIS_BONE_JAW, teeth_of(head, RIS_BONE_JAW), TEETH_CELL_MM, 1},
    };
    ris_result result = RIS_OK;
    for (uint32_t e = 0; e < 2 && result == RIS_OK; ++e) {
        result = bake->model->lid_eye[e].ball_mm > 0.0f ? add_eye(bake->model, e, err) : RIS_OK;
    }
    for (size_t k = 0; k < sizeof source / sizeof source[0] && result == RIS_OK; ++k) {
        result = add_body(bake, &source[k], err);
    }
    return result;
}

static bool is_eye(const ris_contact_solid *solid)
{
    return solid->bone == RIS_BONE_EYE_L || solid->bone == RIS_BONE_EYE_R;
}

static bool is_teeth(const ris_contact_solid *solid)
{
    return strncmp(solid->name, "teeth", 5) == 0;
}

static float reach(const ris_contact_solid *solid)
{
    return is_eye(solid) ? EYE_REACH_MM : solid->bone == RIS_BONE_JAW ? JAW_REACH_MM : BONE_REACH_MM;
}

static float clearance(const ris_contact_solid *solid, bool lining)
{
    return is_eye(solid)     ? EYE_CLEAR_MM
           : lining          ? LINING_CLEAR_MM
           : is_teeth(solid) ? TEETH_CLEAR_MM
                             : BONE_CLEAR_MM;
}

/* Lining with room: farther than LINING_ROOM_MM from one of the two jaws. */
static bool has_room(const ris_model *model, uint32_t i)
{
    float nearest[2] = {INFINITY, INFINITY};
    for (uint32_t k = 0; k < model->contact_solid_count; ++k) {
        const ris_contact_solid *solid = &model->contact_solid[k];
        const ris_grid_place place = place_of(solid);
        ris_vec4 at;
        if (!is_eye(solid) && ris__grid_sample(model->contact_grid + solid->first, &place,
                                               v4_xyz(model->rest_position[i]), &at)) {
            float *d = &nearest[solid->bone == RIS_BONE_JAW];
            *d = f_min(*d, at.w);
        }
    }
    return f_max(nearest[0], nearest[1]) > LINING_ROOM_MM;
}

/* Least distance of node i from a body, or false if it cannot come near. */
static bool body_limit(const ris_model *model, const ris_contact_solid *solid, uint32_t i, bool lining,
                       float *out)
{
    const ris_grid_place place = place_of(solid);
    ris_vec4 at;
    if (!ris__grid_sample(model->contact_grid + solid->first, &place, v4_xyz(model->rest_position[i]), &at) ||
        !(at.w < reach(solid))) {
        return false;
    }
    const float d = at.w;
    *out = f_min(clearance(solid, lining), d - SLACK_MM);
    return d > 0.0f ||
           !is_eye(solid); /* the lids' lining runs through the eye, and lid_pose holds it stiffly */
}

/* ---- lips ---- */

/* Which lip a node follows: its region's, handed on over the mesh for a few rings. */
static void spread_lips(const ris_model *model, uint8_t *lip, uint8_t *scratch)
{
    for (uint32_t ring = 0; ring < LIP_RINGS; ++ring) {
        memcpy(scratch, lip, model->node_count);
        for (uint32_t i = 0; i < model->node_count; ++i) {
            for (uint32_t h = model->spring_start[i];
                 scratch[i] == LIP_NONE && h < model->spring_start[i + 1]; ++h) {
                lip[i] |= scratch[model->half_spring[h].other];
            }
        }
    }
}

/* Is j within so many edges of i? */
static bool near_on_mesh(const ris_model *model, uint32_t i, uint32_t j, uint32_t edges)
{
    for (uint32_t h = model->spring_start[i]; edges > 0 && h < model->spring_start[i + 1]; ++h) {
        const uint32_t k = model->half_spring[h].other;
        if (k == j || near_on_mesh(model, k, j, edges - 1)) {
            return true;
        }
    }
    return false;
}

/* May i and j, of different lips, ever touch with their outer sides? */
static bool faces(const ris_model *model, uint32_t i, uint32_t j)
{
    const ris_vec3 ni = v4_xyz(model->rest_normal[i]), nj = v4_xyz(model->rest_normal[j]);
    const ris_vec3 r = v3_sub(v4_xyz(model->rest_position[i]), v4_xyz(model->rest_position[j]));
    const ris_vec3 m = v3_unit_or(v3_sub(nj, ni), v3(0.0f, 0.0f, 0.0f));
    return v3_dot(r, r) < LIP_LIST_MM * LIP_LIST_MM && v3_dot(ni, nj) < LIP_FACING &&
           v3_dot(m, r) > -LIP_BEHIND_MM && !near_on_mesh(model, i, j, LIP_CORNER_EDGES);
}

/* Room for one more item; *array is NULL or malloc. */
static ris_result reserve(void *array, size_t count, size_t size, ris_error *err)
{
    void *old;
    memcpy(&old, array, sizeof old);
    if (count % 1024 != 0) {
        return RIS_OK;
    }
    void *grown = realloc(old, (count + 1024) * size);
    if (!grown) {
        return ris_fail(err, RIS_ERROR_MEMORY, "not enough memory for contact (%zu x %zu bytes)",
                        count + 1024, size);
    }
    memcpy(array, &grown, sizeof grown);
    return RIS_OK;
}

/* 1 in the corner of the mouth (a node of both lips), 0 from LIP_CORNER_MM on. */
static float corner(const ris_model *model, const uint8_t *lip, uint32_t i)
{
    float nearest = LIP_CORNER_MM;
    for (uint32_t j = 0; j < model->node_count; ++j) {
        if (lip[j] == LIP_BOTH) {
            nearest =
                f_min(nearest, v3_distance(v4_xyz(model->rest_position[i]), v4_xyz(model->rest_position[j])));
        }
    }
    return 1.0f - nearest / LIP_CORNER_MM;
}

/* Adds the nodes of the other lip that contact->node may meet. */
static ris_result list_pairs(ris_model *model, const uint8_t *lip, ris_contact_node *contact, ris_error *err)
{
    const uint32_t i = contact->node;
    ris_result result = RIS_OK;
    contact->lip_first = model->contact_pair_count;
    for (uint32_t j = 0; j < model->node_count && (lip[i] == LIP_UPPER || lip[i] == LIP_LOWER); ++j) {
        if (lip[j] != LIP_BOTH - lip[i] || !faces(model, i, j)) {
            continue;
        }
        result = reserve(&model->contact_other, model->contact_pair_count, sizeof *model->contact_other, err);
        if (result != RIS_OK) {
            return result;
        }
        model->contact_other[model->contact_pair_count++] = j;
    }
    contact->lip_end = model->contact_pair_count;
    if (contact->lip_end > contact->lip_first) {
        ris_vec3 away;
        float weight;
        const float d =
            ris__lip_distance(model, model->rest_position, model->rest_normal, contact, &away, &weight);
        contact->lip_limit_mm = weight > 0.0f ? f_min(LIP_APART_MM, d - SLACK_MM) : LIP_APART_MM;
        contact->lip_limit_mm -= LIP_FOLD_MM * corner(model, lip, i);
    }
    return result;
}

/* Least distance of the middle of edge i-j from teeth; the same seen from both ends. */
static bool middle_limit(const ris_bake *bake, const ris_contact_solid *solid, const bool *rim, uint32_t i,
                         uint32_t j, float *out)
{
    const ris_model *model = bake->model;
    const ris_vec3 a = v4_xyz(model->rest_position[i < j ? i : j]),
                   b = v4_xyz(model->rest_position[i < j ? j : i]);
    const ris_grid_place place = place_of(solid);
    ris_vec4 at;
    if (!is_teeth(solid) || !bake->moving[j] || !(rim[i] || rim[j]) || v3_distance(a, b) < MIDDLE_LONG_MM ||
        !ris__grid_sample(model->contact_grid + solid->first, &place, v3_scale(v3_add(a, b), 0.5f), &at)) {
        return false;
    }
    *out = f_min(MIDDLE_CLEAR_MM, at.w - SLACK_MM);
    return at.w < MIDDLE_REACH_MM;
}

static ris_result add_touch(ris_model *model, uint32_t body, uint32_t other, float limit, ris_error *err)
{
    const ris_result result =
        reserve(&model->contact_touch, model->contact_touch_count, sizeof *model->contact_touch, err);
    if (result == RIS_OK) {
        model->contact_touch[model->contact_touch_count++] = (ris_contact_touch){body, other, limit};
    }
    return result;
}

/* rim: of the lips, inner (node_count). */
static ris_result list_touches(ris_bake *bake, const bool *rim, ris_contact_node *contact, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t i = contact->node;
    const bool lining = bake->lining[i] && has_room(model, i);
    ris_result result = RIS_OK;
    contact->touch_first = model->contact_touch_count;
    for (uint32_t k = 0; k < model->contact_solid_count && result == RIS_OK; ++k) {
        const ris_contact_solid *solid = &model->contact_solid[k];
        float limit;
        if (body_limit(model, solid, i, lining, &limit)) {
            result = add_touch(model, k, i, limit, err);
        }
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1] && result == RIS_OK; ++h) {
            const uint32_t j = model->half_spring[h].other;
            if (middle_limit(bake, solid, rim, i, j, &limit)) {
                result = add_touch(model, k, j, limit, err);
            }
        }
    }
    contact->touch_end = model->contact_touch_count;
    return result;
}

/* Nodes of lips first, then those of bodies, each by the length of their lists: neighbours take equally long, which wide
 * devices like. */
static int compare_work(const void *a, const void *b)
{
    const ris_contact_node *p = a, *q = b;
    const uint32_t lips[2] = {p->lip_end - p->lip_first, q->lip_end - q->lip_first};
    const uint32_t bodies[2] = {p->touch_end - p->touch_first, q->touch_end - q->touch_first};
    if (lips[0] != lips[1]) {
        return lips[0] > lips[1] ? -1 : 1;
    }
    if (bodies[0] != bodies[1]) {
        return bodies[0] > bodies[1] ? -1 : 1;
    }
    return p->node < q->node ? -1 : p->node > q->node;
}

static ris_result add_contact(ris_model *model, const ris_contact_node *contact, ris_error *err)
{
    const ris_result result =
        reserve(&model->contact_node, model->contact_node_count, sizeof *model->contact_node, err);
    if (result == RIS_OK) {
        model->contact_node[model->contact_node_count++] = *contact;
    }
    return result;
}

static ris_result list_nodes(ris_bake *bake, const uint8_t *lip, const bool *rim, ris_error *err)
{
    ris_model *model = bake->model;
    ris_result result = RIS_OK;
    for (uint32_t i = 0; i < model->node_count && result == RIS_OK; ++i) {
        ris_contact_node lips = {.node = i}, bodies = {.node = i};
        if (!bake->moving[i]) {
            continue;
        }
        result = list_pairs(model, lip, &lips, err);
        if (result == RIS_OK && lips.lip_end > lips.lip_first) {
            result = add_contact(model, &lips, err);
        }
        if (result == RIS_OK) {
            result = list_touches(bake, rim, &bodies, err);
        }
        if (result == RIS_OK && bodies.touch_end > bodies.touch_first) {
            result = add_contact(model, &bodies, err);
        }
    }
    if (result == RIS_OK && model->contact_node_count) {
        qsort(model->contact_node, model->contact_node_count, sizeof *model->contact_node, compare_work);
    }
    return result;
}

static ris_result sort_lips(const ris_bake *bake, uint8_t **out, ris_error *err)
{
    const ris_model *model = bake->model;
    uint8_t *lip = NULL;
    ris_result result = ris__model_alloc(&lip, 2 * (size_t)model->node_count, 1, "lip flags", err);
    *out = lip;
    if (result != RIS_OK) {
        return result;
    }
    const ris_region *upper = ris_head_region(bake->head, "lip_upper"),
                     *lower = ris_head_region(bake->head, "lip_lower");
    for (uint32_t k = 0; upper && k < upper->count; ++k) {
        lip[upper->vertex[k]] |= LIP_UPPER;
    }
    for (uint32_t k = 0; lower && k < lower->count; ++k) {
        lip[lower->vertex[k]] |= LIP_LOWER;
    }
    spread_lips(model, lip, lip + model->node_count);
    return RIS_OK;
}

ris_result ris__bake_contact(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    if (bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    uint8_t *lip = NULL;
    bool *rim = NULL;
    model->push.lip_radius_mm = LIP_RADIUS_MM;
    ris_result result = add_bodies(bake, err);
    if (result == RIS_OK) {
        result = sort_lips(bake, &lip, err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&rim, model->node_count, sizeof *rim, "the lips", err);
    }
    if (result == RIS_OK) {
        ris__region_flags(bake->head, "inner_lip_rim", rim);
        result = list_nodes(bake, lip, rim, err);
    }
    free(rim);
    free(lip);
    model->push.contact_node_count = model->contact_node_count;
    for (uint32_t k = 0; k < model->contact_node_count; ++k) { /* sorted: they come first */
        model->push.lip_node_count += model->contact_node[k].lip_end > model->contact_node[k].lip_first;
    }
    return result;
}
