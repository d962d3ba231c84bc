/* Flattens skin and parts (KA-06) into the arrays of a ris_draw_scene. */
#include "draw/scene.h"

#include "draw/fold_mesh.h"
#include "draw/occlusion.h"
#include "draw/openings.h"
#include "draw/refine.h"
#include "sim/ride.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REFINE_LIMIT 40000u /* faces; a finer skin is smooth enough as it is */

/* One mesh on its way into the scene. */
typedef struct piece {
    const ris_part_def *part; /* NULL = the skin */
    const ris_mesh *mesh;
    ris_refined refined;
    ris_vec3 *position, *normal; /* at rest (refined.vertex_count) */
    float *occlusion;
    ris_vec4 *fold; /* of the skin */
    ris_ride *ride;
    uint32_t *ride_triangle; /* into model->triangle */
} piece;

static void *room(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

static ris_vec3 plus(ris_vec3 a, ris_vec3 b, float factor)
{
    return (ris_vec3){a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z};
}

static ris_vec3 mix3(ris_vec3 a, ris_vec3 b, ris_vec3 c, const float w[3])
{
    return (ris_vec3){w[0] * a.x + w[1] * b.x + w[2] * c.x, w[0] * a.y + w[1] * b.y + w[2] * c.y,
                      w[0] * a.z + w[1] * b.z + w[2] * c.z};
}

/* Rigid parts are modelled as fine as they need to be. */
static uint32_t levels_for(const piece *from)
{
    return from->part == NULL && from->mesh->face_count <= REFINE_LIMIT ? 1 : 0;
}

/* The skin, as fine as its painted lines ask for. */
static ris_result fold_skin(const ris_model *model, piece *skin, ris_error *err)
{
    ris_fold_map map = {0};
    ris_result result =
        model->head->color != NULL ? ris__fold_map_read(model->head->color, &map, err) : RIS_OK;
    if (result == RIS_OK) {
        result = ris__fold_split(&map, skin->mesh->position, &skin->refined, err);
    }
    ris_vec3 *position = room(skin->refined.vertex_count, sizeof *position);
    skin->fold = room(skin->refined.vertex_count, sizeof *skin->fold);
    if (result == RIS_OK && (position == NULL || skin->fold == NULL)) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the folds of the skin");
    }
    if (result == RIS_OK) {
        ris__refined_position(&skin->refined, skin->mesh->position, position);
        result = ris__fold_lines(&map, &skin->refined, position, skin->fold, err);
    }
    free(position);
    ris__fold_map_finish(&map);
    return result;
}

static ris_result build_piece(const ris_model *model, piece *to, ris_error *err)
{
    ris_result result = ris__refine(to->mesh, levels_for(to), &to->refined, err);
    if (result == RIS_OK && to->part == NULL) {
        result = fold_skin(model, to, err);
    }
    if (result != RIS_OK) {
        return result;
    }
    uint32_t count = to->refined.vertex_count;
    to->position = room(count, sizeof *to->position);
    to->normal = room(count, sizeof *to->normal);
    to->occlusion = room(count, sizeof *to->occlusion);
    if (to->position == NULL || to->normal == NULL || to->occlusion == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing %u vertices", (unsigned)count);
    }
    ris__refined_position(&to->refined, to->mesh->position, to->position);
    ris__refined_normal(&to->refined, to->position, to->normal);
    for (uint32_t i = 0; i < count; i++) {
        to->occlusion[i] = 1.0f;
    }
    if (to->part != NULL && to->part->bone == RIS_BONE_SKIN) {
        to->ride = room(to->mesh->vertex_count, sizeof *to->ride);
        to->ride_triangle = room(to->mesh->vertex_count, sizeof *to->ride_triangle);
        if (to->ride == NULL || to->ride_triangle == NULL) {
            return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for part \"%s\"", to->part->name);
        }
        result = ris__ride_bind(model, to->mesh, to->ride, to->ride_triangle, err);
    }
    return result;
}

static void finish_piece(piece *from)
{
    ris__refined_finish(&from->refined);
    free(from->position);
    free(from->normal);
    free(from->occlusion);
    free(from->fold);
    free(from->ride);
    free(from->ride_triangle);
}

static bool is_shaded(const piece *of)
{
    return of->part == NULL || of->part->material == RIS_MATERIAL_EYE ||
           of->part->material == RIS_MATERIAL_CORNEA;
}

static bool casts(const piece *of)
{
    return of->part == NULL || of->part->material == RIS_MATERIAL_EYE;
}

/* Skin and eyes shade each other; the rest of the parts has its own rules in its shader. All in one set of arrays, so
 * that the depth pictures are made once. */
static ris_result occlude(piece *all, uint32_t count, ris_error *err)
{
    size_t points = 0, corners = 0;
    for (uint32_t i = 0; i < count; i++) {
        points += is_shaded(&all[i]) ? all[i].refined.vertex_count : 0;
        corners += casts(&all[i]) ? all[i].refined.index_count : 0;
    }
    ris_vec3 *point = room(points, sizeof *point), *normal = room(points, sizeof *normal);
    float *share = room(points, sizeof *share);
    uint32_t *index = room(corners, sizeof *index), at = 0, used = 0;
    ris_result result = RIS_OK;
    if (point == NULL || normal == NULL || share == NULL || index == NULL) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for occlusion");
        goto done;
    }
    for (uint32_t i = 0; i < count; i++) {
        const ris_refined *from = &all[i].refined;
        for (uint32_t k = 0; casts(&all[i]) && k < from->index_count; k++) {
            index[used++] = from->corner[from->index[k]].vertex + at;
        }
        if (is_shaded(&all[i])) {
            memcpy(point + at, all[i].position, from->vertex_count * sizeof *point);
            memcpy(normal + at, all[i].normal, from->vertex_count * sizeof *normal);
            at += from->vertex_count;
        }
    }
    const ris_occluder occluder = {at, point, index, used};
    result = ris__occlusion(&occluder, 1, point, normal, at, share, err);
    at = 0;
    for (uint32_t i = 0; i < count && result == RIS_OK; i++) {
        if (is_shaded(&all[i])) {
            memcpy(all[i].occlusion, share + at, all[i].refined.vertex_count * sizeof *share);
            at += all[i].refined.vertex_count;
        }
    }
done:
    free(point);
    free(normal);
    free(share);
    free(index);
    return result;
}

/* Binding of a vertex at rest to a triangle of the drawn surface, `away` from the point with those shares; turn as in ris_ride. */
static bool bind_to_surface(const piece *skin, const uint32_t node[3], const float share[3], ris_vec3 away,
                            ris_vec3 normal, float turn, ris_draw_ride *out)
{
    ris_vec3 a = skin->position[node[0]], b = skin->position[node[1]], c = skin->position[node[2]], frame[3];
    if (!ris__ride_frame(a, b, c, frame)) {
        return false;
    }
    ris_vec3 offset = ris__ride_offset(plus(mix3(a, b, c, share), away, 1.0f), a, b, c, share), n = normal;
    *out = (ris_draw_ride){.a = node[0],
                           .b = node[1],
                           .c = node[2],
                           .share = {share[0], share[1], share[2], 0.0f},
                           .offset = {offset.x, offset.y, offset.z, 0.0f},
                           .still = {away.x, away.y, away.z, turn}};
    out->normal = (ris_vec4){n.x * frame[0].x + n.y * frame[0].y + n.z * frame[0].z,
                             n.x * frame[1].x + n.y * frame[1].y + n.z * frame[1].z,
                             n.x * frame[2].x + n.y * frame[2].y + n.z * frame[2].z, 0.0f};
    return true;
}

/* Moves a binding from a triangle of the coarse skin to the drawn surface of the same face, keeping the height above it.
 * A strand that stands off keeps the coarse triangle (its corners come first in the drawn surface): the small triangles
 * of a sharp edge turn by very different angles. */
static ris_draw_ride ride_on_surface(const piece *skin, const ris_model *model, const piece *part,
                                     uint32_t vertex, uint32_t face, uint32_t first_quad)
{
    const uint32_t *node = model->triangle + 3 * (size_t)part->ride_triangle[vertex];
    const ris_vec3 *coarse = skin->mesh->position;
    const ris_ride *bound = &part->ride[vertex];
    ris_vec3 foot = mix3(coarse[node[0]], coarse[node[1]], coarse[node[2]], bound->share);
    ris_vec3 away = plus(part->mesh->position[vertex], foot, -1.0f), normal = part->normal[vertex];
    ris_draw_ride best = {0};
    float nearest = FLT_MAX;
    if (bound->standing && bind_to_surface(skin, node, bound->share, away, normal, bound->turn, &best)) {
        return best;
    }
    for (uint32_t q = first_quad; q < skin->refined.quad_count && skin->refined.quad_face[q] == face; q++) {
        const uint32_t *quad = skin->refined.quad + 4 * (size_t)q;
        for (uint32_t half = 0; half < (quad[2] == quad[3] ? 1u : 2u); half++) {
            const uint32_t corner[3] = {quad[0], quad[1 + half], quad[2 + half]};
            float share[3],
                distance = ris__ride_nearest(foot, skin->position[corner[0]], skin->position[corner[1]],
                                             skin->position[corner[2]], share);
            if (distance < nearest && bind_to_surface(skin, corner, share, away, normal, 1.0f, &best)) {
                nearest = distance;
            }
        }
    }
    return best;
}

/* Face of the skin mesh each triangle of the model came from, and the first drawn quad of each face. */
static ris_result add_rides(const ris_model *model, const piece *skin, const piece *part,
                            uint32_t first_vertex, ris_draw_scene *out, ris_error *err)
{
    const ris_mesh *mesh = skin->mesh;
    uint32_t corners = mesh->face_start[mesh->face_count];
    uint32_t *corner_face = room(corners, sizeof *corner_face),
             *first_quad = room(mesh->face_count, sizeof *first_quad);
    if (corner_face == NULL || first_quad == NULL) {
        free(corner_face);
        free(first_quad);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for part \"%s\"", part->part->name);
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1]; c++) {
            corner_face[c] = f;
        }
    }
    for (uint32_t q = skin->refined.quad_count; q-- > 0;) {
        first_quad[skin->refined.quad_face[q]] = q;
    }
    for (uint32_t v = 0; v < part->mesh->vertex_count; v++) {
        uint32_t face = corner_face[model->triangle_corner[3 * (size_t)part->ride_triangle[v]]];
        ris_draw_ride ride = ride_on_surface(skin, model, part, v, face, first_quad[face]);
        ride.target = first_vertex + v;
        out->ride[out->ride_count++] = ride;
    }
    free(corner_face);
    free(first_quad);
    return RIS_OK;
}

static uint32_t texture_index(ris_draw_scene *out, const char *path)
{
    if (path == NULL) {
        return UINT32_MAX;
    }
    for (uint32_t i = 0; i < out->texture_count; i++) {
        if (strcmp(out->texture[i], path) == 0) {
            return i;
        }
    }
    out->texture[out->texture_count] = path;
    return out->texture_count++;
}

/* Appends the surface of one piece. Room was made by reserve. */
static void append(ris_draw_scene *out, const ris_head *head, const piece *from)
{
    const ris_refined *in = &from->refined;
    uint32_t first_vertex = out->vertex_count, first_corner = out->corner_count;
    for (uint32_t i = 0; i < in->vertex_count; i++) {
        ris_vec3 p = from->position[i], n = from->normal[i];
        out->position[first_vertex + i] = (ris_vec4){p.x, p.y, p.z, 1.0f};
        out->normal[first_vertex + i] = (ris_vec4){n.x, n.y, n.z, 0.0f};
        out->rest[first_vertex + i] = (ris_vec4){p.x, p.y, p.z, from->occlusion[i]};
        out->low = (ris_vec3){fminf(out->low.x, p.x), fminf(out->low.y, p.y), fminf(out->low.z, p.z)};
        out->high = (ris_vec3){fmaxf(out->high.x, p.x), fmaxf(out->high.y, p.y), fmaxf(out->high.z, p.z)};
    }
    for (uint32_t i = 0; i < in->corner_count; i++) {
        out->corner[first_corner + i] = in->corner[i];
        out->corner[first_corner + i].vertex += first_vertex;
    }
    ris_draw_item *item = &out->item[out->item_count++];
    const ris_part_def *part = from->part;
    *item = (ris_draw_item){.material = part ? part->material : RIS_MATERIAL_SKIN,
                            .bone = part ? part->bone : RIS_BONE_SKIN,
                            .first_index = out->index_count,
                            .index_count = in->drawn_count,
                            .part = part ? (uint32_t)(part - head->part) : UINT32_MAX,
                            .first_vertex = first_vertex,
                            .tint = part ? part->tint : (ris_vec3){0.52f, 0.28f, 0.19f},
                            .pivot = part ? part->pivot : (ris_vec3){0.0f, 0.0f, 0.0f}};
    item->texture = texture_index(out, part ? part->color : head->color);
    for (uint32_t i = 0; i < in->drawn_count; i++) {
        out->index[out->index_count++] = in->drawn[i] + first_corner;
    }
    out->vertex_count += in->vertex_count;
    out->corner_count += in->corner_count;
}

/* Edges of the coarse skin mesh: the two sides of each quad at its first corner. */
static void add_lines(ris_draw_scene *out, const ris_refined *skin)
{
    uint32_t at = 0;
    for (uint32_t q = 0; q < skin->quad_count; q++) {
        bool triangle = skin->quad[4 * q + 2] == skin->quad[4 * q + 3];
        out->line[out->line_count++] = skin->index[at];
        out->line[out->line_count++] = skin->index[at + 1];
        out->line[out->line_count++] = skin->index[at];
        out->line[out->line_count++] = skin->index[at + (triangle ? 2 : 5)];
        at += triangle ? 3 : 6;
    }
}

/* The coarse faces with their corners on the drawn surface: a quarter of the triangles, and less than the shadow's bias
 * away. Level 0 is coarse already. */
static void add_cast(ris_draw_scene *out, const ris_refined *skin, uint32_t levels)
{
    if (levels == 0) {
        memcpy(out->cast, skin->index, skin->index_count * sizeof *out->cast);
        out->cast_count = skin->index_count;
        return;
    }
    for (uint32_t first = 0, end; first < skin->quad_count; first = end) {
        end = first + 1;
        while (end < skin->quad_count && skin->quad_face[end] == skin->quad_face[first]) {
            end++;
        }
        for (uint32_t q = first + 1; q + 1 < end;
             q++) { /* quads of a refined face begin at its corners, six indices each */
            out->cast[out->cast_count++] = skin->index[6 * (size_t)first];
            out->cast[out->cast_count++] = skin->index[6 * (size_t)q];
            out->cast[out->cast_count++] = skin->index[6 * (size_t)q + 6];
        }
    }
}

static bool reserve(ris_draw_scene *out, const piece *all, uint32_t count)
{
    size_t vertices = 0, corners = 0, indices = 0, rides = 0;
    for (uint32_t i = 0; i < count; i++) {
        vertices += all[i].refined.vertex_count;
        corners += all[i].refined.corner_count;
        indices += all[i].refined.drawn_count;
        rides += all[i].ride != NULL ? all[i].mesh->vertex_count : 0;
    }
    out->position = room(vertices, sizeof *out->position);
    out->normal = room(vertices, sizeof *out->normal);
    out->rest = room(vertices, sizeof *out->rest);
    out->corner = room(corners, sizeof *out->corner);
    out->index = room(indices, sizeof *out->index);
    out->cast = room(all[0].refined.index_count, sizeof *out->cast);
    out->line = room(4 * (size_t)all[0].refined.quad_count, sizeof *out->line);
    out->ride = room(rides, sizeof *out->ride);
    out->item = room(count, sizeof *out->item);
    out->texture = room(count, sizeof *out->texture);
    out->low = (ris_vec3){FLT_MAX, FLT_MAX, FLT_MAX};
    out->high = (ris_vec3){-FLT_MAX, -FLT_MAX, -FLT_MAX};
    return out->position && out->normal && out->rest && out->corner && out->index && out->cast && out->line &&
           out->ride && out->item && out->texture;
}

/* Drawing order: opaque first, hair next, clear shells last. */
static int draw_rank(const piece *of)
{
    if (of->part == NULL) {
        return 0;
    }
    return of->part->material == RIS_MATERIAL_CORNEA ? 3 : of->part->material == RIS_MATERIAL_HAIR ? 2 : 1;
}

/* Lips and lining are uncovered when the mouth opens: the sign of the openness says so (skin.vert). */
static void mark_mouth(ris_draw_scene *out, const ris_head *head, const ris_refined *skin)
{
    static const char *const name[] = {"lips", "mouth_cavity"};
    for (size_t k = 0; k < sizeof name / sizeof name[0]; k++) {
        const ris_region *region = ris_head_region(head, name[k]);
        for (uint32_t i = 0; region != NULL && i < region->count; i++) {
            out->rest[region->vertex[i]].w = -fmaxf(fabsf(out->rest[region->vertex[i]].w), 1e-4f);
        }
    }
    const uint32_t nodes = head->skin.vertex_count;
    for (uint32_t v = nodes; v < skin->vertex_count; v++) { /* edges and faces of the mesh */
        float marked = 0.0f;
        for (uint32_t t = skin->term_start[v]; t < skin->term_start[v + 1]; t++) {
            marked += out->rest[skin->term[t].source].w < 0.0f ? skin->term[t].weight : 0.0f;
        }
        if (marked > 0.4f) {
            out->rest[v].w = -fmaxf(out->rest[v].w, 1e-4f);
        }
    }
}

/* A head with eyes is a bust: its lower end is cut off somewhere in the neck, and that cut is not shown. */
static void find_fade(ris_draw_scene *out, const ris_model *model)
{
    for (uint32_t i = 0; i < model->head->part_count; i++) {
        if (model->head->part[i].material == RIS_MATERIAL_EYE) {
            float size = out->high.y - out->low.y;
            out->fade[0] = out->low.y + 0.07f * size;
            out->fade[1] = out->low.y + 0.29f * size;
        }
    }
}

static ris_result assemble(const ris_model *model, piece *all, uint32_t count, ris_draw_scene *out,
                           ris_error *err)
{
    if (!reserve(out, all, count)) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing the head");
    }
    for (int rank = 0; rank <= 3; rank++) {
        for (uint32_t i = 0; i < count; i++) {
            if (draw_rank(&all[i]) != rank) {
                continue;
            }
            uint32_t first_vertex = out->vertex_count;
            append(out, model->head, &all[i]);
            if (all[i].ride != NULL) {
                ris_result result = add_rides(model, &all[0], &all[i], first_vertex, out, err);
                if (result != RIS_OK) {
                    return result;
                }
            }
        }
    }
    add_lines(out, &all[0].refined);
    add_cast(out, &all[0].refined, levels_for(&all[0]));
    mark_mouth(out, model->head, &all[0].refined);
    find_fade(out, model);
    /* the skin keeps its weights and rings: taken over, not copied */
    ris_refined *skin = &all[0].refined;
    out->skin_count = skin->vertex_count;
    out->term_count = skin->term_count;
    out->ring_count = skin->ring_start[skin->vertex_count];
    out->term_start = skin->term_start;
    out->term = skin->term;
    out->ring_start = skin->ring_start;
    out->ring = skin->ring;
    out->fold = all[0].fold;
    all[0].fold = NULL;
    skin->term_start = skin->ring_start = skin->ring = NULL;
    skin->term = NULL;
    return RIS_OK;
}

ris_result ris__draw_scene_build(const ris_model *model, ris_draw_scene *out, ris_error *err)
{
    const ris_head *head = model->head;
    uint32_t count = head->part_count + 1;
    *out = (ris_draw_scene){0};
    piece *all = room(count, sizeof *all);
    if (all == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for drawing the head");
    }
    ris_result result = RIS_OK;
    for (uint32_t i = 0; i < count && result == RIS_OK; i++) {
        all[i].part = i > 0 ? &head->part[i - 1] : NULL;
        all[i].mesh = i > 0 ? &head->part[i - 1].mesh : &head->skin;
        result = build_piece(model, &all[i], err);
    }
    if (result == RIS_OK) {
        result = occlude(all, count, err);
    }
    if (result == RIS_OK) {
        result = ris__draw_openings(head, out->rim, err);
    }
    if (result == RIS_OK) {
        result = assemble(model, all, count, out, err);
    }
    for (uint32_t i = 0; i < count; i++) {
        finish_piece(&all[i]);
    }
    free(all);
    if (result != RIS_OK) {
        ris__draw_scene_finish(out);
    }
    return result;
}

void ris__draw_scene_finish(ris_draw_scene *scene)
{
    free(scene->term_start);
    free(scene->term);
    free(scene->ring_start);
    free(scene->ring);
    free(scene->fold);
    free(scene->position);
    free(scene->normal);
    free(scene->rest);
    free(scene->corner);
    free(scene->index);
    free(scene->line);
    free(scene->cast);
    free(scene->ride);
    free(scene->item);
    free((void *)scene->texture);
    *scene = (ris_draw_scene){0};
}
