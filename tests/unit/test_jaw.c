/* The way of the mandible on the reference head (KA-05 and beyond; docs/physics.md, jaw_pose), measured on the meshes by exact
 * queries: bone and teeth never pass into each other over the whole range of the three channels, teeth meet when closed,
 * the condyles keep to the joint. Controls: the plain shift of before, and a jaw without its guidance. */
#include "query/query.h"
#include "sim/rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"
#define JOINT_MM 3.0 /* how far a condyle may be from the bone above it */

enum { SKULL, MANDIBLE, UPPER, LOWER, MESHES };

static ris_head head;
static tri_mesh mesh[MESHES], condyle[2];
static bvh tree[MESHES];

static const ris_mesh *part_mesh(const char *name)
{
    for (uint32_t i = 0; i < head.part_count; i++)
        if (strcmp(head.part[i].name, name) == 0)
            return &head.part[i].mesh;
    return NULL;
}

/* The vertices of the upper 9 mm of the mandible before the ear, left and right. */
static void find_condyles(void)
{
    for (int side = 0; side < 2; side++) {
        condyle[side].position = calloc(mesh[MANDIBLE].vertex_count, sizeof *condyle[side].position);
        for (uint32_t i = 0; i < mesh[MANDIBLE].vertex_count; i++) {
            const dvec p = mesh[MANDIBLE].position[i];
            if (p.y > -12 && p.z < 20 && (side ? -p.x : p.x) > 0)
                condyle[side].position[condyle[side].vertex_count++] = p;
        }
    }
}

static int load(void **state)
{
    (void)state;
    ris_error err = {0};
    bool ok = ris_head_load(HUMAN, &head, &err) == RIS_OK;
    const ris_mesh *const source[MESHES] = {&head.skull, &head.mandible, part_mesh("teeth_upper"),
                                            part_mesh("teeth_lower")};
    for (int k = 0; k < MESHES && ok; k++)
        ok = source[k] && ris__tri_from_mesh(source[k], "a mesh", &mesh[k], &err) == RIS_OK &&
             ris__bvh_build(&tree[k], &mesh[k], &err) == RIS_OK;
    if (ok)
        find_condyles();
    else
        print_error("%s\n", err.text);
    return ok ? 0 : -1;
}

static int unload(void **state)
{
    (void)state;
    for (int k = 0; k < MESHES; k++) {
        ris__bvh_finish(&tree[k]);
        ris__tri_finish(&mesh[k]);
    }
    free(condyle[0].position);
    free(condyle[1].position);
    ris_head_finish(&head);
    return 0;
}

static void place_jaw(float open, float forward, float side, float out[12])
{
    const ris_rigid jaw = ris__jaw_path(&head.jaw, &head.guidance, open, forward, side);
    ris__rigid_matrix(&jaw, out);
}

static dvec placed(float open, float forward, float side, dvec p)
{
    float place[12];
    place_jaw(open, forward, side, place);
    return ris__place(place, p);
}

static const float opens[] = {0, 0.02f, 0.06f, 0.15f, 0.35f, 0.6f, 0.8f, 1};

/* 8 x 21 x 17 poses: no edge of a tooth passes into the other arch. */
static void teeth_never_cross(void **state)
{
    (void)state;
    uint32_t count = 0, poses = 0;
    for (size_t o = 0; o < sizeof opens / sizeof *opens; o++)
        for (int f = -4; f <= 16; f++)
            for (int s = -16; s <= 16; s += 2) {
                float place[12];
                place_jaw(opens[o], f < 0 ? (float)f / 4 : (float)f / 16, (float)s / 16, place);
                const uint32_t crossings = ris__bvh_crossings(&tree[LOWER], place, &tree[UPPER], UINT32_MAX);
                if (crossings)
                    print_error("open %.2f forward %d side %d: %u edges\n", (double)opens[o], f, s,
                                crossings);
                count += crossings;
                poses++;
            }
    print_message("%u poses, %u edges of teeth in teeth\n", poses, count);
    assert_int_equal(count, 0);
}

/* The same poses, coarser, for bone; and the condyles stay in the joint. */
static void bones_never_cross(void **state)
{
    (void)state;
    uint32_t count = 0, poses = 0;
    double nearest = HUGE_VAL, farthest = 0;
    for (size_t o = 0; o < sizeof opens / sizeof *opens; o++)
        for (int f = -2; f <= 8; f++)
            for (int s = -4; s <= 4; s++) {
                float place[12];
                place_jaw(opens[o], f < 0 ? (float)f / 2 : (float)f / 8, (float)s / 4, place);
                const uint32_t crossings =
                    ris__bvh_crossings(&tree[MANDIBLE], place, &tree[SKULL], UINT32_MAX);
                if (crossings)
                    print_error("open %.2f forward %d side %d: %u edges\n", (double)opens[o], f, s,
                                crossings);
                count += crossings;
                poses++;
                for (int side = 0; side < 2; side++) {
                    double gap = HUGE_VAL;
                    for (uint32_t i = 0; i < condyle[side].vertex_count; i++) {
                        const dvec p = ris__place(place, condyle[side].position[i]);
                        gap = fmin(gap, ris__bvh_closest(&tree[SKULL], p).distance);
                    }
                    nearest = fmin(nearest, gap);
                    farthest = fmax(farthest, gap);
                }
            }
    print_message("%u poses, %u edges of bone in bone; condyle to skull %.2f .. %.2f mm\n", poses, count,
                  nearest, farthest);
    assert_int_equal(count, 0);
    assert_true(nearest > 0.2 && farthest < JOINT_MM);
}

/* Closed, the arches meet; on the way forward and to the side with closed teeth they stay together. */
static void teeth_meet(void **state)
{
    (void)state;
    float place[12];
    place_jaw(0, 0, 0, place);
    const double rest = ris__bvh_gap(&tree[LOWER], place, &tree[UPPER]);
    double most = 0;
    for (int f = -2; f <= 8; f++)
        for (int s = 0; s <= 8; s++) {
            place_jaw(0, f < 0 ? (float)f / 2 : (float)f / 8, (float)s / 8, place);
            most = fmax(most, ris__bvh_gap(&tree[LOWER], place, &tree[UPPER]));
        }
    place_jaw(0.1f, 0, 0, place);
    const double open = ris__bvh_gap(&tree[LOWER], place, &tree[UPPER]);
    print_message("teeth apart %.3f mm at rest, at most %.3f mm when closed, %.2f mm open by 0.1\n", rest,
                  most, open);
    assert_true(rest > 0 && rest < 0.3);
    assert_true(most < 1.5);
    assert_true(open > 0.5);
}

/* Controls: without guidance teeth cross on the way; the plain shifts of before drive bone into bone; an open jaw is no
 * crossing, and the joint is left when the whole jaw drops. */
static void controls_are_noticed(void **state)
{
    (void)state;
    const ris_guidance none = {0};
    float place[12];
    ris_rigid jaw = ris__jaw_path(&head.jaw, &none, 0, 0, 0.25f);
    ris__rigid_matrix(&jaw, place);
    assert_true(ris__bvh_crossings(&tree[LOWER], place, &tree[UPPER], UINT32_MAX) > 0);
    const float shifts[3][3] = {{6, 0, 0}, {0, 0, 8}, {0, 0, -3}};
    for (int k = 0; k < 3; k++) {
        const float shifted[12] = {1, 0, 0, shifts[k][0], 0, 1, 0, shifts[k][1], 0, 0, 1, shifts[k][2]};
        assert_true(ris__bvh_crossings(&tree[MANDIBLE], shifted, &tree[SKULL], UINT32_MAX) > 0);
    }
    const float dropped[12] = {1, 0, 0, 0, 0, 1, 0, -8, 0, 0, 1, 0};
    double gap = HUGE_VAL;
    for (uint32_t i = 0; i < condyle[0].vertex_count; i++)
        gap = fmin(gap, ris__bvh_closest(&tree[SKULL], ris__place(dropped, condyle[0].position[i])).distance);
    assert_true(gap > JOINT_MM);
}

/* A mirrored pose gives the mirrored bits; the neutral pose the identity. */
static void paths_mirror(void **state)
{
    (void)state;
    static const float mirror[12] = {1, -1, -1, -1, -1, 1, 1, 1, -1, 1, 1, 1};
    for (int k = 0; k < 200; k++) {
        const float open = (float)(k % 7) / 6, forward = (float)(k % 9) / 4 - 1, side = (float)(k % 11) / 10;
        float a[12], b[12];
        place_jaw(open, forward, side, a);
        place_jaw(open, forward, -side, b);
        for (int i = 0; i < 12; i++)
            assert_true(a[i] == mirror[i] * b[i]);
    }
    float a[12];
    place_jaw(0, 0, 0, a);
    for (int i = 0; i < 12; i++)
        assert_true(a[i] == (i % 5 == 0 ? 1.0f : 0.0f));
    assert_true(ris__jaw_path(&head.jaw, &head.guidance, 0, 0, 0).identity);
}

/* What the joint does, told by its middle points: the condyles, and the edge of the lower incisors. */
static void joint_is_anatomical(void **state)
{
    (void)state;
    const dvec left = dv(49, -7, 11), right = dv(-49, -7, 11), incisor = dv(0, -50.6, 86.5);
    dvec c = placed(0.3f, 0, 0, left); /* the first part of opening turns about still condyles */
    assert_true(dv_length(dv_sub(c, left)) < 1e-4);
    c = dv_sub(placed(1, 0, 0, left), left); /* then they slide down and forward */
    assert_true(c.z > 6 && c.z < 10 && c.y < -5 && fabs(c.x) < 1e-4);
    dvec i = dv_sub(placed(1, 0, 0, incisor), incisor);
    print_message("open: incisors %.1f mm down, condyles %.1f forward, %.1f down\n", -i.y, c.z, -c.y);
    assert_true(i.y < -28 && i.y > -45);
    c = dv_sub(placed(0, 1, 0, right), right); /* protrusion */
    assert_true(fabs(c.z - 8) < 1e-4 && c.y < -5);
    c = dv_sub(placed(0, -1, 0, right), right);
    assert_true(fabs(c.z + 1) < 1e-4);
    i = dv_sub(placed(0, 0.375f, 0, incisor),
               incisor); /* incisal guidance: down, before the edges have passed */
    print_message("3 mm forward: incisors %.2f mm down\n", -i.y);
    assert_true(i.y < -1 && i.y > -5 && fabs(i.z - 3) < 1);
    i = dv_sub(placed(0, 0, 1, incisor), incisor); /* to the subject's left */
    const dvec work = dv_sub(placed(0, 0, 1, left), left), balance = dv_sub(placed(0, 0, 1, right), right);
    print_message("left: incisors %.2f mm, working condyle %.2f, balancing %.2f forward, %.2f down\n", i.x,
                  dv_length(work), balance.z, -balance.y);
    assert_true(fabs(i.x - 6) < 0.8);
    assert_true(dv_length(work) < 1.5 && work.x > 0.4);              /* Bennett movement */
    assert_true(balance.z > 3.5 && balance.y < -3 && balance.x > 0); /* forward, down and inwards */
    i = dv_sub(placed(1, 1, 1, incisor), incisor); /* all at once: the joint does not go past its crest */
    c = dv_sub(placed(1, 1, 1, right), right);
    assert_true(c.z < 10.1 && i.x > 4);
}

/* The kaehler tissue turns about the fixed axis, to the letter: no path, no guidance. */
static void literal_jaw_only_turns(void **state)
{
    (void)state;
    ris_vec3 none[1] = {{0}};
    ris_model model = {.head = &head, .push = {.flags = RIS_TISSUE_FLAG_KAEHLER}, .fiber_point = none};
    float pose[32] = {0};
    ris_rig rig = {.model = &model, .p = none};
    pose[RIS__JAW_OPEN] = 1;
    ris__jaw_pose(&rig, pose);
    const ris_rigid turn =
        ris__rigid_turn(head.jaw.point, head.jaw.axis, 20.0 * 3.14159265358979323846 / 180.0);
    assert_memory_equal(rig.jaw.rotation, turn.rotation, sizeof turn.rotation);
    assert_true(rig.jaw.shift.x == 0 && rig.jaw.shift.y == 0 && rig.jaw.shift.z == 0);
    model.push.flags = 0;
    ris__jaw_pose(&rig, pose);
    assert_true(rig.jaw.shift.y < -5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(teeth_never_cross),
        cmocka_unit_test(bones_never_cross),
        cmocka_unit_test(teeth_meet),
        cmocka_unit_test(controls_are_noticed),
        cmocka_unit_test(paths_mirror),
        cmocka_unit_test(joint_is_anatomical),
        cmocka_unit_test(literal_jaw_only_turns),
    };
    return cmocka_run_group_tests_name("jaw", tests, load, unload);
}
