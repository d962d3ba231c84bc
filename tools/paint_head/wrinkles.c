/* Where skin folds when it is squeezed: the lines of the face that stand across the pull of its muscles. One height for all
 * of them, 0.75 = smooth skin, less in a furrow, more on the roll beside it; how deep a line gets is the matter of who draws
 * (docs/drawing.md). Courses: Kraissl, The selection of appropriate lines for elective surgical incisions, 1951, and what
 * Gray's Anatomy says of each muscle's fold. */
#include "paint.h"

#include <math.h>

typedef struct place {
    float x, up,
        s; /* mm on a face of scale 1: sideways from the midline, unsigned; over the line of the eyes */
    int side;
    const ris_paint_surface *surface;
    const ris_paint_site *site;
} place;

/* A furrow and its two rolls at distance d from its middle; about 1 in it, -0.25 on a roll. */
static float furrow(float d, float width)
{
    const float a = d / width, b = (fabsf(d) - 2.1f * width) / (0.9f * width);
    return expf(-a * a) - 0.25f * expf(-b * b);
}

/* 1 between from and to, fading within `soft` mm inside both ends. */
static float between(float from, float to, float soft, float x)
{
    return ris_paint_step(from, from + soft, x) * ris_paint_step(to, to - soft, x);
}

/* Frontalis: across the forehead, higher over each brow's arch, lower at the midline; uneven and broken. */
static float forehead(const place *at, float scalp)
{
    static const float height[4] = {31, 38, 45.5f, 54}, strength[4] = {0.75f, 1.0f, 1.15f, 1.1f};
    float sum = 0;
    for (int k = 0; k < 4; k++) {
        const float seed = (float)k * 7.3f;
        const float arch =
            2.0f * expf(-(at->x - 24) * (at->x - 24) / 340) - 0.6f * expf(-at->x * at->x / 120);
        const float wander = 2.0f * ris_paint_noise(vec3(at->site->p.x / (19 * at->s), seed, 0), 401) +
                             0.5f * ris_paint_noise(vec3(at->site->p.x / (5 * at->s), seed, 0), 409);
        const float end = 50 - 3.0f * (float)k + 4 * ris_paint_noise(vec3(seed, at->site->p.x > 0, 0), 419);
        const float broken = 0.85f + 0.5f * ris_paint_noise(vec3(at->site->p.x / (12 * at->s), seed, 3), 421);
        const float d = at->up - height[k] - arch - wander;
        sum += strength[k] * broken * ris_paint_step(end, end - 26, at->x) * furrow(d, 1.6f);
    }
    return sum * (1 - scalp);
}

/* Corrugators: two upright furrows between the brows, the same on both sides; procerus: across the root of the nose, soft. */
static float glabella(const place *at)
{
    const float wander = 0.5f * ris_paint_noise(vec3(at->x / 6, at->up / 6, 0), 431);
    const float first =
        furrow(at->x - 9.3f - 0.10f * (at->up - 18) + wander, 1.8f) * between(7, 31, 13, at->up);
    const float second =
        furrow(at->x - 14.8f - 0.2f * (at->up - 18) + wander, 1.6f) * between(12, 26, 7, at->up);
    float across = 0;
    static const float height[2] = {1.5f, 7.5f}, strength[2] = {0.34f, 0.30f};
    for (int k = 0; k < 2; k++) {
        const float broken = 0.9f + 0.3f * ris_paint_noise(vec3(at->x / 5, 11.0f * (float)k, 7), 433);
        const float d = at->up - height[k] - 0.022f * at->x * at->x + 1.6f * wander;
        across += strength[k] * broken * furrow(d, 2.0f);
    }
    return 1.3f * first + 0.5f * second + across * ris_paint_step(11, 2, at->x);
}

/* Levator of lip and wing: oblique on the side of the nose. */
static float bunny(const place *at)
{
    float sum = 0;
    for (int k = 0; k < 5; k++) {
        const float wander = 0.9f * ris_paint_noise(vec3(at->x / 4, (float)k * 5.1f, 1), 435);
        const float fall = at->up + 4 + 5.2f * (float)k + 0.75f * (at->x - 6) + wander;
        sum +=
            1.25f * furrow(0.8f * fall, 1.35f) * between(3 + 1.3f * (float)k, 15 + 1.6f * (float)k, 5, at->x);
    }
    return sum;
}

/* Orbital part of orbicularis oculi: rays from the outer corner of the eye, and along the lower lid. */
static float round_the_eye(const place *at)
{
    const ris_vec3 corner = at->surface->at.canthus_outer[at->side], p = at->site->p;
    const float back =
        sqrtf((p.x - corner.x) * (p.x - corner.x) + (p.z - corner.z) * (p.z - corner.z)) / at->s;
    const float u = fabsf(p.x) > fabsf(corner.x) ? back : -back, v = (p.y - corner.y) / at->s;
    const float r = sqrtf(u * u + v * v);
    float sum = 0;
    if (u > 0) {
        static const float ray[5] = {38, 17, -2, -19, -40}, strength[5] = {0.45f, 0.75f, 0.6f, 0.7f, 0.4f};
        const float bend = 7 * ris_paint_noise(vec3_scale(p, 1 / (10 * at->s)), 439) - 0.35f * (r - 12);
        for (int k = 0; k < 5; k++) {
            const float angle = (ray[k] + (k > 2 ? bend : -bend)) / 57.29578f;
            const float d = v * cosf(angle) - u * sinf(angle);
            sum += strength[k] * furrow(d, 0.7f + 0.03f * r) *
                   between(5.5f, 29 - 2.5f * fabsf((float)k - 2), 10, r);
        }
    }
    const float lower = ris_paint_step(0, -4, at->up) * ris_paint_step(17, 12, fabsf(at->x - 31));
    for (int k = 0; k < 3; k++)
        sum += (0.5f - 0.12f * (float)k) * lower * furrow(at->site->lid - 8.2f - 1.9f * (float)k, 0.55f);
    return sum;
}

static float segment_distance(float x, float y, const float a[2], const float b[2], float *along)
{
    const float dx = b[0] - a[0], dy = b[1] - a[1];
    *along = ris_paint_clamp(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy), 0, 1);
    const float px = x - a[0] - *along * dx, py = y - a[1] - *along * dy;
    return sqrtf(px * px + py * py);
}

/* From the wing of the nose round the corner of the mouth. */
static float nasolabial(const place *at)
{
    const ris_paint_landmarks *m = &at->surface->at;
    const float wing[2] = {fabsf(m->ala[at->side].x), m->ala[at->side].y},
                corner[2] = {fabsf(m->lip_corner[at->side].x), m->lip_corner[at->side].y}, s = at->s;
    const float point[5][2] = {{wing[0] - 2.5f * s, wing[1] + 15 * s},
                               {wing[0] + 3.5f * s, wing[1] + 3 * s},
                               {0.5f * (wing[0] + corner[0]) + 5.5f * s, 0.55f * wing[1] + 0.45f * corner[1]},
                               {corner[0] + 7.5f * s, corner[1] + 5 * s},
                               {corner[0] + 9 * s, corner[1] - 5 * s}};
    float nearest = 1e9f, way = 0;
    for (int k = 0; k < 4; k++) {
        float t;
        const float d = segment_distance(fabsf(at->site->p.x), at->site->p.y, point[k], point[k + 1], &t);
        if (d < nearest) {
            nearest = d;
            way = (float)k + t;
        }
    }
    const float a = nearest / (4.0f * s), roll = (nearest - 8.5f * s) / (3.5f * s);
    return (0.85f * expf(-a * a) - 0.15f * expf(-roll * roll)) * ris_paint_step(0, 2.1f, way) *
           ris_paint_step(4, 2.2f, way);
}

/* Arcs beside the corner of the mouth, upright lines above and below the lips, the pebbles of mentalis. */
static float round_the_mouth(const place *at, const ris_paint_zones *zones)
{
    const ris_paint_landmarks *m = &at->surface->at;
    const ris_vec3 corner = m->lip_corner[at->side], p = at->site->p;
    const float u = (fabsf(p.x) - fabsf(corner.x)) / at->s, v = (p.y - corner.y) / at->s,
                r = sqrtf(u * u + v * v);
    float sum = 0;
    const float beside = ris_paint_step(0.1f, 0.75f, u / (r + 0.01f));
    for (int k = 0; k < 2; k++)
        sum += (0.6f - 0.2f * (float)k) * beside * furrow(r - 5.5f - 4.8f * (float)k, 1.3f);
    const float band = ris_paint_step(7.4f, 8.6f, at->site->lip) * ris_paint_step(14, 10.5f, at->site->lip) *
                       ris_paint_step(corner.x * corner.x, 0.5f * corner.x * corner.x, p.x * p.x);
    const float fan = p.x / (at->s * (1 + 0.012f * fabsf(p.y - m->mouth.y)));
    const float above = p.y > m->mouth.y ? 0.5f : 0.25f; /* below, the labiomental fold takes the rest */
    sum += above * band * ris_paint_noise(vec3(fan / 1.9f, p.y / (14 * at->s), 0), 443);
    const ris_paint_cell pebble = ris_paint_cells(vec3_scale(p, 1 / (4.6f * at->s)), 449);
    sum += 0.7f * zones->chin * (0.9f - ris_paint_clamp(1.6f * (pebble.next - pebble.near), 0, 1));
    return sum;
}

float ris_paint_wrinkles(const ris_paint_surface *surface, const ris_paint_site *site,
                         const ris_paint_zones *zones)
{
    if (site->shell != RIS_SHELL_FACE)
        return RIS_PAINT_SMOOTH;
    const float s = surface->at.scale;
    const place at = {.x = fabsf(site->p.x) / s,
                      .up = (site->p.y - surface->at.eye[0].y) / s,
                      .s = s,
                      .side = site->p.x < 0,
                      .surface = surface,
                      .site = site};
    const float front =
        ris_paint_step(surface->at.ear[0].z + 10 * s, surface->at.ear[0].z + 40 * s, site->p.z);
    float sum = forehead(&at, zones->scalp) + glabella(&at) + bunny(&at) + round_the_eye(&at);
    sum += nasolabial(&at) + round_the_mouth(&at, zones);
    const float whole = front * (1 - zones->lip) * (1 - zones->inner_mouth) * (1 - zones->socket) *
                        (1 - zones->rim) * (1 - zones->nostril);
    return RIS_PAINT_SMOOTH - 0.6f * ris_paint_clamp(whole * sum, -0.4f, 1.2f);
}
