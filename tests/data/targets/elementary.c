/* SPDX-License-Identifier: MIT
 * Elementary functions in place of libm's, whose last digits differ between libraries: these are sums, products,
 * quotients and roots in a fixed order, so that programs with them have the same bits wherever arithmetic is IEEE's.
 * Series, to some 2e-16 of 1; for arguments as vehicles have them, below 1e5. */
#include <math.h>

static const double half_pi = 1.57079632679489655800, rest_of_half_pi = 6.12323399573676603587e-17;
static const double log_2 = 0.693147180559945286227, rest_of_log_2 = 2.31904681384629955842e-17;

/* The sine (odd 1) or cosine (odd 0) of |r| < 0.8: terms to r^19 / 19!. */
static double series(double r, int odd)
{
    double term = odd ? r : 1, sum = 0, terms[10];
    int i;
    for (i = 0; i < 10; ++i) {
        terms[i] = term;
        term *= -r * r / ((2 * i + 1 + odd) * (2 * i + 2 + odd));
    }
    for (i = 9; i >= 0; --i)
        sum += terms[i];
    return sum;
}

/* The sine of x and so many quarter turns. */
static double wave(double x, int quarters)
{
    const double turns = floor(x / half_pi + 0.5);
    const int quarter = (int)turns + quarters;
    const double s = series((x - turns * half_pi) - turns * rest_of_half_pi, !(quarter & 1));
    return quarter & 2 ? -s : s;
}

double sin(double x)
{
    return wave(x, 0);
}

double cos(double x)
{
    return wave(x, 1);
}

double tan(double x)
{
    return sin(x) / cos(x);
}

/* Twice halved, the tangent is below 0.2 and 13 terms do. */
double atan(double x)
{
    const double size = fabs(x), t = size > 1 ? 1 / size : size;
    const double half = t / (1 + sqrt(1 + t * t)), quarter = half / (1 + sqrt(1 + half * half));
    double sum = 0;
    int i;
    for (i = 12; i >= 0; --i)
        sum = 1.0 / (2 * i + 1) - quarter * quarter * sum;
    sum *= 4 * quarter;
    sum = size > 1 ? half_pi - sum : sum;
    return x < 0 ? -sum : sum;
}

double atan2(double y, double x)
{
    const double angle = x == 0 ? (y == 0 ? 0 : half_pi) : atan(fabs(y) / fabs(x));
    const double upper = x < 0 ? 2 * half_pi - angle : angle;
    return y < 0 ? -upper : upper;
}

double asin(double x)
{
    return atan2(x, sqrt((1 - x) * (1 + x)));
}

double exp(double x)
{
    const double twos = floor(x / log_2 + 0.5), r = (x - twos * log_2) - twos * rest_of_log_2;
    double sum = 1;
    int i;
    if (!(fabs(x) < 700))
        return x < 0 ? 0 : HUGE_VAL;
    for (i = 17; i >= 1; --i)
        sum = 1 + r / i * sum;
    return ldexp(sum, (int)twos);
}

double tanh(double x)
{
    const double size = fabs(x), t = size > 350 ? 1 : 1 - 2 / (exp(2 * size) + 1);
    return x < 0 ? -t : t;
}
