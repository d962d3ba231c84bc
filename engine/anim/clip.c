/* KA-50: sampling of clips, layer by layer. A sample depends on the time alone, never on what was sampled before. */
#include "anim/clip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 256 /* channels sampled at a time: a sample takes no memory but the stack */

typedef struct pose_block {
    uint32_t first, count; /* channels */
    float value[BLOCK];
} pose_block;

/* Time within a clip. What repeats goes on from its start; idle life does not repeat with it, so it is told how long
 * the clip has been going. */
typedef struct clip_time {
    double local_s, going_s;
} clip_time;

static double wrap(double time_s, double period_s)
{
    return time_s - period_s * floor(time_s / period_s);
}

static double hold(double time_s, double duration_s)
{
    return time_s < 0 ? 0 : time_s > duration_s ? duration_s : time_s;
}

static void clamp_block(const ris_clip *clip, pose_block *block)
{
    for (uint32_t i = 0; i < block->count; i++) {
        float low = clip->minimum[block->first + i], high = clip->maximum[block->first + i];
        block->value[i] = block->value[i] < low ? low : block->value[i] > high ? high : block->value[i];
    }
}

static void add_tracks(const ris_clip_layer *layer, double time_s, pose_block *block)
{
    for (uint32_t i = 0; i < layer->track_count; i++) {
        const ris_track *track = &layer->track[i];
        float value = (float)ris__track_value(track, time_s);
        for (uint32_t n = 0; n < track->term_count; n++) {
            uint32_t at = track->term[n].channel - block->first;
            if (at < block->count) {
                block->value[at] += value * track->term[n].factor;
            }
        }
    }
}

static void sample_block(const ris_clip *clip, clip_time time, bool repeats, pose_block *block);

/* The layer alone, unweighted. */
static void sample_layer(const ris_clip_layer *layer, clip_time time, pose_block *block)
{
    clip_time own = {(time.local_s - layer->start_s) * layer->speed,
                     (time.going_s - layer->start_s) * layer->speed};
    for (uint32_t i = 0; i < block->count; i++) {
        block->value[i] = 0;
    }
    if (layer->idle) {
        ris__idle_add(layer->idle, own.going_s, block->first, block->count, block->value);
        return;
    }
    bool repeats = layer->repeats && own.local_s > 0; /* before its start a layer holds its first pose */
    double local_s = repeats ? wrap(own.local_s, layer->duration_s) : hold(own.local_s, layer->duration_s);
    if (layer->clip) {
        sample_block(layer->clip, (clip_time){local_s, own.going_s}, repeats, block);
    } else if (layer->speech) {
        ris__speech_add(layer->speech, local_s, block->first, block->count, block->value);
    } else {
        add_tracks(layer, local_s, block);
    }
}

static void merge(const ris_clip *clip, const ris_clip_layer *layer, float weight, pose_block *under,
                  const pose_block *own)
{
    if (layer->overrides) {
        clamp_block(clip, under); /* what is replaced is what would show */
    }
    for (uint32_t i = 0; i < under->count; i++) {
        if (!layer->overrides) {
            under->value[i] += weight * own->value[i];
        } else if (layer->touches[under->first + i]) {
            under->value[i] = under->value[i] * (1 - weight) + own->value[i] * weight;
        }
    }
}

static double layer_weight(const ris_clip_layer *layer, double time_s)
{
    return layer->weight.key_count > 0 ? ris__track_value(&layer->weight, time_s) : 1;
}

/* The channels of block, clamped. */
static void sample_block(const ris_clip *clip, clip_time time, bool repeats, pose_block *block)
{
    time.local_s = repeats ? wrap(time.local_s, clip->duration_s) : hold(time.local_s, clip->duration_s);
    for (uint32_t i = 0; i < block->count; i++) {
        block->value[i] = 0;
    }
    for (uint32_t i = 0; i < clip->layer_count; i++) {
        const ris_clip_layer *layer = &clip->layer[i];
        float weight = (float)layer_weight(layer, time.local_s);
        if (weight != 0) {
            pose_block own = {.first = block->first, .count = block->count};
            sample_layer(layer, time, &own);
            if (layer->overrides) {
                clamp_block(clip, &own);
            }
            merge(clip, layer, weight, block, &own);
        }
    }
    clamp_block(clip, block);
}

void ris_clip_sample(const ris_clip *clip, double time_s, float *pose)
{
    for (uint32_t first = 0; first < clip->channel_count; first += BLOCK) {
        uint32_t left = clip->channel_count - first;
        pose_block block = {.first = first, .count = left < BLOCK ? left : BLOCK};
        sample_block(clip, (clip_time){time_s, time_s}, clip->repeats, &block);
        memcpy(pose + first, block.value, block.count * sizeof *pose);
    }
}

bool ris_clip_repeats(const ris_clip *clip)
{
    return clip->repeats;
}

double ris_clip_duration_s(const ris_clip *clip)
{
    return clip->duration_s;
}

/* A moment that may deserve a label; name NULL = after the track that acts most. */
typedef struct moment {
    double t_s;
    const char *name;
} moment;

static int compare_moments(const void *left, const void *right)
{
    double a = ((const moment *)left)->t_s, b = ((const moment *)right)->t_s;
    return a < b ? -1 : a > b;
}

/* The plain track that acts most at time_s, or "rest". */
static const char *strongest(const ris_clip *clip, double time_s)
{
    const char *name = "rest";
    double most = 1e-6;
    for (uint32_t k = 0; k < clip->layer_count; k++) {
        const ris_clip_layer *layer = &clip->layer[k];
        double weight = fabs(layer_weight(layer, time_s)), own_s = (time_s - layer->start_s) * layer->speed;
        own_s = layer->repeats && own_s > 0 ? wrap(own_s, layer->duration_s) : own_s;
        for (uint32_t i = 0; i < layer->track_count; i++) {
            const ris_track *track = &layer->track[i];
            double value = weight * fabs(ris__track_value(track, own_s)), share = 0;
            for (uint32_t n = 0; n < track->term_count; n++) {
                uint32_t c = track->term[n].channel;
                double reach = fmax(fabs((double)clip->minimum[c]), fabs((double)clip->maximum[c]));
                share = fmax(share, reach > 0 ? value * fabs((double)track->term[n].factor) / reach : 0);
            }
            if (share > most) {
                most = share;
                name = track->target;
            }
        }
    }
    return name;
}

static void add_moment(const ris_clip *clip, moment *list, size_t *count, double t_s, const char *name)
{
    if (t_s >= 0 && t_s <= clip->duration_s) {
        list[(*count)++] = (moment){t_s, name};
    }
}

/* Keys of tracks, labels of included clips, middles of phones: of a layer that repeats those of the first round. */
static void collect_layer(const ris_clip *clip, const ris_clip_layer *layer, moment *list, size_t *count)
{
    const double start_s = layer->start_s, speed = layer->speed;
    for (uint32_t i = 0; i < layer->track_count; i++) {
        for (uint32_t n = 0; n < layer->track[i].key_count; n++) {
            add_moment(clip, list, count, start_s + layer->track[i].key[n].t_s / speed, NULL);
        }
    }
    for (uint32_t i = 0; layer->clip && i < layer->clip->label_count; i++) {
        const ris_label *label = &layer->clip->label[i];
        add_moment(clip, list, count, start_s + label->t_s / speed, label->name);
    }
    for (uint32_t i = 0; layer->speech && i < layer->speech->segment_count; i++) {
        const ris_utterance *segment = &layer->speech->segment[i];
        if (segment->phone[0]) {
            add_moment(clip, list, count, start_s + segment->middle_s / speed, segment->phone);
        }
    }
}

static size_t collect_moments(const ris_clip *clip, moment *list)
{
    size_t count = 0;
    for (uint32_t k = 0; k < clip->layer_count; k++) {
        const ris_clip_layer *layer = &clip->layer[k];
        for (uint32_t i = 0; i < layer->weight.key_count; i++) {
            add_moment(clip, list, &count, layer->weight.key[i].t_s, NULL);
        }
        collect_layer(clip, layer, list, &count);
    }
    if (count == 0) {
        add_moment(clip, list, &count, 0, NULL);
    }
    qsort(list, count, sizeof *list, compare_moments);
    return count;
}

static size_t moment_room(const ris_clip *clip)
{
    size_t room = 1;
    for (uint32_t k = 0; k < clip->layer_count; k++) {
        const ris_clip_layer *layer = &clip->layer[k];
        room += layer->weight.key_count + (layer->clip ? layer->clip->label_count : 0);
        room += layer->speech ? layer->speech->segment_count : 0;
        for (uint32_t i = 0; i < layer->track_count; i++) {
            room += layer->track[i].key_count;
        }
    }
    return room;
}

static bool poses_differ(const float *a, const float *b, uint32_t count)
{
    bool differ = false;
    for (uint32_t c = 0; c < count; c++) {
        differ = differ || fabsf(a[c] - b[c]) > 1e-4f;
    }
    return differ;
}

ris_result ris__clip_make_labels(ris_clip *clip, ris_error *err)
{
    size_t room = moment_room(clip);
    moment *list = malloc(room * sizeof *list);
    float *pose = malloc(2 * (size_t)clip->channel_count * sizeof *pose + 1);
    clip->label = calloc(room, sizeof *clip->label);
    if (!list || !pose || !clip->label) {
        free(list);
        free(pose);
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %zu labels of a clip", room);
    }
    size_t count = collect_moments(clip, list);
    float *now = pose, *labelled = pose + clip->channel_count;
    for (size_t i = 0; i < count; i++) {
        ris_clip_sample(clip, list[i].t_s, now);
        if (clip->label_count > 0 && !poses_differ(now, labelled, clip->channel_count)) {
            continue;
        }
        ris_label *label = &clip->label[clip->label_count++];
        label->t_s = list[i].t_s;
        strcpy(label->name, list[i].name ? list[i].name : strongest(clip, list[i].t_s));
        memcpy(labelled, now, clip->channel_count * sizeof *now);
    }
    free(list);
    free(pose);
    return RIS_OK;
}

uint32_t ris_clip_label_count(const ris_clip *clip)
{
    return clip->label_count;
}

const char *ris_clip_label(const ris_clip *clip, uint32_t index, double *out_time_s)
{
    if (index >= clip->label_count) {
        return NULL;
    }
    if (out_time_s) {
        *out_time_s = clip->label[index].t_s;
    }
    return clip->label[index].name;
}

bool ris__clip_take_ranges(ris_clip *clip, const ris_model *model)
{
    const uint32_t count = model->channel_count;
    clip->minimum = malloc((count + 1) * sizeof *clip->minimum);
    clip->maximum = malloc((count + 1) * sizeof *clip->maximum);
    if (!clip->minimum || !clip->maximum) {
        return false;
    }
    clip->channel_count = count;
    for (uint32_t c = 0; c < count; c++) {
        clip->minimum[c] = model->channel[c].minimum;
        clip->maximum[c] = model->channel[c].maximum;
    }
    return true;
}

bool ris__clip_bind(const ris_pose_names *names, ris_track *track, float *scratch, const char **out_unknown)
{
    const uint32_t count = names->model->channel_count;
    for (uint32_t c = 0; c < count; c++) {
        scratch[c] = 0;
    }
    *out_unknown = ris__pose_expand(names, track->target, 1, scratch);
    track->term = malloc((count + 1) * sizeof *track->term);
    if (!track->term) {
        return false;
    }
    for (uint32_t c = 0; c < count && !*out_unknown; c++) {
        if (scratch[c] != 0) {
            track->term[track->term_count++] = (ris_track_term){c, scratch[c]};
        }
    }
    return true;
}

void ris_clip_destroy(ris_clip *clip)
{
    if (!clip) {
        return;
    }
    for (uint32_t k = 0; clip->layer && k < clip->layer_count; k++) {
        ris_clip_layer *layer = &clip->layer[k];
        for (uint32_t i = 0; layer->track && i < layer->track_count; i++) {
            ris__track_finish(&layer->track[i]);
        }
        free(layer->track);
        ris__track_finish(&layer->weight);
        ris_clip_destroy(layer->clip);
        ris__idle_destroy(layer->idle);
        ris__speech_destroy(layer->speech);
        free(layer->touches);
    }
    free(clip->layer);
    free(clip->label);
    free(clip->minimum);
    free(clip->maximum);
    free(clip);
}
