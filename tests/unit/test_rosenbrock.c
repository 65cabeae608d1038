/* SPDX-License-Identifier: MIT
 * Implicit steps (ROS2, ROS3, IMEX) on functions: conditions of order for any matrix A by arithmetic in long double,
 * orders with exact, kept and wrong Jacobians, the stability function, stiff problems, what fails and what is kept. */
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
#define GIC_NAME(name) test_rosenbrock_##name
#include "gic_runtime.c"
#include "run/step_growth.h"
#include "unit/probe.h"

/* ---- conditions of order -------------------------------------------------------------------------------------- */

enum { S = MOST_STAGES };

/* Coefficients as papers have them: k_i = h f(y + sum alpha_ij k_j) + h A sum gamma_ij k_j, y + sum b_i k_i. */
typedef struct Paper {
    int stages;
    long double alpha[S][S], gamma[S][S], b[S];
} Paper;

/* With u = Gamma k, (1 - less) / gamma is the inverse of Gamma. */
static Paper paper_of(const Rosenbrock *r)
{
    Paper p = {.stages = r->stages};
    for (int i = 0; i < p.stages; ++i) /* rows of Gamma: (1 - less) Gamma = gamma */
        for (int j = 0; j <= i; ++j) {
            p.gamma[i][j] = i == j ? r->gamma : 0;
            for (int k = j; k < i; ++k)
                p.gamma[i][j] += (long double)r->less[i][k] * p.gamma[k][j];
        }
    for (int i = 0; i < p.stages; ++i)
        for (int j = 0; j < p.stages; ++j) {
            for (int k = j; k < i; ++k)
                p.alpha[i][j] += (long double)r->place[i][k] * p.gamma[k][j];
            p.b[j] += i >= j ? (long double)r->end[i] * p.gamma[i][j] : 0;
        }
    return p;
}

static long double row_sum(int stages, const long double *row)
{
    long double sum = 0;
    for (int j = 0; j < stages; ++j)
        sum += row[j];
    return sum;
}

static void check_conditions(const Rosenbrock *r, int order)
{
    const Paper p = paper_of(r);
    long double one = -1, a = -0.5L, g = 0, aa = -1 / 3.0L, ata = -1 / 6.0L, atg = 0, gta = 0, gtg = 0;
    long double alpha[S], gamma[S];
    for (int i = 0; i < p.stages; ++i) {
        alpha[i] = row_sum(p.stages, p.alpha[i]);
        gamma[i] = row_sum(p.stages, p.gamma[i]);
        /* times of stages, and shares of the change by time */
        assert_true(fabsl(alpha[i] - r->at[i]) < 1e-15L);
        assert_true(fabsl(gamma[i] - r->drift[i]) < 1e-15L);
    }
    for (int i = 0; i < p.stages; ++i) {
        one += p.b[i];
        a += p.b[i] * alpha[i];
        g += p.b[i] * gamma[i];
        aa += p.b[i] * alpha[i] * alpha[i];
        for (int j = 0; j < p.stages; ++j) {
            ata += p.b[i] * p.alpha[i][j] * alpha[j];
            atg += p.b[i] * p.alpha[i][j] * gamma[j];
            gta += p.b[i] * p.gamma[i][j] * alpha[j];
            gtg += p.b[i] * p.gamma[i][j] * gamma[j];
        }
    }
    /* Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7: A stands for any matrix */
    assert_true(fabsl(one) < 2e-15L && fabsl(a) < 2e-15L && fabsl(g) < 2e-15L);
    if (order == 3)
        assert_true(fabsl(aa) < 2e-15L && fabsl(ata) < 2e-15L && fabsl(atg) < 2e-15L && fabsl(gta) < 2e-15L &&
                    fabsl(gtg) < 2e-15L);
    else
        assert_true(fabsl(aa) > 1e-3L || fabsl(ata) > 1e-3L); /* no more than order 2 */
}

static void test_conditions(void **unused)
{
    (void)unused;
    check_conditions(&ros2, 2);
    check_conditions(&ros3, 3);
    /* ROS2 of the paper: y + 3/2 k_1 + 1/2 k_2 with k_2 of right-hand side f - 2 k_1, gamma^2 - 2 gamma + 1/2 = 0 */
    const long double g = 1 - 1 / sqrtl(2);
    assert_true(fabsl(ros2.gamma - g) < 1e-16L && fabsl(ros2.end[0] - 1.5L / g) < 1e-15L &&
                fabsl(ros2.end[1] - 0.5L / g) < 1e-15L && fabsl(ros2.place[1][0] - 1 / g) < 1e-15L);
}

static double pol_error(const Problem *problem, int method, int steps, int keep, const long double *exact)
{
    const gic_model model = model_of(problem);
    Probe probe = probe_new(problem, pol_start, keep);
    probe.head.input_function = waves;
    for (int k = 0; k < steps; ++k)
        assert_int_equal(gic_step(&model, &probe, pol_end / steps, method), GIC_OK);
    /* IMEX begins with a step of ROS2, whose matrix is another */
    const int most = keep > 1 ? keep : 1, begun = method == GIC_IMEX;
    assert_int_equal(probe.implicit.jacobian_count, begun + (steps - begun + most - 1) / most);
    return fabs(probe.state[0] - (double)exact[0]) + fabs(probe.state[1] - (double)exact[1]);
}

/* With exact Jacobians, with those of some steps ago, with none and with wrong ones. */
static void test_orders(void **unused)
{
    (void)unused;
    const Problem ways[] = {{2, pol_rates, pol_slopes, 0}, {2, pol_rates, NULL, 0}, {2, pol_rates, wrong_slopes, 0}};
    const int keeps[] = {0, 7};
    long double exact[2];
    pol_reference(exact);
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method)
        for (int w = 0; w < 3; ++w)
            for (int k = 0; k < 2; ++k) {
                const int steps = method == GIC_IMEX ? 3200 : 400;
                const double coarse = pol_error(&ways[w], method, steps, keeps[k], exact);
                const double fine = pol_error(&ways[w], method, 2 * steps, keeps[k], exact);
                const double order = log2(coarse / fine);
                if (!(fabs(order - (method == GIC_ROS3 ? 3 : 2)) < 0.15))
                    fail_msg("method %d, way %d, kept %d steps: %g and %g, order %g", method, w, keeps[k], coarse, fine,
                             order);
            }
}

/* ---- stability ------------------------------------------------------------------------------------------------ */

/* A method of order p with R(infinity) = 0 and p coefficients left has the numerator that (1 - gamma z)^s exp(z) begins
 * with, up to z^(s - 1): two stages of order 2 and gamma^2 - 2 gamma + 1/2 = 0, four of order 3. */
static double complex growth_of(const Rosenbrock *r, double complex z)
{
    double complex sum = 0, power = 1;
    for (int j = 0; j < r->stages; ++j, power *= z) {
        double c = 0, binomial = 1, factorial = 1;
        for (int k = 1; k <= j; ++k)
            factorial *= k;
        for (int k = 0; k <= j; ++k) { /* (-gamma)^k binomial(s, k) / (j - k)! */
            c += binomial / factorial;
            binomial *= -r->gamma * (r->stages - k) / (k + 1.0);
            factorial /= j - k > 0 ? j - k : 1;
        }
        sum += c * power;
    }
    return sum / cpow(1 - r->gamma * z, r->stages);
}

static void test_stability(void **unused)
{
    (void)unused;
    const gic_model model = model_of(&spiral);
    for (int method = GIC_ROS2; method <= GIC_ROS3; ++method)
        for (int size = -8; size <= 36; ++size)
            for (int way = 0; way <= 4; ++way) { /* from the negative real axis to the imaginary one */
                const double angle = acos(-1.0) * (1 - way / 8.0), length = pow(10, size / 4.0);
                lambda = length * (way == 4 ? I : cexp(I * angle));
                const double complex right = growth_of(method == GIC_ROS2 ? &ros2 : &ros3, lambda * 0.5);
                Probe probe = probe_new(&spiral, (const double[]){1, 0}, 0);
                assert_int_equal(gic_step(&model, &probe, 0.5, method), GIC_OK);
                const double complex is = probe.state[0] + probe.state[1] * I;
                if (!(cabs(is - right) < 1e-12 * (1 + cabs(right)) && cabs(is) <= 1 + 1e-14))
                    fail_msg("method %d, lambda %g + %g i: %g + %g i, not %g + %g i", method, creal(lambda),
                             cimag(lambda), creal(is), cimag(is), creal(right), cimag(right));
                if (size == 36)
                    assert_true(cabs(is) < 1e-7); /* L-stable */
                /* as --modes tells it, of motions that a step sees */
                const double complex z = lambda * 0.5, error = clog(is * cexp(-z)) / z;
                if (size >= -6 && size <= 2)
                    assert_true(fabs(step_error(method, creal(z), cimag(z)) - cabs(error)) < 1e-12 / cabs(z));
            }
}

/* ---- stiff problems ------------------------------------------------------------------------------------------- */

static double robinson_error(int method, int steps, int keep)
{
    const Problem problem = {1, robinson_rates, robinson_slopes, 0};
    const gic_model model = model_of(&problem);
    Probe probe = probe_new(&problem, (const double[]){0}, keep);
    double most = 0;
    probe.head.input_function = waves;
    for (int k = 1; k <= steps; ++k) {
        assert_int_equal(gic_step(&model, &probe, 2.0 / steps, method), GIC_OK);
        most = fmax(most, fabs(probe.state[0] - sin(2.0 * k / steps)));
    }
    return most;
}

static void test_prothero_robinson(void **unused)
{
    (void)unused;
    for (int method = GIC_ROS2; method <= GIC_ROS3; ++method) {
        stiff = -1; /* the order of the method */
        assert_true(fabs(log2(robinson_error(method, 50, 0) / robinson_error(method, 100, 0)) - method) < 0.15);
        for (stiff = -1e3; stiff > -1e10; stiff *= 10) { /* order 2 at least where steps are long */
            const double coarse = robinson_error(method, 20, 1), fine = robinson_error(method, 40, 1);
            if (!(coarse < 0.1 / -stiff && fine < 0.05 / -stiff))
                fail_msg("method %d, lambda %g: %g and %g", method, stiff, coarse, fine);
        }
    }
    /* IMEX takes what the inputs do as a straight line: off by h^2 times their second derivative, whatever lambda is */
    stiff = -1;
    assert_true(fabs(log2(robinson_error(GIC_IMEX, 50, 0) / robinson_error(GIC_IMEX, 100, 0)) - 2) < 0.15);
    for (stiff = -1e3; stiff > -1e10; stiff *= 10)
        for (int keep = 1; keep < 30; keep += 9) {
            const double coarse = robinson_error(GIC_IMEX, 50, keep), fine = robinson_error(GIC_IMEX, 100, keep);
            if (!(coarse < 1.02 * 0.04 * 0.04 && fine < 1.02 * 0.02 * 0.02))
                fail_msg("IMEX, lambda %g, kept %d steps: %g and %g", stiff, keep, coarse, fine);
        }
}

/* ---- IMEX ----------------------------------------------------------------------------------------------------- */

/* With the exact Jacobian it is the backward formula, y[n + 1] (3 - 2 z) = 4 y[n] - y[n - 1], stable in the left half
 * plane. */
static void test_backward_formula(void **unused)
{
    (void)unused;
    const gic_model model = model_of(&spiral);
    for (int size = -8; size <= 36; ++size)
        for (int way = 0; way <= 4; ++way) {
            const double angle = acos(-1.0) * (1 - way / 8.0), length = pow(10, size / 4.0);
            lambda = length * (way == 4 ? I : cexp(I * angle));
            const double complex z = lambda * 0.5;
            double complex before = 1, now = growth_of(&ros2, z);
            Probe probe = probe_new(&spiral, (const double[]){1, 0}, way);
            assert_int_equal(gic_step(&model, &probe, 0.5, GIC_IMEX), GIC_OK);
            for (int k = 0; k < 60; ++k) {
                const double complex next = (4 * now - before) / (3 - 2 * z);
                before = now;
                now = next;
                assert_int_equal(gic_step(&model, &probe, 0.5, GIC_IMEX), GIC_OK);
                const double complex is = probe.state[0] + probe.state[1] * I;
                if (!(cabs(is - now) < 1e-10 && cabs(is) < 1.5))
                    fail_msg("lambda %g + %g i, step %d: %g + %g i, not %g + %g i", creal(lambda), cimag(lambda), k,
                             creal(is), cimag(is), creal(now), cimag(now));
            }
            assert_true(size < 20 || cabs(now) < 1e-9); /* L-stable */
            if (size >= -6 && size <= -1)               /* the other root is near 1/3 */
                assert_true(fabs(step_error(GIC_IMEX, creal(z), cimag(z)) - cabs(clog(now / before * cexp(-z)) / z)) <
                            1e-9 / cabs(z));
        }
}

/* A Jacobian that has a share of what there is. */
static double part_of_it;

static void part_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)y, (void)u;
    by[0][0] = by[1][1] = part_of_it * creal(lambda);
    by[0][1] = -part_of_it * cimag(lambda);
    by[1][0] = part_of_it * cimag(lambda);
}

/* Of a stiff motion the matrix must have three quarters: then, as z goes to infinity, s r^2 + (1 - s) (2 r - 1) = 0 of
 * a share s has roots within the unit circle, and r = -1 where s is 3/4. */
static void test_rest(void **unused)
{
    (void)unused;
    const Problem problem = {2, spiral_rates, part_slopes, 0};
    const gic_model model = model_of(&problem);
    const struct {
        double share;
        bool stable;
    } row[] = {{0.5, false}, {0.74, false}, {0.76, true}, {1, true}, {2, true}, {10, true}};
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i)
        for (int way = 0; way <= 2; ++way) {
            lambda = -1e8 * cexp(I * acos(-1.0) * way / 6.0);
            part_of_it = row[i].share;
            Probe probe = probe_new(&problem, (const double[]){1, 0}, 1000);
            double begun = 0, most = 0;
            int status = GIC_OK;
            for (int k = 0; k < 400 && status == GIC_OK; ++k) {
                status = gic_step(&model, &probe, 1, GIC_IMEX);
                most = hypot(probe.state[0], probe.state[1]);
                begun = k == 10 ? most : begun;
            }
            assert_int_equal(status, row[i].share > 0.6 ? GIC_OK : GIC_ERROR_UNSTABLE);
            if (!(row[i].stable ? most < 1e-3 * begun : most > 1e3 * begun))
                fail_msg("share %g, way %d: %g, then %g", row[i].share, way, begun, most);
        }
}

/* ---- what is no unknown --------------------------------------------------------------------------------------- */

/* Rates that are unknowns alone give what all states give. */
static void test_positions(void **unused)
{
    (void)unused;
    static const int32_t unknown[2] = {3, 2}, position[2] = {1, 0};
    const Problem problem = {4, swing_rates, swing_slopes, 0};
    const double start[4] = {0.1, 0.3, -1, 2};
    const gic_implicit half = {COLUMNS,
                               2,
                               unknown,
                               position,
                               offsetof(Probe, implicit),
                               offsetof(Probe, pivot),
                               offsetof(Probe, number),
                               probe_jacobian,
                               NULL,
                               NULL,
                               0,
                               NULL,
                               NULL,
                               0,
                               NULL,
                               NULL,
                               0};
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method) {
        const gic_model model = model_of(&problem);
        gic_model other = model;
        other.implicit = &half;
        Probe a = probe_new(&problem, start, 3), b = a;
        a.head.input_function = b.head.input_function = waves;
        for (int k = 0; k < 50; ++k) {
            assert_int_equal(gic_step(&model, &a, 0.02, method), GIC_OK);
            assert_int_equal(gic_step(&other, &b, 0.02, method), GIC_OK);
            for (int i = 0; i < 4; ++i)
                assert_true(fabs(a.state[i] - b.state[i]) < 1e-11 * (1 + fabs(a.state[i])));
        }
    }
}

/* ---- a model's own factors: Cramer's rule */

static int cramer_works;

static int cramer_factorize(const gic_real *jacobian, gic_real reach, gic_real *factor)
{
    for (int i = 0; i < 4; ++i)
        factor[i] = (i == 0 || i == 3 ? 1 : 0) - reach * jacobian[COLUMNS * (i / 2) + i % 2];
    return cramer_works;
}

static void cramer_solve(const gic_real *jacobian, gic_real reach, const gic_real *factor, const gic_real *b,
                         gic_real *u)
{
    const double determinant = factor[0] * factor[3] - factor[1] * factor[2];
    (void)jacobian, (void)reach;
    u[0] = (b[0] * factor[3] - b[1] * factor[1]) / determinant;
    u[1] = (b[1] * factor[0] - b[0] * factor[2]) / determinant;
}

/* They serve where they exist, and the runtime's own where they do not. */
static void test_own_factors(void **unused)
{
    (void)unused;
    const Problem problem = {2, pol_rates, pol_slopes, 0};
    const gic_model model = model_of(&problem);
    gic_model other = model;
    gic_implicit own = whole;
    own.factorize = cramer_factorize;
    own.solve = cramer_solve;
    other.implicit = &own;
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method)
        for (cramer_works = 0; cramer_works < 2; ++cramer_works) {
            Probe a = probe_new(&problem, pol_start, 3), b = a;
            for (int k = 0; k < 30; ++k) {
                assert_int_equal(gic_step(&model, &a, 0.02, method), GIC_OK);
                assert_int_equal(gic_step(&other, &b, 0.02, method), GIC_OK);
                assert_int_equal(b.implicit.exchanged, !cramer_works);
                assert_true(fabs(a.state[0] - b.state[0]) < 1e-13 && fabs(a.state[1] - b.state[1]) < 1e-12);
            }
        }
}

/* ---- failures and copies -------------------------------------------------------------------------------------- */

/* State and time are as before, bit for bit. */
static void assert_same(const Probe *a, const Probe *b)
{
    assert_memory_equal(a->state, b->state, sizeof a->state);
    assert_memory_equal(a->input, b->input, sizeof a->input);
    assert_true(gic_time(a) == gic_time(b));
}

static void test_pivot(void **unused)
{
    (void)unused;
    const gic_model model = model_of(&spiral);
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method) {
        Probe probe = probe_new(&spiral, (const double[]){1, 0}, 5);
        lambda = -1;
        assert_int_equal(gic_step(&model, &probe, 0.25, method), GIC_OK);
        lambda = 8 / (method == GIC_ROS3 ? ros3.gamma : ros2.gamma); /* 1 - gamma h lambda is 0 */
        Probe before = probe;
        assert_int_equal(gic_step(&model, &probe, 0.125, method), GIC_ERROR_PIVOT);
        assert_int_equal(probe.head.grown, 0);
        assert_same(&probe, &before);
        assert_string_equal(gic_status_text(GIC_ERROR_PIVOT),
                            "the matrix of an implicit step is singular: a motion grows too fast for a step so long");
        assert_int_equal(gic_step(&model, &probe, 0.01, method), GIC_OK);
    }
}

static void explosion(double time, const double *y, const double *u, double *rate)
{
    (void)time, (void)u;
    rate[0] = y[0] * y[0] * y[0];
}

static void test_failures(void **unused)
{
    (void)unused;
    const Problem problem = {1, explosion, NULL, 0}, lost = {1, explosion, NULL, GIC_ERROR_ROAD};
    const gic_model model = model_of(&problem);
    gic_model none_of_it = model;
    none_of_it.implicit = NULL;
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method) {
        Probe probe = probe_new(&problem, (const double[]){1e8}, 1), before = probe;
        assert_int_equal(gic_step(&model, &probe, 1, method), GIC_ERROR_UNSTABLE);
        assert_int_equal(probe.head.grown, 0);
        assert_same(&probe, &before);
        assert_int_equal(gic_step(&none_of_it, &probe, 1e-20, method), GIC_ERROR_ARGUMENT);
        probe.head.most = GIC_LEAST_MOST(1) - 1;
        assert_int_equal(gic_step(&model, &probe, 1e-20, method), GIC_ERROR_ARGUMENT);
        assert_same(&probe, &before);
        probe = probe_new(&lost, (const double[]){1}, 1);
        assert_int_equal(gic_step(&model, &probe, 0.01, method), GIC_ERROR_ROAD); /* of the Jacobian */
        assert_int_equal(gic_step(&model, &probe, 0.01, GIC_RK4), GIC_OK);
    }
    Probe probe = probe_new(&problem, (const double[]){1}, 1);
    assert_int_equal(gic_step(&model, &probe, 0.01, GIC_EXP3 + 1), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step(&model, &probe, -0.01, GIC_ROS3), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step(&model, &probe, (double)NAN, GIC_ROS2), GIC_ERROR_ARGUMENT);
}

/* Going on from a copy gives the same bits, with a Jacobian that is kept too. */
static void test_copies(void **unused)
{
    (void)unused;
    const Problem problem = {2, pol_rates, pol_slopes, 0};
    const gic_model model = model_of(&problem);
    for (int method = GIC_ROS2; method <= GIC_IMEX; ++method) {
        Probe probe = probe_new(&problem, pol_start, 5), copy = probe;
        for (int k = 0; k < 40; ++k) {
            if (k == 13)
                copy = probe;
            assert_int_equal(gic_step(&model, &probe, 0.01, method), GIC_OK);
        }
        for (int k = 13; k < 40; ++k)
            assert_int_equal(gic_step(&model, &copy, 0.01, method), GIC_OK);
        assert_memory_equal(&probe, &copy, sizeof probe);
    }
}

/* A new one after a restart, another step or method. */
static void test_keeping(void **unused)
{
    (void)unused;
    const Problem problem = {2, pol_rates, pol_slopes, 0};
    const gic_model model = model_of(&problem);
    const struct {
        double step;
        int method, restart, count;
    } row[] = {{0.01, GIC_ROS2, 0, 1}, {0.01, GIC_ROS2, 0, 1}, {0.02, GIC_ROS2, 0, 2}, {0.02, GIC_ROS3, 0, 3},
               {0.02, GIC_ROS3, 0, 3}, {0.02, GIC_ROS3, 1, 4}, {0.02, GIC_RK4, 0, 4},  {0.02, GIC_ROS3, 0, 5}};
    Probe probe = probe_new(&problem, pol_start, 100);
    for (size_t i = 0; i < sizeof row / sizeof *row; ++i) {
        if (row[i].restart)
            gic_restart(&probe, 0);
        assert_int_equal(gic_step(&model, &probe, row[i].step, row[i].method), GIC_OK);
        assert_int_equal(probe.implicit.jacobian_count, row[i].count);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conditions), cmocka_unit_test(test_orders),
        cmocka_unit_test(test_stability),  cmocka_unit_test(test_prothero_robinson),
        cmocka_unit_test(test_positions),  cmocka_unit_test(test_own_factors),
        cmocka_unit_test(test_pivot),      cmocka_unit_test(test_failures),
        cmocka_unit_test(test_copies),     cmocka_unit_test(test_keeping),
        cmocka_unit_test(test_rest),       cmocka_unit_test(test_backward_formula),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
