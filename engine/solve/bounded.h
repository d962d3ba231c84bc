/* Small dense linear algebra of the solver: row-major symmetric matrices of some hundred rows, in double. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* a (n x n) becomes its lower Cholesky factor; false if it is not positive definite. The upper triangle is not read. */
bool ris__cholesky(uint32_t n, double *a);
/* Solves L L' x = b in place. */
void ris__cholesky_solve(uint32_t n, const double *l, double *b);

/* d (n) with low <= d <= high that makes d'Hd/2 - g'd least: bounded-variable least squares by an active set (Stark and Parker
 * 1995) on the normal equations. H positive definite, low <= 0 <= high. work: n^2 + 2 n
 * doubles, n at most 512. False if H is not positive definite. */
bool ris__bounded_minimum(uint32_t n, const double *h, const double *g, const double *low, const double *high,
                          double *d, double *work);

/* For each column of a Gram matrix G (n x n) the part of its length that no mixture of the others gives, 0..1; columns
 * without length get 0. work: n^2 + n. */
void ris__independent_shares(uint32_t n, const double *gram, double *share, double *work);
