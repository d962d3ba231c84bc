/* The committed head and clips load, and say what the docs promise of them. */
#include "scratch.h"

#include "risorius/timeline.h"

#include <math.h>

static ris_model *model;

static int load_model(void **state)
{
    ris_error err = {0};
    (void)state;
    if (ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int drop_model(void **state)
{
    (void)state;
    ris_model_destroy(model);
    return 0;
}

static void test_first_ten_muscles(void **state)
{
    (void)state;
    static const char *const name[] = {"zygomaticus_major", "frontalis_inner", "corrugator_supercilii",
                                       "depressor_supercilii", "depressor_anguli_oris"};
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        for (int side = 0; side < 2; side++) {
            char sided[RIS_NAME_SIZE];
            snprintf(sided, sizeof sided, "%s.%c", name[i], side ? 'R' : 'L');
            uint32_t channel = ris_model_channel(model, sided);
            assert_true(channel < model->muscle_count);
        }
    }
}

/* A .L grid lies on the subject's left (+x), its .R is the mirror image: column for column from the other end,
 * row for row from the other end where it is a ring. */
static void test_sides(void **state)
{
    (void)state;
    const ris_head *head = model->head;
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < head->muscle_count; i++) {
        const ris_muscle_def *l = &head->muscle[i];
        size_t length = strlen(l->name);
        for (uint32_t k = 0; k < head->muscle_count && l->name[length - 1] == 'L'; k++) {
            const ris_muscle_def *r = &head->muscle[k];
            if (strlen(r->name) != length || memcmp(r->name, l->name, length - 1) != 0 ||
                r->name[length - 1] != 'R') {
                continue;
            }
            pairs++;
            assert_true(l->grid[0].x > 0);
            for (uint32_t p = 0; p < l->rows * l->columns; p++) {
                uint32_t row = p / l->columns, column = p % l->columns;
                const bool ring = l->kind == RIS_MUSCLE_SPHINCTER;
                const ris_vec3 *b = ring ? &r->grid[(l->rows - 1 - row) * l->columns + column]
                                         : &r->grid[row * l->columns + (l->columns - 1 - column)];
                assert_true(l->grid[p].x == -b->x && l->grid[p].y == b->y && l->grid[p].z == b->z);
            }
        }
    }
    assert_true(pairs >= 5);
}

static void test_map_and_tables(void **state)
{
    (void)state;
    const ris_head *head = model->head;
    double depth = 0;
    assert_non_null(head->base_vertex);
    for (uint32_t v = 0; v < head->skin.vertex_count; v++) {
        assert_true(head->base_vertex[v] >= -1 &&
                    head->base_vertex[v] < 19158); /* vertices of the base mesh */
        depth += (double)head->depth_mm[v] / head->skin.vertex_count;
    }
    assert_true(depth > 1 && depth < 30);
    assert_true(head->skin.uv_count > 0);
    assert_non_null(ris_head_region(head, head->simulated));
}

static void test_clips(void **state)
{
    (void)state;
    unsigned count = 0;
    DIR *folder = opendir(RIS_SOURCE_DIR "/assets/clips");
    assert_non_null(folder);
    float *pose = calloc(model->channel_count, sizeof *pose);
    assert_non_null(pose);
    for (struct dirent *entry; (entry = readdir(folder));) {
        char path[2048];
        ris_clip *clip;
        ris_error err = {0};
        float moved = 0;
        if (!strstr(entry->d_name, ".json")) {
            continue;
        }
        snprintf(path, sizeof path, "%s/assets/clips/%s", RIS_SOURCE_DIR, entry->d_name);
        if (ris_clip_load(model, path, &clip, &err) != RIS_OK) {
            print_error("%s\n", err.text);
            fail();
        }
        for (uint32_t i = 0; i < ris_clip_label_count(clip); i++) {
            double time_s;
            assert_non_null(ris_clip_label(clip, i, &time_s));
            ris_clip_sample(clip, time_s, pose);
            for (uint32_t c = 0; c < model->channel_count; c++) {
                moved = fmaxf(moved, fabsf(pose[c]));
            }
        }
        assert_true(moved > 0); /* at least one labelled pose is no rest */
        ris_clip_destroy(clip);
        count++;
    }
    free(pose);
    closedir(folder);
    assert_true(count > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_ten_muscles),
        cmocka_unit_test(test_sides),
        cmocka_unit_test(test_map_and_tables),
        cmocka_unit_test(test_clips),
    };
    return cmocka_run_group_tests(tests, load_model, drop_model);
}
