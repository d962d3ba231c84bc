/* The comparison behind `risorius compare`: agrees when it should, and finds every wrong thing it is fed.
 * The wrong things are a third backend that forwards to the CPU and spoils one stage of one tick. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "gpu/gpu.h"
#include "gpu/random_model.h"
#include "sim/compare.h"
#include "sim/sim_impl.h"

#define NODES 1234u
#define TICKS 12u
#define SUBSTEPS 8u

static ris_device *vk;
static ris_model *model;

/* Opens the jaw and closes it again. */
static void pose(void *user, uint32_t tick, float *out)
{
    const float *size = user;
    memset(out, 0, model->channel_count * sizeof *out);
    out[0] = *size * (tick < TICKS / 2 ? (float)tick : (float)(TICKS - tick)) / (float)(TICKS / 2);
}

/* ---- a backend that spoils ---- */

typedef struct spoiler {
    ris_sim *inner;
    ris_stage stage; /* spoiled stage */
    uint32_t at;     /* which run of it, from 0 */
    uint32_t run;    /* so many were made */
    uint32_t vertex;
    bool skip;   /* leave the stage out, else flip one bit of its output */
    bool always; /* flip in every run; leave out in run `at` of every pass, if skip */
} spoiler;

static void spoil_destroy(void *self)
{
    ris_sim_destroy(((spoiler *)self)->inner);
    free(self);
}

static ris_result spoil_stage(void *self, ris_stage stage, const ris_anchor_frame *anchors, ris_error *err)
{
    static const ris_state output[RIS_STAGE_COUNT] = {
        RIS_STATE_POSITION, RIS_STATE_BEND,     RIS_STATE_FORCE, RIS_STATE_POSITION,
        RIS_STATE_NORMAL,   RIS_STATE_POSITION, RIS_STATE_NORMAL};
    spoiler *s = self;
    ris_result result;
    ris_vec4 *value;
    uint32_t word;
    bool now;
    if (stage != s->stage) {
        return ris__sim_stage(s->inner, stage, anchors, err);
    }
    now = s->always ? s->run % (TICKS * SUBSTEPS) == s->at : s->run == s->at;
    s->run++;
    if (!now && !s->always) {
        return ris__sim_stage(s->inner, stage, anchors, err);
    }
    if (now && s->skip) {
        return RIS_OK;
    }
    result = ris__sim_stage(s->inner, stage, anchors, err);
    value = calloc(NODES, sizeof *value);
    if (result == RIS_OK && value) {
        result = ris_sim_read(s->inner, output[stage], value, err);
        memcpy(&word, &value[s->vertex].y, sizeof word);
        word ^= 1u;
        memcpy(&value[s->vertex].y, &word, sizeof word);
    }
    if (result == RIS_OK && value) {
        result = ris_sim_write(s->inner, output[stage], value, err);
    }
    free(value);
    return result;
}

static ris_result spoil_frame(void *self, const ris_anchor_frame *anchors, uint32_t substeps,
                              ris_sim_times *times, ris_error *err)
{
    uint8_t list[5 * SUBSTEPS + 2];
    ris_result result = RIS_OK;
    (void)times;
    const uint32_t count = ris__sim_stages(model, substeps, list);
    for (uint32_t k = 0; k < count && result == RIS_OK; k++) {
        result = spoil_stage(self, (ris_stage)list[k], k == 0 ? anchors : NULL, err);
    }
    return result;
}

static ris_result spoil_read(void *self, ris_state state, ris_vec4 *out, ris_error *err)
{
    return ris_sim_read(((spoiler *)self)->inner, state, out, err);
}

static ris_result spoil_write(void *self, ris_state state, const ris_vec4 *in, ris_error *err)
{
    return ris_sim_write(((spoiler *)self)->inner, state, in, err);
}

static const ris_sim_impl spoil_impl = {spoil_destroy, spoil_frame, spoil_stage, spoil_read, spoil_write};

static ris_sim *spoiled_sim(ris_stage stage, uint32_t at, uint32_t vertex, bool skip)
{
    ris_sim *sim = NULL;
    spoiler *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (spoiler){.stage = stage, .at = at, .vertex = vertex, .skip = skip};
    assert_int_equal(ris_sim_create_cpu(model, &s->inner, NULL), RIS_OK);
    assert_int_equal(ris__sim_create(model, &spoil_impl, s, "spoiled", &sim, NULL), RIS_OK);
    return sim;
}

/* ---- tests ---- */

static ris_result compare(ris_sim *a, ris_sim *b, float size, ris_compare_report *report, ris_error *err)
{
    ris_compare_def def = ris_default_compare_def(a, b);
    def.tick_count = TICKS;
    def.pose = pose;
    def.user = &size;
    return ris_compare_run(&def, report, err);
}

static ris_sim *cpu_sim(void)
{
    ris_sim *sim = NULL;
    assert_int_equal(ris_sim_create_cpu(model, &sim, NULL), RIS_OK);
    return sim;
}

static void cpu_and_device_agree(void **state)
{
    ris_sim *a = cpu_sim(), *b = NULL;
    ris_error err = {0};
    ris_compare_report report;
    (void)state;
    assert_int_equal(ris_sim_create_vk(model, vk, &b, &err), RIS_OK);
    if (compare(a, b, 1.0f, &report, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    assert_true(report.moved_count >= 500);
    assert_int_equal(report.tick_count, TICKS);
    if (test_gpu_is_lavapipe(vk)) {
        assert_true(report.hash[0] == report.hash[1]);
        assert_false(report.differs);
    }
    ris_sim_destroy(a);
    ris_sim_destroy(b);
}

static void one_flipped_bit_is_named(void **state)
{
    (void)state;
    for (int stage = 0; stage < RIS_STAGE_COUNT; stage++) {
        /* the second pass, tick 3: 8 runs a tick for substep stages, after TICKS ticks of the first pass;
         * the spoiler counts runs of both passes */
        const bool inner = stage >= RIS_STAGE_BEND && stage <= RIS_STAGE_CONTACT;
        const uint32_t a_tick = inner ? 8 : 1;
        ris_sim *a = cpu_sim(),
                *b = spoiled_sim((ris_stage)stage, TICKS * a_tick + 2 * a_tick + (inner ? 5 : 0), 777, false);
        ris_error err = {0};
        ris_compare_report report;
        ris_compare_def def = ris_default_compare_def(a, b);
        float size = 1.0f;
        def.step_tolerance_mm = def.clip_tolerance_mm = 0.0f;
        def.tick_count = TICKS;
        def.pose = pose;
        def.user = &size;
        assert_int_equal(ris_compare_run(&def, &report, &err), RIS_ERROR_FAILED);
        assert_true(report.differs);
        assert_int_equal(report.first_stage, stage);
        assert_int_equal(report.first_tick, 3);
        assert_int_equal(report.first_substep, inner ? 5 : 0);
        assert_int_equal(report.first_vertex, 777);
        ris_sim_destroy(a);
        ris_sim_destroy(b);
    }
}

static ris_result compare_spoiled(bool skip, float tolerance_mm, ris_compare_report *report, ris_error *err)
{
    float size = 1.0f;
    ris_sim *a = cpu_sim(), *b = NULL;
    ris_compare_def def;
    ris_result result;
    spoiler *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (spoiler){
        .stage = RIS_STAGE_VERLET, .at = 5 * SUBSTEPS + 3, .vertex = 777, .skip = skip, .always = true};
    assert_int_equal(ris_sim_create_cpu(model, &s->inner, NULL), RIS_OK);
    assert_int_equal(ris__sim_create(model, &spoil_impl, s, "spoiled", &b, NULL), RIS_OK);
    def = ris_default_compare_def(a, b);
    def.step_tolerance_mm = def.clip_tolerance_mm = tolerance_mm;
    def.tick_count = TICKS;
    def.pose = pose;
    def.user = &size;
    result = ris_compare_run(&def, report, err);
    ris_sim_destroy(a);
    ris_sim_destroy(b);
    return result;
}

/* Both passes of the comparison are wrong in the same way, so only the verdict can tell. */
static void the_verdict_follows_the_tolerance(void **state)
{
    ris_error err = {0};
    ris_compare_report report;
    (void)state;
    assert_int_equal(compare_spoiled(false, 0.0f, &report, &err), RIS_ERROR_FAILED);
    assert_non_null(strstr(err.text, "allowed 0 mm"));
    assert_non_null(strstr(err.text, "verlet, tick 1, substep 0, vertex 777"));
    if (compare_spoiled(false, 1e-2f, &report, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    assert_true(report.differs);
    assert_int_equal(report.first_tick, 1);
}

/* Bits differ from the first substep on, but what is named is the place that is over tolerance. */
static void the_place_over_tolerance_is_named(void **state)
{
    ris_error err = {0};
    ris_compare_report report;
    (void)state;
    assert_int_equal(compare_spoiled(true, 1e-3f, &report, &err), RIS_ERROR_FAILED);
    assert_non_null(strstr(err.text, "verlet, tick 6, substep 3, "));
    assert_int_equal(report.first_stage, RIS_STAGE_VERLET);
    assert_int_equal(report.first_tick, 6);
    assert_int_equal(report.first_substep, 3);
}

/* Also with the tolerance of real devices. Left out in tick 10 of the first pass only: whole ticks and
 * stages disagree. */
static void a_skipped_stage_fails(void **state)
{
    (void)state;
    for (int stage = RIS_STAGE_ANCHOR_SHIFT; stage <= RIS_STAGE_VERLET; stage++) {
        ris_sim *a = cpu_sim(),
                *b = spoiled_sim((ris_stage)stage, stage == RIS_STAGE_ANCHOR_SHIFT ? 9 : 75, 0, true);
        ris_error err = {0};
        ris_compare_report report;
        assert_int_equal(compare(a, b, 1.0f, &report, &err), RIS_ERROR_FAILED);
        assert_true(report.differing_ticks > 0);
        ris_sim_destroy(a);
        ris_sim_destroy(b);
    }
}

static void a_device_is_not_compared_with_itself(void **state)
{
    ris_sim *a = cpu_sim(), *b = cpu_sim();
    ris_error err = {0};
    ris_compare_report report;
    (void)state;
    assert_int_equal(compare(a, b, 1.0f, &report, &err), RIS_ERROR_USAGE);
    assert_int_equal(compare(a, a, 1.0f, &report, &err), RIS_ERROR_USAGE);
    ris_sim_destroy(a);
    ris_sim_destroy(b);
}

/* The random model moves by itself, so the bar is put above what it can move. */
static void a_clip_that_moves_too_little_is_refused(void **state)
{
    ris_sim *a = cpu_sim(), *b = NULL;
    ris_error err = {0};
    ris_compare_report report;
    float size = 1.0f;
    ris_compare_def def;
    (void)state;
    assert_int_equal(ris_sim_create_vk(model, vk, &b, &err), RIS_OK);
    def = ris_default_compare_def(a, b);
    assert_int_equal(def.moved_minimum, 500);
    def.tick_count = 5;
    def.pose = pose;
    def.user = &size;
    def.moved_minimum = model->moving_count + 1;
    assert_int_equal(ris_compare_run(&def, &report, &err), RIS_ERROR_FAILED);
    assert_non_null(strstr(err.text, "2 mm"));
    assert_true(report.moved_count < def.moved_minimum);
    ris_sim_destroy(a);
    ris_sim_destroy(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cpu_and_device_agree),
        cmocka_unit_test(one_flipped_bit_is_named),
        cmocka_unit_test(the_verdict_follows_the_tolerance),
        cmocka_unit_test(the_place_over_tolerance_is_named),
        cmocka_unit_test(a_skipped_stage_fails),
        cmocka_unit_test(a_device_is_not_compared_with_itself),
        cmocka_unit_test(a_clip_that_moves_too_little_is_refused),
    };
    int failed;
    test_gpu_small();
    vk = test_gpu_open();
    model = random_model_create(NODES, RIS_TISSUE_FLAG_CONTINUOUS, 4242);
    failed = model ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
    random_model_free(model);
    ris_device_destroy(vk);
    return failed;
}
