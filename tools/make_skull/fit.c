/* The fit: local bends of the bones until the dowels have the depths of the table (KA-04, KA-74). */
#include "make_skull.h"

#define ROUNDS 14
#define LARGEST_MM 7.0
#define FARTHEST_MM 9.0

/* Where the ray from the skin inwards enters the bone; false when it misses within 45 mm. */
static bool enter(const solid *s, dvec skin, dvec in, double *out_depth)
{
    double last = 0;
    for (double t = 0.5; t < 45; t += 0.5) {
        if (solid_distance(s, dv_mad(skin, t, in)) > 0) {
            last = t;
            continue;
        }
        double low = last, high = t;
        for (int k = 0; k < 20; k++) {
            double middle = 0.5 * (low + high);
            if (solid_distance(s, dv_mad(skin, middle, in)) > 0)
                low = middle;
            else
                high = middle;
        }
        *out_depth = high;
        return true;
    }
    return false;
}

void fit_sites(solid bone[2], const hull *h, const site *sites, uint32_t count)
{
    int slot[SITE_LIMIT];
    for (uint32_t i = 0; i < count; i++) {
        solid *s = &bone[sites[i].bone];
        slot[i] = -1;
        if (sites[i].table_mm > 0 && s->warp_count < SOLID_WARPS) {
            slot[i] = s->warp_count++;
            s->warp[slot[i]] = (solid_warp){.radius = sites[i].radius};
        }
    }
    for (int round = 0; round < ROUNDS; round++)
        for (uint32_t i = 0; i < count; i++) {
            const site *t = &sites[i];
            bvh_hit skin = ris__bvh_ray(&h->tree, t->seed, t->out, 0, 60);
            double depth;
            dvec in = dv(-t->out.x, -t->out.y, -t->out.z);
            if (slot[i] < 0 || !skin.found || !enter(&bone[t->bone], skin.at, in, &depth))
                continue;
            if (depth > t->aim * t->table_mm + FARTHEST_MM)
                continue; /* past the bone, into something behind it: no bend helps */
            solid_warp *w = &bone[t->bone].warp[slot[i]];
            double add = 0.7 * (depth - t->aim * t->table_mm), now = dv_dot(w->shift, t->out) + add;
            now = fmax(-LARGEST_MM, fmin(now, LARGEST_MM));
            w->at = dv_mad(skin.at, t->aim * t->table_mm, in);
            w->shift = dv(now * t->out.x, now * t->out.y, now * t->out.z);
        }
}
