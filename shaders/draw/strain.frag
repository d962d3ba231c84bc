// Skin coloured by its strain: blue compressed, white at rest, red stretched. rest = strain, height at rest, -, openness.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 0) out vec4 out_color;

void main()
{
    vec3 n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    float s = clamp(in_rest.x / RIS_DRAW_STRAIN_FULL, -1.0, 1.0), ao = clamp(in_rest.w, 0.0, 1.0);
    vec3 albedo = s < 0.0 ? mix(vec3(0.72), vec3(0.02, 0.10, 0.55), -s) : mix(vec3(0.72), vec3(0.62, 0.03, 0.02), s);
    vec3 diffuse = ambient(n) * ao;
    for (int k = 0; k < 2; k++) {
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, view.light[k].xyz)), vec3(0.4)) * mix(ao, 1.0, 0.4);
    }
    float rim = 1.0 - clamp(dot(n, v), 0.0, 1.0);
    float cover = mix(object.pivot.x, 1.0, 0.8 * rim * rim);
    if (view.fade[0] < view.fade[1]) {
        cover *= smoothstep(view.fade[0], view.fade[1], in_rest.y);
    }
    out_color = vec4(tone(albedo * diffuse), cover);
}
