/* The readers behind head.json. The first byte picks one: r regions, m muscles, t tissue, j jaw, e
 * expressions, d depth.csv, k skin.map, g guidance.csv, l landmarks. The skin is a fan of 8 vertices. */
#include "fuzz.h"

#include "asset/head_parts.h"

#include <math.h>

#define VERTICES 8

static ris_result read_text(char kind, const char *text, size_t size, ris_head *head, ris_error *err)
{
    ris_json json;
    if (kind == 'd') {
        return ris__depth_read("input", text, size, head, err);
    }
    if (kind == 'g') {
        return ris__guidance_read("input", text, size, head, err);
    }
    if (kind == 'k') {
        return ris__map_read("input", text, size, head, err);
    }
    ris_result result = ris__json_parse("input", text, size, &json, err);
    if (result == RIS_OK) {
        ris_json_at root = ris__json_root(&json);
        switch (kind) {
        case 'r': result = ris__regions_read(&json, head, err); break;
        case 'm': result = ris__muscles_read(&json, head, err); break;
        case 't': result = ris__tissue_read(&root, head, err); break;
        case 'l': result = ris__landmarks_read(&json, head, err); break;
        case 'j': result = ris__jaw_read(&root, head, err); break;
        default: result = ris__head_expressions_read(&json, head, err); break;
        }
    }
    ris__json_finish(&json);
    return result;
}

static void check_muscle(const ris_muscle_def *m)
{
    FUZZ_CHECK(m->name[0] && m->rows >= 2 && m->columns >= 2 && m->grid && m->origin && m->insertion &&
               m->source);
    FUZZ_CHECK(m->max_shortening >= 0 && m->max_shortening <= 0.30f && m->radius_mm > 0);
    for (uint32_t i = 0; i < m->rows * m->columns; i++) {
        FUZZ_CHECK(isfinite(m->grid[i].x) && isfinite(m->grid[i].y) && isfinite(m->grid[i].z));
    }
    for (uint32_t i = 0; i < m->attach_count; i++) {
        FUZZ_CHECK(m->attach[i] < VERTICES && (i == 0 || m->attach[i] > m->attach[i - 1]));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const ris_vec3 position[VERTICES] = {{0, 0, 0}, {1, 0, 0},  {1, 1, 0},
                                                {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}};
    ris_head head = {.skin.vertex_count = VERTICES};
    ris_error err = {0};
    if (size == 0 || !strchr("rmtjedkgl", data[0]) || data[0] == 0) {
        return 0;
    }
    head.skin.position = malloc(sizeof position); /* freed with the head */
    if (!head.skin.position) {
        return 0;
    }
    memcpy(head.skin.position, position, sizeof position);
    ris_result result = read_text((char)data[0], (const char *)data + 1, size - 1, &head, &err);
    fuzz_check_error(result, &err);
    for (uint32_t i = 0; result == RIS_OK && i < head.muscle_count; i++) {
        check_muscle(&head.muscle[i]);
    }
    for (uint32_t i = 0; result == RIS_OK && i < head.region_count; i++) {
        FUZZ_CHECK(head.region[i].count > 0 && head.region[i].vertex[head.region[i].count - 1] < VERTICES);
    }
    for (uint32_t i = 0; result == RIS_OK && data[0] == 'd' && i < VERTICES; i++) {
        FUZZ_CHECK(head.depth_mm[i] >= 0 && head.jaw_weight[i] >= 0 && head.jaw_weight[i] <= 1);
    }
    for (uint32_t i = 1; result == RIS_OK && i < head.guidance.forward_count; i++) {
        FUZZ_CHECK(head.guidance.forward_mm[i] > head.guidance.forward_mm[i - 1] &&
                   head.guidance.side_count >= 2);
    }
    FUZZ_CHECK(head.tissue.anchor_region_count <= 32);
    ris_head_finish(&head);
    return 0;
}
