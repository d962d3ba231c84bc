/* The muscles that move the jaw (KA-45, KA-46 and beyond): from bone to bone, each does to the jaw what anatomy says, and
 * swells under the skin when it clenches. Measured on the reference head. */
#include "model/vec3.h"
#include "query/query.h"
#include "risorius/timeline.h"
#include "sim/rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"

static const char *const names[] = {
    "masseter",    "temporalis", "temporalis_posterior", "pterygoideus_medialis", "pterygoideus_lateralis",
    "mylohyoideus"};
enum { NAMES = sizeof names / sizeof *names };

static ris_model *model;
static ris_rig rig;
static float *pose;
static tri_mesh bone[2]; /* skull, mandible */
static bvh tree[2];

static int load(void **state)
{
    (void)state;
    ris_error err = {0};
    bool ok = ris_model_load(HUMAN, &model, &err) == RIS_OK && ris__rig_init(&rig, model, &err) == RIS_OK;
    const ris_mesh *const source[2] = {ok ? &model->head->skull : NULL, ok ? &model->head->mandible : NULL};
    for (int k = 0; k < 2 && ok; k++)
        ok = ris__tri_from_mesh(source[k], "a bone", &bone[k], &err) == RIS_OK &&
             ris__bvh_build(&tree[k], &bone[k], &err) == RIS_OK;
    pose = ok ? calloc(model->channel_count, sizeof *pose) : NULL;
    if (!pose)
        print_error("%s\n", err.text);
    return pose ? 0 : -1;
}

static int unload(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        ris__bvh_finish(&tree[k]);
        ris__tri_finish(&bone[k]);
    }
    ris__rig_finish(&rig);
    ris_model_destroy(model);
    free(pose);
    return 0;
}

static uint32_t find_muscle(const char *name, const char *side)
{
    char full[RIS_NAME_SIZE];
    snprintf(full, sizeof full, "%s%s", name, side);
    const uint32_t m = ris_model_channel(model, full);
    assert_true(m < model->muscle_count);
    return m;
}

static void take(const char *text)
{
    ris_error err = {0};
    memset(pose, 0, model->channel_count * sizeof *pose);
    if (text[0] && ris_pose_parse(model, text, pose, &err) != RIS_OK)
        fail_msg("%s", err.text);
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    ris__muscle_relax(&rig);
    ris__muscle_bulge(&rig);
    ris__muscle_attach(&rig);
}

/* How a pose moves the edge of the lower incisors, mm. */
static ris_vec3 chin(const char *text)
{
    take(text);
    return v3_sub(ris__rigid_apply(&rig.jaw, model->head->jaw.incisor), model->head->jaw.incisor);
}

static void records_are_whole(void **state)
{
    (void)state;
    for (int k = 0; k < NAMES; k++) {
        const ris_muscle_def *l = model->muscle[find_muscle(names[k], ".L")].def,
                             *r = model->muscle[find_muscle(names[k], ".R")].def;
        assert_true(l->end_bone == RIS_BONE_JAW && r->end_bone == RIS_BONE_JAW);
        assert_true(l->origin[0] && l->insertion[0] && l->source[0]);
        assert_true(l->drives[0] == r->drives[0] && l->drives[1] == r->drives[1] &&
                    l->drives[2] == -r->drives[2]);
        assert_true(l->drives[0] != 0 || l->drives[1] != 0);
    }
}

static void each_does_its_work(void **state)
{
    (void)state;
    const ris_vec3 open = chin("jaw.open=1"), ahead = chin("jaw.forward=1");
    const ris_vec3 protruded = chin("pterygoideus_lateralis=1"), left = chin("pterygoideus_lateralis.R=1"),
                   right = chin("pterygoideus_lateralis.L=1");
    print_message("lateral pterygoids: both %.1f %.1f %.1f, right alone %.1f %.1f %.1f\n",
                  (double)protruded.x, (double)protruded.y, (double)protruded.z, (double)left.x,
                  (double)left.y, (double)left.z);
    assert_true(protruded.z > 2 && protruded.y < -5 && protruded.x == 0); /* forward and open */
    assert_true(left.x > 4 && left.z > 0);                                /* one alone: to the other side */
    assert_true(right.x == -left.x && right.y == left.y && right.z == left.z);
    static const char *const close[] = {"masseter", "temporalis", "pterygoideus_medialis"};
    for (int k = 0; k < 3; k++) {
        char text[96], one[96];
        snprintf(text, sizeof text, "jaw.open=1,%s=1", close[k]);
        snprintf(one, sizeof one, "jaw.open=1,%s.L=1", close[k]);
        const ris_vec3 both = chin(text), single = chin(one);
        print_message("%s against an open jaw: %.1f mm of %.1f left, one side %.1f\n", close[k],
                      -(double)both.y, -(double)open.y, -(double)single.y);
        assert_true(both.y > 0.25f * open.y && single.y > open.y + 5 && single.y < both.y);
    }
    const ris_vec3 back = chin("jaw.forward=1,temporalis_posterior=1"),
                   retruded = chin("temporalis_posterior=1");
    assert_true(ahead.z > 6 && back.z < 0.5f && retruded.z < -0.3f);
    assert_true(chin("temporalis_posterior.L=1").x > 0.5f); /* to its own side */
    assert_true(chin("pterygoideus_medialis.L=1").x < -0.5f);
    assert_true(chin("mylohyoideus=1").y < -5);
    const ris_vec3 shut = chin("masseter=1,temporalis=1,pterygoideus_medialis=1"); /* teeth stop them */
    assert_true(fabsf(shut.y) < 1.5f);
    assert_true(chin("jaw.open=1,mylohyoideus=1,pterygoideus_lateralis=1").y > -60); /* clamped at 1 */
    const ris_vec3 clamped = chin("jaw.forward=1,pterygoideus_lateralis=1,masseter=1");
    assert_true(fabsf(clamped.z - ahead.z) < 0.5f);
}

/* Ends lie on their bones and go with them; the belly is stretched between them. */
static void they_hang_between_bones(void **state)
{
    (void)state;
    ris_vec3 *point = calloc(model->fiber_point_count, sizeof *point);
    ris_segment *segment = calloc(model->segment_count, sizeof *segment);
    take("jaw.open=1");
    ris__muscle_shape(&rig, point, segment);
    for (int k = 0; k < NAMES; k++)
        for (int side = 0; side < 2; side++) {
            const uint32_t m = find_muscle(names[k], side ? ".R" : ".L");
            const ris_muscle *muscle = &model->muscle[m];
            double far[2] = {0}, rest = 0, now = 0;
            for (uint32_t f = 0; f < muscle->fiber_count; f++) {
                const uint32_t first = model->fiber[muscle->first_fiber + f].first_point,
                               last = first + muscle->point_count - 1;
                const ris_vec3 a = model->fiber_point[first], b = model->fiber_point[last];
                far[0] = fmax(far[0], ris__bvh_closest(&tree[muscle->on_jaw], dv(a.x, a.y, a.z)).distance);
                far[1] = fmax(far[1], ris__bvh_closest(&tree[1], dv(b.x, b.y, b.z)).distance);
                const ris_vec3 turned = ris__rigid_apply(&rig.jaw, b);
                assert_true(v3_distance(point[last], turned) < 1e-4f);
                assert_true(v3_distance(point[first], muscle->on_jaw ? ris__rigid_apply(&rig.jaw, a) : a) <
                            1e-4f);
                for (uint32_t i = first; i < last; i++) {
                    rest += (double)v3_distance(model->fiber_point[i], model->fiber_point[i + 1]);
                    now += (double)v3_distance(point[i], point[i + 1]);
                }
            }
            print_message("%s: ends %.1f and %.1f mm from bone, length x %.2f with the jaw open\n",
                          muscle->name, far[0], far[1], now / rest);
            assert_true(far[0] < 6 && (far[1] < 6 || strcmp(names[k], "mylohyoideus") == 0));
            if (strcmp(names[k], "masseter") == 0)
                assert_true(now / rest > 1.2);
            if (muscle->on_jaw)
                assert_true(fabs(now / rest - 1) < 1e-4);
        }
    free(point);
    free(segment);
}

/* Largest way out of the skin's target in a box on the left side, and its mirror image on the right. */
static double swelling(ris_vec3 low, ris_vec3 high, double *out_elsewhere)
{
    double most = 0;
    *out_elsewhere = 0;
    for (uint32_t i = 0; i < model->node_count; i++) {
        const ris_vec3 x = v4_xyz(model->rest_position[i]);
        const double d = (double)v3_dot(v3_sub(rig.target[i], x), v4_xyz(model->rest_normal[i]));
        const float side = fabsf(x.x);
        if (side > low.x && side < high.x && x.y > low.y && x.y < high.y && x.z > low.z && x.z < high.z)
            most = fmax(most, d);
        else
            *out_elsewhere = fmax(*out_elsewhere, fabs(d));
    }
    return most;
}

static void clenching_shows(void **state)
{
    (void)state;
    double elsewhere;
    take("masseter=1");
    const double masseter = swelling(v3(30, -75, 10), v3(80, 5, 65), &elsewhere);
    print_message("masseter swells %.2f mm, elsewhere %.2f\n", masseter, elsewhere);
    assert_true(masseter > 1 && masseter < 2.5 && elsewhere < 0.5);
    take("temporalis=1");
    const double temporalis = swelling(v3(40, -5, -5), v3(85, 75, 70), &elsewhere);
    print_message("temporalis swells %.2f mm, elsewhere %.2f\n", temporalis, elsewhere);
    assert_true(temporalis > 1 && temporalis < 2.5 && elsewhere < 0.5);
    take("masseter.L=1"); /* only its own side */
    for (uint32_t i = 0; i < model->node_count; i++)
        if (model->rest_position[i].x < -25)
            assert_true(rig.jaw.identity || model->jaw_weight[i] > 0 || model->jaw_slide_weight[i] > 0 ||
                        v3_distance(rig.target[i], v4_xyz(model->rest_position[i])) == 0);
    take("");
    for (uint32_t i = 0; i < model->node_count; i++)
        if (model->rest_position[i].w > 0)
            assert_true(v3_distance(rig.target[i], v4_xyz(model->rest_position[i])) == 0);
}

/* What lies deep moves no skin, and none of them stiffens it; the thesis's tissue is not touched by them at all. */
static void the_deep_move_no_skin(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_head head;
    ris_model *literal = NULL;
    assert_int_equal(ris_head_load(HUMAN, &head, &err), RIS_OK);
    head.tissue.model = RIS_TISSUE_KAEHLER;
    head.tissue.substeps = 64;
    assert_int_equal(ris_model_create(&head, &literal, &err), RIS_OK);
    uint32_t shallow = 0;
    for (int k = 0; k < NAMES; k++) {
        const uint32_t m = find_muscle(names[k], ".L");
        const uint32_t count = model->binding_start[model->node_count];
        for (uint32_t b = 0; b < count; b++) {
            if (model->binding[b].muscle == m)
                assert_true(k < 3);
            shallow += model->binding[b].muscle == m;
        }
        for (uint32_t b = 0; b < literal->binding_start[literal->node_count]; b++)
            assert_true(literal->binding[b].muscle != m);
        for (uint32_t g = 0; g < literal->group_point_count; g++)
            assert_true(literal->group_point[g].muscle != m);
    }
    assert_true(shallow > 100);
    ris_model_destroy(literal);
    ris_head_finish(&head);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_are_whole),       cmocka_unit_test(each_does_its_work),
        cmocka_unit_test(they_hang_between_bones), cmocka_unit_test(clenching_shows),
        cmocka_unit_test(the_deep_move_no_skin),
    };
    return cmocka_run_group_tests_name("chewing", tests, load, unload);
}
