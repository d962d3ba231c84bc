/* A numeric locale with a decimal comma, whatever is installed: the C.utf8 of the C library with its point replaced.
 * Needs scratch_setup. */
#pragma once

#include "scratch.h"

#include <locale.h>
#include <sys/stat.h>

#define COMMA_SOURCE "/usr/lib/locale/C.utf8/LC_NUMERIC"

/* Sets the locale; fails the test if numbers are not written with a comma afterwards. */
static inline void comma_locale_begin(void)
{
    char bytes[4096], shown[16];
    FILE *source = fopen(COMMA_SOURCE, "rb");
    if (!source) {
        print_message("skipped: there is no %s to make a locale from\n", COMMA_SOURCE);
        skip();
    }
    size_t size = fread(bytes, 1, sizeof bytes, source);
    fclose(source);
    for (size_t i = 0; i < size; i++) {
        bytes[i] = bytes[i] == '.' ? ',' : bytes[i];
    }
    assert_int_equal(mkdir(scratch_path("comma"), 0777), 0);
    FILE *file = fopen(scratch_path("comma/LC_NUMERIC"), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    setenv("LOCPATH", scratch_folder, 1);
    assert_non_null(setlocale(LC_NUMERIC, "comma"));
    snprintf(shown, sizeof shown, "%.1f", 1.5);
    assert_string_equal(shown, "1,5");
}

static inline void comma_locale_end(void)
{
    setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
    unlink(scratch_path("comma/LC_NUMERIC"));
    rmdir(scratch_path("comma"));
}
