/* Live Link Face CSV: Timecode, BlendShapeCount, 52 ARKit shapes, 9 angles of head and eyes (docs/performances.md). */
#include "asset/take.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHAPE_LIMIT 100.0  /* beyond what any calibration multiplies to */
#define ANGLE_LIMIT 3600.0 /* degrees */
#define PI 3.14159265358979323846
#define HALF_DAY_S 43200.0

const char *const ris__arkit_name[RIS__ARKIT_COUNT] = {"eyeBlinkLeft",
                                                       "eyeLookDownLeft",
                                                       "eyeLookInLeft",
                                                       "eyeLookOutLeft",
                                                       "eyeLookUpLeft",
                                                       "eyeSquintLeft",
                                                       "eyeWideLeft",
                                                       "eyeBlinkRight",
                                                       "eyeLookDownRight",
                                                       "eyeLookInRight",
                                                       "eyeLookOutRight",
                                                       "eyeLookUpRight",
                                                       "eyeSquintRight",
                                                       "eyeWideRight",
                                                       "jawForward",
                                                       "jawRight",
                                                       "jawLeft",
                                                       "jawOpen",
                                                       "mouthClose",
                                                       "mouthFunnel",
                                                       "mouthPucker",
                                                       "mouthRight",
                                                       "mouthLeft",
                                                       "mouthSmileLeft",
                                                       "mouthSmileRight",
                                                       "mouthFrownLeft",
                                                       "mouthFrownRight",
                                                       "mouthDimpleLeft",
                                                       "mouthDimpleRight",
                                                       "mouthStretchLeft",
                                                       "mouthStretchRight",
                                                       "mouthRollLower",
                                                       "mouthRollUpper",
                                                       "mouthShrugLower",
                                                       "mouthShrugUpper",
                                                       "mouthPressLeft",
                                                       "mouthPressRight",
                                                       "mouthLowerDownLeft",
                                                       "mouthLowerDownRight",
                                                       "mouthUpperUpLeft",
                                                       "mouthUpperUpRight",
                                                       "browDownLeft",
                                                       "browDownRight",
                                                       "browInnerUp",
                                                       "browOuterUpLeft",
                                                       "browOuterUpRight",
                                                       "cheekPuff",
                                                       "cheekSquintLeft",
                                                       "cheekSquintRight",
                                                       "noseSneerLeft",
                                                       "noseSneerRight",
                                                       "tongueOut"};

/* The angles: how the file calls them, the channel, what one degree of theirs is in its sense (yaw to the subject's left, pitch
 * up, roll to the left shoulder). The head's signs are those of most writers and readers, see the docs. */
static const struct angle {
    const char *name, *channel, *mirror;
    float factor, limit;
    bool odd;
} angle[] = {
    {"headYaw", "head.yaw", "", 1, 80, true},
    {"headPitch", "head.pitch", "", 1, 60, false},
    {"headRoll", "head.roll", "", -1, 45, true},
    {"leftEyeYaw", "eye.yaw.L", "eye.yaw.R", 1, 35, true},
    {"rightEyeYaw", "eye.yaw.R", "eye.yaw.L", 1, 35, true},
    {"leftEyePitch", "eye.pitch.L", "eye.pitch.R", -1, 30, false},
    {"rightEyePitch", "eye.pitch.R", "eye.pitch.L", -1, 30, false},
    {"leftEyeRoll", "", "", 0, 0, false}, /* an eye of ours does not roll */
    {"rightEyeRoll", "", "", 0, 0, false},
};
#define ANGLE_COUNT (sizeof angle / sizeof *angle)
#define PLAYED_ANGLES 7u
#define FIRST_EYE_ANGLE 3u
#define MAX_FILE_COLUMNS 128

/* What a column of the file is. */
typedef struct file_column {
    uint32_t column; /* of the table; angles that are not played lie behind its columns */
    float factor;
    bool is_angle;
    char half; /* 'L' or 'R' of a shape of the middle that is split, else 0 */
} file_column;

typedef struct live_link {
    ris_lines *l;
    ris_take_table *table;
    ris_take_info *info;
    file_column column[MAX_FILE_COLUMNS];
    uint32_t column_count; /* behind Timecode and count */
    double *frame; /* FF.fff of each sample; table->time_s holds the whole seconds until the rate is known */
    double last_frame, last_second;
    double first_second, first_frame; /* of the first row, with a face or without */
    double day_s;                     /* added since midnight was passed */
    uint32_t capacity;
    bool begun;
} live_link;

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), m = strlen(end);
    return n > m && strcmp(text + n - m, end) == 0;
}

/* "EyeBlinkLeft", "eyeBlink_L" -> "eyeBlinkLeft" */
static void to_camel_case(const char *text, size_t length, char out[RIS_NAME_SIZE])
{
    length = length < RIS_NAME_SIZE - 8 ? length : RIS_NAME_SIZE - 8;
    memcpy(out, text, length);
    out[length] = 0;
    if (out[0] >= 'A' && out[0] <= 'Z') {
        out[0] = (char)(out[0] - 'A' + 'a');
    }
    if (ends_with(out, "_L") || ends_with(out, "_R")) {
        strcpy(out + length - 2, out[length - 1] == 'L' ? "Left" : "Right");
    }
}

static bool find_shape(const char *name, file_column *out)
{
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        if (strcmp(ris__arkit_name[k], name) == 0) {
            *out = (file_column){.column = k, .factor = 1};
            return true;
        }
        /* some rigs split the two shapes of the middle: half of each side */
        const bool split =
            strcmp(ris__arkit_name[k], "browInnerUp") == 0 || strcmp(ris__arkit_name[k], "cheekPuff") == 0;
        const size_t length = strlen(ris__arkit_name[k]);
        if (split && strncmp(ris__arkit_name[k], name, length) == 0 &&
            (strcmp(name + length, "Left") == 0 || strcmp(name + length, "Right") == 0)) {
            *out = (file_column){.column = k, .factor = 0.5f, .half = name[length]};
            return true;
        }
    }
    for (uint32_t k = 0; k < ANGLE_COUNT; k++) {
        if (strcmp(angle[k].name, name) == 0) {
            *out = (file_column){.column = RIS__ARKIT_COUNT + k, .factor = angle[k].factor, .is_angle = true};
            return true;
        }
    }
    return false;
}

static ris_result unknown_column(const ris_lines *l, const char *end, const char *name)
{
    ris_nearest nearest;
    char list[256];
    ris__nearest_init(&nearest, name);
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        ris__nearest_add(&nearest, ris__arkit_name[k]);
    }
    for (uint32_t k = 0; k < ANGLE_COUNT; k++) {
        ris__nearest_add(&nearest, angle[k].name);
    }
    const int length = (int)(end - l->at < 40 ? end - l->at : 40);
    return ris_fail(l->err, RIS_ERROR_DATA,
                    "%s:%u:%d: expected an ARKit shape or an angle of head or eyes, found \"%.*s\"; nearest: "
                    "%s",
                    l->name, l->line, (int)(l->at - l->start) + 1, length, l->at,
                    ris__nearest_text(&nearest, list, sizeof list));
}

static bool cell_is(const char *text, const char *end, const char *word)
{
    return (size_t)(end - text) == strlen(word) && memcmp(text, word, (size_t)(end - text)) == 0;
}

static ris_result read_header(live_link *r)
{
    ris_lines *l = r->l;
    const char *end;
    char name[RIS_NAME_SIZE];
    if (!ris__lines_next(l)) {
        return ris_fail(l->err, RIS_ERROR_DATA,
                        "%s:1:1: expected a header that begins with Timecode, found "
                        "the end of the file",
                        l->name);
    }
    if (!ris__cell(l, &end) || !cell_is(l->at, end, "Timecode") || !ris__cell_done(l, end)) {
        return ris__lines_expected(l, "a header that begins with Timecode");
    }
    ris__cell(l, &end);
    if ((!cell_is(l->at, end, "BlendShapeCount") && !cell_is(l->at, end, "BlendshapeCount")) ||
        !ris__cell_done(l, end)) {
        return ris__lines_expected(l, "BlendShapeCount and the shapes");
    }
    for (bool more = true; more; r->column_count++) {
        if (r->column_count == MAX_FILE_COLUMNS) {
            return ris__lines_expected(l, "at most 128 columns of values");
        }
        ris__cell(l, &end);
        file_column *column = &r->column[r->column_count];
        to_camel_case(l->at, (size_t)(end - l->at), name);
        if (!find_shape(name, column)) {
            return unknown_column(l, end, name);
        }
        for (uint32_t k = 0; k < r->column_count; k++) {
            const bool halves = column->half && r->column[k].half && column->half != r->column[k].half;
            if (r->column[k].column == column->column && !halves) {
                return ris__lines_expected(l, "each shape once");
            }
        }
        more = ris__cell_done(l, end);
    }
    return RIS_OK;
}

static ris_result make_columns(live_link *r)
{
    ris_take_table *table = r->table;
    table->column_count = RIS__ARKIT_COUNT + PLAYED_ANGLES;
    table->column = calloc(table->column_count, sizeof *table->column);
    if (!table->column) {
        return ris_fail(r->l->err, RIS_ERROR_MEMORY, "%s: no memory for the columns", r->l->name);
    }
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        ris_take_column *column = &table->column[k];
        const char *name = ris__arkit_name[k];
        const int stem = (int)strlen(name) - (ends_with(name, "Left") ? 4 : ends_with(name, "Right") ? 5 : 0);
        column->maximum = 1;
        strcpy(column->name, name);
        if ((size_t)stem < strlen(name)) {
            snprintf(column->mirror, sizeof column->mirror, "%.*s%s", stem, name,
                     ends_with(name, "Left") ? "Right" : "Left");
        }
    }
    for (uint32_t k = 0; k < PLAYED_ANGLES; k++) {
        ris_take_column *column = &table->column[RIS__ARKIT_COUNT + k];
        column->minimum = -angle[k].limit;
        column->maximum = angle[k].limit;
        column->odd = angle[k].odd;
        strcpy(column->name, angle[k].channel);
        strcpy(column->mirror, angle[k].mirror);
    }
    return RIS_OK;
}

/* HH:MM:SS:FF.fff, a semicolon before the frames too (drop frame). */
static ris_result read_timecode(live_link *r, double *out_second, double *out_frame)
{
    ris_lines *l = r->l;
    const char *end, *at = l->at;
    int64_t part[3] = {0};
    ris__cell(l, &end);
    for (int k = 0; k < 3; k++) {
        const char *after = ris__parse_integer(at, end, &part[k]);
        if (!after || after >= end || (*after != ':' && !(k == 2 && *after == ';')) || part[k] < 0 ||
            part[k] >= (k ? 60 : 1000)) {
            return ris__lines_expected(l, "a timecode HH:MM:SS:FF.fff");
        }
        at = after + 1;
    }
    if (ris__parse_number(at, end, out_frame) != end || !(*out_frame >= 0 && *out_frame < 1000)) {
        return ris__lines_expected(l, "a timecode HH:MM:SS:FF.fff");
    }
    *out_second = (double)((part[0] * 60 + part[1]) * 60 + part[2]);
    return RIS_OK;
}

static ris_result add_sample(live_link *r, double second, double frame, float **out)
{
    ris_take_table *table = r->table;
    *out = ris__take_add(table, second, r->l->line);
    if (*out && table->capacity > r->capacity) {
        double *grown = realloc(r->frame, table->capacity * sizeof *grown);
        if (!grown) {
            *out = NULL;
        } else {
            r->frame = grown;
            r->capacity = table->capacity;
        }
    }
    if (!*out) {
        return ris_fail(r->l->err, RIS_ERROR_MEMORY, "%s:%u: no memory for %u samples", r->l->name,
                        r->l->line, table->sample_count + 1);
    }
    r->frame[table->sample_count - 1] = frame;
    return RIS_OK;
}

static ris_result read_values(live_link *r, double second, double frame)
{
    ris_lines *l = r->l;
    float *value;
    ris_result result = add_sample(r, second, frame, &value);
    for (uint32_t k = 0; k < r->column_count && result == RIS_OK; k++) {
        const file_column *column = &r->column[k];
        const double limit = column->is_angle ? ANGLE_LIMIT : SHAPE_LIMIT;
        double read;
        bool last;
        result = ris__cell_number(l, column->is_angle ? "an angle" : "a value of 0 to 1", -limit, limit,
                                  &read, &last);
        if (result == RIS_OK && last != (k + 1 == r->column_count)) {
            return ris__lines_expected(l, last ? "a value for every column of the header"
                                               : "the end of the line after the last column");
        }
        if (result == RIS_OK && column->column < r->table->column_count) {
            value[column->column] += (float)read * column->factor;
        }
    }
    return result;
}

static ris_result read_row(live_link *r)
{
    ris_lines *l = r->l;
    double second = 0, frame = 0, count;
    bool last;
    const char *end;
    ris_result result = read_timecode(r, &second, &frame);
    if (result != RIS_OK) {
        return result;
    }
    second += r->day_s;
    if (r->begun && second < r->last_second - HALF_DAY_S) { /* past midnight */
        second += 2 * HALF_DAY_S;
        r->day_s += 2 * HALF_DAY_S;
    }
    if (r->begun && (second < r->last_second || (second == r->last_second && frame < r->last_frame - 1))) {
        return ris__lines_expected(l, "a timecode after that of the row above");
    }
    const bool repeated = r->begun && second == r->last_second && frame < r->last_frame + 1e-3;
    if (!r->begun) {
        r->first_second = second;
        r->first_frame = frame;
    }
    ris__cell(l, &end);
    if (!ris__cell_done(l, end)) {
        return ris__lines_expected(l, "the number of shapes behind the timecode");
    }
    result = ris__cell_number(l, "the number of shapes, or 0 without a face", 0, 1000, &count, &last);
    if (result != RIS_OK) {
        return result;
    }
    r->info->rows++;
    r->begun = true;
    if (repeated) {
        r->info->repeated++;
        return RIS_OK;
    }
    r->last_second = second;
    r->last_frame = frame;
    if (count == 0) { /* the app had no face: the cells behind are 0 or missing */
        r->info->lost++;
        return RIS_OK;
    }
    return last ? ris__lines_expected(l, "a value for every column of the header")
                : read_values(r, second, frame);
}

static int compare_doubles(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static double median(double *value, uint32_t count)
{
    qsort(value, count, sizeof *value, compare_doubles);
    return count ? value[count / 2] : 0;
}

/* Frames a second of the timecode. Where the seconds go on by one, frames fall from a to b: rate + b - a is the usual step. */
static ris_result find_rate(live_link *r, double *out)
{
    static const double common[] = {24, 25, 30, 48, 50, 60, 72, 90, 96, 100, 120, 240, 1000};
    const ris_take_table *table = r->table;
    const uint32_t count = table->sample_count;
    double *step = malloc((count + 1) * sizeof *step), *fall = malloc((count + 1) * sizeof *fall), most = 0;
    uint32_t steps = 0, falls = 0;
    if (!step || !fall) {
        free(step);
        free(fall);
        return ris_fail(r->l->err, RIS_ERROR_MEMORY, "%s: no memory for %u samples", r->l->name, count);
    }
    for (uint32_t i = 0; i < count; i++) {
        most = fmax(most, r->frame[i]);
        if (i > 0 && table->time_s[i] == table->time_s[i - 1]) {
            step[steps++] = r->frame[i] - r->frame[i - 1];
        } else if (i > 0 && table->time_s[i] == table->time_s[i - 1] + 1) {
            fall[falls++] = r->frame[i - 1] - r->frame[i];
        }
    }
    const double wanted = falls && steps ? median(step, steps) + median(fall, falls) : 60;
    double best = common[sizeof common / sizeof *common - 1];
    for (size_t k = sizeof common / sizeof *common; k-- > 0;) {
        if (common[k] > floor(most) && fabs(common[k] - wanted) <= fabs(best - wanted)) {
            best = common[k];
        }
    }
    free(step);
    free(fall);
    *out = best;
    return RIS_OK;
}

/* Whole seconds and frames become seconds from the first row. */
static ris_result set_times(live_link *r, double rate_hz)
{
    ris_take_table *table = r->table;
    ris_result result = rate_hz > 0 ? RIS_OK : find_rate(r, &rate_hz);
    for (uint32_t i = 0; i < table->sample_count && result == RIS_OK; i++) {
        table->time_s[i] = (table->time_s[i] - r->first_second) + (r->frame[i] - r->first_frame) / rate_hz;
        if (table->time_s[i] < 0 || (i > 0 && !(table->time_s[i] > table->time_s[i - 1] + 1e-6))) {
            return ris_fail(r->l->err, RIS_ERROR_DATA,
                            "%s:%u:1: expected a timecode that advances at %g frames a second (--adjust "
                            "rate=HZ sets another), found one that does not",
                            r->l->name, table->line[i], rate_hz);
        }
    }
    table->duration_s = (r->last_second - r->first_second) + (r->last_frame - r->first_frame) / rate_hz;
    return result;
}

/* Angles to degrees, and eyes by shapes or by angles, never both. */
static void set_angles(const live_link *r, bool degrees)
{
    const ris_take_table *table = r->table;
    float most = 0;
    bool looks = false;
    for (uint32_t i = 0; i < table->sample_count; i++) {
        const float *value = table->value + (size_t)i * table->column_count;
        for (uint32_t c = 0; c < table->column_count; c++) {
            most = c >= RIS__ARKIT_COUNT ? fmaxf(most, fabsf(value[c])) : most;
            looks = looks || (value[c] != 0 && strncmp(table->column[c].name, "eyeLook", 7) == 0);
        }
    }
    degrees = degrees || (double)most > PI;
    for (uint32_t i = 0; i < table->sample_count; i++) {
        float *value = table->value + (size_t)i * table->column_count + RIS__ARKIT_COUNT;
        for (uint32_t k = 0; k < PLAYED_ANGLES; k++) {
            value[k] = degrees ? value[k] : (float)((double)value[k] * (180 / PI));
            value[k] = looks && k >= FIRST_EYE_ANGLE ? 0 : value[k];
        }
    }
    r->info->degrees = degrees;
}

ris_result ris__live_link_parse(ris_lines *lines, const ris_take_def *def, ris_take_table *out,
                                ris_take_info *info)
{
    live_link r = {.l = lines, .table = out, .info = info};
    ris_result result = read_header(&r);
    if (result == RIS_OK) {
        result = make_columns(&r);
    }
    while (result == RIS_OK && ris__lines_next(lines)) {
        if (lines->start < lines->stop) {
            result = read_row(&r);
        }
    }
    if (result == RIS_OK && out->sample_count) {
        result = set_times(&r, def->rate_hz);
    }
    if (result == RIS_OK) {
        set_angles(&r, def->degrees);
    }
    free(r.frame);
    return result;
}
