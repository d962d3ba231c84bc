/* The solver: Levenberg-Marquardt with bounds. Every step is a bounded least-squares problem on the response of the face at
 * the pose reached so far, and counts only if the simulated face, held until at rest, came nearer. */
#include "model/model_impl.h"
#include "risorius/timeline.h"
#include "solve/bounded.h"
#include "solve/solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RIDGE_MM 0.003   /* least rms that a control at full value must save to be worth it */
#define LARGEST_STEP 0.2 /* secants later: as wide as the last way, within these */
#define SMALLEST_STEP 0.05
#define LAST_STEP 0.1 /* at the pose found */
#define HOLD_S 4.0
#define GLANCE_MM 0.1 /* while the face is farther, what moves late is less than what is left: */
#define GLANCE_S 0.2  /* then it is held for so long only */
#define TRIES 6
#define STALLED 0.01 /* an iteration that gains less than this share is one of STALLS that end the search */
#define STALLED_NEAR 0.25 /* the same once the face is nearer than GOOD_MM */
#define STALLS 2
#define QUICK 0.5 /* after an iteration that gained more, what does not act is not asked again */

#define GOOD_SHARE 0.01 /* of the distance from rest: nearer than this no other attempt is made */
#define GOOD_MM 0.01

/* How a search sets out from rest: the secants there, where a little of a muscle says nothing yet; how short its first steps
 * are; and how dear activation is while the face is far. Dear, because antagonists cost nothing else: loaded against each other
 * they end where the closed jaw answers to nothing that opens it. The first takes few controls, the others all at once. */
static const struct attempt {
    bool few;
    double first_step, damping, caution;
} attempts[] = {{.few = true, .first_step = 0.5},
                {false, 0.5, 1e-3, 0.1},
                {false, 0.25, 0.3, 0.3},
                {false, 1, 0.03, 0.03}};
#define ATTEMPTS (sizeof attempts / sizeof *attempts)

bool ris_control_independent(const ris_control_found *found)
{
    return found->share >= RIS_INDEPENDENT_SHARE && found->reach_mm >= RIS_INDEPENDENT_MM;
}

static ris_result check(const ris_solve_def *def, const ris_target *target, ris_error *err)
{
    const ris_model *model = def->sim_count ? ris_sim_get_model(def->sim[0]) : NULL;
    if (!model || def->sim_count > RIS_SOLVE_SIMS || def->control_count == 0 ||
        def->control_count > RIS_SOLVE_CONTROLS || target->count == 0) {
        return ris_fail(
            err, RIS_ERROR_USAGE,
            "solve needs 1 to %d simulations, 1 to %d controls and a target of at least one point",
            RIS_SOLVE_SIMS, RIS_SOLVE_CONTROLS);
    }
    for (uint32_t k = 0; k < def->control_count; ++k) {
        const ris_control *control = &def->control[k];
        if (!(control->minimum <= 0 && control->maximum >= 0 && control->minimum < control->maximum)) {
            return ris_fail(err, RIS_ERROR_USAGE, "control %s: its range must hold 0 and more",
                            control->name);
        }
    }
    return RIS_OK;
}

/* A target stands in the space of the head: how the head is held is no part of a face. */
static ris_result check_head(const ris_solver *s, uint32_t k, ris_error *err)
{
    for (uint32_t c = 0; c < s->model->channel_count; ++c) {
        const char *name = s->model->channel[c].name;
        if (s->unit[(size_t)k * s->model->channel_count + c] != 0.0f && strncmp(name, "head.", 5) == 0) {
            return ris_fail(err, RIS_ERROR_USAGE,
                            "control %s: %s cannot be solved for, it moves the head as a whole",
                            s->def->control[k].name, name);
        }
    }
    return RIS_OK;
}

static ris_result open_solver(ris_solver *s, ris_error *err)
{
    const size_t n = s->n, nodes = s->model->node_count, rows = s->rows, channels = s->model->channel_count;
    const struct {
        void *out;
        size_t count, size;
    } room[] = {
        {&s->knob, n, sizeof *s->knob},
        {&s->unit, n * channels, sizeof *s->unit},
        {&s->u, n, sizeof *s->u},
        {&s->step, n, sizeof *s->step},
        {&s->frozen, n, sizeof *s->frozen},
        {&s->drive, RIS_SOLVER_JAW * n, sizeof *s->drive},
        {&s->pose, channels, sizeof *s->pose},
        {&s->seen, rows, sizeof *s->seen},
        {&s->column, 2 * n * rows, sizeof *s->column},
        {&s->gram, 4 * n * n, sizeof *s->gram},
        {&s->damped, n * n, sizeof *s->damped},
        {&s->work, 4 * n * n + 2 * n, sizeof *s->work},
        {&s->g, n, sizeof *s->g},
        {&s->right, n, sizeof *s->right},
        {&s->low, n, sizeof *s->low},
        {&s->high, n, sizeof *s->high},
        {&s->d, 2 * n, sizeof *s->d},
        {&s->tried_u, n, sizeof *s->tried_u},
        {&s->tried_seen, rows, sizeof *s->tried_seen},
        {&s->tried_pose, channels, sizeof *s->tried_pose},
        {&s->wanted, n, sizeof *s->wanted},
        {&s->position, nodes, sizeof *s->position},
    };
    ris_result r = ris__snapshot_make(s->model, &s->now, err);
    for (size_t k = 0; !r && k < sizeof room / sizeof *room; ++k) {
        r = ris__model_alloc(room[k].out, room[k].count, room[k].size, "the solver", err);
    }
    for (uint32_t k = 0; !r && k < s->n; ++k) {
        const ris_control *control = &s->def->control[k];
        const double scale = fmax(-(double)control->minimum, (double)control->maximum);
        s->knob[k] = (ris_knob){scale, (double)control->minimum / scale, (double)control->maximum / scale};
        r = ris_pose_add(s->model, control->name, (float)scale, s->unit + k * channels, err);
        r = r ? r : check_head(s, k, err);
    }
    if (!r) {
        ris__solver_find_drives(s);
    }
    return r;
}

static void close_solver(ris_solver *s)
{
    void *const list[] = {s->knob,       s->unit,   s->u,        s->step,   s->frozen,  s->pose,
                          s->seen,       s->column, s->gram,     s->damped, s->work,    s->g,
                          s->right,      s->low,    s->high,     s->d,      s->tried_u, s->tried_seen,
                          s->tried_pose, s->wanted, s->position, s->drive};
    ris__snapshot_free(&s->now);
    for (size_t k = 0; k < sizeof list / sizeof *list; ++k) {
        free(list[k]);
    }
}

static double distance2(const ris_target *target, const float *seen, uint32_t i)
{
    const double x = (double)target->at[i].x - (double)seen[3 * i],
                 y = (double)target->at[i].y - (double)seen[3 * i + 1],
                 z = (double)target->at[i].z - (double)seen[3 * i + 2];
    return (x * x + y * y) + z * z;
}

/* rms of the distances; *out_max and *out_worst may be NULL. */
static double measure(const ris_target *target, const float *seen, double *out_max, uint32_t *out_worst)
{
    double sum = 0, most = -1;
    uint32_t worst = 0;
    for (uint32_t i = 0; i < target->count; ++i) {
        const double d2 = distance2(target, seen, i);
        sum += d2;
        if (d2 > most) {
            most = d2;
            worst = i;
        }
    }
    if (out_max) {
        *out_max = sqrt(most);
        *out_worst = worst;
    }
    return sqrt(sum / target->count);
}

/* What is made least, mm^2: mean square distance and the ridge. */
static double cost(const ris_solver *s, double rms_mm, const double *u)
{
    double sum = 0;
    for (uint32_t k = 0; k < s->n; ++k) {
        sum += u[k] * u[k];
    }
    return rms_mm * rms_mm + s->ridge_mm * s->ridge_mm * sum;
}

/* Holds a pose from where sim[0] stands, and looks. */
static ris_result hold(ris_solver *s, const float *pose, double limit_s, float *seen, bool *out_rest,
                       ris_error *err)
{
    ris_hold held = {0};
    ris_result r = ris_sim_hold(s->def->sim[0], pose, limit_s, &held, err);
    ++s->holds;
    if (!r) {
        r = ris_sim_read(s->def->sim[0], RIS_STATE_POSITION, s->position, err);
    }
    if (!r) {
        ris__solver_see(s, s->def->sim[0], s->position, seen);
    }
    *out_rest = held.at_rest;
    return r;
}

static double dot_column(const ris_solver *s, uint32_t a, uint32_t b)
{
    const float *p = s->column + (size_t)a * s->rows, *q = s->column + (size_t)b * s->rows;
    double sum = 0;
    for (uint32_t i = 0; i < s->rows; ++i) {
        sum += (double)p[i] * (double)q[i];
    }
    return sum;
}

/* How much the control brings towards the target, per unit of u. */
static double descent(const ris_solver *s, uint32_t k)
{
    const float *column = s->column + (size_t)k * s->rows;
    double sum = 0;
    for (uint32_t i = 0; i < s->target->count; ++i) {
        const ris_vec3 at = s->target->at[i];
        sum += (double)column[3 * i] * ((double)at.x - (double)s->seen[3 * i]) +
               (double)column[3 * i + 1] * ((double)at.y - (double)s->seen[3 * i + 1]) +
               (double)column[3 * i + 2] * ((double)at.z - (double)s->seen[3 * i + 2]);
    }
    return sum / s->target->count;
}

bool ris__solver_is_at_fork(const ris_solver *s, uint32_t k)
{
    return s->knob[k].low < 0 && s->knob[k].high > 0 && fabs(s->u[k]) <= RIS_SOLVER_NOTHING;
}

void ris__solver_choose_step(ris_solver *s, uint32_t k, double size)
{
    const ris_knob *knob = &s->knob[k];
    if (fabs(s->u[k]) > RIS_SOLVER_NOTHING && fabs(s->u[k]) < RIS_SOLVER_LITTLE) {
        s->step[k] = -s->u[k];
        return;
    }
    double step = s->step[k] < 0 ? -size : size;
    if (s->u[k] + step > knob->high || s->u[k] + step < knob->low) {
        step = -step;
    }
    if (s->u[k] + step > knob->high || s->u[k] + step < knob->low) {
        step = knob->high - s->u[k] > s->u[k] - knob->low ? knob->high - s->u[k] : knob->low - s->u[k];
    }
    s->step[k] = step;
}

/* At a fork the side that helps, or the one that harms less. */
static ris_result respond(ris_solver *s, bool all, ris_error *err)
{
    bool any = false;
    for (uint32_t k = 0; k < s->n; ++k) { /* what does not act answers now much as it did a little before */
        s->wanted[k] = !s->frozen[k] && (all || s->u[k] != 0);
    }
    ris_result r = ris__solver_respond(s, s->wanted, err);
    for (uint32_t k = 0; k < s->n && !r; ++k) {
        s->g[k] = descent(s, k);
        const double other = s->u[k] - s->step[k];
        s->wanted[k] = s->wanted[k] && ris__solver_is_at_fork(s, k) && s->g[k] * s->step[k] < 0 &&
                       other <= s->knob[k].high && other >= s->knob[k].low;
        s->step[k] = s->wanted[k] ? -s->step[k] : s->step[k];
        any = any || s->wanted[k];
    }
    if (!r && any) {
        r = ris__solver_respond(s, s->wanted, err);
    }
    for (uint32_t k = 0; !r && any && k < s->n; ++k) {
        s->g[k] = s->wanted[k] ? descent(s, k) : s->g[k];
    }
    return r;
}

ris_result ris__solver_linearise(ris_solver *s, bool all, ris_error *err)
{
    ris_result r = respond(s, all, err);
    for (uint32_t a = 0; !r && a < s->n; ++a) {
        for (uint32_t b = 0; b <= a; ++b) {
            s->gram[(size_t)a * s->n + b] = s->gram[(size_t)b * s->n + a] =
                s->frozen[a] || s->frozen[b] ? 0 : dot_column(s, a, b) / s->target->count;
        }
    }
    return r;
}

void ris__solver_bounds(const ris_solver *s, uint32_t k, double *out_low, double *out_high)
{
    const bool fork = ris__solver_is_at_fork(s, k);
    *out_low = fork && s->step[k] > 0 ? fmin(-s->u[k], 0) : s->knob[k].low - s->u[k];
    *out_high = fork && s->step[k] < 0 ? fmax(-s->u[k], 0) : s->knob[k].high - s->u[k];
}

/* The step for the present damping: into d, within the bounds. False if there is none. */
static bool find_step(const ris_solver *s)
{
    const uint32_t n = s->n;
    const double ridge = s->ridge_mm * s->ridge_mm;
    memcpy(s->damped, s->gram, (size_t)n * n * sizeof *s->gram);
    for (uint32_t k = 0; k < n; ++k) {
        s->damped[(size_t)k * n + k] += ridge + s->damping * (s->gram[(size_t)k * n + k] + ridge);
        s->right[k] = s->g[k] - ridge * s->u[k];
        ris__solver_bounds(s, k, &s->low[k], &s->high[k]);
        if (s->frozen[k]) {
            s->right[k] = s->low[k] = s->high[k] = 0;
        }
    }
    return ris__bounded_minimum(n, s->damped, s->right, s->low, s->high, s->d, s->work);
}

ris_result ris__solver_try(ris_solver *s, double *out_rms, ris_error *err)
{
    bool rest;
    for (uint32_t k = 0; k < s->n; ++k) {
        s->tried_u[k] = fmin(fmax(s->tried_u[k], s->knob[k].low), s->knob[k].high);
    }
    ris__solver_pose(s, s->tried_u, s->tried_pose);
    ris_result r =
        hold(s, s->tried_pose, s->rms_mm > GLANCE_MM ? GLANCE_S : HOLD_S, s->tried_seen, &rest, err);
    s->glanced = !rest && s->rms_mm > GLANCE_MM;
    *out_rms = r ? 0 : measure(s->target, s->tried_seen, NULL, NULL);
    return r;
}

ris_result ris__solver_keep(ris_solver *s, ris_error *err)
{
    for (uint32_t k = 0; k < s->n; ++k) {
        const double way = s->tried_u[k] - s->u[k];
        s->step[k] = way < 0 ? -1 : 1;
        s->u[k] = s->tried_u[k];
        ris__solver_choose_step(s, k, fmin(fmax(fabs(way), SMALLEST_STEP), LARGEST_STEP));
    }
    ris__solver_step_inwards(s);
    memcpy(s->seen, s->tried_seen, s->rows * sizeof *s->seen);
    memcpy(s->pose, s->tried_pose, s->model->channel_count * sizeof *s->pose);
    s->rms_mm = measure(s->target, s->seen, NULL, NULL);
    return ris__snapshot_take(s->def->sim[0], &s->now, err);
}

ris_result ris__solver_improve(ris_solver *s, double *out_gain, ris_error *err)
{
    s->ridge_mm = fmax(RIDGE_MM, s->caution * s->rms_mm);
    const double before = cost(s, s->rms_mm, s->u);
    const bool glanced = s->glanced;
    ris_result r = RIS_OK;
    *out_gain = 0;
    for (int try = 0; !r && try < TRIES; ++try) {
        double rms;
        if (!find_step(s)) {
            return ris_fail(err, RIS_ERROR_FAILED, "the response of the face is no number");
        }
        for (uint32_t k = 0; k < s->n; ++k) {
            s->tried_u[k] = s->u[k] + s->d[k];
        }
        ris__solver_keep_jaw(s, s->d, s->tried_u);
        r = ris__solver_try(s, &rms, err);
        const double after = r ? 0 : cost(s, rms, s->tried_u);
        if (!r && after < before) {
            s->damping = fmax(s->damping / 5, 1e-6);
            *out_gain = 1 - after / before;
            return ris__solver_keep(s, err);
        }
        s->damping = fmax(s->damping * 8, 1e-3);
        s->glanced = glanced;
        if (!r) {
            r = ris__snapshot_put(s->def->sim[0], &s->now, err);
        }
    }
    return r;
}

/* Rest, as the place to start from. */
static ris_result start(ris_solver *s, double first_step, ris_solve_result *out, ris_error *err)
{
    bool rest;
    memset(s->u, 0, s->n * sizeof *s->u);
    memset(s->pose, 0, s->model->channel_count * sizeof *s->pose);
    s->glanced = false;
    for (uint32_t t = 0; t < s->def->sim_count; ++t) { /* equilibria count, not the way to them */
        ris_sim_set_onset(s->def->sim[t], false);
    }
    ris_result r = ris_sim_reset(s->def->sim[0], err);
    if (!r) {
        r = hold(s, s->pose, HOLD_S, s->seen, &rest, err);
    }
    if (!r) {
        r = ris__snapshot_take(s->def->sim[0], &s->now, err);
    }
    s->rms_mm = out->rest_rms_mm = r ? 0 : measure(s->target, s->seen, &out->rest_max_mm, &out->worst);
    for (uint32_t k = 0; k < s->n; ++k) {
        s->step[k] = 0;
        ris__solver_choose_step(s, k, first_step);
    }
    return r;
}

/* Lets a face that was only glanced at come to rest, so that steps are judged by where it ends. */
static ris_result settle(ris_solver *s, ris_error *err)
{
    bool rest;
    s->glanced = false;
    ris_result r = hold(s, s->pose, HOLD_S, s->seen, &rest, err);
    if (!r) {
        s->rms_mm = measure(s->target, s->seen, NULL, NULL);
        r = ris__snapshot_take(s->def->sim[0], &s->now, err);
    }
    return r;
}

ris_result ris__solver_search(ris_solver *s, double caution, double damping, ris_error *err)
{
    const ris_solve_def *def = s->def;
    const uint32_t first = s->iteration, last = first + def->iteration_limit;
    double gain = 1;
    bool all = true; /* controls answer anew; after a quick gain only those that act */
    ris_result r = RIS_OK;
    s->caution = caution;
    s->damping = damping;
    for (uint32_t stalls = 0;
         !r && s->iteration < last && stalls < STALLS && gain > 0 && s->rms_mm > def->enough_mm;
         ++s->iteration) {
        r = ris__solver_linearise(s, all, err);
        if (!r) {
            r = ris__solver_improve(s, &gain, err);
        }
        all = gain < QUICK || s->iteration == first;
        if (!r && s->glanced && (gain == 0 || s->rms_mm <= GLANCE_MM)) {
            r = settle(s, err);
            gain = 1;
        }
        stalls = gain < (s->rms_mm > GOOD_MM ? STALLED : STALLED_NEAR) ? stalls + 1 : 0;
        if ((stalls == STALLS || gain == 0) && s->caution > 0 &&
            s->rms_mm > GOOD_MM) { /* at last the distance alone counts */
            s->caution = s->caution > RIS_SOLVER_LITTLE_CAUTION ? RIS_SOLVER_LITTLE_CAUTION : 0;
            s->damping = RIS_SOLVER_LAST_DAMPING;
            stalls = 0;
            gain = 1;
        }
    }
    s->caution = 0;
    return r;
}

/* Searches anew, on other ways, while the face stays far; the nearest is the state. best: (n). */
static ris_result search_all(ris_solver *s, ris_solve_result *out, double *best, ris_error *err)
{
    double nearest = INFINITY;
    ris_result r = RIS_OK;
    for (size_t a = 0;
         !r && a < ATTEMPTS &&
         !(nearest <= (a > 1 ? fmax(GOOD_MM, GOOD_SHARE * out->rest_rms_mm) : RIS_SOLVER_NEAR_MM));
         ++a) {
        const struct attempt *way = &attempts[a];
        r = start(s, way->first_step, out, err);
        if (!r) {
            r = way->few ? ris__solver_pursue(s, err)
                         : ris__solver_search(s, way->caution, way->damping, err);
        }
        if (!r && s->rms_mm < nearest) {
            nearest = s->rms_mm;
            memcpy(best, s->u, s->n * sizeof *best);
        }
    }
    if (!r && s->rms_mm > nearest) {
        memcpy(s->u, best, s->n * sizeof *best);
        ris__solver_pose(s, s->u, s->pose);
        r = settle(s, err);
    }
    return r;
}

/* Parts of the columns that no mixture of the others gives, into d, and their lengths into g. Of a control with two sides at
 * rest both count: the side that was left closed may be what another control does. */
static ris_result find_shares(ris_solver *s, ris_error *err)
{
    uint32_t count = s->n;
    ris_result r = ris__solver_linearise(s, true, err);
    for (uint32_t k = 0; k < s->n; ++k) {
        const double other = s->u[k] - s->step[k];
        s->wanted[k] = ris__solver_is_at_fork(s, k) && other <= s->knob[k].high && other >= s->knob[k].low;
        if (s->wanted[k]) {
            memcpy(s->column + (size_t)count++ * s->rows, s->column + (size_t)k * s->rows,
                   s->rows * sizeof *s->column);
            s->step[k] = -s->step[k];
        }
    }
    if (!r && count > s->n) {
        r = ris__solver_respond(s, s->wanted, err);
    }
    for (uint32_t a = 0; !r && a < count; ++a) {
        for (uint32_t b = 0; b <= a; ++b) {
            s->gram[(size_t)a * count + b] = s->gram[(size_t)b * count + a] =
                dot_column(s, a, b) / s->target->count;
        }
    }
    if (!r) {
        ris__independent_shares(count, s->gram, s->d, s->work);
    }
    for (uint32_t k = 0, side = s->n; !r && k < s->n; ++k) {
        s->g[k] = sqrt(s->gram[(size_t)k * count + k]);
        if (s->wanted[k]) {
            s->d[k] = fmin(s->d[k], s->d[side]);
            s->g[k] = fmin(s->g[k], sqrt(s->gram[(size_t)side * count + side]));
            ++side;
        }
    }
    return r;
}

/* The pose rounded, held from rest, and how the controls show in it. */
static ris_result finish(ris_solver *s, ris_solve_result *out, ris_control_found *found, float *pose,
                         ris_error *err)
{
    for (uint32_t k = 0; k < s->n; ++k) {
        s->u[k] = round(s->u[k] * 1000) / 1000;
        s->frozen[k] = false;
        s->step[k] = fabs(s->step[k]);
        ris__solver_choose_step(s, k, LAST_STEP);
    }
    ris__solver_pose(s, s->u, s->pose);
    ris_result r = ris_sim_reset(s->def->sim[0], err);
    if (!r) {
        r = hold(s, s->pose, HOLD_S, s->seen, &out->at_rest, err);
    }
    if (!r) {
        out->rms_mm = s->rms_mm = measure(s->target, s->seen, &out->max_mm, &out->worst);
        r = ris__snapshot_take(s->def->sim[0], &s->now, err);
    }
    if (!r) {
        r = find_shares(s, err);
    }
    if (!r) {
        for (uint32_t k = 0; k < s->n; ++k) {
            found[k] = (ris_control_found){
                .value = (float)(s->u[k] * s->knob[k].scale), .reach_mm = s->g[k], .share = s->d[k]};
        }
        memcpy(pose, s->pose, s->model->channel_count * sizeof *pose);
    }
    out->iterations = s->iteration;
    out->holds = s->holds;
    return r;
}

ris_result ris_solve(const ris_solve_def *def, const ris_target *target, ris_solve_result *out,
                     ris_control_found *found, float *pose, ris_error *err)
{
    *out = (ris_solve_result){0};
    ris_result r = check(def, target, err);
    if (r) {
        return r;
    }
    ris_solver s = {.def = def,
                    .model = ris_sim_get_model(def->sim[0]),
                    .target = target,
                    .n = def->control_count,
                    .rows = 3 * target->count};
    double *best = NULL;
    r = ris__model_alloc(&best, s.n, sizeof *best, "the solver", err);
    if (!r) {
        r = open_solver(&s, err);
    }
    if (!r) {
        r = search_all(&s, out, best, err);
    }
    if (!r) {
        r = ris__solver_thin_out(&s, err);
    }
    if (!r) {
        r = finish(&s, out, found, pose, err);
    }
    for (uint32_t t = 0; t < def->sim_count; ++t) {
        ris_sim_set_onset(def->sim[t], true);
    }
    close_solver(&s);
    free(best);
    return r;
}
