/* SPDX-License-Identifier: MIT
 * Vectors, Euler parameters and dense elimination in quadruple precision. */
#include "quad.h"

#include "support.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

quad quad_dot(const quad *a, const quad *b, int size)
{
    quad sum = 0;
    for (int i = 0; i < size; ++i)
        sum += a[i] * b[i];
    return sum;
}

void quad_cross(const quad a[3], const quad b[3], quad out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void euler_product(const quad p[4], const quad q[4], quad out[4])
{
    quad_cross(p + 1, q + 1, out + 1);
    for (int i = 1; i < 4; ++i)
        out[i] += p[0] * q[i] + q[0] * p[i];
    out[0] = p[0] * q[0] - quad_dot(p + 1, q + 1, 3);
}

void rotate(const quad p[4], const quad s[3], quad out[3])
{
    quad c[3], along = 2 * quad_dot(p + 1, s, 3), rest = p[0] * p[0] - quad_dot(p + 1, p + 1, 3);
    quad_cross(p + 1, s, c);
    for (int i = 0; i < 3; ++i)
        out[i] = rest * s[i] + along * p[1 + i] + 2 * p[0] * c[i];
}

void rotate_back(const quad p[4], const quad s[3], quad out[3])
{
    const quad back[4] = {p[0], -p[1], -p[2], -p[3]};
    rotate(back, s, out);
}

void rotation_slope(const quad p[4], const quad s[3], quad B[3][4])
{
    const quad *e = p + 1;
    quad c[3], along = quad_dot(e, s, 3);
    quad_cross(e, s, c);
    for (int i = 0; i < 3; ++i) {
        B[i][0] = 2 * (p[0] * s[i] + c[i]);
        for (int j = 0; j < 3; ++j)
            B[i][1 + j] = 2 * (e[i] * s[j] - s[i] * e[j] + (i == j ? along : 0));
        /* e0 times (unit vector j) x s */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        B[i][1 + j] += 2 * p[0] * s[k];
        B[i][1 + k] -= 2 * p[0] * s[j];
    }
}

void euler_rate_matrix(const quad p[4], quad G[3][4])
{
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        G[i][0] = -p[1 + i];
        G[i][1 + i] = p[0];
        G[i][1 + j] = p[1 + k];
        G[i][1 + k] = -p[1 + j];
    }
}

Factors *factors_new(int size)
{
    Factors *factors = grab(1, sizeof *factors);
    factors->size = size;
    factors->a = grab((size_t)size * (size_t)size, sizeof *factors->a);
    factors->row = grab((size_t)size, sizeof *factors->row);
    factors->used = grab((size_t)size, sizeof *factors->used);
    factors->coarse = grab((size_t)size * (size_t)size, sizeof *factors->coarse);
    return factors;
}

void factors_free(Factors *factors)
{
    free(factors->a);
    free(factors->row);
    free(factors->used);
    free(factors->coarse);
    free(factors);
}

void factors_clear(Factors *factors)
{
    memset(factors->a, 0, (size_t)factors->size * (size_t)factors->size * sizeof *factors->a);
}

/* Rows are exchanged by index: row[k] is where the k-th pivot row lies. Zeros are skipped, since the arithmetic is done
 * in software and most of the matrix is zero. */
bool quad_factor(Factors *factors)
{
    int n = factors->size;
    quad *scale = grab((size_t)n, sizeof *scale);
    bool regular = true;
    factors->sign = 1;
    for (int i = 0; i < n; ++i) {
        factors->row[i] = i;
        for (int j = 0; j < n; ++j)
            scale[i] = fmaxq(scale[i], fabsq(factors->a[i * n + j]));
    }
    for (int k = 0; k < n && regular; ++k) {
        int best = k;
        quad largest = 0;
        for (int i = k; i < n; ++i) {
            quad size = fabsq(factors->a[factors->row[i] * n + k]);
            if (size != 0 && (size /= scale[factors->row[i]]) > largest) {
                largest = size;
                best = i;
            }
        }
        regular = largest > ROUGHLY / 100;
        int pivot = factors->row[best];
        factors->row[best] = factors->row[k];
        factors->row[k] = pivot;
        const quad *from = factors->a + pivot * n;
        int used = 0;
        for (int j = k + 1; j < n; ++j)
            if (from[j] != 0)
                factors->used[used++] = j;
        if ((best != k) != (from[k] < 0))
            factors->sign = -factors->sign;
        for (int i = k + 1; i < n && regular; ++i) {
            quad *to = factors->a + factors->row[i] * n;
            if (to[k] == 0)
                continue;
            quad multiplier = to[k] /= from[k];
            for (int u = 0; u < used; ++u)
                to[factors->used[u]] -= multiplier * from[factors->used[u]];
        }
    }
    free(scale);
    return regular;
}

void quad_solve(const Factors *factors, quad *x)
{
    int n = factors->size;
    quad *y = grab((size_t)n, sizeof *y);
    for (int i = 0; i < n; ++i) {
        const quad *a = factors->a + factors->row[i] * n;
        y[i] = x[factors->row[i]];
        for (int j = 0; j < i; ++j)
            if (a[j] != 0 && y[j] != 0)
                y[i] -= a[j] * y[j];
    }
    for (int i = n - 1; i >= 0; --i) {
        const quad *a = factors->a + factors->row[i] * n;
        for (int j = i + 1; j < n; ++j)
            if (a[j] != 0 && y[j] != 0)
                y[i] -= a[j] * y[j];
        y[i] /= a[i];
    }
    memcpy(x, y, (size_t)n * sizeof *x);
    free(y);
}

bool coarse_factor(Factors *factors)
{
    int n = factors->size;
    double *a = factors->coarse;
    factors->sign = 1;
    for (int i = 0; i < n; ++i) {
        double scale = 0;
        factors->row[i] = i;
        for (int j = 0; j < n; ++j)
            scale = fmax(scale, fabs(a[i * n + j] = (double)factors->a[i * n + j]));
        if (!(scale > 0))
            return false;
    }
    for (int k = 0; k < n; ++k) {
        int best = k;
        for (int i = k; i < n; ++i)
            if (fabs(a[factors->row[i] * n + k]) > fabs(a[factors->row[best] * n + k]))
                best = i;
        int pivot = factors->row[best];
        factors->row[best] = factors->row[k];
        factors->row[k] = pivot;
        const double *from = a + pivot * n;
        if (!(fabs(from[k]) > 1e-14))
            return false;
        if ((best != k) != (from[k] < 0))
            factors->sign = -factors->sign;
        for (int i = k + 1; i < n; ++i) {
            double *to = a + factors->row[i] * n;
            if (to[k] == 0)
                continue;
            double multiplier = to[k] /= from[k];
            for (int j = k + 1; j < n; ++j)
                to[j] -= multiplier * from[j];
        }
    }
    return true;
}

void coarse_solve(const Factors *factors, quad *x)
{
    int n = factors->size;
    double *y = grab((size_t)n, sizeof *y);
    for (int i = 0; i < n; ++i) {
        const double *a = factors->coarse + factors->row[i] * n;
        y[i] = (double)x[factors->row[i]];
        for (int j = 0; j < i; ++j)
            y[i] -= a[j] * y[j];
    }
    for (int i = n - 1; i >= 0; --i) {
        const double *a = factors->coarse + factors->row[i] * n;
        for (int j = i + 1; j < n; ++j)
            y[i] -= a[j] * y[j];
        y[i] /= a[i];
    }
    for (int i = 0; i < n; ++i)
        x[i] = y[i];
    free(y);
}
