/* Few channels rather than many: where several mixtures give the same face, least squares spreads it over all of them. What
 * can be left out is guessed on the response, others making up for it, and kept only if the simulated face stays as near. */
#include "model/model_impl.h"
#include "solve/bounded.h"
#include "solve/solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SLACK_MM 0.001 /* farther by so much, or by SLACK_SHARE of the distance, is as near */
#define SLACK_SHARE 0.02
#define REACH_COUNTS 1e-3 /* of two that are as easy to leave out, first the one with less reach */
#define ROUNDS 8
#define REFUSALS 3
#define REPAIRS 4 /* steps of what is left, after something was left out */
#define UNIQUE 1e-9

typedef struct thinning {
    uint32_t *index;       /* of the controls that act, those left first (n) */
    double *value;         /* what is left takes on, u (n) */
    double *factor, *unit; /* (n x n), (n) */
    ris_place before;
} thinning;

static ris_result open_thinning(const ris_solver *s, thinning *t, ris_error *err)
{
    const struct {
        void *out;
        size_t count, size;
    } room[] = {{&t->index, s->n, sizeof *t->index},
                {&t->value, s->n, sizeof *t->value},
                {&t->factor, (size_t)s->n * s->n, sizeof *t->factor},
                {&t->unit, s->n, sizeof *t->unit}};
    ris_result r = ris__place_make(s, &t->before, err);
    for (size_t k = 0; !r && k < sizeof room / sizeof *room; ++k) {
        r = ris__model_alloc(room[k].out, room[k].count, room[k].size, "the solver", err);
    }
    return r;
}

static void close_thinning(thinning *t)
{
    void *const list[] = {t->index, t->value, t->factor, t->unit};
    ris__place_free(&t->before);
    for (size_t k = 0; k < sizeof list / sizeof *list; ++k) {
        free(list[k]);
    }
}

/* Cholesky factor of the Gram matrix of the first count, with unit diagonal. */
static bool factorise(const ris_solver *s, const thinning *t, uint32_t count)
{
    for (uint32_t a = 0; a < count; ++a) {
        for (uint32_t b = 0; b <= a; ++b) {
            const size_t i = t->index[a], k = t->index[b];
            const double length = sqrt(s->gram[i * s->n + i] * s->gram[k * s->n + k]);
            t->factor[(size_t)a * count + b] = (length > 0 ? s->gram[i * s->n + k] / length : 0) +
                                               (a == b ? UNIQUE + (length > 0 ? 0 : 1) : 0);
        }
    }
    return ris__cholesky(count, t->factor);
}

static double reach(const ris_solver *s, const thinning *t, uint32_t a)
{
    const size_t i = t->index[a];
    return sqrt(s->gram[i * s->n + i]);
}

/* With the a-th of count left out: the loss in mm^2, and what the others become into t->unit. INFINITY if one of them would
 * have to leave its range. */
static double leave_out(const ris_solver *s, const thinning *t, uint32_t count, uint32_t a)
{
    const double own = reach(s, t, a);
    memset(t->unit, 0, count * sizeof *t->unit);
    t->unit[a] = 1;
    ris__cholesky_solve(count, t->factor, t->unit);
    /* column a of the inverse: -u_a / inverse_aa of it is the least change that takes u_a to 0 */
    const double inverse = t->unit[a], loss = t->value[a] * own;
    bool within = true;
    for (uint32_t b = 0; b < count; ++b) {
        const double other = reach(s, t, b);
        const double change = other > 0 ? -t->value[a] * own * t->unit[b] / (inverse * other) : 0;
        const ris_knob *knob = &s->knob[t->index[b]];
        t->unit[b] = b == a ? 0 : t->value[b] + change;
        within = within && t->unit[b] >= knob->low && t->unit[b] <= knob->high;
    }
    return within ? loss * loss / inverse : INFINITY;
}

/* Leaves out as many as the slack allows; those left stand first. Returns their count. */
static uint32_t guess(const ris_solver *s, const thinning *t, uint32_t count, double slack_mm)
{
    double room = (s->rms_mm + slack_mm) * (s->rms_mm + slack_mm) - s->rms_mm * s->rms_mm;
    while (count > 0 && factorise(s, t, count)) {
        uint32_t best = count;
        double least = INFINITY, best_loss = 0;
        for (uint32_t a = 0; a < count; ++a) {
            const double loss = leave_out(s, t, count, a);
            const double score = sqrt(loss) + REACH_COUNTS * reach(s, t, a);
            if (loss <= room && score < least) {
                least = score;
                best = a;
                best_loss = loss;
            }
        }
        if (best == count) {
            break;
        }
        leave_out(s, t, count, best);
        memcpy(t->value, t->unit, count * sizeof *t->value);
        room -= best_loss;
        --count;
        const uint32_t gone = t->index[best];
        t->index[best] = t->index[count];
        t->value[best] = t->value[count];
        t->index[count] = gone;
    }
    return count;
}

/* Holds what the guess made of the pose, and lets what is left find its values anew. */
static ris_result repair(ris_solver *s, const thinning *t, uint32_t left, double limit_mm, ris_error *err)
{
    double rms, gain = 1;
    memset(s->tried_u, 0, s->n * sizeof *s->tried_u);
    for (uint32_t k = 0; k < s->n; ++k) {
        s->frozen[k] = true;
    }
    for (uint32_t a = 0; a < left; ++a) {
        s->tried_u[t->index[a]] = t->value[a];
        s->frozen[t->index[a]] = false;
    }
    ris_result r = ris__solver_try(s, &rms, err);
    if (!r) {
        r = ris__solver_keep(s, err);
    }
    s->damping = 1e-4;
    for (int k = 0; !r && k < REPAIRS && gain > 0 && s->rms_mm > limit_mm; ++k) {
        ++s->iteration;
        r = ris__solver_linearise(s, false, err);
        if (!r) {
            r = ris__solver_improve(s, &gain, err);
        }
    }
    return r;
}

/* The jaw's own channels that only hold against closing muscles: without them the jaw stands where it stood. */
static ris_result let_jaw_go(ris_solver *s, thinning *t, double limit_mm, ris_error *err)
{
    double rms;
    memcpy(s->tried_u, s->u, s->n * sizeof *s->u);
    if (!ris__solver_let_jaw_go(s, s->tried_u)) {
        return RIS_OK;
    }
    ris__place_remember(s, &t->before);
    ris_result r = ris__solver_try(s, &rms, err);
    if (!r) {
        r = ris__solver_keep(s, err);
    }
    return r || s->rms_mm <= limit_mm ? r : ris__place_return(s, &t->before, err);
}

ris_result ris__solver_thin_out(ris_solver *s, ris_error *err)
{
    thinning t = {0};
    double slack = SLACK_MM + SLACK_SHARE * s->rms_mm;
    const double limit = fmax(s->rms_mm + slack, s->def->enough_mm);
    ris_result r = open_thinning(s, &t, err);
    uint32_t refusals = 0;
    for (uint32_t k = 0; k < s->n; ++k) {
        s->frozen[k] = s->u[k] == 0;
    }
    for (int round = 0; !r && round < ROUNDS && refusals < REFUSALS; ++round) {
        uint32_t count = 0;
        for (uint32_t k = 0; k < s->n; ++k) {
            ris__solver_choose_step(s, k, fabs(s->step[k]));
            if (!s->frozen[k]) {
                t.value[count] = s->u[k];
                t.index[count++] = k;
            }
        }
        ris__solver_step_inwards(s);
        r = ris__solver_linearise(s, false, err);
        const uint32_t left = r ? 0 : guess(s, &t, count, slack);
        if (r || left == count) {
            break;
        }
        ris__place_remember(s, &t.before);
        r = repair(s, &t, left, limit, err);
        if (!r && !(s->rms_mm <= limit)) {
            r = ris__place_return(s, &t.before, err);
            slack /= 4;
            ++refusals;
        }
    }
    if (!r) {
        r = let_jaw_go(s, &t, limit, err);
    }
    close_thinning(&t);
    return r;
}
