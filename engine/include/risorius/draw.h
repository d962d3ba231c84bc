/* The raster pass: a simulated head into an offscreen image, or into a window's swapchain. */
#pragma once

#include "risorius/device.h"
#include "risorius/sim.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ris_draw ris_draw;

typedef struct ris_camera {
    ris_vec3 eye, target, up; /* mm */
    float fov_y_deg;
} ris_camera;

/* "front", "34" (three-quarter from the subject's left), "profile" (the left one), "34.R" and "profile.R" from the right;
 * false if unknown. Frames the face of the model. */
bool ris_camera_named(const ris_model *model, const char *name, ris_camera *out);

/* What is shown; a mask. With what lies inside (muscles, skull, landmarks) the skin is drawn as glass. */
typedef enum ris_layer {
    RIS_LAYER_SKIN = 1 << 0,      /* with brows and lashes */
    RIS_LAYER_MUSCLES = 1 << 1,   /* as they are at the tick, brighter with activation */
    RIS_LAYER_SKULL = 1 << 2,     /* skull, mandible and teeth */
    RIS_LAYER_SPRINGS = 1 << 3,   /* of the skin, coloured by stretch */
    RIS_LAYER_LANDMARKS = 1 << 4, /* on skin and bone, with their dowels */
    RIS_LAYER_STRAIN = 1 << 5     /* the skin, coloured by how much its area grew or shrank */
} ris_layer;
#define RIS_LAYER_COUNT 6
#define RIS_LAYER_INNER (RIS_LAYER_MUSCLES | RIS_LAYER_SKULL | RIS_LAYER_LANDMARKS)

#define RIS_STRETCH_FULL 0.2f /* stretch of a spring, l / rest - 1, at the end of the colour scale */
#define RIS_STRAIN_FULL 0.4f  /* area now / area at rest - 1, at the end of the colour scale */

/* Pixel of a point of the world in a picture of width x height; false behind the camera. out_distance (mm, along the
 * view) may be NULL. */
bool ris_camera_project(const ris_camera *camera, uint32_t width, uint32_t height, ris_vec3 point,
                        float *out_x, float *out_y, float *out_distance);

typedef struct ris_draw_def {
    uint32_t width, height; /* pixels */
    bool wireframe;
    uint32_t layers; /* ris_layer mask; 0 = skin */
    bool paper;      /* a flat light background instead of the studio's */
} ris_draw_def;

/* Loads textures and parts of the model's head to the device. Errors: RIS_ERROR_DEVICE, RIS_ERROR_DATA (textures). */
ris_result ris_draw_create(ris_device *device, const ris_model *model, const ris_draw_def *def,
                           ris_draw **out, ris_error *err);
void ris_draw_destroy(ris_draw *draw);
ris_result ris_draw_resize(ris_draw *draw, uint32_t width, uint32_t height, ris_error *err);
void ris_draw_set_wireframe(ris_draw *draw, bool wireframe);
/* ris_layer mask; 0 = skin. What the layers need is made on their first use: errors as of ris_draw_create. */
ris_result ris_draw_set_layers(ris_draw *draw, uint32_t layers, ris_error *err);
/* Which muscles the layer shows: one flag each (muscle_count), NULL = all. After ris_draw_set_layers with muscles. */
void ris_draw_set_muscles(ris_draw *draw, const bool *shown);
/* Leaves the mandible and its teeth out of the skull's layer, to see what lies behind it. */
void ris_draw_set_mandible(ris_draw *draw, bool shown);
/* Which muscle a picture of width x height shows at each pixel (muscle index, UINT32_MAX = none), of the layers and
 * muscles that are shown; bones hide, the skin does not. By the host, at the last tick of sim (width x height). */
ris_result ris_draw_muscle_map(ris_draw *draw, const ris_sim *sim, const ris_camera *camera, uint32_t width,
                               uint32_t height, uint32_t *out, ris_error *err);
/* Draws the present state of sim. A Vulkan sim on the same device is read in place; any other is uploaded. */
ris_result ris_draw_frame(ris_draw *draw, ris_sim *sim, const ris_camera *camera, ris_error *err);
/* The same with positions and normals given (interpolated output frames); (node_count) each, transforms from sim. */
ris_result ris_draw_frame_at(ris_draw *draw, ris_sim *sim, const ris_vec4 *position, const ris_vec4 *normal,
                             const ris_camera *camera, ris_error *err);
/* Copies the last frame, sRGB RGBA8, top row first (width x height x 4). */
ris_result ris_draw_read(ris_draw *draw, uint8_t *out, ris_error *err);

/* A window's swapchain: surface is a VkSurfaceKHR as a 64-bit handle made with ris_device_instance(). */
void *ris_device_instance(ris_device *device);
typedef struct ris_window ris_window;
ris_result ris_window_create(ris_device *device, uint64_t surface, uint32_t width, uint32_t height,
                             ris_window **out, ris_error *err);
/* Shows the last drawn frame; rebuilds the swapchain by itself; a zero-sized (minimised) window is skipped. */
ris_result ris_window_present(ris_window *window, ris_draw *draw, uint32_t width, uint32_t height,
                              ris_error *err);
void ris_window_destroy(ris_window *window);

#ifdef __cplusplus
}
#endif
