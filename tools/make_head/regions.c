/* Named vertex sets from edge rings, floods, half spaces and each other, as the recipe lists them (KA-09). */
#include "make_head.h"

#include <stdlib.h>
#include <string.h>

const region *region_find(const skin *s, const char *name)
{
    for (uint32_t i = 0; i < s->region_count; i++)
        if (strcmp(s->regions[i].name, name) == 0)
            return &s->regions[i];
    stop("recipe: the region \"%s\" is used before it is made", name);
}

static const ring_set *ring_set_named(const maker *m, const char *name)
{
    if (strcmp(name, "mouth") == 0)
        return &m->mouth;
    if (strcmp(name, "eye") == 0)
        return &m->eye;
    stop("recipe: unknown ring set \"%s\"", name);
}

static void mark(const skin *s, uint8_t *has, uint32_t base)
{
    uint32_t i = s->index_of[base];
    if (i == NONE)
        stop("recipe: vertex %u is not part of the head", base);
    has[i] = has[s->mirror[i]] = 1;
}

static void add_rings(const maker *m, json_t *rule, uint8_t *has)
{
    const ring_set *set = ring_set_named(m, json_string_value(json_object_get(rule, "rings")));
    const char *columns = json_string_value(json_object_get(rule, "columns"));
    uint32_t range[2];
    recipe_range(rule, "ring", range);
    uint32_t low = set->corner[0] < set->corner[1] ? set->corner[0] : set->corner[1];
    uint32_t high = set->corner[0] + set->corner[1] - low;
    for (uint32_t r = range[0]; r <= range[1] && r < set->count; r++)
        for (uint32_t k = 0; k < set->at[r].count; k++) {
            bool upper = k <= low || k >= high, lower = k >= low && k <= high;
            if (!columns || (strcmp(columns, "upper") == 0 && upper) ||
                (strcmp(columns, "lower") == 0 && lower))
                mark(&m->skin, has, set->at[r].vertex[k]);
        }
}

static void add_flood(const maker *m, json_t *rule, uint8_t *has)
{
    const topology *topo = &m->topo;
    json_t *bound = recipe_get(rule, "bounded_by");
    const ring_set *set = ring_set_named(m, json_string_value(json_array_get(bound, 0)));
    const edge_loop *wall = &set->at[(uint32_t)json_integer_value(json_array_get(bound, 1)) % MAX_RINGS];
    uint8_t *seen = need(m->mesh.vertex_count, 1);
    uint32_t *stack = need(m->mesh.vertex_count, sizeof *stack), depth = 0;
    for (uint32_t k = 0; k < wall->count; k++)
        seen[wall->vertex[k]] = 1;
    seen[stack[depth++] = recipe_index(rule, "flood")] = 1;
    while (depth) {
        uint32_t v = stack[--depth];
        mark(&m->skin, has, v);
        for (uint32_t i = topo->edge_start[v]; i < topo->edge_start[v + 1]; i++)
            if (!seen[topo->neighbour[i]])
                seen[stack[depth++] = topo->neighbour[i]] = 1;
    }
    free(seen);
    free(stack);
}

/* Half spaces a|x| + b y + c z + d >= 0 in base mm, all of them. */
static void add_planes(const skin *s, json_t *planes, uint8_t *has)
{
    for (uint32_t i = 0; i < s->vertex_count; i++) {
        dvec p = s->position[i];
        bool in = true;
        for (size_t k = 0; k < json_array_size(planes); k++) {
            double c[4];
            for (size_t j = 0; j < 4; j++)
                c[j] = json_number_value(json_array_get(json_array_get(planes, k), j));
            in &= c[0] * (p.x < 0 ? -p.x : p.x) + c[1] * p.y + c[2] * p.z + c[3] >= 0;
        }
        has[i] |= in;
    }
}

static void combine(const skin *s, json_t *rule, const char *key, uint8_t *has)
{
    json_t *names = json_object_get(rule, key);
    for (size_t k = 0; k < json_array_size(names); k++) {
        const region *other = region_find(s, json_string_value(json_array_get(names, k)));
        for (uint32_t i = 0; i < s->vertex_count; i++) {
            if (strcmp(key, "union") == 0)
                has[i] |= other->has[i];
            else if (strcmp(key, "within") == 0)
                has[i] &= other->has[i];
            else
                has[i] &= !other->has[i];
        }
    }
}

static void build_region(maker *m, json_t *rule)
{
    skin *s = &m->skin;
    const char *name = json_string_value(recipe_get(rule, "name"));
    if (s->region_count == sizeof s->regions / sizeof *s->regions || !name || strlen(name) >= 64)
        stop("recipe: too many regions, or a region without a short name");
    uint8_t *has = need(s->vertex_count, 1);
    if (json_object_get(rule, "rings"))
        add_rings(m, rule, has);
    if (json_object_get(rule, "flood"))
        add_flood(m, rule, has);
    if (json_object_get(rule, "planes"))
        add_planes(s, json_object_get(rule, "planes"), has);
    combine(s, rule, "union", has);
    combine(s, rule, "within", has);
    combine(s, rule, "without", has);
    const char *side = json_string_value(json_object_get(rule, "side"));
    for (uint32_t i = 0; i < s->vertex_count && side; i++)
        has[i] &= *side == 'L' ? s->position[i].x > 0 : s->position[i].x < 0;
    region *made = &s->regions[s->region_count++];
    snprintf(made->name, sizeof made->name, "%s", name);
    made->has = has;
}

void regions_build(maker *m)
{
    json_t *rules = recipe_get(m->recipe, "regions");
    for (size_t i = 0; i < json_array_size(rules); i++)
        build_region(m, json_array_get(rules, i));
    skin *s = &m->skin;
    const uint8_t *mouth = region_find(s, "mouth_cavity")->has, *socket = region_find(s, "eye_socket")->has;
    s->outer = need(s->vertex_count, 1);
    for (uint32_t i = 0; i < s->vertex_count; i++)
        s->outer[i] = !mouth[i] && !socket[i];
}
