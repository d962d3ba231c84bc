// bend (docs/physics.md): umbrella vector of the displacement, gathered by spring_force. Not run in the kaehler tissue.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_BIND_POSITION, scalar) readonly buffer position_block { vec4 position[]; };
layout(set = 0, binding = RIS_BIND_REST, scalar) readonly buffer rest_block { vec4 rest[]; };
layout(set = 0, binding = RIS_BIND_BEND, scalar) writeonly buffer bend_block { vec4 bend[]; };
layout(set = 0, binding = RIS_BIND_SPRING_START, scalar) readonly buffer spring_start_block { uint spring_start[]; };
layout(set = 0, binding = RIS_BIND_HALF_SPRING, scalar) readonly buffer half_spring_block { ris_half_spring half_spring[]; };

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.node_count) {
        return;
    }
    const vec4 p = position[i];
    precise vec3 sum = vec3(0.0);
    if (p.w > 0.0) {
        precise vec3 own = p.xyz - rest[i].xyz;
        const uint end = spring_start[i + 1];
        for (uint h = spring_start[i]; h < end; h++) {
            const uint other = half_spring[h].other;
            precise vec3 far = position[other].xyz - rest[other].xyz;
            sum = sum + half_spring[h].bend_out * (far - own);
        }
    }
    bend[i] = vec4(sum, 0.0);
}
