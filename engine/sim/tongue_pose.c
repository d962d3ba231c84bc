/* tongue_pose: KA-06, KA-48 channels tongue.out, tongue.tip, tongue.wide. The tongue is bent along a line through its middle:
 * rest line -> stretched and turned line, sections go along and keep what volume they have. It leaves between the teeth as
 * far as these are apart, and above the lower ones. In the frame of the jaw; no libm but sqrt. docs/physics.md */
#include "sim/rig.h"

#include "model/vec3.h"

#include <string.h>

#define STATIONS RIS__TONGUE_STATIONS
#define STEPS RIS__TONGUE_STEPS
#define SMOOTHING 6
#define ROOT_MM 8.0f    /* the whole tongue comes forward, */
#define PRESS_MM 2.0f   /* in a closed mouth this far, to the lower incisors, */
#define REACH_MM 37.0f  /* and gets longer */
#define RISE_FROM 0.42f /* of the length: from here on the line rises to pass the lower incisors */
#define CLEAR_MM 1.5f   /* between tongue and lower incisors */
#define PASS_MM 8.5f    /* thickness between the incisors where there is room */
#define BEND_FROM 0.45f
#define BEND_TO 0.97f
#define UP_RAD 1.3f /* of the tip */
#define DOWN_RAD 0.95f
#define ARCH_MM 16.0f /* half width over the lower canines */
#define DROOP 0.25f   /* of the tip, by its weight when out */

static uint32_t station_of(const ris_tongue *tongue, float z, float *share)
{
    const float u = f_clamp((z - tongue->back_z) / tongue->length, 0.0f, 1.0f) * (float)(STATIONS - 1);
    const uint32_t k = u >= (float)(STATIONS - 2) ? STATIONS - 2 : (uint32_t)u;
    *share = u - (float)k;
    return k;
}

static float at(const float *table, float u)
{
    const float x = f_clamp(u, 0.0f, 1.0f) * (float)(STATIONS - 1);
    const uint32_t k = x >= (float)(STATIONS - 2) ? STATIONS - 2 : (uint32_t)x;
    return table[k] + (x - (float)k) * (table[k + 1] - table[k]);
}

static void smooth(float *table)
{
    for (int pass = 0; pass < SMOOTHING; ++pass) {
        float last = table[0];
        for (uint32_t k = 1; k + 1 < STATIONS; ++k) {
            const float now = table[k];
            table[k] = 0.25f * (last + table[k + 1]) + 0.5f * now;
            last = now;
        }
    }
}

/* Sections of the mesh along z: middle, half height and half width of what lies within a station of each. */
static void measure(const ris_mesh *mesh, ris_tongue *tongue)
{
    float low[STATIONS], high[STATIONS];
    const float step = tongue->length / (float)(STATIONS - 1);
    for (uint32_t k = 0; k < STATIONS; ++k) {
        const float z = tongue->back_z + step * (float)k;
        low[k] = INFINITY;
        high[k] = -INFINITY;
        tongue->half_width[k] = 0.0f;
        for (float reach = step; !(low[k] < high[k]); reach *= 2.0f) {
            for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
                const ris_vec3 p = mesh->position[i];
                if (fabsf(p.z - z) <= reach) {
                    low[k] = f_min(low[k], p.y);
                    high[k] = f_max(high[k], p.y);
                    tongue->half_width[k] = f_max(tongue->half_width[k], fabsf(p.x));
                }
            }
        }
        tongue->middle[k] = 0.5f * (low[k] + high[k]);
        tongue->half_height[k] = 0.5f * (high[k] - low[k]);
    }
    smooth(tongue->middle);
    smooth(tongue->half_height);
    smooth(tongue->half_width);
}

void ris__tongue_init(ris_tongue *tongue, const ris_head *head)
{
    memset(tongue, 0, sizeof *tongue);
    for (uint32_t k = 0; k < head->part_count && !tongue->mesh; ++k) {
        const ris_part_def *part = &head->part[k];
        if (part->material == RIS_MATERIAL_TONGUE && part->bone == RIS_BONE_JAW &&
            part->mesh.vertex_count > 0) {
            tongue->mesh = &part->mesh;
        }
    }
    tongue->still = true;
    if (!tongue->mesh) {
        return;
    }
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < tongue->mesh->vertex_count; ++i) {
        low = f_min(low, tongue->mesh->position[i].z);
        high = f_max(high, tongue->mesh->position[i].z);
    }
    tongue->back_z = low;
    tongue->length = high - low;
    if (!(tongue->length > 1.0f)) {
        tongue->mesh = NULL;
        return;
    }
    measure(tongue->mesh, tongue);
}

/* What a pose asks for, limited by the room between the teeth. */
typedef struct aim {
    float out, up, wide; /* out 0..1; up and wide -1..1 */
    float root_mm;       /* forward */
    float shown;         /* how far the way over the teeth is taken, 0..1 */
    float teeth_z, pass_y,
        pass_mm; /* where the lower incisors are, middle and thickness of the tongue above them */
} aim;

static aim aim_of(const ris_rig *rig, const float *beside)
{
    const ris_vec3 incisor = rig->model->head->jaw.incisor;
    /* the upper incisors reach about 2 mm below the edges of the lower ones when closed */
    const float room = f_max(incisor.y - ris__rigid_apply(&rig->jaw, incisor).y - 2.0f, 0.0f);
    aim a = {.teeth_z = incisor.z};
    a.out = f_clamp(beside[RIS__TONGUE_OUT], 0.0f, 1.0f) * f_smoothstep((room - 3.0f) / 8.0f);
    a.root_mm = PRESS_MM * f_clamp(beside[RIS__TONGUE_OUT], 0.0f, 1.0f) + (ROOT_MM - PRESS_MM) * a.out;
    a.shown = f_smoothstep(a.out / 0.18f);
    const float tip = f_clamp(beside[RIS__TONGUE_TIP], -1.0f, 1.0f);
    const float up = f_min(0.23f + room / 18.0f, 1.0f), past = f_clamp((room - 5.0f) / 9.0f, 0.15f, 1.0f),
                down = 0.3f + 0.7f * a.shown;
    a.up = tip * (tip > 0.0f ? up + (past - up) * a.shown : down) - DROOP * a.out;
    a.wide = f_clamp(beside[RIS__TONGUE_WIDE], -1.0f, 1.0f);
    a.pass_mm = f_min(PASS_MM, f_max(room - 1.8f, 2.0f));
    a.pass_y = incisor.y + CLEAR_MM + 0.5f * a.pass_mm;
    return a;
}

/* Unit tangent of the rest line. */
static void rest_tangent(const ris_tongue *tongue, float u, float out[2])
{
    const float step = 1.0f / (float)(STATIONS - 1);
    const float a = f_max(u - step, 0.0f), b = f_min(u + step, 1.0f);
    const float dy = at(tongue->middle, b) - at(tongue->middle, a), dz = tongue->length * (b - a);
    const float l = sqrtf(dy * dy + dz * dz);
    out[0] = dy / l;
    out[1] = dz / l;
}

/* Section: height and width scales that keep height x width x length, flat enough between the teeth, narrow between the
 * canines, wide where there is room. */
static void size_section(const ris_tongue *tongue, const aim *a, float u, float z, float stretch,
                         ris_tongue_frame *out)
{
    const float outside = f_smoothstep((z - a->teeth_z + 4.0f) / 10.0f);
    const float front = f_smoothstep((u - 0.35f) / 0.4f), base = 1.0f / sqrtf(stretch);
    const float spread = a->wide * front * (a->wide > 0.0f ? 0.06f + 0.3f * outside : 0.32f);
    float width = base * (1.0f + spread), height = 1.0f / (stretch * width);
    const float between = a->shown * f_smoothstep((z - a->teeth_z + 26.0f) / 12.0f) *
                          (1.0f - f_smoothstep((z - a->teeth_z - 5.0f) / 14.0f));
    const float thin = 0.5f * a->pass_mm / f_max(at(tongue->half_height, u), 1.0f),
                narrow = ARCH_MM / f_max(at(tongue->half_width, u), 1.0f);
    height += between * (f_min(height, thin) - height);
    width = f_min(1.0f / (stretch * height), 1.2f * width);
    width += between * (f_min(width, narrow) - width);
    /* pushed out, the tip is pointed: it has no teeth to lie against */
    const float tip = f_clamp((u - 0.78f) / 0.22f, 0.0f, 1.0f);
    out->height = height;
    out->width = width * (1.0f - 0.35f * a->shown * tip * tip);
}

/* Slope of the way from the floor of the mouth over the lower incisors: a smooth step. */
static float slope_at(const aim *a, float z, float from_z, float from_y)
{
    const float span = f_max(a->teeth_z - 9.0f - from_z, 5.0f), t = (z - from_z) / span;
    return t > 0.0f && t < 1.0f ? (a->pass_y - from_y) * 6.0f * t * (1.0f - t) / span : 0.0f;
}

static void bend_line(ris_tongue *tongue, const aim *a)
{
    float y = tongue->middle[0], z = tongue->back_z + a->root_mm, from_y = y, from_z = z;
    const float du = 1.0f / (float)STEPS, reach = a->out * REACH_MM / tongue->length;
    float bend_from = BEND_FROM;
    for (uint32_t k = 0; k <= STEPS; ++k) {
        const float u = (float)k * du;
        float rest[2], now[2];
        rest_tangent(tongue, u, rest);
        if (u <= RISE_FROM) {
            from_y = y;
            from_z = z;
        }
        if (z <
            a->teeth_z + 1.0f) { /* what is still behind the teeth does not bend up or down between them */
            bend_from += a->shown * (f_max(bend_from, u) - bend_from);
        }
        const float slope = u > RISE_FROM ? slope_at(a, z, from_z, from_y) : rest[0] / rest[1];
        const float l = sqrtf(1.0f + slope * slope);
        now[0] = rest[0] + a->shown * (slope / l - rest[0]);
        now[1] = rest[1] + a->shown * (1.0f / l - rest[1]);
        const float free = f_clamp((1.0f - bend_from) / 0.3f, 0.0f, 1.0f);
        const float angle = a->up * (a->up > 0.0f ? UP_RAD : DOWN_RAD) * free *
                            f_smoothstep((u - bend_from) / f_max(BEND_TO - bend_from, 0.1f));
        double c, s;
        ris__cos_sin((double)angle, &c, &s);
        const float m = sqrtf(now[0] * now[0] + now[1] * now[1]);
        const float ty = ((float)c * now[0] + (float)s * now[1]) / m,
                    tz = ((float)c * now[1] - (float)s * now[0]) / m;
        const float stretch = 1.0f + reach * 6.0f * u * (1.0f - u);
        ris_tongue_frame *f = &tongue->frame[k];
        *f = (ris_tongue_frame){
            .y = y, .z = z, .cosine = rest[0] * ty + rest[1] * tz, .sine = rest[1] * ty - rest[0] * tz};
        size_section(tongue, a, u, z, stretch, f);
        const float ds = tongue->length * du * stretch / rest[1]; /* the rest line's own length */
        y += ty * ds;
        z += tz * ds;
    }
}

void ris__tongue_pose(ris_rig *rig, const float *pose)
{
    ris_tongue *tongue = &rig->tongue;
    const float *beside = pose + rig->first_beside;
    tongue->still = !tongue->mesh || (beside[RIS__TONGUE_OUT] == 0.0f && beside[RIS__TONGUE_TIP] == 0.0f &&
                                      beside[RIS__TONGUE_WIDE] == 0.0f);
    if (!tongue->still) {
        const aim a = aim_of(rig, beside);
        bend_line(tongue, &a);
    }
}

ris_vec3 ris__tongue_place(const ris_tongue *tongue, ris_vec3 p)
{
    if (tongue->still) {
        return p;
    }
    float share;
    const uint32_t station = station_of(tongue, p.z, &share);
    const float u = ((float)station + share) / (float)(STATIONS - 1), x = u * (float)STEPS;
    const uint32_t k = x >= (float)(STEPS - 1) ? STEPS - 1 : (uint32_t)x;
    const ris_tongue_frame *a = &tongue->frame[k], *b = a + 1;
    const float t = x - (float)k, c = a->cosine + t * (b->cosine - a->cosine),
                s = a->sine + t * (b->sine - a->sine);
    const float off = (p.y - at(tongue->middle, u)) * (a->height + t * (b->height - a->height));
    return v3(p.x * (a->width + t * (b->width - a->width)), a->y + t * (b->y - a->y) + c * off,
              a->z + t * (b->z - a->z) - s * off);
}
