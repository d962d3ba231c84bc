/* Device choice and creation (docs/shaders.md lists what a device must have). */
#include "vk_device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STORAGE_BUFFERS_NEEDED 21 /* of RIS_BIND_COUNT: one set holds all buffers of the simulation */

static const char *type_name(VkPhysicalDeviceType type)
{
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return "cpu";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual";
    default: return "other";
    }
}

static int type_rank(const char *type)
{
    static const char *const order[] = {"discrete", "integrated", "virtual", "cpu", "other"};
    int rank = 0;
    while (rank < 4 && strcmp(order[rank], type) != 0) {
        rank++;
    }
    return rank;
}

/* Adds ", what" to the list of missing things. */
static void miss(ris_device_info *info, bool present, const char *what)
{
    size_t used = strlen(info->missing);
    if (!present) {
        snprintf(info->missing + used, sizeof info->missing - used, "%s%s", used ? ", " : "", what);
    }
}

/* First family with graphics and compute (Vulkan asks for one wherever there is graphics), or UINT32_MAX. */
static uint32_t find_family(VkPhysicalDevice physical, uint32_t *out_timestamp_bits)
{
    VkQueueFamilyProperties family[16];
    uint32_t count = 16;
    const VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, family);
    for (uint32_t i = 0; i < count; i++) {
        if ((family[i].queueFlags & both) == both) {
            *out_timestamp_bits = family[i].timestampValidBits;
            return i;
        }
    }
    *out_timestamp_bits = 0;
    return UINT32_MAX;
}

static bool has_device_extension(VkPhysicalDevice physical, const char *name)
{
    uint32_t count = 0;
    bool found = false;
    VkExtensionProperties *properties;
    if (vkEnumerateDeviceExtensionProperties(physical, NULL, &count, NULL) != VK_SUCCESS) {
        return false;
    }
    properties = calloc(count ? count : 1, sizeof *properties);
    if (properties &&
        vkEnumerateDeviceExtensionProperties(physical, NULL, &count, properties) == VK_SUCCESS) {
        for (uint32_t i = 0; i < count; i++) {
            found = found || strcmp(properties[i].extensionName, name) == 0;
        }
    }
    free(properties);
    return found;
}

static void check_features(VkPhysicalDevice physical, ris_device_info *info)
{
    VkPhysicalDeviceVulkan13Features v13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                            .pNext = &v13};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &v12};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    miss(info, v12.scalarBlockLayout, "scalarBlockLayout");
    miss(info, v13.synchronization2, "synchronization2");
    miss(info, v13.dynamicRendering, "dynamicRendering");
    miss(info, v13.maintenance4, "maintenance4");
}

static void describe(VkPhysicalDevice physical, bool present, ris_device_info *info)
{
    VkPhysicalDeviceDriverProperties driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    const VkPhysicalDeviceLimits *limits = &properties.properties.limits;
    VkSampleCountFlags samples;
    uint32_t timestamp_bits;
    memset(info, 0, sizeof *info);
    vkGetPhysicalDeviceProperties2(physical, &properties);
    info->api_version = properties.properties.apiVersion;
    snprintf(info->name, sizeof info->name, "%s", properties.properties.deviceName);
    snprintf(info->type, sizeof info->type, "%s", type_name(properties.properties.deviceType));
    if (info->api_version < VK_API_VERSION_1_3) {
        snprintf(info->driver, sizeof info->driver, "unknown");
        miss(info, false, "Vulkan 1.3");
        return; /* the 1.3 structures below may not be asked of it */
    }
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &properties);
    /* both strings may be 255 bytes; the limits keep the whole inside driver[256] */
    snprintf(info->driver, sizeof info->driver, "%.120s %.120s", driver.driverName, driver.driverInfo);
    check_features(physical, info);
    samples = limits->framebufferColorSampleCounts & limits->framebufferDepthSampleCounts;
    miss(info, (samples & VK_SAMPLE_COUNT_4_BIT) != 0, "4x multisampling");
    miss(info, limits->maxPerStageDescriptorStorageBuffers >= STORAGE_BUFFERS_NEEDED,
         "22 storage buffers a stage");
    miss(info, find_family(physical, &timestamp_bits) != UINT32_MAX, "a queue with graphics and compute");
    if (present) {
        miss(info, has_device_extension(physical, VK_KHR_SWAPCHAIN_EXTENSION_NAME), "VK_KHR_swapchain");
    }
    info->usable = info->missing[0] == '\0';
}

/* All physical devices of vk->instance; *out is freed by the caller. */
static ris_result enumerate(ris_device *vk, VkPhysicalDevice **out, uint32_t *out_count, ris_error *err)
{
    ris_result result = RIS_OK;
    VkPhysicalDevice *physical = NULL;
    uint32_t count = 0;
    RIS_VK(vkEnumeratePhysicalDevices(vk->instance, &count, NULL));
    physical = calloc(count ? count : 1, sizeof(VkPhysicalDevice));
    if (!physical) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u Vulkan devices", count);
        goto fail;
    }
    if (count) {
        RIS_VK(vkEnumeratePhysicalDevices(vk->instance, &count, physical));
    }
    *out = physical;
    *out_count = count;
    return RIS_OK;
fail:
    free(physical);
    return result;
}

ris_result ris_device_list(ris_device_info *out, uint32_t capacity, uint32_t *out_count, ris_error *err)
{
    ris_device vk = {0};
    VkPhysicalDevice *physical = NULL;
    ris_result result;
    *out_count = 0;
    result = ris__vk_instance_create(&vk, NULL, 0, err);
    if (result == RIS_OK) {
        result = enumerate(&vk, &physical, out_count, err);
    }
    for (uint32_t i = 0; i < *out_count && i < capacity; i++) {
        describe(physical[i], false, &out[i]);
    }
    free(physical);
    ris__vk_instance_finish(&vk);
    return result;
}

static bool contains(const char *text, const char *part)
{
    for (; *text; text++) {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i])) {
            i++;
        }
        if (!part[i]) {
            return true;
        }
    }
    return false;
}

/* Index of the device that `select` means, UINT32_MAX if none. */
static uint32_t match(const ris_device_info *info, uint32_t count, const char *select)
{
    uint32_t best = UINT32_MAX;
    char *end = NULL;
    if (select && isdigit((unsigned char)select[0])) {
        unsigned long index = strtoul(select, &end, 10);
        if (*end == '\0') {
            return index < count ? (uint32_t)index : UINT32_MAX;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (select && !contains(info[i].name, select)) {
            continue;
        }
        /* a usable device before one that is not, then by type; the first of equals */
        if (best == UINT32_MAX || (info[i].usable && !info[best].usable) ||
            (info[i].usable == info[best].usable && type_rank(info[i].type) < type_rank(info[best].type))) {
            best = i;
        }
    }
    return best;
}

static ris_result choose(ris_device *vk, const ris_device_def *def, ris_error *err)
{
    VkPhysicalDevice *physical = NULL;
    ris_device_info *info = NULL;
    uint32_t count = 0, best;
    const char *select = def->select && def->select[0] ? def->select : NULL;
    ris_result result;
    RIS_TRY(enumerate(vk, &physical, &count, err));
    if (count == 0) {
        result = ris_fail(
            err, RIS_ERROR_DEVICE,
            "there is no Vulkan device on this machine (Debian: apt-get install mesa-vulkan-drivers)");
        goto fail;
    }
    info = calloc(count, sizeof *info);
    if (!info) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u device descriptions", count);
        goto fail;
    }
    for (uint32_t i = 0; i < count; i++) {
        describe(physical[i], def->present, &info[i]);
    }
    best = match(info, count, select);
    if (best == UINT32_MAX) {
        result = ris_fail(err, RIS_ERROR_DEVICE,
                          "no Vulkan device \"%s\" among %u (`risorius devices` lists them)", select, count);
        goto fail;
    }
    if (!info[best].usable) {
        result = ris_fail(err, RIS_ERROR_DEVICE, "%s lacks %s", info[best].name, info[best].missing);
        goto fail;
    }
    vk->physical = physical[best];
    vk->info = info[best];
fail:
    free(info);
    free(physical);
    return result;
}

static ris_result open_device(ris_device *vk, ris_error *err)
{
    ris_result result = RIS_OK;
    const float priority = 1.0f;
    const char *const extensions[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    VkPhysicalDeviceFeatures offered;
    VkPhysicalDeviceVulkan13Features v13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                            .synchronization2 = VK_TRUE,
                                            .dynamicRendering = VK_TRUE,
                                            .maintenance4 = VK_TRUE};
    VkPhysicalDeviceVulkan12Features v12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                            .pNext = &v13,
                                            .scalarBlockLayout = VK_TRUE};
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .pNext = &v12,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queue,
                               .enabledExtensionCount = vk->present ? 1 : 0,
                               .ppEnabledExtensionNames = extensions,
                               .pEnabledFeatures = &vk->features};
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                    .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    vkGetPhysicalDeviceProperties(vk->physical, &vk->properties);
    vkGetPhysicalDeviceMemoryProperties(vk->physical, &vk->memory);
    vkGetPhysicalDeviceFeatures(vk->physical, &offered);
    vk->features.samplerAnisotropy = offered.samplerAnisotropy;
    vk->features.fillModeNonSolid = offered.fillModeNonSolid;
    vk->features.wideLines = offered.wideLines;
    vk->family = find_family(vk->physical, &vk->timestamp_bits);
    queue.queueFamilyIndex = vk->family;
    RIS_VK(vkCreateDevice(vk->physical, &info, NULL, &vk->handle));
    vkGetDeviceQueue(vk->handle, vk->family, 0, &vk->queue);
    pool.queueFamilyIndex = vk->family;
    RIS_VK(vkCreateCommandPool(vk->handle, &pool, NULL, &vk->pool));
fail:
    return result;
}

ris_result ris_device_create(const ris_device_def *def, ris_device **out, ris_error *err)
{
    static const ris_device_def plain = {0};
    ris_result result;
    const char *staging;
    ris_device *vk = calloc(1, sizeof *vk);
    *out = NULL;
    if (!vk) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for a device");
    }
    if (!def) {
        def = &plain;
    }
    staging = getenv("RIS_STAGING");
    vk->staging = staging && strcmp(staging, "1") == 0;
    vk->present = def->present;
    result = ris__vk_instance_create(vk, def->instance_extensions, def->instance_extension_count, err);
    if (result != RIS_OK) {
        goto fail;
    }
    RIS_TRY(choose(vk, def, err));
    RIS_TRY(open_device(vk, err));
    *out = vk;
    return RIS_OK;
fail:
    ris_device_destroy(vk);
    return result;
}

void ris_device_destroy(ris_device *vk)
{
    if (!vk) {
        return;
    }
    if (vk->handle) {
        vkDeviceWaitIdle(vk->handle);
        vkDestroyCommandPool(vk->handle, vk->pool, NULL);
        vkDestroyDevice(vk->handle, NULL);
    }
    ris__vk_instance_finish(vk);
    free(vk);
}

const ris_device_info *ris_device_get_info(const ris_device *vk)
{
    return &vk->info;
}

bool ris_device_validates(const ris_device *vk)
{
    return vk->validation;
}

uint32_t ris_device_message_count(const ris_device *vk, const char **out_first)
{
    if (out_first) {
        *out_first = vk->message;
    }
    return vk->message_count;
}

void ris_vk_name(ris_device *vk, VkObjectType type, uint64_t handle, const char *name)
{
    VkDebugUtilsObjectNameInfoEXT info = {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                          .objectType = type,
                                          .objectHandle = handle,
                                          .pObjectName = name};
    if (vk->set_name && name && handle) {
        vk->set_name(vk->handle, &info); /* a name that cannot be set changes nothing */
    }
}
