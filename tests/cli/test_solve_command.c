/* risorius solve and risorius pairs as a user meets them: a face that was exported is found again, one that cannot be is said
 * to be far, what is written plays, wrong words and files have their sentence. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#define HUMAN "'" RIS_SOURCE_DIR "/assets/human'"
#define FEW " --channels jaw.open,frontalis_inner,lid.upper.L"

static run_result run;
static char folder[COMMAND_PATH_SIZE];

static void expect(const char *line, int code, const char *in_err)
{
    command_run(&run, NULL, line);
    if (run.code != code || (in_err && !strstr(run.err, in_err))) {
        fail_msg("risorius %s: code %d (expected %d), stderr '%s' (expected '%s')", line, run.code, code,
                 run.err, in_err ? in_err : "");
    }
}

/* printf into a command line; %s of the format is the folder. */
static void expect_in(const char *before, const char *file, const char *after, int code, const char *in_err)
{
    char line[2 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line, "%s '%s/%s' %s", before, folder, file, after);
    expect(line, code, in_err);
}

static int make_face(void **state)
{
    (void)state;
    command_folder(folder, "solve");
    char line[2 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line,
             "export " HUMAN " --pose jaw.open=0.3,frontalis_inner.L=0.8,lid.upper.L=0.5 --device cpu -q -o "
             "'%s/face.obj'",
             folder);
    command_run(&run, NULL, line);
    if (run.code) {
        return run.code;
    }
    snprintf(line, sizeof line, "export " HUMAN " --device cpu -q -o '%s/rest.obj'", folder);
    command_run(&run, NULL, line);
    return run.code;
}

static double number(const json_t *root, const char *key)
{
    return json_number_value(json_object_get(root, key));
}

static double value_of(const json_t *root, const char *name)
{
    size_t k;
    json_t *channel;
    json_array_foreach(json_object_get(root, "channels"), k, channel)
    {
        if (strcmp(json_string_value(json_object_get(channel, "name")), name) == 0) {
            return number(channel, "value");
        }
    }
    fail_msg("no channel %s", name);
    return 0;
}

static void an_exported_face_is_found(void **state)
{
    (void)state;
    char line[3 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line,
             "solve " HUMAN " '%s/face.obj' --device cpu -q --json" FEW " -o '%s/pose.json'", folder, folder);
    expect(line, 0, NULL);
    json_t *root = json_loads(run.out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(root);
    assert_true(number(root, "rest_rms_mm") > 1);
    assert_true(number(root, "rms_mm") < 0.01);
    assert_true(json_is_true(json_object_get(root, "reached")));
    assert_true(value_of(root, "jaw.open") > 0.295 && value_of(root, "jaw.open") < 0.305);
    assert_true(value_of(root, "frontalis_inner.L") > 0.75 && value_of(root, "frontalis_inner.L") < 0.85);
    assert_true(value_of(root, "frontalis_inner.R") < 0.05);
    assert_true(value_of(root, "lid.upper.L") > 0.45 && value_of(root, "lid.upper.L") < 0.55);
    json_decref(root);
    /* the clip that was written gives the face again */
    snprintf(line, sizeof line,
             "export " HUMAN " --clip '%s/pose.json' --at 1 --device cpu -q -o '%s/again.obj'", folder,
             folder);
    expect(line, 0, NULL);
}

/* Only the jaw may act: the brow and the lid stay away, and the text says so when that counts. */
static void what_is_far_is_said(void **state)
{
    (void)state;
    expect_in("solve " HUMAN, "face.obj",
              "--device cpu -q --channels frontalis_outer --landmarks --iterations 1", 0, NULL);
    assert_non_null(strstr(run.out, "not reached: "));
    expect_in("solve " HUMAN, "face.obj", "--device cpu -q --channels jaw.open --near 100 --iterations 1", 0,
              NULL);
    assert_null(strstr(run.out, "not reached"));
    assert_non_null(strstr(run.out, "pose: jaw.open=0."));
}

/* By action units: a side each, but of what has no side one unit alone, for two halves could not be told apart. */
static void units_have_sides_where_they_differ(void **state)
{
    (void)state;
    expect_in("solve " HUMAN, "rest.obj", "--device cpu -q --json --channels au --enough 0.01", 0, NULL);
    assert_non_null(strstr(run.out, "\"AU12.L\""));
    assert_non_null(strstr(run.out, "\"AU4.R\"")); /* corrugators with half of procerus each */
    assert_non_null(strstr(run.out, "\"AU26\""));
    assert_null(strstr(run.out, "\"AU26.L\""));
    assert_null(strstr(run.out, "\"AU51\"")); /* turns the head */
}

static void wrong_words_and_files(void **state)
{
    (void)state;
    expect("solve", 2, "HEAD");
    expect("solve " HUMAN, 2, "needs a target");
    expect("solve " HUMAN " --self-test 1 -o x", 2, "--self-test");
    expect("solve " HUMAN " --self-test many", 2, "--self-test");
    expect_in("solve " HUMAN, "face.obj", "--first 56 --device cpu", 2, "--first");
    expect_in("solve " HUMAN, "face.obj", "--channels jaw.opem --device cpu", 2, "jaw.open");
    expect_in("solve " HUMAN, "face.obj", "--channels jaw.open,,lids --device cpu", 2, "expected a name");
    expect_in("solve " HUMAN, "none.obj", "--device cpu", 3, "none.obj");
    char path[COMMAND_PATH_SIZE + 16];
    snprintf(path, sizeof path, "%s/marks.csv", folder);
    command_write_file(path, "landmark,x_mm,y_mm,z_mm\nch.X,1,2,3\n");
    expect_in("solve " HUMAN, "marks.csv", "--device cpu", 3, "marks.csv:2:1: expected a landmark");
    expect_in("solve " HUMAN, "marks.csv", "--align --device cpu", 2, "--align");
    expect("pairs", 2, "HEAD");
    expect("pairs " HUMAN " --pair AU6 --device cpu", 2, "two names");
    expect("pairs " HUMAN " --pair AU6,AU99 --device cpu", 2, "AU99");
    expect("pairs " HUMAN " --path nan --device cpu", 2, "--path");
}

/* One pose by its number, with two channels: nothing before it is run. */
static void a_self_test_may_begin_anywhere(void **state)
{
    (void)state;
    expect("solve " HUMAN " --self-test 1 --first 57 --device cpu --channels risorius", 0, NULL);
    assert_non_null(strstr(run.out, "   57     "));
    assert_non_null(strstr(run.out, "1 poses of seed 1, 2 channels"));
}

/* Two pairs end in one face on every way; held to nothing, the ways differ. */
static void pairs_end_in_one_face(void **state)
{
    (void)state;
    expect("pairs " HUMAN " --device cpu -q --json --pair AU6,AU12 --pair AU18,AU26", 0, NULL);
    json_t *root = json_loads(run.out, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(root);
    assert_int_equal(json_array_size(json_object_get(root, "pairs")), 2);
    assert_true(number(root, "worst_mm") > 0 && number(root, "worst_mm") <= 0.1);
    json_decref(root);
    expect("pairs " HUMAN " --device cpu -q --path 0 --pair AU6,AU12", 1, "apart on different ways");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_exported_face_is_found),          cmocka_unit_test(what_is_far_is_said),
        cmocka_unit_test(units_have_sides_where_they_differ), cmocka_unit_test(wrong_words_and_files),
        cmocka_unit_test(a_self_test_may_begin_anywhere),     cmocka_unit_test(pairs_end_in_one_face),
    };
    return cmocka_run_group_tests(tests, make_face, NULL);
}
