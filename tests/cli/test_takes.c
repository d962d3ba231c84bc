/* Performances as a user plays them: render, export, soak; wrong words, wrong files; a short one measured frame by frame. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human' --device cpu -q "

static run_result run;
static char folder[COMMAND_PATH_SIZE];

static void expect(int code, const char *in_err, const char *format, ...)
{
    char line[4 * COMMAND_PATH_SIZE];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof line, format, list);
    va_end(list);
    command_run(&run, NULL, line);
    if (run.code != code || (in_err && !strstr(run.err, in_err))) {
        fail_msg("risorius %s: code %d (expected %d), stderr '%s' (expected '%s')", line, run.code, code,
                 run.err, in_err ? in_err : "");
    }
}

static int make_takes(void **state)
{
    (void)state;
    command_folder(folder, "takes");
    expect(0, NULL, "make-take -o '%s/two.csv' --seconds 2 --seed 3", folder);
    expect(0, NULL, "make-take -o '%s/of.csv' --seconds 1 --openface --lose 0.1", folder);
    return 0;
}

static void wrong_words(void **state)
{
    (void)state;
    expect(2, "name one motion between them",
           "render " HEAD "--live-link a.csv --openface b.csv --no-raster");
    expect(2, "--adjust is for", "render " HEAD "--clip a.json --adjust mirror --no-raster");
    expect(2, "found \"upside\"", "render " HEAD "--live-link a.csv --adjust upside --no-raster");
    expect(2, "--no-raster", "render " HEAD "--live-link '%s/two.csv'", folder);
    expect(2, "--no-raster makes no picture", "render " HEAD "--live-link '%s/two.csv' --no-raster -o x.mp4",
           folder);
    expect(2, "not both", "soak " HEAD "--live-link '%s/two.csv' --pose jaw.open=1", folder);
    expect(2, "--every is for", "soak " HEAD "--every 3");
    expect(2, "not both", "export " HEAD "--live-link '%s/two.csv' --pose jaw.open=1 -o x.obj", folder);
}

static void wrong_files(void **state)
{
    char path[COMMAND_PATH_SIZE + 16];
    (void)state;
    snprintf(path, sizeof path, "%s/bad.csv", folder);
    command_write_file(path,
                       "Timecode,BlendShapeCount,JawOpen\n00:00:00:01.000,1,0.1\n00:00:00:02.000,1,high\n");
    expect(3, "bad.csv:3:19: expected a value of 0 to 1, found \"high\"",
           "render " HEAD "--live-link '%s' --no-raster", path);
    expect(3, "expected a header that begins with Timecode",
           "render " HEAD "--live-link '%s/of.csv' --no-raster", folder);
    expect(3, "no_such.csv", "render " HEAD "--openface no_such.csv --no-raster");
    command_write_file(path, "timestamp,AU12_r\n0,1\n0.1,-3\n");
    expect(3, "bad.csv:3:5: expected an intensity of 0 to 5, found \"-3\"",
           "export " HEAD "--openface '%s' --at 0.1 -o x.obj", path);
}

static void render_tells_the_speed(void **state)
{
    (void)state;
    expect(0, NULL, "render " HEAD "--json --live-link '%s/two.csv' --no-raster", folder);
    json_t *root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    assert_true(json_number_value(json_object_get(root, "real_time_factor")) > 0);
    assert_true(json_number_value(json_object_get(root, "simulated_s")) > 1.9);
    json_decref(root);
    /* what was found in the file is told unless -q */
    expect(0, "columns that move",
           "render '" RIS_SOURCE_DIR
           "/assets/human' --device cpu --live-link '%s/two.csv' --no-raster --adjust "
           "mirror,center",
           folder);
}

static void openface_tells_what_it_bridged(void **state)
{
    (void)state;
    expect(0, "rows without a sure face",
           "render '" RIS_SOURCE_DIR "/assets/human' --device cpu --openface '%s/of.csv' --no-raster",
           folder);
    assert_non_null(strstr(run.err, "times real time"));
}

static void a_moment_is_exported(void **state)
{
    char path[COMMAND_PATH_SIZE + 16];
    (void)state;
    snprintf(path, sizeof path, "%s/at.obj", folder);
    expect(0, NULL, "export " HEAD "--live-link '%s/two.csv' --at 0.5 -o '%s'", folder, path);
    assert_true(command_exists(path));
}

/* Every viseme as an OBJ of its own, and the neutral head they are told apart from. */
static void a_set_is_exported(void **state)
{
    char path[COMMAND_PATH_SIZE + 32];
    (void)state;
    snprintf(path, sizeof path, "%s/set", folder);
    expect(2, "expected facs, arkit, visemes or expressions, found 'shapes'",
           "export " HEAD "--set shapes -o '%s'", path);
    expect(2, "makes its own poses", "export " HEAD "--set arkit --pose jaw.open=1 -o '%s'", path);
    expect(0, NULL, "export " HEAD "--set visemes -o '%s'", path);
    assert_int_equal(command_entries(path), 16);
    snprintf(path, sizeof path, "%s/set/viseme.aa.obj", folder);
    char *open = command_read_file(path);
    snprintf(path, sizeof path, "%s/set/neutral.obj", folder);
    char *neutral = command_read_file(path);
    assert_non_null(open);
    assert_non_null(neutral);
    assert_true(strcmp(open, neutral) != 0);
    free(open);
    free(neutral);
}

/* The frames of a short take hold the bounds of a held pose; a bound that nothing holds breaks, and names its time. */
static void frames_are_measured(void **state)
{
    (void)state;
    expect(0, NULL, "soak " HEAD "--json --live-link '%s/two.csv'", folder);
    json_t *root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    json_t *measures = json_object_get(root, "measures"), *measure;
    size_t k;
    double speed = 0;
    json_array_foreach(measures, k, measure)
    {
        assert_true(json_is_true(json_object_get(measure, "holds")));
        assert_int_equal(json_integer_value(json_object_get(measure, "poses")), 119);
        if (strcmp(json_string_value(json_object_get(measure, "name")), "speed") == 0) {
            const json_t *worst = json_array_get(json_object_get(measure, "worst"), 0);
            speed = json_number_value(json_object_get(worst, "value"));
            assert_true(json_number_value(json_object_get(worst, "time_s")) > 0);
            assert_non_null(strstr(json_string_value(json_object_get(worst, "pose")), "="));
        }
    }
    json_decref(root);
    print_message("fastest vertex %g mm/s\n", speed);
    assert_true(speed > 10 && speed < 1000); /* it moves, and no face leaps a metre a second */
    expect(1, "speed: ", "soak " HEAD "--live-link '%s/two.csv' --speed 1 --every 10", folder);
    assert_non_null(strstr(run.out, "11 of 11 frames, one in 10"));
    assert_non_null(strstr(run.out, "the frame at "));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_words),
        cmocka_unit_test(wrong_files),
        cmocka_unit_test(render_tells_the_speed),
        cmocka_unit_test(openface_tells_what_it_bridged),
        cmocka_unit_test(a_moment_is_exported),
        cmocka_unit_test(a_set_is_exported),
        cmocka_unit_test(frames_are_measured),
    };
    return cmocka_run_group_tests(tests, make_takes, NULL);
}
