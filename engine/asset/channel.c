/* KA-48: channels beside the muscles. */
#include "asset/channel.h"

#include "asset/names.h"

#include <stdio.h>
#include <string.h>

const ris_beside_channel ris__beside_channel[] = {
    {"jaw.open", 0, 1},        {"jaw.forward", -1, 1},   {"jaw.side", -1, 1},      {"eye.yaw.L", -35, 35},
    {"eye.yaw.R", -35, 35},    {"eye.pitch.L", -30, 30}, {"eye.pitch.R", -30, 30}, {"head.yaw", -80, 80},
    {"head.pitch", -60, 60},   {"head.roll", -45, 45},   {"head.x", -200, 200},    {"head.y", -200, 200},
    {"head.z", -200, 200},     {"lid.upper.L", -1, 1},   {"lid.upper.R", -1, 1},   {"lid.lower.L", -1, 1},
    {"lid.lower.R", -1, 1},    {"tongue.out", 0, 1},     {"tongue.tip", -1, 1},    {"tongue.wide", -1, 1},
    {"cheek.puff.L", -1, 1},   {"cheek.puff.R", -1, 1},  {"lips.close", 0, 1},     {"lip.upper.roll", -1, 1},
    {"lip.lower.roll", -1, 1},
};
const uint32_t ris__beside_channel_count = sizeof ris__beside_channel / sizeof ris__beside_channel[0];

bool ris__protrude_channel(const ris_muscle_def *def, char out[RIS_NAME_SIZE])
{
    out[0] = '\0';
    if (def->kind != RIS_MUSCLE_SPHINCTER || def->closes_on_line) {
        return false;
    }
    const size_t length = strlen(def->name), side = ris__name_is_sided(def->name) ? 2 : 0;
    char name[2 * RIS_NAME_SIZE];
    snprintf(name, sizeof name, "%.*s.protrude%s", (int)(length - side), def->name,
             def->name + length - side);
    memcpy(out, name, RIS_NAME_SIZE - 1);
    out[RIS_NAME_SIZE - 1] = '\0';
    return true;
}
