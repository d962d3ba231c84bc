/* Cholesky, bounded least squares and how far columns are independent. */
#include "solve/bounded.h"

#include <math.h>
#include <string.h>

bool ris__cholesky(uint32_t n, double *a)
{
    for (uint32_t j = 0; j < n; ++j) {
        double *row = a + (size_t)j * n;
        for (uint32_t i = 0; i <= j; ++i) {
            const double *other = a + (size_t)i * n;
            double sum = row[i];
            for (uint32_t k = 0; k < i; ++k) {
                sum -= row[k] * other[k];
            }
            if (i < j) {
                row[i] = sum / other[i];
            } else if (!(sum > 0)) {
                return false;
            } else {
                row[j] = sqrt(sum);
            }
        }
    }
    return true;
}

void ris__cholesky_solve(uint32_t n, const double *l, double *b)
{
    for (uint32_t i = 0; i < n; ++i) {
        for (uint32_t k = 0; k < i; ++k) {
            b[i] -= l[(size_t)i * n + k] * b[k];
        }
        b[i] /= l[(size_t)i * n + i];
    }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t k = i + 1; k < n; ++k) {
            b[i] -= l[(size_t)k * n + i] * b[k];
        }
        b[i] /= l[(size_t)i * n + i];
    }
}

typedef struct problem {
    uint32_t n;
    const double *h, *g, *low, *high;
    double *d, *factor, *goal, *slope;
} problem;

/* -gradient of the target at d. */
static void find_slope(const problem *p)
{
    for (uint32_t i = 0; i < p->n; ++i) {
        double sum = p->g[i];
        for (uint32_t k = 0; k < p->n; ++k) {
            sum -= p->h[(size_t)i * p->n + k] * p->d[k];
        }
        p->slope[i] = sum;
    }
}

/* Where the free variables would go if they had no bounds, into goal. */
static bool find_goal(const problem *p, const bool *is_free, uint32_t *index)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->n; ++i) {
        if (is_free[i]) {
            index[count++] = i;
        }
    }
    find_slope(p);
    for (uint32_t a = 0; a < count; ++a) {
        for (uint32_t b = 0; b <= a; ++b) {
            p->factor[(size_t)a * count + b] = p->h[(size_t)index[a] * p->n + index[b]];
        }
    }
    if (!ris__cholesky(count, p->factor)) {
        return false;
    }
    for (uint32_t a = 0; a < count; ++a) {
        p->goal[a] = p->slope[index[a]];
    }
    ris__cholesky_solve(count, p->factor, p->goal);
    for (uint32_t a = count; a-- > 0;) { /* spread to places, from behind: index[a] >= a */
        const double step = p->goal[a];
        p->goal[index[a]] = p->d[index[a]] + step;
    }
    return true;
}

/* Goes towards the goal up to the first bound; true if the goal was reached. */
static bool go(const problem *p, bool *is_free)
{
    double share = 1;
    uint32_t blocking = p->n;
    for (uint32_t i = 0; i < p->n; ++i) {
        const double step = is_free[i] ? p->goal[i] - p->d[i] : 0;
        const double room = step > 0 ? p->high[i] - p->d[i] : p->low[i] - p->d[i];
        if (fabs(step) > fabs(room) && room / step < share) {
            share = room / step;
            blocking = i;
        }
    }
    for (uint32_t i = 0; i < p->n; ++i) {
        if (is_free[i]) {
            p->d[i] += share * (p->goal[i] - p->d[i]);
        }
    }
    if (blocking == p->n) {
        return true;
    }
    p->d[blocking] = p->goal[blocking] > p->d[blocking] ? p->high[blocking] : p->low[blocking];
    is_free[blocking] = false;
    return false;
}

/* Frees the variable at a bound that pulls inwards most; false if none does. */
static bool release(const problem *p, bool *is_free, double tolerance)
{
    uint32_t best = p->n;
    double most = tolerance;
    find_slope(p);
    for (uint32_t i = 0; i < p->n; ++i) {
        if (is_free[i] || p->low[i] == p->high[i]) {
            continue;
        }
        const double pull = p->d[i] <= p->low[i] ? p->slope[i] : -p->slope[i];
        const double scaled = pull / sqrt(p->h[(size_t)i * p->n + i]);
        if (scaled > most) {
            most = scaled;
            best = i;
        }
    }
    if (best < p->n) {
        is_free[best] = true;
    }
    return best < p->n;
}

bool ris__bounded_minimum(uint32_t n, const double *h, const double *g, const double *low, const double *high,
                          double *d, double *work)
{
    enum { LARGEST = 512 };
    bool is_free[LARGEST];
    uint32_t index[LARGEST];
    const problem p = {n, h, g, low, high, d, work, work + (size_t)n * n, work + (size_t)n * n + n};
    double scale = 0;
    if (n > LARGEST) {
        return false;
    }
    for (uint32_t i = 0; i < n; ++i) {
        d[i] = 0;
        is_free[i] = (low[i] < 0 || g[i] > 0) && (high[i] > 0 || g[i] < 0);
        if (!(h[(size_t)i * n + i] > 0)) {
            return false;
        }
        scale = fmax(scale, fabs(g[i]) / sqrt(h[(size_t)i * n + i]));
    }
    /* each round frees one variable or takes one to a bound; the target falls at every full step, so none comes back
     * for ever, and the limit is a guard against rounding only */
    for (uint32_t round = 0; round < 20 * n + 20; ++round) {
        if (!find_goal(&p, is_free, index)) {
            return false;
        }
        if (go(&p, is_free) && !release(&p, is_free, 1e-12 * scale)) {
            break;
        }
    }
    return true;
}

void ris__independent_shares(uint32_t n, const double *gram, double *share, double *work)
{
    const double tiny = 1e-9; /* keeps equal columns apart: a share of 3e-5 */
    double *factor = work, *unit = work + (size_t)n * n;
    for (uint32_t i = 0; i < n; ++i) {
        const double own = gram[(size_t)i * n + i];
        for (uint32_t k = 0; k <= i; ++k) {
            const double length = sqrt(own * gram[(size_t)k * n + k]);
            factor[(size_t)i * n + k] = i == k ? 1 + tiny : length > 0 ? gram[(size_t)i * n + k] / length : 0;
        }
    }
    const bool definite = ris__cholesky(n, factor);
    for (uint32_t i = 0; i < n; ++i) {
        share[i] = 0;
        if (definite && gram[(size_t)i * n + i] > 0) {
            memset(unit, 0, n * sizeof *unit);
            unit[i] = 1;
            ris__cholesky_solve(n, factor, unit);
            share[i] = fmin(1 / sqrt(unit[i]), 1);
        }
    }
}
