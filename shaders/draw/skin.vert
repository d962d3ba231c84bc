// The skin: as every mesh, and how it is squeezed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_graphics.glsl"
#include "draw_vertex.glsl"
#include "draw_opening.glsl"

layout(scalar, binding = RIS_DRAW_BIND_SQUEEZE) readonly buffer Squeeze { ris_draw_squeeze squeeze[]; };

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec4 out_rest;
layout(location = 4) out vec3 out_squeeze_own;
layout(location = 5) out vec3 out_squeeze_mixed;

void main()
{
    ris_draw_corner c = corner[gl_VertexIndex];
    out_world = world_point(at[c.vertex].xyz);
    out_normal = world_direction(facing[c.vertex].xyz);
    out_uv = vec2(c.u, c.v);
    out_rest = rest[c.vertex];
    if (out_rest.w < 0.0) { // what parting lips uncover is lit as far as they part
        // a little behind it, so that the rim itself lies within
        vec3 into = through_opening(RIS_DRAW_RIM_MOUTH, at[c.vertex].xyz - vec3(0.0, 0.0, 2.5));
        float seen = length(into), facing_it = clamp((dot(facing[c.vertex].xyz, into) / max(seen, 1e-4) + 0.25) / 1.25, 0.0, 1.0);
        float share = sqrt(seen) * smoothstep(0.0, 0.25, seen) * mix(0.6, 1.0, facing_it); // and the walls of the mouth light each other
        out_rest.w = max(-out_rest.w, into.z > 0.0 ? share : min(2.0 * seen, 1.0)); // else it lies before the lips
    }
    out_squeeze_own = squeeze[c.vertex].own.xyz;
    out_squeeze_mixed = squeeze[c.vertex].mixed.xyz;
    gl_Position = rows(view.clip[0], view.clip[1], view.clip[2], view.clip[3], vec4(out_world, 1.0));
}
