/* Names as channels of a model (docs/facs.md). */
#pragma once

#include "risorius/model.h"

/* Adds value to the channel, to both sides of an unsided name, or to the muscle the name is a synonym of; false if
 * the model has none. pose: (channel_count). */
bool ris__model_add_channel(const ris_model *model, const char *name, float value, float *pose);
/* Adds value x a word of the vocabulary, one side of it, or units joined ("AU6+12C.L"); false if it is none, with pose
 * as it was. */
bool ris__model_add_word(const ris_model *model, const char *name, float value, float *pose);
/* Fills the values of model->vocabulary by the model's channels (channel, channel_count). RIS_ERROR_MEMORY. */
ris_result ris__vocabulary_resolve(ris_model *model, ris_error *err);
/* The channel that a mirror image exchanges with channel c (c itself if it has no side). */
uint32_t ris__model_mirror_channel(const ris_model *model, uint32_t c);
