/* KA-50: layers that add and override, their own time, clips within clips. */
#include "scratch.h"

#include "anim/clip.h"
#include "fake_model.h"

#include <math.h>

#define START "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4,"
#define TRACK(target, keys) "{\"target\":\"" target "\",\"keys\":[" keys "]}"
#define HOLD(target, value) TRACK(target, "{\"t\":0,\"v\":" value "}")
#define RAMP(target) TRACK(target, "{\"t\":0,\"v\":0},{\"t\":1,\"v\":1}")

static ris_clip *clip_of(const char *text)
{
    ris_clip *clip;
    ris_error err = {0};
    if (ris__clip_parse(&fake_model, "t.json", text, strlen(text), &clip, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    return clip;
}

static float sample(const ris_clip *clip, double time_s, int channel)
{
    float pose[FAKE_COUNT];
    memset(pose, 0x55, sizeof pose);
    ris_clip_sample(clip, time_s, pose);
    return pose[channel];
}

static void test_override_by_weight(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(START "\"tracks\":[" HOLD("jaw.open", "0.8") "," HOLD(
        "smile", "1.2") "],\"layers\":["
                        "{\"mode\":\"override\",\"weight\":0.25,\"tracks\":[" HOLD("jaw.open", "0.2") "]}]}");
    /* smile is half zygomaticus and a quarter of the jaw: 0.8 + 0.3 shows as 1, and 1 * 0.75 + 0.2 * 0.25 = 0.8 */
    assert_float_equal(sample(clip, 1, FAKE_JAW), 0.8, 1e-6);
    assert_float_equal(sample(clip, 1, FAKE_ZYGO_L), 0.6, 1e-6); /* not touched */
    ris_clip_destroy(clip);
    clip = clip_of(START "\"tracks\":[" HOLD(
        "jaw.open", "0.8") "],\"layers\":["
                           "{\"mode\":\"override\",\"tracks\":[" HOLD(
                               "jaw.open", "0") "]},"
                                                "{\"tracks\":[" HOLD("jaw.open", "0.125") "]}]}");
    assert_true(sample(clip, 1, FAKE_JAW) == 0.125f); /* later layers lie on top */
    ris_clip_destroy(clip);
}

static void test_weight_keys(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of(START "\"layers\":[{\"weight\":[{\"t\":0,\"v\":0},{\"t\":4,\"v\":1}],\"tracks\":[" HOLD(
            "jaw.open", "0.4") "]},{\"weight\":2,\"tracks\":[" HOLD("jaw.side", "0.25") "]}]}");
    assert_float_equal(sample(clip, 1, FAKE_JAW), 0.1, 1e-7);
    assert_float_equal(sample(clip, 4, FAKE_JAW), 0.4, 1e-7);
    assert_true(sample(clip, 3, FAKE_SIDE) == 0.5f);
    ris_clip_destroy(clip);
}

static void test_own_time(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of(START "\"layers\":[{\"start_s\":1,\"speed\":0.5,\"duration_s\":1,\"tracks\":[" RAMP(
            "jaw.open") "]},"
                        "{\"start_s\":1,\"duration_s\":1,\"loop\":true,\"tracks\":[" RAMP(
                            "jaw.side") "]},"
                                        "{\"start_s\":-0.25,\"duration_s\":2,\"loop\":true,\"tracks\":[" RAMP(
                                            "zygomaticus_major") "]}]}");
    assert_true(sample(clip, 0.5, FAKE_JAW) == 0); /* the ends hold */
    assert_true(sample(clip, 2, FAKE_JAW) == 0.5f);
    assert_true(sample(clip, 3, FAKE_JAW) == 1);
    assert_true(sample(clip, 4, FAKE_JAW) == 1);
    assert_true(sample(clip, 0.75, FAKE_SIDE) == 0);
    assert_true(sample(clip, 1.25, FAKE_SIDE) == 0.25f);
    assert_true(sample(clip, 3.25, FAKE_SIDE) == 0.25f);
    assert_true(sample(clip, 0, FAKE_ZYGO_L) == 0.25f);
    assert_true(sample(clip, 1.25, FAKE_ZYGO_L) == 0.5f); /* on the way back to the key at 2 s */
    ris_clip_destroy(clip);
}

static void test_track_options(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(
        START
        "\"tracks\":[{\"target\":\"jaw.open\",\"ease\":\"in\",\"scale\":0.5,\"offset\":0.25,\"shift_s\":-1,"
        "\"keys\":[{\"t\":1,\"v\":0},{\"t\":3,\"v\":1,\"ease\":\"step\"},{\"t\":4,\"v\":0}]}]}");
    assert_true(sample(clip, 0, FAKE_JAW) == 0.25f);
    assert_true(sample(clip, 1, FAKE_JAW) == 0.375f); /* a quarter of the way at half the time */
    assert_true(sample(clip, 2.5, FAKE_JAW) == 0.75f);
    assert_true(sample(clip, 3, FAKE_JAW) == 0.25f);
    ris_clip_destroy(clip);
}

static void test_whole_clip_repeats(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(START "\"loop\":true,\"tracks\":[" TRACK(
        "eye.yaw", "{\"t\":0,\"v\":0},{\"t\":1,\"v\":10},{\"t\":3,\"v\":-10}") "]}");
    assert_true(ris_clip_repeats(clip));
    static const double known[][2] = {{0.5, 5}, {2, 0},    {3.5, -5},  {4, 0},
                                      {4.5, 5}, {7.5, -5}, {-0.5, -5}, {403, -10}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        assert_float_equal(sample(clip, known[i][0], FAKE_YAW_L), known[i][1], 1e-5);
    }
    ris_clip_destroy(clip);
    clip = clip_of(START "\"tracks\":[" RAMP("jaw.open") "]}");
    assert_false(ris_clip_repeats(clip));
    ris_clip_destroy(clip);
}

static ris_clip *load(const char *path)
{
    ris_clip *clip;
    ris_error err = {0};
    if (ris_clip_load(&fake_model, path, &clip, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    return clip;
}

static void test_clips_within_clips(void **state)
{
    (void)state;
    scratch_write("nod.json",
                  "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":2,\"loop\":true,"
                  "\"expressions\":{\"tilt\":{\"jaw.side\":1}},\"labels\":[{\"t\":1,\"name\":\"over\"}],"
                  "\"tracks\":[" TRACK("tilt", "{\"t\":0,\"v\":0},{\"t\":1,\"v\":3}") "]}");
    ris_clip *clip = load(scratch_write(
        "outer.json",
        START "\"tracks\":[" HOLD(
            "jaw.side",
            "-0.5") "],\"layers\":["
                    "{\"name\":\"nod\",\"clip\":\"nod.json\",\"start_s\":1,\"speed\":2,\"weight\":0.5}]}"));
    /* at 1.25 s the inner clip is at 0.5 s: 1.5, which alone shows as 1; half of it on -0.5 */
    assert_float_equal(sample(clip, 1.25, FAKE_SIDE), 0, 1e-7);
    assert_float_equal(sample(clip, 2.25, FAKE_SIDE), 0, 1e-7); /* it repeats by itself */
    assert_float_equal(sample(clip, 0.5, FAKE_SIDE), -0.5, 1e-7);
    assert_int_equal(ris_clip_label_count(clip), 2);
    double t;
    assert_string_equal(ris_clip_label(clip, 1, &t), "over");
    assert_true(t == 1.5);
    ris_clip_destroy(clip);
    clip = load(scratch_write(
        "over.json", START "\"tracks\":[" HOLD("jaw.side", "-0.5") "," HOLD(
                         "jaw.open", "0.5") "],\"layers\":[{\"mode\":\"override\",\"clip\":\"nod.json\"}]}"));
    assert_float_equal(sample(clip, 1.8, FAKE_SIDE), 0.6, 1e-6); /* 3 * 0.2: on the way back */
    assert_true(sample(clip, 1.8, FAKE_JAW) == 0.5f);
    ris_clip_destroy(clip);
}

/* Performances below a clip's own layer: 0.2 rad of gaze are 11.459 degrees, 10 more on the left, and half of all. */
static void test_performances_as_layers(void **state)
{
    (void)state;
    scratch_write("take.csv", "timestamp, gaze_angle_x\n0, 0.1\n0.5, 0.2\n1, 0.1\n");
    scratch_write("live.csv", "Timecode,BlendShapeCount,LeftEyeYaw\n0:0:0:0,1,10\n0:0:0:1,1,10\n");
    ris_clip *clip = load(scratch_write("on_take.json",
                                        START "\"layers\":[{\"openface\":\"take.csv\",\"start_s\":1},{\"live_"
                                              "link\":\"live.csv\",\"adjust\":\"no-head\"},"
                                              "{\"mode\":\"override\",\"weight\":0.5,\"tracks\":[" TRACK(
                                                  "eye.yaw", "{\"t\":0,\"v\":0},{\"t\":4,\"v\":0}") "]}]}"));
    assert_float_equal(sample(clip, 1.5, FAKE_YAW_L), 21.4591559 / 2, 1e-4);
    assert_float_equal(sample(clip, 1.5, FAKE_YAW_R), 11.4591559 / 2, 1e-4);
    ris_clip_destroy(clip);
}

static void expect_bad(const char *path, const char *says)
{
    ris_clip *clip = NULL;
    ris_error err = {0};
    expect_error(&err, ris_clip_load(&fake_model, path, &clip, &err), RIS_ERROR_DATA, says);
    assert_null(clip);
}

static void test_includes_that_are_refused(void **state)
{
    (void)state;
    const char *a = scratch_write("a.json", START "\"layers\":[{\"clip\":\"b.json\"}]}");
    scratch_write("b.json", START "\"layers\":[{\"clip\":\"a.json\"}]}");
    expect_bad(a, "b.json:1:72: layers[0].clip: the clip includes itself through \"a.json\"");
    scratch_write("c.json", START "\"layers\":[{\"clip\":\"../"
                                  "x/c.json\"}]}");
    expect_bad(scratch_path("c.json"), "x/c.json: cannot open");
    scratch_write("d.json", START "\"tracks\":[" HOLD("jaw.opn", "1") "]}");
    expect_bad(scratch_write("e.json", START "\"layers\":[{\"clip\":\"d.json\"}]}"), "d.json:1:");
    char name[16], text[200];
    for (int i = 0; i < 12; i++) {
        snprintf(name, sizeof name, "n%d.json", i);
        snprintf(text, sizeof text, START "\"layers\":[{\"clip\":\"n%d.json\"}]}", i + 1);
        scratch_write(name, text);
    }
    expect_bad(scratch_path("n0.json"), "n8.json: clips include clips more than 8 deep");
    expect_bad(
        scratch_write("adjusted.json", START "\"layers\":[{\"openface\":\"take.csv\",\"adjust\":\"turn\"}]}"),
        "layers[0].adjust: ");
    expect_bad(
        scratch_write("onset.json", START "\"layers\":[{\"openface\":\"take.csv\",\"adjust\":\"onset\"}]}"),
        "layers[0].adjust: muscles in a clip have their onset already");
    expect_bad(scratch_write("no_take.json", START "\"layers\":[{\"adjust\":\"onset\",\"idle\":{}}]}"),
               "layers[0].adjust: only a performance is adjusted");
    expect_bad(scratch_write("lost.json", START "\"layers\":[{\"live_link\":\"lost.csv\"}]}"),
               "lost.csv: cannot open");
    scratch_write("leaf.json", START "\"tracks\":[" HOLD("jaw.open", "1") "]}");
    char *wide = malloc(1 << 16);
    assert_non_null(wide);
    for (int level = 0; level < 2; level++) { /* 64 times 64 */
        int used = snprintf(wide, 1 << 16, START "\"layers\":[");
        for (int i = 0; i < 64; i++) {
            used += snprintf(wide + used, (size_t)(1 << 16) - (size_t)used, "%s{\"clip\":\"%s\"}",
                             i ? "," : "", level ? "w0.json" : "leaf.json");
        }
        snprintf(wide + used, (size_t)(1 << 16) - (size_t)used, "]}");
        scratch_write(level ? "w1.json" : "w0.json", wide);
    }
    free(wide);
    expect_bad(scratch_path("w1.json"), "clips include more than 256 files");
}

static void test_refuses(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {START "\"layers\":[]}", "layers: expected"},
        {START "\"layers\":[{}]}", "layers[0]: expected one of \"tracks\", \"clip\", \"live_link\", "
                                   "\"openface\", \"idle\" and \"speech\""},
        {START "\"layers\":[{\"idle\":{},\"tracks\":[" RAMP("jaw.open") "]}]}", "layers[0]: expected one of"},
        {START "\"layers\":[{\"mode\":\"mix\",\"idle\":{}}]}",
         "layers[0].mode: expected one of add, override, found \"mix\""},
        {START "\"layers\":[{\"mode\":\"override\",\"weight\":1.5,\"idle\":{}}]}",
         "layers[0].weight: expected a number of 0 to 1, found 1.5"},
        {START "\"layers\":[{\"weight\":[{\"t\":0,\"v\":11}],\"idle\":{}}]}",
         "layers[0].weight[0].v: expected a number of 0 to 10, found 11"},
        {START "\"layers\":[{\"speed\":0,\"tracks\":[" RAMP("jaw.open") "]}]}",
         "layers[0].speed: expected a number"},
        {START "\"layers\":[{\"duration_s\":0.5,\"tracks\":[" RAMP("jaw.open") "]}]}",
         "layers[0].tracks[0].keys[1].t: expected a number of 0 to 0.5, found 1"},
        {START "\"layers\":[{\"loop\":1,\"tracks\":[" RAMP("jaw.open") "]}]}",
         "layers[0].loop: expected true or false, found 1"},
        {START "\"layers\":[{\"loop\":true,\"idle\":{}}]}", "layers[0]: idle life has no end"},
        {START "\"layers\":[{\"idle\":{\"seed\":-1}}]}", "layers[0].idle.seed: expected"},
        {START "\"layers\":[{\"idle\":{\"blinks\":3}}]}",
         "layers[0].idle.blinks: unknown key; nearest: seed, blinks_per_min"},
        {START "\"layers\":[{\"clip\":\"a.json\"}]}",
         "layers[0].clip: a clip from memory cannot name a file"},
        {START "\"layers\":[{\"weigth\":1}]}", "layers[0].weigth: unknown key; nearest: weight"},
        {START "\"loop\":\"yes\",\"layers\":[{\"idle\":{}}]}", "loop: expected true or false, found \"yes\""},
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

/* More channels than are sampled at a time (256): a layer that overrides the last and a track of all. */
static void test_many_channels(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    static ris_channel channel[COUNT];
    static ris_term term[COUNT];
    static float pose[COUNT];
    for (int c = 0; c < COUNT; c++) {
        snprintf(channel[c].name, sizeof channel[c].name, "m%d", c);
        channel[c].maximum = 1;
        snprintf(term[c].channel, sizeof term[c].channel, "m%d", c);
        term[c].value = (float)c / COUNT;
    }
    ris_expression all = {"all", COUNT, term};
    ris_head head = {.expression_count = 1, .expression = &all};
    ris_model model = {.head = &head, .channel_count = COUNT, .channel = channel};
    const char *text = START "\"tracks\":[" HOLD(
        "all", "1") "],\"layers\":[{\"mode\":\"override\",\"tracks\":[" HOLD("m599", "0.25") "]}]}";
    ris_clip *clip;
    ris_error err = {0};
    assert_int_equal(ris__clip_parse(&model, "t", text, strlen(text), &clip, &err), RIS_OK);
    ris_clip_sample(clip, 1, pose);
    for (int c = 0; c < COUNT - 1; c++) {
        assert_true(pose[c] == (float)c / COUNT);
    }
    assert_true(pose[COUNT - 1] == 0.25f);
    ris_clip_destroy(clip);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_override_by_weight),
        cmocka_unit_test(test_weight_keys),
        cmocka_unit_test(test_own_time),
        cmocka_unit_test(test_track_options),
        cmocka_unit_test(test_whole_clip_repeats),
        cmocka_unit_test(test_clips_within_clips),
        cmocka_unit_test(test_performances_as_layers),
        cmocka_unit_test(test_includes_that_are_refused),
        cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_many_channels),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
