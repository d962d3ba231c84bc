/* The measurer: what the measures share, and their order. */
#include "measure/measure_impl.h"

#include <stdlib.h>
#include <string.h>

#define FAR_MM 1e5f /* as in engine/sim: a node this far out has diverged */

struct ris_measurer {
    const ris_model *model;
    bool *moving; /* (node_count) */
    ris_penetration penetration;
    ris_sheet_pair lips, lids[2];
    ris_folds folds;
    uint32_t *partner; /* node at the mirrored place (node_count) */
    uint32_t unpaired;
    ris_finding rest[RIS_MEASURE_COUNT];
};

static const struct {
    const char *name, *unit;
} about[RIS_MEASURE_COUNT] = {
    [RIS_MEASURE_FINITE] = {"not finite", "nodes"},
    [RIS_MEASURE_SKULL] = {"skull, vertices", "mm"},
    [RIS_MEASURE_SKULL_MIDPOINT] = {"skull, midpoints", "mm"},
    [RIS_MEASURE_UPPER_TEETH] = {"upper teeth, vertices", "mm"},
    [RIS_MEASURE_UPPER_TEETH_MIDPOINT] = {"upper teeth, midpoints", "mm"},
    [RIS_MEASURE_MANDIBLE] = {"mandible, vertices", "mm"},
    [RIS_MEASURE_MANDIBLE_MIDPOINT] = {"mandible, midpoints", "mm"},
    [RIS_MEASURE_LOWER_TEETH] = {"lower teeth, vertices", "mm"},
    [RIS_MEASURE_LOWER_TEETH_MIDPOINT] = {"lower teeth, midpoints", "mm"},
    [RIS_MEASURE_EYES] = {"eyes, vertices", "mm"},
    [RIS_MEASURE_EYES_MIDPOINT] = {"eyes, midpoints", "mm"},
    [RIS_MEASURE_LIPS] = {"lip in lip", "mm"},
    [RIS_MEASURE_LIDS] = {"lid in lid", "mm"},
    [RIS_MEASURE_FLIPPED] = {"flipped, lips and lids", "triangles"},
    [RIS_MEASURE_FLIPPED_OTHER] = {"flipped, other skin", "triangles"},
    [RIS_MEASURE_MIRROR] = {"mirror", "mm"},
};

const char *ris__measure_name(ris_measure measure)
{
    return (unsigned)measure < RIS_MEASURE_COUNT ? about[measure].name : "?";
}

const char *ris__measure_unit(ris_measure measure)
{
    return (unsigned)measure < RIS_MEASURE_COUNT ? about[measure].unit : "?";
}

static void clear(ris_finding *out)
{
    for (int k = 0; k < RIS_MEASURE_COUNT; ++k) {
        out[k] = (ris_finding){.part = ""};
    }
}

/* What sheets and folds are measured from; one allocation. */
typedef struct surface {
    dvec *position; /* (node_count) */
    dvec *normal;   /* sum of the area vectors around each node (node_count) */
    dvec *area;     /* of each triangle (triangle_count) */
} surface;

static ris_result read_surface(const ris_model *model, const ris_vec4 *position, surface *out, ris_error *err)
{
    const uint32_t n = model->node_count;
    ris_result result = ris__model_alloc(&out->position, 2 * (size_t)n + model->triangle_count,
                                         sizeof *out->position, "the surface", err);
    if (result != RIS_OK) {
        return result;
    }
    out->normal = out->position + n;
    out->area = out->normal + n;
    for (uint32_t i = 0; i < n; ++i) {
        out->position[i] = dv_of(position[i]);
    }
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        const dvec a = out->position[v[0]];
        out->area[t] = dv_cross(dv_sub(out->position[v[1]], a), dv_sub(out->position[v[2]], a));
        for (int k = 0; k < 3; ++k) {
            out->normal[v[k]] = dv_add(out->normal[v[k]], out->area[t]);
        }
    }
    return RIS_OK;
}

static ris_result init_surface_measures(ris_measurer *m, const surface *rest, ris_error *err)
{
    static const char *const lids[2][2] = {{"lid_upper.L", "lid_lower.L"}, {"lid_upper.R", "lid_lower.R"}};
    ris_result result =
        ris__sheets_init(&m->lips, m->model, "lip_upper", "lip_lower", rest->position, rest->normal, err);
    for (int e = 0; result == RIS_OK && e < 2; ++e) {
        result = ris__sheets_init(&m->lids[e], m->model, lids[e][0], lids[e][1], rest->position, rest->normal,
                                  err);
    }
    return result == RIS_OK ? ris__folds_init(&m->folds, m->model, m->moving, rest->area, err) : result;
}

static void find_rest(ris_measurer *m)
{
    clear(m->rest);
    ris__penetration_rest(&m->penetration, m->rest);
    ris__sheets_rest(&m->lips, &m->rest[RIS_MEASURE_LIPS]);
    for (int e = 0; e < 2; ++e) {
        ris__sheets_rest(&m->lids[e], &m->rest[RIS_MEASURE_LIDS]);
    }
    ris__folds_rest(&m->folds, &m->rest[RIS_MEASURE_FLIPPED]);
}

ris_result ris__measurer_create(const ris_model *model, ris_measurer **out, ris_error *err)
{
    ris_measurer *m = NULL;
    surface rest = {0};
    *out = NULL;
    ris_result result = ris__model_alloc(&m, 1, sizeof *m, "the measurer", err);
    if (result != RIS_OK) {
        return result;
    }
    m->model = model;
    result = ris__model_alloc(&m->moving, model->node_count, sizeof *m->moving, "the measurer", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&m->partner, model->node_count, sizeof *m->partner, "the measurer", err);
    }
    for (uint32_t i = 0; result == RIS_OK && i < model->node_count; ++i) {
        m->moving[i] = model->rest_position[i].w > 0.0f;
    }
    if (result == RIS_OK) {
        m->unpaired = ris__mirror_pairs(model, m->partner);
        result = ris__penetration_init(&m->penetration, model, m->moving, err);
    }
    if (result == RIS_OK) {
        result = read_surface(model, model->rest_position, &rest, err);
    }
    if (result == RIS_OK) {
        result = init_surface_measures(m, &rest, err);
    }
    free(rest.position);
    if (result != RIS_OK) {
        ris__measurer_destroy(m);
        return result;
    }
    find_rest(m);
    *out = m;
    return RIS_OK;
}

void ris__measurer_destroy(ris_measurer *m)
{
    if (!m) {
        return;
    }
    ris__penetration_finish(&m->penetration);
    ris__sheets_finish(&m->lips);
    ris__sheets_finish(&m->lids[0]);
    ris__sheets_finish(&m->lids[1]);
    ris__folds_finish(&m->folds);
    free(m->moving);
    free(m->partner);
    free(m);
}

static uint32_t sheet_nodes(const ris_sheet_pair *pair)
{
    return pair->sheet[0].node_count + pair->sheet[1].node_count;
}

uint32_t ris__measurer_tested(const ris_measurer *m, ris_measure measure)
{
    switch (measure) {
    case RIS_MEASURE_FINITE: return m->model->node_count;
    case RIS_MEASURE_MIRROR: return m->model->node_count - m->unpaired;
    case RIS_MEASURE_LIPS: return sheet_nodes(&m->lips);
    case RIS_MEASURE_LIDS: return sheet_nodes(&m->lids[0]) + sheet_nodes(&m->lids[1]);
    case RIS_MEASURE_FLIPPED: return m->folds.tested[0];
    case RIS_MEASURE_FLIPPED_OTHER: return m->folds.tested[1];
    default: break;
    }
    for (uint32_t k = 0; k < m->penetration.body_count; ++k) {
        if (m->penetration.body[k].measure == measure) {
            return m->penetration.vertex_count;
        }
        if ((int)m->penetration.body[k].measure + 1 == (int)measure) {
            return m->penetration.point_count - m->penetration.vertex_count;
        }
    }
    return 0;
}

bool ris__measurer_has(const ris_measurer *m, ris_measure measure)
{
    return ris__measurer_tested(m, measure) > 0;
}

const ris_finding *ris__measurer_rest(const ris_measurer *m, ris_measure measure)
{
    return &m->rest[measure];
}

uint32_t ris__measurer_unpaired(const ris_measurer *m)
{
    return m->unpaired;
}

static bool find_wild(const ris_model *model, const ris_vec4 *position, ris_finding *out)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec4 p = position[i];
        if (!(p.x > -FAR_MM && p.x < FAR_MM && p.y > -FAR_MM && p.y < FAR_MM && p.z > -FAR_MM &&
              p.z < FAR_MM)) {
            out->value = ++out->count;
            if (out->vertex_count == 0) {
                out->vertex_count = 1;
                out->vertex[0] = i;
            }
        }
    }
    return out->vertex_count > 0;
}

ris_result ris__measure_pose(const ris_measurer *m, const ris_vec4 *position, const ris_bone_frames *frames,
                             ris_finding *out, ris_measure_trace *trace, ris_error *err)
{
    float *worst = trace ? trace->worst : NULL;
    const size_t n = m->model->node_count;
    surface now = {0};
    clear(out);
    if (find_wild(m->model, position, &out[RIS_MEASURE_FINITE])) {
        return RIS_OK;
    }
    ris__penetration_measure(&m->penetration, position, frames, out, trace);
    ris_result result = read_surface(m->model, position, &now, err);
    if (result == RIS_OK) {
        result = ris__sheets_measure(&m->lips, now.position, now.normal, &out[RIS_MEASURE_LIPS],
                                     worst ? worst + n * RIS_MEASURE_LIPS : NULL, err);
    }
    for (int e = 0; result == RIS_OK && e < 2; ++e) {
        result = ris__sheets_measure(&m->lids[e], now.position, now.normal, &out[RIS_MEASURE_LIDS],
                                     worst ? worst + n * RIS_MEASURE_LIDS : NULL, err);
    }
    if (result == RIS_OK) {
        ris__folds_measure(&m->folds, now.area, &out[RIS_MEASURE_FLIPPED], trace ? trace->flipped : NULL);
    }
    free(now.position);
    return result;
}

ris_finding ris__measure_mirror(const ris_measurer *m, const ris_vec4 *position, const ris_vec4 *mirrored)
{
    return ris__mirror_difference(m->model, m->partner, position, mirrored);
}

const char *ris__measure_region(const ris_model *model, uint32_t vertex)
{
    const ris_head *head = model->head;
    const ris_region *best = NULL;
    for (uint32_t k = 0; k < head->region_count; ++k) {
        const ris_region *region = &head->region[k];
        if (strcmp(region->name, head->simulated) == 0 || (best && best->count <= region->count)) {
            continue;
        }
        for (uint32_t i = 0; i < region->count; ++i) {
            if (region->vertex[i] == vertex) {
                best = region;
                break;
            }
        }
    }
    return best ? best->name : "";
}
