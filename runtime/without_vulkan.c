/* The commands that cannot exist without Vulkan say so; their help is there all the same. */
#include "cli.h"

#include <string.h>

static ris_result refuse(ris_cli *cli, const cli_command *command, int argc, char **argv, ris_error *err)
{
    const cli_option options[] = {{0}};
    uint32_t count;
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        return cli_parse(cli, command, options, argc, argv, NULL, 0, &count, err);
    }
    return ris_fail(err, RIS_ERROR_DEVICE,
                    "'%s' needs Vulkan, and this risorius was built without Vulkan (RISORIUS_VULKAN=OFF)",
                    command->name);
}

static ris_result run_view(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    return refuse(cli, &cmd_view, argc, argv, err);
}

static ris_result run_compare(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    return refuse(cli, &cmd_compare, argc, argv, err);
}

static ris_result run_validate(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    return refuse(cli, &cmd_validate, argc, argv, err);
}

static ris_result run_plate(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    return refuse(cli, &cmd_plate, argc, argv, err);
}

static ris_result run_sheet(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    return refuse(cli, &cmd_sheet, argc, argv, err);
}

const cli_command cmd_sheet = {
    .name = "sheet", .usage = "HEAD -o FILE.png", .summary = "(needs Vulkan)", .run = run_sheet};
const cli_command cmd_plate = {
    .name = "plate", .usage = "HEAD -o FILE.png", .summary = "(needs Vulkan)", .run = run_plate};
const cli_command cmd_view = {.name = "view", .usage = "HEAD", .summary = "(needs Vulkan)", .run = run_view};
const cli_command cmd_compare = {
    .name = "compare", .usage = "HEAD --clip C", .summary = "(needs Vulkan)", .run = run_compare};
const cli_command cmd_validate = {
    .name = "validate", .usage = "", .summary = "(needs Vulkan)", .run = run_validate};
