/* Command lines: the options of a command and the global ones, help texts, and numbers with their ranges. */
#include "cli.h"
#include "base/text.h"

#include <math.h>
#include <string.h>

#define GLOBAL_COUNT 7

/* The global options, bound to one cli. help and version have neither flag nor text of their own. */
static void global_options(ris_cli *cli, bool *help, bool *version, cli_option out[GLOBAL_COUNT + 1])
{
    const cli_option table[GLOBAL_COUNT + 1] = {
        {"device", 0, "cpu|INDEX|NAME", "where the simulation runs (default: the first usable Vulkan device)",
         NULL, &cli->device, NULL},
        {"json", 0, NULL, "print the result as JSON", &cli->json, NULL, NULL},
        {"quiet", 'q', NULL, "no progress, no notes", &cli->quiet, NULL, NULL},
        {"verbose", 'v', NULL, "more notes", &cli->verbose, NULL, NULL},
        {"help", 'h', NULL, "this text", help, NULL, NULL},
        {"version", 0, NULL, "the version", version, NULL, NULL},
        {0},
    };
    memcpy(out, table, sizeof table);
}

static void print_options(const cli_option *options)
{
    for (const cli_option *o = options; o->name; o++) {
        char left[64];
        char letter[8] = "    ";
        if (o->letter) {
            snprintf(letter, sizeof letter, "-%c, ", o->letter);
        }
        snprintf(left, sizeof left, "%s--%s%s%s", letter, o->name, o->value ? " " : "",
                 o->value ? o->value : "");
        printf("  %-34s %s\n", left, o->help);
    }
}

static void print_help(ris_cli *cli, const cli_command *command, const cli_option *options)
{
    bool unused;
    cli_option global[GLOBAL_COUNT + 1];
    global_options(cli, &unused, &unused, global);
    printf("usage: risorius %s %s\n\n%s\n", command->name, command->usage, command->summary);
    if (command->detail) {
        printf("\n%s", command->detail);
    }
    if (options[0].name) {
        printf("\noptions:\n");
        print_options(options);
    }
    printf("\neverywhere:\n");
    print_options(global);
}

static const cli_option *find_long(const cli_option *options, const char *name, size_t length)
{
    for (const cli_option *o = options; o->name; o++) {
        if (strlen(o->name) == length && strncmp(o->name, name, length) == 0) {
            return o;
        }
    }
    return NULL;
}

static const cli_option *find_letter(const cli_option *options, char letter)
{
    for (const cli_option *o = options; o->name; o++) {
        if (o->letter && o->letter == letter) {
            return o;
        }
    }
    return NULL;
}

static ris_result unknown_option(const char *where, const char *word, const cli_option *own,
                                 const cli_option *global, ris_error *err)
{
    char name[64];
    size_t length = strcspn(word, "=");
    snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), word);
    ris_nearest nearest;
    ris__nearest_init(&nearest, name + strspn(name, "-"));
    for (const cli_option *o = own; o && o->name; o++) {
        ris__nearest_add(&nearest, o->name);
    }
    for (const cli_option *o = global; o->name; o++) {
        ris__nearest_add(&nearest, o->name);
    }
    return ris_fail(err, RIS_ERROR_USAGE, "unknown option '%s' of %s; the nearest is --%s", name, where,
                    nearest.name[0]);
}

static ris_result store(const cli_option *option, const char *value, ris_error *err)
{
    if (option->flag) {
        *option->flag = true;
    } else if (option->text) {
        if (*option->text && strcmp(*option->text, value) != 0) {
            return ris_fail(err, RIS_ERROR_USAGE, "--%s is given twice: '%s' and '%s'", option->name,
                            *option->text, value);
        }
        *option->text = value;
    } else if (option->list->count == CLI_LIST_SIZE) {
        return ris_fail(err, RIS_ERROR_USAGE, "--%s is given more than %d times", option->name,
                        CLI_LIST_SIZE);
    } else {
        option->list->item[option->list->count++] = value;
    }
    return RIS_OK;
}

/* One option word at argv[*index], with its value in the same word ("--a=b", "-ob") or in the next. */
static ris_result parse_option(const char *where, const cli_option *own, const cli_option *global, int argc,
                               char **argv, int *index, ris_error *err)
{
    const char *word = argv[*index];
    const char *value = NULL;
    const cli_option *option;
    if (word[1] == '-') {
        size_t length = strcspn(word + 2, "=");
        option = own ? find_long(own, word + 2, length) : NULL;
        if (!option) {
            option = find_long(global, word + 2, length);
        }
        value = word[2 + length] == '=' ? word + 2 + length + 1 : NULL;
    } else {
        option = own ? find_letter(own, word[1]) : NULL;
        if (!option) {
            option = find_letter(global, word[1]);
        }
        value = word[2] != '\0' ? word + 2 : NULL;
    }
    if (!option) {
        return unknown_option(where, word, own, global, err);
    }
    if (option->flag) {
        if (value) {
            return ris_fail(err, RIS_ERROR_USAGE, "--%s takes no value, found '%s'", option->name, word);
        }
    } else if (!value) {
        if (*index + 1 >= argc) {
            return ris_fail(err, RIS_ERROR_USAGE, "--%s needs a value: %s", option->name, option->value);
        }
        value = argv[++*index];
    }
    return store(option, value, err);
}

ris_result cli_parse(ris_cli *cli, const cli_command *command, const cli_option *options, int argc,
                     char **argv, const char **positional, uint32_t positional_capacity, uint32_t *out_count,
                     ris_error *err)
{
    bool help = false, version = false, only_words = false;
    cli_option global[GLOBAL_COUNT + 1];
    global_options(cli, &help, &version, global);
    *out_count = 0;
    for (int i = 1; i < argc; i++) {
        if (!only_words && strcmp(argv[i], "--") == 0) {
            only_words = true;
        } else if (!only_words && argv[i][0] == '-' && argv[i][1] != '\0') {
            ris_result r = parse_option(command->name, options, global, argc, argv, &i, err);
            if (r) {
                return r;
            }
        } else if (*out_count == positional_capacity) {
            return ris_fail(err, RIS_ERROR_USAGE, "unexpected '%s'; usage: risorius %s %s", argv[i],
                            command->name, command->usage);
        } else {
            positional[(*out_count)++] = argv[i];
        }
    }
    if (help) {
        print_help(cli, command, options);
    } else if (version) {
        printf("risorius %s\n", RIS_VERSION_STRING);
    }
    cli->done = help || version;
    return RIS_OK;
}

ris_result cli_parse_global(ris_cli *cli, int argc, char **argv, int *index, ris_error *err)
{
    bool help = false, version = false;
    cli_option global[GLOBAL_COUNT + 1];
    global_options(cli, &help, &version, global);
    for (; *index < argc && argv[*index][0] == '-'; ++*index) {
        ris_result r = parse_option("risorius", NULL, global, argc, argv, index, err);
        if (r) {
            return r;
        }
    }
    if (version && !help) {
        printf("risorius %s\n", RIS_VERSION_STRING);
        cli->done = true;
    }
    cli->help = help;
    return RIS_OK;
}

ris_result cli_need_head(const cli_command *command, uint32_t count, ris_error *err)
{
    if (count == 0) {
        return ris_fail(err, RIS_ERROR_USAGE, "%s needs a head folder; usage: risorius %s %s", command->name,
                        command->name, command->usage);
    }
    return RIS_OK;
}

ris_result cli_number(const char *option, const char *text, double minimum, double maximum, double *out,
                      ris_error *err)
{
    const char *end = text + strlen(text);
    double value = 0;
    if (ris__parse_number(text, end, &value) != end || end == text ||
        !(value >= minimum && value <= maximum)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--%s: expected a number from %g to %g, found '%.64s'", option,
                        minimum, maximum, text);
    }
    *out = value;
    return RIS_OK;
}

ris_result cli_count(const char *option, const char *text, uint32_t minimum, uint32_t maximum, uint32_t *out,
                     ris_error *err)
{
    const char *end = text + strlen(text);
    int64_t value = 0;
    if (ris__parse_integer(text, end, &value) != end || end == text || value < (int64_t)minimum ||
        value > (int64_t)maximum) {
        return ris_fail(err, RIS_ERROR_USAGE, "--%s: expected a whole number from %u to %u, found '%.64s'",
                        option, minimum, maximum, text);
    }
    *out = (uint32_t)value;
    return RIS_OK;
}

ris_result cli_set(const char *text, ris_word_kind *out, ris_error *err)
{
    static const char *const names[RIS_WORD_KINDS] = {"facs", "arkit", "visemes", "expressions"};
    for (int kind = 0; kind < RIS_WORD_KINDS; kind++) {
        if (strcmp(names[kind], text) == 0) {
            *out = (ris_word_kind)kind;
            return RIS_OK;
        }
    }
    return ris_fail(err, RIS_ERROR_USAGE,
                    "--set: expected facs, arkit, visemes or expressions, found '%.40s'", text);
}

ris_result cli_size(const char *option, const char *text, uint32_t *out_width, uint32_t *out_height,
                    ris_error *err)
{
    const char *end = text + strlen(text);
    int64_t width = 0, height = 0;
    const char *cross = ris__parse_integer(text, end, &width);
    if (!cross || *cross != 'x' || ris__parse_integer(cross + 1, end, &height) != end || width < 16 ||
        width > 8192 || height < 16 || height > 8192) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "--%s: expected WIDTHxHEIGHT with sides from 16 to 8192, found '%.64s'", option,
                        text);
    }
    *out_width = (uint32_t)width;
    *out_height = (uint32_t)height;
    return RIS_OK;
}

void cli_json_string(FILE *out, const char *text)
{
    fputc('"', out);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\') {
            fprintf(out, "\\%c", *c);
        } else if (*c < 0x20) {
            fprintf(out, "\\u%04x", *c);
        } else {
            fputc(*c, out);
        }
    }
    fputc('"', out);
}
