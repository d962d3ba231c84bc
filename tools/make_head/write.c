/* Writing the asset: each file under a temporary name, then renamed. */
#include "make_head.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void path_of(const maker *m, const char *name, const char *suffix, char out[4096])
{
    if (snprintf(out, 4096, "%s/%s%s", m->out, name, suffix) >= 4096)
        stop("the path of %s is too long", name);
}

FILE *output_open(const maker *m, const char *name)
{
    char path[4096];
    path_of(m, name, ".part", path);
    FILE *file = fopen(path, "w");
    if (!file)
        stop("cannot write %s: %s", path, strerror(errno));
    return file;
}

void output_close(const maker *m, FILE *file, const char *name)
{
    char from[4096], to[4096];
    path_of(m, name, ".part", from);
    path_of(m, name, "", to);
    int bad = ferror(file);
    if (fclose(file) || bad || rename(from, to)) {
        remove(from);
        stop("cannot write %s: %s", to, strerror(errno));
    }
}

/* -0.000000 reads as a difference between left and right where there is none. */
static double shown(double x)
{
    return fabs(x) < 5e-7 ? 0.0 : x;
}

static void put_vertex(FILE *file, dvec p)
{
    fprintf(file, "v %.6f %.6f %.6f\n", shown(p.x), shown(p.y), shown(p.z));
}

static void notice(FILE *file, const char *what)
{
    fprintf(file, "# %s, mm. Made by risorius-make-head; see README.md.\n", what);
}

/* New number of each used uv, in the order of the source; the count in *count. */
static uint32_t *number_uvs(const maker *m, uint32_t *count)
{
    uint32_t *number = need(m->mesh.uv_count, sizeof *number);
    for (uint32_t f = 0; f < m->skin.quad_count; f++)
        for (int k = 0; k < 4; k++)
            number[m->skin.quad_uv[f][k]] = 1;
    *count = 0;
    for (uint32_t i = 0; i < m->mesh.uv_count; i++)
        number[i] = number[i] ? ++*count : 0;
    return number;
}

void write_skin(const maker *m)
{
    const skin *s = &m->skin;
    uint32_t uv_count, *number = number_uvs(m, &uv_count);
    FILE *file = output_open(m, "skin.obj");
    notice(file, "Head and neck cut from the MakeHuman base mesh (CC0)");
    for (uint32_t i = 0; i < s->vertex_count; i++)
        put_vertex(file, to_head(&m->frame, s->position[i]));
    for (uint32_t i = 0; i < m->mesh.uv_count; i++)
        if (number[i])
            fprintf(file, "vt %.6f %.6f\n", m->mesh.uv[2 * i], m->mesh.uv[2 * i + 1]);
    for (uint32_t f = 0; f < s->quad_count; f++) {
        fputc('f', file);
        for (int k = 0; k < 4; k++)
            fprintf(file, " %u/%u", s->quad[f][k] + 1, number[s->quad_uv[f][k]]);
        fputc('\n', file);
    }
    output_close(m, file, "skin.obj");
    free(number);
    file = output_open(m, "skin.map");
    for (uint32_t i = 0; i < s->vertex_count; i++)
        fprintf(file, "%u\n", s->base[i]);
    output_close(m, file, "skin.map");
}

void write_fields(const maker *m)
{
    FILE *file = output_open(m, "depth.csv");
    fputs("vertex,depth_mm,jaw_weight\n", file);
    for (uint32_t i = 0; i < m->skin.vertex_count; i++)
        fprintf(file, "%u,%.6f,%.6f\n", i, m->skin.depth_mm[i], shown(m->skin.jaw_weight[i]));
    output_close(m, file, "depth.csv");
}

static void write_region(FILE *file, const region *r, uint32_t count, bool last)
{
    fprintf(file, "  \"%s\": [", r->name);
    for (uint32_t i = 0, ranges = 0; i < count; i++) {
        if (!r->has[i])
            continue;
        uint32_t first = i;
        while (i + 1 < count && r->has[i + 1])
            i++;
        const char *comma = ranges ? ranges % 12 ? ", " : ",\n    " : "";
        fprintf(file, "%s[%u,%u]", comma, first, i);
        ranges++;
    }
    fprintf(file, "]%s\n", last ? "" : ",");
}

void write_regions(const maker *m)
{
    const skin *s = &m->skin;
    json_t *rules = recipe_get(m->recipe, "regions");
    uint32_t shown_last = 0;
    for (uint32_t i = 0; i < s->region_count; i++)
        if (!json_is_true(json_object_get(json_array_get(rules, i), "private")))
            shown_last = i;
    FILE *file = output_open(m, "regions.json");
    fputs("{\n", file);
    for (uint32_t i = 0; i < s->region_count; i++)
        if (!json_is_true(json_object_get(json_array_get(rules, i), "private")))
            write_region(file, &s->regions[i], s->vertex_count, i == shown_last);
    fputs("}\n", file);
    output_close(m, file, "regions.json");
}

void write_part(const maker *m, const part *p, const char *name)
{
    FILE *file = output_open(m, name);
    notice(file, "Part of the reference head");
    for (uint32_t i = 0; i < p->vertex_count; i++)
        put_vertex(file, to_head(&m->frame, p->position[i]));
    for (uint32_t i = 0; i < p->vertex_count; i++)
        fprintf(file, "vt %.6f %.6f\n", shown(p->uv[i][0]), shown(p->uv[i][1]));
    for (uint32_t f = 0; f < p->face_count; f++) {
        fputc('f', file);
        for (int k = 0; k < 4 && p->face[f][k] != NONE; k++)
            fprintf(file, " %u/%u", p->face[f][k] + 1, p->face[f][k] + 1);
        fputc('\n', file);
    }
    output_close(m, file, name);
}
