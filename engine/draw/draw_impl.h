/* Inside of ris_draw. One picture: frame.c. What is drawn: scene.h. Structs shared with shaders: draw_shared.h. */
#pragma once

#include "risorius/draw.h"

#include "draw/layers.h"
#include "draw/scene.h"
#include "vk/vk.h"

#define RIS_DRAW_COLOR_FORMAT VK_FORMAT_R8G8B8A8_SRGB
#define RIS_DRAW_DEPTH_FORMAT VK_FORMAT_D32_SFLOAT
#define RIS_DRAW_SHADOW_SIDE 640u

/* Images of one size. color is the resolved picture; it rests in TRANSFER_SRC_OPTIMAL between frames. */
typedef struct ris_draw_target {
    uint32_t width, height;
    ris_vk_image many, depth, color; /* many: 4 samples a pixel */
    ris_vk_buffer readback;
} ris_draw_target;

/* The graphics pipelines, in drawing order. */
typedef enum ris_draw_pipe {
    RIS_DRAW_PIPE_SHADOW,
    RIS_DRAW_PIPE_BACKGROUND,
    RIS_DRAW_PIPE_SKIN,
    RIS_DRAW_PIPE_EYE,
    RIS_DRAW_PIPE_MOUTH,
    RIS_DRAW_PIPE_HAIR,
    RIS_DRAW_PIPE_CORNEA,
    RIS_DRAW_PIPE_WIRE,
    RIS_DRAW_PIPE_COUNT
} ris_draw_pipe;

/* The scene on the device. */
typedef struct ris_draw_store {
    ris_vk_buffer node; /* uploaded positions of a simulation elsewhere (UPLOAD) */
    ris_vk_buffer view; /* ris_draw_view (UPLOAD) */
    ris_vk_buffer term_start, term, ring_start, ring, ride;
    ris_vk_buffer position, normal, rest, squeeze, fold, corner, index, line, cast;
    ris_vk_image *texture;          /* (texture_count + 1), the last one white */
    ris_vk_image *detail, *wrinkle; /* beside each; without handle where there is none; the last one flat */
    uint32_t texture_count;
    VkSampler sampler, shadow_sampler;
} ris_draw_store;

struct ris_draw {
    ris_device *device;
    const ris_model *model;
    ris_draw_scene scene; /* items and counts; the big arrays are freed once uploaded */
    ris_draw_store store;
    ris_draw_target target;
    ris_vk_image shadow;
    ris_vk_sets compute_sets;
    ris_vk_sets *graphics_sets; /* one set per texture (store.texture_count + 1) */
    VkPipelineLayout compute_layout, graphics_layout;
    VkPipeline refine, normal, squeeze, fold, ride;
    VkPipeline pipe[RIS_DRAW_PIPE_COUNT];
    ris_vk_cmd cmd, copy;
    ris_draw_layers layers;
    uint32_t shown; /* ris_layer mask */
    bool wireframe, paper, drawn;
    bool jawless; /* no mandible in the layer of the skull */
};

/* store.c */
ris_result ris__draw_store_create(ris_draw *draw, ris_error *err);
void ris__draw_store_finish(ris_draw *draw);
/* texture.c: an image file with mips. RIS_ERROR_DATA names the file. */
ris_result ris__draw_texture_load(ris_device *device, const char *path, VkFormat format, ris_vk_image *out,
                                  ris_error *err);
/* One pixel. */
ris_result ris__draw_texture_plain(ris_device *device, const uint8_t rgba[4], VkFormat format,
                                   ris_vk_image *out, ris_error *err);
/* A linear texture beside a colour texture: "<stem>_<kind>.png"; leaves *out zeroed where there is no such file. */
ris_result ris__draw_texture_beside(ris_device *device, const char *color_path, const char *kind,
                                    ris_vk_image *out, ris_error *err);
/* target.c */
ris_result ris__draw_target_create(ris_device *device, uint32_t width, uint32_t height, ris_draw_target *out,
                                   ris_error *err);
void ris__draw_target_finish(ris_device *device, ris_draw_target *target);
/* pipes.c: layouts, sets and pipelines */
ris_result ris__draw_pipes_create(ris_draw *draw, ris_error *err);
void ris__draw_pipes_finish(ris_draw *draw);
/* A pipeline of the picture: mesh.vert, opaque, back faces culled. */
ris_vk_graphics_def ris__draw_picture_def(const ris_draw *draw, ris_vk_code fragment, const char *name);
/* The same with skin.vert, for the skin's own fragments. */
ris_vk_graphics_def ris__draw_skin_def(const ris_draw *draw, ris_vk_code fragment, const char *name);
/* view.c: fills what is the same for the whole frame */
void ris__draw_view_fill(const ris_draw *draw, const ris_camera *camera, const float head[12],
                         ris_draw_view *out);
/* frame.c: one object with the pipeline and the index buffer that are bound; its set when it has nothing special */
void ris__draw_object(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim,
                      const ris_draw_item *item, VkDescriptorSet set);
/* row-major 3x4: bone, then head pose */
void ris__draw_place(const ris_sim *sim, ris_bone bone, float out[12]);
VkDescriptorSet ris__draw_set_of(const ris_draw *draw, const ris_draw_item *item);
/* soft.c: writes the parts that change their shape into the surface; area-weighted normals of a mesh at position */
ris_result ris__draw_soft_record(ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim, ris_error *err);
void ris__soft_normals(const ris_mesh *mesh, const ris_vec4 *position, ris_vec4 *normal);
/* layers.c: makes them on first use; writes what changes every frame. node (node_count) NULL = read from sim. */
ris_result ris__draw_layers_create(ris_draw *draw, ris_error *err);
void ris__draw_layers_finish(ris_draw *draw);
ris_result ris__draw_layers_update(ris_draw *draw, ris_sim *sim, const ris_vec4 *node,
                                   const ris_camera *camera, ris_error *err);
/* layer_pipes.c */
ris_result ris__draw_layer_pipes_create(ris_draw *draw, ris_error *err);
void ris__draw_layer_pipes_finish(ris_draw *draw);
/* layer_frame.c: true when the skin is shown alone; bones and muscles as what casts shadows; everything over the
 * background */
bool ris__draw_is_plain(const ris_draw *draw);
void ris__draw_layer_shadow(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim);
void ris__draw_layer_picture(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim);
