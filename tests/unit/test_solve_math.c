/* The solver's small algebra against numbers worked out by hand, and against trying every set of bounds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "measure/soak_pose.h"
#include "solve/align.h"
#include "solve/bounded.h"

#include <math.h>
#include <string.h>

#define N 4

static void expect_near(double a, double b, double bound)
{
    if (!(fabs(a - b) <= bound)) {
        fail_msg("%.12g and %.12g differ by more than %g", a, b, bound);
    }
}

/* [4 2; 2 5] = L L' with L = [2 0; 1 2]; L L' x = (8, 14) has x = (0.75, 2.5). */
static void cholesky_by_hand(void **state)
{
    (void)state;
    double a[4] = {4, 99, 2, 5}, b[2] = {8, 14};
    assert_true(ris__cholesky(2, a));
    assert_true(a[0] == 2 && a[2] == 1 && a[3] == 2);
    ris__cholesky_solve(2, a, b);
    expect_near(b[0], 0.75, 1e-15);
    expect_near(b[1], 2.5, 1e-15);
    double indefinite[4] = {1, 0, 2, 4};
    assert_false(ris__cholesky(2, indefinite));
}

/* 2x + y = 3, x + 2y = 0: (2, -1). With y >= -0.5: x = 1.75; with y >= 0: x = 1.5; with x <= 1 besides: (1, 0). */
static void bounds_by_hand(void **state)
{
    (void)state;
    const double h[4] = {2, 1, 1, 2}, g[2] = {3, 0};
    static const double cases[][6] = {/* low, high of x; of y; expected */
                                      {-9, 9, -9, 9, 2, -1},
                                      {-9, 9, -0.5, 9, 1.75, -0.5},
                                      {-9, 9, 0, 9, 1.5, 0},
                                      {-9, 1, 0, 9, 1, 0},
                                      {0, 0, -9, 9, 0, 0}};
    double work[8], d[2];
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        const double *c = cases[k], low[2] = {c[0], c[2]}, high[2] = {c[1], c[3]};
        assert_true(ris__bounded_minimum(2, h, g, low, high, d, work));
        expect_near(d[0], c[4], 1e-14);
        expect_near(d[1], c[5], 1e-14);
    }
    const double flat[4] = {1, 1, 1, 1};
    const double low[2] = {-9, -9}, high[2] = {9, 9};
    assert_false(ris__bounded_minimum(2, flat, g, low, high, d, work));
}

static double value(const double *h, const double *g, const double *d)
{
    double sum = 0;
    for (int i = 0; i < N; ++i) {
        for (int k = 0; k < N; ++k) {
            sum += 0.5 * d[i] * h[N * i + k] * d[k];
        }
        sum -= g[i] * d[i];
    }
    return sum;
}

/* Least value over every choice of free, low, high for each variable that stays within the bounds. */
static double try_all(const double *h, const double *g, const double *low, const double *high)
{
    double best = 0; /* d = 0 is within */
    for (int choice = 0; choice < 81; ++choice) {
        double d[N], a[N * N], b[N];
        int index[N], count = 0, rest = choice;
        for (int i = 0; i < N; ++i, rest /= 3) {
            d[i] = rest % 3 == 0 ? 0 : rest % 3 == 1 ? low[i] : high[i];
            if (rest % 3 == 0) {
                index[count++] = i;
            }
        }
        for (int r = 0; r < count; ++r) {
            b[r] = g[index[r]];
            for (int k = 0; k < N; ++k) {
                b[r] -= h[N * index[r] + k] * d[k];
            }
            for (int c = 0; c < count; ++c) {
                a[r * count + c] = h[N * index[r] + index[c]];
            }
        }
        assert_true(ris__cholesky((uint32_t)count, a));
        ris__cholesky_solve((uint32_t)count, a, b);
        bool within = true;
        for (int r = 0; r < count; ++r) {
            d[index[r]] = b[r];
            within = within && b[r] >= low[index[r]] && b[r] <= high[index[r]];
        }
        best = within ? fmin(best, value(h, g, d)) : best;
    }
    return best;
}

static double draw(ris_pcg *pcg)
{
    return (double)ris__pcg_below(pcg, 2001) / 1000 - 1;
}

static void bounds_as_by_trying_all(void **state)
{
    (void)state;
    ris_pcg pcg = ris__pcg_start(7, 1);
    uint32_t bound = 0;
    for (int k = 0; k < 500; ++k) {
        double root[N * N], h[N * N] = {0}, g[N], low[N], high[N], d[N], work[N * N + 2 * N];
        for (int i = 0; i < N * N; ++i) {
            root[i] = draw(&pcg);
        }
        for (int i = 0; i < N; ++i) {
            for (int j = 0; j < N; ++j) {
                for (int c = 0; c < N; ++c) {
                    h[N * i + j] += root[N * c + i] * root[N * c + j];
                }
            }
            h[N * i + i] += 0.01;
            g[i] = draw(&pcg);
            low[i] = fmin(draw(&pcg), 0);
            high[i] = fmax(draw(&pcg), 0);
        }
        assert_true(ris__bounded_minimum(N, h, g, low, high, d, work));
        for (int i = 0; i < N; ++i) {
            assert_true(d[i] >= low[i] && d[i] <= high[i]);
            bound += d[i] == low[i] || d[i] == high[i];
        }
        expect_near(value(h, g, d), try_all(h, g, low, high), 1e-10);
    }
    assert_true(bound > 500); /* bounds do act */
}

/* Unit columns at 30 degrees: sin 30; a column that is another one: nothing of its own; one across: all. */
static void shares_by_hand(void **state)
{
    (void)state;
    const double c = sqrt(3) / 2;
    const double gram[16] = {1, 2 * c, 0, 0, 2 * c, 4, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0};
    double share[4], work[20];
    ris__independent_shares(4, gram, share, work);
    expect_near(share[0], 0.5, 1e-7);
    expect_near(share[1], 0.5, 1e-7);
    expect_near(share[2], 1, 1e-7);
    assert_true(share[3] == 0);
    const double twins[4] = {1, 2, 2, 4};
    ris__independent_shares(2, twins, share, work);
    assert_true(share[0] < 1e-4 && share[1] < 1e-4);
}

/* A quarter turn about z and a shift, found again from four points; a line has no one answer. */
static void motions_are_found(void **state)
{
    (void)state;
    const ris_vec3 from[4] = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}, {0, 0, 30}};
    ris_vec3 onto[4];
    ris_motion motion;
    for (int i = 0; i < 4; ++i) {
        onto[i] = (ris_vec3){-from[i].y + 1, from[i].x + 2, from[i].z + 3};
    }
    assert_true(ris__align(4, from, onto, &motion));
    expect_near(ris__motion_degrees(&motion), 90, 1e-6);
    for (int i = 0; i < 4; ++i) {
        const ris_vec3 p = ris__motion_apply(&motion, from[i]);
        expect_near((double)p.x, (double)onto[i].x, 1e-5);
        expect_near((double)p.y, (double)onto[i].y, 1e-5);
        expect_near((double)p.z, (double)onto[i].z, 1e-5);
    }
    const ris_vec3 line[3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    assert_false(ris__align(3, line, line, &motion));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cholesky_by_hand),        cmocka_unit_test(bounds_by_hand),
        cmocka_unit_test(bounds_as_by_trying_all), cmocka_unit_test(shares_by_hand),
        cmocka_unit_test(motions_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
