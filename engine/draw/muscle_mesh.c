#include "draw/muscle_mesh.h"

#include "model/vec3.h"

#include <stdlib.h>
#include <string.h>

#define STEPS 4u    /* rows per segment; even, so that one lies in its middle */
#define CAP_ROWS 4u /* more rows within the rounding of an end */
#define CAP 0.5f    /* length of the rounding, in segments */
#define TIP 0.12f   /* height of the first row, of the full one */
#define SWEEP 8u    /* vertices across the first fibre, two for each more */
#define PI 3.14159265358979f

static uint32_t row_count(const ris_muscle *muscle)
{
    return (muscle->point_count - 1) * STEPS + 1 + 2 * CAP_ROWS;
}

static uint32_t across_count(const ris_muscle *muscle)
{
    return SWEEP + 4u * (muscle->fiber_count - 1);
}

/* Place of a row along the muscle in segments: dense at the ends, where the section grows. */
static float row_place(const ris_muscle *muscle, uint32_t row)
{
    const uint32_t last = row_count(muscle) - 1;
    const uint32_t from_end = row < last - row ? row : last - row, dense = CAP_ROWS + STEPS / 2;
    const float length = (float)(muscle->point_count - 1);
    if (from_end > dense) {
        return ((float)row - (float)CAP_ROWS) / (float)STEPS;
    }
    const float share = (float)from_end / (float)dense, place = CAP * share * share;
    return row == from_end ? place : length - place;
}

/* Place across of vertex k of n along one side, 0..1, denser at the edges. */
static float across_place(uint32_t k, uint32_t n)
{
    return 0.5f - 0.5f * cosf(PI * (float)k / (float)n);
}

/* True when the grid's columns go the way of the segments' `wide`: the fibres are then taken from the last. */
static bool runs_along_wide(const ris_model *model, const ris_muscle *muscle)
{
    if (muscle->fiber_count < 2) {
        return false;
    }
    const ris_fiber *a = &model->fiber[muscle->first_fiber], *b = a + 1;
    float vote = 0.0f;
    for (uint32_t i = 0; i + 1 < muscle->point_count; ++i) {
        const ris_segment *s = &model->segment[a->first_segment + i];
        vote += v3_dot(s->wide, v3_sub(model->segment[b->first_segment + i].origin, s->origin));
    }
    return vote > 0.0f;
}

static void make_body(const ris_muscle *muscle, ris_muscle_body *body, ris_muscle_mesh *out)
{
    const uint32_t n = across_count(muscle), ring = 2 * n, rows = row_count(muscle);
    *body = (ris_muscle_body){.first_vertex = out->vertex_count,
                              .row_count = rows,
                              .ring_count = ring,
                              .first_index = out->index_count,
                              .reversed = runs_along_wide(out->model, muscle)};
    for (uint32_t r = 0; r < rows; ++r) {
        const float along = row_place(muscle, r) / (float)(muscle->point_count - 1);
        for (uint32_t k = 0; k < ring; ++k) {
            const uint32_t v = body->first_vertex + r * ring + k;
            const float fixed = 1.0f - f_smoothstep(along / 0.22f),
                        moved = 1.0f - f_smoothstep((1.0f - along) / 0.08f);
            out->across[v] = across_place(k <= n ? k : ring - k, n) * (float)muscle->fiber_count;
            out->along[v] = along;
            out->tendon[v] = muscle->kind == RIS_MUSCLE_LINEAR ? f_max(fixed, 0.5f * moved) : 0.0f;
        }
    }
    uint32_t *to = out->index + out->index_count;
    for (uint32_t r = 0; r + 1 < rows; ++r) {
        for (uint32_t k = 0; k < ring; ++k) {
            const uint32_t a = body->first_vertex + r * ring + k,
                           b = body->first_vertex + r * ring + (k + 1) % ring;
            const uint32_t quad[6] = {a, a + ring, b + ring, a, b + ring, b};
            memcpy(to, quad, sizeof quad);
            to += 6;
        }
    }
    for (uint32_t end = 0; end < 2;
         ++end) { /* the flat faces of both tips: strips between upper and lower side */
        const uint32_t first = body->first_vertex + (end ? (rows - 1) * ring : 0);
        for (uint32_t k = 0; k < n; ++k) {
            const uint32_t a = first + k, b = first + k + 1, c = first + (ring - k) % ring,
                           d = first + ring - k - 1;
            if (k > 0) {
                const uint32_t face[3] = {a, end ? c : b, end ? b : c};
                memcpy(to, face, sizeof face);
                to += 3;
            }
            if (k + 1 < n) {
                const uint32_t face[3] = {c, end ? d : b, end ? b : d};
                memcpy(to, face, sizeof face);
                to += 3;
            }
        }
    }
    body->index_count = (uint32_t)(to - (out->index + out->index_count));
    out->index_count += body->index_count;
    out->vertex_count += rows * ring;
}

ris_result ris__muscle_mesh_build(const ris_model *model, ris_muscle_mesh *out, ris_error *err)
{
    size_t vertices = 0, indices = 0;
    uint32_t widest = 0;
    *out = (ris_muscle_mesh){.model = model};
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const uint32_t n = across_count(&model->muscle[m]), rows = row_count(&model->muscle[m]);
        widest = model->muscle[m].fiber_count > widest ? model->muscle[m].fiber_count : widest;
        vertices += (size_t)rows * 2 * n;
        indices += ((size_t)rows - 1) * 2 * n * 6 + 2 * 6 * ((size_t)n - 1);
    }
    out->body = calloc(model->muscle_count + 1u, sizeof *out->body);
    out->index = calloc(indices + 1, sizeof *out->index);
    out->across = calloc(vertices + 1, sizeof *out->across);
    out->along = calloc(vertices + 1, sizeof *out->along);
    out->tendon = calloc(vertices + 1, sizeof *out->tendon);
    out->point = calloc(model->fiber_point_count + 1u, sizeof *out->point);
    out->segment = calloc(model->segment_count + 1u, sizeof *out->segment);
    out->slice = calloc(widest + 1u, sizeof *out->slice);
    if (!out->slice || !out->body || !out->index || !out->across || !out->along || !out->tendon ||
        !out->point || !out->segment) {
        ris__muscle_mesh_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing %u muscles",
                        (unsigned)model->muscle_count);
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        make_body(&model->muscle[m], &out->body[m], out);
    }
    return RIS_OK;
}

void ris__muscle_mesh_finish(ris_muscle_mesh *mesh)
{
    free(mesh->body);
    free(mesh->index);
    free(mesh->across);
    free(mesh->along);
    free(mesh->tendon);
    free(mesh->point);
    free(mesh->segment);
    free(mesh->slice);
    *mesh = (ris_muscle_mesh){0};
}

/* Through the control points (Catmull-Rom); t in segments. */
static ris_vec3 curve(const ris_vec3 *p, uint32_t n, float t)
{
    const uint32_t i = t <= 0.0f ? 0 : (uint32_t)t < n - 1 ? (uint32_t)t : n - 2;
    const float u = t - (float)i;
    const ris_vec3 b = p[i], c = p[i + 1], a = i > 0 ? p[i - 1] : v3_sub(v3_scale(b, 2.0f), c),
                   d = i + 2 < n ? p[i + 2] : v3_sub(v3_scale(c, 2.0f), b);
    const ris_vec3 c1 = v3_scale(v3_sub(c, a), 0.5f);
    const ris_vec3 c2 = v3_add(v3_mad(v3_scale(a, 1.0f), -2.5f, b), v3_mad(v3_scale(c, 2.0f), -0.5f, d));
    const ris_vec3 c3 = v3_add(v3_scale(v3_sub(b, c), 1.5f), v3_scale(v3_sub(d, a), 0.5f));
    return v3_mad(b, u, v3_mad(c1, u, v3_mad(c2, u, c3)));
}

/* Frames and extents belong to the middles of the segments; between them they are blended. */
static ris_muscle_slice cut(const ris_muscle_mesh *mesh, const ris_muscle *muscle, uint32_t f, float t)
{
    const ris_fiber *fiber = &mesh->model->fiber[muscle->first_fiber + f];
    const uint32_t segments = muscle->point_count - 1;
    const float x = f_clamp(t - 0.5f, 0.0f, (float)(segments - 1));
    const uint32_t i = (uint32_t)x, k = i + 1 < segments ? i + 1 : i;
    const ris_segment *a = &mesh->segment[fiber->first_segment + i],
                      *b = &mesh->segment[fiber->first_segment + k];
    const float u = x - (float)i;
    return (ris_muscle_slice){.centre = curve(mesh->point + fiber->first_point, muscle->point_count, t),
                              .up = v3_unit_or(v3_lerp(a->up, b->up, u), a->up),
                              .wide = v3_unit_or(v3_lerp(a->wide, b->wide, u), a->wide),
                              .height = a->size.y + u * (b->size.y - a->size.y),
                              .width = a->size.z + u * (b->size.z - a->size.z)};
}

/* The sheet's middle at s fibres from its first edge: centres joined, half a width beyond the outer ones. The fibres
 * follow each other against `wide`. */
static ris_muscle_slice across(const ris_muscle_slice *fiber, uint32_t count, float s)
{
    const float x = s - 0.5f;
    if (x <= 0.0f || count == 1) {
        ris_muscle_slice out = fiber[0];
        out.centre = v3_mad(out.centre, -x * out.width, out.wide);
        return out;
    }
    if (x >= (float)(count - 1)) {
        ris_muscle_slice out = fiber[count - 1];
        out.centre = v3_mad(out.centre, ((float)(count - 1) - x) * out.width, out.wide);
        return out;
    }
    const uint32_t i = (uint32_t)x;
    const float u = x - (float)i;
    const ris_muscle_slice *a = &fiber[i], *b = &fiber[i + 1];
    return (ris_muscle_slice){.centre = v3_lerp(a->centre, b->centre, u),
                              .up = v3_unit_or(v3_lerp(a->up, b->up, u), a->up),
                              .height = a->height + u * (b->height - a->height)};
}

/* Half height at s of count fibres, of the full one: round edges, flat between; width over height says how round. */
static float profile(float s, uint32_t count, float flatness)
{
    const float edge = f_min(s, (float)count - s),
                round = f_min(0.5f * (float)count, f_max(0.5f, 0.75f / flatness));
    const float x = 1.0f - f_min(edge / round, 1.0f);
    return sqrtf(f_max(1.0f - x * x, 0.0f));
}

/* One row of a body: the ring goes over the upper side, then back below. */
static void place_row(const ris_muscle_slice *fiber, uint32_t count, float from_end, uint32_t n,
                      ris_vec4 *out)
{
    const float x = 1.0f - f_min(from_end / CAP, 1.0f), grown = f_max(sqrtf(1.0f - x * x), TIP);
    const float narrow = 0.65f + 0.35f * grown, flatness = fiber[0].width / f_max(fiber[0].height, 0.01f);
    for (uint32_t k = 0; k < 2 * n; ++k) {
        const bool upper = k <= n;
        const float a = across_place(upper ? k : 2 * n - k, n);
        const float s = (0.5f + (a - 0.5f) * narrow) * (float)count;
        const ris_muscle_slice at = across(fiber, count, s);
        const float half = 0.5f * at.height * grown * profile(a * (float)count, count, flatness);
        out[k] = v4_from(v3_mad(at.centre, upper ? half : -half, at.up), 1.0f);
    }
}

static void add_normals(const ris_muscle_mesh *mesh, const ris_vec4 *position, ris_vec4 *normal)
{
    memset(normal, 0, mesh->vertex_count * sizeof *normal);
    for (uint32_t i = 0; i < mesh->index_count; i += 3) {
        const uint32_t *v = mesh->index + i;
        const ris_vec3 p = v4_xyz(position[v[0]]);
        const ris_vec3 n = v3_cross(v3_sub(v4_xyz(position[v[1]]), p), v3_sub(v4_xyz(position[v[2]]), p));
        for (int k = 0; k < 3; ++k) {
            normal[v[k]] = v4_from(v3_add(v4_xyz(normal[v[k]]), n), 0.0f);
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        normal[i] = v4_from(v3_unit_or(v4_xyz(normal[i]), v3(0.0f, 0.0f, 1.0f)), 0.0f);
    }
}

void ris__muscle_mesh_place(ris_muscle_mesh *mesh, const ris_sim *sim, ris_vec4 *position, ris_vec4 *normal)
{
    const ris_model *model = mesh->model;
    if (sim != NULL) {
        ris_sim_muscles(sim, mesh->point, mesh->segment);
    } else {
        memcpy(mesh->point, model->fiber_point, model->fiber_point_count * sizeof *mesh->point);
        memcpy(mesh->segment, model->segment, model->segment_count * sizeof *mesh->segment);
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const ris_muscle_body *body = &mesh->body[m];
        const float length = (float)(muscle->point_count - 1);
        for (uint32_t r = 0; r < body->row_count; ++r) {
            const float t = row_place(muscle, r);
            for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
                mesh->slice[f] = cut(mesh, muscle, body->reversed ? muscle->fiber_count - 1 - f : f, t);
            }
            place_row(mesh->slice, muscle->fiber_count, f_min(t, length - t), body->ring_count / 2,
                      position + body->first_vertex + (size_t)r * body->ring_count);
        }
    }
    add_normals(mesh, position, normal);
}
