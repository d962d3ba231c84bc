/* KA-54, KA-55, KA-57, KU-31: action units, shapes, visemes and expressions as channels of a head. */
#include "scratch.h"

#include "asset/names.h"
#include "asset/vocabulary.h"
#include "measure/measure.h"
#include "model/vocabulary.h"
#include "risorius/timeline.h"

#include <math.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"
#define MAX_CHANNELS 256

static ris_model *human;

static int load_human(void **state)
{
    ris_error err = {0};
    (void)state;
    return ris_model_load(HUMAN, &human, &err) == RIS_OK && human->channel_count <= MAX_CHANNELS ? 0 : -1;
}

static int free_human(void **state)
{
    (void)state;
    ris_model_destroy(human);
    return 0;
}

static void pose_of(const char *text, float *pose)
{
    ris_error err = {0};
    if (ris_pose_parse(human, text, pose, &err) != RIS_OK) {
        fail_msg("%s: %s", text, err.text);
    }
}

static float value_of(const char *text, const char *channel)
{
    float pose[MAX_CHANNELS];
    uint32_t c = ris_model_channel(human, channel);
    assert_true(c != UINT32_MAX);
    pose_of(text, pose);
    return pose[c];
}

static void expect_same(const char *a, const char *b)
{
    float pose[2][MAX_CHANNELS];
    pose_of(a, pose[0]);
    pose_of(b, pose[1]);
    for (uint32_t c = 0; c < human->channel_count; c++) {
        if (fabsf(pose[0][c] - pose[1][c]) > 1e-6f) {
            fail_msg("%s of %s is %g, of %s %g", human->channel[c].name, a, (double)pose[0][c], b,
                     (double)pose[1][c]);
        }
    }
}

static uint32_t count_moved(const float *pose)
{
    uint32_t moved = 0;
    for (uint32_t c = 0; c < human->channel_count; c++) {
        moved += pose[c] != 0;
    }
    return moved;
}

/* The 33 rows of table 3 of Küderle's thesis, and what else the project promises. */
static void test_every_unit(void **state)
{
    (void)state;
    static const int unit[] = {1,  2,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17, 18, 19,
                               20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 31, 32, 33, 34, 35, 37, 38, 39,
                               41, 42, 43, 44, 45, 46, 51, 52, 53, 54, 55, 56, 57, 58, 61, 62, 63, 64};
    float pose[MAX_CHANNELS];
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++) {
        char text[32];
        snprintf(text, sizeof text, "AU%d=1", unit[k]);
        pose_of(text, pose);
        if (count_moved(pose) == 0) {
            fail_msg("%s moves nothing", text);
        }
    }
    pose_of("AU30.L=1", pose);
    assert_int_equal(count_moved(pose), 1);
    pose_of("AU36.L=1", pose);
    assert_int_equal(count_moved(pose), 1);
    expect_same("AU46=1", "AU46.L=1"); /* a wink is of one eye */
    assert_true(value_of("AU46=1", "lid.upper.L") == 1 && value_of("AU46=1", "lid.upper.R") == 0);
    assert_true(value_of("AU46.R=1", "lid.upper.R") == 1 && value_of("AU46.R=1", "lid.upper.L") == 0);
    assert_true(value_of("AU30.L=1", "jaw.side") == 1 && value_of("AU30.R=1", "jaw.side") == -1);
}

/* The 52 names of ARKit, in its order. */
static void test_every_shape(void **state)
{
    (void)state;
    static const char *const shape[] = {"eyeBlinkLeft",      "eyeLookDownLeft",    "eyeLookInLeft",
                                        "eyeLookOutLeft",    "eyeLookUpLeft",      "eyeSquintLeft",
                                        "eyeWideLeft",       "eyeBlinkRight",      "eyeLookDownRight",
                                        "eyeLookInRight",    "eyeLookOutRight",    "eyeLookUpRight",
                                        "eyeSquintRight",    "eyeWideRight",       "jawForward",
                                        "jawLeft",           "jawRight",           "jawOpen",
                                        "mouthClose",        "mouthFunnel",        "mouthPucker",
                                        "mouthLeft",         "mouthRight",         "mouthSmileLeft",
                                        "mouthSmileRight",   "mouthFrownLeft",     "mouthFrownRight",
                                        "mouthDimpleLeft",   "mouthDimpleRight",   "mouthStretchLeft",
                                        "mouthStretchRight", "mouthRollLower",     "mouthRollUpper",
                                        "mouthShrugLower",   "mouthShrugUpper",    "mouthPressLeft",
                                        "mouthPressRight",   "mouthLowerDownLeft", "mouthLowerDownRight",
                                        "mouthUpperUpLeft",  "mouthUpperUpRight",  "browDownLeft",
                                        "browDownRight",     "browInnerUp",        "browOuterUpLeft",
                                        "browOuterUpRight",  "cheekPuff",          "cheekSquintLeft",
                                        "cheekSquintRight",  "noseSneerLeft",      "noseSneerRight",
                                        "tongueOut"};
    assert_int_equal(sizeof shape / sizeof *shape, 52);
    uint32_t shapes = 0;
    for (uint32_t i = 0; i < human->vocabulary.word_count; i++) {
        shapes += human->vocabulary.word[i].kind == RIS_WORD_SHAPE;
    }
    assert_int_equal(shapes, 52);
    for (size_t k = 0; k < 52; k++) {
        char side;
        const ris_word *word = ris__vocabulary_find(&human->vocabulary, shape[k], &side);
        if (!word || word->kind != RIS_WORD_SHAPE || word->value_count == 0) {
            fail_msg("%s is no shape, or moves nothing", shape[k]);
        }
    }
}

static void test_every_viseme(void **state)
{
    (void)state;
    static const char *const viseme[] = {"sil", "PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                         "nn",  "RR", "aa", "E",  "I",  "O",  "U"};
    float pose[MAX_CHANNELS];
    for (size_t k = 0; k < 15; k++) {
        char text[32];
        snprintf(text, sizeof text, "viseme.%s=1", viseme[k]);
        pose_of(text, pose);
        assert_int_equal(count_moved(pose) == 0, k == 0);
    }
}

static void test_sides(void **state)
{
    (void)state;
    float pose[MAX_CHANNELS];
    pose_of("AU12.L=1", pose);
    assert_int_equal(count_moved(pose), 1);
    assert_true(pose[ris_model_channel(human, "zygomaticus_major.L")] == 1);
    expect_same("AU12=0.5", "AU12.L=0.5,AU12.R=0.5");
    /* what has no side counts half for one: the two halves make the whole */
    assert_true(value_of("AU4.L=1", "procerus") == 0.5f * value_of("AU4=1", "procerus"));
    assert_true(value_of("AU4.L=1", "corrugator_supercilii.L") == 1);
    assert_true(value_of("AU4.L=1", "corrugator_supercilii.R") == 0);
    for (uint32_t i = 0; i < human->vocabulary.word_count; i++) {
        const ris_word *word = &human->vocabulary.word[i];
        char whole[160], halves[320];
        const bool wink = strcmp(word->name, "AU46") == 0; /* alone the left one */
        if (word->kind == RIS_WORD_UNIT && !wink && !ris__name_is_sided(word->name)) {
            snprintf(whole, sizeof whole, "%s=1", word->name);
            snprintf(halves, sizeof halves, "%s.L=1,%s.R=1", word->name, word->name);
            expect_same(whole, halves);
        }
    }
}

/* .L and .R of every unit and expression, Left and Right of every shape mirror each other. */
static void test_mirrored_names(void **state)
{
    (void)state;
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < human->vocabulary.word_count; i++) {
        const ris_word *word = &human->vocabulary.word[i];
        float left[MAX_CHANNELS] = {0}, right[MAX_CHANNELS] = {0}, mirrored[MAX_CHANNELS];
        char name[2][RIS_NAME_SIZE + 8];
        const size_t length = strlen(word->name);
        if (word->kind == RIS_WORD_VISEME || word->name[length - 2] == '.' ||
            (word->kind == RIS_WORD_UNIT && atoi(word->name + 2) > 50)) {
            continue; /* units of head and eyes are one-sided in themselves */
        }
        if (word->kind == RIS_WORD_SHAPE) {
            if (length < 4 || strcmp(word->name + length - 4, "Left") != 0) {
                continue;
            }
            snprintf(name[0], sizeof name[0], "%s", word->name);
            snprintf(name[1], sizeof name[1], "%.*sRight", (int)length - 4, word->name);
        } else {
            snprintf(name[0], sizeof name[0], "%s.L", word->name);
            snprintf(name[1], sizeof name[1], "%s.R", word->name);
        }
        assert_true(ris__model_add_word(human, name[0], 1, left));
        assert_true(ris__model_add_word(human, name[1], 1, right));
        ris__measure_mirror_pose(human, left, mirrored);
        for (uint32_t c = 0; c < human->channel_count; c++) {
            if (mirrored[c] != right[c]) {
                fail_msg("%s: %s is %g mirrored from %s, %g in %s", human->channel[c].name, name[0],
                         (double)mirrored[c], name[0], (double)right[c], name[1]);
            }
        }
        pairs++;
    }
    assert_true(pairs > 60);
}

static void test_joined(void **state)
{
    (void)state;
    expect_same("AU6+12=0.5", "AU6=0.5,AU12=0.5");
    expect_same("AU6+12.L=1", "AU6.L=1,AU12.L=1");
    expect_same("AU1+AU2+5=1", "AU1=1,AU2=1,AU5=1");
    expect_same("AU12C=1", "AU12=0.6");
    expect_same("AU12=C", "AU12=0.6");
    expect_same("AU6B+12D.R=1", "AU6.R=0.4,AU12.R=0.8");
    expect_same("AU6A+12E=0.5", "AU6=0.1,AU12=0.5");
}

static void test_adds_then_clamps(void **state)
{
    (void)state;
    assert_true(value_of("AU12=1,smile=1,AU6+12=1", "zygomaticus_major.L") == 1);
    assert_true(value_of("AU12=1,AU13=1,smile=1", "levator_anguli_oris.R") == 1);
    assert_true(value_of("AU26=1,AU27=1,viseme.aa=1", "jaw.open") == 1);
    assert_true(value_of("AU12=1,AU12=-0.75", "zygomaticus_major.L") == 0.25f);
    assert_true(value_of("AU61=1,AU62=1", "eye.yaw.L") == 0);
}

static void test_unknown_names(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"AU3=1",
         "\"AU3\" is no muscle, channel, unit, shape, viseme or expression of this head; nearest: AU"},
        {"AU012=1", "\"AU012\" is no"},
        {"AU12F=1", "\"AU12F\" is no"},
        {"AU30.L+26=1", "\"AU30.L+26\" is no"}, /* the side stands at the end */
        {"AU6+=1", "\"AU6+\" is no"},
        {"AU6++12=1", "\"AU6++12\" is no"},
        {"AU6+12.l=1", "\"AU6+12.l\" is no"},
        {"AU6+3=1", "\"AU6+3\" is no"},
        {"au12=1", "nearest: AU12"},
        {"mouthSmilLeft=1", "nearest: mouthSmileLeft"},
        {"mouthSmileLeft.L=1", "nearest: mouthSmileLeft"},
        {"viseme.pp=1", "nearest: viseme.PP"},
        {"viseme.aa.L=1", "nearest: viseme.aa"},
        {"hapiness=1", "nearest: happiness"},
        {"AU30=1", "nearest: AU30.L, AU30.R"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        float pose[MAX_CHANNELS];
        ris_error err = {0};
        expect_error(&err, ris_pose_parse(human, bad[k].text, pose, &err), RIS_ERROR_USAGE, bad[k].says);
    }
}

/* KA-57: the same vocabulary on a head of three channels. */
static void test_a_head_that_lacks_muscles(void **state)
{
    (void)state;
    ris_channel channel[] = {
        {"zygomaticus_major.L", 0, 1}, {"zygomaticus_major.R", 0, 1}, {"jaw.open", 0, 1}};
    ris_model model = {.channel_count = 3, .channel = channel};
    ris_error err = {0};
    char side;
    float pose[3];
    assert_int_equal(ris__vocabulary_read(ris__vocabulary_file, &model.vocabulary, &err), RIS_OK);
    assert_int_equal(ris__vocabulary_resolve(&model, &err), RIS_OK);
    const ris_word *whole = ris__vocabulary_find(&model.vocabulary, "AU12", &side);
    const ris_word *part = ris__vocabulary_find(&model.vocabulary, "AU27", &side);
    const ris_word *none = ris__vocabulary_find(&model.vocabulary, "AU1", &side);
    assert_true(whole->missing_count == 0 && whole->value_count == 2);
    assert_true(part->missing_count == 2 && part->value_count == 1);
    assert_true(none->missing_count == 2 && none->value_count == 0);
    assert_int_equal(ris_pose_parse(&model, "AU6+12+27=0.5", pose, &err), RIS_OK);
    assert_true(pose[0] == 0.5f && pose[1] == 0.5f && pose[2] == 0.5f);
    ris__vocabulary_finish(&model.vocabulary);
}

#define FACS(units) "{\"format\":\"risorius-facs\",\"version\":1,\"units\":{" units "}}"
#define ARKIT(shapes) "{\"format\":\"risorius-arkit\",\"version\":1,\"shapes\":{" shapes "}}"
#define VISEMES(v) "{\"format\":\"risorius-visemes\",\"version\":1,\"visemes\":{" v "}}"
#define LIBRARY(e) "{\"format\":\"risorius-library\",\"version\":1,\"expressions\":{" e "}}"
#define WORD(name, terms) "\"" name "\":{\"title\":\"t\",\"terms\":{" terms "}}"
#define SMILE WORD("AU12", "\"zygomaticus_major\":1")

static ris_result read_texts(const char *const text[RIS_WORD_KINDS], ris_error *err)
{
    static const char *const name[] = {"facs", "arkit", "visemes", "library"};
    ris_vocabulary_text file[RIS_WORD_KINDS];
    ris_vocabulary vocabulary;
    for (int k = 0; k < RIS_WORD_KINDS; k++) {
        file[k] = (ris_vocabulary_text){name[k], text[k], strlen(text[k])};
    }
    ris_result result = ris__vocabulary_read(file, &vocabulary, err);
    ris__vocabulary_finish(&vocabulary);
    return result;
}

static void test_bad_files(void **state)
{
    (void)state;
    static const char *const fine[] = {FACS(SMILE), ARKIT(WORD("mouthSmileLeft", "\"AU12.L\":1")),
                                       VISEMES(WORD("viseme.I", "\"AU12\":0.2,\"jaw.open\":0.1")),
                                       LIBRARY(WORD("glee", "\"AU12\":1"))};
    static const struct {
        int kind;
        const char *text, *says;
    } bad[] = {
        {0, "{", "facs:1:"},
        {0, ARKIT(""), "facs:1:11: format: expected \"risorius-facs\""},
        {0, FACS(WORD("AU0", "")), "facs:1:54: units.AU0: expected the name of an action unit (\"AU12\")"},
        {0, FACS(WORD("smile", "")), "expected the name of an action unit"},
        {0, FACS(WORD("AU12C", "")), "expected the name of an action unit"},
        {0, FACS(WORD("AU6+12", "")), "expected the name of an action unit"},
        {0, FACS(SMILE "," WORD("AU13", "\"AU12\":1")),
         "units.AU13.terms.AU12: expected a muscle or channel, found an action unit"},
        {0, FACS("\"AU1\":{\"terms\":{}}"), "units.AU1: expected the key \"title\""},
        {0, FACS("\"AU1\":{\"title\":\"t\",\"terms\":{},\"weights\":[]}"), "unknown key; nearest: "},
        {0, FACS(WORD("AU1", "\"frontalis_inner\":\"1\"")), "units.AU1.terms.frontalis_inner: expected"},
        {0, FACS(WORD("AU1", "\"frontalis_inner\":1e9")), "units.AU1.terms.frontalis_inner: expected"},
        {1, ARKIT(WORD("smile", "")), "shapes.smile: expected the name of an ARKit shape"},
        {1, ARKIT(WORD("mouthSmileLeft", "\"AU13.L\":1")), "unknown action unit; nearest: AU12"},
        {1, ARKIT(WORD("mouthSmileLeft", "\"AU12.L+13\":1")), "unknown action unit"},
        {2, VISEMES(WORD("PP", "")), "expected the name of a viseme"},
        {2, VISEMES(WORD("viseme.PP", "\"mouthSmileLeft\":1")),
         "expected an action unit, a muscle or a channel, found an ARKit shape"},
        {3, LIBRARY(WORD("AU40", "")), "expected the name of an expression"},
        {3, LIBRARY(WORD("Glee", "")), "expected the name of an expression"},
        {3, LIBRARY(WORD("glee", "\"AU12\":1") "," WORD("joy", "\"glee\":1")),
         "expected an action unit, a muscle or a channel, found an expression"},
        {3, LIBRARY(WORD("glee", "\"glee\":1")), "found an expression"},
    };
    ris_error err = {0};
    assert_int_equal(read_texts(fine, &err), RIS_OK);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        const char *text[RIS_WORD_KINDS];
        memcpy(text, fine, sizeof text);
        text[bad[k].kind] = bad[k].text;
        err = (ris_error){0};
        expect_error(&err, read_texts(text, &err), RIS_ERROR_DATA, bad[k].says);
    }
}

/* The reference head has every muscle and channel the vocabulary names, and no muscle with the name of a word. */
static void test_the_human_head_has_all(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < human->vocabulary.word_count; i++) {
        const ris_word *word = &human->vocabulary.word[i];
        float pose[MAX_CHANNELS] = {0};
        assert_false(ris__model_add_channel(human, word->name, 1, pose));
        for (uint32_t k = 0; k < word->term_count; k++) {
            const char *name = word->term[k].channel;
            const bool known =
                ris__model_add_channel(human, name, 1, pose) || ris__model_add_word(human, name, 1, pose);
            if (!known) {
                fail_msg("%s: %s is no channel of the human head", word->name, name);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_unit),
        cmocka_unit_test(test_every_shape),
        cmocka_unit_test(test_every_viseme),
        cmocka_unit_test(test_sides),
        cmocka_unit_test(test_mirrored_names),
        cmocka_unit_test(test_joined),
        cmocka_unit_test(test_adds_then_clamps),
        cmocka_unit_test(test_unknown_names),
        cmocka_unit_test(test_a_head_that_lacks_muscles),
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_the_human_head_has_all),
    };
    return cmocka_run_group_tests(tests, load_human, free_human);
}
