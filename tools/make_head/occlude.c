/* Teeth that meet (KA-06): crowns whose chewing surfaces would pass into each other are set back into their jaws, half
 * the way each, as far as the contact that stops a tooth from erupting. */
#include "make_head.h"

#include <math.h>

#define SAMPLES_PER_EDGE 4

/* Height of triangle (a, b, c) over (x, z); false beside it. */
static bool height_at(dvec a, dvec b, dvec c, double x, double z, double *out)
{
    double d = (b.z - c.z) * (a.x - c.x) + (c.x - b.x) * (a.z - c.z);
    if (fabs(d) < 1e-9)
        return false;
    double u = ((b.z - c.z) * (x - c.x) + (c.x - b.x) * (z - c.z)) / d;
    double v = ((c.z - a.z) * (x - c.x) + (a.x - c.x) * (z - c.z)) / d, w = 1 - u - v;
    *out = u * a.y + v * b.y + w * c.y;
    return u >= -1e-9 && v >= -1e-9 && w >= -1e-9;
}

/* How far point p of one tooth reaches past the surface of the other along y; sign as in tooth_overlap. */
static double past(const part *other, uint32_t first, uint32_t count, dvec p, double sign)
{
    double most = -HUGE_VAL, y;
    for (uint32_t f = 0; f < other->face_count; f++) {
        const uint32_t *q = other->face[f];
        if (q[0] < first || q[0] >= first + count)
            continue;
        for (int k = 1; k < (q[3] == NONE ? 2 : 3); k++)
            if (height_at(other->position[q[0]], other->position[q[k]], other->position[q[k + 1]], p.x, p.z,
                          &y))
                most = fmax(most, sign * (p.y - y));
    }
    return most;
}

/* Largest overlap of the samples on the edges of tooth `from` of a with tooth `to` of b, each of count vertices. sign 1:
 * a is below b. -HUGE_VAL if they do not face each other. */
static double one_way(const part *a, uint32_t from, const part *b, uint32_t to, uint32_t count, double sign)
{
    double most = -HUGE_VAL;
    for (uint32_t f = 0; f < a->face_count; f++) {
        const uint32_t *q = a->face[f];
        if (q[0] / count != from)
            continue;
        uint32_t corners = q[3] == NONE ? 3 : 4;
        for (uint32_t k = 0; k < corners; k++)
            for (int s = 0; s < SAMPLES_PER_EDGE; s++) {
                dvec p =
                    v_mix(a->position[q[k]], a->position[q[(k + 1) % corners]], (double)s / SAMPLES_PER_EDGE);
                most = fmax(most, past(b, to * count, count, p, sign));
            }
    }
    return most;
}

/* How far lower tooth l reaches into upper tooth u, mm. */
static double tooth_overlap(const part *lower, uint32_t l, const part *upper, uint32_t u, uint32_t count)
{
    return fmax(one_way(lower, l, upper, u, count, 1), one_way(upper, u, lower, l, count, -1));
}

void occlude(const part *lower, const part *upper, uint32_t teeth, double gap_mm, double *lower_back,
             double *upper_back)
{
    const uint32_t count = lower->vertex_count / (2 * teeth); /* both halves, left first */
    double overlap[16][16];
    for (uint32_t l = 0; l < teeth; l++)
        for (uint32_t u = 0; u < teeth; u++)
            overlap[l][u] = l + 1 < u || u + 1 < l ? -HUGE_VAL : tooth_overlap(lower, l, upper, u, count);
    for (uint32_t u = 0; u < teeth; u++) {
        upper_back[u] = 0;
        for (uint32_t l = 0; l < teeth; l++)
            upper_back[u] = fmax(upper_back[u], 0.5 * overlap[l][u]);
    }
    for (uint32_t l = 0; l < teeth; l++) {
        lower_back[l] = 0;
        for (uint32_t u = 0; u < teeth; u++)
            lower_back[l] = fmax(lower_back[l], overlap[l][u] + gap_mm - upper_back[u]);
    }
}
