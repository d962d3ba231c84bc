/* risorius solve HEAD --self-test N: poses that are known are held, solved for and compared. */
#include "solve.h"

#include "measure/soak_pose.h"
#include "risorius/timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VALUE_BOUND 0.05 /* of a channel's range, for independent channels */

typedef struct tally {
    uint32_t poses, far, off; /* done; rms above the bound; an independent channel off */
    double rms_sum, rms_worst, max_worst, value_worst;
    uint64_t independent, wrong_dependent; /* channels over all poses */
    uint32_t *told;                        /* poses in which each control was independent (control_count) */
} tally;

/* The pose of soak with what is not to be solved for left at rest. */
static ris_result draw_pose(const solve_run *run, uint32_t number, float *pose, ris_error *err)
{
    const ris_model *model = run->backend.model;
    char *text = ris__soak_pose_text(model, run->args.seed, (ris_soak_id){RIS_SOAK_FEW, number});
    ris_result r = text ? ris_pose_parse(model, text, pose, err)
                        : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    free(text);
    for (uint32_t c = 0; !r && c < model->channel_count; c++) {
        bool free_to_act = false;
        for (uint32_t k = 0; k < run->control_count && !free_to_act; k++) {
            free_to_act = strcmp(model->channel[c].name, run->control[k].name) == 0;
        }
        pose[c] = free_to_act ? pose[c] : 0.0f;
    }
    return r;
}

static ris_result hold_target(solve_run *run, const float *pose, ris_error *err)
{
    ris_hold held;
    ris_vec4 *position = calloc(run->backend.model->node_count + 1u, sizeof *position);
    ris_result r = position ? ris_sim_reset(run->sim[0], err)
                            : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a skin");
    if (!r) {
        r = ris_sim_hold(run->sim[0], pose, 5, &held, err);
    }
    if (!r) {
        r = ris_sim_read(run->sim[0], RIS_STATE_POSITION, position, err);
    }
    ris_target_finish(&run->target);
    if (!r) {
        r = ris_target_from_skin(run->backend.model, position, &run->target, err);
    }
    free(position);
    return r;
}

/* Largest difference among independent channels, as a share of the range; *out_control is NULL without any. */
static double compare(const solve_run *run, const float *pose, tally *t, const ris_control **out_control)
{
    const ris_model *model = run->backend.model;
    double worst = 0;
    *out_control = NULL;
    for (uint32_t k = 0; k < run->control_count; k++) {
        const ris_control *control = &run->control[k];
        const double range = fmax(-(double)control->minimum, (double)control->maximum);
        const uint32_t channel = ris_model_channel(model, control->name);
        const double wanted = channel < model->channel_count ? (double)pose[channel] : 0;
        const double off = fabs((double)run->found[k].value - wanted) / range;
        const bool independent = ris_control_independent(&run->found[k]);
        t->independent += independent;
        t->told[k] += independent;
        t->wrong_dependent += !independent && off > VALUE_BOUND;
        if (independent && off >= worst) {
            worst = off;
            *out_control = control;
        }
    }
    return worst;
}

static void print_pose(const solve_run *run, uint32_t number, double off, const ris_control *control)
{
    if (run->cli->json || run->cli->quiet) {
        return;
    }
    const ris_solve_result *found = &run->result;
    printf("%5u %9.3f %9.4f %9.4f %6u %6u %8.3f  %s%s\n", number, found->rest_rms_mm, found->rms_mm,
           found->max_mm, found->iterations, found->holds, off, control ? control->name : "",
           found->rms_mm > run->args.near_mm || off > VALUE_BOUND ? "  NOT FOUND" : "");
    fflush(stdout);
}

static ris_result test_pose(solve_run *run, uint32_t number, float *pose, tally *t, ris_error *err)
{
    const ris_control *control;
    char title[32];
    snprintf(title, sizeof title, "pose %u", number);
    ris_result r = draw_pose(run, number, pose, err);
    if (!r) {
        r = hold_target(run, pose, err);
    }
    if (!r) {
        r = solve_target(run, title, err);
    }
    if (r) {
        return r;
    }
    const double off = compare(run, pose, t, &control);
    print_pose(run, number, off, control);
    t->poses++;
    t->far += run->result.rms_mm > run->args.near_mm;
    t->off += off > VALUE_BOUND;
    t->rms_sum += run->result.rms_mm;
    t->rms_worst = fmax(t->rms_worst, run->result.rms_mm);
    t->max_worst = fmax(t->max_worst, run->result.max_mm);
    t->value_worst = fmax(t->value_worst, off);
    return RIS_OK;
}

static void print_told(const solve_run *run, const tally *t)
{
    printf("channels by the share of poses in which they are independent:\n");
    for (uint32_t k = 0; k < run->control_count; k++) {
        if (t->told[k] < t->poses) {
            printf("  %-40s %5.2f\n", run->control[k].name, (double)t->told[k] / t->poses);
        }
    }
    printf("  all others                                1\n");
}

static void print_tally(const solve_run *run, const tally *t)
{
    const double poses = t->poses ? (double)t->poses : 1;
    const double channels = poses * (double)run->control_count;
    if (run->cli->json) {
        printf(
            "{\"poses\": %u, \"seed\": %u, \"channels\": %u, \"far\": %u, \"off\": %u, \"rms_mean_mm\": "
            "%.6g, "
            "\"rms_worst_mm\": %.6g, \"max_worst_mm\": %.6g, \"value_worst\": %.6g, \"independent\": %.6g, "
            "\"dependent_off\": %.6g}\n",
            t->poses, run->args.seed, run->control_count, t->far, t->off, t->rms_sum / poses, t->rms_worst,
            t->max_worst, t->value_worst, (double)t->independent / channels,
            (double)t->wrong_dependent / channels);
        return;
    }
    print_told(run, t);
    printf(
        "%u poses of seed %u, %u channels: rms %.4f mm in the mean, %.4f mm at worst; a vertex at most %.4f "
        "mm\n",
        t->poses, run->args.seed, run->control_count, t->rms_sum / poses, t->rms_worst, t->max_worst);
    printf(
        "%.1f %% of channels independent, their worst value off by %.3f of the range; %.1f %% dependent and "
        "off by more than %g\n",
        100 * (double)t->independent / channels, t->value_worst, 100 * (double)t->wrong_dependent / channels,
        VALUE_BOUND);
    printf("%u poses farther than %g mm rms, %u with an independent channel off by more than %g\n", t->far,
           run->args.near_mm, t->off, VALUE_BOUND);
}

ris_result solve_self_test(solve_run *run, ris_error *err)
{
    tally t = {.told = calloc(run->control_count + 1u, sizeof *t.told)};
    float *pose = calloc(run->backend.model->channel_count + 1u, sizeof *pose);
    ris_result r =
        t.told && pose ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the self-test");
    if (!r && !run->cli->json && !run->cli->quiet) {
        printf("%5s %9s %9s %9s %6s %6s %8s  %s\n", "pose", "rest mm", "rms mm", "max mm", "steps", "holds",
               "off", "worst independent channel");
    }
    for (uint32_t i = 0; !r && i < run->args.poses; i++) {
        r = test_pose(run, run->args.first + i, pose, &t, err);
    }
    if (!r) {
        print_tally(run, &t);
    }
    if (!r && t.far + t.off) {
        r = ris_fail(err, RIS_ERROR_FAILED, "%u of %u poses were not found again",
                     t.far > t.off ? t.far : t.off, t.poses);
    }
    free(t.told);
    free(pose);
    return r;
}
