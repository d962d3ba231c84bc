// Vertex pulling: corner -> surface vertex -> world.
layout(scalar, binding = RIS_DRAW_BIND_AT) readonly buffer At { vec4 at[]; };
layout(scalar, binding = RIS_DRAW_BIND_FACING) readonly buffer Facing { vec4 facing[]; };
layout(scalar, binding = RIS_DRAW_BIND_REST) readonly buffer Rest { vec4 rest[]; };
layout(scalar, binding = RIS_DRAW_BIND_CORNER) readonly buffer Corner { ris_draw_corner corner[]; };

vec3 world_point(vec3 p)
{
    vec4 v = vec4(p, 1.0);
    return vec3(dot(object.place[0], v), dot(object.place[1], v), dot(object.place[2], v));
}

vec3 world_direction(vec3 d)
{
    return vec3(dot(object.place[0].xyz, d), dot(object.place[1].xyz, d), dot(object.place[2].xyz, d));
}
