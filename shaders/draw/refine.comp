// Skin surface: each drawn vertex is a fixed weighted sum of simulated nodes (one Catmull-Clark step, engine/draw/refine.h).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "draw_shared.h"

layout(local_size_x = RIS_DRAW_GROUP) in;
layout(scalar, binding = RIS_DRAW_BIND_NODE) readonly buffer Node { vec4 node[]; };
layout(scalar, binding = RIS_DRAW_BIND_TERM_START) readonly buffer TermStart { uint term_start[]; };
layout(scalar, binding = RIS_DRAW_BIND_TERM) readonly buffer Term { ris_draw_term term[]; };
layout(scalar, binding = RIS_DRAW_BIND_POSITION) writeonly buffer Position { vec4 position[]; };
layout(scalar, push_constant) uniform Push { ris_draw_count push; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) {
        return;
    }
    vec3 sum = vec3(0.0);
    for (uint k = term_start[i]; k < term_start[i + 1u]; k++) {
        sum += term[k].weight * node[term[k].source].xyz;
    }
    position[i] = vec4(sum, 1.0);
}
