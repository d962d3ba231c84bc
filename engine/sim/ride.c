/* Parts riding on bones and skin (KA-06). */
#include "sim/ride.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FAR_MM 1.5f /* a strand or card that reaches farther from the skin than this hangs on its root */
#define SPREAD_PASSES 64
#define LOWER_LASH_TURN 0.3f /* half-way they would still stand up before the eye in a squint */

static ris_vec3 sub(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static float dot(ris_vec3 a, ris_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static ris_vec3 cross(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static ris_vec3 blend(ris_vec3 a, ris_vec3 b, ris_vec3 c, const float w[3])
{
    return (ris_vec3){a.x * w[0] + b.x * w[1] + c.x * w[2], a.y * w[0] + b.y * w[1] + c.y * w[2],
                      a.z * w[0] + b.z * w[1] + c.z * w[2]};
}

static ris_vec3 xyz(ris_vec4 v)
{
    return (ris_vec3){v.x, v.y, v.z};
}

/* The seven Voronoi regions of a triangle (Ericson, Real-Time Collision Detection, 5.1.5). */
static void nearest_shares(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c, float s[3])
{
    ris_vec3 ab = sub(b, a), ac = sub(c, a), ap = sub(p, a), bp = sub(p, b), cp = sub(p, c);
    float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
          d6 = dot(ac, cp);
    s[0] = s[1] = s[2] = 0.0f;
    if (d1 <= 0.0f && d2 <= 0.0f) {
        s[0] = 1.0f;
        return;
    }
    if (d3 >= 0.0f && d4 <= d3) {
        s[1] = 1.0f;
        return;
    }
    float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
        s[1] = d1 / (d1 - d3);
        s[0] = 1.0f - s[1];
        return;
    }
    if (d6 >= 0.0f && d5 <= d6) {
        s[2] = 1.0f;
        return;
    }
    float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
        s[2] = d2 / (d2 - d6);
        s[0] = 1.0f - s[2];
        return;
    }
    float va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
        s[2] = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        s[1] = 1.0f - s[2];
        return;
    }
    float sum = va + vb + vc;
    s[1] = vb / sum;
    s[2] = vc / sum;
    s[0] = 1.0f - s[1] - s[2];
}

float ris__ride_nearest(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c, float share[3])
{
    nearest_shares(p, a, b, c, share);
    ris_vec3 away = sub(p, blend(a, b, c, share));
    return dot(away, away);
}

bool ris__ride_frame(ris_vec3 a, ris_vec3 b, ris_vec3 c, ris_vec3 frame[3])
{
    ris_vec3 x = sub(b, a), z = cross(x, sub(c, a));
    float lx = sqrtf(dot(x, x)), lz = sqrtf(dot(z, z));
    if (!(lx > 0.0f) || !(lz > 0.0f)) {
        return false;
    }
    frame[0] = (ris_vec3){x.x / lx, x.y / lx, x.z / lx};
    frame[2] = (ris_vec3){z.x / lz, z.y / lz, z.z / lz};
    frame[1] = cross(frame[2], frame[0]);
    return true;
}

ris_vec3 ris__ride_offset(ris_vec3 p, ris_vec3 a, ris_vec3 b, ris_vec3 c, const float share[3])
{
    ris_vec3 frame[3], away = sub(p, blend(a, b, c, share));
    if (!ris__ride_frame(a, b, c, frame)) {
        return (ris_vec3){0};
    }
    return (ris_vec3){dot(away, frame[0]), dot(away, frame[1]), dot(away, frame[2])};
}

ris_vec3 ris__ride_turn(ris_vec3 still, ris_vec3 turned, float turn)
{
    const ris_vec3 way = sub(turned, still);
    const ris_vec3 v = {still.x + turn * way.x, still.y + turn * way.y, still.z + turn * way.z};
    const float length = sqrtf(dot(v, v)), wanted = sqrtf(dot(still, still));
    if (!(turn < 1.0f) || !(length > 0.0f)) {
        return turned;
    }
    return (ris_vec3){v.x * wanted / length, v.y * wanted / length, v.z * wanted / length};
}

ris_vec3 ris__ride_place(const ris_ride *ride, const ris_vec4 *position)
{
    ris_vec3 a = xyz(position[ride->vertex[0]]), b = xyz(position[ride->vertex[1]]),
             c = xyz(position[ride->vertex[2]]);
    ris_vec3 frame[3], at = blend(a, b, c, ride->share);
    if (ris__ride_frame(a, b, c, frame)) {
        const float along[3] = {ride->offset.x, ride->offset.y, ride->offset.z};
        ris_vec3 away = ris__ride_turn(ride->still, blend(frame[0], frame[1], frame[2], along), ride->turn);
        at = (ris_vec3){at.x + away.x, at.y + away.y, at.z + away.z};
    }
    return at;
}

/* A skin triangle with its extent along x, for a sweep. */
typedef struct span {
    float low, high;
    uint32_t triangle;
} span;

static int compare_span(const void *left, const void *right)
{
    const span *l = left, *r = right;
    return l->low < r->low ? -1 : l->low > r->low ? 1 : l->triangle < r->triangle ? -1 : 1;
}

static span *sort_spans(const ris_model *model, float *out_widest)
{
    span *all = malloc((model->triangle_count + 1) * sizeof *all);
    *out_widest = 0.0f;
    for (uint32_t t = 0; all != NULL && t < model->triangle_count; t++) {
        const uint32_t *n = model->triangle + 3 * (size_t)t;
        float a = model->rest_position[n[0]].x, b = model->rest_position[n[1]].x,
              c = model->rest_position[n[2]].x;
        all[t] = (span){fminf(fminf(a, b), c), fmaxf(fmaxf(a, b), c), t};
        *out_widest = fmaxf(*out_widest, all[t].high - all[t].low);
    }
    if (all != NULL) {
        qsort(all, model->triangle_count, sizeof *all, compare_span);
    }
    return all;
}

static void try_triangle(const ris_model *model, uint32_t t, ris_vec3 p, uint32_t *triangle, float *distance2)
{
    const uint32_t *n = model->triangle + 3 * (size_t)t;
    float share[3],
        d2 = ris__ride_nearest(p, xyz(model->rest_position[n[0]]), xyz(model->rest_position[n[1]]),
                               xyz(model->rest_position[n[2]]), share);
    if (d2 < *distance2) {
        *distance2 = d2;
        *triangle = t;
    }
}

/* Nearest skin triangle of every mesh vertex: triangles sorted along x, tried outwards from the vertex until the gap
 * along x alone is larger than the best distance. */
static void find_nearest(const ris_model *model, const span *all, float widest, const ris_mesh *mesh,
                         uint32_t *triangle, float *distance2)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        ris_vec3 p = mesh->position[v];
        uint32_t low = 0, high = model->triangle_count;
        while (low < high) { /* first span that starts beyond p.x */
            uint32_t middle = low + (high - low) / 2;
            if (all[middle].low > p.x) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        triangle[v] = v > 0 ? triangle[v - 1] : 0; /* a neighbour: most likely near */
        distance2[v] = FLT_MAX;
        try_triangle(model, triangle[v], p, &triangle[v], &distance2[v]);
        for (uint32_t i = low; i < model->triangle_count; i++) {
            float gap = all[i].low - p.x;
            if (gap * gap > distance2[v]) {
                break;
            }
            try_triangle(model, all[i].triangle, p, &triangle[v], &distance2[v]);
        }
        for (uint32_t i = low; i-- > 0;) {
            float gap = p.x - all[i].low - widest;
            if (gap > 0.0f && gap * gap > distance2[v]) {
                break;
            }
            float own = p.x - all[i].high;
            if (own <= 0.0f || own * own <= distance2[v]) {
                try_triangle(model, all[i].triangle, p, &triangle[v], &distance2[v]);
            }
        }
    }
}

/* The largest reach[] of every connected piece of the mesh, at all its vertices. */
static void spread_largest(const ris_mesh *mesh, float *reach)
{
    bool changed = true;
    for (int pass = 0; pass < SPREAD_PASSES && changed; pass++) {
        changed = false;
        for (uint32_t f = 0; f < mesh->face_count; f++) {
            float largest = 0.0f;
            for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
                largest = fmaxf(largest, reach[mesh->face_vertex[c]]);
            }
            for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
                changed = changed || reach[mesh->face_vertex[c]] < largest;
                reach[mesh->face_vertex[c]] = largest;
            }
        }
    }
}

/* A piece that stands off the skin (a lash) rides as one on the triangle of its root, the vertex nearest to the
 * skin; pieces that lie on it (hairs of a brow) follow it vertex by vertex. */
static void spread_roots(const ris_mesh *mesh, const float *reach, uint32_t *root, float *distance2)
{
    bool changed = true;
    for (int pass = 0; pass < SPREAD_PASSES && changed; pass++) {
        changed = false;
        for (uint32_t f = 0; f < mesh->face_count; f++) {
            uint32_t first = mesh->face_start[f], end = mesh->face_start[f + 1];
            for (uint32_t c = first; c < end; c++) {
                uint32_t a = mesh->face_vertex[c], b = mesh->face_vertex[c + 1 < end ? c + 1 : first];
                uint32_t near = distance2[a] < distance2[b] ? a : b, far = near == a ? b : a;
                if (reach[far] > FAR_MM * FAR_MM && distance2[near] < distance2[far]) {
                    root[far] = root[near];
                    distance2[far] = distance2[near];
                    changed = true;
                }
            }
        }
    }
}

static void mark_lower_lids(const ris_model *model, bool *lower_lid)
{
    static const char *const names[] = {"lid_lower.L", "lid_lower.R"};
    for (size_t k = 0; model->head && k < sizeof names / sizeof *names; ++k) {
        const ris_region *region = ris_head_region(model->head, names[k]);
        for (uint32_t i = 0; region && i < region->count; ++i) {
            lower_lid[region->vertex[i]] = true;
        }
    }
}

/* Binding of vertex v at the foot of its root. */
static ris_ride bind_vertex(const ris_model *model, const ris_mesh *mesh, uint32_t v, uint32_t root,
                            uint32_t triangle, bool standing, const bool *lower_lid)
{
    const uint32_t *n = model->triangle + 3 * (size_t)triangle;
    ris_vec3 a = xyz(model->rest_position[n[0]]), b = xyz(model->rest_position[n[1]]);
    ris_vec3 c = xyz(model->rest_position[n[2]]);
    ris_ride ride = {.vertex = {n[0], n[1], n[2]}, .standing = standing};
    (void)ris__ride_nearest(mesh->position[root], a, b, c, ride.share);
    ride.offset = ris__ride_offset(mesh->position[v], a, b, c, ride.share);
    ride.still = sub(mesh->position[v], blend(a, b, c, ride.share));
    ride.turn = standing && (lower_lid[n[0]] || lower_lid[n[1]] || lower_lid[n[2]]) ? LOWER_LASH_TURN : 1.0f;
    return ride;
}

ris_result ris__ride_bind(const ris_model *model, const ris_mesh *mesh, ris_ride *out, uint32_t *out_triangle,
                          ris_error *err)
{
    size_t count = mesh->vertex_count > 0 ? mesh->vertex_count : 1;
    uint32_t *triangle = malloc(count * sizeof *triangle), *root = malloc(count * sizeof *root);
    float *distance2 = malloc(count * sizeof *distance2), *reach = malloc(count * sizeof *reach), widest;
    span *all = sort_spans(model, &widest);
    bool *lower_lid = calloc(model->node_count + 1u, sizeof *lower_lid);
    ris_result result = RIS_OK;
    if (!triangle || !root || !distance2 || !reach || !all || !lower_lid) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a skin-bound part of %u vertices",
                          (unsigned)mesh->vertex_count);
        goto done;
    }
    find_nearest(model, all, widest, mesh, triangle, distance2);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        root[v] = v;
        reach[v] = distance2[v];
    }
    spread_largest(mesh, reach);
    spread_roots(mesh, reach, root, distance2);
    mark_lower_lids(model, lower_lid);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        out[v] =
            bind_vertex(model, mesh, v, root[v], triangle[root[v]], reach[v] > FAR_MM * FAR_MM, lower_lid);
        if (out_triangle != NULL) {
            out_triangle[v] = triangle[root[v]];
        }
    }
done:
    free(all);
    free(triangle);
    free(root);
    free(distance2);
    free(reach);
    free(lower_lid);
    return result;
}

ris_result ris_sim_part(const ris_sim *sim, uint32_t part, const ris_vec4 *position, ris_vec4 *out,
                        ris_error *err)
{
    const ris_model *model = ris_sim_get_model(sim);
    if (part >= model->head->part_count) {
        return ris_fail(err, RIS_ERROR_USAGE, "the head has %u parts, there is no part %u",
                        (unsigned)model->head->part_count, (unsigned)part);
    }
    const ris_part_def *def = &model->head->part[part];
    const ris_mesh *mesh = &def->mesh;
    if (def->bone == RIS_BONE_SKIN) {
        ris_ride *ride = calloc((size_t)mesh->vertex_count + 1, sizeof *ride);
        if (ride == NULL) {
            return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for part \"%s\"", def->name);
        }
        ris_result result = ris__ride_bind(model, mesh, ride, NULL, err);
        for (uint32_t v = 0; v < mesh->vertex_count && result == RIS_OK; v++) {
            ris_vec3 p = ris__ride_place(&ride[v], position);
            out[v] = (ris_vec4){p.x, p.y, p.z, 1.0f};
        }
        free(ride);
        return result;
    }
    float m[12];
    ris_sim_bone_transform(sim, def->bone, m);
    const bool shaped = ris_sim_part_shape(sim, part, out);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        ris_vec3 p = shaped ? xyz(out[v]) : mesh->position[v];
        out[v] = (ris_vec4){m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                            m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11], 1.0f};
    }
    return RIS_OK;
}
