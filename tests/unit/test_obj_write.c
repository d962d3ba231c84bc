/* engine/output/obj_write.c: order, quads and UVs survive writing and reading; two objects count on. */
#include "comma_locale.h"
#include "scratch.h"

#include "base/file.h"
#include "risorius/output.h"

static const char source[] = "v 0 0 0\nv 10 0 0\nv 10 10 0.25\nv 0 10 0\nv 5 15 0\n"
                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                             "f 1/1 2/2 3/3 4/4\nf 4/4 3/3 5/1\n";

static ris_mesh parse(void)
{
    ris_mesh mesh;
    ris_error err = {0};
    assert_int_equal(ris_mesh_parse_obj("source", source, strlen(source), &mesh, &err), RIS_OK);
    return mesh;
}

static void test_round_trip(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse(), back;
    ris_vec4 moved[5];
    for (uint32_t i = 0; i < 5; i++) {
        moved[i] =
            (ris_vec4){mesh.position[i].x + 1.5f, mesh.position[i].y - 0.125f, mesh.position[i].z, 0.0f};
    }
    const ris_obj_object object = {"skin", &mesh, moved};
    const char *path = scratch_path("a.obj");
    assert_int_equal(ris_obj_write(path, &object, 1, &err), RIS_OK);
    assert_int_equal(ris_mesh_load_obj(path, &back, &err), RIS_OK);
    assert_int_equal(back.vertex_count, mesh.vertex_count);
    assert_int_equal(back.uv_count, mesh.uv_count);
    assert_int_equal(back.face_count, mesh.face_count);
    assert_memory_equal(back.face_start, mesh.face_start, 3 * sizeof *mesh.face_start);
    assert_memory_equal(back.face_vertex, mesh.face_vertex, 7 * sizeof *mesh.face_vertex);
    assert_memory_equal(back.face_uv, mesh.face_uv, 7 * sizeof *mesh.face_uv);
    for (uint32_t i = 0; i < 5; i++) {
        assert_true(back.position[i].x == moved[i].x && back.position[i].y == moved[i].y &&
                    back.position[i].z == moved[i].z);
    }
    ris_mesh_finish(&back);
    ris_mesh_finish(&mesh);
    scratch_clear();
}

static void test_text(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse();
    const ris_vec4 at[5] = {{0.1234567f, -2.0f, 3e-7f, 0.0f}};
    const ris_obj_object objects[2] = {{"skin", &mesh, at}, {"tongue", &mesh, at}};
    const char *path = scratch_path("b.obj");
    char *text;
    size_t size;
    assert_int_equal(ris_obj_write(path, objects, 2, &err), RIS_OK);
    assert_int_equal(ris__file_read(path, 10000, &text, &size, &err), RIS_OK);
    assert_non_null(strstr(text, "\nv 0.123457 -2.000000 0.000000\n"));
    assert_non_null(strstr(text, "\no tongue\n"));
    assert_non_null(strstr(text, "\nf 1/1 2/2 3/3 4/4\n"));
    assert_non_null(
        strstr(text, "\nf 6/5 7/6 8/7 9/8\n")); /* indices of the second object go on from the first */
    free(text);
    ris_mesh_finish(&mesh);
    assert_int_equal(scratch_count(), 1);
    scratch_clear();
}

/* A program that uses the library may run in any locale. */
static void test_comma_locale(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse();
    const ris_vec4 at[5] = {{0.5f, -2.25f, 3.0f, 0.0f}};
    const ris_obj_object object = {"skin", &mesh, at};
    const char *path = scratch_path("c.obj");
    char *text;
    size_t size;
    comma_locale_begin();
    ris_result result = ris_obj_write(path, &object, 1, &err);
    comma_locale_end();
    assert_int_equal(result, RIS_OK);
    assert_int_equal(ris__file_read(path, 10000, &text, &size, &err), RIS_OK);
    assert_non_null(strstr(text, "\nv 0.500000 -2.250000 3.000000\n"));
    free(text);
    ris_mesh_finish(&mesh);
    scratch_clear();
}

static void test_unwritable(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse();
    const ris_vec4 at[5] = {{0}};
    const ris_obj_object object = {"skin", &mesh, at};
    expect_error(&err, ris_obj_write(scratch_path("no/a.obj"), &object, 1, &err), RIS_ERROR_FAILED,
                 "no/a.obj");
    expect_error(&err, ris_obj_write("/dev/full", &object, 1, &err), RIS_ERROR_FAILED, "No space left");
    ris_mesh_finish(&mesh);
    assert_int_equal(scratch_count(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_comma_locale),
        cmocka_unit_test(test_unwritable),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
