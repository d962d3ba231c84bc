/* muscles.json: KA-38 grids and the muscle file of KA-44; mirrored records are expanded about x = 0 (KA-43).
 * */
#include "asset/head_parts.h"
#include "asset/names.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_MUSCLES 1024
#define MAX_GRID 256 /* rows or columns */
#define MAX_COORDINATE 1000.0
#define MIN_SEGMENT_MM 1e-3
#define TEXT_SIZE 1024

static const char *const record_keys[] = {"name",
                                          "mirror_of",
                                          "kind",
                                          "bone",
                                          "grid",
                                          "axis",
                                          "thickness_mm",
                                          "max_shortening",
                                          "attach",
                                          "au",
                                          "origin",
                                          "insertion",
                                          "source",
                                          "radius_mm",
                                          "insertion_start",
                                          "lip_drag_power",
                                          "gain",
                                          "closes",
                                          "end_bone",
                                          "drives",
                                          "acts_on",
                                          "fat",
                                          "fat_radius_mm",
                                          "onset_ms",
                                          "release_ms",
                                          "puff_mm",
                                          "puff_radius_mm",
                                          "held_at",
                                          "strength",
                                          "push_lip",
                                          "bowstring",
                                          NULL};

static double distance(const ris_vec3 *a, const ris_vec3 *b)
{
    double x = (double)a->x - b->x, y = (double)a->y - b->y, z = (double)a->z - b->z;
    return sqrt(x * x + y * y + z * z);
}

static ris_result read_point(const ris_json_at *at, ris_vec3 *out, ris_error *err)
{
    float p[3] = {0};
    ris_result result = ris__json_floats(at, RIS_JSON_REQUIRED, 3, -MAX_COORDINATE, MAX_COORDINATE, p, err);
    *out = (ris_vec3){p[0], p[1], p[2]};
    return result;
}

/* A fibre is a column of the grid: its points must not coincide. */
static ris_result read_row(const ris_json_at *at, ris_muscle_def *def, uint32_t row, ris_error *err)
{
    if (!json_is_array(at->value) || json_array_size(at->value) != def->columns) {
        char expected[64];
        snprintf(expected, sizeof expected, "%u points, as in row 0", def->columns);
        return ris__json_expected(at, err, expected);
    }
    for (uint32_t c = 0; c < def->columns; c++) {
        ris_json_at item = ris__json_item(at, c);
        ris_vec3 *p = &def->grid[(size_t)row * def->columns + c];
        ris_result result = read_point(&item, p, err);
        if (result != RIS_OK) {
            return result;
        }
        if (row > 0 && distance(p, p - def->columns) < MIN_SEGMENT_MM) {
            return ris__json_fail(&item, err, "the point coincides with the one of the row before");
        }
    }
    return RIS_OK;
}

static ris_result read_grid(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    ris_json_at first = ris__json_item(at, 0);
    ris_result result;
    if ((result = ris__json_check_array(at, 2, MAX_GRID, err)) ||
        (result = ris__json_check_array(&first, 2, MAX_GRID, err))) {
        return result;
    }
    def->rows = (uint32_t)json_array_size(at->value);
    def->columns = (uint32_t)json_array_size(first.value);
    def->grid = calloc((size_t)def->rows * def->columns, sizeof *def->grid);
    if (!def->grid) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the grid of %s", at->json->name, def->name);
    }
    for (uint32_t row = 0; row < def->rows; row++) {
        ris_json_at item = ris__json_item(at, row);
        if ((result = read_row(&item, def, row, err))) {
            return result;
        }
    }
    return RIS_OK;
}

static ris_result read_axis(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    ris_json_at a0 = ris__json_item(at, 0), a1 = ris__json_item(at, 1);
    ris_result result;
    if (def->kind == RIS_MUSCLE_LINEAR) {
        return ris__json_absent(at) ? RIS_OK : ris__json_expected(at, err, "no axis for a linear muscle");
    }
    if ((result = ris__json_check_array(at, 2, 2, err)) || (result = read_point(&a0, &def->axis[0], err)) ||
        (result = read_point(&a1, &def->axis[1], err))) {
        return result;
    }
    if (distance(&def->axis[0], &def->axis[1]) < MIN_SEGMENT_MM) {
        return ris__json_expected(at, err, "two different points");
    }
    def->has_axis = true;
    return RIS_OK;
}

/* What a sphincter closes on: the moving point of KA-32, or the whole axis as a slit. */
static ris_result read_closes(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    static const char *const choices[] = {"point", "line", NULL};
    uint32_t choice = 0;
    if (def->kind == RIS_MUSCLE_LINEAR) {
        return ris__json_absent(at) ? RIS_OK : ris__json_expected(at, err, "no closes for a linear muscle");
    }
    ris_result result = ris__json_choice(at, RIS_JSON_OPTIONAL, choices, &choice, err);
    def->closes_on_line = choice == 1;
    return result;
}

/* "auto", or skin vertices, ascending and unique. */
static ris_result read_attach(const ris_json_at *at, uint32_t vertex_count, ris_muscle_def *def,
                              ris_error *err)
{
    ris_result result;
    if (!at->value || (json_is_string(at->value) && strcmp(json_string_value(at->value), "auto") == 0)) {
        def->attach_auto = true;
        return RIS_OK;
    }
    if (!json_is_array(at->value)) {
        return ris__json_expected(at, err, "\"auto\" or an array of vertices");
    }
    if ((result = ris__json_check_array(at, 1, vertex_count, err))) {
        return result;
    }
    size_t count = json_array_size(at->value);
    def->attach_auto = false;
    def->attach = malloc(count * sizeof *def->attach);
    if (!def->attach) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the vertices of %s", at->json->name,
                        def->name);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        uint32_t lowest = i ? def->attach[i - 1] + 1 : 0;
        if (lowest >= vertex_count) {
            return ris__json_expected(&item, err, "no vertex after the last one");
        }
        if ((result =
                 ris__json_uint(&item, RIS_JSON_REQUIRED, lowest, vertex_count - 1, &def->attach[i], err))) {
            return result;
        }
        def->attach_count++;
    }
    return RIS_OK;
}

static ris_result read_action_units(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    size_t count = json_array_size(at->value);
    ris_result result;
    if (!at->value) {
        return RIS_OK;
    }
    if ((result = ris__json_check_array(at, 0, 64, err))) {
        return result;
    }
    def->au = calloc(count + 1, sizeof *def->au);
    if (!def->au) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the action units of %s", at->json->name,
                        def->name);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        char *name = def->au[def->au_count++];
        if ((result = ris__json_text(&item, RIS_JSON_REQUIRED, name, sizeof *def->au, err))) {
            return result;
        }
        if (strncmp(name, "AU", 2) != 0 || name[2] == 0 ||
            strspn(name + 2, "0123456789") != strlen(name + 2)) {
            return ris__json_expected(&item, err, "an action unit such as \"AU12\"");
        }
    }
    return RIS_OK;
}

/* Anatomical text; absent is empty. */
static ris_result read_story(const ris_json_at *at, char **out, ris_error *err)
{
    char text[TEXT_SIZE] = "";
    ris_result result = ris__json_text(at, RIS_JSON_OPTIONAL, text, sizeof text, err);
    if (result != RIS_OK) {
        return result;
    }
    *out = ris__copy_text(text);
    return *out ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for a text", at->json->name);
}

static ris_result read_numbers(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    ris_json_at thickness = ris__json_key(at, "thickness_mm"),
                shortening = ris__json_key(at, "max_shortening");
    ris_json_at radius = ris__json_key(at, "radius_mm"), start = ris__json_key(at, "insertion_start");
    ris_json_at drag = ris__json_key(at, "lip_drag_power"), gain = ris__json_key(at, "gain");
    ris_json_at puff = ris__json_key(at, "puff_mm"), puff_radius = ris__json_key(at, "puff_radius_mm");
    ris_json_at held = ris__json_key(at, "held_at"), strength = ris__json_key(at, "strength");
    ris_json_at bowstring = ris__json_key(at, "bowstring");
    ris_json_at fat = ris__json_key(at, "fat"), fat_radius = ris__json_key(at, "fat_radius_mm");
    ris_result result;
    def->thickness_mm[0] = 2;
    def->thickness_mm[1] = 6;
    def->max_shortening = 0.15f;
    def->radius_mm = 8;
    def->insertion_start = 0.5f;
    def->gain = 1.2f;
    def->strength = 1;
    def->fat_radius_mm = 15;
    def->puff_radius_mm = 20;
    if ((result = ris__json_floats(&thickness, RIS_JSON_OPTIONAL, 2, 0.01, 50, def->thickness_mm, err)) ||
        (result = ris__json_float(&shortening, RIS_JSON_OPTIONAL, 0, 0.30, &def->max_shortening, err)) ||
        (result = ris__json_float(&radius, RIS_JSON_OPTIONAL, 0.1, 100, &def->radius_mm, err)) ||
        (result = ris__json_float(&start, RIS_JSON_OPTIONAL, 0, 0.99, &def->insertion_start, err)) ||
        (result = ris__json_float(&strength, RIS_JSON_OPTIONAL, 0.1, 10, &def->strength, err)) ||
        (result = ris__json_float(&held, RIS_JSON_OPTIONAL, 0, 0.9, &def->held_at, err)) ||
        (result = ris__json_float(&fat, RIS_JSON_OPTIONAL, 0, 10, &def->fat, err)) ||
        (result = ris__json_float(&fat_radius, RIS_JSON_OPTIONAL, 0.1, 100, &def->fat_radius_mm, err)) ||
        (result = ris__json_float(&puff, RIS_JSON_OPTIONAL, 0, 50, &def->puff_mm, err)) ||
        (result = ris__json_float(&puff_radius, RIS_JSON_OPTIONAL, 0.1, 100, &def->puff_radius_mm, err)) ||
        (result = ris__json_float(&bowstring, RIS_JSON_OPTIONAL, 0, 1, &def->bowstring, err)) ||
        (result = ris__json_float(&drag, RIS_JSON_OPTIONAL, 0, 64, &def->lip_drag_power, err)) ||
        (result = ris__json_float(&gain, RIS_JSON_OPTIONAL, 0, 10, &def->gain, err))) {
        return result;
    }
    if (def->thickness_mm[1] < def->thickness_mm[0]) {
        return ris__json_expected(&thickness, err, "the least thickness first, then the greatest");
    }
    if (def->puff_mm > 0 && !ris__name_is_sided(def->name)) {
        return ris__json_expected(&puff, err, "0 for a muscle without a side");
    }
    return RIS_OK;
}

/* A muscle from bone to bone keeps the places its author drew, between both. */
static ris_result read_end_bone(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    static const char *const bones[] = {"auto", "skull", "jaw", NULL}; /* order of ris_bone */
    uint32_t bone = 0;
    if (ris__json_absent(at)) {
        return RIS_OK;
    }
    ris_result result = ris__json_choice(at, RIS_JSON_REQUIRED, bones + 1, &bone, err);
    if (result == RIS_OK && (def->kind != RIS_MUSCLE_LINEAR || def->bone == RIS_BONE_AUTO)) {
        return ris__json_expected(at, err, "no end_bone but for a linear muscle with a bone of its own");
    }
    def->end_bone = (ris_bone)(bone + 1);
    return result;
}

/* What the muscle does to the jaw, in its channels. */
static ris_result read_drives(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    static const char *const keys[] = {"open", "forward", "side", NULL};
    ris_result result = at->value ? ris__json_check_object(at, keys, err) : RIS_OK;
    for (uint32_t k = 0; at->value && result == RIS_OK && k < 3; k++) {
        ris_json_at item = ris__json_key(at, keys[k]);
        result = ris__json_float(&item, RIS_JSON_OPTIONAL, -1, 1, &def->drives[k], err);
    }
    return result;
}

static ris_result read_acts_on(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    static const char *const choices[] = {"skin", "lip", "lid", NULL}; /* order of ris_acts_on */
    uint32_t choice = 0;
    ris_result result = ris__json_choice(at, RIS_JSON_OPTIONAL, choices, &choice, err);
    def->acts_on = (ris_acts_on)choice;
    const bool in_lids = choice == RIS_ACTS_ON_LID && def->closes_on_line;
    if (result == RIS_OK && choice != RIS_ACTS_ON_SKIN && def->kind != RIS_MUSCLE_LINEAR && !in_lids) {
        return ris__json_expected(at, err, "skin for a sphincter (lid if it closes on a line)");
    }
    if (result == RIS_OK && choice == RIS_ACTS_ON_LID && !ris__name_is_sided(def->name)) {
        return ris__json_expected(at, err, "lid only for a muscle with a side");
    }
    return result;
}

/* Onset and release: the record's own, else those of the head for its sort of muscle. */
static ris_result read_pace(const ris_json_at *at, const ris_dynamics_def *dynamics, ris_muscle_def *def,
                            ris_error *err)
{
    const bool lid = def->acts_on == RIS_ACTS_ON_LID || def->closes_on_line,
               jaw = def->end_bone != RIS_BONE_AUTO;
    ris_json_at onset = ris__json_key(at, "onset_ms"), release = ris__json_key(at, "release_ms");
    def->onset_ms = lid ? dynamics->lid_onset_ms : jaw ? dynamics->jaw_onset_ms : dynamics->onset_ms;
    def->release_ms = lid ? dynamics->lid_release_ms : jaw ? dynamics->jaw_release_ms : dynamics->release_ms;
    ris_result result = ris__json_float(&onset, RIS_JSON_OPTIONAL, 0, RIS_MAX_PACE_MS, &def->onset_ms, err);
    return result == RIS_OK
               ? ris__json_float(&release, RIS_JSON_OPTIONAL, 0, RIS_MAX_PACE_MS, &def->release_ms, err)
               : result;
}

/* Only a muscle that ends in the skin gathers tissue below a lip. */
static ris_result read_push_lip(const ris_json_at *at, ris_muscle_def *def, ris_error *err)
{
    ris_result result = ris__json_floats(at, RIS_JSON_OPTIONAL, 2, -4, 4, def->push_lip, err);
    if (result == RIS_OK && !ris__json_absent(at) &&
        (def->kind != RIS_MUSCLE_LINEAR || def->end_bone != RIS_BONE_AUTO)) {
        return ris__json_expected(at, err, "no push_lip but for a linear muscle that ends in the skin");
    }
    return result;
}

/* A record with its own grid; def->name is read already. */
static ris_result read_own(const ris_json_at *at, const ris_head *head, ris_muscle_def *def, ris_error *err)
{
    static const char *const kinds[] = {"linear", "sphincter", NULL};
    static const char *const bones[] = {"auto", "skull", "jaw", NULL}; /* order of ris_bone */
    uint32_t kind = 0, bone = 0;
    ris_json_at kind_at = ris__json_key(at, "kind"), bone_at = ris__json_key(at, "bone");
    ris_json_at grid = ris__json_key(at, "grid"), axis = ris__json_key(at, "axis");
    ris_json_at attach = ris__json_key(at, "attach"), units = ris__json_key(at, "au");
    ris_json_at origin = ris__json_key(at, "origin"), insertion = ris__json_key(at, "insertion");
    ris_json_at source = ris__json_key(at, "source"), closes = ris__json_key(at, "closes");
    ris_json_at end_bone = ris__json_key(at, "end_bone"), drives = ris__json_key(at, "drives");
    ris_json_at acts_on = ris__json_key(at, "acts_on"), push = ris__json_key(at, "push_lip");
    ris_result result;
    if ((result = ris__json_choice(&kind_at, RIS_JSON_REQUIRED, kinds, &kind, err)) ||
        (result = ris__json_choice(&bone_at, RIS_JSON_OPTIONAL, bones, &bone, err))) {
        return result;
    }
    def->kind = (ris_muscle_kind)kind;
    def->bone = (ris_bone)bone;
    if ((result = read_end_bone(&end_bone, def, err)) || (result = read_drives(&drives, def, err)) ||
        (result = read_grid(&grid, def, err)) || (result = read_axis(&axis, def, err)) ||
        (result = read_closes(&closes, def, err)) || (result = read_acts_on(&acts_on, def, err)) ||
        (result = read_push_lip(&push, def, err)) || (result = read_numbers(at, def, err)) ||
        (result = read_pace(at, &head->dynamics, def, err)) ||
        (result = read_attach(&attach, head->skin.vertex_count, def, err)) ||
        (result = read_action_units(&units, def, err)) || (result = read_story(&origin, &def->origin, err)) ||
        (result = read_story(&insertion, &def->insertion, err)) ||
        (result = read_story(&source, &def->source, err))) {
        return result;
    }
    return RIS_OK;
}

/* Copies source mirrored about x = 0, so that the grid's normals still point the same way in or out: rows
 * of a linear muscle stay (row 0 is the fixed end) and columns turn round; columns of a sphincter stay
 * (outer to inner) and rows turn round. */
static ris_result copy_mirrored(const ris_muscle_def *source, const char *file, ris_muscle_def *def,
                                ris_error *err)
{
    size_t points = (size_t)source->rows * source->columns;
    char name[RIS_NAME_SIZE];
    bool attach_auto = def->attach_auto;
    uint32_t attach_count = def->attach_count, *attach = def->attach;
    memcpy(name, def->name, sizeof name);
    *def = *source;
    memcpy(def->name, name, sizeof name);
    def->attach_auto = attach_auto;
    def->attach_count = attach_count;
    def->attach = attach;
    def->grid = calloc(points, sizeof *def->grid);
    def->au = calloc(source->au_count + 1, sizeof *def->au);
    def->origin = ris__copy_text(source->origin);
    def->insertion = ris__copy_text(source->insertion);
    def->source = ris__copy_text(source->source);
    if (!def->grid || !def->au || !def->origin || !def->insertion || !def->source) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the mirror of %s", file, source->name);
    }
    if (source->au_count) {
        memcpy(def->au, source->au, source->au_count * sizeof *def->au);
    }
    const bool linear = source->kind == RIS_MUSCLE_LINEAR;
    for (uint32_t row = 0; row < source->rows; row++) {
        for (uint32_t c = 0; c < source->columns; c++) {
            const uint32_t to_row = linear ? row : source->rows - 1 - row;
            const uint32_t to_column = linear ? source->columns - 1 - c : c;
            ris_vec3 p = source->grid[(size_t)row * source->columns + c];
            p.x = -p.x;
            def->grid[(size_t)to_row * source->columns + to_column] = p;
        }
    }
    def->drives[2] = -def->drives[2];
    def->axis[0].x = -def->axis[0].x;
    def->axis[1].x = -def->axis[1].x;
    return RIS_OK;
}

static ris_result read_mirrored(const ris_json_at *at, ris_head *head, ris_muscle_def *def, ris_error *err)
{
    static const char *const keys[] = {"name", "mirror_of", "attach", NULL};
    const ris_muscle_def *source = NULL;
    ris_json_at mirror = ris__json_key(at, "mirror_of"), attach = ris__json_key(at, "attach");
    const char *of = json_string_value(mirror.value);
    ris_result result = ris__json_check_object(at, keys, err);
    if (result != RIS_OK) {
        return result;
    }
    if (!of || !ris__name_is_opposite(def->name, of)) {
        return ris__json_expected(&mirror, err, "this muscle's name with the other side");
    }
    for (uint32_t i = 0; i < head->muscle_count; i++) {
        source = strcmp(head->muscle[i].name, of) == 0 ? &head->muscle[i] : source;
    }
    if (!source || source->rows == 0) {
        return ris__json_expected(&mirror, err, "a muscle of this file with its own grid");
    }
    if ((result = read_attach(&attach, head->skin.vertex_count, def, err))) {
        return result;
    }
    if (def->attach_auto != source->attach_auto) {
        return ris__json_expected(&attach, err,
                                  source->attach_auto ? "\"auto\", as on the other side"
                                                      : "a vertex list, as on the other side");
    }
    return copy_mirrored(source, at->json->name, def, err);
}

static ris_result read_record_name(const ris_json_at *at, const ris_head *head, uint32_t index,
                                   ris_error *err)
{
    ris_json_at name = ris__json_key(at, "name");
    ris_muscle_def *def = &head->muscle[index];
    ris_result result;
    if ((result = ris__json_check_object(at, record_keys, err)) ||
        (result = ris__read_name(&name, "a muscle name", def->name, err))) {
        return result;
    }
    for (uint32_t i = 0; i < index; i++) {
        const char *other = head->muscle[i].name;
        if (strcmp(other, def->name) == 0) {
            return ris__json_fail(&name, err, "the muscle \"%s\" is there already", other);
        }
        if (ris__name_is_side_of(other, def->name) || ris__name_is_side_of(def->name, other)) {
            return ris__json_fail(
                &name, err, "\"%s\" and \"%s\" cannot both be muscles: an unsided name means both sides",
                other, def->name);
        }
    }
    return RIS_OK;
}

ris_result ris__muscles_read(const ris_json *json, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "muscles", NULL};
    ris_json_at root = ris__json_root(json), list = ris__json_key(&root, "muscles");
    ris_result result;
    if ((result = ris__json_check_format(&root, "risorius-muscles", 1, err)) ||
        (result = ris__json_check_object(&root, keys, err)) ||
        (result = ris__json_check_array(&list, 1, MAX_MUSCLES, err))) {
        return result;
    }
    uint32_t count = (uint32_t)json_array_size(list.value);
    head->muscle = calloc(count, sizeof *head->muscle);
    if (!head->muscle) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %u muscles", json->name, count);
    }
    head->muscle_count = count;
    /* names first, since a mirrored record may stand before its source; then grids; then mirrors */
    for (int pass = 0; pass < 3; pass++) {
        for (uint32_t i = 0; i < count; i++) {
            ris_json_at record = ris__json_item(&list, i), mirror = ris__json_key(&record, "mirror_of");
            bool mirrored = !ris__json_absent(&mirror);
            if (pass == 0) {
                result = read_record_name(&record, head, i, err);
            } else if (pass == 1 && !mirrored) {
                result = read_own(&record, head, &head->muscle[i], err);
            } else if (pass == 2 && mirrored) {
                result = read_mirrored(&record, head, &head->muscle[i], err);
            }
            if (result != RIS_OK) {
                return result;
            }
        }
    }
    return RIS_OK;
}
