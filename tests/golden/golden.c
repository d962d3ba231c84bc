#include "golden.h"

#include "risorius/output.h"

#include <stb/stb_image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

golden_difference golden_compare(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height)
{
    uint64_t count[256] = {0}, total = 0, sum = 0, seen = 0;
    golden_difference out = {0};
    for (size_t i = 0; i < (size_t)width * height * 4; i++) {
        if (i % 4 != 3) {
            unsigned d = (unsigned)abs((int)a[i] - (int)b[i]);
            count[d]++;
            total++;
            sum += d;
            out.max = d > out.max ? d : out.max;
        }
    }
    out.mean = (double)sum / (double)total;
    while (out.p99 < 255 && (seen += count[out.p99]) * 100 < total * 99) {
        out.p99++;
    }
    return out;
}

bool golden_within(golden_difference difference, golden_limit limit)
{
    return difference.mean <= limit.mean && difference.p99 <= limit.p99 && difference.max <= limit.max;
}

static void write_failure(const char *name, const uint8_t *rgba, const uint8_t *reference, uint32_t width,
                          uint32_t height)
{
    char path[1024];
    ris_error err = {0};
    mkdir(RIS_BUILD_DIR "/golden", 0777);
    snprintf(path, sizeof path, "%s/golden/%s.actual.png", RIS_BUILD_DIR, name);
    if (ris_png_write(path, rgba, width, height, &err) != RIS_OK) {
        fprintf(stderr, "%s\n", err.text);
    }
    fprintf(stderr, "  written: %s\n", path);
    uint8_t *difference = reference ? malloc((size_t)width * height * 4) : NULL;
    if (difference) {
        for (size_t i = 0; i < (size_t)width * height * 4; i++) {
            int d = 8 * abs((int)rgba[i] - (int)reference[i]); /* eight times, to be seen */
            difference[i] = i % 4 == 3 ? 255 : (uint8_t)(d > 255 ? 255 : d);
        }
        snprintf(path, sizeof path, "%s/golden/%s.difference.png", RIS_BUILD_DIR, name);
        if (ris_png_write(path, difference, width, height, &err) != RIS_OK) {
            fprintf(stderr, "%s\n", err.text);
        }
        free(difference);
    }
}

static bool update(const char *name, const char *path, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    ris_error err = {0};
    struct stat info;
    if (ris_png_write(path, rgba, width, height, &err) != RIS_OK || stat(path, &info) != 0) {
        fprintf(stderr, "%s: %s\n", name, err.text);
        return false;
    }
    fprintf(stderr, "%s: reference written, %ld bytes\n", name, (long)info.st_size);
    return info.st_size <= 65536;
}

bool golden_check(const char *name, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    char path[1024];
    int w = 0, h = 0, channels = 0;
    const char *wanted = getenv("RIS_UPDATE_GOLDEN");
    snprintf(path, sizeof path, "%s/tests/golden/reference/%s.png", RIS_SOURCE_DIR, name);
    if (wanted && (strcmp(wanted, name) == 0 || strcmp(wanted, "all") == 0)) {
        return update(name, path, rgba, width, height);
    }
    uint8_t *reference = stbi_load(path, &w, &h, &channels, 4);
    if (!reference || (uint32_t)w != width || (uint32_t)h != height) {
        fprintf(stderr, "%s: no reference of %ux%u pixels at %s (RIS_UPDATE_GOLDEN=%s writes it)\n", name,
                (unsigned)width, (unsigned)height, path, name);
        write_failure(name, rgba, NULL, width, height);
        stbi_image_free(reference);
        return false;
    }
    golden_difference d = golden_compare(rgba, reference, width, height);
    bool good = golden_within(d, GOLDEN_LIMIT);
    fprintf(stderr, "%s: mean %.3f, 99th percentile %u, largest %u of 255: %s\n", name, d.mean, d.p99, d.max,
            good ? "the same" : "DIFFERENT");
    if (!good) {
        write_failure(name, rgba, reference, width, height);
    }
    stbi_image_free(reference);
    return good;
}
