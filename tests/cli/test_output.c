/* What commands write: whole or not at all, in the order of the head, and never over a failure. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define CLIP "'" RIS_SOURCE_DIR "/assets/clips/first_light.json'"

static run_result run;

static uint32_t count_lines(const char *text, const char *start)
{
    uint32_t count = 0;
    for (const char *line = text; line && *line; line = strchr(line, '\n')) {
        line += *line == '\n';
        count += strncmp(line, start, strlen(start)) == 0;
    }
    return count;
}

static void info_is_json(void **state)
{
    (void)state;
    command_run(&run, NULL, "info " HEAD " --json");
    assert_int_equal(run.code, 0);
    json_error_t error;
    json_t *root = json_loads(run.out, JSON_REJECT_DUPLICATES, &error);
    assert_non_null(root);
    char *obj = command_read_file(RIS_SOURCE_DIR "/assets/human/skin.obj");
    assert_non_null(obj);
    assert_int_equal(json_integer_value(json_object_get(root, "vertices")), count_lines(obj, "v "));
    assert_int_equal(json_integer_value(json_object_get(root, "faces")), count_lines(obj, "f "));
    assert_true(json_integer_value(json_object_get(root, "moving_nodes")) >= 2000);
    assert_true(json_integer_value(json_object_get(root, "springs")) >
                json_integer_value(json_object_get(root, "moving_nodes")));
    assert_true(json_array_size(json_object_get(root, "muscles")) >= 10);
    assert_true(json_real_value(json_object_get(root, "stable_dt_s")) >
                json_real_value(json_object_get(root, "dt_s")));
    free(obj);
    json_decref(root);
    command_run(&run, NULL, "info " HEAD);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "zygomaticus_major.L"));
}

/* Positions of "v" lines, count x 3; the caller frees. */
static double *read_positions(const char *path, uint32_t *out_count)
{
    char *text = command_read_file(path);
    assert_non_null(text);
    *out_count = count_lines(text, "v ");
    double *position = calloc(3u * *out_count + 1u, sizeof *position);
    assert_non_null(position);
    uint32_t at = 0;
    for (const char *line = text; line && *line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, "v ", 2) == 0) {
            assert_int_equal(
                sscanf(line, "v %lf %lf %lf", &position[at], &position[at + 1], &position[at + 2]), 3);
            at += 3;
        }
    }
    free(text);
    return position;
}

static double largest_difference(const double *a, const double *b, uint32_t count)
{
    double largest = 0;
    for (uint32_t i = 0; i < 3 * count; i++) {
        double d = a[i] > b[i] ? a[i] - b[i] : b[i] - a[i];
        largest = d > largest ? d : largest;
    }
    return largest;
}

static void export_keeps_the_order_of_the_skin(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], line[3 * COMMAND_PATH_SIZE], rest[COMMAND_PATH_SIZE + 16],
        open[COMMAND_PATH_SIZE + 16];
    command_folder(folder, "export");
    snprintf(rest, sizeof rest, "%s/rest.obj", folder);
    snprintf(open, sizeof open, "%s/open.obj", folder);
    snprintf(line, sizeof line, "--device cpu export " HEAD " -o '%s'", rest);
    command_run(&run, NULL, line);
    assert_int_equal(run.code, 0);
    snprintf(line, sizeof line, "--device cpu export " HEAD " --pose jaw.open=0.5 -o '%s'", open);
    command_run(&run, NULL, line);
    assert_int_equal(run.code, 0);
    assert_int_equal(command_entries(folder), 2);

    uint32_t skin_count, rest_count, open_count;
    double *skin = read_positions(RIS_SOURCE_DIR "/assets/human/skin.obj", &skin_count),
           *at_rest = read_positions(rest, &rest_count), *opened = read_positions(open, &open_count);
    assert_int_equal(skin_count, rest_count);
    assert_int_equal(skin_count, open_count);
    assert_true(largest_difference(skin, at_rest, skin_count) < 0.01);
    assert_true(largest_difference(skin, opened, skin_count) > 5.0);
    free(skin);
    free(at_rest);
    free(opened);
}

static void export_with_parts_adds_objects(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], line[2 * COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 16];
    command_folder(folder, "parts");
    snprintf(path, sizeof path, "%s/all.obj", folder);
    snprintf(line, sizeof line, "--device cpu export " HEAD " --clip " CLIP " --at 0.5 --parts -o '%s'",
             path);
    command_run(&run, NULL, line);
    assert_int_equal(run.code, 0);
    char *text = command_read_file(path);
    assert_non_null(text);
    assert_true(count_lines(text, "o ") > 4);
    free(text);
}

/* A failed command leaves its folder as it was. */
static void expect_nothing(const char *name, const command_def *def, const char *words, int code)
{
    char folder[COMMAND_PATH_SIZE], line[2 * COMMAND_PATH_SIZE];
    command_folder(folder, name);
    command_def here = *def;
    here.directory = folder;
    snprintf(line, sizeof line, "--device cpu %s", words);
    command_run(&run, &here, line);
    const char *newline = strrchr(run.err, '\n');
    if (run.code != code || command_entries(folder) != 0 || !newline || newline == run.err) {
        fail_msg("%s: code %d (expected %d), %u files left, stderr '%s'", name, run.code, code,
                 command_entries(folder), run.err);
    }
}

static void a_full_disk_leaves_nothing(void **state)
{
    (void)state;
    const command_def full = {.file_limit = 3000};
    expect_nothing("full_obj", &full, "export " HEAD " -o x.obj", 1);
    expect_nothing("full_pc2", &full, "render " HEAD " --clip " CLIP " -o x.pc2", 1);
}

static void an_unwritable_output_is_an_error(void **state)
{
    (void)state;
    const command_def plain = {0};
    expect_nothing("no_folder", &plain, "export " HEAD " -o no/such/folder/x.obj", 1);
    expect_nothing("a_device", &plain, "export " HEAD " -o /proc/version/x.obj", 1);
    expect_nothing("pc2_folder", &plain, "render " HEAD " --pose jaw.open=1 -o no/such/folder/x.pc2", 1);
}

static void an_interrupt_leaves_nothing(void **state)
{
    (void)state;
    const command_def def = {.interrupt_after_ms = 300};
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 16], words[2 * COMMAND_PATH_SIZE];
    command_folder(folder, "long_clip");
    snprintf(path, sizeof path, "%s/long.json", folder);
    command_write_file(
        path,
        "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 600, \"tracks\": [{\"target\": "
        "\"jaw.open\", \"keys\": [{\"t\": 0, \"v\": 0, \"ease\": \"linear\"}, {\"t\": 600, \"v\": 1, "
        "\"ease\": \"step\"}]}]}");
    snprintf(words, sizeof words, "render " HEAD " --clip '%s' -o x.pc2", path);
    expect_nothing("interrupt", &def, words, 130);
}

static void a_cache_has_every_frame(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], line[2 * COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 16];
    command_folder(folder, "cache");
    snprintf(path, sizeof path, "%s/x.pc2", folder);
    snprintf(line, sizeof line, "--device cpu render " HEAD " --pose jaw.open=0.3 --fps 24 -o '%s'", path);
    command_run(&run, NULL, line);
    assert_int_equal(run.code, 0);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char magic[12];
    int32_t head[5]; /* version, points, start, rate, samples */
    assert_int_equal(fread(magic, 1, 12, file), 12);
    assert_int_equal(fread(head, 4, 5, file), 5);
    assert_memory_equal(magic, "POINTCACHE2", 12);
    assert_int_equal(head[4], 48);
    fseek(file, 0, SEEK_END);
    assert_int_equal(ftell(file), 32 + 12L * head[1] * head[4]);
    fclose(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(info_is_json),
        cmocka_unit_test(export_keeps_the_order_of_the_skin),
        cmocka_unit_test(export_with_parts_adds_objects),
        cmocka_unit_test(a_full_disk_leaves_nothing),
        cmocka_unit_test(an_unwritable_output_is_an_error),
        cmocka_unit_test(an_interrupt_leaves_nothing),
        cmocka_unit_test(a_cache_has_every_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
