// bend (docs/physics.md): umbrella vector of the displacement, gathered by spring_force. Not run in the kaehler tissue.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"
#include "half_spring.glsl"

layout(set = 0, binding = RIS_BIND_MOVING, scalar) readonly buffer moving_block { uint moving[]; };
layout(set = 0, binding = RIS_TEXEL_POSITION) uniform samplerBuffer position;
layout(set = 0, binding = RIS_TEXEL_REST) uniform samplerBuffer rest;
layout(set = 0, binding = RIS_BIND_BEND, scalar) writeonly buffer bend_block { vec4 bend[]; };
layout(set = 0, binding = RIS_BIND_SPRING_START, scalar) readonly buffer spring_start_block { uint spring_start[]; };

void main()
{
    if (gl_GlobalInvocationID.x >= push.moving_count) {
        return;
    }
    const uint i = moving[gl_GlobalInvocationID.x];
    const vec4 p = texelFetch(position, int(i));
    precise vec3 sum = vec3(0.0);
    precise vec3 own = p.xyz - texelFetch(rest, int(i)).xyz;
    uint h = spring_start[i];
    const uint end = spring_start[i + 1];
    if (h < end) {
        do {
            const ris_half_spring s = half_spring(h);
            precise vec3 far = texelFetch(position, int(s.other)).xyz - texelFetch(rest, int(s.other)).xyz;
            sum = sum + s.bend_out * (far - own);
        } while (++h < end);
    }
    bend[i] = vec4(sum, 0.0);
}
