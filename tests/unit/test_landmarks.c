/* Landmarks of a head (KA-07) and the pose they define (KA-08), on the reference head and on files that are wrong. */
#include "scratch.h"

#include "asset/head_parts.h"
#include "query/query.h"

#include <math.h>

#define START "{\"format\":\"risorius-landmarks\",\"version\":1,\"units\":\"mm\",\"skin\":["
#define GOOD START "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[0.5,0.25,0.25],\"at\":[0.25,0.25,0]}]}"

static ris_head human;
static ris_error err;

static int open_human(void **state)
{
    (void)state;
    if (ris_head_load(RIS_SOURCE_DIR "/assets/human", &human, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int close_human(void **state)
{
    (void)state;
    ris_head_finish(&human);
    return 0;
}

static const ris_mesh *mesh_of(ris_landmark_mesh mesh)
{
    return mesh == RIS_LANDMARK_SKIN    ? &human.skin
           : mesh == RIS_LANDMARK_SKULL ? &human.skull
                                        : &human.mandible;
}

static void they_lie_on_their_meshes(void **state)
{
    (void)state;
    uint32_t count[3] = {0};
    for (int m = RIS_LANDMARK_SKIN; m <= RIS_LANDMARK_MANDIBLE; m++) {
        tri_mesh soup = {0};
        bvh tree = {0};
        assert_int_equal(ris__tri_from_mesh(mesh_of((ris_landmark_mesh)m), "mesh", &soup, &err), RIS_OK);
        assert_int_equal(ris__bvh_build(&tree, &soup, &err), RIS_OK);
        for (uint32_t k = 0; k < human.landmark_count; k++) {
            const ris_vec3 at = human.landmark[k].at;
            if ((int)human.landmark[k].mesh != m) {
                continue;
            }
            count[m]++;
            const double off = ris__bvh_closest(&tree, dv((double)at.x, (double)at.y, (double)at.z)).distance;
            if (!(off < 1e-4)) {
                fail_msg("%s is %g mm off its mesh", human.landmark[k].name, off);
            }
            /* control: a millimetre out along x, y and z is not on it */
            assert_true(
                ris__bvh_closest(&tree, dv((double)at.x + 1, (double)at.y + 1, (double)at.z + 1)).distance >
                1e-4);
        }
        ris__bvh_finish(&tree);
        ris__tri_finish(&soup);
    }
    assert_true(count[RIS_LANDMARK_SKIN] >= 60);
    assert_int_equal(count[RIS_LANDMARK_SKULL] + count[RIS_LANDMARK_MANDIBLE], 38); /* table 8.3 */
}

static void bones_pair_with_the_skin(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < human.landmark_count; k++) {
        const ris_landmark *bone = &human.landmark[k];
        if (bone->mesh == RIS_LANDMARK_SKIN) {
            continue;
        }
        const ris_landmark *skin = ris_head_landmark(&human, bone->name, false);
        assert_non_null(skin);
        const double x = (double)(skin->at.x - bone->at.x), y = (double)(skin->at.y - bone->at.y),
                     z = (double)(skin->at.z - bone->at.z);
        assert_float_equal(sqrt(x * x + y * y + z * z), (double)bone->depth_mm, 2e-3);
        assert_float_equal(x, (double)(bone->dowel.x * bone->depth_mm), 2e-3);
        assert_float_equal(y, (double)(bone->dowel.y * bone->depth_mm), 2e-3);
        assert_float_equal(z, (double)(bone->dowel.z * bone->depth_mm), 2e-3);
    }
    assert_null(ris_head_landmark(&human, "zz", true));
}

static void move(const double m[12], ris_vec3 p, double out[3])
{
    for (int r = 0; r < 3; r++) {
        out[r] =
            m[4 * r] * (double)p.x + m[4 * r + 1] * (double)p.y + m[4 * r + 2] * (double)p.z + m[4 * r + 3];
    }
}

static void the_frankfort_horizontal(void **state)
{
    (void)state;
    double m[12], p[4][3];
    static const char *const name[4] = {"po.L", "po.R", "or.L", "or.R"};
    assert_int_equal(ris_head_frankfort(&human, m, &err), RIS_OK);
    ris_head turned = {.landmark_count = 4, .landmark = calloc(4, sizeof *turned.landmark)};
    assert_non_null(turned.landmark);
    for (int k = 0; k < 4; k++) {
        turned.landmark[k] = *ris_head_landmark(&human, name[k], false);
        move(m, turned.landmark[k].at, p[k]);
        turned.landmark[k].at = (ris_vec3){(float)p[k][0], (float)p[k][1], (float)p[k][2]};
    }
    assert_float_equal(p[0][1], p[1][1], 1e-6);
    assert_float_equal(p[0][2], p[1][2], 1e-6);
    assert_float_equal(0.5 * (p[2][1] + p[3][1]), p[0][1], 1e-6);
    assert_float_equal(p[0][0], -p[1][0], 1e-6);
    /* the reference head was posed by vertices of its base mesh: its soft landmarks are within a degree of it */
    assert_true(m[5] > cos(1.0 / 57.3) && m[5] < 1.0);
    assert_int_equal(ris_head_frankfort(&turned, m, &err), RIS_OK); /* twice is once */
    for (int k = 0; k < 12; k++) {
        const double one = k % 5 ? 0.0 : 1.0;
        assert_float_equal(m[k], one, 1e-5);
    }
    turned.landmark[1].at = turned.landmark[0].at;
    assert_int_equal(ris_head_frankfort(&turned, m, &err), RIS_ERROR_DATA);
    turned.landmark_count = 3;
    assert_int_equal(ris_head_frankfort(&turned, m, &err), RIS_ERROR_DATA);
    assert_non_null(strstr(err.text, "or.R"));
    free(turned.landmark);
}

static ris_result read_text(const char *text, ris_head *head)
{
    static const ris_vec3 corner[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    ris_json json = {0};
    *head = (ris_head){.skin.vertex_count = 3, .skin.position = malloc(sizeof corner)};
    assert_non_null(head->skin.position);
    memcpy(head->skin.position, corner, sizeof corner);
    ris_result result = ris__json_parse("landmarks.json", text, strlen(text), &json, &err);
    if (result == RIS_OK) {
        result = ris__landmarks_read(&json, head, &err);
    }
    ris__json_finish(&json);
    return result;
}

static void refuse(const char *text, const char *says)
{
    ris_head head;
    assert_int_equal(read_text(text, &head), RIS_ERROR_DATA);
    ris_head_finish(&head);
    if (!strstr(err.text, says)) {
        fail_msg("\"%s\" does not say \"%s\"", err.text, says);
    }
}

static void wrong_files_are_refused(void **state)
{
    (void)state;
    ris_head head;
    assert_int_equal(read_text(GOOD, &head), RIS_OK);
    assert_int_equal(head.landmark_count, 1);
    assert_float_equal(head.landmark[0].at.x, 0.25f, 1e-6f);
    ris_head_finish(&head);
    refuse("{\"format\":\"risorius-landmarks\",\"version\":1,\"units\":\"mm\"}", "skin");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1],\"weights\":[1,0,0],\"at\":[0,0,0]}]}", "vertices");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1,3],\"weights\":[1,0,0],\"at\":[0,0,0]}]}", "vertices[2]");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[0.5,0,0],\"at\":[0,0,0]}]}", "sum 1");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[1,0,0],\"at\":[0,0,0.5]}]}",
           "expected the place");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[1,0,0],\"at\":[0,0,0],\"colour\":1}]}",
           "colour");
    refuse(START "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[1,0,0],\"at\":[0,0,0]},"
                 "{\"name\":\"g\",\"vertices\":[0,1,2],\"weights\":[1,0,0],\"at\":[0,0,0]}]}",
           "there already");
    refuse(START "],\"bone\":[{\"name\":\"g\",\"mesh\":\"skull\",\"vertices\":[0,1,2],\"weights\":[1,0,0],"
                 "\"at\":[0,0,0],"
                 "\"dowel\":[0,0,1],\"depth_mm\":4}]}",
           "skull");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_lie_on_their_meshes),
        cmocka_unit_test(bones_pair_with_the_skin),
        cmocka_unit_test(the_frankfort_horizontal),
        cmocka_unit_test(wrong_files_are_refused),
    };
    return cmocka_run_group_tests(tests, open_human, close_human);
}
