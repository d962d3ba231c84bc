/* The measure of expressions: hand-computed numbers on four vertices, and files that are wrong. */
#include "scratch.h"

#include "asset/score_list.h"
#include "asset/target.h"
#include "measure/score.h"
#include "risorius/timeline.h"

#include <math.h>
#include <sys/stat.h>

#define NEAR(a, b) assert_float_equal(a, b, 1e-12)

static ris_error err;

/* Two right triangles of 2 and 4 mm^2 that share no vertex; the last vertex is no vertex of the base mesh. */
static ris_vec3 place[6] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {10, 0, 0}, {14, 0, 0}, {10, 2, 0}};
static int32_t map[6] = {0, 1, 2, 4, 5, -1};
static uint32_t face_start[3] = {0, 3, 6}, face_vertex[6] = {0, 1, 2, 3, 4, 5};
static ris_head head = {.skin = {.vertex_count = 6,
                                 .face_count = 2,
                                 .position = place,
                                 .face_start = face_start,
                                 .face_vertex = face_vertex},
                        .base_vertex = map};
static ris_model model = {.head = &head, .node_count = 6};

/* The base mesh is the head in decimetres, its vertex 3 is none of the skin's. */
static ris_mesh base_mesh(ris_vec3 *position)
{
    for (uint32_t i = 0; i < 6; i++) {
        if (map[i] >= 0) {
            position[map[i]] = (ris_vec3){place[i].x / 100, place[i].y / 100, place[i].z / 100};
        }
    }
    return (ris_mesh){.vertex_count = 6, .position = position};
}

static void open_scorer(ris_scorer *scorer, ris_vec4 *neutral)
{
    ris_vec3 position[6] = {{0, 0, 0}};
    const ris_mesh base = base_mesh(position);
    for (uint32_t i = 0; i < 6; i++) {
        neutral[i] = (ris_vec4){place[i].x, place[i].y, place[i].z, 1};
    }
    assert_int_equal(ris__scorer_create(&model, &base, neutral, scorer, &err), RIS_OK);
    assert_float_equal(scorer->mm, 1.0, 1e-6);
    scorer->mm = 1; /* rounding of the base mesh aside */
}

/* w = 2/3 at each vertex of the first triangle, 4/3 of the second. u = (0,3,0) at 0 and (0,0,1) at 3 (base 4);
 * s = (0,2,0) at 0, (1,0,0) at 1, (0,0,1) at 3:
 * uu = 2/3 9 + 4/3 1 = 22/3, ss = 2/3 4 + 2/3 1 + 4/3 1 = 14/3, su = 2/3 6 + 4/3 1 = 16/3,
 * |s-u|^2 = 2/3 (1 + 1) = 4/3, far = 2/3 of 14/3 = 1/7. */
static void hand_computed_numbers(void **state)
{
    (void)state;
    ris_vec4 position[6];
    ris_scorer scorer;
    ris_score score;
    double sculpt[18] = {0};
    open_scorer(&scorer, position);
    assert_int_equal(scorer.used_count, 5);
    NEAR(scorer.area[0], 2.0 / 3);
    NEAR(scorer.area[4], 4.0 / 3);
    sculpt[0 * 3 + 1] = 0.03;
    sculpt[4 * 3 + 2] = 0.01;
    sculpt[3 * 3 + 0] = 7; /* what the skin has not is not seen */
    position[0].y += 2;
    position[1].x += 1;
    position[3].z += 1;
    position[5].x += 9; /* unmapped: not seen */
    assert_int_equal(ris__score_pose(&scorer, sculpt, position, &score, &err), RIS_OK);
    NEAR(score.cos, 16.0 / sqrt(14.0 * 22.0));
    NEAR(score.gain, sqrt(14.0 / 22.0));
    NEAR(score.r2, 1 - 4.0 / 22.0);
    NEAR(score.r2fit, 256.0 / (14.0 * 22.0));
    NEAR(score.far, 1.0 / 7);
    NEAR(score.simulated_mm, 2);
    NEAR(score.sculpted_mm, 3);
    ris__scorer_finish(&scorer);
}

/* The sculpt itself scores 1, its opposite -1 with r2fit 0, and no motion 0. */
static void controls_of_the_measure(void **state)
{
    (void)state;
    ris_vec4 rest[6], position[6];
    ris_scorer scorer;
    ris_score score;
    double sculpt[18] = {0};
    open_scorer(&scorer, rest);
    assert_int_equal(ris__score_pose(&scorer, sculpt, rest, &score, &err), RIS_ERROR_DATA);
    sculpt[1] = 0.02;
    sculpt[3] = -0.01;
    for (int sign = -1; sign <= 1; sign++) {
        memcpy(position, rest, sizeof rest);
        position[0].y += 2.0f * (float)sign;
        position[1].x -= 1.0f * (float)sign;
        assert_int_equal(ris__score_pose(&scorer, sculpt, position, &score, &err), RIS_OK);
        NEAR(score.cos, sign);
        NEAR(score.gain, sign == 0 ? 0 : 1);
        NEAR(score.r2fit, sign > 0 ? 1 : 0);
        NEAR(score.r2, sign > 0 ? 1 : sign < 0 ? -3 : 0);
        NEAR(score.far, 0);
    }
    position[2].x = NAN;
    assert_int_equal(ris__score_pose(&scorer, sculpt, position, &score, &err), RIS_ERROR_FAILED);
    ris__scorer_finish(&scorer);
}

static void a_head_must_fit_the_base_mesh(void **state)
{
    (void)state;
    ris_vec4 neutral[6] = {{0, 0, 0, 1}};
    ris_vec3 position[6] = {{0, 0, 0}};
    ris_mesh base = base_mesh(position);
    ris_scorer scorer;
    base.vertex_count = 5;
    expect_error(&err, ris__scorer_create(&model, &base, neutral, &scorer, &err), RIS_ERROR_DATA,
                 "skin.map:5:1: expected a vertex of the base mesh, 0 to 4, found 5");
    ris_head bare = head;
    bare.base_vertex = NULL;
    const ris_model unmapped = {.head = &bare, .node_count = 6};
    expect_error(&err, ris__scorer_create(&unmapped, &base, neutral, &scorer, &err), RIS_ERROR_DATA,
                 "skin.map");
    base.vertex_count = 6;
    expect_error(&err, ris__scorer_create(&model, &base, neutral, &scorer, &err), RIS_ERROR_DATA,
                 "one place");
}

static void targets_are_read_and_add(void **state)
{
    (void)state;
    double sum[9] = {0};
    const char *text = "# a comment\n\n0 1 -2 .5\r\n 2\t0.25  0 1e-1 \n2 0.75 0 0\n";
    assert_int_equal(ris__target_add("a.target", text, strlen(text), 3, sum, &err), RIS_OK);
    const double wanted[9] = {1, -2, 0.5, 0, 0, 0, 1, 0, 0.1};
    for (int k = 0; k < 9; k++) {
        NEAR(sum[k], wanted[k]);
    }
    const struct {
        const char *text, *message;
    } wrong[] = {{"0 1 2\n", "a.target:1:6: expected 3 numbers after the vertex, found \"\""},
                 {"#\n3 0 0 0\n", "a.target:2:1: expected a vertex of 0 to 2, found \"3 0 0 0\""},
                 {"-1 0 0 0\n", "a.target:1:1: expected a vertex"},
                 {"0 1 2 nan\n", "a.target:1:7: expected 3 numbers"},
                 {"0 1 2 3 4\n", "a.target:1:9: expected the end of the line, found \"4\""},
                 {"01 1x 2 3\n", "a.target:1:5: expected 3 numbers"},
                 {"0 1 2 1e9\n", "a.target:1:7: expected 3 numbers"}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        expect_error(&err, ris__target_add("a.target", wrong[k].text, strlen(wrong[k].text), 3, sum, &err),
                     RIS_ERROR_DATA, wrong[k].message);
    }
}

/* A plain folder, and the folder of a checkout. Removes what it made: scratch_clear knows no folders. */
static void references_are_found(void **state)
{
    (void)state;
    static const char *const folders[] = {"makehuman",
                                          "makehuman/data",
                                          "makehuman/data/3dobjs",
                                          "makehuman/data/targets",
                                          "makehuman/data/targets/expression",
                                          "makehuman/data/targets/expression/units",
                                          "makehuman/data/targets/expression/units/caucasian",
                                          "expression"};
    const char *mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    double sum[9];
    ris_reference reference;
    expect_error(&err, ris__reference_load(scratch_folder, &reference, &err), RIS_ERROR_DATA, "found no");
    for (size_t k = 0; k < 8; k++) {
        assert_int_equal(mkdir(scratch_path(folders[k]), 0700), 0);
    }
    const char *checkout = "makehuman/data/targets/expression/units/caucasian/smile.target";
    scratch_write("makehuman/data/3dobjs/base.obj", mesh);
    scratch_write(checkout, "1 2 0 0\n");
    assert_int_equal(rmdir(scratch_path("expression")), 0);
    assert_int_equal(ris__reference_load(scratch_folder, &reference, &err), RIS_OK);
    assert_int_equal(reference.base.vertex_count, 3);
    assert_int_equal(ris__reference_unit(&reference, "smile", sum, &err), RIS_OK);
    NEAR(sum[3], 2);
    ris__reference_finish(&reference);

    assert_int_equal(mkdir(scratch_path("expression"), 0700), 0);
    scratch_write("base.obj", mesh);
    scratch_write("expression/a.target", "0 1 0 0\n");
    scratch_write("expression/b.target", "0 1 0 5\n2 0 3 0\n");
    assert_int_equal(ris__reference_load(scratch_folder, &reference, &err), RIS_OK);
    assert_int_equal(ris__reference_unit(&reference, "a+b", sum, &err), RIS_OK);
    NEAR(sum[0], 2);
    NEAR(sum[2], 5);
    NEAR(sum[7], 3);
    expect_error(&err, ris__reference_unit(&reference, "a+c", sum, &err), RIS_ERROR_DATA, "c.target");
    expect_error(&err, ris__reference_unit(&reference, "a+", sum, &err), RIS_ERROR_DATA, "\"a+\"");
    ris__reference_finish(&reference);

    unlink(scratch_path("makehuman/data/3dobjs/base.obj"));
    unlink(scratch_path(checkout));
    unlink(scratch_path("expression/a.target"));
    unlink(scratch_path("expression/b.target"));
    for (size_t k = 8; k-- > 0;) {
        assert_int_equal(rmdir(scratch_path(folders[k])), 0);
    }
}

#define LIST(units) "{\"format\":\"risorius-score\",\"version\":1,\"units\":[" units "]}"

static void lists_are_checked(void **state)
{
    (void)state;
    ris_score_list list;
    const char *path = scratch_write("score.json", LIST("{\"unit\":\"a\",\"recipe\":\"AU12=1\"},"
                                                        "{\"unit\":\"b-1+c\",\"argument\":\"bone\"}"));
    assert_int_equal(ris__score_list_load(path, &list, &err), RIS_OK);
    assert_int_equal(list.count, 2);
    assert_string_equal(list.unit[0].recipe, "AU12=1");
    assert_string_equal(list.unit[1].unit, "b-1+c");
    assert_string_equal(list.unit[1].argument, "bone");
    ris__score_list_finish(&list);
    const struct {
        const char *text, *message;
    } wrong[] = {
        {LIST(""), "units"},
        {LIST("{\"unit\":\"a\"}"), "expected a recipe, or an argument"},
        {LIST("{\"unit\":\"a\",\"recipe\":\"AU1=1,AU2=1,AU4=1,AU5=1\"}"), "at most 3 names, found 4"},
        {LIST("{\"unit\":\"../a\",\"recipe\":\"x=1\"}"), "target names joined by '+'"},
        {LIST("{\"unit\":\"a+\",\"recipe\":\"x=1\"}"), "target names joined by '+'"},
        {LIST("{\"unit\":\"a\",\"recipe\":\"x=1\"},{\"unit\":\"a\",\"recipe\":\"x=2\"}"), "again"},
        {LIST("{\"unit\":\"a\",\"recepe\":\"x=1\"}"), "recipe"},
        {"{\"format\":\"risorius-clip\",\"version\":1,\"units\":[]}", "risorius-score"}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        path = scratch_write("score.json", wrong[k].text);
        expect_error(&err, ris__score_list_load(path, &list, &err), RIS_ERROR_DATA, wrong[k].message);
        assert_null(list.unit);
    }
}

/* The reference head's own list: all 34 units once, each with a recipe that is a pose of the head, or an argument. */
static void the_list_of_the_head_is_sound(void **state)
{
    (void)state;
    ris_score_list list;
    ris_model *human = NULL;
    uint32_t targets = 0;
    assert_int_equal(ris__score_list_load(RIS_SOURCE_DIR "/assets/human/score.json", &list, &err), RIS_OK);
    assert_int_equal(ris_model_load(RIS_SOURCE_DIR "/assets/human", &human, &err), RIS_OK);
    float *pose = calloc(human->channel_count, sizeof *pose);
    for (uint32_t k = 0; k < list.count; k++) {
        targets++;
        for (const char *plus = list.unit[k].unit; (plus = strchr(plus, '+')); plus++) {
            targets++;
        }
        if (list.unit[k].recipe[0] && ris_pose_parse(human, list.unit[k].recipe, pose, &err)) {
            fail_msg("%s: %s", list.unit[k].unit, err.text);
        }
    }
    assert_int_equal(targets, 34);
    free(pose);
    ris_model_destroy(human);
    ris__score_list_finish(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hand_computed_numbers),         cmocka_unit_test(controls_of_the_measure),
        cmocka_unit_test(a_head_must_fit_the_base_mesh), cmocka_unit_test(targets_are_read_and_add),
        cmocka_unit_test(references_are_found),          cmocka_unit_test(lists_are_checked),
        cmocka_unit_test(the_list_of_the_head_is_sound),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
