/* SPDX-License-Identifier: MIT
 * Quad precision's functions against digits from tables and by the theorems that they obey, within 4e-31 (two
 * functions); Taylor models against values of their functions, in quad precision, at random places: each must be within
 * the model's bound, and the bound small where the function is smooth. */
#include "base/quad.h"
#include "subset/taylor_model.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static Quad digits(const char *text)
{
    Quad value = 0, unit = 1;
    bool after = false;
    for (; *text; ++text)
        if (*text == '.') {
            after = true;
        } else {
            value = value * 10 + (*text - '0');
            unit *= after ? 10 : 1;
        }
    return value / unit;
}

static void near(Quad a, Quad b)
{
    assert_true(quad_abs(a - b) <= (Quad)4e-31 * quad_max(1, quad_abs(b)));
}

static double drawn(double least, double most)
{
    return least + (most - least) * rand() / RAND_MAX;
}

static void test_digits(void **state)
{
    (void)state;
    Quad s, c;
    near(quad_pi(), digits("3.14159265358979323846264338327950288"));
    near(quad_exp(1), digits("2.71828182845904523536028747135266250"));
    near(quad_log(10), digits("2.30258509299404568401799145468436421"));
    near(quad_sqrt(2), digits("1.41421356237309504880168872420969808"));
    quad_sincos(1, &s, &c);
    near(s, digits("0.84147098480789650665250232163029900"));
    near(c, digits("0.54030230586813971740093660744297660"));
    quad_sincos(quad_pi() / 6, &s, &c);
    near(s, (Quad)1 / 2);
    quad_sincos(0, &s, &c);
    assert_true(s == 0 && c == 1);
    near(quad_atan2(-1, -1), -3 * quad_pi() / 4);
    assert_true(quad_sqrt(0) == 0);
    assert_false(quad_is_finite(quad_sqrt(-1)));
}

static void test_theorems(void **state)
{
    (void)state;
    for (int i = 0; i < 2000; ++i) {
        const Quad a = drawn(-30, 30), b = drawn(-30, 30), r = drawn(0.1, 9);
        Quad s[3], c[3];
        quad_sincos(a, &s[0], &c[0]);
        quad_sincos(b, &s[1], &c[1]);
        quad_sincos(a + b, &s[2], &c[2]);
        near(s[2], s[0] * c[1] + c[0] * s[1]);
        near(c[2], c[0] * c[1] - s[0] * s[1]);
        near(quad_exp(a) * quad_exp(-a), 1);
        near(quad_log(quad_exp(a)), a);
        near(quad_sqrt(r) * quad_sqrt(r), r);
        quad_sincos(r / 3, &s[0], &c[0]);
        near(quad_atan2(r * s[0], r * c[0]), r / 3);
    }
}

/* Value of a polynomial. */
static Quad value_of(const TaylorModel *a, Quad t)
{
    Quad sum = 0;
    for (int i = a->degree; i >= 0; --i)
        sum = sum * t + a->c[i];
    return sum;
}

/* The function's value at t lies where the model says; it says it within `bound`. */
static void holds(const TaylorModel *a, Quad t, Quad value, Quad bound)
{
    Quad least, most;
    taylor_range(a, &least, &most);
    assert_true(quad_abs(value - value_of(a, t)) <= a->off + (Quad)1e-29);
    assert_true(least <= value + (Quad)1e-29 && value <= most + (Quad)1e-29);
    assert_true(a->off <= bound);
}

static void test_operations(void **state)
{
    (void)state;
    for (int i = 0; i < 400; ++i) {
        const Quad middle = drawn(-2, 2), half = drawn(0.001, 0.05), shift = drawn(3, 5);
        const TaylorModel x = taylor_line(middle, half), y = taylor_constant(shift);
        TaylorModel sum, square, sine, cosine, quotient, root, product;
        taylor_sum(&x, &y, 1, &sum);
        taylor_product(&x, &x, &square);
        taylor_sine(&square, false, &sine);
        taylor_sine(&square, true, &cosine);
        taylor_quotient(&sine, &sum, &quotient);
        taylor_root(&sum, &root);
        taylor_product(&root, &cosine, &product);
        for (int k = 0; k <= 20; ++k) {
            const Quad t = (Quad)(k - 10) / 10, at = middle + half * t;
            Quad s, c;
            quad_sincos(at * at, &s, &c);
            holds(&sine, t, s, 1e-7);
            holds(&cosine, t, c, 1e-7);
            holds(&quotient, t, s / (at + shift), 1e-7);
            holds(&root, t, quad_sqrt(at + shift), 1e-12);
            holds(&product, t, quad_sqrt(at + shift) * c, 1e-6);
        }
    }
}

/* Numbers that coincide, and what has no bound. */
static void test_limits(void **state)
{
    (void)state;
    const TaylorModel zero = taylor_constant(0), one = taylor_constant(1), x = taylor_line(0, 1);
    TaylorModel out, minus;
    taylor_product(&zero, &x, &out);
    assert_true(taylor_most(&out) < (Quad)1e-290);
    taylor_quotient(&one, &zero, &out);
    assert_false(quad_is_finite(taylor_most(&out)));
    taylor_quotient(&one, &x, &out);
    assert_false(quad_is_finite(taylor_most(&out)));
    taylor_root(&x, &out);
    assert_false(quad_is_finite(taylor_most(&out)));
    taylor_sum(&out, &one, 1, &out); /* and so it stays */
    assert_false(quad_is_finite(taylor_most(&out)));
    taylor_negative(&x, &minus);
    taylor_choice(&x, &x, &minus, &out); /* |x| where x has both signs */
    for (int k = -4; k <= 4; ++k)
        holds(&out, (Quad)k / 4, quad_abs((Quad)k / 4), 1.0001);
    taylor_sum(&x, &one, 1, &minus);
    taylor_choice(&one, &minus, &x, &out);
    assert_true(out.c[0] == 1 && out.c[1] == 1);
    assert_true(taylor_end(&x, -1) == -1 && taylor_end(&x, 1) == 1);
    /* a bound of what goes in stays one of what comes out */
    TaylorModel wide = taylor_constant(2);
    wide.off = (Quad)0.125;
    taylor_product(&wide, &wide, &out);
    assert_true(out.off >= (Quad)(2.125 * 2.125 - 4));
    taylor_quotient(&one, &wide, &out);
    assert_true(out.off >= (Quad)(1 / 1.875 - 0.5));
    taylor_root(&wide, &out);
    holds(&out, 0, quad_sqrt(1.875), 0.1);
    holds(&out, 0, quad_sqrt(2.125), 0.1);
    taylor_sine(&wide, false, &out);
    Quad s, c;
    quad_sincos(2.125, &s, &c);
    holds(&out, 0, s, 0.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_digits), cmocka_unit_test(test_theorems),
                                       cmocka_unit_test(test_operations), cmocka_unit_test(test_limits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
