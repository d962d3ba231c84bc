/* The simulation a command runs: a model, and a CPU or Vulkan backend chosen by --device. */
#pragma once

#include "cli.h"
#include "risorius/sim.h"

struct ris_device;

typedef struct ris_backend {
    ris_model *model;
    struct ris_device *device; /* NULL on the CPU, unless a device was asked for drawing */
    ris_sim *sim;
} ris_backend;

/* What a command needs besides the model. */
typedef struct backend_need {
    bool sim;                               /* a simulation by --device */
    bool draw;                              /* a Vulkan device even when the simulation runs on the CPU */
    const char *const *instance_extensions; /* for a window */
    uint32_t instance_extension_count;
} backend_need;

/* Loads the head and makes what is needed; close it in any case. Notes the device on stderr with -v.
 * RIS_ERROR_DEVICE without a usable device, and in a build without Vulkan unless --device cpu. */
ris_result backend_open(ris_backend *out, const ris_cli *cli, const char *head, const backend_need *need,
                        ris_error *err);
void backend_close(ris_backend *backend);
/* The two halves of backend_open, for commands that look at the model in between. */
ris_result backend_load(ris_backend *out, const char *head, ris_error *err);
ris_result backend_start(ris_backend *backend, const ris_cli *cli, const backend_need *need, ris_error *err);

/* True for --device cpu. */
bool backend_is_cpu(const ris_cli *cli);
/* "name, driver" of the device that draws, or "" */
void backend_describe(const ris_backend *backend, char *out, size_t size);
