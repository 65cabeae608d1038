/* SPDX-License-Identifier: MIT
 * LU factorization of small matrices. One body is 7 x 7: for that size the loops have constant bounds, which makes them
 * several times as fast as a library's. */
#include "world/dense.h"

#include <math.h>

static inline bool factor(const int n, double *A, int *swap)
{
    for (int k = 0; k < n; ++k) {
        int best = k;
        double largest = fabs(A[n * k + k]);
        for (int i = k + 1; i < n; ++i)
            if (fabs(A[n * i + k]) > largest) {
                largest = fabs(A[n * i + k]);
                best = i;
            }
        if (!(largest > 0))
            return false;
        swap[k] = best;
        double *row = A + n * k, *other = A + n * best;
        if (best != k)
            for (int j = 0; j < n; ++j) {
                const double x = row[j];
                row[j] = other[j];
                other[j] = x;
            }
        const double reciprocal = 1 / row[k];
        row[k] = reciprocal;
        for (int i = k + 1; i < n; ++i) {
            double *below = A + n * i;
            if (below[k] == 0)
                continue;
            const double multiplier = below[k] *= reciprocal;
            for (int j = k + 1; j < n; ++j)
                below[j] -= multiplier * row[j];
        }
    }
    return true;
}

static inline void solve(const int n, const double *A, const int *swap, double *x)
{
    for (int k = 0; k < n; ++k) {
        const double value = x[swap[k]];
        x[swap[k]] = x[k];
        x[k] = value;
    }
    /* by columns: the sums of different rows don't wait for each other */
    for (int k = 0; k < n; ++k)
        for (int i = k + 1; i < n; ++i)
            x[i] -= A[n * i + k] * x[k];
    for (int k = n - 1; k >= 0; --k) {
        x[k] *= A[n * k + k];
        for (int i = 0; i < k; ++i)
            x[i] -= A[n * i + k] * x[k];
    }
}

bool dense_factor(int n, double *A, int *swap)
{
    return n == 7 ? factor(7, A, swap) : factor(n, A, swap);
}

double dense_determinant(int n, const double *A, const int *swap)
{
    double product = 1;
    for (int k = 0; k < n; ++k)
        product *= swap[k] == k ? A[n * k + k] : -A[n * k + k];
    return 1 / product;
}

void dense_solve(int n, const double *A, const int *swap, double *x)
{
    if (n == 7)
        solve(7, A, swap, x);
    else
        solve(n, A, swap, x);
}
