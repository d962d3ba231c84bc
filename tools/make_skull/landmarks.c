/* Landmarks on skin and bone (KA-07): placed by closest point or by dowel, and their file (docs/skull.md). */
#include "make_skull.h"

#include "base/file.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

/* Skin landmarks: seed near the place; a direction, when given, is the ray from the seed that finds the
 * skin. */
typedef struct seed {
    const char *name;
    bool bilateral;
    dvec at, ray;
} seed;

static const seed seeds[] = {
    {"v", false, {0, 60, -4}, {0, 1, 0}},        {"op", false, {0, 46, 0}, {0, 0, -1}},
    {"i", false, {0, 4, 0}, {0, 0, -1}},         {"tri", false, {0, 100, 40}, {0, 0.3, 0.95}},
    {"m", false, {0, 64, 40}, {0, 0, 1}},        {"se", false, {0, 21.5, 60}, {0, 0, 1}},
    {"prn", false, {0, -19.3, 100}, {0, 0, 1}},  {"c", false, {0, -27, 108.5}, {0, 0, 0}},
    {"sn", false, {0, -33, 101}, {0, 0, 0}},     {"ls", false, {0, -42.6, 90}, {0, 0, 1}},
    {"sts", false, {0, -49, 102}, {0, 0, 0}},    {"sti", false, {0, -51.4, 99}, {0, 0, 0}},
    {"sto", false, {0, -50, 101}, {0, 0, 0}},    {"li", false, {0, -57, 85}, {0, 0, 1}},
    {"sl", false, {0, -67.5, 80}, {0, 0, 1}},    {"gn", false, {0, -88, 77}, {0, -0.8, 0.6}},
    {"cv", false, {0, -88.6, 14}, {0, 0, 0}},    {"eu", true, {0, 58, -3}, {1, 0, 0}},
    {"ft", true, {50, 47, 60}, {0.8, 0, 0.6}},   {"or", true, {31, 0, 74}, {0, 0, 1}},
    {"os", true, {31, 33, 74}, {0, 0, 1}},       {"mf", true, {11, 19, 80}, {0.5, 0, 0.86}},
    {"en", true, {17.6, 14.5, 80.5}, {0, 0, 0}}, {"ex", true, {44.6, 17.6, 78}, {0, 0, 0}},
    {"ps", true, {31, 22.3, 84}, {0, 0, 0}},     {"pi", true, {31, 11.6, 83}, {0, 0, 0}},
    {"al", true, {17, -20, 100}, {0, 0, 0}},     {"ac", true, {15.5, -21.5, 93}, {0, 0, 0}},
    {"sbal", true, {9, -30, 99.5}, {0, 0, 0}},   {"itn", true, {5.5, -26, 107}, {0, 0, 0}},
    {"cph", true, {5.5, -41, 103.5}, {0, 0, 0}}, {"ch", true, {25.5, -50.5, 90}, {0, 0, 0}},
    {"t", true, {72, -3, 4.5}, {0, 0, 0}},       {"po", true, {66, 0, 0}, {0, 0, 0}},
    {"sa", true, {78, 23.5, -6}, {0, 0, 0}},     {"sba", true, {73, -28, 2}, {0, 0, 0}},
    {"pa", true, {86, 5, -20}, {0, 0, 0}},       {"pra", true, {72, 2, 5}, {0, 0, 0}},
    {"obs", true, {72, 20, 2}, {0, 0, 0}},       {"obi", true, {68, -25, 7}, {0, 0, 0}},
    {"tu", true, {83, 18, -14}, {0, 0, 0}},
};

static void weights_of(const tri_mesh *mesh, uint32_t triangle, dvec p, landmark *out)
{
    const uint32_t *t = mesh->triangle + 3 * (size_t)triangle;
    dvec a = mesh->position[t[0]], b = mesh->position[t[1]], c = mesh->position[t[2]];
    dvec n = dv_cross(dv_sub(b, a), dv_sub(c, a));
    double area = dv_dot(n, n);
    double u = dv_dot(dv_cross(dv_sub(c, b), dv_sub(p, b)), n) / area;
    double v = dv_dot(dv_cross(dv_sub(a, c), dv_sub(p, c)), n) / area;
    u = fmax(0, fmin(1, u));
    v = fmax(0, fmin(1 - u, v));
    const double w[3] = {u, v, 1 - u - v};
    out->at = dv(0, 0, 0);
    for (int k = 0; k < 3; k++) {
        out->vertex[k] = t[k];
        out->weight[k] = w[k];
        out->at = dv_mad(out->at, w[k], mesh->position[t[k]]);
    }
}

static ris_result name_it(landmark *l, const char *name, bool bilateral, bool right)
{
    snprintf(l->name, sizeof l->name, "%s%s", name, bilateral ? right ? ".R" : ".L" : "");
    return RIS_OK;
}

static dvec side(dvec p, bool right)
{
    return dv(right ? -p.x : p.x, p.y, p.z);
}

/* Closest point on the skin itself, not on a fan that closes an opening. */
static bvh_hit on_skin(const hull *h, dvec p)
{
    bvh_hit hit = ris__bvh_closest(&h->tree, p);
    if (hit.triangle < h->skin_triangles)
        return hit;
    tri_mesh skin = h->mesh;
    skin.triangle_count = h->skin_triangles;
    bvh tree = {0};
    if (ris__bvh_build(&tree, &skin, NULL) == RIS_OK)
        hit = ris__bvh_closest(&tree, p);
    ris__bvh_finish(&tree);
    return hit;
}

/* Closest point on the skin's midline: the edges whose ends both have x = 0. */
static bvh_hit on_midline(const hull *h, dvec p)
{
    bvh_hit best = {.distance = HUGE_VAL};
    for (uint32_t i = 0; i < 3 * h->skin_triangles; i++) {
        dvec a = h->mesh.position[h->mesh.triangle[i]],
             b = h->mesh.position[h->mesh.triangle[i % 3 == 2 ? i - 2 : i + 1]];
        if (fabs(a.x) > 1e-4 || fabs(b.x) > 1e-4)
            continue;
        dvec ab = dv_sub(b, a);
        double t = fmax(0, fmin(1, dv_dot(dv_sub(p, a), ab) / dv_dot(ab, ab)));
        dvec q = dv_mad(a, t, ab);
        double d = dv_length(dv_sub(p, q));
        if (d < best.distance)
            best = (bvh_hit){true, i / 3, d, q};
    }
    return best;
}

static ris_result place_seed(landmark_set *set, const hull *h, const seed *s, bool right, ris_error *err)
{
    dvec at = side(s->at, right), ray = side(s->ray, right);
    bvh_hit hit = dv_length(ray) > 0 ? ris__bvh_ray(&h->tree, at, dv_unit(ray), 0, 120)
                  : s->bilateral     ? on_skin(h, at)
                                     : on_midline(h, at);
    if (!hit.found || hit.triangle >= h->skin_triangles)
        return ris_fail(err, RIS_ERROR_DATA, "the skin has no place for landmark %s", s->name);
    landmark *l = &set->skin[set->skin_count++];
    *l = (landmark){0};
    weights_of(&h->mesh, hit.triangle, hit.at, l);
    return name_it(l, s->name, s->bilateral, right);
}

static landmark *skin_named(landmark_set *set, const char *name)
{
    for (uint32_t i = 0; i < set->skin_count; i++)
        if (strcmp(set->skin[i].name, name) == 0)
            return &set->skin[i];
    return NULL;
}

/* A dowel: where it leaves the skin, and where the way back meets the bone. */
static ris_result place_site(landmark_set *set, const hull *h, const tri_mesh bone[2], const bvh tree[2],
                             const site *s, bool right, ris_error *err)
{
    dvec out = side(s->out, right), in = dv(-out.x, -out.y, -out.z), from = side(s->seed, right);
    bvh_hit skin = ris__bvh_ray(&h->tree, from, out, 0, 60);
    if (!skin.found || skin.triangle >= h->skin_triangles)
        return ris_fail(err, RIS_ERROR_DATA, "the dowel of site %s does not meet the skin", s->name);
    bvh_hit hit = ris__bvh_ray(&tree[s->bone], skin.at, in, 0, 60);
    if (!hit.found)
        return ris_fail(err, RIS_ERROR_DATA, "the dowel of site %s does not meet the bone", s->name);
    landmark *b = &set->bone[set->bone_count++], seated = {0};
    *b = (landmark){.bone = s->bone, .normal = out, .table_mm = s->table_mm};
    name_it(b, s->name, s->bilateral, right);
    weights_of(&bone[s->bone], hit.triangle, hit.at, b);
    if (!skin_named(set, b->name)) {
        weights_of(&h->mesh, skin.triangle, skin.at, &seated);
        memcpy(seated.name, b->name, sizeof seated.name);
        set->skin[set->skin_count++] = seated;
    }
    dvec d = dv_sub(skin_named(set, b->name)->at, b->at);
    b->depth_mm = dv_length(d);
    b->normal = dv_unit(d);
    return RIS_OK;
}

ris_result landmarks_place(landmark_set *set, const hull *h, const tri_mesh bone[2], const bvh tree[2],
                           const site *sites, uint32_t count, ris_error *err)
{
    *set = (landmark_set){0};
    ris_result result = RIS_OK;
    /* pairs first: where a site and an anthropometric point share a name, the eye corners excepted, they
     * are one */
    for (uint32_t i = 0; i < sizeof seeds / sizeof *seeds && result == RIS_OK; i++)
        for (int right = 0; right <= seeds[i].bilateral && result == RIS_OK; right++)
            if (strcmp(seeds[i].name, "or") != 0)
                result = place_seed(set, h, &seeds[i], right != 0, err);
    for (uint32_t i = 0; i < count && result == RIS_OK; i++)
        for (int right = 0; right <= sites[i].bilateral && result == RIS_OK; right++)
            result = place_site(set, h, bone, tree, &sites[i], right != 0, err);
    return result;
}

static void write_surface(ris_output_file *f, const landmark *l)
{
    fprintf(f->stream,
            "\"vertices\": [%u, %u, %u], \"weights\": [%.6f, %.6f, %.6f], \"at\": [%.4f, %.4f, %.4f]",
            l->vertex[0], l->vertex[1], l->vertex[2], l->weight[0], l->weight[1], l->weight[2], l->at.x,
            l->at.y, l->at.z);
}

ris_result landmarks_write(const char *path, const landmark_set *set, ris_error *err)
{
    ris_output_file f = {0};
    ris_result result = ris__output_open(&f, path, err);
    if (result != RIS_OK)
        return result;
    fprintf(f.stream, "{\"format\": \"risorius-landmarks\", \"version\": 1, \"units\": \"mm\",\n");
    fprintf(f.stream, "  \"meshes\": {\"skin\": \"skin.obj\", \"skull\": \"skull.obj\", \"mandible\": "
                      "\"mandible.obj\"},\n");
    fprintf(
        f.stream,
        "  \"condylar_axis\": {\"point\": [%.4f, %.4f, %.4f], \"axis\": [%.4f, %.4f, %.4f]},\n  \"skin\": [",
        set->jaw_point.x, set->jaw_point.y, set->jaw_point.z, set->jaw_axis.x, set->jaw_axis.y,
        set->jaw_axis.z);
    for (uint32_t i = 0; i < set->skin_count; i++) {
        fprintf(f.stream, "%s\n    {\"name\": \"%s\", ", i ? "," : "", set->skin[i].name);
        write_surface(&f, &set->skin[i]);
        fputs("}", f.stream);
    }
    fprintf(f.stream, "],\n  \"bone\": [");
    for (uint32_t i = 0; i < set->bone_count; i++) {
        const landmark *l = &set->bone[i];
        fprintf(f.stream, "%s\n    {\"name\": \"%s\", \"mesh\": \"%s\", ", i ? "," : "", l->name,
                l->bone ? "mandible" : "skull");
        write_surface(&f, l);
        fprintf(f.stream, ",\n     \"dowel\": [%.6f, %.6f, %.6f], \"depth_mm\": %.4f", l->normal.x,
                l->normal.y, l->normal.z, l->depth_mm);
        if (l->table_mm > 0)
            fprintf(f.stream, ", \"table_mm\": %g", l->table_mm);
        fputs("}", f.stream);
    }
    fputs("]}\n", f.stream);
    result = ris__output_commit(&f, err);
    ris__output_discard(&f);
    return result;
}

static dvec read_vector(json_t *j)
{
    return dv(json_number_value(json_array_get(j, 0)), json_number_value(json_array_get(j, 1)),
              json_number_value(json_array_get(j, 2)));
}

static void read_landmark(json_t *j, landmark *l)
{
    const char *name = json_string_value(json_object_get(j, "name")),
               *mesh = json_string_value(json_object_get(j, "mesh"));
    *l = (landmark){.bone = mesh && strcmp(mesh, "mandible") == 0};
    snprintf(l->name, sizeof l->name, "%s", name ? name : "");
    dvec w = read_vector(json_object_get(j, "weights"));
    const double weight[3] = {w.x, w.y, w.z};
    for (size_t k = 0; k < 3; k++) {
        l->vertex[k] = (uint32_t)json_integer_value(json_array_get(json_object_get(j, "vertices"), k));
        l->weight[k] = weight[k];
    }
    l->at = read_vector(json_object_get(j, "at"));
    l->normal = read_vector(json_object_get(j, "dowel"));
    l->depth_mm = json_number_value(json_object_get(j, "depth_mm"));
    l->table_mm = json_number_value(json_object_get(j, "table_mm"));
}

ris_result landmarks_read(const char *path, landmark_set *set, ris_error *err)
{
    *set = (landmark_set){0};
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    if (!root)
        return ris_fail(err, RIS_ERROR_DATA, "%s:%d:%d: %s", path, error.line, error.column, error.text);
    const char *format = json_string_value(json_object_get(root, "format"));
    json_t *skin = json_object_get(root, "skin"), *bone = json_object_get(root, "bone");
    ris_result result = RIS_OK;
    if (!format || strcmp(format, "risorius-landmarks") != 0 || json_array_size(skin) > LANDMARK_LIMIT ||
        json_array_size(bone) > LANDMARK_LIMIT)
        result = ris_fail(err, RIS_ERROR_DATA, "%s: not a landmark file of at most %d places", path,
                          LANDMARK_LIMIT);
    for (size_t i = 0; result == RIS_OK && i < json_array_size(skin); i++)
        read_landmark(json_array_get(skin, i), &set->skin[set->skin_count++]);
    for (size_t i = 0; result == RIS_OK && i < json_array_size(bone); i++)
        read_landmark(json_array_get(bone, i), &set->bone[set->bone_count++]);
    json_t *axis = json_object_get(root, "condylar_axis");
    set->jaw_point = read_vector(json_object_get(axis, "point"));
    set->jaw_axis = read_vector(json_object_get(axis, "axis"));
    json_decref(root);
    return result;
}
