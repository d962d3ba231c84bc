#include "base/text.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_LIMIT 63 /* RIS_NAME_SIZE - 1 */

static bool is_digit(const char *text, const char *end)
{
    return text < end && *text >= '0' && *text <= '9';
}

/* The rare numbers that the exact path below cannot do: long mantissas and big exponents. */
static bool convert_slow(const char *text, size_t length, double *out)
{
    char buffer[512];
    if (length >= sizeof buffer) {
        return false;
    }
    memcpy(buffer, text, length);
    buffer[length] = 0;
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0) {
        return false;
    }
    locale_t before = uselocale(c_locale);
    *out = strtod(buffer, NULL);
    uselocale(before);
    freelocale(c_locale);
    return isfinite(*out);
}

const char *ris__parse_number(const char *text, const char *end, double *out)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *p = text;
    bool negative = false, exact = true;
    uint64_t mantissa = 0;
    int exponent = 0, digits = 0;
    if (p < end && (*p == '-' || *p == '+')) {
        negative = *p++ == '-';
    }
    for (bool fraction = false; p < end; p++) {
        if (*p == '.' && !fraction) {
            fraction = true;
            continue;
        }
        if (!is_digit(p, end)) {
            break;
        }
        digits++;
        if (mantissa < UINT64_C(900000000000000)) { /* one more digit stays below 2^53 */
            mantissa = mantissa * 10 + (uint64_t)(*p - '0');
            exponent -= fraction;
        } else {
            exact = false;
        }
    }
    if (digits == 0) {
        return NULL;
    }
    if (p < end && (*p == 'e' || *p == 'E')) {
        const char *q = p + 1;
        bool minus = q < end && *q == '-';
        int value = 0;
        q += q < end && (*q == '-' || *q == '+');
        if (is_digit(q, end)) {
            for (; is_digit(q, end); q++) {
                value = value > 9999 ? value : value * 10 + (*q - '0');
            }
            exponent += minus ? -value : value;
            p = q;
        }
    }
    /* both factors are exact doubles, so one rounding: the same result as strtod */
    if (exact && exponent >= -22 && exponent <= 22) {
        double value =
            exponent < 0 ? (double)mantissa / power[-exponent] : (double)mantissa * power[exponent];
        *out = negative ? -value : value;
        return p;
    }
    return convert_slow(text, (size_t)(p - text), out) ? p : NULL;
}

const char *ris__parse_integer(const char *text, const char *end, int64_t *out)
{
    const char *p = text;
    bool negative = false;
    int64_t value = 0;
    if (p < end && (*p == '-' || *p == '+')) {
        negative = *p++ == '-';
    }
    if (!is_digit(p, end)) {
        return NULL;
    }
    for (; is_digit(p, end); p++) {
        value = value * 10 + (*p - '0');
        if (value > (INT64_C(1) << 53)) {
            return NULL;
        }
    }
    *out = negative ? -value : value;
    return p;
}

uint32_t ris__edit_distance(const char *a, const char *b)
{
    uint32_t row[NAME_LIMIT + 1];
    uint32_t length_a = 0, length_b = 0;
    while (a[length_a] && length_a < NAME_LIMIT) {
        length_a++;
    }
    while (b[length_b] && length_b < NAME_LIMIT) {
        length_b++;
    }
    for (uint32_t j = 0; j <= length_b; j++) {
        row[j] = j;
    }
    for (uint32_t i = 1; i <= length_a; i++) {
        uint32_t diagonal = row[0];
        row[0] = i;
        for (uint32_t j = 1; j <= length_b; j++) {
            uint32_t best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            best = row[j] + 1 < best ? row[j] + 1 : best;
            best = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
            row[j] = best;
        }
    }
    return row[length_b];
}

void ris__nearest_init(ris_nearest *nearest, const char *wanted)
{
    *nearest = (ris_nearest){.wanted = wanted};
}

void ris__nearest_add(ris_nearest *nearest, const char *name)
{
    for (uint32_t i = 0; i < nearest->count; i++) {
        if (strcmp(nearest->name[i], name) == 0) {
            return;
        }
    }
    const size_t length = strlen(nearest->wanted);
    const bool a_side_of_it = strncmp(name, nearest->wanted, length) == 0 && name[length] == '.';
    const uint32_t distance = a_side_of_it ? 0 : ris__edit_distance(nearest->wanted, name);
    uint32_t place = nearest->count;
    while (place > 0 && distance < nearest->distance[place - 1]) {
        place--;
    }
    if (place == 3) {
        return;
    }
    nearest->count += nearest->count < 3;
    for (uint32_t i = nearest->count - 1; i > place; i--) {
        nearest->name[i] = nearest->name[i - 1];
        nearest->distance[i] = nearest->distance[i - 1];
    }
    nearest->name[place] = name;
    nearest->distance[place] = distance;
}

const char *ris__nearest_text(const ris_nearest *nearest, char *out, size_t size)
{
    snprintf(out, size, "%s", nearest->count ? "" : "none");
    for (uint32_t i = 0; i < nearest->count; i++) {
        size_t used = strlen(out);
        snprintf(out + used, size - used, "%s%s", i ? ", " : "", nearest->name[i]);
    }
    return out;
}
