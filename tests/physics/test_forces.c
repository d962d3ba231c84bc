/* Forces against hand-computed numbers: KA-12 biphasic springs, KA-14/15 anchor pair, KA-16 sums, the
 * default tissue's anchor and bending, KA-20 normals, KA-37 anchor_shift. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "model/vec3.h"
#include "scenes/scenes.h"
#include "sim/sim_impl.h"

#include <stdlib.h>
#include <string.h>

#define assert_near(a, b, tolerance) assert_float_equal((float)(a), (float)(b), (float)(tolerance))

typedef struct world {
    ris_model *model;
    ris_sim *sim;
    float *pose;
    ris_vec4 *x, *value;
} world;

static ris_error err;

static void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static world open_world(ris_model *model)
{
    world w = {.model = model};
    need(ris_sim_create_cpu(model, &w.sim, &err));
    w.pose = calloc(model->channel_count, sizeof *w.pose);
    w.x = malloc(model->node_count * sizeof *w.x);
    w.value = malloc(model->node_count * sizeof *w.value);
    memcpy(w.x, model->rest_position, model->node_count * sizeof *w.x);
    return w;
}

static void close_world(world *w)
{
    ris_sim_destroy(w->sim);
    ris_model_destroy(w->model);
    free(w->pose);
    free(w->x);
    free(w->value);
}

/* Forces at positions w->x with the anchors of the neutral pose. */
static const ris_vec4 *forces(world *w)
{
    ris_anchor_frame anchors;
    need(ris__sim_pose(w->sim, w->pose, &anchors, &err));
    need(ris_sim_write(w->sim, RIS_STATE_POSITION, w->x, &err));
    need(ris__sim_stage(w->sim, RIS_STAGE_BEND, &anchors, &err));
    need(ris__sim_stage(w->sim, RIS_STAGE_SPRING_FORCE, NULL, &err));
    need(ris_sim_read(w->sim, RIS_STATE_FORCE, w->value, &err));
    return w->value;
}

static world open_net(ris_scene_net_def *def)
{
    ris_model *model = NULL;
    need(ris_scene_net(def, &model, &err));
    return open_world(model);
}

static ris_tissue_def law(bool continuous, float compression)
{
    ris_tissue_def tissue = ris_default_tissue();
    tissue.continuous = continuous;
    tissue.compression = compression;
    tissue.substeps = 1;
    return tissue;
}

/* KA-12: the interior equilateral edge of length 1, g = sqrt(3)/2. Force on the near end along the edge. */
static void biphasic_spring(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{0, 0, 0}, {1, 0, 0}};
    const ris_scene_spring spring = {0, 1, 1.0f, 0.86602540f};
    ris_scene_net_def def = {.node_count = 2,
                             .spring_count = 1,
                             .position = p,
                             .spring = &spring,
                             .mass_g = 1,
                             .tissue = law(false, 1)};
    static const float literal[][2] = {{1.0f, 0},        {1.2f, 17.3205f},  {1.49f, 42.435f},
                                       {1.5f, 433.013f}, {0.8f, -17.3205f}, {0, 0}};
    world w = open_net(&def);
    for (size_t k = 0; k < sizeof literal / sizeof literal[0]; ++k) {
        w.x[1].x = literal[k][0];
        const ris_vec4 *f = forces(&w);
        assert_near(f[0].x, literal[k][1], 2e-3);
        assert_near(f[1].x, -literal[k][1], 2e-3);
        assert_true(f[0].y == 0.0f && f[0].z == 0.0f && f[0].w == 0.0f);
    }
    close_world(&w);

    def.tissue = law(true, 0.2f); /* continuous above the switch, soft below rest */
    static const float smooth[][2] = {
        {1.2f, 17.3205f}, {1.5f, 43.3013f}, {1.6f, 129.9038f}, {0.8f, -3.4641f}};
    w = open_net(&def);
    for (size_t k = 0; k < sizeof smooth / sizeof smooth[0]; ++k) {
        w.x[1].x = smooth[k][0];
        assert_near(forces(&w)[0].x, smooth[k][1], 2e-3);
    }
    close_world(&w);
}

/* KA-16: p = 0, q = 2, r = 1, k = 10 gives 10 and -10; internal forces and torques of a random net add up
 * to nothing. */
static void internal_forces_cancel(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{0, 0, 0}, {2, 0, 0}};
    const ris_scene_spring spring = {0, 1, 1.0f, 0.1f};
    ris_scene_net_def def = {.node_count = 2,
                             .spring_count = 1,
                             .position = p,
                             .spring = &spring,
                             .mass_g = 1,
                             .tissue = law(false, 1)};
    def.tissue.modulus[1] = def.tissue.modulus[0];
    world w = open_net(&def);
    assert_near(forces(&w)[0].x, 10, 1e-5);
    assert_near(forces(&w)[1].x, -10, 1e-5);
    close_world(&w);

    enum { N = 40, S = 120 };
    ris_vec3 q[N];
    ris_scene_spring springs[S];
    uint32_t seed = 12345;
    for (uint32_t i = 0; i < 3 * N; ++i) {
        seed = seed * 1664525u + 1013904223u;
        ((float *)q)[i] = (float)(seed >> 8) / 16777216.0f * 20.0f;
    }
    for (uint32_t s = 0; s < S; ++s) {
        seed = seed * 1664525u + 1013904223u;
        const uint32_t a = (seed >> 8) % N, b = (a + 1 + (seed >> 16) % (N - 1)) % N;
        springs[s] = (ris_scene_spring){a, b, 1.0f + (float)(seed >> 24) / 32.0f, 0.5f};
    }
    def = (ris_scene_net_def){.node_count = N,
                              .spring_count = S,
                              .position = q,
                              .spring = springs,
                              .mass_g = 1,
                              .tissue = law(true, 0.2f)};
    w = open_net(&def);
    const ris_vec4 *f = forces(&w);
    ris_vec3 sum = {0}, torque = {0};
    float size = 0.0f;
    for (uint32_t i = 0; i < N; ++i) {
        sum = v3_add(sum, v4_xyz(f[i]));
        torque = v3_add(torque, v3_cross(v4_xyz(w.x[i]), v4_xyz(f[i])));
        size += v3_length(v4_xyz(f[i]));
    }
    assert_true(size > 1000.0f);
    assert_true(v3_length(sum) < 1e-6f * size && v3_length(torque) < 2e-5f * size);
    close_world(&w);
}

/* KA-15: pair of k at h = 5 mm, pushed s: normal 2ks, tangential 2k(1 - h/sqrt(h^2 + s^2))s. */
static void anchor_pair(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{0, 0, 0}};
    ris_anchor_param anchor = {.normal = 30, .rest_mm = 5};
    ris_scene_net_def def = {
        .node_count = 1, .position = p, .anchor = &anchor, .mass_g = 1, .tissue = law(false, 1)};
    def.tissue.model = RIS_TISSUE_KAEHLER;
    static const float cases[][4] = {{30, 1, 60, 1.1652f}, {10, 1, 20, 0.3884f}, {30, 2, 120, 8.583f}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        anchor.normal = cases[k][0];
        world w = open_net(&def);
        for (int sign = -1; sign <= 1; sign += 2) {
            w.x[0] = (ris_vec4){0, 0, cases[k][1] * (float)sign, 1};
            assert_near(forces(&w)[0].z, -cases[k][2] * (float)sign, 1e-3);
            w.x[0] = (ris_vec4){cases[k][1] * (float)sign, 0, 0, 1};
            assert_near(forces(&w)[0].x, -cases[k][3] * (float)sign, 1e-3);
            assert_near(forces(&w)[0].z, 0, 1e-5);
        }
        close_world(&w);
    }
}

/* Default tissue: 60 along the normal, 45 across it, linear in both. */
static void normal_and_tangential_anchor(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{1, 2, 3}};
    const ris_anchor_param anchor = {.normal = 60, .tangential = 45};
    ris_scene_net_def def = {
        .node_count = 1, .position = p, .anchor = &anchor, .mass_g = 1, .tissue = law(true, 1)};
    world w = open_net(&def);
    w.x[0] = (ris_vec4){1 + 2, 2 - 1, 3 + 0.5f, 1};
    const ris_vec4 f = forces(&w)[0];
    assert_near(f.x, -90, 1e-4);
    assert_near(f.y, 45, 1e-4);
    assert_near(f.z, -30, 1e-4);
    close_world(&w);
}

/* A field without springs, anchors of its own and muscles; radius 0 is flat. */
static ris_model *umbrellas_alone(uint32_t columns, uint32_t rows, float spacing_mm, float radius_mm)
{
    ris_scene_def def = ris_default_scene_def();
    def.columns = columns;
    def.rows = rows;
    def.spacing_mm = spacing_mm;
    def.radius_mm = radius_mm;
    def.rig = false;
    def.tissue.modulus[0] = def.tissue.modulus[1] = 0.0f;
    def.tissue.anchor_region_count = 0;
    ris_model *model = NULL;
    need(ris_scene_model(&def, &model, &err));
    return model;
}

/* Bending: the force is minus the gradient of sum k/2 |L(x - x0)|^2 over the moving nodes, by central
 * differences. */
static void bending_is_the_gradient(void **state)
{
    (void)state;
    ris_model *model = umbrellas_alone(7, 6, 3, 30);
    world w = open_world(model);
    uint32_t seed = 7;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        float *x = &w.x[i].x;
        for (int k = 0; k < 3 && w.x[i].w > 0.0f; ++k) {
            seed = seed * 1664525u + 1013904223u;
            x[k] += (float)(seed >> 8) / 16777216.0f - 0.5f;
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec4 f = forces(&w)[i];
        if (!(w.x[i].w > 0.0f)) {
            assert_true(f.x == 0.0f && f.y == 0.0f && f.z == 0.0f);
            continue;
        }
        double energy[2];
        for (int side = 0; side < 2; ++side) {
            const float keep = w.x[i].y;
            w.x[i].y += side ? 0.25f : -0.25f;
            energy[side] = 0.0;
            need(ris_sim_write(w.sim, RIS_STATE_POSITION, w.x, &err));
            need(ris__sim_stage(w.sim, RIS_STAGE_BEND, NULL, &err));
            need(ris_sim_read(w.sim, RIS_STATE_BEND, w.value, &err));
            for (uint32_t j = 0; j < model->node_count; ++j) {
                const double k = (double)model->anchor_param[j].bend;
                energy[side] += 0.5 * k * (double)v3_dot(v4_xyz(w.value[j]), v4_xyz(w.value[j]));
            }
            w.x[i].y = keep;
        }
        assert_near(f.y, -(energy[1] - energy[0]) / 0.5, 0.05);
    }
    close_world(&w);
}

/* Largest bending force at the middle of a flat field of 80 mm lifted to a cosine of 80 mm, per mm^2 of skin. */
static double bending_of_a_wave(float spacing_mm)
{
    const uint32_t nodes = (uint32_t)(80.0f / spacing_mm) + 1;
    ris_model *model = umbrellas_alone(nodes, nodes, spacing_mm, 0);
    world w = open_world(model);
    const ris_vec4 *rest = model->rest_position;
    uint32_t middle = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const float *x = &rest[i].x, *m = &rest[middle].x;
        middle = x[0] * x[0] + x[1] * x[1] < m[0] * m[0] + m[1] * m[1] ? i : middle;
        w.x[i].z += cosf(3.14159265f / 40.0f * x[0]);
    }
    const double force = fabs((double)forces(&w)[middle].z) / (double)(spacing_mm * spacing_mm);
    close_world(&w);
    return force;
}

/* The same wave of the skin is held as firmly by a mesh of 1 mm as by one of 2 mm; a stiffness that knew no edge would
 * make it 4 times softer. From 4 mm on the tissue's bending counts as it is, and the force goes with the edge's square. */
static void a_fine_mesh_bends_no_more_readily(void **state)
{
    (void)state;
    const double fine = bending_of_a_wave(1.0f), middle = bending_of_a_wave(2.0f);
    const double coarse = bending_of_a_wave(3.6f), coarser = bending_of_a_wave(7.2f);
    assert_true(fine > 0.0);
    assert_near(fine / middle, 1.0, 0.05);
    assert_true(coarser / coarse > 3.0);
}

/* KA-20: on a sphere the normals are radial within a degree, inside the border; they turn with the mesh. */
static void normals_of_a_sphere(void **state)
{
    (void)state;
    ris_scene_def def = ris_default_scene_def();
    def.rig = false;
    ris_model *model = NULL;
    need(ris_scene_model(&def, &model, &err));
    world w = open_world(model);
    need(ris__sim_stage(w.sim, RIS_STAGE_NORMAL, NULL, &err));
    need(ris_sim_read(w.sim, RIS_STATE_NORMAL, w.value, &err));
    for (uint32_t i = 0; i < model->node_count; ++i) {
        assert_memory_equal(&w.value[i], &model->rest_normal[i], sizeof w.value[i]);
        if (w.x[i].w > 0.0f) {
            assert_true(v3_dot(v4_xyz(w.value[i]), v3_unit_or(v4_xyz(w.x[i]), v3(0, 0, 1))) > 0.99985f);
        }
        w.x[i] = (ris_vec4){-model->rest_position[i].y, model->rest_position[i].x, model->rest_position[i].z,
                            w.x[i].w};
    }
    need(ris_sim_write(w.sim, RIS_STATE_POSITION, w.x, &err));
    need(ris__sim_stage(w.sim, RIS_STAGE_NORMAL, NULL, &err));
    need(ris_sim_read(w.sim, RIS_STATE_NORMAL, w.value, &err));
    for (uint32_t i = 0; i < model->node_count; ++i) {
        assert_near(w.value[i].x, -model->rest_normal[i].y, 1e-6);
        assert_near(w.value[i].y, model->rest_normal[i].x, 1e-6);
    }
    close_world(&w);
}

/* anchor_shift moves free nodes by the anchors' change and leaves static ones and velocities alone. */
static void anchor_shift_moves_free_nodes(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{0, 0, 0}, {5, 0, 0}};
    const bool pinned[] = {false, true};
    ris_scene_net_def def = {
        .node_count = 2, .position = p, .pinned = pinned, .mass_g = 2, .tissue = law(true, 1)};
    world w = open_net(&def);
    const ris_anchor_point points[2] = {{{0, 0, 0, 0}, {0, 0, 1, 0}}, {{5, 0, 0, 0}, {0, 0, 1, 0}}};
    const ris_vec4 delta[2] = {{1, 2, 3, 0}, {1, 2, 3, 0}};
    const ris_anchor_frame anchors = {points, delta, NULL, NULL};
    need(ris__sim_stage(w.sim, RIS_STAGE_ANCHOR_SHIFT, &anchors, &err));
    need(ris_sim_read(w.sim, RIS_STATE_POSITION, w.value, &err));
    assert_true(w.value[0].x == 1.0f && w.value[0].y == 2.0f && w.value[0].z == 3.0f && w.value[0].w == 0.5f);
    assert_true(w.value[1].x == 5.0f && w.value[1].y == 0.0f && w.value[1].w == 0.0f);
    need(ris_sim_read(w.sim, RIS_STATE_VELOCITY_HALF, w.value, &err));
    assert_true(w.value[0].x == 0.0f);
    close_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(biphasic_spring),
        cmocka_unit_test(internal_forces_cancel),
        cmocka_unit_test(anchor_pair),
        cmocka_unit_test(normal_and_tangential_anchor),
        cmocka_unit_test(bending_is_the_gradient),
        cmocka_unit_test(a_fine_mesh_bends_no_more_readily),
        cmocka_unit_test(normals_of_a_sphere),
        cmocka_unit_test(anchor_shift_moves_free_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
