// Teeth, gums and tongue: wet, lit by what gets in between the lips and by the flesh around.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"

layout(scalar, binding = RIS_DRAW_BIND_AT) readonly buffer At { vec4 at[]; };
#include "draw_opening.glsl"

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 0) out vec4 out_color;

void main()
{
    vec3 n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    vec3 albedo = base_color(in_uv);
    float ao = clamp(in_rest.w, 0.0, 1.0);
    // how much of the room is seen between the lips, and where
    vec3 into = has_opening(RIS_DRAW_RIM_MOUTH) ? through_opening(RIS_DRAW_RIM_MOUTH, from_world(in_world)) : vec3(0.0, 0.0, 1.0);
    float seen = into.z < 0.0 ? 1.0 : length(into); // before the lips
    vec3 middle = seen > 1e-4 && into.z > 0.0 ? to_world(into) / seen : to_world(vec3(0.0, 0.0, 1.0));
    // enamel passes light on: the front of a row stays bright behind a narrow opening, if not behind closed lips
    float spread = sqrt(seen * (2.0 - seen)) * smoothstep(0.0, 0.25, seen);
    float share = spread * clamp((dot(n, middle) + 0.45) / 1.45, 0.0, 1.0) * ao;
    vec3 diffuse = ambient(normalize(n + middle)) * vec3(1.45, 1.38, 1.30) * share, shine = vec3(0.0);
    for (int k = 0; k < 2; k++) {
        vec3 l = view.light[k].xyz;
        // the lamp itself is seen where its shadow is not, and only as far as the opening looks its way
        float reach = smoothstep(0.0, 0.35, seen) * ao;
        float shadow = k == 0 ? mix(0.65 * share, reach, key_shadow(in_world, n)) : 0.9 * share;
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, l)), vec3(0.35, 0.25, 0.22)) * shadow;
        shine += view.radiance[k].rgb * specular(n, v, l, 0.24, 0.04) * shadow;
    }
    // light that came off tongue, gums and cheeks is red, the more the deeper; a row of teeth lights itself, or it looks decayed
    float enamel = smoothstep(0.25, 0.55, min(albedo.r, min(albedo.g, albedo.b)));
    diffuse *= mix(mix(vec3(1.0, 0.72, 0.60), vec3(1.0, 0.88, 0.84), enamel), vec3(1.0), smoothstep(0.05, 0.45, seen));
    vec3 flesh = mix(vec3(0.70, 0.24, 0.17), vec3(1.15, 0.86, 0.80), enamel) * (0.5 + 0.5 * ao) * seen * (2.0 - seen) *
                 (1.0 - 0.7 * share);
    // what is mirrored: the room between the lips, dark flesh beside
    vec3 r = reflect(-v, n);
    float room = smoothstep(0.75 - seen, 1.05 - 0.6 * seen, dot(r, middle)) * seen;
    float fresnel = 0.03 + 0.5 * fifth(1.0 - clamp(dot(n, v), 0.0, 1.0));
    shine += ambient(r) * (fresnel * room);
    out_color = vec4(tone(albedo * (diffuse + flesh) + shine * 0.8), 1.0);
}
