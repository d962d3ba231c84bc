/* Shared by instance.c and device.c only. */
#pragma once

#include "vk.h"

/* Fills vk->instance, messenger, debug_utils and validation; ris__vk_instance_finish frees them, halves
 * too. */
ris_result ris__vk_instance_create(ris_device *vk, const char *const *extensions, uint32_t extension_count,
                                   ris_error *err);
void ris__vk_instance_finish(ris_device *vk);
