/* SPDX-License-Identifier: MIT
 * Exponential steps (EXP3) on functions: functions of matrices against closed forms and series in long double, what is
 * exact for any step, coefficients by Lagrange's polynomials, orders with exact, kept, no and wrong Jacobians, stiff
 * problems, mass matrices, what fails and what is kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <complex.h>
#include <float.h>
#include <math.h>

/* the coefficients are the runtime's own */
#define GIC_NAME(name) test_exponential_##name
#include "gic_runtime.c"
#include "unit/probe.h"

/* ---- functions of matrices ------------------------------------------------------------------------------------- */

/* phi_k(z), by its series where |z| < 2, else phi_k+1(z) = (phi_k(z) - 1 / k!) / z. */
static long double complex phi_of(int k, long double complex z)
{
    long double factorial = 1;
    for (int i = 2; i <= k; ++i)
        factorial *= i;
    if (k == 0)
        return cexpl(z);
    if (cabsl(z) >= 2) {
        const long double before = factorial / k;
        return (phi_of(k - 1, z) - 1 / before) / z;
    }
    long double complex sum = 0, term = 1 / factorial;
    for (int i = 1; i < 60; ++i) {
        sum += term;
        term *= z / (k + i);
    }
    return sum;
}

/* phi_0 to phi_3 of a matrix of `n` rows times `reach`, into phi[k][i][j]; false: it is not made. */
static bool functions_of(int n, const double *matrix, double reach, double (*phi)[MOST][MOST])
{
    static gic_real place[GIC_EXPONENTIAL(MOST) + MOST * GIC_PANEL];
    gic_real unit[MOST], column[MOST];
    Exponential e = {.n = n, .size = GIC_PANEL * n};
    gic_real *at = place, *a = at, *of[FUNCTIONS] = {at + e.size, at + 2 * e.size, at + 3 * e.size, at + 4 * e.size};
    memset(place, 0, sizeof place);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            a[GIC_PANEL * j + i] = matrix[n * i + j];
    const double norm = exponential_balance(&e, a, unit);
    if (!exponential_functions(&e, a, reach, reach * norm, 3, of, at + 5 * e.size, at + 6 * e.size, column))
        return false;
    for (int k = 0; k < FUNCTIONS; ++k)
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                phi[k][i][j] = of[k][GIC_PANEL * j + i] * unit[i] / unit[j];
    return true;
}

/* Of [[a, -b], [b, a]], as complex numbers, also with a coordinate in other units. Errors are relative to the function
 * at -|z|, 0 and |z|: doubling squares them, 2^-52 |z| of them at most, and 40 of its operations. */
static void test_complex(void **unused)
{
    (void)unused;
    const double units[] = {1, 1024, 1e-5};
    for (int size = -12; size <= 12; ++size)
        for (int way = 0; way < 8; ++way)
            for (size_t u = 0; u < sizeof units / sizeof *units; ++u) {
                const double length = pow(10, size / 4.0), angle = acos(-1.0) * way / 4;
                const double a = way % 4 == 2 ? 0 : length * cos(angle), b = way % 4 == 0 ? 0 : length * sin(angle);
                const double matrix[4] = {a, -b * units[u], b / units[u], a};
                double phi[FUNCTIONS][MOST][MOST];
                if (a > 100)
                    continue; /* too large for a number */
                assert_true(functions_of(2, matrix, 1, phi));
                for (int k = 0; k < FUNCTIONS; ++k) {
                    const long double complex right = phi_of(k, a + b * I);
                    const double off = fabs(phi[k][0][0] - (double)creall(right)) +
                                       fabs(phi[k][1][0] * units[u] - (double)cimagl(right)) +
                                       fabs(phi[k][0][1] / units[u] + (double)cimagl(right)) +
                                       fabs(phi[k][1][1] - (double)creall(right));
                    const double most = 40 * DBL_EPSILON * (1 + length) * (1 + (double)cabsl(right));
                    if (!(off < most))
                        fail_msg("phi_%d of %g + %g i, unit %g: %g off, more than %g", k, a, b, units[u], off, most);
                }
            }
}

/* Nice ones: 0; a body without forces, [[0, 1], [0, 0]], whose series ends; one that cannot be. */
static void test_nice(void **unused)
{
    (void)unused;
    double phi[FUNCTIONS][MOST][MOST];
    const double zero[4] = {0}, body[4] = {0, 1, 0, 0}, huge[1] = {1e30};
    const double share[] = {1, 1, 0.5, 1 / 6.0, 1 / 24.0};
    for (double h = 0.125; h < 2000; h *= 2) {
        assert_true(functions_of(2, zero, h, phi));
        for (int k = 0; k < FUNCTIONS; ++k)
            assert_true(fabs(phi[k][0][0] - share[k]) < 1e-15 && fabs(phi[k][1][1] - share[k]) < 1e-15 &&
                        phi[k][0][1] == 0 && phi[k][1][0] == 0);
        assert_true(functions_of(2, body, h, phi));
        for (int k = 0; k < FUNCTIONS; ++k)
            assert_true(fabs(phi[k][0][0] - share[k]) < 1e-14 && fabs(phi[k][1][1] - share[k]) < 1e-14 &&
                        phi[k][1][0] == 0 && fabs(phi[k][0][1] - h * share[k + 1]) < 1e-13 * h);
    }
    assert_false(functions_of(1, huge, 1, phi));
}

/* ---- what is exact ---------------------------------------------------------------------------------------------- */

/* Linear rates, with steps of any length: exp(lambda t), and rest. */
static void test_linear(void **unused)
{
    (void)unused;
    const gic_model model = model_of(&spiral);
    for (int size = -8; size <= 12; ++size)
        for (int way = 0; way <= 4; ++way) { /* from the negative real axis to the imaginary one */
            const double angle = acos(-1.0) * (1 - way / 8.0), length = pow(10, size / 4.0);
            lambda = length * (way == 4 ? I : cexp(I * angle));
            Probe probe = probe_new(&spiral, (const double[]){1, 0}, way);
            for (int k = 1; k <= 20; ++k) {
                assert_int_equal(gic_step(&model, &probe, 0.5, GIC_EXP3), GIC_OK);
                const double complex is = probe.state[0] + probe.state[1] * I, right = cexp(lambda * 0.5 * k);
                if (!(cabs(is - right) < 1e-13 * k * (1 + length)))
                    fail_msg("lambda %g + %g i, step %d: %g off", creal(lambda), cimag(lambda), k, cabs(is - right));
            }
            assert_int_equal(probe.implicit.jacobian_count, way > 1 ? (20 + way - 1) / way : 1);
            probe = probe_new(&spiral, (const double[]){0, 0}, 0);
            for (int k = 0; k < 3; ++k)
                assert_int_equal(gic_step(&model, &probe, 0.5, GIC_EXP3), GIC_OK);
            assert_true(probe.state[0] == 0 && probe.state[1] == 0);
        }
}

static int power;

static void power_rates(double time, const double *y, const double *u, double *rate)
{
    (void)y, (void)u;
    rate[0] = pow(time, power);
}

/* Of rates t^p alone, without A: exact to p = 2 from the first step on, and of t^3 an excess of h^4 / 36 in each step
 * after it; in the first one 2/3 of the node's (2/3)^2 for 1 / 4. */
static void test_powers(void **unused)
{
    (void)unused;
    const Problem problem = {1, power_rates, NULL, 0};
    const gic_model model = model_of(&problem);
    const double h = 0.25;
    for (power = 0; power <= 3; ++power) {
        Probe probe = probe_new(&problem, (const double[]){0}, 0);
        for (int k = 1; k <= 8; ++k) {
            assert_int_equal(gic_step(&model, &probe, h, GIC_EXP3), GIC_OK);
            const double first = 3 / 4.0 * 8 / 27 - 1 / 4.0,
                         lack = power < 3 ? 0 : pow(h, 4) * (first - (k - 1) / 36.0);
            assert_true(fabs(probe.state[0] - pow(h * k, power + 1) / (power + 1) - lack) < 1e-14);
        }
    }
}

/* ---- coefficients ----------------------------------------------------------------------------------------------- */

/* The integral over a step of the polynomial that is 1 at a and 0 at b and c. */
static long double weight(long double a, long double b, long double c)
{
    return (1 / 3.0L - (b + c) / 2 + b * c) / ((a - b) * (a - c));
}

/* Both parts as floats, in which functions at the node are multiplied. */
static long double complex brief(long double complex z)
{
    return (float)creall(z) + (float)cimagl(z) * (long double complex)I;
}

/* Without A a step is a linear recurrence of complex numbers: a straight line to the node, a parabola over the step. */
static void test_recurrence(void **unused)
{
    (void)unused;
    const Problem problem = {2, spiral_rates, NULL, 0};
    const gic_model model = model_of(&problem);
    const long double c = 2 / 3.0L, before = weight(-1, 0, c), here = weight(0, -1, c), there = weight(c, -1, 0);
    for (int way = 0; way < 8; ++way) {
        lambda = 0.8 * cexp(I * acos(-1.0) * way / 4);
        const long double complex z = lambda * 0.5;
        Probe probe = probe_new(&problem, (const double[]){1, 0}, 0);
        assert_int_equal(gic_step(&model, &probe, 0.5, GIC_EXP3), GIC_OK);
        /* the first one is Heun's method of order 3, but for the roundings at its node */
        const long double complex early = 1 + brief(c * z), first = early + brief(c * z * (early - 1)) / 2;
        long double complex last = 1, now = 1 + z / 4 + 3 * z / 4 * first;
        assert_true(cabsl(now - (1 + z + z * z / 2 + z * z * z / 6)) < 1e-7);
        for (int k = 0; k < 20; ++k) {
            const double complex is = probe.state[0] + probe.state[1] * I;
            assert_true(cabs(is - (double complex)now) < 1e-14 * (1 + (double)cabsl(now)));
            assert_int_equal(gic_step(&model, &probe, 0.5, GIC_EXP3), GIC_OK);
            const long double complex moved = c * (now - last);
            const long double complex stage = now + moved + brief(c * z * now - moved) + brief(c * z * moved) / 2;
            const long double complex next = now + z * (before * last + here * now + there * stage);
            last = now;
            now = next;
        }
    }
}

static double pol_off(const Problem *problem, int steps, int keep, const long double *exact)
{
    const gic_model model = model_of(problem);
    Probe probe = probe_new(problem, pol_start, keep);
    probe.head.input_function = waves;
    for (int k = 0; k < steps; ++k)
        assert_int_equal(gic_step(&model, &probe, pol_end / steps, GIC_EXP3), GIC_OK);
    assert_int_equal(probe.implicit.jacobian_count, keep > 1 ? (steps + keep - 1) / keep : 1);
    return fabs(probe.state[0] - (double)exact[0]) + fabs(probe.state[1] - (double)exact[1]);
}

/* Order 3 with exact Jacobians of the first step or some steps ago, with none, and with wrong ones. */
static void test_orders(void **unused)
{
    (void)unused;
    const Problem ways[] = {{2, pol_rates, pol_slopes, 0}, {2, pol_rates, NULL, 0}, {2, pol_rates, wrong_slopes, 0}};
    const int keeps[] = {0, 7};
    long double exact[2];
    pol_reference(exact);
    for (int w = 0; w < 3; ++w)
        for (int k = 0; k < 2; ++k) {
            const double coarse = pol_off(&ways[w], 800, keeps[k], exact),
                         fine = pol_off(&ways[w], 1600, keeps[k], exact), order = log2(coarse / fine);
            if (!(fabs(order - 3) < 0.15))
                fail_msg("way %d, kept %d steps: %g and %g, order %g", w, keeps[k], coarse, fine, order);
        }
}

/* ---- stiff problems ---------------------------------------------------------------------------------------------- */

/* However stiff, off by h^3 times the third derivative, 1, of what is followed, as its parabola is: |t (t + 1) (t -
 * 2/3)| / 6 is 1/9 at most over a step; a quarter more for what stays of a step in the next ones. */
static void test_prothero_robinson(void **unused)
{
    (void)unused;
    const Problem problem = {1, robinson_rates, robinson_slopes, 0};
    const gic_model model = model_of(&problem);
    for (stiff = -1e3; stiff > -1e10; stiff *= 10)
        for (int steps = 20; steps <= 320; steps *= 2) {
            const double h = 2.0 / steps;
            Probe probe = probe_new(&problem, (const double[]){0}, 0);
            double most = 0;
            probe.head.input_function = waves;
            for (int k = 1; k <= steps; ++k) {
                assert_int_equal(gic_step(&model, &probe, h, GIC_EXP3), GIC_OK);
                if (k > 1) /* the first has a straight line */
                    most = fmax(most, fabs(probe.state[0] - sin(h * k)));
            }
            if (!(most < 1.25 / 9 * h * h * h + 1e-14))
                fail_msg("lambda %g, %d steps: %g, more than %g h^3", stiff, steps, most, most / (h * h * h));
        }
}

/* ---- positions and masses ---------------------------------------------------------------------------------------- */

/* A mass matrix of velocities: rows of the Jacobian are forces, then, and it stands behind. */
static const double mass[2][2] = {{2, 0.5}, {0.5, 1}};

static void massive_rates(double time, const double *y, const double *u, double *rate)
{
    swing_rates(time, y, u, rate); /* forces */
    const double f = rate[2], g = rate[3], determinant = mass[0][0] * mass[1][1] - mass[0][1] * mass[1][0];
    rate[2] = (mass[1][1] * f - mass[0][1] * g) / determinant;
    rate[3] = (mass[0][0] * g - mass[1][0] * f) / determinant;
}

static void massive_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    swing_slopes(time, y, u, by);
    const double determinant = mass[0][0] * mass[1][1] - mass[0][1] * mass[1][0];
    for (int j = 0; j < COLUMNS; ++j) {
        const double f = by[2][j], g = by[3][j];
        by[2][j] = (mass[1][1] * f - mass[0][1] * g) / determinant;
        by[3][j] = (mass[0][0] * g - mass[1][0] * f) / determinant;
    }
}

/* Room behind the numbers for the masses. */
typedef struct Massive {
    Probe probe;
    gic_real number[GIC_IMPLICIT(MOST, COLUMNS) + 4];
} Massive;

static int massive_jacobian(void *self, gic_real time, const gic_real *state, gic_real *jacobian)
{
    Problem forces = {4, swing_rates, swing_slopes, 0};
    Probe probe = *(const Probe *)self;
    probe.problem = &forces;
    for (int i = 0; i < 4; ++i)
        jacobian[MOST * COLUMNS + i] = mass[i / 2][i % 2];
    return probe_jacobian(&probe, time, state, jacobian);
}

/* Positions whose rates are states, and rows of forces, give what all rows of accelerations give. */
static void test_masses(void **unused)
{
    (void)unused;
    static const int32_t unknown[2] = {3, 2}, position[2] = {1, 0}, row[4] = {2, 2, 3, 3}, column[4] = {2, 3, 2, 3};
    const Problem problem = {4, massive_rates, massive_slopes, 0};
    const double start[4] = {0.1, 0.3, -1, 2};
    gic_implicit half = whole;
    half.unknown_count = 2;
    half.unknown = unknown;
    half.position = position;
    half.number_offset = offsetof(Massive, number);
    half.jacobian = massive_jacobian;
    half.mass_count = 4;
    half.mass_row = row;
    half.mass_column = column;
    const gic_model model = model_of(&problem);
    gic_model other = model;
    other.implicit = &half;
    for (int keep = 0; keep < 8; keep += 4) {
        Probe a = probe_new(&problem, start, keep);
        Massive b = {.probe = a};
        for (int k = 0; k < 50; ++k) {
            assert_int_equal(gic_step(&model, &a, 0.005, GIC_EXP3), GIC_OK);
            assert_int_equal(gic_step(&other, &b, 0.005, GIC_EXP3), GIC_OK);
            for (int i = 0; i < 4; ++i) /* rounding, times motions of 200 rad/s */
                assert_true(fabs(a.state[i] - b.probe.state[i]) < 1e-11 * (1 + fabs(a.state[i])));
        }
    }
}

/* ---- failures, copies, lengths ------------------------------------------------------------------------------------
 */

static void test_failures(void **unused)
{
    (void)unused;
    const Problem lost = {2, spiral_rates, spiral_slopes, GIC_ERROR_ROAD};
    const gic_model model = model_of(&spiral), losing = model_of(&lost);
    gic_implicit plain = whole;
    plain.exponential_offset = 0;
    gic_model without = model;
    without.implicit = &plain;
    lambda = -1;
    Probe probe = probe_new(&spiral, (const double[]){1, 0}, 0), before = probe;
    assert_int_equal(gic_step(&without, &probe, 0.25, GIC_EXP3), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step(&model, &probe, -0.25, GIC_EXP3), GIC_ERROR_ARGUMENT);
    probe.head.most = GIC_LEAST_MOST(1) - 1;
    assert_int_equal(gic_step(&model, &probe, 0.25, GIC_EXP3), GIC_ERROR_ARGUMENT);
    assert_memory_equal(probe.state, before.state, sizeof probe.state);
    probe = probe_new(&spiral, (const double[]){1, 0}, 0);
    lambda = 1e6; /* e to that */
    assert_int_equal(gic_step(&model, &probe, 1, GIC_EXP3), GIC_ERROR_PIVOT);
    assert_memory_equal(probe.state, before.state, sizeof probe.state);
    assert_true(gic_time(&probe) == 0);
    lambda = -1;
    assert_int_equal(gic_step(&model, &probe, 1, GIC_EXP3), GIC_OK);
    assert_true(fabs(probe.state[0] - exp(-1)) < 1e-15);
    probe = probe_new(&lost, (const double[]){1, 0}, 0);
    assert_int_equal(gic_step(&losing, &probe, 1, GIC_EXP3), GIC_ERROR_ROAD); /* of the Jacobian */
}

/* Going on from a copy gives the same bits, and so does going on after a step that failed. */
static void test_copies(void **unused)
{
    (void)unused;
    const Problem problem = {2, pol_rates, pol_slopes, 0};
    const gic_model model = model_of(&problem);
    Probe probe = probe_new(&problem, pol_start, 5), copy = probe;
    for (int k = 0; k < 40; ++k) {
        if (k == 13)
            copy = probe;
        assert_int_equal(gic_step(&model, &probe, 0.01, GIC_EXP3), GIC_OK);
    }
    for (int k = 13; k < 40; ++k)
        assert_int_equal(gic_step(&model, &copy, 0.01, GIC_EXP3), GIC_OK);
    assert_memory_equal(&probe, &copy, sizeof probe);
    const double fine = probe.state[1];
    copy = probe;
    copy.state[1] = (double)NAN;
    assert_int_equal(gic_step(&model, &copy, 0.01, GIC_EXP3), GIC_ERROR_INPUT);
    copy.state[1] = fine;
    assert_int_equal(gic_step(&model, &copy, 0.01, GIC_EXP3), GIC_OK);
    assert_int_equal(gic_step(&model, &probe, 0.01, GIC_EXP3), GIC_OK);
    assert_memory_equal(probe.state, copy.state, sizeof probe.state);
}

/* Exponentials stay for a length; a single step of another one is ROS3's, with a Jacobian of its own, the second one
 * has exponentials. */
static void test_lengths(void **unused)
{
    (void)unused;
    const Problem problem = {2, pol_rates, pol_slopes, 0};
    const gic_model model = model_of(&problem);
    const struct {
        double step;
        int method, count;
        double span;
    } row[] = {{0.01, GIC_EXP3, 1, 0.01}, {0.01, GIC_EXP3, 1, 0.01}, {0.02, GIC_EXP3, 2, 0.01},
               {0.01, GIC_EXP3, 2, 0.01}, {0.02, GIC_EXP3, 3, 0.01}, {0.02, GIC_EXP3, 4, 0.02},
               {0.02, GIC_EXP3, 4, 0.02}, {0.02, GIC_RK4, 4, 0.02},  {0.02, GIC_EXP3, 4, 0.02},
               {0.01, GIC_ROS2, 5, 0.02}, {0.02, GIC_EXP3, 5, 0.02}};
    Probe probe = probe_new(&problem, pol_start, 0), other;
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i) {
        other = probe;
        assert_int_equal(gic_step(&model, &probe, row[i].step, row[i].method), GIC_OK);
        assert_int_equal(probe.implicit.jacobian_count, row[i].count);
        assert_true(probe.implicit.span == row[i].span);
        if (row[i].method != GIC_EXP3 || row[i].span == row[i].step)
            continue;
        other.implicit.keep = 0;
        assert_int_equal(gic_step(&model, &other, row[i].step, GIC_ROS3), GIC_OK);
        assert_memory_equal(probe.state, other.state, sizeof probe.state);
    }
    gic_restart(&probe, 0); /* it has none of the past, but its exponentials, until one says 0 */
    assert_int_equal(gic_step(&model, &probe, 0.02, GIC_EXP3), GIC_OK);
    assert_int_equal(probe.implicit.jacobian_count, 5);
    probe.implicit.span = 0;
    assert_int_equal(gic_step(&model, &probe, 0.02, GIC_EXP3), GIC_OK);
    assert_int_equal(probe.implicit.jacobian_count, 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complex),    cmocka_unit_test(test_nice),    cmocka_unit_test(test_linear),
        cmocka_unit_test(test_powers),     cmocka_unit_test(test_orders),  cmocka_unit_test(test_prothero_robinson),
        cmocka_unit_test(test_recurrence), cmocka_unit_test(test_masses),  cmocka_unit_test(test_failures),
        cmocka_unit_test(test_copies),     cmocka_unit_test(test_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
