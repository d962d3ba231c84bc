/* The committed skull, mandible and landmarks of the reference head (KA-04, KA-07): the bounds of
 * docs/skull.md, measured
 * on the files, and controls that each measurement notices what it is for. */
#include "make_skull.h"

#include "risorius/head.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"

static hull skin;
static tri_mesh bone[2], teeth[2];
static bvh tree[2];
static landmark_set marks;
static dvec jaw_point, jaw_axis;

static int load(void **state)
{
    static const char *const bones[2] = {HUMAN "/skull.obj", HUMAN "/mandible.obj"};
    static const char *const crowns[2] = {HUMAN "/teeth_upper.obj", HUMAN "/teeth_lower.obj"};
    ris_error err = {0};
    ris_head head;
    (void)state;
    bool ok = ris_head_load(HUMAN, &head, &err) == RIS_OK;
    if (ok) {
        jaw_point = dv(head.jaw.point.x, head.jaw.point.y, head.jaw.point.z);
        jaw_axis = dv(head.jaw.axis.x, head.jaw.axis.y, head.jaw.axis.z);
        ris_head_finish(&head);
    }
    ok = ok && hull_load(HUMAN, &skin, &err) == RIS_OK &&
         landmarks_read(HUMAN "/landmarks.json", &marks, &err) == RIS_OK;
    for (int k = 0; k < 2 && ok; k++)
        ok = ris__tri_load_obj(bones[k], &bone[k], &err) == RIS_OK &&
             ris__tri_load_obj(crowns[k], &teeth[k], &err) == RIS_OK &&
             ris__bvh_build(&tree[k], &bone[k], &err) == RIS_OK;
    if (!ok)
        print_error("%s\n", err.text);
    return ok ? 0 : -1;
}

static int unload(void **state)
{
    (void)state;
    hull_finish(&skin);
    for (int k = 0; k < 2; k++) {
        ris__bvh_finish(&tree[k]);
        ris__tri_finish(&bone[k]);
        ris__tri_finish(&teeth[k]);
    }
    return 0;
}

static skull_report measure(const tri_mesh *bones, const bvh *trees, const landmark_set *set, dvec point)
{
    skull_input in = {&skin, bones, trees, teeth, set, point, jaw_axis};
    skull_report r;
    ris_error err = {0};
    assert_int_equal(skull_measure(&in, &r, &err), RIS_OK);
    return r;
}

static void test_bounds_hold(void **state)
{
    (void)state;
    ris_error err = {0};
    skull_report r = measure(bone, tree, &marks, jaw_point);
    skull_print(&r);
    if (!skull_accept(&r, &err))
        fail_msg("%s", err.text);
    assert_true(r.joint_gap > 0.3 && r.joint_gap < 4);
    assert_in_range(bone[0].triangle_count, 10000, 25000);
    assert_in_range(bone[1].triangle_count, 6000, 12000);
}

/* Bones moved, scaled or replaced: the measurement must say what broke. */
static void test_controls_are_noticed(void **state)
{
    (void)state;
    tri_mesh moved[2];
    bvh trees[2];
    ris_error err = {0};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ris__tri_load_obj(k ? HUMAN "/mandible.obj" : HUMAN "/skull.obj", &moved[k], &err),
                         RIS_OK);
        for (uint32_t i = 0; i < moved[k].vertex_count; i++)
            moved[k].position[i].z += k ? -8 : 6;
        assert_int_equal(ris__bvh_build(&trees[k], &moved[k], &err), RIS_OK);
    }
    skull_report r = measure(moved, trees, &marks, jaw_point);
    assert_true(r.least_depth[0] < 0);
    assert_true(r.condyle_off > 5);
    assert_true(r.worst_near_error > 0.3);
    assert_true(r.crossing > 0);
    assert_true(r.roots_bare > 0);
    assert_true(!skull_accept(&r, &err));
    moved[0].position[0].x += 1; /* one vertex out of symmetry, one triangle missing */
    moved[0].triangle_count--;
    r = measure(moved, tree, &marks, jaw_point);
    assert_true(r.asymmetry[0] > 0.4 && r.open_edges[0] == 3);
    for (int k = 0; k < 2; k++) {
        ris__bvh_finish(&trees[k]);
        ris__tri_finish(&moved[k]);
    }
    r = measure(bone, tree, &marks, dv_add(jaw_point, dv(0, 3, 4)));
    assert_true(r.condyle_off > 3);
    landmark_set wrong = marks;
    wrong.bone[0].depth_mm *= 1.5;
    r = measure(bone, tree, &wrong, jaw_point);
    assert_true(r.worst_depth_error > 0.3);
}

/* The skin itself, moved 4 mm inwards, as the skull: refused, for its openings and as a shrunken skin. */
static void test_shrunken_skin_is_refused(void **state)
{
    (void)state;
    ris_error err = {0};
    tri_mesh shrunk[2] = {skin.mesh, bone[1]};
    dvec *normal = calloc(skin.mesh.vertex_count, sizeof *normal);
    shrunk[0].position = malloc(skin.mesh.vertex_count * sizeof *normal);
    assert_true(normal && shrunk[0].position);
    for (uint32_t i = 0; i < skin.mesh.triangle_count * 3; i++)
        normal[skin.mesh.triangle[i]] =
            dv_add(normal[skin.mesh.triangle[i]], ris__tri_normal(&skin.mesh, i / 3));
    for (uint32_t i = 0; i < skin.mesh.vertex_count; i++)
        shrunk[0].position[i] = dv_mad(skin.mesh.position[i], -4, dv_unit(normal[i]));
    bvh trees[2] = {{0}, tree[1]};
    assert_int_equal(ris__bvh_build(&trees[0], &shrunk[0], &err), RIS_OK);
    skull_report r = measure(shrunk, trees, &marks, jaw_point);
    assert_true(r.orbit_free < 15);
    assert_true(r.nose_free < 15);
    assert_true(r.arch_free < 12);
    assert_true(r.shrink_share > 0.6);
    ris__bvh_finish(&trees[0]);
    free(shrunk[0].position);
    free(normal);
}

/* Edges of the mandible that pierce the skull after a turn about the jaw axis and a shift. */
static uint32_t crossings_after(double degrees, dvec shift)
{
    tri_mesh turned;
    bvh t;
    ris_error err = {0};
    double c = cos(degrees * 0.017453292519943295), s = sin(degrees * 0.017453292519943295);
    assert_int_equal(ris__tri_load_obj(HUMAN "/mandible.obj", &turned, &err), RIS_OK);
    for (uint32_t i = 0; i < turned.vertex_count; i++) {
        dvec p = dv_sub(turned.position[i], jaw_point);
        turned.position[i] = dv_add(dv_add(jaw_point, shift), dv(p.x, p.y * c - p.z * s, p.y * s + p.z * c));
    }
    assert_int_equal(ris__bvh_build(&t, &turned, &err), RIS_OK);
    bvh trees[2] = {tree[0], t};
    uint32_t crossing = skull_crossings(trees);
    ris__bvh_finish(&t);
    ris__tri_finish(&turned);
    return crossing;
}

/* The hinge of head.json (axis along x) opens the jaw to its limit without bone in bone; a jaw pushed back
 * is noticed. */
static void test_jaw_opens_freely(void **state)
{
    (void)state;
    for (int degrees = 5; degrees <= 20; degrees += 5)
        assert_int_equal(crossings_after(degrees, dv(0, 0, 0)), 0);
    assert_true(crossings_after(0, dv(0, 0, -6)) > 0);
}

/* No vertex of an eyeball in bone; an eye moved up by half its size is in the roof of the orbit. */
static void test_eyes_fit(void **state)
{
    (void)state;
    ris_error err = {0};
    tri_mesh eye;
    assert_int_equal(ris__tri_load_obj(HUMAN "/eye.L.obj", &eye, &err), RIS_OK);
    double nearest = HUGE_VAL, moved = HUGE_VAL;
    for (uint32_t i = 0; i < eye.vertex_count; i++) {
        nearest = fmin(nearest, -ris__bvh_depth(&tree[0], eye.position[i]));
        moved = fmin(moved, -ris__bvh_depth(&tree[0], dv_add(eye.position[i], dv(0, 15, 0))));
    }
    ris__tri_finish(&eye);
    print_message("eyeball to orbit %.2f mm\n", nearest);
    assert_true(nearest > 0);
    assert_true(moved < 0);
}

static const landmark *find(const landmark *list, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(list[i].name, name) == 0)
            return &list[i];
    fail_msg("no landmark \"%s\"", name);
    return NULL;
}

/* Distance of the stored place from the one its triangle and weights give, and whether the triangle is of
 * the mesh. */
static double off_surface(const tri_mesh *mesh, uint32_t triangles, const landmark *l)
{
    dvec p = {0};
    for (int k = 0; k < 3; k++) {
        assert_true(l->vertex[k] < mesh->vertex_count && l->weight[k] >= -1e-9 && l->weight[k] <= 1 + 1e-9);
        p = dv_mad(p, l->weight[k], mesh->position[l->vertex[k]]);
    }
    bool known = false;
    for (uint32_t i = 0; i < triangles && !known; i++)
        known = memcmp(mesh->triangle + 3 * (size_t)i, l->vertex, sizeof l->vertex) == 0;
    assert_true(known);
    return dv_length(dv_sub(p, l->at));
}

static void test_landmarks(void **state)
{
    (void)state;
    static const char *const midline[] = {"v",   "tr",  "g",  "n",  "se",  "prn", "sn", "ls",
                                          "sts", "sti", "li", "sl", "pog", "gn",  "me", "op"};
    static const char *const paired[] = {"fe",  "sci", "en",  "ex",  "ps", "pi", "or", "os",
                                         "zy",  "al",  "ch",  "cph", "go", "t",  "po", "sa",
                                         "sba", "obs", "obi", "pa",  "ft", "eu"};
    assert_true(marks.skin_count >= 60);
    for (size_t i = 0; i < sizeof midline / sizeof *midline; i++)
        assert_true(fabs(find(marks.skin, marks.skin_count, midline[i])->at.x) < 0.01);
    for (size_t i = 0; i < sizeof paired / sizeof *paired; i++) {
        char name[2][16];
        snprintf(name[0], sizeof name[0], "%s.L", paired[i]);
        snprintf(name[1], sizeof name[1], "%s.R", paired[i]);
        dvec l = find(marks.skin, marks.skin_count, name[0])->at,
             r = find(marks.skin, marks.skin_count, name[1])->at;
        assert_true(l.x > 3 && dv_length(dv_sub(l, dv(-r.x, r.y, r.z))) < 0.05);
    }
    for (uint32_t i = 0; i < marks.skin_count; i++) {
        assert_true(off_surface(&skin.mesh, skin.skin_triangles, &marks.skin[i]) < 5e-4);
        for (uint32_t k = 0; k < i; k++)
            assert_string_not_equal(marks.skin[i].name, marks.skin[k].name);
    }
    /* Frankfort pose (KA-08): orbitale and porion at one height */
    dvec po = find(marks.skin, marks.skin_count, "po.L")->at;
    assert_true(fabs(po.y) < 4 && fabs(po.z) < 5);
}

static void test_pairs(void **state)
{
    (void)state;
    assert_int_equal(marks.bone_count, 10 + 28); /* table 8.3 */
    uint32_t measured = 0;
    for (uint32_t i = 0; i < marks.bone_count; i++) {
        const landmark *b = &marks.bone[i], *s = find(marks.skin, marks.skin_count, b->name);
        assert_true(off_surface(&bone[b->bone], bone[b->bone].triangle_count, b) < 5e-4);
        dvec d = dv_sub(s->at, b->at);
        assert_true(fabs(dv_length(d) - b->depth_mm) < 1e-3);
        assert_true(dv_length(dv_sub(dv_unit(d), b->normal)) < 1e-3);
        measured += b->table_mm > 0;
    }
    assert_int_equal(measured, 10 + 22); /* all rows of tissue_depth.csv */
    site sites[SITE_LIMIT];
    ris_error err = {0};
    uint32_t count = sites_default(sites);
    assert_int_equal(sites_read_table(RIS_SOURCE_DIR "/assets/tables/tissue_depth.csv", sites, count, &err),
                     RIS_OK);
    for (uint32_t i = 0; i < marks.bone_count; i++)
        for (uint32_t k = 0; k < count; k++) {
            size_t n = strlen(sites[k].name);
            const char *rest =
                strncmp(marks.bone[i].name, sites[k].name, n) == 0 ? marks.bone[i].name + n : "?";
            if (strcmp(rest, sites[k].bilateral ? ".L" : "") == 0)
                assert_true(fabs(marks.bone[i].table_mm - sites[k].table_mm) < 1e-9);
        }
}

/* A unit cube: what the queries must say is known. */
static void test_queries(void **state)
{
    (void)state;
    dvec corner[8];
    uint32_t face[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    for (int i = 0; i < 8; i++)
        corner[i] = dv(i & 1, i >> 1 & 1, i >> 2);
    tri_mesh cube = {8, 12, corner, face};
    bvh t;
    ris_error err = {0};
    uint32_t open = 1;
    assert_int_equal(tri_open_edges(&cube, &open, &err), RIS_OK);
    assert_int_equal(open, 0);
    assert_true(fabs(tri_volume(&cube) - 1) < 1e-12);
    assert_int_equal(ris__bvh_build(&t, &cube, &err), RIS_OK);
    assert_true(fabs(ris__bvh_depth(&t, dv(0.5, 0.5, 0.9)) - 0.1) < 1e-12);
    assert_true(fabs(ris__bvh_depth(&t, dv(2, 2, 1)) + sqrt(2)) < 1e-12);
    bvh_hit hit = ris__bvh_ray(&t, dv(0.3, 0.6, 5), dv(0, 0, -1), 0, 100);
    assert_true(hit.found && fabs(hit.distance - 4) < 1e-12);
    assert_false(ris__bvh_ray(&t, dv(0.3, 0.6, 5), dv(0, 0, -1), 0, 3.9).found);
    ris__bvh_finish(&t);
}

/* A ball by the same mesher: closed, symmetric, its volume and every vertex within the lattice's error. */
static void test_mesher(void **state)
{
    (void)state;
    ris_error err = {0};
    solid s;
    tri_mesh half, ball;
    assert_int_equal(solid_init(&s, "ball", &err), RIS_OK);
    shape def = {.kind = SHAPE_ELLIPSOID, .radius = {10, 10, 10}};
    solid_add(&s, &def);
    assert_int_equal(mesh_half(&s, dv(0, -12, -12), dv(12, 12, 12), 1, &half, &err), RIS_OK);
    mesh_project(&half, &s, 1);
    assert_int_equal(mesh_simplify(&half, 600, &err), RIS_OK);
    assert_true(half.triangle_count <= 600);
    assert_int_equal(mesh_mirror(&half, &ball, &err), RIS_OK);
    uint32_t open = 1;
    assert_int_equal(tri_open_edges(&ball, &open, &err), RIS_OK);
    assert_int_equal(open, 0);
    assert_true(tri_asymmetry(&ball) == 0);
    assert_true(fabs(tri_volume(&ball) / (4.0 / 3 * 3.14159265358979 * 1000) - 1) < 0.02);
    for (uint32_t i = 0; i < ball.vertex_count; i++)
        assert_true(fabs(dv_length(ball.position[i]) - 10) < 0.15);
    ris__tri_finish(&half);
    ris__tri_finish(&ball);
    solid_finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_queries),
        cmocka_unit_test(test_mesher),
        cmocka_unit_test(test_bounds_hold),
        cmocka_unit_test(test_controls_are_noticed),
        cmocka_unit_test(test_shrunken_skin_is_refused),
        cmocka_unit_test(test_jaw_opens_freely),
        cmocka_unit_test(test_eyes_fit),
        cmocka_unit_test(test_landmarks),
        cmocka_unit_test(test_pairs),
    };
    return cmocka_run_group_tests_name("skull", tests, load, unload);
}
