/* SPDX-License-Identifier: MIT
 * The growth of y' = lambda y in steps of AB3 or RK4. */
#include "step_growth.h"

#include "gic_runtime.h"

#include <complex.h>
#include <math.h>

/* Have all roots of p[0] + p[1] r + ... + p[n] r^n magnitudes below 1? Schur and Cohn's criterion: |p[0]| < |p[n]|, and
 * the same of conj(p[n]) p - p[0] (its reverse), whose constant vanishes and which is divided by r. p is used up. */
static bool all_within(double complex *p, int n)
{
    for (; n > 0; --n) {
        double complex next[4];
        const double complex first = p[0], last = p[n];
        if (!(cabs(first) < cabs(last)))
            return false;
        for (int i = 0; i < n; ++i)
            next[i] = conj(last) * p[i + 1] - first * conj(p[n - i - 1]);
        for (int i = 0; i < n; ++i)
            p[i] = next[i];
    }
    return true;
}

static double rk4_growth(double complex z)
{
    return cabs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))));
}

bool step_grows(int32_t method, double real, double imaginary, double growth)
{
    const double complex z = real + imaginary * I;
    if (method == GIC_RK4)
        return rk4_growth(z) > growth;
    /* y[n+1] = y[n] + z (23 y[n] - 16 y[n-1] + 5 y[n-2]) / 12, with y[n] = (growth s)^n */
    double complex p[4] = {-5 * z / 12, 16 * z / 12 * growth, -(1 + 23 * z / 12) * growth * growth,
                           growth * growth * growth};
    return !all_within(p, 3);
}

double step_growth(int32_t method, double real, double imaginary)
{
    if (method == GIC_RK4)
        return rk4_growth(real + imaginary * I);
    /* no root is larger than 1 and the sum of the other coefficients */
    double low = 0, high = 2 + 44.0 / 12 * hypot(real, imaginary);
    while (high - low > 1e-9 * high) {
        const double middle = (low + high) / 2;
        *(step_grows(method, real, imaginary, middle) ? &low : &high) = middle;
    }
    return low;
}
