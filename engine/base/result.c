#include "risorius/base.h"

#include <stdarg.h>
#include <stdio.h>

ris_result ris_fail(ris_error *err, ris_result code, const char *format, ...)
{
    if (err) {
        va_list args;
        va_start(args, format);
        err->code = code;
        vsnprintf(err->text, sizeof err->text, format, args);
        va_end(args);
        for (char *c = err->text; *c; c++) {
            *c = (unsigned char)*c < 32 ? ' ' : *c; /* whatever a file holds, a sentence is one line */
        }
    }
    return code;
}

int ris_exit_code(ris_result result)
{
    switch (result) {
    case RIS_OK: return 0;
    case RIS_ERROR_USAGE: return 2;
    case RIS_ERROR_DATA: return 3;
    case RIS_ERROR_DEVICE: return 4;
    case RIS_ERROR_FAILED:
    case RIS_ERROR_MEMORY:
    case RIS_ERROR_DIVERGED: break;
    }
    return 1;
}
