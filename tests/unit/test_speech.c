/* KA-51, 52, 54: phones as visemes, coarticulation by dominance. */
#include "scratch.h"

#include "anim/clip.h"
#include "anim/speech.h"

#include <math.h>

enum { JAW, TIP, ROUND, SMILE, COUNT };

static ris_channel channel[COUNT] = {{"jaw.open", 0, 1},
                                     {"tongue.tip", -1, 1},
                                     {"orbicularis_oris_superior", 0, 1},
                                     {"zygomaticus_major.L", 0, 1}};
static ris_channel_value aa_value[] = {{JAW, 0.8f}, {SMILE, 0.5f}};
static ris_channel_value pp_value[] = {{ROUND, 1}};
static ris_channel_value u_value[] = {{JAW, 0.2f}, {ROUND, 0.6f}};
static ris_channel_value nn_value[] = {{JAW, 0.2f}, {TIP, 0.9f}};
static ris_word word[] = {
    {.name = "viseme.aa", .kind = RIS_WORD_VISEME, .value_count = 2, .value = aa_value},
    {.name = "viseme.PP", .kind = RIS_WORD_VISEME, .value_count = 1, .value = pp_value},
    {.name = "viseme.U", .kind = RIS_WORD_VISEME, .value_count = 2, .value = u_value},
    {.name = "viseme.nn", .kind = RIS_WORD_VISEME, .value_count = 2, .value = nn_value},
};
static const ris_model model = {.channel_count = COUNT, .channel = channel, .vocabulary = {4, word}};

#define START                                                                                                \
    "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4,\"layers\":[{\"lead_s\":0,\"speech\":["
#define PHONE(symbol, t, end) "{\"phone\":\"" symbol "\",\"t\":" t ",\"end\":" end "}"
#define END "]}]}"

static ris_clip *clip_of(const char *text)
{
    ris_clip *clip;
    ris_error err = {0};
    if (ris__clip_parse(&model, "t.json", text, strlen(text), &clip, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    return clip;
}

static float sample(const ris_clip *clip, double time_s, int c)
{
    float pose[COUNT];
    ris_clip_sample(clip, time_s, pose);
    return pose[c];
}

/* Two utterances by hand: strengths 1 and 3, rates 10 and 20 a second, 0.1 s after the one and 0.05 s before the
 * other: 1 exp(-10 (sqrt(0.1^2 + 0.012^2) - 0.012)) = 0.411818, 3 exp(-20 (sqrt(0.05^2 + 0.012^2) - 0.012)) = 1.363719;
 * the jaw is then at (0.411818 * 0.8 + 1.363719 * 0.2) / 1.775537. */
static void test_dominance_by_hand(void **state)
{
    (void)state;
    ris_speech_viseme viseme[2] = {{.name = "a", .dominance = {{9, 9, 9}, {1, 15, 10}, {9, 9, 9}}},
                                   {.name = "b", .dominance = {{9, 9, 9}, {3, 20, 25}, {9, 9, 9}}}};
    ris_channel_value a = {JAW, 0.8f}, b = {JAW, 0.2f};
    ris_mouth_target target[2] = {{1, &a}, {1, &b}};
    ris_utterance said[2] = {{.from_s = 0.2, .to_s = 0.3, .amount = 1, .viseme = 0},
                             {.from_s = 0.45, .to_s = 0.5, .amount = 1, .viseme = 1}};
    uint8_t articulator[COUNT] = {RIS_JAW, RIS_TONGUE, RIS_LIPS, RIS_LIPS};
    ris_speech speech = {.phonetics = {.viseme_count = 2, .viseme = viseme},
                         .segment_count = 2,
                         .segment = said,
                         .target = target,
                         .channel_count = COUNT,
                         .articulator = articulator};
    assert_float_equal(ris__speech_dominance(&speech, 0, RIS_JAW, 0.25), 1, 1e-12); /* held */
    assert_float_equal(ris__speech_dominance(&speech, 0, RIS_JAW, 0.4), 0.411818, 1e-6);
    assert_float_equal(ris__speech_dominance(&speech, 1, RIS_JAW, 0.4), 1.363719, 1e-6);
    float pose[COUNT] = {0};
    ris__speech_add(&speech, 0.4, 0, COUNT, pose);
    assert_float_equal(pose[JAW], 0.339164, 1e-5);
    assert_true(pose[TIP] == 0 && pose[ROUND] == 0);
    said[1].amount = 0.5; /* half as far, just as strong */
    pose[JAW] = 0;
    ris__speech_add(&speech, 0.4, 0, COUNT, pose);
    assert_float_equal(pose[JAW], 0.262358, 1e-5);
}

/* A lone phone reaches its pose, and is gone a fifth of a second before and behind it. */
static void test_a_lone_phone(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(START PHONE("ɑː", "1", "1.15") END);
    assert_true(sample(clip, 1.075, JAW) > 0.95f * 0.8f && sample(clip, 1.075, JAW) <= 0.8f);
    assert_true(sample(clip, 1.075, SMILE) > 0.95f * 0.5f);
    assert_true(sample(clip, 0.8, JAW) < 0.03f && sample(clip, 1.35, JAW) < 0.03f);
    assert_true(sample(clip, 0, JAW) < 1e-6f && sample(clip, 4, JAW) < 1e-6f);
    float before = 0;
    for (int i = 0; i <= 100; i++) { /* one way up, no kink: the steps change slowly */
        float now = sample(clip, 0.7 + 0.00375 * i, JAW);
        assert_true(now >= before - 1e-6f && now - before < 0.04f);
        before = now;
    }
    ris_clip_destroy(clip);
}

/* A sung vowel is there from its beginning to its end, without a gap or a leap. */
static void test_a_long_phone(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of("{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":12,\"layers\":[{\"lead_s\":0,"
                "\"speech\":[" PHONE("ɑː", "1", "11") END);
    float before = 0;
    for (int i = 0; i <= 1000; i++) {
        float now = sample(clip, 1 + 0.01 * i, JAW);
        assert_true(i < 20 || i > 980 || now > 0.95f * 0.8f);
        assert_true(i == 0 || fabsf(now - before) < 0.1f);
        before = now;
    }
    ris_clip_destroy(clip);
}

/* p between open vowels: lips and jaw are the consonant's; n leaves the lips to the vowel; rounding begins in the
 * consonants before u. */
static void test_coarticulation(void **state)
{
    (void)state;
    ris_clip *clip = clip_of(
        START PHONE("a", "1", "1.12") "," PHONE("p", "1.12", "1.19") "," PHONE("a", "1.19", "1.31") END);
    assert_true(sample(clip, 1.155, ROUND) > 0.9f);
    assert_true(sample(clip, 1.155, SMILE) < 0.05f && sample(clip, 1.155, JAW) < 0.25f);
    assert_true(sample(clip, 1.06, JAW) > 0.6f && sample(clip, 1.06, ROUND) < 0.4f);
    ris_clip_destroy(clip);
    clip = clip_of(START PHONE("a", "1", "1.12") "," PHONE("n", "1.12", "1.19") "," PHONE("a", "1.19", "1.31")
                       END);
    assert_true(sample(clip, 1.155, SMILE) > 0.35f && sample(clip, 1.155, TIP) > 0.8f);
    ris_clip_destroy(clip);
    clip = clip_of(START PHONE("a", "1", "1.12") "," PHONE("n", "1.12", "1.2") "," PHONE("uː", "1.2", "1.4")
                       END);
    ris_clip *plain =
        clip_of(START PHONE("a", "1", "1.12") "," PHONE("n", "1.12", "1.2") "," PHONE("a", "1.2", "1.4") END);
    assert_true(sample(clip, 1.16, ROUND) > 0.2f); /* a third of it in the middle of the n */
    assert_true(sample(plain, 1.16, ROUND) < 0.01f);
    assert_true(sample(clip, 1.06, SMILE) < sample(plain, 1.06, SMILE));
    ris_clip_destroy(plain);
    ris_clip_destroy(clip);
}

/* Unless told, the mouth is shaped 40 ms before the sound: that is how far behind the flesh is. */
static void test_lead(void **state)
{
    (void)state;
    ris_clip *sound = clip_of(START PHONE("a", "1", "1.2") END);
    ris_clip *clip = clip_of(
        "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4,\"layers\":[{\"speech\":[" PHONE(
            "a", "1", "1.2") END);
    for (int i = 0; i < 40; i++) {
        assert_float_equal(sample(clip, 0.9 + i * 0.01, JAW), sample(sound, 0.94 + i * 0.01, JAW), 1e-6);
    }
    double t;
    assert_string_equal(ris_clip_label(clip, 0, &t), "a");
    assert_float_equal(t, 1.1, 1e-9); /* where it sounds */
    ris_clip_destroy(sound);
    ris_clip_destroy(clip);
}

static void test_pauses_and_parts(void **state)
{
    (void)state;
    ris_clip *clip =
        clip_of(START PHONE("a", "0.5", "0.6") "," PHONE("a", "0.7", "0.8") "," PHONE("aʊ", "2", "2.2") END);
    assert_true(sample(clip, 0.65, JAW) > 0.75f); /* a gap too short for silence */
    assert_true(sample(clip, 1.4, JAW) < 0.001f); /* a pause */
    assert_true(sample(clip, 2.06, JAW) > sample(clip, 2.16, JAW));
    assert_true(sample(clip, 2.17, ROUND) >
                1.5f * sample(clip, 2.03, ROUND));   /* the second part is an u of 0.7 */
    assert_int_equal(ris_clip_label_count(clip), 2); /* of two a's the pose is the same, so one label */
    double t;
    assert_string_equal(ris_clip_label(clip, 0, &t), "a");
    assert_float_equal(t, 0.55, 1e-9);
    assert_string_equal(ris_clip_label(clip, 1, &t), "aʊ");
    ris_clip_destroy(clip);
    clip = clip_of(
        START "{\"viseme\":\"aa\",\"t\":1,\"end\":1.2,\"amount\":0.5}]},{\"mode\":\"override\",\"speech\":["
              "{\"viseme\":\"viseme.PP\",\"t\":1,\"end\":1.2}" END);
    assert_true(sample(clip, 1.1, JAW) > 0.38f &&
                sample(clip, 1.1, JAW) <= 0.4f); /* PP has no jaw: not touched */
    assert_true(sample(clip, 1.1, ROUND) > 0.95f);
    ris_clip_destroy(clip);
}

/* Every phoneme of English, German and Slovak, marks or not. */
static void test_symbols(void **state)
{
    (void)state;
    static const char *const known[] = {
        /* English */ "p",
        "b",
        "t",
        "d",
        "k",
        "ɡ",
        "tʃ",
        "dʒ",
        "f",
        "v",
        "θ",
        "ð",
        "s",
        "z",
        "ʃ",
        "ʒ",
        "h",
        "m",
        "n",
        "ŋ",
        "l",
        "ɹ",
        "j",
        "w",
        "iː",
        "ɪ",
        "e",
        "ɛ",
        "æ",
        "ɑː",
        "ɒ",
        "ɔː",
        "ʊ",
        "uː",
        "ʌ",
        "ɜː",
        "ə",
        "eɪ",
        "aɪ",
        "ɔɪ",
        "aʊ",
        "oʊ",
        "əʊ",
        "ɪə",
        "eə",
        "ʊə",
        "ɚ",
        "ɝ",
        "ɾ",
        "ʔ",
        "ʍ",
        /* German */ "ç",
        "x",
        "ʁ",
        "ʀ",
        "pf",
        "ts",
        "yː",
        "ʏ",
        "øː",
        "œ",
        "aː",
        "ɐ",
        "ɔʏ",
        "n̩",
        "l̩",
        "ɐ̯",
        "p͡f",
        "t͡s",
        /* Slovak */ "c",
        "ɟ",
        "ɲ",
        "ʎ",
        "ɦ",
        "dz",
        "t͡ʃ",
        "d͡ʒ",
        "r̩",
        "rː",
        "lː",
        "ia",
        "ie",
        "iu",
        "uɔ",
        "i̯e",
        "ʊ̯ɔ",
        /* marks */ "ˈa",
        "ˌaɪ",
        "tʰ",
        "ã",
        "a˥",
        "g",
    };
    ris_phonetics phonetics;
    ris_error err = {0};
    if (ris__phonetics_read(ris__phonetics_visemes(), ris__phonetics_ipa, &phonetics, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    assert_int_equal(phonetics.viseme_count, 15);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        const ris_phone *phone = ris__phonetics_find(&phonetics, known[i]);
        if (!phone) {
            fail_msg("%s is not known", known[i]);
        }
        double shares = 0;
        for (uint32_t n = 0; n < phone->part_count; n++) {
            shares += phone->part[n].share;
            assert_true(phone->part[n].viseme < phonetics.viseme_count);
        }
        assert_float_equal(shares, 1, 1e-12);
    }
    static const char *const unknown[] = {"", "xyz", "ä̈q", "\xff", "\xc3", "a\x80", "ʌʌʌʌʌʌʌʌʌʌʌʌʌʌʌʌʌʌʌ"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        assert_null(ris__phonetics_find(&phonetics, unknown[i]));
    }
    const ris_phone *m = ris__phonetics_find(&phonetics, "m");
    assert_int_equal(m->part[0].viseme, ris__phonetics_viseme(&phonetics, "PP"));
    ris__phonetics_finish(&phonetics);
}

static void test_refuses(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {START END, "layers[0].speech: expected"},
        {START "{\"t\":1,\"end\":2}" END, "speech[0]: expected one of \"phone\" and \"viseme\""},
        {START "{\"phone\":\"a\",\"viseme\":\"aa\",\"t\":1,\"end\":2}" END, "speech[0]: expected one of"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":4,\"layers\":[{\"lead_s\":0.1,\"idle\":{"
         "}}]}",
         "layers[0].lead_s: only speech has a lead"},
        {START PHONE("qq", "1", "2") END, "speech[0].phone: unknown phone \"qq\""},
        {START "{\"viseme\":\"XX\",\"t\":1,\"end\":2}" END, "speech[0].viseme: unknown viseme \"XX\""},
        {START PHONE("a", "1", "5") END, "speech[0].end: expected a number of 0 to 4, found 5"},
        {START PHONE("a", "1", "1") END, "speech[0].end: expected a time at least 1 ms after \"t\", found 1"},
        {START PHONE("a", "1", "2") "," PHONE("p", "1.5", "3") END,
         "speech[1].t: expected a time at or after the end of the phone before, found 1.5"},
        {START "{\"phone\":\"a\",\"t\":1,\"end\":2,\"stress\":1}" END, "speech[0].stress: unknown key"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ris_clip *clip = NULL;
        ris_error err = {0};
        expect_error(&err, ris__clip_parse(&model, "t.json", bad[i].text, strlen(bad[i].text), &clip, &err),
                     RIS_ERROR_DATA, bad[i].says);
        assert_null(clip);
    }
}

static void test_tables_that_are_refused(void **state)
{
    (void)state;
    static const char good[] =
        "{\"visemes\":{\"viseme.sil\":{\"speech\":{\"hold\":1,\"lips\":[1,2,3],\"jaw\":[1,2,3],"
        "\"tongue\":[1,2,3]}}}}";
    static const char ipa[] = "{\"format\":\"risorius-ipa\",\"version\":1,\"phones\":{\"_\":[\"sil\"]}}";
    static const struct {
        const char *visemes, *phones, *says;
    } bad[] = {
        {"{\"visemes\":{\"viseme.sil\":{}}}", ipa, "visemes.viseme.sil: expected the key \"speech\""},
        {"{\"visemes\":{\"viseme.sil\":{\"speech\":{\"hold\":1,\"lips\":[1,2],\"jaw\":[1,2,3],\"tongue\":[1,"
         "2,3]}}}}",
         ipa, "speech.lips: expected 3 numbers"},
        {"{\"visemes\":{}}", ipa, "visemes: expected an object of 1 to 64 visemes"},
        {good, "{\"format\":\"risorius-ipa\",\"version\":1,\"phones\":{\"a\":[\"aa\"]}}",
         "phones.a[0]: unknown viseme \"aa\""},
        {good, "{\"format\":\"risorius-ipa\",\"version\":1,\"phones\":{\"a\":[]}}", "phones.a: expected"},
        {good, "{\"format\":\"risorius-ipa\",\"version\":1,\"phones\":{\"\":[\"sil\"]}}",
         "expected a symbol of"},
    };
    ris_phonetics phonetics;
    ris_error err = {0};
    assert_int_equal(ris__phonetics_read((ris_phonetics_text){"v", good, sizeof good - 1},
                                         (ris_phonetics_text){"p", ipa, sizeof ipa - 1}, &phonetics, &err),
                     RIS_OK);
    ris__phonetics_finish(&phonetics);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        expect_error(&err,
                     ris__phonetics_read((ris_phonetics_text){"v", bad[i].visemes, strlen(bad[i].visemes)},
                                         (ris_phonetics_text){"p", bad[i].phones, strlen(bad[i].phones)},
                                         &phonetics, &err),
                     RIS_ERROR_DATA, bad[i].says);
        ris__phonetics_finish(&phonetics);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dominance_by_hand),
        cmocka_unit_test(test_a_lone_phone),
        cmocka_unit_test(test_a_long_phone),
        cmocka_unit_test(test_coarticulation),
        cmocka_unit_test(test_lead),
        cmocka_unit_test(test_pauses_and_parts),
        cmocka_unit_test(test_symbols),
        cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_tables_that_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
