#include "draw/occlusion.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define DIRECTIONS 64
#define SIDE 256     /* pixels of a depth picture */
#define BIAS_MM 1.5f /* a point this near below the nearest surface is seen */

typedef struct view {
    ris_vec3 x, y, z; /* z towards the viewer */
    float scale, cx, cy;
    float *depth; /* (SIDE x SIDE), larger is nearer */
} view;

static float dot(ris_vec3 a, ris_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Directions spread evenly over the sphere (Fibonacci lattice). */
static ris_vec3 direction(int i)
{
    float y = 1.0f - 2.0f * ((float)i + 0.5f) / DIRECTIONS, r = sqrtf(1.0f - y * y);
    float turn = 2.39996323f * (float)i;
    return (ris_vec3){r * cosf(turn), y, r * sinf(turn)};
}

static void aim(view *to, ris_vec3 z)
{
    ris_vec3 up = fabsf(z.y) < 0.9f ? (ris_vec3){0.0f, 1.0f, 0.0f} : (ris_vec3){1.0f, 0.0f, 0.0f};
    ris_vec3 x = {up.y * z.z - up.z * z.y, up.z * z.x - up.x * z.z, up.x * z.y - up.y * z.x};
    float length = sqrtf(dot(x, x));
    to->z = z;
    to->x = (ris_vec3){x.x / length, x.y / length, x.z / length};
    to->y = (ris_vec3){z.y * to->x.z - z.z * to->x.y, z.z * to->x.x - z.x * to->x.z,
                       z.x * to->x.y - z.y * to->x.x};
}

static ris_vec3 project(const view *in, ris_vec3 p)
{
    return (ris_vec3){(dot(p, in->x) - in->cx) * in->scale + 0.5f * SIDE,
                      (dot(p, in->y) - in->cy) * in->scale + 0.5f * SIDE, dot(p, in->z)};
}

static int clamp_pixel(float at)
{
    return at < 0.0f ? 0 : at > SIDE - 1 ? SIDE - 1 : (int)at;
}

static float least(float a, float b, float c)
{
    float m = a < b ? a : b;
    return m < c ? m : c;
}

/* Triangles seen from behind are skipped: a closed surface has a nearer one in front. */
static void fill_triangle(view *in, ris_vec3 a, ris_vec3 b, ris_vec3 c)
{
    float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(area > 1e-6f)) {
        return;
    }
    int x0 = clamp_pixel(least(a.x, b.x, c.x) - 0.5f), x1 = clamp_pixel(-least(-a.x, -b.x, -c.x) + 0.5f);
    int y0 = clamp_pixel(least(a.y, b.y, c.y) - 0.5f), y1 = clamp_pixel(-least(-a.y, -b.y, -c.y) + 0.5f);
    float inverse = 1.0f / area, du = (b.y - c.y) * inverse, dv = (c.y - a.y) * inverse;
    for (int y = y0; y <= y1; y++) {
        float px = (float)x0 + 0.5f, py = (float)y + 0.5f;
        float u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) * inverse;
        float v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) * inverse;
        for (int x = x0; x <= x1; x++, u += du, v += dv) {
            float w = 1.0f - u - v;
            if (u >= 0.0f && v >= 0.0f && w >= 0.0f) {
                float z = u * a.z + v * b.z + w * c.z, *at = &in->depth[y * SIDE + x];
                *at = z > *at ? z : *at;
            }
        }
    }
}

/* at: room for the projected vertices of the largest occluder. */
static void draw_depth(view *in, const ris_occluder *occluder, uint32_t occluder_count, ris_vec3 *at)
{
    for (int i = 0; i < SIDE * SIDE; i++) {
        in->depth[i] = -FLT_MAX;
    }
    for (uint32_t o = 0; o < occluder_count; o++) {
        const ris_occluder *from = &occluder[o];
        for (uint32_t i = 0; i < from->position_count; i++) {
            at[i] = project(in, from->position[i]);
        }
        for (uint32_t i = 0; i + 2 < from->index_count; i += 3) {
            fill_triangle(in, at[from->index[i]], at[from->index[i + 1]], at[from->index[i + 2]]);
        }
    }
}

/* Centre and half size of everything, so that every direction sees all of it. */
static float bounds(const ris_occluder *occluder, uint32_t occluder_count, ris_vec3 *centre)
{
    ris_vec3 low = {FLT_MAX, FLT_MAX, FLT_MAX}, high = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t o = 0; o < occluder_count; o++) {
        for (uint32_t i = 0; i < occluder[o].position_count; i++) {
            ris_vec3 p = occluder[o].position[i];
            low = (ris_vec3){fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z)};
            high = (ris_vec3){fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z)};
        }
    }
    *centre = (ris_vec3){0.5f * (low.x + high.x), 0.5f * (low.y + high.y), 0.5f * (low.z + high.z)};
    ris_vec3 size = {high.x - low.x, high.y - low.y, high.z - low.z};
    return 0.5f * sqrtf(dot(size, size));
}

/* Share of the four pixels around p that see it. */
static float visible(const view *in, ris_vec3 p)
{
    ris_vec3 at = project(in, p);
    int x = (int)floorf(at.x - 0.5f), y = (int)floorf(at.y - 0.5f);
    float seen = 0.0f;
    for (int k = 0; k < 4; k++) {
        int px = x + (k & 1), py = y + (k >> 1);
        bool inside = px >= 0 && py >= 0 && px < SIDE && py < SIDE;
        seen += !inside || at.z + BIAS_MM >= in->depth[py * SIDE + px] ? 0.25f : 0.0f;
    }
    return seen;
}

ris_result ris__occlusion(const ris_occluder *occluder, uint32_t occluder_count, const ris_vec3 *point,
                          const ris_vec3 *normal, uint32_t point_count, float *out, ris_error *err)
{
    view in = {.depth = malloc(SIDE * SIDE * sizeof *in.depth)};
    float *total = calloc(point_count + 1, sizeof *total);
    uint32_t largest = 1;
    for (uint32_t o = 0; o < occluder_count; o++) {
        largest = occluder[o].position_count > largest ? occluder[o].position_count : largest;
    }
    ris_vec3 *at = malloc(largest * sizeof *at);
    if (in.depth == NULL || total == NULL || at == NULL) {
        free(at);
        free(in.depth);
        free(total);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the occlusion of %u points",
                        (unsigned)point_count);
    }
    ris_vec3 centre;
    float radius = bounds(occluder, occluder_count, &centre);
    in.scale = radius > 0.0f ? 0.5f * SIDE / (radius * 1.02f) : 1.0f;
    for (uint32_t i = 0; i < point_count; i++) {
        out[i] = 0.0f;
    }
    for (int d = 0; d < DIRECTIONS; d++) {
        aim(&in, direction(d));
        in.cx = dot(centre, in.x);
        in.cy = dot(centre, in.y);
        draw_depth(&in, occluder, occluder_count, at);
        for (uint32_t i = 0; i < point_count; i++) {
            float facing = dot(normal[i], in.z);
            if (facing > 0.0f) {
                ris_vec3 n = normal[i], p = point[i];
                ris_vec3 lifted = {p.x + 0.5f * n.x, p.y + 0.5f * n.y, p.z + 0.5f * n.z};
                total[i] += facing;
                out[i] += facing * visible(&in, lifted);
            }
        }
    }
    for (uint32_t i = 0; i < point_count; i++) {
        out[i] = total[i] > 0.0f ? out[i] / total[i] : 1.0f;
    }
    free(at);
    free(in.depth);
    free(total);
    return RIS_OK;
}
