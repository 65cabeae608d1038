/* SPDX-License-Identifier: MIT
 * Elementary functions in quad precision, from those of long double and series: no library has to be there for them. */
#include "base/quad.h"

#include <math.h>

Quad quad_pi(void)
{
    return 4 * quad_atan2(1, 1);
}

Quad quad_sqrt(Quad a)
{
    const Quad s = sqrtl((long double)a);
    return s > 0 && quad_is_finite(s) ? (s + a / s) / 2 : s; /* a step of Newton's iteration doubles the digits */
}

/* Series at a small share of the angle; then it is doubled. 1 - cos is what is kept, for it is small. */
void quad_sincos(Quad a, Quad *sine, Quad *cosine)
{
    int doubled = 0;
    for (; quad_abs(a) > 0.125 && quad_is_finite(a) && doubled < 64; ++doubled)
        a /= 2;
    const Quad square = a * a;
    Quad s = 0, less = 0; /* what follows the first term of sin a and of 1 - cos a, as shares of it */
    for (int k = 24; k >= 2; k -= 2) {
        s = (1 - s) * square / (k * (k + 1));
        less = (1 - less) * square / ((k + 1) * (k + 2));
    }
    s = a * (1 - s);
    less = square / 2 * (1 - less);
    for (; doubled > 0; --doubled) {
        const Quad c = 1 - less;
        less = 2 * s * s;
        s = 2 * s * c;
    }
    *sine = s;
    *cosine = 1 - less;
}

Quad quad_atan2(Quad y, Quad x)
{
    const Quad a = atan2l((long double)y, (long double)x);
    Quad s, c;
    quad_sincos(a, &s, &c);
    const Quad along = x * c + y * s;
    const Quad rest = along > 0 ? (y * c - x * s) / along : 0; /* the tangent of what is left: its cube is nothing */
    return a + rest;
}

Quad quad_exp(Quad a)
{
    if (a < 0)
        return 1 / quad_exp(-a);
    const Quad share = a / 1024;
    Quad sum = 0; /* exp(share) - 1 */
    for (int k = 24; k >= 1; --k)
        sum = (1 + sum) * share / k;
    for (int i = 0; i < 10; ++i)
        sum = sum * (2 + sum);
    return 1 + sum;
}

Quad quad_log(Quad a)
{
    const Quad l = logl((long double)a);
    if (!quad_is_finite(l))
        return l;
    const Quad rest = a * quad_exp(-l) - 1;
    return l + rest - rest * rest / 2;
}
