/* engine/output/png.c: what is written is what a decoder reads; nothing is left when it cannot be written. */
#include "scratch.h"

#include "risorius/output.h"

#include <signal.h>
#include <stb/stb_image.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void noise(uint8_t *rgba, uint32_t count, bool opaque)
{
    uint32_t seed = 12345;
    for (uint32_t i = 0; i < 4 * count; i++) {
        seed = seed * 1664525u + 1013904223u;
        rgba[i] = opaque && i % 4 == 3 ? 255 : (uint8_t)(seed >> 24);
    }
}

static void round_trip(uint32_t width, uint32_t height)
{
    ris_error err = {0};
    int w, h, channels;
    uint8_t *pixels = malloc((size_t)width * height * 4);
    const char *path = scratch_path("picture.png");
    assert_non_null(pixels);
    noise(pixels, width * height, true);
    assert_int_equal(ris_png_write(path, pixels, width, height, &err), RIS_OK);
    uint8_t *read = stbi_load(path, &w, &h, &channels, 4);
    assert_non_null(read);
    assert_int_equal(w, width);
    assert_int_equal(h, height);
    assert_memory_equal(read, pixels, (size_t)width * height * 4);
    pixels[4 * (width * height - 1)] ^= 1; /* the comparison can fail */
    assert_memory_not_equal(read, pixels, (size_t)width * height * 4);
    stbi_image_free(read);
    free(pixels);
    assert_int_equal(scratch_count(), 1);
    scratch_clear();
}

static void test_round_trip(void **state)
{
    (void)state;
    round_trip(1, 1);
    round_trip(7, 3);
    round_trip(64, 65);
    round_trip(301, 200);
}

static void test_sizes(void **state)
{
    (void)state;
    ris_error err = {0};
    uint8_t pixel[4] = {0};
    expect_error(&err, ris_png_write(scratch_path("a.png"), pixel, 0, 1, &err), RIS_ERROR_USAGE, "found 0x1");
    expect_error(&err, ris_png_write(scratch_path("a.png"), pixel, 1, 100000, &err), RIS_ERROR_USAGE,
                 "1x100000");
    assert_int_equal(scratch_count(), 0);
}

static void test_unwritable(void **state)
{
    (void)state;
    ris_error err = {0};
    uint8_t pixel[4] = {0};
    expect_error(&err, ris_png_write(scratch_path("no/such/a.png"), pixel, 1, 1, &err), RIS_ERROR_FAILED,
                 "no/such/a.png");
    expect_error(&err, ris_png_write(scratch_folder, pixel, 1, 1, &err), RIS_ERROR_FAILED, scratch_folder);
    expect_error(&err, ris_png_write("/dev/full", pixel, 1, 1, &err), RIS_ERROR_FAILED, "No space left");
    assert_int_equal(scratch_count(), 0);
}

/* A full disk leaves the old picture as it was. */
static void test_full_disk(void **state)
{
    (void)state;
    enum { side = 128 };
    static uint8_t pixels[side * side * 4];
    ris_error err = {0};
    const char *path = scratch_write("old.png", "old");
    noise(pixels, side * side, true);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        const struct rlimit limit = {1000, 1000};
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &limit);
        bool told = ris_png_write(path, pixels, side, side, &err) == RIS_ERROR_FAILED &&
                    strstr(err.text, "File too large");
        _exit(told ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_size, 3);
    assert_int_equal(scratch_count(), 1);
    scratch_clear();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_unwritable),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
