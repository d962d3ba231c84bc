#include "gpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__)
/* The driver must stay loaded, or the leak checker cannot name (and suppress) what it keeps. */
int dlclose(void *handle);
int dlclose(void *handle)
{
    (void)handle;
    return 0;
}
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libVkLayer_khronos_validation\n";
}
#endif

void test_gpu_small(void)
{
    setenv("LP_NUM_THREADS", "0", 1);
}

_Noreturn void test_gpu_missing(const char *why)
{
    const char *required = getenv("RIS_REQUIRE_GPU");
    const bool failed = required && strcmp(required, "1") == 0;
    fprintf(stderr, "%s: %s\n", failed ? "failed" : "skipped", why);
    exit(failed ? 1 : 77);
}

ris_device *test_gpu_open(void)
{
    ris_device *device = NULL;
    ris_error err = {0};
    const ris_device_def def = {.select = getenv("RIS_DEVICE")};
    if (ris_device_create(&def, &device, &err) != RIS_OK) {
        test_gpu_missing(err.text);
    }
    fprintf(stderr, "device: %s, %s\n", ris_device_get_info(device)->name,
            ris_device_get_info(device)->driver);
    return device;
}

bool test_gpu_is_lavapipe(const ris_device *device)
{
    return strstr(ris_device_get_info(device)->driver, "llvmpipe") != NULL;
}
