/* SPDX-License-Identifier: MIT
 * Dense elimination of numbers, for the samples that the generator follows. */
#include "expression/expression.h"

#include <math.h>
#include <string.h>

/* Rows scaled to 1, then eliminated with partial pivoting; b (or NULL) goes along. The product of the pivots with the
 * sign of the exchanges, 0 where one is rounding. */
static double eliminate_numeric(int n, double *A, double *b)
{
    double determinant = 1;
    for (int i = 0; i < n; ++i) {
        double largest = 0;
        for (int j = 0; j < n; ++j)
            largest = fmax(largest, fabs(A[n * i + j]));
        if (!(largest > 0))
            return 0;
        for (int j = 0; j < n; ++j)
            A[n * i + j] /= largest;
        if (b)
            b[i] /= largest;
    }
    for (int k = 0; k < n; ++k) {
        int pivot = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(A[n * i + k]) > fabs(A[n * pivot + k]))
                pivot = i;
        if (!(fabs(A[n * pivot + k]) > 1e-12))
            return 0;
        for (int j = 0; pivot != k && j < n; ++j) {
            double t = A[n * k + j];
            A[n * k + j] = A[n * pivot + j];
            A[n * pivot + j] = t;
        }
        if (pivot != k && b) {
            double t = b[k];
            b[k] = b[pivot];
            b[pivot] = t;
        }
        determinant *= pivot != k ? -A[n * k + k] : A[n * k + k];
        for (int i = k + 1; i < n; ++i) {
            double multiplier = A[n * i + k] / A[n * k + k];
            for (int j = k; multiplier != 0 && j < n; ++j)
                A[n * i + j] -= multiplier * A[n * k + j];
            if (b)
                b[i] -= multiplier * b[k];
        }
    }
    return determinant;
}

double linear_determinant(int n, double *A)
{
    return eliminate_numeric(n, A, NULL);
}

bool linear_solve_numeric(int n, double *A, double *b)
{
    if (eliminate_numeric(n, A, b) == 0)
        return false;
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j)
            b[k] -= A[n * k + j] * b[j];
        b[k] /= A[n * k + k];
    }
    return true;
}

double linear_least_pivot(int n, double *A)
{
    double least = 1;
    bool used[n + 1];
    memset(used, 0, sizeof used);
    for (int i = 0; i < n; ++i) {
        double largest = 0;
        for (int j = 0; j < n; ++j)
            largest = fmax(largest, fabs(A[n * i + j]));
        for (int j = 0; j < n; ++j)
            A[n * i + j] /= largest > 0 ? largest : 1;
    }
    for (int k = 0; k < n; ++k) {
        int row = k, column = 0;
        double largest = -1;
        for (int i = k; i < n; ++i)
            for (int j = 0; j < n; ++j)
                if (!used[j] && fabs(A[n * i + j]) > largest)
                    largest = fabs(A[n * i + j]), row = i, column = j;
        if (!(largest > 0))
            return 0;
        least = fmin(least, largest);
        used[column] = true;
        for (int j = 0; j < n; ++j) {
            const double t = A[n * k + j];
            A[n * k + j] = A[n * row + j];
            A[n * row + j] = t;
        }
        for (int i = k + 1; i < n; ++i) {
            const double multiplier = A[n * i + column] / A[n * k + column];
            for (int j = 0; multiplier != 0 && j < n; ++j)
                if (!used[j])
                    A[n * i + j] -= multiplier * A[n * k + j];
        }
    }
    return least;
}

/* Columns of the inverse of A one after the other. False when singular. */
static bool invert(int n, const double *A, double *columns)
{
    memset(columns, 0, (size_t)(n * n) * sizeof *columns);
    for (int k = 0; k < n; ++k) {
        double copy[n * n + 1], *b = columns + n * k;
        memcpy(copy, A, (size_t)(n * n) * sizeof *copy);
        b[k] = 1;
        if (!linear_solve_numeric(n, copy, b))
            return false;
    }
    return true;
}

double linear_condition(int n, const double *A)
{
    double rows[n * n + 1], inverse[n * n + 1], squares = 0;
    for (int i = 0; i < n; ++i) {
        double size = 0;
        for (int j = 0; j < n; ++j)
            size = hypot(size, A[n * i + j]);
        for (int j = 0; j < n; ++j)
            rows[n * i + j] = A[n * i + j] / (size > 0 ? size : 1);
    }
    if (!invert(n, rows, inverse))
        return HUGE_VAL;
    for (int i = 0; i < n * n; ++i)
        squares += inverse[i] * inverse[i];
    return sqrt(squares / n);
}

double linear_condition_in_best_units(int n, const double *A)
{
    const int iterations = 200; /* the estimate falls as 1 + n / iterations where units alone are far apart */
    double inverse[n * n + 1], x[n + 1], moved[n + 1], largest = 1;
    if (!invert(n, A, inverse))
        return HUGE_VAL;
    for (int i = 0; i < n; ++i)
        x[i] = 1;
    for (int k = 0; k < iterations; ++k) {
        double next[n + 1];
        memset(next, 0, sizeof next);
        largest = 0;
        for (int i = 0; i < n; ++i) {
            moved[i] = 0;
            for (int j = 0; j < n; ++j)
                moved[i] += fabs(A[n * i + j]) * x[j];
            for (int j = 0; j < n; ++j)
                next[j] += fabs(inverse[n * i + j]) * moved[i];
        }
        for (int i = 0; i < n; ++i)
            largest = fmax(largest, next[i]);
        for (int i = 0; i < n; ++i)
            x[i] = next[i] / largest;
    }
    return largest;
}
