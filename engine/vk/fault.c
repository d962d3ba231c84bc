/* Behind RIS_VK: result names, sticky device loss, and the fault injection of tests/fault. */
#include "vk.h"

#include <string.h>

static _Thread_local struct {
    int64_t at, count;
    VkResult what;
} fault = {-1, 0, VK_SUCCESS};

void ris__vk_fault_set(int64_t n, VkResult what)
{
    fault.at = n;
    fault.count = 0;
    fault.what = what;
}

int64_t ris__vk_fault_count(void)
{
    return fault.count;
}

VkResult ris__vk_gate(ris_device *vk)
{
    if (vk && vk->lost) {
        return VK_ERROR_DEVICE_LOST;
    }
    return fault.count++ == fault.at ? fault.what : VK_SUCCESS;
}

const char *ris_vk_result_name(VkResult result)
{
    switch (result) {
#define NAME(x)                                                                                              \
    case x: return #x
        NAME(VK_SUCCESS);
        NAME(VK_NOT_READY);
        NAME(VK_TIMEOUT);
        NAME(VK_INCOMPLETE);
        NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
        NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
        NAME(VK_ERROR_INITIALIZATION_FAILED);
        NAME(VK_ERROR_DEVICE_LOST);
        NAME(VK_ERROR_MEMORY_MAP_FAILED);
        NAME(VK_ERROR_LAYER_NOT_PRESENT);
        NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
        NAME(VK_ERROR_FEATURE_NOT_PRESENT);
        NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
        NAME(VK_ERROR_TOO_MANY_OBJECTS);
        NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
        NAME(VK_ERROR_FRAGMENTED_POOL);
        NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
        NAME(VK_ERROR_SURFACE_LOST_KHR);
        NAME(VK_ERROR_NATIVE_WINDOW_IN_USE_KHR);
        NAME(VK_SUBOPTIMAL_KHR);
        NAME(VK_ERROR_OUT_OF_DATE_KHR);
#undef NAME
    default: return "VkResult";
    }
}

/* "vkCreateBuffer" of "vkCreateBuffer(vk->handle, ...)". */
static int call_length(const char *call)
{
    return (int)strcspn(call, "(");
}

ris_result ris__vk_fail(ris_device *vk, ris_error *err, VkResult result, const char *call, const char *file,
                        int line)
{
    const char *slash = strrchr(file, '/');
    const bool named = vk && vk->info.name[0];
    ris_result code = RIS_ERROR_DEVICE;
    if (result == VK_ERROR_DEVICE_LOST && vk) {
        vk->lost = true;
    }
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY) {
        code = RIS_ERROR_MEMORY;
    }
    return ris_fail(err, code, "%s%s%.*s failed with %s (%d) at %s:%d", named ? vk->info.name : "",
                    named ? ": " : "", call_length(call), call, ris_vk_result_name(result), (int)result,
                    slash ? slash + 1 : file, line);
}
