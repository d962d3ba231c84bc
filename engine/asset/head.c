/* head.json and all it names -> ris_head. The order is the order in which the files need each other. */
#include "asset/head_parts.h"
#include "asset/names.h"
#include "base/file.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

typedef ris_result json_reader(const ris_json *json, ris_head *head, ris_error *err);
typedef ris_result text_reader(const char *name, const char *text, size_t size, ris_head *head,
                               ris_error *err);

/* Reads the JSON file named by key; an absent optional key reads nothing. */
static ris_result read_json(const ris_json_at *root, const char *key, ris_json_need need, json_reader *read,
                            ris_head *head, ris_error *err)
{
    ris_json_at at = ris__json_key(root, key);
    ris_json json = {0};
    char *path;
    ris_result result = ris__read_file_key(&at, head->directory, &path, err);
    if (result == RIS_OK && !path && need == RIS_JSON_REQUIRED) {
        result = ris__json_expected(&at, err, "a file name");
    }
    if (result == RIS_OK && path) {
        result = ris__json_load(path, &json, err);
    }
    if (result == RIS_OK && path) {
        result = read(&json, head, err);
    }
    ris__json_finish(&json);
    free(path);
    return result;
}

static ris_result read_text(const ris_json_at *root, const char *key, ris_json_need need, text_reader *read,
                            ris_head *head, ris_error *err)
{
    ris_json_at at = ris__json_key(root, key);
    char *path, *text = NULL;
    size_t size = 0;
    ris_result result = ris__read_file_key(&at, head->directory, &path, err);
    if (result == RIS_OK && !path && need == RIS_JSON_REQUIRED) {
        result = ris__json_expected(&at, err, "a file name");
    }
    if (result == RIS_OK && path) {
        result = ris__file_read(path, RIS_MAX_JSON_BYTES, &text, &size, err);
    }
    if (result == RIS_OK && path) {
        result = read(path, text, size, head, err);
    }
    free(text);
    free(path);
    return result;
}

/* The OBJ file named by key; an absent optional key leaves *out empty. What is simulated must be sound
 * (ris_mesh_check); a bone is only asked for distances and may have slivers. */
static ris_result read_mesh(const ris_json_at *root, const char *key, ris_json_need need,
                            const ris_head *head, ris_mesh *out, ris_error *err)
{
    ris_json_at at = ris__json_key(root, key);
    char *path;
    ris_result result = ris__read_file_key(&at, head->directory, &path, err);
    if (result == RIS_OK && !path && need == RIS_JSON_REQUIRED) {
        result = ris__json_expected(&at, err, "a file name");
    }
    if (result == RIS_OK && path) {
        result = ris_mesh_load_obj(path, out, err);
    }
    if (result == RIS_OK && path && need == RIS_JSON_REQUIRED) {
        result = ris_mesh_check(out, path, err);
    }
    free(path);
    return result;
}

static ris_result read_simulated(const ris_json_at *root, ris_head *head, ris_error *err)
{
    ris_json_at at = ris__json_key(root, "simulated");
    ris_result result = ris__read_name(&at, "a region name", head->simulated, err);
    if (result == RIS_OK && !ris_head_region(head, head->simulated)) {
        ris_nearest nearest;
        char names[256];
        ris__nearest_init(&nearest, head->simulated);
        for (uint32_t i = 0; i < head->region_count; i++) {
            ris__nearest_add(&nearest, head->region[i].name);
        }
        result = ris__json_fail(&at, err, "unknown region \"%s\"; nearest: %s", head->simulated,
                                ris__nearest_text(&nearest, names, sizeof names));
    }
    return result;
}

static ris_result read_head(const ris_json *json, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "units",     "skin",        "map",
                                       "color",  "regions", "simulated", "skull",       "mandible",
                                       "depth",  "muscles", "landmarks", "expressions", "parts",
                                       "jaw",    "tissue",  "guidance",  "dynamics",    NULL};
    static const char *const units_known[] = {"mm", NULL};
    ris_json_at root = ris__json_root(json);
    ris_json_at units = ris__json_key(&root, "units"), color = ris__json_key(&root, "color");
    ris_json_at parts = ris__json_key(&root, "parts"), jaw = ris__json_key(&root, "jaw");
    ris_json_at tissue = ris__json_key(&root, "tissue"), dynamics = ris__json_key(&root, "dynamics");
    uint32_t unit;
    ris_result result;
    if ((result = ris__json_check_format(&root, "risorius-head", 1, err)) ||
        (result = ris__json_check_object(&root, keys, err)) ||
        (result = ris__json_choice(&units, RIS_JSON_OPTIONAL, units_known, &unit, err)) ||
        (result = read_mesh(&root, "skin", RIS_JSON_REQUIRED, head, &head->skin, err)) ||
        (result = read_mesh(&root, "skull", RIS_JSON_OPTIONAL, head, &head->skull, err)) ||
        (result = read_mesh(&root, "mandible", RIS_JSON_OPTIONAL, head, &head->mandible, err)) ||
        (result = read_text(&root, "map", RIS_JSON_OPTIONAL, ris__map_read, head, err)) ||
        (result = ris__read_file_key(&color, head->directory, &head->color, err)) ||
        (result = read_json(&root, "regions", RIS_JSON_REQUIRED, ris__regions_read, head, err)) ||
        (result = read_simulated(&root, head, err)) ||
        (result = read_text(&root, "depth", RIS_JSON_REQUIRED, ris__depth_read, head, err)) ||
        (result = ris__jaw_read(&jaw, head, err)) ||
        (result = read_text(&root, "guidance", RIS_JSON_OPTIONAL, ris__guidance_read, head, err)) ||
        (result = ris__tissue_read(&tissue, head, err)) ||
        (result = ris__dynamics_read(&dynamics, head, err)) ||
        (result = read_json(&root, "muscles", RIS_JSON_REQUIRED, ris__muscles_read, head, err)) ||
        (result = read_json(&root, "landmarks", RIS_JSON_OPTIONAL, ris__landmarks_read, head, err)) ||
        (result =
             read_json(&root, "expressions", RIS_JSON_OPTIONAL, ris__head_expressions_read, head, err)) ||
        (result = ris__parts_read(&parts, head, err))) {
        return result;
    }
    return RIS_OK;
}

ris_result ris_head_load(const char *directory, ris_head *out, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    ris_json json = {0};
    ris_result result;
    *out = (ris_head){.directory = ris__copy_text(directory)};
    if (!out->directory) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for a path", directory);
    }
    if ((result = ris__path_join(path, directory, "head.json", err)) ||
        (result = ris__json_load(path, &json, err)) || (result = read_head(&json, out, err))) {
        ris_head_finish(out);
    }
    ris__json_finish(&json);
    return result;
}

void ris_head_finish(ris_head *head)
{
    ris_mesh_finish(&head->skin);
    ris_mesh_finish(&head->skull);
    ris_mesh_finish(&head->mandible);
    free(head->landmark);
    for (uint32_t i = 0; i < head->region_count; i++) {
        free(head->region[i].vertex);
    }
    for (uint32_t i = 0; i < head->muscle_count; i++) {
        ris_muscle_def *def = &head->muscle[i];
        free(def->grid);
        free(def->attach);
        free(def->au);
        free(def->origin);
        free(def->insertion);
        free(def->source);
    }
    for (uint32_t i = 0; i < head->part_count; i++) {
        ris_mesh_finish(&head->part[i].mesh);
        free(head->part[i].color);
    }
    ris__expressions_finish(head->expression, head->expression_count);
    free(head->region);
    free(head->muscle);
    free(head->part);
    free(head->directory);
    free(head->base_vertex);
    free(head->color);
    free(head->guidance.forward_mm);
    free(head->guidance.side);
    free(head->guidance.open_deg);
    free(head->depth_mm);
    free(head->jaw_weight);
    *head = (ris_head){0};
}
