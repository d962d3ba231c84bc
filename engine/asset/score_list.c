/* score.json -> ris_score_list. */
#include "asset/score_list.h"
#include "asset/json.h"

#include <stdlib.h>
#include <string.h>

#define MAX_UNITS 1024
#define MAX_TERMS 3 /* of a recipe: what a face does, not a fit of everything it could */

static bool is_unit(const char *text)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    for (const char *part = text;; part++) {
        const size_t length = strspn(part, letters);
        if (length == 0 || part[0] == '.') {
            return false;
        }
        part += length;
        if (*part != '+') {
            return *part == '\0';
        }
    }
}

static uint32_t term_count(const char *recipe)
{
    uint32_t count = recipe[0] != '\0';
    for (const char *at = recipe; (at = strchr(at, ',')); at++) {
        count++;
    }
    return count;
}

static ris_result read_unit(const ris_json_at *at, ris_score_list *list, ris_error *err)
{
    static const char *const keys[] = {"unit", "recipe", "argument", NULL};
    const ris_json_at unit = ris__json_key(at, "unit"), recipe = ris__json_key(at, "recipe"),
                      argument = ris__json_key(at, "argument");
    ris_score_unit *const out = &list->unit[list->count];
    ris_result r;
    if ((r = ris__json_check_object(at, keys, err)) ||
        (r = ris__json_text(&unit, RIS_JSON_REQUIRED, out->unit, sizeof out->unit, err)) ||
        (r = ris__json_text(&recipe, RIS_JSON_OPTIONAL, out->recipe, sizeof out->recipe, err)) ||
        (r = ris__json_text(&argument, RIS_JSON_OPTIONAL, out->argument, sizeof out->argument, err))) {
        return r;
    }
    if (!is_unit(out->unit)) {
        return ris__json_expected(&unit, err, "target names joined by '+'");
    }
    if (!out->recipe[0] && !out->argument[0]) {
        return ris__json_fail(at, err, "expected a recipe, or an argument why there is none, found neither");
    }
    if (term_count(out->recipe) > MAX_TERMS) {
        return ris__json_fail(&recipe, err, "expected a recipe of at most %d names, found %u", MAX_TERMS,
                              term_count(out->recipe));
    }
    for (uint32_t i = 0; i < list->count; i++) {
        if (strcmp(list->unit[i].unit, out->unit) == 0) {
            return ris__json_fail(&unit, err, "expected each unit once, found \"%s\" again", out->unit);
        }
    }
    list->count++;
    return RIS_OK;
}

ris_result ris__score_list_load(const char *path, ris_score_list *out, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "units", NULL};
    ris_json json = {0};
    *out = (ris_score_list){0};
    ris_result r = ris__json_load(path, &json, err);
    if (r) {
        return r;
    }
    const ris_json_at root = ris__json_root(&json), units = ris__json_key(&root, "units");
    if ((r = ris__json_check_format(&root, "risorius-score", 1, err)) ||
        (r = ris__json_check_object(&root, keys, err)) ||
        (r = ris__json_check_array(&units, 1, MAX_UNITS, err))) {
        goto fail;
    }
    const size_t count = json_array_size(units.value);
    out->unit = calloc(count, sizeof *out->unit);
    if (!out->unit) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu units", path, count);
        goto fail;
    }
    for (size_t i = 0; i < count && !r; i++) {
        const ris_json_at item = ris__json_item(&units, i);
        r = read_unit(&item, out, err);
    }
fail:
    ris__json_finish(&json);
    if (r) {
        ris__score_list_finish(out);
    }
    return r;
}

void ris__score_list_finish(ris_score_list *list)
{
    free(list->unit);
    *list = (ris_score_list){0};
}
