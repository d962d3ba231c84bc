/* Muscles that share a node (decision 17), and two that act beyond the skin over them: mentalis pushes the lower lip,
 * platysma straightens over the hollow of the neck. On the reference head, settled. */
#include "loaded_head.h"
#include "risorius/timeline.h"

#include <math.h>

static int open_head(void **state)
{
    (void)state;
    return load_head();
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    return 0;
}

/* How the pose moves the node that rests nearest to a place. */
static ris_vec3 moves(const char *text, ris_vec3 place)
{
    uint32_t nearest = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (v3_distance(v4_xyz(model->rest_position[i]), place) <
            v3_distance(v4_xyz(model->rest_position[nearest]), place)) {
            nearest = i;
        }
    }
    need(ris_pose_parse(model, text, pose, &err));
    settle();
    return v3_sub(v4_xyz(x[nearest]), v4_xyz(model->rest_position[nearest]));
}

/* Down by the depressor, forward by the ring: the lip does both. With every acting muscle counted in full, as the
 * prototype did, each gets about half. */
static void pulls_across_one_another_add(void **state)
{
    (void)state;
    const ris_vec3 lip = {0, -57, 101};
    const ris_vec3 down = moves("depressor_labii_inferioris=1", lip),
                   out = moves("orbicularis_oris_inferior.protrude=1", lip),
                   both = moves("depressor_labii_inferioris=1,orbicularis_oris_inferior.protrude=1", lip);
    print_message("lower lip: down %.2f (out %.2f), out %.2f, both %.2f and %.2f mm\n", (double)down.y,
                  (double)down.z, (double)out.z, (double)both.y, (double)both.z);
    assert_true(down.y < -3 && out.z > 3);
    assert_true(both.y < 0.75f * down.y && both.z > down.z + 0.4f * out.z);
}

/* Two levators raise the lip between them no farther than fibres that pull as one would. */
static void pulls_alike_share(void **state)
{
    (void)state;
    const ris_vec3 lip = {19, -38, 95};
    const float one = moves("levator_labii_superioris=1", lip).y, other = moves("zygomaticus_minor=1", lip).y,
                both = moves("levator_labii_superioris=1,zygomaticus_minor=1", lip).y;
    print_message("upper lip: one levator %.2f, the other %.2f, both %.2f mm\n", (double)one, (double)other,
                  (double)both);
    assert_true(one > 1.5f && other > 1.5f);
    assert_true(both >= f_max(one, other) - 0.5f && both < 0.8f * (one + other));
}

/* A press at a twentieth is nothing beside a smile. */
static void a_weak_pull_leaves_the_node_to_the_strong(void **state)
{
    (void)state;
    const ris_vec3 place = {25, -43, 91};
    const ris_vec3 smile = moves("zygomaticus_major=1", place),
                   pressed = moves("zygomaticus_major=1,orbicularis_oris_superior=0.05", place);
    print_message("beside the corner: smile %.2f, with a weak ring %.2f mm\n", (double)smile.y,
                  (double)pressed.y);
    assert_true(smile.y > 2);
    assert_true(fabsf(pressed.y - smile.y) < 0.2f * smile.y);
}

/* AU17: the lip goes up and out with the chin, most in its middle; one side pushes its half. */
static void mentalis_pushes_the_lip(void **state)
{
    (void)state;
    const ris_vec3 middle = moves("mentalis=1", (ris_vec3){0, -57, 101}),
                   corner = moves("mentalis=1", (ris_vec3){27, -50, 86}),
                   left = moves("mentalis.L=1", (ris_vec3){12, -55, 97}),
                   right = moves("mentalis.L=1", (ris_vec3){-12, -55, 97});
    print_message("mentalis: middle up %.2f out %.2f, corner %.2f, one side %.2f %.2f mm\n", (double)middle.y,
                  (double)middle.z, (double)v3_length(corner), (double)left.z, (double)right.z);
    assert_true(middle.y > 1.0f && middle.z > 1.0f);
    assert_true(v3_length(corner) < 0.5f);
    assert_true(left.z > 2 * right.z);
}

/* AU17: the upper lip, which lies on the lower one, goes up with it, until the jaw has taken the lower one away (decision 24). */
static void a_pushed_lip_lifts_the_other(void **state)
{
    (void)state;
    const ris_vec3 place = {0, -48.3f, 102.2f};
    const ris_vec3 shut = moves("mentalis=1", place), open = moves("jaw.open=0.3", place),
                   raised = moves("jaw.open=0.3,mentalis=1", place);
    print_message("upper lip: %.2f mm up with the chin, %.2f mm forward; %.2f mm over an open jaw\n",
                  (double)shut.y, (double)shut.z, (double)(raised.y - open.y));
    assert_true(shut.y > 1.8f && shut.z < 0.5f * shut.y);
    assert_true(fabsf(raised.y - open.y) < 0.25f * shut.y);
}

/* AU21: the hollow under the jaw comes forward, the jaw's border hardly moves. */
static void platysma_stands_out_in_the_neck(void **state)
{
    (void)state;
    const ris_vec3 neck = moves("platysma=1", (ris_vec3){22, -91, 20}),
                   jaw = moves("platysma=1", (ris_vec3){30, -78, 74});
    print_message("platysma: neck %.2f %.2f %.2f, jaw %.2f mm\n", (double)neck.x, (double)neck.y,
                  (double)neck.z, (double)v3_length(jaw));
    assert_true(neck.z > 2 && neck.x > 0.5f);
    assert_true(v3_length(jaw) < 0.5f * v3_length(neck));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulls_across_one_another_add),
        cmocka_unit_test(pulls_alike_share),
        cmocka_unit_test(a_weak_pull_leaves_the_node_to_the_strong),
        cmocka_unit_test(mentalis_pushes_the_lip),
        cmocka_unit_test(a_pushed_lip_lifts_the_other),
        cmocka_unit_test(platysma_stands_out_in_the_neck),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
