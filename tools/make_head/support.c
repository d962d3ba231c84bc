/* Vectors, memory and recipe access of risorius-make-head. */
#include "make_head.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

dvec v_cross(dvec a, dvec b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

double v_length(dvec a)
{
    return sqrt(v_dot(a, a));
}

dvec v_unit(dvec a)
{
    double length = v_length(a);
    return length > 0 ? v_mul(a, 1 / length) : v3(0, 0, 1);
}

double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

double smoothstep(double low, double high, double x)
{
    double t = clamp((x - low) / (high - low), 0, 1);
    return t * t * (3 - 2 * t);
}

_Noreturn void stop(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("risorius-make-head: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(ris_exit_code(RIS_ERROR_DATA));
}

void *need(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (!memory)
        stop("out of memory for %zu items of %zu bytes", count, size);
    return memory;
}

json_t *recipe_get(json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    if (!value)
        stop("recipe: expected the key \"%s\", found none", key);
    return value;
}

double recipe_number(json_t *object, const char *key)
{
    json_t *value = recipe_get(object, key);
    if (!json_is_number(value))
        stop("recipe: expected a number at \"%s\"", key);
    return json_number_value(value);
}

uint32_t recipe_index(json_t *object, const char *key)
{
    double value = recipe_number(object, key);
    if (value < 0 || value > 1e6 || value != floor(value))
        stop("recipe: expected a vertex index at \"%s\", found %g", key, value);
    return (uint32_t)value;
}

void recipe_numbers(json_t *object, const char *key, double *out, size_t count)
{
    json_t *list = recipe_get(object, key);
    if (!json_is_array(list) || json_array_size(list) != count)
        stop("recipe: expected %zu numbers at \"%s\"", count, key);
    for (size_t i = 0; i < count; i++)
        out[i] = json_number_value(json_array_get(list, i));
}

void recipe_range(json_t *object, const char *key, uint32_t out[2])
{
    double pair[2];
    recipe_numbers(object, key, pair, 2);
    if (pair[0] < 0 || pair[1] < pair[0])
        stop("recipe: expected an ascending pair at \"%s\"", key);
    out[0] = (uint32_t)pair[0];
    out[1] = (uint32_t)pair[1];
}
