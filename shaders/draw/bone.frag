// Bone, and teeth seen without lips: dry, warm white, dark in its hollows.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"
#include "draw_noise.glsl"

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 0) out vec4 out_color;

void main()
{
    vec3 n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    bool tooth = object.tint.w > 0.5;
    float ao = clamp(in_rest.w, 0.0, 1.0);
    float grain = noise3(in_rest.xyz * 0.22) * 0.6 + noise3(in_rest.xyz * 0.9) * 0.4;
    vec3 albedo = base_color(in_uv) * (tooth ? 1.0 : mix(0.86, 1.08, grain));
    vec3 open = pow(vec3(ao), vec3(0.95, 1.15, 1.35));
    float lit = key_shadow(in_world, n);
    vec3 diffuse = ambient(n) * open, shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz, through = k == 0 ? mix(vec3(0.16, 0.12, 0.10) * ao, vec3(1.0), lit) : open;
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, l)), vec3(0.12, 0.09, 0.06)) * through;
        shine += view.radiance[k].rgb * (specular(n, v, l, tooth ? 0.30 : 0.55, 0.04) * (k == 0 ? lit : 0.5) * ao);
    }
    out_color = vec4(melt(tone(albedo * diffuse + shine), in_rest.y), 1.0);
}
