/* regions.json: named vertex ranges of the skin (docs/file-formats.md; KA-09 for the simulated one). */
#include "asset/head_parts.h"
#include "asset/names.h"

#include <stdlib.h>
#include <string.h>

#define MAX_REGIONS 1024
#define MAX_RANGES (1u << 20)

/* Sets member[v] for every vertex of the ranges; the array is left zeroed by read_region. */
static ris_result mark_ranges(const ris_json_at *at, uint32_t vertex_count, uint8_t *member, ris_error *err)
{
    size_t count = json_array_size(at->value);
    ris_result result = ris__json_check_array(at, 1, MAX_RANGES, err);
    for (size_t i = 0; i < count && result == RIS_OK; i++) {
        ris_json_at range = ris__json_item(at, i);
        uint32_t first = 0, last = 0;
        if ((result = ris__json_check_array(&range, 2, 2, err))) {
            break;
        }
        ris_json_at from = ris__json_item(&range, 0), to = ris__json_item(&range, 1);
        if ((result = ris__json_uint(&from, RIS_JSON_REQUIRED, 0, vertex_count - 1, &first, err)) ||
            (result = ris__json_uint(&to, RIS_JSON_REQUIRED, first, vertex_count - 1, &last, err))) {
            break;
        }
        memset(member + first, 1, last - first + 1);
    }
    return result;
}

static ris_result read_region(const ris_json_at *at, uint32_t vertex_count, uint8_t *member, ris_region *out,
                              ris_error *err)
{
    ris_result result;
    if (strlen(at->key) >= RIS_NAME_SIZE || !ris__name_is_anatomical(at->key)) {
        return ris__json_fail(at, err, "expected a region name in snake_case, at most %d bytes",
                              RIS_NAME_SIZE - 1);
    }
    strcpy(out->name, at->key);
    if ((result = mark_ranges(at, vertex_count, member, err))) {
        return result;
    }
    for (uint32_t v = 0; v < vertex_count; v++) {
        out->count += member[v];
    }
    out->vertex = malloc(out->count * sizeof *out->vertex);
    if (!out->vertex) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for region %s", at->json->name, out->name);
    }
    for (uint32_t v = 0, n = 0; v < vertex_count; v++) {
        if (member[v]) {
            out->vertex[n++] = v;
            member[v] = 0;
        }
    }
    return RIS_OK;
}

ris_result ris__regions_read(const ris_json *json, ris_head *head, ris_error *err)
{
    ris_json_at root = ris__json_root(json);
    size_t count = json_object_size(root.value);
    uint8_t *member = NULL;
    const char *key;
    json_t *value;
    ris_result result = RIS_OK;
    if (count == 0 || count > MAX_REGIONS) {
        return ris__json_fail(&root, err, "expected 1 to %d regions, found %zu", MAX_REGIONS, count);
    }
    head->region = calloc(count, sizeof *head->region);
    member = calloc(head->skin.vertex_count, 1);
    if (!head->region || !member) {
        free(member);
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu regions", json->name, count);
    }
    json_object_foreach(root.value, key, value)
    {
        ris_json_at at = ris__json_key(&root, key);
        ris_region *region = &head->region[head->region_count++];
        if ((result = read_region(&at, head->skin.vertex_count, member, region, err))) {
            break;
        }
    }
    free(member);
    return result;
}

const ris_region *ris_head_region(const ris_head *head, const char *name)
{
    for (uint32_t i = 0; i < head->region_count; i++) {
        if (strcmp(head->region[i].name, name) == 0) {
            return &head->region[i];
        }
    }
    return NULL;
}
