/* engine/output/label.c: letters differ, scale grows them, clipping never leaves the picture. */
#include "scratch.h"

#include "risorius/output.h"

enum { WIDTH = 120, HEIGHT = 40, EDGE = 64 };

/* Picture with guard bytes around it. */
static uint8_t store[EDGE + WIDTH * HEIGHT * 4 + EDGE];

static unsigned draw(int x, int y, int scale, const char *text)
{
    unsigned white = 0;
    memset(store, 100, sizeof store);
    ris_label_draw(store + EDGE, WIDTH, HEIGHT, x, y, scale, text);
    for (unsigned i = 0; i < EDGE; i++) {
        assert_int_equal(store[i], 100);
        assert_int_equal(store[sizeof store - 1 - i], 100);
    }
    for (unsigned i = 0; i < WIDTH * HEIGHT; i++) {
        white += store[EDGE + 4 * i] == 255;
    }
    return white;
}

static void test_draws(void **state)
{
    (void)state;
    static uint8_t other[sizeof store];
    unsigned one = draw(4, 4, 1, "smile"), two = draw(4, 4, 2, "smile");
    assert_true(one > 20);
    assert_int_equal(two, 4 * one);
    draw(4, 4, 2, "frown");
    memcpy(other, store, sizeof store);
    draw(4, 4, 2, "smile");
    assert_memory_not_equal(other, store, sizeof store);
    unsigned dark = 0;
    for (unsigned i = 0; i < WIDTH * HEIGHT; i++) {
        dark += store[EDGE + 4 * i] < 50;
    }
    assert_true(dark > two / 2); /* readable on a light picture */
}

static void test_empty_and_outside(void **state)
{
    (void)state;
    assert_int_equal(draw(4, 4, 2, ""), 0);
    assert_int_equal(draw(4, 4, 0, "smile"), 0);
    assert_int_equal(draw(-500, -500, 2, "smile"), 0);
    assert_int_equal(draw(5000, 5000, 2, "smile"), 0);
    assert_true(draw(-8, -3, 3, "smile") > 0);
    assert_true(draw(WIDTH - 10, HEIGHT - 8, 3, "smile") > 0);
}

static void test_odd_text(void **state)
{
    (void)state;
    char longest[3000];
    memset(longest, 'M', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_true(draw(0, 0, 1, longest) > 0);
    assert_true(draw(0, 0, 1, "\x01\x7f\xc3\xa4\n~") > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draws),
        cmocka_unit_test(test_empty_and_outside),
        cmocka_unit_test(test_odd_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
