/* Structs, bindings and sizes of the raster pass, read by C and GLSL. layout(scalar). */
/* clang-format off */ /* the macros below read as structs to C and GLSL, not to the formatter */
#ifndef RIS_DRAW_SHARED_H
#define RIS_DRAW_SHARED_H

#ifdef RIS_GLSL
#define RIS_DRAW_STRUCT(name) struct name
#define RIS_DRAW_STRUCT_END(name)
#define ris_draw_v4 vec4
#define ris_draw_uint uint
#define ris_draw_float float
#else
#include <stdint.h>
#include "risorius/base.h"
#define RIS_DRAW_STRUCT(name) typedef struct name
#define RIS_DRAW_STRUCT_END(name) name
#define ris_draw_v4 ris_vec4
#define ris_draw_uint uint32_t
#define ris_draw_float float
#endif

#define RIS_DRAW_GROUP 64
#define RIS_DRAW_STRAIN_FULL 0.4 /* RIS_STRAIN_FULL of risorius/draw.h */

/* Set 0 of refine.comp, surface_normal.comp, skin_squeeze.comp, fold.comp and ride.comp; all storage buffers. "Surface" vertices are what is drawn: the
 * refined skin first, then the parts. */
#define RIS_DRAW_BIND_NODE 0       /* vec4 (node_count): simulated positions, mm */
#define RIS_DRAW_BIND_TERM_START 1 /* uint (skin surface vertices + 1) */
#define RIS_DRAW_BIND_TERM 2       /* ris_draw_term */
#define RIS_DRAW_BIND_POSITION 3   /* vec4 (surface vertices), mm */
#define RIS_DRAW_BIND_NORMAL 4     /* vec4 (surface vertices), unit */
#define RIS_DRAW_BIND_RING_START 5 /* uint (skin surface vertices + 1) */
#define RIS_DRAW_BIND_RING 6       /* uint pairs: next and previous vertex of each face around a vertex */
#define RIS_DRAW_BIND_RIDE 7       /* ris_draw_ride */
#define RIS_DRAW_BIND_AT_REST 8    /* vec4 (surface vertices): as RIS_DRAW_BIND_REST */
#define RIS_DRAW_BIND_SQUEEZE_OUT 9 /* ris_draw_squeeze (skin surface vertices) */
#define RIS_DRAW_BIND_FOLD 10       /* vec4 (skin surface vertices): direction across a painted line at rest, w = mm out when folded */
#define RIS_DRAW_BIND_COMPUTE_COUNT 11

/* Set 0 of the graphics stages. */
#define RIS_DRAW_BIND_FRAME 0  /* ris_draw_view */
#define RIS_DRAW_BIND_AT 1     /* vec4 (surface vertices): position */
#define RIS_DRAW_BIND_FACING 2 /* vec4 (surface vertices): normal */
#define RIS_DRAW_BIND_REST                                                                                   \
    3 /* vec4 (surface vertices): position at rest, w = visible share of the surroundings, negative where
         the lips cover it */
#define RIS_DRAW_BIND_CORNER 4 /* ris_draw_corner */
#define RIS_DRAW_BIND_SQUEEZE 5 /* ris_draw_squeeze (skin surface vertices) */
#define RIS_DRAW_BIND_COLOR 6   /* texture, sRGB; the buffers come before it */
#define RIS_DRAW_BIND_DETAIL 7  /* texture beside it, linear: R height (0.5 = mean), G oil, B thinness */
#define RIS_DRAW_BIND_WRINKLE 8 /* texture beside it, linear: R height of fully squeezed skin */
#define RIS_DRAW_BIND_SHADOW 9  /* depth picture from the key light */
#define RIS_DRAW_BIND_GRAPHICS_COUNT 10

#define RIS_DRAW_RIM 16 /* points around an opening of the skin */
#define RIS_DRAW_RIM_MOUTH 0
#define RIS_DRAW_RIM_EYE_L 1
#define RIS_DRAW_RIM_EYE_R 2
#define RIS_DRAW_RIM_COUNT 3

#define RIS_DRAW_WRINKLE_FLAT 0.75 /* height where the skin does not fold */
#define RIS_DRAW_WRINKLE_MM 2.0    /* between black and white of the wrinkle texture, fully squeezed */
#define RIS_DRAW_FOLD_FROM 0.03    /* shares by which the skin is shorter: folding begins */
#define RIS_DRAW_FOLD_FULL 0.24    /* and is whole */

/* How the skin is squeezed at a vertex (skin_squeeze.comp): the symmetric M with g . M g = 1 / stretch^2 along the unit
 * direction g. */
RIS_DRAW_STRUCT(ris_draw_squeeze)
{
    ris_draw_v4 own;   /* xx, yy, zz, share by which the skin is shorter across the painted line */
    ris_draw_v4 mixed; /* xy, yz, zx, - */
}
RIS_DRAW_STRUCT_END(ris_draw_squeeze);

/* One node's share of a surface vertex. */
RIS_DRAW_STRUCT(ris_draw_term)
{
    ris_draw_uint source;
    ris_draw_float weight;
}
RIS_DRAW_STRUCT_END(ris_draw_term);

/* A vertex of a skin-bound part on a triangle of the skin surface (engine/sim/ride.h). */
RIS_DRAW_STRUCT(ris_draw_ride)
{
    ris_draw_uint a, b, c, target; /* skin surface vertices, surface vertex written */
    ris_draw_v4 share;             /* barycentric, w unused */
    ris_draw_v4 offset;            /* mm in the triangle's frame, w unused */
    ris_draw_v4 still;             /* the same at rest, mm; w = share of the triangle's turn that it follows */
    ris_draw_v4 normal;            /* unit, in the triangle's frame, w unused */
}
RIS_DRAW_STRUCT_END(ris_draw_ride);

/* What one drawn triangle corner needs: a surface vertex and its place in the texture (v down). */
RIS_DRAW_STRUCT(ris_draw_corner)
{
    ris_draw_uint vertex;
    ris_draw_float u, v;
}
RIS_DRAW_STRUCT_END(ris_draw_corner);

/* Push constants of the compute stages. */
RIS_DRAW_STRUCT(ris_draw_count)
{
    ris_draw_uint count;
}
RIS_DRAW_STRUCT_END(ris_draw_count);

/* Everything that is the same for the whole frame. Matrices as rows: clip = row . (position, 1). */
RIS_DRAW_STRUCT(ris_draw_view)
{
    ris_draw_v4 clip[4];   /* world to clip space */
    ris_draw_v4 shadow[4]; /* world to the key light's clip space */
    ris_draw_v4 eye;       /* camera, mm; w = tangent of half the vertical field of view */
    ris_draw_v4
        light[3]; /* key, fill, rim: unit direction towards the light, w = half angle of the lamp, radians */
    ris_draw_v4 radiance[3]; /* linear RGB, w unused */
    ris_draw_v4 sky, ground; /* ambient from above and below, linear RGB */
    ris_draw_v4 head[3];     /* rows: the skin's space to world */
    ris_draw_uint rim[RIS_DRAW_RIM_COUNT * RIS_DRAW_RIM]; /* surface vertices around mouth and lids (engine/draw/openings.h); equal = none */
    ris_draw_float paper;    /* grey of a flat backdrop, 0 = studio */
    ris_draw_float
        fade[2];      /* the bust melts into the backdrop between these heights at rest, mm; equal = never */
    ris_draw_v4 size; /* width, height in pixels, shadow texels per side, mm per shadow texel */
}
RIS_DRAW_STRUCT_END(ris_draw_view);

/* Push constants of the graphics stages: one object. */
RIS_DRAW_STRUCT(ris_draw_object)
{
    ris_draw_v4 place[3]; /* rows: bone, then head pose */
    ris_draw_v4 tint;     /* linear RGB where there is no texture; w = 1 with a texture */
    ris_draw_v4 pivot;    /* centre of an eye at rest, mm; w = relief of the detail texture, mm */
}
RIS_DRAW_STRUCT_END(ris_draw_object);

#ifdef RIS_GLSL
#undef RIS_DRAW_STRUCT
#undef RIS_DRAW_STRUCT_END
#endif
#endif
