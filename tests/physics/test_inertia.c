/* The stage head_inertia and what verlet makes of it: the field by hand, a free node that falls behind, and the reference
 * head that is shaken. */
#include "loaded_head.h"
#include "scenes/scenes.h"
#include "sim/rig.h"

#include <math.h>

#define DEGREE (3.14159265358979 / 180.0)

/* ---- the field by hand ---- */

typedef struct field {
    ris_model *model;
    ris_rig rig;
    float *pose;
} field;

static field open_field(ris_tissue_model tissue, float follow_through, float gravity)
{
    static const ris_vec3 p[] = {{0, 0, 0}};
    field f = {0};
    ris_scene_net_def def = {.node_count = 1, .position = p, .mass_g = 2, .tissue = ris_default_tissue()};
    def.tissue.model = tissue;
    need(ris_scene_net(&def, &f.model, &err));
    f.model->owned_head->dynamics.follow_through = follow_through;
    f.model->owned_head->dynamics.gravity = gravity;
    need(ris__rig_init(&f.rig, f.model, &err));
    f.pose = calloc(f.model->channel_count, sizeof *f.pose);
    assert_non_null(f.pose);
    return f;
}

static void close_field(field *f)
{
    ris__rig_finish(&f->rig);
    ris_model_destroy(f->model);
    free(f->pose);
}

static float *channel(const ris_model *of, float *values, const char *name)
{
    const uint32_t c = ris_model_channel(of, name);
    assert_true(c < of->channel_count);
    return &values[c];
}

static void tick_field(field *f, bool at_once)
{
    ris__jaw_pose(&f->rig, f->pose);
    ris__head_inertia(&f->rig, at_once);
}

/* What is felt at r. */
static ris_vec3 felt(const field *f, ris_vec3 r)
{
    const ris_inertia *i = &f->rig.inertia;
    return v3(v3_dot(v4_xyz(i->row_x), r) + i->row_x.w, v3_dot(v4_xyz(i->row_y), r) + i->row_y.w,
              v3_dot(v4_xyz(i->row_z), r) + i->row_z.w);
}

static void assert_felt(const field *f, ris_vec3 r, ris_vec3 wanted, float tolerance)
{
    const ris_vec3 is = felt(f, r);
    if (!(v3_distance(is, wanted) <= tolerance)) {
        fail_msg("felt (%g %g %g), expected (%g %g %g)", (double)is.x, (double)is.y, (double)is.z,
                 (double)wanted.x, (double)wanted.y, (double)wanted.z);
    }
}

/* Speeding up by 720 mm/s^2 to the left is felt as 720 to the right, everywhere; half of it at a share of 0.5. */
static void speeding_up_is_felt_against_it(void **state)
{
    (void)state;
    for (int half = 0; half < 2; ++half) {
        field f = open_field(RIS_TISSUE_RISORIUS, half ? 0.5f : 1.0f, 0);
        for (int t = 0; t < 40; ++t) { /* 0.1 mm a tick and tick */
            *channel(f.model, f.pose, "head.x") = 0.1f * (float)(t * t);
            tick_field(&f, false);
        }
        assert_felt(&f, v3(0, 0, 0), v3(half ? -360 : -720, 0, 0), 0.5f);
        assert_felt(&f, v3(50, -60, 90), v3(half ? -360 : -720, 0, 0), 0.5f);
        close_field(&f);
    }
}

/* The same with the head turned by 90 degrees to the left: its own z points to where it speeds up. */
static void it_is_felt_in_the_heads_own_frame(void **state)
{
    (void)state;
    field f = open_field(RIS_TISSUE_RISORIUS, 1, 0);
    for (int t = 0; t < 40; ++t) {
        *channel(f.model, f.pose, "head.yaw") = 90.0f;
        *channel(f.model, f.pose, "head.x") = 0.1f * (float)(t * t);
        tick_field(&f, false);
    }
    assert_felt(&f, v3(0, 0, 0), v3(0, 0, -720), 0.5f);
    close_field(&f);
}

/* A steady turn of 2 rad/s about y throws outwards with w^2 r = 4 x 100; one that speeds up by 2 rad/s^2 besides leaves a
 * point 100 mm in front behind by 200 to the right. */
static void a_turn_throws_outwards_and_leaves_behind(void **state)
{
    (void)state;
    field f = open_field(RIS_TISSUE_RISORIUS, 1, 0);
    const double rate = 2.0 / 60.0 / DEGREE; /* degrees a tick */
    for (int t = 0; t < 40; ++t) {
        *channel(f.model, f.pose, "head.yaw") = (float)(rate * t - 40.0);
        tick_field(&f, false);
    }
    assert_felt(&f, v3(0, 0, 100), v3(0, 0, 400), 2.0f);
    assert_felt(&f, v3(50, 70, 0), v3(200, 0, 0), 2.0f);
    close_field(&f);
    f = open_field(RIS_TISSUE_RISORIUS, 1, 0);
    for (int t = 0; t < 40; ++t) {
        *channel(f.model, f.pose, "head.yaw") = (float)(rate / 60.0 * t * t / 2.0);
        tick_field(&f, false);
    }
    assert_true(fabsf(felt(&f, v3(0, 0, 100)).x + 200.0f) < 2.0f);
    assert_true(fabsf(felt(&f, v3(100, 0, 0)).z - 200.0f) < 2.0f);
    close_field(&f);
}

/* Nothing is felt of rest, of a steady way, of a head that stands turned, nor in the kaehler tissue. */
static void steady_ways_are_not_felt(void **state)
{
    (void)state;
    static const ris_inertia none;
    for (int k = 0; k < 5; ++k) {
        field f = open_field(k == 4 ? RIS_TISSUE_KAEHLER : RIS_TISSUE_RISORIUS, 1, k == 4);
        for (int t = 0; t < 40; ++t) {
            *channel(f.model, f.pose, "head.y") = k == 1 ? 5.0f * (float)t : k == 4 ? (float)(t * t) : 0.0f;
            *channel(f.model, f.pose, "head.roll") = k == 2 ? 30.0f : k == 4 ? (float)(t % 7) : 0.0f;
            tick_field(&f, k == 3); /* and k == 3: held */
            assert_memory_equal(&f.rig.inertia, &none, sizeof none);
        }
        close_field(&f);
    }
}

/* On the left shoulder by 30 degrees the weight pulls to the left by 9810 sin 30 = 4905, and down by 9810 (1 - cos 30) = 1314.3
 * less than at rest; looking up by 90 it pulls back by 9810. */
static void a_tilted_head_feels_its_weight(void **state)
{
    (void)state;
    field f = open_field(RIS_TISSUE_RISORIUS, 0, 1);
    *channel(f.model, f.pose, "head.roll") = 30.0f;
    tick_field(&f, true);
    assert_felt(&f, v3(0, 0, 0), v3(4905, 1314.3f, 0), 0.5f);
    assert_felt(&f, v3(50, 60, 70), v3(4905, 1314.3f, 0), 0.5f);
    *channel(f.model, f.pose, "head.roll") = 0.0f;
    *channel(f.model, f.pose, "head.pitch") = 90.0f;
    tick_field(&f, true);
    assert_felt(&f, v3(0, 0, 0), v3(0, 9810, -9810), 0.5f);
    close_field(&f);
}

/* A cut in a take, from one side to the other within a tick, is felt within bounds, and what it speeds up it stops again. */
static void a_cut_is_no_blow(void **state)
{
    (void)state;
    field f = open_field(RIS_TISSUE_RISORIUS, 1, 0);
    ris_vec3 sum = {0};
    float most = 0.0f;
    for (int t = 0; t < 120; ++t) {
        *channel(f.model, f.pose, "head.x") = t < 20 ? -200.0f : 200.0f;
        tick_field(&f, false);
        const ris_vec3 now = felt(&f, v3(0, 0, 100));
        most = f_max(most, v3_length(now));
        sum = v3_add(sum, now);
    }
    assert_true(most > 1000.0f && most < 12000.0f);
    assert_true(v3_length(sum) < 1.0f);
    assert_true(v3_length(felt(&f, v3(0, 0, 100))) == 0.0f);
    close_field(&f);
}

/* ---- a node without springs ---- */

/* A free node of 2 g in a head that speeds up by 720 mm/s^2 gets slower by 12 mm/s a tick, its heft of 1 whatever it weighs. */
static void a_free_node_falls_behind(void **state)
{
    (void)state;
    static const ris_vec3 p[] = {{0, 0, 0}, {10, 0, 0}};
    static const bool pinned[] = {false, true};
    ris_scene_net_def def = {
        .node_count = 2, .position = p, .pinned = pinned, .mass_g = 2, .tissue = ris_default_tissue()};
    ris_model *net = NULL;
    ris_sim *free_sim = NULL;
    ris_vec4 v[2], before[2];
    need(ris_scene_net(&def, &net, &err));
    net->owned_head->dynamics.follow_through = 1;
    need(ris_sim_create_cpu(net, &free_sim, &err));
    float *values = calloc(net->channel_count, sizeof *values);
    for (int t = 0; t < 60; ++t) {
        *channel(net, values, "head.x") = 0.1f * (float)(t * t);
        need(ris_sim_read(free_sim, RIS_STATE_VELOCITY_HALF, before, &err));
        need(ris_sim_tick(free_sim, values, &err));
    }
    need(ris_sim_read(free_sim, RIS_STATE_VELOCITY_HALF, v, &err));
    assert_true(fabsf((v[0].x - before[0].x) + 12.0f) < 0.01f);
    assert_true(v[0].y == 0.0f && v[0].z == 0.0f);
    assert_true(v[1].x == 0.0f);
    free(values);
    ris_sim_destroy(free_sim);
    ris_model_destroy(net);
}

/* ---- the reference head ---- */

static float most_of(const ris_region *region)
{
    float most = 0.0f;
    for (uint32_t k = 0; k < region->count; ++k) {
        const uint32_t i = region->vertex[k];
        most = f_max(most, v3_distance(v4_xyz(x[i]), v4_xyz(model->rest_position[i])));
    }
    return most;
}

static uint32_t flipped(void)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        count += v3_dot(triangle_cross(x, v), triangle_cross(model->rest_position, v)) < 0.0f;
    }
    return count;
}

typedef struct shake {
    float cheek, lips, forehead; /* largest displacement, mm */
    float after;                 /* largest of all half a second after the end, mm */
    uint32_t flips;              /* triangles against their rest normal, over all ticks */
} shake;

/* Moves the head as motion says for a second, and keeps it for another. */
static shake play(void (*motion)(float seconds))
{
    shake s = {0};
    const ris_region *cheek = ris_head_region(model->head, "cheek"),
                     *lips = ris_head_region(model->head, "lips"),
                     *forehead = ris_head_region(model->head, "forehead");
    memset(pose, 0, model->channel_count * sizeof *pose);
    need(ris_sim_reset(sim, &err));
    for (int t = 0; t < 120; ++t) {
        motion(f_min((float)t / 60.0f, 1.0f));
        need(ris_sim_tick(sim, pose, &err));
        need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
        s.cheek = f_max(s.cheek, most_of(cheek));
        s.lips = f_max(s.lips, most_of(lips));
        s.forehead = f_max(s.forehead, most_of(forehead));
        s.flips += flipped();
        if (t >= 90) {
            for (uint32_t i = 0; i < model->node_count; ++i) {
                s.after = f_max(s.after, v3_distance(v4_xyz(x[i]), v4_xyz(model->rest_position[i])));
            }
        }
    }
    print_message("cheek %.2f mm, lips %.2f, forehead %.2f, after half a second %.3f, %u flips\n",
                  (double)s.cheek, (double)s.lips, (double)s.forehead, (double)s.after, s.flips);
    return s;
}

/* 0 to 1 and back, twice. */
static float twice(float seconds)
{
    return 0.5f - 0.5f * cosf(4.0f * 3.14159265f * seconds);
}

static void nod(float seconds)
{
    *channel(model, pose, "head.pitch") = -15.0f * twice(seconds);
}

static void nod_and_turn(float seconds)
{
    nod(seconds);
    *channel(model, pose, "head.yaw") =
        25.0f * sinf(4.0f * 3.14159265f * seconds) * twice(0.25f * seconds + 0.125f);
}

/* Noise of 2 degrees and 5 mm a tick, and a cut to the other side every tenth of a second. */
static void broken_take(float seconds)
{
    static const char *const names[] = {"head.yaw", "head.pitch", "head.roll", "head.x", "head.y", "head.z"};
    static uint32_t seed = 9;
    for (int k = 0; k < 6; ++k) {
        seed = seed * 1664525u + 1013904223u;
        const float noise = (float)(seed >> 8) / 8388608.0f - 1.0f,
                    side = (int)(10.0f * seconds) % 2 ? 1.0f : -1.0f;
        *channel(model, pose, names[k]) =
            seconds < 1.0f ? (k < 3 ? 2.0f * noise + 40.0f * side : 5.0f * noise + 100.0f * side) : 0.0f;
    }
}

static void still(float seconds)
{
    (void)seconds;
}

static void a_nod_moves_the_cheeks(void **state)
{
    (void)state;
    const shake s = play(nod);
    assert_true(s.cheek > 0.2f && s.cheek < 2.0f);
    assert_true(s.cheek > 2.0f * s.forehead && s.lips > 0.03f);
    assert_true(s.after < 0.05f && s.flips == 0);
}

static void a_shaken_head_stays_whole(void **state)
{
    (void)state;
    shake s = play(nod_and_turn);
    assert_true(s.cheek > 0.5f && s.cheek < 5.0f && s.after < 0.1f && s.flips == 0);
    s = play(broken_take);
    assert_true(s.cheek < 8.0f && s.after < 0.2f && s.flips == 0);
}

/* Control, and rest: without a motion, and without its shares, not a bit moves. */
static void no_share_no_motion(void **state)
{
    (void)state;
    ris_dynamics_def *dynamics = &model->owned_head->dynamics;
    const shake rest = play(still);
    assert_true(rest.after < 1e-3f);
    ris_vec4 *still_x = malloc(model->node_count * sizeof *still_x);
    memcpy(still_x, x, model->node_count * sizeof *x);
    const ris_dynamics_def kept = *dynamics;
    dynamics->follow_through = dynamics->gravity = 0.0f;
    (void)play(nod_and_turn);
    *dynamics = kept;
    assert_memory_equal(x, still_x, model->node_count * sizeof *x);
    free(still_x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(speeding_up_is_felt_against_it),
        cmocka_unit_test(it_is_felt_in_the_heads_own_frame),
        cmocka_unit_test(a_turn_throws_outwards_and_leaves_behind),
        cmocka_unit_test(steady_ways_are_not_felt),
        cmocka_unit_test(a_tilted_head_feels_its_weight),
        cmocka_unit_test(a_cut_is_no_blow),
        cmocka_unit_test(a_free_node_falls_behind),
        cmocka_unit_test(a_nod_moves_the_cheeks),
        cmocka_unit_test(a_shaken_head_stays_whole),
        cmocka_unit_test(no_share_no_motion),
    };
    return cmocka_run_group_tests(tests, open_loaded_head, close_loaded_head);
}
