/* KA-54, KA-55, KU-31: reading the vocabularies, and how action units are written. */
#include "asset/vocabulary.h"

#include "asset/names.h"
#include "vocabulary/arkit.h"
#include "vocabulary/expressions.h"
#include "vocabulary/facs.h"
#include "vocabulary/visemes.h"

#include <stdlib.h>
#include <string.h>

#define MAX_WORDS 4096

/* clang-format off */
const ris_vocabulary_text ris__vocabulary_file[RIS_WORD_KINDS] = {
    {"vocabulary/facs.json", (const char *)ris_text_facs, sizeof ris_text_facs - 1},
    {"vocabulary/arkit.json", (const char *)ris_text_arkit, sizeof ris_text_arkit - 1},
    {"vocabulary/visemes.json", (const char *)ris_text_visemes, sizeof ris_text_visemes - 1},
    {"vocabulary/expressions.json", (const char *)ris_text_expressions, sizeof ris_text_expressions - 1},
};

static const struct {
    const char *format, *list, *kind;
} form[RIS_WORD_KINDS] = {
    {"risorius-facs", "units", "an action unit"},
    {"risorius-arkit", "shapes", "an ARKit shape (camelCase)"},
    {"risorius-visemes", "visemes", "a viseme"},
    {"risorius-library", "expressions", NULL},
};
/* clang-format on */

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The number of a unit, one or two digits, and the letter behind it; returns what follows, or NULL. */
static const char *read_unit(const char *p, const char *end, ris_unit *out)
{
    size_t digits = 0;
    while (digits < 3 && p + digits < end && is_digit(p[digits])) {
        digits++;
    }
    if (digits < 1 || digits > 2 || *p == '0') {
        return NULL;
    }
    *out = (ris_unit){.name = "AU", .factor = 1};
    memcpy(out->name + 2, p, digits);
    p += digits;
    if (p < end && *p >= 'A' && *p <= 'E') {
        out->factor = (float)(*p++ - 'A' + 1) / 5.0f;
    }
    return p;
}

uint32_t ris__units_split(const char *name, ris_unit unit[RIS_UNITS_MAX])
{
    const char *side = ris__name_is_sided(name) ? name + strlen(name) - 2 : "";
    const char *p = name, *end = name + strlen(name) - strlen(side);
    uint32_t count = 0;
    if (strncmp(name, "AU", 2) != 0) {
        return 0;
    }
    while (count < RIS_UNITS_MAX) {
        ris_unit *out = &unit[count++];
        p = read_unit(p + (strncmp(p, "AU", 2) == 0 ? 2 : 0), end, out);
        if (!p) {
            return 0;
        }
        strcat(out->name, side);
        if (p == end) {
            return count;
        }
        if (*p++ != '+') {
            return 0;
        }
    }
    return 0;
}

static const ris_word *find(const ris_vocabulary *vocabulary, const char *name, size_t length)
{
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        const ris_word *word = &vocabulary->word[i];
        if (strncmp(word->name, name, length) == 0 && word->name[length] == 0) {
            return word;
        }
    }
    return NULL;
}

const ris_word *ris__vocabulary_find(const ris_vocabulary *vocabulary, const char *name, char *out_side)
{
    const size_t length = strlen(name);
    *out_side = 0;
    if (length >= RIS_NAME_SIZE) {
        return NULL;
    }
    const ris_word *word = find(vocabulary, name, length);
    if (!word && ris__name_is_sided(name)) {
        word = find(vocabulary, name, length - 2);
        if (word && word->kind != RIS_WORD_UNIT && word->kind != RIS_WORD_EXPRESSION) {
            return NULL;
        }
        *out_side = name[length - 1];
    }
    return word;
}

bool ris__vocabulary_has(const ris_vocabulary *vocabulary, const char *name)
{
    ris_unit unit[RIS_UNITS_MAX];
    char side;
    if (!vocabulary) {
        return false;
    }
    const uint32_t count = ris__units_split(name, unit);
    for (uint32_t i = 0; i < count; i++) {
        if (!ris__vocabulary_find(vocabulary, unit[i].name, &side)) {
            return false;
        }
    }
    return count > 0 || ris__vocabulary_find(vocabulary, name, &side);
}

void ris__vocabulary_nearest(const ris_vocabulary *vocabulary, ris_nearest *nearest)
{
    for (uint32_t i = 0; vocabulary && i < vocabulary->word_count; i++) {
        ris__nearest_add(nearest, vocabulary->word[i].name);
    }
}

static ris_result read_line(const ris_json_at *at, ris_json_need need, char **out, ris_error *err)
{
    char line[1024] = "";
    ris_result result = ris__json_text(at, need, line, sizeof line, err);
    if (result == RIS_OK && !(*out = strdup(line))) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for a text", at->json->name);
    }
    return result;
}

static ris_result check_name(const ris_json_at *at, ris_word_kind kind, const char *name, ris_error *err)
{
    static const char *const wanted[] = {"an action unit (\"AU12\")", "an ARKit shape (camelCase)",
                                         "a viseme (\"viseme.PP\")", "an expression (snake_case)"};
    const char *found = ris__name_reserved(name);
    bool fine = strlen(name) < RIS_NAME_SIZE && (found == NULL) == (form[kind].kind == NULL) &&
                (!found || strcmp(found, form[kind].kind) == 0);
    if (kind == RIS_WORD_UNIT) {
        ris_unit unit[RIS_UNITS_MAX];
        fine = fine && ris__units_split(name, unit) == 1 && strcmp(name, unit[0].name) == 0;
    } else if (kind == RIS_WORD_EXPRESSION) {
        fine = fine && ris__name_is_anatomical(name);
    }
    return fine ? RIS_OK : ris__json_fail(at, err, "expected the name of %s", wanted[kind]);
}

static ris_result read_word(const ris_json_at *at, ris_word_kind kind, ris_vocabulary *out, ris_error *err)
{
    /* "speech" of a viseme is for engine/anim/phonetics.c */
    static const char *const keys[] = {"title", "terms", "source", "speech", NULL};
    ris_json_at title = ris__json_key(at, "title"), terms = ris__json_key(at, "terms");
    ris_json_at source = ris__json_key(at, "source");
    ris_word *word = &out->word[out->word_count];
    ris_result result = check_name(at, kind, at->key, err);
    if (result) {
        return result;
    }
    strcpy(word->name, at->key);
    word->kind = kind;
    out->word_count++;
    if ((result = ris__json_check_object(at, keys, err)) ||
        (result = read_line(&title, RIS_JSON_REQUIRED, &word->title, err)) ||
        (result = read_line(&source, RIS_JSON_OPTIONAL, &word->source, err))) {
        return result;
    }
    return ris__terms_read(&terms, &word->term, &word->term_count, err);
}

/* Units name channels only, other words units and channels: so nothing can go round in a circle. */
static ris_result check_terms(const ris_json_at *at, const ris_vocabulary *vocabulary, const ris_word *word,
                              ris_error *err)
{
    for (uint32_t i = 0; i < word->term_count; i++) {
        const char *name = word->term[i].channel;
        const ris_json_at term = ris__json_key(at, name);
        ris_nearest nearest;
        char side, names[256];
        const ris_word *other = ris__vocabulary_find(vocabulary, name, &side);
        const char *kind = ris__name_reserved(name);
        if (kind && strcmp(kind, form[RIS_WORD_UNIT].kind) == 0 && word->kind != RIS_WORD_UNIT) {
            if (ris__vocabulary_has(vocabulary, name)) {
                continue;
            }
            ris__nearest_init(&nearest, name);
            ris__vocabulary_nearest(vocabulary, &nearest);
            return ris__json_fail(&term, err, "unknown action unit; nearest: %s",
                                  ris__nearest_text(&nearest, names, sizeof names));
        }
        if (kind || other) {
            return ris__json_fail(&term, err, "expected %s, found %s",
                                  word->kind == RIS_WORD_UNIT ? "a muscle or channel"
                                                              : "an action unit, a muscle or a channel",
                                  kind ? kind : "an expression");
        }
    }
    return RIS_OK;
}

static ris_result read_file(const ris_json *json, ris_word_kind kind, ris_vocabulary *out, ris_error *err)
{
    const char *const keys[] = {"format", "version", "source", form[kind].list, NULL};
    const char *key;
    json_t *value;
    char source[1024];
    const ris_json_at root = ris__json_root(json), list = ris__json_key(&root, form[kind].list);
    const ris_json_at origin = ris__json_key(&root, "source");
    const size_t count = json_object_size(list.value);
    const uint32_t first = out->word_count;
    ris_result result;
    if ((result = ris__json_check_format(&root, form[kind].format, 1, err)) ||
        (result = ris__json_check_object(&root, keys, err)) ||
        (result = ris__json_text(&origin, RIS_JSON_OPTIONAL, source, sizeof source, err))) {
        return result;
    }
    if (!json_is_object(list.value) || count > MAX_WORDS) {
        return ris__json_expected(&list, err, "an object of names");
    }
    ris_word *grown = realloc(out->word, (first + count + 1) * sizeof *grown);
    if (!grown) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu names", json->name, count);
    }
    out->word = grown;
    memset(grown + first, 0, (count + 1) * sizeof *grown);
    json_object_foreach(list.value, key, value)
    {
        const ris_json_at item = ris__json_key(&list, key);
        if ((result = read_word(&item, kind, out, err))) {
            return result;
        }
    }
    for (uint32_t i = first; i < out->word_count; i++) {
        const ris_json_at item = ris__json_key(&list, out->word[i].name),
                          terms = ris__json_key(&item, "terms");
        if ((result = check_terms(&terms, out, &out->word[i], err))) {
            return result;
        }
    }
    return RIS_OK;
}

ris_result ris__vocabulary_read(const ris_vocabulary_text file[RIS_WORD_KINDS], ris_vocabulary *out,
                                ris_error *err)
{
    ris_result result = RIS_OK;
    *out = (ris_vocabulary){0};
    for (int kind = 0; kind < RIS_WORD_KINDS && result == RIS_OK; kind++) {
        ris_json json;
        result = ris__json_parse(file[kind].name, file[kind].text, file[kind].size, &json, err);
        if (result == RIS_OK) {
            result = read_file(&json, (ris_word_kind)kind, out, err);
        }
        ris__json_finish(&json);
    }
    return result;
}

void ris__vocabulary_finish(ris_vocabulary *vocabulary)
{
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        free(vocabulary->word[i].title);
        free(vocabulary->word[i].source);
        free(vocabulary->word[i].term);
        free(vocabulary->word[i].value);
    }
    free(vocabulary->word);
    *vocabulary = (ris_vocabulary){0};
}
