/* Looks at PNG files. */
#pragma once

#include "risorius/base.h"

typedef struct picture {
    int width, height;
    uint8_t *rgba; /* (width x height x 4), free with picture_finish */
} picture;

/* Fails the test if the file is not a picture. */
void picture_load(const char *path, picture *out);
void picture_finish(picture *image);
/* Pixels that differ clearly from the pixel in the top left corner. */
uint32_t picture_foreground(const picture *image);
/* A picture without a face in it: nearly all one colour. */
bool picture_is_blank(const picture *image);
