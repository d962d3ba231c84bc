/* Writers: PNG, video through the ffmpeg program, OBJ, PC2. Every file is written beside its place and renamed when whole. */
#pragma once

#include "risorius/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* rgba: sRGB, top row first (width x height x 4). */
ris_result ris_png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                         ris_error *err);

/* mp4 (H.264, yuv420p) by piping raw frames to ffmpeg; even sizes only. */
typedef struct ris_video ris_video;
ris_result ris_video_open(const char *path, uint32_t width, uint32_t height, uint32_t fps, ris_video **out,
                          ris_error *err);
ris_result ris_video_add(ris_video *video, const uint8_t *rgba, ris_error *err);
/* Ends and renames; frees video in any case. */
ris_result ris_video_close(ris_video *video, ris_error *err);
/* Drops the unfinished file; NULL is fine. */
void ris_video_abandon(ris_video *video);

/* PC2 vertex cache (docs/file-formats.md): little-endian, point_count floats xyz per sample. */
typedef struct ris_pc2 ris_pc2;
ris_result ris_pc2_open(const char *path, uint32_t point_count, float start_frame, float rate, ris_pc2 **out,
                        ris_error *err);
ris_result ris_pc2_add(ris_pc2 *cache, const ris_vec4 *position, ris_error *err);
ris_result ris_pc2_close(ris_pc2 *cache, ris_error *err);
void ris_pc2_abandon(ris_pc2 *cache);

/* OBJ with the faces and UVs of mesh and other positions, "%.6f" mm; position (mesh->vertex_count). */
typedef struct ris_obj_object {
    const char *name;
    const ris_mesh *mesh;
    const ris_vec4 *position;
} ris_obj_object;
ris_result ris_obj_write(const char *path, const ris_obj_object *object, uint32_t object_count,
                         ris_error *err);

/* Draws a label with a small built-in font into an RGBA image; white with a dark edge. scale in pixels per font unit. */
void ris_label_draw(uint8_t *rgba, uint32_t width, uint32_t height, int x, int y, int scale,
                    const char *text);
/* The same font in plain ink without an edge, at fractions of a pixel. Capitals are 7 units high. */
void ris_label_ink(uint8_t *rgba, uint32_t width, uint32_t height, float x, float y, float scale,
                   const uint8_t ink[3], const char *text);
float ris_label_width(float scale, const char *text);

#ifdef __cplusplus
}
#endif
