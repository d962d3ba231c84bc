/* Runs a driver over its corpus and over seeded mutations of it: the same inputs on every machine.
 * usage: fuzz_<name> CORPUS_FOLDER MUTATIONS [SEED] */
#include "fuzz.h"

#include <dirent.h>

#define MAX_SEEDS 256
#define MAX_INPUT ((size_t)64 << 10)

typedef struct input {
    char name[256];
    uint8_t *data;
    size_t size;
} input;

static uint64_t state;

static uint32_t next_random(uint32_t below)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)(state >> 32) % below;
}

static bool load(const char *folder, const char *name, input *out)
{
    char path[2048];
    uint8_t *data = malloc(MAX_INPUT);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || !data) {
        fprintf(stderr, "%s: cannot read\n", path);
        free(data);
        return false;
    }
    out->size = fread(data, 1, MAX_INPUT, file);
    out->data = data;
    snprintf(out->name, sizeof out->name, "%s", name);
    fclose(file);
    return true;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(((const input *)a)->name, ((const input *)b)->name);
}

static size_t insert(uint8_t *data, size_t size, size_t at, const uint8_t *piece, size_t length)
{
    if (size + length > 2 * MAX_INPUT) {
        return size;
    }
    memmove(data + at + length, data + at, size - at);
    memcpy(data + at, piece, length);
    return size + length;
}

/* One change of the bytes; data has room for 2 x MAX_INPUT. */
static size_t mutate(uint8_t *data, size_t size, const input *other)
{
    static const char *const token[] = {
        "-1", "0",         "1e999",     "nan",          "99999999999", "{",  "}",    "[",   "]", ",",
        ":",  "\"",        "\\",        "null",         "true",        "\n", "/",    "//",  ".", "-",
        "e",  "f 1 2 3\n", "v 0 0 0\n", "\"jaw.open\"", "=",           ".L", "\xff", "[[]]"};
    size_t at = size ? next_random((uint32_t)size) : 0;
    size_t length = size > at ? 1 + next_random((uint32_t)(size - at)) : 0;
    length = length > 64 ? 64 : length;
    switch (next_random(7)) {
    case 0: /* flip a bit */
        if (size) {
            data[at] ^= (uint8_t)(1u << next_random(8));
        }
        return size;
    case 1: /* any byte */
        if (size) {
            data[at] = (uint8_t)next_random(256);
        }
        return size;
    case 2: /* cut a piece out */
        memmove(data + at, data + at + length, size - at - length);
        return size - length;
    case 3: /* cut the end off */ return at;
    case 4: { /* a token */
        const char *text = token[next_random(sizeof token / sizeof token[0])];
        return insert(data, size, at, (const uint8_t *)text, strlen(text));
    }
    case 5: { /* a piece twice */
        uint8_t piece[64];
        memcpy(piece, data + at, length);
        return insert(data, size, at, piece, length);
    }
    default: { /* a piece of another input */
        size_t from = other->size ? next_random((uint32_t)other->size) : 0;
        size_t count = other->size - from < 64 ? other->size - from : 64;
        return insert(data, size, at, other->data + from, count);
    }
    }
}

static void run_mutations(const input *seeds, size_t seed_count, long mutations)
{
    uint8_t *data = malloc(2 * MAX_INPUT);
    FUZZ_CHECK(data);
    for (long i = 0; i < mutations; i++) {
        const input *start = &seeds[next_random((uint32_t)seed_count)];
        size_t size = start->size;
        memcpy(data, start->data, size);
        for (uint32_t change = 1 + next_random(4); change > 0; change--) {
            size = mutate(data, size, &seeds[next_random((uint32_t)seed_count)]);
        }
        uint8_t *exact = malloc(size ? size : 1); /* of the exact size, so that a read beyond it is seen */
        FUZZ_CHECK(exact);
        memcpy(exact, data, size);
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    free(data);
}

int main(int argc, char **argv)
{
    static input seeds[MAX_SEEDS];
    size_t count = 0;
    DIR *folder = argc >= 3 ? opendir(argv[1]) : NULL;
    if (!folder) {
        fprintf(stderr, "usage: %s CORPUS_FOLDER MUTATIONS [SEED]\n", argv[0]);
        return 2;
    }
    state = argc > 3 ? strtoull(argv[3], NULL, 10) | 1 : UINT64_C(88172645463325252);
    for (struct dirent *entry; count < MAX_SEEDS && (entry = readdir(folder));) {
        if (entry->d_name[0] != '.' && !load(argv[1], entry->d_name, &seeds[count++])) {
            closedir(folder);
            return 1;
        }
    }
    closedir(folder);
    if (count == 0) {
        fprintf(stderr, "%s: no inputs\n", argv[1]);
        return 1;
    }
    qsort(seeds, count, sizeof seeds[0], compare_names); /* the order of a folder differs between machines */
    for (size_t i = 0; i < count; i++) {
        LLVMFuzzerTestOneInput(seeds[i].data, seeds[i].size);
    }
    run_mutations(seeds, count, strtol(argv[2], NULL, 10));
    printf("%zu inputs and %s mutations\n", count, argv[2]);
    for (size_t i = 0; i < count; i++) {
        free(seeds[i].data);
    }
    return 0;
}
