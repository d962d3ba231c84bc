/* A simulated expression against a sculpted one. All in double, in the order of the nodes. */
#include "measure/score.h"
#include "asset/target.h"
#include "measure/measure_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STILL_MM 0.3 /* below this the sculpt counts as not moving */

static dvec of_vec3(ris_vec3 p)
{
    return dv((double)p.x, (double)p.y, (double)p.z);
}

/* Each face as a fan from its first corner. */
static void add_areas(const ris_mesh *skin, const ris_vec4 *position, double *area)
{
    for (uint32_t f = 0; f < skin->face_count; f++) {
        const uint32_t *corner = skin->face_vertex + skin->face_start[f];
        const uint32_t count = skin->face_start[f + 1] - skin->face_start[f];
        const dvec a = dv_of(position[corner[0]]);
        for (uint32_t k = 1; k + 1 < count; k++) {
            const dvec b = dv_sub(dv_of(position[corner[k]]), a),
                       c = dv_sub(dv_of(position[corner[k + 1]]), a);
            const double third = dv_length(dv_cross(b, c)) / 6.0;
            area[corner[0]] += third;
            area[corner[k]] += third;
            area[corner[k + 1]] += third;
        }
    }
}

/* Root mean square distance from the centroid. of_base: the points are those of the base mesh. */
static double spread(const ris_scorer *s, const ris_mesh *base)
{
    dvec centre = {0};
    double sum = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t k = 0; k < s->used_count; k++) {
            const uint32_t i = s->node[k];
            const dvec p =
                base ? of_vec3(base->position[s->model->head->base_vertex[i]]) : dv_of(s->neutral[i]);
            if (pass == 0) {
                centre = dv_mad(centre, 1.0 / s->used_count, p);
            } else {
                const dvec d = dv_sub(p, centre);
                sum += dv_dot(d, d);
            }
        }
    }
    return sqrt(sum / s->used_count);
}

static ris_result collect_nodes(ris_scorer *s, ris_error *err)
{
    const ris_head *head = s->model->head;
    const char *directory = head->directory ? head->directory : "the head";
    if (!head->base_vertex) {
        return ris_fail(err, RIS_ERROR_DATA, "%s: expected a head with a skin.map, found none", directory);
    }
    for (uint32_t i = 0; i < s->model->node_count; i++) {
        if (head->base_vertex[i] >= (int64_t)s->base_count) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "%s: skin.map:%u:1: expected a vertex of the base mesh, 0 to %u, found %d",
                            directory, i + 1, s->base_count - 1, head->base_vertex[i]);
        }
        if (head->base_vertex[i] >= 0) {
            s->node[s->used_count++] = i;
        }
    }
    if (s->used_count == 0) {
        return ris_fail(err, RIS_ERROR_DATA, "%s: expected a skin.map with base vertices, found only -1",
                        directory);
    }
    return RIS_OK;
}

ris_result ris__scorer_create(const ris_model *model, const ris_mesh *base, const ris_vec4 *neutral,
                              ris_scorer *out, ris_error *err)
{
    const uint32_t n = model->node_count;
    *out = (ris_scorer){.model = model,
                        .node = malloc((n + 1u) * sizeof *out->node),
                        .area = calloc(n + 1u, sizeof *out->area),
                        .neutral = malloc((n + 1u) * sizeof *out->neutral),
                        .base_count = base->vertex_count};
    ris_result r = out->node && out->area && out->neutral
                       ? RIS_OK
                       : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", n);
    if (!r) {
        r = collect_nodes(out, err);
    }
    if (!r) {
        memcpy(out->neutral, neutral, n * sizeof *neutral);
        add_areas(&model->head->skin, neutral, out->area);
        out->mm = spread(out, base) / spread(out, NULL) * RIS_MM_PER_BASE_UNIT;
        if (!isfinite(out->mm)) {
            r = ris_fail(err, RIS_ERROR_DATA, "expected mapped vertices at more than one place, found one");
        }
    }
    if (r) {
        ris__scorer_finish(out);
    }
    return r;
}

void ris__scorer_finish(ris_scorer *scorer)
{
    free(scorer->node);
    free(scorer->area);
    free(scorer->neutral);
    *scorer = (ris_scorer){0};
}

ris_result ris__score_pose(const ris_scorer *s, const double *sculpt, const ris_vec4 *position,
                           ris_score *out, ris_error *err)
{
    double ss = 0, uu = 0, su = 0, far = 0, rest = 0, s_max = 0, u_max = 0;
    for (uint32_t k = 0; k < s->used_count; k++) {
        const uint32_t i = s->node[k];
        const double *d = sculpt + (size_t)3 * (uint32_t)s->model->head->base_vertex[i];
        const dvec v = dv_mad(dv(0, 0, 0), s->mm, dv_sub(dv_of(position[i]), dv_of(s->neutral[i]))),
                   u = dv_mad(dv(0, 0, 0), RIS_MM_PER_BASE_UNIT, dv(d[0], d[1], d[2])), off = dv_sub(v, u);
        const double v2 = dv_dot(v, v), u2 = dv_dot(u, u), w = s->area[i];
        if (!isfinite(v2)) {
            return ris_fail(err, RIS_ERROR_FAILED, "vertex %u is not finite", i);
        }
        ss += w * v2;
        uu += w * u2;
        su += w * dv_dot(v, u);
        rest += w * dv_dot(off, off);
        far += u2 < STILL_MM * STILL_MM ? w * v2 : 0;
        s_max = fmax(s_max, v2);
        u_max = fmax(u_max, u2);
    }
    if (uu == 0) {
        return ris_fail(err, RIS_ERROR_DATA,
                        "expected a sculpt that moves the skin, found one that moves no mapped vertex");
    }
    const double cosine = ss > 0 ? su / sqrt(ss * uu) : 0;
    *out = (ris_score){.cos = cosine,
                       .gain = sqrt(ss / uu),
                       .r2 = 1 - rest / uu,
                       .r2fit = cosine > 0 ? cosine * cosine : 0,
                       .far = ss > 0 ? far / ss : 0,
                       .simulated_mm = sqrt(s_max),
                       .sculpted_mm = sqrt(u_max)};
    return RIS_OK;
}
