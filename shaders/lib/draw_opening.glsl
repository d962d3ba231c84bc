// Light through mouth and lids. Needs draw_graphics.glsl and the positions at[].

// Where the light comes from that gets through an opening to a point p, in the skin's space: the mean direction of the
// opening, as long as the share of a lit half space that a surface facing it gets (Lambert's vector for a polygon). Turns
// round where p lies outside. 0 where the opening is shut.
vec3 through_opening(uint which, vec3 p)
{
    uint first = which * RIS_DRAW_RIM;
    vec3 sum = vec3(0.0), last = at[view.rim[first + RIS_DRAW_RIM - 1]].xyz - p;
    last *= inversesqrt(max(dot(last, last), 1e-4));
    for (uint k = 0; k < RIS_DRAW_RIM; k++) {
        vec3 next = at[view.rim[first + k]].xyz - p;
        next *= inversesqrt(max(dot(next, next), 1e-4));
        vec3 across = cross(last, next);
        float size = length(across);
        sum += across * (size > 1e-5 ? atan(size, dot(last, next)) / size : 1.0);
        last = next;
    }
    return sum * 0.15915494;
}

bool has_opening(uint which)
{
    return view.rim[which * RIS_DRAW_RIM] != view.rim[which * RIS_DRAW_RIM + 1];
}

vec3 from_world(vec3 p)
{
    vec3 d = p - vec3(view.head[0].w, view.head[1].w, view.head[2].w);
    return d.x * view.head[0].xyz + d.y * view.head[1].xyz + d.z * view.head[2].xyz;
}

vec3 to_world(vec3 d)
{
    return vec3(dot(view.head[0].xyz, d), dot(view.head[1].xyz, d), dot(view.head[2].xyz, d));
}

// Share of the room that a place on an eye sees between its lids, 1 where they are wide open.
float between_lids(vec3 world, vec3 normal)
{
    uint which = object.pivot.x > 0.0 ? RIS_DRAW_RIM_EYE_L : RIS_DRAW_RIM_EYE_R;
    if (!has_opening(which)) {
        return 1.0;
    }
    vec3 into = through_opening(which, from_world(world));
    float size = length(into), share = dot(normal, to_world(into)) / max(size, 1e-4);
    float open = clamp(1.2 * size * clamp((share + 0.5) / 1.3, 0.0, 1.0), 0.0, 1.0);
    return share < 0.0 ? 1.0 : open * open; // twice: what the lids let in, and what lashes leave of it
}
