/* risorius soak HEAD --live-link T: the frames of a motion while it moves, each measured like a pose. */
#include "soak.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ris_result soak_motion_open(soak *run, const ris_cli *cli, ris_error *err)
{
    const ris_model *model = run->backend.model;
    ris_result r = motion_load(&run->args.motion, cli, model, &run->clip, err);
    if (!r) {
        motion_start(&run->args.motion, run->backend.sim);
        r = player_init(&run->player, run->backend.sim, run->clip, NULL, err);
    }
    if (!r) {
        run->before = calloc(model->node_count, sizeof *run->before);
        r = run->before ? RIS_OK
                        : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", model->node_count);
    }
    if (!r) {
        const double ticks = ris_clip_duration_s(run->clip) / RIS_TICK_S;
        run->total = (uint32_t)(ticks / run->args.every + 1e-6);
        run->total = run->total ? run->total : 1;
        run->kind_count[RIS_SOAK_FEW] = run->total;
        run->row[RIS_MEASURE_MIRROR].measured = false;
    }
    return r;
}

void soak_motion_close(soak *run)
{
    player_finish(&run->player);
    ris_clip_destroy(run->clip);
    free(run->before);
}

/* The node that went farthest in the last tick, in mm/s. */
static ris_finding fastest(const soak *run)
{
    ris_finding found = {.vertex_count = 1, .part = ""};
    double most = 0;
    for (uint32_t i = 0; i < run->backend.model->node_count; i++) {
        const ris_vec4 *a = &run->before[i], *b = &run->position[i];
        const double x = (double)b->x - (double)a->x, y = (double)b->y - (double)a->y,
                     z = (double)b->z - (double)a->z;
        const double way = x * x + y * y + z * z;
        if (way > most) {
            most = way;
            found.vertex[0] = i;
        }
    }
    found.value = sqrt(most) / RIS_TICK_S;
    return found;
}

/* Plays up to the frame and measures it. Numbers that are none are a finding, no error; after them nothing is played. */
static ris_result measure_frame(soak *run, uint32_t frame, bool *out_wild, ris_error *err)
{
    ris_finding found[RIS_MEASURE_COUNT];
    ris_result r = RIS_OK;
    const ris_soak_id id = {RIS_SOAK_FEW, frame};
    for (uint32_t k = 0; k < run->args.every && !r; k++) {
        if (k + 1 == run->args.every) {
            r = ris_sim_read(run->backend.sim, RIS_STATE_POSITION, run->before, err);
        }
        if (!r) {
            r = player_tick(&run->player, err);
        }
    }
    *out_wild = r == RIS_ERROR_DIVERGED;
    r = *out_wild ? RIS_OK : r;
    if (!r) {
        r = ris_sim_read(run->backend.sim, RIS_STATE_POSITION, run->position, err);
    }
    if (!r) {
        r = soak_measure_skin(run, id, found, err);
    }
    if (!r && !*out_wild && found[RIS_MEASURE_FINITE].value == 0) {
        const ris_finding speed = fastest(run);
        soak_record_finding(run, SOAK_SPEED, &speed, id);
    }
    return r;
}

ris_result soak_motion_measure(soak *run, const ris_cli *cli, ris_error *err)
{
    ris_progress bar;
    ris_result r = RIS_OK;
    bool wild = false;
    progress_start(&bar, cli, "soak");
    for (uint32_t i = 0; i < run->total && !r && !wild && !run->interrupted; i++) {
        progress_show(&bar, i, run->total);
        r = measure_frame(run, i, &wild, err);
        run->done += !r;
        run->interrupted = interrupt_seen();
    }
    if (!r && !run->interrupted) {
        progress_show(&bar, run->done, run->total);
    }
    progress_end(&bar);
    return r;
}

double soak_motion_time_s(const soak *run, uint32_t frame)
{
    return (double)(frame + 1) * run->args.every * RIS_TICK_S;
}
