/* Outputs of `render`: a video, pictures or a vertex cache, told apart by the name of the file. */
#pragma once

#include "cli.h"
#include "risorius/output.h"

typedef enum render_kind { RENDER_MP4, RENDER_PNG, RENDER_PNG_SEQUENCE, RENDER_PC2 } render_kind;

typedef struct render_out {
    render_kind kind;
    const char *path;
    bool open;
    uint32_t frames; /* written so far */
    uint32_t width, height;
    bool made_directory;
    ris_video *video;
    ris_pc2 *cache;
} render_out;

/* Kind by the name: .mp4, .pc2, .png with one %d or %0Nd for a sequence, .png for one picture. RIS_ERROR_USAGE. */
ris_result render_out_name(render_out *out, const char *path, ris_error *err);
/* True when the output needs pictures, false for a vertex cache. */
bool render_out_draws(const render_out *out);
/* Opens it for pictures of width x height, or for node_count points. Makes the folder of a sequence. */
ris_result render_out_open(render_out *out, uint32_t width, uint32_t height, uint32_t fps,
                           uint32_t node_count, ris_error *err);
/* rgba (width x height x 4) for pictures, position (node_count) for a cache. */
ris_result render_out_frame(render_out *out, const uint8_t *rgba, const ris_vec4 *position, ris_error *err);
/* Completes the file under its name. */
ris_result render_out_close(render_out *out, ris_error *err);
/* Removes what was written; safe in every state, does nothing after a close. */
void render_out_abandon(render_out *out);
