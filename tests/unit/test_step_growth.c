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

/* Longest steps: the limits above over |lambda|, on a way that leaves the region once and on one that grows by itself.
 */
static void test_stable(void **state)
{
    (void)state;
    for (double size = 1e-3; size < 1e6; size *= 7) {
        assert_true(fabs(step_stable(GIC_AB3, -size, 0) * size - 6.0 / 11) < 1e-9);
        assert_true(fabs(step_stable(GIC_RK4, -size, 0) * size - 2.785293563405282) < 1e-9);
        assert_true(fabs(step_stable(GIC_RK4, 0, size) * size - sqrt(8)) < 1e-6);
        /* the same for what rounding leaves of damping */
        assert_true(fabs(step_stable(GIC_AB3, 1e-12 * size, size) * size - 0.7236) < 1e-4);
        assert_true(isinf(step_stable(GIC_AB3, size, 0)) && isinf(step_stable(GIC_RK4, size, size)));
        for (int32_t method = GIC_ROS2; method <= GIC_IMEX; ++method)
            assert_true(isinf(step_stable(method, -size, size)));
    }
    assert_true(isinf(step_stable(GIC_AB3, 0, 0)) && isinf(step_accurate(GIC_IMEX, 0, 0, 0.01)));
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int way = 1; way <= 8; ++way) {
            const double angle = acos(-1.0) * (1 - way / 17.0), step = step_stable(method, cos(angle), sin(angle));
            assert_true(measured(method, 0.98 * step * cos(angle), 0.98 * step * sin(angle)) < 1);
            assert_true(measured(method, 1.02 * step * cos(angle), 1.02 * step * sin(angle)) > 1);
        }
}

/* The eigenvalue in steps, as the turn and growth of a run have it after its start. */
static double measured_error(int32_t method, double real, double imaginary)
{
    Spiral s = {.state = {1, 0}, .real = real, .imaginary = imaginary};
    double before[2] = {0};
    for (int i = 0; i < 60; ++i) {
        before[0] = s.state[0];
        before[1] = s.state[1];
        assert_int_equal(gic_step(&spiral_model, &s, 1, method), GIC_OK);
    }
    const double square = before[0] * before[0] + before[1] * before[1];
    const double across = before[0] * s.state[1] - before[1] * s.state[0];
    const double along = before[0] * s.state[0] + before[1] * s.state[1];
    const double growth = log(hypot(across, along) / square), turn = atan2(across, along);
    return hypot(growth - real, turn - imaginary) / hypot(real, imaginary);
}

static void test_accurate(void **state)
{
    (void)state;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int way = 0; way <= 8; ++way) {
            const double angle = acos(-1.0) * (1 - way / 16.0), x = cos(angle), y = way ? sin(angle) : 0;
            for (double size = 0.05; size < 0.2; size *= 1.4)
                assert_true(fabs(measured_error(method, size * x, size * y) - step_error(method, size * x, size * y)) <
                            1e-9);
            const double step = step_accurate(method, x, y, 0.001);
            assert_true(fabs(step_error(method, step * x, step * y) - 0.001) < 1e-9);
            assert_true(step < step_accurate(method, x, y, 0.01));
        }
    /* orders: the error of a short step is |z|^order times a constant, 3/8 of AB3 and 1/120 of RK4 */
    assert_true(fabs(step_error(GIC_AB3, -0.01, 0) / 1e-6 * 8 / 3 - 1) < 0.05);
    assert_true(fabs(step_error(GIC_RK4, 0, 0.05) / pow(0.05, 4) * 120 - 1) < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_measured), cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_alike), cmocka_unit_test(test_stable),
                                       cmocka_unit_test(test_accurate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
