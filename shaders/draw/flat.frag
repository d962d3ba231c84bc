// Springs, landmarks, dowels: their own colour, unlit. rest = linear RGB, opacity.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 0) out vec4 out_color;

void main()
{
    out_color = in_rest;
}
