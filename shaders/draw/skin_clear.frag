// Skin as glass over what lies below it: denser where it is seen edge on.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"
#include "draw_skin.glsl"

void main()
{
    float ndv = clamp(dot(normalize(in_normal), normalize(view.eye.xyz - in_world)), 0.0, 1.0);
    float rim = (1.0 - ndv) * (1.0 - ndv);
    float cover = mix(object.pivot.x, 1.0, 0.8 * rim);
    if (view.fade[0] < view.fade[1]) {
        cover *= smoothstep(view.fade[0], view.fade[1], in_rest.y);
    }
    out_color = vec4(skin_color(), cover);
}
