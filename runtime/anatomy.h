/* What a picture of the muscles shows, for its labels: which are seen, how much of them, and where to point. */
#pragma once

#include "labels.h"
#include "risorius/draw.h"

/* One muscle in one picture. */
typedef struct muscle_sight {
    uint32_t seen_px, whole_px; /* pixels it is seen at, and would be if nothing lay over it */
    float x, y;                 /* a point well inside what is seen (of the whole if nothing is), in pixels */
} muscle_sight;

/* Looks at the muscles of draw as they are shown (muscle_count). With cover: also what they would show alone, and who
 * covers whom: cover[a * muscle_count + b] = pixels of a that b lies over (muscle_count^2), or NULL for the seen ones
 * alone. With cover, which muscles are shown is left changed: ris_draw_set_muscles again. */
ris_result anatomy_look(ris_draw *draw, const ris_sim *sim, const ris_camera *camera, uint32_t width,
                        uint32_t height, muscle_sight *sight, uint32_t *cover, ris_error *err);

/* "zygomaticus_major.L" -> "Zygomaticus major". out (LABEL_TEXT_SIZE) */
void anatomy_title(const char *name, char *out);
/* '\0' for a muscle of both sides, else 'L' or 'R'. */
char anatomy_side(const char *name);

/* One label for each muscle name that is seen at least_px or more; of a pair the one that is seen more. out
 * (muscle_count). */
ris_result anatomy_labels(const ris_model *model, const muscle_sight *sight, uint32_t least_px,
                          ris_label *out, uint32_t *out_count, ris_error *err);
