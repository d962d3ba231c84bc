// The simulated mesh as lines, drawn slightly nearer than the surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_vertex.glsl"

void main()
{
    vec3 world = world_point(at[corner[gl_VertexIndex].vertex].xyz);
    gl_Position = rows(view.clip[0], view.clip[1], view.clip[2], view.clip[3], vec4(mix(world, view.eye.xyz, 0.002), 1.0));
}
