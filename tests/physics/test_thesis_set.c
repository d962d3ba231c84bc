/* The muscles of the thesis's table 7.1 on the reference head, in the kaehler tissue: KA-45 who merges with whom (KA-28), the
 * size of the network (KA-29), figure 7.19, KA-34, and the order of the stages (KA-30). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "model/model_impl.h"
#include "model/vec3.h"
#include "sim/rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ris_error err;
static ris_head head;
static uint32_t all_muscles;
static ris_model *model;
static ris_rig rig;
static float *pose;

/* Table 7.1 by our names; mylohyoideus has none, mentalis is a pair here. */
static const char *const set[] = {"corrugator_supercilii",
                                  "zygomaticus_major",
                                  "risorius",
                                  "orbicularis_oris_inferior",
                                  "orbicularis_oris_superior",
                                  "mentalis",
                                  "depressor_anguli_oris",
                                  "levator_labii_superioris",
                                  "depressor_labii_inferioris",
                                  "frontalis_inner",
                                  "frontalis_outer",
                                  "orbicularis_oculi_orbital",
                                  "orbicularis_oculi_palpebral"};

static bool is_named(const char *name, const char *stem)
{
    const size_t length = strlen(stem);
    return strncmp(name, stem, length) == 0 && (name[length] == '\0' || name[length] == '.');
}

static int open_set(void **state)
{
    (void)state;
    if (ris_head_load(RIS_SOURCE_DIR "/assets/human", &head, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    all_muscles = head.muscle_count;
    head.muscle_count = 0;
    for (uint32_t m = 0; m < all_muscles; ++m) { /* those of the set first, in the file's order */
        bool wanted = false;
        for (size_t k = 0; k < sizeof set / sizeof *set; ++k) {
            wanted = wanted || is_named(head.muscle[m].name, set[k]);
        }
        if (wanted) {
            const ris_muscle_def def = head.muscle[m];
            head.muscle[m] = head.muscle[head.muscle_count];
            head.muscle[head.muscle_count++] = def;
        }
    }
    head.tissue.model = RIS_TISSUE_KAEHLER;
    if (ris_model_create(&head, &model, &err) != RIS_OK || ris__rig_init(&rig, model, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    pose = calloc(model->channel_count, sizeof *pose);
    return pose ? 0 : -1;
}

static int close_set(void **state)
{
    (void)state;
    free(pose);
    ris__rig_finish(&rig);
    ris_model_destroy(model);
    head.muscle_count = all_muscles;
    ris_head_finish(&head);
    return 0;
}

static uint32_t muscle(const char *name)
{
    const uint32_t m = ris_model_channel(model, name);
    assert_true(m < model->muscle_count);
    return m;
}

static void pose_muscles(const char *first, const char *second)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
    pose[muscle(first)] = 1.0f;
    pose[muscle(second)] = 1.0f;
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    ris__muscle_relax(&rig);
    ris__muscle_bulge(&rig);
    ris__muscle_attach(&rig);
}

static bool merged(const char *a, const char *b)
{
    for (uint32_t g = 0; g < model->group_count; ++g) {
        bool has[2] = {false, false};
        for (uint32_t k = 0; k < model->group[g].point_count; ++k) {
            const uint32_t m = model->group_point[model->group[g].first_point + k].muscle;
            has[0] = has[0] || m == muscle(a);
            has[1] = has[1] || m == muscle(b);
        }
        if (has[0] && has[1]) {
            return true;
        }
    }
    return false;
}

/* The 19 connected pairs of the table: nine on each side, and the two lips. */
static void the_connections_of_the_table(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"corrugator_supercilii.L", "frontalis_inner.L"},
        {"corrugator_supercilii.L", "orbicularis_oculi_orbital.L"},
        {"frontalis_inner.L", "orbicularis_oculi_orbital.L"},
        {"frontalis_outer.L", "orbicularis_oculi_orbital.L"},
        {"zygomaticus_major.L", "orbicularis_oris_superior"},
        {"risorius.L", "orbicularis_oris_superior"},
        {"levator_labii_superioris.L", "orbicularis_oris_superior"},
        {"depressor_anguli_oris.L", "orbicularis_oris_inferior"},
        {"depressor_labii_inferioris.L", "orbicularis_oris_inferior"},
    };
    uint32_t count = 0;
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; ++k) {
        char other[2][RIS_NAME_SIZE];
        for (int i = 0; i < 2; ++i) {
            snprintf(other[i], sizeof other[i], "%s", pairs[k][i]);
            char *end = other[i] + strlen(other[i]) - 1;
            *end = *end == 'L' ? 'R' : *end;
        }
        if (!merged(pairs[k][0], pairs[k][1]) || !merged(other[0], other[1])) {
            fail_msg("%s and %s do not merge", pairs[k][0], pairs[k][1]);
        }
        count += 2;
    }
    assert_true(merged("orbicularis_oris_superior", "orbicularis_oris_inferior"));
    assert_int_equal(count + 1, 19);
    assert_false(merged("zygomaticus_major.L", "zygomaticus_major.R")); /* control */
    assert_false(merged("frontalis_inner.L", "orbicularis_oris_superior"));
    assert_int_equal(model->muscle_count, 24); /* the thesis has 24 with one mentalis and the mylohyoideus */
}

/* 70 nodes and 143 springs in the thesis. */
static void the_network_has_its_size(void **state)
{
    (void)state;
    assert_int_equal(model->network_node_count, 78);
    assert_int_equal(model->network_spring_count, 220);
}

static ris_vec3 moved(uint32_t m, uint32_t point)
{
    return v3_sub(ris__muscle_point(model, &model->muscle[m], rig.q, point),
                  ris__muscle_point(model, &model->muscle[m], rig.p, point));
}

/* Chord over length of a muscle's middle line. */
static float straightness(uint32_t m, const ris_vec3 *points)
{
    const uint32_t n = model->muscle[m].point_count;
    float length = 0.0f;
    for (uint32_t i = 1; i < n; ++i) {
        length += v3_distance(ris__muscle_point(model, &model->muscle[m], points, i),
                              ris__muscle_point(model, &model->muscle[m], points, i - 1));
    }
    return v3_distance(ris__muscle_point(model, &model->muscle[m], points, 0),
                       ris__muscle_point(model, &model->muscle[m], points, n - 1)) /
           length;
}

/* Figure 7.19: zygomaticus major alone lifts the upper half of orbicularis oris and straightens the depressor anguli oris. */
static void a_smile_lifts_the_lip_and_straightens_the_depressor(void **state)
{
    (void)state;
    pose_muscles("zygomaticus_major.L", "zygomaticus_major.R");
    const uint32_t lip = muscle("orbicularis_oris_superior"), n = model->muscle[lip].point_count;
    float lifted = 0.0f;
    for (uint32_t i = 0; i < n; ++i) {
        lifted += moved(lip, i).y / (float)n;
        assert_true(moved(lip, i).y > -0.1f);
    }
    assert_true(lifted > 2.0f && moved(lip, 0).y > 4.0f && moved(lip, n - 1).y > 4.0f);
    static const char *const depressor[] = {"depressor_anguli_oris.L", "depressor_anguli_oris.R"};
    for (int k = 0; k < 2; ++k) {
        const uint32_t m = muscle(depressor[k]);
        assert_true(straightness(m, rig.q) > straightness(m, rig.p) + 0.015f);
        assert_true(moved(m, model->muscle[m].point_count - 1).y > 2.0f); /* it lengthens */
    }
    pose_muscles("frontalis_inner.L", "frontalis_inner.R"); /* control: the brow does neither */
    assert_true(fabsf(moved(lip, 0).y) < 0.01f);
    assert_true(fabsf(straightness(muscle(depressor[0]), rig.q) - straightness(muscle(depressor[0]), rig.p)) <
                1e-4f);
}

/* KA-34: what pulls at the left corner reaches the right one along the lips, weaker; without the network it does not. */
static void a_pull_reaches_the_far_corner(void **state)
{
    (void)state;
    const uint32_t lip = muscle("orbicularis_oris_superior"), n = model->muscle[lip].point_count;
    pose_muscles("zygomaticus_major.L", "risorius.L");
    const float near = v3_length(moved(lip, n - 1)), far = v3_length(moved(lip, 0));
    assert_true(near > 3.0f && far > 0.002f && far < 0.5f * near);
    const uint32_t springs = model->network_spring_count, nodes = model->network_node_count;
    model->network_node_count = 0;
    model->network_spring_count = 0;
    pose_muscles("zygomaticus_major.L", "risorius.L");
    assert_true(v3_length(moved(lip, 0)) < 1e-4f);
    model->network_node_count = nodes;
    model->network_spring_count = springs;
}

/* KA-30: bulging before straightening gives another smile, so the order is seen to be kept. */
static void the_order_of_relaxing_and_bulging_matters(void **state)
{
    (void)state;
    pose_muscles("zygomaticus_major.L", "zygomaticus_major.R");
    ris_anchor_point *right = malloc(model->node_count * sizeof *right);
    memcpy(right, rig.point, model->node_count * sizeof *right);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    ris__muscle_bulge(&rig);
    ris__muscle_relax(&rig);
    ris__muscle_attach(&rig);
    float most = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        most = f_max(most, v3_distance(v4_xyz(right[i].a), v4_xyz(rig.point[i].a)));
    }
    assert_true(most > 0.01f);
    pose_muscles("zygomaticus_major.L",
                 "zygomaticus_major.R"); /* control: in order it is the same to the bit */
    assert_memory_equal(right, rig.point, model->node_count * sizeof *right);
    free(right);
}

static void smiles_are_mirror_images(void **state)
{
    (void)state;
    const uint32_t lip = muscle("orbicularis_oris_superior"), n = model->muscle[lip].point_count;
    pose_muscles("zygomaticus_major.L", "depressor_anguli_oris.L");
    ris_vec3 left[64];
    assert_true(n <= 64);
    for (uint32_t i = 0; i < n; ++i) {
        left[i] = moved(lip, i);
    }
    pose_muscles("zygomaticus_major.R", "depressor_anguli_oris.R");
    float lopsided = 0.0f;
    for (uint32_t i = 0; i < n; ++i) {
        const ris_vec3 d = moved(lip, n - 1 - i);
        assert_true(v3_distance(left[i], v3(-d.x, d.y, d.z)) < 1e-3f);
        lopsided = f_max(lopsided, v3_distance(left[i], moved(lip, i)));
    }
    assert_true(lopsided > 1.0f); /* control */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_connections_of_the_table),
        cmocka_unit_test(the_network_has_its_size),
        cmocka_unit_test(a_smile_lifts_the_lip_and_straightens_the_depressor),
        cmocka_unit_test(a_pull_reaches_the_far_corner),
        cmocka_unit_test(the_order_of_relaxing_and_bulging_matters),
        cmocka_unit_test(smiles_are_mirror_images),
    };
    return cmocka_run_group_tests(tests, open_set, close_set);
}
