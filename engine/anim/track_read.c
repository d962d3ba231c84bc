/* KA-50: reads keys and tracks. */
#include "anim/clip_read.h"
#include "asset/names.h"

#include <stdlib.h>

#define MAX_TRACKS 4096
#define MAX_KEYS (1u << 20)

static ris_result read_ease(const ris_json_at *at, ris_ease *out, ris_error *err)
{
    uint32_t ease = (uint32_t)*out;
    ris_result result = ris__json_choice(at, RIS_JSON_OPTIONAL, ris__ease_names, &ease, err);
    *out = (ris_ease)ease;
    return result;
}

static ris_result read_key(const ris_json_at *at, const ris_key_range *range, double after_s, ris_key *out,
                           ris_error *err)
{
    static const char *const keys[] = {"t", "v", "ease", NULL};
    ris_json_at t = ris__json_key(at, "t"), v = ris__json_key(at, "v"), ease = ris__json_key(at, "ease");
    ris_result result;
    out->ease = range->ease;
    if ((result = ris__json_check_object(at, keys, err)) ||
        (result = ris__json_double(&t, RIS_JSON_REQUIRED, 0, range->duration_s, &out->t_s, err)) ||
        (result =
             ris__json_double(&v, RIS_JSON_REQUIRED, range->minimum, range->maximum, &out->value, err)) ||
        (result = read_ease(&ease, &out->ease, err))) {
        return result;
    }
    if (out->t_s - after_s < 1e-6) {
        char expected[64];
        snprintf(expected, sizeof expected, "a time after the key before (%g s)", after_s);
        return ris__json_expected(&t, err, expected);
    }
    return RIS_OK;
}

ris_result ris__read_keys(const ris_json_at *at, const ris_key_range *range, ris_track *track, ris_error *err)
{
    size_t count = json_array_size(at->value);
    if (json_is_array(at->value) && count == 0) {
        return ris__json_fail(at, err, "the clip is empty: a track without keys");
    }
    ris_result result = ris__json_check_array(at, 1, MAX_KEYS, err);
    if (result != RIS_OK) {
        return result;
    }
    track->key = calloc(count + 1, sizeof *track->key); /* one more for ris__track_repeat */
    if (!track->key) {
        return ris__clip_no_memory(at, err);
    }
    double before_s = -1;
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        ris_key *key = &track->key[i];
        if ((result = read_key(&item, range, before_s, key, err))) {
            return result;
        }
        before_s = key->t_s;
        key->t_s += range->shift_s;
        key->value = key->value * range->scale + range->offset;
        track->key_count++;
    }
    return RIS_OK;
}

/* The target once, as the channels it moves and by how much. */
static ris_result read_target(const ris_json_at *at, ris_clip_reader *r, ris_track *track)
{
    char nearest[256];
    const char *unknown;
    ris_result result = ris__json_text(at, RIS_JSON_REQUIRED, track->target, sizeof track->target, r->err);
    if (result != RIS_OK) {
        return result;
    }
    if (!ris__clip_bind(&r->names, track, r->pose, &unknown)) {
        return ris__clip_no_memory(at, r->err);
    }
    if (unknown) {
        return ris__json_fail(
            at, r->err, "unknown muscle, channel, unit, shape, viseme or expression \"%s\"; nearest: %s",
            unknown, ris__pose_nearest(&r->names, unknown, nearest, sizeof nearest));
    }
    return RIS_OK;
}

static ris_result read_track(const ris_json_at *at, ris_clip_reader *r, const ris_clip_layer *layer,
                             ris_track *track)
{
    static const char *const keys[] = {"target", "keys", "ease", "scale", "offset", "shift_s", NULL};
    const double most = RIS_CLIP_MAX_VALUE;
    ris_json_at target = ris__json_key(at, "target"), list = ris__json_key(at, "keys");
    ris_json_at ease = ris__json_key(at, "ease"), scale = ris__json_key(at, "scale");
    ris_json_at offset = ris__json_key(at, "offset"), shift = ris__json_key(at, "shift_s");
    ris_key_range range = {layer->duration_s, -most, most, RIS_EASE_LINEAR, 1, 0, 0};
    ris_result result;
    if ((result = ris__json_check_object(at, keys, r->err)) || (result = read_target(&target, r, track)) ||
        (result = read_ease(&ease, &range.ease, r->err)) ||
        (result = ris__json_double(&scale, RIS_JSON_OPTIONAL, -most, most, &range.scale, r->err)) ||
        (result = ris__json_double(&offset, RIS_JSON_OPTIONAL, -most, most, &range.offset, r->err)) ||
        (result = ris__json_double(&shift, RIS_JSON_OPTIONAL, -RIS_CLIP_MAX_S, RIS_CLIP_MAX_S, &range.shift_s,
                                   r->err)) ||
        (result = ris__read_keys(&list, &range, track, r->err))) {
        return result;
    }
    if (layer->repeats) {
        ris__track_repeat(track, layer->duration_s);
    }
    ris__track_set_slopes(track);
    return RIS_OK;
}

ris_result ris__read_tracks(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer)
{
    size_t count = json_array_size(at->value);
    if (json_is_array(at->value) && count == 0) {
        return ris__json_fail(at, r->err, "the clip is empty: no tracks");
    }
    ris_result result = ris__json_check_array(at, 1, MAX_TRACKS, r->err);
    if (result != RIS_OK) {
        return result;
    }
    layer->track = calloc(count, sizeof *layer->track);
    if (!layer->track) {
        return ris__clip_no_memory(at, r->err);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        if ((result = read_track(&item, r, layer, &layer->track[layer->track_count++]))) {
            return result;
        }
    }
    return RIS_OK;
}
