#include "sheet.h"
#include "risorius/output.h"

#include <stdlib.h>
#include <string.h>

#define CELL_WIDTH 400u
#define CELL_HEIGHT 440u
#define COLUMNS 4u
#define CAPACITY 64u /* poses of a ris_sheet */

/* Labels of the clip; of neighbours with the same name the last one, where the pose has had time to settle. */
static ris_result collect(ris_sheet *sheet, const ris_clip *clip, ris_error *err)
{
    uint32_t count = ris_clip_label_count(clip);
    sheet->pose = calloc(count + 1u, sizeof *sheet->pose);
    if (!sheet->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u labels", count);
    }
    for (uint32_t i = 0; i < count; i++) {
        double time_s;
        const char *label = ris_clip_label(clip, i, &time_s);
        uint32_t at = sheet->pose_count;
        if (at > 0 && strcmp(sheet->pose[at - 1].label, label) == 0) {
            at--;
        }
        if (at < CAPACITY) {
            sheet->pose[at].label = label;
            sheet->pose[at].time_s = time_s;
            sheet->pose_count = at + 1;
        }
    }
    return RIS_OK;
}

ris_result sheet_init(ris_sheet *out, const char *path, const ris_backend *backend, const ris_clip *clip,
                      const studio_look *look, ris_error *err)
{
    *out = (ris_sheet){.path = path};
    ris_result r = collect(out, clip, err);
    if (r) {
        goto fail;
    }
    if (out->pose_count == 0) {
        r = ris_fail(err, RIS_ERROR_DATA, "the clip has no key poses for a contact sheet");
        goto fail;
    }
    studio_views views;
    r = studio_views_parse("front,34", &views, err);
    if (!r) {
        r = studio_create(backend, &views, CELL_WIDTH, CELL_HEIGHT, look, &out->studio, err);
    }
    if (r) {
        goto fail;
    }
    out->columns = out->pose_count < COLUMNS ? out->pose_count : COLUMNS;
    out->width = out->columns * CELL_WIDTH;
    out->height = (out->pose_count + out->columns - 1) / out->columns * 2u * CELL_HEIGHT;
    out->rgba = malloc((size_t)out->width * out->height * 4);
    if (!out->rgba) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a contact sheet of %ux%u", out->width,
                     out->height);
        goto fail;
    }
    for (size_t i = 0; i < (size_t)out->width * out->height; i++) {
        memcpy(out->rgba + i * 4, (const uint8_t[4]){46, 48, 52, 255}, 4);
    }
    return RIS_OK;
fail:
    sheet_finish(out);
    return r;
}

void sheet_finish(ris_sheet *sheet)
{
    studio_destroy(sheet->studio);
    free(sheet->pose);
    free(sheet->rgba);
    *sheet = (struct ris_sheet){0};
}

/* Puts one picture (front and three-quarter side by side) into the cell of pose index, one above the other. */
static void place(ris_sheet *sheet, uint32_t index, const uint8_t *rgba)
{
    uint32_t x = index % sheet->columns * CELL_WIDTH, y = index / sheet->columns * 2u * CELL_HEIGHT;
    for (uint32_t view = 0; view < 2; view++) {
        for (uint32_t row = 0; row < CELL_HEIGHT; row++) {
            memcpy(sheet->rgba + ((size_t)(y + view * CELL_HEIGHT + row) * sheet->width + x) * 4,
                   rgba + ((size_t)row * 2 + view) * CELL_WIDTH * 4, (size_t)CELL_WIDTH * 4);
        }
    }
    char text[RIS_NAME_SIZE + 16];
    snprintf(text, sizeof text, "%s  %.1f s", sheet->pose[index].label, sheet->pose[index].time_s);
    ris_label_draw(sheet->rgba, sheet->width, sheet->height, (int)x + 12, (int)y + 12, 2, text);
}

ris_result sheet_take(ris_sheet *sheet, ris_player *player, double time_s, ris_error *err)
{
    ris_result r = RIS_OK;
    for (; !r && sheet->next < sheet->pose_count && sheet->pose[sheet->next].time_s <= time_s;
         sheet->next += !r) {
        double at = sheet->pose[sheet->next].time_s;
        const ris_vec4 *position, *normal;
        const uint8_t *rgba;
        r = player_advance(player, at, err);
        if (!r) {
            r = player_look(player, at, &position, &normal, err);
        }
        if (!r) {
            r = studio_shoot(sheet->studio, player->sim, position, normal, &rgba, err);
        }
        if (!r) {
            place(sheet, sheet->next, rgba);
        }
    }
    return r;
}

ris_result sheet_write(const ris_sheet *sheet, ris_error *err)
{
    return ris_png_write(sheet->path, sheet->rgba, sheet->width, sheet->height, err);
}
