/* Few controls: from rest one more at a time, the one that alone would gain most (orthogonal matching pursuit, Pati, Rezaiifar
 * and Krishnaprasad 1993). What all controls at once would spread over antagonists that hold each other is found as the one
 * muscle it was. A muscle that was taken early for its neighbour holds the rest in its place, so when no more helps, each is
 * exchanged for others, or left out, and the search goes on from the first exchange that brings the face nearer. */
#include "model/model_impl.h"
#include "solve/bounded.h"
#include "solve/solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST 12             /* controls taken at a time */
#define GAIN 0.98           /* one more, or an exchange, must bring the distance down to this share */
#define STAND_INS 3         /* for each control, the most promising; leaving it out is tried too */
#define EXCHANGE_STEP 0.3   /* secants of what acts little: narrower ones say too little of a muscle */
#define EXCHANGE_LEAST 0.02 /* u of a stand-in below which it stands for nothing */
#define TRIALS 150          /* exchanges simulated, over the whole pursuit */
#define SURE_MM2 1e-5       /* on the diagonal, so that equal columns share the work */
#define SURE_SHARE 1e-6

typedef struct exchange {
    uint32_t out, in; /* in: n for none */
    double rms_mm;    /* promised by the response */
} exchange;

typedef struct pursuit {
    bool *taken;     /* (n) */
    uint32_t *set;   /* of a promise, ascending (MOST) */
    exchange *list;  /* ((1 + STAND_INS) x MOST) */
    double *reached; /* u that each promises (listed x n) */
    double *h, *g, *low, *high, *d, *work;
    ris_place before;
    uint32_t trials;
} pursuit;

static ris_result open_pursuit(const ris_solver *s, pursuit *p, ris_error *err)
{
    const size_t listed = (1 + STAND_INS) * MOST;
    const struct {
        void *out;
        size_t count, size;
    } room[] = {{&p->taken, s->n, sizeof *p->taken}, {&p->set, MOST, sizeof *p->set},
                {&p->list, listed, sizeof *p->list}, {&p->reached, listed * s->n, sizeof *p->reached},
                {&p->h, MOST * MOST, sizeof *p->h},  {&p->g, MOST, sizeof *p->g},
                {&p->low, MOST, sizeof *p->low},     {&p->high, MOST, sizeof *p->high},
                {&p->d, MOST, sizeof *p->d},         {&p->work, MOST * MOST + 2 * MOST, sizeof *p->work}};
    *p = (pursuit){0};
    ris_result r = ris__place_make(s, &p->before, err);
    for (size_t k = 0; !r && k < sizeof room / sizeof *room; ++k) {
        r = ris__model_alloc(room[k].out, room[k].count, room[k].size, "the solver", err);
    }
    return r;
}

static void close_pursuit(pursuit *p)
{
    void *const list[] = {p->taken, p->set, p->list, p->reached, p->h, p->g, p->low, p->high, p->d, p->work};
    ris__place_free(&p->before);
    for (size_t k = 0; k < sizeof list / sizeof *list; ++k) {
        free(list[k]);
    }
}

/* The control left out that a step would gain most by, alone; n if there is none. */
static uint32_t best_left_out(const ris_solver *s, const bool *taken)
{
    uint32_t found = s->n;
    double most = 0;
    for (uint32_t k = 0; k < s->n; ++k) {
        const double square = s->gram[(size_t)k * s->n + k];
        const double way = s->g[k] > 0 ? s->knob[k].high - s->u[k] : s->u[k] - s->knob[k].low;
        if (!taken[k] && square > 0 && way > RIS_SOLVER_NOTHING && s->g[k] * s->g[k] / square > most) {
            most = s->g[k] * s->g[k] / square;
            found = k;
        }
    }
    return found;
}

static ris_result respond_all(ris_solver *s, ris_error *err)
{
    memset(s->frozen, 0, s->n * sizeof *s->frozen);
    return ris__solver_linearise(s, true, err);
}

static ris_result search_taken(ris_solver *s, const bool *taken, ris_error *err)
{
    for (uint32_t k = 0; k < s->n; ++k) {
        s->frozen[k] = !taken[k];
    }
    return ris__solver_search(s, RIS_SOLVER_LITTLE_CAUTION, RIS_SOLVER_LAST_DAMPING, err);
}

static uint32_t count_taken(const ris_solver *s, const pursuit *p)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < s->n; ++k) {
        count += p->taken[k];
    }
    return count;
}

/* One more at a time, while that helps. */
static ris_result grow(ris_solver *s, pursuit *p, ris_error *err)
{
    double before = INFINITY;
    ris_result r = RIS_OK;
    for (uint32_t count = count_taken(s, p);
         !r && count < MOST && s->rms_mm > RIS_SOLVER_NEAR_MM && s->rms_mm < GAIN * before; ++count) {
        before = s->rms_mm;
        r = respond_all(s, err);
        const uint32_t more = r ? s->n : best_left_out(s, p->taken);
        if (more == s->n) {
            break;
        }
        p->taken[more] = true;
        r = search_taken(s, p->taken, err);
    }
    return r;
}

/* What the response promises if `in` acts and `out` does not, the others finding their values anew: u into reached (n). */
static exchange promise(const ris_solver *s, const pursuit *p, uint32_t out, uint32_t in, double *reached)
{
    const size_t n = s->n;
    uint32_t m = 0;
    memset(reached, 0, n * sizeof *reached);
    for (uint32_t k = 0; k < n; ++k) {
        if ((p->taken[k] && k != out) || k == in) {
            p->set[m++] = k;
        }
    }
    for (uint32_t a = 0; a < m; ++a) {
        const uint32_t k = p->set[a];
        for (uint32_t b = 0; b < m; ++b) {
            p->h[a * m + b] = s->gram[k * n + p->set[b]];
        }
        p->h[a * m + a] += SURE_MM2 + SURE_SHARE * p->h[a * m + a];
        p->g[a] = s->g[k] + s->gram[k * n + out] * s->u[out];
        ris__solver_bounds(s, k, &p->low[a], &p->high[a]);
    }
    if (m > 0 && !ris__bounded_minimum(m, p->h, p->g, p->low, p->high, p->d, p->work)) {
        return (exchange){out, in, INFINITY};
    }
    double square = s->rms_mm * s->rms_mm + (2 * s->g[out] + s->gram[out * n + out] * s->u[out]) * s->u[out];
    for (uint32_t a = 0; a < m; ++a) {
        reached[p->set[a]] = s->u[p->set[a]] + p->d[a];
        square -= 2 * p->g[a] * p->d[a];
        for (uint32_t b = 0; b < m; ++b) {
            square += p->d[a] * p->d[b] * s->gram[p->set[a] * n + p->set[b]];
        }
    }
    return (exchange){out, in, sqrt(fmax(square, 0))};
}

static int nearer_first(const void *a, const void *b)
{
    const exchange *p = a, *q = b;
    if (p->rms_mm != q->rms_mm) {
        return p->rms_mm < q->rms_mm ? -1 : 1;
    }
    return p->out != q->out ? (p->out < q->out ? -1 : 1) : p->in < q->in ? -1 : p->in > q->in;
}

/* Leaving `out` out, and its best stand-ins; returns the new count. */
static uint32_t list_for(const ris_solver *s, pursuit *p, uint32_t out, uint32_t count)
{
    exchange *best = p->list + count;
    uint32_t kept = 0;
    for (uint32_t in = 0; in < s->n; ++in) {
        if (p->taken[in] || s->gram[(size_t)in * s->n + in] == 0) {
            continue;
        }
        exchange next = promise(s, p, out, in, p->reached);
        if (fabs(p->reached[in]) < EXCHANGE_LEAST) {
            continue;
        }
        for (uint32_t k = 0; k < kept; ++k) {
            if (nearer_first(&next, &best[k]) < 0) {
                const exchange later = best[k];
                best[k] = next;
                next = later;
            }
        }
        if (kept < STAND_INS) {
            best[kept++] = next;
        }
    }
    best[kept++] = promise(s, p, out, s->n, p->reached);
    return count + kept;
}

/* The exchanges worth a trial, the most promising first, and what each promises. Changes the columns. */
static ris_result list_exchanges(ris_solver *s, pursuit *p, uint32_t *out_count, ris_error *err)
{
    for (uint32_t k = 0; k < s->n; ++k) {
        p->taken[k] = p->taken[k] && fabs(s->u[k]) > RIS_SOLVER_NOTHING;
        if (fabs(s->u[k]) < RIS_SOLVER_LITTLE) {
            const double step = s->step[k] < 0 ? -EXCHANGE_STEP : EXCHANGE_STEP;
            const bool within = s->u[k] + step <= s->knob[k].high && s->u[k] + step >= s->knob[k].low;
            s->step[k] = within ? step : -step;
        }
    }
    ris__solver_step_inwards(s);
    const ris_result r = respond_all(s, err);
    uint32_t count = 0;
    for (uint32_t k = 0; !r && k < s->n; ++k) {
        count = p->taken[k] ? list_for(s, p, k, count) : count;
    }
    qsort(p->list, count, sizeof *p->list, nearer_first);
    for (uint32_t i = 0; i < count; ++i) {
        promise(s, p, p->list[i].out, p->list[i].in, p->reached + (size_t)i * s->n);
    }
    *out_count = count;
    return r;
}

/* Simulates exchanges until one brings the face nearer, which stays; *out_better: one did. */
static ris_result exchange_one(ris_solver *s, pursuit *p, bool *out_better, ris_error *err)
{
    uint32_t count;
    ris_result r = list_exchanges(s, p, &count, err);
    *out_better = false;
    ris__place_remember(s, &p->before);
    for (uint32_t i = 0; !r && !*out_better && i < count && p->trials < TRIALS; ++i, ++p->trials) {
        const exchange *x = &p->list[i];
        double rms;
        memcpy(s->tried_u, p->reached + (size_t)i * s->n, s->n * sizeof *s->tried_u);
        p->taken[x->out] = false;
        if (x->in < s->n) {
            p->taken[x->in] = true;
        }
        r = ris__solver_try(s, &rms, err);
        if (!r) {
            r = ris__solver_keep(s, err);
        }
        if (!r) {
            r = search_taken(s, p->taken, err);
        }
        *out_better = !r && s->rms_mm < GAIN * p->before.rms_mm;
        if (!r && !*out_better) {
            p->taken[x->out] = true;
            if (x->in < s->n) {
                p->taken[x->in] = false;
            }
            r = ris__place_return(s, &p->before, err);
        }
    }
    return r;
}

ris_result ris__solver_pursue(ris_solver *s, ris_error *err)
{
    pursuit p;
    bool better = true;
    ris_result r = open_pursuit(s, &p, err);
    while (!r && better) {
        r = grow(s, &p, err);
        better = false;
        if (!r && s->rms_mm > RIS_SOLVER_NEAR_MM) {
            r = exchange_one(s, &p, &better, err);
        }
    }
    memset(s->frozen, 0, s->n * sizeof *s->frozen);
    close_pursuit(&p);
    return r;
}
