/* Two meshes, one of them placed elsewhere: do they cross, how far are they apart. */
#include "query/query.h"

dvec ris__place(const float place[12], dvec p)
{
    return dv((double)place[0] * p.x + (double)place[1] * p.y + (double)place[2] * p.z + (double)place[3],
              (double)place[4] * p.x + (double)place[5] * p.y + (double)place[6] * p.z + (double)place[7],
              (double)place[8] * p.x + (double)place[9] * p.y + (double)place[10] * p.z + (double)place[11]);
}

/* place is a rotation and a shift. */
static dvec place_back(const float place[12], dvec p)
{
    const dvec q = dv_sub(p, dv((double)place[3], (double)place[7], (double)place[11]));
    return dv((double)place[0] * q.x + (double)place[4] * q.y + (double)place[8] * q.z,
              (double)place[1] * q.x + (double)place[5] * q.y + (double)place[9] * q.z,
              (double)place[2] * q.x + (double)place[6] * q.y + (double)place[10] * q.z);
}

static uint32_t piercing(const tri_mesh *mesh, const bvh *other, const float place[12],
                         dvec (*move)(const float[12], dvec), uint32_t stop)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->triangle_count * 3 && count < stop; i++) {
        const uint32_t from = mesh->triangle[i], to = mesh->triangle[i % 3 == 2 ? i - 2 : i + 1];
        if (from > to) /* each edge once: a closed mesh has it in both directions */
            continue;
        const dvec a = move(place, mesh->position[from]), d = dv_sub(move(place, mesh->position[to]), a);
        count += ris__bvh_ray(other, a, dv_unit(d), 0, dv_length(d)).found;
    }
    return count;
}

uint32_t ris__bvh_crossings(const bvh *moved, const float place[12], const bvh *still, uint32_t stop)
{
    const uint32_t count = piercing(moved->mesh, still, place, ris__place, stop);
    return count < stop ? count + piercing(still->mesh, moved, place, place_back, stop - count) : count;
}

double ris__bvh_gap(const bvh *moved, const float place[12], const bvh *still)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < moved->mesh->vertex_count; i++)
        least = fmin(least, ris__bvh_closest(still, ris__place(place, moved->mesh->position[i])).distance);
    for (uint32_t i = 0; i < still->mesh->vertex_count; i++)
        least = fmin(least, ris__bvh_closest(moved, place_back(place, still->mesh->position[i])).distance);
    return least;
}
