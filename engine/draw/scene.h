/* What is drawn, as plain arrays ready for upload: one surface vertex numbering over skin and parts, one corner list, one
 * index list, and a short list of objects. Knows no Vulkan. */
#pragma once

#include "risorius/model.h"

#include "draw_shared.h"

typedef struct ris_draw_item {
    ris_material material;
    ris_bone bone; /* SKIN: already placed by ride.comp (and the skin itself) */
    uint32_t first_index, index_count;
    uint32_t part, first_vertex; /* of the head, UINT32_MAX = the skin; its first surface vertex */
    uint32_t texture;            /* into ris_draw_scene.texture, UINT32_MAX = none */
    ris_vec3 tint, pivot;
} ris_draw_item;

typedef struct ris_draw_scene {
    uint32_t skin_count;   /* surface vertices of the skin, the first ones */
    uint32_t vertex_count; /* surface vertices in all */
    uint32_t term_count, corner_count, index_count, line_count, ride_count, item_count, texture_count,
        ring_count, cast_count;
    uint32_t *term_start; /* (skin_count + 1) */
    ris_draw_term *term;  /* (term_count) */
    uint32_t *ring_start; /* (skin_count + 1) */
    uint32_t *ring;       /* (ring_count x 2) */
    ris_vec4 *fold;       /* as RIS_DRAW_BIND_FOLD (skin_count) */
    ris_vec4 *position;   /* at rest, w 1 (vertex_count) */
    ris_vec4 *normal;     /* at rest, w 0 (vertex_count) */
    ris_vec4 *rest;       /* position at rest, w = visible share of the surroundings, negative in
                           the mouth (vertex_count) */
    ris_draw_corner *corner;
    uint32_t *index; /* triangles into corner (index_count) */
    uint32_t *cast;  /* coarser triangles of the skin for the key light's depth, into corner (cast_count) */
    uint32_t *line;  /* edges of the simulated skin mesh, pairs into corner (line_count) */
    ris_draw_ride *ride;  /* (ride_count) */
    ris_draw_item *item;  /* skin first, then opaque parts, hair, clear parts (item_count) */
    const char **texture; /* paths, each once, owned by the head (texture_count) */
    uint32_t rim[RIS_DRAW_RIM_COUNT][RIS_DRAW_RIM];
    float fade[2];
    ris_vec3 low, high; /* bounds of everything at rest, mm */
} ris_draw_scene;

/* Builds the scene of model's head. RIS_ERROR_MEMORY; on failure *out is zeroed. */
ris_result ris__draw_scene_build(const ris_model *model, ris_draw_scene *out, ris_error *err);
void ris__draw_scene_finish(ris_draw_scene *scene);
