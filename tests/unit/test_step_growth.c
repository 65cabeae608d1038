/* SPDX-License-Identifier: MIT
 * step_growth() against the limits of the literature and against what gic_step() makes of y' = lambda y itself. */
#include "gic_runtime.h"
#include "run/step_growth.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* A complex number and its lambda, step 1. */
typedef struct Spiral {
    gic_head head;
    double state[2], rate[2], history[GIC_HISTORY(2, 0)], scratch[GIC_SCRATCH(2, 0)];
    double real, imaginary;
} Spiral;

static int spiral_rhs(void *self, double time, const double *state, double *rate)
{
    const Spiral *s = self;
    (void)time;
    rate[0] = s->real * state[0] - s->imaginary * state[1];
    rate[1] = s->imaginary * state[0] + s->real * state[1];
    return GIC_OK;
}

static int spiral_settle(void *self, double *state)
{
    (void)self;
    return gic_bounded(state, 2) ? GIC_OK : GIC_ERROR_INPUT;
}

static const gic_model spiral_model = {.abi_version = GIC_ABI_VERSION,
                                       .real_size = sizeof(gic_real),
                                       .size = sizeof(Spiral),
                                       .slow_count = 2,
                                       .state_offset = offsetof(Spiral, state),
                                       .rate_offset = offsetof(Spiral, rate),
                                       .history_offset = offsetof(Spiral, history),
                                       .scratch_offset = offsetof(Spiral, scratch),
                                       .rhs = spiral_rhs,
                                       .settle = spiral_settle};

/* Mean growth over the second half of many steps; all is linear, so numbers that get large or small are scaled back. */
static double measured(int32_t method, double real, double imaginary)
{
    enum { STEPS = 8000 };
    Spiral s = {.state = {1, 0.3}, .real = real, .imaginary = imaginary};
    double sum = 0;
    for (int i = 0; i < STEPS; ++i) {
        assert_int_equal(gic_step(&spiral_model, &s, 1, method), GIC_OK);
        const double size = hypot(s.state[0], s.state[1]) + hypot(s.history[0], s.history[1]);
        sum += i >= STEPS / 2 ? log(size) : 0;
        for (int k = 0; k < 2; ++k)
            s.state[k] /= size;
        for (int k = 0; k < 4; ++k)
            s.history[k] /= size;
    }
    return exp(sum / (STEPS / 2));
}

/* Where roots are nearly alike in size their beat is what is left of 4000 steps: 1e-3 at most. */
static void test_measured(void **state)
{
    (void)state;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int i = 0; i <= 12; ++i)
            for (int k = 0; k <= 12; ++k) {
                const double size = method == GIC_AB3 ? 1 : 4;
                const double real = -size * i / 12, imaginary = size * k / 12;
                if (i == 0 && k == 0)
                    continue;
                const double expected = measured(method, real, imaginary);
                assert_true(fabs(step_growth(method, real, imaginary) - expected) < 2e-3 * expected);
            }
}

static double limit(int32_t method, double real, double imaginary)
{
    double low = 0.1, high = 4;
    while (high - low > 1e-7) {
        const double middle = (low + high) / 2;
        /* on the imaginary axis both damp a little below their limits */
        *(step_grows(method, middle * real, middle * imaginary, 1) ? &high : &low) = middle;
    }
    return low;
}

/* Hairer and Wanner, Solving Ordinary Differential Equations II, section V.1 and IV.2. */
static void test_limits(void **state)
{
    (void)state;
    assert_true(fabs(limit(GIC_AB3, -1, 0) - 6.0 / 11) < 1e-6);
    assert_true(fabs(limit(GIC_AB3, 0, 1) - 0.7236) < 1e-4);
    assert_true(fabs(limit(GIC_RK4, -1, 0) - 2.7852936) < 1e-6);
    assert_true(fabs(limit(GIC_RK4, 0, 1) - sqrt(8)) < 1e-6);
}

/* The search ends where the criterion without one changes; a motion and its mirror image are the same. */
static void test_alike(void **state)
{
    (void)state;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int i = 1; i < 20; ++i) {
            const double real = -0.1 * i, imaginary = 0.07 * i * i, growth = step_growth(method, real, imaginary);
            assert_true(step_grows(method, real, imaginary, growth * (1 - 1e-6)));
            assert_false(step_grows(method, real, imaginary, growth * (1 + 1e-6)));
            assert_true(fabs(step_growth(method, real, -imaginary) - growth) < 1e-6 * growth);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_measured), cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_alike)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
