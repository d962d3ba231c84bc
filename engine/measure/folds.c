/* Triangles turned over. A surface in space has no inverted elements as a plane has, so the neighbours are asked: a
 * triangle is turned over when its normal points against the area-weighted mean of the normals of the triangles that
 * share a vertex with it (not its own), and the cosine between the two has fallen by more than a half since rest, so that
 * one which stands upright among its neighbours is not called turned over for leaning by a degree. The mean is local, so a lip may roll and a lid may turn
 * as a whole; it is taken of several triangles, so a crease between two flat flanks is none until a flank folds back;
 * and a triangle cannot vouch for itself, however large it has grown. */
#include "measure/measure_impl.h"

#include <stdlib.h>

#define FALL 0.5 /* of the cosine since rest */

enum { STILL, LIPS_AND_LIDS, OTHERS };

/* A triangle that touches a lip or a lid with any vertex is one of theirs. */
static ris_result sort_triangles(ris_folds *folds, const bool *moving, ris_error *err)
{
    const ris_model *model = folds->model;
    bool *soft = NULL;
    ris_result result = ris__model_alloc(&folds->kind, model->triangle_count, 1, "the triangles", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&soft, model->node_count, sizeof *soft, "the lips and lids", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    static const char *const region[] = {"lips",        "lip_upper",   "lip_lower",   "inner_lip_rim", "lids",
                                         "lid_upper.L", "lid_upper.R", "lid_lower.L", "lid_lower.R"};
    for (size_t k = 0; k < sizeof region / sizeof *region; ++k) {
        ris__region_flags(model->head, region[k], soft);
    }
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        if (moving[v[0]] || moving[v[1]] || moving[v[2]]) {
            folds->kind[t] = soft[v[0]] || soft[v[1]] || soft[v[2]] ? LIPS_AND_LIDS : OTHERS;
            ++folds->tested[folds->kind[t] - 1];
        }
    }
    free(soft);
    return RIS_OK;
}

/* Triangles of each vertex, CSR: start (node_count + 1) and list, freed by the caller. */
static ris_result list_fans(const ris_model *model, uint32_t **out_start, uint32_t **out_list, ris_error *err)
{
    const size_t corners = 3 * (size_t)model->triangle_count;
    uint32_t *start = NULL, *list = NULL;
    ris_result result =
        ris__model_alloc(&start, (size_t)model->node_count + 2, sizeof *start, "the fans", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&list, corners, sizeof *list, "the fans", err);
    }
    *out_start = start;
    *out_list = list;
    if (result != RIS_OK) {
        return result;
    }
    for (size_t i = 0; i < corners; ++i) {
        ++start[model->triangle[i] + 2];
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        start[i + 2] += start[i + 1];
    }
    for (size_t i = 0; i < corners; ++i) {
        list[start[model->triangle[i] + 1]++] = (uint32_t)(i / 3);
    }
    return RIS_OK;
}

static ris_result find_around(ris_folds *folds, ris_error *err)
{
    const ris_model *model = folds->model;
    uint32_t *start = NULL, *list = NULL;
    ris_result result = list_fans(model, &start, &list, err);
    size_t room = 0;
    for (uint32_t t = 0; result == RIS_OK && t < model->triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t v = model->triangle[3 * (size_t)t + k];
            room += start[v + 1] - start[v];
        }
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&folds->around_start, (size_t)model->triangle_count + 1,
                                  sizeof *folds->around_start, "the neighbours", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&folds->around, room, sizeof *folds->around, "the neighbours", err);
    }
    for (uint32_t t = 0; result == RIS_OK && t < model->triangle_count; ++t) {
        const uint32_t first = folds->around_start[t];
        uint32_t end = first;
        for (int k = 0; k < 3; ++k) {
            const uint32_t v = model->triangle[3 * (size_t)t + k];
            for (uint32_t i = start[v]; i < start[v + 1]; ++i) {
                bool known = list[i] == t;
                for (uint32_t j = first; j < end && !known; ++j) {
                    known = folds->around[j] == list[i];
                }
                if (!known) {
                    folds->around[end++] = list[i];
                }
            }
        }
        folds->around_start[t + 1] = end;
    }
    free(start);
    free(list);
    return result;
}

/* Cosine between the triangle's normal and the mean around it; 1 where that means nothing. */
static double agreement(const ris_folds *folds, const dvec *area, uint32_t t)
{
    dvec sum = dv(0, 0, 0);
    for (uint32_t i = folds->around_start[t]; i < folds->around_start[t + 1]; ++i) {
        sum = dv_add(sum, area[folds->around[i]]);
    }
    const double product = dv_length(sum) * dv_length(area[t]);
    return product > 0 ? dv_dot(sum, area[t]) / product : 1;
}

static void note(const ris_folds *folds, uint32_t t, double cosine, double worst[2], ris_finding out[2])
{
    const int which = folds->kind[t] - 1;
    out[which].value = ++out[which].count;
    if (cosine < worst[which]) {
        worst[which] = cosine;
        out[which].vertex_count = 3;
        for (int k = 0; k < 3; ++k) {
            out[which].vertex[k] = folds->model->triangle[3 * (size_t)t + k];
        }
    }
}

ris_result ris__folds_init(ris_folds *out, const ris_model *model, const bool *moving, const dvec *area,
                           ris_error *err)
{
    out->model = model;
    ris_result result = sort_triangles(out, moving, err);
    if (result == RIS_OK) {
        result = find_around(out, err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&out->rest, model->triangle_count, sizeof *out->rest, "the triangles", err);
    }
    for (uint32_t t = 0; result == RIS_OK && t < model->triangle_count; ++t) {
        out->rest[t] = agreement(out, area, t);
    }
    return result;
}

void ris__folds_finish(ris_folds *folds)
{
    free(folds->kind);
    free(folds->around_start);
    free(folds->around);
    free(folds->rest);
    *folds = (ris_folds){0};
}

void ris__folds_measure(const ris_folds *folds, const dvec *area, ris_finding out[2], uint32_t *flipped)
{
    double worst[2] = {0, 0};
    for (uint32_t t = 0; t < folds->model->triangle_count; ++t) {
        const double cosine = folds->kind[t] ? agreement(folds, area, t) : 1;
        if (cosine < 0 && cosine < folds->rest[t] - FALL) {
            note(folds, t, cosine, worst, out);
            if (flipped) {
                ++flipped[t];
            }
        }
    }
}

void ris__folds_rest(const ris_folds *folds, ris_finding out[2])
{
    double worst[2] = {0, 0};
    for (uint32_t t = 0; t < folds->model->triangle_count; ++t) {
        if (folds->kind[t] && folds->rest[t] < 0) {
            note(folds, t, folds->rest[t], worst, out);
        }
    }
}
