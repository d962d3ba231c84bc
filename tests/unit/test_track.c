/* KA-50: eases by their formulas, curves that repeat, the exponential the engine has of its own. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "anim/track.h"
#include "base/pcg.h"
#include "base/real.h"

#include <math.h>
#include <string.h>

static void test_eases(void **state)
{
    (void)state;
    static const struct {
        ris_ease ease;
        const char *name;
        double quarter, half, three_quarters;
    } known[] = {
        {RIS_EASE_STEP, "step", 0, 0, 0},
        {RIS_EASE_LINEAR, "linear", 0.25, 0.5, 0.75},
        {RIS_EASE_CUBIC, "cubic", 0.15625, 0.5, 0.84375},
        {RIS_EASE_IN, "in", 0.0625, 0.25, 0.5625},
        {RIS_EASE_OUT, "out", 0.4375, 0.75, 0.9375},
        {RIS_EASE_IN_OUT, "in_out", 0.125, 0.5, 0.875},
        {RIS_EASE_MINIMUM_JERK, "minimum_jerk", 0.103515625, 0.5, 0.896484375},
        {RIS_EASE_BACK_IN, "back_in", -0.0641365625, -0.0876975, 0.1825903125},
        {RIS_EASE_BACK_OUT, "back_out", 0.8174096875, 1.0876975, 1.0641365625},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        ris_ease ease = known[i].ease;
        assert_string_equal(ris__ease_names[ease], known[i].name);
        assert_true(fabs(ris__ease(ease, 0)) < 1e-15 && fabs(ris__ease(ease, 1) - 1) < 1e-15);
        assert_float_equal(ris__ease(ease, 0.25), known[i].quarter, 1e-12);
        assert_float_equal(ris__ease(ease, 0.5), known[i].half, 1e-12);
        assert_float_equal(ris__ease(ease, 0.75), known[i].three_quarters, 1e-12);
    }
    assert_null(ris__ease_names[sizeof known / sizeof known[0]]);
    double least = 0;
    for (int i = 0; i <= 1000; i++) {
        least = fmin(least, ris__ease(RIS_EASE_BACK_IN, i / 1000.0));
    }
    assert_float_equal(least, -0.1, 1e-5); /* a tenth back before it goes */
}

/* Keys 0: 0, 1: 1, 3: -1; in a round of 4 s the way from -1 to the 0 at 4 s has the slope of the way from 0 to 1. */
static void test_repeats(void **state)
{
    (void)state;
    ris_key key[4] = {{0, 0, 0, RIS_EASE_CUBIC}, {1, 1, 0, RIS_EASE_CUBIC}, {3, -1, 0, RIS_EASE_CUBIC}};
    ris_track track = {.key_count = 3, .key = key};
    ris__track_set_slopes(&track);
    assert_float_equal(ris__track_value(&track, 0.5), 0.5, 1e-12); /* from rest: the ends hold */
    assert_true(ris__track_value(&track, 3.5) == -1);
    ris__track_repeat(&track, 4);
    ris__track_set_slopes(&track);
    assert_int_equal(track.key_count, 4);
    assert_true(key[0].slope == 1 && key[3].slope == 1);
    assert_float_equal(ris__track_value(&track, 0.5), 0.625, 1e-12);
    assert_float_equal(ris__track_value(&track, 3.5), -0.625, 1e-12);
    assert_float_equal(ris__track_value(&track, 7.5), -0.625, 1e-12);
    assert_float_equal(ris__track_value(&track, -0.5), -0.625, 1e-12);
    double h = 1e-4; /* no kink where the rounds meet */
    assert_float_equal(ris__track_value(&track, 4 - h), -h, 1e-7);
    assert_float_equal(ris__track_value(&track, 4 + h), h, 1e-7);
}

/* First and last key at both ends of the round are one; with different values they jump. */
static void test_repeats_with_a_key_at_each_end(void **state)
{
    (void)state;
    ris_key key[4] = {
        {0, 0, 0, RIS_EASE_CUBIC}, {1, 1, 0, RIS_EASE_CUBIC}, {3, -1, 0, RIS_EASE_CUBIC}, {4, 0, 0, 0}};
    ris_track track = {.key_count = 4, .key = key};
    ris__track_repeat(&track, 4);
    ris__track_set_slopes(&track);
    assert_int_equal(track.key_count, 4);
    assert_float_equal(ris__track_value(&track, 3.5), -0.625, 1e-12);
    key[3].value = -0.5;
    ris__track_set_slopes(&track);
    assert_true(key[0].slope == 0 && key[3].slope == 0);
    assert_float_equal(ris__track_value(&track, 4 - 1e-9), -0.5, 1e-6);
    assert_true(ris__track_value(&track, 4) == 0);
}

/* A cubic beside an ease that comes to rest is at rest there too, beside one that arrives with speed it is not. */
static void test_cubic_beside_eases(void **state)
{
    (void)state;
    static const struct {
        ris_ease before;
        double slope;
    } known[] = {{RIS_EASE_LINEAR, 1.5},     {RIS_EASE_OUT, 0},  {RIS_EASE_IN_OUT, 0},
                 {RIS_EASE_MINIMUM_JERK, 0}, {RIS_EASE_STEP, 0}, {RIS_EASE_IN, 1.5}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        ris_key key[3] = {{0, 0, 0, known[i].before}, {1, 1, 0, RIS_EASE_CUBIC}, {2, 3, 0, 0}};
        ris_track track = {.key_count = 3, .key = key};
        ris__track_set_slopes(&track);
        assert_float_equal(key[1].slope, known[i].slope, 1e-12);
    }
}

static void test_exponential(void **state)
{
    (void)state;
    assert_true(ris__exp(0) == 1);
    assert_true(ris__exp(-1e9) == 0 && ris__exp(-HUGE_VAL) == 0 && ris__exp(NAN) == 0);
    assert_true(isfinite(ris__exp(1e9)));
    for (double x = -600; x < 600; x += 0.37) {
        assert_true(fabs(ris__exp(x) - exp(x)) <= 4e-16 * exp(x));
    }
}

static void test_normal_numbers(void **state)
{
    (void)state;
    ris_pcg pcg = ris__pcg_start(3, 4);
    double sum = 0, squares = 0, most = 0;
    for (int i = 0; i < 20000; i++) {
        double x = ris__pcg_normal(&pcg);
        sum += x;
        squares += x * x;
        most = fmax(most, fabs(x));
    }
    assert_float_equal(sum / 20000, 0, 0.03); /* deviation of the mean: 0.007 */
    assert_float_equal(squares / 20000, 1, 0.04);
    assert_true(most > 3 && most < 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eases),
        cmocka_unit_test(test_repeats),
        cmocka_unit_test(test_repeats_with_a_key_at_each_end),
        cmocka_unit_test(test_cubic_beside_eases),
        cmocka_unit_test(test_exponential),
        cmocka_unit_test(test_normal_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
