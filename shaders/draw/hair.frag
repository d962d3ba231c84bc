// Brows and lashes: cards with the texture's alpha, or plain strands; blended.
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
    n = dot(n, v) < 0.0 ? -n : n;
    // without a texture: a strand with v along it, thin and light at its tip
    vec4 texel = object.tint.w > 0.5 ? texture(color_texture, in_uv)
                                     : vec4(object.tint.rgb * (1.6 - 0.6 * in_uv.y), 0.25 + 0.6 * in_uv.y);
    if (texel.a < 0.02) {
        discard;
    }
    vec3 diffuse = ambient(n);
    vec3 shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, view.light[k].xyz)), vec3(0.5));
        shine += view.radiance[k].rgb * specular(n, v, view.light[k].xyz, 0.45, 0.04);
    }
    out_color = vec4(tone((object.tint.w > 0.5 ? linear(texel.rgb) : texel.rgb) * diffuse + 0.35 * shine), texel.a);
}
