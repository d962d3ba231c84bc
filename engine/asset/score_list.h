/* score.json: which sculpted units a head is measured by, and what it does for each. Format: docs/file-formats.md. */
#pragma once

#include "risorius/base.h"

#define RIS_UNIT_SIZE 128
#define RIS_RECIPE_SIZE 256
#define RIS_ARGUMENT_SIZE 512

typedef struct ris_score_unit {
    char unit[RIS_UNIT_SIZE];         /* target names joined by '+' */
    char recipe[RIS_RECIPE_SIZE];     /* a pose, or "" */
    char argument[RIS_ARGUMENT_SIZE]; /* why the unit is no muscle's work and does not count, or "" */
} ris_score_unit;

typedef struct ris_score_list {
    uint32_t count;
    ris_score_unit *unit;
} ris_score_list;

/* RIS_ERROR_DATA with file:line:col; on failure *out is zeroed. */
ris_result ris__score_list_load(const char *path, ris_score_list *out, ris_error *err);
void ris__score_list_finish(ris_score_list *list);
