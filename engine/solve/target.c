/* What a face is to come near to: the vertices of a skin, or landmarks. */
#include "solve/target.h"

#include "asset/json.h"
#include "asset/lines.h"
#include "base/file.h"
#include "base/text.h"
#include "model/model_impl.h"
#include "model/vec3.h"
#include "solve/align.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_MM 1e4
#define NEAR_BONE_MM 10.0f /* skin with less below it goes with the skull */
#define CSV_HEADER "landmark,x_mm,y_mm,z_mm"

void ris_target_finish(ris_target *target)
{
    free(target->index);
    free(target->at);
    *target = (ris_target){0};
}

static ris_result make_room(ris_target *target, uint32_t count, ris_error *err)
{
    target->index = calloc(count + 1u, sizeof *target->index);
    target->at = calloc(count + 1u, sizeof *target->at);
    if (!target->index || !target->at) {
        ris_target_finish(target);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u targets", count);
    }
    return RIS_OK;
}

ris_result ris_target_from_skin(const ris_model *model, const ris_vec4 *position, ris_target *out,
                                ris_error *err)
{
    *out = (ris_target){0};
    ris_result r = make_room(out, model->node_count, err);
    for (uint32_t i = 0; !r && i < model->node_count; ++i) {
        if (model->rest_position[i].w > 0.0f) {
            out->index[out->count] = i;
            out->at[out->count++] = (ris_vec3){position[i].x, position[i].y, position[i].z};
        }
    }
    return r;
}

/* Vertices that nothing moves and that go with the skull: not the neck, not the sockets behind the lids. other: zeroed
 * (node_count). */
static uint32_t find_still(const ris_model *model, bool *other, uint32_t *still)
{
    const ris_head *head = model->head;
    uint32_t count = 0;
    ris__region_flags(head, "neck", other);
    ris__region_flags(head, "eye_socket", other);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!other[i] && !(model->rest_position[i].w > 0.0f) && head->depth_mm[i] <= NEAR_BONE_MM &&
            head->jaw_weight[i] <= 0.01f) {
            still[count++] = i;
        }
    }
    return count;
}

/* Takes the rigid motion of the skull's skin out of all positions. */
static ris_result take_back(const ris_model *model, const char *path, ris_vec3 *position, ris_target *out,
                            ris_error *err)
{
    uint32_t *still = calloc(model->node_count + 1u, sizeof *still);
    ris_vec3 *pair = calloc(2 * ((size_t)model->node_count + 1), sizeof *pair);
    bool *other = calloc(model->node_count + 1u, sizeof *other);
    ris_result r = RIS_OK;
    if (!still || !pair || !other) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", model->node_count);
        goto fail;
    }
    const uint32_t count = find_still(model, other, still);
    ris_vec3 *from = pair, *onto = pair + count;
    for (uint32_t k = 0; k < count; ++k) {
        const ris_vec4 rest = model->rest_position[still[k]];
        from[k] = position[still[k]];
        onto[k] = (ris_vec3){rest.x, rest.y, rest.z};
    }
    ris_motion motion;
    if (count < 3 || !ris__align(count, from, onto, &motion)) {
        r = ris_fail(err, RIS_ERROR_DATA, "%s: there is no skin on the skull to align by", path);
        goto fail;
    }
    const ris_vec3 middle = ris__motion_apply(&motion, (ris_vec3){0, 0, 0});
    out->moved_mm = sqrt((double)middle.x * (double)middle.x + (double)middle.y * (double)middle.y +
                         (double)middle.z * (double)middle.z);
    out->turned_deg = ris__motion_degrees(&motion);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        position[i] = ris__motion_apply(&motion, position[i]);
    }
fail:
    free(still);
    free(pair);
    free(other);
    return r;
}

ris_result ris_target_load_skin(const ris_model *model, const char *path, bool align, ris_target *out,
                                ris_error *err)
{
    ris_mesh mesh;
    *out = (ris_target){0};
    ris_result r = ris_mesh_load_obj(path, &mesh, err);
    if (r) {
        return r;
    }
    if (mesh.vertex_count != model->node_count) {
        r = ris_fail(err, RIS_ERROR_DATA,
                     "%s: expected the %u vertices of the head's skin in their order, found %u", path,
                     model->node_count, mesh.vertex_count);
    }
    if (!r) {
        r = make_room(out, model->node_count, err);
    }
    if (!r && align) {
        r = take_back(model, path, mesh.position, out, err);
    }
    for (uint32_t i = 0; !r && i < model->node_count; ++i) {
        if (model->rest_position[i].w > 0.0f) {
            out->index[out->count] = i;
            out->at[out->count++] = mesh.position[i];
        }
    }
    ris_mesh_finish(&mesh);
    if (r) {
        ris_target_finish(out);
    }
    return r;
}

/* Entry of a skin vertex, or count if it does not move. */
static uint32_t find_vertex(const ris_target *target, uint32_t vertex)
{
    uint32_t low = 0, high = target->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (target->index[middle] < vertex) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < target->count && target->index[low] == vertex ? low : target->count;
}

ris_result ris_target_reduce(const ris_model *model, ris_target *target, ris_error *err)
{
    const ris_head *head = model->head;
    ris_target out = {.landmarks = true, .moved_mm = target->moved_mm, .turned_deg = target->turned_deg};
    ris_result r = make_room(&out, head->landmark_count, err);
    for (uint32_t k = 0; !r && k < head->landmark_count; ++k) {
        const ris_landmark *mark = &head->landmark[k];
        ris_vec3 at = {0};
        bool known = mark->mesh == RIS_LANDMARK_SKIN;
        for (int c = 0; known && c < 3; ++c) {
            const uint32_t i = find_vertex(target, mark->vertex[c]);
            known = i < target->count;
            at = known ? v3_mad(at, mark->weight[c], target->at[i]) : at;
        }
        if (known) {
            out.index[out.count] = k;
            out.at[out.count++] = at;
        }
    }
    if (!r && out.count == 0) {
        r = ris_fail(err, RIS_ERROR_DATA, "the head has no landmark on skin that moves");
        ris_target_finish(&out);
    }
    if (!r) {
        ris_target_finish(target);
        *target = out;
    }
    return r;
}

/* A landmark by name: on the skin if there is one there, else on the jaw. What is wrong with the name goes to out_fault. */
static bool find_landmark(const ris_head *head, const char *name, uint32_t *out, char *out_fault, size_t size)
{
    const ris_landmark *landmark = ris_head_landmark(head, name, false);
    if (!landmark) {
        landmark = ris_head_landmark(head, name, true);
    }
    if (landmark && landmark->mesh != RIS_LANDMARK_SKULL) {
        *out = (uint32_t)(landmark - head->landmark);
        return true;
    }
    if (landmark) {
        snprintf(out_fault, size, "a landmark of the skin or the jaw, found \"%s\", which is on the skull",
                 landmark->name);
        return false;
    }
    ris_nearest nearest;
    char text[128];
    ris__nearest_init(&nearest, name);
    for (uint32_t k = 0; k < head->landmark_count; ++k) {
        ris__nearest_add(&nearest, head->landmark[k].name);
    }
    snprintf(out_fault, size, "a landmark of this head, found \"%.40s\"; nearest: %s", name,
             ris__nearest_text(&nearest, text, sizeof text));
    return false;
}

/* Enters a landmark in ascending order; false if it is there. */
static bool enter(ris_target *target, uint32_t landmark, const float at[3])
{
    uint32_t place = target->count;
    while (place > 0 && target->index[place - 1] >= landmark) {
        --place;
    }
    if (place < target->count && target->index[place] == landmark) {
        return false;
    }
    const size_t after = target->count - place;
    memmove(target->index + place + 1, target->index + place, after * sizeof *target->index);
    memmove(target->at + place + 1, target->at + place, after * sizeof *target->at);
    target->index[place] = landmark;
    target->at[place] = (ris_vec3){at[0], at[1], at[2]};
    ++target->count;
    return true;
}

static ris_result read_json(const ris_model *model, const ris_json *json, ris_target *out, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "units", "points", NULL};
    static const char *const units[] = {"mm", NULL};
    ris_json_at root = ris__json_root(json), points = ris__json_key(&root, "points"),
                unit = ris__json_key(&root, "units");
    uint32_t which = 0;
    ris_result r;
    if ((r = ris__json_check_format(&root, "risorius-targets", 1, err)) ||
        (r = ris__json_check_object(&root, keys, err)) ||
        (r = ris__json_choice(&unit, RIS_JSON_OPTIONAL, units, &which, err))) {
        return r;
    }
    if (!json_is_object(points.value)) {
        return ris__json_expected(&points, err, "an object of landmarks and their places");
    }
    if (json_object_size(points.value) == 0) {
        return ris__json_fail(&points, err, "expected at least one landmark, found none");
    }
    const char *name;
    json_t *value;
    json_object_foreach(points.value, name, value)
    {
        ris_json_at point = ris__json_key(&points, name);
        char fault[256];
        uint32_t landmark;
        float at[3];
        if (!find_landmark(model->head, name, &landmark, fault, sizeof fault)) {
            return ris__json_fail(&point, err, "expected %s", fault);
        }
        r = ris__json_floats(&point, RIS_JSON_REQUIRED, 3, -LARGEST_MM, LARGEST_MM, at, err);
        if (r) {
            return r;
        }
        enter(out, landmark, at);
    }
    return RIS_OK;
}

static ris_result read_row(const ris_model *model, ris_lines *l, ris_target *out)
{
    char name[RIS_NAME_SIZE], fault[256];
    uint32_t landmark;
    float at[3];
    const char *comma = memchr(l->at, ',', (size_t)(l->stop - l->at));
    if (!comma || comma == l->at || comma - l->at >= (long)sizeof name) {
        return ris__lines_expected(l, "the name of a landmark and a comma");
    }
    memcpy(name, l->at, (size_t)(comma - l->at));
    name[comma - l->at] = '\0';
    if (!find_landmark(model->head, name, &landmark, fault, sizeof fault)) {
        return ris_fail(l->err, RIS_ERROR_DATA, "%s:%u:1: expected %s", l->name, l->line, fault);
    }
    l->at = comma + 1;
    for (int k = 0; k < 3; ++k) {
        ris_result r =
            ris__lines_number(l, "a place within 10000 mm", -LARGEST_MM, LARGEST_MM, k < 2 ? ',' : 0, &at[k]);
        if (r) {
            return r;
        }
    }
    if (!enter(out, landmark, at)) {
        return ris_fail(l->err, RIS_ERROR_DATA, "%s:%u:1: expected every landmark once, found \"%s\" again",
                        l->name, l->line, name);
    }
    return RIS_OK;
}

static ris_result read_csv(const ris_model *model, ris_lines *l, ris_target *out)
{
    ris_result r = ris__lines_header(l, CSV_HEADER);
    while (!r && ris__lines_next(l)) {
        r = read_row(model, l, out);
    }
    if (!r && out->count == 0) {
        r = ris_fail(l->err, RIS_ERROR_DATA, "%s:2:1: expected a landmark, found the end of the file",
                     l->name);
    }
    return r;
}

static bool begins_json(const char *text, size_t size)
{
    size_t at = 0;
    while (at < size && (text[at] == ' ' || text[at] == '\t' || text[at] == '\r' || text[at] == '\n')) {
        ++at;
    }
    return at < size && text[at] == '{';
}

ris_result ris__target_parse(const ris_model *model, const char *name, const char *text, size_t size,
                             ris_target *out, ris_error *err)
{
    *out = (ris_target){.landmarks = true};
    ris_result r = make_room(out, model->head->landmark_count, err);
    out->landmarks = true;
    if (!r && begins_json(text, size)) {
        ris_json json;
        r = ris__json_parse(name, text, size, &json, err);
        if (!r) {
            r = read_json(model, &json, out, err);
            ris__json_finish(&json);
        }
    } else if (!r) {
        ris_lines lines = {.name = name, .next = text, .end = text + size, .err = err};
        r = read_csv(model, &lines, out);
    }
    if (r) {
        ris_target_finish(out);
    }
    return r;
}

ris_result ris_target_load_landmarks(const ris_model *model, const char *path, ris_target *out,
                                     ris_error *err)
{
    char *text = NULL;
    size_t size = 0;
    *out = (ris_target){0};
    ris_result r = ris__file_read(path, RIS_MAX_JSON_BYTES, &text, &size, err);
    if (!r) {
        r = ris__target_parse(model, path, text, size, out, err);
    }
    free(text);
    return r;
}
