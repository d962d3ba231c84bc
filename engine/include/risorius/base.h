/* Results, errors and small vectors shared by every part of Risorius.
 * Units everywhere: mm, g, s, radians. x to the subject's left, y up, z out of the face. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RIS_VERSION_STRING "0.1.0"

/* What went wrong; the process exit code of each is given by ris_exit_code(). */
typedef enum ris_result {
    RIS_OK = 0,
    RIS_ERROR_FAILED,   /* unwritable output, full disk, a comparison that differs: exit 1 */
    RIS_ERROR_MEMORY,   /* an allocation failed: exit 1 */
    RIS_ERROR_DIVERGED, /* the simulation left the finite numbers: exit 1 */
    RIS_ERROR_USAGE,    /* wrong command line, unknown name on it: exit 2 */
    RIS_ERROR_DATA,     /* bad data in a file: exit 3 */
    RIS_ERROR_DEVICE    /* no usable Vulkan device, or device lost: exit 4 */
} ris_result;

/* One clear sentence about the first error; owned by the caller. text is empty while code is RIS_OK. */
typedef struct ris_error {
    ris_result code;
    char text[1024];
} ris_error;

/* Stores code and the printf-formatted sentence in err (which may be NULL) and returns code. */
ris_result ris_fail(ris_error *err, ris_result code, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Process exit code of a result: 0 ok, 1 failed, 2 usage, 3 data, 4 device. */
int ris_exit_code(ris_result result);

typedef struct ris_vec3 {
    float x, y, z;
} ris_vec3;

typedef struct ris_vec4 {
    float x, y, z, w;
} ris_vec4;

#ifdef __cplusplus
}
#endif
