// Skin, opaque.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"
#include "draw_skin.glsl"

void main()
{
    out_color = vec4(melt(skin_color(), in_rest.y), 1.0);
}
