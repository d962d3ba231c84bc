/* Height-field scenes: a flat patch, or a cap with muscles of a mouth and a brow that have the names of
 * the human ones. */
#include "scenes/scenes.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ris_scene_def ris_default_scene_def(void)
{
    ris_scene_def def = {
        .columns = 49,
        .rows = 61,
        .spacing_mm = 2.0f,
        .radius_mm = 90.0f,
        .depth_mm = 6.0f,
        .pinned_border = true,
        .rig = true,
        .tissue = ris_default_tissue(),
    };
    return def;
}

static ris_vec3 on_ground(const ris_scene_def *def, float x, float y)
{
    const float r = def->radius_mm;
    return v3(x, y, r > 0.0f ? sqrtf(r * r - x * x - y * y) : 0.0f);
}

static ris_result make_mesh(const ris_scene_def *def, ris_mesh *mesh, ris_error *err)
{
    const uint32_t columns = def->columns, rows = def->rows, faces = (columns - 1) * (rows - 1);
    ris_result result =
        ris__model_alloc(&mesh->position, (size_t)columns * rows, sizeof *mesh->position, "a scene", err);
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&mesh->face_start, (size_t)faces + 1, sizeof *mesh->face_start, "a scene", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&mesh->face_vertex, 4 * (size_t)faces, sizeof *mesh->face_vertex, "a scene",
                                  err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&mesh->face_uv, 4 * (size_t)faces, sizeof *mesh->face_uv, "a scene", err);
    }
    if (result != RIS_OK) {
        return result;
    }
    mesh->vertex_count = columns * rows;
    mesh->face_count = faces;
    memset(mesh->face_uv, 0xff, 4 * (size_t)faces * sizeof *mesh->face_uv);
    const float half = 0.5f * def->spacing_mm;
    for (uint32_t r = 0; r < rows; ++r) {
        for (uint32_t c = 0; c < columns; ++c) {
            const float x = (float)(2 * (int64_t)c - (columns - 1)) * half,
                        y = (float)(2 * (int64_t)r - (rows - 1)) * half;
            mesh->position[r * columns + c] = on_ground(def, x, y);
        }
    }
    for (uint32_t f = 0; f < faces; ++f) {
        const uint32_t a = f / (columns - 1) * columns + f % (columns - 1);
        const uint32_t corner[4] = {a, a + 1, a + columns + 1, a + columns};
        memcpy(mesh->face_vertex + 4 * (size_t)f, corner, sizeof corner);
        mesh->face_start[f + 1] = 4 * (f + 1);
    }
    return RIS_OK;
}

typedef bool (*vertex_test)(const ris_scene_def *def, uint32_t column, uint32_t row, ris_vec3 p);

static bool is_free(const ris_scene_def *def, uint32_t c, uint32_t r, ris_vec3 p)
{
    (void)p;
    return !def->pinned_border || (c > 0 && r > 0 && c + 1 < def->columns && r + 1 < def->rows);
}

static bool is_upper_lip(const ris_scene_def *def, uint32_t c, uint32_t r, ris_vec3 p)
{
    (void)def, (void)c, (void)r;
    return p.y > -25.0f && p.y < -16.0f && p.x > -20.0f && p.x < 20.0f;
}

static bool is_lower_lip(const ris_scene_def *def, uint32_t c, uint32_t r, ris_vec3 p)
{
    (void)def, (void)c, (void)r;
    return p.y <= -25.0f && p.y > -34.0f && p.x > -20.0f && p.x < 20.0f;
}

static ris_result make_region(const ris_scene_def *def, const ris_mesh *mesh, const char *name,
                              vertex_test test, ris_region *out, ris_error *err)
{
    ris_result result =
        ris__model_alloc(&out->vertex, mesh->vertex_count, sizeof *out->vertex, "a scene", err);
    snprintf(out->name, sizeof out->name, "%s", name);
    for (uint32_t i = 0; result == RIS_OK && i < mesh->vertex_count; ++i) {
        if (test(def, i % def->columns, i / def->columns, mesh->position[i])) {
            out->vertex[out->count++] = i;
        }
    }
    return result;
}

/* A grid of rows points from a to b in the xy plane, columns across a band of the given half width. */
typedef struct band {
    const char *name;
    ris_muscle_kind kind;
    float from[2], to[2], half_width;
    uint32_t rows, columns;
    float radius_mm, insertion_start, max_shortening, lip_drag_power;
} band;

static const band bands[] = {
    {"zygomaticus_major.L", RIS_MUSCLE_LINEAR, {36, 14}, {19, -24}, 4, 6, 3, 9.9f, 0.6f, 0.22f, 6},
    {"zygomaticus_major.R", RIS_MUSCLE_LINEAR, {-36, 14}, {-19, -24}, 4, 6, 3, 9.9f, 0.6f, 0.22f, 6},
    {"depressor_anguli_oris.L", RIS_MUSCLE_LINEAR, {24, -52}, {19, -26}, 3, 5, 3, 6.8f, 0.7f, 0.17f, 6},
    {"depressor_anguli_oris.R", RIS_MUSCLE_LINEAR, {-24, -52}, {-19, -26}, 3, 5, 3, 6.8f, 0.7f, 0.17f, 6},
    {"frontalis_inner.L", RIS_MUSCLE_LINEAR, {11, 54}, {11, 30}, 6, 5, 3, 4.6f, 0.5f, 0.15f, 0},
    {"frontalis_inner.R", RIS_MUSCLE_LINEAR, {-11, 54}, {-11, 30}, 6, 5, 3, 4.6f, 0.5f, 0.15f, 0},
    {"orbicularis_oris_superior", RIS_MUSCLE_SPHINCTER, {-19, -21}, {19, -21}, 3, 9, 3, 5.4f, 0, 0.1f, 0},
    {"orbicularis_oris_inferior", RIS_MUSCLE_SPHINCTER, {-19, -29}, {19, -29}, -3, 9, 3, 4, 0, 0.1f, 0},
};

static ris_result make_muscle(const ris_scene_def *def, const band *b, ris_muscle_def *out, ris_error *err)
{
    snprintf(out->name, sizeof out->name, "%s", b->name);
    *out = (ris_muscle_def){
        .kind = b->kind,
        .bone = RIS_BONE_AUTO,
        .rows = b->rows,
        .columns = b->columns,
        .thickness_mm = {2, 6},
        .max_shortening = b->max_shortening,
        .radius_mm = b->radius_mm,
        .insertion_start = b->insertion_start,
        .lip_drag_power = b->lip_drag_power,
        .gain = 1.2f,
        .onset_ms = def->dynamics.onset_ms,
        .release_ms = def->dynamics.release_ms,
        .attach_auto = true,
        .has_axis = b->kind == RIS_MUSCLE_SPHINCTER,
    };
    snprintf(out->name, sizeof out->name, "%s", b->name);
    const ris_vec3 centre = on_ground(def, 0.0f, -25.0f);
    out->axis[0] = v3(0.0f, -25.0f, centre.z - 20.0f);
    out->axis[1] = v3(0.0f, -25.0f, centre.z + 5.0f);
    char **const texts[] = {&out->origin, &out->insertion, &out->source};
    ris_result result =
        ris__model_alloc(&out->grid, (size_t)b->rows * b->columns, sizeof *out->grid, "a scene", err);
    for (size_t k = 0; result == RIS_OK && k < sizeof texts / sizeof texts[0]; ++k) {
        result = ris__model_alloc(texts[k], 1, 1, "a scene", err);
    }
    const float dx = b->to[0] - b->from[0], dy = b->to[1] - b->from[1], length = sqrtf(dx * dx + dy * dy);
    for (uint32_t k = 0; result == RIS_OK && k < b->rows * b->columns; ++k) {
        const uint32_t row = k / b->columns;
        const float t = (float)row / (float)(b->rows - 1);
        const float s = (2.0f * (float)(k % b->columns) / (float)(b->columns - 1) - 1.0f) * -b->half_width;
        /* mirror images: the columns of a right muscle run the other way across */
        const float across = b->from[0] < 0.0f && b->kind == RIS_MUSCLE_LINEAR ? -s : s;
        out->grid[k] = on_ground(def, b->from[0] + t * dx + across * dy / length,
                                 b->from[1] + t * dy - across * dx / length);
    }
    return result;
}

static ris_result make_rig(const ris_scene_def *def, ris_head *head, ris_error *err)
{
    const uint32_t count = sizeof bands / sizeof bands[0];
    ris_result result = ris__model_alloc(&head->muscle, count, sizeof *head->muscle, "a scene", err);
    for (uint32_t m = 0; result == RIS_OK && m < count; ++m) {
        head->muscle_count = m + 1;
        result = make_muscle(def, &bands[m], &head->muscle[m], err);
    }
    for (uint32_t i = 0; result == RIS_OK && i < head->skin.vertex_count; ++i) {
        head->jaw_weight[i] = f_smoothstep((-15.0f - head->skin.position[i].y) / 20.0f);
    }
    return result;
}

ris_result ris_scene_head(const ris_scene_def *def, ris_head *out, ris_error *err)
{
    memset(out, 0, sizeof *out);
    const float width = def->spacing_mm * (float)def->columns, height = def->spacing_mm * (float)def->rows;
    if (def->columns < 2 || def->rows < 2 || def->columns > 4096 || def->rows > 4096 ||
        !(def->spacing_mm > 0.0f) ||
        (def->radius_mm > 0.0f &&
         !(4.0f * def->radius_mm * def->radius_mm > width * width + height * height))) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "a scene of %u x %u nodes, %g mm apart, radius %g mm is impossible", def->columns,
                        def->rows, (double)def->spacing_mm, (double)def->radius_mm);
    }
    out->tissue = def->tissue;
    out->dynamics = def->dynamics;
    out->jaw = ris_default_jaw();
    out->jaw.point = v3(0, 15, 0);
    out->jaw.incisor = v3(0, -28, 76);
    snprintf(out->simulated, sizeof out->simulated, "face");
    ris_result result = make_mesh(def, &out->skin, err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&out->region, 3, sizeof *out->region, "a scene", err);
    }
    static const struct {
        const char *name;
        vertex_test test;
    } regions[] = {{"face", is_free}, {"lip_upper", is_upper_lip}, {"lip_lower", is_lower_lip}};
    for (uint32_t k = 0; result == RIS_OK && k < 3; ++k) {
        out->region_count = k + 1;
        result = make_region(def, &out->skin, regions[k].name, regions[k].test, &out->region[k], err);
    }
    if (result == RIS_OK) {
        result =
            ris__model_alloc(&out->depth_mm, out->skin.vertex_count, sizeof *out->depth_mm, "a scene", err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&out->jaw_weight, out->skin.vertex_count, sizeof *out->jaw_weight,
                                  "a scene", err);
    }
    for (uint32_t i = 0; result == RIS_OK && i < out->skin.vertex_count; ++i) {
        out->depth_mm[i] = def->depth_mm;
    }
    if (result == RIS_OK && def->rig) {
        result = make_rig(def, out, err);
    }
    if (result == RIS_OK) {
        result = ris__model_alloc(&out->directory, sizeof "scene", 1, "a scene", err);
    }
    if (result != RIS_OK) {
        ris_head_finish(out);
        return result;
    }
    memcpy(out->directory, "scene", sizeof "scene");
    return RIS_OK;
}

ris_result ris_scene_model(const ris_scene_def *def, ris_model **out, ris_error *err)
{
    *out = NULL;
    ris_head *head = NULL;
    ris_result result = ris__model_alloc(&head, 1, sizeof *head, "a scene", err);
    if (result == RIS_OK) {
        result = ris_scene_head(def, head, err);
    }
    if (result == RIS_OK) {
        result = ris_model_create(head, out, err);
        if (result != RIS_OK) {
            ris_head_finish(head);
        }
    }
    if (result != RIS_OK) {
        free(head);
        return result;
    }
    (*out)->owned_head = head;
    return RIS_OK;
}
