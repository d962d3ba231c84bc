/* engine/output/pc2.c: byte layout of the cache, sample count filled in at the end, nothing left of an abandoned one. */
#include "scratch.h"

#include "base/file.h"
#include "risorius/output.h"

static uint32_t u32(const char *at)
{
    const uint8_t *b = (const uint8_t *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float f32(const char *at)
{
    uint32_t bits = u32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void test_layout(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_pc2 *cache = NULL;
    const char *path = scratch_path("a.pc2");
    const ris_vec4 first[2] = {{1.0f, 2.0f, 3.0f, 9.0f}, {-4.0f, 0.5f, 1e-3f, 9.0f}};
    const ris_vec4 second[2] = {{5.0f, 6.0f, 7.0f, 9.0f}, {8.0f, 9.0f, 10.0f, 9.0f}};
    assert_int_equal(ris_pc2_open(path, 2, 1.0f, 0.5f, &cache, &err), RIS_OK);
    assert_int_equal(ris_pc2_add(cache, first, &err), RIS_OK);
    assert_int_equal(ris_pc2_add(cache, second, &err), RIS_OK);
    assert_int_equal(ris_pc2_close(cache, &err), RIS_OK);
    char *bytes;
    size_t size;
    assert_int_equal(ris__file_read(path, 1000, &bytes, &size, &err), RIS_OK);
    assert_int_equal(size, 32 + 2 * 2 * 12);
    assert_memory_equal(bytes, "POINTCACHE2", 12);
    assert_int_equal(u32(bytes + 12), 1);
    assert_int_equal(u32(bytes + 16), 2);
    assert_true(f32(bytes + 20) == 1.0f);
    assert_true(f32(bytes + 24) == 0.5f);
    assert_int_equal(u32(bytes + 28), 2);
    assert_true(f32(bytes + 32) == 1.0f && f32(bytes + 36) == 2.0f && f32(bytes + 40) == 3.0f);
    assert_true(f32(bytes + 44) == -4.0f && f32(bytes + 48) == 0.5f && f32(bytes + 52) == 1e-3f);
    assert_true(f32(bytes + 56) == 5.0f && f32(bytes + 76) == 10.0f);
    free(bytes);
    assert_int_equal(scratch_count(), 1);
    scratch_clear();
}

static void test_abandon(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_pc2 *cache = NULL;
    const ris_vec4 point = {0};
    assert_int_equal(ris_pc2_open(scratch_path("b.pc2"), 1, 0.0f, 1.0f, &cache, &err), RIS_OK);
    assert_int_equal(ris_pc2_add(cache, &point, &err), RIS_OK);
    ris_pc2_abandon(cache);
    ris_pc2_abandon(NULL);
    assert_int_equal(scratch_count(), 0);
}

static void test_refused(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_pc2 *cache = NULL;
    expect_error(&err, ris_pc2_open(scratch_path("c.pc2"), 0, 0.0f, 1.0f, &cache, &err), RIS_ERROR_USAGE,
                 "found 0");
    assert_null(cache);
    expect_error(&err, ris_pc2_open(scratch_path("no/c.pc2"), 1, 0.0f, 1.0f, &cache, &err), RIS_ERROR_FAILED,
                 "no/c.pc2");
    assert_null(cache);
    assert_int_equal(scratch_count(), 0);
}

static void test_full_disk(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_pc2 *cache = NULL;
    static ris_vec4 many[4096];
    ris_result result = ris_pc2_open("/dev/full", 4096, 0.0f, 1.0f, &cache, &err);
    if (result == RIS_OK) {
        result = ris_pc2_add(cache, many, &err);
        if (result == RIS_OK) {
            result = ris_pc2_close(cache, &err);
        } else {
            ris_pc2_abandon(cache);
        }
    }
    expect_error(&err, result, RIS_ERROR_FAILED, "/dev/full");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_layout),
        cmocka_unit_test(test_abandon),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
