/* runtime/labels.c: names at the margins neither overlap nor cross, and lie as near to their points as that allows. */
#include "scratch.h"

#include "../../runtime/labels.h"

#include <math.h>

enum { COUNT = 24 };

static const float width = 900.0f, height = 700.0f, gap = 20.0f;

static void fill(ris_label *label, unsigned seed)
{
    for (int i = 0; i < COUNT; i++) {
        seed = seed * 1664525u + 1013904223u;
        label[i] = (ris_label){.x = 250.0f + (float)(seed >> 8 & 1023) * 0.4f,
                               .y = 200.0f + (float)(seed >> 20 & 255),
                               .side = LABEL_EITHER};
        snprintf(label[i].text, sizeof label[i].text, "name %d", i);
    }
}

/* Neighbours of one side nearer than gap. */
static int overlaps(const ris_label *label, int count)
{
    int found = 0;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < i; k++) {
            found += label[i].side == label[k].side && fabsf(label[i].text_y - label[k].text_y) < gap - 0.01f;
        }
    }
    return found;
}

static float turn(const float a[2], const float b[2], const float c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int crossings(const ris_label *label, int count)
{
    int found = 0;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < i; k++) {
            const float edge = label[i].side == LABEL_LEFT ? 0.16f * width : 0.84f * width;
            const float a[2] = {edge, label[i].text_y}, b[2] = {label[i].x, label[i].y},
                        c[2] = {edge, label[k].text_y}, d[2] = {label[k].x, label[k].y};
            found += label[i].side == label[k].side && turn(a, b, c) * turn(a, b, d) < 0 &&
                     turn(c, d, a) * turn(c, d, b) < 0;
        }
    }
    return found;
}

static void test_random(void **state)
{
    (void)state;
    ris_label label[COUNT];
    int left = 0;
    for (unsigned seed = 1; seed <= 50; seed++) {
        fill(label, seed);
        assert_true(labels_place(label, COUNT, width, height, gap));
        assert_int_equal(overlaps(label, COUNT), 0);
        assert_int_equal(crossings(label, COUNT), 0);
        for (int i = 0; i < COUNT; i++) {
            assert_true(label[i].text_y >= 0.5f * gap - 0.01f &&
                        label[i].text_y <= height - 0.5f * gap + 0.01f);
            left += label[i].side == LABEL_LEFT;
        }
    }
    assert_true(left > 50 * COUNT / 4 && left < 50 * COUNT * 3 / 4);
    /* the controls: what these look for is seen */
    label[1].text_y = label[0].text_y;
    label[1].side = label[0].side;
    assert_true(overlaps(label, COUNT) > 0);
    const ris_label crossed[2] = {{.x = 300, .y = 400, .side = LABEL_LEFT, .text_y = 100},
                                  {.x = 300, .y = 100, .side = LABEL_LEFT, .text_y = 400}};
    assert_true(crossings(crossed, 2) > 0);
}

/* Two that push each other share the way; one alone stays where it points. */
static void test_least_moved(void **state)
{
    (void)state;
    ris_label label[3] = {{.x = 300, .y = 100, .side = LABEL_LEFT},
                          {.x = 310, .y = 110, .side = LABEL_LEFT},
                          {.x = 300, .y = 400, .side = LABEL_LEFT}};
    assert_true(labels_place(label, 3, width, height, gap));
    assert_true(fabsf(label[0].text_y - 95) < 0.01f && fabsf(label[1].text_y - 115) < 0.01f);
    assert_true(label[2].text_y == 400);
}

static void test_no_room(void **state)
{
    (void)state;
    ris_label label[COUNT];
    fill(label, 7);
    for (int i = 0; i < COUNT; i++) {
        label[i].side = LABEL_RIGHT;
    }
    assert_true(labels_place(label, COUNT, width, COUNT * gap, gap));
    assert_false(labels_place(label, COUNT, width, (COUNT - 1) * gap, gap));
    assert_true(labels_place(label, 0, width, height, gap));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_least_moved),
        cmocka_unit_test(test_no_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
