/* Images of the painter: sRGB bytes and PNG files. */
#include "paint.h"

#include "risorius/output.h"

#include <math.h>
#include <stdlib.h>

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
    const size_t texels = (size_t)image->width * image->height;
    uint8_t *rgba = malloc(texels * 4);
    if (!rgba)
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory to write the image", path);
    for (size_t i = 0; i < 4 * texels; i++)
        rgba[i] = i % 4 == 3 ? 255 : image->rgb[i / 4 * 3 + i % 4];
    const ris_result result = ris_png_write(path, rgba, image->width, image->height, err);
    free(rgba);
    return result;
}
