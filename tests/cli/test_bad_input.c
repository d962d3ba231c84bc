/* Files that are missing or wrong: exit code 3 (2 for names on the command line), one sentence that says where. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define CLIP "'" RIS_SOURCE_DIR "/assets/clips/first_light.json'"

static run_result run;

static void expect_code(const char *what, int code, const char *in_err)
{
    const char *newline = strchr(run.err, '\n');
    if (run.code != code || !strstr(run.err, in_err) || !newline || newline[1] != '\0') {
        fail_msg("%s: code %d (expected %d), stderr '%s' (expected one line with '%s')", what, run.code, code,
                 run.err, in_err);
    }
}

/* `risorius info` on a head of which one file is spoiled. */
static void expect_bad_file(const char *name, const char *file, const char *text, const char *in_err)
{
    char folder[COMMAND_PATH_SIZE], line[COMMAND_PATH_SIZE + 32];
    command_folder(folder, name);
    command_spoil_head(folder, file, text);
    snprintf(line, sizeof line, "info '%s'", folder);
    command_run(&run, NULL, line);
    expect_code(name, 3, in_err);
    assert_non_null(strstr(run.err, file));
}

/* `risorius export` with a clip of the given text; never writes. */
static void expect_bad_clip(const char *name, const char *text, const char *in_err)
{
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 32], line[3 * COMMAND_PATH_SIZE];
    command_folder(folder, name);
    snprintf(path, sizeof path, "%s/clip.json", folder);
    command_write_file(path, text);
    snprintf(line, sizeof line, "--device cpu export " HEAD " --clip '%s' --at 0 -o '%s/out.obj'", path,
             folder);
    command_run(&run, NULL, line);
    expect_code(name, 3, in_err);
    assert_int_equal(command_entries(folder), 1);
}

static void missing_files(void **state)
{
    (void)state;
    command_run(&run, NULL, "info '" RIS_BUILD_DIR "/no-such-head'");
    expect_code("no head", 3, "no-such-head");
    command_run(&run, NULL, "info " HEAD "/skin.obj");
    expect_code("a file as head", 3, "skin.obj");
    command_run(&run, NULL,
                "--device cpu export " HEAD " --clip no-such-clip.json --at 0 -o '" RIS_BUILD_DIR
                "/never.obj'");
    expect_code("no clip", 3, "no-such-clip.json");
    assert_false(command_exists(RIS_BUILD_DIR "/never.obj"));
}

static void bad_json_names_line_and_column(void **state)
{
    (void)state;
    expect_bad_file("json_syntax", "head.json", "{\"format\": \"risorius-head\",\n  \"version\": 1,,\n}",
                    "head.json:2:");
    expect_bad_file("json_empty", "head.json", "", "head.json:");
    expect_bad_file("json_other", "head.json", "{\"format\": \"risorius-clip\", \"version\": 1}",
                    "head.json:1:");
    expect_bad_file("json_key", "head.json",
                    "{\"format\": \"risorius-head\", \"version\": 1,\n \"colour\": \"x\"}", "colour");
    expect_bad_file("json_deep", "head.json", "[[[[[[[[[[[[[[[[", "head.json:1:");
    expect_bad_file("json_muscles", "muscles.json",
                    "{\"format\": \"risorius-muscles\", \"version\": 2, \"muscles\": []}", "version");
}

static void bad_meshes(void **state)
{
    (void)state;
    expect_bad_file("obj_nan", "skin.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", "skin.obj:2:");
    expect_bad_file("obj_index", "skin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "skin.obj:4:");
    expect_bad_file("obj_zero", "skin.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "area");
    expect_bad_file("obj_isolated", "skin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n", "isolated");
    expect_bad_file("obj_empty", "skin.obj", "# nothing\n", "skin.obj");
    expect_bad_file("obj_huge_index", "skin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n",
                    "skin.obj:4:");
}

static void bad_clips(void **state)
{
    (void)state;
    expect_bad_clip("clip_empty", "", "clip.json:");
    expect_bad_clip("clip_no_tracks",
                    "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 1, \"tracks\": []}",
                    "clip.json:1:");
    expect_bad_clip(
        "clip_muscle",
        "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 1,\n \"tracks\": [\n  {\"target\": "
        "\"zygomaticus_mayor\", \"keys\": [{\"t\": 0, \"v\": 0, \"ease\": \"step\"}]}]}",
        "clip.json:3:");
    assert_non_null(strstr(run.err, "zygomaticus_major"));
    expect_bad_clip("clip_long",
                    "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 1e300, \"tracks\": []}",
                    "clip.json:1:");
    expect_bad_clip(
        "clip_order",
        "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 1,\n \"tracks\": [{\"target\": "
        "\"jaw.open\", \"keys\": [{\"t\": 1, \"v\": 0, \"ease\": \"step\"}, {\"t\": 0, \"v\": 1, \"ease\": "
        "\"step\"}]}]}",
        "clip.json:2:");
}

/* 86,400 s x 60 x 1,000 samples do not fit 32 bits. */
static void an_endless_benchmark_is_refused(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 32], line[3 * COMMAND_PATH_SIZE];
    command_folder(folder, "endless");
    snprintf(path, sizeof path, "%s/clip.json", folder);
    command_write_file(path,
                       "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 86400, \"tracks\": "
                       "[{\"target\": \"jaw.open\", \"keys\": [{\"t\": 0, \"v\": 0}]}]}");
    snprintf(line, sizeof line, "--device cpu bench " HEAD " --clip '%s' --repeat 1000", path);
    command_run(&run, NULL, line);
    expect_code("endless", 2, "5184000 frames x 1000 repeats");
}

static void unknown_names_on_the_command_line(void **state)
{
    (void)state;
    command_run(&run, NULL,
                "--device cpu export " HEAD " --pose zygomaticus_mayor=1 -o '" RIS_BUILD_DIR "/never.obj'");
    expect_code("pose", 2, "zygomaticus_major");
    command_run(&run, NULL,
                "--device cpu export " HEAD " --pose jaw.open=wide -o '" RIS_BUILD_DIR "/never.obj'");
    expect_code("pose value", 2, "wide");
    assert_false(command_exists(RIS_BUILD_DIR "/never.obj"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_files),
        cmocka_unit_test(bad_json_names_line_and_column),
        cmocka_unit_test(bad_meshes),
        cmocka_unit_test(bad_clips),
        cmocka_unit_test(an_endless_benchmark_is_refused),
        cmocka_unit_test(unknown_names_on_the_command_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
