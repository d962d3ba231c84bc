/* KA-50: clips are sampled by time; linear mid-way is the mean of the keys, the spline passes through them,
 * any order of times gives the same values; empty and wrong clips are refused with their place. */
#include "scratch.h"

#include "anim/clip.h"
#include "fake_model.h"

#include <math.h>

#define START "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4,"
#define CLIP(tracks) START "\"tracks\":[" tracks "]}"
#define TRACK(target, keys) "{\"target\":\"" target "\",\"keys\":[" keys "]}"

static ris_clip *clip_of(const char *text)
{
    ris_clip *clip;
    ris_error err = {0};
    ris_result result = ris__clip_parse(&fake_model, "t.json", text, strlen(text), &clip, &err);
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
    }
    assert_int_equal(result, RIS_OK);
    return clip;
}

static float sample(const ris_clip *clip, double time_s, int channel)
{
    float pose[FAKE_COUNT];
    memset(pose, 0x55, sizeof pose);
    ris_clip_sample(clip, time_s, pose);
    return pose[channel];
}

static void test_linear_and_step(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(CLIP(TRACK(
        "jaw.open",
        "{\"t\":1,\"v\":0.2,\"ease\":\"linear\"},{\"t\":2,\"v\":0.6,\"ease\":\"step\"},{\"t\":3,\"v\":1}")));
    assert_true(ris_clip_duration_s(clip) == 4);
    assert_true(sample(clip, 0, FAKE_JAW) == 0.2f); /* the ends hold */
    assert_true(sample(clip, -9, FAKE_JAW) == 0.2f);
    assert_true(sample(clip, 1, FAKE_JAW) == 0.2f);
    assert_float_equal(sample(clip, 1.5, FAKE_JAW), 0.4, 1e-7); /* mid-way: the mean of the keys */
    assert_float_equal(sample(clip, 1.25, FAKE_JAW), 0.3, 1e-7);
    assert_true(sample(clip, 2, FAKE_JAW) == 0.6f);
    assert_true(sample(clip, 2.999999, FAKE_JAW) == 0.6f);
    assert_true(sample(clip, 3, FAKE_JAW) == 1);
    assert_true(sample(clip, 99, FAKE_JAW) == 1);
    assert_true(sample(clip, 2, FAKE_ORIS) == 0);
    ris_clip_destroy(clip);
}

static void test_default_ease_is_linear(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":0},{\"t\":4,\"v\":1}")));
    assert_true(sample(clip, 1, FAKE_JAW) == 0.25f);
    ris_clip_destroy(clip);
}

static void test_cubic(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(CLIP(TRACK(
        "eye.yaw.L",
        "{\"t\":0,\"v\":0,\"ease\":\"cubic\"},{\"t\":1,\"v\":10,\"ease\":\"cubic\"},"
        "{\"t\":1.1,\"v\":30,\"ease\":\"cubic\"},{\"t\":3,\"v\":30,\"ease\":\"cubic\"},{\"t\":4,\"v\":-5}")));
    static const double key_t[] = {0, 1, 1.1, 3, 4}, key_v[] = {0, 10, 30, 30, -5};
    for (int k = 0; k < 5; k++) { /* passes through the keys */
        assert_float_equal(sample(clip, key_t[k], FAKE_YAW_L), key_v[k], 1e-5);
    }
    for (int k = 0; k < 4; k++) { /* between two keys it goes one way and stays between them */
        float before = sample(clip, key_t[k], FAKE_YAW_L);
        for (int i = 1; i <= 200; i++) {
            double t = key_t[k] + (key_t[k + 1] - key_t[k]) * i / 200;
            float now = sample(clip, t, FAKE_YAW_L);
            assert_true(key_v[k + 1] >= key_v[k] ? now >= before - 1e-4f : now <= before + 1e-4f);
            assert_true(now <= fmax(key_v[k], key_v[k + 1]) + 1e-4 &&
                        now >= fmin(key_v[k], key_v[k + 1]) - 1e-4);
            before = now;
        }
    }
    ris_clip_destroy(clip);
}

/* Two keys: the ends hold, so the cubic starts and ends at rest: 3s^2 - 2s^3. */
static void test_cubic_of_two_keys(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of(CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":0,\"ease\":\"cubic\"},{\"t\":4,\"v\":1}")));
    assert_float_equal(sample(clip, 1, FAKE_JAW), 0.15625, 1e-7);
    assert_float_equal(sample(clip, 2, FAKE_JAW), 0.5, 1e-7);
    ris_clip_destroy(clip);
}

/* Equal secants: the slope of the inner key is theirs; the cubic has no kink there, a linear track with other
 * slopes has. */
static void test_cubic_is_smooth(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(CLIP(TRACK(
        "eye.yaw.L",
        "{\"t\":0,\"v\":0,\"ease\":\"cubic\"},{\"t\":1,\"v\":8,"
        "\"ease\":\"cubic\"},{\"t\":3,\"v\":20}") "," TRACK("eye.yaw.R", "{\"t\":0,\"v\":0},{\"t\":1,\"v\":8}"
                                                                         ",{\"t\":3,\"v\":20}")));
    double h = 1e-2;
    double left = (8 - (double)sample(clip, 1 - h, FAKE_YAW_L)) / h,
           right = ((double)sample(clip, 1 + h, FAKE_YAW_L) - 8) / h;
    assert_true(fabs(left - right) < 0.3);
    assert_float_equal(clip->layer[0].track[0].key[1].slope, 7, 1e-12); /* mean of the secants 8 and 6 */
    left = (8 - (double)sample(clip, 1 - h, FAKE_YAW_R)) / h;
    right = ((double)sample(clip, 1 + h, FAKE_YAW_R) - 8) / h;
    assert_true(fabs(left - right) > 1.9);
    ris_clip_destroy(clip);
}

static void test_order_of_samples(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(
        CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":0,\"ease\":\"cubic\"},{\"t\":1.5,\"v\":1,\"ease\":\"linear\"},"
                               "{\"t\":2,\"v\":0.1,\"ease\":\"step\"},{\"t\":4,\"v\":1}")));
    static float forward[401];
    for (int i = 0; i <= 400; i++) {
        forward[i] = sample(clip, i / 100.0, FAKE_JAW);
    }
    for (int i = 0; i <= 400; i++) {
        int shuffled = i * 173 % 401;
        assert_true(sample(clip, shuffled / 100.0, FAKE_JAW) == forward[shuffled]);
    }
    ris_clip_destroy(clip);
}

static void test_tracks_add_then_clamp(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(
        START "\"expressions\":{\"half\":{\"zygomaticus_major\":0.5},\"smile\":{\"half\":1,\"frontalis_inner."
              "R\":1}},"
              "\"tracks\":[" TRACK("smile", "{\"t\":0,\"v\":0},{\"t\":4,\"v\":2}") "," TRACK(
                  "zygomaticus_major.L",
                  "{\"t\":0,\"v\":0.25}") "," TRACK("grin", "{\"t\":0,\"v\":0},{\"t\":3,\"v\":0,\"ease\":"
                                                            "\"step\"},{\"t\":3.5,\"v\":0.5}") "]}");
    /* the clip's smile hides the head's; the head's grin still means the head's smile */
    assert_float_equal(sample(clip, 1, FAKE_ZYGO_L), 0.5, 1e-7);
    assert_float_equal(sample(clip, 1, FAKE_ZYGO_R), 0.25, 1e-7);
    assert_float_equal(sample(clip, 1, FAKE_FRONT_R), 0.5, 1e-7);
    assert_true(sample(clip, 1, FAKE_JAW) == 0);
    assert_true(sample(clip, 4, FAKE_ZYGO_L) == 1);
    assert_true(sample(clip, 4, FAKE_FRONT_R) == 1);
    assert_float_equal(sample(clip, 4, FAKE_JAW), 0.25, 1e-7);
    assert_float_equal(sample(clip, 4, FAKE_FRONT_L), 0.5, 1e-7);
    ris_clip_destroy(clip);
}

static void expect_label(const ris_clip *clip, uint32_t index, double time_s, const char *name)
{
    double t = -1;
    const char *label = ris_clip_label(clip, index, &t);
    assert_non_null(label);
    assert_string_equal(label, name);
    assert_true(t == time_s);
}

static void test_labels(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(
        START "\"labels\":[{\"t\":0.5,\"name\":\"jaw open\"},{\"t\":4,\"name\":\"back\"}],\"tracks\":[" TRACK(
            "jaw.open", "{\"t\":0,\"v\":1}") "]}");
    assert_int_equal(ris_clip_label_count(clip), 2);
    expect_label(clip, 0, 0.5, "jaw open");
    expect_label(clip, 1, 4, "back");
    assert_null(ris_clip_label(clip, 2, NULL));
    ris_clip_destroy(clip);
    /* without labels: key times at which the pose is another than the one before, named after what acts */
    clip = clip_of(CLIP(
        TRACK("smile", "{\"t\":0,\"v\":0},{\"t\":1,\"v\":1},{\"t\":2,\"v\":1},{\"t\":3,\"v\":0}") "," TRACK(
            "eye.yaw", "{\"t\":2,\"v\":0},{\"t\":3,\"v\":35}")));
    assert_int_equal(ris_clip_label_count(clip), 3);
    expect_label(clip, 0, 0, "rest");
    expect_label(clip, 1, 1, "smile");
    expect_label(clip, 2, 3, "eye.yaw");
    ris_clip_destroy(clip);
}

static void test_refuses(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"{\"format\":\"risorius-clip\",\n\"version\":1,,", "t.json:2:13: "},
        {"{\"format\":\"risorius-head\",\"version\":1}", "format: expected \"risorius-clip\""},
        {"{\"format\":\"risorius-clip\",\"version\":3}", "version: expected 1, found 3"},
        {START "\"track\":[]}", "track: unknown key; nearest: tracks"},
        {START "\"tracks\":[]}", "tracks: the clip is empty: no tracks"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4}", "the clip is empty: no tracks"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":0,\"tracks\":[]}",
         "duration_s: the clip is empty: its duration is 0"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":-1,\"tracks\":[]}",
         "duration_s: expected a number of 0.001 to 86400, found -1"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":1e9,\"tracks\":[]}",
         "duration_s: expected a number of 0.001 to 86400"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"tracks\":[]}", "expected the key \"duration_s\""},
        {CLIP(TRACK("jaw.open", "")), "tracks[0].keys: the clip is empty: a track without keys"},
        {CLIP("{\"target\":\"jaw.open\"}"), "tracks[0]: expected the key \"keys\""},
        {CLIP("{\"keys\":[]}"), "tracks[0]: expected the key \"target\""},
        {CLIP("\n" TRACK("zygomaticus_mayor", "{\"t\":0,\"v\":0}")),
         "t.json:2:11: tracks[0].target: unknown muscle, channel, unit, shape, viseme or expression "
         "\"zygomaticus_mayor\"; "
         "nearest: zygomaticus_major.L, zygomaticus_major.R"},
        {CLIP(TRACK("jaw.open", "{\"t\":1,\"v\":0},{\"t\":1,\"v\":0}")),
         "tracks[0].keys[1].t: expected a time after the key before (1 s), found 1"},
        {CLIP(TRACK("jaw.open", "{\"t\":1,\"v\":0},{\"t\":0.5,\"v\":0}")),
         "tracks[0].keys[1].t: expected a time after the key before"},
        {CLIP(TRACK("jaw.open", "{\"t\":5,\"v\":0}")),
         "tracks[0].keys[0].t: expected a number of 0 to 4, found 5"},
        {CLIP(TRACK("jaw.open", "{\"t\":-1,\"v\":0}")), "tracks[0].keys[0].t: expected a number of 0 to 4"},
        {CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":\"1\"}")), "tracks[0].keys[0].v: expected a number"},
        {CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":1,\"ease\":\"bounce\"}")),
         "tracks[0].keys[0].ease: expected one of step, linear, cubic, in, out, in_out, minimum_jerk, "
         "back_in, back_out, found \"bounce\""},
        {CLIP(TRACK("jaw.open", "{\"t\":0,\"v\":1,\"w\":1}")), "tracks[0].keys[0].w: unknown key"},
        {START "\"expressions\":{\"a\":{\"jaw.opn\":1}},\"tracks\":[]}",
         "expressions.a.jaw.opn: unknown muscle, channel, unit, shape, viseme or expression; nearest: "
         "jaw.open"},
        {START "\"expressions\":{\"zygomaticus_major\":{}},\"tracks\":[]}",
         "may not carry the name of a muscle or channel"},
        {START "\"labels\":[{\"t\":1,\"name\":\"a\"},{\"t\":1,\"name\":\"b\"}],\"tracks\":[" TRACK(
             "jaw.open", "{\"t\":0,\"v\":1}") "]}",
         "labels[1].t: expected a time after the label before"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ris_clip *clip = NULL;
        ris_error err = {0};
        expect_error(&err,
                     ris__clip_parse(&fake_model, "t.json", bad[i].text, strlen(bad[i].text), &clip, &err),
                     RIS_ERROR_DATA, bad[i].says);
        assert_null(clip);
    }
}

/* A synonym as target of a track and as term of an expression; an expression may not carry it. */
static void test_synonyms(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of(START "\"expressions\":{\"a\":{\"occipitofrontalis_inner.R\":0.5}},\"tracks\":[" TRACK(
            "a", "{\"t\":0,\"v\":1}") "," TRACK("occipitofrontalis_inner.L", "{\"t\":0,\"v\":0.25}") "]}");
    assert_true(sample(clip, 1, FAKE_FRONT_R) == 0.5f);
    assert_true(sample(clip, 1, FAKE_FRONT_L) == 0.25f);
    ris_clip_destroy(clip);
    const char *text = START "\"expressions\":{\"occipitofrontalis_inner\":{}},\"tracks\":[]}";
    ris_error err = {0};
    expect_error(&err, ris__clip_parse(&fake_model, "t.json", text, strlen(text), &clip, &err),
                 RIS_ERROR_DATA, "may not carry the name of a muscle or channel");
}

static void test_files(void **state)
{
    (void)state;
    ris_clip *clip;
    ris_error err = {0};
    expect_error(&err, ris_clip_load(&fake_model, scratch_path("absent.json"), &clip, &err), RIS_ERROR_DATA,
                 "absent.json: cannot open");
    assert_null(clip);
    const char *path = scratch_write("a.json", CLIP(TRACK("smile", "{\"t\":0,\"v\":1}")));
    assert_int_equal(ris_clip_load(&fake_model, path, &clip, &err), RIS_OK);
    assert_true(sample(clip, 2, FAKE_ZYGO_R) == 0.5f);
    ris_clip_destroy(clip);
    ris_clip_destroy(NULL);
    expect_error(&err, ris_clip_load(&fake_model, scratch_write("b.json", "{\n\n]"), &clip, &err),
                 RIS_ERROR_DATA, "b.json:3:1: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear_and_step),
        cmocka_unit_test(test_default_ease_is_linear),
        cmocka_unit_test(test_cubic),
        cmocka_unit_test(test_cubic_of_two_keys),
        cmocka_unit_test(test_cubic_is_smooth),
        cmocka_unit_test(test_order_of_samples),
        cmocka_unit_test(test_tracks_add_then_clamp),
        cmocka_unit_test(test_labels),
        cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_synonyms),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
