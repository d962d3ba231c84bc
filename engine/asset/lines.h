/* Tables in text files, line by line, with errors that give line and column. */
#pragma once

#include "risorius/base.h"

typedef struct ris_lines {
    const char *name, *next, *end; /* next line starts at next */
    const char *start, *at, *stop; /* of the present line */
    uint32_t line;
    ris_error *err;
} ris_lines;

/* Steps to the next line; false at the end of the text. A last line without newline counts, an empty one does
 * not. */
bool ris__lines_next(ris_lines *l);
/* RIS_ERROR_DATA: "name:line:col: expected ..., found ..." at l->at. */
ris_result ris__lines_expected(const ris_lines *l, const char *what);
/* The first line must be this header. */
ris_result ris__lines_header(ris_lines *l, const char *header);
/* A number within the range that is followed by the separator (0 = the end of the line). */
ris_result ris__lines_number(ris_lines *l, const char *what, double minimum, double maximum, char separator,
                             float *out);
