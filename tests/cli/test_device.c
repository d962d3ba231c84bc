/* Commands that need a Vulkan device: what they write, and what they say without one. */
#include "command.h"
#include "picture.h"

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
static char folder[COMMAND_PATH_SIZE];

/* Runs in the emptied folder `name` and expects the code and the number of files left. */
static void expect(const char *name, const command_def *def, const char *line, int code, uint32_t files)
{
    command_folder(folder, name);
    command_def here = def ? *def : (command_def){0};
    here.directory = folder;
    command_run(&run, &here, line);
    if (run.code != code || command_entries(folder) != files) {
        fail_msg("risorius %s: code %d (expected %d), %u files (expected %u), stderr '%s'", line, run.code,
                 code, command_entries(folder), files, run.err);
    }
}

static void load_picture(const char *name, picture *out)
{
    char path[COMMAND_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    picture_load(path, out);
}

static void without_a_driver_nothing_runs(void **state)
{
    (void)state;
    const command_def none = {
        .environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"}};
    static const char *const lines[] = {
        "export " HEAD " -o x.obj",
        "render " HEAD " --clip " CLIP " -o x.mp4",
        "render " HEAD " --pose jaw.open=1 -o x.png",
        "--device cpu render " HEAD " --pose jaw.open=1 -o x.png",
        "compare " HEAD " --clip " CLIP,
        "bench " HEAD,
        "validate",
        "devices",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        expect("no_driver", &none, lines[i], 4, 0);
        assert_non_null(strstr(run.err, "Vulkan"));
        assert_ptr_equal(strchr(run.err, '\n'), run.err + strlen(run.err) - 1);
    }
    /* the CPU reference is there when it is asked for */
    expect("no_driver", &none, "--device cpu export " HEAD " -o x.obj", 0, 1);
}

static void an_unknown_device_is_not_replaced(void **state)
{
    (void)state;
    expect("device", NULL, "--device nosuchcard export " HEAD " -o x.obj", 4, 0);
    assert_non_null(strstr(run.err, "nosuchcard"));
    expect("device", NULL, "--device 99 export " HEAD " -o x.obj", 4, 0);
}

static void the_cpu_is_not_compared_with_itself(void **state)
{
    (void)state;
    expect("itself", NULL, "--device cpu compare " HEAD " --clip " CLIP, 2, 0);
}

static void a_pose_gives_a_picture(void **state)
{
    (void)state;
    expect("pose", NULL, "render " HEAD " --pose zygomaticus_major=1 -o x.png --size 96x128 --view front,34",
           0, 1);
    picture shot;
    load_picture("x.png", &shot);
    assert_int_equal(shot.width, 192);
    assert_int_equal(shot.height, 128);
    assert_false(picture_is_blank(&shot));
    /* the control: a picture of one colour is blank */
    memset(shot.rgba, 128, (size_t)shot.width * (size_t)shot.height * 4);
    assert_true(picture_is_blank(&shot));
    picture_finish(&shot);
}

static void layers_give_other_pictures(void **state)
{
    (void)state;
    static const char *const layers[] = {"skin",
                                         "muscles,skull",
                                         "skin,muscles,skull,springs,landmarks",
                                         "strain",
                                         "strain --labels",
                                         "landmarks,strain --labels",
                                         "muscles --labels"};
    picture before = {0};
    for (size_t i = 0; i < sizeof layers / sizeof layers[0]; i++) {
        char line[1024];
        picture shot;
        snprintf(line, sizeof line,
                 "render " HEAD " --pose zygomaticus_major=1 -o x.png --size 96x128 --layers %s", layers[i]);
        expect("layers", NULL, line, 0, 1);
        load_picture("x.png", &shot);
        assert_false(picture_is_blank(&shot));
        if (before.rgba) {
            assert_memory_not_equal(before.rgba, shot.rgba, (size_t)shot.width * (size_t)shot.height * 4);
            picture_finish(&before);
        }
        before = shot;
    }
    picture_finish(&before);
}

static void a_plate_names_every_muscle(void **state)
{
    (void)state;
    expect("plate", NULL, "plate " HEAD " -o plate.png --size 700x750 --json", 0, 1);
    picture shot;
    load_picture("plate.png", &shot);
    assert_int_equal(shot.width, 700);
    assert_int_equal(shot.height, 750);
    assert_false(picture_is_blank(&shot));
    picture_finish(&shot);
    json_t *report = json_loads(run.out, 0, NULL);
    assert_non_null(report);
    assert_true(json_integer_value(json_object_get(report, "muscles")) > 40);
    assert_int_equal(json_integer_value(json_object_get(report, "named")),
                     json_integer_value(json_object_get(report, "muscles")));
    assert_int_equal(json_array_size(json_object_get(report, "hidden")), 0);
    json_decref(report);
    expect("plate", NULL, "plate " HEAD, 2, 0);
    expect("plate", NULL, "plate " HEAD " -o x.png --size 100x100", 2, 0);
}

/* Four poses, shuffled: the key tells which is which, the same seed gives the same picture, names hide nothing else. */
static void a_sheet_shuffles_and_keeps_the_key(void **state)
{
    (void)state;
    static const char line[] =
        "--device cpu sheet " HEAD " --poses jaw.open=1;AU12=1;AU1=1;AU43=1 --size 64x72 "
        "--view front --columns 2 -o x.png --key key.txt --hide-names -q --shuffle";
    char text[2048], path[COMMAND_PATH_SIZE + 16];
    picture shot[2];
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, "%s 7", line);
        expect("sheet", NULL, text, 0, 2);
        load_picture("x.png", &shot[k]);
    }
    assert_int_equal(shot[0].width, 128);
    assert_int_equal(shot[0].height, 2 * (72 + 26));
    assert_memory_equal(shot[0].rgba, shot[1].rgba, (size_t)shot[0].width * (size_t)shot[0].height * 4);
    snprintf(path, sizeof path, "%s/key.txt", folder);
    char *key = command_read_file(path);
    assert_non_null(key);
    assert_non_null(strstr(key, " jaw.open=1\n"));
    assert_non_null(strstr(key, " AU43=1\n"));
    snprintf(text, sizeof text, "%s 8", line);
    expect("sheet", NULL, text, 0, 2);
    char *other = command_read_file(path);
    assert_non_null(other);
    assert_string_not_equal(key, other);
    free(key);
    free(other);
    picture_finish(&shot[0]);
    picture_finish(&shot[1]);
    expect("sheet", NULL, "sheet " HEAD " --set smiles -o x.png", 2, 0);
    expect("sheet", NULL, "sheet " HEAD " --poses AU12=1;AU99=1 -o x.png", 2, 0);
    expect("sheet", NULL, "sheet " HEAD " --poses AU12=1; -o x.png", 2, 0);
}

/* A clip of half a second whose jaw opens. */
static void write_short_clip(char out[COMMAND_PATH_SIZE + 16])
{
    char place[COMMAND_PATH_SIZE];
    command_folder(place, "short_clip");
    snprintf(out, COMMAND_PATH_SIZE + 16, "%s/clip.json", place);
    command_write_file(
        out, "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 0.5, \"tracks\": [{\"target\": "
             "\"jaw.open\", \"keys\": [{\"t\": 0, \"v\": 0, \"ease\": \"cubic\"}, {\"t\": 0.4, \"v\": 1, "
             "\"ease\": \"step\"}]}]}");
}

static void a_clip_gives_all_outputs_at_once(void **state)
{
    (void)state;
    char clip[COMMAND_PATH_SIZE + 16], line[2 * COMMAND_PATH_SIZE];
    write_short_clip(clip);
    snprintf(line, sizeof line,
             "render " HEAD " --clip '%s' -o x.mp4 -o frames/%%03d.png -o x.pc2 --contact sheet.png "
             "--size 64x80 --fps 8 --json",
             clip);
    expect("outputs", NULL, line, 0, 4);
    char frames[COMMAND_PATH_SIZE + 16];
    snprintf(frames, sizeof frames, "%s/frames", folder);
    assert_int_equal(command_entries(frames), 4);
    picture sheet, first, last;
    load_picture("sheet.png", &sheet);
    assert_true(sheet.width >= 400 && sheet.height >= 880);
    assert_false(picture_is_blank(&sheet));
    load_picture("frames/000.png", &first);
    load_picture("frames/003.png", &last);
    assert_memory_not_equal(first.rgba, last.rgba, 64 * 80 * 4); /* the jaw has opened */
    picture_finish(&sheet);
    picture_finish(&first);
    picture_finish(&last);
    json_t *root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    assert_int_equal(json_integer_value(json_object_get(root, "frames")), 4);
    json_decref(root);
}

static void a_full_disk_leaves_nothing(void **state)
{
    (void)state;
    const command_def full = {.file_limit = 600};
    expect("full_png", &full, "render " HEAD " --pose jaw.open=1 -o x.png --size 128x128", 1, 0);
    expect("full_sequence", &full,
           "render " HEAD " --pose jaw.open=1 -o frames/%d.png --size 128x128 --fps 3", 1, 0);
    expect("full_mp4", &full, "render " HEAD " --pose jaw.open=1 -o x.mp4 --size 128x128 --fps 3", 1, 0);
}

static void without_ffmpeg_a_video_fails(void **state)
{
    (void)state;
    const command_def empty = {.environment = {"PATH=/nonexistent"}};
    expect("no_ffmpeg", &empty, "render " HEAD " --pose jaw.open=1 -o x.mp4 --size 64x64 --fps 2", 1, 0);
    assert_non_null(strstr(run.err, "ffmpeg"));
    expect("no_ffmpeg", &empty, "render " HEAD " --pose jaw.open=1 -o %d.png --size 64x64 --fps 1", 0, 2);
}

static void odd_sizes_make_no_video(void **state)
{
    (void)state;
    expect("odd", NULL, "render " HEAD " --pose jaw.open=1 -o x.mp4 --size 65x64", 2, 0);
}

static void bench_ends_where_compare_ends(void **state)
{
    (void)state;
    char clip[COMMAND_PATH_SIZE + 16], line[2 * COMMAND_PATH_SIZE], hash[32];
    write_short_clip(clip);
    snprintf(line, sizeof line, "compare " HEAD " --clip '%s' --json", clip);
    expect("compare", NULL, line, 0, 0);
    json_t *root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    assert_int_equal(json_integer_value(json_object_get(root, "frames")), 30);
    snprintf(hash, sizeof hash, "%s", json_string_value(json_array_get(json_object_get(root, "hash"), 1)));
    json_decref(root);
    snprintf(line, sizeof line, "bench " HEAD " --clip '%s' --repeat 2 --json", clip);
    expect("bench", NULL, line, 0, 0);
    root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    assert_string_equal(json_string_value(json_object_get(root, "hash")), hash);
    assert_true(json_array_size(json_object_get(root, "stages")) >= 8);
    json_decref(root);
}

static void a_clip_that_hardly_moves_proves_nothing(void **state)
{
    (void)state;
    char place[COMMAND_PATH_SIZE], clip[COMMAND_PATH_SIZE + 16], line[2 * COMMAND_PATH_SIZE];
    command_folder(place, "still_clip");
    snprintf(clip, sizeof clip, "%s/clip.json", place);
    command_write_file(
        clip,
        "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 0.2, \"tracks\": [{\"target\": "
        "\"jaw.open\", \"keys\": [{\"t\": 0, \"v\": 0, \"ease\": \"step\"}]}]}");
    snprintf(line, sizeof line, "compare " HEAD " --clip '%s'", clip);
    expect("still", NULL, line, 1, 0);
    assert_non_null(strstr(run.err, "500"));
}

static void validate_finds_nothing_wrong(void **state)
{
    (void)state;
    expect("validate", NULL, "validate --json", 0, 0);
    json_t *root = json_loads(run.out, 0, NULL);
    assert_non_null(root);
    assert_true(json_is_true(json_object_get(root, "good")));
    assert_int_equal(json_array_size(json_object_get(root, "checks")), 4);
    json_decref(root);
}

int main(void)
{
    command_run(&run, NULL, "devices");
    if (run.code != 0) {
        const char *required = getenv("RIS_REQUIRE_GPU");
        fprintf(stderr, "no device: %s", run.err);
        return required && strcmp(required, "1") == 0 ? 1 : 77;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_driver_nothing_runs),
        cmocka_unit_test(an_unknown_device_is_not_replaced),
        cmocka_unit_test(the_cpu_is_not_compared_with_itself),
        cmocka_unit_test(a_pose_gives_a_picture),
        cmocka_unit_test(layers_give_other_pictures),
        cmocka_unit_test(a_plate_names_every_muscle),
        cmocka_unit_test(a_sheet_shuffles_and_keeps_the_key),
        cmocka_unit_test(a_clip_gives_all_outputs_at_once),
        cmocka_unit_test(a_full_disk_leaves_nothing),
        cmocka_unit_test(without_ffmpeg_a_video_fails),
        cmocka_unit_test(odd_sizes_make_no_video),
        cmocka_unit_test(bench_ends_where_compare_ends),
        cmocka_unit_test(a_clip_that_hardly_moves_proves_nothing),
        cmocka_unit_test(validate_finds_nothing_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
