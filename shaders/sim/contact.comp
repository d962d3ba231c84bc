// contact (beyond the thesis; KF-04): nodes stay off the other lip, then out of bone, teeth and eyes. All but a node's own
// place is read from before contact, so the order of nodes means nothing; both ends of an edge give way for its middle.
// Run twice, for the nodes with lips and for those with bodies. Operation order: docs/physics.md.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "stage.glsl"

layout(set = 0, binding = RIS_BIND_POSITION, scalar) buffer position_block { vec4 position[]; };
layout(set = 0, binding = RIS_BIND_VELOCITY_HALF, scalar) buffer velocity_half_block { vec4 velocity_half[]; };
layout(set = 0, binding = RIS_BIND_VELOCITY_PREV, scalar) buffer velocity_prev_block { vec4 velocity_prev[]; };
layout(set = 0, binding = RIS_TEXEL_NORMAL) uniform samplerBuffer normal;
layout(set = 0, binding = RIS_TEXEL_FREE) uniform samplerBuffer free_position;
layout(set = 0, binding = RIS_BIND_CONTACT_NODE, scalar) readonly buffer contact_node_block { ris_contact_node contact_node[]; };
layout(set = 0, binding = RIS_BIND_CONTACT_TOUCH, scalar) readonly buffer contact_touch_block { ris_contact_touch contact_touch[]; };
layout(set = 0, binding = RIS_BIND_CONTACT_OTHER, scalar) readonly buffer contact_other_block { uint contact_other[]; };
layout(set = 0, binding = RIS_TEXEL_CONTACT_GRID) uniform samplerBuffer contact_grid;
layout(set = 0, binding = RIS_BIND_CONTACT_BODY, scalar) uniform contact_body_block { ris_contact_body contact_body[RIS_CONTACT_BODIES]; };

// Which of the two: a device without branches would do both every time.
layout(constant_id = RIS_CONSTANT_LIPS) const bool LIPS = true;

const float SHARE = 0.5; // of what is missing, a substep: each lip gives way by half, and notches cannot throw
const float GLIDE = 0.5; // of its speed a touching node keeps, a substep
const float FILM_MM = 0.1; // that much farther off the moist film still slows, or pressed lips tremble by microns;
const float FILM_WEIGHT_FULL = 0.03; // with less of the other lip near it fades
const float LIP_WEIGHT_FULL = 0.6; // with less of the other lip near, contact fades

// What contact may change of a node.
struct touched {
    vec3 x, half_v, prev_v;
};

float dot3(vec3 a, vec3 b)
{
    precise float d = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return d;
}

// Speed v along what is touched: nothing into it, and half of the rest is lost to the moist film between.
vec3 glide(vec3 n, vec3 v)
{
    precise float c = dot3(n, v);
    if (c < 0.0) {
        precise vec3 u = (v - c * n) * GLIDE;
        return u;
    }
    precise vec3 w = v * GLIDE;
    return w;
}

// Moves the node by amount along the unit vector n and takes the speed against n from it.
void push_off(inout touched t, vec3 n, float amount)
{
    if (amount > 0.0) {
        precise vec3 x = t.x + amount * n;
        t = touched(x, glide(n, t.half_v), glide(n, t.prev_v));
    }
}

void touch_lip(ris_contact_node c, inout touched t)
{
    const vec3 n = texelFetch(normal, int(c.node)).xyz, own = texelFetch(free_position, int(c.node)).xyz;
    precise float radius2 = push.lip_radius_mm * push.lip_radius_mm;
    precise float weight = 0.0;
    precise float dist = 0.0;
    precise vec3 away = vec3(0.0);
    uint k = c.lip_first;
    do { // at least one, or it would not be in the list
        const uint j = contact_other[k];
        const vec3 nj = texelFetch(normal, int(j)).xyz;
        precise vec3 r = own - texelFetch(free_position, int(j)).xyz;
        precise float closeness = 1.0 - dot3(r, r) / radius2;
        precise float along = dot3(n, nj);
        if (closeness > 0.0 && along < 0.0) {
            precise vec3 m = n - nj;
            precise float w = (closeness * closeness) * along;
            precise float q = w / sqrt(dot3(m, m));
            weight = weight - w;
            dist = dist + q * dot3(m, r);
            away = away + q * m;
        }
    } while (++k < c.lip_end);
    precise float l = sqrt(dot3(away, away));
    if (weight > 0.0 && l > 0.0) {
        precise float d = dist / weight;
        precise float gap = d - c.lip_limit_mm;
        if (gap < 0.0) {
            precise float share = SHARE * min(weight / LIP_WEIGHT_FULL, 1.0);
            precise float amount = share * (c.lip_limit_mm - d);
            precise vec3 u = vec3(away.x / l, away.y / l, away.z / l);
            push_off(t, u, amount);
        } else if (gap < FILM_MM) {
            precise float film = (1.0 - gap / FILM_MM) * min(weight / FILM_WEIGHT_FULL, 1.0);
            precise float kept = 1.0 - (1.0 - GLIDE) * film;
            precise vec3 half_v = t.half_v * kept;
            precise vec3 prev_v = t.prev_v * kept;
            t = touched(t.x, half_v, prev_v);
        }
    }
}

// x: the node, or the middle of an edge that goes with it; k: the body.
void touch_body(uint k, vec3 x, float limit, inout touched t)
{
    const ris_contact_body b = contact_body[k];
    precise vec3 p = vec3(((b.row_x.x * x.x + b.row_x.y * x.y) + b.row_x.z * x.z) + b.row_x.w,
                          ((b.row_y.x * x.x + b.row_y.y * x.y) + b.row_y.z * x.z) + b.row_y.w,
                          ((b.row_z.x * x.x + b.row_z.y * x.y) + b.row_z.z * x.z) + b.row_z.w);
    precise vec3 q = (p - b.low.xyz) * b.low.w;
    if (!(q.x >= 0.0 && q.x < float(b.count_x - 1u) && q.y >= 0.0 && q.y < float(b.count_y - 1u) && q.z >= 0.0 &&
          q.z < float(b.count_z - 1u))) {
        return;
    }
    const uvec3 c = uvec3(q);
    precise vec3 f = q - vec3(c);
    const uint row = b.count_x, slice = row * b.count_y;
    const uint v = b.first + c.z * slice + c.y * row + c.x;
    const vec4 v000 = texelFetch(contact_grid, int(v)), v100 = texelFetch(contact_grid, int(v + 1u));
    const vec4 v010 = texelFetch(contact_grid, int(v + row)), v110 = texelFetch(contact_grid, int(v + row + 1u));
    const vec4 v001 = texelFetch(contact_grid, int(v + slice)), v101 = texelFetch(contact_grid, int(v + slice + 1u));
    const vec4 v011 = texelFetch(contact_grid, int(v + slice + row)), v111 = texelFetch(contact_grid, int(v + slice + row + 1u));
    precise vec4 c00 = v000 + f.x * (v100 - v000);
    precise vec4 c10 = v010 + f.x * (v110 - v010);
    precise vec4 c01 = v001 + f.x * (v101 - v001);
    precise vec4 c11 = v011 + f.x * (v111 - v011);
    precise vec4 c0 = c00 + f.y * (c10 - c00);
    precise vec4 c1 = c01 + f.y * (c11 - c01);
    precise vec4 g = c0 + f.z * (c1 - c0);
    if (g.w < limit) {
        precise vec3 w = vec3((b.row_x.x * g.x + b.row_y.x * g.y) + b.row_z.x * g.z,
                              (b.row_x.y * g.x + b.row_y.y * g.y) + b.row_z.y * g.z,
                              (b.row_x.z * g.x + b.row_y.z * g.y) + b.row_z.z * g.z);
        precise float l = sqrt(dot3(w, w));
        if (l > 0.0) {
            precise float amount = SHARE * (limit - g.w);
            precise vec3 n = vec3(w.x / l, w.y / l, w.z / l);
            push_off(t, n, amount);
        }
    }
}

void main()
{
    const uint index = gl_GlobalInvocationID.x + (LIPS ? 0u : push.lip_node_count);
    if (index >= (LIPS ? push.lip_node_count : push.contact_node_count)) {
        return;
    }
    const ris_contact_node c = contact_node[index];
    const vec4 x = position[c.node];
    touched t = touched(x.xyz, velocity_half[c.node].xyz, velocity_prev[c.node].xyz);
    if (LIPS) {
        touch_lip(c, t);
    } else {
        const vec3 own = texelFetch(free_position, int(c.node)).xyz;
        uint k = c.touch_first;
        do { // at least one, or it would not be in the list
            const ris_contact_touch with = contact_touch[k];
            precise vec3 half_edge = (texelFetch(free_position, int(with.other)).xyz - own) * 0.5;
            precise vec3 middle = t.x + half_edge;
            touch_body(with.body, middle, with.limit_mm, t);
        } while (++k < c.touch_end);
    }
    position[c.node] = vec4(t.x, x.w);
    velocity_half[c.node] = vec4(t.half_v, 0.0);
    velocity_prev[c.node] = vec4(t.prev_v, 0.0);
}
