/* How a name on the command line or in a clip becomes channel values (KA-48, KA-49). */
#pragma once

#include "base/text.h"
#include "risorius/model.h"

/* Names in reach: channels of the model, expressions of the clip being read (none otherwise), expressions of
 * the head. */
typedef struct ris_pose_names {
    const ris_model *model;
    const ris_expression *clip_expression;
    uint32_t clip_expression_count;
} ris_pose_names;

/* Adds value x name to pose (channel_count). Returns NULL, or the name that is not known (pose may then be
 * partly changed). A channel goes before an expression, an expression of the clip before one of the head. */
const char *ris__pose_expand(const ris_pose_names *names, const char *name, float value, float *pose);

/* "a, b, c": the three known names nearest to name. Returns out. */
const char *ris__pose_nearest(const ris_pose_names *names, const char *name, char *out, size_t size);
