// Neutral grey studio paper.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_light.glsl"

layout(location = 0) out vec4 out_color;

void main()
{
    out_color = vec4(backdrop(gl_FragCoord.xy), 1.0);
}
