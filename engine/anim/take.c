/* A recorded performance as a clip: a track per column that moves, a cubic key per sample (docs/performances.md). */
#include "anim/clip.h"
#include "anim/take_clip.h"
#include "asset/take.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_TAKE_BYTES ((size_t)256 << 20)
#define LABEL_APART_S 0.1
#define LABEL_LEAST 0.2 /* of the column's range */

typedef struct binder {
    const ris_take_table *table;
    const ris_model *model;
    ris_clip *clip;
    ris_take_info *info;
    float *pose; /* scratch (channel_count) */
} binder;

static float value_at(const ris_take_table *table, uint32_t sample, uint32_t column)
{
    return table->value[(size_t)sample * table->column_count + column];
}

static bool moves(const ris_take_table *table, uint32_t column)
{
    for (uint32_t i = 0; i < table->sample_count; i++) {
        if (value_at(table, i, column) != 0) {
            return true;
        }
    }
    return false;
}

static bool make_keys(const ris_take_table *table, uint32_t column, ris_track *track)
{
    track->key = calloc(table->sample_count, sizeof *track->key);
    if (!track->key) {
        return false;
    }
    for (uint32_t i = 0; i < table->sample_count; i++) {
        track->key[i] = (ris_key){
            .t_s = table->time_s[i], .value = (double)value_at(table, i, column), .ease = RIS_EASE_CUBIC};
    }
    track->key_count = table->sample_count;
    ris__track_set_slopes(track);
    return true;
}

static bool make_tracks(binder *b)
{
    const ris_pose_names names = {.model = b->model};
    ris_clip_layer *layer = &b->clip->layer[0];
    layer->track = calloc(b->table->column_count + 1, sizeof *layer->track);
    if (!layer->track) {
        return false;
    }
    for (uint32_t c = 0; c < b->table->column_count; c++) {
        if (!moves(b->table, c)) {
            continue;
        }
        const char *unknown; /* this head has none of it: no terms */
        ris_track *track = &layer->track[layer->track_count++];
        strcpy(track->target, b->table->column[c].name);
        if (!ris__clip_bind(&names, track, b->pose, &unknown) || !make_keys(b->table, c, track)) {
            return false;
        }
        if (track->term_count == 0) {
            if (b->info->unknown++ == 0) {
                strcpy(b->info->first_unknown, track->target);
            }
            ris__track_finish(track);
            layer->track_count--;
        }
    }
    return true;
}

typedef struct peak {
    double t_s;
    float height; /* of the range */
    const char *name;
} peak;

static peak find_peak(const ris_take_table *table, uint32_t column)
{
    const ris_take_column *c = &table->column[column];
    peak best = {0, 0, c->name};
    for (uint32_t i = 0; i < table->sample_count; i++) {
        const float value = value_at(table, i, column);
        const float height = value > 0 ? value / c->maximum : value / c->minimum;
        if (value != 0 && height > best.height) {
            best = (peak){table->time_s[i], height, c->name};
        }
    }
    return best;
}

static int compare_peaks(const void *left, const void *right)
{
    const peak *a = left, *b = right;
    return a->t_s != b->t_s ? (a->t_s > b->t_s) - (a->t_s < b->t_s) : strcmp(a->name, b->name);
}

/* Where each column is highest, named after it; of those at one time the highest. */
static bool make_labels(binder *b)
{
    const ris_take_table *table = b->table;
    peak *list = malloc((table->column_count + 1) * sizeof *list);
    uint32_t count = 0, kept = 0;
    b->clip->label = calloc(table->column_count + 1, sizeof *b->clip->label);
    if (!list || !b->clip->label) {
        free(list);
        return false;
    }
    for (uint32_t c = 0; c < table->column_count; c++) {
        const peak found = find_peak(table, c);
        if (found.height >= LABEL_LEAST) {
            list[count++] = found;
        }
    }
    qsort(list, count, sizeof *list, compare_peaks);
    for (uint32_t i = 0; i < count; i++) {
        if (kept && list[i].t_s - list[kept - 1].t_s < LABEL_APART_S) {
            list[kept - 1] = list[i].height > list[kept - 1].height ? list[i] : list[kept - 1];
        } else {
            list[kept++] = list[i];
        }
    }
    list[0] = kept ? list[0] : (peak){0, 0, "rest"};
    b->clip->label_count = kept ? kept : 1;
    for (uint32_t i = 0; i < b->clip->label_count; i++) {
        b->clip->label[i].t_s = list[i].t_s;
        strcpy(b->clip->label[i].name, list[i].name);
    }
    free(list);
    return true;
}

static bool make_clip(binder *b)
{
    ris_clip *clip = b->clip = calloc(1, sizeof *clip);
    if (!clip) {
        return false;
    }
    clip->duration_s = fmax(b->table->duration_s, 1e-3);
    clip->layer = calloc(1, sizeof *clip->layer);
    b->pose = malloc((b->model->channel_count + 1) * sizeof *b->pose);
    if (!clip->layer || !b->pose || !ris__clip_take_ranges(clip, b->model)) {
        return false;
    }
    clip->layer_count = 1;
    clip->layer[0].speed = 1;
    clip->layer[0].duration_s = clip->duration_s;
    return make_tracks(b) && make_labels(b);
}

static ris_result bind(const ris_model *model, const char *name, const ris_take_table *table, ris_clip **out,
                       ris_take_info *info, ris_error *err)
{
    binder b = {.table = table, .model = model, .info = info};
    const bool made = make_clip(&b);
    free(b.pose);
    if (!made) {
        ris_clip_destroy(b.clip);
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %u samples", name, table->sample_count);
    }
    if (info->columns > 0 && info->unknown == info->columns) {
        ris_clip_destroy(b.clip);
        return ris_fail(err, RIS_ERROR_DATA,
                        "%s: expected a column that moves this head, found none among %u; the first is %s",
                        name, info->columns, info->first_unknown);
    }
    *out = b.clip;
    return RIS_OK;
}

ris_result ris__take_clip(const ris_model *model, const char *name, const char *text, size_t size,
                          const ris_take_def *def, ris_clip **out, ris_take_info *info, ris_error *err)
{
    ris_take_table table;
    *out = NULL;
    ris_result result = ris__take_parse(name, text, size, def, &table, info, err);
    if (result == RIS_OK) {
        result = bind(model, name, &table, out, info, err);
        ris__take_finish(&table);
    }
    return result;
}

ris_result ris_take_load(const ris_model *model, const char *path, const ris_take_def *def, ris_clip **out,
                         ris_take_info *out_info, ris_error *err)
{
    char *text;
    size_t size;
    ris_take_info info = {0};
    *out = NULL;
    ris_result result = ris__file_read(path, MAX_TAKE_BYTES, &text, &size, err);
    if (result == RIS_OK) {
        result = ris__take_clip(model, path, text, size, def, out, &info, err);
        free(text);
    }
    if (out_info) {
        *out_info = info;
    }
    return result;
}
