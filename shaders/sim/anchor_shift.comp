// anchor_shift (KA-37): over-relaxation, once a tick the node follows its anchor's move; the velocity is untouched.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_BIND_MOVING, scalar) readonly buffer moving_block { uint moving[]; };
layout(set = 0, binding = RIS_BIND_POSITION, scalar) buffer position_block { vec4 position[]; };
layout(set = 0, binding = RIS_BIND_ANCHOR_DELTA, scalar) readonly buffer anchor_delta_block { vec4 anchor_delta[]; };

void main()
{
    if (gl_GlobalInvocationID.x >= push.moving_count) {
        return;
    }
    const uint i = moving[gl_GlobalInvocationID.x];
    const vec4 p = position[i];
    precise vec3 x = p.xyz + anchor_delta[i].xyz;
    position[i] = vec4(x, p.w);
}
