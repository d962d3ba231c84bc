/* OpenFace CSV: timestamp, confidence, success, gaze, head pose, AUxx_r of 0 to 5 and AU28_c (docs/performances.md). */
#include "asset/take.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREES (180 / 3.14159265358979323846)
#define BIT_STRENGTH 0.6  /* of a unit that is only told to be there */
#define BIT_SECONDS 0.2   /* it comes and goes within */
#define MAX_COLUMNS 4096u /* of the file; OpenFace writes 714 */

typedef enum kind { IGNORED, TIME, CONFIDENCE, SUCCESS, FACE, GAZE, POSE, UNIT, BIT } kind;
enum { GAZE_X, GAZE_Y, POSE_X, POSE_Y, POSE_Z, NUMBER_COUNT };

typedef struct file_column {
    kind kind;
    uint32_t at; /* column of the table for units, else GAZE_X .. POSE_Z */
} file_column;

typedef struct openface {
    ris_lines *l;
    ris_take_table *table;
    ris_take_info *info;
    double least; /* confidence */
    file_column *column;
    uint32_t column_count, unit_count;
    bool has_time, has_gaze, begun;
    double first_s, last_s, face;
} openface;

/* Columns behind the units. */
static const struct beside {
    const char *name;
    float limit;
    bool odd;
} beside[] = {{"eye.yaw", 35, true},
              {"eye.pitch", 30, false},
              {"head.yaw", 80, true},
              {"head.pitch", 60, false},
              {"head.roll", 45, true}};
enum { EYE_YAW, EYE_PITCH, HEAD_YAW, HEAD_PITCH, HEAD_ROLL, BESIDE_COUNT };

static bool is(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && memcmp(text, word, length) == 0;
}

static bool begins(const char *text, size_t length, const char *word)
{
    return strlen(word) <= length && memcmp(text, word, strlen(word)) == 0;
}

/* "AU06_r" -> 6 and true for 'r'; false if it is no such name. */
static bool read_unit(const char *text, size_t length, uint32_t *out, char *out_letter)
{
    if (length != 6 || memcmp(text, "AU", 2) != 0 || text[4] != '_' || text[2] < '0' || text[2] > '9' ||
        text[3] < '0' || text[3] > '9') {
        return false;
    }
    *out = (uint32_t)(text[2] - '0') * 10u + (uint32_t)(text[3] - '0');
    *out_letter = text[5];
    return *out > 0 && (text[5] == 'r' || text[5] == 'c');
}

/* Landmarks, shape parameters and the like, which are written but not played. */
static bool is_other(const char *text, size_t length)
{
    static const char *const family[] = {"eye_lmk_", "gaze_0_", "gaze_1_", "pose_T", "p_",
                                         "x_",       "y_",      "X_",      "Y_",     "Z_"};
    for (size_t k = 0; k < sizeof family / sizeof *family; k++) {
        if (begins(text, length, family[k])) {
            return true;
        }
    }
    return is(text, length, "frame");
}

static bool classify(const char *text, size_t length, file_column *out)
{
    static const struct {
        const char *name;
        kind kind;
        uint32_t at;
    } known[] = {{"timestamp", TIME, 0},    {"confidence", CONFIDENCE, 0},  {"success", SUCCESS, 0},
                 {"face_id", FACE, 0},      {"gaze_angle_x", GAZE, GAZE_X}, {"gaze_angle_y", GAZE, GAZE_Y},
                 {"pose_Rx", POSE, POSE_X}, {"pose_Ry", POSE, POSE_Y},      {"pose_Rz", POSE, POSE_Z}};
    uint32_t unit;
    char letter;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        if (is(text, length, known[k].name)) {
            *out = (file_column){known[k].kind, known[k].at};
            return true;
        }
    }
    if (read_unit(text, length, &unit, &letter)) { /* AU28 is the one unit that has no intensity */
        *out = (file_column){letter == 'r' ? UNIT : unit == 28 ? BIT : IGNORED, unit};
        return true;
    }
    *out = (file_column){IGNORED, 0};
    return is_other(text, length);
}

static ris_result read_header(openface *r)
{
    ris_lines *l = r->l;
    const char *end;
    if (!ris__lines_next(l)) {
        return ris_fail(l->err, RIS_ERROR_DATA,
                        "%s:1:1: expected a header with timestamp, found the end of the file", l->name);
    }
    for (bool more = true; more; r->column_count++) {
        if (r->column_count % 256 == 0) {
            file_column *grown = realloc(r->column, (r->column_count + 256u) * sizeof *grown);
            if (!grown) {
                return ris_fail(l->err, RIS_ERROR_MEMORY, "%s: no memory for the columns", l->name);
            }
            r->column = grown;
        }
        ris__cell(l, &end);
        size_t length = (size_t)(end - l->at);
        while (length > 0 && l->at[length - 1] == ' ') {
            length--;
        }
        file_column *column = &r->column[r->column_count];
        if (r->column_count == MAX_COLUMNS || !classify(l->at, length, column)) {
            return ris__lines_expected(l,
                                       "a column of OpenFace (timestamp, AU01_r, gaze_angle_x, pose_Rx ...)");
        }
        for (uint32_t k = 0; k < r->column_count && column->kind != IGNORED; k++) {
            if (r->column[k].kind == column->kind && r->column[k].at == column->at) {
                return ris__lines_expected(l, "each column once");
            }
        }
        r->has_time = r->has_time || column->kind == TIME;
        r->has_gaze = r->has_gaze || column->kind == GAZE;
        r->unit_count += column->kind == UNIT || column->kind == BIT;
        more = ris__cell_done(l, end);
    }
    if (!r->has_time) {
        return ris_fail(l->err, RIS_ERROR_DATA, "%s:1:1: expected a column timestamp, found none among %u",
                        l->name, r->column_count);
    }
    return RIS_OK;
}

static ris_result make_columns(openface *r)
{
    ris_take_table *table = r->table;
    uint32_t at = 0;
    table->column_count = r->unit_count + BESIDE_COUNT;
    table->column = calloc(table->column_count, sizeof *table->column);
    if (!table->column) {
        return ris_fail(r->l->err, RIS_ERROR_MEMORY, "%s: no memory for the columns", r->l->name);
    }
    for (uint32_t k = 0; k < r->column_count; k++) {
        file_column *column = &r->column[k];
        if (column->kind == UNIT || column->kind == BIT) {
            snprintf(table->column[at].name, sizeof table->column[at].name, "AU%u", column->at);
            table->column[at].maximum = 1;
            table->column[at].leaps = column->kind == BIT;
            column->at = at++;
        }
    }
    for (uint32_t k = 0; k < BESIDE_COUNT; k++) {
        ris_take_column *column = &table->column[r->unit_count + k];
        *column =
            (ris_take_column){.minimum = -beside[k].limit, .maximum = beside[k].limit, .odd = beside[k].odd};
        strcpy(column->name, beside[k].name);
    }
    return RIS_OK;
}

/* Camera: x to the right of the picture, which is the subject's left, y down, z away. A positive turn about x lowers the nose,
 * about y turns it to the subject's right, about z tips the head to the subject's left; R = Rx Ry Rz. The direction of gaze is
 * the camera's too; the head's turn is taken from it. */
static void set_angles(const double number[NUMBER_COUNT], bool has_gaze, float *out)
{
    out[HEAD_YAW] = (float)(-number[POSE_Y] * DEGREES);
    out[HEAD_PITCH] = (float)(-number[POSE_X] * DEGREES);
    out[HEAD_ROLL] = (float)(number[POSE_Z] * DEGREES);
    if (!has_gaze) {
        return;
    }
    const double c1 = cos(number[POSE_X]), s1 = sin(number[POSE_X]), c2 = cos(number[POSE_Y]),
                 s2 = sin(number[POSE_Y]), c3 = cos(number[POSE_Z]), s3 = sin(number[POSE_Z]);
    const double rotation[3][3] = {{c2 * c3, -c2 * s3, s2},
                                   {c1 * s3 + c3 * s1 * s2, c1 * c3 - s1 * s2 * s3, -c2 * s1},
                                   {s1 * s3 - c1 * c3 * s2, c3 * s1 + c1 * s2 * s3, c1 * c2}};
    const double gaze[3] = {tan(number[GAZE_X]), tan(number[GAZE_Y]), -1};
    double own[3] = {0};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) { /* the inverse of a rotation is its transpose */
            own[i] += rotation[k][i] * gaze[k];
        }
    }
    out[EYE_YAW] = (float)(atan2(own[0], -own[2]) * DEGREES);
    out[EYE_PITCH] = (float)(atan2(-own[1], sqrt(own[0] * own[0] + own[2] * own[2])) * DEGREES);
}

typedef struct sample {
    double time_s, confidence, success, face, number[NUMBER_COUNT];
} sample;

static ris_result read_cell(openface *r, const file_column *column, sample *out, float *value, bool *last)
{
    static const char *const what[] = {"a number",
                                       "seconds",
                                       "a confidence of 0 to 1",
                                       "0 or 1",
                                       "a face_id",
                                       "an angle in radians",
                                       "an angle in radians",
                                       "an intensity of 0 to 5",
                                       "0 or 1"};
    static const double low[] = {-1e12, 0, -1, 0, 0, -1.5, -7, -1, 0},
                        high[] = {1e12, 86400, 1, 1, 1e6, 1.5, 7, 10, 1};
    double read;
    if (column->kind == IGNORED) { /* not looked at, so that other versions can be read too */
        const char *end;
        ris__cell(r->l, &end);
        *last = !ris__cell_done(r->l, end);
        return RIS_OK;
    }
    ris_result result =
        ris__cell_number(r->l, what[column->kind], low[column->kind], high[column->kind], &read, last);
    if (result != RIS_OK) {
        return result;
    }
    switch (column->kind) {
    case TIME: out->time_s = read; break;
    case CONFIDENCE: out->confidence = read; break;
    case SUCCESS: out->success = read; break;
    case FACE: out->face = read; break;
    case GAZE:
    case POSE: out->number[column->at] = read; break;
    case UNIT: value[column->at] = (float)(read / 5); break;
    default: value[column->at] = (float)(read * BIT_STRENGTH); break;
    }
    return RIS_OK;
}

static ris_result read_row(openface *r)
{
    ris_lines *l = r->l;
    sample row = {.confidence = 1, .success = 1};
    float *value = ris__take_add(r->table, 0, l->line);
    ris_result result = value ? RIS_OK
                              : ris_fail(l->err, RIS_ERROR_MEMORY, "%s:%u: no memory for %u samples", l->name,
                                         l->line, r->table->sample_count + 1);
    for (uint32_t k = 0; k < r->column_count && result == RIS_OK; k++) {
        bool last;
        result = read_cell(r, &r->column[k], &row, value, &last);
        if (result == RIS_OK && last != (k + 1 == r->column_count)) {
            return ris__lines_expected(l, last ? "a value for every column of the header"
                                               : "the end of the line after the last column");
        }
    }
    if (result != RIS_OK) {
        return result;
    }
    r->info->rows++;
    r->table->sample_count--; /* until it is known to be played */
    if (!r->begun) {
        r->face = row.face;
        r->first_s = r->last_s = row.time_s;
    }
    if (row.face != r->face) {
        r->info->other_faces++;
        return RIS_OK;
    }
    if (r->begun && row.time_s <= r->last_s + 1e-4) {
        if (row.time_s < r->last_s - 1e-4) {
            return ris_fail(l->err, RIS_ERROR_DATA,
                            "%s:%u:1: expected a timestamp after that of the row above (%g s), found %g",
                            l->name, l->line, r->last_s, row.time_s);
        }
        r->info->repeated++;
        return RIS_OK;
    }
    r->begun = true;
    r->last_s = row.time_s;
    if (row.success < 0.5 || row.confidence < r->least) {
        r->info->lost++;
        return RIS_OK;
    }
    r->table->time_s[r->table->sample_count++] = row.time_s - r->first_s;
    set_angles(row.number, r->has_gaze, value + r->unit_count);
    return RIS_OK;
}

/* Rises and falls of a bit take their time: the mean weighted by a hat of BIT_SECONDS to each side. */
static ris_result smooth_bits(openface *r)
{
    const ris_take_table *t = r->table;
    float *held = malloc((t->sample_count + 1) * sizeof *held);
    if (!held) {
        return ris_fail(r->l->err, RIS_ERROR_MEMORY, "%s: no memory for %u samples", r->l->name,
                        t->sample_count);
    }
    for (uint32_t c = 0; c < r->unit_count; c++) {
        if (!t->column[c].leaps) {
            continue;
        }
        for (uint32_t i = 0; i < t->sample_count; i++) {
            held[i] = t->value[(size_t)i * t->column_count + c];
        }
        for (uint32_t i = 0, first = 0; i < t->sample_count; i++) {
            double sum = 0, weights = 0;
            while (t->time_s[first] < t->time_s[i] - BIT_SECONDS) {
                first++;
            }
            for (uint32_t k = first; k < t->sample_count && t->time_s[k] < t->time_s[i] + BIT_SECONDS; k++) {
                const double weight = BIT_SECONDS - fabs(t->time_s[k] - t->time_s[i]);
                sum += weight * (double)held[k];
                weights += weight;
            }
            t->value[(size_t)i * t->column_count + c] = (float)(sum / weights);
        }
    }
    free(held);
    return RIS_OK;
}

ris_result ris__openface_parse(ris_lines *lines, const ris_take_def *def, ris_take_table *out,
                               ris_take_info *info)
{
    openface r = {.l = lines, .table = out, .info = info, .least = def->confidence};
    ris_result result = read_header(&r);
    if (result == RIS_OK) {
        result = make_columns(&r);
    }
    while (result == RIS_OK && ris__lines_next(lines)) {
        if (lines->start < lines->stop) {
            while (lines->at < lines->stop && *lines->at == ' ') {
                lines->at++;
            }
            result = read_row(&r);
        }
    }
    if (result == RIS_OK) {
        out->duration_s = r.last_s - r.first_s;
        result = smooth_bits(&r);
    }
    free(r.column);
    return result;
}
