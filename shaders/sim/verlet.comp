// verlet (KA-17, KA-18): leapfrog with the damping speed extrapolated from the last two half steps, and what is felt of
// the head's motion (head_inertia).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_BIND_MOVING, scalar) readonly buffer moving_block { uint moving[]; };
layout(set = 0, binding = RIS_BIND_POSITION, scalar) buffer position_block { vec4 position[]; };
layout(set = 0, binding = RIS_BIND_VELOCITY_HALF, scalar) buffer velocity_half_block { vec4 velocity_half[]; };
layout(set = 0, binding = RIS_BIND_VELOCITY_PREV, scalar) buffer velocity_prev_block { vec4 velocity_prev[]; };
layout(set = 0, binding = RIS_BIND_FREE, scalar) writeonly buffer free_block { vec4 free_position[]; };
layout(set = 0, binding = RIS_BIND_FORCE, scalar) readonly buffer force_block { vec4 force[]; };
layout(set = 0, binding = RIS_BIND_INERTIA, scalar) uniform inertia_block { ris_inertia inertia[1]; };
layout(set = 0, binding = RIS_BIND_HEFT, scalar) readonly buffer heft_block { float heft[]; };

float felt(vec4 row, vec3 x)
{
    precise float a = ((row.x * x.x + row.y * x.y) + row.z * x.z) + row.w;
    return a;
}

void main()
{
    if (gl_GlobalInvocationID.x >= push.moving_count) {
        return;
    }
    const uint i = moving[gl_GlobalInvocationID.x];
    const vec4 p = position[i];
    const vec3 h = velocity_half[i].xyz;
    precise vec3 v = 1.5 * h - 0.5 * velocity_prev[i].xyz;
    const ris_inertia head = inertia[0];
    precise vec3 b = vec3(felt(head.row_x, p.xyz), felt(head.row_y, p.xyz), felt(head.row_z, p.xyz));
    precise vec3 a = (p.w * force[i].xyz - push.damping_per_s * v) + heft[i] * b;
    precise vec3 u = h + push.dt_s * a;
    precise vec3 x = p.xyz + push.dt_s * u;
    velocity_prev[i] = vec4(h, 0.0);
    velocity_half[i] = vec4(u, 0.0);
    position[i] = vec4(x, p.w);
    free_position[i] = vec4(x, p.w); // for contact, which overwrites position
}
