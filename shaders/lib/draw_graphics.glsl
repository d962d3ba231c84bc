// Blocks that every graphics stage of the raster pass shares.
#extension GL_EXT_scalar_block_layout : require
#include "draw_shared.h"
layout(scalar, binding = RIS_DRAW_BIND_FRAME) readonly buffer Frame { ris_draw_view view; };
layout(scalar, push_constant) uniform Push { ris_draw_object object; };

vec4 rows(vec4 r0, vec4 r1, vec4 r2, vec4 r3, vec4 v)
{
    return vec4(dot(r0, v), dot(r1, v), dot(r2, v), dot(r3, v));
}
