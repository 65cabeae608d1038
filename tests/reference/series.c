/* SPDX-License-Identifier: MIT
 * Formulas of coordinates as Taylor series a0 + a1 t + a2 t^2, by their recurrences. */
#include "formula.h"

#include "support.h"

#include <quadmath.h>
#include <string.h>

static Series times(Series a, Series b)
{
    return (Series){
        {a.c[0] * b.c[0], a.c[0] * b.c[1] + a.c[1] * b.c[0], a.c[0] * b.c[2] + a.c[1] * b.c[1] + a.c[2] * b.c[0]}};
}

static Series plus(Series a, quad sign, Series b)
{
    return (Series){{a.c[0] + sign * b.c[0], a.c[1] + sign * b.c[1], a.c[2] + sign * b.c[2]}};
}

/* q b = a */
static Series over(Series a, Series b)
{
    Series q;
    q.c[0] = a.c[0] / b.c[0];
    q.c[1] = (a.c[1] - q.c[0] * b.c[1]) / b.c[0];
    q.c[2] = (a.c[2] - q.c[0] * b.c[2] - q.c[1] * b.c[1]) / b.c[0];
    return q;
}

/* The series that begins with `value` and has the rate `slope` a'; of slope only two terms count. */
static Series integral(quad value, Series slope, Series a)
{
    return (Series){{value, slope.c[0] * a.c[1], (2 * slope.c[0] * a.c[2] + slope.c[1] * a.c[1]) / 2}};
}

static const Series one = {{1, 0, 0}};

static Series of_exp(Series a)
{
    Series e = {{expq(a.c[0]), 0, 0}};
    e.c[1] = e.c[0] * a.c[1];
    e.c[2] = e.c[0] * a.c[2] + e.c[1] * a.c[1] / 2;
    return e;
}

static void sin_cos(Series a, Series *s, Series *c)
{
    s->c[0] = sinq(a.c[0]);
    c->c[0] = cosq(a.c[0]);
    s->c[1] = c->c[0] * a.c[1];
    c->c[1] = -s->c[0] * a.c[1];
    s->c[2] = c->c[0] * a.c[2] + c->c[1] * a.c[1] / 2;
    c->c[2] = -s->c[0] * a.c[2] - s->c[1] * a.c[1] / 2;
}

static Series of_sqrt(Series a)
{
    Series r = {{sqrtq(a.c[0]), 0, 0}};
    r.c[1] = a.c[1] / (2 * r.c[0]);
    r.c[2] = (a.c[2] - r.c[1] * r.c[1]) / (2 * r.c[0]);
    return r;
}

static Series of_log(Series a)
{
    return integral(logq(a.c[0]), over(one, a), a);
}

/* Whole powers by products, so that a base of 0 has derivatives. */
static Series power(Series a, Series b)
{
    const int n = (int)b.c[0];
    if (b.c[1] == 0 && b.c[2] == 0 && n == b.c[0] && n >= 0 && n < 64) {
        Series product = one;
        for (int i = 0; i < n; ++i)
            product = times(product, a);
        return product;
    }
    return of_exp(times(b, of_log(a)));
}

static Series of_tanh(Series a)
{
    Series t = {{tanhq(a.c[0]), 0, 0}};
    t.c[1] = (1 - t.c[0] * t.c[0]) * a.c[1];
    return integral(t.c[0], plus(one, -1, times(t, t)), a);
}

static Series call(const char *op, int arguments, Series a, Series b)
{
    const Series squared = times(a, a);
    Series s, c;
    sin_cos(a, &s, &c);
    if (!strcmp(op, "-"))
        return arguments == 1 ? plus((Series){{0, 0, 0}}, -1, a) : plus(a, -1, b);
    if (!strcmp(op, "+"))
        return plus(a, 1, b);
    if (!strcmp(op, "*"))
        return times(a, b);
    if (!strcmp(op, "/"))
        return over(a, b);
    if (!strcmp(op, "pow"))
        return power(a, b);
    if (!strcmp(op, "sqrt"))
        return of_sqrt(a);
    if (!strcmp(op, "sin"))
        return s;
    if (!strcmp(op, "cos"))
        return c;
    if (!strcmp(op, "tan"))
        return over(s, c);
    if (!strcmp(op, "exp"))
        return of_exp(a);
    if (!strcmp(op, "log"))
        return of_log(a);
    if (!strcmp(op, "tanh"))
        return of_tanh(a);
    if (!strcmp(op, "atan"))
        return integral(atanq(a.c[0]), over(one, plus(one, 1, squared)), a);
    if (!strcmp(op, "asin"))
        return integral(asinq(a.c[0]), over(one, of_sqrt(plus(one, -1, squared))), a);
    if (!strcmp(op, "acos"))
        return integral(acosq(a.c[0]), over((Series){{-1, 0, 0}}, of_sqrt(plus(one, -1, squared))), a);
    if (!strcmp(op, "atan2")) {
        /* of (b, a): r^2 angle' = b a' - a b' */
        const Series square = plus(squared, 1, times(b, b));
        const Series da = {{a.c[1], 2 * a.c[2], 0}}, db = {{b.c[1], 2 * b.c[2], 0}};
        const Series rate = over(plus(times(b, da), -1, times(a, db)), square);
        return (Series){{atan2q(a.c[0], b.c[0]), rate.c[0], rate.c[1] / 2}};
    }
    fail("a formula of a joint has '%s'", op);
}

Series formula_series(const Formula *formula, const quad *w, const quad *way)
{
    Series a[2] = {{{0}}};
    if (!formula->op)
        return (Series){{formula->number, 0, 0}};
    if (!strcmp(formula->op, "value"))
        return (Series){{w[formula->index], way[formula->index], 0}};
    for (int i = 0; i < formula->arguments && i < 2; ++i)
        a[i] = formula_series(formula->argument[i], w, way);
    return call(formula->op, formula->arguments, a[0], a[1]);
}
