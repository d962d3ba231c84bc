// Depth from the key light.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_vertex.glsl"

void main()
{
    vec3 world = world_point(at[corner[gl_VertexIndex].vertex].xyz);
    gl_Position = rows(view.shadow[0], view.shadow[1], view.shadow[2], view.shadow[3], vec4(world, 1.0));
}
