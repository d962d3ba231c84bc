// spring_force (KA-11, KA-12, KA-14, KA-15, KA-16; docs/physics.md): all forces on a node but damping.
// Operation order: docs/physics.md. Gather in CSR order, no atomics, everything precise.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"
#include "half_spring.glsl"

layout(set = 0, binding = RIS_BIND_MOVING, scalar) readonly buffer moving_block { uint moving[]; };
layout(set = 0, binding = RIS_TEXEL_POSITION) uniform samplerBuffer position;
layout(set = 0, binding = RIS_BIND_FORCE, scalar) writeonly buffer force_block { vec4 force[]; };
layout(set = 0, binding = RIS_TEXEL_BEND) uniform samplerBuffer bend;
layout(set = 0, binding = RIS_BIND_SPRING_START, scalar) readonly buffer spring_start_block { uint spring_start[]; };
layout(set = 0, binding = RIS_BIND_ANCHOR_PARAM, scalar) readonly buffer anchor_param_block { ris_anchor_param anchor_param[]; };
layout(set = 0, binding = RIS_BIND_ANCHOR_POINT, scalar) readonly buffer anchor_point_block { ris_anchor_point anchor_point[]; };

// The tissue of the model, fixed when the pipeline is made: wide devices without branches would compute both.
layout(constant_id = RIS_CONSTANT_KAEHLER) const bool KAEHLER = false;
layout(constant_id = RIS_CONSTANT_CONTINUOUS) const bool CONTINUOUS = true;

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
    } else if (CONTINUOUS) {
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
    if (gl_GlobalInvocationID.x >= push.moving_count) {
        return;
    }
    const uint i = moving[gl_GlobalInvocationID.x];
    const vec3 x = texelFetch(position, int(i)).xyz;
    precise vec3 f = vec3(0.0);
    precise vec3 g = vec3(0.0);
    uint h = spring_start[i];
    const uint end = spring_start[i + 1];
    if (h < end) {
        do {
            const ris_half_spring s = half_spring(h);
            precise vec3 d = texelFetch(position, int(s.other)).xyz - x;
            precise float l = sqrt(dot3(d, d));
            precise float q = 0.0;
            precise float shortest = TINY * s.rest_mm;
            if (!(l < shortest)) {
                q = (s.area_ratio * tension(l, s.rest_mm)) / l;
            }
            f = f + q * d;
            if (!KAEHLER) {
                g = g + s.bend_in * texelFetch(bend, int(s.other)).xyz;
            }
        } while (++h < end);
    }
    const ris_anchor_param a = anchor_param[i];
    const ris_anchor_point at = anchor_point[i];
    if (KAEHLER) {
        f = f + pair_force(x, at.a.xyz, a.normal, a.rest_mm);
        f = f + pair_force(x, at.b.xyz, a.normal, a.rest_mm);
    } else {
        f = f + (a.bend * texelFetch(bend, int(i)).xyz - g);
        precise vec3 d = x - at.a.xyz;
        precise float c = dot3(at.b.xyz, d);
        precise vec3 m = c * at.b.xyz;
        f = f - (a.normal * m + a.tangential * (d - m));
    }
    force[i] = vec4(f, 0.0);
}
