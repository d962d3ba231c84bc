// lip_normal (KA-20): the normals of the lips' nodes anew each substep, before contact pushes along them; with the
// normals of the last tick pressed lips would swing for ever.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_TEXEL_FREE) uniform samplerBuffer free_position;
layout(set = 0, binding = RIS_BIND_NORMAL, scalar) writeonly buffer normal_block { vec4 normal[]; };
layout(set = 0, binding = RIS_BIND_RING_START, scalar) readonly buffer ring_start_block { uint ring_start[]; };
layout(set = 0, binding = RIS_BIND_RING, scalar) readonly buffer ring_block { ris_ring ring[]; };
layout(set = 0, binding = RIS_BIND_CONTACT_NODE, scalar) readonly buffer contact_node_block { ris_contact_node contact_node[]; };

void main()
{
    if (gl_GlobalInvocationID.x >= push.lip_node_count) {
        return;
    }
    const uint i = contact_node[gl_GlobalInvocationID.x].node;
    const vec3 p = texelFetch(free_position, int(i)).xyz;
    precise vec3 s = vec3(0.0);
    uint k = ring_start[i];
    const uint end = ring_start[i + 1];
    if (k < end) {
        do {
            const ris_ring t = ring[k];
            precise vec3 u = texelFetch(free_position, int(t.b)).xyz - p;
            precise vec3 v = texelFetch(free_position, int(t.c)).xyz - p;
            s.x = s.x + (u.y * v.z - u.z * v.y);
            s.y = s.y + (u.z * v.x - u.x * v.z);
            s.z = s.z + (u.x * v.y - u.y * v.x);
        } while (++k < end);
    }
    precise float l = sqrt((s.x * s.x + s.y * s.y) + s.z * s.z);
    if (l > 0.0) {
        precise vec3 n = vec3(s.x / l, s.y / l, s.z / l);
        normal[i] = vec4(n, 0.0);
    }
}
