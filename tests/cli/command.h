/* Runs the risorius program as a user would and keeps what it said. */
#pragma once

#include "risorius/base.h"

#include <sys/types.h>

#define COMMAND_PATH_SIZE 4096

typedef struct run_result {
    int code;             /* exit code, or 128 + signal */
    char out[256 * 1024]; /* standard output */
    char err[64 * 1024];  /* standard error */
} run_result;

/* How a run differs from a plain one; zeroed = plain. */
typedef struct command_def {
    const char *environment[4]; /* "NAME=value" */
    long file_limit;            /* > 0: RLIMIT_FSIZE in bytes, a full disk */
    const char *directory;      /* working directory */
    const char *out_path;       /* standard output goes to this file instead */
    int interrupt_after_ms;     /* > 0: SIGINT after this time */
} command_def;

/* Runs build/bin/risorius with the words of `line`, which are parted by blanks outside of single quotes. */
void command_run(run_result *result, const command_def *def, const char *line);

/* A fresh folder for one test, "name" below the build; emptied first. */
void command_folder(char out[COMMAND_PATH_SIZE], const char *name);
/* Number of entries in a folder. */
uint32_t command_entries(const char *folder);
bool command_exists(const char *path);
void command_write_file(const char *path, const char *text);
/* A copy of assets/human of which one file (e.g. "head.json") has other text; the rest are links. */
void command_spoil_head(const char *folder, const char *file, const char *text);
/* Reads a whole text file; the caller frees. NULL if there is none. */
char *command_read_file(const char *path);
