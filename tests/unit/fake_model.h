/* A model of channels only, for poses and clips: two sided muscles, one unsided, jaw and eyes, three
 * expressions. */
#pragma once

#include "risorius/model.h"

enum {
    FAKE_ZYGO_L,
    FAKE_ZYGO_R,
    FAKE_FRONT_L,
    FAKE_FRONT_R,
    FAKE_ORIS,
    FAKE_JAW,
    FAKE_SIDE,
    FAKE_YAW_L,
    FAKE_YAW_R,
    FAKE_COUNT
};

static ris_channel fake_channel[FAKE_COUNT] = {
    {"zygomaticus_major.L", 0, 1},
    {"zygomaticus_major.R", 0, 1},
    {"frontalis_inner.L", 0, 1},
    {"frontalis_inner.R", 0, 1},
    {"orbicularis_oris_superior", 0, 1},
    {"jaw.open", 0, 1},
    {"jaw.side", -1, 1},
    {"eye.yaw.L", -35, 35},
    {"eye.yaw.R", -35, 35},
};
static ris_term fake_smile[] = {{"zygomaticus_major", 0.5f}, {"jaw.open", 0.25f}};
static ris_term fake_grin[] = {{"smile", 2}, {"frontalis_inner.L", 1}};
static ris_term fake_wrong[] = {{"grin", 1}};
static ris_expression fake_expression[] = {
    {"smile", 2, fake_smile}, {"grin", 2, fake_grin}, {"too_deep", 1, fake_wrong}, {"neutral", 0, NULL}};
static ris_head fake_head = {.expression_count = 4, .expression = fake_expression};
static const ris_model fake_model = {
    .head = &fake_head, .channel_count = FAKE_COUNT, .channel = fake_channel};
