/* The lining of the mouth in the committed reference head: off bone and teeth, a bag round teeth and tongue, without slivers
 * (KA-48 names the mouth). Controls: the lining moved 4 mm, put inside out, flattened. */
#include "lay_lining.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"

static ris_head head;
static tri_mesh mesh[BODY_COUNT];
static bvh tree[BODY_COUNT];
static lining sheet;

static int load(void **state)
{
    static const char *const path[BODY_COUNT] = {HUMAN "/skull.obj", HUMAN "/mandible.obj",
                                                 HUMAN "/teeth_upper.obj", HUMAN "/teeth_lower.obj",
                                                 HUMAN "/tongue.obj"};
    ris_error err = {0};
    (void)state;
    bool ok = ris_head_load(HUMAN, &head, &err) == RIS_OK;
    for (int k = 0; k < BODY_COUNT && ok; k++)
        ok = ris__tri_load_obj(path[k], &mesh[k], &err) == RIS_OK &&
             ris__bvh_build(&tree[k], &mesh[k], &err) == RIS_OK;
    ok = ok && lining_build(&sheet, &head, tree, &err) == RIS_OK;
    if (!ok)
        print_error("%s\n", err.text);
    return ok ? 0 : -1;
}

static int drop(void **state)
{
    (void)state;
    lining_finish(&sheet);
    for (int k = 0; k < BODY_COUNT; k++) {
        ris__bvh_finish(&tree[k]);
        ris__tri_finish(&mesh[k]);
    }
    ris_head_finish(&head);
    return 0;
}

static void restore(void)
{
    memcpy(sheet.at, sheet.from, sheet.count * sizeof *sheet.at);
}

static void test_rings(void **state)
{
    (void)state;
    uint32_t inside = 0, moving = 0, across = 0;
    for (uint32_t i = 0; i < sheet.count; i++) {
        inside += sheet.ring[i] != LINING_NONE && sheet.ring[i] > 0;
        moving += sheet.moves[i];
        across += sheet.border[i];
        assert_true(!sheet.moves[i] || sheet.ring[i] >= 4); /* the rim that is seen stays */
        assert_int_equal(sheet.outside[i], sheet.outside[sheet.mirror[i]]);
    }
    assert_int_equal(inside, ris_head_region(&head, "mouth_cavity")->count);
    assert_int_equal(moving, inside - ris_head_region(&head, "inner_lip_rim")->count);
    assert_in_range(across, 60, moving / 2); /* two rows along two arches */
}

/* No vertex and, on either side of the teeth, no edge in bone or teeth. */
static void test_off_bone(void **state)
{
    (void)state;
    lining_report r = lining_measure(&sheet);
    print_message("vertices %.2f mm, midpoints %.2f mm off bone and teeth\n", r.vertex_mm, r.midpoint_mm);
    assert_true(r.vertex_mm > 1.8);
    assert_true(r.midpoint_mm > 1.0);
    assert_int_equal(r.buried + r.buried_midpoints, 0);
    for (uint32_t i = 0; i < sheet.count; i++)
        sheet.at[i].y += 4;
    r = lining_measure(&sheet);
    restore();
    assert_true(r.buried > 20 && r.vertex_mm < -1 && r.midpoint_mm < -1);
}

/* Solid angle of the lining, closed by a fan over the opening of the mouth, over the full sphere. */
static double winding(dvec p)
{
    const ris_mesh *m = &head.skin;
    dvec hub = {0};
    uint32_t rim = 0;
    double sum = 0;
    for (uint32_t i = 0; i < sheet.count; i++)
        if (sheet.ring[i] == 1) {
            hub = dv_add(hub, sheet.at[i]);
            rim++;
        }
    hub = dv(hub.x / rim, hub.y / rim, hub.z / rim);
    for (uint32_t f = 0; f < m->face_count; f++) {
        const uint32_t *q = &m->face_vertex[m->face_start[f]];
        const uint32_t corners = m->face_start[f + 1] - m->face_start[f];
        uint32_t in = 0;
        for (uint32_t k = 0; k < corners; k++)
            in += sheet.ring[q[k]] != LINING_NONE && sheet.ring[q[k]] > 0;
        for (uint32_t k = 0; in == corners && k < corners; k++) {
            const uint32_t v = q[k], w = q[(k + 1) % corners];
            dvec corner[2][3] = {{sheet.at[q[0]], sheet.at[v], sheet.at[w]}, {sheet.at[w], sheet.at[v], hub}};
            const bool edge = sheet.ring[v] == 1 && sheet.ring[w] == 1; /* the fan's triangle across it */
            for (int t = k == 0 || k + 1 == corners ? 1 : 0; t < (edge ? 2 : 1); t++) {
                const dvec a = dv_sub(corner[t][0], p), b = dv_sub(corner[t][1], p),
                           c = dv_sub(corner[t][2], p);
                const double la = dv_length(a), lb = dv_length(b), lc = dv_length(c);
                sum += atan2(dv_dot(a, dv_cross(b, c)),
                             la * lb * lc + dv_dot(a, b) * lc + dv_dot(b, c) * la + dv_dot(c, a) * lb);
            }
        }
    }
    return fabs(sum) / 6.283185307179586;
}

static double share_inside(int body, double lift)
{
    uint32_t in = 0, count = 0;
    for (uint32_t i = 0; i < mesh[body].vertex_count; i += 23, count++)
        in += winding(dv_add(mesh[body].position[i], dv(0, lift, 0))) > 0.5;
    return (double)in / count;
}

/* Teeth and tongue lie in the bag; 60 mm higher they do not. */
static void test_bag(void **state)
{
    (void)state;
    print_message("in the bag: %.3f of the upper teeth, %.3f of the lower, %.3f of the tongue\n",
                  share_inside(BODY_UPPER, 0), share_inside(BODY_LOWER, 0), share_inside(BODY_TONGUE, 0));
    assert_true(share_inside(BODY_UPPER, 0) > 0.9);
    assert_true(share_inside(BODY_LOWER, 0) > 0.9);
    assert_true(share_inside(BODY_TONGUE, 0) > 0.95);
    assert_true(share_inside(BODY_TONGUE, 60) == 0);
}

/* Least height of a triangle over its longest edge; both ways of splitting a quad are tried, the better one counts. */
static double thinnest(uint32_t *vertex)
{
    const ris_mesh *m = &head.skin;
    double worst = HUGE_VAL;
    for (uint32_t f = 0; f < m->face_count; f++) {
        const uint32_t *q = &m->face_vertex[m->face_start[f]];
        double best = 0;
        bool moves = false;
        for (uint32_t k = 0; k < 4; k++)
            moves |= sheet.moves[q[k]];
        for (uint32_t s = 0; s < 2; s++) {
            double thin = HUGE_VAL;
            for (uint32_t t = 0; t < 2; t++) {
                const dvec a = sheet.at[q[s]], b = sheet.at[q[s + 1 + t]], c = sheet.at[q[(s + 2 + t) % 4]];
                const double area2 = dv_length(dv_cross(dv_sub(b, a), dv_sub(c, a)));
                const double edge =
                    fmax(dv_length(dv_sub(b, a)), fmax(dv_length(dv_sub(c, b)), dv_length(dv_sub(a, c))));
                thin = fmin(thin, area2 / (edge * edge));
            }
            best = fmax(best, thin);
        }
        if (moves && best < worst) {
            worst = best;
            *vertex = q[0];
        }
    }
    return worst;
}

static void test_no_slivers(void **state)
{
    (void)state;
    ris_error err = {0};
    uint32_t vertex = 0;
    const double worst = thinnest(&vertex);
    print_message("thinnest triangle of the lining: height %.3f of its longest edge, at vertex %u\n", worst,
                  vertex);
    assert_true(worst > 0.04);
    assert_int_equal(ris_mesh_check(&head.skin, "skin.obj", &err), RIS_OK);
    for (uint32_t i = 0; i < sheet.count; i++)
        if (sheet.moves[i])
            sheet.at[i].y = -45;
    const double flat = thinnest(&vertex);
    restore();
    assert_true(flat < worst);
}

/* Bone put where the lining is: laying moves it off again, symmetric to the bit, and moves nothing else. */
static void test_lays(void **state)
{
    (void)state;
    ris_error err = {0};
    for (uint32_t i = 0; i < sheet.count; i++)
        if (sheet.moves[i] && sheet.ring[i] < 9)
            sheet.from[i].y += 3;
    memcpy(sheet.at, sheet.from, sheet.count * sizeof *sheet.at);
    assert_true(lining_measure(&sheet).buried > 10);
    assert_int_equal(lining_lay(&sheet, &err), RIS_OK);
    const lining_report r = lining_measure(&sheet);
    assert_int_equal(r.buried + r.buried_midpoints, 0);
    for (uint32_t i = 0; i < sheet.count; i++) {
        const dvec p = sheet.at[i], q = sheet.at[sheet.mirror[i]];
        assert_true(p.x == -q.x && p.y == q.y && p.z == q.z);
        const ris_vec3 file = head.skin.position[i];
        assert_true(sheet.moves[i] ||
                    (p.x == (double)file.x && p.y == (double)file.y && p.z == (double)file.z));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rings),      cmocka_unit_test(test_off_bone), cmocka_unit_test(test_bag),
        cmocka_unit_test(test_no_slivers), cmocka_unit_test(test_lays), /* last: it changes the lining */
    };
    return cmocka_run_group_tests_name("lining", tests, load, drop);
}
