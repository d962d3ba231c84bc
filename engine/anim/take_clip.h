/* Performances from memory, for tests and fuzzing. */
#pragma once

#include "risorius/take.h"

/* ris_take_load of text; name stands for the file in errors. */
ris_result ris__take_clip(const ris_model *model, const char *name, const char *text, size_t size,
                          const ris_take_def *def, ris_clip **out, ris_take_info *info, ris_error *err);
