/* Names and numbers in text: strict, independent of the locale. */
#pragma once

#include "risorius/base.h"

/* Reads one decimal number ("-1.5", "3", ".5", "2e-3") from [text, end), whatever the locale; "nan", "inf",
 * hex and blanks are not numbers. Returns the first byte after it, or NULL if there is none or it is beyond
 * double's range. */
const char *ris__parse_number(const char *text, const char *end, double *out);
/* Reads an optionally signed decimal integer from [text, end); NULL if there is none or |value| > 2^53. */
const char *ris__parse_integer(const char *text, const char *end, int64_t *out);

/* The three names nearest to a wanted one by edit distance; ties keep the order in which they were added. */
typedef struct ris_nearest {
    const char *wanted;
    uint32_t count; /* 0..3 */
    const char *name[3];
    uint32_t distance[3];
} ris_nearest;

void ris__nearest_init(ris_nearest *nearest, const char *wanted);
/* name must outlive nearest. A name already among the three is not added twice. */
void ris__nearest_add(ris_nearest *nearest, const char *name);
/* "a, b, c" for the end of a sentence; "none" when nothing was added. Returns out. */
const char *ris__nearest_text(const ris_nearest *nearest, char *out, size_t size);

/* Edit distance (insert, delete, replace) of two names, in bytes; only the first 63 bytes of each count. */
uint32_t ris__edit_distance(const char *a, const char *b);
