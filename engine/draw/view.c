/* Cameras, lamps and the matrices of a frame. */
#include "draw/draw_impl.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define PI 3.14159265358979f
#define PAPER 0.92f /* linear grey */

static float dot(ris_vec3 a, ris_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static ris_vec3 cross(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static ris_vec3 minus(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* Unit vector; fallback where v has no length. */
static ris_vec3 unit(ris_vec3 v, ris_vec3 fallback)
{
    float length = sqrtf(dot(v, v));
    return length > 1e-6f ? (ris_vec3){v.x / length, v.y / length, v.z / length} : fallback;
}

/* A face by its eyes: everything from the crown to below an open jaw, in eye distances. */
static bool frame_eyes(const ris_head *head, ris_vec3 *centre, float *half, float *depth)
{
    const ris_part_def *left = NULL, *right = NULL;
    for (uint32_t i = 0; i < head->part_count; i++) {
        left = head->part[i].bone == RIS_BONE_EYE_L ? &head->part[i] : left;
        right = head->part[i].bone == RIS_BONE_EYE_R ? &head->part[i] : right;
    }
    if (left == NULL || right == NULL || left->pivot.x - right->pivot.x < 1.0f) {
        return false;
    }
    float span = left->pivot.x - right->pivot.x;
    *centre = (ris_vec3){0.5f * (left->pivot.x + right->pivot.x),
                         0.5f * (left->pivot.y + right->pivot.y) - 0.22f * span,
                         0.5f * (left->pivot.z + right->pivot.z) - 0.55f * span};
    *half = 2.12f * span;
    *depth = 0.6f * span;
    return true;
}

/* Anything else by the box of what moves. */
static void frame_nodes(const ris_model *model, ris_vec3 *centre, float *half, float *depth)
{
    ris_vec3 low = {FLT_MAX, FLT_MAX, FLT_MAX}, high = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t i = 0; i < model->node_count; i++) {
        ris_vec4 p = model->rest_position[i];
        if (p.w > 0.0f || model->moving_count == 0) {
            low = (ris_vec3){fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z)};
            high = (ris_vec3){fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z)};
        }
    }
    ris_vec3 size = minus(high, low);
    *centre = (ris_vec3){0.5f * (low.x + high.x), 0.5f * (low.y + high.y), 0.5f * (low.z + high.z)};
    *half = fmaxf(0.56f * fmaxf(size.y, 0.8f * fmaxf(size.x, size.z)), 1.0f);
    *depth = 0.5f * size.z;
}

bool ris_camera_named(const ris_model *model, const char *name, ris_camera *out)
{
    static const struct {
        const char *name;
        float turn_deg; /* to the subject's left */
    } views[] = {{"front", 0.0f}, {"34", 38.0f}, {"34.R", -38.0f}, {"profile", 90.0f}, {"profile.R", -90.0f}};
    const size_t count = sizeof views / sizeof views[0];
    size_t view = 0;
    while (view < count && strcmp(name, views[view].name) != 0) {
        view++;
    }
    if (view == count) {
        return false;
    }
    ris_vec3 centre;
    float half, depth, fov_deg = 18.0f;
    if (!frame_eyes(model->head, &centre, &half, &depth)) {
        frame_nodes(model, &centre, &half, &depth);
    }
    float away = half / tanf(0.5f * fov_deg * PI / 180.0f) + depth;
    float turn = views[view].turn_deg * PI / 180.0f;
    *out = (ris_camera){.eye = {centre.x + away * sinf(turn), centre.y, centre.z + away * cosf(turn)},
                        .target = centre,
                        .up = {0.0f, 1.0f, 0.0f},
                        .fov_y_deg = fov_deg};
    return true;
}

/* Rows of world -> clip for a camera; depth 0 near, 1 far, y down. */
static void camera_rows(const ris_camera *camera, float aspect, float near, float far, ris_vec4 out[4])
{
    ris_vec3 z = unit(minus(camera->eye, camera->target), (ris_vec3){0.0f, 0.0f, 1.0f});
    ris_vec3 x = unit(cross(camera->up, z), (ris_vec3){1.0f, 0.0f, 0.0f}), y = cross(z, x), e = camera->eye;
    float f = 1.0f / tanf(0.5f * camera->fov_y_deg * PI / 180.0f), k = far / (far - near);
    out[0] = (ris_vec4){x.x * f / aspect, x.y * f / aspect, x.z * f / aspect, -dot(x, e) * f / aspect};
    out[1] = (ris_vec4){-y.x * f, -y.y * f, -y.z * f, dot(y, e) * f};
    out[2] = (ris_vec4){-z.x * k, -z.y * k, -z.z * k, dot(z, e) * k - near * k};
    out[3] = (ris_vec4){-z.x, -z.y, -z.z, dot(z, e)};
}

/* Rows of world -> clip of a parallel light towards l that sees the sphere (centre, radius). */
static void light_rows(ris_vec3 l, ris_vec3 centre, float radius, ris_vec4 out[4])
{
    ris_vec3 x = unit(cross((ris_vec3){0.0f, 1.0f, 0.0f}, l), (ris_vec3){1.0f, 0.0f, 0.0f}), y = cross(l, x);
    float s = 1.0f / radius;
    out[0] = (ris_vec4){x.x * s, x.y * s, x.z * s, -dot(x, centre) * s};
    out[1] = (ris_vec4){-y.x * s, -y.y * s, -y.z * s, dot(y, centre) * s};
    out[2] = (ris_vec4){-0.5f * l.x * s, -0.5f * l.y * s, -0.5f * l.z * s, 0.5f * dot(l, centre) * s + 0.5f};
    out[3] = (ris_vec4){0.0f, 0.0f, 0.0f, 1.0f};
}

static ris_vec4 lamp(float x, float y, float z, float half_angle)
{
    ris_vec3 d = unit((ris_vec3){x, y, z}, (ris_vec3){0.0f, 0.0f, 1.0f});
    return (ris_vec4){d.x, d.y, d.z, half_angle};
}

void ris__draw_view_fill(const ris_draw *draw, const ris_camera *camera, const float head[12],
                         ris_draw_view *out)
{
    const ris_draw_scene *scene = &draw->scene;
    ris_vec3 c = {0.5f * (scene->low.x + scene->high.x), 0.5f * (scene->low.y + scene->high.y),
                  0.5f * (scene->low.z + scene->high.z)};
    ris_vec3 centre = {head[0] * c.x + head[1] * c.y + head[2] * c.z + head[3],
                       head[4] * c.x + head[5] * c.y + head[6] * c.z + head[7],
                       head[8] * c.x + head[9] * c.y + head[10] * c.z + head[11]};
    ris_vec3 span = minus(scene->high, scene->low);
    float radius = fmaxf(0.5f * sqrtf(dot(span, span)) * 1.05f, 1.0f);
    ris_vec3 to_eye = minus(camera->eye, centre);
    float distance = sqrtf(dot(to_eye, to_eye));
    float near = fmaxf(distance - 1.2f * radius, 0.02f * radius), far = distance + 1.5f * radius;
    *out = (ris_draw_view){
        .eye = {camera->eye.x, camera->eye.y, camera->eye.z, tanf(0.5f * camera->fov_y_deg * PI / 180.0f)}};
    camera_rows(camera, (float)draw->target.width / (float)draw->target.height, near, far, out->clip);
    /* key from the upper right of the picture, fill low from the left, rim from behind */
    out->light[0] = lamp(0.62f, 0.62f, 0.85f, 0.33f);
    out->light[1] = lamp(-0.85f, 0.10f, 0.75f, 0.34f);
    out->light[2] = lamp(-0.75f, 0.45f, -0.70f, 0.30f);
    out->radiance[0] = (ris_vec4){1.46f, 1.36f, 1.24f, 0.0f};
    out->radiance[1] = (ris_vec4){0.36f, 0.40f, 0.46f, 0.0f};
    out->radiance[2] = (ris_vec4){0.85f, 0.90f, 1.00f, 0.0f};
    out->sky = (ris_vec4){0.35f, 0.37f, 0.40f, 0.0f};
    out->ground = (ris_vec4){0.17f, 0.15f, 0.14f, 0.0f};
    light_rows((ris_vec3){out->light[0].x, out->light[0].y, out->light[0].z}, centre, radius, out->shadow);
    out->paper = draw->paper ? PAPER : 0.0f;
    memcpy(out->head, head, sizeof out->head);
    memcpy(out->rim, scene->rim, sizeof out->rim);
    memcpy(out->fade, scene->fade, sizeof out->fade);
    out->size = (ris_vec4){(float)draw->target.width, (float)draw->target.height, (float)RIS_DRAW_SHADOW_SIDE,
                           2.0f * radius / (float)RIS_DRAW_SHADOW_SIDE};
}

bool ris_camera_project(const ris_camera *camera, uint32_t width, uint32_t height, ris_vec3 point,
                        float *out_x, float *out_y, float *out_distance)
{
    ris_vec4 row[4];
    camera_rows(camera, (float)width / (float)height, 1.0f, 2.0f, row);
    const float w = row[3].x * point.x + row[3].y * point.y + row[3].z * point.z + row[3].w;
    if (!(w > 0.0f)) {
        return false;
    }
    const float x = row[0].x * point.x + row[0].y * point.y + row[0].z * point.z + row[0].w,
                y = row[1].x * point.x + row[1].y * point.y + row[1].z * point.z + row[1].w;
    *out_x = (0.5f + 0.5f * x / w) * (float)width;
    *out_y = (0.5f + 0.5f * y / w) * (float)height;
    if (out_distance != NULL) {
        *out_distance = w;
    }
    return true;
}
