/* Every device stage against its CPU twin: alone on random inputs, then whole ticks. On lavapipe not one
 * bit may differ; on other devices 1e-4 mm (forces as what they move a node by in a substep). Then the
 * controls: each comparator here is fed a wrong input and must fail. With RIS_STAGING=1 the same runs as
 * on a device whose memory the host cannot reach. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu/gpu.h"
#include "gpu/random_model.h"
#include "sim/sim_impl.h"
#include "sim/vk/vk_sim.h"

#define TOLERANCE_MM 1e-4
#define STEP_TICKS 10

static ris_device *vk;
static bool exact;
static const uint32_t sizes[] = {1, 63, 64, 65, 1234};
static const uint32_t tissues[] = {RIS_TISSUE_FLAG_CONTINUOUS, 0,
                                   RIS_TISSUE_FLAG_KAEHLER | RIS_TISSUE_FLAG_CONTINUOUS,
                                   RIS_TISSUE_FLAG_KAEHLER};

/* One model on both sides, and what was read of them last. */
typedef struct pair {
    const ris_model *model;
    ris_sim *cpu, *gpu;
    ris_vec4 *a, *b;
    ris_anchor_point *point;
    ris_vec4 *delta;
    ris_contact_body body[RIS_CONTACT_BODIES];
    ris_inertia inertia;
} pair;

static void pair_open(pair *p, const ris_model *model)
{
    ris_error err = {0};
    const size_t n = model->node_count;
    p->model = model;
    p->a = calloc(n, sizeof *p->a);
    p->b = calloc(n, sizeof *p->b);
    p->point = calloc(n, sizeof *p->point);
    p->delta = calloc(n, sizeof *p->delta);
    assert_true(p->a && p->b && p->point && p->delta);
    if (ris_sim_create_cpu(model, &p->cpu, &err) != RIS_OK ||
        ris_sim_create_vk(model, vk, &p->gpu, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static void pair_close(pair *p)
{
    ris_sim_destroy(p->cpu);
    ris_sim_destroy(p->gpu);
    free(p->a);
    free(p->b);
    free(p->point);
    free(p->delta);
}

/* Random state near rest on both sides, and random anchors in p. */
static void randomize(pair *p, uint32_t seed)
{
    static const float size[RIS_STATE_COUNT] = {3.0f, 200.0f, 200.0f, 5000.0f, 2.0f, 1.0f, 3.0f};
    const uint32_t n = p->model->node_count;
    for (int s = 0; s < RIS_STATE_COUNT; s++) {
        for (uint32_t i = 0; i < n; i++) {
            p->a[i] = random_vec(&seed, size[s], 0.0f);
            if (s == RIS_STATE_POSITION || s == RIS_STATE_FREE) {
                p->a[i].x += p->model->rest_position[i].x;
                p->a[i].y += p->model->rest_position[i].y;
                p->a[i].z += p->model->rest_position[i].z;
                p->a[i].w = p->model->rest_position[i].w;
            }
        }
        if (s == RIS_STATE_POSITION && n > 8) {
            p->a[n / 2] = p->a[n / 3]; /* two nodes in one place: springs without a direction */
            p->a[n / 2].w = p->model->rest_position[n / 2].w;
        }
        assert_int_equal(ris_sim_write(p->cpu, (ris_state)s, p->a, NULL), RIS_OK);
        assert_int_equal(ris_sim_write(p->gpu, (ris_state)s, p->a, NULL), RIS_OK);
    }
    for (uint32_t i = 0; i < n; i++) {
        ris_vec4 rest = p->model->rest_position[i], shift = random_vec(&seed, 4.0f, 0.0f);
        p->point[i].a = (ris_vec4){rest.x + shift.x, rest.y + shift.y, rest.z + shift.z, 0.0f};
        p->point[i].b = p->model->push.flags & RIS_TISSUE_FLAG_KAEHLER
                            ? (ris_vec4){rest.x - shift.x, rest.y - shift.y, rest.z - shift.z, 0.0f}
                            : p->model->rest_normal[i];
        p->delta[i] = random_vec(&seed, 0.5f, 0.0f);
    }
    p->inertia.row_x = random_vec(&seed, 80.0f, random_between(&seed, -5000.0f, 5000.0f));
    p->inertia.row_y = random_vec(&seed, 80.0f, random_between(&seed, -5000.0f, 5000.0f));
    p->inertia.row_z = random_vec(&seed, 80.0f, random_between(&seed, -5000.0f, 5000.0f));
    for (uint32_t k = 0; k < p->model->contact_solid_count; k++) {
        const ris_contact_solid *solid = &p->model->contact_solid[k];
        p->body[k] =
            (ris_contact_body){.row_x = {0.96f, -0.28f, 0.0f, random_between(&seed, -4.0f, 4.0f)},
                               .row_y = {0.28f, 0.96f, 0.0f, 1.5f},
                               .row_z = {0.0f, 0.0f, 1.0f, -2.0f},
                               .low = {solid->low.x, solid->low.y, solid->low.z, 1.0f / solid->cell_mm},
                               .count_x = solid->count[0],
                               .count_y = solid->count[1],
                               .count_z = solid->count[2],
                               .first = solid->first};
    }
}

/* First node of a and b that differs (too much), or count; NaN on one side only always differs. unit_mm is
 * what one unit of the value is worth in mm at node i, w gives forces their own. */
static uint32_t first_difference(const pair *p, ris_state state, bool bits)
{
    const double dt = (double)p->model->push.dt_s;
    for (uint32_t i = 0; i < p->model->node_count; i++) {
        const ris_vec4 a = p->a[i], b = p->b[i];
        const double unit = state == RIS_STATE_FORCE ? (double)p->model->rest_position[i].w * dt * dt
                            : state == RIS_STATE_VELOCITY_HALF ? dt
                            : state == RIS_STATE_VELOCITY_PREV ? dt
                                                               : 1.0;
        const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y,
                     z = (double)a.z - (double)b.z;
        if (bits ? memcmp(&a, &b, sizeof a) != 0 : !(sqrt(x * x + y * y + z * z) * unit <= TOLERANCE_MM)) {
            return i;
        }
    }
    return p->model->node_count;
}

static uint32_t read_and_compare(pair *p, ris_state state)
{
    assert_int_equal(ris_sim_read(p->cpu, state, p->a, NULL), RIS_OK);
    assert_int_equal(ris_sim_read(p->gpu, state, p->b, NULL), RIS_OK);
    return first_difference(p, state, exact);
}

/* All states, those the stage must leave alone too. */
static void check_all(pair *p, const char *what)
{
    ris_error err = {0};
    for (int s = 0; s < RIS_STATE_COUNT; s++) {
        const uint32_t i = read_and_compare(p, (ris_state)s);
        if (i < p->model->node_count) {
            fail_msg("%s, %u nodes, flags %u: %s of node %u is (%.9g %.9g %.9g %.9g) on the CPU, (%.9g %.9g "
                     "%.9g %.9g) on %s",
                     what, p->model->node_count, p->model->push.flags, ris_state_name((ris_state)s), i,
                     (double)p->a[i].x, (double)p->a[i].y, (double)p->a[i].z, (double)p->a[i].w,
                     (double)p->b[i].x, (double)p->b[i].y, (double)p->b[i].z, (double)p->b[i].w,
                     ris_sim_backend(p->gpu));
        }
    }
    if (ris__vk_sim_check_guards(p->gpu, &err) != RIS_OK) {
        fail_msg("%s, %u nodes: %s", what, p->model->node_count, err.text);
    }
}

static void run_stage(pair *p, ris_stage stage)
{
    const ris_anchor_frame anchors = {p->point, p->delta, p->body, &p->inertia};
    assert_int_equal(ris__sim_stage(p->cpu, stage, &anchors, NULL), RIS_OK);
    assert_int_equal(ris__sim_stage(p->gpu, stage, &anchors, NULL), RIS_OK);
}

static void check_stages(const ris_model *model, uint32_t seed)
{
    pair p = {0};
    pair_open(&p, model);
    for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
        randomize(&p, seed + (uint32_t)stage);
        run_stage(&p, (ris_stage)stage);
        check_all(&p, ris_stage_name((ris_stage)stage));
    }
    pair_close(&p);
}

/* Whole ticks through the recorded frame, with poses from random channel values. */
static void check_ticks(const ris_model *model, uint32_t ticks, uint32_t seed)
{
    pair p = {0};
    float *pose = calloc(model->channel_count, sizeof *pose);
    ris_error err = {0};
    char what[32];
    assert_non_null(pose);
    pair_open(&p, model);
    for (uint32_t t = 1; t <= ticks; t++) {
        for (uint32_t c = 0; c < model->channel_count; c++) {
            float value = random_unit(&seed);
            pose[c] = model->channel[c].minimum +
                      value * value * (model->channel[c].maximum - model->channel[c].minimum);
        }
        if (ris_sim_tick(p.cpu, pose, &err) != RIS_OK || ris_sim_tick(p.gpu, pose, &err) != RIS_OK) {
            fail_msg("tick %u of %u nodes: %s", t, model->node_count, err.text);
        }
        snprintf(what, sizeof what, "tick %u", t);
        check_all(&p, what);
    }
    free(pose);
    pair_close(&p);
}

static void stages_match_on_random_models(void **state)
{
    (void)state;
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        for (size_t t = 0; t < sizeof tissues / sizeof tissues[0]; t++) {
            const uint32_t seed = 1000u + 17u * (uint32_t)(s * 8 + t);
            ris_model *model = random_model_create(sizes[s], tissues[t], seed);
            assert_non_null(model);
            check_stages(model, seed);
            check_ticks(model, STEP_TICKS, seed);
            random_model_free(model);
        }
    }
}

static void stages_match_on_the_human_head(void **state)
{
    ris_model *model = NULL;
    ris_error err = {0};
    (void)state;
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    check_stages(model, 77);
    check_ticks(model, STEP_TICKS, 78);
    ris_model_destroy(model);
}

/* Two device simulations of one model, the second without timestamps, go the same way. */
static void the_device_repeats_itself(void **state)
{
    ris_model *model = random_model_create(1234, RIS_TISSUE_FLAG_CONTINUOUS, 5);
    ris_sim *sim[2];
    uint64_t hash[2];
    float *pose;
    (void)state;
    assert_non_null(model);
    pose = calloc(model->channel_count, sizeof *pose);
    assert_non_null(pose);
    pose[0] = 0.7f;
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ris_sim_create_vk(model, vk, &sim[k], NULL), RIS_OK);
        ris_vk_sim_set_timestamps(sim[k], k == 0);
        for (int t = 0; t < 20; t++) {
            assert_int_equal(ris_sim_tick(sim[k], pose, NULL), RIS_OK);
        }
        assert_int_equal(ris_sim_hash(sim[k], &hash[k], NULL), RIS_OK);
    }
    assert_true(hash[0] == hash[1]);
    assert_true(ris_sim_get_times(sim[0])->wait_ms > 0.0);
    assert_true(ris_sim_get_times(sim[1])->stage_ms[RIS_STAGE_VERLET] == 0.0);
    ris_sim_destroy(sim[0]);
    ris_sim_destroy(sim[1]);
    free(pose);
    random_model_free(model);
}

/* ---- controls: what must be found ---- */

static ris_state output_of(ris_stage stage)
{
    static const ris_state output[RIS_STAGE_COUNT] = {
        RIS_STATE_POSITION, RIS_STATE_BEND,     RIS_STATE_FORCE, RIS_STATE_POSITION,
        RIS_STATE_NORMAL,   RIS_STATE_POSITION, RIS_STATE_NORMAL};
    return output[stage];
}

static void a_stage_left_out_is_found(void **state)
{
    ris_model *model = random_model_create(65, RIS_TISSUE_FLAG_CONTINUOUS, 9);
    pair p = {0};
    (void)state;
    assert_non_null(model);
    pair_open(&p, model);
    for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
        const ris_anchor_frame anchors = {p.point, p.delta, p.body, &p.inertia};
        randomize(&p, 90 + (uint32_t)stage);
        assert_int_equal(ris__sim_stage(p.cpu, (ris_stage)stage, &anchors, NULL), RIS_OK);
        assert_true(read_and_compare(&p, output_of((ris_stage)stage)) < 65);
    }
    pair_close(&p);
    random_model_free(model);
}

static void a_flipped_bit_is_found(void **state)
{
    ris_model *model = random_model_create(65, RIS_TISSUE_FLAG_CONTINUOUS, 10);
    pair p = {0};
    (void)state;
    assert_non_null(model);
    pair_open(&p, model);
    for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
        const ris_state output = output_of((ris_stage)stage);
        uint32_t word;
        randomize(&p, 100 + (uint32_t)stage);
        run_stage(&p, (ris_stage)stage);
        assert_int_equal(read_and_compare(&p, output), 65);
        memcpy(&word, &p.b[41].y, sizeof word);
        word ^= 1u; /* the smallest change there is */
        memcpy(&p.b[41].y, &word, sizeof word);
        assert_int_equal(first_difference(&p, output, true), 41);
        p.b[41].y = p.a[41].y + 1e6f;
        assert_int_equal(first_difference(&p, output, false), 41);
        p.b[41].y = NAN;
        assert_int_equal(first_difference(&p, output, false), 41);
    }
    pair_close(&p);
    random_model_free(model);
}

static void a_swapped_buffer_is_found(void **state)
{
    static const uint32_t swap[RIS_STAGE_COUNT][2] = {
        {RIS_BIND_ANCHOR_DELTA, RIS_BIND_BEND}, {RIS_BIND_POSITION, RIS_BIND_REST},
        {RIS_BIND_POSITION, RIS_BIND_REST},     {RIS_BIND_VELOCITY_HALF, RIS_BIND_VELOCITY_PREV},
        {RIS_BIND_FREE, RIS_BIND_REST},         {RIS_BIND_FREE, RIS_BIND_REST},
        {RIS_BIND_POSITION, RIS_BIND_REST}};
    ris_model *model = random_model_create(65, RIS_TISSUE_FLAG_CONTINUOUS, 11);
    pair p = {0};
    (void)state;
    assert_non_null(model);
    pair_open(&p, model);
    for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
        randomize(&p, 110 + (uint32_t)stage);
        assert_int_equal(ris__vk_sim_swap_bindings(p.gpu, swap[stage][0], swap[stage][1], NULL), RIS_OK);
        run_stage(&p, (ris_stage)stage);
        assert_true(read_and_compare(&p, output_of((ris_stage)stage)) < 65);
        assert_int_equal(ris__vk_sim_swap_bindings(p.gpu, swap[stage][0], swap[stage][0], NULL), RIS_OK);
        assert_int_equal(ris__vk_sim_swap_bindings(p.gpu, swap[stage][1], swap[stage][1], NULL), RIS_OK);
    }
    pair_close(&p);
    random_model_free(model);
}

static void a_write_past_the_end_is_found(void **state)
{
    ris_model *model = random_model_create(63, RIS_TISSUE_FLAG_CONTINUOUS, 12);
    pair p = {0};
    ris_error err = {0};
    (void)state;
    assert_non_null(model);
    pair_open(&p, model);
    for (uint32_t b = 0; b < RIS_BIND_COUNT; b++) {
        assert_int_equal(ris__vk_sim_check_guards(p.gpu, &err), RIS_OK);
        assert_int_equal(ris__vk_sim_spoil_guard(p.gpu, b, 0, &err), RIS_OK);
        assert_int_equal(ris__vk_sim_check_guards(p.gpu, &err), RIS_ERROR_FAILED);
        assert_non_null(strstr(err.text, "binding"));
        assert_int_equal(ris__vk_sim_spoil_guard(p.gpu, b, RIS__VK_SENTINEL, &err), RIS_OK);
    }
    pair_close(&p);
    random_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_match_on_random_models), cmocka_unit_test(stages_match_on_the_human_head),
        cmocka_unit_test(the_device_repeats_itself),     cmocka_unit_test(a_stage_left_out_is_found),
        cmocka_unit_test(a_flipped_bit_is_found),        cmocka_unit_test(a_swapped_buffer_is_found),
        cmocka_unit_test(a_write_past_the_end_is_found),
    };
    int failed;
    test_gpu_small();
    vk = test_gpu_open();
    exact = test_gpu_is_lavapipe(vk);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    ris_device_destroy(vk);
    return failed;
}
