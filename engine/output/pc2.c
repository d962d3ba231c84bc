/* PC2 vertex cache: the 32-byte header, then point_count x 3 little-endian floats per sample.
 * Header: "POINTCACHE2\0", int32 version 1, int32 points, float start frame, float frames per sample, int32 samples. */
#include "risorius/output.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>

struct ris_pc2 {
    ris_output_file file;
    uint32_t point_count, sample_count;
    uint8_t *row; /* one sample (point_count x 12) */
};

static void put_u32(uint8_t *at, uint32_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
    at[2] = (uint8_t)(value >> 16);
    at[3] = (uint8_t)(value >> 24);
}

static void put_float(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(at, bits);
}

void ris_pc2_abandon(ris_pc2 *cache)
{
    if (cache != NULL) {
        ris__output_discard(&cache->file);
        free(cache->row);
        free(cache);
    }
}

ris_result ris_pc2_open(const char *path, uint32_t point_count, float start_frame, float rate, ris_pc2 **out,
                        ris_error *err)
{
    *out = NULL;
    if (point_count == 0 || point_count > INT32_MAX / 12) {
        return ris_fail(err, RIS_ERROR_USAGE, "cache \"%s\": the point count must be 1 to %d, found %u", path,
                        INT32_MAX / 12, (unsigned)point_count);
    }
    ris_pc2 *cache = calloc(1, sizeof *cache);
    if (cache != NULL) {
        cache->row = malloc((size_t)point_count * 12);
    }
    if (cache == NULL || cache->row == NULL) {
        ris_pc2_abandon(cache);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for cache \"%s\"", path);
    }
    cache->point_count = point_count;
    uint8_t header[32] = "POINTCACHE2";
    put_u32(header + 12, 1);
    put_u32(header + 16, point_count);
    put_float(header + 20, start_frame);
    put_float(header + 24, rate);
    put_u32(header + 28, 0); /* filled in at close */
    ris_result result = ris__output_open(&cache->file, path, err);
    if (result == RIS_OK) {
        result = ris__output_write(&cache->file, header, sizeof header, err);
    }
    if (result != RIS_OK) {
        ris_pc2_abandon(cache);
        return result;
    }
    *out = cache;
    return RIS_OK;
}

ris_result ris_pc2_add(ris_pc2 *cache, const ris_vec4 *position, ris_error *err)
{
    for (uint32_t i = 0; i < cache->point_count; i++) {
        put_float(cache->row + 12 * (size_t)i, position[i].x);
        put_float(cache->row + 12 * (size_t)i + 4, position[i].y);
        put_float(cache->row + 12 * (size_t)i + 8, position[i].z);
    }
    ris_result result = ris__output_write(&cache->file, cache->row, (size_t)cache->point_count * 12, err);
    if (result == RIS_OK) {
        cache->sample_count++;
    }
    return result;
}

ris_result ris_pc2_close(ris_pc2 *cache, ris_error *err)
{
    uint8_t count[4];
    put_u32(count, cache->sample_count);
    ris_result result;
    if (fseek(cache->file.stream, 28, SEEK_SET) != 0) {
        result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": its header cannot be completed",
                          cache->file.path);
    } else {
        result = ris__output_write(&cache->file, count, sizeof count, err);
    }
    if (result == RIS_OK) {
        result = ris__output_commit(&cache->file, err);
    }
    ris_pc2_abandon(cache);
    return result;
}
