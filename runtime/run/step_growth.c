/* SPDX-License-Identifier: MIT
 * The growth of y' = lambda y in steps of AB3 or RK4. */
#include "gic_runtime.h"
#include "run/step_growth.h"

#include <complex.h>
#include <math.h>

/* True if all roots of p[0] + p[1] r + ... + p[n] r^n have magnitudes below 1. Schur and Cohn's criterion: |p[0]| <
 * |p[n]|, and the same for conj(p[n]) p - p[0] (its reverse), whose constant vanishes, divided by r. p is overwritten.
 */
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
    /* y[n] = (growth s)^n, with the weights of y[n], y[n-1] and y[n-2] in y[n+1], each where the others are 0 */
    double complex p[4] = {-GIC_ADAMS_BASHFORTH(0, z / 12, 0, 0, 1), -GIC_ADAMS_BASHFORTH(0, z / 12, 0, growth, 0),
                           -GIC_ADAMS_BASHFORTH(1, z / 12, 1, 0, 0) * growth * growth, growth * growth * growth};
    return !all_within(p, 3);
}

double step_growth(int32_t method, double real, double imaginary)
{
    if (method == GIC_RK4)
        return rk4_growth(real + imaginary * I);
    /* no root is larger than 1 and the sum of the magnitudes of the other coefficients */
    double low = 0, high = 2 + GIC_ADAMS_BASHFORTH(0, hypot(real, imaginary) / 12, 1, -1, 1);
    while (high - low > 1e-9 * high) {
        const double middle = (low + high) / 2;
        *(step_grows(method, real, imaginary, middle) ? &low : &high) = middle;
    }
    return low;
}
