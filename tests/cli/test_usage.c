/* The command line itself: help, version, wrong words, exit codes. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define CLIP "'" RIS_SOURCE_DIR "/assets/clips/first_light.json'"

static run_result run;

static const char *const commands[] = {"devices", "info",  "view",  "render",   "export", "compare", "bench",
                                       "soak",    "solve", "pairs", "validate", "plate",  "sheet"};

static void expect(const char *line, int code, const char *in_err)
{
    command_run(&run, NULL, line);
    if (run.code != code || (in_err && !strstr(run.err, in_err))) {
        fail_msg("risorius %s: code %d (expected %d), stderr '%s' (expected '%s')", line, run.code, code,
                 run.err, in_err ? in_err : "");
    }
}

static void help_names_every_command(void **state)
{
    (void)state;
    expect("--help", 0, NULL);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        assert_non_null(strstr(run.out, commands[i]));
    }
    assert_string_equal(run.err, "");
    expect("help", 0, NULL);
    assert_non_null(strstr(run.out, "usage"));
}

static void every_command_has_help(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char line[64], usage[64];
        snprintf(line, sizeof line, "%s --help", commands[i]);
        snprintf(usage, sizeof usage, "usage: risorius %s", commands[i]);
        expect(line, 0, NULL);
        assert_non_null(strstr(run.out, usage));
        assert_non_null(strstr(run.out, "--device"));
        snprintf(line, sizeof line, "help %s", commands[i]);
        expect(line, 0, NULL);
        assert_non_null(strstr(run.out, usage));
    }
}

static void version_is_the_library_version(void **state)
{
    (void)state;
    expect("--version", 0, NULL);
    assert_string_equal(run.out, "risorius " RIS_VERSION_STRING "\n");
    expect("info --version", 0, NULL);
    assert_string_equal(run.out, "risorius " RIS_VERSION_STRING "\n");
}

static void wrong_words_are_usage_errors(void **state)
{
    (void)state;
    expect("", 2, "command");
    expect("rendr", 2, "render");
    expect("--devise cpu info", 2, "--device");
    expect("info", 2, "HEAD");
    expect("info " HEAD " --jsn", 2, "--json");
    expect("info " HEAD " another", 2, "another");
    expect("render " HEAD " --clip", 2, "--clip");
    expect("render " HEAD " --clp x", 2, "--clip");
    expect("render " HEAD " -x", 2, "-x");
    expect("render " HEAD " --quiet=3", 2, "--quiet");
    expect("render " HEAD, 2, "--clip");
    expect("render " HEAD " --clip a --pose b=1 -o o.png", 2, "both");
    expect("render " HEAD " --clip a", 2, "-o");
    expect("render " HEAD " --clip a -o picture.jpeg", 2, ".png");
    expect("render " HEAD " --clip a -o '%s'.png", 2, "%d");
    expect("render " HEAD " --clip a -o %04d%04d.png", 2, "%d");
    expect("render " HEAD " --clip a -o a%n.png", 2, "%d");
    expect("render " HEAD " --clip a -o one.png", 2, "--at");
    expect("render " HEAD " --clip a -o a.mp4 -o a.mp4", 2, "two outputs");
    expect("render " HEAD " --clip a -o a%d.png --contact a%d.png", 2, "two outputs");
    expect("export " HEAD, 2, "-o");
    expect("export " HEAD " --clip c -o x.obj", 2, "--at");
#ifdef RISORIUS_VULKAN
    expect("compare " HEAD, 2, "--clip");
#endif
}

static void absurd_numbers_are_usage_errors(void **state)
{
    (void)state;
    static const char *const sizes[] = {
        "0x0",     "1x1",       "100000x100000",          "-640x480", "640",    "640x", "x480",
        "640X480", "640x480x3", "99999999999999999999x5", "nanxnan",  "6e2x480"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        char line[512];
        snprintf(line, sizeof line, "render " HEAD " --pose jaw.open=1 -o x.png --size %s", sizes[i]);
        expect(line, 2, "--size");
    }
    expect("render " HEAD " --pose jaw.open=1 -o x.mp4 --fps 0", 2, "--fps");
    expect("render " HEAD " --pose jaw.open=1 -o x.mp4 --fps 1e9", 2, "--fps");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --view top", 2, "top");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --view front,", 2, "--view");
    expect("render " HEAD " --clip " CLIP " -o x.png --at nan", 2, "--at");
    expect("render " HEAD " --pose jaw.open=1 -o x.mp4 --loops 2", 2, "--loops is for a clip");
    expect("render " HEAD " --clip " CLIP " -o x.pc2 --loops 0", 2, "--loops");
    expect("render " HEAD " --clip " CLIP " -o x.pc2 --loops 2 --device cpu", 2, "does not repeat");
    expect("render " HEAD " --clip " CLIP " -o x.png --at -1", 2, "--at");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --layers skin,mucles", 2, "muscles");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --layers skin,", 2, "--layers");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --layers ''", 2, "--layers");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --labels", 2, "--layers");
    expect("render " HEAD " --pose jaw.open=1 -o x.png --labels --layers skin", 2, "--layers");
    expect("bench " HEAD " --repeat 0", 2, "--repeat");
}

static void a_program_beside_it_is_a_command(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 32], environment[2 * COMMAND_PATH_SIZE];
    command_folder(folder, "verbs");
    snprintf(path, sizeof path, "%s/risorius-hello", folder);
    command_write_file(path, "#!/bin/sh\necho \"hello $1\"\nexit 7\n");
    chmod(path, 0755);
    snprintf(environment, sizeof environment, "PATH=%s:/usr/bin:/bin", folder);
    const command_def def = {.environment = {environment}};
    command_run(&run, &def, "hello you");
    assert_int_equal(run.code, 7);
    assert_string_equal(run.out, "hello you\n");
    /* names that are not verbs are never looked for */
    command_run(&run, &def, "../verbs/risorius-hello");
    assert_int_equal(run.code, 2);
}

static void a_full_standard_output_is_an_error(void **state)
{
    (void)state;
    const command_def def = {.out_path = "/dev/full"};
    command_run(&run, &def, "--help");
    assert_int_equal(run.code, 1);
    assert_non_null(strstr(run.err, "standard output"));
}

#ifdef RISORIUS_VULKAN
static void a_sheet_needs_its_words(void **state)
{
    (void)state;
    expect("sheet " HEAD " --set facs", 2, "sheet needs -o FILE.png");
    expect("sheet " HEAD " -o x.png", 2, "sheet needs --set NAME or --poses LIST");
    expect("sheet " HEAD " -o x.png --set facs --poses AU1=1", 2, "not both");
    expect("sheet " HEAD " -o x.png --set facs --hide-names", 2, "--hide-names needs --key FILE");
    expect("sheet " HEAD " -o x.png --set facs --key x.png", 2, "named as two outputs");
    expect("sheet " HEAD " -o x.png --set ekman", 2,
           "expected facs, arkit, visemes or expressions, found 'ekman'");
    expect("sheet " HEAD " -o x.png --set facs --zoom 0", 2, "zoom");
    expect("sheet " HEAD " -o x.png --set facs --shuffle x", 2, "shuffle");
}
#endif

/* The tables of docs/facs.md are what the command prints. */
static void the_document_lists_the_vocabulary(void **state)
{
    (void)state;
    static const char mark[] = "<!-- names -->\n";
    char *text = command_read_file(RIS_SOURCE_DIR "/docs/facs.md");
    assert_non_null(text);
    const char *tables = strstr(text, mark);
    assert_non_null(tables);
    expect("info " HEAD " --names", 0, NULL);
    assert_non_null(strstr(run.out, "| `AU12` | Lip Corner Puller | zygomaticus_major 1 |"));
    assert_string_equal(tables + strlen(mark), run.out);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_names_every_command),
        cmocka_unit_test(every_command_has_help),
        cmocka_unit_test(version_is_the_library_version),
        cmocka_unit_test(wrong_words_are_usage_errors),
        cmocka_unit_test(absurd_numbers_are_usage_errors),
        cmocka_unit_test(a_program_beside_it_is_a_command),
        cmocka_unit_test(a_full_standard_output_is_an_error),
#ifdef RISORIUS_VULKAN
        cmocka_unit_test(a_sheet_needs_its_words),
#endif
        cmocka_unit_test(the_document_lists_the_vocabulary),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
