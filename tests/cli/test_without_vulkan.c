/* A build without Vulkan says so, and still simulates on the CPU. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define CLIP "'" RIS_SOURCE_DIR "/assets/clips/first_light.json'"

static run_result run;

static void what_needs_vulkan_says_so(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "view " HEAD,
        "compare " HEAD " --clip " CLIP,
        "validate",
        "render " HEAD " --pose jaw.open=1 -o x.png",
        "--device cpu render " HEAD " --pose jaw.open=1 -o x.png",
        "export " HEAD " -o x.obj",
        "bench " HEAD,
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        command_run(&run, NULL, lines[i]);
        if (run.code != 4 || !strstr(run.err, "without Vulkan")) {
            fail_msg("risorius %s: code %d, %s", lines[i], run.code, run.err);
        }
    }
}

static void the_cpu_simulates(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], line[2 * COMMAND_PATH_SIZE];
    command_folder(folder, "cpu_only");
    snprintf(line, sizeof line, "--device cpu render " HEAD " --pose jaw.open=1 --fps 10 -o '%s/x.pc2'",
             folder);
    command_run(&run, NULL, line);
    assert_int_equal(run.code, 0);
    assert_int_equal(command_entries(folder), 1);
    command_run(&run, NULL, "--device cpu bench --repeat 1 -q");
    assert_int_equal(run.code, 0);
    command_run(&run, NULL, "devices");
    assert_int_equal(run.code, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_needs_vulkan_says_so),
        cmocka_unit_test(the_cpu_simulates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
