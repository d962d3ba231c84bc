/* What is done to the samples of a take before they are played (docs/performances.md): mirror, signs and zero of the head,
 * leaps of one frame, ranges, gaps. */
#include "asset/take.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A tracker's slip: a sample that lies farther from the middle of those beside it than any part of a face can speed up, while
 * they lie closer to each other than it does to them. Fastest is a lid; a way of 1 in T with the least jerk speeds up by up to
 * 5.77 / T^2 (Flash and Hogan 1985), and T is 60 ms or more. */
#define SPIKE_ACCELERATION (5.77 / (0.06 * 0.06)) /* 1/s^2, of the range */
#define SPIKE_LEAST 0.12                          /* noise is no slip */
#define SPIKE_SECONDS 0.07                        /* between the samples beside it */

static uint32_t find(const ris_take_table *table, const char *name)
{
    for (uint32_t c = 0; c < table->column_count; c++) {
        if (strcmp(table->column[c].name, name) == 0) {
            return c;
        }
    }
    return table->column_count;
}

static float *at(const ris_take_table *table, uint32_t sample, uint32_t column)
{
    return &table->value[(size_t)sample * table->column_count + column];
}

static void mirror(const ris_take_table *table)
{
    for (uint32_t c = 0; c < table->column_count; c++) {
        const ris_take_column *column = &table->column[c];
        const uint32_t other = *column->mirror ? find(table, column->mirror) : c;
        for (uint32_t i = 0; i < table->sample_count; i++) {
            if (other > c && other < table->column_count) {
                const float held = *at(table, i, c);
                *at(table, i, c) = *at(table, i, other);
                *at(table, i, other) = held;
            }
            if (column->odd) {
                *at(table, i, c) = -*at(table, i, c);
            }
        }
    }
}

static int compare_floats(const void *left, const void *right)
{
    const float a = *(const float *)left, b = *(const float *)right;
    return (a > b) - (a < b);
}

static ris_result center(const ris_take_table *table, uint32_t column)
{
    float *sorted = malloc(table->sample_count * sizeof *sorted);
    if (!sorted) {
        return RIS_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < table->sample_count; i++) {
        sorted[i] = *at(table, i, column);
    }
    qsort(sorted, table->sample_count, sizeof *sorted, compare_floats);
    const float zero = sorted[table->sample_count / 2];
    free(sorted);
    for (uint32_t i = 0; i < table->sample_count; i++) {
        *at(table, i, column) -= zero;
    }
    return RIS_OK;
}

static ris_result adjust_head(const ris_take_table *table, const ris_take_def *def)
{
    const struct {
        const char *name;
        bool flip;
    } angle[] = {{"head.yaw", def->flip_yaw}, {"head.pitch", def->flip_pitch}, {"head.roll", def->flip_roll}};
    for (size_t k = 0; k < sizeof angle / sizeof *angle; k++) {
        const uint32_t c = find(table, angle[k].name);
        if (c == table->column_count) {
            continue;
        }
        for (uint32_t i = 0; i < table->sample_count; i++) {
            const float value = *at(table, i, c);
            *at(table, i, c) = def->no_head ? 0 : angle[k].flip ? -value : value;
        }
        if (def->center && center(table, c) != RIS_OK) {
            return RIS_ERROR_MEMORY;
        }
    }
    return RIS_OK;
}

static uint32_t take_out_spikes(const ris_take_table *table, uint32_t c)
{
    const ris_take_column *column = &table->column[c];
    const double reach = (double)fmaxf(fabsf(column->minimum), fabsf(column->maximum));
    uint32_t count = 0;
    for (uint32_t i = 1; i + 1 < table->sample_count; i++) {
        const double a = (double)*at(table, i - 1, c), b = (double)*at(table, i + 1, c);
        const double off = fabs((double)*at(table, i, c) - 0.5 * (a + b));
        const double seconds = table->time_s[i + 1] - table->time_s[i - 1];
        /* half a second difference: acceleration times half the square of the step */
        const double most = fmax(SPIKE_ACCELERATION * seconds * seconds / 8, SPIKE_LEAST) * reach;
        if (seconds <= SPIKE_SECONDS && off > most && fabs(a - b) < off) {
            *at(table, i, c) = (float)(0.5 * (a + b));
            count++;
        }
    }
    return count;
}

static uint32_t clamp(const ris_take_table *table, uint32_t c)
{
    const ris_take_column *column = &table->column[c];
    uint32_t count = 0;
    for (uint32_t i = 0; i < table->sample_count; i++) {
        float *value = at(table, i, c);
        const float held = fminf(fmaxf(*value, column->minimum), column->maximum);
        count += held != *value;
        *value = held;
    }
    return count;
}

static void count_gaps(const ris_take_table *table, ris_take_info *info)
{
    const double step = info->rate_hz > 0 ? 1 / info->rate_hz : 0;
    for (uint32_t i = 1; i < table->sample_count; i++) {
        const double gap = table->time_s[i] - table->time_s[i - 1];
        if (gap > 1.5 * step) {
            info->gaps++;
            info->longest_gap_s = fmax(info->longest_gap_s, gap);
        }
    }
}

/* Frames a second of the samples themselves: the median step. */
static ris_result find_rate(const ris_take_table *table, ris_take_info *info)
{
    const uint32_t count = table->sample_count;
    float *step = malloc((count + 1) * sizeof *step);
    if (!step) {
        return RIS_ERROR_MEMORY;
    }
    for (uint32_t i = 1; i < count; i++) {
        step[i - 1] = (float)(table->time_s[i] - table->time_s[i - 1]);
    }
    if (count > 1) {
        qsort(step, count - 1, sizeof *step, compare_floats);
        info->rate_hz = floor(1000 / (double)step[(count - 1) / 2] + 0.5) / 1000;
    }
    free(step);
    return RIS_OK;
}

ris_result ris__take_clean(ris_take_table *table, const ris_take_def *def, ris_take_info *info)
{
    if (def->mirror) {
        mirror(table);
    }
    if (adjust_head(table, def) != RIS_OK || find_rate(table, info) != RIS_OK) {
        return RIS_ERROR_MEMORY;
    }
    for (uint32_t c = 0; c < table->column_count; c++) {
        if (!def->keep_spikes && !table->column[c].leaps) {
            info->spikes += take_out_spikes(table, c);
        }
        info->clamped += clamp(table, c);
        bool moves = false;
        for (uint32_t i = 0; i < table->sample_count && !moves; i++) {
            moves = *at(table, i, c) != 0;
        }
        info->columns += moves;
    }
    count_gaps(table, info);
    info->samples = table->sample_count;
    info->duration_s = table->duration_s;
    return RIS_OK;
}
