// Muscle: red-brown flesh in bundles along the fibres, pale tendon at its ends, brighter the more it is activated.
// uv = fibres across, mm along; rest = activation, height at rest, tendon, openness.
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

// relief across the fibres: bundles, and finer strands in them
float bundles(vec2 at)
{
    return 0.6 * noise2(vec2(at.x * 3.0, at.y * 0.035)) + 0.4 * noise2(vec2(at.x * 9.0 + 7.0, at.y * 0.07));
}

void main()
{
    vec3 smooth_n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    float action = clamp(in_rest.x, 0.0, 1.0), tendon = clamp(in_rest.z, 0.0, 1.0), ao = clamp(in_rest.w, 0.0, 1.0);
    float height = bundles(in_uv);

    // relief by differences over the pixel (Mikkelsen 2010), gone where a pixel spans whole bundles
    vec3 along_x = dFdx(in_world), along_y = dFdy(in_world);
    vec3 across_x = cross(along_y, smooth_n), across_y = cross(smooth_n, along_x);
    float area = dot(along_x, across_x);
    float near = 1.0 - smoothstep(0.08, 0.35, fwidth(in_uv.x) * 2.0);
    vec3 slope = 0.9 * near * sign(area) * (dFdx(height) * across_x + dFdy(height) * across_y);
    vec3 n = normalize(abs(area) * smooth_n - slope);

    vec3 flesh = mix(vec3(0.118, 0.019, 0.015), vec3(0.30, 0.076, 0.056), height);
    vec3 sinew = mix(vec3(0.46, 0.38, 0.30), vec3(0.62, 0.55, 0.46), height);
    float white = smoothstep(0.15, 0.85, tendon + 0.5 * (height - 0.5) * step(0.001, tendon));
    vec3 albedo = mix(flesh, sinew, white);
    albedo *= mix(vec3(1.0), vec3(2.5, 1.3, 1.15), action * (1.0 - 0.7 * white));

    vec3 open = ao * (vec3(1.3, 0.95, 0.9) - ao * vec3(0.3, -0.05, -0.1));
    float lit = key_shadow(in_world, smooth_n);
    vec3 diffuse = ambient(n) * open, shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz, through = k == 0 ? mix(vec3(0.22, 0.15, 0.13) * ao, vec3(1.0), lit) : open;
        diffuse += view.radiance[k].rgb * wrapped(vec3(dot(n, l)), vec3(0.25, 0.12, 0.10)) * through;
        shine += view.radiance[k].rgb * (specular(n, v, l, 0.42, 0.035) * (k == 0 ? lit : 0.4) * ao);
    }
    out_color = vec4(melt(tone(albedo * diffuse + 0.9 * shine), in_rest.y), 1.0);
}
