/* Finds the parts of a face from its UV islands: the largest is the face itself, the one behind the lips
 * the mouth, those behind the lids the eye sockets. Edge loops counted out from the shared seams then
 * follow lips and lids as the modeller laid them: the vermilion border, the lid rims and the lid folds are
 * such loops. */
#include "paint.h"

#include <math.h>
#include <stdlib.h>

typedef struct island {
    uint32_t root;
    float area;
    ris_vec3 centre;
} island;

static uint32_t find_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void join_uvs(const ris_paint_surface *surface, uint32_t *parent)
{
    for (uint32_t i = 0; i < surface->mesh->uv_count; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < surface->triangle_count; i++) {
        const uint32_t *t = &surface->triangle_uv[3 * i];
        parent[find_root(parent, t[1])] = find_root(parent, t[0]);
        parent[find_root(parent, t[2])] = find_root(parent, t[0]);
    }
}

/* Area and area-weighted centre of every island; slot (uv_count) gives each root's index in list. */
static uint32_t measure(const ris_paint_surface *surface, uint32_t *parent, uint32_t *slot, island *list,
                        uint32_t capacity)
{
    const ris_vec3 *p = surface->mesh->position;
    uint32_t count = 0;
    for (uint32_t i = 0; i < surface->triangle_count; i++) {
        const uint32_t *t = &surface->triangle[3 * i];
        const uint32_t root = find_root(parent, surface->triangle_uv[3 * i]);
        if (slot[root] == UINT32_MAX) {
            if (count == capacity)
                continue;
            slot[root] = count;
            list[count++] = (island){.root = root};
        }
        island *at = &list[slot[root]];
        const float area =
            0.5f * ris_paint_length(vec3_cross(vec3_sub(p[t[1]], p[t[0]]), vec3_sub(p[t[2]], p[t[0]])));
        at->area += area;
        at->centre =
            vec3_add(at->centre, vec3_scale(vec3_add(p[t[0]], vec3_add(p[t[1]], p[t[2]])), area / 3));
    }
    for (uint32_t i = 0; i < count; i++)
        list[i].centre = vec3_scale(list[i].centre, 1 / fmaxf(list[i].area, 1e-12f));
    return count;
}

static ris_paint_shell classify(const island *face, const island *other)
{
    const ris_vec3 d = vec3_sub(other->centre, face->centre);
    if (other == face)
        return RIS_SHELL_FACE;
    if (d.z < 20 || d.y < -120)
        return RIS_SHELL_OTHER;
    if (fabsf(d.x) < 8)
        return RIS_SHELL_MOUTH;
    return fabsf(d.x) > 15 && fabsf(d.x) < 60 ? RIS_SHELL_SOCKET : RIS_SHELL_OTHER;
}

/* Counts edge loops from the vertices that both shells touch: upwards over the face, downwards behind the
 * seam. */
static void count_rings(const ris_paint_surface *surface, ris_paint_shell inner, float *ring)
{
    const uint32_t count = surface->mesh->vertex_count;
    uint8_t *touch = calloc(count, 1);
    for (uint32_t i = 0; i < count; i++)
        ring[i] = RIS_PAINT_RING_MAX;
    if (!touch)
        return;
    for (uint32_t i = 0; i < 3 * surface->triangle_count; i++) {
        const uint8_t shell = surface->shell[i / 3];
        touch[surface->triangle[i]] |= shell == RIS_SHELL_FACE ? 1 : shell == inner ? 2 : 0;
    }
    for (uint32_t i = 0; i < count; i++)
        ring[i] = touch[i] == 3 ? 0 : RIS_PAINT_RING_MAX;
    for (float level = 0; level < RIS_PAINT_RING_MAX - 1; level += 1) {
        for (uint32_t f = 0; f < surface->mesh->face_count; f++) {
            const uint32_t first = surface->mesh->face_start[f], end = surface->mesh->face_start[f + 1];
            for (uint32_t c = first; c < end; c++) {
                const uint32_t a = surface->mesh->face_vertex[c];
                const uint32_t b = surface->mesh->face_vertex[c + 1 < end ? c + 1 : first];
                if (fabsf(ring[a]) == level && ring[b] == RIS_PAINT_RING_MAX)
                    ring[b] = (touch[b] == 2 ? -1 : 1) * (level + 1);
                if (fabsf(ring[b]) == level && ring[a] == RIS_PAINT_RING_MAX)
                    ring[a] = (touch[a] == 2 ? -1 : 1) * (level + 1);
            }
        }
    }
    /* what lies behind the seam never reads as outside */
    for (uint32_t i = 0; i < count; i++)
        if (touch[i] == 2 && ring[i] == RIS_PAINT_RING_MAX)
            ring[i] = -RIS_PAINT_RING_MAX;
    free(touch);
}

/* The face vertex that looks forward nearest to (x, y). */
static ris_vec3 front_point(const ris_paint_surface *surface, float x, float y)
{
    ris_vec3 best = vec3(x, y, 0);
    float nearest = 1e30f;
    for (uint32_t i = 0; i < surface->mesh->vertex_count; i++) {
        const ris_vec3 p = surface->mesh->position[i];
        const float distance = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
        if (surface->normal[i].z > 0.15f && surface->lip_ring[i] >= 0 && surface->lid_ring[i] >= 0 &&
            distance < nearest) {
            nearest = distance;
            best = p;
        }
    }
    return best;
}

/* Centre of the lid seam and its two ends, side 0 = left (x > 0). */
static void find_eye(ris_paint_surface *surface, int side)
{
    ris_vec3 sum = vec3(0, 0, 0), inner = sum, outer = sum;
    float count = 0, least = 1e30f, most = -1e30f;
    for (uint32_t i = 0; i < surface->mesh->vertex_count; i++) {
        const ris_vec3 p = surface->mesh->position[i];
        const float x = side ? -p.x : p.x;
        if (surface->lid_ring[i] != 0 || x < 0)
            continue;
        sum = vec3_add(sum, p);
        count += 1;
        if (x < least) {
            least = x;
            inner = p;
        }
        if (x > most) {
            most = x;
            outer = p;
        }
    }
    surface->at.eye[side] = vec3_scale(sum, 1 / fmaxf(count, 1));
    surface->at.canthus_inner[side] = inner;
    surface->at.canthus_outer[side] = outer;
}

/* Moves each ear's outermost point to the middle of the ear: the box of what sticks out as far. */
static void centre_ears(ris_paint_surface *surface)
{
    for (int side = 0; side < 2; side++) {
        ris_vec3 *ear = &surface->at.ear[side], low = *ear, high = *ear;
        for (uint32_t i = 0; i < surface->mesh->vertex_count; i++) {
            const ris_vec3 p = surface->mesh->position[i];
            const bool out = side ? p.x < ear->x + 11 : p.x > ear->x - 11;
            if (!out || fabsf(p.y - ear->y) > 50 || fabsf(p.z - ear->z) > 40)
                continue;
            low = vec3(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
            high = vec3(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
        }
        ear->y = 0.5f * (low.y + high.y);
        ear->z = 0.5f * (low.z + high.z);
    }
}

static void find_landmarks(ris_paint_surface *surface)
{
    ris_paint_landmarks *at = &surface->at;
    find_eye(surface, 0);
    find_eye(surface, 1);
    at->crown = at->lip_corner[0] = at->lip_corner[1] = vec3(0, -1e9f, 0);
    for (int side = 0; side < 2; side++) {
        float widest = -1e9f, ear = -1e9f;
        for (uint32_t i = 0; i < surface->mesh->vertex_count; i++) {
            const ris_vec3 p = surface->mesh->position[i];
            const float x = side ? -p.x : p.x;
            if (surface->lip_ring[i] == 3 && x > widest) {
                widest = x;
                at->lip_corner[side] = p;
            }
            if (p.y > at->eye[0].y - 45 && p.y < at->eye[0].y + 30 && p.z < at->eye[0].z - 45 && x > ear) {
                ear = x;
                at->ear[side] = p;
            }
            if (p.y > at->crown.y)
                at->crown = p;
        }
    }
    centre_ears(surface);
    at->mouth = vec3_scale(vec3_add(at->lip_corner[0], at->lip_corner[1]), 0.5f);
    const float rise = fmaxf(at->eye[0].y - at->mouth.y, 1), apart = at->eye[0].x;
    at->scale = rise / 67.0f;
    at->nose_tip = vec3(0, 0, -1e9f);
    for (uint32_t i = 0; i < surface->mesh->vertex_count; i++) {
        const ris_vec3 p = surface->mesh->position[i];
        if (fabsf(p.x) < 8 && p.y > at->mouth.y + 0.2f * rise && p.y < at->eye[0].y && p.z > at->nose_tip.z)
            at->nose_tip = p;
    }
    at->chin = front_point(surface, 0, at->mouth.y - 0.58f * rise);
    for (int side = 0; side < 2; side++) {
        const float sign = side ? -1.0f : 1.0f;
        at->ala[side] = front_point(surface, sign * 0.48f * apart, at->nose_tip.y - 0.07f * rise);
        at->cheek[side] = front_point(surface, sign * 1.25f * apart, at->mouth.y + 0.52f * rise);
    }
}

ris_result ris_paint_find_islands(ris_paint_surface *surface, ris_error *err)
{
    enum { CAPACITY = 256 };
    const uint32_t count = surface->mesh->uv_count;
    uint32_t *parent = malloc(count * sizeof *parent), *slot = malloc(count * sizeof *slot);
    island *list = malloc(CAPACITY * sizeof *list);
    ris_result result = RIS_OK;
    if (!parent || !slot || !list) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u texture coordinates", count);
        goto done;
    }
    join_uvs(surface, parent);
    for (uint32_t i = 0; i < count; i++)
        slot[i] = UINT32_MAX;
    const uint32_t islands = measure(surface, parent, slot, list, CAPACITY);
    const island *face = &list[0];
    for (uint32_t i = 1; i < islands; i++)
        if (list[i].area > face->area)
            face = &list[i];
    for (uint32_t i = 0; i < surface->triangle_count; i++) {
        const uint32_t at = slot[find_root(parent, surface->triangle_uv[3 * i])];
        surface->shell[i] = (uint8_t)(at == UINT32_MAX ? RIS_SHELL_OTHER : classify(face, &list[at]));
        surface->has_mouth = surface->has_mouth || surface->shell[i] == RIS_SHELL_MOUTH;
        surface->has_eyes = surface->has_eyes || surface->shell[i] == RIS_SHELL_SOCKET;
    }
    count_rings(surface, RIS_SHELL_MOUTH, surface->lip_ring);
    count_rings(surface, RIS_SHELL_SOCKET, surface->lid_ring);
    if (!surface->has_mouth || !surface->has_eyes)
        result = ris_fail(err, RIS_ERROR_DATA,
                          "the mesh has no %s behind a UV seam, so the painter cannot find the face",
                          surface->has_mouth ? "eye sockets" : "inner mouth");
    else
        find_landmarks(surface);
done:
    free(parent);
    free(slot);
    free(list);
    return result;
}
