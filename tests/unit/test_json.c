/* JSON readers: every refusal says file, line, column and path. */
#include "scratch.h"

#include "asset/json.h"

#include <math.h>

static ris_json parsed(const char *text)
{
    ris_json json;
    ris_error err = {0};
    ris_result result = ris__json_parse("t.json", text, strlen(text), &json, &err);
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
    }
    assert_int_equal(result, RIS_OK);
    return json;
}

static void test_syntax(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"{\"a\": 1,\n  \"b\": }", "t.json:2:8: "},
        {"{\"a\": 1,\n", "t.json:2:"},
        {"", "t.json:1:"},
        {"[1]", "t.json:1:1: expected an object at the top of the file"},
        {"{\"a\":1,\"a\":2}", "t.json:1:"},
        {"{\"a\":1e999}", "t.json:1:"},
        {"{\"a\":NaN}", "t.json:1:"},
        {"{\"a\":1} x", "t.json:1:"},
        {"{\"a\":\"\xff\"}", "t.json:1:"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ris_json json;
        ris_error err = {0};
        ris_result result = ris__json_parse("t.json", bad[i].text, strlen(bad[i].text), &json, &err);
        expect_error(&err, result, RIS_ERROR_DATA, bad[i].says);
        assert_null(json.root);
    }
}

static void test_place_of_a_value(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_json json = parsed("{\n \"text, {[\\\"\": [1, {\"\xc3\xa4\": 2}],\n \"m\": [\n  {\"g\": [[1,2],\n    "
                           "     [3, [4]]]}, 5 ]\n}");
    ris_json_at root = ris__json_root(&json), m = ris__json_key(&root, "m"), m0 = ris__json_item(&m, 0);
    ris_json_at g = ris__json_key(&m0, "g"), g1 = ris__json_item(&g, 1), g11 = ris__json_item(&g1, 1);
    expect_error(&err, ris__json_expected(&g11, &err, "a number"), RIS_ERROR_DATA,
                 "t.json:5:14: m[0].g[1][1]: expected a number, found an array of 1");
    ris_json_at m1 = ris__json_item(&m, 1);
    expect_error(&err, ris__json_expected(&m1, &err, "an object"), RIS_ERROR_DATA,
                 "t.json:5:22: m[1]: expected an object, found 5");
    ris_json_at absent = ris__json_key(&m0, "h");
    expect_error(&err, ris__json_expected(&absent, &err, "a number"), RIS_ERROR_DATA,
                 "t.json:4:3: m[0]: expected the key \"h\" with a number, found none");
    expect_error(&err, ris__json_fail(&root, &err, "wrong"), RIS_ERROR_DATA, "t.json:1:1: wrong");
    ris__json_finish(&json);
}

static void test_column_counts_letters(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_json json = parsed("{\"a\": [\"\xc3\xa4\xc3\xb6\", 7]}");
    ris_json_at root = ris__json_root(&json), a = ris__json_key(&root, "a"), item = ris__json_item(&a, 1);
    expect_error(&err, ris__json_fail(&item, &err, "wrong"), RIS_ERROR_DATA, "t.json:1:14: a[1]: wrong");
    ris__json_finish(&json);
}

static void test_format(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_json json = parsed("{\"format\":\"x\",\"version\":2}");
    ris_json_at root = ris__json_root(&json);
    assert_int_equal(ris__json_check_format(&root, "x", 2, &err), RIS_OK);
    expect_error(&err, ris__json_check_format(&root, "y", 2, &err), RIS_ERROR_DATA,
                 "t.json:1:11: format: expected \"y\", found \"x\"");
    expect_error(&err, ris__json_check_format(&root, "x", 1, &err), RIS_ERROR_DATA,
                 "version: expected 1, found 2");
    ris__json_finish(&json);
    json = parsed("{}");
    root = ris__json_root(&json);
    expect_error(&err, ris__json_check_format(&root, "x", 2, &err), RIS_ERROR_DATA,
                 "t.json:1:1: expected the key \"format\" with \"x\", found none");
    ris__json_finish(&json);
}

static void test_objects(void **state)
{
    (void)state;
    static const char *const keys[] = {"duration_s", "tracks", NULL};
    ris_error err = {0};
    ris_json json = parsed("{\"tracks\":1,\n\"duration\":2}");
    ris_json_at root = ris__json_root(&json);
    expect_error(&err, ris__json_check_object(&root, keys, &err), RIS_ERROR_DATA,
                 "t.json:2:12: duration: unknown key; nearest: duration_s, tracks");
    ris__json_finish(&json);
}

static void test_numbers(void **state)
{
    (void)state;
    ris_error err = {0};
    float number = 7, vector[3];
    double wide = 0;
    uint32_t integer = 7;
    ris_json json = parsed(
        "{\"a\":1.5,\"b\":-1,\"c\":[1,2],\"d\":[1,2,\"x\"],\"e\":\"t\",\"f\":null,\"g\":[1,2,3],\"h\":2.0}");
    ris_json_at root = ris__json_root(&json), a = ris__json_key(&root, "a"), b = ris__json_key(&root, "b");
    ris_json_at c = ris__json_key(&root, "c"), d = ris__json_key(&root, "d"), e = ris__json_key(&root, "e");
    ris_json_at f = ris__json_key(&root, "f"), g = ris__json_key(&root, "g"), h = ris__json_key(&root, "h");
    ris_json_at absent = ris__json_key(&root, "absent");
    assert_int_equal(ris__json_float(&absent, RIS_JSON_OPTIONAL, 0, 1, &number, &err), RIS_OK);
    assert_true(number == 7);
    assert_int_equal(ris__json_float(&a, RIS_JSON_OPTIONAL, 0, 2, &number, &err), RIS_OK);
    assert_true(number == 1.5f);
    expect_error(&err, ris__json_float(&a, RIS_JSON_REQUIRED, 0, 1, &number, &err), RIS_ERROR_DATA,
                 "a: expected a number of 0 to 1, found 1.5");
    expect_error(&err, ris__json_double(&e, RIS_JSON_OPTIONAL, 0, 1, &wide, &err), RIS_ERROR_DATA,
                 "found \"t\"");
    expect_error(&err, ris__json_float(&f, RIS_JSON_OPTIONAL, 0, 1, &number, &err), RIS_ERROR_DATA,
                 "found null");
    expect_error(&err, ris__json_uint(&b, RIS_JSON_REQUIRED, 0, 9, &integer, &err), RIS_ERROR_DATA,
                 "b: expected an integer of 0 to 9, found -1");
    expect_error(&err, ris__json_uint(&h, RIS_JSON_REQUIRED, 0, 9, &integer, &err), RIS_ERROR_DATA,
                 "found 2");
    assert_int_equal(integer, 7);
    expect_error(&err, ris__json_floats(&c, RIS_JSON_REQUIRED, 3, 0, 9, vector, &err), RIS_ERROR_DATA,
                 "c: expected 3 numbers, found an array of 2");
    expect_error(&err, ris__json_floats(&d, RIS_JSON_REQUIRED, 3, 0, 9, vector, &err), RIS_ERROR_DATA,
                 "d[2]: expected a number of 0 to 9, found \"x\"");
    assert_int_equal(ris__json_floats(&g, RIS_JSON_REQUIRED, 3, 0, 9, vector, &err), RIS_OK);
    assert_true(vector[0] == 1 && vector[1] == 2 && vector[2] == 3);
    ris__json_finish(&json);
}

static void test_texts(void **state)
{
    (void)state;
    static const char *const choices[] = {"one", "two", NULL};
    ris_error err = {0};
    char text[4] = "";
    uint32_t choice = 9;
    ris_json json =
        parsed("{\"a\":\"abc\",\"b\":\"abcd\",\"c\":\"a\\nb\",\"d\":\"two\",\"e\":\"three\",\"f\":1}");
    ris_json_at root = ris__json_root(&json), a = ris__json_key(&root, "a"), b = ris__json_key(&root, "b");
    ris_json_at c = ris__json_key(&root, "c"), d = ris__json_key(&root, "d"), e = ris__json_key(&root, "e");
    ris_json_at f = ris__json_key(&root, "f");
    assert_int_equal(ris__json_text(&a, RIS_JSON_REQUIRED, text, sizeof text, &err), RIS_OK);
    assert_string_equal(text, "abc");
    expect_error(&err, ris__json_text(&b, RIS_JSON_REQUIRED, text, sizeof text, &err), RIS_ERROR_DATA,
                 "b: expected a text of at most 3 bytes");
    expect_error(&err, ris__json_text(&c, RIS_JSON_REQUIRED, text, sizeof text, &err), RIS_ERROR_DATA,
                 "on one line");
    expect_error(&err, ris__json_text(&f, RIS_JSON_REQUIRED, text, sizeof text, &err), RIS_ERROR_DATA,
                 "found 1");
    assert_int_equal(ris__json_choice(&d, RIS_JSON_REQUIRED, choices, &choice, &err), RIS_OK);
    assert_int_equal(choice, 1);
    expect_error(&err, ris__json_choice(&e, RIS_JSON_REQUIRED, choices, &choice, &err), RIS_ERROR_DATA,
                 "e: expected one of one, two, found \"three\"");
    ris__json_finish(&json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_syntax),
        cmocka_unit_test(test_place_of_a_value),
        cmocka_unit_test(test_column_counts_letters),
        cmocka_unit_test(test_format),
        cmocka_unit_test(test_objects),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
