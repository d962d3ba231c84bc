/* The stage activation: its exponential, the step by hand, bounds and arrival, and who follows how fast. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scenes/scenes.h"
#include "sim/rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define X60 1.0804778250 /* 1000/60 ms x 3.88972017 / 60 ms */

static ris_error err;

static void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static void the_series_is_the_exponential(void **state)
{
    (void)state;
    static const double x[] = {0, 1e-9, 0.03, 0.0625, 0.1, 1, X60, 5, 20, 65, 700};
    for (size_t k = 0; k < sizeof x / sizeof *x; ++k) {
        assert_true(fabs(ris__decay(x[k]) - exp(-x[k])) < 1e-11 * exp(-x[k]) + 1e-16);
    }
}

/* 1 - (1 + n x) exp(-n x) after n ticks: 0.29382, 0.63581, 0.83413 ... for 60 ms; 90 % after 3 ticks for 50 ms. */
static void a_step_by_hand(void **state)
{
    (void)state;
    static const double first_three[] = {0.29382, 0.63581, 0.83413};
    double a = 0, b = 0;
    for (int n = 1; n <= 12; ++n) {
        ris__follow(ris__pace(60), 1, &a, &b);
        assert_true(fabs(a - (1.0 - exp(-n * X60))) < 1e-6);
        assert_true(fabs(b - (1.0 - (1.0 + n * X60) * exp(-n * X60))) < 1e-6);
        assert_true(n > 3 || fabs(b - first_three[n - 1]) < 1e-5);
    }
    a = b = 0;
    for (int n = 0; n < 3; ++n) {
        assert_true(b < 0.89);
        ris__follow(ris__pace(50), 1, &a, &b);
    }
    assert_true(fabs(b - 0.9) < 1e-6);
    a = b = 0.8;
    for (int n = 0; n < 6; ++n) {
        ris__follow(ris__pace(100), 0.3, &a, &b);
    }
    assert_true(fabs(b - 0.35) < 1e-6);
}

static void no_time_is_at_once(void **state)
{
    (void)state;
    double a = 0.25, b = 0.125;
    ris__follow(ris__pace(0), 0.7, &a, &b);
    assert_true(a == 0.7 && b == 0.7);
}

/* A held value is reached to the bit, without overshoot, and nothing leaves the range of what was asked for. */
static void it_arrives_and_never_overshoots(void **state)
{
    (void)state;
    static const float times[] = {1, 17, 60, 120, 500, 2000};
    for (size_t k = 0; k < sizeof times / sizeof *times; ++k) {
        const ris_pace pace = ris__pace(times[k]);
        double a = 0, b = 0, before = 0;
        int n = 0;
        for (; n < 1000 && b != 0.7; ++n, before = b) {
            ris__follow(pace, 0.7, &a, &b);
            assert_true(b >= before && b <= 0.7);
        }
        assert_true(n < 600 && a == 0.7);
        for (n = 0; n < 1000 && b != 0; ++n, before = b) {
            ris__follow(pace, 0, &a, &b);
            assert_true(b <= before && b >= 0);
        }
        assert_true(n < 600 && a == 0);
        uint32_t seed = 5;
        for (n = 0; n < 2000; ++n) {
            seed = seed * 1664525u + 1013904223u;
            ris__follow(pace, (double)seed / 4294967296.0, &a, &b);
            assert_true(a >= 0 && a <= 1 && b >= 0 && b <= 1);
        }
    }
}

typedef struct fixture {
    ris_model *model;
    ris_rig rig;
    float *pose;
} fixture;

static fixture open_fixture(ris_tissue_model tissue)
{
    fixture f = {0};
    ris_scene_def def = ris_default_scene_def();
    def.tissue.model = tissue;
    def.tissue.substeps = tissue == RIS_TISSUE_KAEHLER ? 64 : def.tissue.substeps;
    def.dynamics = ris_default_dynamics();
    need(ris_scene_model(&def, &f.model, &err));
    need(ris__rig_init(&f.rig, f.model, &err));
    f.pose = calloc(f.model->channel_count, sizeof *f.pose);
    assert_non_null(f.pose);
    return f;
}

static void close_fixture(fixture *f)
{
    ris__rig_finish(&f->rig);
    ris_model_destroy(f->model);
    free(f->pose);
}

static float value(const fixture *f, const char *channel)
{
    const uint32_t c = ris_model_channel(f->model, channel);
    assert_true(c < f->model->channel_count);
    return f->rig.pose[c];
}

static void ask_for(fixture *f, float share)
{
    for (uint32_t c = 0; c < f->model->channel_count; ++c) {
        f->pose[c] = share * f->model->channel[c].maximum;
    }
}

static void everything_in_its_own_time(void **state)
{
    (void)state;
    fixture f = open_fixture(RIS_TISSUE_RISORIUS);
    ask_for(&f, 1.0f);
    ris__activation(&f.rig, f.pose, false);
    const float muscle = value(&f, "zygomaticus_major.L"), lid = value(&f, "lid.upper.L"),
                jaw = value(&f, "jaw.open");
    assert_true(fabsf(muscle - 0.29382f) < 1e-4f);
    assert_true(lid > muscle && muscle > jaw && jaw > 0.0f);
    assert_true(value(&f, "orbicularis_oris_superior.protrude") == muscle);
    assert_true(value(&f, "tongue.out") == muscle && value(&f, "cheek.puff.L") == muscle);
    assert_true(value(&f, "eye.yaw.L") == 35.0f && value(&f, "head.pitch") == 60.0f &&
                value(&f, "head.x") == 200.0f);
    /* release is slower */
    ris__activation(&f.rig, f.pose, true);
    assert_memory_equal(f.rig.pose, f.pose, f.model->channel_count * sizeof *f.pose);
    ask_for(&f, 0.0f);
    ris__activation(&f.rig, f.pose, false);
    assert_true(1.0f - value(&f, "zygomaticus_major.L") < muscle);
    assert_true(value(&f, "eye.yaw.L") == 0.0f);
    ris__rig_reset(&f.rig);
    assert_true(value(&f, "zygomaticus_major.L") == 0.0f);
    close_fixture(&f);
    f = open_fixture(RIS_TISSUE_KAEHLER);
    ask_for(&f, 1.0f);
    ris__activation(&f.rig, f.pose, false);
    assert_memory_equal(f.rig.pose, f.pose, f.model->channel_count * sizeof *f.pose);
    close_fixture(&f);
}

/* What is held, and what a recorded performance plays, is there with the first tick. */
static void a_recorded_pose_is_there_at_once(void **state)
{
    (void)state;
    fixture f = open_fixture(RIS_TISSUE_RISORIUS);
    ris_sim *sim = NULL;
    ris_hold hold;
    need(ris_sim_create_cpu(f.model, &sim, &err));
    f.pose[0] = 0.75f;
    need(ris_sim_tick(sim, f.pose, &err));
    assert_true(ris_sim_activation(sim, 0) > 0.1f && ris_sim_activation(sim, 0) < 0.5f);
    ris_sim_set_onset(sim, false);
    need(ris_sim_tick(sim, f.pose, &err));
    assert_true(ris_sim_activation(sim, 0) == 0.75f);
    ris_sim_set_onset(sim, true);
    f.pose[0] = 0.0f;
    need(ris_sim_tick(sim, f.pose, &err));
    assert_true(ris_sim_activation(sim, 0) > 0.4f);
    need(ris_sim_hold(sim, f.pose, RIS_TICK_S, &hold, &err));
    assert_true(ris_sim_activation(sim, 0) == 0.0f);
    ris_sim_destroy(sim);
    close_fixture(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_series_is_the_exponential),
        cmocka_unit_test(a_step_by_hand),
        cmocka_unit_test(no_time_is_at_once),
        cmocka_unit_test(it_arrives_and_never_overshoots),
        cmocka_unit_test(everything_in_its_own_time),
        cmocka_unit_test(a_recorded_pose_is_there_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
