/* ris_mesh_check: each kind of broken mesh is refused and named, a sound one is not. */
#include "scratch.h"

#include "risorius/head.h"

#include <math.h>

#define TETRAHEDRON "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n"

static ris_mesh mesh_of(const char *text)
{
    ris_mesh mesh;
    ris_error err = {0};
    ris_result result = ris_mesh_parse_obj("t.obj", text, strlen(text), &mesh, &err);
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
    }
    assert_int_equal(result, RIS_OK);
    return mesh;
}

static void expect_refused(const char *text, const char *says)
{
    ris_error err = {0};
    ris_mesh mesh = mesh_of(text);
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA, says);
    ris_mesh_finish(&mesh);
}

static void expect_sound(const char *text)
{
    ris_error err = {0};
    ris_mesh mesh = mesh_of(text);
    assert_int_equal(ris_mesh_check(&mesh, "t.obj", &err), RIS_OK);
    assert_string_equal(err.text, "");
    ris_mesh_finish(&mesh);
}

static void test_sound(void **state)
{
    (void)state;
    expect_sound(TETRAHEDRON "f 2 3 4\n"); /* closed */
    expect_sound(TETRAHEDRON);             /* with a border */
    expect_sound("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n");
    expect_sound("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv -1 1 0\nf 1 2 3 4 5\n");
    expect_sound("v 0 0 0\nv 100 0 0\nv 50 0.001 0\nf 1 2 3\n"); /* thin is not flat */
}

static void test_refused(void **state)
{
    (void)state;
    expect_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
                   "face 0 has a triangle of zero area (vertices 0, 1, 2)");
    expect_refused("v 0 0 0\nv 0 0 0\nv 2 0 0\nf 1 2 3\n", "triangle of zero area");
    expect_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n", "face 0 has a triangle of zero area");
    expect_refused(TETRAHEDRON "v 9 9 9\n", "vertex 4 is isolated");
    expect_refused(TETRAHEDRON "v 1 1 1\nf 1 2 5\n",
                   "the edge of vertices 0 and 1 is in more than two faces (0, 1, 3)");
    expect_refused(TETRAHEDRON "f 2 4 3\n", "faces 0 and 3 run the same way along vertices 1 and 2");
    expect_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n",
                   "faces 0 and 1 run the same way");
}

static void test_broken_in_memory(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = mesh_of(TETRAHEDRON "vt 0 0\n");
    mesh.position[2].y = NAN;
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA,
                 "t.obj: vertex 2 has a coordinate that is not a finite number");
    mesh.position[2].y = INFINITY;
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA, "vertex 2");
    mesh.position[2].y = 1;
    assert_int_equal(ris_mesh_check(&mesh, "t.obj", &err), RIS_OK);
    mesh.uv[1] = NAN;
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA, "texture vertex 0");
    mesh.uv[1] = 0;
    mesh.face_vertex[1] = 4;
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA, "face 0 names vertex 4 of 4");
    ris_mesh_finish(&mesh);
    expect_error(&err, ris_mesh_check(&mesh, "t.obj", &err), RIS_ERROR_DATA, "0 vertices and 0 faces");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_broken_in_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
