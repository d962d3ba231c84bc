/* risorius score as a user meets it. The reference is made here: a base mesh of the head's own vertices, whose sculpts are
 * what the head itself does, so a recipe scores 1 by its own sculpt and breaks a bound by any other. */
#include "command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>
#include <jansson.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"
#define MAX_VERTICES 20000

static run_result run;
static char folder[COMMAND_PATH_SIZE];

typedef struct obj_points {
    uint32_t count;
    double p[MAX_VERTICES][3];
} obj_points;

static obj_points rest, posed;
static long base_of[MAX_VERTICES];

static void expect(const char *line, int code, const char *in_err)
{
    command_run(&run, NULL, line);
    if (run.code != code || (in_err && !strstr(run.err, in_err))) {
        fail_msg("risorius %s: code %d (expected %d), stderr '%s' (expected '%s')", line, run.code, code,
                 run.err, in_err ? in_err : "");
    }
}

static const char *path_of(const char *name)
{
    static char path[4][COMMAND_PATH_SIZE + 64];
    static unsigned turn;
    char *out = path[turn++ % 4];
    snprintf(out, sizeof path[0], "%s/%s", folder, name);
    return out;
}

static void read_points(const char *path, obj_points *out)
{
    char *text = command_read_file(path);
    assert_non_null(text);
    out->count = 0;
    for (char *at = text; at; at = strchr(at, '\n'), at = at ? at + 1 : NULL) {
        if (strncmp(at, "v ", 2) == 0) {
            double *p = out->p[out->count++];
            assert_true(out->count < MAX_VERTICES);
            p[0] = strtod(at + 2, &at);
            p[1] = strtod(at, &at);
            p[2] = strtod(at, &at);
        }
    }
    free(text);
}

static void write_base(uint32_t count)
{
    static double base[MAX_VERTICES][3];
    FILE *file = fopen(path_of("base.obj"), "wb");
    assert_non_null(file);
    for (uint32_t i = 0; i < rest.count; i++) {
        if (base_of[i] >= 0) {
            memcpy(base[base_of[i]], rest.p[i], sizeof base[0]);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        fprintf(file, "v %.9f %.9f %.9f\n", base[i][0] / 100, base[i][1] / 100, base[i][2] / 100);
    }
    fprintf(file, "f 1 2 3\n");
    fclose(file);
}

/* The pose as a sculpt, scaled, by way of export. */
static void write_sculpt(const char *name, const char *pose, double scale)
{
    char line[2 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line, "export '" HUMAN "' --device cpu -q --pose %s -o '%s'", pose,
             path_of("posed.obj"));
    expect(line, 0, NULL);
    read_points(path_of("posed.obj"), &posed);
    FILE *file = fopen(path_of(name), "wb");
    assert_non_null(file);
    fprintf(file, "# made by export\n");
    for (uint32_t i = 0; i < posed.count; i++) {
        const double *p = posed.p[i], *q = rest.p[i], f = scale / 100;
        if (base_of[i] >= 0 && fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]) > 1e-5) {
            fprintf(file, "%ld %.9f %.9f %.9f\n", base_of[i], f * (p[0] - q[0]), f * (p[1] - q[1]),
                    f * (p[2] - q[2]));
        }
    }
    fclose(file);
}

static int make_reference(void **state)
{
    (void)state;
    uint32_t count = 0, i = 0;
    command_folder(folder, "score");
    mkdir(path_of("expression"), 0700);
    char line[2 * COMMAND_PATH_SIZE];
    snprintf(line, sizeof line, "export '" HUMAN "' --device cpu -q -o '%s'", path_of("rest.obj"));
    expect(line, 0, NULL);
    read_points(path_of("rest.obj"), &rest);
    char *map = command_read_file(HUMAN "/skin.map"), *at = map;
    assert_non_null(map);
    for (; i < rest.count; i++) {
        base_of[i] = strtol(at, &at, 10);
        count = base_of[i] + 1 > (long)count ? (uint32_t)base_of[i] + 1 : count;
    }
    free(map);
    write_base(count);
    write_sculpt("expression/smile.target", "zygomaticus_major=1", 1);
    write_sculpt("expression/jaw.target", "jaw.open=0.5", 0.5);
    return 0;
}

static const char *score_line(const char *units, const char *words)
{
    static char line[4 * COMMAND_PATH_SIZE], list[4096];
    snprintf(list, sizeof list, "{\"format\":\"risorius-score\",\"version\":1,\"units\":[%s]}", units);
    command_write_file(path_of("list.json"), list);
    snprintf(line, sizeof line, "score '" HUMAN "' --device cpu -q --reference '%s' --recipes '%s' %s",
             folder, path_of("list.json"), words);
    return line;
}

static void a_recipe_scores_one_by_its_own_sculpt(void **state)
{
    (void)state;
    json_error_t error;
    expect(score_line("{\"unit\":\"smile\",\"recipe\":\"zygomaticus_major=1\"},"
                      "{\"unit\":\"jaw\",\"recipe\":\"jaw.open=0.5\",\"argument\":\"a bone\"}",
                      ""),
           0, NULL);
    assert_non_null(strstr(run.out, "  1.000   1.00   1.000  1.000  0.00"));
    assert_non_null(strstr(run.out, "mean cos 1.000 over 1 units"));
    assert_non_null(strstr(run.out, "not counted  jaw: a bone"));
    assert_null(strstr(run.out, "BROKEN"));
    expect(score_line("{\"unit\":\"jaw\",\"recipe\":\"jaw.open=0.5\"}", "--json"), 1, "gain 2.00");
    json_t *root = json_loads(run.out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(root);
    json_t *unit = json_array_get(json_object_get(root, "units"), 0);
    assert_float_equal(json_number_value(json_object_get(unit, "gain")), 2.0, 1e-4);
    assert_float_equal(json_number_value(json_object_get(unit, "cos")), 1.0, 1e-6);
    json_decref(root);
}

static void other_poses_break_a_bound(void **state)
{
    (void)state;
    const char *smile = "{\"unit\":\"smile\",\"recipe\":\"zygomaticus_major=1\"}";
    expect(score_line(smile, "--unit smile --pose zygomaticus_major=0.4"), 1, "smile: gain 0.");
    expect(score_line(smile, "--unit smile --pose depressor_anguli_oris=1"), 1, "smile: cos -");
    expect(score_line(smile, "--unit smile --pose zygomaticus_major=1,frontalis_outer=1"), 1, "smile: far ");
    assert_non_null(strstr(run.out, "BROKEN  smile: far"));
    assert_non_null(
        strstr(run.out, "  zygomaticus_major=1,frontalis_outer=1\n")); /* what was measured, not the recipe */
}

static void wrong_words_and_files(void **state)
{
    (void)state;
    const char *smile = "{\"unit\":\"smile\",\"recipe\":\"zygomaticus_major=1\"}";
    expect("score '" HUMAN "' --device cpu", 2, "--reference");
    expect("score --reference x", 2, "HEAD");
    expect("score '" HUMAN "' --device cpu --reference no_such_folder", 3, "no_such_folder");
    expect(score_line(smile, "--unit smle"), 2, "nearest: smile");
    expect(score_line(smile, "--pose zygomaticus_major=1"), 2, "--unit");
    expect(score_line(smile, "--unit smile --pose zygomaticus_majo=1"), 2, "zygomaticus_major");
    expect(score_line("{\"unit\":\"smile\",\"recipe\":\"zygomaticus_majo=1\"}", ""), 3, "smile: ");
    expect(score_line("{\"unit\":\"frown\",\"recipe\":\"zygomaticus_major=1\"}", ""), 3, "frown.target");
    command_write_file(path_of("expression/torn.target"), "12 0.1 0.2\n");
    expect(score_line("{\"unit\":\"torn\",\"recipe\":\"zygomaticus_major=1\"}", ""), 3,
           "torn.target:1:11: expected");
    command_write_file(path_of("expression/still.target"), "# nothing\n");
    expect(score_line("{\"unit\":\"still\",\"recipe\":\"zygomaticus_major=1\"}", ""), 3, "still: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_recipe_scores_one_by_its_own_sculpt),
        cmocka_unit_test(other_poses_break_a_bound),
        cmocka_unit_test(wrong_words_and_files),
    };
    return cmocka_run_group_tests(tests, make_reference, NULL);
}
