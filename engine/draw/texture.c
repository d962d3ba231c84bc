/* Image files as textures with mip levels. */
#include "draw/draw_impl.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <stb_image.h>

static ris_result upload(ris_device *device, const char *name, const uint8_t *pixels, uint32_t width,
                         uint32_t height, VkFormat format, ris_vk_image *out, ris_error *err)
{
    const ris_vk_image_def def = {.width = width,
                                  .height = height,
                                  .format = format,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                           VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                  .name = name};
    ris_result result = ris_vk_image_create(device, &def, out, err);
    return result == RIS_OK ? ris_vk_image_upload(device, out, pixels, err) : result;
}

ris_result ris__draw_texture_plain(ris_device *device, const uint8_t rgba[4], VkFormat format,
                                   ris_vk_image *out, ris_error *err)
{
    return upload(device, "plain", rgba, 1, 1, format, out, err);
}

ris_result ris__draw_texture_beside(ris_device *device, const char *color_path, const char *kind,
                                    ris_vk_image *out, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    const char *dot = strrchr(color_path, '.');
    int stem = dot != NULL ? (int)(dot - color_path) : (int)strlen(color_path);
    int wrote = snprintf(path, sizeof path, "%.*s_%s.png", stem, color_path, kind);
    if (wrote < 0 || (size_t)wrote >= sizeof path || access(path, F_OK) != 0) {
        return RIS_OK;
    }
    return ris__draw_texture_load(device, path, VK_FORMAT_R8G8B8A8_UNORM, out, err);
}

ris_result ris__draw_texture_load(ris_device *device, const char *path, VkFormat format, ris_vk_image *out,
                                  ris_error *err)
{
    char *bytes = NULL;
    size_t size = 0;
    ris_result result = ris__file_read(path, RIS_MAX_IMAGE_BYTES, &bytes, &size, err);
    if (result != RIS_OK) {
        return result;
    }
    const uint32_t limit = device->properties.limits.maxImageDimension2D;
    int width = 0, height = 0, channels = 0;
    if (stbi_info_from_memory((const uint8_t *)bytes, (int)size, &width, &height, &channels) != 0 &&
        ((uint32_t)width > limit || (uint32_t)height > limit)) {
        free(bytes);
        return ris_fail(err, RIS_ERROR_DATA, "\"%s\": %dx%d pixels, the device takes at most %u each way",
                        path, width, height, (unsigned)limit);
    }
    uint8_t *pixels = stbi_load_from_memory((const uint8_t *)bytes, (int)size, &width, &height, &channels, 4);
    free(bytes);
    if (pixels == NULL) {
        return ris_fail(err, RIS_ERROR_DATA, "\"%s\": not a usable PNG or JPEG picture: %s", path,
                        stbi_failure_reason());
    }
    result = upload(device, path, pixels, (uint32_t)width, (uint32_t)height, format, out, err);
    stbi_image_free(pixels);
    return result;
}
