/* Labels on pictures: stb_easy_font rasterised into an image, white with a dark edge. */
#include "risorius/output.h"

#include <stdlib.h>
#include <string.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

#define LABEL_MAX 512 /* characters drawn; the rest is dropped */

typedef struct quad_vertex {
    float x, y, z;
    uint8_t color[4];
} quad_vertex;

static void fill(uint8_t *rgba, uint32_t width, uint32_t height, int x0, int y0, int x1, int y1, uint8_t grey)
{
    x0 = x0 < 0 ? 0 : x0;
    y0 = y0 < 0 ? 0 : y0;
    x1 = x1 > (int)width ? (int)width : x1;
    y1 = y1 > (int)height ? (int)height : y1;
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            uint8_t *at = rgba + 4 * ((size_t)y * width + (size_t)x);
            at[0] = at[1] = at[2] = grey;
            at[3] = 255;
        }
    }
}

/* The font has ASCII only. line (LABEL_MAX + 1). */
static void clean(const char *text, char *line)
{
    size_t length = 0;
    for (; text[length] != '\0' && length < LABEL_MAX; length++) {
        char c = text[length];
        line[length] = (c >= 32 && c <= 126) || c == '\n' ? c : '?';
    }
    line[length] = '\0';
}

/* Blends ink over the pixels a rectangle covers, by the covered share. */
static void cover(uint8_t *rgba, uint32_t width, uint32_t height, const float box[4], const uint8_t ink[3])
{
    int x0 = (int)(box[0] < 0 ? 0 : box[0]), y0 = (int)(box[1] < 0 ? 0 : box[1]);
    for (int y = y0; y < (int)height && (float)y < box[3]; y++) {
        float top = box[1] > (float)y ? box[1] : (float)y,
              bottom = box[3] < (float)(y + 1) ? box[3] : (float)(y + 1);
        for (int x = x0; x < (int)width && (float)x < box[2]; x++) {
            float left = box[0] > (float)x ? box[0] : (float)x,
                  right = box[2] < (float)(x + 1) ? box[2] : (float)(x + 1),
                  share = (right - left) * (bottom - top);
            uint8_t *at = rgba + 4 * ((size_t)y * width + (size_t)x);
            for (int c = 0; c < 3 && share > 0; c++) {
                at[c] = (uint8_t)((float)at[c] + share * ((float)ink[c] - (float)at[c]) + 0.5f);
            }
        }
    }
}

float ris_label_width(float scale, const char *text)
{
    char line[LABEL_MAX + 1];
    clean(text, line);
    return (float)stb_easy_font_width(line) * scale;
}

void ris_label_ink(uint8_t *rgba, uint32_t width, uint32_t height, float x, float y, float scale,
                   const uint8_t ink[3], const char *text)
{
    char line[LABEL_MAX + 1];
    static const size_t room = (size_t)LABEL_MAX * 16 * 4 * sizeof(quad_vertex);
    clean(text, line);
    quad_vertex *quad = scale > 0 ? malloc(room) : NULL;
    if (quad == NULL) {
        return; /* a picture without its label is still right */
    }
    int count = stb_easy_font_print(0.0f, 0.0f, line, NULL, quad, (int)room);
    for (int q = 0; q < count; q++) {
        const float box[4] = {x + quad[4 * q].x * scale, y + quad[4 * q].y * scale,
                              x + quad[4 * q + 2].x * scale, y + quad[4 * q + 2].y * scale};
        cover(rgba, width, height, box, ink);
    }
    free(quad);
}

void ris_label_draw(uint8_t *rgba, uint32_t width, uint32_t height, int x, int y, int scale, const char *text)
{
    char line[LABEL_MAX + 1];
    static const size_t room = (size_t)LABEL_MAX * 16; /* the widest glyphs have fewer than 16 strokes */
    clean(text, line);
    quad_vertex *quad = malloc(room * 4 * sizeof *quad);
    if (quad == NULL || scale < 1) {
        free(quad);
        return; /* a picture without its label is still right */
    }
    int count = stb_easy_font_print(0.0f, 0.0f, line, NULL, quad, (int)(room * 4 * sizeof *quad));
    int edge = (scale + 1) / 2;
    for (int pass = 0; pass < 2; pass++) {
        for (int q = 0; q < count; q++) {
            int grow = pass == 0 ? edge : 0;
            int x0 = x + (int)quad[4 * q].x * scale, y0 = y + (int)quad[4 * q].y * scale;
            int x1 = x + (int)quad[4 * q + 2].x * scale, y1 = y + (int)quad[4 * q + 2].y * scale;
            fill(rgba, width, height, x0 - grow, y0 - grow, x1 + grow, y1 + grow, pass == 0 ? 24 : 255);
        }
    }
    free(quad);
}
