/* SPDX-License-Identifier: MIT
 * stepper.h: Prothero and Robinson's problem by BDF, ends of steps, rates there, restarts and failures by all methods;
 * and the Jacobian that generated code gives BDF against differences of another engine. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "read/read.h"
#include "run/engines.h"
#include "run/stepper.h"
#include "scene/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const int32_t method[] = {METHOD_ADAMS, METHOD_RKCK, METHOD_BDF};

/* y' = lambda (y - cos t) - sin t, y = cos t from there on; and z' = z. */
typedef struct Problem {
    double lambda;
    double wall; /* the rate fails beyond this time */
    int64_t rates, jacobians;
} Problem;

static int problem_rate(void *user, double time, const double *state, double *rate)
{
    Problem *p = user;
    ++p->rates;
    if (time > p->wall)
        return -1;
    rate[0] = p->lambda * (state[0] - cos(time)) - sin(time);
    rate[1] = state[1];
    return 0;
}

static int problem_jacobian(void *user, double time, const double *state, const double *rate, double *matrix)
{
    Problem *p = user;
    (void)time, (void)state, (void)rate;
    ++p->jacobians;
    assert_true(matrix[1] == 0 && matrix[2] == 0);
    matrix[0] = p->lambda;
    matrix[3] = 1;
    return 0;
}

/* The state at 1 s; returns the steps, -1: one failed. */
static int go(int32_t by, Problem *problem, double tolerance, double *state)
{
    const StepperSystem system = {2, problem_rate, problem_jacobian, problem};
    Stepper *stepper = stepper_open(by, &system, tolerance, 1e-4);
    double time = 0, next = 1e-4;
    int steps = 0;
    assert_non_null(stepper);
    state[0] = state[1] = 1;
    while (time < 1 && steps >= 0) {
        const double before = time;
        if (stepper_step(stepper, &time, 1, &next, state)) {
            steps = -1;
            break;
        }
        assert_true(time > before && time <= 1 && next > 0);
        /* rates at both ends: of z they are z */
        const double *rate = stepper_rate(stepper), *there = stepper_rate_there(stepper);
        assert_non_null(rate);
        assert_non_null(there);
        assert_true(fabs(there[1] - state[1]) <= 1e-15 * state[1] && rate[1] < there[1]);
        ++steps;
    }
    assert_true(time == 1 || steps < 0);
    stepper_close(stepper);
    return steps;
}

static void test_stiff(void **unused)
{
    (void)unused;
    for (double lambda = -1; lambda >= -1e9; lambda *= 1e3)
        for (double tolerance = 1e-4; tolerance > 1e-11; tolerance /= 100) {
            Problem problem = {.lambda = lambda, .wall = INFINITY};
            double state[2];
            const int steps = go(METHOD_BDF, &problem, tolerance, state);
            /* stiffness costs nothing, and errors are those of some hundred steps */
            assert_true(steps > 0 && steps < 2000);
            assert_true(fabs(state[0] - cos(1)) < 300 * tolerance);
            assert_true(fabs(state[1] - exp(1)) < 300 * tolerance);
            assert_true(problem.jacobians > 0 && problem.jacobians < problem.rates);
        }
}

static void test_plain(void **unused)
{
    (void)unused;
    for (int m = 0; m < 3; ++m) {
        Problem problem = {.lambda = -1, .wall = INFINITY};
        double state[2];
        assert_true(go(method[m], &problem, 1e-9, state) > 0);
        assert_true(fabs(state[0] - cos(1)) < 3e-7 && fabs(state[1] - exp(1)) < 3e-7);
        assert_true(method[m] == METHOD_BDF || !problem.jacobians);
    }
}

/* A rate that fails from some time on: all methods come near to it and no further, and say so. */
static void test_wall(void **unused)
{
    (void)unused;
    for (int m = 0; m < 3; ++m) {
        Problem problem = {.lambda = -1, .wall = 0.5};
        double state[2];
        assert_int_equal(go(method[m], &problem, 1e-6, state), -1);
        assert_true(state[1] > 1.6 && state[1] < exp(0.5) + 1e-4);
    }
}

/* From another state after a restart: the history is gone. */
static void test_restart(void **unused)
{
    (void)unused;
    for (int m = 0; m < 3; ++m) {
        Problem problem = {.lambda = -1, .wall = INFINITY};
        const StepperSystem system = {2, problem_rate, problem_jacobian, &problem};
        Stepper *stepper = stepper_open(method[m], &system, 1e-9, 1e-4);
        double time = 0, next = 1e-4, state[2] = {1, 1};
        while (time < 0.5)
            assert_int_equal(stepper_step(stepper, &time, 0.5, &next, state), 0);
        state[1] = -2;
        next = 1e-4;
        stepper_restart(stepper);
        while (time < 1)
            assert_int_equal(stepper_step(stepper, &time, 1, &next, state), 0);
        assert_true(fabs(state[1] + 2 * exp(0.5)) < 3e-7 && fabs(state[0] - cos(1)) < 3e-7);
        stepper_close(stepper);
    }
}

/* Generated code's exact Jacobian, and one from differences of the interpreted formulas by 1e-6 on both sides, at a
 * state away from the design. */
static void compare_jacobian(const char *path)
{
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    const Engine *tcc =
        engine_open(pool, "tcc", model, &(EngineOptions){.implicit = true, .exact = true, .quiet = true});
    const Engine *tape = engine_open(pool, "tape", model, &(EngineOptions){.quiet = true});
    const gic_model *code = tcc->code;
    const gic_implicit *implicit = code->implicit;
    gic_head *self = instance_new(pool, tcc), *other = instance_new(pool, tape);
    const int n = code->slow_count + code->fast_count, columns = implicit->columns;
    assert_int_equal(implicit->mass_count, 0);
    assert_int_equal(tape->code->slow_count + tape->code->fast_count, n);
    assert_int_equal(code->setup(self), GIC_OK);
    assert_int_equal(tape->code->setup(other), GIC_OK);
    double *state = instance_array(other, tape->code->state_offset),
           *J = pool_alloc(pool, sizeof *J * (size_t)(n * columns)), *at = pool_alloc(pool, sizeof *at * (size_t)n),
           *above = pool_alloc(pool, sizeof *at * (size_t)n), *below = pool_alloc(pool, sizeof *at * (size_t)n);
    for (int i = 0; i < n; ++i) /* rates and fast states that are 0 at the design, places near it */
        at[i] = state[i] + (i < code->slow_count / 2 + code->free_base ? 1e-4 : 0.01) * sin(1 + 3 * i);
    if (code->free_base)
        memcpy(at + 3, (const double[]){1, 0, 0, 0}, 4 * sizeof *at);
    double *rate = pool_alloc(pool, sizeof *rate * (size_t)n);
    assert_int_equal(code->rhs(self, 0, at, rate), GIC_OK);
    assert_int_equal(implicit->jacobian(self, 0, at, J), GIC_OK);
    for (int j = 0; j < n; ++j) {
        const double was = at[j], h = 1e-6;
        double size = 1;
        at[j] = was + h;
        assert_int_equal(tape->code->rhs(other, 0, at, above), GIC_OK);
        at[j] = was - h;
        assert_int_equal(tape->code->rhs(other, 0, at, below), GIC_OK);
        at[j] = was;
        for (int i = 0; i < n; ++i)
            size = fmax(size, fabs(J[columns * i + j]));
        for (int i = 0; i < n; ++i)
            if (!(fabs((above[i] - below[i]) / (2 * h) - J[columns * i + j]) <= 1e-5 * size))
                fail_msg("%s: derivative of rate %d by state %d is %g, by differences %g", path, i, j,
                         J[columns * i + j], (above[i] - below[i]) / (2 * h));
    }
    engine_close(tcc);
    engine_close(tape);
    pool_free(pool);
}

static void test_jacobian(void **unused)
{
    (void)unused;
    compare_jacobian("models/pendulum.veh");
    compare_jacobian("models/quarter_car.veh");
    compare_jacobian("models/hmmwv.veh");
    compare_jacobian("models/hmmwv14.veh");
    compare_jacobian("models/hatchback.veh");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stiff), cmocka_unit_test(test_plain),
                                       cmocka_unit_test(test_wall), cmocka_unit_test(test_restart),
                                       cmocka_unit_test(test_jacobian)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
