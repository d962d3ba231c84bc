/* Noise of the painter: gradient and cellular noise over integer hashes, so that textures are the same
 * everywhere. */
#include "paint.h"

#include <math.h>

float ris_paint_length(ris_vec3 a)
{
    return sqrtf(vec3_dot(a, a));
}

ris_vec3 ris_paint_unit(ris_vec3 a)
{
    const float length = ris_paint_length(a);
    return length > 1e-12f ? vec3_scale(a, 1.0f / length) : vec3(0, 0, 1);
}

float ris_paint_clamp(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

float ris_paint_mix(float a, float b, float t)
{
    return a + (b - a) * t;
}

float ris_paint_step(float edge0, float edge1, float x)
{
    const float t = ris_paint_clamp((x - edge0) / (edge1 - edge0), 0, 1);
    return t * t * (3 - 2 * t);
}

float ris_paint_blob(ris_vec3 p, ris_vec3 centre, float radius)
{
    const ris_vec3 d = vec3_sub(p, centre);
    return expf(-vec3_dot(d, d) / (radius * radius));
}

float ris_paint_capsule(ris_vec3 p, ris_vec3 a, ris_vec3 b, float radius)
{
    const ris_vec3 along = vec3_sub(b, a);
    const float square = vec3_dot(along, along);
    const float t = square > 0 ? ris_paint_clamp(vec3_dot(vec3_sub(p, a), along) / square, 0, 1) : 0;
    return ris_paint_blob(p, vec3_add(a, vec3_scale(along, t)), radius);
}

uint32_t ris_paint_hash(int32_t x, int32_t y, int32_t z, uint32_t seed)
{
    uint32_t h = seed * 0x9e3779b9u ^ (uint32_t)x * 0x85ebca6bu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du ^ (uint32_t)y * 0xc2b2ae35u;
    h = (h ^ (h >> 13)) * 0x297a2d39u ^ (uint32_t)z * 0x27d4eb2fu;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

/* dot of the corner's gradient (one of the 12 cube edges) with the offset */
static float corner(int32_t x, int32_t y, int32_t z, uint32_t seed, float dx, float dy, float dz)
{
    const uint32_t h = ris_paint_hash(x, y, z, seed) & 15u;
    const float u = h < 8 ? dx : dy;
    const float v = h < 4 ? dy : h == 12 || h == 14 ? dx : dz;
    return ((h & 1u) ? -u : u) + ((h & 2u) ? -v : v);
}

static float fade(float t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

float ris_paint_noise(ris_vec3 p, uint32_t seed)
{
    const float fx = floorf(p.x), fy = floorf(p.y), fz = floorf(p.z);
    const int32_t x = (int32_t)fx, y = (int32_t)fy, z = (int32_t)fz;
    const float dx = p.x - fx, dy = p.y - fy, dz = p.z - fz;
    const float u = fade(dx), v = fade(dy), w = fade(dz);
    float plane[2];
    for (int k = 0; k < 2; k++) {
        const float a = ris_paint_mix(corner(x, y, z + k, seed, dx, dy, dz - (float)k),
                                      corner(x + 1, y, z + k, seed, dx - 1, dy, dz - (float)k), u);
        const float b = ris_paint_mix(corner(x, y + 1, z + k, seed, dx, dy - 1, dz - (float)k),
                                      corner(x + 1, y + 1, z + k, seed, dx - 1, dy - 1, dz - (float)k), u);
        plane[k] = ris_paint_mix(a, b, v);
    }
    return ris_paint_mix(plane[0], plane[1], w);
}

float ris_paint_fbm(ris_vec3 p, int octaves, uint32_t seed)
{
    float sum = 0, strength = 1, total = 0;
    for (int i = 0; i < octaves; i++) {
        sum += strength * ris_paint_noise(p, seed + (uint32_t)i * 101u);
        total += strength;
        strength *= 0.55f;
        p = vec3_scale(p, 2.03f);
    }
    return 1.6f * sum / total;
}

ris_paint_cell ris_paint_cells(ris_vec3 p, uint32_t seed)
{
    const int32_t x = (int32_t)floorf(p.x), y = (int32_t)floorf(p.y), z = (int32_t)floorf(p.z);
    ris_paint_cell out = {9, 9, 0};
    for (int32_t k = 0; k < 27; k++) {
        const int32_t cx = x + k % 3 - 1, cy = y + k / 3 % 3 - 1, cz = z + k / 9 - 1;
        const uint32_t h = ris_paint_hash(cx, cy, cz, seed);
        const ris_vec3 point =
            vec3((float)cx + (float)(h & 1023u) / 1024.0f, (float)cy + (float)(h >> 10 & 1023u) / 1024.0f,
                 (float)cz + (float)(h >> 20 & 1023u) / 1024.0f);
        const ris_vec3 d = vec3_sub(p, point);
        const float square = vec3_dot(d, d);
        if (square < out.near) {
            out.next = out.near;
            out.near = square;
            out.id = ris_paint_hash(cx, cy, cz, seed + 77u);
        } else if (square < out.next) {
            out.next = square;
        }
    }
    out.near = sqrtf(out.near);
    out.next = sqrtf(out.next);
    return out;
}
