/* Names at the margins of a picture, with leader lines that neither overlap nor cross. */
#pragma once

#include "risorius/base.h"

#define LABEL_TEXT_SIZE 72

typedef enum label_side { LABEL_LEFT, LABEL_RIGHT, LABEL_EITHER } label_side;

typedef struct ris_label {
    char text[LABEL_TEXT_SIZE];
    float x, y; /* what is named, pixels */
    label_side side;
    float text_y; /* middle of the text: out of labels_place */
} ris_label;

/* Chooses sides for those that may be at either, sorts by side and height, and spreads the texts so that their middles
 * are at least gap apart within 0 .. height. false when there is no room for all. */
bool labels_place(ris_label *label, uint32_t count, float width, float height, float gap);
/* Places and draws, with the texts as near to the columns left and right as the picture's edges allow. scale:
 * pixels per font unit. */
void labels_draw(uint8_t *rgba, uint32_t width, uint32_t height, ris_label *label, uint32_t count,
                 const float column[2], float scale, const uint8_t ink[3]);
/* A line of about one pixel per scale unit, and a dot. */
void labels_line(uint8_t *rgba, uint32_t width, uint32_t height, const float from[2], const float to[2],
                 float thickness, const uint8_t ink[3]);
