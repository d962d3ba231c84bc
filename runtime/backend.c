#include "backend.h"

#include <stdlib.h>
#include <string.h>

#ifdef RISORIUS_VULKAN
#include "risorius/device.h"
#endif

#define SMALL_NODES 5000u /* below, lavapipe simulates faster without worker threads */

bool backend_is_cpu(const ris_cli *cli)
{
    return cli->device && strcmp(cli->device, "cpu") == 0;
}

#ifdef RISORIUS_VULKAN
static ris_result open_device(ris_backend *out, const ris_cli *cli, const backend_need *need, ris_error *err)
{
    bool on_cpu = backend_is_cpu(cli);
    if (on_cpu && !need->draw) {
        return RIS_OK;
    }
    ris_device_def def = {.select = on_cpu ? NULL : cli->device,
                          .instance_extensions = need->instance_extensions,
                          .instance_extension_count = need->instance_extension_count,
                          .present = need->instance_extension_count > 0};
    return ris_device_create(&def, &out->device, err);
}

static ris_result open_vulkan_sim(ris_backend *out, ris_error *err)
{
    return ris_sim_create_vk(out->model, out->device, &out->sim, err);
}

static void close_device(ris_backend *backend)
{
    ris_device_destroy(backend->device);
}

void backend_describe(const ris_backend *backend, char *out, size_t size)
{
    const ris_device_info *info = backend->device ? ris_device_get_info(backend->device) : NULL;
    snprintf(out, size, "%s%s%s", info ? info->name : "", info ? ", " : "", info ? info->driver : "");
}
#else
static ris_result open_device(ris_backend *out, const ris_cli *cli, const backend_need *need, ris_error *err)
{
    (void)out;
    if (need->draw) {
        return ris_fail(err, RIS_ERROR_DEVICE,
                        "this risorius was built without Vulkan (RISORIUS_VULKAN=OFF), so it "
                        "cannot draw");
    }
    if (!backend_is_cpu(cli)) {
        return ris_fail(err, RIS_ERROR_DEVICE,
                        "this risorius was built without Vulkan (RISORIUS_VULKAN=OFF); say "
                        "--device cpu to simulate on the CPU");
    }
    return RIS_OK;
}

static ris_result open_vulkan_sim(ris_backend *out, ris_error *err)
{
    (void)out;
    return ris_fail(err, RIS_ERROR_DEVICE, "this risorius was built without Vulkan");
}

static void close_device(ris_backend *backend)
{
    (void)backend;
}

void backend_describe(const ris_backend *backend, char *out, size_t size)
{
    (void)backend;
    snprintf(out, size, "%s", "");
}
#endif

ris_result backend_load(ris_backend *out, const char *head, ris_error *err)
{
    *out = (ris_backend){0};
    return ris_model_load(head, &out->model, err);
}

ris_result backend_start(ris_backend *backend, const ris_cli *cli, const backend_need *need, ris_error *err)
{
    if (!need->sim && !need->draw) {
        return RIS_OK;
    }
    if (!need->draw && backend->model->node_count < SMALL_NODES) {
        setenv("LP_NUM_THREADS", "0", 0);
    }
    ris_result r = open_device(backend, cli, need, err);
    if (!r && cli->verbose && backend->device) {
        char text[600];
        backend_describe(backend, text, sizeof text);
        fprintf(stderr, "device: %s\n", text);
    }
    if (r || !need->sim) {
        return r;
    }
    return backend_is_cpu(cli) ? ris_sim_create_cpu(backend->model, &backend->sim, err)
                               : open_vulkan_sim(backend, err);
}

ris_result backend_open(ris_backend *out, const ris_cli *cli, const char *head, const backend_need *need,
                        ris_error *err)
{
    ris_result r = backend_load(out, head, err);
    return r ? r : backend_start(out, cli, need, err);
}

void backend_close(ris_backend *backend)
{
    ris_sim_destroy(backend->sim);
    close_device(backend);
    ris_model_destroy(backend->model);
    *backend = (struct ris_backend){0};
}
