/* KA-14, KA-15 and the anchors of the default tissue (docs/physics.md): one anchor on every moving
 * node, its stiffness by region, smoothed over region borders and in proportion to the node's area. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>
#include <string.h>

#define BONE_RAY_MM 15.0 /* bone deeper than this below a vertex is not the one it glides on (errata 28) */
#define MIDDLE_MM 1e-3f
#define PLANE_STEPS 12
#define AREA_UNIT_MM2 25.0f
#define SMOOTHING_PASSES 2
#define HEFT_MM 10.0f /* tissue of this thickness has heft 1 */

/* Sets (or, for "muscle", blends in) the stiffness of one record. */
static ris_result apply_region(const ris_bake *bake, const ris_anchor_region *record, float *normal,
                               float *tangential, ris_error *err)
{
    const uint32_t n = bake->model->node_count;
    if (strcmp(record->region, "bone") == 0) {
        for (uint32_t i = 0; i < n; ++i) {
            normal[i] = record->normal;
            tangential[i] = record->tangential;
        }
        return RIS_OK;
    }
    if (strcmp(record->region, "muscle") == 0) {
        for (uint32_t i = 0; i < n; ++i) {
            normal[i] += bake->muscle_weight[i] * (record->normal - normal[i]);
            tangential[i] += bake->muscle_weight[i] * (record->tangential - tangential[i]);
        }
        return RIS_OK;
    }
    bool *flags = NULL;
    ris_result result = ris__model_alloc(&flags, n, sizeof *flags, "anchors", err);
    if (result == RIS_OK) { /* a head need not have every region of the default tissue */
        ris__region_flags(bake->head, record->region, flags);
    }
    for (uint32_t i = 0; result == RIS_OK && i < n; ++i) {
        normal[i] = flags[i] ? record->normal : normal[i];
        tangential[i] = flags[i] ? record->tangential : tangential[i];
    }
    free(flags);
    return result;
}

static void smooth(const ris_model *model, float *value, float *scratch)
{
    for (uint32_t pass = 0; pass < SMOOTHING_PASSES; ++pass) {
        memcpy(scratch, value, model->node_count * sizeof *value);
        for (uint32_t i = 0; i < model->node_count; ++i) {
            uint32_t first = model->spring_start[i], end = model->spring_start[i + 1];
            float sum = 0.0f;
            for (uint32_t h = first; h < end; ++h) {
                sum += scratch[model->half_spring[h].other];
            }
            if (end > first) {
                value[i] = 0.5f * scratch[i] + 0.5f * sum / (float)(end - first);
            }
        }
    }
}

/* How far the stiffness of an anchor and the weight of what it holds go with the area of the node. */
static float area_share(const ris_model *model, uint32_t i)
{
    return f_clamp(model->node_area_mm2[i] / AREA_UNIT_MM2, 0.05f, 4.0f);
}

static ris_result fill_default(ris_bake *bake, float *normal, float *tangential, float *scratch,
                               ris_error *err)
{
    ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    for (uint32_t k = 0; k < tissue->anchor_region_count; ++k) {
        ris_result result = apply_region(bake, &tissue->anchor_region[k], normal, tangential, err);
        if (result != RIS_OK) {
            return result;
        }
    }
    smooth(model, normal, scratch);
    smooth(model, tangential, scratch);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!bake->moving[i]) {
            continue;
        }
        const float scale = area_share(model, i) * tissue->stiffness_scale;
        ris_anchor_param *param = &model->anchor_param[i];
        param->normal = normal[i] * scale;
        param->tangential = tangential[i] * scale;
        param->bend = ris__bend_stiffness(bake, i);
        const float thick = bake->head->depth_mm[i] / HEFT_MM;
        model->heft[i] = area_share(model, i) * f_clamp(thick * thick, 0.04f, 2.0f);
        if (!(param->normal >= 0.0f) || !(param->tangential >= 0.0f)) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "anchor stiffness of vertex %u is %g, %g, expected 0 or more", i,
                            (double)param->normal, (double)param->tangential);
        }
    }
    return RIS_OK;
}

/* A bone as triangles; a head made in code has none. */
typedef struct bone_surface {
    tri_mesh mesh;
    bvh tree;
} bone_surface;

static ris_result open_bone(const ris_mesh *mesh, const char *name, bone_surface *out, ris_error *err)
{
    ris_result result = RIS_OK;
    if (mesh->face_count > 0) {
        result = ris__tri_from_mesh(mesh, name, &out->mesh, err);
        if (result == RIS_OK) {
            result = ris__bvh_build(&out->tree, &out->mesh, err);
        }
    }
    return result;
}

static void close_bone(bone_surface *bone)
{
    ris__bvh_finish(&bone->tree);
    ris__tri_finish(&bone->mesh);
}

/* A vertex of the middle plane must not choose a side: to the surface and back to the plane until both meet. */
static dvec closest_in_plane(const bone_surface *bone, dvec at)
{
    for (int step = 0; step < PLANE_STEPS; ++step) {
        at = ris__bvh_closest(&bone->tree, dv(0.0, at.y, at.z)).at;
    }
    return at;
}

/* Straight below the vertex if there is bone, else the closest point of the bone. */
static ris_vec3 point_on_bone(const bone_surface *bone, ris_vec3 x, ris_vec3 normal)
{
    const bool middle = fabsf(x.x) < MIDDLE_MM;
    normal.x = middle ? 0.0f : normal.x;
    const dvec at = dv((double)x.x, (double)x.y, (double)x.z),
               down = dv_unit(dv(-(double)normal.x, -(double)normal.y, -(double)normal.z));
    bvh_hit hit = ris__bvh_ray(&bone->tree, at, down, 0.0, BONE_RAY_MM);
    if (!hit.found) {
        hit = ris__bvh_closest(&bone->tree, at);
        hit.at = middle ? closest_in_plane(bone, hit.at) : hit.at;
    }
    return v3((float)hit.at.x, (float)hit.at.y, (float)hit.at.z);
}

/* KA-14: the point on skull or mandible under each node; by the tissue depth where the head has no such bone. */
static ris_result find_bone_anchors(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    bone_surface bones[2] = {{{0}, {0}}, {{0}, {0}}};
    ris_result result = open_bone(&bake->head->skull, "skull", &bones[0], err);
    if (result == RIS_OK) {
        result = open_bone(&bake->head->mandible, "mandible", &bones[1], err);
    }
    for (uint32_t i = 0; result == RIS_OK && i < model->node_count; ++i) {
        const bone_surface *bone = &bones[bake->head->jaw_weight[i] > 0.5f];
        const ris_vec3 x = v4_xyz(model->rest_position[i]), n = v4_xyz(model->rest_normal[i]);
        model->bone_anchor[i] = bone->mesh.triangle_count > 0 ? point_on_bone(bone, x, n)
                                                              : v3_mad(x, -bake->head->depth_mm[i], n);
    }
    close_bone(&bones[0]);
    close_bone(&bones[1]);
    return result;
}

/* The thesis: a spring pair of one stiffness, on the muscle if one is near, else on the bone. */
static ris_result fill_kaehler(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const ris_tissue_def *tissue = &bake->head->tissue;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!bake->moving[i]) {
            continue;
        }
        const bool on_muscle = model->binding_start[i + 1] > model->binding_start[i];
        const ris_vec3 a = ris__anchor_at_rest(model, i);
        ris_anchor_param *param = &model->anchor_param[i];
        param->normal = on_muscle ? tissue->muscle_anchor : tissue->bone_anchor;
        param->rest_mm = v3_length(v3_sub(a, v4_xyz(model->rest_position[i])));
        if (!(param->rest_mm > 0.0f)) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "vertex %u has neither a muscle nor a depth to the bone: nothing holds it", i);
        }
    }
    return RIS_OK;
}

ris_result ris__bake_anchors(ris_bake *bake, ris_error *err)
{
    ris_model *model = bake->model;
    const uint32_t n = model->node_count;
    float *values = NULL;
    ris_result result = ris__model_alloc(&model->bone_anchor, n, sizeof *model->bone_anchor, "anchors", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->anchor_param, n, sizeof *model->anchor_param, "anchors", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&model->heft, n, sizeof *model->heft, "anchors", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&values, 3 * (size_t)n, sizeof *values, "anchors", err);
    }
    if (result == RIS_OK) {
        result = find_bone_anchors(bake, err);
    }
    if (result == RIS_OK) {
        result = bake->head->tissue.model == RIS_TISSUE_KAEHLER
                     ? fill_kaehler(bake, err)
                     : fill_default(bake, values, values + n, values + 2 * (size_t)n, err);
    }
    free(values);
    return result;
}
