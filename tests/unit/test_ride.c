/* engine/sim/ride.c (KA-06): nearest points, frames, and parts that follow bones and skin. */
#include "scratch.h"

#include "risorius/sim.h"
#include "scenes/scenes.h"
#include "sim/ride.h"

#include <math.h>

static float distance(ris_vec3 a, ris_vec3 b)
{
    return sqrtf((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* One point in each of the seven regions around the triangle (0,0,0) (4,0,0) (0,4,0). */
static void test_nearest(void **state)
{
    (void)state;
    static const struct {
        ris_vec3 p;
        float share[3], d2;
    } know[] = {
        {{1, 1, 3}, {0.5f, 0.25f, 0.25f}, 9}, {{-1, -1, 0}, {1, 0, 0}, 2},
        {{6, -1, 0}, {0, 1, 0}, 5},           {{-1, 6, 0}, {0, 0, 1}, 5},
        {{2, -3, 0}, {0.5f, 0.5f, 0}, 9},     {{-2, 1, 0}, {0.75f, 0, 0.25f}, 4},
        {{4, 4, 1}, {0, 0.5f, 0.5f}, 9},
    };
    const ris_vec3 a = {0, 0, 0}, b = {4, 0, 0}, c = {0, 4, 0};
    for (size_t i = 0; i < sizeof know / sizeof know[0]; i++) {
        float share[3];
        assert_true(fabsf(ris__ride_nearest(know[i].p, a, b, c, share) - know[i].d2) < 1e-5f);
        for (int k = 0; k < 3; k++) {
            assert_true(fabsf(share[k] - know[i].share[k]) < 1e-6f);
        }
    }
}

static void test_frame(void **state)
{
    (void)state;
    ris_vec3 frame[3];
    assert_true(ris__ride_frame((ris_vec3){1, 1, 1}, (ris_vec3){1, 5, 1}, (ris_vec3){1, 1, 3}, frame));
    assert_true(distance(frame[0], (ris_vec3){0, 1, 0}) < 1e-6f);
    assert_true(distance(frame[1], (ris_vec3){0, 0, 1}) < 1e-6f);
    assert_true(distance(frame[2], (ris_vec3){1, 0, 0}) < 1e-6f);
    assert_false(ris__ride_frame((ris_vec3){0, 0, 0}, (ris_vec3){1, 1, 1}, (ris_vec3){2, 2, 2}, frame));
}

/* The share of the way, at the length of the strand; all of it for what rides on any other skin. */
static void test_turn(void **state)
{
    (void)state;
    const ris_vec3 still = {0, -3, 4}, turned = {0, 3, 4};
    assert_true(distance(ris__ride_turn(still, turned, 1), turned) == 0);
    assert_true(distance(ris__ride_turn(still, turned, 0), still) < 1e-6f);
    assert_true(distance(ris__ride_turn(still, turned, 0.5f), (ris_vec3){0, 0, 5}) < 1e-6f);
    const ris_vec3 third = ris__ride_turn(still, turned, 0.3f);
    assert_true(fabsf(sqrtf(third.y * third.y + third.z * third.z) - 5) < 1e-5f && third.y < 0);
    assert_true(distance(ris__ride_turn(still, (ris_vec3){0, 3, -4}, 0.5f), (ris_vec3){0, 3, -4}) == 0);
}

/* The search along x finds the same distance as trying every triangle. */
static void test_bind(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_model *model = NULL;
    const ris_scene_def def = ris_default_scene_def();
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    enum { COUNT = 60 };
    ris_vec3 point[COUNT];
    uint32_t seed = 7, face_start[2] = {0, 0};
    for (int i = 0; i < COUNT; i++) {
        float r[4];
        for (int k = 0; k < 4; k++) {
            seed = seed * 1664525u + 1013904223u;
            r[k] = (float)(seed >> 8) / 16777216.0f;
        }
        ris_vec4 near = model->rest_position[(uint32_t)(r[3] * (float)(model->node_count - 1))];
        point[i] = (ris_vec3){near.x + 8 * r[0] - 4, near.y + 8 * r[1] - 4, near.z + 8 * r[2] - 4};
    }
    const ris_mesh mesh = {.vertex_count = COUNT, .position = point, .face_start = face_start};
    ris_ride ride[COUNT];
    assert_int_equal(ris__ride_bind(model, &mesh, ride, NULL, &err), RIS_OK);
    ris_vec4 *shifted = malloc(model->node_count * sizeof *shifted);
    assert_non_null(shifted);
    for (uint32_t i = 0; i < model->node_count; i++) { /* a quarter turn about y, then a shift */
        ris_vec4 p = model->rest_position[i];
        shifted[i] = (ris_vec4){p.z + 3, p.y - 2, -p.x, p.w};
    }
    for (int i = 0; i < COUNT; i++) {
        float best = 1e30f, share[3];
        for (uint32_t t = 0; t < model->triangle_count; t++) {
            ris_vec4 q[3];
            for (int k = 0; k < 3; k++) {
                q[k] = model->rest_position[model->triangle[3 * t + (uint32_t)k]];
            }
            best = fminf(best, ris__ride_nearest(point[i], (ris_vec3){q[0].x, q[0].y, q[0].z},
                                                 (ris_vec3){q[1].x, q[1].y, q[1].z},
                                                 (ris_vec3){q[2].x, q[2].y, q[2].z}, share));
        }
        ris_vec3 o = ride[i].offset;
        assert_true(fabsf(sqrtf(best) - sqrtf(o.x * o.x + o.y * o.y + o.z * o.z)) < 1e-3f);
        assert_true(distance(ris__ride_place(&ride[i], model->rest_position), point[i]) < 1e-3f);
        ris_vec3 turned = {point[i].z + 3, point[i].y - 2, -point[i].x};
        assert_true(distance(ris__ride_place(&ride[i], shifted), turned) < 2e-3f);
        assert_true(distance(ris__ride_place(&ride[i], shifted), point[i]) > 0.5f); /* it did move */
    }
    free(shifted);
    ris_model_destroy(model);
}

/* Parts of the reference head: at rest where their files say; jaw parts follow the jaw, skull parts stay. */
static void test_parts(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_model *model = NULL;
    ris_sim *sim = NULL;
    assert_int_equal(ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err), RIS_OK);
    assert_int_equal(ris_sim_create_cpu(model, &sim, &err), RIS_OK);
    float *pose = calloc(model->channel_count, sizeof *pose);
    ris_vec4 *position = malloc(model->node_count * sizeof *position);
    assert_true(pose && position);
    assert_int_equal(ris_sim_part(sim, model->head->part_count, model->rest_position, position, &err),
                     RIS_ERROR_USAGE);
    for (int turn = 0; turn < 2; turn++) {
        assert_int_equal(ris_sim_read(sim, RIS_STATE_POSITION, position, &err), RIS_OK);
        for (uint32_t i = 0; i < model->head->part_count; i++) {
            const ris_part_def *part = &model->head->part[i];
            float most = 0;
            if (turn == 1 && part->bone == RIS_BONE_SKIN) {
                continue; /* binding them is slow in a sanitizer build, and once is enough */
            }
            ris_vec4 *at = malloc(part->mesh.vertex_count * sizeof *at);
            assert_non_null(at);
            assert_int_equal(ris_sim_part(sim, i, position, at, &err), RIS_OK);
            for (uint32_t v = 0; v < part->mesh.vertex_count; v++) {
                most = fmaxf(most, distance((ris_vec3){at[v].x, at[v].y, at[v].z}, part->mesh.position[v]));
            }
            bool moves = turn == 1 && part->bone == RIS_BONE_JAW;
            assert_true(part->bone == RIS_BONE_SKIN ? most < 1e-3f : moves ? most > 10.0f : most < 1e-3f);
            free(at);
        }
        pose[ris_model_channel(model, "jaw.open")] = 1.0f;
        for (int tick = 0; tick < 30; tick++) {
            assert_int_equal(ris_sim_tick(sim, pose, &err), RIS_OK);
        }
    }
    free(pose);
    free(position);
    ris_sim_destroy(sim);
    ris_model_destroy(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearest), cmocka_unit_test(test_frame), cmocka_unit_test(test_turn),
        cmocka_unit_test(test_bind),    cmocka_unit_test(test_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
