/* Layers below and on the skin: their meshes, buffers and pipelines, made on first use. */
#pragma once

#include "draw/marks.h"
#include "draw/muscle_mesh.h"
#include "vk/vk.h"

typedef enum ris_layer_pipe {
    RIS_LAYER_PIPE_BONE,
    RIS_LAYER_PIPE_MUSCLE,
    RIS_LAYER_PIPE_FLAT,
    RIS_LAYER_PIPE_DEPTH, /* of a translucent skin, ahead of it */
    RIS_LAYER_PIPE_CLEAR, /* translucent skin */
    RIS_LAYER_PIPE_STRAIN,
    RIS_LAYER_PIPE_COUNT
} ris_layer_pipe;

typedef struct ris_layer_bone {
    ris_bone bone;
    uint32_t first_index, index_count;
} ris_layer_bone;

/* One vertex numbering: bones (constant), muscles and marks (written every frame). Indices are vertices: corner i is
 * vertex i. */
typedef struct ris_draw_layers {
    bool ready;
    ris_layer_bone bone[2]; /* skull, mandible */
    uint32_t bone_count, bone_vertex_count, bone_index_count;
    uint32_t *bone_index; /* into the vertices of the bones (bone_index_count) */
    ris_muscle_mesh muscles;
    bool *shown; /* (muscle_count) */
    ris_marks marks;
    uint32_t vertex_count, index_count;
    ris_vec4 *node;                       /* node positions on the host (node_count) */
    ris_vk_buffer position, normal, rest; /* as the surface vertices of the scene (UPLOAD) */
    ris_vk_buffer strain;                 /* rest of the skin's surface vertices, x = strain (UPLOAD) */
    ris_vk_buffer corner, index;
    ris_vk_sets set, strain_set;
    VkPipeline pipe[RIS_LAYER_PIPE_COUNT];
} ris_draw_layers;
