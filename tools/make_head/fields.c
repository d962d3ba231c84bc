/* Tissue depth interpolated from the published sites, and the smooth mandible weight
 * (KA-05, KA-09; assets/tables/tissue_depth.csv). */
#include "make_head.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SITES 128

typedef struct site {
    dvec at;
    double depth_mm;
} site;

/* mean_mm of a site of the table: "id,site,bilateral,mean_mm", '#' starts a comment. */
static double table_depth(const char *path, const char *id)
{
    FILE *file = fopen(path, "r");
    if (!file)
        stop("cannot read %s", path);
    char line[512];
    double depth = -1;
    while (fgets(line, sizeof line, file)) {
        char *comma = strchr(line, ','), *last = strrchr(line, ',');
        if (line[0] != '#' && comma && (size_t)(comma - line) == strlen(id) &&
            strncmp(line, id, strlen(id)) == 0)
            depth = strtod(last + 1, NULL);
    }
    fclose(file);
    if (depth <= 0)
        stop("%s: no site \"%s\"", path, id);
    return depth;
}

static uint32_t load_sites(const maker *m, site *sites)
{
    json_t *list = recipe_get(m->recipe, "depth_sites");
    uint32_t count = 0;
    for (size_t k = 0; k < json_array_size(list); k++) {
        json_t *entry = json_array_get(list, k);
        uint32_t i = m->skin.index_of[recipe_index(entry, "vertex")];
        const char *id = json_string_value(json_object_get(entry, "id"));
        if (i == NONE || count + 2 > MAX_SITES)
            stop("recipe: depth site %zu is off the head, or there are too many", k);
        double depth = id ? table_depth(m->tables, id) : recipe_number(entry, "estimate_mm");
        sites[count++] = (site){m->skin.position[i], depth};
        if (m->skin.mirror[i] != i)
            sites[count++] = (site){m->skin.position[m->skin.mirror[i]], depth};
    }
    return count;
}

/* Inverse distance, power 3, 2 mm soft core. */
static double interpolate(const site *sites, uint32_t count, dvec p)
{
    double sum = 0, weights = 0;
    for (uint32_t k = 0; k < count; k++) {
        double d2 = v_dot(v_sub(p, sites[k].at), v_sub(p, sites[k].at)) + 4;
        double w = 1 / (d2 * sqrt(d2));
        sum += w * sites[k].depth_mm;
        weights += w;
    }
    return sum / weights;
}

static void symmetrise(const skin *s, double *field)
{
    for (uint32_t i = 0; i < s->vertex_count; i++) {
        uint32_t k = s->mirror[i];
        if (i < k)
            field[i] = field[k] = (field[i] + field[k]) / 2;
    }
}

/* passes Jacobi sweeps towards the mean of the neighbours, each weighted by 1 / edge length; held vertices stay. */
static void relax(const maker *m, double *field, const uint8_t *held, uint32_t passes)
{
    const skin *s = &m->skin;
    double *next = need(s->vertex_count, sizeof *next);
    for (uint32_t pass = 0; pass < passes; pass++) {
        for (uint32_t i = 0; i < s->vertex_count; i++) {
            uint32_t v = s->base[i];
            double sum = 0, weights = 0;
            for (uint32_t e = m->topo.edge_start[v]; e < m->topo.edge_start[v + 1]; e++) {
                uint32_t k = s->index_of[m->topo.neighbour[e]];
                if (k == NONE)
                    continue;
                double w = 1 / v_length(v_sub(s->position[k], s->position[i]));
                sum += w * field[k];
                weights += w;
            }
            next[i] = held && held[i] ? field[i] : sum / weights;
        }
        memcpy(field, next, s->vertex_count * sizeof *field);
    }
    symmetrise(s, field);
    free(next);
}

static void build_depth(maker *m)
{
    skin *s = &m->skin;
    site sites[MAX_SITES];
    uint32_t count = load_sites(m, sites);
    json_t *rule = recipe_get(m->recipe, "depth");
    double limits[2], inside = recipe_number(rule, "inside_mm");
    recipe_numbers(rule, "clamp_mm", limits, 2);
    s->depth_mm = need(s->vertex_count, sizeof *s->depth_mm);
    for (uint32_t i = 0; i < s->vertex_count; i++)
        s->depth_mm[i] = s->outer[i] ? interpolate(sites, count, s->position[i]) : inside;
    relax(m, s->depth_mm, NULL, recipe_index(rule, "smoothing_passes"));
    for (uint32_t i = 0; i < s->vertex_count; i++)
        s->depth_mm[i] = clamp(s->depth_mm[i], limits[0], limits[1]);
}

/* Holds the value; 2 marks a firm one, which later smoothing leaves alone. */
static void hold(const maker *m, json_t *entry, uint8_t *held)
{
    skin const *s = &m->skin;
    double value = recipe_number(entry, "value");
    const char *name = json_string_value(json_object_get(entry, "region"));
    const uint8_t mark = json_is_true(json_object_get(entry, "firm")) ? 2 : 1;
    if (name) {
        const region *r = region_find(s, name);
        for (uint32_t i = 0; i < s->vertex_count; i++)
            if (r->has[i]) {
                held[i] = mark;
                s->jaw_weight[i] = value;
            }
        return;
    }
    uint32_t range[2], columns[2];
    recipe_range(entry, "ring", range);
    recipe_range(entry, "column", columns);
    for (uint32_t r = range[0]; r <= range[1] && r < m->mouth.count; r++)
        for (uint32_t c = columns[0]; c <= columns[1] && c < m->mouth.at[r].count; c++) {
            uint32_t i = s->index_of[m->mouth.at[r].vertex[c]];
            held[i] = held[s->mirror[i]] = mark;
            s->jaw_weight[i] = s->jaw_weight[s->mirror[i]] = value;
        }
}

/* Harmonic between held values, so that the weight follows the skin and never leaks across the slit of the mouth. */
static void build_jaw(maker *m)
{
    skin *s = &m->skin;
    json_t *rule = recipe_get(m->recipe, "jaw_weight"), *list = recipe_get(rule, "held");
    uint8_t *held = need(s->vertex_count, 1);
    s->jaw_weight = need(s->vertex_count, sizeof *s->jaw_weight);
    for (size_t k = 0; k < json_array_size(list); k++)
        hold(m, json_array_get(list, k), held);
    relax(m, s->jaw_weight, held, recipe_index(rule, "harmonic_passes"));
    for (uint32_t i = 0; i < s->vertex_count; i++)
        held[i] = held[i] == 2;
    relax(m, s->jaw_weight, held, recipe_index(rule, "smoothing_passes"));
    for (uint32_t i = 0; i < s->vertex_count; i++)
        s->jaw_weight[i] = smoothstep(0, 1, s->jaw_weight[i]) * recipe_number(rule, "smoothstep") +
                           clamp(s->jaw_weight[i], 0, 1) * (1 - recipe_number(rule, "smoothstep"));
    free(held);
}

void fields_build(maker *m)
{
    build_depth(m);
    build_jaw(m);
}
