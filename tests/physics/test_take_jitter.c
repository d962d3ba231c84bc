/* The noise of a tracker does not grow on its way to the skin: how far the skin goes from frame to frame, against how far it would
 * go if every noisy frame were held until at rest. */
#include "loaded_head.h"

#include "asset/take.h"
#include "base/pcg.h"
#include "risorius/timeline.h"

#include <math.h>

#define FRAMES 90
#define HELD 16 /* noisy frames that are held */

static ris_vec4 *last;

static double unit(ris_pcg *pcg)
{
    return (double)(ris__pcg_next(pcg) >> 8) / 16777216.0;
}

/* A half smile with raised brows and parted lips, every shape of it and of the rest with even noise of this half width. */
static void noisy_pose(ris_pcg *pcg, double noise)
{
    static const struct {
        const char *name;
        double value;
    } face[] = {{"mouthSmileLeft", 0.5}, {"mouthSmileRight", 0.5}, {"browInnerUp", 0.4}, {"jawOpen", 0.2}};
    memset(pose, 0, model->channel_count * sizeof *pose);
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        double value = 0.1;
        for (size_t f = 0; f < sizeof face / sizeof *face; f++) {
            value = strcmp(face[f].name, ris__arkit_name[k]) == 0 ? face[f].value : value;
        }
        value += noise * (2 * unit(pcg) - 1);
        need(ris_pose_add(model, ris__arkit_name[k], (float)value, pose, &err));
    }
    ris_pose_clamp(model, pose);
}

/* Mean square way of the nodes since the last call, mm^2. */
static double way(void)
{
    double sum = 0;
    memcpy(last, x, model->node_count * sizeof *x);
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    for (uint32_t i = 0; i < model->node_count; i++) {
        const double dx = (double)x[i].x - (double)last[i].x, dy = (double)x[i].y - (double)last[i].y,
                     dz = (double)x[i].z - (double)last[i].z;
        sum += dx * dx + dy * dy + dz * dz;
    }
    return sum / model->node_count;
}

/* Root mean square way from frame to frame while noise plays, mm. */
static double played(double noise)
{
    ris_pcg pcg = ris__pcg_start(1, 1);
    double sum = 0;
    need(ris_sim_reset(sim, &err));
    noisy_pose(&pcg, 0);
    need(ris_sim_hold(sim, pose, 3, &(ris_hold){0}, &err));
    way();
    for (int i = 0; i < FRAMES; i++) {
        noisy_pose(&pcg, noise);
        need(ris_sim_tick(sim, pose, &err));
        const double square = way();
        sum += i < 10 ? 0 : square; /* the noise has set in by then */
    }
    return sqrt(sum / (FRAMES - 10));
}

/* The same with every frame held until at rest: what the noise asks for. */
static double asked(double noise)
{
    ris_pcg pcg = ris__pcg_start(1, 1);
    double sum = 0;
    need(ris_sim_reset(sim, &err));
    noisy_pose(&pcg, 0);
    need(ris_sim_hold(sim, pose, 3, &(ris_hold){0}, &err));
    way();
    for (int i = 0; i < HELD; i++) {
        noisy_pose(&pcg, noise);
        need(ris_sim_hold(sim, pose, 1, &(ris_hold){0}, &err));
        const double square = way();
        sum += i < 1 ? 0 : square;
    }
    return sqrt(sum / (HELD - 1));
}

static void noise_does_not_grow(void **state)
{
    (void)state;
    const double input = asked(0.01);
    ris_sim_set_onset(sim, true);
    const double slow = played(0.01);
    ris_sim_set_onset(sim, false); /* as performances are played */
    const double skin = played(0.01);
    print_message("the noise asks for %.4g mm a frame; the skin goes %.4g mm, %.3f of it, with onset %.3f\n",
                  input, skin, skin / input, slow / input);
    assert_true(input > 1e-3);       /* there is noise */
    assert_true(skin > 1e-5);        /* and it is played */
    assert_true(skin <= input);      /* what must be */
    assert_true(slow <= 0.5 * skin); /* muscles that need time calm it */
}

/* The measure sees a skin that shakes more than it is asked to. */
static void more_noise_is_seen(void **state)
{
    (void)state;
    assert_false(played(0.2) <= asked(0.01));
}

static int open_all(void **state)
{
    if (open_loaded_head(state)) {
        return -1;
    }
    last = calloc(model->node_count, sizeof *last);
    return last ? 0 : -1;
}

static int close_all(void **state)
{
    free(last);
    return close_loaded_head(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_does_not_grow),
        cmocka_unit_test(more_noise_is_seen),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
