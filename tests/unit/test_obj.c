/* The strict OBJ reader: what it keeps, and the line and column of what it refuses. */
#include "scratch.h"

#include "risorius/head.h"

static ris_result parse(const char *text, ris_mesh *out, ris_error *err)
{
    return ris_mesh_parse_obj("t.obj", text, strlen(text), out, err);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void test_keeps_order_quads_and_uvs(void **state)
{
    (void)state;
    ris_mesh mesh;
    ris_error err = {0};
    const char *text =
        "# a comment\r\nmtllib x.mtl\no head\n\n" SQUARE
        "v 0.5 2 -1e-1\nvt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
        "g face\ns off\nusemtl skin\nf 1/1/1 2/2/1 3/3/1 4/4/1\n  f  4 3\t5  \nf -5//-1 -3//1 -4//1\n";
    assert_int_equal(parse(text, &mesh, &err), RIS_OK);
    assert_int_equal(mesh.vertex_count, 5);
    assert_int_equal(mesh.uv_count, 4);
    assert_int_equal(mesh.face_count, 3);
    static const uint32_t start[] = {0, 4, 7, 10}, vertex[] = {0, 1, 2, 3, 3, 2, 4, 0, 2, 1};
    assert_memory_equal(mesh.face_start, start, sizeof start);
    assert_memory_equal(mesh.face_vertex, vertex, sizeof vertex);
    assert_int_equal(mesh.face_uv[3], 3);
    assert_int_equal(mesh.face_uv[4], UINT32_MAX);
    assert_int_equal(mesh.face_uv[7], UINT32_MAX);
    assert_true(mesh.position[4].x == 0.5f && mesh.position[4].y == 2 && mesh.position[4].z == -0.1f);
    assert_true(mesh.uv[2 * 2] == 1 && mesh.uv[2 * 3 + 1] == 1);
    ris_mesh_finish(&mesh);
    ris_mesh_finish(&mesh); /* a finished mesh is an empty one */
}

static void test_last_line_without_newline(void **state)
{
    (void)state;
    ris_mesh mesh;
    ris_error err = {0};
    assert_int_equal(parse(SQUARE "f 1 2 3", &mesh, &err), RIS_OK);
    assert_int_equal(mesh.face_count, 1);
    ris_mesh_finish(&mesh);
}

static void test_refuses(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "expected vertices and faces, found 0 vertices and 0 faces"},
        {SQUARE, "found 4 vertices and 0 faces"},
        {"v 0 0\n", "t.obj:1:6: expected a finite z, found the end of the line"},
        {"v 0 0 0 1\n", "t.obj:1:9: expected three coordinates only, found \"1\""},
        {"v 0 nan 0\n", "t.obj:1:5: expected a finite y, found \"nan\""},
        {"v inf 0 0\n", "t.obj:1:3: expected a finite x, found \"inf\""},
        {"v 0 0 1e999\n", "t.obj:1:7: expected a finite z, found \"1e999\""},
        {"v 0 0 2e6\n", "t.obj:1:7: expected a number within +-1e6, found \"2e6\""},
        {"v 0 0 1,5\n", "t.obj:1:7: expected a finite z, found \"1,5\""},
        {"v 0 0 0x1\n", "expected a finite z"},
        {"vt 0\n", "t.obj:1:5: expected a finite v"},
        {"vt 0 0 0 0\n", "t.obj:1:10: expected at most three numbers"},
        {SQUARE "f 1 2 5\n", "t.obj:5:7: expected a vertex index of the 4 above, found \"5\""},
        {SQUARE "f 1 2 0\n", "t.obj:5:7: expected a vertex index of the 4 above, found \"0\""},
        {SQUARE "f 1 2 -5\n", "t.obj:5:7: expected a vertex index of the 4 above, found \"-5\""},
        {SQUARE "f 1 2 99999999999999999999\n", "t.obj:5:7: expected a vertex index"},
        {SQUARE "f 1/1 2 3\n", "t.obj:5:5: expected a texture vertex index of the 0 above, found \"1\""},
        {SQUARE "f 1/ 2 3\n", "t.obj:5:5: expected a texture vertex index"},
        {SQUARE "f 1// 2 3\n", "t.obj:5:6: expected a normal index"},
        {SQUARE "f 1//0 2 3\n", "t.obj:5:6: expected a normal index"},
        {SQUARE "f 1 2 3x\n", "t.obj:5:8: expected a blank after the corner, found \"x\""},
        {SQUARE "f 1 2\n", "t.obj:5:6: expected at least three corners"},
        {SQUARE "f 1 2 1\n", "t.obj:5:7: expected a vertex that the face has not named yet, found \"1\""},
        {SQUARE "l 1 2\n", "t.obj:5:1: expected v, vt, vn, f, o, g, s, usemtl, mtllib or #, found \"l\""},
        {SQUARE "f 1 2 3 \\\n4\n", "t.obj:5:9: expected a vertex index"},
        {"\x7f"
         "ELF\n",
         "t.obj:1:1: expected v, vt"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ris_mesh mesh;
        ris_error err = {0};
        expect_error(&err, parse(bad[i].text, &mesh, &err), RIS_ERROR_DATA, bad[i].says);
        assert_null(mesh.position);
        assert_int_equal(mesh.vertex_count, 0);
    }
}

static void test_absurd_polygon(void **state)
{
    (void)state;
    char text[4096] = "";
    size_t used = 0;
    ris_mesh mesh;
    ris_error err = {0};
    for (int i = 0; i < 65; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "v %d 0 0\n", i);
    }
    used += (size_t)snprintf(text + used, sizeof text - used, "f");
    for (int i = 0; i < 65; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, " %d", i + 1);
    }
    expect_error(&err, parse(text, &mesh, &err), RIS_ERROR_DATA, "t.obj:66:186: expected at most 64 corners");
}

static void test_files(void **state)
{
    (void)state;
    ris_mesh mesh;
    ris_error err = {0};
    expect_error(&err, ris_mesh_load_obj(scratch_path("absent.obj"), &mesh, &err), RIS_ERROR_DATA,
                 "absent.obj: cannot open");
    assert_null(mesh.position);
    assert_int_equal(ris_mesh_load_obj(scratch_write("a.obj", SQUARE "f 1 2 3 4\n"), &mesh, &err), RIS_OK);
    ris_mesh_finish(&mesh);
    expect_error(&err, ris_mesh_load_obj(scratch_write("b.obj", "v 0 0 x\n"), &mesh, &err), RIS_ERROR_DATA,
                 "b.obj:1:7: expected a finite z");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_keeps_order_quads_and_uvs),
        cmocka_unit_test(test_last_line_without_newline),
        cmocka_unit_test(test_refuses),
        cmocka_unit_test(test_absurd_polygon),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
