/* SPDX-License-Identifier: MIT
 * Arithmetic of Taylor models. Quotients and roots are found as power series by recurrence, without care, and then
 * bounded by what is left when they are multiplied back. Bounds are made larger by a share that covers the rounding of
 * a few hundred operations on them. */
#include "subset/taylor_model.h"

#include <math.h>

static const Quad rounding = QUAD_EPSILON; /* twice what one operation rounds by */

static Quad wider(Quad bound)
{
    return bound * (1 + 512 * rounding) + 1e-300; /* and what underflows */
}

TaylorModel taylor_constant(Quad value)
{
    return (TaylorModel){.c = {value}};
}

TaylorModel taylor_line(Quad middle, Quad half)
{
    return (TaylorModel){.degree = 1, .c = {middle, half}};
}

static Quad sum_from(const TaylorModel *a, int first)
{
    Quad sum = 0;
    for (int i = first; i <= a->degree; ++i)
        sum += quad_abs(a->c[i]);
    return sum;
}

Quad taylor_most(const TaylorModel *a)
{
    const Quad most = wider(sum_from(a, 0) + a->off);
    return most == most ? most : HUGE_VAL;
}

void taylor_range(const TaylorModel *a, Quad *least, Quad *most)
{
    const Quad radius = wider(sum_from(a, 1) + a->off + rounding * quad_abs(a->c[0]));
    *least = a->c[0] - radius;
    *most = a->c[0] + radius;
}

Quad taylor_end(const TaylorModel *a, int end)
{
    Quad value = 0;
    for (int i = a->degree; i >= 0; --i)
        value = value * (Quad)end + a->c[i];
    return value;
}

static void unbounded(TaylorModel *out)
{
    *out = taylor_constant(0);
    out->off = NAN;
}

void taylor_negative(const TaylorModel *a, TaylorModel *out)
{
    *out = *a;
    for (int i = 0; i <= a->degree; ++i)
        out->c[i] = -a->c[i];
}

void taylor_sum(const TaylorModel *a, const TaylorModel *b, int sign, TaylorModel *out)
{
    TaylorModel sum = {.degree = a->degree > b->degree ? a->degree : b->degree};
    for (int i = 0; i <= sum.degree; ++i)
        sum.c[i] = a->c[i] + (Quad)sign * b->c[i];
    sum.off = wider(a->off + b->off + rounding * sum_from(&sum, 0));
    *out = sum;
}

void taylor_product(const TaylorModel *a, const TaylorModel *b, TaylorModel *out)
{
    const int all = a->degree + b->degree;
    const Quad A = sum_from(a, 0), B = sum_from(b, 0);
    TaylorModel product = {.degree = all < TAYLOR_ORDER ? all : TAYLOR_ORDER};
    Quad left = 0;
    for (int i = 0; i <= a->degree; ++i)
        for (int j = 0; j <= b->degree; ++j)
            if (i + j <= TAYLOR_ORDER)
                product.c[i + j] += a->c[i] * b->c[j];
            else
                left += quad_abs(a->c[i]) * quad_abs(b->c[j]);
    /* a coefficient is a sum of at most TAYLOR_ORDER + 1 products */
    product.off = wider(a->off * (B + b->off) + A * b->off + left + (TAYLOR_ORDER + 2) * rounding * A * B);
    *out = product;
}

void taylor_quotient(const TaylorModel *a, const TaylorModel *b, TaylorModel *out)
{
    TaylorModel inverse = {.degree = b->degree ? TAYLOR_ORDER : 0, .c = {1 / b->c[0]}}, left;
    for (int k = 1; k <= inverse.degree; ++k) {
        Quad sum = 0;
        for (int i = 1; i <= k && i <= b->degree; ++i)
            sum += b->c[i] * inverse.c[k - i];
        inverse.c[k] = -sum * inverse.c[0];
    }
    /* 1 / b = inverse / (1 - left) with left = 1 - b inverse */
    const TaylorModel one = taylor_constant(1);
    taylor_product(b, &inverse, &left);
    taylor_sum(&one, &left, -1, &left);
    const Quad share = taylor_most(&left);
    if (!(share < 0.5)) {
        unbounded(out);
        return;
    }
    inverse.off = wider(taylor_most(&inverse) * share / (1 - share));
    taylor_product(a, &inverse, out);
}

void taylor_root(const TaylorModel *a, TaylorModel *out)
{
    Quad least, most;
    taylor_range(a, &least, &most);
    if (!(least > 0)) {
        unbounded(out);
        return;
    }
    TaylorModel root = {.degree = a->degree ? TAYLOR_ORDER : 0, .c = {quad_sqrt(a->c[0])}}, left;
    for (int k = 1; k <= root.degree; ++k) {
        Quad sum = k <= a->degree ? a->c[k] : 0;
        for (int i = 1; i < k; ++i)
            sum -= root.c[i] * root.c[k - i];
        root.c[k] = sum / (2 * root.c[0]);
    }
    /* sqrt(a) - root = (a - root^2) / (sqrt(a) + root), where the first term of that is positive */
    taylor_product(&root, &root, &left);
    taylor_sum(a, &left, -1, &left);
    taylor_range(&root, &least, &most);
    if (!(least > 0)) {
        unbounded(out);
        return;
    }
    root.off = wider(taylor_most(&left) / least);
    *out = root;
}

/* sin(c + h) and cos(c + h) by those of c and the series of h. */
void taylor_sine(const TaylorModel *a, bool cosine, TaylorModel *out)
{
    TaylorModel h = *a, square, s = taylor_constant(1), c = taylor_constant(1), part;
    h.c[0] = 0;
    const Quad size = taylor_most(&h), middle = a->c[0];
    if (!(size < 1 && quad_abs(middle) < 1000)) {
        unbounded(out);
        return;
    }
    taylor_product(&h, &h, &square);
    const TaylorModel one = taylor_constant(1);
    Quad after = 1; /* what follows the last term is at most the first one that is left out: signs alternate */
    for (int k = TAYLOR_ORDER; k >= 2; k -= 2) {
        const TaylorModel odd = taylor_constant((Quad)(k * (k + 1))), even = taylor_constant((Quad)(k * (k - 1)));
        taylor_product(&square, &s, &part);
        taylor_quotient(&part, &odd, &part);
        taylor_sum(&one, &part, -1, &s);
        taylor_product(&square, &c, &part);
        taylor_quotient(&part, &even, &part);
        taylor_sum(&one, &part, -1, &c);
    }
    taylor_product(&h, &s, &s);
    for (int k = 1; k <= TAYLOR_ORDER + 2; ++k)
        after *= size / (Quad)k;
    s.off = wider(s.off + after);
    c.off = wider(c.off + after);
    Quad of_sine, of_cosine;
    quad_sincos(middle, &of_sine, &of_cosine);
    TaylorModel sine = taylor_constant(of_sine), other = taylor_constant(of_cosine);
    sine.off = other.off = 1e-30;
    taylor_product(cosine ? &other : &sine, &c, &c);
    taylor_product(cosine ? &sine : &other, &s, &s);
    taylor_sum(&c, &s, cosine ? -1 : 1, out);
}

void taylor_choice(const TaylorModel *a, const TaylorModel *positive, const TaylorModel *other, TaylorModel *out)
{
    Quad least, most, low[2], high[2];
    taylor_range(a, &least, &most);
    if (least > 0) {
        *out = *positive;
        return;
    }
    if (most <= 0) {
        *out = *other;
        return;
    }
    taylor_range(positive, &low[0], &high[0]);
    taylor_range(other, &low[1], &high[1]);
    const Quad bottom = low[0] < low[1] ? low[0] : low[1], top = high[0] > high[1] ? high[0] : high[1];
    *out = taylor_constant((bottom + top) / 2);
    out->off = wider((top - bottom) / 2 + rounding * (quad_abs(bottom) + quad_abs(top)));
    if (!quad_is_finite(least + most + low[0] + low[1] + high[0] + high[1]))
        unbounded(out);
}
