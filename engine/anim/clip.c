/* KA-50: sampling of clips. A sample depends on the time alone, never on what was sampled before. Cubic: F.
 * N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17 (1980). */
#include "anim/clip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the curve does between key i and i + 1, as far as the cubic beside it cares: a held value has slope 0.
 * */
static double secant(const ris_track *track, uint32_t i)
{
    const ris_key *a = &track->key[i], *b = a + 1;
    return a->ease == RIS_EASE_STEP ? 0 : (b->value - a->value) / (b->t_s - a->t_s);
}

void ris__track_set_slopes(ris_track *track)
{
    /* the ends hold, so the first and last slopes are 0 */
    track->key[0].slope = track->key[track->key_count - 1].slope = 0;
    for (uint32_t i = 1; i + 1 < track->key_count; i++) {
        double before = secant(track, i - 1), after = secant(track, i);
        track->key[i].slope = before * after > 0 ? (before + after) / 2 : 0;
    }
    for (uint32_t i = 0; i + 1 < track->key_count; i++) {
        ris_key *a = &track->key[i], *b = a + 1;
        double d = secant(track, i);
        if (a->ease != RIS_EASE_CUBIC || d == 0) {
            continue;
        }
        double alpha = a->slope / d, beta = b->slope / d, square = alpha * alpha + beta * beta;
        if (square > 9) { /* outside the circle of radius 3 the cubic would overshoot */
            a->slope = 3 / sqrt(square) * alpha * d;
            b->slope = 3 / sqrt(square) * beta * d;
        }
    }
}

double ris__track_value(const ris_track *track, double time_s)
{
    uint32_t low = 0, high = track->key_count;
    if (time_s < track->key[0].t_s) {
        return track->key[0].value;
    }
    while (high - low > 1) { /* key[low] is at or before time_s */
        uint32_t middle = low + (high - low) / 2;
        if (track->key[middle].t_s <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const ris_key *a = &track->key[low], *b = a + 1;
    if (low + 1 == track->key_count || a->ease == RIS_EASE_STEP) {
        return a->value;
    }
    double span = b->t_s - a->t_s, s = (time_s - a->t_s) / span;
    if (a->ease == RIS_EASE_LINEAR) {
        return a->value * (1 - s) + b->value * s;
    }
    double r = 1 - s;
    return a->value * (1 + 2 * s) * r * r + b->value * s * s * (3 - 2 * s) + a->slope * span * s * r * r -
           b->slope * span * s * s * r;
}

void ris_clip_sample(const ris_clip *clip, double time_s, float *pose)
{
    for (uint32_t c = 0; c < clip->channel_count; c++) {
        pose[c] = 0;
    }
    for (uint32_t i = 0; i < clip->track_count; i++) {
        const ris_track *track = &clip->track[i];
        float value = (float)ris__track_value(track, time_s);
        for (uint32_t n = 0; n < track->term_count; n++) {
            pose[track->term[n].channel] += value * track->term[n].factor;
        }
    }
    for (uint32_t c = 0; c < clip->channel_count; c++) {
        pose[c] = pose[c] < clip->minimum[c] ? clip->minimum[c] : pose[c];
        pose[c] = pose[c] > clip->maximum[c] ? clip->maximum[c] : pose[c];
    }
}

double ris_clip_duration_s(const ris_clip *clip)
{
    return clip->duration_s;
}

static int compare_times(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return a < b ? -1 : a > b;
}

/* The track that acts most at time_s, or "rest". */
static const char *strongest(const ris_clip *clip, double time_s)
{
    const char *name = "rest";
    double most = 1e-6;
    for (uint32_t i = 0; i < clip->track_count; i++) {
        const ris_track *track = &clip->track[i];
        double value = fabs(ris__track_value(track, time_s)), share = 0;
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
    return name;
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
    size_t key_count = 0, n = 0;
    for (uint32_t i = 0; i < clip->track_count; i++) {
        key_count += clip->track[i].key_count;
    }
    double *time = malloc(key_count * sizeof *time);
    float *pose = malloc(2 * (size_t)clip->channel_count * sizeof *pose + 1);
    clip->label = calloc(key_count, sizeof *clip->label);
    if (!time || !pose || !clip->label) {
        free(time);
        free(pose);
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %zu labels of a clip", key_count);
    }
    for (uint32_t i = 0; i < clip->track_count; i++) {
        for (uint32_t k = 0; k < clip->track[i].key_count; k++) {
            time[n++] = clip->track[i].key[k].t_s;
        }
    }
    qsort(time, n, sizeof *time, compare_times);
    float *now = pose, *labelled = pose + clip->channel_count;
    for (size_t i = 0; i < n; i++) {
        ris_clip_sample(clip, time[i], now);
        if (clip->label_count > 0 && !poses_differ(now, labelled, clip->channel_count)) {
            continue;
        }
        ris_label *label = &clip->label[clip->label_count++];
        label->t_s = time[i];
        strcpy(label->name, strongest(clip, time[i]));
        memcpy(labelled, now, clip->channel_count * sizeof *now);
    }
    free(time);
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

void ris_clip_destroy(ris_clip *clip)
{
    if (!clip) {
        return;
    }
    for (uint32_t i = 0; clip->track && i < clip->track_count; i++) {
        free(clip->track[i].key);
        free(clip->track[i].term);
    }
    free(clip->track);
    free(clip->label);
    free(clip->minimum);
    free(clip->maximum);
    free(clip);
}
