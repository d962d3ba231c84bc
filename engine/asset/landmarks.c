/* landmarks.json: named points on skin, skull and mandible (KA-07; docs/skull.md, docs/file-formats.md), and the pose they
 * define (KA-08). */
#include "asset/head_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LANDMARKS 4096

static const ris_mesh *mesh_of(const ris_head *head, ris_landmark_mesh mesh)
{
    return mesh == RIS_LANDMARK_SKIN    ? &head->skin
           : mesh == RIS_LANDMARK_SKULL ? &head->skull
                                        : &head->mandible;
}

static ris_result read_place(const ris_json_at *at, const ris_head *head, ris_landmark *out, ris_error *err)
{
    ris_json_at vertices = ris__json_key(at, "vertices"), weights = ris__json_key(at, "weights");
    ris_json_at place = ris__json_key(at, "at");
    const ris_mesh *mesh = mesh_of(head, out->mesh);
    float given[3] = {0};
    ris_result result;
    if ((result = ris__json_check_array(&vertices, 3, 3, err)) ||
        (result = ris__json_floats(&weights, RIS_JSON_REQUIRED, 3, 0, 1, out->weight, err)) ||
        (result = ris__json_floats(&place, RIS_JSON_REQUIRED, 3, -1e6, 1e6, given, err))) {
        return result;
    }
    const float total = (out->weight[0] + out->weight[1]) + out->weight[2];
    if (!(fabsf(total - 1.0f) <= 1e-4f)) {
        return ris__json_fail(&weights, err, "expected three weights of sum 1, found a sum of %g",
                              (double)total);
    }
    for (uint32_t k = 0; k < 3; k++) { /* what rounding left would lift the point off its triangle */
        out->weight[k] /= total;
    }
    ris_vec3 sum = {0};
    for (uint32_t k = 0; k < 3; k++) {
        ris_json_at item = ris__json_item(&vertices, k);
        if ((result =
                 ris__json_uint(&item, RIS_JSON_REQUIRED, 0, mesh->vertex_count - 1, &out->vertex[k], err))) {
            return result;
        }
        const ris_vec3 p = mesh->position[out->vertex[k]];
        sum = (ris_vec3){sum.x + out->weight[k] * p.x, sum.y + out->weight[k] * p.y,
                         sum.z + out->weight[k] * p.z};
    }
    out->at = sum;
    const float off = fabsf(sum.x - given[0]) + fabsf(sum.y - given[1]) + fabsf(sum.z - given[2]);
    if (off > 0.01f) { /* the mesh is not the one the landmarks were placed on */
        return ris__json_fail(&place, err,
                              "expected the place that vertices and weights give, %.4f %.4f %.4f",
                              (double)sum.x, (double)sum.y, (double)sum.z);
    }
    return RIS_OK;
}

static ris_result read_landmark(const ris_json_at *at, bool bone, ris_head *head, ris_landmark *out,
                                ris_error *err)
{
    static const char *const skin_keys[] = {"name", "vertices", "weights", "at", NULL};
    static const char *const bone_keys[] = {"name",  "mesh",     "vertices", "weights", "at",
                                            "dowel", "depth_mm", "table_mm", NULL};
    static const char *const meshes[] = {"skull", "mandible", NULL};
    ris_json_at name = ris__json_key(at, "name"), mesh = ris__json_key(at, "mesh"),
                dowel = ris__json_key(at, "dowel");
    ris_json_at depth = ris__json_key(at, "depth_mm"), table = ris__json_key(at, "table_mm");
    uint32_t which = 0;
    float d[3] = {0};
    ris_result result;
    if ((result = ris__json_check_object(at, bone ? bone_keys : skin_keys, err)) ||
        (result = ris__json_text(&name, RIS_JSON_REQUIRED, out->name, sizeof out->name, err))) {
        return result;
    }
    out->mesh = RIS_LANDMARK_SKIN;
    if (bone) {
        if ((result = ris__json_choice(&mesh, RIS_JSON_REQUIRED, meshes, &which, err)) ||
            (result = ris__json_floats(&dowel, RIS_JSON_REQUIRED, 3, -1, 1, d, err)) ||
            (result = ris__json_float(&depth, RIS_JSON_REQUIRED, 0, 100, &out->depth_mm, err)) ||
            (result = ris__json_float(&table, RIS_JSON_OPTIONAL, 0, 100, &out->table_mm, err))) {
            return result;
        }
        out->mesh = which ? RIS_LANDMARK_MANDIBLE : RIS_LANDMARK_SKULL;
        out->dowel = (ris_vec3){d[0], d[1], d[2]};
        if (mesh_of(head, out->mesh)->vertex_count == 0) {
            return ris__json_fail(&mesh, err, "expected a bone that head.json names, found \"%s\"",
                                  meshes[which]);
        }
    }
    return read_place(at, head, out, err);
}

static ris_result read_list(const ris_json_at *list, bool bone, ris_head *head, ris_error *err)
{
    const size_t count = json_array_size(list->value);
    ris_result result = ris__json_check_array(list, 0, MAX_LANDMARKS, err);
    if (result != RIS_OK) {
        return result;
    }
    ris_landmark *grown = realloc(head->landmark, (head->landmark_count + count + 1) * sizeof *grown);
    if (!grown) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu landmarks", list->json->name, count);
    }
    head->landmark = grown;
    for (size_t i = 0; i < count && result == RIS_OK; i++) {
        ris_json_at item = ris__json_item(list, i);
        ris_landmark *out = &head->landmark[head->landmark_count];
        *out = (ris_landmark){0};
        result = read_landmark(&item, bone, head, out, err);
        for (uint32_t k = 0; result == RIS_OK && k < head->landmark_count; k++) {
            const bool same = (head->landmark[k].mesh == RIS_LANDMARK_SKIN) == !bone;
            if (same && strcmp(head->landmark[k].name, out->name) == 0) {
                result = ris__json_fail(&item, err, "the landmark \"%s\" is there already", out->name);
            }
        }
        head->landmark_count++;
    }
    return result;
}

ris_result ris__landmarks_read(const ris_json *json, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"format",        "version", "units", "meshes",
                                       "condylar_axis", "skin",    "bone",  NULL};
    ris_json_at root = ris__json_root(json), skin = ris__json_key(&root, "skin"),
                bone = ris__json_key(&root, "bone");
    ris_result result;
    if ((result = ris__json_check_format(&root, "risorius-landmarks", 1, err)) ||
        (result = ris__json_check_object(&root, keys, err)) ||
        (result = read_list(&skin, false, head, err)) ||
        (result = ris__json_absent(&bone) ? RIS_OK : read_list(&bone, true, head, err))) {
        return result;
    }
    return RIS_OK;
}

const ris_landmark *ris_head_landmark(const ris_head *head, const char *name, bool on_bone)
{
    for (uint32_t k = 0; k < head->landmark_count; k++) {
        const ris_landmark *landmark = &head->landmark[k];
        if ((landmark->mesh != RIS_LANDMARK_SKIN) == on_bone && strcmp(landmark->name, name) == 0) {
            return landmark;
        }
    }
    return NULL;
}

static ris_result find_points(const ris_head *head, double out[4][3], ris_error *err)
{
    static const char *const name[4] = {"po.L", "po.R", "or.L", "or.R"};
    for (int k = 0; k < 4; k++) {
        const ris_landmark *landmark = ris_head_landmark(head, name[k], false);
        if (!landmark) {
            return ris_fail(err, RIS_ERROR_DATA,
                            "the head has no landmark %s, which the Frankfort horizontal needs", name[k]);
        }
        out[k][0] = (double)landmark->at.x;
        out[k][1] = (double)landmark->at.y;
        out[k][2] = (double)landmark->at.z;
    }
    return RIS_OK;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Makes v a unit vector; false if it has no length to speak of (mm). */
static bool make_unit(double v[3])
{
    const double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++) {
        v[k] = length > 0 ? v[k] / length : 0;
    }
    return length > 1e-3;
}

ris_result ris_head_frankfort(const ris_head *head, double out[12], ris_error *err)
{
    double p[4][3], x[3], y[3], z[3], middle[3];
    ris_result result = find_points(head, p, err);
    if (result != RIS_OK) {
        return result;
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (p[0][k] + p[1][k]);
        x[k] = p[0][k] - p[1][k];
        z[k] = 0.5 * (p[2][k] + p[3][k]) - middle[k];
    }
    bool plane = make_unit(x);
    const double along = dot(x, z);
    for (int k = 0; k < 3; k++) {
        z[k] -= along * x[k];
    }
    plane = make_unit(z) && plane;
    if (!plane) {
        return ris_fail(err, RIS_ERROR_DATA, "the landmarks po.L, po.R, or.L and or.R span no plane");
    }
    y[0] = z[1] * x[2] - z[2] * x[1];
    y[1] = z[2] * x[0] - z[0] * x[2];
    y[2] = z[0] * x[1] - z[1] * x[0];
    const double *const row[3] = {x, y, z};
    for (int r = 0; r < 3; r++) {
        memcpy(out + 4 * r, row[r], 3 * sizeof *out);
        out[4 * r + 3] = -dot(row[r], middle);
    }
    return RIS_OK;
}
