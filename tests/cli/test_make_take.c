/* `risorius make-take`: the same bytes for the same seed, every shape used, both formats readable, the faults that are asked
 * for and no others. */
#include "command.h"

#include "asset/take.h"
#include "base/hash.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static run_result run;
static char folder[COMMAND_PATH_SIZE];

static char *make(const char *options)
{
    char line[2 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line, "make-take -o '%s/take.csv' %s", folder, options);
    command_run(&run, NULL, line);
    if (run.code != 0) {
        fail_msg("exit code %d: %s", run.code, run.err);
    }
    snprintf(line, sizeof line, "%s/take.csv", folder);
    char *text = command_read_file(line);
    assert_non_null(text);
    return text;
}

static uint64_t hash_of(const char *options)
{
    char *text = make(options);
    const uint64_t hash = ris__hash(RIS_HASH_START, text, strlen(text));
    free(text);
    return hash;
}

static void read_take(const char *options, ris_take_format format, ris_take_table *table, ris_take_info *info)
{
    ris_take_def def = ris_default_take_def(format);
    ris_error err = {0};
    char *text = make(options);
    if (ris__take_parse("take.csv", text, strlen(text), &def, table, info, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    free(text);
}

/* Made on x86-64 with gcc 12; only + - * / and PCG32 go into it. */
static void same_bytes_everywhere(void **state)
{
    (void)state;
    const uint64_t hash = hash_of("--seconds 20 --seed 7");
    print_message("hash %016llx\n", (unsigned long long)hash);
    assert_true(hash == UINT64_C(0x85902007c989eeca));
    assert_true(hash == hash_of("--seconds 20 --seed 7"));
    assert_true(hash != hash_of("--seconds 20 --seed 8"));
}

static void every_shape_is_used(void **state)
{
    ris_take_table table;
    ris_take_info info;
    (void)state;
    read_take("--seconds 180 --seed 1 --clean", RIS_TAKE_LIVE_LINK, &table, &info);
    assert_int_equal(info.rows, 10800);
    assert_int_equal(info.samples, 10800);
    assert_int_equal(info.spikes + info.clamped + info.gaps + info.lost, 0);
    assert_int_equal(info.columns, RIS__ARKIT_COUNT + 3); /* the eyes go by the shapes */
    for (uint32_t c = 0; c < table.column_count; c++) {
        float most = 0;
        for (uint32_t i = 0; i < table.sample_count; i++) {
            const float value = table.value[(size_t)i * table.column_count + c];
            most = value > most ? value : most;
        }
        if (strncmp(table.column[c].name, "eye.", 4) != 0 && !(most >= 0.5f)) {
            fail_msg("%s reaches %g only", table.column[c].name, (double)most);
        }
    }
    ris__take_finish(&table);
}

static void faults_come_as_told(void **state)
{
    ris_take_table table;
    ris_take_info info;
    (void)state;
    read_take("--seconds 60 --drop 0.01 --lose 0.002 --spikes 0.01", RIS_TAKE_LIVE_LINK, &table, &info);
    assert_true(info.rows < 3600 && info.rows > 3300);
    assert_true(info.lost > 20 && info.gaps > 20 && info.spikes > 10);
    ris__take_finish(&table);
    read_take("--seconds 10 --still --spelling camel", RIS_TAKE_LIVE_LINK, &table, &info);
    for (uint32_t i = 0; i < table.sample_count; i++) {
        assert_true(table.value[(size_t)i * table.column_count + 17] < 0.03f); /* jawOpen: five deviations */
    }
    ris__take_finish(&table);
}

static void openface_can_be_read(void **state)
{
    ris_take_table table;
    ris_take_info info;
    (void)state;
    read_take("--seconds 30 --openface --lose 0.005", RIS_TAKE_OPENFACE, &table, &info);
    assert_true(info.rate_hz > 29.9 && info.rate_hz < 30.4); /* timestamps have three decimals */
    assert_true(info.lost > 5);
    assert_int_equal(info.columns, 17 + 1 + 5);
    ris__take_finish(&table);
}

/* Half a second at one frame a second has no frame: a face is lost for two. */
static void few_frames_lose_a_face_too(void **state)
{
    ris_take_table table;
    ris_take_info info;
    (void)state;
    read_take("--seconds 40 --fps 1 --lose 0.3 --drop 0 --spikes 0", RIS_TAKE_LIVE_LINK, &table, &info);
    assert_int_equal(info.rows, 40);
    assert_true(info.lost > 5 && info.lost < 38);
    ris__take_finish(&table);
}

static void wrong_words(void **state)
{
    (void)state;
    command_run(&run, NULL, "make-take --seconds 3");
    assert_int_equal(run.code, 2);
    assert_non_null(strstr(run.err, "expected -o FILE.csv"));
    command_run(&run, NULL, "make-take -o x.csv --seconds never");
    assert_int_equal(run.code, 2);
    assert_non_null(strstr(run.err, "--seconds: expected a number from 0.1 to 3600, found \"never\""));
    command_run(&run, NULL, "make-take -o x.csv --spelling kebab");
    assert_int_equal(run.code, 2);
    command_run(&run, NULL, "make-take -o x.csv --loud");
    assert_int_equal(run.code, 2);
    command_run(&run, NULL, "make-take -o /nowhere/at/all.csv");
    assert_int_equal(run.code, 1);
}

static int open_folder(void **state)
{
    (void)state;
    command_folder(folder, "make_take");
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bytes_everywhere),      cmocka_unit_test(every_shape_is_used),
        cmocka_unit_test(faults_come_as_told),        cmocka_unit_test(openface_can_be_read),
        cmocka_unit_test(few_frames_lose_a_face_too), cmocka_unit_test(wrong_words),
    };
    return cmocka_run_group_tests(tests, open_folder, NULL);
}
