/* Red-green splitting: an edge is split for both of its triangles or for none, so that no gap opens. */
#include "draw/fold_mesh.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <stb_image.h>

#define ROUNDS 2
#define SHORTEST_MM 1.8f /* edges below are left */
#define RELIEF 0.05f     /* of the map's height: less is smooth skin */
#define SHOWN 0.6f       /* share of the painted depth that moves the surface; shading has the whole of it */

/* Pairs of numbers to a number; open addressing. */
typedef struct pair_map {
    uint64_t *key; /* 0 = free */
    uint32_t *value, mask, count;
} pair_map;

/* A round of splitting. */
typedef struct splitter {
    const ris_fold_map *map;
    ris_refined *at;
    pair_map vertex, corner; /* middle of two vertices, of two corners */
    uint32_t *index, index_count;
} splitter;

ris_result ris__fold_map_read(const char *color_path, ris_fold_map *out, ris_error *err)
{
    char path[RIS_PATH_SIZE], *bytes = NULL;
    const char *dot = strrchr(color_path, '.');
    int stem = dot != NULL ? (int)(dot - color_path) : (int)strlen(color_path);
    int wrote = snprintf(path, sizeof path, "%.*s_wrinkles.png", stem, color_path);
    size_t size = 0;
    *out = (ris_fold_map){0};
    if (wrote < 0 || (size_t)wrote >= sizeof path || access(path, F_OK) != 0) {
        return RIS_OK;
    }
    ris_result result = ris__file_read(path, RIS_MAX_IMAGE_BYTES, &bytes, &size, err);
    if (result != RIS_OK) {
        return result;
    }
    int width = 0, height = 0, channels = 0;
    uint8_t *rgba = stbi_load_from_memory((const uint8_t *)bytes, (int)size, &width, &height, &channels, 4);
    free(bytes);
    if (rgba == NULL) {
        return ris_fail(err, RIS_ERROR_DATA, "\"%s\": not a usable PNG or JPEG picture: %s", path,
                        stbi_failure_reason());
    }
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++) {
        rgba[i] = rgba[4 * i]; /* red, in place */
    }
    *out = (ris_fold_map){(uint32_t)width, (uint32_t)height, rgba};
    return RIS_OK;
}

void ris__fold_map_finish(ris_fold_map *map)
{
    stbi_image_free(map->height_of);
    *map = (ris_fold_map){0};
}

static float texel(const ris_fold_map *map, int x, int y)
{
    int w = (int)map->width, h = (int)map->height;
    x = x < 0 ? 0 : x >= w ? w - 1 : x;
    y = y < 0 ? 0 : y >= h ? h - 1 : y;
    return (float)map->height_of[(size_t)y * map->width + (size_t)x] / 255.0f;
}

/* Height over smooth skin; v down. */
static float relief_at(const ris_fold_map *map, float u, float v)
{
    float x = u * (float)map->width - 0.5f, y = v * (float)map->height - 0.5f;
    int x0 = (int)floorf(x), y0 = (int)floorf(y);
    float fx = x - (float)x0, fy = y - (float)y0;
    float above = (1.0f - fx) * texel(map, x0, y0) + fx * texel(map, x0 + 1, y0);
    float below = (1.0f - fx) * texel(map, x0, y0 + 1) + fx * texel(map, x0 + 1, y0 + 1);
    return (1.0f - fy) * above + fy * below - (float)RIS_DRAW_WRINKLE_FLAT;
}

static bool pairs_init(pair_map *map, uint32_t most)
{
    uint32_t size = 16;
    while (size < 2 * most) {
        size *= 2;
    }
    *map = (pair_map){calloc(size, sizeof(uint64_t)), calloc(size, sizeof(uint32_t)), size - 1, 0};
    return map->key != NULL && map->value != NULL;
}

static void pairs_finish(pair_map *map)
{
    free(map->key);
    free(map->value);
}

/* The value of a pair in any order; NULL where it is not known and not to be added. */
static uint32_t *pair_of(pair_map *map, uint32_t a, uint32_t b, bool add)
{
    uint64_t key = ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1;
    uint32_t at = (uint32_t)((key * 0x9E3779B97F4A7C15ull) >> 33) & map->mask;
    while (map->key[at] != 0 && map->key[at] != key) {
        at = (at + 1) & map->mask;
    }
    if (map->key[at] == 0) {
        if (!add) {
            return NULL;
        }
        map->key[at] = key;
        map->value[at] = UINT32_MAX;
        map->count++;
    }
    return &map->value[at];
}

static bool is_split(const splitter *s, const ris_vec3 *position, ris_draw_corner a, ris_draw_corner b)
{
    ris_vec3 p = position[a.vertex], q = position[b.vertex];
    float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, most = 0.0f;
    for (int k = 0; k <= 4; k++) {
        float t = 0.25f * (float)k;
        most = fmaxf(most, fabsf(relief_at(s->map, a.u + t * (b.u - a.u), a.v + t * (b.v - a.v))));
    }
    return most > RELIEF && dx * dx + dy * dy + dz * dz > SHORTEST_MM * SHORTEST_MM;
}

/* Room for `more` vertices: rows of two parents' terms, rings of two parents. */
static bool make_room(ris_refined *to, uint32_t more)
{
    uint32_t longest_row = 0, longest_ring = 0;
    for (uint32_t v = 0; v < to->vertex_count; v++) {
        uint32_t row = to->term_start[v + 1] - to->term_start[v],
                 ring = to->ring_start[v + 1] - to->ring_start[v];
        longest_row = row > longest_row ? row : longest_row;
        longest_ring = ring > longest_ring ? ring : longest_ring;
    }
    size_t vertices = (size_t)to->vertex_count + more,
           terms = to->term_count + 2 * (size_t)longest_row * more,
           rings = to->ring_start[to->vertex_count] + 2 * (size_t)longest_ring * more;
    uint32_t *term_start = realloc(to->term_start, (vertices + 1) * sizeof *term_start);
    to->term_start = term_start != NULL ? term_start : to->term_start;
    ris_draw_term *term = realloc(to->term, (terms + 1) * sizeof *term);
    to->term = term != NULL ? term : to->term;
    uint32_t *ring_start = realloc(to->ring_start, (vertices + 2) * sizeof *ring_start);
    to->ring_start = ring_start != NULL ? ring_start : to->ring_start;
    uint32_t *ring = realloc(to->ring, (2 * rings + 2) * sizeof *ring);
    to->ring = ring != NULL ? ring : to->ring;
    ris_draw_corner *corner =
        realloc(to->corner, ((size_t)to->corner_count + to->drawn_count + 1) * sizeof *corner);
    to->corner = corner != NULL ? corner : to->corner;
    return term_start && term && ring_start && ring && corner;
}

static void add_share(ris_refined *to, uint32_t first, ris_draw_term term)
{
    for (uint32_t i = first; i < to->term_count; i++) {
        if (to->term[i].source == term.source) {
            to->term[i].weight += 0.5f * term.weight;
            return;
        }
    }
    to->term[to->term_count++] = (ris_draw_term){term.source, 0.5f * term.weight};
}

/* The middle of two vertices. Its ring is both of theirs: a sum over closed rings does not depend on where it is taken. */
static uint32_t add_middle(ris_refined *to, uint32_t a, uint32_t b)
{
    const uint32_t parent[2] = {a, b}, first = to->term_count;
    uint32_t ring = to->ring_start[to->vertex_count];
    for (int k = 0; k < 2; k++) {
        for (uint32_t i = to->term_start[parent[k]]; i < to->term_start[parent[k] + 1]; i++) {
            add_share(to, first, to->term[i]);
        }
        for (uint32_t i = to->ring_start[parent[k]]; i < to->ring_start[parent[k] + 1]; i++, ring++) {
            to->ring[2 * (size_t)ring] = to->ring[2 * (size_t)i];
            to->ring[2 * (size_t)ring + 1] = to->ring[2 * (size_t)i + 1];
        }
    }
    to->term_start[to->vertex_count + 1] = to->term_count;
    to->ring_start[to->vertex_count + 1] = ring;
    return to->vertex_count++;
}

/* Corner in the middle of the edge between two corners, UINT32_MAX where the edge stays whole. */
static uint32_t middle_corner(splitter *s, uint32_t a, uint32_t b)
{
    ris_refined *to = s->at;
    const ris_draw_corner p = to->corner[a], q = to->corner[b];
    uint32_t *vertex = pair_of(&s->vertex, p.vertex, q.vertex, false);
    if (vertex == NULL) {
        return UINT32_MAX;
    }
    uint32_t *corner = pair_of(&s->corner, a, b, true);
    if (*corner == UINT32_MAX) {
        if (*vertex == UINT32_MAX) {
            *vertex = add_middle(to, p.vertex, q.vertex);
        }
        *corner = to->corner_count;
        to->corner[to->corner_count++] = (ris_draw_corner){*vertex, 0.5f * (p.u + q.u), 0.5f * (p.v + q.v)};
    }
    return *corner;
}

static void emit(splitter *s, uint32_t a, uint32_t b, uint32_t c)
{
    s->index[s->index_count++] = a;
    s->index[s->index_count++] = b;
    s->index[s->index_count++] = c;
}

static void split_triangle(splitter *s, const uint32_t *corner)
{
    uint32_t c[3], m[3];
    for (int turn = 0; turn < 3; turn++) { /* so that the whole edges come last */
        int split = 0;
        for (int k = 0; k < 3; k++) {
            c[k] = corner[(k + turn) % 3];
        }
        for (int k = 0; k < 3; k++) {
            m[k] = middle_corner(s, c[k], c[(k + 1) % 3]);
            split += m[k] != UINT32_MAX;
        }
        if (split == 0 || split == 3 || (m[0] != UINT32_MAX && m[2] == UINT32_MAX)) {
            break;
        }
    }
    if (m[0] == UINT32_MAX) {
        emit(s, c[0], c[1], c[2]);
    } else if (m[1] == UINT32_MAX) {
        emit(s, c[0], m[0], c[2]);
        emit(s, m[0], c[1], c[2]);
    } else if (m[2] == UINT32_MAX) {
        emit(s, m[0], c[1], m[1]);
        emit(s, c[0], m[0], m[1]);
        emit(s, c[0], m[1], c[2]);
    } else {
        emit(s, c[0], m[0], m[2]);
        emit(s, m[0], c[1], m[1]);
        emit(s, m[2], m[1], c[2]);
        emit(s, m[0], m[1], m[2]);
    }
}

static bool split_round(splitter *s, const ris_vec3 *source)
{
    ris_refined *at = s->at;
    ris_vec3 *position = malloc(((size_t)at->vertex_count + 1) * sizeof *position);
    uint32_t count = at->drawn_count;
    s->index_count = 0;
    s->index = malloc((4 * (size_t)count + 1) * sizeof *s->index);
    bool good = position != NULL && s->index != NULL && pairs_init(&s->vertex, count + 1) &&
                pairs_init(&s->corner, count + 1);
    if (good) {
        ris__refined_position(at, source, position);
        for (uint32_t i = 0; i < count; i++) {
            ris_draw_corner a = at->corner[at->drawn[i]],
                            b = at->corner[at->drawn[i % 3 == 2 ? i - 2 : i + 1]];
            if (is_split(s, position, a, b)) {
                pair_of(&s->vertex, a.vertex, b.vertex, true);
            }
        }
        good = make_room(at, s->vertex.count);
    }
    for (uint32_t t = 0; t + 2 < count && good; t += 3) {
        split_triangle(s, at->drawn + t);
    }
    free(position);
    pairs_finish(&s->vertex);
    pairs_finish(&s->corner);
    if (!good) {
        free(s->index);
        return false;
    }
    free(at->drawn);
    at->drawn = s->index;
    at->drawn_count = s->index_count;
    return true;
}

ris_result ris__fold_split(const ris_fold_map *map, const ris_vec3 *source, ris_refined *refined,
                           ris_error *err)
{
    for (int round = 0; round < ROUNDS && map->height_of != NULL; round++) {
        splitter s = {.map = map, .at = refined};
        if (!split_round(&s, source)) {
            return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the folds of %u vertices",
                            (unsigned)refined->vertex_count);
        }
    }
    return RIS_OK;
}

/* Adds the slope of the map over a triangle, as g g^T times its area, to each of its vertices. */
static void add_slope(const ris_refined *in, const uint32_t *triangle, const float *height,
                      const ris_vec3 *position, float (*sum)[6])
{
    uint32_t v[3];
    for (int k = 0; k < 3; k++) {
        v[k] = in->corner[triangle[k]].vertex;
    }
    ris_vec3 a = position[v[0]], b = position[v[1]], c = position[v[2]];
    ris_vec3 e = {b.x - a.x, b.y - a.y, b.z - a.z}, f = {c.x - a.x, c.y - a.y, c.z - a.z};
    float ee = e.x * e.x + e.y * e.y + e.z * e.z, ef = e.x * f.x + e.y * f.y + e.z * f.z,
          ff = f.x * f.x + f.y * f.y + f.z * f.z, det = ee * ff - ef * ef;
    if (!(det > 1e-8f)) {
        return;
    }
    float du = height[v[1]] - height[v[0]], dv = height[v[2]] - height[v[0]];
    float ke = (ff * du - ef * dv) / det, kf = (ee * dv - ef * du) / det, area = sqrtf(det);
    float g[3] = {ke * e.x + kf * f.x, ke * e.y + kf * f.y, ke * e.z + kf * f.z};
    for (int k = 0; k < 3; k++) {
        float *t = sum[v[k]];
        for (int r = 0; r < 3; r++) {
            t[r] += area * g[r] * g[r];
            t[3 + r] += area * g[r] * g[(r + 1) % 3];
        }
    }
}

/* The direction in which a sum of g g^T is largest (power iteration). */
static ris_vec4 main_direction(const float t[6])
{
    int largest = t[0] > t[1] ? (t[0] > t[2] ? 0 : 2) : t[1] > t[2] ? 1 : 2;
    float d[3] = {0.1f, 0.1f, 0.1f};
    d[largest] = 1.0f;
    for (int i = 0; i < 16; i++) {
        float n[3] = {t[0] * d[0] + t[3] * d[1] + t[5] * d[2], t[3] * d[0] + t[1] * d[1] + t[4] * d[2],
                      t[5] * d[0] + t[4] * d[1] + t[2] * d[2]};
        float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(size > 1e-12f)) {
            return (ris_vec4){0.0f, 0.0f, 0.0f, 0.0f};
        }
        for (int k = 0; k < 3; k++) {
            d[k] = n[k] / size;
        }
    }
    return (ris_vec4){d[0], d[1], d[2], 0.0f};
}

ris_result ris__fold_lines(const ris_fold_map *map, const ris_refined *refined, const ris_vec3 *position,
                           ris_vec4 *out, ris_error *err)
{
    const uint32_t n = refined->vertex_count;
    float *height = calloc((size_t)n + 1, sizeof *height);
    float(*slope)[6] = calloc((size_t)n + 1, sizeof *slope),
    (*around)[6] = calloc((size_t)n + 1, sizeof *around);
    if (height == NULL || slope == NULL || around == NULL) {
        free(height);
        free(slope);
        free(around);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the folds of %u vertices", (unsigned)n);
    }
    for (uint32_t i = 0; i < refined->corner_count && map->height_of != NULL; i++) {
        const ris_draw_corner c = refined->corner[i];
        height[c.vertex] = relief_at(map, c.u, c.v);
    }
    for (uint32_t t = 0; t + 2 < refined->drawn_count; t += 3) {
        add_slope(refined, refined->drawn + t, height, position, slope);
    }
    /* at the bottom of a furrow the slope has no direction: its neighbours know */
    for (uint32_t i = 0; i < refined->drawn_count; i++) {
        uint32_t v = refined->corner[refined->drawn[i]].vertex;
        uint32_t w = refined->corner[refined->drawn[i % 3 == 2 ? i - 2 : i + 1]].vertex;
        for (int k = 0; k < 6; k++) {
            around[v][k] += slope[w][k];
            around[w][k] += slope[v][k];
        }
    }
    for (uint32_t v = 0; v < n; v++) {
        out[v] = main_direction(around[v]);
        out[v].w = fabsf(height[v]) > 0.02f ? (float)RIS_DRAW_WRINKLE_MM * SHOWN * height[v] : 0.0f;
    }
    free(height);
    free(slope);
    free(around);
    return RIS_OK;
}
