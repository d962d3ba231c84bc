/* Names of muscles, channels and expressions (docs/file-formats.md). */
#include "asset/names.h"
#include "asset/vocabulary.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define MAX_EXPRESSIONS 4096
#define MAX_TERMS 1024
#define MAX_VALUE 1000.0 /* mm or degrees: beyond every channel */

static bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

bool ris__name_is_sided(const char *name)
{
    size_t length = strlen(name);
    return length > 2 && name[length - 2] == '.' && (name[length - 1] == 'L' || name[length - 1] == 'R');
}

bool ris__name_is_anatomical(const char *name)
{
    size_t length = strlen(name) - (ris__name_is_sided(name) ? 2 : 0);
    for (size_t i = 0; i < length; i++) {
        if (!is_lower(name[i]) && (i == 0 || (!is_digit(name[i]) && name[i] != '_'))) {
            return false;
        }
    }
    return length > 0;
}

bool ris__name_is_opposite(const char *a, const char *b)
{
    size_t length = strlen(a);
    return ris__name_is_sided(a) && ris__name_is_sided(b) && strlen(b) == length &&
           memcmp(a, b, length - 1) == 0 && a[length - 1] != b[length - 1];
}

bool ris__name_is_side_of(const char *sided, const char *name)
{
    size_t length = strlen(name);
    return ris__name_is_sided(sided) && strlen(sided) == length + 2 && memcmp(sided, name, length) == 0;
}

ris_result ris__read_name(const ris_json_at *at, const char *what, char out[RIS_NAME_SIZE], ris_error *err)
{
    char expected[96];
    const char *text = json_string_value(at->value);
    if (!text || json_string_length(at->value) != strlen(text) || strlen(text) >= RIS_NAME_SIZE ||
        !ris__name_is_anatomical(text)) {
        snprintf(expected, sizeof expected, "%s (snake_case, .L or .R at the end if sided)", what);
        return ris__json_expected(at, err, expected);
    }
    strcpy(out, text);
    return RIS_OK;
}

static bool names_channel(const ris_scope *scope, const char *name)
{
    for (uint32_t i = 0; i < scope->channel_count; i++) {
        if (strcmp(scope->channel[i], name) == 0 || ris__name_is_side_of(scope->channel[i], name)) {
            return true;
        }
    }
    return false;
}

bool ris__scope_has_channel(const ris_scope *scope, const char *name)
{
    char other[RIS_NAME_SIZE];
    return names_channel(scope, name) || (ris__name_of_synonym(name, other) && names_channel(scope, other));
}

const ris_expression *ris__expression_find(const ris_expression *expression, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(expression[i].name, name) == 0) {
            return &expression[i];
        }
    }
    return NULL;
}

bool ris__name_turns_sign(const char *name)
{
    static const char *const odd[] = {"jaw.side", "eye.yaw", "head.yaw", "head.roll", "head.x"};
    for (size_t k = 0; k < sizeof odd / sizeof *odd; ++k) {
        if (strcmp(name, odd[k]) == 0 || ris__name_is_side_of(name, odd[k])) {
            return true;
        }
    }
    return false;
}

const char *ris__name_reserved(const char *name)
{
    bool upper = false, joined = false;
    for (const char *p = name; *p; p++) {
        upper = upper || is_upper(*p);
        joined = joined || *p == '_' || *p == '-' || *p == '.';
    }
    if (name[0] == 'A' && name[1] == 'U' && is_digit(name[2])) {
        return "an action unit";
    }
    if (strncmp(name, "viseme.", 7) == 0) {
        return "a viseme";
    }
    if (is_lower(name[0]) && upper && !joined) {
        return "an ARKit shape (camelCase)";
    }
    return NULL;
}

static ris_result check_expression_name(const ris_json_at *at, const ris_scope *scope, ris_error *err)
{
    size_t length = strlen(at->key), body = length - (ris__name_is_sided(at->key) ? 2 : 0);
    const char *kind =
        ris__scope_has_channel(scope, at->key) ? "a muscle or channel" : ris__name_reserved(at->key);
    if (kind) {
        return ris__json_fail(at, err, "an expression may not carry the name of %s", kind);
    }
    bool fine = length < RIS_NAME_SIZE && (is_lower(at->key[0]) || is_upper(at->key[0]));
    for (size_t i = 0; fine && i < body; i++) {
        char c = at->key[i];
        fine = is_lower(c) || is_upper(c) || is_digit(c) || c == '_' || c == '-';
    }
    if (!fine) {
        return ris__json_fail(at, err,
                              "expected an expression name of letters, digits, _ and -, at most %d bytes",
                              RIS_NAME_SIZE - 1);
    }
    return RIS_OK;
}

ris_result ris__terms_read(const ris_json_at *at, ris_term **out, uint32_t *out_count, ris_error *err)
{
    *out = NULL;
    *out_count = 0;
    const char *key;
    json_t *value;
    if (!json_is_object(at->value) || json_object_size(at->value) > MAX_TERMS) {
        return ris__json_expected(at, err, "an object of channels and values");
    }
    *out = calloc(json_object_size(at->value) + 1, sizeof **out);
    if (!*out) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for an expression", at->json->name);
    }
    json_object_foreach(at->value, key, value)
    {
        ris_json_at term = ris__json_key(at, key);
        if (strlen(key) >= RIS_NAME_SIZE) {
            return ris__json_fail(&term, err, "expected a name of at most %d bytes", RIS_NAME_SIZE - 1);
        }
        ris_result result =
            ris__json_float(&term, RIS_JSON_REQUIRED, -MAX_VALUE, MAX_VALUE, &(*out)[*out_count].value, err);
        if (result != RIS_OK) {
            return result;
        }
        strcpy((*out)[(*out_count)++].channel, key);
    }
    return RIS_OK;
}

/* Channels and words of the vocabulary, that is: nothing that could come back to an expression. */
static bool made_of_channels(const ris_scope *scope, const ris_expression *expression)
{
    for (uint32_t i = 0; i < expression->term_count; i++) {
        const char *name = expression->term[i].channel;
        if (!ris__scope_has_channel(scope, name) && !ris__vocabulary_has(scope->vocabulary, name)) {
            return false;
        }
    }
    return true;
}

/* A term is a channel, or an expression that is made of channels only. */
static ris_result check_terms(const ris_json_at *at, const ris_scope *scope, const ris_expression *all,
                              uint32_t count, const ris_expression *expression, ris_error *err)
{
    for (uint32_t i = 0; i < expression->term_count; i++) {
        const char *name = expression->term[i].channel;
        ris_json_at term = ris__json_key(at, name);
        ris_nearest nearest;
        char names[256];
        if (ris__scope_has_channel(scope, name)) {
            continue;
        }
        const ris_expression *other = ris__expression_find(all, count, name);
        other = other ? other : ris__expression_find(scope->outer, scope->outer_count, name);
        if (!other && ris__vocabulary_has(scope->vocabulary, name)) {
            continue;
        }
        if (other && made_of_channels(scope, other)) {
            continue;
        }
        if (other) {
            return ris__json_fail(&term, err, "expressions may be nested one level deep only");
        }
        ris__nearest_init(&nearest, name);
        for (uint32_t c = 0; c < scope->channel_count; c++) {
            ris__nearest_add(&nearest, scope->channel[c]);
        }
        for (uint32_t e = 0; e < count; e++) {
            ris__nearest_add(&nearest, all[e].name);
        }
        ris__vocabulary_nearest(scope->vocabulary, &nearest);
        return ris__json_fail(&term, err,
                              "unknown muscle, channel, unit, shape, viseme or expression; nearest: %s",
                              ris__nearest_text(&nearest, names, sizeof names));
    }
    return RIS_OK;
}

ris_result ris__expressions_read(const ris_json_at *at, const ris_scope *scope, ris_expression **out,
                                 uint32_t *out_count, ris_error *err)
{
    const char *key;
    json_t *value;
    ris_result result = RIS_OK;
    size_t count = json_object_size(at->value);
    *out = NULL;
    *out_count = 0;
    if (!json_is_object(at->value) || count > MAX_EXPRESSIONS) {
        return ris__json_expected(at, err, "an object of expressions");
    }
    *out = calloc(count + 1, sizeof **out);
    if (!*out) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu expressions", at->json->name, count);
    }
    json_object_foreach(at->value, key, value)
    {
        ris_json_at item = ris__json_key(at, key);
        ris_expression *expression = &(*out)[*out_count];
        if ((result = check_expression_name(&item, scope, err))) {
            return result;
        }
        strcpy(expression->name, key);
        (*out_count)++;
        if ((result = ris__terms_read(&item, &expression->term, &expression->term_count, err))) {
            return result;
        }
    }
    for (uint32_t i = 0; i < *out_count && result == RIS_OK; i++) {
        ris_json_at item = ris__json_key(at, (*out)[i].name);
        result = check_terms(&item, scope, *out, *out_count, &(*out)[i], err);
    }
    return result;
}

void ris__expressions_finish(ris_expression *expression, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        free(expression[i].term);
    }
    free(expression);
}
