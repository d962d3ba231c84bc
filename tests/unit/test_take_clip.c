/* A performance as a clip: sides, samples on time, gaps bridged within their ends, labels where columns are highest, columns that
 * the head has nothing for. */
#include "scratch.h"

#include "anim/take_clip.h"
#include "fake_model.h"

#include <math.h>

#define LL "Timecode,BlendShapeCount,"

static ris_clip *clip_of(ris_take_format format, const char *text, ris_take_info *info)
{
    const ris_take_def def = ris_default_take_def(format);
    ris_clip *clip;
    ris_error err = {0};
    if (ris__take_clip(&fake_model, "t.csv", text, strlen(text), &def, &clip, info, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    return clip;
}

static void near(const ris_clip *clip, double time_s, int channel, double wanted, double tolerance)
{
    float pose[FAKE_COUNT];
    memset(pose, 0x55, sizeof pose);
    ris_clip_sample(clip, time_s, pose);
    if (!(fabs((double)pose[channel] - wanted) <= tolerance)) {
        fail_msg("at %g s channel %d: expected %g, found %g", time_s, channel, wanted, (double)pose[channel]);
    }
}

static void samples_are_met_on_time(void **state)
{
    ris_take_info info;
    (void)state;
    ris_clip *clip =
        clip_of(RIS_TAKE_LIVE_LINK,
                LL "LeftEyeYaw,RightEyeYaw\n0:0:0:0,2,10,-5\n0:0:0:1,2,14,-5\n0:0:0:2,2,8,-7\n", &info);
    near(clip, 0, FAKE_YAW_L, 10, 1e-5);
    near(clip, 1 / 60.0, FAKE_YAW_L, 14, 1e-5);
    near(clip, 2 / 60.0, FAKE_YAW_L, 8, 1e-5);
    near(clip, 2 / 60.0, FAKE_YAW_R, -7, 1e-5);
    near(clip, 1, FAKE_YAW_R, -7, 1e-5); /* the ends hold */
    near(clip, -1, FAKE_YAW_L, 10, 1e-5);
    near(clip, 0.5 / 60, FAKE_YAW_L, 12, 1); /* between its samples */
    assert_true(fabs(ris_clip_duration_s(clip) - 2 / 60.0) < 1e-9);
    ris_clip_destroy(clip);
}

/* 0.2 s without samples: on the way from 4 to 8 and never beyond, without a step. */
static void gaps_are_bridged(void **state)
{
    ris_take_info info;
    double before = 4;
    (void)state;
    ris_clip *clip =
        clip_of(RIS_TAKE_LIVE_LINK,
                LL "LeftEyeYaw\n0:0:0:0,1,9\n0:0:0:1,1,4\n0:0:0:3,0\n0:0:0:13,1,8\n0:0:0:14,1,3\n", &info);
    assert_int_equal(info.gaps, 1);
    for (int i = 0; i <= 120; i++) {
        float pose[FAKE_COUNT];
        ris_clip_sample(clip, (1 + i * 0.1) / 60, pose);
        const double value = (double)pose[FAKE_YAW_L];
        assert_true(value >= 4 - 1e-4 && value <= 8 + 1e-4);
        assert_true(value - before >= -1e-4 && value - before < 0.06);
        before = value;
    }
    ris_clip_destroy(clip);
}

static void unsided_columns_move_both_sides(void **state)
{
    ris_take_info info;
    (void)state;
    ris_clip *clip = clip_of(RIS_TAKE_OPENFACE, "timestamp, gaze_angle_x\n0, 0.1\n0.5, 0.2\n1, 0.1\n", &info);
    near(clip, 0.5, FAKE_YAW_L, 11.4591559, 1e-4);
    near(clip, 0.5, FAKE_YAW_R, 11.4591559, 1e-4);
    ris_clip_destroy(clip);
}

static void labels_name_the_peaks(void **state)
{
    ris_take_info info;
    double time_s = -1;
    (void)state;
    ris_clip *clip = clip_of(
        RIS_TAKE_LIVE_LINK,
        LL "LeftEyeYaw,RightEyeYaw\n0:0:0:0,2,0,1\n0:0:1:0,2,30,1\n0:0:2:0,2,1,-20\n0:0:3:0,2,0,1\n", &info);
    assert_int_equal(ris_clip_label_count(clip), 2);
    assert_string_equal(ris_clip_label(clip, 0, &time_s), "eye.yaw.L");
    assert_true(time_s == 1);
    assert_string_equal(ris_clip_label(clip, 1, &time_s), "eye.yaw.R");
    assert_true(time_s == 2);
    ris_clip_destroy(clip);
    clip = clip_of(RIS_TAKE_LIVE_LINK, LL "LeftEyeYaw\n0:0:0:0,1,0\n0:0:1:0,1,0\n", &info);
    assert_string_equal(ris_clip_label(clip, 0, NULL), "rest");
    ris_clip_destroy(clip);
}

/* The fake head has eyes but no tongue; a file that moves nothing of it is refused. */
static void columns_for_nothing(void **state)
{
    const ris_take_def def = ris_default_take_def(RIS_TAKE_LIVE_LINK);
    static const char some[] = LL "LeftEyeYaw,HeadYaw\n0:0:0:0,2,10,5\n",
                      none[] = LL "HeadYaw\n0:0:0:0,1,5\n";
    ris_take_info info;
    ris_error err = {0};
    char text[512];
    (void)state;
    ris_clip *clip = clip_of(RIS_TAKE_LIVE_LINK, some, &info);
    assert_int_equal(info.unknown, 1);
    assert_string_equal(info.first_unknown, "head.yaw");
    assert_non_null(
        strstr(ris_take_describe(&info, text, sizeof text), "1 columns this head has nothing for"));
    ris_clip_destroy(clip);
    expect_error(&err, ris__take_clip(&fake_model, "t.csv", none, strlen(none), &def, &clip, &info, &err),
                 RIS_ERROR_DATA,
                 "t.csv: expected a column that moves this head, found none among 1; the first is head.yaw");
    assert_null(clip);
}

static void missing_file(void **state)
{
    const ris_take_def def = ris_default_take_def(RIS_TAKE_OPENFACE);
    ris_clip *clip;
    ris_error err = {0};
    (void)state;
    expect_error(&err, ris_take_load(&fake_model, "no_such_take.csv", &def, &clip, NULL, &err),
                 RIS_ERROR_DATA, "no_such_take.csv");
    assert_null(clip);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_met_on_time),
        cmocka_unit_test(gaps_are_bridged),
        cmocka_unit_test(unsided_columns_move_both_sides),
        cmocka_unit_test(labels_name_the_peaks),
        cmocka_unit_test(columns_for_nothing),
        cmocka_unit_test(missing_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
