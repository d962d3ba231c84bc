/* The poses of `risorius soak`: the same on every machine, each known by seed, kind and number alone. They are made as
 * text, so that what is held is to the bit what `--pose` makes of the printed words. */
#pragma once

#include "base/pcg.h"
#include "risorius/model.h"

typedef enum ris_soak_kind {
    RIS_SOAK_FEW,   /* 1 to 6 channels, none of head.* */
    RIS_SOAK_ALL,   /* every channel but head.* */
    RIS_SOAK_SINGLE /* one channel at one end of its range; number = 0 .. ris__soak_single_count - 1 */
} ris_soak_kind;

typedef struct ris_soak_id {
    ris_soak_kind kind;
    uint32_t number;
} ris_soak_id;

/* "few", "all", "single" */
const char *ris__soak_kind_name(ris_soak_kind kind);
/* Ends of ranges that are not rest, of every channel. */
uint32_t ris__soak_single_count(const ris_model *model);
/* "name=value,..." with values of thousandths of the channel's range; malloced, the caller frees; NULL without memory
 * or channels. */
char *ris__soak_pose_text(const ris_model *model, uint64_t seed, ris_soak_id id);
