/* Rims of the openings of the skin: what light passes on its way to teeth, tongue and eyes. */
#pragma once

#include "risorius/head.h"

#include "draw_shared.h"

/* Skin vertices around mouth and lids, from the subject's left end over the others back to it, each rim the same way round;
 * all 0 where the head has no such region. RIS_ERROR_MEMORY. */
ris_result ris__draw_openings(const ris_head *head, uint32_t rim[RIS_DRAW_RIM_COUNT][RIS_DRAW_RIM],
                              ris_error *err);
