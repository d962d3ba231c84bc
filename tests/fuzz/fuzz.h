/* What every fuzz driver promises: any bytes either give a sound object or one sentence, never both, never a
 * crash. */
#pragma once

#include "risorius/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FUZZ_CHECK(condition)                                                                                \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #condition);                    \
            abort();                                                                                         \
        }                                                                                                    \
    } while (0)

static inline void fuzz_check_error(ris_result result, const ris_error *err)
{
    if (result == RIS_OK) {
        FUZZ_CHECK(err->text[0] == 0);
    } else {
        FUZZ_CHECK(err->code == result);
        FUZZ_CHECK(result == RIS_ERROR_DATA || result == RIS_ERROR_USAGE);
        FUZZ_CHECK(err->text[0] != 0 && !strchr(err->text, '\n'));
    }
}
