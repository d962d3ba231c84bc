/* The commands that cannot exist without Vulkan say so. */
#include "cli.h"

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    (void)cli, (void)argc;
    return ris_fail(err, RIS_ERROR_DEVICE, "'%s' needs Vulkan, and this risorius was built without it (RISORIUS_VULKAN=OFF)",
                    argv[0]);
}

const cli_command cmd_view = {.name = "view", .usage = "HEAD", .summary = "(needs Vulkan)", .run = run};
const cli_command cmd_compare = {.name = "compare", .usage = "HEAD --clip C", .summary = "(needs Vulkan)", .run = run};
const cli_command cmd_validate = {.name = "validate", .usage = "", .summary = "(needs Vulkan)", .run = run};
