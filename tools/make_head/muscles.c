/* First layout of muscles.json: grids on the skin from the recipe's origins, insertions and widths (KA-38,
 * KA-44). Afterwards the file is calibrated by hand, so it is written only when asked for. */
#include "make_head.h"

#include <stdlib.h>
#include <string.h>

static const char *text_of(json_t *entry, const char *key)
{
    const char *text = json_string_value(recipe_get(entry, key));
    if (!text)
        stop("recipe: expected a text at \"%s\"", key);
    return text;
}

/* On the skin in front of x, y; where that is another surface (the neck behind the jaw), nearest to the guess. */
static void put_point(FILE *file, const maker *m, dvec guess, bool first)
{
    dvec on = skin_project(&m->skin, guess.x, guess.y, NULL);
    if (on.z < guess.z - 12 || on.z > guess.z + 12)
        on = skin_nearest(&m->skin, guess, NULL);
    dvec p = to_head(&m->frame, on);
    fprintf(file, "%s[%.3f, %.3f, %.3f]", first ? "" : ", ", p.x, p.y, p.z);
}

static void put_linear_grid(FILE *file, const maker *m, json_t *entry)
{
    double from[2], to[2], width[2], size[2], near[2];
    recipe_numbers(entry, "origin_xy", from, 2);
    recipe_numbers(entry, "insertion_xy", to, 2);
    recipe_numbers(entry, "near_vertices", near, 2);
    recipe_numbers(entry, "half_width", width, 2);
    recipe_numbers(entry, "rows_columns", size, 2);
    double z[2];
    for (int k = 0; k < 2; k++) {
        if (near[k] < 0 || near[k] >= m->topo.body_end)
            stop("recipe: near vertex %g is off the body", near[k]);
        z[k] = m->mesh.position[(uint32_t)near[k]].z;
    }
    dvec across = v_unit(v3(-(to[1] - from[1]), to[0] - from[0], 0));
    if (across.x < 0)
        across = v_mul(across, -1);
    int rows = (int)size[0], columns = (int)size[1];
    for (int r = 0; r < rows; r++) {
        double t = (double)r / (rows - 1), half = width[0] + t * (width[1] - width[0]);
        fprintf(file, "        [");
        for (int c = 0; c < columns; c++) {
            double s = half * (2.0 * c / (columns - 1) - 1);
            dvec guess = v3(from[0] + t * (to[0] - from[0]) + s * across.x,
                            from[1] + t * (to[1] - from[1]) + s * across.y, z[0] + t * (z[1] - z[0]));
            put_point(file, m, guess, c == 0);
        }
        fprintf(file, "]%s\n", r + 1 < rows ? "," : "");
    }
}

/* y as an even polynomial of x through three points, the first at x = 0. */
static double even_curve(const dvec p[3], double x)
{
    double a = p[1].x * p[1].x, b = p[2].x * p[2].x, u = x * x;
    double s1 = (p[1].y - p[0].y) / a, s2 = (p[2].y - p[0].y) / b, quartic = (s2 - s1) / (b - a);
    return p[0].y + u * (s1 + quartic * (u - a));
}

/* Rows from the subject's right mouth corner along the lip to the left one; columns from the outer ring to the red. */
static void put_lip_grid(FILE *file, const maker *m, json_t *entry)
{
    json_t *rings = recipe_get(entry, "through");
    size_t columns = json_array_size(rings);
    int rows = (int)recipe_number(entry, "rows");
    for (int r = 0; r < rows; r++) {
        fprintf(file, "        [");
        for (size_t c = 0; c < columns; c++) {
            dvec p[3];
            for (size_t k = 0; k < 3; k++) {
                json_int_t v = json_integer_value(json_array_get(json_array_get(rings, c), k));
                if (v < 0 || v >= m->topo.body_end)
                    stop("recipe: lip vertex %lld is off the body", (long long)v);
                p[k] = m->mesh.position[v];
            }
            double x = p[2].x * (2.0 * r / (rows - 1) - 1);
            put_point(file, m, v3(x, even_curve(p, x), p[1].z), c == 0);
        }
        fprintf(file, "]%s\n", r + 1 < rows ? "," : "");
    }
}

/* The line in the middle plane that a sphincter closes on. */
static void put_axis(FILE *file, const maker *m, json_t *ends)
{
    dvec p[2];
    for (size_t k = 0; k < 2; k++) {
        json_t *yz = json_array_get(ends, k);
        p[k] = to_head(&m->frame, v3(0, json_number_value(json_array_get(yz, 0)),
                                     json_number_value(json_array_get(yz, 1))));
    }
    fprintf(file, "      \"axis\": [[0, %.3f, %.3f], [0, %.3f, %.3f]],\n", p[0].y, p[0].z, p[1].y, p[1].z);
}

static void put_muscle(FILE *file, const maker *m, json_t *entry, bool last)
{
    const char *name = text_of(entry, "name"), *kind = text_of(entry, "kind");
    bool sided = strcmp(kind, "linear") == 0;
    double thickness[2];
    recipe_numbers(entry, "thickness_mm", thickness, 2);
    fprintf(file, "    {\"name\": \"%s%s\", \"mirror_of\": null, \"kind\": \"%s\", \"bone\": \"%s\",\n", name,
            sided ? ".L" : "", kind, text_of(entry, "bone"));
    fprintf(file, "      \"grid\": [\n");
    if (sided)
        put_linear_grid(file, m, entry);
    else
        put_lip_grid(file, m, entry);
    fprintf(file, "      ],\n");
    if (!sided)
        put_axis(file, m, recipe_get(entry, "axis_yz"));
    fprintf(file, "      \"thickness_mm\": [%g, %g], \"max_shortening\": %g,\n", thickness[0], thickness[1],
            recipe_number(entry, "max_shortening"));
    fprintf(file, "      \"radius_mm\": %g, \"insertion_start\": %g, \"lip_drag_power\": %g, \"gain\": %g,\n",
            recipe_number(entry, "radius_mm"), recipe_number(entry, "insertion_start"),
            recipe_number(entry, "lip_drag_power"), recipe_number(entry, "gain"));
    char *au = json_dumps(recipe_get(entry, "au"), 0);
    fprintf(file, "      \"attach\": \"auto\", \"au\": %s,\n", au ? au : "[]");
    free(au);
    fprintf(file, "      \"origin\": \"%s\",\n      \"insertion\": \"%s\",\n      \"source\": \"%s\"}",
            text_of(entry, "origin"), text_of(entry, "insertion"), text_of(entry, "source"));
    if (sided)
        fprintf(file, ",\n    {\"name\": \"%s.R\", \"mirror_of\": \"%s.L\"}", name, name);
    fprintf(file, "%s\n", last ? "" : ",");
}

void write_muscles(const maker *m)
{
    json_t *list = recipe_get(m->recipe, "muscles");
    FILE *file = output_open(m, "muscles.json");
    fputs("{\"format\": \"risorius-muscles\", \"version\": 1,\n  \"muscles\": [\n", file);
    for (size_t i = 0; i < json_array_size(list); i++)
        put_muscle(file, m, json_array_get(list, i), i + 1 == json_array_size(list));
    fputs("  ]}\n", file);
    output_close(m, file, "muscles.json");
}
