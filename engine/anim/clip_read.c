/* KA-50: reads a clip and checks it against the names of a model. */
#include "anim/clip.h"
#include "anim/pose_names.h"
#include "asset/json.h"
#include "asset/names.h"

#include <stdlib.h>
#include <string.h>

#define MAX_DURATION_S 86400.0
#define MIN_DURATION_S 1e-3
#define MAX_TRACKS 4096
#define MAX_KEYS (1u << 20)
#define MAX_LABELS 256
#define MAX_VALUE 1000.0

typedef struct clip_reader {
    ris_pose_names names;
    ris_clip *clip;
    float *pose; /* scratch (channel_count) */
    ris_error *err;
} clip_reader;

static ris_result no_memory(const ris_json_at *at, ris_error *err)
{
    return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the clip", at->json->name);
}

static ris_result read_key(const ris_json_at *at, clip_reader *r, double after_s, ris_key *out)
{
    static const char *const keys[] = {"t", "v", "ease", NULL};
    static const char *const eases[] = {"step", "linear", "cubic", NULL};
    uint32_t ease = RIS_EASE_LINEAR;
    ris_json_at t = ris__json_key(at, "t"), v = ris__json_key(at, "v"), ease_at = ris__json_key(at, "ease");
    ris_result result;
    if ((result = ris__json_check_object(at, keys, r->err)) ||
        (result = ris__json_double(&t, RIS_JSON_REQUIRED, 0, r->clip->duration_s, &out->t_s, r->err)) ||
        (result = ris__json_double(&v, RIS_JSON_REQUIRED, -MAX_VALUE, MAX_VALUE, &out->value, r->err)) ||
        (result = ris__json_choice(&ease_at, RIS_JSON_OPTIONAL, eases, &ease, r->err))) {
        return result;
    }
    if (out->t_s - after_s < 1e-6) {
        char expected[64];
        snprintf(expected, sizeof expected, "a time after the key before (%g s)", after_s);
        return ris__json_expected(&t, r->err, expected);
    }
    out->ease = (ris_ease)ease;
    return RIS_OK;
}

static ris_result read_keys(const ris_json_at *at, clip_reader *r, ris_track *track)
{
    size_t count = json_array_size(at->value);
    if (json_is_array(at->value) && count == 0) {
        return ris__json_fail(at, r->err, "the clip is empty: a track without keys");
    }
    ris_result result = ris__json_check_array(at, 1, MAX_KEYS, r->err);
    if (result != RIS_OK) {
        return result;
    }
    track->key = calloc(count, sizeof *track->key);
    if (!track->key) {
        return no_memory(at, r->err);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        if ((result = read_key(&item, r, i ? track->key[i - 1].t_s : -1, &track->key[i]))) {
            return result;
        }
        track->key_count++;
    }
    ris__track_set_slopes(track);
    return RIS_OK;
}

/* The target once, as the channels it moves and by how much. */
static ris_result read_target(const ris_json_at *at, clip_reader *r, ris_track *track)
{
    uint32_t count = r->clip->channel_count;
    char nearest[256];
    ris_result result = ris__json_text(at, RIS_JSON_REQUIRED, track->target, sizeof track->target, r->err);
    if (result != RIS_OK) {
        return result;
    }
    for (uint32_t c = 0; c < count; c++) {
        r->pose[c] = 0;
    }
    const char *unknown = ris__pose_expand(&r->names, track->target, 1, r->pose);
    if (unknown) {
        return ris__json_fail(
            at, r->err, "unknown muscle, channel, unit, shape, viseme or expression \"%s\"; nearest: %s",
            unknown, ris__pose_nearest(&r->names, unknown, nearest, sizeof nearest));
    }
    track->term = malloc((count + 1) * sizeof *track->term);
    if (!track->term) {
        return no_memory(at, r->err);
    }
    for (uint32_t c = 0; c < count; c++) {
        if (r->pose[c] != 0) {
            track->term[track->term_count++] = (ris_track_term){c, r->pose[c]};
        }
    }
    return RIS_OK;
}

static ris_result read_tracks(const ris_json_at *at, clip_reader *r)
{
    static const char *const keys[] = {"target", "keys", NULL};
    size_t count = json_array_size(at->value);
    if (!at->value || (json_is_array(at->value) && count == 0)) {
        return ris__json_fail(at, r->err, "the clip is empty: no tracks");
    }
    ris_result result = ris__json_check_array(at, 1, MAX_TRACKS, r->err);
    if (result != RIS_OK) {
        return result;
    }
    r->clip->track = calloc(count, sizeof *r->clip->track);
    if (!r->clip->track) {
        return no_memory(at, r->err);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        ris_json_at target = ris__json_key(&item, "target"), list = ris__json_key(&item, "keys");
        ris_track *track = &r->clip->track[r->clip->track_count++];
        if ((result = ris__json_check_object(&item, keys, r->err)) ||
            (result = read_target(&target, r, track)) || (result = read_keys(&list, r, track))) {
            return result;
        }
    }
    return RIS_OK;
}

static ris_result read_labels(const ris_json_at *at, clip_reader *r)
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
        return no_memory(at, r->err);
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

static ris_result read_duration(const ris_json_at *at, clip_reader *r)
{
    if (json_is_number(at->value) && json_number_value(at->value) == 0) {
        return ris__json_fail(at, r->err, "the clip is empty: its duration is 0");
    }
    return ris__json_double(at, RIS_JSON_REQUIRED, MIN_DURATION_S, MAX_DURATION_S, &r->clip->duration_s,
                            r->err);
}

static ris_result read_expressions(const ris_json_at *at, clip_reader *r, ris_expression **out)
{
    const ris_model *model = r->names.model;
    if (!at->value) {
        return RIS_OK;
    }
    const char **channel = malloc((model->channel_count + 1) * sizeof *channel);
    if (!channel) {
        return no_memory(at, r->err);
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

/* Everything in the file; *out_expression is the caller's to free. */
static ris_result read_clip(const ris_json *json, clip_reader *r, ris_expression **out_expression)
{
    static const char *const keys[] = {"format", "version", "duration_s", "expressions",
                                       "tracks", "labels",  NULL};
    ris_json_at root = ris__json_root(json), duration = ris__json_key(&root, "duration_s");
    ris_json_at expressions = ris__json_key(&root, "expressions"), tracks = ris__json_key(&root, "tracks");
    ris_json_at labels = ris__json_key(&root, "labels");
    uint32_t count = r->names.model->channel_count;
    ris_result result;
    r->clip->minimum = malloc((count + 1) * sizeof *r->clip->minimum);
    r->clip->maximum = malloc((count + 1) * sizeof *r->clip->maximum);
    r->pose = malloc((count + 1) * sizeof *r->pose);
    if (!r->clip->minimum || !r->clip->maximum || !r->pose) {
        return no_memory(&root, r->err);
    }
    r->clip->channel_count = count;
    for (uint32_t c = 0; c < count; c++) {
        r->clip->minimum[c] = r->names.model->channel[c].minimum;
        r->clip->maximum[c] = r->names.model->channel[c].maximum;
    }
    if ((result = ris__json_check_format(&root, "risorius-clip", 1, r->err)) ||
        (result = ris__json_check_object(&root, keys, r->err)) || (result = read_duration(&duration, r)) ||
        (result = read_expressions(&expressions, r, out_expression)) || (result = read_tracks(&tracks, r)) ||
        (result = read_labels(&labels, r))) {
        return result;
    }
    return RIS_OK;
}

static ris_result make_clip(const ris_model *model, const ris_json *json, ris_clip **out, ris_error *err)
{
    clip_reader r = {.names.model = model, .clip = calloc(1, sizeof(ris_clip)), .err = err};
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
        result = make_clip(model, &json, out, err);
    }
    ris__json_finish(&json);
    return result;
}

ris_result ris_clip_load(const ris_model *model, const char *path, ris_clip **out, ris_error *err)
{
    ris_json json;
    *out = NULL;
    ris_result result = ris__json_load(path, &json, err);
    if (result == RIS_OK) {
        result = make_clip(model, &json, out, err);
    }
    ris__json_finish(&json);
    return result;
}
