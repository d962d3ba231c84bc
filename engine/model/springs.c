/* KA-09 moving nodes, KA-10 springs, KA-11 area ratio, KA-13 mass, the bending umbrella and
 * the stable time step (docs/physics.md). */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define BEND_EDGE_MM 4.5f /* a mean edge that long, or longer, has the bending of the tissue */
#define BEND_MOST 32.0f   /* times that at most, for the step must stay stable */

ris_result ris__bake_mass(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    const uint32_t n = model->node_count;
    ris_result result = ris__model_alloc(&bake->moving, n, sizeof *bake->moving, "node flags", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&bake->lining, n, sizeof *bake->lining, "node flags", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->rest_position, n, sizeof *model->rest_position, "positions", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    ris__region_flags(bake->head, bake->head->simulated, bake->moving);
    ris__region_flags(bake->head, "mouth_cavity", bake->lining);
    const ris_region *rim = ris_head_region(bake->head, "inner_lip_rim");
    for (uint32_t k = 0; rim && k < rim->count; ++k) {
        bake->lining[rim->vertex[k]] = false;
    }
    model->mass_g = tissue->mass_g;
    if (tissue->model == RIS_TISSUE_KAEHLER) {
        double area_mm2 = 0.0;
        for (uint32_t t = 0; t < model->triangle_count; ++t) {
            area_mm2 += (double)bake->triangle_area[t];
        }
        /* 1 kg/m^3 = 1e-6 g/mm^3 */
        model->mass_g =
            (float)((double)tissue->density_kg_m3 * 1e-6 * (double)tissue->skin_mm * area_mm2 / n);
    }
    if (!(model->mass_g > 0.0f) || !isfinite(model->mass_g)) {
        return ris_fail(err, RIS_ERROR_DATA, "node mass is %g g, expected more than 0",
                        (double)model->mass_g);
    }
    for (uint32_t i = 0; i < n; ++i) {
        model->rest_position[i] =
            v4_from(bake->head->skin.position[i], bake->moving[i] ? 1.0f / model->mass_g : 0.0f);
    }
    return RIS_OK;
}

/* Neighbours of node i, ascending, with the sum of the areas at each edge. Returns their number; room for
 * 2 x ring size. */
static uint32_t collect_edges(const ris_bake *bake, uint32_t i, uint32_t *other, float *area)
{
    const ris_model *model = bake->model;
    uint32_t count = 0;
    for (uint32_t k = model->ring_start[i]; k < model->ring_start[i + 1]; ++k) {
        const uint32_t ends[2] = {model->ring[k].b, model->ring[k].c};
        for (uint32_t e = 0; e < 2; ++e) {
            uint32_t slot = 0;
            while (slot < count && other[slot] < ends[e]) {
                ++slot;
            }
            if (slot == count || other[slot] != ends[e]) {
                for (uint32_t j = count; j > slot; --j) {
                    other[j] = other[j - 1];
                    area[j] = area[j - 1];
                }
                other[slot] = ends[e];
                area[slot] = 0.0f;
                ++count;
            }
            area[slot] += bake->triangle_area[bake->ring_triangle[k]];
        }
    }
    return count;
}

static uint32_t largest_ring(const ris_model *model)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        uint32_t size = model->ring_start[i + 1] - model->ring_start[i];
        largest = size > largest ? size : largest;
    }
    return largest;
}

/* The umbrella is an offset that the same curvature makes smaller where edges are short: k |L|^2 an area goes with the
 * square of the edge. So that a fine mesh bends no more readily, k grows as edges get shorter than BEND_EDGE_MM. */
float ris__bend_stiffness(const ris_bake *bake, uint32_t i)
{
    const ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    const uint32_t first = model->spring_start[i], end = model->spring_start[i + 1];
    float sum = 0.0f;
    for (uint32_t h = first; h < end; ++h) {
        sum += model->half_spring[h].rest_mm;
    }
    const float mean = end > first ? sum / (float)(end - first) : BEND_EDGE_MM;
    const float finer = BEND_EDGE_MM / mean;
    return tissue->bending * tissue->stiffness_scale * f_clamp(finer * finer, 1.0f, BEND_MOST);
}

/* Umbrella weights 1/length, normalised over the node; bend_in gathers the transpose (docs/physics.md,
 * bend). */
static void weigh_umbrellas(ris_bake *bake)
{
    ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    if (tissue->model == RIS_TISSUE_KAEHLER) {
        return;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        float sum = 0.0f;
        for (uint32_t h = model->spring_start[i]; bake->moving[i] && h < model->spring_start[i + 1]; ++h) {
            sum += 1.0f / model->half_spring[h].rest_mm;
        }
        for (uint32_t h = model->spring_start[i]; bake->moving[i] && h < model->spring_start[i + 1]; ++h) {
            model->half_spring[h].bend_out = 1.0f / model->half_spring[h].rest_mm / sum;
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            uint32_t other = model->half_spring[h].other;
            for (uint32_t b = model->spring_start[other]; b < model->spring_start[other + 1]; ++b) {
                if (model->half_spring[b].other == i) {
                    model->half_spring[h].bend_in =
                        ris__bend_stiffness(bake, other) * model->half_spring[b].bend_out;
                }
            }
        }
    }
}

static ris_result fill_springs(ris_bake *bake, uint32_t *other, float *area, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_vec3 *position = bake->head->skin.position;
    uint32_t slot = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        uint32_t count = collect_edges(bake, i, other, area);
        model->spring_start[i] = slot;
        for (uint32_t k = 0; k < count; ++k) {
            if (!bake->moving[i] && !bake->moving[other[k]]) {
                continue;
            }
            float r = v3_distance(position[other[k]], position[i]);
            if (!(r > 1e-6f)) {
                return ris_fail(err, RIS_ERROR_DATA, "edge %u-%u of the skin has no length", i, other[k]);
            }
            ris_half_spring *half = &model->half_spring[slot++];
            half->other = other[k];
            half->rest_mm = r;
            half->area_ratio = area[k] / (r * r);
        }
    }
    model->spring_start[model->node_count] = slot;
    model->half_spring_count = slot;
    model->spring_count = slot / 2;
    return RIS_OK;
}

ris_result ris__bake_springs(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t room = 2 * largest_ring(model);
    uint32_t *other = NULL;
    float *area = NULL;
    ris_result result = ris__model_alloc(&model->spring_start, (size_t)model->node_count + 1,
                                         sizeof *model->spring_start, "springs", err);
    if (result == RIS_OK) { /* each of a node's ring entries gives at most two edges */
        result = ris__model_alloc(&model->half_spring, 6 * (size_t)model->triangle_count,
                                  sizeof *model->half_spring, "springs", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&other, room, sizeof *other, "springs", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&area, room, sizeof *area, "springs", err);
    }
    if (result == RIS_OK) {
        result = fill_springs(bake, other, area, err);
    }
    if (result == RIS_OK) {
        weigh_umbrellas(bake);
        result = ris__list_moving(model, err);
    }
    free(other);
    free(area);
    return result;
}

/* Absolute row sum of the stiffness matrix at rest: springs on the low modulus, umbrellas, anchor
 * (Gershgorin). */
static double row_stiffness(const ris_model *model, const ris_tissue_def *tissue, uint32_t i)
{
    double sum = 0.0, own_out = 0.0;
    double bend = 0.0;
    for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
        const ris_half_spring *half = &model->half_spring[h];
        sum += 2.0 * (double)half->area_ratio * (double)model->push.modulus_low;
        own_out += (double)half->bend_out;
        /* |row of L^T K L| <= sum over umbrellas of K |entry of i| (1 + sum of weights = 2) */
        bend += 2.0 * (double)half->bend_in;
    }
    bend += (double)model->anchor_param[i].bend * (1.0 + own_out);
    double anchor = (double)f_max(model->anchor_param[i].normal, model->anchor_param[i].tangential);
    if (tissue->model == RIS_TISSUE_KAEHLER) {
        anchor = 2.0 * (double)model->anchor_param[i].normal;
    }
    return sum + bend + anchor;
}

ris_result ris__bake_push(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    const bool kaehler = tissue->model == RIS_TISSUE_KAEHLER;
    const float scale = kaehler ? 1.0f : tissue->stiffness_scale;
    ris_sim_push *push = &model->push;
    push->node_count = model->node_count;
    push->flags =
        (kaehler ? RIS_TISSUE_FLAG_KAEHLER : 0u) | (tissue->continuous ? RIS_TISSUE_FLAG_CONTINUOUS : 0u);
    push->dt_s = (float)(1.0 / 60.0 / tissue->substeps);
    push->modulus_low = tissue->modulus[0] * scale;
    push->modulus_high = tissue->modulus[1] * scale;
    push->switch_stretch = tissue->switch_stretch;
    push->compression = kaehler ? 1.0f : tissue->compression;
    push->damping_per_s = kaehler ? tissue->damping_g_s / model->mass_g : tissue->damping_per_s;

    /* (omega dt)^2 + 4 gamma dt / m < 4, for the stiffest node */
    double damping = 4.0 * (double)push->damping_per_s, stable = INFINITY;
    uint32_t worst = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!bake->moving[i]) {
            continue;
        }
        double w = row_stiffness(model, tissue, i) / (double)model->mass_g;
        double dt = w > 0.0         ? (sqrt(damping * damping + 16.0 * w) - damping) / (2.0 * w)
                    : damping > 0.0 ? 4.0 / damping
                                    : INFINITY;
        if (dt < stable) {
            stable = dt;
            worst = i;
        }
    }
    model->stable_dt_s = (float)stable;
    if (!((double)push->dt_s < stable)) {
        return ris_fail(err, RIS_ERROR_DATA,
                        "%u substeps are unstable: dt is %.3f ms, vertex %u allows %.3f ms; at least %.0f "
                        "substeps are needed",
                        tissue->substeps, (double)push->dt_s * 1e3, worst, stable * 1e3,
                        floor(1.0 / 60.0 / stable) + 1.0);
    }
    return RIS_OK;
}
