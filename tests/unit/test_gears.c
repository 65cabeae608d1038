/* SPDX-License-Identifier: MIT
 * Changes of gear within steps: the runtime core on a hand-made model, against sums over its pieces in long double.
 * Made to be built plain and with -DGIC_FLOAT. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>

#include "gic_runtime.h"

#ifdef GIC_FLOAT
#define EPSILON ((double)FLT_EPSILON)
#else
#define EPSILON DBL_EPSILON
#endif

/* ---- a hand-made model: x' = w - t^2 / 8, w' = u + g % 5 - 2, age' = 1 ----------------------------------
 *
 * The gear g grows by 1 where age reaches `period`. Between changes x is a parabola, which all formulas integrate
 * without an error, so that what is left comes from changes. */

enum { SLOW = 1, FAST = 2, N = SLOW + FAST, LINKS = 1 };

typedef struct Probe {
    gic_head head;
    gic_real state[N], rate[N], history[GIC_HISTORY(N, FAST)], input[1], link[5 * LINKS], scratch[GIC_SCRATCH(N, 1)];
    int32_t gear;
    gic_real period;
    int32_t fails; /* gear in which evaluations fail; 0: none */
} Probe;

static double slope(int32_t gear)
{
    return (double)(gear % 5 - 2);
}

static int probe_fast(void *self, gic_real time, const gic_real *link, const gic_real *fast, gic_real *rate)
{
    const Probe *probe = self;
    (void)time;
    (void)link;
    (void)fast;
    rate[0] = probe->input[0] + (gic_real)slope(probe->gear);
    rate[1] = GIC_R(1.0);
    return probe->fails && probe->fails == probe->gear ? GIC_ERROR_NEWTON : GIC_OK;
}

static int probe_rhs(void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    ++((Probe *)self)->head.rhs_count;
    rate[0] = state[1] - GIC_R(0.125) * time * time;
    return probe_fast(self, time, NULL, state + SLOW, rate + SLOW);
}

static int probe_link(void *self, gic_real time, const gic_real *slow, gic_real *link)
{
    (void)self;
    (void)time;
    link[0] = slow[0];
    return GIC_OK;
}

static int probe_settle(void *self, gic_real *state)
{
    (void)self;
    return gic_bounded(state, N) ? GIC_OK : GIC_ERROR_INPUT;
}

static int probe_shift(void *self)
{
    Probe *probe = self;
    if (!gic_reached(probe->state[2], probe->period))
        return 0;
    ++probe->gear;
    probe->state[2] = GIC_R(0.0);
    return 1;
}

static const gic_signal probe_discrete[] = {{"gear", "1"}};

static const gic_model probe_model = {
    .abi_version = GIC_ABI_VERSION,
    .real_size = sizeof(gic_real),
    .size = sizeof(Probe),
    .slow_count = SLOW,
    .fast_count = FAST,
    .discrete_count = 1,
    .discrete = probe_discrete,
    .input_count = 1,
    .link_count = LINKS,
    .state_offset = offsetof(Probe, state),
    .rate_offset = offsetof(Probe, rate),
    .history_offset = offsetof(Probe, history),
    .scratch_offset = offsetof(Probe, scratch),
    .discrete_offset = offsetof(Probe, gear),
    .input_offset = offsetof(Probe, input),
    .link_offset = offsetof(Probe, link),
    .rhs = probe_rhs,
    .settle = probe_settle,
    .link = probe_link,
    .fast = probe_fast,
    .shift = probe_shift,
};

static void ramp(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user;
    (void)lane;
    input[0] = GIC_R(0.25) * time;
}

static Probe probe_new(double period)
{
    Probe probe;
    memset(&probe, 0, sizeof probe);
    probe.period = (gic_real)period;
    probe.head.input_function = ramp;
    return probe;
}

/* ratio 0: RK4 at one rate */
static int probe_step(Probe *probe, double step, int32_t ratio)
{
    return ratio ? gic_step_dual(&probe_model, probe, (gic_real)step, ratio)
                 : gic_step(&probe_model, probe, (gic_real)step, GIC_RK4);
}

/* x and w at a time, from piece to piece: u = t / 4 gives t^2 / 8, which x' leaves out. By the rule a time is reached
 * from 1 - d of it on. */
static int32_t exact(const Probe *probe, double time, double *x, double *w)
{
    const long double period = (long double)probe->period * (1 - (long double)GIC_LIMIT_ROUNDING);
    long double place = 0, speed = 0, at = 0;
    int32_t gear = 0;
    for (;; ++gear) {
        const long double piece = fminl(period, time - at);
        place += speed * piece + slope(gear) * piece * piece / 2;
        speed += slope(gear) * piece;
        if (piece < period)
            break;
        at += period;
    }
    *x = (double)place;
    *w = (double)(speed + (long double)time * time / 8);
    return gear;
}

/* The instance is where the sum over pieces is. Rounding may have put a change beside the time itself. */
static void assert_exact(const Probe *probe, double rounding)
{
    double x, w;
    const double time = (double)gic_time(probe);
    const int32_t gear = exact(probe, time, &x, &w);
    if (gear != probe->gear) {
        double before, behind;
        assert_true(exact(probe, time - rounding, &before, &before) <= probe->gear);
        assert_true(exact(probe, time + rounding, &behind, &behind) >= probe->gear);
    }
    assert_true(fabs((double)probe->state[0] - x) <= rounding * (1 + fabs(x)));
    assert_true(fabs((double)probe->state[1] - w) <= rounding * (1 + fabs(w)));
}

/* ---- tests ---------------------------------------------------------------------------------------------- */

static uint64_t random_state = 1;

static double uniform(double low, double high)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(random_state >> 11) / 9007199254740992.0;
}

/* From less than one change in ten steps to 30 in one, all in the step where they are due. */
static void test_none_lost(void **unused)
{
    (void)unused;
#ifdef GIC_FLOAT
    const int sequences = 200;
    const int32_t longest = 100; /* changes; rounding of ages adds up */
    const double rounding = 2e-3;
#else
    const int sequences = 20000; /* more than a million changes */
    const int32_t longest = 100;
    const double rounding = 1e-11;
#endif
    int64_t changes = 0;
    for (int k = 0; k < sequences; ++k) {
        const double step = 0.01, period = step * exp(uniform(log(1.0 / 30), log(10)));
        const int32_t ratio = k % 4 == 3 ? 0 : k % 4 == 2 ? 5 : k % 4 + 1;
        Probe probe = probe_new(period);
        while (probe.gear < longest && probe.head.steps < 200) {
            assert_int_equal(probe_step(&probe, step, ratio), GIC_OK);
            assert_exact(&probe, rounding);
        }
        changes += probe.gear;
    }
    assert_true(changes > 50 * sequences);
}

/* Numbers as people write them: periods that are parts and multiples of the step. A change that is due at the end of a
 * step happens in the step that ends there. */
static void test_nice_numbers(void **unused)
{
    (void)unused;
    for (int32_t ratio = 0; ratio <= 6; ++ratio)
        for (int parts = 1; parts <= 5; ++parts)
            for (int whole = 1; whole <= 5; ++whole) {
                Probe probe = probe_new(0.01 * whole / parts);
                for (int k = 1; k <= 60; ++k) {
                    assert_int_equal(probe_step(&probe, 0.01, ratio), GIC_OK);
                    assert_int_equal(probe.gear, k * parts / whole);
                }
            }
}

/* More changes than a step follows are refused, and nothing has changed; as many as that are not. */
static void test_bound(void **unused)
{
    (void)unused;
    for (int32_t ratio = 0; ratio <= 6; ratio += 3)
        for (int before = 0; before < 4; ++before) {
            Probe probe = probe_new(100);
            for (int k = 0; k < before; ++k)
                assert_int_equal(probe_step(&probe, 0.01, ratio), GIC_OK);
            probe.state[2] = GIC_R(0.0);
            probe.period = GIC_R(0.01) / (GIC_R(0.5) + GIC_CHANGES + 1);
            const Probe good = probe;
            assert_int_equal(probe_step(&probe, 0.01, ratio), GIC_ERROR_EVENTS);
            assert_int_equal(probe.head.status, GIC_ERROR_EVENTS);
            assert_string_equal(gic_event_name(&probe_model, &probe), "gear");
            assert_memory_equal(probe.state, good.state, sizeof good.state);
            assert_memory_equal(probe.input, good.input, sizeof good.input);
            assert_int_equal(probe.gear, good.gear);
            assert_true(gic_time(&probe) == gic_time(&good));
            /* it can go on */
            assert_int_equal(probe_step(&probe, 0.005, ratio), GIC_OK);
            assert_int_equal(probe.gear, (GIC_CHANGES + 1) / 2);
            probe = good;
            probe.period = GIC_R(0.01) / (GIC_R(0.5) + GIC_CHANGES);
            assert_int_equal(probe_step(&probe, 0.01, ratio), GIC_OK);
            assert_int_equal(probe.gear, GIC_CHANGES);
        }
}

/* Evaluations that fail in the new gear fail the step. */
static void test_failure(void **unused)
{
    (void)unused;
    for (int32_t ratio = 0; ratio <= 6; ratio += 3)
        for (int32_t fails = 1; fails <= 3; ++fails) {
            Probe probe = probe_new(0.015);
            probe.fails = fails;
            Probe good = probe;
            int status = GIC_OK;
            for (int k = 0; k < 10 && status == GIC_OK; ++k) {
                good = probe;
                status = probe_step(&probe, 0.01, ratio);
            }
            assert_int_equal(status, GIC_ERROR_NEWTON);
            assert_int_equal(probe.gear, fails - 1);
            assert_memory_equal(probe.state, good.state, sizeof good.state);
            assert_memory_equal(probe.input, good.input, sizeof good.input);
            assert_memory_equal(probe.rate, good.rate, sizeof good.rate);
            assert_memory_equal(probe.history, good.history, sizeof good.history);
            assert_int_equal(probe.head.history, good.head.history);
            assert_true(gic_time(&probe) == gic_time(&good));
            probe.fails = 0;
            for (int k = 0; k < 10; ++k)
                assert_int_equal(probe_step(&probe, 0.01, ratio), GIC_OK);
            assert_int_equal(probe.gear, (int32_t)((double)gic_time(&probe) / 0.015 + 0.01));
        }
}

/* A run again, and one from a copy of the instance, are the same to the last bit. */
static void test_repeatable(void **unused)
{
    (void)unused;
    for (int32_t ratio = 0; ratio <= 6; ratio += 3) {
        Probe first = probe_new(0.0237), second = first, copy = first;
        for (int k = 0; k < 50; ++k) {
            assert_int_equal(probe_step(&first, 0.01, ratio), GIC_OK);
            assert_int_equal(probe_step(&second, 0.01, ratio), GIC_OK);
            if (k == 20)
                copy = first;
            if (k > 20)
                assert_int_equal(probe_step(&copy, 0.01, ratio), GIC_OK);
        }
        assert_true(first.gear > 15);
        assert_memory_equal(first.state, second.state, sizeof first.state);
        assert_memory_equal(first.state, copy.state, sizeof first.state);
        assert_int_equal(copy.gear, first.gear);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_none_lost), cmocka_unit_test(test_nice_numbers), cmocka_unit_test(test_bound),
        cmocka_unit_test(test_failure),   cmocka_unit_test(test_repeatable),
    };
    return cmocka_run_group_tests_name("gears", tests, NULL, NULL);
}
