/* KA-50: reads the layers of a clip. */
#include "anim/clip_read.h"
#include "base/file.h"
#include "risorius/take.h"

#include <stdlib.h>
#include <string.h>

#define MAX_LAYERS 64
#define MAX_WEIGHT 10.0 /* of a layer that adds */

static ris_result read_weight(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    double most = layer->overrides ? 1 : MAX_WEIGHT, value = 1;
    ris_key_range range = {r->clip->duration_s, 0, most, RIS_EASE_LINEAR, 1, 0, 0};
    ris_track *track = &layer->weight;
    ris_result result;
    if (!at->value) {
        return RIS_OK;
    }
    if (json_is_array(at->value)) {
        result = ris__read_keys(at, &range, track, r->err);
    } else {
        result = ris__json_double(at, RIS_JSON_REQUIRED, 0, most, &value, r->err);
        track->key = result == RIS_OK ? calloc(2, sizeof *track->key) : NULL;
        if (track->key) {
            track->key_count = 1;
            track->key[0].value = value;
        }
    }
    if (result == RIS_OK && !track->key) {
        return ris__clip_no_memory(at, r->err);
    }
    if (result == RIS_OK) {
        if (r->clip->repeats) {
            ris__track_repeat(track, r->clip->duration_s);
        }
        ris__track_set_slopes(track);
    }
    return result;
}

static ris_result read_idle(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    static const char *const keys[] = {
        "seed",        "blinks_per_min", "gazes_per_min",   "gaze_deg",   "saccades_per_s",
        "saccade_deg", "head_deg",       "breaths_per_min", "breath_deg", NULL};
    ris_idle_def def = ris__idle_default;
    const struct {
        double maximum, *out;
    } number[] = {{60, &def.blinks_per_min},  {120, &def.gazes_per_min}, {15, &def.gaze_deg},
                  {5, &def.saccades_per_s},   {2, &def.saccade_deg},     {5, &def.head_deg},
                  {60, &def.breaths_per_min}, {5, &def.breath_deg}};
    ris_json_at seed = ris__json_key(at, keys[0]);
    ris_result result = ris__json_check_object(at, keys, r->err);
    if (result == RIS_OK) {
        result = ris__json_uint(&seed, RIS_JSON_OPTIONAL, 0, UINT32_MAX, &def.seed, r->err);
    }
    for (size_t i = 0; result == RIS_OK && i < sizeof number / sizeof number[0]; i++) {
        ris_json_at item = ris__json_key(at, keys[1 + i]);
        result = ris__json_double(&item, RIS_JSON_OPTIONAL, 0, number[i].maximum, number[i].out, r->err);
    }
    if (result != RIS_OK) {
        return result;
    }
    layer->idle = ris__idle_create(&def, r->names.model);
    return layer->idle ? RIS_OK : ris__clip_no_memory(at, r->err);
}

/* The path of a file that is named in this one: relative to its folder. */
static ris_result read_path(const ris_json_at *at, ris_clip_reader *r, char out[RIS_PATH_SIZE])
{
    char name[1024], folder[RIS_PATH_SIZE];
    ris_result result = ris__json_text(at, RIS_JSON_REQUIRED, name, sizeof name, r->err);
    if (result != RIS_OK) {
        return result;
    }
    if (!r->path) {
        return ris__json_fail(at, r->err, "a clip from memory cannot name a file");
    }
    const char *slash = strrchr(r->path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - r->path + 1) : 0, r->path);
    result = ris__path_join(out, folder, name, r->err);
    for (const ris_clip_reader *outer = r; !result && outer; outer = outer->outer) {
        if (strcmp(outer->path, out) == 0) {
            return ris__json_fail(at, r->err, "the clip includes itself through \"%.200s\"", name);
        }
    }
    return result;
}

static ris_result read_include(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    char path[RIS_PATH_SIZE];
    ris_result result = read_path(at, r, path);
    return result ? result : ris__clip_include(path, r, &layer->clip);
}

/* A recorded performance (docs/performances.md). */
static ris_result read_take(const ris_json_at *at, const ris_json_at *adjust, ris_take_format format,
                            ris_clip_reader *r, ris_clip_layer *layer)
{
    char path[RIS_PATH_SIZE], words[256] = "";
    ris_error reason = {0};
    ris_take_def def = ris_default_take_def(format);
    ris_result result;
    if ((result = read_path(at, r, path)) ||
        (result = ris__json_text(adjust, RIS_JSON_OPTIONAL, words, sizeof words, r->err))) {
        return result;
    }
    if (words[0] && ris_take_adjust(&def, words, &reason) != RIS_OK) {
        return ris__json_fail(adjust, r->err, "%s", reason.text);
    }
    if (def.onset) {
        return ris__json_fail(adjust, r->err, "muscles in a clip have their onset already");
    }
    result = ris__clip_count_file(path, r);
    return result ? result : ris_take_load(r->names.model, path, &def, &layer->clip, NULL, r->err);
}

static void touch(const ris_clip_layer *layer, bool *touches)
{
    for (uint32_t i = 0; i < layer->track_count; i++) {
        for (uint32_t n = 0; n < layer->track[i].term_count; n++) {
            touches[layer->track[i].term[n].channel] = true;
        }
    }
    for (uint32_t k = 0; layer->clip && k < layer->clip->layer_count; k++) {
        touch(&layer->clip->layer[k], touches);
    }
    if (layer->idle) {
        ris__idle_touch(layer->idle, touches);
    }
    if (layer->speech) {
        ris__speech_touch(layer->speech, touches);
    }
}

/* Where and how long the layer runs; before its content, whose keys must lie within. */
static ris_result read_times(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    ris_json_at start = ris__json_key(at, "start_s"), speed = ris__json_key(at, "speed");
    ris_json_at duration = ris__json_key(at, "duration_s"), loop = ris__json_key(at, "loop");
    ris_result result;
    if (layer->idle && (duration.value || loop.value)) {
        return ris__json_fail(at, r->err, "idle life has no end: neither \"duration_s\" nor \"loop\"");
    }
    layer->duration_s = layer->clip ? layer->clip->duration_s : r->clip->duration_s;
    layer->repeats = layer->clip && layer->clip->repeats;
    if ((result = ris__json_double(&start, RIS_JSON_OPTIONAL, -RIS_CLIP_MAX_S, RIS_CLIP_MAX_S,
                                   &layer->start_s, r->err)) ||
        (result = ris__json_double(&speed, RIS_JSON_OPTIONAL, 0.01, 100, &layer->speed, r->err)) ||
        (result = ris__json_double(&duration, RIS_JSON_OPTIONAL, 1e-3, RIS_CLIP_MAX_S, &layer->duration_s,
                                   r->err))) {
        return result;
    }
    return loop.value ? ris__read_bool(&loop, &layer->repeats, r->err) : RIS_OK;
}

static ris_result read_speech(const ris_json_at *at, const ris_json_at *list, ris_clip_reader *r,
                              ris_clip_layer *layer)
{
    double lead_s = RIS_SPEECH_LEAD_S;
    ris_json_at lead = ris__json_key(at, "lead_s");
    ris_result result = ris__json_double(&lead, RIS_JSON_OPTIONAL, 0, 1, &lead_s, r->err);
    return result ? result
                  : ris__speech_read(list, r->names.model, layer->duration_s, lead_s, &layer->speech, r->err);
}

/* What plays, if it is another file. */
static ris_result read_file(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    ris_json_at clip = ris__json_key(at, "clip"), live_link = ris__json_key(at, "live_link");
    ris_json_at openface = ris__json_key(at, "openface"), adjust = ris__json_key(at, "adjust");
    if (adjust.value && !live_link.value && !openface.value) {
        return ris__json_fail(&adjust, r->err, "only a performance is adjusted");
    }
    if (clip.value) {
        return read_include(&clip, r, layer);
    }
    if (live_link.value) {
        return read_take(&live_link, &adjust, RIS_TAKE_LIVE_LINK, r, layer);
    }
    return openface.value ? read_take(&openface, &adjust, RIS_TAKE_OPENFACE, r, layer) : RIS_OK;
}

static ris_result read_content(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    static const char *const kinds[] = {"tracks", "clip", "live_link", "openface", "idle", "speech"};
    ris_json_at tracks = ris__json_key(at, "tracks"), speech = ris__json_key(at, "speech");
    ris_json_at idle = ris__json_key(at, "idle"), lead = ris__json_key(at, "lead_s");
    int count = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        count += ris__json_key(at, kinds[i]).value != NULL;
    }
    if (count != 1) {
        return ris__json_fail(at, r->err,
                              "expected one of \"tracks\", \"clip\", \"live_link\", \"openface\", "
                              "\"idle\" and \"speech\"");
    }
    if (lead.value && !speech.value) {
        return ris__json_fail(&lead, r->err, "only speech has a lead");
    }
    ris_result result = read_file(at, r, layer);
    if (result == RIS_OK && idle.value) {
        result = read_idle(&idle, r, layer);
    }
    if (result == RIS_OK) {
        result = read_times(at, r, layer);
    }
    if (result == RIS_OK && tracks.value) {
        result = ris__read_tracks(&tracks, r, layer);
    } else if (result == RIS_OK && speech.value) {
        result = read_speech(at, &speech, r, layer);
    }
    return result;
}

static ris_result read_layer(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    static const char *const keys[] = {"name",      "mode",     "weight", "start_s", "speed",  "duration_s",
                                       "loop",      "tracks",   "clip",   "idle",    "speech", "lead_s",
                                       "live_link", "openface", "adjust", NULL};
    static const char *const modes[] = {"add", "override", NULL};
    uint32_t mode = 0;
    ris_json_at name = ris__json_key(at, "name"), mode_at = ris__json_key(at, "mode");
    ris_json_at weight = ris__json_key(at, "weight");
    ris_result result;
    if ((result = ris__json_check_object(at, keys, r->err)) ||
        (result = ris__json_text(&name, RIS_JSON_OPTIONAL, layer->name, sizeof layer->name, r->err)) ||
        (result = ris__json_choice(&mode_at, RIS_JSON_OPTIONAL, modes, &mode, r->err))) {
        return result;
    }
    layer->overrides = mode == 1;
    if ((result = read_weight(&weight, r, layer)) || (result = read_content(at, r, layer))) {
        return result;
    }
    layer->touches = calloc(r->clip->channel_count + 1u, sizeof *layer->touches);
    if (!layer->touches) {
        return ris__clip_no_memory(at, r->err);
    }
    touch(layer, layer->touches);
    return RIS_OK;
}

ris_result ris__read_layers(const ris_json_at *plain, const ris_json_at *list, ris_clip_reader *r)
{
    ris_clip *clip = r->clip;
    size_t count = json_array_size(list->value);
    ris_result result = list->value ? ris__json_check_array(list, 1, MAX_LAYERS, r->err) : RIS_OK;
    if (result != RIS_OK) {
        return result;
    }
    if (!plain->value && !list->value) {
        return ris__json_fail(plain, r->err, "the clip is empty: no tracks and no layers");
    }
    clip->layer = calloc(count + 1, sizeof *clip->layer);
    if (!clip->layer) {
        return ris__clip_no_memory(plain, r->err);
    }
    if (plain->value) {
        ris_clip_layer *layer = &clip->layer[clip->layer_count++];
        *layer = (ris_clip_layer){.speed = 1, .duration_s = clip->duration_s, .repeats = clip->repeats};
        result = ris__read_tracks(plain, r, layer);
    }
    for (size_t i = 0; result == RIS_OK && i < count; i++) {
        ris_json_at item = ris__json_item(list, i);
        ris_clip_layer *layer = &clip->layer[clip->layer_count++];
        *layer = (ris_clip_layer){.speed = 1};
        result = read_layer(&item, r, layer);
    }
    return result;
}
