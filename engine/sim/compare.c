#include "sim/compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/sim_impl.h"

#define PROBE_EVERY 30u /* ticks between the one-step comparisons */
#define MOVED_MM 2.0f

/* Buffers and sums of one run; every pointer (node_count) ris_vec4 unless noted. */
typedef struct run {
    const ris_compare_def *def;
    ris_compare_report *report;
    const ris_model *model;
    ris_vec4 *value[2];                                          /* what was just read of a and b */
    ris_vec4 *saved[2][RIS_STATE_COUNT];                         /* state of a and b around a probe */
    bool *moved;                                                 /* (node_count) */
    float *pose;                                                 /* (channel_count) */
    double step_sum[RIS_STAGE_COUNT], clip_sum[RIS_STAGE_COUNT]; /* squares, mm^2 */
    uint64_t step_nodes[RIS_STAGE_COUNT], clip_nodes[RIS_STAGE_COUNT];
    bool over; /* report->first_* is over tolerance */
} run;

/* Where in the clip a stage ran. */
typedef struct place {
    uint32_t tick, substep;
    bool probe; /* the single step from equal states */
} place;

ris_compare_def ris_default_compare_def(ris_sim *a, ris_sim *b)
{
    const bool exact = strstr(ris_sim_backend(a), "llvmpipe") || strstr(ris_sim_backend(b), "llvmpipe");
    return (ris_compare_def){.a = a,
                             .b = b,
                             .step_tolerance_mm = exact ? 0.0f : 1e-4f,
                             .clip_tolerance_mm = exact ? 0.0f : 1e-2f,
                             .moved_minimum = 500};
}

/* States that a stage writes; the first is the one measured in mm. Returns how many. */
static uint32_t outputs(ris_stage stage, ris_state out[4])
{
    switch (stage) {
    case RIS_STAGE_ANCHOR_SHIFT: out[0] = RIS_STATE_POSITION; return 1;
    case RIS_STAGE_BEND: out[0] = RIS_STATE_BEND; return 1;
    case RIS_STAGE_SPRING_FORCE: out[0] = RIS_STATE_FORCE; return 1;
    case RIS_STAGE_VERLET:
    case RIS_STAGE_CONTACT:
        out[0] = RIS_STATE_POSITION;
        out[1] = RIS_STATE_VELOCITY_HALF;
        out[2] = RIS_STATE_VELOCITY_PREV;
        out[3] = RIS_STATE_FREE;
        return 4;
    case RIS_STAGE_LIP_NORMAL:
    case RIS_STAGE_NORMAL:
    case RIS_STAGE_COUNT: break;
    }
    out[0] = RIS_STATE_NORMAL;
    return 1;
}

static void free_run(run *r)
{
    for (int side = 0; side < 2; side++) {
        free(r->value[side]);
        for (int s = 0; s < RIS_STATE_COUNT; s++) {
            free(r->saved[side][s]);
        }
    }
    free(r->moved);
    free(r->pose);
}

static ris_result init_run(run *r, const ris_compare_def *def, ris_compare_report *report, ris_error *err)
{
    const size_t nodes = ris_sim_get_model(def->a)->node_count;
    const size_t channels = ris_sim_get_model(def->a)->channel_count;
    bool complete = true;
    memset(r, 0, sizeof *r);
    r->def = def;
    r->report = report;
    r->model = ris_sim_get_model(def->a);
    r->moved = calloc(nodes, sizeof *r->moved);
    r->pose = calloc(channels ? channels : 1, sizeof *r->pose);
    for (int side = 0; side < 2; side++) {
        r->value[side] = calloc(nodes, sizeof(ris_vec4));
        complete = complete && r->value[side];
        for (int s = 0; s < RIS_STATE_COUNT; s++) {
            r->saved[side][s] = calloc(nodes, sizeof(ris_vec4));
            complete = complete && r->saved[side][s];
        }
    }
    if (!complete || !r->moved || !r->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory to compare %zu vertices", nodes);
    }
    return RIS_OK;
}

static ris_result read_both(run *r, ris_state state, ris_error *err)
{
    ris_result result = ris_sim_read(r->def->a, state, r->value[0], err);
    return result == RIS_OK ? ris_sim_read(r->def->b, state, r->value[1], err) : result;
}

/* Length of a stage's unit in mm for node i. */
static double scale_mm(const run *r, ris_stage stage, uint32_t i)
{
    const double dt = (double)r->model->push.dt_s;
    return stage == RIS_STAGE_SPRING_FORCE ? (double)r->model->rest_position[i].w * dt * dt : 1.0;
}

static double distance(ris_vec4 a, ris_vec4 b)
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

/* Differing words of the values read; *out_first is the first vertex that has one. */
static uint64_t differing(const run *r, uint32_t *out_first)
{
    const size_t bytes = r->model->node_count * sizeof(ris_vec4);
    uint64_t count = 0;
    if (memcmp(r->value[0], r->value[1], bytes) == 0) {
        return 0;
    }
    for (uint32_t i = r->model->node_count; i-- > 0;) {
        uint32_t a[4], b[4];
        memcpy(a, &r->value[0][i], sizeof a);
        memcpy(b, &r->value[1][i], sizeof b);
        for (int w = 0; w < 4; w++) {
            if (a[w] != b[w]) {
                count++;
                *out_first = i;
            }
        }
    }
    return count;
}

/* Adds the values read as output of stage to stats; sum and nodes carry the mean square. */
static void measure(const run *r, ris_stage stage, ris_compare_stage *stats, double *sum, uint64_t *nodes)
{
    for (uint32_t i = 0; i < r->model->node_count; i++) {
        double d = distance(r->value[0][i], r->value[1][i]) * scale_mm(r, stage, i);
        if (!(d <= stats->max_mm)) { /* also takes a NaN, and keeps it */
            stats->max_mm = isnan(stats->max_mm) ? stats->max_mm : d;
        }
        *sum += d * d;
    }
    *nodes += r->model->node_count;
    stats->rms_mm = sqrt(*sum / (double)*nodes);
}

/* true if a vertex is more than tolerance_mm off (a NaN is); *out_first is then the lowest. */
static bool find_over(const run *r, ris_stage stage, float tolerance_mm, uint32_t *out_first)
{
    for (uint32_t i = 0; i < r->model->node_count; i++) {
        if (!(distance(r->value[0][i], r->value[1][i]) * scale_mm(r, stage, i) <= (double)tolerance_mm)) {
            *out_first = i;
            return true;
        }
    }
    return false;
}

/* Keeps the first place over tolerance; until there is one, the first difference. */
static void note_difference(run *r, ris_stage stage, const place *at, bool in_mm, uint32_t vertex)
{
    ris_compare_report *report = r->report;
    const float tolerance_mm = at->probe ? r->def->step_tolerance_mm : r->def->clip_tolerance_mm;
    const bool over = tolerance_mm > 0.0f ? in_mm && find_over(r, stage, tolerance_mm, &vertex) : true;
    if (report->differs && (r->over || !over)) {
        return;
    }
    report->differs = true;
    r->over = over;
    report->first_stage = stage;
    report->first_tick = at->tick;
    report->first_substep = at->substep;
    report->first_vertex = vertex;
}

/* Reads and compares all that stage wrote. */
static ris_result compare_stage(run *r, ris_stage stage, const place *at, ris_error *err)
{
    ris_compare_stage *stats = at->probe ? &r->report->step[stage] : &r->report->clip[stage];
    double *sum = at->probe ? &r->step_sum[stage] : &r->clip_sum[stage];
    uint64_t *nodes = at->probe ? &r->step_nodes[stage] : &r->clip_nodes[stage];
    ris_state state[4];
    const uint32_t count = outputs(stage, state);
    for (uint32_t k = 0; k < count; k++) {
        uint32_t vertex = 0;
        uint64_t words;
        ris_result result = read_both(r, state[k], err);
        if (result != RIS_OK) {
            return result;
        }
        words = differing(r, &vertex);
        stats->differing_words += words;
        if (words) {
            note_difference(r, stage, at, k == 0, vertex);
        }
        if (k == 0) {
            measure(r, stage, stats, sum, nodes);
        }
    }
    return RIS_OK;
}

/* Runs one stage on both sides and compares. */
static ris_result both_stage(run *r, ris_stage stage, const ris_anchor_frame *anchors, const place *at,
                             ris_error *err)
{
    ris_result result = ris__sim_stage(r->def->a, stage, anchors ? &anchors[0] : NULL, err);
    if (result == RIS_OK) {
        result = ris__sim_stage(r->def->b, stage, anchors ? &anchors[1] : NULL, err);
    }
    return result == RIS_OK ? compare_stage(r, stage, at, err) : result;
}

/* A tick (or a probe's single step) stage by stage. */
static ris_result lockstep(run *r, const ris_anchor_frame *anchors, uint32_t tick, uint32_t substeps,
                           bool is_probe, ris_error *err)
{
    place at = {.tick = tick, .probe = is_probe};
    uint8_t *list = malloc(5 * (size_t)substeps + 2);
    if (!list) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for the stages of %u substeps", substeps);
    }
    const uint32_t count = ris__sim_stages(r->model, substeps, list);
    uint32_t steps = 0; /* verlets before this stage */
    ris_result result = RIS_OK;
    for (uint32_t k = 0; k < count && result == RIS_OK; k++) {
        at.substep = list[k] == RIS_STAGE_NORMAL ? 0 : list[k] > RIS_STAGE_VERLET ? steps - 1 : steps;
        steps += list[k] == RIS_STAGE_VERLET;
        result = both_stage(r, (ris_stage)list[k], k == 0 ? anchors : NULL, &at, err);
    }
    free(list);
    return result;
}

/* One step of every stage from a's state on both sides; then both states are put back. */
static ris_result probe(run *r, const ris_anchor_frame *anchors, uint32_t tick, ris_error *err)
{
    ris_sim *const side[2] = {r->def->a, r->def->b};
    ris_result result = RIS_OK;
    for (int s = 0; s < RIS_STATE_COUNT && result == RIS_OK; s++) {
        for (int k = 0; k < 2 && result == RIS_OK; k++) {
            result = ris_sim_read(side[k], (ris_state)s, r->saved[k][s], err);
        }
        if (result == RIS_OK) {
            result = ris_sim_write(side[1], (ris_state)s, r->saved[0][s], err);
        }
    }
    if (result == RIS_OK) {
        result = lockstep(r, anchors, tick, 1, true, err);
    }
    for (int s = 0; s < RIS_STATE_COUNT && result == RIS_OK; s++) {
        for (int k = 0; k < 2 && result == RIS_OK; k++) {
            result = ris_sim_write(side[k], (ris_state)s, r->saved[k][s], err);
        }
    }
    return result;
}

static void report_progress(const run *r, uint32_t done)
{
    if (r->def->progress) {
        r->def->progress(r->def->user, done, 2 * r->def->tick_count);
    }
}

static void count_moved(run *r)
{
    for (uint32_t i = 0; i < r->model->node_count; i++) {
        if (!r->moved[i] && distance(r->value[0][i], r->model->rest_position[i]) >= (double)MOVED_MM) {
            r->moved[i] = true;
            r->report->moved_count++;
        }
    }
}

static ris_result reset_both(run *r, ris_error *err)
{
    ris_result result = ris_sim_reset(r->def->a, err);
    return result == RIS_OK ? ris_sim_reset(r->def->b, err) : result;
}

/* Pass 1: whole ticks, as the engine runs them. */
static ris_result run_ticks(run *r, ris_error *err)
{
    static const ris_state end_state[] = {RIS_STATE_POSITION, RIS_STATE_VELOCITY_HALF,
                                          RIS_STATE_VELOCITY_PREV, RIS_STATE_NORMAL};
    ris_result result = reset_both(r, err);
    for (uint32_t tick = 1; tick <= r->def->tick_count && result == RIS_OK; tick++) {
        bool same = true;
        r->def->pose(r->def->user, tick, r->pose);
        result = ris_sim_tick(r->def->a, r->pose, err);
        if (result == RIS_OK) {
            result = ris_sim_tick(r->def->b, r->pose, err);
        }
        for (uint32_t s = 0; s < 4 && result == RIS_OK; s++) {
            uint32_t vertex;
            result = read_both(r, end_state[s], err);
            same = same && differing(r, &vertex) == 0;
            if (s == 0 && result == RIS_OK) {
                count_moved(r);
            }
        }
        r->report->differing_ticks += !same;
        report_progress(r, tick);
    }
    if (result == RIS_OK) {
        result = ris_sim_hash(r->def->a, &r->report->hash[0], err);
    }
    return result == RIS_OK ? ris_sim_hash(r->def->b, &r->report->hash[1], err) : result;
}

/* Pass 2: the same clip stage by stage. */
static ris_result run_stages(run *r, ris_error *err)
{
    ris_result result = reset_both(r, err);
    for (uint32_t tick = 1; tick <= r->def->tick_count && result == RIS_OK; tick++) {
        ris_anchor_frame anchors[2];
        r->def->pose(r->def->user, tick, r->pose);
        result = ris__sim_pose(r->def->a, r->pose, &anchors[0], err);
        if (result == RIS_OK) {
            result = ris__sim_pose(r->def->b, r->pose, &anchors[1], err);
        }
        if (result == RIS_OK && (tick % PROBE_EVERY == 0 || tick == r->def->tick_count)) {
            result = probe(r, anchors, tick, err);
        }
        if (result == RIS_OK) {
            result = lockstep(r, anchors, tick, r->report->substeps, false, err);
        }
        report_progress(r, r->def->tick_count + tick);
    }
    return result;
}

/* Whole ticks and single stages must have ended in the same state, or one of the two passes did something
 * else. */
static ris_result check_passes(run *r, ris_error *err)
{
    for (int side = 0; side < 2; side++) {
        uint64_t hash;
        ris_result result = ris_sim_hash(side ? r->def->b : r->def->a, &hash, err);
        if (result != RIS_OK) {
            return result;
        }
        if (hash != r->report->hash[side]) {
            return ris_fail(err, RIS_ERROR_FAILED,
                            "%s: whole ticks end in state %016llx, the same stages one by one in %016llx",
                            r->report->backend[side], (unsigned long long)r->report->hash[side],
                            (unsigned long long)hash);
        }
    }
    return RIS_OK;
}

/* NaN is over every tolerance. */
static bool is_over(const ris_compare_stage *stats, float tolerance_mm)
{
    return tolerance_mm > 0.0f ? !(stats->max_mm <= (double)tolerance_mm) : stats->differing_words > 0;
}

static ris_result judge(const run *r, ris_error *err)
{
    const ris_compare_report *report = r->report;
    for (uint32_t s = 0; s < RIS_STAGE_COUNT; s++) {
        const bool step = is_over(&report->step[s], r->def->step_tolerance_mm);
        const bool clip = is_over(&report->clip[s], r->def->clip_tolerance_mm);
        const ris_compare_stage *stats = clip ? &report->clip[s] : &report->step[s];
        if (step || clip) {
            return ris_fail(err, RIS_ERROR_FAILED,
                            "%s and %s differ in %s by up to %g mm (%llu words) %s, allowed %g mm; "
                            "the first place is %s, tick %u, substep %u, vertex %u",
                            report->backend[0], report->backend[1], ris_stage_name((ris_stage)s),
                            stats->max_mm, (unsigned long long)stats->differing_words,
                            clip ? "over the clip" : "after one step",
                            (double)(clip ? r->def->clip_tolerance_mm : r->def->step_tolerance_mm),
                            ris_stage_name(report->first_stage), report->first_tick, report->first_substep,
                            report->first_vertex);
        }
    }
    if (r->def->clip_tolerance_mm <= 0.0f && report->differing_ticks) {
        return ris_fail(err, RIS_ERROR_FAILED, "%s and %s differ after %llu of %u whole ticks",
                        report->backend[0], report->backend[1], (unsigned long long)report->differing_ticks,
                        report->tick_count);
    }
    return RIS_OK;
}

ris_result ris_compare_run(const ris_compare_def *def, ris_compare_report *out, ris_error *err)
{
    run r;
    ris_result result;
    memset(out, 0, sizeof *out);
    snprintf(out->backend[0], sizeof out->backend[0], "%s", ris_sim_backend(def->a));
    snprintf(out->backend[1], sizeof out->backend[1], "%s", ris_sim_backend(def->b));
    if (def->a == def->b || strcmp(out->backend[0], out->backend[1]) == 0) {
        return ris_fail(err, RIS_ERROR_USAGE, "%s would be compared with itself", out->backend[0]);
    }
    if (ris_sim_get_model(def->a) != ris_sim_get_model(def->b) || def->tick_count == 0) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "a comparison needs two simulations of one model and at least one tick");
    }
    result = init_run(&r, def, out, err);
    out->tick_count = def->tick_count;
    out->substeps = r.model->head->tissue.substeps;
    out->node_count = r.model->node_count;
    out->moving_count = r.model->moving_count;
    if (result == RIS_OK) {
        result = run_ticks(&r, err);
    }
    if (result == RIS_OK && out->moved_count < def->moved_minimum) {
        result = ris_fail(err, RIS_ERROR_FAILED, "the clip moves %u vertices by 2 mm, a comparison needs %u",
                          out->moved_count, def->moved_minimum);
    }
    if (result == RIS_OK) {
        result = run_stages(&r, err);
    }
    if (result == RIS_OK) {
        result = check_passes(&r, err);
    }
    if (result == RIS_OK) {
        result = judge(&r, err);
    }
    free_run(&r);
    return result;
}
