#include "labels.h"

#include "risorius/output.h"

#include <math.h>
#include <stdlib.h>

#define CAPITAL 7.0f /* font units */
#define GAP 12.5f    /* font units from line to line */

static int by_place(const void *a, const void *b)
{
    const ris_label *p = a, *q = b;
    if (p->side != q->side) {
        return p->side < q->side ? -1 : 1;
    }
    return p->y < q->y ? -1 : p->y > q->y;
}

static int by_height(const void *a, const void *b)
{
    const ris_label *p = a, *q = b;
    return p->y < q->y ? -1 : p->y > q->y;
}

/* Down the picture, each to the side with fewer names so far, unless it lies clearly on the other half. */
static void choose_sides(ris_label *label, uint32_t count, float width)
{
    uint32_t used[2] = {0};
    qsort(label, count, sizeof *label, by_height);
    for (uint32_t i = 0; i < count; i++) {
        if (label[i].side != LABEL_EITHER) {
            used[label[i].side]++;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (label[i].side == LABEL_EITHER) {
            float lean =
                (label[i].x / width - 0.5f) * 16.0f; /* names of difference that half a picture is worth */
            label[i].side =
                (float)used[LABEL_RIGHT] - (float)used[LABEL_LEFT] < lean ? LABEL_RIGHT : LABEL_LEFT;
            used[label[i].side]++;
        }
    }
}

/* Least moved places with at least gap between them (pool adjacent violators: blocks that push each other move to their
 * common mean), then kept within the picture. */
static bool spread(ris_label *label, uint32_t count, float height, float gap)
{
    for (uint32_t end = 1; end <= count; end++) { /* label[end - 1] joins those above it */
        uint32_t first = end - 1;
        label[first].text_y = label[first].y;
        while (first > 0 && label[first].text_y < label[first - 1].text_y + gap) {
            float sum = 0;
            first--;
            while (first > 0 && label[first].text_y < label[first - 1].text_y + 1.01f * gap) {
                first--;
            }
            for (uint32_t k = first; k < end; k++) {
                sum += label[k].y - (float)(k - first) * gap;
            }
            for (uint32_t k = first; k < end; k++) {
                label[k].text_y = sum / (float)(end - first) + (float)(k - first) * gap;
            }
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        float low = i ? label[i - 1].text_y + gap : 0.5f * gap;
        label[i].text_y = label[i].text_y < low ? low : label[i].text_y;
    }
    for (uint32_t i = count; i-- > 0;) {
        float high = i + 1 < count ? label[i + 1].text_y - gap : height - 0.5f * gap;
        label[i].text_y = label[i].text_y > high ? high : label[i].text_y;
    }
    return count == 0 || label[0].text_y >= 0.5f * gap - 0.01f;
}

static float turn(float ax, float ay, float bx, float by, float cx, float cy)
{
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

/* Leaders from (edge, text_y) to their points: neighbours that cross change places. */
static void uncross(ris_label *label, uint32_t count, float edge)
{
    for (uint32_t pass = 0; pass < count; pass++) {
        bool swapped = false;
        for (uint32_t i = 0; i + 1 < count; i++) {
            ris_label *a = &label[i], *b = &label[i + 1];
            bool cross = turn(edge, a->text_y, a->x, a->y, b->x, b->y) *
                                 turn(edge, a->text_y, a->x, a->y, edge, b->text_y) <
                             0 &&
                         turn(edge, b->text_y, b->x, b->y, a->x, a->y) *
                                 turn(edge, b->text_y, b->x, b->y, edge, a->text_y) <
                             0;
            if (cross) {
                ris_label other = *a;
                float upper = a->text_y, lower = b->text_y;
                *a = *b;
                *b = other;
                a->text_y = upper;
                b->text_y = lower;
                swapped = true;
            }
        }
        if (!swapped) {
            return;
        }
    }
}

bool labels_place(ris_label *label, uint32_t count, float width, float height, float gap)
{
    choose_sides(label, count, width);
    qsort(label, count, sizeof *label, by_place);
    uint32_t left = 0;
    while (left < count && label[left].side == LABEL_LEFT) {
        left++;
    }
    bool fits = spread(label, left, height, gap);
    fits = spread(label + left, count - left, height, gap) && fits;
    uncross(label, left, 0.16f * width);
    uncross(label + left, count - left, 0.84f * width);
    return fits;
}

void labels_line(uint8_t *rgba, uint32_t width, uint32_t height, const float from[2], const float to[2],
                 float thickness, const uint8_t ink[3])
{
    float dx = to[0] - from[0], dy = to[1] - from[1], length2 = dx * dx + dy * dy,
          reach = 0.5f * thickness + 1.0f;
    int x0 = (int)floorf(fminf(from[0], to[0]) - reach), x1 = (int)ceilf(fmaxf(from[0], to[0]) + reach);
    int y0 = (int)floorf(fminf(from[1], to[1]) - reach), y1 = (int)ceilf(fmaxf(from[1], to[1]) + reach);
    for (int y = y0 < 0 ? 0 : y0; y < y1 && y < (int)height; y++) {
        for (int x = x0 < 0 ? 0 : x0; x < x1 && x < (int)width; x++) {
            float px = (float)x + 0.5f - from[0], py = (float)y + 0.5f - from[1];
            float t = length2 > 0 ? fminf(fmaxf((px * dx + py * dy) / length2, 0), 1) : 0;
            float share = 0.5f * thickness + 0.5f - hypotf(px - t * dx, py - t * dy);
            share = fminf(fmaxf(share, 0), 1);
            uint8_t *at = rgba + 4 * ((size_t)y * width + (size_t)x);
            for (int c = 0; c < 3; c++) {
                at[c] = (uint8_t)((float)at[c] + share * ((float)ink[c] - (float)at[c]) + 0.5f);
            }
        }
    }
}

void labels_draw(uint8_t *rgba, uint32_t width, uint32_t height, ris_label *label, uint32_t count,
                 const float column[2], float scale, const uint8_t ink[3])
{
    const float margin = 4.0f * scale;
    float widest[2] = {0, 0};
    labels_place(label, count, (float)width, (float)height, GAP * scale);
    for (uint32_t i = 0; i < count; i++) {
        float own = ris_label_width(scale, label[i].text);
        widest[label[i].side] = fmaxf(widest[label[i].side], own);
    }
    for (uint32_t i = 0; i < count; i++) {
        bool left = label[i].side == LABEL_LEFT;
        float own = ris_label_width(scale, label[i].text);
        float edge = left ? fmaxf(margin + widest[LABEL_LEFT], column[0])
                          : fminf((float)width - margin - widest[LABEL_RIGHT], column[1]);
        float sign = left ? 1.0f : -1.0f;
        const float knee[2] = {edge + sign * 10.0f * scale, label[i].text_y},
                    start[2] = {edge + sign * 3.0f * scale, label[i].text_y},
                    end[2] = {label[i].x, label[i].y};
        labels_line(rgba, width, height, start, knee, 0.55f * scale, ink);
        labels_line(rgba, width, height, knee, end, 0.55f * scale, ink);
        labels_line(rgba, width, height, end, end, 2.6f * scale, ink);
        ris_label_ink(rgba, width, height, left ? edge - own : edge,
                      label[i].text_y - 0.55f * CAPITAL * scale, scale, ink, label[i].text);
    }
}
