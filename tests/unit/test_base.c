/* engine/base: files, output by rename, numbers, names, hash, clock. */
#include "comma_locale.h"
#include "scratch.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"

#include <locale.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void test_file_read(void **state)
{
    (void)state;
    char *text;
    size_t size;
    ris_error err = {0};
    const char *path = scratch_write("text", "hello\n");
    assert_int_equal(ris__file_read(path, 6, &text, &size, &err), RIS_OK);
    assert_int_equal(size, 6);
    assert_string_equal(text, "hello\n");
    free(text);
    expect_error(&err, ris__file_read(path, 5, &text, &size, &err), RIS_ERROR_DATA,
                 "larger than the limit of 5 bytes");
    assert_null(text);
    expect_error(&err, ris__file_read(scratch_path("absent"), 9, &text, &size, &err), RIS_ERROR_DATA,
                 "absent: cannot open: No such file");
    expect_error(&err, ris__file_read(scratch_folder, 9, &text, &size, &err), RIS_ERROR_DATA, "cannot read");
    assert_int_equal(ris__file_read(scratch_write("empty", ""), 9, &text, &size, &err), RIS_OK);
    assert_int_equal(size, 0);
    free(text);
    scratch_clear();
}

static void test_file_read_grows(void **state)
{
    (void)state;
    size_t size = 0, wanted = 300000;
    char *text, *big = malloc(wanted + 1);
    ris_error err = {0};
    assert_non_null(big);
    memset(big, 'x', wanted);
    big[wanted] = 0;
    assert_int_equal(ris__file_read(scratch_write("big", big), RIS_MAX_JSON_BYTES, &text, &size, &err),
                     RIS_OK);
    assert_int_equal(size, wanted);
    assert_memory_equal(text, big, wanted + 1);
    free(text);
    free(big);
    scratch_clear();
}

static void test_path_join(void **state)
{
    (void)state;
    char path[RIS_PATH_SIZE], longer[RIS_PATH_SIZE + 2];
    ris_error err = {0};
    assert_int_equal(ris__path_join(path, "a/b", "c.obj", &err), RIS_OK);
    assert_string_equal(path, "a/b/c.obj");
    assert_int_equal(ris__path_join(path, "a/", "c", &err), RIS_OK);
    assert_string_equal(path, "a/c");
    assert_int_equal(ris__path_join(path, "", "c", &err), RIS_OK);
    assert_string_equal(path, "c");
    assert_int_equal(ris__path_join(path, "a", "/c", &err), RIS_OK);
    assert_string_equal(path, "/c");
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    expect_error(&err, ris__path_join(path, "a", longer, &err), RIS_ERROR_DATA, "path longer than");
}

static void test_output_appears_when_complete(void **state)
{
    (void)state;
    char *text;
    size_t size;
    ris_error err = {0};
    ris_output_file file = {0};
    const char *path = scratch_write("out.txt", "old");
    assert_int_equal(ris__output_try(path, &err), RIS_OK); /* changes nothing */
    assert_int_equal(ris__output_open(&file, path, &err), RIS_OK);
    assert_int_equal(ris__output_write(&file, "new ", 4, &err), RIS_OK);
    assert_int_equal(ris__output_printf(&file, &err, "%d", 12), RIS_OK);
    assert_int_equal(scratch_count(), 2); /* the old file and the one being written */
    assert_int_equal(ris__output_commit(&file, &err), RIS_OK);
    ris__output_discard(&file);
    assert_int_equal(scratch_count(), 1);
    assert_int_equal(ris__file_read(path, 99, &text, &size, &err), RIS_OK);
    assert_string_equal(text, "new 12");
    free(text);
    scratch_clear();
}

static void test_output_discard_keeps_the_old_file(void **state)
{
    (void)state;
    char *text;
    size_t size;
    ris_error err = {0};
    ris_output_file file = {0};
    const char *path = scratch_write("out.txt", "old");
    ris__output_discard(&file);
    assert_int_equal(ris__output_open(&file, path, &err), RIS_OK);
    assert_int_equal(ris__output_write(&file, "new", 3, &err), RIS_OK);
    ris__output_discard(&file);
    assert_int_equal(scratch_count(), 1);
    assert_int_equal(ris__file_read(path, 99, &text, &size, &err), RIS_OK);
    assert_string_equal(text, "old");
    free(text);
    scratch_clear();
}

static void test_output_errors(void **state)
{
    (void)state;
    ris_error err = {0};
    expect_error(&err, ris__file_write(scratch_path("no/such/folder"), "x", 1, &err), RIS_ERROR_FAILED,
                 "folder: cannot write: No such file or directory");
    expect_error(&err, ris__output_try(scratch_path("no/such/folder"), &err), RIS_ERROR_FAILED,
                 "folder: cannot write: No such file or directory");
    expect_error(&err, ris__file_write(scratch_folder, "x", 1, &err), RIS_ERROR_FAILED,
                 "cannot write: Is a directory");
    expect_error(&err, ris__file_write("", "x", 1, &err), RIS_ERROR_FAILED, "cannot write");
    expect_error(&err, ris__directory_make(scratch_path("no/such"), &err), RIS_ERROR_FAILED,
                 "cannot make the directory");
    assert_int_equal(ris__directory_make(scratch_folder, &err), RIS_OK);
    assert_int_equal(scratch_count(), 0);
}

static void test_output_to_a_device_does_not_replace_it(void **state)
{
    (void)state;
    struct stat info;
    ris_error err = {0};
    char temporary[RIS_PATH_SIZE];
    assert_int_equal(ris__file_write("/dev/null", "x", 1, &err), RIS_OK);
    expect_error(&err, ris__file_write("/dev/full", "x", 1, &err), RIS_ERROR_FAILED,
                 "/dev/full: cannot write: No space left on device");
    assert_int_equal(stat("/dev/null", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
    assert_int_equal(ris__temporary_path(temporary, "/dev/null", &err), RIS_OK);
    assert_string_equal(temporary, "/dev/null");
}

/* A full disk, played by a limit on file sizes in a child process. */
static void test_output_full_disk(void **state)
{
    (void)state;
    const char *path = scratch_write("kept", "old");
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        static char block[100000];
        ris_error err = {0};
        struct rlimit limit = {4096, 4096};
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &limit);
        ris_result result = ris__file_write(path, block, sizeof block, &err);
        bool said = strstr(err.text, "kept: cannot write: File too large") != NULL;
        _exit(result == RIS_ERROR_FAILED && said ? 0 : 1);
    }
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    char *text;
    size_t size;
    ris_error err = {0};
    assert_int_equal(scratch_count(), 1); /* nothing half-written is left */
    assert_int_equal(ris__file_read(path, 99, &text, &size, &err), RIS_OK);
    assert_string_equal(text, "old");
    free(text);
    scratch_clear();
}

static void test_temporary_commit(void **state)
{
    (void)state;
    ris_error err = {0};
    char temporary[RIS_PATH_SIZE];
    const char *path = scratch_path("film.mp4");
    assert_int_equal(ris__temporary_path(temporary, path, &err), RIS_OK);
    assert_string_not_equal(temporary, path);
    assert_non_null(strstr(temporary, "film.mp4")); /* same extension, for programs that go by it */
    scratch_write(strrchr(temporary, '/') + 1, "film");
    assert_int_equal(ris__temporary_commit(temporary, path, &err), RIS_OK);
    assert_int_equal(access(path, R_OK), 0);
    expect_error(&err, ris__temporary_commit(temporary, path, &err), RIS_ERROR_FAILED,
                 "film.mp4: cannot write");
    scratch_clear();
}

static double number(const char *text)
{
    double value = NAN;
    const char *end = text + strlen(text);
    return ris__parse_number(text, end, &value) == end ? value : NAN;
}

static void test_numbers_equal_strtod(void **state)
{
    (void)state;
    static const char *const good[] = {"0",
                                       "-0",
                                       "1",
                                       "+2",
                                       "-3.25",
                                       ".5",
                                       "5.",
                                       "1e3",
                                       "1E-3",
                                       "2.5e+2",
                                       "123456789.123456789",
                                       "0.1",
                                       "0.000001",
                                       "3.4028235e38",
                                       "1e-320",
                                       "9007199254740993",
                                       "1.7976931348623157e308",
                                       "0.30000000000000004",
                                       "1234567890123456789012345678901234567890",
                                       "6.02214076e23"};
    static const char *const bad[] = {"",     "-",  "+",  ".",   "e5", "nan", "inf", "-inf",
                                      "0x10", " 1", "1 ", "1,5", "1e", "1e+", "--1", "1e999"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(number(good[i]) == strtod(good[i], NULL));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_true(isnan(number(bad[i])));
    }
    uint64_t seed = 12345;
    for (int i = 0; i < 20000; i++) {
        char text[64];
        seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        snprintf(text, sizeof text, "%.*g", 1 + (int)(seed >> 33) % 17,
                 ((double)(int64_t)seed) * pow(10, (double)(int)(seed >> 59) - 30));
        assert_true(number(text) == strtod(text, NULL));
    }
}

static void test_numbers_ignore_the_locale(void **state)
{
    (void)state;
    comma_locale_begin();
    assert_true(number("1.5") == 1.5);
    assert_true(number("1.234567890123456789") == 1.234567890123456789);
    assert_true(isnan(number("1,5")));
    comma_locale_end();
}

static void test_integers(void **state)
{
    (void)state;
    int64_t value = 0;
    const char *text = "-12/3";
    assert_ptr_equal(ris__parse_integer(text, text + 5, &value), text + 3);
    assert_int_equal(value, -12);
    text = "99999999999999999999";
    assert_null(ris__parse_integer(text, text + strlen(text), &value));
    text = "x";
    assert_null(ris__parse_integer(text, text + 1, &value));
    assert_null(ris__parse_integer(text, text, &value));
}

static void test_nearest(void **state)
{
    (void)state;
    char text[64];
    ris_nearest nearest;
    assert_int_equal(ris__edit_distance("kitten", "sitting"), 3);
    assert_int_equal(ris__edit_distance("", "abc"), 3);
    assert_int_equal(ris__edit_distance("same", "same"), 0);
    ris__nearest_init(&nearest, "smil");
    assert_string_equal(ris__nearest_text(&nearest, text, sizeof text), "none");
    ris__nearest_add(&nearest, "frown");
    ris__nearest_add(&nearest, "smile");
    ris__nearest_add(&nearest, "smile");
    ris__nearest_add(&nearest, "sniff");
    ris__nearest_add(&nearest, "mill");
    ris__nearest_add(&nearest, "zygomaticus_major");
    assert_string_equal(ris__nearest_text(&nearest, text, sizeof text), "smile, mill, sniff");
}

static void test_hash_and_clock(void **state)
{
    (void)state;
    /* published values of FNV-1a 64 */
    assert_true(ris__hash(RIS_HASH_START, "", 0) == UINT64_C(0xcbf29ce484222325));
    assert_true(ris__hash(RIS_HASH_START, "a", 1) == UINT64_C(0xaf63dc4c8601ec8c));
    assert_true(ris__hash(RIS_HASH_START, "foobar", 6) == UINT64_C(0x85944171f73967e8));
    assert_true(ris__hash(ris__hash(RIS_HASH_START, "foo", 3), "bar", 3) == UINT64_C(0x85944171f73967e8));
    uint64_t start = ris__clock_ns(), end = ris__clock_ns();
    assert_true(end >= start);
    assert_true(ris__clock_ms(1000000, 3500000) == 2.5);
}

static void test_exit_codes(void **state)
{
    (void)state;
    static const int code[] = {0, 1, 1, 1, 2, 3, 4};
    for (int i = 0; i < 7; i++) {
        assert_int_equal(ris_exit_code((ris_result)i), code[i]);
    }
    assert_int_equal(ris_fail(NULL, RIS_ERROR_DATA, "nobody listens"), RIS_ERROR_DATA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_file_read),
        cmocka_unit_test(test_file_read_grows),
        cmocka_unit_test(test_path_join),
        cmocka_unit_test(test_output_appears_when_complete),
        cmocka_unit_test(test_output_discard_keeps_the_old_file),
        cmocka_unit_test(test_output_errors),
        cmocka_unit_test(test_output_to_a_device_does_not_replace_it),
        cmocka_unit_test(test_output_full_disk),
        cmocka_unit_test(test_temporary_commit),
        cmocka_unit_test(test_numbers_equal_strtod),
        cmocka_unit_test(test_numbers_ignore_the_locale),
        cmocka_unit_test(test_integers),
        cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_hash_and_clock),
        cmocka_unit_test(test_exit_codes),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
