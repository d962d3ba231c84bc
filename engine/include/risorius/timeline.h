/* Poses, expressions and clips: names and times in, channel values out. A pose is one float per model channel. */
#pragma once

#include "risorius/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Adds value x the named thing (sided or unsided muscle or channel, expression, and later AU or shape) to pose
 * (channel_count floats); call ris_pose_clamp when all is added. Unknown name: RIS_ERROR_USAGE with the three nearest. */
ris_result ris_pose_add(const ris_model *model, const char *name, float value, float *pose, ris_error *err);
void ris_pose_clamp(const ris_model *model, float *pose);
/* "name=value[,name=value...]" into pose (zeroed first, clamped). Letters A-E are 0.2 .. 1. C locale. RIS_ERROR_USAGE. */
ris_result ris_pose_parse(const ris_model *model, const char *text, float *pose, ris_error *err);

typedef struct ris_clip ris_clip;
/* Reads a clip, and those it includes, and checks them against the model's names (RIS_ERROR_DATA with line and column).
 * The model need not outlive it. */
ris_result ris_clip_load(const ris_model *model, const char *path, ris_clip **out, ris_error *err);
void ris_clip_destroy(ris_clip *clip);
double ris_clip_duration_s(const ris_clip *clip);
/* True if the clip is made to go round: ris_clip_sample then takes any time and repeats after its duration. */
bool ris_clip_repeats(const ris_clip *clip);
/* The pose at time_s into pose (channel_count floats): layers from the first to the last, clamped. It depends on the
 * time alone, so any frame rate and any order of times show the same motion. Several threads may sample one clip. */
void ris_clip_sample(const ris_clip *clip, double time_s, float *pose);
/* Key poses for contact sheets: distinct key times of the clip with the name of the strongest track there. */
uint32_t ris_clip_label_count(const ris_clip *clip);
const char *ris_clip_label(const ris_clip *clip, uint32_t index, double *out_time_s);

#ifdef __cplusplus
}
#endif
