#include "picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <stb_image.h>

void picture_load(const char *path, picture *out)
{
    int channels;
    out->rgba = stbi_load(path, &out->width, &out->height, &channels, 4);
    if (!out->rgba) {
        fail_msg("%s is not a picture: %s", path, stbi_failure_reason());
    }
}

void picture_finish(picture *image)
{
    stbi_image_free(image->rgba);
    image->rgba = NULL;
}

uint32_t picture_foreground(const picture *image)
{
    uint32_t count = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        const uint8_t *a = image->rgba, *b = image->rgba + (size_t)i * 4;
        count += abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]) > 60;
    }
    return count;
}

bool picture_is_blank(const picture *image)
{
    return picture_foreground(image) < (uint32_t)(image->width * image->height / 10);
}
