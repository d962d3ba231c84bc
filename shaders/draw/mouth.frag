// Teeth, gums and tongue: wet, and darker the deeper in the mouth.
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
    vec3 albedo = base_color(in_uv);
    float depth = max(0.0, view.mouth.x - in_rest.z) / view.mouth.y;
    float open = exp(-1.6 * depth) * 0.9 + 0.03;
    vec3 diffuse = vec3(0.0), shine = vec3(0.0);
    for (int k = 0; k < 2; k++) {
        vec3 l = view.light[k].xyz;
        float shadow = k == 0 ? mix(0.25, 1.0, key_shadow(in_world, n)) : 0.8;
        diffuse += view.radiance[k].rgb * wrapped(dot(n, l), vec3(0.35, 0.25, 0.22)) * shadow;
        shine += view.radiance[k].rgb * specular(n, v, l, 0.24, 0.04) * shadow;
    }
    diffuse += ambient(n) * 0.7;
    out_color = vec4(tone(albedo * diffuse * pow(vec3(open), vec3(0.85, 1.05, 1.05)) + shine * open * 0.8), 1.0);
}
