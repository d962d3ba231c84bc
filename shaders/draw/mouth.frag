// Teeth, gums and tongue: wet, darker the deeper in the mouth and the nearer the lips are to each other.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"

layout(scalar, binding = RIS_DRAW_BIND_AT) readonly buffer At { vec4 at[]; };
layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 0) out vec4 out_color;

void main()
{
    vec3 n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    vec3 albedo = base_color(in_uv);
    float depth = max(0.0, view.mouth.x - in_rest.z) / view.mouth.y;
    float gap = 0.0;
    for (int k = 0; k < 3; k++) {
        gap = max(gap, distance(at[view.lip[2 * k]].xyz, at[view.lip[2 * k + 1]].xyz) - view.apart[k]);
    }
    float parted = view.lip[2] == view.lip[3] ? 1.0 : clamp(0.04 + gap / 2.2, 0.04, 1.0);
    float open = (exp(-1.05 * depth) + 0.03) * parted;
    vec3 diffuse = vec3(0.0), shine = vec3(0.0);
    for (int k = 0; k < 2; k++) {
        vec3 l = view.light[k].xyz;
        float shadow = k == 0 ? mix(0.5, 1.0, key_shadow(in_world, n)) : 0.9;
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, l)), vec3(0.35, 0.25, 0.22)) * shadow;
        shine += view.radiance[k].rgb * specular(n, v, l, 0.24, 0.04) * shadow;
    }
    diffuse += ambient(n);
    out_color = vec4(tone(albedo * diffuse * (open * mix(vec3(1.0, 0.70, 0.60), vec3(1.0, 0.95, 0.88), exp(-2.0 * depth)) + (1.0 - open) * parted * vec3(0.09, 0.03, 0.025)) + shine * open * 0.8), 1.0);
}
