/* risorius devices: what the simulation can run on. */
#include "cli.h"

#include <stdlib.h>

#ifdef RISORIUS_VULKAN
#include "risorius/device.h"

#define DEVICE_CAPACITY 32

static void print_device(const ris_cli *cli, const ris_device_info *info, uint32_t index)
{
    uint32_t major = info->api_version >> 22 & 0x7fu, minor = info->api_version >> 12 & 0x3ffu;
    if (!cli->json) {
        printf("%-5u %s (%s), %s, Vulkan %u.%u%s%s\n", index, info->name, info->type, info->driver, major,
               minor, info->usable ? "" : ": not usable, lacks ", info->usable ? "" : info->missing);
        return;
    }
    printf(",\n  {\"select\": \"%u\", \"name\": ", index);
    cli_json_string(stdout, info->name);
    printf(", \"driver\": ");
    cli_json_string(stdout, info->driver);
    printf(", \"type\": \"%s\", \"vulkan\": \"%u.%u\", \"usable\": %s, \"missing\": ", info->type, major,
           minor, info->usable ? "true" : "false");
    cli_json_string(stdout, info->missing);
    printf("}");
}

static ris_result print_vulkan(const ris_cli *cli, ris_error *err)
{
    ris_device_info *info = calloc(DEVICE_CAPACITY, sizeof *info);
    if (!info) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the device list");
    }
    uint32_t count = 0;
    ris_result r = ris_device_list(info, DEVICE_CAPACITY, &count, err);
    for (uint32_t i = 0; !r && i < count && i < DEVICE_CAPACITY; i++) {
        print_device(cli, &info[i], i);
    }
    free(info);
    if (!r && count == 0) {
        r = ris_fail(err, RIS_ERROR_DEVICE,
                     "there is no Vulkan device on this machine (Debian: apt install "
                     "mesa-vulkan-drivers); --device cpu runs the reference");
    }
    return r;
}
#else
static ris_result print_vulkan(const ris_cli *cli, ris_error *err)
{
    (void)err;
    if (!cli->json) {
        printf("(built without Vulkan)\n");
    }
    return RIS_OK;
}
#endif

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    const cli_option options[] = {{0}};
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_devices, options, argc, argv, NULL, 0, &count, err);
    if (r || cli->done) {
        return r;
    }
    printf(cli->json
               ? "{\"devices\": [\n  {\"select\": \"cpu\", \"name\": \"CPU reference\", \"usable\": true}"
               : "cpu   CPU reference\n");
    r = print_vulkan(cli, err);
    if (cli->json) {
        printf("\n]}\n");
    }
    return r;
}

const cli_command cmd_devices = {
    .name = "devices",
    .usage = "",
    .summary = "list what the simulation can run on",
    .detail = "The first column is what --device takes; a part of the name does too.\n",
    .run = run,
};
