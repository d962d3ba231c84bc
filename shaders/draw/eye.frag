// Eyeball: painted sclera and iris, shaded by the lids, light gathered on the far side of the iris by the cornea.
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
    float ao = clamp(in_rest.w, 0.5, 1.0); // baked at rest: what a turned eye brings out of the socket is not black
    vec3 local = normalize(in_rest.xyz - object.pivot.xyz);
    float iris = smoothstep(0.82, 0.90, local.z); // the iris covers about 30 degrees around the axis
    float seen = between_lids(in_world, n);
    vec3 diffuse = vec3(0.0), shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz;
        float shadow = k == 0 ? mix(0.35 * seen, mix(seen, 1.0, 0.3), key_shadow(in_world, n)) : seen;
        vec3 gathered = normalize(n - 0.55 * iris * l + 0.55 * iris * dot(n, l) * n);
        float ndl = mix(dot(n, l), 0.6 * dot(gathered, l) + 0.4, iris);
        diffuse += view.radiance[k].rgb * wrapped(vec3(ndl), vec3(0.45, 0.36, 0.33)) * shadow;
        shine += view.radiance[k].rgb * specular(n, v, l, 0.22, 0.025) * shadow * (1.0 - iris);
    }
    diffuse += ambient(n) * seen;
    vec3 lids = pow(vec3(ao), vec3(1.05, 1.25, 1.3)) * 0.92;
    diffuse *= 1.0 + 0.35 * iris;
    out_color = vec4(tone(albedo * diffuse * lids + shine * ao * 2.0), 1.0);
}
