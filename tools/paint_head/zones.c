/* Where on the face a texel lies: soft weights from landmarks, edge loops of lips and lids, and a natural
 * hairline. */
#include "paint.h"

#include <math.h>

/* Hairline: angle from straight ahead (degrees) against height over the eye line (mm on a face of scale
 * 1): across the forehead, round the temple, down the sideburn, behind the ear and down to the nape. */
static const float hairline[][2] = {{0, 72},    {12, 73},   {24, 78},   {33, 75},   {41, 64},  {46, 48},
                                    {53, 33},   {58, 16},   {62, 2},    {65, -16},  {72, -22}, {82, -20},
                                    {100, -22}, {110, -40}, {120, -60}, {140, -75}, {180, -80}};

/* Signed distance (mm, positive on the hair side) of an angle and height from that line. */
static float over_hairline(float degrees, float height)
{
    const int count = (int)(sizeof hairline / sizeof *hairline);
    const float mm_per_degree = 1.35f; /* on a head of 77 mm radius */
    float nearest = 1e9f, line = hairline[count - 1][1];
    for (int i = 1; i < count; i++) {
        const float *a = hairline[i - 1], *b = hairline[i];
        const float ax = (b[0] - a[0]) * mm_per_degree, ay = b[1] - a[1];
        const float px = (degrees - a[0]) * mm_per_degree, py = height - a[1];
        const float t = ris_paint_clamp((px * ax + py * ay) / (ax * ax + ay * ay), 0, 1);
        const float dx = px - t * ax, dy = py - t * ay;
        nearest = fminf(nearest, sqrtf(dx * dx + dy * dy));
        if (degrees >= a[0] && degrees < b[0])
            line = ris_paint_mix(a[1], b[1], (degrees - a[0]) / (b[0] - a[0]));
    }
    return height > line ? nearest : -nearest;
}

/* How far round the ear, 1 on its outline. */
static float ear_radius(const ris_paint_surface *surface, ris_vec3 p)
{
    const ris_vec3 ear = surface->at.ear[p.x < 0];
    const float s = surface->at.scale;
    const float dy = (p.y - ear.y) / (30 * s), dz = (p.z - ear.z) / (19 * s);
    return sqrtf(dy * dy + dz * dz);
}

static float find_ear(const ris_paint_surface *surface, ris_vec3 p)
{
    const float x = fabsf(surface->at.ear[p.x < 0].x), s = surface->at.scale;
    return ris_paint_step(1.15f, 0.85f, ear_radius(surface, p)) *
           ris_paint_step(x - 17 * s, x - 12 * s, fabsf(p.x));
}

static float find_scalp(const ris_paint_surface *surface, ris_vec3 p)
{
    const ris_paint_landmarks *at = &surface->at;
    const float degrees = atan2f(fabsf(p.x), p.z - at->ear[0].z - 4) * 57.29578f;
    const float ragged = 5.0f * ris_paint_fbm(vec3_scale(p, 1 / 15.0f), 4, 11);
    const float over = over_hairline(degrees, (p.y - at->eye[0].y) / at->scale) + ragged;
    const float clear = ris_paint_step(0.84f, 1.16f, ear_radius(surface, p) + 0.02f * ragged);
    return ris_paint_step(-8, 15, over) * clear;
}

static void find_mouth(const ris_paint_surface *surface, const ris_paint_site *site, ris_paint_zones *zones)
{
    const float s = surface->at.scale;
    const float wobble = 0.22f * ris_paint_noise(vec3_scale(site->p, 1 / (2.2f * s)), 21);
    const float upper = ris_paint_step(-2 * s, 3 * s, site->p.y - surface->at.mouth.y);
    const float ring = site->lip + wobble + 0.35f * upper;
    zones->lip = ris_paint_step(7.35f, 5.9f, ring);
    zones->lip_roll = ris_paint_step(6.6f, 7.6f, ring) * ris_paint_step(9.2f, 7.9f, ring);
    zones->inner_lip = ris_paint_step(3.2f, 0.8f, site->lip);
    zones->inner_mouth = site->shell == RIS_SHELL_MOUTH ? 1 : 0;
    for (int side = 0; side < 2; side++) {
        const ris_vec3 corner =
            vec3_add(surface->at.lip_corner[side], vec3((side ? -1.0f : 1.0f) * s, -0.5f * s, 0));
        zones->lip_corner += ris_paint_blob(site->p, corner, 4.5f * s);
    }
    zones->lip_corner = fminf(zones->lip_corner, 1);
}

static void find_lids(const ris_paint_surface *surface, const ris_paint_site *site, ris_paint_zones *zones)
{
    const int side = site->p.x < 0;
    const ris_paint_landmarks *at = &surface->at;
    const float s = at->scale, ring = site->lid, above = site->p.y - at->eye[side].y;
    zones->socket = site->shell == RIS_SHELL_SOCKET ? 1 : 0;
    zones->rim = ris_paint_step(4.4f, 3.3f, ring);
    const float upper = ris_paint_step(0, 2.5f * s, above);
    zones->lash = (0.45f + 0.55f * upper) * expf(-(ring - 4.5f) * (ring - 4.5f) / 0.5f);
    zones->crease = upper * expf(-(ring - 7.2f) * (ring - 7.2f) / 0.8f);
    zones->lid = ris_paint_step(12, 8, ring) * upper;
    const ris_vec3 bag = vec3_add(at->eye[side], vec3((side ? -1.0f : 1.0f) * -4 * s, -12 * s, 0));
    const float dx = (site->p.x - bag.x) / (17 * s), dy = (site->p.y - bag.y) / (8 * s);
    zones->under_eye =
        expf(-(dx * dx + dy * dy)) * ris_paint_step(-30 * s, -12 * s, site->p.z - at->eye[side].z);
    zones->caruncle = ris_paint_blob(site->p, at->canthus_inner[side], 3.2f * s);
}

ris_paint_zones ris_paint_find_zones(const ris_paint_surface *surface, const ris_paint_site *site)
{
    const ris_paint_landmarks *at = &surface->at;
    const float s = at->scale;
    const int side = site->p.x < 0;
    const ris_vec3 p = site->p;
    ris_paint_zones zones = {0};
    zones.ear = find_ear(surface, p);
    zones.scalp = find_scalp(surface, p);
    find_mouth(surface, site, &zones);
    find_lids(surface, site, &zones);
    zones.nose = ris_paint_blob(p, at->nose_tip, 15 * s);
    zones.nose = fmaxf(zones.nose,
                       0.6f * ris_paint_capsule(p, at->nose_tip,
                                                vec3(0, at->eye[0].y - 8 * s, at->eye[0].z + 12 * s), 9 * s));
    zones.ala = ris_paint_blob(p, at->ala[side], 8 * s);
    zones.cheek = ris_paint_blob(p, at->cheek[side], 24 * s);
    const float front = ris_paint_step(at->ear[0].z + 10 * s, at->ear[0].z + 45 * s, p.z);
    zones.forehead = front * ris_paint_step(12 * s, 40 * s, p.y - at->eye[0].y);
    zones.chin = ris_paint_blob(p, at->chin, 15 * s);
    zones.lower_face = front * ris_paint_step(18 * s, -4 * s, p.y - at->mouth.y) *
                       ris_paint_step(-75 * s, -50 * s, p.y - at->mouth.y);
    zones.neck = ris_paint_step(at->chin.y - 5 * s, at->chin.y - 30 * s, p.y);
    const ris_vec3 wing = vec3_add(at->ala[side], vec3((side ? -3.0f : 3.0f) * s, 2 * s, -2 * s));
    const ris_vec3 end = vec3_add(at->lip_corner[side], vec3((side ? -9.0f : 9.0f) * s, 3 * s, 0));
    zones.fold = ris_paint_capsule(p, wing, end, 4.5f * s);
    /* the mesh has only dents for nostrils: paint makes them deep */
    const ris_vec3 nare = vec3_add(at->nose_tip, vec3((side ? -8.8f : 8.8f) * s, -3.8f * s, -11.0f * s));
    zones.nostril = ris_paint_step(0.84f, 0.64f, site->occlusion) *
                    ris_paint_step(8.0f * s, 4.5f * s, ris_paint_length(vec3_sub(p, nare)));
    return zones;
}
