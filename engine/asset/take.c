/* Recorded performances: what both formats share (docs/performances.md). */
#include "asset/take.h"
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SAMPLES (1u << 20)

ris_take_def ris_default_take_def(ris_take_format format)
{
    return (ris_take_def){.format = format, .confidence = 0.7};
}

void ris__take_finish(ris_take_table *table)
{
    free(table->column);
    free(table->time_s);
    free(table->line);
    free(table->value);
    *table = (ris_take_table){0};
}

static bool grow(void *array, size_t count, size_t size)
{
    void *grown = realloc(*(void **)array, count * size + 1);
    if (grown) {
        *(void **)array = grown;
    }
    return grown != NULL;
}

float *ris__take_add(ris_take_table *table, double time_s, uint32_t line)
{
    if (table->sample_count == table->capacity) {
        const uint32_t capacity = table->capacity ? 2 * table->capacity : 64;
        if (capacity > MAX_SAMPLES || !grow((void *)&table->time_s, capacity, sizeof *table->time_s) ||
            !grow((void *)&table->line, capacity, sizeof *table->line) ||
            !grow((void *)&table->value, (size_t)capacity * table->column_count, sizeof *table->value)) {
            return NULL;
        }
        table->capacity = capacity;
    }
    const uint32_t at = table->sample_count++;
    table->time_s[at] = time_s;
    table->line[at] = line;
    float *value = table->value + (size_t)at * table->column_count;
    for (uint32_t c = 0; c < table->column_count; c++) {
        value[c] = 0;
    }
    return value;
}

bool ris__cell(const ris_lines *l, const char **end)
{
    const char *comma = memchr(l->at, ',', (size_t)(l->stop - l->at));
    *end = comma ? comma : l->stop;
    return l->at < l->stop;
}

bool ris__cell_done(ris_lines *l, const char *end)
{
    if (end == l->stop) {
        l->at = end;
        return false;
    }
    l->at = end + 1;
    while (l->at < l->stop && *l->at == ' ') {
        l->at++;
    }
    return true;
}

ris_result ris__cell_number(ris_lines *l, const char *what, double minimum, double maximum, double *out,
                            bool *last)
{
    const char *end;
    ris__cell(l, &end);
    const char *after = ris__parse_number(l->at, end, out);
    while (after && after < end && *after == ' ') {
        after++;
    }
    if (after != end || !(*out >= minimum && *out <= maximum)) {
        return ris__lines_expected(l, what);
    }
    *last = !ris__cell_done(l, end);
    return RIS_OK;
}

ris_result ris__take_parse(const char *name, const char *text, size_t size, const ris_take_def *def,
                           ris_take_table *out, ris_take_info *info, ris_error *err)
{
    ris_lines l = {.name = name, .next = text, .end = text + size, .err = err};
    *out = (ris_take_table){0};
    *info = (ris_take_info){0};
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) { /* byte order mark of a spreadsheet */
        l.next += 3;
    }
    ris_result result = def->format == RIS_TAKE_LIVE_LINK ? ris__live_link_parse(&l, def, out, info)
                                                          : ris__openface_parse(&l, def, out, info);
    if (result == RIS_OK && out->sample_count == 0) {
        result = info->rows ? ris_fail(err, RIS_ERROR_DATA,
                                       "%s:%u:1: expected a row with a face, found none among %u rows", name,
                                       l.line, info->rows)
                            : ris_fail(err, RIS_ERROR_DATA,
                                       "%s:%u:1: expected rows below the header, found the end of the file",
                                       name, l.line + 1);
    }
    if (result == RIS_OK) {
        result = ris__take_clean(out, def, info);
        if (result == RIS_ERROR_MEMORY) {
            ris_fail(err, result, "%s: no memory for %u samples", name, out->sample_count);
        }
    }
    if (result != RIS_OK) {
        ris__take_finish(out);
    }
    return result;
}

static ris_result adjust_number(const char *word, const char *text, const char *end, double low, double high,
                                double *out, ris_error *err)
{
    if (ris__parse_number(text, end, out) != end || !(*out >= low && *out <= high)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--adjust: %s: expected a number from %g to %g, found \"%.*s\"",
                        word, low, high, (int)(end - text < 40 ? end - text : 40), text);
    }
    return RIS_OK;
}

static bool is_word(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && memcmp(text, word, length) == 0;
}

ris_result ris_take_adjust(ris_take_def *def, const char *words, ris_error *err)
{
    const struct {
        const char *name;
        bool *flag;
    } flag[] = {
        {"mirror", &def->mirror},           {"flip-yaw", &def->flip_yaw}, {"flip-pitch", &def->flip_pitch},
        {"flip-roll", &def->flip_roll},     {"center", &def->center},     {"no-head", &def->no_head},
        {"keep-spikes", &def->keep_spikes}, {"onset", &def->onset},       {"degrees", &def->degrees}};
    for (const char *at = words;; at++) {
        const size_t length = strcspn(at, ",");
        const char *end = at + length;
        bool known = is_word(at, length, "landscape");
        if (known) {
            def->flip_yaw = def->flip_pitch = true;
        }
        for (size_t k = 0; k < sizeof flag / sizeof *flag; k++) {
            if (is_word(at, length, flag[k].name)) {
                *flag[k].flag = known = true;
            }
        }
        ris_result result = RIS_OK;
        if (length > 5 && memcmp(at, "rate=", 5) == 0) {
            known = true;
            result = adjust_number("rate", at + 5, end, 1, 1000, &def->rate_hz, err);
        } else if (length > 11 && memcmp(at, "confidence=", 11) == 0) {
            known = true;
            result = adjust_number("confidence", at + 11, end, 0, 1, &def->confidence, err);
        }
        if (!known) {
            result = ris_fail(err, RIS_ERROR_USAGE,
                              "--adjust: expected mirror, flip-yaw, flip-pitch, flip-roll, landscape, "
                              "center, no-head, keep-spikes, onset, degrees, rate=HZ or confidence=C, found "
                              "\"%.*s\"",
                              (int)(length < 40 ? length : 40), at);
        }
        if (result != RIS_OK || *end == 0) {
            return result;
        }
        at = end;
    }
}

const char *ris_take_describe(const ris_take_info *info, char *out, size_t size)
{
    const struct {
        uint32_t count;
        const char *text;
    } note[] = {{info->lost, "rows without a sure face"},
                {info->repeated, "rows of a time that was there"},
                {info->other_faces, "rows of another face"},
                {info->spikes, "leaps of one frame taken out"},
                {info->clamped, "values clamped to their range"},
                {info->unknown, "columns this head has nothing for"}};
    int used = snprintf(out, size, "%u of %u rows, %u columns that move, %.2f s at %g Hz", info->samples,
                        info->rows, info->columns, info->duration_s, info->rate_hz);
    if (info->gaps && used > 0 && (size_t)used < size) {
        used += snprintf(out + used, size - (size_t)used, "; %u gaps bridged, the longest %.2f s", info->gaps,
                         info->longest_gap_s);
    }
    for (size_t k = 0; k < sizeof note / sizeof *note; k++) {
        if (note[k].count && used > 0 && (size_t)used < size) {
            used += snprintf(out + used, size - (size_t)used, "; %u %s", note[k].count, note[k].text);
        }
    }
    return out;
}
