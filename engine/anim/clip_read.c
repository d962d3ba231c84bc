/* KA-50: reads a clip and checks it against the names of a model. */
#include "anim/clip_read.h"
#include "asset/names.h"

#include <stdlib.h>
#include <string.h>

#define MIN_DURATION_S 1e-3
#define MAX_LABELS 256
#define MAX_DEPTH 8   /* of clips within clips */
#define MAX_FILES 256 /* of clips in all */

ris_result ris__clip_no_memory(const ris_json_at *at, ris_error *err)
{
    return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the clip", at->json->name);
}

ris_result ris__read_bool(const ris_json_at *at, bool *out, ris_error *err)
{
    if (!json_is_boolean(at->value)) {
        return ris__json_expected(at, err, "true or false");
    }
    *out = json_is_true(at->value);
    return RIS_OK;
}

static ris_result read_labels(const ris_json_at *at, ris_clip_reader *r)
{
    static const char *const keys[] = {"t", "name", NULL};
    size_t count = json_array_size(at->value);
    ris_result result;
    if (!at->value) {
        return ris__clip_make_labels(r->clip, r->err);
    }
    if ((result = ris__json_check_array(at, 1, MAX_LABELS, r->err))) {
        return result;
    }
    r->clip->label = calloc(count, sizeof *r->clip->label);
    if (!r->clip->label) {
        return ris__clip_no_memory(at, r->err);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        ris_json_at t = ris__json_key(&item, "t"), name = ris__json_key(&item, "name");
        ris_label *label = &r->clip->label[r->clip->label_count++];
        if ((result = ris__json_check_object(&item, keys, r->err)) ||
            (result = ris__json_double(&t, RIS_JSON_REQUIRED, 0, r->clip->duration_s, &label->t_s, r->err)) ||
            (result = ris__json_text(&name, RIS_JSON_REQUIRED, label->name, sizeof label->name, r->err))) {
            return result;
        }
        if (i > 0 && label->t_s <= label[-1].t_s) {
            return ris__json_expected(&t, r->err, "a time after the label before");
        }
    }
    return RIS_OK;
}

static ris_result read_duration(const ris_json_at *at, ris_clip_reader *r)
{
    if (json_is_number(at->value) && json_number_value(at->value) == 0) {
        return ris__json_fail(at, r->err, "the clip is empty: its duration is 0");
    }
    return ris__json_double(at, RIS_JSON_REQUIRED, MIN_DURATION_S, RIS_CLIP_MAX_S, &r->clip->duration_s,
                            r->err);
}

static ris_result read_expressions(const ris_json_at *at, ris_clip_reader *r, ris_expression **out)
{
    const ris_model *model = r->names.model;
    if (!at->value) {
        return RIS_OK;
    }
    const char **channel = malloc((model->channel_count + 1) * sizeof *channel);
    if (!channel) {
        return ris__clip_no_memory(at, r->err);
    }
    for (uint32_t c = 0; c < model->channel_count; c++) {
        channel[c] = model->channel[c].name;
    }
    ris_scope scope = {.channel = channel,
                       .channel_count = model->channel_count,
                       .outer = model->head ? model->head->expression : NULL,
                       .outer_count = model->head ? model->head->expression_count : 0,
                       .vocabulary = &model->vocabulary};
    ris_result result = ris__expressions_read(at, &scope, out, &r->names.clip_expression_count, r->err);
    r->names.clip_expression = *out;
    free(channel);
    return result;
}

static ris_result make_ranges(const ris_json_at *root, ris_clip_reader *r)
{
    const ris_model *model = r->names.model;
    r->pose = malloc((model->channel_count + 1) * sizeof *r->pose);
    return r->pose && ris__clip_take_ranges(r->clip, model) ? RIS_OK : ris__clip_no_memory(root, r->err);
}

/* Everything in the file; *out_expression is the caller's to free. */
static ris_result read_clip(const ris_json *json, ris_clip_reader *r, ris_expression **out_expression)
{
    static const char *const keys[] = {"format", "version", "duration_s", "loop", "expressions",
                                       "tracks", "layers",  "labels",     NULL};
    ris_json_at root = ris__json_root(json), duration = ris__json_key(&root, "duration_s");
    ris_json_at expressions = ris__json_key(&root, "expressions"), tracks = ris__json_key(&root, "tracks");
    ris_json_at labels = ris__json_key(&root, "labels"), layers = ris__json_key(&root, "layers");
    ris_json_at loop = ris__json_key(&root, "loop");
    ris_result result;
    if ((result = make_ranges(&root, r)) ||
        (result = ris__json_check_format(&root, "risorius-clip", 1, r->err)) ||
        (result = ris__json_check_object(&root, keys, r->err)) || (result = read_duration(&duration, r)) ||
        (result = loop.value ? ris__read_bool(&loop, &r->clip->repeats, r->err) : RIS_OK) ||
        (result = read_expressions(&expressions, r, out_expression)) ||
        (result = ris__read_layers(&tracks, &layers, r)) || (result = read_labels(&labels, r))) {
        return result;
    }
    return RIS_OK;
}

/* path NULL: from memory. outer NULL: the clip that was asked for. */
static ris_result make_clip(const ris_model *model, const ris_json *json, const char *path,
                            const ris_clip_reader *outer, ris_clip **out, ris_error *err)
{
    uint32_t file_count = 0;
    ris_clip_reader r = {.names.model = model,
                         .clip = calloc(1, sizeof(ris_clip)),
                         .err = err,
                         .path = path,
                         .outer = outer,
                         .file_count = outer ? outer->file_count : &file_count};
    ris_expression *expression = NULL;
    if (!r.clip) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the clip", json->name);
    }
    ris_result result = read_clip(json, &r, &expression);
    ris__expressions_finish(expression, r.names.clip_expression_count);
    free(r.pose);
    if (result != RIS_OK) {
        ris_clip_destroy(r.clip);
        return result;
    }
    *out = r.clip;
    return RIS_OK;
}

ris_result ris__clip_parse(const ris_model *model, const char *name, const char *text, size_t size,
                           ris_clip **out, ris_error *err)
{
    ris_json json;
    *out = NULL;
    ris_result result = ris__json_parse(name, text, size, &json, err);
    if (result == RIS_OK) {
        result = make_clip(model, &json, NULL, NULL, out, err);
    }
    ris__json_finish(&json);
    return result;
}

static ris_result load(const ris_model *model, const char *path, const ris_clip_reader *outer, ris_clip **out,
                       ris_error *err)
{
    ris_json json;
    *out = NULL;
    ris_result result = ris__json_load(path, &json, err);
    if (result == RIS_OK) {
        result = make_clip(model, &json, path, outer, out, err);
    }
    ris__json_finish(&json);
    return result;
}

ris_result ris__clip_count_file(const char *path, const ris_clip_reader *r)
{
    if (++*r->file_count > MAX_FILES) {
        return ris_fail(r->err, RIS_ERROR_DATA, "%s: clips include more than %d files", path, MAX_FILES);
    }
    return RIS_OK;
}

ris_result ris__clip_include(const char *path, const ris_clip_reader *outer, ris_clip **out)
{
    uint32_t depth = 1;
    for (const ris_clip_reader *r = outer; r; r = r->outer) {
        depth++;
    }
    if (depth > MAX_DEPTH) {
        return ris_fail(outer->err, RIS_ERROR_DATA, "%s: clips include clips more than %d deep", path,
                        MAX_DEPTH);
    }
    ris_result result = ris__clip_count_file(path, outer);
    return result ? result : load(outer->names.model, path, outer, out, outer->err);
}

ris_result ris_clip_load(const ris_model *model, const char *path, ris_clip **out, ris_error *err)
{
    return load(model, path, NULL, out, err);
}
