/* Finds a value again in its JSON text, for the line and column of an error about it. The text has been
 * accepted by Jansson, so this only has to walk, never to judge; it still never reads past the end. */
#include "asset/json.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct walker {
    const char *at, *end;
} walker;

static void skip_blanks(walker *w)
{
    while (w->at < w->end && strchr(" \t\r\n", *w->at) && *w->at) {
        w->at++;
    }
}

static void skip_string(walker *w)
{
    for (w->at++; w->at < w->end && *w->at != '"'; w->at++) {
        w->at += *w->at == '\\' && w->at + 1 < w->end;
    }
    w->at += w->at < w->end;
}

/* Past one value, whatever is in it. */
static void skip_value(walker *w)
{
    size_t depth = 0;
    do {
        skip_blanks(w);
        if (w->at >= w->end) {
            return;
        }
        if (*w->at == '"') {
            skip_string(w);
        } else if (*w->at == '{' || *w->at == '[') {
            depth++;
            w->at++;
        } else if (*w->at == '}' || *w->at == ']') {
            depth -= depth > 0;
            w->at++;
        } else if (*w->at == ',' || *w->at == ':') {
            w->at++;
        } else {
            do { /* a number or a literal */
                w->at++;
            } while (w->at < w->end && !strchr(" \t\r\n,:]}\"", *w->at));
        }
    } while (depth > 0);
}

/* From the start of an object to the value of key; false if it is not there in plain letters. */
static bool enter_key(walker *w, const char *key)
{
    size_t length = strlen(key);
    for (w->at++; w->at < w->end;) {
        skip_blanks(w);
        if (w->at >= w->end || *w->at != '"') {
            return false;
        }
        const char *start = w->at + 1;
        skip_string(w);
        bool found = (size_t)(w->at - start) == length + 1 && memcmp(start, key, length) == 0;
        skip_blanks(w);
        w->at += w->at < w->end; /* the colon */
        skip_blanks(w);
        if (found) {
            return true;
        }
        skip_value(w);
        skip_blanks(w);
        w->at += w->at < w->end && *w->at == ',';
    }
    return false;
}

static bool enter_item(walker *w, size_t index)
{
    for (w->at++; w->at < w->end; index--) {
        skip_blanks(w);
        if (index == 0) {
            return w->at < w->end && *w->at != ']';
        }
        skip_value(w);
        skip_blanks(w);
        if (w->at >= w->end || *w->at != ',') {
            return false;
        }
        w->at++;
    }
    return false;
}

/* Leaves w at the value; false if the way there is lost (then w is at the last value found). */
static bool walk(walker *w, const ris_json_at *at)
{
    if (!at->parent) {
        skip_blanks(w);
        return true;
    }
    if (!walk(w, at->parent) || w->at >= w->end) {
        return false;
    }
    walker before = *w;
    bool found = at->key ? *w->at == '{' && enter_key(w, at->key) : *w->at == '[' && enter_item(w, at->index);
    if (!found) {
        *w = before;
    }
    return found;
}

static size_t write_path(const ris_json_at *at, char *out, size_t size)
{
    if (!at->parent) {
        return 0;
    }
    size_t used = write_path(at->parent, out, size);
    int wrote;
    if (used >= size) {
        return used;
    }
    if (at->key) {
        wrote = snprintf(out + used, size - used, "%s%.63s", at->parent->parent ? "." : "", at->key);
    } else {
        wrote = snprintf(out + used, size - used, "[%zu]", at->index);
    }
    return used + (wrote > 0 ? (size_t)wrote : 0);
}

ris_result ris__json_fail(const ris_json_at *at, ris_error *err, const char *format, ...)
{
    char sentence[768], path[160] = "";
    int line = 1, column = 1;
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    walker w = {at->json->text, at->json->text + at->json->size};
    walk(&w, at);
    for (const char *p = at->json->text; p < w.at; p++) {
        if (*p == '\n') {
            line++;
            column = 1;
        } else {
            column += ((unsigned char)*p & 0xC0) != 0x80; /* count letters, not their UTF-8 bytes */
        }
    }
    write_path(at, path, sizeof path);
    return ris_fail(err, RIS_ERROR_DATA, "%s:%d:%d: %s%s%s", at->json->name, line, column, path,
                    path[0] ? ": " : "", sentence);
}
