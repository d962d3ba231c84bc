// Skin: light that bleeds into the shadow edge (red farthest), two specular lobes broken up by pores, ambient that
// keeps red in the creases.
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
    vec3 smooth_n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    vec3 albedo = base_color(in_uv);
    float ao = clamp(in_rest.w, 0.0, 1.0);

    // pores, in the skin's own frame; they fade where a pixel covers more than a pore
    float footprint = length(fwidth(in_rest.xyz));
    vec4 coarse = noise3(in_rest.xyz * 0.45), fine = noise3(in_rest.xyz * 1.35);
    float keep = clamp(1.4 - footprint * 0.9, 0.0, 1.0);
    vec3 bump = coarse.yzw * 0.45 * 0.045 + fine.yzw * 1.35 * 0.035 * keep;
    vec3 n = normalize(smooth_n - (bump - smooth_n * dot(bump, smooth_n)));
    vec3 soft = normalize(mix(smooth_n, n, 0.35));

    float rough = 0.50 + 0.06 * coarse.x - 0.05 * fine.x * keep;
    float oil = 0.75 + 0.25 * coarse.x;
    float gloss = ao * ao * oil;

    const vec3 spread = vec3(0.42, 0.16, 0.09);
    vec3 diffuse = vec3(0.0), shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz;
        float shadow = k == 0 ? key_shadow(in_world, smooth_n) : ao;
        // the shadow's edge is red too: skin lets red light through
        vec3 through = pow(vec3(shadow), vec3(0.62, 1.05, 1.25));
        vec3 lambert = vec3(wrapped(dot(soft, l), spread).r, wrapped(dot(n, l), spread).gb);
        diffuse += view.radiance[k].rgb * lambert * through;
        float lobes = 0.80 * specular(n, v, l, rough, 0.028) + 0.28 * specular(n, v, l, rough * 0.62, 0.028);
        shine += view.radiance[k].rgb * lobes * shadow * gloss * 3.14159265;
    }
    vec3 bleed = pow(vec3(ao), vec3(0.75, 1.05, 1.15));
    diffuse += ambient(soft) * bleed;
    // soft reflection of the room at grazing angles
    float grazing = pow(1.0 - clamp(dot(n, v), 0.0, 1.0), 5.0);
    shine += ambient(reflect(-v, n)) * (0.018 + 0.22 * grazing) * ao * ao;
    out_color = vec4(tone(albedo * diffuse + shine), 1.0);
}
