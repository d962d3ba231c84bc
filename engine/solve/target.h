/* Landmark targets from memory, for tests and fuzzing. */
#pragma once

#include "risorius/solve.h"

/* ris_target_load_landmarks of text; name stands for the file in errors. */
ris_result ris__target_parse(const ris_model *model, const char *name, const char *text, size_t size,
                             ris_target *out, ris_error *err);
