/* SPDX-License-Identifier: MIT
 * Cubic splines: h_(i-1) m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_i m_(i+1) = 6 (c_i - c_(i-1)) for second derivatives m,
 * widths h and chords c. */
#include "scene/spline.h"

#include <string.h>

static double width(const double *s, int i)
{
    return s[i + 1] - s[i];
}

/* Right-hand side between the intervals `before` and `after`. */
static double kink(const double *s, const double *y, int before, int after)
{
    return 6 * ((y[after + 1] - y[after]) / width(s, after) - (y[before + 1] - y[before]) / width(s, before));
}

/* m between the ends, where they are given: forward elimination, back substitution. y NULL: of the right-hand side 0.
 */
static void solve(const double *s, const double *y, int count, double *upper, double *m)
{
    for (int i = 1; i < count - 1; ++i) {
        const double lower = width(s, i - 1), pivot = 2 * (lower + width(s, i)) - (i > 1 ? lower * upper[i - 1] : 0);
        upper[i] = width(s, i) / pivot;
        m[i] = ((y ? kink(s, y, i - 1, i) : 0) - lower * m[i - 1]) / pivot;
    }
    for (int i = count - 2; i >= 1; --i)
        m[i] -= upper[i] * m[i + 1];
}

const double *spline_bend(Pool *pool, const double *s, const double *y, int count, bool periodic)
{
    const size_t size = sizeof(double) * (size_t)count;
    double *m = pool_alloc(pool, size), *upper = pool_alloc(pool, size), *unit = pool_alloc(pool, size);
    if (count < 3)
        return m;
    solve(s, y, count, upper, m);
    if (!periodic)
        return m;
    /* m grows with its value at both ends by `unit`; the equation there says how large that is */
    unit[0] = unit[count - 1] = 1;
    solve(s, NULL, count, upper, unit);
    const double last = width(s, count - 2), first = width(s, 0);
    const double missing = kink(s, y, count - 2, 0) - last * m[count - 2] - first * m[1];
    const double end = missing / (last * unit[count - 2] + 2 * (last + first) + first * unit[1]);
    for (int i = 0; i < count; ++i)
        m[i] += end * unit[i];
    return m;
}

double spline_value(const double *s, const double *y, const double *bend, int count, double at, int *place)
{
    while (*place < count - 2 && at > s[*place + 1])
        ++*place;
    const int i = *place;
    const double h = width(s, i), b = (at - s[i]) / h, a = 1 - b;
    return a * y[i] + b * y[i + 1] + ((a * a * a - a) * bend[i] + (b * b * b - b) * bend[i + 1]) * h * h / 6;
}
