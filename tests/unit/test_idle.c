/* Idle life: a sample depends on the time alone; rates, lids, saccades and drift are what the sources say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "anim/idle.h"

#include <math.h>
#include <string.h>

enum {
    UPPER_L,
    UPPER_R,
    LOWER_L,
    YAW_L,
    YAW_R,
    PITCH_L,
    PITCH_R,
    HEAD_YAW,
    HEAD_PITCH,
    HEAD_ROLL,
    HEAD_Y,
    COUNT
};

static ris_channel channel[COUNT] = {
    {"lid.upper.L", -1, 1},  {"lid.upper.R", -1, 1},   {"lid.lower.L", -1, 1},   {"eye.yaw.L", -35, 35},
    {"eye.yaw.R", -35, 35},  {"eye.pitch.L", -30, 30}, {"eye.pitch.R", -30, 30}, {"head.yaw", -80, 80},
    {"head.pitch", -60, 60}, {"head.roll", -45, 45},   {"head.y", -200, 200},
};
static const ris_model model = {.channel_count = COUNT, .channel = channel};

static void life(const ris_idle *idle, double time_s, float pose[COUNT])
{
    memset(pose, 0, COUNT * sizeof *pose);
    ris__idle_add(idle, time_s, 0, COUNT, pose);
}

static ris_idle *make(ris_idle_def def)
{
    ris_idle *idle = ris__idle_create(&def, &model);
    assert_non_null(idle);
    return idle;
}

static void test_depends_on_time_alone(void **state)
{
    (void)state;
    ris_idle *a = make(ris__idle_default), *b = make(ris__idle_default);
    float forward[600][COUNT], now[COUNT], part[COUNT] = {0};
    for (int i = 0; i < 600; i++) {
        life(a, i / 24.0, forward[i]);
    }
    for (int i = 0; i < 600; i++) { /* another order, the same seed */
        int k = i * 173 % 600;
        life(b, k / 24.0, now);
        assert_memory_equal(now, forward[k], sizeof now);
    }
    ris__idle_add(a, 10, 3, 4, part); /* channels 3 .. 6 alone */
    assert_memory_equal(part, forward[240] + 3, 4 * sizeof *part);
    assert_true(part[4] == 0);
    life(a, RIS_IDLE_ROUND_S + 10, now);
    for (int c = 0; c < COUNT; c++) { /* half an hour later the same */
        assert_float_equal(now[c], forward[240][c], 1e-5);
    }
    life(a, -1, now);
    for (int c = 0; c < COUNT; c++) {
        assert_true(now[c] == 0 && fabsf(forward[0][c]) < 1e-6f); /* begins at rest */
    }
    ris__idle_destroy(b);
    ris_idle_def other = ris__idle_default;
    other.seed++;
    b = make(other);
    int differing = 0;
    for (int i = 0; i < 600; i++) {
        life(b, i / 24.0, now);
        differing += memcmp(now, forward[i], sizeof now) != 0;
    }
    assert_true(differing > 500);
    ris__idle_destroy(a);
    ris__idle_destroy(b);
}

static void test_blinks(void **state)
{
    (void)state;
    ris_idle_def def = ris__idle_default;
    def.gazes_per_min = 0;
    ris_idle *idle = make(def);
    double minutes = RIS_IDLE_ROUND_S / 60, sum = 0, squares = 0;
    assert_true(fabs(idle->blink_count / minutes - 15) < 1.5); /* 450 of them */
    for (uint32_t i = 0; i < idle->blink_count; i++) {
        const ris_blink *blink = &idle->blink[i];
        assert_true(blink->close_s >= 0.1 && blink->close_s <= 0.15);
        assert_true(blink->open_s >= 0.2 && blink->open_s <= 0.3);
        assert_true(blink->depth > 0.9 && blink->depth <= 1);
        if (i > 0) {
            double wait = blink->start_s - blink[-1].start_s;
            assert_true(wait >= blink[-1].close_s + RIS_BLINK_HOLD_S + blink[-1].open_s);
            sum += wait;
            squares += wait * wait;
        }
    }
    uint32_t n = idle->blink_count - 1;
    double mean = sum / n, deviation = sqrt(squares / n - mean * mean);
    assert_true(deviation / mean > 0.45 && deviation / mean < 0.75); /* 3.1 / 5.2 of the source */
    /* one of them: rises to its depth, comes back, slower than it went; both lids alike */
    const ris_blink *blink = &idle->blink[5];
    float pose[COUNT], before = -1;
    for (int i = 0; i <= 100; i++) {
        life(idle, blink->start_s + blink->close_s * i / 100, pose);
        assert_true(pose[UPPER_L] >= before && pose[UPPER_R] == pose[UPPER_L]);
        before = pose[UPPER_L];
    }
    assert_float_equal(before, blink->depth, 1e-6);
    assert_float_equal(pose[LOWER_L], 0.15 * blink->depth, 1e-6);
    for (int i = 1; i <= 100; i++) {
        life(idle, blink->start_s + blink->close_s + RIS_BLINK_HOLD_S + blink->open_s * i / 100, pose);
        assert_true(pose[UPPER_L] <= before);
        before = pose[UPPER_L];
    }
    assert_true(before < 1e-6f);
    ris__idle_destroy(idle);
    def.blinks_per_min = 0;
    idle = make(def);
    assert_int_equal(idle->blink_count, 0);
    ris__idle_destroy(idle);
}

/* Duration by the main sequence, both eyes the same way; blinks come along with the large ones. */
static void test_gaze(void **state)
{
    (void)state;
    ris_idle_def def = ris__idle_default;
    def.head_deg = def.breath_deg = def.saccades_per_s = 0;
    def.gaze_deg = 12;
    def.gazes_per_min = 30;
    def.blinks_per_min = 0.1;
    ris_idle *idle = make(def);
    assert_true(fabs(idle->gaze_count / (RIS_IDLE_ROUND_S / 60) - 30) < 3);
    uint32_t back = 0;
    for (uint32_t i = 1; i < idle->gaze_count; i++) {
        const ris_shift *to = &idle->gaze[i];
        double size = hypot(to->yaw_deg - to[-1].yaw_deg, to->pitch_deg - to[-1].pitch_deg);
        if (i + 1 < idle->gaze_count) {
            assert_float_equal(to->duration_s, 0.021 + 0.0022 * size, 1e-12);
        }
        assert_true(to->start_s > to[-1].start_s + to[-1].duration_s);
        back += to->yaw_deg == 0;
        float pose[COUNT];
        life(idle, to->start_s + to->duration_s, pose);
        assert_float_equal(pose[YAW_L], to->yaw_deg, 1e-5);
        assert_float_equal(pose[PITCH_R], to->pitch_deg, 1e-5);
        assert_true(pose[YAW_L] == pose[YAW_R] && pose[PITCH_L] == pose[PITCH_R]);
    }
    /* home is left at once and three of five go back there: 0.375 of them */
    assert_float_equal((double)back / idle->gaze_count, 0.375, 0.03);
    assert_true(idle->blink_count > idle->gaze_count / 8 && idle->blink_count < idle->gaze_count * 2 / 3);
    ris__idle_destroy(idle);
}

static void test_saccades(void **state)
{
    (void)state;
    ris_idle *idle = make(ris__idle_default);
    double size = 0;
    for (uint32_t i = 1; i < idle->saccade_count; i++) {
        const ris_shift *to = &idle->saccade[i];
        size += hypot(to->yaw_deg - to[-1].yaw_deg, to->pitch_deg - to[-1].pitch_deg);
    }
    assert_float_equal(size / (idle->saccade_count - 1), 0.4, 0.04);
    assert_true(fabs(idle->saccade_count / RIS_IDLE_ROUND_S - 1.2) < 0.15);
    ris__idle_destroy(idle);
}

/* The head's drift: its deviation, smooth, and eyes that look past it. */
static void test_head(void **state)
{
    (void)state;
    ris_idle_def def = ris__idle_default;
    def.gazes_per_min = def.saccades_per_s = def.breath_deg = 0;
    ris_idle *idle = make(def);
    float pose[COUNT], before[COUNT];
    double squares = 0, fastest = 0;
    for (int i = 0; i < 54000; i++) {
        life(idle, 60 + i / 60.0, pose);
        squares += (double)pose[HEAD_YAW] * (double)pose[HEAD_YAW];
        assert_float_equal(pose[YAW_L] + pose[HEAD_YAW], 0, 1e-6);
        assert_float_equal(pose[PITCH_R] + pose[HEAD_PITCH], 0, 1e-6);
        if (i > 0) {
            fastest = fmax(fastest, 60 * fabs((double)pose[HEAD_YAW] - (double)before[HEAD_YAW]));
        }
        memcpy(before, pose, sizeof pose);
    }
    assert_float_equal(sqrt(squares / 54000), 0.6, 0.06);
    assert_true(fastest > 0.3 && fastest < 3); /* deg/s */
    ris__idle_destroy(idle);
}

static void test_breath(void **state)
{
    (void)state;
    ris_idle_def def = {.breaths_per_min = 15, .breath_deg = 0.5};
    ris_idle *idle = make(def);
    float pose[COUNT];
    static const double known[][2] = {{0, 0},     {0.8, 0.5}, {1.6, 1},
                                      {2.8, 0.5}, {4, 0},     {401.6, 1}}; /* of 4 s */
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        life(idle, known[i][0], pose);
        assert_float_equal(pose[HEAD_PITCH], 0.5 * known[i][1], 1e-5);
        assert_float_equal(pose[HEAD_Y], known[i][1], 1e-5);
        assert_float_equal(pose[PITCH_L], -0.5 * known[i][1], 1e-5);
        assert_true(pose[HEAD_YAW] == 0 && pose[UPPER_L] == 0);
    }
    bool touches[COUNT] = {false};
    ris__idle_touch(idle, touches);
    for (int c = 0; c < COUNT; c++) {
        assert_true(touches[c]);
    }
    ris__idle_destroy(idle);
}

/* A model without lids, eyes and head: nothing to move, nothing broken. */
static void test_model_without_channels(void **state)
{
    (void)state;
    static ris_channel only[] = {{"zygomaticus_major.L", 0, 1}};
    const ris_model bare = {.channel_count = 1, .channel = only};
    ris_idle *idle = ris__idle_create(&ris__idle_default, &bare);
    float pose[1] = {0};
    bool touches[1] = {false};
    ris__idle_add(idle, 10, 0, 1, pose);
    ris__idle_touch(idle, touches);
    assert_true(pose[0] == 0 && !touches[0]);
    ris__idle_destroy(idle);
    ris__idle_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_depends_on_time_alone),
        cmocka_unit_test(test_blinks),
        cmocka_unit_test(test_gaze),
        cmocka_unit_test(test_saccades),
        cmocka_unit_test(test_head),
        cmocka_unit_test(test_breath),
        cmocka_unit_test(test_model_without_channels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
