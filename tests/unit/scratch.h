/* A folder of temporary files for one test program, below the build directory, and assertions on error texts.
 * */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "risorius/base.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char scratch_folder[1024];

static inline int scratch_setup(void **state)
{
    (void)state;
    snprintf(scratch_folder, sizeof scratch_folder, "%s/scratch-XXXXXX", RIS_BUILD_DIR);
    return mkdtemp(scratch_folder) ? 0 : -1;
}

/* "<folder>/<name>"; the text lives until the eighth call after this one. */
static inline const char *scratch_path(const char *name)
{
    static char path[8][2048];
    static unsigned turn;
    char *out = path[turn++ % 8];
    snprintf(out, sizeof path[0], "%s/%s", scratch_folder, name);
    return out;
}

static inline const char *scratch_write(const char *name, const char *text)
{
    const char *path = scratch_path(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
    return path;
}

static inline unsigned scratch_count(void)
{
    unsigned count = 0;
    DIR *folder = opendir(scratch_folder);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));) {
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    }
    closedir(folder);
    return count;
}

static inline void scratch_clear(void)
{
    DIR *folder = opendir(scratch_folder);
    if (!folder) {
        return;
    }
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            unlink(scratch_path(entry->d_name));
        }
    }
    closedir(folder);
}

static inline int scratch_teardown(void **state)
{
    (void)state;
    scratch_clear();
    rmdir(scratch_folder);
    return 0;
}

/* The call failed with this code and its sentence holds this text. */
static inline void expect_error(const ris_error *err, ris_result result, ris_result wanted, const char *text)
{
    if (result != wanted || !strstr(err->text, text)) {
        print_error("expected code %d with \"%s\", found code %d with \"%s\"\n", (int)wanted, text,
                    (int)result, result == RIS_OK ? "" : err->text);
        fail();
    }
    assert_int_equal(err->code, wanted);
    assert_null(strchr(err->text, '\n'));
}
