/* Images of the painter: sRGB bytes and PNG files. */
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include "paint.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

ris_result ris_paint_image_init(ris_paint_image *image, uint32_t width, uint32_t height, ris_error *err)
{
    *image = (ris_paint_image){.width = width, .height = height};
    image->rgb = calloc((size_t)width * height, 3);
    image->covered = calloc((size_t)width * height, 1);
    if (image->rgb && image->covered)
        return RIS_OK;
    ris_paint_image_finish(image);
    return ris_fail(err, RIS_ERROR_MEMORY, "no memory for an image of %u x %u", width, height);
}

void ris_paint_image_finish(ris_paint_image *image)
{
    free(image->rgb);
    free(image->covered);
    *image = (ris_paint_image){0};
}

uint8_t ris_paint_encode(float linear)
{
    const float c = ris_paint_clamp(linear, 0, 1);
    const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1 / 2.4f) - 0.055f;
    return (uint8_t)(255 * s + 0.5f);
}

float ris_paint_decode(float byte)
{
    const float s = byte / 255.0f;
    return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

ris_result ris_paint_image_save(const ris_paint_image *image, const char *path, ris_error *err)
{
    const int width = (int)image->width, height = (int)image->height;
    int size = 0;
    stbi_write_png_compression_level = 12;
    unsigned char *bytes = stbi_write_png_to_mem(image->rgb, width * 3, width, height, 3, &size);
    if (!bytes)
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory to write the image", path);
    const ris_result result = ris__file_write(path, bytes, (size_t)size, err);
    STBIW_FREE(bytes);
    return result;
}
