/* A clip shows the same motion at any frame rate: the simulation ticks at 60 Hz whatever is written, so a frame on a
 * tick is the tick's state to the bit, and one between two ticks is their mean by time. */
#include "command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define TICKS 60                                 /* of the clip */

/* Tracks of several eases, layers that repeat and override, idle life whose first blink and gaze shift fall within. */
static const char clip_text[] =
    "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":1,\n"
    "\"tracks\":[{\"target\":\"smile\",\"ease\":\"minimum_jerk\",\"keys\":[{\"t\":0,\"v\":0},{\"t\":0.4,"
    "\"v\":1},"
    "{\"t\":1,\"v\":0}]}],\n"
    "\"layers\":[{\"idle\":{\"seed\":1,\"blinks_per_min\":60,\"gazes_per_min\":120,\"head_deg\":2}},\n"
    "{\"duration_s\":0.3,\"loop\":true,\"tracks\":[{\"target\":\"frontalis_inner\",\"ease\":\"cubic\","
    "\"keys\":["
    "{\"t\":0,\"v\":0},{\"t\":0.1,\"v\":1}]}]},\n"
    "{\"mode\":\"override\",\"weight\":[{\"t\":0.3,\"v\":0},{\"t\":0.7,\"v\":1}],\"tracks\":[{\"target\":"
    "\"jaw.open\","
    "\"ease\":\"back_out\",\"keys\":[{\"t\":0.3,\"v\":0},{\"t\":0.9,\"v\":0.6}]}]}]}\n";

typedef struct cache {
    int32_t point_count, frame_count;
    float *position; /* (frame_count, point_count, 3) */
} cache;

static cache play(const char *folder, int fps)
{
    static run_result run;
    char line[4 * COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/at_%d.pc2", folder, fps);
    snprintf(line, sizeof line, "-q --device cpu render " HEAD " --clip '%s/clip.json' --fps %d -o '%s'",
             folder, fps, path);
    command_run(&run, NULL, line);
    if (run.code != 0) {
        fail_msg("%s", run.err);
    }
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char magic[12];
    int32_t head[5]; /* version, points, start, rate, samples */
    assert_int_equal(fread(magic, 1, sizeof magic, file), sizeof magic);
    assert_int_equal(fread(head, 4, 5, file), 5);
    cache c = {.point_count = head[1], .frame_count = head[4]};
    size_t count = (size_t)c.point_count * (size_t)c.frame_count * 3;
    c.position = malloc(count * sizeof *c.position);
    assert_non_null(c.position);
    assert_int_equal(fread(c.position, sizeof *c.position, count, file), count);
    fclose(file);
    return c;
}

/* Largest difference of the frame from the ticks at time_s, mm; at most 59 ticks. */
static double difference(const cache *ticks, const float *frame, double time_s)
{
    double tick = time_s * TICKS, whole = floor(tick + 1e-6), share = tick - whole < 1e-6 ? 0 : tick - whole,
           most = 0;
    size_t size = (size_t)ticks->point_count * 3;
    const float *a = ticks->position + (size_t)whole * size, *b = share > 0 ? a + size : a;
    for (size_t i = 0; i < size; i++) {
        most = fmax(most, fabs((double)a[i] * (1 - share) + (double)b[i] * share - (double)frame[i]));
    }
    return most;
}

static void the_same_motion_at_any_rate(void **state)
{
    (void)state;
    static const int rates[] = {24, 25, 30, 120};
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 32];
    command_folder(folder, "frame_rate");
    snprintf(path, sizeof path, "%s/clip.json", folder);
    command_write_file(path, clip_text);
    cache ticks = play(folder, TICKS);
    assert_int_equal(ticks.frame_count, TICKS);
    size_t size = (size_t)ticks.point_count * 3;
    double moved = 0, wrong = 0;
    for (size_t i = 0; i < size; i++) {
        moved = fmax(moved, fabs((double)ticks.position[30 * size + i] - (double)ticks.position[i]));
    }
    assert_true(moved > 5);
    for (size_t k = 0; k < sizeof rates / sizeof rates[0]; k++) {
        cache c = play(folder, rates[k]);
        int on_ticks = 0;
        assert_int_equal(c.frame_count, rates[k]);
        for (int f = 0; f < c.frame_count; f++) {
            double time_s = (double)f / rates[k], tick = time_s * TICKS;
            const float *frame = c.position + (size_t)f * size;
            if (tick > TICKS - 1) {
                break;
            }
            bool on_tick = fabs(tick - round(tick)) < 1e-6;
            on_ticks += on_tick;
            assert_true(difference(&ticks, frame, time_s) <= (on_tick ? 0 : 1e-4)); /* a float's last bits */
            if (f > 0) { /* control: a frame late */
                wrong = fmax(wrong, difference(&ticks, frame, (double)(f - 1) / rates[k]));
            }
        }
        assert_true(on_ticks >= 5);
        free(c.position);
    }
    assert_true(wrong > 0.5);
    free(ticks.position);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_same_motion_at_any_rate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
