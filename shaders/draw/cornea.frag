// Wet, clear shell over the iris: only what it mirrors is seen.
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
    float ndv = clamp(dot(n, v), 0.0, 1.0);
    float fresnel = min(0.03 + 0.97 * fifth(1.0 - ndv), 0.25);
    float ao = clamp(in_rest.w, 0.0, 1.0);
    // lids and lashes are mirrored where they hide the room
    float seen = between_lids(in_world, n), between = seen * seen;
    vec3 mirror = studio(reflect(-v, n)) * (1.6 * fresnel) * mix(0.2, 1.0, smoothstep(0.15, 0.5, ao)) * between;
    float shadow = mix(0.4, 1.0, key_shadow(in_world, n));
    for (int k = 0; k < 2; k++) {
        mirror += view.radiance[k].rgb * specular(n, v, view.light[k].xyz, 0.15, 0.03) * (k == 0 ? shadow : 0.5 * between);
    }
    vec3 shown = tone(mirror * 2.2);
    float cover = max(max(shown.r, shown.g), max(shown.b, 0.0005));
    out_color = vec4(shown / cover, cover);
}
