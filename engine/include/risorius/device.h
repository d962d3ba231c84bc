/* Vulkan devices. The only public header besides draw.h that knows there is a GPU; no Vulkan type in it. */
#pragma once

#include "risorius/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ris_device ris_device;

typedef struct ris_device_info {
    char name[256], driver[256], type[32]; /* type: "cpu", "integrated", "discrete", "virtual", "other" */
    uint32_t api_version;                  /* VK_MAKE_API_VERSION */
    bool usable;                           /* has all this engine needs */
    char missing[256];                     /* what it lacks, empty if usable */
} ris_device_info;

typedef struct ris_device_def {
    /* NULL = first usable, discrete before integrated before cpu; else "INDEX" or part of a name */
    const char *select;
    const char *const *instance_extensions; /* for windows, from the window library */
    uint32_t instance_extension_count;
    bool present; /* needs a swapchain */
} ris_device_def;

/* Lists devices: fills up to capacity and sets *out_count to how many there are. */
ris_result ris_device_list(ris_device_info *out, uint32_t capacity, uint32_t *out_count, ris_error *err);
/* RIS_ERROR_DEVICE when none fits; never falls back to the CPU simulation. */
ris_result ris_device_create(const ris_device_def *def, ris_device **out, ris_error *err);
void ris_device_destroy(ris_device *device);
const ris_device_info *ris_device_get_info(const ris_device *device);
/* True when the device was created with RIS_VALIDATION=1 in the environment (validation and
 * synchronization validation). */
bool ris_device_validates(const ris_device *device);
/* Validation warnings and errors so far; *out_first (may be NULL) is the text of the first, owned by the
 * device. */
uint32_t ris_device_message_count(const ris_device *device, const char **out_first);

#ifdef __cplusplus
}
#endif
