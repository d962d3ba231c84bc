/* KA-50: curves of keys. Cubic: F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation, SIAM J.
 * Numer. Anal. 17 (1980). Minimum jerk: T. Flash, N. Hogan, The coordination of arm movements, J. Neurosci. 5
 * (1985). Back: R. Penner, Programming Macromedia Flash MX (2002), ten percent beyond. */
#include "anim/track.h"

#include <math.h>
#include <stdlib.h>

#define BACK 1.70158     /* makes the greatest overshoot a tenth */
#define SAME_TIME_S 1e-6 /* keys nearer than this are one moment */
#define SAME_VALUE 1e-6

const char *const ris__ease_names[] = {"step",   "linear",       "cubic",   "in",       "out",
                                       "in_out", "minimum_jerk", "back_in", "back_out", NULL};

double ris__ease(ris_ease ease, double u)
{
    double r = 1 - u;
    switch (ease) {
    case RIS_EASE_STEP: return u < 1 ? 0 : 1;
    case RIS_EASE_LINEAR: return u;
    case RIS_EASE_CUBIC: return u * u * (3 - 2 * u);
    case RIS_EASE_IN: return u * u;
    case RIS_EASE_OUT: return 1 - r * r;
    case RIS_EASE_IN_OUT: return u < 0.5 ? 2 * u * u : 1 - 2 * r * r;
    case RIS_EASE_MINIMUM_JERK: return u * u * u * (10 - u * (15 - 6 * u));
    case RIS_EASE_BACK_IN: return u * u * ((BACK + 1) * u - BACK);
    case RIS_EASE_BACK_OUT: return 1 - r * r * ((BACK + 1) * r - BACK);
    }
    return u;
}

/* Mean speed between key i and i + 1 as the cubic beside it sees it: where an ease comes to rest at the key
 * they share (last: key i + 1), so does the cubic. */
static double secant(const ris_track *track, uint32_t i, bool last)
{
    const ris_key *a = &track->key[i], *b = a + 1;
    switch (a->ease) {
    case RIS_EASE_STEP:
    case RIS_EASE_IN_OUT:
    case RIS_EASE_MINIMUM_JERK: return 0;
    case RIS_EASE_IN:
    case RIS_EASE_BACK_IN:
        if (!last) {
            return 0;
        }
        break;
    case RIS_EASE_OUT:
    case RIS_EASE_BACK_OUT:
        if (last) {
            return 0;
        }
        break;
    case RIS_EASE_LINEAR:
    case RIS_EASE_CUBIC: break;
    }
    return (b->value - a->value) / (b->t_s - a->t_s);
}

static double mean_slope(double before, double after)
{
    return before * after > 0 ? (before + after) / 2 : 0;
}

/* Outside the circle of radius 3 the cubic from key i on would overshoot. */
static void limit_slopes(ris_track *track, uint32_t i)
{
    ris_key *a = &track->key[i], *b = a + 1;
    double d = secant(track, i, false);
    if (a->ease != RIS_EASE_CUBIC || d == 0) {
        return;
    }
    double alpha = a->slope / d, beta = b->slope / d, square = alpha * alpha + beta * beta;
    if (square > 9) {
        a->slope = 3 / sqrt(square) * alpha * d;
        b->slope = 3 / sqrt(square) * beta * d;
    }
}

void ris__track_set_slopes(ris_track *track)
{
    uint32_t last = track->key_count - 1;
    ris_key *key = track->key;
    /* ends that hold are at rest, ends that meet are one key, unless the values jump there */
    key[0].slope = key[last].slope = 0;
    bool meet = track->period_s > 0 && last > 0 && fabs(key[0].value - key[last].value) <= SAME_VALUE;
    if (meet) {
        key[0].slope = key[last].slope = mean_slope(secant(track, last - 1, true), secant(track, 0, false));
    }
    for (uint32_t i = 1; i < last; i++) {
        key[i].slope = mean_slope(secant(track, i - 1, true), secant(track, i, false));
    }
    for (uint32_t i = 0; i < last; i++) {
        limit_slopes(track, i);
    }
    if (meet) { /* a smaller slope of the same sign is always within the circle */
        double least = fabs(key[0].slope) < fabs(key[last].slope) ? key[0].slope : key[last].slope;
        key[0].slope = key[last].slope = least;
    }
}

void ris__track_repeat(ris_track *track, double period_s)
{
    ris_key first = track->key[0];
    track->period_s = period_s;
    if (track->key[track->key_count - 1].t_s - first.t_s < period_s - SAME_TIME_S) {
        first.t_s += period_s;
        track->key[track->key_count++] = first;
    } else {
        track->key[track->key_count - 1].t_s = first.t_s + period_s;
    }
}

/* The last key at or before time_s (of those that are followed by another; 0 if there is none before). */
static uint32_t find_key(const ris_track *track, double time_s)
{
    uint32_t low = 0, high = track->key_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (track->key[middle].t_s <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

double ris__track_value(const ris_track *track, double time_s)
{
    const double first_s = track->key[0].t_s;
    if (track->period_s > 0) {
        time_s -= track->period_s * floor((time_s - first_s) / track->period_s);
    }
    if (time_s < first_s) {
        return track->key[0].value;
    }
    uint32_t at = find_key(track, time_s);
    const ris_key *a = &track->key[at], *b = a + 1;
    if (at + 1 == track->key_count || a->ease == RIS_EASE_STEP) {
        return a->value;
    }
    double span = b->t_s - a->t_s, s = (time_s - a->t_s) / span;
    if (a->ease == RIS_EASE_LINEAR) {
        return a->value * (1 - s) + b->value * s;
    }
    double r = 1 - s;
    if (a->ease != RIS_EASE_CUBIC) {
        double done = ris__ease(a->ease, s);
        return a->value * (1 - done) + b->value * done;
    }
    return a->value * (1 + 2 * s) * r * r + b->value * s * s * (3 - 2 * s) + a->slope * span * s * r * r -
           b->slope * span * s * s * r;
}

void ris__track_finish(ris_track *track)
{
    free(track->key);
    free(track->term);
    *track = (ris_track){0};
}
