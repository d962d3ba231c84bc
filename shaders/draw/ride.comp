// Skin-bound parts (KA-06): lashes and brows on the triangle of the skin surface they were bound to at rest.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "draw_shared.h"

layout(local_size_x = RIS_DRAW_GROUP) in;
layout(scalar, binding = RIS_DRAW_BIND_POSITION) buffer Position { vec4 position[]; };
layout(scalar, binding = RIS_DRAW_BIND_NORMAL) writeonly buffer Normal { vec4 normal[]; };
layout(scalar, binding = RIS_DRAW_BIND_RIDE) readonly buffer Ride { ris_draw_ride ride[]; };
layout(scalar, push_constant) uniform Push { ris_draw_count push; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) {
        return;
    }
    ris_draw_ride r = ride[i];
    vec3 a = position[r.a].xyz, b = position[r.b].xyz, c = position[r.c].xyz;
    vec3 at = r.share.x * a + r.share.y * b + r.share.z * c;
    vec3 x = b - a, z = cross(x, c - a);
    float lx = length(x), lz = length(z);
    vec3 n = vec3(0.0, 0.0, 1.0);
    if (lx > 0.0 && lz > 0.0) {
        x /= lx;
        z /= lz;
        vec3 y = cross(z, x);
        vec3 away = r.offset.x * x + r.offset.y * y + r.offset.z * z;
        vec3 bent = mix(r.still.xyz, away, r.still.w);
        at += r.still.w < 1.0 && dot(bent, bent) > 0.0 ? normalize(bent) * length(r.still.xyz) : away;
        n = r.normal.x * x + r.normal.y * y + r.normal.z * z;
    }
    position[r.target] = vec4(at, 1.0);
    normal[r.target] = vec4(n, 0.0);
}
