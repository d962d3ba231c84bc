/* The Vulkan instance: layers, extensions and the sink of validation messages. */
#include "vk_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    ris_device *vk = user;
    (void)severity;
    /* "general" messages are the loader's talk about manifests, not about our calls */
    if (types == VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT) {
        return VK_FALSE;
    }
    if (vk->message_count++ == 0) {
        snprintf(vk->message, sizeof vk->message, "%s", data->pMessage);
    }
    if (vk->message_count <= 8) {
        fprintf(stderr, "validation: %s\n", data->pMessage);
    }
    return VK_FALSE;
}

static ris_result has_extension(const char *layer, const char *name, bool *out, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_device *vk = NULL;
    VkExtensionProperties *properties = NULL;
    uint32_t count = 0;
    *out = false;
    RIS_VK(vkEnumerateInstanceExtensionProperties(layer, &count, NULL));
    properties = calloc(count ? count : 1, sizeof *properties);
    if (!properties) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u Vulkan instance extensions", count);
        goto fail;
    }
    RIS_VK(vkEnumerateInstanceExtensionProperties(layer, &count, properties));
    for (uint32_t i = 0; i < count; i++) {
        *out = *out || strcmp(properties[i].extensionName, name) == 0;
    }
fail:
    free(properties);
    return result;
}

static ris_result has_validation_layer(bool *out, ris_error *err)
{
    ris_result result = RIS_OK;
    ris_device *vk = NULL;
    VkLayerProperties *properties = NULL;
    uint32_t count = 0;
    *out = false;
    RIS_VK(vkEnumerateInstanceLayerProperties(&count, NULL));
    properties = calloc(count ? count : 1, sizeof *properties);
    if (!properties) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u Vulkan layers", count);
        goto fail;
    }
    RIS_VK(vkEnumerateInstanceLayerProperties(&count, properties));
    for (uint32_t i = 0; i < count; i++) {
        *out = *out || strcmp(properties[i].layerName, validation_layer) == 0;
    }
fail:
    free(properties);
    return result;
}

static ris_result create_messenger(ris_device *vk, const VkDebugUtilsMessengerCreateInfoEXT *info,
                                   ris_error *err)
{
    ris_result result = RIS_OK;
    PFN_vkCreateDebugUtilsMessengerEXT vk_create_messenger =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(vk->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    vk->destroy_messenger = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
        vk->instance, "vkDestroyDebugUtilsMessengerEXT");
    if (!vk_create_messenger || !vk->destroy_messenger) {
        return ris_fail(err, RIS_ERROR_DEVICE, "VK_EXT_debug_utils is present but its functions are not");
    }
    RIS_VK(vk_create_messenger(vk->instance, info, NULL, &vk->messenger));
fail:
    return result;
}

static ris_result create(ris_device *vk, const VkInstanceCreateInfo *info, ris_error *err)
{
    VkResult created = ris__vk_gate(vk);
    if (created == VK_SUCCESS) {
        created = vkCreateInstance(info, NULL, &vk->instance);
    }
    if (created == VK_ERROR_INCOMPATIBLE_DRIVER) { /* the loader found no driver at all */
        return ris_fail(
            err, RIS_ERROR_DEVICE,
            "there is no Vulkan driver on this machine (Debian: apt-get install mesa-vulkan-drivers)");
    }
    return created == VK_SUCCESS ? RIS_OK
                                 : ris__vk_fail(vk, err, created, "vkCreateInstance", __FILE__, __LINE__);
}

ris_result ris__vk_instance_create(ris_device *vk, const char *const *extensions, uint32_t extension_count,
                                   ris_error *err)
{
    ris_result result = RIS_OK;
    const char *wanted = getenv("RIS_VALIDATION");
    const char *names[32];
    const char *layers[1] = {validation_layer};
    uint32_t count = 0;
    VkValidationFeatureEnableEXT enable[1] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                        .enabledValidationFeatureCount = 1,
                                        .pEnabledValidationFeatures = enable};
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .pNext = &features,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = vk,
    };
    VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                     .pApplicationName = "risorius",
                                     .pEngineName = "risorius",
                                     .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                 .pApplicationInfo = &application};
    if (extension_count > 30) {
        return ris_fail(err, RIS_ERROR_DEVICE, "%u instance extensions asked for, at most 30 expected",
                        extension_count);
    }
    for (uint32_t i = 0; i < extension_count; i++) {
        names[count++] = extensions[i];
    }
    vk->validation = wanted && strcmp(wanted, "1") == 0;
    if (vk->validation) {
        bool found = false;
        RIS_TRY(has_validation_layer(&found, err));
        if (!found) {
            return ris_fail(err, RIS_ERROR_DEVICE, "RIS_VALIDATION=1 but %s is not installed",
                            validation_layer);
        }
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.pNext = &messenger;
    }
    RIS_TRY(has_extension(NULL, VK_EXT_DEBUG_UTILS_EXTENSION_NAME, &vk->debug_utils, err));
    if (vk->debug_utils) {
        names[count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    }
    info.enabledExtensionCount = count;
    info.ppEnabledExtensionNames = names;
    RIS_TRY(create(vk, &info, err));
    if (vk->validation && vk->debug_utils) {
        messenger.pNext = NULL;
        RIS_TRY(create_messenger(vk, &messenger, err));
    }
    if (vk->debug_utils) {
        vk->set_name = (PFN_vkSetDebugUtilsObjectNameEXT)vkGetInstanceProcAddr(
            vk->instance, "vkSetDebugUtilsObjectNameEXT");
    }
fail:
    return result;
}

void ris__vk_instance_finish(ris_device *vk)
{
    if (vk->messenger) {
        vk->destroy_messenger(vk->instance, vk->messenger, NULL);
    }
    if (vk->instance) {
        vkDestroyInstance(vk->instance, NULL);
    }
    vk->messenger = VK_NULL_HANDLE;
    vk->instance = VK_NULL_HANDLE;
}
