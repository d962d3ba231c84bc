/* MakeHuman's .target files, and the folders they are found in. */
#include "asset/target.h"
#include "asset/head_parts.h"
#include "asset/lines.h"
#include "base/file.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

#define MAX_OFFSET 1000.0 /* decimetres */

static const char *const base_places[] = {"base.obj", "3dobjs/base.obj", "data/3dobjs/base.obj",
                                          "makehuman/data/3dobjs/base.obj"};
static const char *const target_places[] = {"expression", "targets/expression/units/caucasian",
                                            "data/targets/expression/units/caucasian",
                                            "makehuman/data/targets/expression/units/caucasian"};
#define PLACE_COUNT (sizeof base_places / sizeof base_places[0])

static bool can_open(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file) {
        fclose(file);
    }
    return file != NULL;
}

/* The first of the places that is there; "" if none is. */
static ris_result find(const char *directory, const char *const *places, char path[RIS_PATH_SIZE],
                       ris_error *err)
{
    for (size_t k = 0; k < PLACE_COUNT; k++) {
        const ris_result r = ris__path_join(path, directory, places[k], err);
        if (r) {
            return r;
        }
        if (can_open(path)) {
            return RIS_OK;
        }
    }
    path[0] = '\0';
    return RIS_OK;
}

ris_result ris__reference_load(const char *directory, ris_reference *out, ris_error *err)
{
    char base[RIS_PATH_SIZE], target[RIS_PATH_SIZE];
    *out = (ris_reference){0};
    ris_result r = find(directory, base_places, base, err);
    if (!r) {
        r = find(directory, target_places, target, err);
    }
    if (!r && (!base[0] || !target[0])) {
        r = ris_fail(err, RIS_ERROR_DATA,
                     "%s:1:1: expected a MakeHuman checkout, or a folder with %s, found no %s", directory,
                     base[0] ? "expression/*.target" : "base.obj",
                     base[0] ? target_places[3] : base_places[3]);
    }
    if (r) {
        return r;
    }
    out->base_path = ris__copy_text(base);
    out->target_directory = ris__copy_text(target);
    r = out->base_path && out->target_directory
            ? ris_mesh_load_obj(base, &out->base, err)
            : ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for a path", base);
    if (r) {
        ris__reference_finish(out);
    }
    return r;
}

void ris__reference_finish(ris_reference *reference)
{
    free(reference->base_path);
    free(reference->target_directory);
    ris_mesh_finish(&reference->base);
    *reference = (ris_reference){0};
}

static void skip_blanks(ris_lines *l)
{
    while (l->at < l->stop && (*l->at == ' ' || *l->at == '\t')) {
        l->at++;
    }
}

static ris_result read_offset(ris_lines *l, uint32_t vertex_count, double *sum)
{
    int64_t vertex;
    char what[64];
    double offset[3];
    const char *after = ris__parse_integer(l->at, l->stop, &vertex);
    if (!after || vertex < 0 || vertex >= (int64_t)vertex_count) {
        snprintf(what, sizeof what, "a vertex of 0 to %u", vertex_count - 1);
        return ris__lines_expected(l, what);
    }
    for (int k = 0; k < 3; k++) {
        const char *const before = after;
        l->at = after;
        skip_blanks(l);
        after = l->at > before ? ris__parse_number(l->at, l->stop, &offset[k]) : NULL;
        if (!after || !(offset[k] >= -MAX_OFFSET && offset[k] <= MAX_OFFSET)) {
            return ris__lines_expected(l, "3 numbers after the vertex");
        }
    }
    l->at = after;
    skip_blanks(l);
    if (l->at != l->stop) {
        return ris__lines_expected(l, "the end of the line");
    }
    for (int k = 0; k < 3; k++) {
        sum[3 * vertex + k] += offset[k];
    }
    return RIS_OK;
}

ris_result ris__target_add(const char *name, const char *text, size_t size, uint32_t vertex_count,
                           double *sum, ris_error *err)
{
    ris_lines l = {.name = name, .next = text, .end = text + size, .err = err};
    while (ris__lines_next(&l)) {
        skip_blanks(&l);
        if (l.at == l.stop || *l.at == '#') {
            continue;
        }
        const ris_result r = read_offset(&l, vertex_count, sum);
        if (r) {
            return r;
        }
    }
    return RIS_OK;
}

static ris_result add_file(const ris_reference *reference, const char *name, double *sum, ris_error *err)
{
    char path[RIS_PATH_SIZE], *text = NULL;
    size_t size = 0;
    ris_result r = ris__path_join(path, reference->target_directory, name, err);
    if (!r) {
        r = ris__file_read(path, RIS_MAX_MESH_BYTES, &text, &size, err);
    }
    if (!r) {
        r = ris__target_add(path, text, size, reference->base.vertex_count, sum, err);
    }
    free(text);
    return r;
}

ris_result ris__reference_unit(const ris_reference *reference, const char *unit, double *sum, ris_error *err)
{
    ris_result r = RIS_OK;
    memset(sum, 0, (size_t)reference->base.vertex_count * 3 * sizeof *sum);
    for (const char *part = unit; !r && part;) {
        char name[256];
        const size_t length = strcspn(part, "+");
        if (length == 0 || length + sizeof ".target" > sizeof name) {
            return ris_fail(err, RIS_ERROR_DATA, "expected target names joined by '+', found \"%.64s\"",
                            unit);
        }
        snprintf(name, sizeof name, "%.*s.target", (int)length, part);
        r = add_file(reference, name, sum, err);
        part = part[length] == '+' ? part + length + 1 : NULL;
    }
    return r;
}
