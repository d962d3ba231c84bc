/* Depth of moving skin in bones, teeth and eyes (KA-04, KA-06): the point goes into the bone's rest frame, rays say
 * whether it is inside, the closest point how deep. */
#include "measure/measure_impl.h"

#include <stdlib.h>
#include <string.h>

static int compare_pairs(const void *left, const void *right)
{
    const uint32_t *x = left, *y = right;
    if (x[0] != y[0]) {
        return x[0] < y[0] ? -1 : 1;
    }
    return (x[1] > y[1]) - (x[1] < y[1]);
}

/* Moving vertices, then the edges of triangles with a moving end, each once. */
static ris_result find_points(ris_penetration *pen, const ris_model *model, const bool *moving,
                              ris_error *err)
{
    const size_t corners = 3 * (size_t)model->triangle_count;
    ris_result result = ris__model_alloc(&pen->end, model->node_count + corners, sizeof *pen->end,
                                         "the points to measure", err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (moving[i]) {
            pen->end[pen->point_count][0] = pen->end[pen->point_count][1] = i;
            ++pen->point_count;
        }
    }
    pen->vertex_count = pen->point_count;
    uint32_t(*edge)[2] = pen->end + pen->vertex_count;
    size_t count = 0;
    for (size_t i = 0; i < corners; ++i) {
        const uint32_t a = model->triangle[i], b = model->triangle[i % 3 == 2 ? i - 2 : i + 1];
        if (moving[a] || moving[b]) {
            edge[count][0] = a < b ? a : b;
            edge[count++][1] = a < b ? b : a;
        }
    }
    qsort(edge, count, sizeof *edge, compare_pairs);
    for (size_t i = 0; i < count; ++i) {
        if (i == 0 || compare_pairs(edge[i], edge[i - 1]) != 0) {
            memmove(pen->end[pen->point_count++], edge[i], sizeof *edge);
        }
    }
    return RIS_OK;
}

static ris_result add_mesh(ris_penetration *pen, ris_measure measure, ris_bone bone, const ris_mesh *mesh,
                           const dvec *apex, const char *name, ris_error *err)
{
    ris_body *body = NULL;
    for (uint32_t k = 0; k < pen->body_count && !body; ++k) {
        if (pen->body[k].measure == measure && pen->body[k].bone == bone) {
            body = &pen->body[k];
        }
    }
    if (!body && pen->body_count < RIS_BODY_MAX) {
        body = &pen->body[pen->body_count++];
        body->measure = measure;
        body->bone = bone;
    }
    if (!body || body->solids.source_count == sizeof body->part / sizeof *body->part) {
        return ris_fail(err, RIS_ERROR_DATA, "%s: too many parts of one kind to measure", name);
    }
    body->part[body->solids.source_count] = name;
    return ris__solids_add(&body->solids, mesh, apex, name, err);
}

static ris_result add_part(ris_penetration *pen, const ris_part_def *part, ris_error *err)
{
    const bool eye = part->bone == RIS_BONE_EYE_L || part->bone == RIS_BONE_EYE_R;
    const dvec pivot = dv((double)part->pivot.x, (double)part->pivot.y, (double)part->pivot.z);
    if (part->material == RIS_MATERIAL_TEETH && part->bone == RIS_BONE_SKULL) {
        return add_mesh(pen, RIS_MEASURE_UPPER_TEETH, part->bone, &part->mesh, NULL, part->name, err);
    }
    if (part->material == RIS_MATERIAL_TEETH && part->bone == RIS_BONE_JAW) {
        return add_mesh(pen, RIS_MEASURE_LOWER_TEETH, part->bone, &part->mesh, NULL, part->name, err);
    }
    if (part->material == RIS_MATERIAL_EYE && eye) {
        return add_mesh(pen, RIS_MEASURE_EYES, part->bone, &part->mesh, NULL, part->name, err);
    }
    if (part->material == RIS_MATERIAL_CORNEA && eye) {
        return add_mesh(pen, RIS_MEASURE_EYES, part->bone, &part->mesh, &pivot, part->name, err);
    }
    return RIS_OK;
}

static dvec point_at(const ris_penetration *pen, uint32_t point, const ris_vec4 *position)
{
    const dvec a = dv_of(position[pen->end[point][0]]), b = dv_of(position[pen->end[point][1]]);
    return dv(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z));
}

static ris_result find_rest(ris_penetration *pen, const ris_model *model, ris_error *err)
{
    for (uint32_t k = 0; k < pen->body_count; ++k) {
        ris_body *body = &pen->body[k];
        ris_result result = ris__model_alloc(&body->rest_mm, pen->point_count, sizeof *body->rest_mm,
                                             "the depths at rest", err);
        if (result != RIS_OK) {
            return result;
        }
        for (uint32_t i = 0; i < pen->point_count; ++i) {
            const dvec p = point_at(pen, i, model->rest_position);
            uint32_t solid;
            const double depth = ris__solids_depth(&body->solids, p, &solid);
            body->rest_mm[i] = depth > 0 ? depth : -ris__solids_clearance(&body->solids, p);
        }
    }
    return RIS_OK;
}

ris_result ris__penetration_init(ris_penetration *out, const ris_model *model, const bool *moving,
                                 ris_error *err)
{
    const ris_head *head = model->head;
    out->rest_position = model->rest_position;
    out->node_count = model->node_count;
    ris_result result = find_points(out, model, moving, err);
    if (result == RIS_OK && head->skull.vertex_count) {
        result = add_mesh(out, RIS_MEASURE_SKULL, RIS_BONE_SKULL, &head->skull, NULL, "skull", err);
    }
    if (result == RIS_OK && head->mandible.vertex_count) {
        result = add_mesh(out, RIS_MEASURE_MANDIBLE, RIS_BONE_JAW, &head->mandible, NULL, "mandible", err);
    }
    for (uint32_t k = 0; result == RIS_OK && k < head->part_count; ++k) {
        result = add_part(out, &head->part[k], err);
    }
    return result == RIS_OK ? find_rest(out, model, err) : result;
}

void ris__penetration_finish(ris_penetration *pen)
{
    for (uint32_t k = 0; k < pen->body_count; ++k) {
        ris__solids_finish(&pen->body[k].solids);
        free(pen->body[k].rest_mm);
    }
    free(pen->end);
    *pen = (ris_penetration){0};
}

/* Into the frame in which the bone is at rest: transposed rotation of what is left without the translation. */
static dvec into_frame(const float m[12], dvec p)
{
    const dvec d = dv(p.x - (double)m[3], p.y - (double)m[7], p.z - (double)m[11]);
    return dv(((double)m[0] * d.x + (double)m[4] * d.y) + (double)m[8] * d.z,
              ((double)m[1] * d.x + (double)m[5] * d.y) + (double)m[9] * d.z,
              ((double)m[2] * d.x + (double)m[6] * d.y) + (double)m[10] * d.z);
}

static void note(const ris_penetration *pen, const ris_body *body, uint32_t point, uint32_t solid,
                 double depth, ris_finding *out)
{
    ris_finding *finding = &out[body->measure + (point < pen->vertex_count ? 0 : 1)];
    finding->count += depth > 0;
    if (depth <= finding->value) {
        return;
    }
    const uint32_t source = body->solids.solid[solid].source;
    uint32_t first = solid, last = solid;
    while (first > 0 && body->solids.solid[first - 1].source == source) {
        --first;
    }
    while (last + 1 < body->solids.count && body->solids.solid[last + 1].source == source) {
        ++last;
    }
    *finding = (ris_finding){.value = depth,
                             .count = finding->count,
                             .vertex_count = point < pen->vertex_count ? 1 : 2,
                             .vertex = {pen->end[point][0], pen->end[point][1]},
                             .part = body->part[source],
                             .piece = first < last ? solid - first + 1 : 0};
}

void ris__penetration_measure(const ris_penetration *pen, const ris_vec4 *position,
                              const ris_bone_frames *frames, ris_finding *out, ris_measure_trace *trace)
{
    for (uint32_t k = 0; k < pen->body_count; ++k) {
        const ris_body *body = &pen->body[k];
        const float *frame = body->bone == RIS_BONE_SKULL ? NULL : frames->bone[body->bone];
        for (uint32_t i = 0; i < pen->point_count; ++i) {
            dvec p = point_at(pen, i, position);
            p = frame ? into_frame(frame, p) : p;
            const double rest = body->rest_mm[i];
            const double moved = dv_length(dv_sub(p, point_at(pen, i, pen->rest_position)));
            uint32_t solid = 0;
            if (moved < -rest) {
                continue; /* outside, and it did not move by its clearance: still outside */
            }
            const double depth = ris__solids_depth(&body->solids, p, &solid);
            note(pen, body, i, solid, depth - fmax(rest, 0), out);
            if (trace && trace->worst) {
                float *worst = trace->worst +
                               (size_t)pen->node_count * (body->measure + (i < pen->vertex_count ? 0 : 1));
                for (int e = 0; e < 2; ++e) {
                    float *at = &worst[pen->end[i][e]];
                    *at = fmaxf(*at, (float)(depth - fmax(rest, 0)));
                }
            }
        }
    }
}

void ris__penetration_rest(const ris_penetration *pen, ris_finding *out)
{
    for (uint32_t k = 0; k < pen->body_count; ++k) {
        for (uint32_t i = 0; i < pen->point_count; ++i) {
            uint32_t solid = 0;
            if (pen->body[k].rest_mm[i] > 0) {
                const dvec p = point_at(pen, i, pen->rest_position);
                const double depth = ris__solids_depth(&pen->body[k].solids, p, &solid);
                note(pen, &pen->body[k], i, solid, depth, out);
            }
        }
    }
}
