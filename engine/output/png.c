/* PNG: encoded to memory by stb_image_write, then written whole and renamed. */
#include "risorius/output.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

typedef struct sink {
    uint8_t *data;
    size_t size;
    bool failed;
} sink;

static void take(void *context, void *data, int size)
{
    sink *to = context;
    uint8_t *bigger = to->failed ? NULL : realloc(to->data, to->size + (size_t)size);
    if (bigger == NULL) {
        to->failed = true;
        return;
    }
    memcpy(bigger + to->size, data, (size_t)size);
    to->data = bigger;
    to->size += (size_t)size;
}

ris_result ris_png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                         ris_error *err)
{
    if (width == 0 || height == 0 || width > 16384 || height > 16384) {
        return ris_fail(err, RIS_ERROR_USAGE, "picture \"%s\": sides must be 1 to 16384 pixels, found %ux%u",
                        path, (unsigned)width, (unsigned)height);
    }
    /* three channels: every picture here is opaque */
    uint8_t *rgb = malloc((size_t)width * height * 3);
    if (rgb == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for picture \"%s\"", path);
    }
    for (size_t i = 0; i < (size_t)width * height; i++) {
        memcpy(rgb + 3 * i, rgba + 4 * i, 3);
    }
    sink out = {0};
    int made = stbi_write_png_to_func(take, &out, (int)width, (int)height, 3, rgb, (int)width * 3);
    free(rgb);
    ris_result result;
    if (made == 0 || out.failed) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for picture \"%s\"", path);
    } else {
        result = ris__file_write(path, out.data, out.size, err);
    }
    free(out.data);
    return result;
}
