/* A contact sheet: the key poses of a clip, each from the front and in three-quarter view, with their names. */
#pragma once

#include "player.h"
#include "studio.h"

typedef struct ris_sheet {
    const char *path;
    ris_studio *studio;
    uint32_t pose_count, next; /* next pose to take */
    struct {
        const char *label; /* owned by the clip */
        double time_s;
    } * pose;
    uint32_t columns, width, height; /* poses per row; size in pixels */
    uint8_t *rgba;
} ris_sheet;

/* Collects the labels of the clip, of a run of the same label the last. */
ris_result sheet_init(ris_sheet *out, const char *path, const ris_backend *backend, const ris_clip *clip,
                      const studio_look *look, ris_error *err);
void sheet_finish(ris_sheet *sheet);
/* Takes the poses up to time_s, moving the player there. */
ris_result sheet_take(ris_sheet *sheet, ris_player *player, double time_s, ris_error *err);
ris_result sheet_write(const ris_sheet *sheet, ris_error *err);
