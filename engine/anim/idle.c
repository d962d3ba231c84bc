/* Idle life. Sources:
 * blink rate: Bentivoglio et al., Analysis of blink rate patterns in normal subjects, Mov. Disord. 12 (1997): 17 a
 *   minute at rest, 26 in talk, 4.5 reading. Intervals: strongly skewed, 5.2 s with deviation 3.1 s in Cruz et al.,
 *   Spontaneous interblink time distributions, Invest. Ophthalmol. Vis. Sci. 52 (2011): log-normal here, that ratio.
 * lid: Evinger, Manning, Sibony, Eyelid movements, Invest. Ophthalmol. Vis. Sci. 32 (1991): falls about twice as
 *   fast as it rises, with a long tail. Blinks come with gaze shifts the likelier the larger these are: Evinger et
 *   al., Not looking while leaping: the linkage of blinking and saccadic gaze shifts, Exp. Brain Res. 100 (1994).
 * saccades: Bahill, Clark, Stark, The main sequence, Math. Biosci. 24 (1975); duration 21 ms + 2.2 ms/deg of
 *   Carpenter, Movements of the Eyes (1988). Micro-saccades: one or two a second, up to about a degree:
 *   Martinez-Conde, Macknik, Hubel, Nat. Rev. Neurosci. 5 (2004).
 * The eyes turn against the head's drift, as the vestibulo-ocular reflex has them do. */
#include "anim/idle.h"
#include "anim/track.h"
#include "base/pcg.h"
#include "base/real.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SKEW 0.55           /* deviation of the logarithm of intervals: mean 5.2, deviation 3.1 */
#define GAP_S 0.5           /* least time between the starts of two blinks */
#define QUIET_S 1.0         /* at the end of a round, so that the next can begin at rest */
#define DRIFT_S 1.2         /* between control values of the head's drift */
#define DRIFT_GAIN 1.45     /* the spline evens control values out to 0.69 of their deviation */
#define LOWER_LID 0.15      /* the lower lid's share of a blink */
#define BLINK_GAZE_DEG 33.0 /* a gaze shift as large as this always brings a blink */
#define BREATH_IN 0.4       /* share of a breath */
#define BREATH_MM_PER_DEG 2.0

enum { STREAM_BLINK, STREAM_GAZE, STREAM_SACCADE, STREAM_DRIFT };

const ris_idle_def ris__idle_default = {
    .seed = 1,
    .blinks_per_min = 15,
    .gazes_per_min = 16,
    .gaze_deg = 3.5,
    .saccades_per_s = 1.2,
    .saccade_deg = 0.4,
    .head_deg = 0.6,
    .breaths_per_min = 14,
    .breath_deg = 0.25,
};

/* Log-normal with the mean. */
static double interval(ris_pcg *pcg, double mean_s)
{
    return mean_s * ris__exp(SKEW * ris__pcg_normal(pcg) - SKEW * SKEW / 2);
}

static uint32_t capacity(double mean_s)
{
    return (uint32_t)(RIS_IDLE_ROUND_S / mean_s * 2) + 64;
}

/* Shifts of both eyes to places of deviation deg. Home: from the middle, and three of five go back there. */
static bool draw_shifts(ris_shift **out, uint32_t *out_count, ris_pcg pcg, double mean_s, double deg,
                        double tall, bool home)
{
    uint32_t most = mean_s > 0 && deg > 0 ? capacity(mean_s) : 2, count = 1;
    ris_shift *shift = calloc(most, sizeof *shift);
    *out = shift;
    if (!shift) {
        return false;
    }
    double time_s = 0;
    while (mean_s > 0 && deg > 0 && count + 1 < most) {
        double wait = interval(&pcg, mean_s);
        time_s = fmax(time_s + wait, shift[count - 1].start_s + shift[count - 1].duration_s + 0.1);
        double yaw = deg * ris__pcg_normal(&pcg), pitch = tall * deg * ris__pcg_normal(&pcg);
        bool away = shift[count - 1].yaw_deg != 0, back = ris__pcg_unit(&pcg) < 0.6 && home && away;
        if (time_s > RIS_IDLE_ROUND_S - QUIET_S) {
            break;
        }
        ris_shift *next = &shift[count];
        *next = (ris_shift){.start_s = time_s};
        next->yaw_deg = back ? 0 : fmax(-2.5 * deg, fmin(2.5 * deg, yaw));
        next->pitch_deg = back ? 0 : fmax(-2.5 * deg, fmin(2.5 * deg, pitch));
        double across = next->yaw_deg - shift[count - 1].yaw_deg;
        double up = next->pitch_deg - shift[count - 1].pitch_deg;
        next->duration_s = 0.021 + 0.0022 * sqrt(across * across + up * up);
        count++;
    }
    shift[count++] = (ris_shift){.start_s = RIS_IDLE_ROUND_S - QUIET_S / 2, .duration_s = 0.04};
    *out_count = count;
    return true;
}

static ris_blink draw_blink(ris_pcg *pcg, double start_s)
{
    return (ris_blink){.start_s = start_s,
                       .close_s = 0.100 + 0.040 * ris__pcg_unit(pcg),
                       .open_s = 0.200 + 0.100 * ris__pcg_unit(pcg),
                       .depth = 0.92 + 0.08 * ris__pcg_unit(pcg)};
}

static int compare_blinks(const void *left, const void *right)
{
    double a = ((const ris_blink *)left)->start_s, b = ((const ris_blink *)right)->start_s;
    return a < b ? -1 : a > b;
}

/* Blinks of their own and with gaze shifts, in order, none within GAP_S of the one before. */
static bool draw_blinks(ris_idle *idle, ris_pcg pcg)
{
    double mean_s = idle->def.blinks_per_min > 0 ? 60 / idle->def.blinks_per_min : 0, time_s = 0;
    uint32_t own = mean_s > 0 ? capacity(mean_s) : 0, count = 0, kept = 0;
    ris_blink *blink = calloc(own + idle->gaze_count + 1u, sizeof *blink);
    idle->blink = blink;
    if (!blink) {
        return false;
    }
    while (count < own) {
        time_s += interval(&pcg, mean_s);
        if (time_s > RIS_IDLE_ROUND_S - QUIET_S) {
            break;
        }
        blink[count++] = draw_blink(&pcg, time_s);
    }
    for (uint32_t i = 1; own > 0 && i < idle->gaze_count; i++) {
        const ris_shift *to = &idle->gaze[i], *from = to - 1;
        double across = to->yaw_deg - from->yaw_deg, up = to->pitch_deg - from->pitch_deg;
        double chance = sqrt(across * across + up * up) / BLINK_GAZE_DEG;
        if (ris__pcg_unit(&pcg) < chance) {
            blink[count++] = draw_blink(&pcg, to->start_s);
        }
    }
    qsort(blink, count, sizeof *blink, compare_blinks);
    for (uint32_t i = 0; i < count; i++) {
        if (kept == 0 || blink[i].start_s - blink[kept - 1].start_s >= GAP_S) {
            blink[kept++] = blink[i];
        }
    }
    idle->blink_count = kept;
    return true;
}

static bool draw_drift(ris_idle *idle, ris_pcg pcg)
{
    idle->drift_count = (uint32_t)(RIS_IDLE_ROUND_S / DRIFT_S);
    idle->drift = calloc((size_t)idle->drift_count * 3, sizeof *idle->drift);
    for (uint32_t i = 0; idle->drift && i < 3 * idle->drift_count; i++) {
        double scale = DRIFT_GAIN * idle->def.head_deg * (i % 3 == 2 ? 0.5 : 1);
        idle->drift[i] = (float)(scale * ris__pcg_normal(&pcg));
    }
    return idle->drift != NULL;
}

static void find_channels(ris_idle *idle, const ris_model *model)
{
    static const char *const lid[] = {"lid.upper.L", "lid.upper.R", "lid.lower.L", "lid.lower.R"};
    static const char *const eye[] = {"eye.yaw.L", "eye.yaw.R", "eye.pitch.L", "eye.pitch.R"};
    static const char *const head[] = {"head.yaw", "head.pitch", "head.roll", "head.y"};
    for (int i = 0; i < 4; i++) {
        idle->lid[i] = ris_model_channel(model, lid[i]);
        idle->eye[i] = ris_model_channel(model, eye[i]);
        idle->head[i] = ris_model_channel(model, head[i]);
    }
}

ris_idle *ris__idle_create(const ris_idle_def *def, const ris_model *model)
{
    ris_idle *idle = calloc(1, sizeof *idle);
    if (!idle) {
        return NULL;
    }
    idle->def = *def;
    find_channels(idle, model);
    double gaze_s = def->gazes_per_min > 0 ? 60 / def->gazes_per_min : 0;
    double saccade_s = def->saccades_per_s > 0 ? 1 / def->saccades_per_s : 0;
    if (!draw_shifts(&idle->gaze, &idle->gaze_count, ris__pcg_start(def->seed, STREAM_GAZE), gaze_s,
                     def->gaze_deg, 0.6, true) ||
        /* from one place of this deviation to another, sqrt(pi) of it apart on the average */
        !draw_shifts(&idle->saccade, &idle->saccade_count, ris__pcg_start(def->seed, STREAM_SACCADE),
                     saccade_s, def->saccade_deg * 0.5642, 1, false) ||
        !draw_blinks(idle, ris__pcg_start(def->seed, STREAM_BLINK)) ||
        !draw_drift(idle, ris__pcg_start(def->seed, STREAM_DRIFT))) {
        ris__idle_destroy(idle);
        return NULL;
    }
    return idle;
}

void ris__idle_destroy(ris_idle *idle)
{
    if (idle) {
        free(idle->blink);
        free(idle->gaze);
        free(idle->saccade);
        free(idle->drift);
        free(idle);
    }
}

/* The last of the elements of stride bytes, each beginning with its time, at or before time_s; count if none. */
static uint32_t find_event(const void *first, uint32_t count, size_t stride, double time_s)
{
    uint32_t low = 0, high = count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        double start_s;
        memcpy(&start_s, (const char *)first + middle * stride, sizeof start_s);
        if (start_s <= time_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low > 0 ? low - 1 : count;
}

static double blink_at(const ris_idle *idle, double time_s)
{
    uint32_t i = find_event(idle->blink, idle->blink_count, sizeof *idle->blink, time_s);
    if (i == idle->blink_count) {
        return 0;
    }
    const ris_blink *blink = &idle->blink[i];
    double since = time_s - blink->start_s;
    if (since < blink->close_s) {
        return blink->depth * ris__ease(RIS_EASE_MINIMUM_JERK, since / blink->close_s);
    }
    double u = fmax(since - blink->close_s - RIS_BLINK_HOLD_S, 0) / blink->open_s;
    /* faster at first, slow at the end */
    return u < 1 ? blink->depth * (1 - ris__ease(RIS_EASE_MINIMUM_JERK, u * (1.5 - 0.5 * u))) : 0;
}

static void add_shift(const ris_shift *shift, uint32_t count, double time_s, double eye_deg[2])
{
    uint32_t i = find_event(shift, count, sizeof *shift, time_s);
    if (i == count) {
        return;
    }
    const ris_shift *to = &shift[i], *from = i > 0 ? to - 1 : to;
    double since = time_s - to->start_s;
    double done = since < to->duration_s ? ris__ease(RIS_EASE_MINIMUM_JERK, since / to->duration_s) : 1;
    eye_deg[0] += from->yaw_deg + (to->yaw_deg - from->yaw_deg) * done;
    eye_deg[1] += from->pitch_deg + (to->pitch_deg - from->pitch_deg) * done;
}

static void drift_at(const ris_idle *idle, double time_s, double head_deg[3])
{
    double at = time_s / RIS_IDLE_ROUND_S * idle->drift_count, whole = floor(at), u = at - whole, r = 1 - u;
    double weight[4] = {r * r * r / 6, (4 + 3 * u * u * (u - 2)) / 6, (4 + 3 * r * r * (r - 2)) / 6,
                        u * u * u / 6};
    /* a round begins and ends at rest */
    double near = fmin(time_s, RIS_IDLE_ROUND_S - time_s) / (2 * DRIFT_S);
    double in = near < 1 ? ris__ease(RIS_EASE_MINIMUM_JERK, near) : 1;
    for (uint32_t k = 0; k < 4; k++) {
        const float *value = idle->drift + (size_t)3 * (((uint32_t)whole + k) % idle->drift_count);
        for (int axis = 0; axis < 3; axis++) {
            head_deg[axis] += in * weight[k] * (double)value[axis];
        }
    }
}

/* 0 .. 1: in for BREATH_IN of the time, then out. */
static double breath_at(const ris_idle *idle, double time_s)
{
    double count = floor(RIS_IDLE_ROUND_S * idle->def.breaths_per_min / 60 + 0.5);
    double phase = time_s / RIS_IDLE_ROUND_S * count;
    phase -= floor(phase);
    return phase < BREATH_IN ? ris__ease(RIS_EASE_MINIMUM_JERK, phase / BREATH_IN)
                             : 1 - ris__ease(RIS_EASE_MINIMUM_JERK, (phase - BREATH_IN) / (1 - BREATH_IN));
}

static void add(float *pose, uint32_t first, uint32_t count, uint32_t channel, double value)
{
    if (channel != UINT32_MAX && channel >= first && channel - first < count) {
        pose[channel - first] += (float)value;
    }
}

void ris__idle_add(const ris_idle *idle, double time_s, uint32_t first, uint32_t count, float *pose)
{
    if (!(time_s >= 0)) {
        return;
    }
    time_s -= RIS_IDLE_ROUND_S * floor(time_s / RIS_IDLE_ROUND_S);
    double eye_deg[2] = {0, 0}, head_deg[3] = {0, 0, 0};
    double blink = blink_at(idle, time_s), breath = breath_at(idle, time_s) * idle->def.breath_deg;
    add_shift(idle->gaze, idle->gaze_count, time_s, eye_deg);
    add_shift(idle->saccade, idle->saccade_count, time_s, eye_deg);
    drift_at(idle, time_s, head_deg);
    head_deg[1] += breath;
    for (int side = 0; side < 2; side++) {
        add(pose, first, count, idle->lid[side], blink);
        add(pose, first, count, idle->lid[2 + side], LOWER_LID * blink);
        add(pose, first, count, idle->eye[side], eye_deg[0] - head_deg[0]);
        add(pose, first, count, idle->eye[2 + side], eye_deg[1] - head_deg[1]);
    }
    add(pose, first, count, idle->head[0], head_deg[0]);
    add(pose, first, count, idle->head[1], head_deg[1]);
    add(pose, first, count, idle->head[2], head_deg[2]);
    add(pose, first, count, idle->head[3], BREATH_MM_PER_DEG * breath);
}

void ris__idle_touch(const ris_idle *idle, bool *touches)
{
    for (int i = 0; i < 4; i++) {
        if (idle->lid[i] != UINT32_MAX) {
            touches[idle->lid[i]] = true;
        }
        if (idle->eye[i] != UINT32_MAX) {
            touches[idle->eye[i]] = true;
        }
        if (idle->head[i] != UINT32_MAX) {
            touches[idle->head[i]] = true;
        }
    }
}
