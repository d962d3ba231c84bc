/* Lips and lids in each other: a vertex of one sheet is inside the other when it lies behind the nearest triangle of
 * that sheet and faces against it. Behind is decided by the pseudonormal of the nearest feature (of a triangle, an edge
 * or, weighted by angles, a vertex: Baerentzen and Aanaes 2005), since the normal of one triangle alone errs at edges. A sheet that is itself crumpled at its end would
 * still lie to its surroundings, so the sheet as a whole is asked too: seen from behind it fills a part of the
 * sphere, with the sign of its faces (solid angle of triangles: Van Oosterom and Strackee 1983). */
#include "measure/measure_impl.h"

#include <stdlib.h>

#define REACH_MM 5.0 /* deeper than this is no lip but another part of the mouth */
#define BEHIND 0.1   /* share of the sphere from which on its sign counts; 0.5 just behind a plane ... */
#define BEHIND_PER_MM 0.06 /* ... and so much more per mm: deep inside a lip it is all around */
#define OPPOSED (-0.3)     /* cosine below which two normals face each other */
#define ON_FEATURE 1e-7    /* barycentric share below which a closest point lies on an edge or vertex */

static bool all_of(const bool *flag, const uint32_t *v)
{
    return flag[v[0]] && flag[v[1]] && flag[v[2]];
}

static uint32_t across(const ris_sheet *sheet, uint32_t a, uint32_t b)
{
    for (uint32_t t = 0; t < sheet->triangle_count; ++t) {
        const uint32_t *v = sheet->triangle + 3 * (size_t)t;
        for (int k = 0; k < 3; ++k) {
            if (v[k] == b && v[(k + 1) % 3] == a) {
                return t;
            }
        }
    }
    return UINT32_MAX;
}

/* Triangles inside the region that are not wholly shared with the other sheet; vertices that are not shared at all. */
static ris_result fill_sheet(ris_sheet *sheet, const ris_model *model, const bool *own, const bool *other,
                             ris_error *err)
{
    ris_result result =
        ris__model_alloc(&sheet->node, model->node_count, sizeof *sheet->node, sheet->name, err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&sheet->border, model->node_count, sizeof *sheet->border, sheet->name, err);
    }
    const size_t corners = 3 * (size_t)model->triangle_count;
    if (result == RIS_OK) {
        result = ris__model_alloc(&sheet->triangle, corners, sizeof *sheet->triangle, sheet->name, err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&sheet->neighbor, corners, sizeof *sheet->neighbor, sheet->name, err);
    }
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (own[i] && !other[i]) {
            sheet->node[sheet->node_count++] = i;
        }
    }
    for (size_t i = 0; i < corners; i += 3) {
        const uint32_t *v = model->triangle + i;
        if (all_of(own, v) && !all_of(other, v)) {
            for (int k = 0; k < 3; ++k) {
                sheet->triangle[3 * (size_t)sheet->triangle_count + k] = v[k];
            }
            ++sheet->triangle_count;
        }
    }
    for (uint32_t t = 0; t < sheet->triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = sheet->triangle[3 * (size_t)t + k],
                           b = sheet->triangle[3 * (size_t)t + (k + 1) % 3];
            const uint32_t neighbor = across(sheet, a, b);
            sheet->neighbor[3 * (size_t)t + k] = neighbor;
            if (neighbor == UINT32_MAX) {
                sheet->border[a] = sheet->border[b] = true;
            }
        }
    }
    return RIS_OK;
}

void ris__sheets_finish(ris_sheet_pair *pair)
{
    for (int s = 0; s < 2; ++s) {
        free(pair->sheet[s].node);
        free(pair->sheet[s].triangle);
        free(pair->sheet[s].neighbor);
        free(pair->sheet[s].border);
        free(pair->rest_mm[s]);
    }
    *pair = (ris_sheet_pair){0};
}

static double angle_at(const tri_mesh *mesh, const uint32_t *v, int k)
{
    const dvec p = mesh->position[v[k]];
    const dvec a = dv_unit(dv_sub(mesh->position[v[(k + 1) % 3]], p));
    const dvec b = dv_unit(dv_sub(mesh->position[v[(k + 2) % 3]], p));
    return acos(fmin(fmax(dv_dot(a, b), -1), 1));
}

/* Area of the triangle a, b, q along n; over that of the whole triangle it is the share of the third corner. */
static double part_area(dvec a, dvec b, dvec q, dvec n)
{
    return dv_dot(dv_cross(dv_sub(a, q), dv_sub(b, q)), n);
}

/* The pseudonormal at a closest point; false on the border of the sheet, where there is no behind. */
static bool pseudonormal(const ris_sheet *sheet, const tri_mesh *mesh, const bvh_hit *hit, dvec *out)
{
    const uint32_t *v = mesh->triangle + 3 * (size_t)hit->triangle;
    const dvec n = ris__tri_normal(mesh, hit->triangle), *x = mesh->position;
    const double whole = part_area(x[v[1]], x[v[2]], x[v[0]], n);
    int zero = 0, edge = 0, corner = 0;
    for (int k = 0; k < 3; ++k) {
        const double share = part_area(x[v[(k + 1) % 3]], x[v[(k + 2) % 3]], hit->at, n) / whole;
        if (fabs(share) < ON_FEATURE) {
            ++zero;
            edge = (k + 1) % 3; /* the edge facing corner k */
        } else {
            corner = k;
        }
    }
    *out = n;
    if (zero == 1) {
        const uint32_t other = sheet->neighbor[3 * (size_t)hit->triangle + edge];
        if (other == UINT32_MAX) {
            return false;
        }
        *out = dv_add(n, ris__tri_normal(mesh, other));
    } else if (zero >= 2) {
        if (sheet->border[v[corner]]) {
            return false;
        }
        *out = dv(0, 0, 0);
        for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
            const uint32_t *w = mesh->triangle + 3 * (size_t)t;
            for (int k = 0; k < 3; ++k) {
                if (w[k] == v[corner]) {
                    *out = dv_mad(*out, angle_at(mesh, w, k), ris__tri_normal(mesh, t));
                }
            }
        }
    }
    return true;
}

/* Signed share of the sphere that a mesh fills from p, positive from behind. */
static double share_of_sphere(const tri_mesh *mesh, dvec p)
{
    double sum = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t *v = mesh->triangle + 3 * (size_t)t;
        const dvec a = dv_sub(mesh->position[v[0]], p), b = dv_sub(mesh->position[v[1]], p),
                   c = dv_sub(mesh->position[v[2]], p);
        const double la = dv_length(a), lb = dv_length(b), lc = dv_length(c);
        const double below = ((la * lb) * lc + dv_dot(a, b) * lc) + (dv_dot(b, c) * la + dv_dot(c, a) * lb);
        sum += 2 * atan2(dv_dot(a, dv_cross(b, c)), below);
    }
    return sum / (4 * 3.14159265358979323846);
}

/* How deep a vertex with this normal lies in the sheet, or 0. */
static double depth_in(const ris_sheet *sheet, const bvh *tree, dvec p, dvec normal)
{
    dvec n;
    const bvh_hit hit = ris__bvh_closest(tree, p);
    if (!hit.found || hit.distance > REACH_MM || !pseudonormal(sheet, tree->mesh, &hit, &n)) {
        return 0;
    }
    const bool behind = dv_dot(dv_sub(p, hit.at), n) < 0 && dv_dot(dv_unit(normal), dv_unit(n)) < OPPOSED;
    if (!behind || share_of_sphere(tree->mesh, p) < BEHIND + BEHIND_PER_MM * hit.distance) {
        return 0;
    }
    return hit.distance;
}

/* Depth of every node of sheet s in the other (node_count of the sheet). */
static ris_result depths(const ris_sheet_pair *pair, int s, dvec *position, const dvec *normal, double *out,
                         ris_error *err)
{
    const ris_sheet *own = &pair->sheet[s], *other = &pair->sheet[1 - s];
    const tri_mesh mesh = {
        .triangle_count = other->triangle_count, .position = position, .triangle = other->triangle};
    bvh tree;
    ris_result result = ris__bvh_build(&tree, &mesh, err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t k = 0; k < own->node_count; ++k) {
        const uint32_t i = own->node[k];
        out[k] = depth_in(other, &tree, position[i], normal[i]);
    }
    ris__bvh_finish(&tree);
    return RIS_OK;
}

static ris_result build_sheets(ris_sheet_pair *out, const ris_model *model, const char *const name[2],
                               ris_error *err)
{
    bool *flag[2] = {NULL, NULL};
    ris_result result = RIS_OK;
    for (int s = 0; result == RIS_OK && s < 2; ++s) {
        out->sheet[s].name = name[s];
        result = ris__model_alloc(&flag[s], model->node_count, sizeof *flag[s], name[s], err);
        if (result == RIS_OK) {
            ris__region_flags(model->head, name[s], flag[s]);
        }
    }
    for (int s = 0; result == RIS_OK && s < 2; ++s) {
        result = fill_sheet(&out->sheet[s], model, flag[s], flag[1 - s], err);
    }
    free(flag[0]);
    free(flag[1]);
    return result;
}

ris_result ris__sheets_init(ris_sheet_pair *out, const ris_model *model, const char *upper, const char *lower,
                            dvec *rest, const dvec *normal, ris_error *err)
{
    const char *const name[2] = {upper, lower};
    if (!ris_head_region(model->head, upper) || !ris_head_region(model->head, lower)) {
        return RIS_OK;
    }
    ris_result result = build_sheets(out, model, name, err);
    for (int s = 0; result == RIS_OK && s < 2; ++s) {
        result = ris__model_alloc(&out->rest_mm[s], out->sheet[s].node_count, sizeof *out->rest_mm[s],
                                  name[s], err);
        if (result == RIS_OK) {
            result = depths(out, s, rest, normal, out->rest_mm[s], err);
        }
    }
    return result;
}

static void note(const ris_sheet_pair *pair, int s, uint32_t k, double depth, ris_finding *out)
{
    out->count += depth > 0;
    if (depth > out->value) {
        *out = (ris_finding){.value = depth,
                             .count = out->count,
                             .vertex_count = 1,
                             .vertex = {pair->sheet[s].node[k]},
                             .part = pair->sheet[1 - s].name};
    }
}

ris_result ris__sheets_measure(const ris_sheet_pair *pair, dvec *position, const dvec *normal,
                               ris_finding *out, float *worst, ris_error *err)
{
    for (int s = 0; s < 2; ++s) {
        double *depth = NULL;
        const uint32_t count = pair->sheet[s].node_count;
        ris_result result = ris__model_alloc(&depth, count, sizeof *depth, "the depths of lips", err);
        if (result == RIS_OK) {
            result = depths(pair, s, position, normal, depth, err);
        }
        for (uint32_t k = 0; result == RIS_OK && k < count; ++k) {
            const double beyond = depth[k] - pair->rest_mm[s][k];
            note(pair, s, k, beyond, out);
            if (worst) {
                float *at = &worst[pair->sheet[s].node[k]];
                *at = fmaxf(*at, (float)beyond);
            }
        }
        free(depth);
        if (result != RIS_OK) {
            return result;
        }
    }
    return RIS_OK;
}

void ris__sheets_rest(const ris_sheet_pair *pair, ris_finding *out)
{
    for (int s = 0; s < 2; ++s) {
        for (uint32_t k = 0; k < pair->sheet[s].node_count; ++k) {
            note(pair, s, k, pair->rest_mm[s][k], out);
        }
    }
}
