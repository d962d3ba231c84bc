// spring_force (KA-11, KA-12, KA-14, KA-15, KA-16; docs/physics.md): all forces on a node but damping.
// Operation order: docs/physics.md. Gather in CSR order, no atomics, everything precise.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_BIND_POSITION, scalar) readonly buffer position_block { vec4 position[]; };
layout(set = 0, binding = RIS_BIND_FORCE, scalar) writeonly buffer force_block { vec4 force[]; };
layout(set = 0, binding = RIS_BIND_BEND, scalar) readonly buffer bend_block { vec4 bend[]; };
layout(set = 0, binding = RIS_BIND_SPRING_START, scalar) readonly buffer spring_start_block { uint spring_start[]; };
layout(set = 0, binding = RIS_BIND_HALF_SPRING, scalar) readonly buffer half_spring_block { ris_half_spring half_spring[]; };
layout(set = 0, binding = RIS_BIND_ANCHOR_PARAM, scalar) readonly buffer anchor_param_block { ris_anchor_param anchor_param[]; };
layout(set = 0, binding = RIS_BIND_ANCHOR_POINT, scalar) readonly buffer anchor_point_block { ris_anchor_point anchor_point[]; };

const float TINY = 1e-6; // shorter than this part of its rest length, a spring has no direction

float dot3(vec3 a, vec3 b)
{
    precise float d = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return d;
}

// Tension of a spring of length l and rest length r, before the area ratio (KA-12), g mm/s^2.
float tension(float l, float r)
{
    precise float t;
    if (l < r) {
        t = (push.compression * push.modulus_low) * (l - r);
    } else if ((push.flags & RIS_TISSUE_FLAG_CONTINUOUS) != 0u) {
        precise float s = push.switch_stretch * r;
        t = push.modulus_low * (min(l, s) - r) + push.modulus_high * max(l - s, 0.0);
    } else {
        precise float s = push.switch_stretch * r;
        t = (l < s ? push.modulus_low : push.modulus_high) * (l - r);
    }
    return t;
}

// One spring of the kaehler anchor pair (KA-15): stiffness k, rest length r, far end a.
vec3 pair_force(vec3 x, vec3 a, float k, float r)
{
    precise vec3 d = a - x;
    precise float l = sqrt(dot3(d, d));
    precise float q = 0.0;
    precise float shortest = TINY * r;
    if (!(l < shortest)) {
        q = (k * (l - r)) / l;
    }
    precise vec3 f = q * d;
    return f;
}

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= push.node_count) {
        return;
    }
    const vec4 p = position[i];
    precise vec3 f = vec3(0.0);
    if (p.w > 0.0) {
        const bool kaehler = (push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0u;
        precise vec3 g = vec3(0.0);
        const uint end = spring_start[i + 1];
        for (uint h = spring_start[i]; h < end; h++) {
            const ris_half_spring s = half_spring[h];
            precise vec3 d = position[s.other].xyz - p.xyz;
            precise float l = sqrt(dot3(d, d));
            precise float q = 0.0;
            precise float shortest = TINY * s.rest_mm;
            if (!(l < shortest)) {
                q = (s.area_ratio * tension(l, s.rest_mm)) / l;
            }
            f = f + q * d;
            if (!kaehler) {
                g = g + s.bend_in * bend[s.other].xyz;
            }
        }
        const ris_anchor_param a = anchor_param[i];
        const ris_anchor_point at = anchor_point[i];
        if (kaehler) {
            f = f + pair_force(p.xyz, at.a.xyz, a.normal, a.rest_mm);
            f = f + pair_force(p.xyz, at.b.xyz, a.normal, a.rest_mm);
        } else {
            f = f + (a.bend * bend[i].xyz - g);
            precise vec3 d = p.xyz - at.a.xyz;
            precise float c = dot3(at.b.xyz, d);
            precise vec3 m = c * at.b.xyz;
            f = f - (a.normal * m + a.tangential * (d - m));
        }
    }
    force[i] = vec4(f, 0.0);
}
