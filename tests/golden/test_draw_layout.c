/* Member offsets and array strides of shaders/shared/draw_shared.h in the SPIR-V of the raster pass against C, and, as
 * control, every checked word spoilt in turn. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draw_shared.h"

enum { OP_NAME = 5, OP_MEMBER_NAME = 6, OP_RUNTIME_ARRAY = 29, OP_DECORATE = 71, OP_MEMBER_DECORATE = 72 };
enum { ARRAY_STRIDE = 6, OFFSET = 35, MOST_WORDS = 100000, MOST_IDS = 4000 };

static const struct {
    const char *type, *member;
    uint32_t offset;
} field[] = {
#define FIELD(type, member)                                                                                  \
    {                                                                                                        \
#type, #member, (uint32_t)offsetof(type, member)                                                     \
    }
    FIELD(ris_draw_term, source),   FIELD(ris_draw_term, weight),   FIELD(ris_draw_ride, a),
    FIELD(ris_draw_ride, b),        FIELD(ris_draw_ride, c),        FIELD(ris_draw_ride, target),
    FIELD(ris_draw_ride, share),    FIELD(ris_draw_ride, offset),   FIELD(ris_draw_ride, still),
    FIELD(ris_draw_ride, normal),   FIELD(ris_draw_corner, vertex), FIELD(ris_draw_corner, u),
    FIELD(ris_draw_corner, v),      FIELD(ris_draw_count, count),   FIELD(ris_draw_view, clip),
    FIELD(ris_draw_view, shadow),   FIELD(ris_draw_view, eye),      FIELD(ris_draw_view, light),
    FIELD(ris_draw_view, radiance), FIELD(ris_draw_view, sky),      FIELD(ris_draw_view, ground),
    FIELD(ris_draw_view, paper),    FIELD(ris_draw_view, head),     FIELD(ris_draw_view, rim),
    FIELD(ris_draw_view, fade),     FIELD(ris_draw_view, size),     FIELD(ris_draw_object, place),
    FIELD(ris_draw_object, tint),   FIELD(ris_draw_object, pivot),
};
static const struct {
    const char *type;
    uint32_t size;
} stride[] = {{"ris_draw_term", sizeof(ris_draw_term)},
              {"ris_draw_ride", sizeof(ris_draw_ride)},
              {"ris_draw_corner", sizeof(ris_draw_corner)}};
static const char *const file[] = {"refine_comp", "surface_normal_comp", "ride_comp", "mesh_vert",
                                   "shadow_vert", "skin_frag",           "mouth_frag"};

enum { FIELDS = sizeof field / sizeof field[0], STRIDES = sizeof stride / sizeof stride[0] };

static uint32_t words[MOST_WORDS], word_count;
static const char *name[MOST_IDS];
static uint32_t element[MOST_IDS];           /* of a runtime array */
static uint32_t checked[200], checked_count; /* places of the words that were compared */
static bool seen_field[FIELDS], seen_stride[STRIDES];

static void load(const char *stem)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/shaders/draw/%s.spv", RIS_BUILD_DIR, stem);
    FILE *in = fopen(path, "rb");
    assert_non_null(in);
    word_count = (uint32_t)fread(words, 4, MOST_WORDS, in);
    fclose(in);
    assert_true(word_count > 5 && word_count < MOST_WORDS && words[0] == 0x07230203 && words[3] < MOST_IDS);
}

static const char *name_of(uint32_t id)
{
    return name[id] ? name[id] : "";
}

/* Compares one decoration word; false when it differs. */
static bool same(uint32_t at, uint32_t wanted)
{
    if (checked_count < sizeof checked / sizeof checked[0]) {
        checked[checked_count++] = at;
    }
    return words[at] == wanted;
}

/* True when every known member and array of the loaded module lies where C has it. Names come before decorations, and
 * arrays after them: two passes. */
static bool matches(void)
{
    bool good = true;
    memset(name, 0, sizeof name);
    memset(element, 0, sizeof element);
    checked_count = 0;
    for (uint32_t at = 5; at < word_count; at += words[at] >> 16) {
        uint32_t op = words[at] & 0xffff;
        if (op == OP_NAME) {
            name[words[at + 1]] = (const char *)&words[at + 2];
        } else if (op == OP_RUNTIME_ARRAY) {
            element[words[at + 1]] = words[at + 2];
        }
    }
    for (uint32_t at = 5; at < word_count; at += words[at] >> 16) {
        uint32_t op = words[at] & 0xffff;
        for (int s = 0; s < STRIDES && op == OP_DECORATE && words[at + 2] == ARRAY_STRIDE; s++) {
            if (strcmp(name_of(element[words[at + 1]]), stride[s].type) == 0) {
                seen_stride[s] = true;
                good &= same(at + 3, stride[s].size);
            }
        }
        if (op != OP_MEMBER_NAME) {
            continue;
        }
        for (int f = 0; f < FIELDS; f++) {
            bool this_one = strcmp(name_of(words[at + 1]), field[f].type) == 0 &&
                            strcmp((const char *)&words[at + 3], field[f].member) == 0;
            for (uint32_t d = 5; d < word_count && this_one; d += words[d] >> 16) {
                if ((words[d] & 0xffff) == OP_MEMBER_DECORATE && words[d + 1] == words[at + 1] &&
                    words[d + 2] == words[at + 2] && words[d + 3] == OFFSET) {
                    seen_field[f] = true;
                    good &= same(d + 4, field[f].offset);
                }
            }
        }
    }
    return good;
}

static void layout_is_the_same(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof file / sizeof file[0]; i++) {
        load(file[i]);
        if (!matches()) {
            fail_msg("%s: a struct of draw_shared.h lies differently in C and in the shader", file[i]);
        }
        assert_true(checked_count > 0);
        uint32_t place[200], count = checked_count;
        memcpy(place, checked, sizeof place);
        for (uint32_t k = 0; k < count; k++) {
            words[place[k]] += 4;
            assert_false(matches());
            words[place[k]] -= 4;
        }
    }
    for (int f = 0; f < FIELDS; f++) {
        if (!seen_field[f]) {
            fail_msg("%s.%s is in no shader", field[f].type, field[f].member);
        }
    }
    for (int s = 0; s < STRIDES; s++) {
        assert_true(seen_stride[s]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(layout_is_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
