/* A recorded performance as a table: a row per sample, a column per name that the vocabulary knows. */
#pragma once

#include "asset/lines.h"
#include "risorius/head.h"
#include "risorius/take.h"

typedef struct ris_take_column {
    char name[RIS_NAME_SIZE];   /* "mouthSmileLeft", "AU12", "head.yaw" */
    char mirror[RIS_NAME_SIZE]; /* the column that changes places with it, "" = none */
    float minimum, maximum;     /* values are clamped to it */
    bool odd;                   /* changes its sign in a mirror */
    bool leaps;                 /* may leap for one frame (a bit, not a measure): spikes stay */
} ris_take_column;

typedef struct ris_take_table {
    uint32_t column_count, sample_count, capacity;
    ris_take_column *column; /* (column_count) */
    double *time_s;          /* ascending; 0 = first row of the file */
    uint32_t *line;          /* of the file */
    float *value;            /* (sample_count x column_count) */
    double duration_s;       /* to the last row of the file, whether it has a face or not */
} ris_take_table;

/* Reads a take from memory; name stands for the file in errors. *out is zeroed on failure. */
ris_result ris__take_parse(const char *name, const char *text, size_t size, const ris_take_def *def,
                           ris_take_table *out, ris_take_info *info, ris_error *err);
void ris__take_finish(ris_take_table *table);

/* Parts of ris__take_parse. */

/* Room for one more sample, zeroed; its values or NULL without memory. */
float *ris__take_add(ris_take_table *table, double time_s, uint32_t line);
ris_result ris__live_link_parse(ris_lines *lines, const ris_take_def *def, ris_take_table *out,
                                ris_take_info *info);
ris_result ris__openface_parse(ris_lines *lines, const ris_take_def *def, ris_take_table *out,
                               ris_take_info *info);
/* Mirrors, flips, centres, takes out spikes, clamps, counts gaps. */
ris_result ris__take_clean(ris_take_table *table, const ris_take_def *def, ris_take_info *info);

/* The 52 shapes in the order of ARKit's Live Link Face, camelCase. */
#define RIS__ARKIT_COUNT 52
extern const char *const ris__arkit_name[RIS__ARKIT_COUNT];

/* The next cell of the line, blanks around it left out: [l->at, *end). Steps over the comma at the following call by
 * ris__cell_done. False at the end of the line. */
bool ris__cell(const ris_lines *l, const char **end);
/* Steps behind the cell and its comma; false if it was the last of the line. */
bool ris__cell_done(ris_lines *l, const char *end);
/* The cell as a number within the range, then behind it: *last tells whether the line ends there. */
ris_result ris__cell_number(ris_lines *l, const char *what, double minimum, double maximum, double *out,
                            bool *last);
