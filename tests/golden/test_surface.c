/* The drawn surface without a device: Catmull-Clark weights against hand-computed numbers, and occlusion of simple shapes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draw/fold_mesh.h"
#include "draw/occlusion.h"
#include "draw/refine.h"
#include "risorius/head.h"

static const char cube[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\nf 2/1 3/2 7/3 6/4\n"
    "f 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";

static ris_mesh parse(const char *text)
{
    ris_mesh mesh;
    ris_error err = {0};
    assert_int_equal(ris_mesh_parse_obj("test", text, strlen(text), &mesh, &err), RIS_OK);
    return mesh;
}

static void near3(ris_vec3 p, float x, float y, float z)
{
    assert_true(fabsf(p.x - x) < 1e-5f && fabsf(p.y - y) < 1e-5f && fabsf(p.z - z) < 1e-5f);
}

/* A cube of half side 1: a corner goes to 5/9, an edge point to 3/4, a face point stays in the middle. */
static void test_cube(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse(cube);
    ris_refined refined;
    ris_vec3 at[26], normal[26];
    assert_int_equal(ris__refine(&mesh, 1, &refined, &err), RIS_OK);
    assert_int_equal(refined.vertex_count, 8 + 12 + 6);
    assert_int_equal(refined.quad_count, 24);
    assert_int_equal(refined.index_count, 24 * 6);
    for (uint32_t v = 0; v < refined.vertex_count; v++) {
        float sum = 0.0f;
        for (uint32_t i = refined.term_start[v]; i < refined.term_start[v + 1]; i++) {
            sum += refined.term[i].weight;
        }
        assert_true(fabsf(sum - 1.0f) < 1e-5f);
        assert_int_equal(refined.ring_start[v + 1] - refined.ring_start[v], v < 8 ? 3 : 4);
    }
    ris__refined_position(&refined, mesh.position, at);
    ris__refined_normal(&refined, at, normal);
    near3(at[0], -5.0f / 9.0f, -5.0f / 9.0f, -5.0f / 9.0f);
    near3(at[6], 5.0f / 9.0f, 5.0f / 9.0f, 5.0f / 9.0f);
    near3(at[8], 0.0f, -0.75f, -0.75f); /* first edge in order: vertices 0 and 1 */
    near3(at[20], 0.0f, 0.0f, -1.0f);
    for (uint32_t v = 0; v < refined.vertex_count; v++) { /* outward everywhere */
        assert_true(at[v].x * normal[v].x + at[v].y * normal[v].y + at[v].z * normal[v].z > 0.5f);
    }
    ris__refined_finish(&refined);
    ris_mesh_finish(&mesh);
}

/* An open sheet keeps its border on the border, and its UVs in bilinear places (v turned down). */
static void test_border(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh =
        parse("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    ris_refined refined;
    ris_vec3 at[9];
    assert_int_equal(ris__refine(&mesh, 1, &refined, &err), RIS_OK);
    assert_int_equal(refined.vertex_count, 9);
    ris__refined_position(&refined, mesh.position, at);
    near3(at[0], 0.5f, 0.5f, 0.0f); /* 6/8 own, 1/8 each border neighbour */
    near3(at[4], 2.0f, 0.0f, 0.0f); /* middle of a border edge */
    near3(at[8], 2.0f, 2.0f, 0.0f);
    assert_int_equal(refined.corner_count, 9);
    for (uint32_t i = 0; i < refined.corner_count; i++) {
        if (refined.corner[i].vertex == 8) {
            assert_true(refined.corner[i].u == 0.5f && refined.corner[i].v == 0.5f);
        }
        if (refined.corner[i].vertex == 0) {
            assert_true(refined.corner[i].u == 0.0f && refined.corner[i].v == 1.0f);
        }
    }
    ris__refined_finish(&refined);
    ris_mesh_finish(&mesh);
}

/* Level 0 keeps quads, triangles and a fan of a pentagon. */
static void test_plain(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = parse(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nf 1 2 3 4\nf 2 5 3\nf 3 5 6 7 4\n");
    ris_refined refined;
    assert_int_equal(ris__refine(&mesh, 0, &refined, &err), RIS_OK);
    assert_int_equal(refined.vertex_count, 7);
    assert_int_equal(refined.quad_count, 1 + 1 + 3);
    assert_int_equal(refined.index_count, 6 + 3 + 9);
    assert_int_equal(refined.quad_face[4], 2);
    ris__refined_finish(&refined);
    ris_mesh_finish(&mesh);
}

/* A point in the open sees everything, one deep in a box nothing, one on the floor below a wide lid almost nothing. */
static void test_occlusion(void **state)
{
    (void)state;
    ris_error err = {0};
    static const ris_vec3 corner[16] = {
        {-50, 0, -50}, {50, 0, -50}, {50, 0, 50}, {-50, 0, 50}, /* floor */
        {-50, 8, -50}, {0, 8, -50},  {0, 8, 50},  {-50, 8, 50}, /* lid over one half, seen from both sides */
    };
    static const uint32_t index[18] = {0, 2, 1, 0, 3, 2, 4, 6, 5, 4, 7, 6, 4, 5, 6, 4, 6, 7};
    const ris_occluder occluder = {8, corner, index, 18};
    const ris_vec3 point[3] = {{40, 0, 0}, {-30, 0, 0}, {-25, 8, 0}};
    const ris_vec3 up[3] = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
    float seen[3];
    assert_int_equal(ris__occlusion(&occluder, 1, point, up, 3, seen, &err), RIS_OK);
    assert_true(seen[0] > 0.95f);
    assert_true(seen[1] < 0.15f);
    assert_true(seen[2] > 0.95f);
}

enum { SIDE = 5, TEXELS = 64 };

/* A sheet of 4 x 4 faces of 10 mm with the texture over the whole of it. */
static ris_mesh sheet(void)
{
    char text[8192];
    size_t used = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d 0\nvt %g %g\n", 10 * (i % SIDE),
                                 10 * (i / SIDE), (i % SIDE) / 4.0, (i / SIDE) / 4.0);
    }
    for (int y = 0; y + 1 < SIDE; y++) {
        for (int x = 0; x + 1 < SIDE; x++) {
            int a = y * SIDE + x + 1, b = a + 1, c = b + SIDE, d = a + SIDE;
            used += (size_t)snprintf(text + used, sizeof text - used, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b,
                                     b, c, c, d, d);
        }
    }
    return parse(text);
}

/* How often the drawn triangles go from vertex a to vertex b. */
static int times(const ris_refined *in, uint32_t a, uint32_t b)
{
    int sum = 0;
    for (uint32_t i = 0; i < in->drawn_count; i++) {
        sum += in->corner[in->drawn[i]].vertex == a &&
               in->corner[in->drawn[i % 3 == 2 ? i - 2 : i + 1]].vertex == b;
    }
    return sum;
}

/* On the edge of the sheet, whose corners a Catmull-Clark step rounds. */
static bool on_outline(ris_vec3 p)
{
    float x = fminf(p.x, 40.0f - p.x), y = fminf(p.y, 40.0f - p.y);
    return x < 0.01f || y < 0.01f || (x < 1.3f && y < 1.3f);
}

/* A furrow along x across a sheet: finer triangles about it and nowhere else, no gap, the same area, folds across it. */
static void test_fold(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_mesh mesh = sheet();
    ris_refined refined;
    ris_vec3 *at;
    ris_vec4 *fold;
    uint8_t height[TEXELS * TEXELS];
    const ris_fold_map map = {TEXELS, TEXELS, height};
    for (int i = 0; i < TEXELS * TEXELS; i++) {
        float d = ((float)(i / TEXELS) - 24.0f) / 3.0f;
        height[i] = (uint8_t)(255.0 * RIS_DRAW_WRINKLE_FLAT - 120.0 * exp(-(double)(d * d)) + 0.5);
    }
    assert_int_equal(ris__refine(&mesh, 1, &refined, &err), RIS_OK);
    const uint32_t before = refined.vertex_count, triangles = refined.drawn_count;
    assert_int_equal(ris__fold_split(&map, mesh.position, &refined, &err), RIS_OK);
    assert_true(refined.vertex_count > before + 20 && refined.drawn_count > triangles + 60);
    at = calloc(refined.vertex_count, sizeof *at);
    fold = calloc(refined.vertex_count, sizeof *fold);
    assert_true(at && fold);
    ris__refined_position(&refined, mesh.position, at);
    assert_int_equal(ris__fold_lines(&map, &refined, at, fold, &err), RIS_OK);
    float area = 0.0f, deepest = 0.0f;
    for (uint32_t i = 0; i < refined.drawn_count; i++) {
        uint32_t a = refined.corner[refined.drawn[i]].vertex,
                 b = refined.corner[refined.drawn[i % 3 == 2 ? i - 2 : i + 1]].vertex;
        ris_vec3 p = at[a], q = at[b];
        area += 0.5f * (p.x * q.y - p.y * q.x);
        bool border = on_outline(p) && on_outline(q);
        assert_int_equal(times(&refined, a, b), 1);
        assert_true(times(&refined, b, a) == 1 || (border && times(&refined, b, a) == 0));
    }
    assert_true(fabsf(area - 1575.0f) < 0.1f); /* 1600 less four rounded corners of 6.25 */
    for (uint32_t v = 0; v < refined.vertex_count; v++) {
        float sum = 0.0f;
        for (uint32_t i = refined.term_start[v]; i < refined.term_start[v + 1]; i++) {
            sum += refined.term[i].weight;
        }
        assert_true(fabsf(sum - 1.0f) < 1e-5f);
        assert_true(v < before || fabsf(at[v].y - 24.6f) < 11.0f);
        assert_true(fold[v].w > -0.1f || fabsf(fold[v].y) > 0.9f);
        deepest = fminf(deepest, fold[v].w);
    }
    assert_true(deepest < -0.3f && deepest > -0.7f);
    free(at);
    free(fold);
    ris__refined_finish(&refined);
    ris_mesh_finish(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),      cmocka_unit_test(test_border), cmocka_unit_test(test_plain),
        cmocka_unit_test(test_occlusion), cmocka_unit_test(test_fold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
