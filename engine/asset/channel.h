/* Channels beside the muscles (KA-48; docs/file-formats.md). The model's channel table is the
 * muscles followed by these in this order; the head loader checks expression terms against the same names. */
#pragma once

#include "risorius/head.h"

typedef struct ris_beside_channel {
    const char *name;
    float minimum, maximum; /* file units: 0..1 or -1..1, degrees, mm; rest is 0 */
} ris_beside_channel;

extern const ris_beside_channel ris__beside_channel[];
extern const uint32_t ris__beside_channel_count;

/* Behind them: the movable centre (KA-32) of each sphincter that closes on a point, `<sphincter>.protrude` with the side at the
 * end, 0..1. False if the muscle has none; out is then "". A name that does not fit is cut off. */
bool ris__protrude_channel(const ris_muscle_def *def, char out[RIS_NAME_SIZE]);
