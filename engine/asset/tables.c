/* depth.csv and skin.map: one line per skin vertex. Errors give line and column. */
#include "asset/head_parts.h"
#include "asset/lines.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

#define MAX_DEPTH_MM 100.0
#define CSV_HEADER "vertex,depth_mm,jaw_weight"

bool ris__lines_next(ris_lines *l)
{
    if (l->next >= l->end) {
        return false;
    }
    const char *newline = memchr(l->next, '\n', (size_t)(l->end - l->next));
    l->start = l->at = l->next;
    l->stop = newline ? newline : l->end;
    l->next = newline ? newline + 1 : l->end;
    if (l->stop > l->start && l->stop[-1] == '\r') {
        l->stop--;
    }
    l->line++;
    return true;
}

ris_result ris__lines_expected(const ris_lines *l, const char *what)
{
    int length = (int)(l->stop - l->at < 24 ? l->stop - l->at : 24);
    return ris_fail(l->err, RIS_ERROR_DATA, "%s:%u:%d: expected %s, found \"%.*s\"", l->name, l->line,
                    (int)(l->at - l->start) + 1, what, length, l->at);
}

static ris_result wrong_count(const ris_lines *l, uint32_t wanted, const char *found)
{
    return ris_fail(l->err, RIS_ERROR_DATA, "%s:%u:1: expected one row for each of the %u vertices, found %s",
                    l->name, l->line + 1, wanted, found);
}

ris_result ris__lines_header(ris_lines *l, const char *header)
{
    if (!ris__lines_next(l) || (size_t)(l->stop - l->start) != strlen(header) ||
        memcmp(l->start, header, strlen(header)) != 0) {
        return ris_fail(l->err, RIS_ERROR_DATA, "%s:1:1: expected the header \"%s\"", l->name, header);
    }
    return RIS_OK;
}

ris_result ris__lines_number(ris_lines *l, const char *what, double minimum, double maximum, char separator,
                             float *out)
{
    double value;
    const char *after = ris__parse_number(l->at, l->stop, &value);
    if (!after || !(value >= minimum && value <= maximum)) {
        return ris__lines_expected(l, what);
    }
    l->at = after;
    if (separator ? l->at >= l->stop || *l->at != separator : l->at != l->stop) {
        return ris__lines_expected(l, separator ? "a comma" : "the end of the line");
    }
    l->at += separator != 0;
    *out = (float)value;
    return RIS_OK;
}

static ris_result read_row(ris_lines *l, uint32_t vertex, ris_head *head)
{
    int64_t index;
    ris_result result;
    char what[48];
    const char *after = ris__parse_integer(l->at, l->stop, &index);
    if (!after || index != (int64_t)vertex || after >= l->stop || *after != ',') {
        snprintf(what, sizeof what, "vertex %u and a comma", vertex);
        return ris__lines_expected(l, what);
    }
    l->at = after + 1;
    if ((result =
             ris__lines_number(l, "a depth of 0 to 100 mm", 0, MAX_DEPTH_MM, ',', &head->depth_mm[vertex]))) {
        return result;
    }
    return ris__lines_number(l, "a jaw weight of 0 to 1", 0, 1, 0, &head->jaw_weight[vertex]);
}

ris_result ris__depth_read(const char *name, const char *text, size_t size, ris_head *head, ris_error *err)
{
    ris_lines l = {.name = name, .next = text, .end = text + size, .err = err};
    uint32_t count = head->skin.vertex_count;
    ris_result header = ris__lines_header(&l, CSV_HEADER);
    if (header != RIS_OK) {
        return header;
    }
    head->depth_mm = malloc(count * sizeof *head->depth_mm);
    head->jaw_weight = malloc(count * sizeof *head->jaw_weight);
    if (!head->depth_mm || !head->jaw_weight) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %u vertices", name, count);
    }
    for (uint32_t v = 0; v < count; v++) {
        if (!ris__lines_next(&l)) {
            return wrong_count(&l, count, "the end of the file");
        }
        ris_result result = read_row(&l, v, head);
        if (result != RIS_OK) {
            return result;
        }
    }
    return ris__lines_next(&l) ? wrong_count(&l, count, "more") : RIS_OK;
}

ris_result ris__map_read(const char *name, const char *text, size_t size, ris_head *head, ris_error *err)
{
    ris_lines l = {.name = name, .next = text, .end = text + size, .err = err};
    uint32_t count = head->skin.vertex_count;
    head->base_vertex = malloc(count * sizeof *head->base_vertex);
    if (!head->base_vertex) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %u vertices", name, count);
    }
    for (uint32_t v = 0; v < count; v++) {
        int64_t index;
        if (!ris__lines_next(&l)) {
            return wrong_count(&l, count, "the end of the file");
        }
        const char *after = ris__parse_integer(l.at, l.stop, &index);
        if (!after || after != l.stop || index < -1 || index > INT32_MAX) {
            return ris__lines_expected(&l, "a base vertex or -1");
        }
        head->base_vertex[v] = (int32_t)index;
    }
    return ris__lines_next(&l) ? wrong_count(&l, count, "more") : RIS_OK;
}
