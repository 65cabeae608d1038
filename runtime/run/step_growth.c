/* SPDX-License-Identifier: MIT
 * The growth of y' = lambda y in steps of a method. */
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

/* ---- longest steps ---------------------------------------------------------------------------------------------- */

/* The stability function of order 3 with a pole of order 4 at 1 / gamma and a zero at infinity is one alone; that of
 * order 2 with a pole of order 2 too. Of the second-order backward formula, the root that is exp(z) for small z. EXP3
 * has no error where rates are linear. */
static double complex implicit_factor(int32_t method, double complex z)
{
    if (method == GIC_EXP3)
        return cexp(z);
    if (method == GIC_IMEX)
        return (2 + csqrt(1 + 2 * z)) / (3 - 2 * z);
    if (method == GIC_ROS2) {
        const double g = 1 - sqrt(0.5);
        return (1 + (1 - 2 * g) * z) / cpow(1 - g * z, 2);
    }
    const double g = 0.43586652150845900; /* 6 g^3 - 18 g^2 + 9 g = 1 */
    const double complex above =
        1 + z * (1 - 4 * g + z * (0.5 - 4 * g + 6 * g * g + z * (1 / 6.0 - 2 * g + 6 * g * g - 4 * g * g * g)));
    return above / cpow(1 - g * z, 4);
}

/* The root of AB3 that is exp(z) for small z, by Newton's method from there. */
static double complex ab3_factor(double complex z)
{
    const double complex newest = GIC_ADAMS_BASHFORTH(0, z / 12, 1, 0, 0),
                         last = GIC_ADAMS_BASHFORTH(0, z / 12, 0, 1, 0),
                         oldest = GIC_ADAMS_BASHFORTH(0, z / 12, 0, 0, 1);
    double complex r = cexp(z);
    for (int i = 0; i < 30; ++i) {
        const double complex p = ((r - 1 - newest) * r - last) * r - oldest;
        r -= p / ((3 * r - 2 * (1 + newest)) * r - last);
    }
    return r;
}

double step_error(int32_t method, double real, double imaginary)
{
    const double complex z = real + imaginary * I;
    const double complex factor = method == GIC_AB3   ? ab3_factor(z)
                                  : method == GIC_RK4 ? 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))
                                                      : implicit_factor(method, z);
    return cabs(clog(factor * cexp(-z))) / cabs(z);
}

/* Is a step of `size` / |lambda| too long? error: 0: it must be stable. */
static bool too_long(int32_t method, double real, double imaginary, double size, double error)
{
    const double x = size * real, y = size * imaginary;
    /* more than rounding, which is all that RK4 adds to an undamped motion in short steps */
    return error > 0 ? !(step_error(method, x, y) <= error) : step_grows(method, x, y, 1 + 1e-10);
}

/* The first limit on the way from 0, as a region need not be convex. */
static double longest(int32_t method, double real, double imaginary, double error)
{
    const double magnitude = hypot(real, imaginary), largest = 4, piece = 0.01; /* of |z|; RK4 reaches 3 */
    const double x = real / magnitude, y = imaginary / magnitude;
    if (magnitude == 0)
        return INFINITY;
    double low = 0.001, high = piece;
    while (high < largest && !too_long(method, x, y, high, error)) {
        low = high;
        high += piece;
    }
    if (high >= largest)
        return INFINITY;
    while (high - low > 1e-12 * high) {
        const double middle = (low + high) / 2;
        *(too_long(method, x, y, middle, error) ? &high : &low) = middle;
    }
    return low / magnitude;
}

double step_stable(int32_t method, double real, double imaginary)
{
    /* a motion without damping has some by rounding, or a little of the other sign */
    if (method > GIC_RK4 || real > 1e-9 * hypot(real, imaginary))
        return INFINITY;
    return longest(method, fmin(real, 0), imaginary, 0);
}

double step_accurate(int32_t method, double real, double imaginary, double error)
{
    return longest(method, real, imaginary, error);
}
