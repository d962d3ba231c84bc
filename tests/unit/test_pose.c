/* Poses: names to channels, sums, clamps, errors with the nearest names. */
#include "scratch.h"

#include "fake_model.h"
#include "risorius/timeline.h"

#include <locale.h>

static void expect_pose(const char *text, const float *wanted)
{
    float pose[FAKE_COUNT];
    ris_error err = {0};
    memset(pose, 0x55, sizeof pose);
    ris_result result = ris_pose_parse(&fake_model, text, pose, &err);
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
    }
    assert_int_equal(result, RIS_OK);
    for (int c = 0; c < FAKE_COUNT; c++) {
        if (pose[c] != wanted[c]) {
            print_error("%s: %s is %g, not %g\n", text, fake_channel[c].name, (double)pose[c],
                        (double)wanted[c]);
        }
        assert_true(pose[c] == wanted[c]);
    }
}

#define POSE(...) ((const float[FAKE_COUNT]){__VA_ARGS__})

static void test_names(void **state)
{
    (void)state;
    expect_pose("zygomaticus_major.L=0.5", POSE([FAKE_ZYGO_L] = 0.5f));
    expect_pose("zygomaticus_major=0.5", POSE([FAKE_ZYGO_L] = 0.5f, [FAKE_ZYGO_R] = 0.5f));
    expect_pose("orbicularis_oris_superior=0.25", POSE([FAKE_ORIS] = 0.25f));
    expect_pose("eye.yaw=-10", POSE([FAKE_YAW_L] = -10, [FAKE_YAW_R] = -10));
    expect_pose("eye.yaw.R=.5e1", POSE([FAKE_YAW_R] = 5));
    expect_pose("neutral=1", POSE(0));
    expect_pose("jaw.open=C", POSE([FAKE_JAW] = 0.6f));
    expect_pose("jaw.open=A,jaw.side=E", POSE([FAKE_JAW] = 0.2f, [FAKE_SIDE] = 1));
}

/* The table of docs/file-formats.md on the reference head: every synonym is the muscle, side by side. */
static void test_synonyms(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"triangularis", "depressor_anguli_oris"},
        {"triangularis.L", "depressor_anguli_oris.L"},
        {"quadratus_labii", "depressor_labii_inferioris"},
        {"quadratus_labii_inferioris.R", "depressor_labii_inferioris.R"},
        {"levator_labii", "levator_labii_superioris"},
        {"caninus.R", "levator_anguli_oris.R"},
        {"compressor_naris", "nasalis"},
        {"dilatator_naris.L", "nasalis_alaris.L"},
        {"depressor_septi_nasi", "depressor_septi"},
        {"occipitofrontalis_inner", "frontalis_inner"},
        {"occipitofrontalis_outer.L", "frontalis_outer.L"},
        {"medial_pterygoid", "pterygoideus_medialis"},
        {"external_pterygoid.R", "pterygoideus_lateralis.R"},
        {"mylohyoid", "mylohyoideus"},
    };
    ris_model *model = NULL;
    ris_error err = {0};
    assert_int_equal(ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err), RIS_OK);
    float *a = calloc(model->channel_count, sizeof *a), *b = calloc(model->channel_count, sizeof *b);
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        char text[2][96];
        for (int side = 0; side < 2; side++) {
            snprintf(text[side], sizeof text[side], "%s=0.5", pairs[k][side]);
            assert_int_equal(ris_pose_parse(model, text[side], side ? b : a, &err), RIS_OK);
        }
        assert_memory_equal(a, b, model->channel_count * sizeof *a);
        float sum = 0;
        for (uint32_t c = 0; c < model->channel_count; c++) {
            sum += a[c];
        }
        assert_true(sum >= 0.5f);
    }
    assert_int_equal(ris_pose_parse(model, "triangulari=1", a, &err), RIS_ERROR_USAGE);
    assert_int_equal(ris_pose_parse(model, "triangularis.X=1", a, &err), RIS_ERROR_USAGE);
    free(a);
    free(b);
    ris_model_destroy(model);
}

/* A muscle of the synonym's own name goes first. */
static void test_own_name_first(void **state)
{
    (void)state;
    static ris_channel channel[] = {{"caninus", 0, 1}, {"levator_anguli_oris", 0, 1}};
    const ris_model model = {.channel_count = 2, .channel = channel};
    float pose[2];
    ris_error err = {0};
    assert_int_equal(ris_pose_parse(&model, "caninus=1", pose, &err), RIS_OK);
    assert_true(pose[0] == 1.0f && pose[1] == 0.0f);
}

static void test_expressions(void **state)
{
    (void)state;
    expect_pose("smile=1", POSE([FAKE_ZYGO_L] = 0.5f, [FAKE_ZYGO_R] = 0.5f, [FAKE_JAW] = 0.25f));
    expect_pose("smile=0.5", POSE([FAKE_ZYGO_L] = 0.25f, [FAKE_ZYGO_R] = 0.25f, [FAKE_JAW] = 0.125f));
    expect_pose("grin=0.5",
                POSE([FAKE_ZYGO_L] = 0.5f, [FAKE_ZYGO_R] = 0.5f, [FAKE_JAW] = 0.25f, [FAKE_FRONT_L] = 0.5f));
}

static void test_adds_then_clamps(void **state)
{
    (void)state;
    expect_pose("zygomaticus_major=0.25,zygomaticus_major.L=0.5",
                POSE([FAKE_ZYGO_L] = 0.75f, [FAKE_ZYGO_R] = 0.25f));
    expect_pose("zygomaticus_major.L=2,zygomaticus_major.L=-1.5", POSE([FAKE_ZYGO_L] = 0.5f));
    expect_pose("jaw.open=5,jaw.side=-3,eye.yaw.L=99,frontalis_inner.R=-1",
                POSE([FAKE_JAW] = 1, [FAKE_SIDE] = -1, [FAKE_YAW_L] = 35));
    expect_pose("smile=1,smile=1", POSE([FAKE_ZYGO_L] = 1, [FAKE_ZYGO_R] = 1, [FAKE_JAW] = 0.5f));
}

static void test_add_does_not_clamp(void **state)
{
    (void)state;
    float pose[FAKE_COUNT] = {0};
    ris_error err = {0};
    assert_int_equal(ris_pose_add(&fake_model, "jaw.open", 3, pose, &err), RIS_OK);
    assert_int_equal(ris_pose_add(&fake_model, "jaw.open", -2.5f, pose, &err), RIS_OK);
    assert_true(pose[FAKE_JAW] == 0.5f);
    ris_pose_clamp(&fake_model, pose);
    assert_true(pose[FAKE_JAW] == 0.5f);
}

static void test_refuses(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "pose \"\": expected name=value, found \"\""},
        {"smile", "expected name=value, found \"smile\""},
        {"=1", "expected name=value"},
        {"smile=1,", "expected name=value, found \"\""},
        {"smile=", "expected a number or a letter A to E, found \"\""},
        {"smile=x", "found \"x\""},
        {"smile=F", "found \"F\""},
        {"smile=a", "found \"a\""},
        {"smile=nan", "found \"nan\""},
        {"smile=1e9", "found \"1e9\""},
        {"smile=1 ", "found \"1 \""},
        {"smile=0x1", "found \"0x1\""},
        {"smil=1",
         "\"smil\" is no muscle, channel, unit, shape, viseme or expression of this head; nearest: smile"},
        {"zygomaticus_mayor=1", "nearest: zygomaticus_major.L, zygomaticus_major.R"},
        {"Smile=1", "nearest: smile"},
        {"jaw=1", "\"jaw\" is no muscle"},
        {"too_deep=1", "\"smile\" is no muscle"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        float pose[FAKE_COUNT];
        ris_error err = {0};
        expect_error(&err, ris_pose_parse(&fake_model, bad[i].text, pose, &err), RIS_ERROR_USAGE,
                     bad[i].says);
    }
}

static void test_model_without_head(void **state)
{
    (void)state;
    float pose[FAKE_COUNT] = {0};
    ris_error err = {0};
    ris_model model = fake_model;
    model.head = NULL;
    assert_int_equal(ris_pose_add(&model, "jaw.open", 1, pose, &err), RIS_OK);
    expect_error(&err, ris_pose_add(&model, "smile", 1, pose, &err), RIS_ERROR_USAGE, "smile");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_synonyms),
        cmocka_unit_test(test_own_name_first),
        cmocka_unit_test(test_expressions),
        cmocka_unit_test(test_adds_then_clamps),
        cmocka_unit_test(test_add_does_not_clamp),
        cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_model_without_head),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
