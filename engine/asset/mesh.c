/* Strict OBJ reader: v, vt, f with quads and polygons kept; vn, o, g, s, usemtl, mtllib skipped; all else
 * refused. */
#include "base/file.h"
#include "base/text.h"
#include "risorius/head.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_VERTICES (4u << 20)
#define MAX_FACES (8u << 20)
#define MAX_CORNERS (32u << 20)
#define MAX_FACE_CORNERS 64
#define MAX_COORDINATE 1e6 /* mm: a kilometre is no face */

typedef struct reader {
    const char *name, *line_start, *at, *line_end;
    uint32_t line;
    ris_mesh mesh;
    uint32_t vertex_capacity, uv_capacity, face_capacity, corner_capacity, uv_index_capacity;
    ris_error *err;
} reader;

static ris_result fail_at(const reader *r, const char *at, const char *expected)
{
    char found[40];
    size_t length = 0;
    while (at + length < r->line_end && at[length] != ' ' && at[length] != '\t' && length < 24) {
        found[length] = at[length] >= 32 && at[length] < 127 ? at[length] : '?';
        length++;
    }
    found[length] = 0;
    return ris_fail(r->err, RIS_ERROR_DATA, "%s:%u:%d: expected %s, found %s%s%s", r->name, r->line,
                    (int)(at - r->line_start) + 1, expected, length ? "\"" : "",
                    length ? found : "the end of the line", length ? "\"" : "");
}

/* array with room for count elements, doubling *capacity; NULL with err set when memory is out (array stays
 * valid). */
static void *grown(reader *r, void *array, uint32_t *capacity, uint32_t count, size_t element)
{
    if (count <= *capacity) {
        return array;
    }
    uint32_t wanted = *capacity ? *capacity * 2 : 256;
    void *larger = realloc(array, wanted * element);
    if (!larger) {
        ris_fail(r->err, RIS_ERROR_MEMORY, "%s: no memory for %u elements", r->name, wanted);
        return NULL;
    }
    *capacity = wanted;
    return larger;
}

static void skip_blanks(reader *r)
{
    while (r->at < r->line_end && (*r->at == ' ' || *r->at == '\t')) {
        r->at++;
    }
}

/* A number must be followed by a blank or the end of the line. */
static ris_result read_number(reader *r, const char *expected, float *out)
{
    double value;
    skip_blanks(r);
    const char *after = ris__parse_number(r->at, r->line_end, &value);
    if (!after || (after < r->line_end && *after != ' ' && *after != '\t')) {
        return fail_at(r, r->at, expected);
    }
    if (fabs(value) > MAX_COORDINATE) {
        return fail_at(r, r->at, "a number within +-1e6");
    }
    *out = (float)value;
    r->at = after;
    return RIS_OK;
}

static ris_result expect_line_end(reader *r, const char *expected)
{
    skip_blanks(r);
    return r->at == r->line_end ? RIS_OK : fail_at(r, r->at, expected);
}

static ris_result read_vertex(reader *r)
{
    ris_vec3 p = {0};
    ris_result result;
    if (r->mesh.vertex_count == MAX_VERTICES) {
        return ris_fail(r->err, RIS_ERROR_DATA, "%s:%u:1: more than %u vertices", r->name, r->line,
                        MAX_VERTICES);
    }
    if ((result = read_number(r, "a finite x", &p.x)) || (result = read_number(r, "a finite y", &p.y)) ||
        (result = read_number(r, "a finite z", &p.z)) ||
        (result = expect_line_end(r, "three coordinates only"))) {
        return result;
    }
    ris_vec3 *position = grown(r, r->mesh.position, &r->vertex_capacity, r->mesh.vertex_count + 1, sizeof p);
    if (!position) {
        return RIS_ERROR_MEMORY;
    }
    r->mesh.position = position;
    position[r->mesh.vertex_count++] = p;
    return RIS_OK;
}

static ris_result read_uv(reader *r)
{
    float u = 0, v = 0, ignored;
    ris_result result;
    if (r->mesh.uv_count == MAX_VERTICES) {
        return ris_fail(r->err, RIS_ERROR_DATA, "%s:%u:1: more than %u texture vertices", r->name, r->line,
                        MAX_VERTICES);
    }
    if ((result = read_number(r, "a finite u", &u)) || (result = read_number(r, "a finite v", &v))) {
        return result;
    }
    skip_blanks(r);
    if (r->at < r->line_end && (result = read_number(r, "a finite w", &ignored))) {
        return result;
    }
    if ((result = expect_line_end(r, "at most three numbers"))) {
        return result;
    }
    float *uv = grown(r, r->mesh.uv, &r->uv_capacity, r->mesh.uv_count + 1, 2 * sizeof *uv);
    if (!uv) {
        return RIS_ERROR_MEMORY;
    }
    r->mesh.uv = uv;
    uv[2 * r->mesh.uv_count] = u;
    uv[2 * r->mesh.uv_count + 1] = v;
    r->mesh.uv_count++;
    return RIS_OK;
}

/* A 1-based or negative index among count elements so far, as 0-based. */
static ris_result read_index(reader *r, const char *kind, uint32_t count, uint32_t *out)
{
    int64_t value;
    char expected[64];
    const char *after = ris__parse_integer(r->at, r->line_end, &value);
    if (!after) {
        snprintf(expected, sizeof expected, "a %s index", kind);
        return fail_at(r, r->at, expected);
    }
    if (value == 0 || value > (int64_t)count || value < -(int64_t)count) {
        snprintf(expected, sizeof expected, "a %s index of the %u above", kind, count);
        return fail_at(r, r->at, expected);
    }
    *out = (uint32_t)(value > 0 ? value - 1 : (int64_t)count + value);
    r->at = after;
    return RIS_OK;
}

/* v, v/vt, v//vn or v/vt/vn; the normal index is only checked to be an integer. */
static ris_result read_corner(reader *r, uint32_t *out_vertex, uint32_t *out_uv)
{
    int64_t normal;
    ris_result result = read_index(r, "vertex", r->mesh.vertex_count, out_vertex);
    *out_uv = UINT32_MAX;
    if (result) {
        return result;
    }
    if (r->at < r->line_end && *r->at == '/') {
        r->at++;
        bool normal_only = r->at < r->line_end && *r->at == '/';
        if (!normal_only && (result = read_index(r, "texture vertex", r->mesh.uv_count, out_uv))) {
            return result;
        }
        if (r->at < r->line_end && *r->at == '/') {
            const char *after = ris__parse_integer(++r->at, r->line_end, &normal);
            if (!after || normal == 0) {
                return fail_at(r, r->at, "a normal index");
            }
            r->at = after;
        }
    }
    if (r->at < r->line_end && *r->at != ' ' && *r->at != '\t') {
        return fail_at(r, r->at, "a blank after the corner");
    }
    return RIS_OK;
}

/* Appends a corner at index; refuses a vertex that the face has already. */
static ris_result add_corner(reader *r, uint32_t first, uint32_t index)
{
    ris_mesh *m = &r->mesh;
    const char *start = r->at;
    uint32_t vertex, uv;
    ris_result result = read_corner(r, &vertex, &uv);
    if (result) {
        return result;
    }
    for (uint32_t i = first; i < index; i++) {
        if (m->face_vertex[i] == vertex) {
            return fail_at(r, start, "a vertex that the face has not named yet");
        }
    }
    uint32_t *face_vertex = grown(r, m->face_vertex, &r->corner_capacity, index + 1, sizeof vertex);
    if (!face_vertex) {
        return RIS_ERROR_MEMORY;
    }
    m->face_vertex = face_vertex;
    uint32_t *face_uv = grown(r, m->face_uv, &r->uv_index_capacity, index + 1, sizeof uv);
    if (!face_uv) {
        return RIS_ERROR_MEMORY;
    }
    m->face_uv = face_uv;
    face_vertex[index] = vertex;
    face_uv[index] = uv;
    return RIS_OK;
}

static ris_result read_face(reader *r)
{
    ris_mesh *m = &r->mesh;
    uint32_t first = m->face_count ? m->face_start[m->face_count] : 0, count = 0;
    ris_result result;
    if (m->face_count == MAX_FACES || first > MAX_CORNERS - MAX_FACE_CORNERS) {
        return ris_fail(r->err, RIS_ERROR_DATA, "%s:%u:1: more than %u faces or %u corners", r->name, r->line,
                        MAX_FACES, MAX_CORNERS);
    }
    for (skip_blanks(r); r->at < r->line_end; skip_blanks(r)) {
        if (count == MAX_FACE_CORNERS) {
            return fail_at(r, r->at, "at most 64 corners");
        }
        if ((result = add_corner(r, first, first + count))) {
            return result;
        }
        count++;
    }
    if (count < 3) {
        return fail_at(r, r->at, "at least three corners");
    }
    uint32_t *face_start = grown(r, m->face_start, &r->face_capacity, m->face_count + 2, sizeof first);
    if (!face_start) {
        return RIS_ERROR_MEMORY;
    }
    m->face_start = face_start;
    face_start[m->face_count++] = first;
    face_start[m->face_count] = first + count;
    return RIS_OK;
}

static ris_result read_line(reader *r)
{
    static const char *const skipped[] = {"vn", "o", "g", "s", "usemtl", "mtllib"};
    skip_blanks(r);
    const char *word = r->at;
    while (r->at < r->line_end && *r->at != ' ' && *r->at != '\t') {
        r->at++;
    }
    size_t length = (size_t)(r->at - word);
    if (length == 0 || *word == '#') {
        return RIS_OK;
    }
    if (length == 1 && *word == 'v') {
        return read_vertex(r);
    }
    if (length == 2 && memcmp(word, "vt", 2) == 0) {
        return read_uv(r);
    }
    if (length == 1 && *word == 'f') {
        return read_face(r);
    }
    for (size_t i = 0; i < sizeof skipped / sizeof skipped[0]; i++) {
        if (length == strlen(skipped[i]) && memcmp(word, skipped[i], length) == 0) {
            return RIS_OK;
        }
    }
    return fail_at(r, word, "v, vt, vn, f, o, g, s, usemtl, mtllib or #");
}

ris_result ris_mesh_parse_obj(const char *name, const char *text, size_t size, ris_mesh *out, ris_error *err)
{
    const char *end = text + size;
    reader r = {.name = name, .line_start = text, .err = err};
    ris_result result = RIS_OK;
    *out = (ris_mesh){0};
    while (r.line_start < end && result == RIS_OK) {
        const char *newline = memchr(r.line_start, '\n', (size_t)(end - r.line_start));
        r.line++;
        r.at = r.line_start;
        r.line_end = newline ? newline : end;
        if (r.line_end > r.line_start && r.line_end[-1] == '\r') {
            r.line_end--;
        }
        result = read_line(&r);
        r.line_start = newline ? newline + 1 : end;
    }
    if (result == RIS_OK && (r.mesh.vertex_count == 0 || r.mesh.face_count == 0)) {
        result =
            ris_fail(err, RIS_ERROR_DATA, "%s: expected vertices and faces, found %u vertices and %u faces",
                     name, r.mesh.vertex_count, r.mesh.face_count);
    }
    if (result != RIS_OK) {
        ris_mesh_finish(&r.mesh);
        return result;
    }
    *out = r.mesh;
    return RIS_OK;
}

ris_result ris_mesh_load_obj(const char *path, ris_mesh *out, ris_error *err)
{
    char *text;
    size_t size;
    *out = (ris_mesh){0};
    ris_result result = ris__file_read(path, RIS_MAX_MESH_BYTES, &text, &size, err);
    if (result != RIS_OK) {
        return result;
    }
    result = ris_mesh_parse_obj(path, text, size, out, err);
    free(text);
    return result;
}

void ris_mesh_finish(ris_mesh *mesh)
{
    free(mesh->position);
    free(mesh->uv);
    free(mesh->face_start);
    free(mesh->face_vertex);
    free(mesh->face_uv);
    *mesh = (ris_mesh){0};
}
