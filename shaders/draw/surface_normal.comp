// Smooth normals of the skin surface: area-weighted sum over the faces around each vertex.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "draw_shared.h"

layout(local_size_x = RIS_DRAW_GROUP) in;
layout(scalar, binding = RIS_DRAW_BIND_POSITION) readonly buffer Position { vec4 position[]; };
layout(scalar, binding = RIS_DRAW_BIND_NORMAL) writeonly buffer Normal { vec4 normal[]; };
layout(scalar, binding = RIS_DRAW_BIND_RING_START) readonly buffer RingStart { uint ring_start[]; };
layout(scalar, binding = RIS_DRAW_BIND_RING) readonly buffer Ring { uint ring[]; };
layout(scalar, push_constant) uniform Push { ris_draw_count push; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) {
        return;
    }
    vec3 at = position[i].xyz, sum = vec3(0.0);
    for (uint k = ring_start[i]; k < ring_start[i + 1u]; k++) {
        sum += cross(position[ring[2u * k]].xyz - at, position[ring[2u * k + 1u]].xyz - at);
    }
    float size = length(sum);
    normal[i] = vec4(size > 0.0 ? sum / size : vec3(0.0, 0.0, 1.0), 0.0);
}
