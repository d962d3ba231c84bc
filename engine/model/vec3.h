/* Small float vectors with a fixed order of operations (docs/physics.md): no libm but sqrtf. */
#pragma once

#include "risorius/base.h"

#include <math.h>

static inline ris_vec3 v3(float x, float y, float z)
{
    ris_vec3 r = {x, y, z};
    return r;
}

static inline ris_vec3 v3_add(ris_vec3 a, ris_vec3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline ris_vec3 v3_sub(ris_vec3 a, ris_vec3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline ris_vec3 v3_scale(ris_vec3 a, float s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}

/* a + s b */
static inline ris_vec3 v3_mad(ris_vec3 a, float s, ris_vec3 b)
{
    return v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

static inline ris_vec3 v3_lerp(ris_vec3 a, ris_vec3 b, float s)
{
    return v3_mad(a, s, v3_sub(b, a));
}

static inline float v3_dot(ris_vec3 a, ris_vec3 b)
{
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

static inline ris_vec3 v3_cross(ris_vec3 a, ris_vec3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float v3_length(ris_vec3 a)
{
    return sqrtf(v3_dot(a, a));
}

static inline float v3_distance(ris_vec3 a, ris_vec3 b)
{
    return v3_length(v3_sub(a, b));
}

/* Unit vector, or fallback when a has no length. */
static inline ris_vec3 v3_unit_or(ris_vec3 a, ris_vec3 fallback)
{
    float l = v3_length(a);
    if (!(l > 0.0f)) {
        return fallback;
    }
    return v3(a.x / l, a.y / l, a.z / l);
}

static inline ris_vec3 v4_xyz(ris_vec4 a)
{
    return v3(a.x, a.y, a.z);
}

static inline ris_vec4 v4_from(ris_vec3 a, float w)
{
    ris_vec4 r = {a.x, a.y, a.z, w};
    return r;
}

static inline float f_clamp(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

static inline float f_min(float a, float b)
{
    return a < b ? a : b;
}

static inline float f_max(float a, float b)
{
    return a > b ? a : b;
}

/* 3x^2 - 2x^3 on the clamped argument. */
static inline float f_smoothstep(float x)
{
    x = f_clamp(x, 0.0f, 1.0f);
    return x * x * (3.0f - 2.0f * x);
}
