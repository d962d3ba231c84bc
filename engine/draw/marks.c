#include "draw/marks.h"

#include "model/vec3.h"

#include <stdlib.h>
#include <string.h>

#define CORNERS 12u     /* of a disc */
#define DISC_MM 1.15f   /* radius */
#define RIM_MM 1.55f    /* radius of the dark disc behind it */
#define DOWEL_MM 0.5f   /* width */
#define SPRING_MM 0.42f /* width */
#define NEARER_MM 1.8f  /* towards the eye, so that marks of the skin are not lost in its drawn surface */
#define BONE_NEARER_MM 0.8f
#define PI 3.14159265358979f

static const ris_vec4 skin_color = {0.05f, 0.50f, 0.75f, 1.0f}, bone_color = {0.95f, 0.42f, 0.03f, 1.0f},
                      rim_color = {0.01f, 0.01f, 0.012f, 1.0f}, dowel_color = {0.80f, 0.55f, 0.12f, 1.0f};

/* Where the next vertices and indices go. */
typedef struct pen {
    const ris_marks *marks;
    uint32_t vertex, index;
    ris_vec3 eye;
    ris_vec4 *position, *color;
} pen;

static void add_ribbon_index(ris_marks *to, uint32_t *vertex, uint32_t *index)
{
    const uint32_t v = *vertex, quad[6] = {v, v + 1, v + 2, v + 2, v + 1, v + 3};
    memcpy(to->index + *index, quad, sizeof quad);
    *vertex += 4;
    *index += 6;
}

static void add_disc_index(ris_marks *to, uint32_t *vertex, uint32_t *index)
{
    for (uint32_t k = 1; k + 1 < CORNERS; ++k) {
        const uint32_t face[3] = {*vertex, *vertex + k, *vertex + k + 1};
        memcpy(to->index + *index, face, sizeof face);
        *index += 3;
    }
    *vertex += CORNERS;
}

ris_result ris__marks_build(const ris_model *model, ris_marks *out, ris_error *err)
{
    uint32_t bones = 0, skins = 0, vertex = 0, index = 0;
    for (uint32_t i = 0; i < model->head->landmark_count; ++i) {
        const bool skin = model->head->landmark[i].mesh == RIS_LANDMARK_SKIN;
        skins += skin;
        bones += !skin;
    }
    const uint32_t disc = 3 * (CORNERS - 2);
    *out = (ris_marks){.bone_index_count = bones * (6 + 2 * disc),
                       .spring_index_count = 6 * model->spring_count,
                       .skin_index_count = skins * 2 * disc,
                       .vertex_count =
                           bones * (4 + 2 * CORNERS) + 4 * model->spring_count + skins * 2 * CORNERS};
    out->index_count = out->bone_index_count + out->spring_index_count + out->skin_index_count;
    out->index = calloc(out->index_count + 1u, sizeof *out->index);
    if (out->index == NULL) {
        *out = (ris_marks){0};
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the marks of %u springs",
                        (unsigned)model->spring_count);
    }
    for (uint32_t i = 0; i < bones; ++i) {
        add_ribbon_index(out, &vertex, &index);
        add_disc_index(out, &vertex, &index);
        add_disc_index(out, &vertex, &index);
    }
    for (uint32_t i = 0; i < model->spring_count; ++i) {
        add_ribbon_index(out, &vertex, &index);
    }
    for (uint32_t i = 0; i < 2 * skins; ++i) {
        add_disc_index(out, &vertex, &index);
    }
    return RIS_OK;
}

void ris__marks_finish(ris_marks *marks)
{
    free(marks->index);
    *marks = (ris_marks){0};
}

static void put(pen *to, ris_vec3 p, ris_vec4 color)
{
    to->position[to->vertex] = v4_from(p, 1.0f);
    to->color[to->vertex++] = color;
}

static ris_vec3 nearer(const pen *to, ris_vec3 p, float mm)
{
    return v3_mad(p, mm, v3_unit_or(v3_sub(to->eye, p), v3(0.0f, 0.0f, 1.0f)));
}

static void put_ribbon(pen *to, ris_vec3 a, ris_vec3 b, float width_mm, float near_mm, ris_vec4 color)
{
    const ris_vec3 none = {0}, view = v3_sub(to->eye, a);
    const ris_vec3 side = v3_unit_or(v3_cross(v3_sub(b, a), view), none);
    a = nearer(to, a, near_mm);
    b = nearer(to, b, near_mm);
    put(to, v3_mad(a, -0.5f * width_mm, side), color);
    put(to, v3_mad(a, 0.5f * width_mm, side), color);
    put(to, v3_mad(b, -0.5f * width_mm, side), color);
    put(to, v3_mad(b, 0.5f * width_mm, side), color);
}

static void put_disc(pen *to, ris_vec3 p, float radius_mm, float near_mm, ris_vec4 color)
{
    const ris_vec3 z = v3_unit_or(v3_sub(to->eye, p), v3(0.0f, 0.0f, 1.0f));
    const ris_vec3 x = v3_unit_or(v3_cross(v3(0.0f, 1.0f, 0.0f), z), v3(1.0f, 0.0f, 0.0f)),
                   y = v3_cross(z, x);
    p = v3_mad(p, near_mm, z);
    for (uint32_t k = 0; k < CORNERS; ++k) {
        const float turn = 2.0f * PI * (float)k / (float)CORNERS;
        put(to, v3_mad(v3_mad(p, radius_mm * cosf(turn), x), radius_mm * sinf(turn), y), color);
    }
}

static void put_landmarks(pen *to, const ris_sim *sim, const ris_vec4 *node, bool on_skin)
{
    const ris_head *head = ris_sim_get_model(sim)->head;
    const float near_mm = on_skin ? NEARER_MM : BONE_NEARER_MM;
    for (uint32_t i = 0; i < head->landmark_count; ++i) {
        if ((head->landmark[i].mesh == RIS_LANDMARK_SKIN) != on_skin) {
            continue;
        }
        ris_vec3 tip, at = ris_sim_landmark(sim, i, node, &tip);
        if (!on_skin) {
            put_ribbon(to, at, tip, DOWEL_MM, 0.0f, dowel_color);
        }
        put_disc(to, at, RIM_MM, near_mm, rim_color);
        put_disc(to, at, DISC_MM, near_mm + 0.2f, on_skin ? skin_color : bone_color);
    }
}

/* White at rest, blue when compressed, red when stretched. */
static ris_vec4 stretch_color(float stretch)
{
    const float s = f_clamp(stretch / RIS_STRETCH_FULL, -1.0f, 1.0f), t = s < 0.0f ? -s : s;
    const ris_vec3 calm = {0.85f, 0.85f, 0.85f},
                   end = s < 0.0f ? v3(0.01f, 0.08f, 0.75f) : v3(0.80f, 0.02f, 0.01f);
    return v4_from(v3_lerp(calm, end, t), 0.35f + 0.65f * f_min(3.0f * t, 1.0f));
}

static void put_springs(pen *to, const ris_model *model, const ris_vec4 *node)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            const ris_half_spring *spring = &model->half_spring[h];
            if (spring->other > i) {
                const ris_vec3 a = v4_xyz(node[i]), b = v4_xyz(node[spring->other]);
                put_ribbon(to, a, b, SPRING_MM, NEARER_MM,
                           stretch_color(v3_distance(a, b) / spring->rest_mm - 1.0f));
            }
        }
    }
}

void ris__marks_place(const ris_marks *marks, const ris_sim *sim, const ris_vec4 *node, uint32_t layers,
                      ris_vec3 eye, ris_vec4 *position, ris_vec4 *color)
{
    const ris_model *model = ris_sim_get_model(sim);
    pen to = {.marks = marks, .eye = eye, .position = position, .color = color};
    if (layers & RIS_LAYER_LANDMARKS) {
        put_landmarks(&to, sim, node, false);
    }
    to.vertex = marks->bone_index_count / (6 + 6 * (CORNERS - 2)) * (4 + 2 * CORNERS);
    if (layers & RIS_LAYER_SPRINGS) {
        put_springs(&to, model, node);
    }
    to.vertex = marks->vertex_count - marks->skin_index_count / (6 * (CORNERS - 2)) * 2 * CORNERS;
    if (layers & RIS_LAYER_LANDMARKS) {
        put_landmarks(&to, sim, node, true);
    }
}
