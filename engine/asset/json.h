/* JSON with errors that say where: a value is addressed by the path it was reached by, so that every message
 * carries file, line, column and path ("muscles.json:12:8: muscles[3].grid[0][1]: expected 3 numbers, found
 * 2"). Jansson reads the text; line and column of a value are found again in the text only when an error
 * needs them. */
#pragma once

#include "risorius/base.h"

#include <jansson.h>

typedef struct ris_json {
    char *name; /* of the file, for messages */
    char *text;
    size_t size;
    json_t *root;
} ris_json;

/* A value and how it was reached; lives on the stack, parent must outlive it. value is NULL if the key is
 * absent. */
typedef struct ris_json_at {
    const ris_json *json;
    const struct ris_json_at *parent;
    const char *key; /* key within an object, or NULL = index within an array (or the root) */
    size_t index;
    json_t *value;
} ris_json_at;

/* Reads a file, or a copy of a text; the root must be an object, a key twice is an error. RIS_ERROR_DATA. */
ris_result ris__json_load(const char *path, ris_json *out, ris_error *err);
ris_result ris__json_parse(const char *name, const char *text, size_t size, ris_json *out, ris_error *err);
void ris__json_finish(ris_json *json);

ris_json_at ris__json_root(const ris_json *json);
ris_json_at ris__json_key(const ris_json_at *at, const char *key);
ris_json_at ris__json_item(const ris_json_at *at, size_t index);
/* Absent or null. */
bool ris__json_absent(const ris_json_at *at);

/* RIS_ERROR_DATA with "file:line:col: path: sentence" for this value (for its parent if it is absent). */
ris_result ris__json_fail(const ris_json_at *at, ris_error *err, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
/* "expected <expected>, found <what is there>". */
ris_result ris__json_expected(const ris_json_at *at, ris_error *err, const char *expected);

/* Checks that root has "format": format and "version": version. */
ris_result ris__json_check_format(const ris_json_at *root, const char *format, int version, ris_error *err);
/* Refuses a value that is no object, or has a key outside the NULL-ended list (names the nearest ones). */
ris_result ris__json_check_object(const ris_json_at *at, const char *const *keys, ris_error *err);
/* Refuses a value that is no array of minimum..maximum items. */
ris_result ris__json_check_array(const ris_json_at *at, size_t minimum, size_t maximum, ris_error *err);

/* Readers: an absent value leaves *out as it is if optional, else is an error. Ranges are inclusive. */
typedef enum ris_json_need { RIS_JSON_REQUIRED, RIS_JSON_OPTIONAL } ris_json_need;
ris_result ris__json_float(const ris_json_at *at, ris_json_need need, double minimum, double maximum,
                           float *out, ris_error *err);
ris_result ris__json_double(const ris_json_at *at, ris_json_need need, double minimum, double maximum,
                            double *out, ris_error *err);
ris_result ris__json_uint(const ris_json_at *at, ris_json_need need, uint32_t minimum, uint32_t maximum,
                          uint32_t *out, ris_error *err);
/* count numbers of [minimum, maximum] in an array. */
ris_result ris__json_floats(const ris_json_at *at, ris_json_need need, uint32_t count, double minimum,
                            double maximum, float *out, ris_error *err);
/* Text of at most size - 1 bytes without control characters. */
ris_result ris__json_text(const ris_json_at *at, ris_json_need need, char *out, size_t size, ris_error *err);
/* The position of the text in the NULL-ended list of choices. */
ris_result ris__json_choice(const ris_json_at *at, ris_json_need need, const char *const *choices,
                            uint32_t *out, ris_error *err);
