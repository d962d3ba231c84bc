/* Targets of the solver: skins and landmark files, good and bad, on the reference head. */
#include "scratch.h"

#include "model/vec3.h"
#include "risorius/output.h"
#include "risorius/solve.h"

#include <math.h>

#define CSV "landmark,x_mm,y_mm,z_mm\n"
#define JSON "{\"format\":\"risorius-targets\",\"version\":1,\"points\":{"

static ris_model *model;
static ris_error err;

static int open_model(void **state)
{
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    return scratch_setup(state);
}

static int close_model(void **state)
{
    ris_model_destroy(model);
    return scratch_teardown(state);
}

static void landmarks_are_read(void **state)
{
    (void)state;
    ris_target json, csv;
    const char *a = scratch_write("a.json", JSON "\"sto\":[1,2,3],\"ch.R\":[4,5,6.5]}}"),
               *b = scratch_write("b.csv", CSV "ch.R,4,5,6.5\r\nsto,1,2,3\n");
    assert_int_equal(ris_target_load_landmarks(model, a, &json, &err), RIS_OK);
    assert_int_equal(ris_target_load_landmarks(model, b, &csv, &err), RIS_OK);
    assert_true(json.landmarks && csv.landmarks);
    assert_int_equal(json.count, 2);
    assert_int_equal(csv.count, 2);
    assert_memory_equal(json.index, csv.index, 2 * sizeof *csv.index);
    assert_memory_equal(json.at, csv.at, 2 * sizeof *csv.at);
    assert_true(json.index[0] < json.index[1]);
    for (uint32_t i = 0; i < 2; i++) {
        const bool corner = strcmp(model->head->landmark[json.index[i]].name, "ch.R") == 0;
        assert_true(json.at[i].x == (corner ? 4 : 1) && json.at[i].z == (corner ? 6.5f : 3));
    }
    ris_target_finish(&json);
    ris_target_finish(&csv);
}

static void wrong_landmarks_have_a_sentence(void **state)
{
    (void)state;
    const struct {
        const char *name, *text, *wanted;
    } cases[] = {
        {"a.csv", "", "expected the header"},
        {"b.csv", CSV, "expected a landmark, found the end"},
        {"c.csv", CSV "cq.L,1,2,3\n", "found \"cq.L\"; nearest: "},
        {"d.csv", CSV "ch.L,1,2\n", ":2:9: expected a comma"},
        {"e.csv", CSV "ch.L,1,2,nan\n", ":2:10: expected a place"},
        {"f.csv", CSV "ch.L,1,2,3\nch.L,1,2,3\n", ":3:1: expected every landmark once"},
        {"g.csv", CSV "ch.L\n", "a comma"},
        {"h.csv", CSV "ch.L,1,2,1e9\n", "expected a place"},
        {"a.json", "{\"format\":\"risorius-clip\",\"version\":1}", "risorius-targets"},
        {"b.json", JSON "}}", "expected at least one landmark, found none"},
        {"i.json", "{\"format\":\"risorius-targets\",\"version\":1,\"points\":[]}",
         "expected an object of landmarks"},
        {"c.json", JSON "\"ch.L\":[1,2]}}", "points.ch.L: expected 3 numbers"},
        {"d.json", JSON "\"chin\":[1,2,3]}}", "found \"chin\"; nearest: "},
        {"e.json", JSON "\"ch.L\":[1,2,3]},\"unit\":\"mm\"}", "unit"},
        {"f.json",
         "{\"format\":\"risorius-targets\",\"version\":1,\"units\":\"cm\",\"points\":{\"g\":[0,0,0]}}", "cm"},
        {"g.json", "{", "g.json:1:"},
    };
    ris_target target;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        expect_error(
            &err,
            ris_target_load_landmarks(model, scratch_write(cases[k].name, cases[k].text), &target, &err),
            RIS_ERROR_DATA, cases[k].wanted);
        assert_null(target.index);
        assert_null(target.at);
    }
}

/* The resting skin, turned by a quarter and moved: only --align takes it back. */
static void skins_are_read_and_aligned(void **state)
{
    (void)state;
    ris_vec4 *moved = malloc(model->node_count * sizeof *moved);
    assert_non_null(moved);
    for (uint32_t i = 0; i < model->node_count; i++) {
        const ris_vec4 p = model->rest_position[i];
        moved[i] = (ris_vec4){p.z + 5, p.y - 7, -p.x + 100, 1};
    }
    const char *path = scratch_path("moved.obj");
    const ris_obj_object object = {"skin", &model->head->skin, moved};
    assert_int_equal(ris_obj_write(path, &object, 1, &err), RIS_OK);
    for (int align = 0; align < 2; align++) {
        ris_target target;
        double most = 0;
        assert_int_equal(ris_target_load_skin(model, path, align, &target, &err), RIS_OK);
        assert_int_equal(target.count, model->moving_count);
        for (uint32_t i = 0; i < target.count; i++) {
            const ris_vec3 rest = v4_xyz(model->rest_position[target.index[i]]);
            most = fmax(most, (double)v3_distance(rest, target.at[i]));
        }
        if (align) {
            assert_true(most < 1e-3);
            assert_true(fabs(target.turned_deg - 90) < 1e-3);
            /* the middle goes from (5, -7, 100) back to 0, so 0 goes where the turn takes (-5, 7, -100) */
            assert_true(fabs(target.moved_mm - sqrt(5 * 5 + 7 * 7 + 100 * 100)) < 1e-3);
        } else {
            assert_true(most > 50);
            assert_true(target.turned_deg == 0 && target.moved_mm == 0);
        }
        ris_target_finish(&target);
    }
    free(moved);
}

static void wrong_skins_have_a_sentence(void **state)
{
    (void)state;
    ris_target target;
    expect_error(&err,
                 ris_target_load_skin(model, scratch_write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                                      false, &target, &err),
                 RIS_ERROR_DATA, "expected the 4368 vertices of the head's skin in their order, found 3");
    expect_error(&err,
                 ris_target_load_skin(model, scratch_write("n.obj", "v 0 nan 0\n"), false, &target, &err),
                 RIS_ERROR_DATA, "n.obj:1:5");
    expect_error(&err, ris_target_load_skin(model, scratch_path("none.obj"), false, &target, &err),
                 RIS_ERROR_DATA, "none.obj");
}

/* Reduced to landmarks, the resting skin gives the places of the landmarks at rest. */
static void skins_reduce_to_landmarks(void **state)
{
    (void)state;
    ris_target target;
    assert_int_equal(ris_target_from_skin(model, model->rest_position, &target, &err), RIS_OK);
    assert_int_equal(ris_target_reduce(model, &target, &err), RIS_OK);
    assert_true(target.landmarks && target.count > 50);
    for (uint32_t i = 0; i < target.count; i++) {
        const ris_landmark *mark = &model->head->landmark[target.index[i]];
        assert_int_equal(mark->mesh, RIS_LANDMARK_SKIN);
        assert_true(v3_distance(mark->at, target.at[i]) < 1e-3f);
    }
    ris_target_finish(&target);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(landmarks_are_read),         cmocka_unit_test(wrong_landmarks_have_a_sentence),
        cmocka_unit_test(skins_are_read_and_aligned), cmocka_unit_test(wrong_skins_have_a_sentence),
        cmocka_unit_test(skins_reduce_to_landmarks),
    };
    return cmocka_run_group_tests(tests, open_model, close_model);
}
