/* Random poses of the soak: the published numbers of PCG32, and what a pose may hold. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "fake_model.h"
#include "measure/soak_pose.h"
#include "risorius/timeline.h"

#include <stdlib.h>
#include <string.h>

/* The generator's own demonstration: seed 42, sequence 54. */
static void pcg_gives_the_published_numbers(void **state)
{
    (void)state;
    static const uint32_t known[] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    ris_pcg pcg = ris__pcg_start(42, 54);
    for (size_t k = 0; k < sizeof known / sizeof *known; ++k) {
        assert_int_equal(ris__pcg_next(&pcg), known[k]);
    }
}

static void numbers_below_a_limit_are_even(void **state)
{
    (void)state;
    uint32_t seen[6] = {0};
    ris_pcg pcg = ris__pcg_start(1, 2);
    for (int k = 0; k < 60000; ++k) {
        const uint32_t n = ris__pcg_below(&pcg, 6);
        assert_in_range(n, 0, 5);
        ++seen[n];
    }
    for (int k = 0; k < 6; ++k) {
        assert_in_range(seen[k], 9500, 10500); /* five standard deviations are 456 */
    }
}

static ris_channel channel[] = {
    {"a.L", 0, 1},         {"a.R", 0, 1},         {"jaw.side", -1, 1}, {"eye.yaw.L", -35, 35},
    {"head.yaw", -80, 80}, {"head.x", -200, 200}, {"b", 0, 1},         {"c", 0, 1}};
static ris_head head;
static const ris_model model = {.head = &head, .channel_count = 8, .channel = channel};

static char *text_of(uint64_t seed, ris_soak_kind kind, uint32_t number)
{
    char *text = ris__soak_pose_text(&model, seed, (ris_soak_id){kind, number});
    assert_non_null(text);
    return text;
}

static uint32_t terms(const char *text)
{
    uint32_t count = 1;
    for (; *text; ++text) {
        count += *text == ',';
    }
    return count;
}

static void few_channels(void **state)
{
    (void)state;
    uint32_t seen[7] = {0}, used[8] = {0};
    float pose[8];
    ris_error err;
    for (uint32_t i = 0; i < 3000; ++i) {
        char *text = text_of(7, RIS_SOAK_FEW, i);
        const uint32_t count = terms(text);
        uint32_t nonzero = 0;
        assert_in_range(count, 1, 6);
        assert_null(strstr(text, "head."));
        assert_int_equal(ris_pose_parse(&model, text, pose, &err), RIS_OK);
        for (int c = 0; c < 8; ++c) {
            assert_true(pose[c] >= channel[c].minimum && pose[c] <= channel[c].maximum);
            nonzero += pose[c] != 0.0f;
            used[c] += pose[c] != 0.0f;
        }
        assert_true(nonzero <= count); /* less only where a value is 0 */
        ++seen[count];
        free(text);
    }
    for (int k = 1; k <= 6; ++k) {
        assert_in_range(seen[k], 400, 600);
    }
    for (int c = 0; c < 8; ++c) {
        assert_true(c == 4 || c == 5 ? used[c] == 0 : used[c] > 1000);
    }
}

static void poses_are_known_by_number(void **state)
{
    (void)state;
    char *a = text_of(1, RIS_SOAK_FEW, 17), *b = text_of(1, RIS_SOAK_FEW, 17),
         *c = text_of(2, RIS_SOAK_FEW, 17), *d = text_of(1, RIS_SOAK_FEW, 18),
         *all = text_of(1, RIS_SOAK_ALL, 17);
    assert_string_equal(a, b);
    assert_string_not_equal(a, c);
    assert_string_not_equal(a, d);
    assert_int_equal(terms(all), 6);
    assert_null(strstr(all, "head."));
    /* every machine's words of this pose */
    assert_string_equal(a, "b=0.391,a.L=0.717,c=0.778,jaw.side=-0.956,a.R=0.224");
    free(a);
    free(b);
    free(c);
    free(d);
    free(all);
}

static void single_channels_at_their_ends(void **state)
{
    (void)state;
    static const char *const expected[] = {"a.L=1",         "a.R=1",        "jaw.side=-1",  "jaw.side=1",
                                           "eye.yaw.L=-35", "eye.yaw.L=35", "head.yaw=-80", "head.yaw=80",
                                           "head.x=-200",   "head.x=200",   "b=1",          "c=1"};
    assert_int_equal(ris__soak_single_count(&model), 12);
    for (uint32_t i = 0; i < 12; ++i) {
        char *text = text_of(1, RIS_SOAK_SINGLE, i);
        assert_string_equal(text, expected[i]);
        free(text);
    }
    assert_null(ris__soak_pose_text(&model, 1, (ris_soak_id){RIS_SOAK_SINGLE, 12}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pcg_gives_the_published_numbers),
        cmocka_unit_test(numbers_below_a_limit_are_even),
        cmocka_unit_test(few_channels),
        cmocka_unit_test(poses_are_known_by_number),
        cmocka_unit_test(single_channels_at_their_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
