// normal (KA-20): area-weighted vertex normal, gathered over the triangles around the node.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_TEXEL_POSITION) uniform samplerBuffer position;
layout(set = 0, binding = RIS_BIND_NORMAL, scalar) writeonly buffer normal_block { vec4 normal[]; };
layout(set = 0, binding = RIS_BIND_RING_START, scalar) readonly buffer ring_start_block { uint ring_start[]; };
layout(set = 0, binding = RIS_BIND_RING, scalar) readonly buffer ring_block { ris_ring ring[]; };

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.node_count) {
        return;
    }
    const vec3 p = texelFetch(position, int(i)).xyz;
    precise vec3 s = vec3(0.0);
    uint k = ring_start[i];
    const uint end = ring_start[i + 1];
    if (k < end) {
        do {
            const ris_ring t = ring[k];
            precise vec3 u = texelFetch(position, int(t.b)).xyz - p;
            precise vec3 v = texelFetch(position, int(t.c)).xyz - p;
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
