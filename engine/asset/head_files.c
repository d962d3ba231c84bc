/* What head.json names beside mesh and tables: textures, parts (KA-06) and expressions (KA-49). */
#include "asset/channel.h"
#include "asset/head_parts.h"
#include "asset/names.h"
#include "asset/vocabulary.h"
#include "base/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define MAX_PARTS 256

char *ris__copy_text(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy) {
        memcpy(copy, text, size);
    }
    return copy;
}

ris_result ris__read_file_key(const ris_json_at *at, const char *directory, char **out, ris_error *err)
{
    char name[1024] = "", path[RIS_PATH_SIZE];
    ris_result result;
    *out = NULL;
    if (ris__json_absent(at)) {
        return RIS_OK;
    }
    if ((result = ris__json_text(at, RIS_JSON_REQUIRED, name, sizeof name, err))) {
        return result;
    }
    if (name[0] == 0) {
        return ris__json_expected(at, err, "a file name");
    }
    if ((result = ris__path_join(path, directory, name, err))) {
        return result;
    }
    FILE *file = fopen(path, "rb");
    if (!file) {
        return ris__json_fail(at, err, "cannot open %s: %s", path, strerror(errno));
    }
    fclose(file);
    *out = ris__copy_text(path);
    return *out ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for a path", at->json->name);
}

static ris_result read_part_look(const ris_json_at *at, const ris_head *head, ris_part_def *part,
                                 ris_error *err)
{
    static const char *const materials[] = {"skin", "eye", "cornea", "teeth", "gum", "tongue", "hair", NULL};
    ris_json_at material_at = ris__json_key(at, "material"), color = ris__json_key(at, "color");
    ris_json_at tint_at = ris__json_key(at, "tint");
    uint32_t material = RIS_MATERIAL_SKIN;
    float tint[3] = {0.8f, 0.8f, 0.8f};
    ris_result result;
    if ((result = ris__json_choice(&material_at, RIS_JSON_REQUIRED, materials, &material, err)) ||
        (result = ris__read_file_key(&color, head->directory, &part->color, err)) ||
        (result = ris__json_floats(&tint_at, RIS_JSON_OPTIONAL, 3, 0, 1, tint, err))) {
        return result;
    }
    part->material = (ris_material)material;
    part->tint = (ris_vec3){tint[0], tint[1], tint[2]};
    return RIS_OK;
}

static ris_result read_part(const ris_json_at *at, const ris_head *head, uint32_t index, ris_error *err)
{
    static const char *const keys[] = {"name", "mesh", "bone", "pivot", "material", "color", "tint", NULL};
    static const char *const bones[] = {"skull", "jaw", "eye.L", "eye.R", "skin", NULL};
    static const ris_bone bone_of[] = {RIS_BONE_SKULL, RIS_BONE_JAW, RIS_BONE_EYE_L, RIS_BONE_EYE_R,
                                       RIS_BONE_SKIN};
    ris_json_at name = ris__json_key(at, "name"), mesh = ris__json_key(at, "mesh"),
                bone_at = ris__json_key(at, "bone");
    ris_json_at pivot_at = ris__json_key(at, "pivot");
    ris_part_def *part = &head->part[index];
    float pivot[3] = {0};
    char *path = NULL;
    uint32_t bone = 0;
    ris_result result;
    if ((result = ris__json_check_object(at, keys, err)) ||
        (result = ris__read_name(&name, "a part name", part->name, err)) ||
        (result = ris__json_choice(&bone_at, RIS_JSON_REQUIRED, bones, &bone, err))) {
        return result;
    }
    part->bone = bone_of[bone];
    for (uint32_t i = 0; i < index; i++) {
        if (strcmp(head->part[i].name, part->name) == 0) {
            return ris__json_fail(&name, err, "the part \"%s\" is there already", part->name);
        }
    }
    bool eye = part->bone == RIS_BONE_EYE_L || part->bone == RIS_BONE_EYE_R;
    if ((result = ris__json_floats(&pivot_at, eye ? RIS_JSON_REQUIRED : RIS_JSON_OPTIONAL, 3, -1000, 1000,
                                   pivot, err)) ||
        (result = read_part_look(at, head, part, err)) ||
        (result = ris__read_file_key(&mesh, head->directory, &path, err))) {
        return result;
    }
    part->pivot = (ris_vec3){pivot[0], pivot[1], pivot[2]};
    if (!path) {
        return ris__json_expected(&mesh, err, "a file name");
    }
    if ((result = ris_mesh_load_obj(path, &part->mesh, err)) == RIS_OK) {
        result = ris_mesh_check(&part->mesh, path, err);
    }
    free(path);
    return result;
}

ris_result ris__parts_read(const ris_json_at *at, ris_head *head, ris_error *err)
{
    size_t count = json_array_size(at->value);
    ris_result result;
    if (!at->value) {
        return RIS_OK;
    }
    if ((result = ris__json_check_array(at, 0, MAX_PARTS, err))) {
        return result;
    }
    head->part = calloc(count + 1, sizeof *head->part);
    if (!head->part) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu parts", at->json->name, count);
    }
    for (size_t i = 0; i < count && result == RIS_OK; i++) {
        ris_json_at item = ris__json_item(at, i);
        head->part_count++;
        result = read_part(&item, head, (uint32_t)i, err);
    }
    return result;
}

ris_result ris__head_expressions_read(const ris_json *json, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "expressions", NULL};
    ris_json_at root = ris__json_root(json), list = ris__json_key(&root, "expressions");
    ris_result result;
    if ((result = ris__json_check_format(&root, "risorius-expressions", 1, err)) ||
        (result = ris__json_check_object(&root, keys, err))) {
        return result;
    }
    uint32_t count = 0;
    const size_t room = 2 * (size_t)head->muscle_count + ris__beside_channel_count;
    const char **channel = malloc(room * sizeof *channel);
    char(*protrude)[RIS_NAME_SIZE] = malloc((head->muscle_count + 1u) * sizeof *protrude);
    if (!channel || !protrude) {
        free(channel);
        free(protrude);
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu names", json->name, room);
    }
    for (uint32_t i = 0; i < head->muscle_count; i++) {
        channel[count++] = head->muscle[i].name;
    }
    for (uint32_t i = 0; i < ris__beside_channel_count; i++) {
        channel[count++] = ris__beside_channel[i].name;
    }
    for (uint32_t i = 0; i < head->muscle_count; i++) {
        if (ris__protrude_channel(&head->muscle[i], protrude[i])) {
            channel[count++] = protrude[i];
        }
    }
    ris_vocabulary vocabulary;
    result = ris__vocabulary_read(ris__vocabulary_file, &vocabulary, err);
    if (result == RIS_OK) {
        ris_scope scope = {.channel = channel, .channel_count = count, .vocabulary = &vocabulary};
        result = ris__expressions_read(&list, &scope, &head->expression, &head->expression_count, err);
    }
    ris__vocabulary_finish(&vocabulary);
    free(channel);
    free(protrude);
    return result;
}
