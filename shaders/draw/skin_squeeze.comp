// How the skin is squeezed around each vertex: M = F C^-2 F^T of the deformation F from rest, C = F^T F, both in the tangent
// plane at rest. A fibre that lies along the unit direction g now is 1 / sqrt(g . M g) of its length at rest.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "draw_shared.h"

layout(local_size_x = RIS_DRAW_GROUP) in;
layout(scalar, binding = RIS_DRAW_BIND_POSITION) readonly buffer Position { vec4 position[]; };
layout(scalar, binding = RIS_DRAW_BIND_RING_START) readonly buffer RingStart { uint ring_start[]; };
layout(scalar, binding = RIS_DRAW_BIND_RING) readonly buffer Ring { uint ring[]; };
layout(scalar, binding = RIS_DRAW_BIND_AT_REST) readonly buffer Rest { vec4 rest[]; };
layout(scalar, binding = RIS_DRAW_BIND_SQUEEZE_OUT) writeonly buffer Squeeze { ris_draw_squeeze squeeze[]; };
layout(scalar, binding = RIS_DRAW_BIND_FOLD) readonly buffer Fold { vec4 fold[]; };
layout(scalar, push_constant) uniform Push { ris_draw_count push; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) {
        return;
    }
    vec3 at = position[i].xyz, at_rest = rest[i].xyz, up = vec3(0.0), first = vec3(0.0);
    uint start = ring_start[i], end = ring_start[i + 1u];
    for (uint k = start; k < end; k++) {
        first = rest[ring[2u * k]].xyz - at_rest;
        up += cross(first, rest[ring[2u * k + 1u]].xyz - at_rest);
    }
    ris_draw_squeeze none = ris_draw_squeeze(vec4(1.0, 1.0, 1.0, 0.0), vec4(0.0));
    squeeze[i] = none;
    vec3 u = cross(up, first), v = cross(up, u);
    float lu = length(u), lv = length(v);
    if (!(lu > 0.0) || !(lv > 0.0)) {
        return;
    }
    u /= lu;
    v /= lv;
    // least squares over the neighbours: F (sum r r^T) = sum d r^T
    vec3 du = vec3(0.0), dv = vec3(0.0);
    float ruu = 0.0, ruv = 0.0, rvv = 0.0;
    for (uint k = 2u * start; k < 2u * end; k++) {
        vec3 r = rest[ring[k]].xyz - at_rest, d = position[ring[k]].xyz - at;
        float ru = dot(r, u), rv = dot(r, v);
        du += ru * d;
        dv += rv * d;
        ruu += ru * ru;
        ruv += ru * rv;
        rvv += rv * rv;
    }
    float det = ruu * rvv - ruv * ruv;
    if (!(det > 1e-6 * ruu * rvv)) {
        return;
    }
    vec3 fu = (rvv * du - ruv * dv) / det, fv = (ruu * dv - ruv * du) / det;
    float cuu = dot(fu, fu), cuv = dot(fu, fv), cvv = dot(fv, fv);
    float area = cuu * cvv - cuv * cuv;
    if (!(area > 1e-4)) { // folded flat: no direction left
        return;
    }
    vec3 gu = (cvv * fu - cuv * fv) / area, gv = (cuu * fv - cuv * fu) / area; // F C^-1
    float shorter = 1.0 - length(dot(fold[i].xyz, u) * fu + dot(fold[i].xyz, v) * fv);
    squeeze[i] = ris_draw_squeeze(vec4(gu * gu + gv * gv, shorter),
                                  vec4(gu.x * gu.y + gv.x * gv.y, gu.y * gu.z + gv.y * gv.z, gu.z * gu.x + gv.z * gv.x, 0.0));
}
