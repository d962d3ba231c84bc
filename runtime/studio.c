#include "studio.h"

#include <stdlib.h>
#include <string.h>

static const char *const view_names[] = {"front", "34", "34.R", "profile", "profile.R", NULL};

ris_result studio_views_parse(const char *text, studio_views *out, ris_error *err)
{
    *out = (studio_views){0};
    for (const char *c = text;; c++) {
        size_t length = strcspn(c, ",");
        bool known = false;
        for (uint32_t i = 0; view_names[i]; i++) {
            known = known || (strlen(view_names[i]) == length && strncmp(c, view_names[i], length) == 0);
        }
        if (!known) {
            return ris_fail(err, RIS_ERROR_USAGE,
                            "--view: expected front, 34, 34.R, profile or profile.R, found '%.*s'",
                            (int)(length < 64 ? length : 64), c);
        }
        if (out->count == STUDIO_VIEW_CAPACITY) {
            return ris_fail(err, RIS_ERROR_USAGE, "--view: more than %d views", STUDIO_VIEW_CAPACITY);
        }
        snprintf(out->name[out->count++], sizeof out->name[0], "%.*s", (int)length, c);
        c += length;
        if (*c == '\0') {
            return RIS_OK;
        }
    }
}

#ifdef RISORIUS_VULKAN
#include "annotate.h"

struct ris_studio {
    ris_draw *draw;
    ris_camera camera[STUDIO_VIEW_CAPACITY];
    studio_look look;
    uint32_t view_count, width, height; /* of one view */
    uint8_t *view, *picture;            /* one view, and all side by side (the same when there is one) */
};

/* Nearer by zoom, and aimed the more at the base of the nose. */
static void go_nearer(ris_camera *camera, const ris_head *head, float zoom)
{
    const ris_landmark *nose = ris_head_landmark(head, "sn", false);
    const ris_vec3 at = nose ? nose->at : camera->target,
                   away = {camera->eye.x - camera->target.x, camera->eye.y - camera->target.y,
                           camera->eye.z - camera->target.z};
    const float share = 1.0f - 1.0f / zoom;
    camera->target.x += share * (at.x - camera->target.x);
    camera->target.y += share * (at.y - camera->target.y);
    camera->target.z += share * (at.z - camera->target.z);
    camera->eye.x = camera->target.x + away.x / zoom;
    camera->eye.y = camera->target.y + away.y / zoom;
    camera->eye.z = camera->target.z + away.z / zoom;
}

ris_result studio_create(const ris_backend *backend, const studio_views *views, uint32_t width,
                         uint32_t height, const studio_look *look, ris_studio **out, ris_error *err)
{
    *out = NULL;
    ris_studio *s = calloc(1, sizeof *s);
    if (!s) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a picture");
    }
    ris_result r = RIS_OK;
    s->look = *look;
    s->view_count = views->count;
    s->width = width;
    s->height = height;
    for (uint32_t i = 0; i < views->count; i++) {
        if (!ris_camera_named(backend->model, views->name[i], &s->camera[i])) {
            r = ris_fail(err, RIS_ERROR_USAGE, "there is no view '%s' of this head", views->name[i]);
            goto fail;
        }
        if (look->zoom > 0.0f) {
            go_nearer(&s->camera[i], backend->model->head, look->zoom);
        }
    }
    size_t pixels = (size_t)width * height;
    s->view = malloc(pixels * 4);
    s->picture = views->count > 1 ? malloc(pixels * 4 * views->count) : s->view;
    if (!s->view || !s->picture) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a picture of %ux%u", width * views->count,
                     height);
        goto fail;
    }
    const ris_draw_def def = {
        .width = width, .height = height, .wireframe = look->wireframe, .layers = look->layers};
    r = ris_draw_create(backend->device, backend->model, &def, &s->draw, err);
    if (r) {
        goto fail;
    }
    *out = s;
    return RIS_OK;
fail:
    studio_destroy(s);
    return r;
}

void studio_destroy(ris_studio *studio)
{
    if (studio) {
        ris_draw_destroy(studio->draw);
        if (studio->picture != studio->view) {
            free(studio->picture);
        }
        free(studio->view);
        free(studio);
    }
}

ris_result studio_shoot(ris_studio *studio, ris_sim *sim, const ris_vec4 *position, const ris_vec4 *normal,
                        const uint8_t **out_rgba, ris_error *err)
{
    size_t row = (size_t)studio->width * 4;
    for (uint32_t i = 0; i < studio->view_count; i++) {
        ris_result r = position
                           ? ris_draw_frame_at(studio->draw, sim, position, normal, &studio->camera[i], err)
                           : ris_draw_frame(studio->draw, sim, &studio->camera[i], err);
        if (!r) {
            r = ris_draw_read(studio->draw, studio->view, err);
        }
        if (!r && studio->look.labels) {
            r = annotate_picture(studio->draw, sim, &studio->camera[i], position, studio->look.layers,
                                 studio->view, studio->width, studio->height, err);
        }
        if (r) {
            return r;
        }
        for (uint32_t y = 0; studio->view_count > 1 && y < studio->height; y++) {
            memcpy(studio->picture + (y * (size_t)studio->view_count + i) * row, studio->view + y * row, row);
        }
    }
    *out_rgba = studio->picture;
    return RIS_OK;
}
#else
/* Without Vulkan nothing draws: backend_open has refused before a studio is asked for. */
ris_result studio_create(const ris_backend *backend, const studio_views *views, uint32_t width,
                         uint32_t height, const studio_look *look, ris_studio **out, ris_error *err)
{
    (void)backend, (void)views, (void)width, (void)height, (void)look;
    *out = NULL;
    return ris_fail(err, RIS_ERROR_DEVICE, "this risorius was built without Vulkan, so it cannot draw");
}

void studio_destroy(ris_studio *studio)
{
    (void)studio;
}

ris_result studio_shoot(ris_studio *studio, ris_sim *sim, const ris_vec4 *position, const ris_vec4 *normal,
                        const uint8_t **out_rgba, ris_error *err)
{
    (void)studio, (void)sim, (void)position, (void)normal;
    *out_rgba = NULL;
    return ris_fail(err, RIS_ERROR_DEVICE, "this risorius was built without Vulkan, so it cannot draw");
}
#endif
