/* The Vulkan device of a test program. Without one the program ends with 77 (ctest: skipped), or with 1 when
 * RIS_REQUIRE_GPU=1 (CI). Also keeps the driver loaded for the leak checker of sanitizer builds. */
#pragma once

#include "risorius/device.h"

/* Small models: LP_NUM_THREADS=0 makes a dispatch on lavapipe cost 0.2 us instead of 30 to 80. Call first. */
void test_gpu_small(void);
/* Opens the device of RIS_DEVICE (or the first usable); never returns NULL. */
ris_device *test_gpu_open(void);
/* True on Mesa's software device, where CPU and GPU agree bit for bit. */
bool test_gpu_is_lavapipe(const ris_device *device);
/* Ends the program as described above, saying why. */
_Noreturn void test_gpu_missing(const char *why);
