/* JSON readers with range checks; the messages of the house rule "file:line:col: expected ..., found ...". */
#include "asset/json.h"

#include "base/file.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

ris_result ris__json_parse(const char *name, const char *text, size_t size, ris_json *out, ris_error *err)
{
    json_error_t problem;
    ris_result result = RIS_OK;
    *out = (ris_json){.name = malloc(strlen(name) + 1), .text = malloc(size + 1), .size = size};
    if (!out->name || !out->text) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu bytes", name, size);
        goto fail;
    }
    strcpy(out->name, name);
    memcpy(out->text, text, size);
    out->text[size] = 0;
    out->root = json_loadb(out->text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, &problem);
    if (!out->root) {
        result = ris_fail(err, RIS_ERROR_DATA, "%s:%d:%d: %s", name, problem.line > 0 ? problem.line : 1,
                          problem.column > 0 ? problem.column : 1, problem.text);
        goto fail;
    }
    if (!json_is_object(out->root)) {
        result = ris_fail(err, RIS_ERROR_DATA, "%s:1:1: expected an object at the top of the file", name);
        goto fail;
    }
    return RIS_OK;
fail:
    ris__json_finish(out);
    return result;
}

ris_result ris__json_load(const char *path, ris_json *out, ris_error *err)
{
    char *text;
    size_t size;
    *out = (ris_json){0};
    ris_result result = ris__file_read(path, RIS_MAX_JSON_BYTES, &text, &size, err);
    if (result == RIS_OK) {
        result = ris__json_parse(path, text, size, out, err);
        free(text);
    }
    return result;
}

void ris__json_finish(ris_json *json)
{
    json_decref(json->root);
    free(json->name);
    free(json->text);
    *json = (ris_json){0};
}

ris_json_at ris__json_root(const ris_json *json)
{
    return (ris_json_at){.json = json, .value = json->root};
}

ris_json_at ris__json_key(const ris_json_at *at, const char *key)
{
    return (ris_json_at){
        .json = at->json, .parent = at, .key = key, .value = json_object_get(at->value, key)};
}

ris_json_at ris__json_item(const ris_json_at *at, size_t index)
{
    return (ris_json_at){
        .json = at->json, .parent = at, .index = index, .value = json_array_get(at->value, index)};
}

bool ris__json_absent(const ris_json_at *at)
{
    return !at->value || json_is_null(at->value);
}

static void describe(const json_t *value, char *out, size_t size)
{
    switch (value ? json_typeof(value) : JSON_NULL) {
    case JSON_OBJECT: snprintf(out, size, "an object"); break;
    case JSON_ARRAY: snprintf(out, size, "an array of %zu", json_array_size(value)); break;
    case JSON_STRING: snprintf(out, size, "\"%.40s\"", json_string_value(value)); break;
    case JSON_INTEGER: snprintf(out, size, "%" JSON_INTEGER_FORMAT, json_integer_value(value)); break;
    case JSON_REAL: snprintf(out, size, "%g", json_real_value(value)); break;
    case JSON_TRUE: snprintf(out, size, "true"); break;
    case JSON_FALSE: snprintf(out, size, "false"); break;
    case JSON_NULL: snprintf(out, size, "null"); break;
    }
}

ris_result ris__json_expected(const ris_json_at *at, ris_error *err, const char *expected)
{
    char found[64];
    if (!at->value && at->key) {
        return ris__json_fail(at->parent, err, "expected the key \"%s\" with %s, found none", at->key,
                              expected);
    }
    describe(at->value, found, sizeof found);
    return ris__json_fail(at, err, "expected %s, found %s", expected, found);
}

ris_result ris__json_check_format(const ris_json_at *root, const char *format, int version, ris_error *err)
{
    char expected[64];
    ris_json_at at = ris__json_key(root, "format");
    snprintf(expected, sizeof expected, "\"%s\"", format);
    if (!json_is_string(at.value) || strcmp(json_string_value(at.value), format) != 0) {
        return ris__json_expected(&at, err, expected);
    }
    at = ris__json_key(root, "version");
    snprintf(expected, sizeof expected, "%d", version);
    if (!json_is_integer(at.value) || json_integer_value(at.value) != version) {
        return ris__json_expected(&at, err, expected);
    }
    return RIS_OK;
}

ris_result ris__json_check_object(const ris_json_at *at, const char *const *keys, ris_error *err)
{
    const char *key;
    json_t *value;
    if (!json_is_object(at->value)) {
        return ris__json_expected(at, err, "an object");
    }
    json_object_foreach(at->value, key, value)
    {
        ris_nearest nearest;
        char names[256];
        bool known = false;
        ris__nearest_init(&nearest, key);
        for (size_t i = 0; keys[i]; i++) {
            known = known || strcmp(keys[i], key) == 0;
            ris__nearest_add(&nearest, keys[i]);
        }
        if (!known) {
            ris_json_at unknown = ris__json_key(at, key);
            return ris__json_fail(&unknown, err, "unknown key; nearest: %s",
                                  ris__nearest_text(&nearest, names, sizeof names));
        }
    }
    return RIS_OK;
}

ris_result ris__json_check_array(const ris_json_at *at, size_t minimum, size_t maximum, ris_error *err)
{
    size_t count = json_array_size(at->value);
    if (!json_is_array(at->value) || count < minimum || count > maximum) {
        char expected[64];
        if (minimum == maximum) {
            snprintf(expected, sizeof expected, "an array of %zu", minimum);
        } else {
            snprintf(expected, sizeof expected, "an array of %zu to %zu", minimum, maximum);
        }
        return ris__json_expected(at, err, expected);
    }
    return RIS_OK;
}

ris_result ris__json_double(const ris_json_at *at, ris_json_need need, double minimum, double maximum,
                            double *out, ris_error *err)
{
    if (need == RIS_JSON_OPTIONAL && !at->value) {
        return RIS_OK;
    }
    double value = json_number_value(at->value);
    /* written so that NaN is refused too */
    if (!json_is_number(at->value) || !(value >= minimum && value <= maximum)) {
        char expected[64];
        snprintf(expected, sizeof expected, "a number of %g to %g", minimum, maximum);
        return ris__json_expected(at, err, expected);
    }
    *out = value;
    return RIS_OK;
}

ris_result ris__json_float(const ris_json_at *at, ris_json_need need, double minimum, double maximum,
                           float *out, ris_error *err)
{
    double value = *out;
    ris_result result = ris__json_double(at, need, minimum, maximum, &value, err);
    if (result == RIS_OK) {
        *out = (float)value;
    }
    return result;
}

ris_result ris__json_uint(const ris_json_at *at, ris_json_need need, uint32_t minimum, uint32_t maximum,
                          uint32_t *out, ris_error *err)
{
    if (need == RIS_JSON_OPTIONAL && !at->value) {
        return RIS_OK;
    }
    json_int_t value = json_integer_value(at->value);
    if (!json_is_integer(at->value) || value < (json_int_t)minimum || value > (json_int_t)maximum) {
        char expected[64];
        snprintf(expected, sizeof expected, "an integer of %u to %u", minimum, maximum);
        return ris__json_expected(at, err, expected);
    }
    *out = (uint32_t)value;
    return RIS_OK;
}

ris_result ris__json_floats(const ris_json_at *at, ris_json_need need, uint32_t count, double minimum,
                            double maximum, float *out, ris_error *err)
{
    char expected[64];
    if (need == RIS_JSON_OPTIONAL && !at->value) {
        return RIS_OK;
    }
    if (!json_is_array(at->value) || json_array_size(at->value) != count) {
        snprintf(expected, sizeof expected, "%u numbers", count);
        return ris__json_expected(at, err, expected);
    }
    for (uint32_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        ris_result result = ris__json_float(&item, RIS_JSON_REQUIRED, minimum, maximum, &out[i], err);
        if (result != RIS_OK) {
            return result;
        }
    }
    return RIS_OK;
}

ris_result ris__json_text(const ris_json_at *at, ris_json_need need, char *out, size_t size, ris_error *err)
{
    if (need == RIS_JSON_OPTIONAL && !at->value) {
        return RIS_OK;
    }
    size_t length = json_string_length(at->value);
    bool fine = json_is_string(at->value) && length < size;
    for (size_t i = 0; fine && i < length; i++) {
        fine = (unsigned char)json_string_value(at->value)[i] >= 32;
    }
    if (!fine) {
        char expected[64];
        snprintf(expected, sizeof expected, "a text of at most %zu bytes on one line", size - 1);
        return ris__json_expected(at, err, expected);
    }
    memcpy(out, json_string_value(at->value), length + 1);
    return RIS_OK;
}

ris_result ris__json_choice(const ris_json_at *at, ris_json_need need, const char *const *choices,
                            uint32_t *out, ris_error *err)
{
    char expected[160] = "one of ";
    if (need == RIS_JSON_OPTIONAL && !at->value) {
        return RIS_OK;
    }
    for (uint32_t i = 0; choices[i]; i++) {
        if (json_is_string(at->value) && strcmp(json_string_value(at->value), choices[i]) == 0) {
            *out = i;
            return RIS_OK;
        }
        size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s%s", i ? ", " : "", choices[i]);
    }
    return ris__json_expected(at, err, expected);
}
