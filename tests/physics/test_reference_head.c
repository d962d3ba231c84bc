/* The reference head: what must hold of its motion whatever the calibration. Rest, settling, mirror
 * symmetry, who moves what, no torn or folded skin, and grids that matter. */
#include "loaded_head.h"

static int open_head(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    return 0;
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    return 0;
}

/* Holds channels until rest; an unsided name sets both sides. Returns the time. */
static double hold(const char *first, const char *second)
{
    const char *const names[] = {first, second};
    memset(pose, 0, model->channel_count * sizeof *pose);
    for (int k = 0; k < 2; ++k) {
        uint32_t set = 0;
        for (uint32_t c = 0; names[k] && c < model->channel_count; ++c) {
            const size_t length = strlen(names[k]);
            const char *name = model->channel[c].name;
            if (strncmp(name, names[k], length) == 0 &&
                (name[length] == '\0' || (name[length] == '.' && name[length + 2] == '\0'))) {
                pose[c] = 1.0f;
                ++set;
            }
        }
        assert_true(!names[k] || set > 0);
    }
    return settle();
}

static ris_vec3 moved(uint32_t i)
{
    return v3_sub(v4_xyz(x[i]), v4_xyz(model->rest_position[i]));
}

/* Largest displacement within a region. */
static float region_motion(const char *name)
{
    const ris_region *region = ris_head_region(model->head, name);
    float largest = 0.0f;
    assert_non_null(region);
    for (uint32_t k = 0; k < region->count; ++k) {
        largest = f_max(largest, v3_length(moved(region->vertex[k])));
    }
    return largest;
}

/* No spike, no tear, no fold: edges within 4 x rest, few triangles turned over. */
static void assert_whole(void)
{
    uint32_t turned = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            const ris_half_spring *half = &model->half_spring[h];
            assert_true(v3_distance(v4_xyz(x[i]), v4_xyz(x[half->other])) < 4.0f * half->rest_mm);
        }
    }
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        turned += v3_dot(triangle_cross(x, v), triangle_cross(model->rest_position, v)) < 0.0f;
    }
    assert_true(turned < 40);
}

static void assert_symmetric(void)
{
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (mirror[i] != UINT32_MAX) {
            const ris_vec4 other = x[mirror[i]];
            assert_true(v3_distance(v4_xyz(x[i]), v3(-other.x, other.y, other.z)) < 0.01f);
            ++pairs;
        }
    }
    assert_true(pairs > 4000);
}

static void the_head_is_big_enough_and_rests(void **state)
{
    (void)state;
    assert_true(model->moving_count >= 2000);
    assert_true(model->stable_dt_s > model->push.dt_s);
    for (uint32_t i = 0; i < model->node_count; ++i) { /* every simulated node is held */
        assert_true(!(model->rest_position[i].w > 0.0f) ||
                    (model->anchor_param[i].normal > 0.0f && model->anchor_param[i].tangential > 0.0f));
    }
    memset(pose, 0, model->channel_count * sizeof *pose);
    for (int i = 0; i < 60; ++i) {
        need(ris_sim_tick(sim, pose, &err));
    }
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    assert_memory_equal(x, model->rest_position, model->node_count * sizeof *x);
}

static void a_smile_lifts_both_corners(void **state)
{
    (void)state;
    assert_true(hold("zygomaticus_major", NULL) < 5.0);
    assert_whole();
    assert_symmetric();
    const ris_region *lips = ris_head_region(model->head, "lip_upper");
    assert_non_null(lips);
    float left = 0.0f, right = 0.0f, middle = 0.0f;
    for (uint32_t k = 0; k < lips->count; ++k) {
        const uint32_t i = lips->vertex[k];
        const ris_vec3 d = moved(i);
        const float side = model->rest_position[i].x;
        left = side > 15.0f ? f_max(left, f_min(d.x, d.y)) : left;
        right = side < -15.0f ? f_max(right, f_min(-d.x, d.y)) : right;
        middle = fabsf(side) < 3.0f ? f_max(middle, v3_length(d)) : middle;
    }
    assert_true(left > 2.0f && right > 2.0f);
    assert_true(middle < 0.5f * left);
    assert_true(region_motion("cheek") > 2.0f);
}

static void brows_move_alone(void **state)
{
    (void)state;
    static const struct {
        const char *muscle;
        float direction;
    } cases[] = {{"frontalis_inner", 1.0f}, {"depressor_supercilii", -1.0f}};
    for (size_t k = 0; k < 2; ++k) {
        assert_true(hold(cases[k].muscle, NULL) < 5.0);
        assert_whole();
        assert_symmetric();
        float most = 0.0f, chin = 0.0f;
        for (uint32_t i = 0; i < model->node_count; ++i) {
            most = f_max(most, cases[k].direction * moved(i).y);
            chin = model->jaw_weight[i] > 0.5f ? f_max(chin, v3_length(moved(i))) : chin;
        }
        assert_true(most > 2.0f && most < 12.0f);
        assert_true(chin < 0.01f);
    }
}

static void the_jaw_leaves_the_skull_alone(void **state)
{
    (void)state;
    assert_true(hold("jaw.open", NULL) < 5.0);
    assert_whole();
    assert_symmetric();
    float lower = 0.0f, brow = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        lower = model->jaw_weight[i] > 0.99f ? f_max(lower, -moved(i).y) : lower;
        brow = model->rest_position[i].y > 30.0f ? f_max(brow, v3_length(moved(i))) : brow;
    }
    assert_true(lower > 15.0f);
    assert_true(brow < 0.1f);
}

static void poses_combine(void **state)
{
    (void)state;
    assert_true(hold("zygomaticus_major", "jaw.open") < 5.0);
    assert_whole();
    assert_symmetric();
    assert_true(hold("zygomaticus_major", "depressor_anguli_oris") < 5.0);
    assert_whole();
    assert_symmetric();
    hold("zygomaticus_major.L", NULL); /* control: one side is not symmetric */
    float gap = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (mirror[i] != UINT32_MAX) {
            gap = f_max(gap, v3_distance(v4_xyz(x[i]), v3(-x[mirror[i]].x, x[mirror[i]].y, x[mirror[i]].z)));
        }
    }
    assert_true(gap > 3.0f);
}

/* No channel is dead: each moves its skin or its bone. */
/* How far the tongue, which the skin does not show, is from rest. */
static float tongue_moved(void)
{
    float most = 0.0f;
    for (uint32_t k = 0; k < model->head->part_count; ++k) {
        const ris_mesh *mesh = &model->head->part[k].mesh;
        ris_vec4 *at = calloc(mesh->vertex_count + 1u, sizeof *at);
        assert_non_null(at);
        const bool shaped = ris_sim_part_shape(sim, k, at);
        for (uint32_t v = 0; shaped && v < mesh->vertex_count; ++v) {
            most = f_max(most, v3_distance(v4_xyz(at[v]), mesh->position[v]));
        }
        free(at);
    }
    return most;
}

static void no_channel_is_dead(void **state)
{
    (void)state;
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        float before[5][12], after[5][12];
        if (strcmp(model->channel[c].name, "lips.close") == 0) {
            continue; /* closed lips have nothing to close; see test_mouth */
        }
        static const ris_bone bones[] = {RIS_BONE_JAW, RIS_BONE_EYE_L, RIS_BONE_EYE_R, RIS_BONE_SKULL};
        memset(pose, 0, model->channel_count * sizeof *pose);
        need(ris_sim_reset(sim, &err));
        for (int step = 0; step < 2; ++step) {
            pose[c] = step ? model->channel[c].maximum : 0.0f;
            for (int i = 0; i < 1 + 5 * step; ++i) {
                need(ris_sim_tick(sim, pose, &err));
            }
            for (int b = 0; b < 4; ++b) {
                ris_sim_bone_transform(sim, bones[b], step ? after[b] : before[b]);
            }
            ris_sim_head_transform(sim, step ? after[4] : before[4]);
        }
        need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
        float most = tongue_moved();
        for (uint32_t i = 0; i < model->node_count; ++i) {
            most = f_max(most, v3_length(moved(i)));
        }
        if (most < 0.5f && memcmp(before, after, sizeof before) == 0) {
            fail_msg("channel %s moves nothing", model->channel[c].name);
        }
    }
}

/* A grid point moved by 5 mm shows: the muscles are real, not painted. */
static void grids_matter(void **state)
{
    (void)state;
    ris_head *head = model->owned_head;
    hold("zygomaticus_major.L", NULL);
    ris_vec4 *before = malloc(model->node_count * sizeof *before);
    memcpy(before, x, model->node_count * sizeof *before);
    ris_muscle_def *def = NULL;
    for (uint32_t m = 0; m < head->muscle_count; ++m) {
        def = strcmp(head->muscle[m].name, "zygomaticus_major.L") == 0 ? &head->muscle[m] : def;
    }
    assert_non_null(def);
    for (uint32_t c = 0; c < def->columns; ++c) {
        def->grid[(def->rows - 1) * def->columns + c].y += 5.0f;
    }
    ris_model *other = NULL;
    ris_sim *other_sim = NULL;
    need(ris_model_create(head, &other, &err));
    need(ris_sim_create_cpu(other, &other_sim, &err));
    need(ris_sim_settle(other_sim, pose, NULL, &err));
    need(ris_sim_read(other_sim, RIS_STATE_POSITION, x, &err));
    float most = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        most = f_max(most, v3_distance(v4_xyz(x[i]), v4_xyz(before[i])));
    }
    assert_true(most > 0.5f);
    for (uint32_t c = 0; c < def->columns; ++c) {
        def->grid[(def->rows - 1) * def->columns + c].y -= 5.0f;
    }
    free(before);
    ris_sim_destroy(other_sim);
    ris_model_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_head_is_big_enough_and_rests),
        cmocka_unit_test(a_smile_lifts_both_corners),
        cmocka_unit_test(brows_move_alone),
        cmocka_unit_test(the_jaw_leaves_the_skull_alone),
        cmocka_unit_test(poses_combine),
        cmocka_unit_test(no_channel_is_dead),
        cmocka_unit_test(grids_matter),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
