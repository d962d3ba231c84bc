/* risorius soak as a user meets it: a bound that holds and the same bound broken, the words of a pose, JSON, interruption. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#define SOAK "soak '" RIS_SOURCE_DIR "/assets/human' --device cpu -q "
#define NO_BOUNDS                                                                                            \
    " --vertex 1000 --midpoint 1000 --lips 1000 --flipped 1 --mirror 1000 --speed 1000000 --no-single"

static run_result run;

static void expect(const char *line, int code, const char *in_err)
{
    command_run(&run, NULL, line);
    if (run.code != code || (in_err && !strstr(run.err, in_err))) {
        fail_msg("risorius %s: code %d (expected %d), stderr '%s' (expected '%s')", line, run.code, code,
                 run.err, in_err ? in_err : "");
    }
}

static void wrong_words_are_usage_errors(void **state)
{
    (void)state;
    expect("soak", 2, "HEAD");
    expect(SOAK "--poses -1", 2, "--poses");
    expect(SOAK "--poses many", 2, "--poses");
    expect(SOAK "--seed 5000000000", 2, "--seed");
    expect(SOAK "--worst 100000", 2, "--worst");
    expect(SOAK "--vertex nan", 2, "--vertex");
    expect(SOAK "--flipped 2", 2, "--flipped");
    expect(SOAK "--hold 1e9", 2, "--hold");
    expect(SOAK "--pose jaw.opem=1", 2, "jaw.open");
    expect(SOAK "--pos 3", 2, "--pose");
    expect("soak no_such_head --device cpu", 3, "no_such_head");
}

/* The mirror of a pose is never to the last bit the mirrored skin, so a bound of 0 must break. */
static void bounds_hold_and_break(void **state)
{
    (void)state;
    expect(SOAK "--pose zygomaticus_major.L=1,jaw.open=0.3,jaw.side=0.5" NO_BOUNDS, 0, NULL);
    assert_non_null(strstr(run.out, "1 of 1 poses"));
    assert_non_null(strstr(run.out, "skull, vertices"));
    assert_non_null(strstr(run.out, "mirror"));
    assert_non_null(strstr(run.out, "jaw.side=0.5"));
    assert_null(strstr(run.out, "BROKEN"));
    expect("soak '" RIS_SOURCE_DIR "/assets/human' --device cpu -q --pose zygomaticus_major.L=1,jaw.open=0.3 "
           "--vertex 1000 --midpoint 1000 --lips 1000 --flipped 1 --mirror 0",
           1, "mirror: ");
    assert_non_null(strstr(run.out, "BROKEN"));
    expect(SOAK "--pose jaw.open=1 --hold 0.1", 1, "");
    assert_non_null(strstr(run.out, "not at rest"));
    expect(SOAK
           "--pose jaw.open=1 --hold 0.1 --vertex 1000 --midpoint 1000 --lips 1000 --flipped 1 --mirror 1000",
           1, "not at rest: ");
}

static json_t *worst_of(json_t *root, const char *name)
{
    size_t k;
    json_t *measure;
    json_array_foreach(json_object_get(root, "measures"), k, measure)
    {
        if (strcmp(json_string_value(json_object_get(measure, "name")), name) == 0) {
            return json_array_get(json_object_get(measure, "worst"), 0);
        }
    }
    fail_msg("no measure %s", name);
    return NULL;
}

/* Ten random poses and one of all channels; the worst pose of a measure, given alone, finds the same to the bit. */
static void a_worst_pose_can_be_had_alone(void **state)
{
    (void)state;
    json_error_t error;
    expect(SOAK "--poses 10 --seed 3 --worst 2 --mirror-every 5 --json" NO_BOUNDS, 0, NULL);
    json_t *root = json_loads(run.out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(root);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "poses"), "done")), 11);
    assert_false(json_boolean_value(json_object_get(root, "interrupted")));
    json_t *worst = worst_of(root, "mandible, midpoints");
    const double value = json_real_value(json_object_get(worst, "value"));
    assert_true(value > 0);
    char line[8192];
    snprintf(line, sizeof line, SOAK "--json --pose %s" NO_BOUNDS,
             json_string_value(json_object_get(worst, "pose")));
    expect(line, 0, NULL);
    json_t *alone = json_loads(run.out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(alone);
    json_t *again = worst_of(alone, "mandible, midpoints");
    assert_true(json_real_value(json_object_get(again, "value")) == value);
    assert_int_equal(json_integer_value(json_array_get(json_object_get(again, "vertices"), 0)),
                     json_integer_value(json_array_get(json_object_get(worst, "vertices"), 0)));
    json_decref(root);
    json_decref(alone);
}

static void an_interrupt_keeps_what_was_measured(void **state)
{
    (void)state;
    const command_def def = {.interrupt_after_ms = 5000};
    command_run(&run, &def, SOAK "--poses 1000000" NO_BOUNDS);
    assert_int_equal(run.code, 130);
    assert_non_null(strstr(run.out, "interrupted"));
    assert_non_null(strstr(run.out, "skull, vertices"));
    assert_non_null(strstr(run.err, "interrupted"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_words_are_usage_errors),
        cmocka_unit_test(bounds_hold_and_break),
        cmocka_unit_test(a_worst_pose_can_be_had_alone),
        cmocka_unit_test(an_interrupt_keeps_what_was_measured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
