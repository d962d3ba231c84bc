/* What every sub-command of the `risorius` program shares: its place in the table, options, progress, interruption. */
#pragma once

#include "risorius/head.h"

#include <stdio.h>

/* Choices that hold for every command, set by global options. */
typedef struct ris_cli {
    const char *program; /* argv[0] */
    const char *device;  /* "cpu", index or part of a name; NULL = first usable Vulkan device */
    bool json, quiet, verbose;
    bool done; /* --help or --version was answered: the command returns at once */
    bool help; /* --help before the command's name */
} ris_cli;

typedef struct cli_command {
    const char *name;
    const char *usage; /* what follows the name: "HEAD (--clip C | --pose P) -o OUT" */
    const char *summary;
    const char *detail; /* more help, may be NULL */
    ris_result (*run)(ris_cli *cli, int argc, char **argv,
                      ris_error *err); /* argv[0] is the command's name */
} cli_command;

extern const cli_command cmd_devices, cmd_info, cmd_render, cmd_export, cmd_compare, cmd_bench, cmd_soak,
    cmd_score, cmd_validate, cmd_view, cmd_plate, cmd_sheet;

extern const cli_command cmd_pairs, cmd_solve;

#define CLI_LIST_SIZE 8

/* The values of an option that may be given several times. */
typedef struct cli_list {
    const char *item[CLI_LIST_SIZE];
    uint32_t count;
} cli_list;

/* One option of a command; exactly one of flag, text, list is set. A table ends with a zeroed record. */
typedef struct cli_option {
    const char *name;  /* long name without dashes */
    char letter;       /* short name, 0 = none */
    const char *value; /* name of the value in the help, NULL for a flag */
    const char *help;
    bool *flag;
    const char **text;
    cli_list *list;
} cli_option;

/* Reads argv[1..] by the command's options and the global ones; other words go to positional (at most
 * positional_capacity, *out_count of them). Answers --help on stdout and sets cli->done.
 * RIS_ERROR_USAGE for an unknown option (with the nearest), a missing value, too many words. */
ris_result cli_parse(ris_cli *cli, const cli_command *command, const cli_option *options, int argc,
                     char **argv, const char **positional, uint32_t positional_capacity, uint32_t *out_count,
                     ris_error *err);

/* Reads leading global options of argv[*index..] before the command's name; stops at the first other word. */
ris_result cli_parse_global(ris_cli *cli, int argc, char **argv, int *index, ris_error *err);

/* The one positional word of most commands: the head folder. */
ris_result cli_need_head(const cli_command *command, uint32_t count, ris_error *err);

/* Numbers on the command line, C locale. RIS_ERROR_USAGE naming the option and the range. */
ris_result cli_number(const char *option, const char *text, double minimum, double maximum, double *out,
                      ris_error *err);
ris_result cli_count(const char *option, const char *text, uint32_t minimum, uint32_t maximum, uint32_t *out,
                     ris_error *err);
/* The kind of words that --set names: facs, arkit, visemes or expressions. */
ris_result cli_set(const char *text, ris_word_kind *out, ris_error *err);
/* "WxH", each side 16..8192 pixels. */
ris_result cli_size(const char *option, const char *text, uint32_t *out_width, uint32_t *out_height,
                    ris_error *err);

/* A progress line on stderr: a bar redrawn in place on a terminal, else a line every tenth; silent with -q. */
typedef struct ris_progress {
    const char *title;
    bool silent, terminal;
    uint32_t last;
    uint64_t start_ns;
} ris_progress;

void progress_start(ris_progress *bar, const ris_cli *cli, const char *title);
void progress_show(ris_progress *bar, uint32_t done, uint32_t total);
void progress_end(ris_progress *bar);

/* Ctrl-C sets a flag that long loops look at. */
void interrupt_install(void);
bool interrupt_seen(void);
/* RIS_OK, or RIS_ERROR_FAILED "interrupted" once Ctrl-C was pressed. */
ris_result interrupt_check(ris_error *err);

/* Text as a JSON string with quotes on stdout. */
void cli_json_string(FILE *out, const char *text);
