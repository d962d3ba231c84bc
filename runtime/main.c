/* The `risorius` command: global options, the table of sub-commands, and programs named risorius-<verb>, as git does. */
#include "cli.h"
#include "base/text.h"

#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef PATH_MAX
#define PATH_MAX 4096
#endif

static const cli_command *const commands[] = {
    &cmd_devices, &cmd_solve, &cmd_pairs, &cmd_info,     &cmd_view,  &cmd_render, &cmd_export, &cmd_compare,
    &cmd_bench,   &cmd_soak,  &cmd_score, &cmd_validate, &cmd_plate, &cmd_sheet,  NULL};

/* Programs of this project that are found as risorius-<verb>. */
static const struct {
    const char *verb, *summary;
} programs[] = {
    {"make-head", "make a head folder from a base mesh"},
    {"paint-head", "paint the textures of a head folder"},
};

static void print_overview(FILE *out)
{
    fprintf(out,
            "Risorius %s: an anatomical face engine on Vulkan.\n\nusage: risorius [--device D] [-q] [-v] "
            "COMMAND ...\n\n",
            RIS_VERSION_STRING);
    for (uint32_t i = 0; commands[i]; i++) {
        fprintf(out, "  %-12s %s\n", commands[i]->name, commands[i]->summary);
    }
    fprintf(out, "\nprograms beside it:\n");
    for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
        fprintf(out, "  %-12s %s\n", programs[i].verb, programs[i].summary);
    }
    fprintf(
        out,
        "\n`risorius COMMAND --help` tells the rest. Exit codes: 0 done, 1 failed, 2 wrong command line,\n"
        "3 bad data in a file, 4 no usable device.\n");
}

static const cli_command *find_command(const char *name)
{
    for (uint32_t i = 0; commands[i]; i++) {
        if (strcmp(commands[i]->name, name) == 0) {
            return commands[i];
        }
    }
    return NULL;
}

static bool is_verb(const char *name)
{
    size_t length = strlen(name);
    return length > 0 && length < 64 && strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-") == length;
}

/* Replaces this process by risorius-<argv[0]> from the folder of this program, its libexec, or PATH; returns only if
 * there is none. */
static void run_program(char **argv)
{
    char self[PATH_MAX], path[PATH_MAX + 96];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length > 0) {
        self[length] = '\0';
        char *slash = strrchr(self, '/');
        if (slash) {
            *slash = '\0';
        }
        snprintf(path, sizeof path, "%s/risorius-%s", self, argv[0]);
        execv(path, argv);
        snprintf(path, sizeof path, "%s/../libexec/risorius/risorius-%s", self, argv[0]);
        execv(path, argv);
    }
    snprintf(path, sizeof path, "risorius-%s", argv[0]);
    execvp(path, argv);
}

static ris_result unknown_command(const char *name, ris_error *err)
{
    ris_nearest nearest;
    ris__nearest_init(&nearest, name);
    for (uint32_t i = 0; commands[i]; i++) {
        ris__nearest_add(&nearest, commands[i]->name);
    }
    for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
        ris__nearest_add(&nearest, programs[i].verb);
    }
    return ris_fail(err, RIS_ERROR_USAGE, "unknown command '%.64s'; the nearest is %s", name,
                    nearest.name[0]);
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    int index = 1;
    ris_result r = cli_parse_global(cli, argc, argv, &index, err);
    if (r || cli->done) {
        return r;
    }
    bool help = cli->help;
    if (index < argc && strcmp(argv[index], "help") == 0) {
        help = true;
        index++;
    }
    if (index >= argc) {
        print_overview(help ? stdout : stderr);
        return help ? RIS_OK : ris_fail(err, RIS_ERROR_USAGE, "a command is needed");
    }
    const cli_command *command = find_command(argv[index]);
    if (!command) {
        if (is_verb(argv[index])) {
            run_program(argv + index);
        }
        return unknown_command(argv[index], err);
    }
    if (help) {
        char *words[] = {argv[index], (char[]){"--help"}, NULL};
        return command->run(cli, 2, words, err);
    }
    return command->run(cli, argc - index, argv + index, err);
}

int main(int argc, char **argv)
{
    setlocale(LC_ALL, "C");
    interrupt_install();
    ris_cli cli = {.program = argc > 0 ? argv[0] : "risorius"};
    ris_error err = {0};
    ris_result result = run(&cli, argc, argv, &err);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        if (!result) {
            result =
                ris_fail(&err, RIS_ERROR_FAILED, "cannot write to the standard output: %s", strerror(errno));
        }
    }
    if (result && interrupt_seen()) {
        interrupt_check(&err); /* Ctrl-C reaches ffmpeg too, whose end is then not the news */
    }
    if (result) {
        fprintf(stderr, "risorius: %s\n", err.text);
    }
    return interrupt_seen() ? 130 : ris_exit_code(result);
}
