/* The muscle update on the whole reference head: KA-32 and KA-46 the movable centres of the lips, KA-37 what hangs on muscles goes
 * with them, KA-42 lips that never mix, KA-47 a cheek that bulges, figure 7.19 in the default tissue, and one equilibrium
 * however a smile is reached. */
#include "model/model_impl.h"
#include "sim/rig.h"

#include "loaded_head.h" /* after the others: it names a file-wide x */

static ris_model *literal; /* the same head in the kaehler tissue */

static int open_heads(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    model->owned_head->tissue.model = RIS_TISSUE_KAEHLER;
    const ris_result result = ris_model_create(model->owned_head, &literal, &err);
    model->owned_head->tissue.model = RIS_TISSUE_RISORIUS;
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int close_heads(void **state)
{
    (void)state;
    ris_model_destroy(literal);
    free_head();
    return 0;
}

static uint32_t channel(const char *name)
{
    const uint32_t c = ris_model_channel(model, name);
    if (c == UINT32_MAX) {
        fail_msg("no channel %s", name);
    }
    return c;
}

static void rest_pose(void)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
}

static ris_vec3 moved(uint32_t i)
{
    return v3_sub(v4_xyz(x[i]), v4_xyz(model->rest_position[i]));
}

/* The foremost vertex of a lip. */
static uint32_t apex(const char *lip)
{
    const ris_region *region = ris_head_region(model->head, lip);
    assert_non_null(region);
    uint32_t best = region->vertex[0];
    for (uint32_t k = 0; k < region->count; ++k) {
        best = model->rest_position[region->vertex[k]].z > model->rest_position[best].z ? region->vertex[k]
                                                                                        : best;
    }
    return best;
}

static void the_upper_lip_comes_forward_alone(void **state) /* KA-46, and the pose of an f */
{
    (void)state;
    const uint32_t upper = apex("lip_upper"), lower = apex("lip_lower");
    float last = -1.0f, across = 0.0f;
    for (int active = 0; active < 2; ++active) { /* by itself, and while the muscle contracts */
        last = -1.0f;
        for (int step = 0; step <= 4; ++step) {
            rest_pose();
            pose[channel("orbicularis_oris_superior")] = (float)active;
            pose[channel("orbicularis_oris_superior.protrude")] = 0.25f * (float)step;
            settle();
            const float out = moved(upper).z;
            across = f_max(across, fabsf(moved(upper).x));
            assert_true(out > last + 0.3f);
            assert_true(step == 0 || out > moved(lower).z + 0.5f * (float)step);
            last = out;
        }
        assert_true(last > 3.0f);
    }
    assert_true(across < 0.05f);
}

/* KA-32 literally: a = 0 is the one end of the axis, 1 the other; the outer ring stays. */
static void the_literal_centre_moves_along_the_axis(void **state)
{
    (void)state;
    ris_rig rig;
    need(ris__rig_init(&rig, literal, &err));
    const uint32_t m = channel("orbicularis_oris_superior");
    const ris_muscle *muscle = &literal->muscle[m];
    const ris_vec3 axis = v3_unit_or(v3_sub(muscle->axis[1], muscle->axis[0]), v3(0, 0, 1));
    const float reach = v3_distance(muscle->axis[0], muscle->axis[1]);
    const uint32_t outer = literal->fiber[muscle->first_fiber].first_point + muscle->point_count / 2,
                   inner = literal->fiber[muscle->first_fiber + muscle->fiber_count - 1].first_point +
                           muscle->point_count / 2;
    ris_vec3 start[2] = {{0}};
    for (int step = 0; step <= 4; ++step) {
        rest_pose();
        pose[m] = 1.0f;
        pose[channel("orbicularis_oris_superior.protrude")] = 0.25f * (float)step;
        ris__jaw_pose(&rig, pose);
        ris__muscle_contract(&rig, pose);
        if (step == 0) {
            start[0] = rig.q[outer];
            start[1] = rig.q[inner];
        }
        assert_true(v3_distance(rig.q[outer], start[0]) < 1e-4f);
        const ris_vec3 d = v3_sub(rig.q[inner], start[1]);
        assert_true(fabsf(v3_dot(d, axis) - 0.25f * (float)step * reach * muscle->max_shortening) < 1e-3f);
        assert_true(v3_length(v3_mad(d, -v3_dot(d, axis), axis)) < 1e-3f);
    }
    ris__rig_finish(&rig);
}

static float largest_of(const char *region, bool alone)
{
    const ris_region *r = ris_head_region(model->head, region),
                     *other = ris_head_region(model->head,
                                              strcmp(region, "lip_upper") ? "lip_upper" : "lip_lower");
    float most = 0.0f;
    for (uint32_t k = 0; k < r->count; ++k) {
        bool shared = false;
        for (uint32_t i = 0; i < other->count; ++i) {
            shared = shared || other->vertex[i] == r->vertex[k];
        }
        if (!(alone && shared)) {
            most = f_max(most, v3_length(moved(r->vertex[k])));
        }
    }
    return most;
}

/* KA-42, KA-46: with the lower muscle alone the lower lip moves and the upper one by a tenth of that at most, away from the
 * corners that both share. */
static void the_lower_lip_moves_alone(void **state)
{
    (void)state;
    const uint32_t upper = apex("lip_upper"), lower = apex("lip_lower");
    rest_pose();
    pose[channel("orbicularis_oris_inferior.protrude")] = 1.0f;
    settle();
    assert_true(v3_length(moved(lower)) > 3.0f && v3_length(moved(upper)) < 0.1f * v3_length(moved(lower)));
    rest_pose();
    pose[channel("orbicularis_oris_inferior")] = 1.0f;
    settle();
    assert_true(v3_length(moved(lower)) > 4.0f && v3_length(moved(upper)) < 0.1f * v3_length(moved(lower)));
    assert_true(largest_of("lip_lower", true) > 4.0f);
}

/* KA-42: no vertex of one lip alone hangs on the muscle of the other, in either tissue. */
static void lips_never_mix(void **state)
{
    (void)state;
    bool *flags[2];
    static const char *const lips[] = {"lip_upper", "lip_lower"};
    static const char *const muscles[] = {"orbicularis_oris_superior", "orbicularis_oris_inferior"};
    for (int k = 0; k < 2; ++k) {
        flags[k] = calloc(model->node_count, sizeof **flags);
        ris__region_flags(model->head, lips[k], flags[k]);
    }
    for (int t = 0; t < 2; ++t) {
        const ris_model *tissue = t ? literal : model;
        uint32_t own[2] = {0};
        for (uint32_t i = 0; i < tissue->node_count; ++i) {
            for (uint32_t b = tissue->binding_start[i]; b < tissue->binding_start[i + 1]; ++b) {
                for (int k = 0; k < 2; ++k) {
                    const bool here = tissue->binding[b].muscle == channel(muscles[k]);
                    own[k] += here && flags[k][i];
                    assert_false(here && flags[1 - k][i] && !flags[k][i]);
                }
            }
        }
        assert_true(own[0] > 50 && own[1] > 50);
    }
    free(flags[0]);
    free(flags[1]);
}

/* KA-37: all muscles shifted, what hangs on them is shifted as they are, and no edge between such nodes changes. */
static void attached_skin_goes_with_the_muscles(void **state)
{
    (void)state;
    ris_rig rig;
    need(ris__rig_init(&rig, literal, &err));
    rest_pose();
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_bulge(&rig);
    for (uint32_t k = 0; k < literal->fiber_point_count; ++k) {
        rig.q[k] = v3_add(rig.q[k], v3(1, 2, 3));
    }
    ris__muscle_attach(&rig);
    uint32_t bound = 0;
    for (uint32_t i = 0; i < literal->node_count; ++i) {
        const bool on_muscle = literal->binding_start[i + 1] > literal->binding_start[i];
        if (literal->rest_position[i].w > 0.0f && on_muscle) {
            assert_true(v3_distance(v4_xyz(rig.delta[i]), v3(1, 2, 3)) < 1e-4f);
            ++bound;
        } else {
            assert_true(v3_length(v4_xyz(rig.delta[i])) == 0.0f);
        }
    }
    assert_true(bound > 500);
    ris__rig_finish(&rig);
}

/* How far the nodes on zygomaticus major come out of the face in a full smile, on the whole. */
static float cheek_height(float nu)
{
    ris_rig rig;
    model->owned_head->tissue.bulge_kaehler = nu;
    need(ris__rig_init(&rig, literal, &err));
    rest_pose();
    pose[channel("zygomaticus_major.L")] = 1.0f;
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    ris__muscle_relax(&rig);
    ris__muscle_bulge(&rig);
    ris__muscle_attach(&rig);
    float sum = 0.0f;
    for (uint32_t i = 0; i < literal->node_count; ++i) {
        if (literal->binding_start[i + 1] > literal->binding_start[i] &&
            literal->binding[literal->binding_start[i]].muscle == channel("zygomaticus_major.L")) {
            sum += v3_dot(v4_xyz(rig.delta[i]), v4_xyz(literal->rest_normal[i]));
        }
    }
    ris__rig_finish(&rig);
    return sum;
}

static void a_bulging_cheek_stands_out(void **state) /* KA-47 */
{
    (void)state;
    const float flat = cheek_height(0.0f), full = cheek_height(5.0f);
    assert_true(full > flat + 1.0f);
    assert_true(cheek_height(1.0f) > flat && cheek_height(1.0f) < full);
    model->owned_head->tissue.bulge_kaehler = 5.0f;
}

static float straightness(const ris_muscle *muscle, const ris_vec3 *points)
{
    float length = 0.0f;
    for (uint32_t i = 1; i < muscle->point_count; ++i) {
        length += v3_distance(ris__muscle_point(model, muscle, points, i),
                              ris__muscle_point(model, muscle, points, i - 1));
    }
    return v3_distance(ris__muscle_point(model, muscle, points, 0),
                       ris__muscle_point(model, muscle, points, muscle->point_count - 1)) /
           length;
}

/* Figure 7.19: zygomaticus major alone lifts the upper half of orbicularis oris and straightens the depressor anguli oris. */
static void a_smile_lifts_the_lip_and_straightens_the_depressor(void **state)
{
    (void)state;
    ris_rig rig;
    need(ris__rig_init(&rig, model, &err));
    rest_pose();
    pose[channel("zygomaticus_major.L")] = pose[channel("zygomaticus_major.R")] = 1.0f;
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    ris__muscle_relax(&rig);
    const ris_muscle *lip = &model->muscle[channel("orbicularis_oris_superior")];
    float lifted = 0.0f;
    for (uint32_t i = 0; i < lip->point_count; ++i) {
        const float up =
            ris__muscle_point(model, lip, rig.q, i).y - ris__muscle_point(model, lip, rig.p, i).y;
        assert_true(up > -0.1f);
        lifted += up / (float)lip->point_count;
    }
    assert_true(lifted > 2.0f);
    static const char *const names[] = {"depressor_anguli_oris.L", "depressor_anguli_oris.R"};
    for (int k = 0; k < 2; ++k) {
        const ris_muscle *muscle = &model->muscle[channel(names[k])];
        assert_true(straightness(muscle, rig.q) > straightness(muscle, rig.p) + 0.01f);
    }
    ris__rig_finish(&rig);
}

static void ramped_and_sudden_smiles_end_alike(void **state)
{
    (void)state;
    static const char *const smile[] = {"zygomaticus_major.L", "zygomaticus_major.R"};
    ris_vec4 *sudden = malloc(model->node_count * sizeof *sudden);
    rest_pose();
    pose[channel(smile[0])] = pose[channel(smile[1])] = 1.0f;
    settle();
    memcpy(sudden, x, model->node_count * sizeof *sudden);
    rest_pose();
    need(ris_sim_reset(sim, &err));
    for (int tick = 1; tick <= 60; ++tick) {
        pose[channel(smile[0])] = pose[channel(smile[1])] = (float)tick / 60.0f;
        need(ris_sim_tick(sim, pose, &err));
    }
    float halfway = 0.0f, end = 0.0f;
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    for (uint32_t i = 0; i < model->node_count; ++i) {
        halfway = f_max(halfway, v3_distance(v4_xyz(x[i]), v4_xyz(sudden[i])));
    }
    need(ris_sim_settle(sim, pose, NULL, &err));
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    for (uint32_t i = 0; i < model->node_count; ++i) {
        end = f_max(end, v3_distance(v4_xyz(x[i]), v4_xyz(sudden[i])));
    }
    print_message("ramped and sudden smile end %.4f mm apart at most\n", (double)end);
    assert_true(end < 0.1f);
    assert_true(halfway > end); /* control: before rest they differ */
    free(sudden);
}

/* The literal tissue too mirrors a symmetric pose, midline and all. */
static void the_literal_tissue_is_symmetric(void **state)
{
    (void)state;
    ris_sim *other = NULL;
    need(ris_sim_create_cpu(literal, &other, &err));
    static const char *const both[] = {"zygomaticus_major.L", "zygomaticus_major.R", "procerus",
                                       "orbicularis_oris_superior"};
    float gap = 0.0f, lopsided = 0.0f;
    for (int side = 0; side < 2; ++side) { /* symmetric, then the left side only */
        rest_pose();
        for (int k = 0; k < (side ? 1 : 4); ++k) {
            pose[channel(both[k])] = 1.0f;
        }
        need(ris_sim_reset(other, &err));
        for (int tick = 0; tick < 30; ++tick) {
            need(ris_sim_tick(other, pose, &err));
        }
        need(ris_sim_read(other, RIS_STATE_POSITION, x, &err));
        for (uint32_t i = 0; i < model->node_count; ++i) {
            if (mirror[i] != UINT32_MAX) {
                const ris_vec4 p = x[mirror[i]];
                float *most = side ? &lopsided : &gap;
                *most = f_max(*most, v3_distance(v4_xyz(x[i]), v3(-p.x, p.y, p.z)));
            }
        }
    }
    assert_true(gap < 0.01f);
    assert_true(lopsided > 0.5f); /* control */
    ris_sim_destroy(other);
}

/* KA-05: the jaw alone leaves the middle of the upper lip where it is and takes the lower lip along. */
static void the_jaw_leaves_the_upper_lip(void **state)
{
    (void)state;
    rest_pose();
    pose[channel("jaw.open")] = 1.0f;
    settle();
    float upper = 0.0f;
    const ris_region *region = ris_head_region(model->head, "lip_upper");
    for (uint32_t k = 0; k < region->count; ++k) {
        const uint32_t i = region->vertex[k];
        upper = fabsf(model->rest_position[i].x) < 6.0f ? f_max(upper, v3_length(moved(i))) : upper;
    }
    print_message("the middle of the upper lip moves %.3f mm\n", (double)upper);
    assert_true(upper < 0.1f && moved(apex("lip_lower")).y < -15.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_upper_lip_comes_forward_alone),
        cmocka_unit_test(the_literal_centre_moves_along_the_axis),
        cmocka_unit_test(the_lower_lip_moves_alone),
        cmocka_unit_test(lips_never_mix),
        cmocka_unit_test(attached_skin_goes_with_the_muscles),
        cmocka_unit_test(a_bulging_cheek_stands_out),
        cmocka_unit_test(a_smile_lifts_the_lip_and_straightens_the_depressor),
        cmocka_unit_test(ramped_and_sudden_smiles_end_alike),
        cmocka_unit_test(the_literal_tissue_is_symmetric),
        cmocka_unit_test(the_jaw_leaves_the_upper_lip),
    };
    return cmocka_run_group_tests(tests, open_heads, close_heads);
}
