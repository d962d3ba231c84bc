/* KA-47: at a smile the fat of the cheek rises over zygomaticus major: the cheek is higher than without fat,
 * roundest beside the nose's wing and not at the edge of the pad, only while the muscle is short; and the
 * buccinator (AU14) presses the cheek to the teeth. */
#include "loaded_head.h"
#include "risorius/timeline.h"

#include <math.h>

static void hold(const char *text)
{
    need(ris_pose_parse(model, text, pose, &err));
    settle();
}

static uint32_t nearest_outside(ris_vec3 place)
{
    uint32_t nearest = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec3 n = v4_xyz(model->rest_normal[i]);
        if (n.z > 0.0f && v3_distance(v4_xyz(model->rest_position[i]), place) <
                              v3_distance(v4_xyz(model->rest_position[nearest]), place)) {
            nearest = i;
        }
    }
    return nearest;
}

/* How far a node is out of the face, along its normal at rest, mm. */
static float height(const ris_vec4 *p, uint32_t i)
{
    return v3_dot(v3_sub(v4_xyz(p[i]), v4_xyz(model->rest_position[i])), v4_xyz(model->rest_normal[i]));
}

/* Positions of the same head without its fat in the pose that is set; caller frees. */
static ris_vec4 *without_fat(void)
{
    ris_head head;
    ris_model *lean = NULL;
    ris_sim *other = NULL;
    ris_vec4 *out = malloc(model->node_count * sizeof *out);
    need(ris_head_load(RIS_SOURCE_DIR "/assets/human", &head, &err));
    for (uint32_t m = 0; m < head.muscle_count; ++m) {
        head.muscle[m].fat = 0.0f;
    }
    need(ris_model_create(&head, &lean, &err));
    assert_int_equal(lean->fat_count, 0);
    need(ris_sim_create_cpu(lean, &other, &err));
    need(ris_sim_settle(other, pose, NULL, &err));
    need(ris_sim_read(other, RIS_STATE_POSITION, out, &err));
    ris_sim_destroy(other);
    ris_model_destroy(lean);
    ris_head_finish(&head);
    return out;
}

static void a_smile_raises_the_cheek(void **state)
{
    (void)state;
    const uint32_t apple = nearest_outside(v3(38, -18, 85)), nose = nearest_outside(v3(17, -20, 94)),
                   temple = nearest_outside(v3(58, 5, 62));
    assert_true(model->fat_count > 40);
    hold("zygomaticus_major=1");
    ris_vec4 *lean = without_fat();
    const float fat = height(x, apple), thin = height(lean, apple);
    print_message("height of the cheek: %.2f mm, without fat %.2f\n", (double)fat, (double)thin);
    float strayed = 0.0f;
    assert_true(fat > thin + 1.5f);
    assert_true(fabsf(height(x, nose) - height(lean, nose)) < 0.3f); /* the pad ends before the nose, */
    assert_true(fabsf(height(x, temple) - height(lean, temple)) < 0.3f);
    for (uint32_t i = 0; i < model->node_count; ++i) { /* and leaves the middle of the face alone */
        if (fabsf(model->rest_position[i].x) < 8.0f) {
            strayed = f_max(strayed, v3_distance(v4_xyz(x[i]), v4_xyz(lean[i])));
        }
        if (mirror[i] != UINT32_MAX) {
            const ris_vec4 other = x[mirror[i]];
            assert_true(v3_distance(v4_xyz(x[i]), v3(-other.x, other.y, other.z)) < 0.01f);
        }
    }
    free(lean);
    print_message("moved by it within 8 mm of the midline: %.2f mm\n", (double)strayed);
    assert_true(strayed < 0.5f * (fat - thin));
    hold("zygomaticus_major=0.5");
    assert_true(height(x, apple) < 0.7f * fat && height(x, apple) > 0.3f * fat);
    hold("frontalis_inner=1"); /* control: no smile, no apple */
    assert_true(fabsf(height(x, apple)) < 0.05f);
}

/* What rises is what the shortening squeezes: a corner that is held down leaves the muscle long. */
static void a_held_corner_holds_the_fat(void **state)
{
    (void)state;
    const uint32_t apple = nearest_outside(v3(38, -18, 85));
    hold("zygomaticus_major=1");
    const float free_smile = height(x, apple);
    hold("zygomaticus_major=1,depressor_anguli_oris=1");
    print_message("height of the cheek: %.2f mm, with the corner held down %.2f\n", (double)free_smile,
                  (double)height(x, apple));
    assert_true(height(x, apple) < 0.8f * free_smile);
    hold("depressor_anguli_oris=1"); /* stretched: nothing rises */
    assert_true(fabsf(height(x, apple)) < 0.2f);
}

static void the_buccinator_presses_the_cheek(void **state)
{
    (void)state;
    const uint32_t cheek = nearest_outside(v3(38, -48, 80));
    hold("buccinator=1");
    print_message("buccinator: cheek %.2f mm in\n", (double)-height(x, cheek));
    assert_true(height(x, cheek) < -0.8f);
    hold("zygomaticus_minor=1");
    assert_true(height(x, cheek) > -0.5f);
}

/* cheek.puff: air bulges the cheek, of one side if asked, and leaves nose and eyes alone; suction hollows it by less. */
static void air_puffs_the_cheek(void **state)
{
    (void)state;
    const uint32_t left = nearest_outside(v3(42, -42, 64)), right = nearest_outside(v3(-42, -42, 64));
    const uint32_t nose = nearest_outside(v3(0, -20, 110)), lid = nearest_outside(v3(30, 12, 85));
    hold("cheek.puff=1");
    const float puffed = height(x, left);
    print_message("cheek.puff: %.2f mm out\n", (double)puffed);
    assert_true(puffed > 6.0f && puffed < 14.0f);
    assert_true(fabsf(height(x, right) - puffed) < 0.05f);
    assert_true(fabsf(height(x, nose)) < 0.3f && fabsf(height(x, lid)) < 0.5f);
    hold("cheek.puff=0.5");
    assert_true(height(x, left) > 0.35f * puffed && height(x, left) < 0.65f * puffed);
    hold("cheek.puff.L=1");
    assert_true(height(x, left) > 0.9f * puffed && fabsf(height(x, right)) < 0.3f);
    hold("cheek.puff=-1");
    print_message("cheek.puff -1: %.2f mm in\n", (double)-height(x, left));
    assert_true(height(x, left) < -2.0f && height(x, left) > -0.8f * puffed);
    hold("cheek.puff=7"); /* clamped */
    assert_true(fabsf(height(x, left) - puffed) < 0.05f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_smile_raises_the_cheek),
        cmocka_unit_test(a_held_corner_holds_the_fat),
        cmocka_unit_test(the_buccinator_presses_the_cheek),
        cmocka_unit_test(air_puffs_the_cheek),
    };
    return cmocka_run_group_tests(tests, open_loaded_head, close_loaded_head);
}
