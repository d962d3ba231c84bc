// Skin that has folded: a vertex on a painted line moves in or out as far as the skin is shorter across the line.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "draw_shared.h"

layout(local_size_x = RIS_DRAW_GROUP) in;
layout(scalar, binding = RIS_DRAW_BIND_POSITION) buffer Position { vec4 position[]; };
layout(scalar, binding = RIS_DRAW_BIND_NORMAL) readonly buffer Normal { vec4 normal[]; };
layout(scalar, binding = RIS_DRAW_BIND_SQUEEZE_OUT) readonly buffer Squeeze { ris_draw_squeeze squeeze[]; };
layout(scalar, binding = RIS_DRAW_BIND_FOLD) readonly buffer Fold { vec4 fold[]; };
layout(scalar, push_constant) uniform Push { ris_draw_count push; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count || fold[i].w == 0.0) {
        return;
    }
    // the normals stay those of the smooth skin: the painted slope is shaded by the fragment
    position[i].xyz += normal[i].xyz * (fold[i].w * smoothstep(RIS_DRAW_FOLD_FROM, RIS_DRAW_FOLD_FULL, squeeze[i].own.w));
}
