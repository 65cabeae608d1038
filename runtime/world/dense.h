/* SPDX-License-Identifier: MIT
 *
 * Small dense systems, row-major, for inner loops that can't afford a library's call. */
#ifndef WORLD_DENSE_H
#define WORLD_DENSE_H

#include <stdbool.h>

/* P A = L U in place with partial pivoting: multipliers below the diagonal, reciprocal pivots on it. swap: [n]. False
 * where a pivot is 0 or no number. */
bool dense_factor(int n, double *A, int *swap);
/* Determinant of A from its factors. */
double dense_determinant(int n, const double *A, const int *swap);
/* x = A^-1 x from the factors. */
void dense_solve(int n, const double *A, const int *swap, double *x);

#endif
