/* Whole-file input, and output that appears under its name only when it is complete (nothing
 * half-written). */
#pragma once

#include "risorius/base.h"

#include <stdio.h>

#define RIS_PATH_SIZE 4096 /* bytes of a path with its terminator */

/* Largest input files accepted; anything bigger is refused before memory is taken. */
#define RIS_MAX_MESH_BYTES ((size_t)256 << 20)
#define RIS_MAX_JSON_BYTES ((size_t)64 << 20)
#define RIS_MAX_IMAGE_BYTES ((size_t)256 << 20)

/* Reads a whole file into *out (malloc, caller frees), with a NUL after the last byte; out_size does not
 * count it. Errors: RIS_ERROR_DATA (missing, unreadable, a directory, longer than max_size),
 * RIS_ERROR_MEMORY. */
ris_result ris__file_read(const char *path, size_t max_size, char **out, size_t *out_size, ris_error *err);

/* "directory/name", or name alone when it is absolute or directory is empty. Error: RIS_ERROR_DATA when too
 * long. */
ris_result ris__path_join(char out[RIS_PATH_SIZE], const char *directory, const char *name, ris_error *err);

/* A file being written. Zero it, open, write, then commit; discard is safe at any point, also after commit.
 * Bytes go to ".part-<pid>-<name>" beside the target (same extension), renamed at commit. An existing device
 * or pipe (/dev/full, /dev/stdout) is written directly. */
typedef struct ris_output_file {
    FILE *stream; /* NULL when not open; may be used directly, errors show at commit */
    char path[RIS_PATH_SIZE];
    char temporary[RIS_PATH_SIZE]; /* empty when the path is written directly */
} ris_output_file;

/* Errors of all: RIS_ERROR_FAILED with path and reason. The library never touches signals: a program that
 * wants an error instead of a signal at a file-size limit ignores SIGXFSZ (and SIGPIPE for pipes). */
ris_result ris__output_open(ris_output_file *file, const char *path, ris_error *err);
/* Whether path can be written, before long work; leaves nothing behind. A device or pipe is not touched. */
ris_result ris__output_try(const char *path, ris_error *err);
ris_result ris__output_write(ris_output_file *file, const void *data, size_t size, ris_error *err);
/* Numbers are written as in the C locale, whatever the program's. */
ris_result ris__output_printf(ris_output_file *file, ris_error *err, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;
/* Flushes, closes and renames; on failure the temporary is removed and the old file, if any, is untouched. */
ris_result ris__output_commit(ris_output_file *file, ris_error *err);
void ris__output_discard(ris_output_file *file);

/* For writers that are other programs (ffmpeg): the temporary name for path, and its rename when done.
 * ris__temporary_path gives path itself for an existing device or pipe. */
ris_result ris__temporary_path(char out[RIS_PATH_SIZE], const char *path, ris_error *err);
ris_result ris__temporary_commit(const char *temporary, const char *path, ris_error *err);

/* Writes size bytes as a whole file: open, write, commit. */
ris_result ris__file_write(const char *path, const void *data, size_t size, ris_error *err);
/* Makes a directory if it does not exist (its parent must). */
ris_result ris__directory_make(const char *path, ris_error *err);
