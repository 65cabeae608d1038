/* SPDX-License-Identifier: MIT
 * The runtime core against exact solutions, independent formulas in long double and bit comparisons. Made to be built
 * three ways: plain, with -DGIC_FLOAT, and with -ffast-math. */
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
#define ORDER_TOLERANCE 0.25 /* rounding shows beside the fourth-order error */
#else
#define EPSILON DBL_EPSILON
#define ORDER_TOLERANCE 0.1
#endif

/* ---- a hand-made model: x'' = -x + u + t with the input u = cos 2t -------------------------------------- */

enum { N = 2 };

typedef struct Probe {
    gic_head head;
    gic_real state[N], rate[N], history[2 * N], input[1], scratch[GIC_SCRATCH(N, 1)];
    int fail_at;   /* evaluation of the step that fails, from 0; -1: none */
    int poison_at; /* evaluation whose rate is not a number, from 0; -1: none */
    int settle_status;
    int refuse_at; /* evaluation that refuses an input, from 1; 0: none */
    int looks;     /* 1: evaluations refuse states that are none, as generated code does */
    int evaluation;
} Probe;

static gic_real not_a_number(void)
{
    gic_real x;
    memset(&x, 0xff, sizeof x);
    return x;
}

static int probe_rhs(void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    Probe *probe = self;
    ++probe->head.rhs_count;
    const int evaluation = probe->evaluation++;
    if ((probe->looks && !gic_bounded(state, N)) || evaluation + 1 == probe->refuse_at)
        return GIC_ERROR_INPUT;
    rate[0] = state[1];
    rate[1] = -state[0] + probe->input[0] + time;
    if (evaluation == probe->poison_at)
        rate[1] = not_a_number();
    if (evaluation == probe->fail_at) {
        probe->head.subset = 3;
        return GIC_ERROR_NEWTON;
    }
    return GIC_OK;
}

static int probe_settle(void *self, gic_real *state)
{
    return gic_bounded(state, N) ? ((Probe *)self)->settle_status : GIC_ERROR_INPUT;
}

static void cosine_input(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user;
    (void)lane;
    input[0] = (gic_real)cos(2 * (double)time);
}

static double exact(double t, int i)
{
    return i == 0 ? cos(t) - cos(2 * t) / 3 + t : -sin(t) + 2 * sin(2 * t) / 3 + 1;
}

static const gic_model probe_model = {
    .abi_version = GIC_ABI_VERSION,
    .real_size = sizeof(gic_real),
    .size = sizeof(Probe),
    .slow_count = N,
    .input_count = 1,
    .state_offset = offsetof(Probe, state),
    .rate_offset = offsetof(Probe, rate),
    .history_offset = offsetof(Probe, history),
    .scratch_offset = offsetof(Probe, scratch),
    .input_offset = offsetof(Probe, input),
    .rhs = probe_rhs,
    .settle = probe_settle,
};

static Probe probe_new(void)
{
    Probe probe;
    memset(&probe, 0, sizeof probe);
    for (int i = 0; i < N; ++i)
        probe.state[i] = (gic_real)exact(0, i);
    probe.fail_at = probe.poison_at = -1;
    probe.head.input_function = cosine_input;
    probe.input[0] = (gic_real)0.125;
    return probe;
}

static int probe_step(Probe *probe, double step, int32_t method)
{
    probe->evaluation = 0;
    return gic_step(&probe_model, probe, (gic_real)step, method);
}

/* ---- integrators ---------------------------------------------------------------------------------------- */

static double error_at(int32_t method, int steps)
{
    const double end = 3;
    Probe probe = probe_new();
    for (int k = 0; k < steps; ++k)
        assert_int_equal(probe_step(&probe, end / steps, method), GIC_OK);
    return hypot((double)probe.state[0] - exact(end, 0), (double)probe.state[1] - exact(end, 1));
}

static void test_order(void **unused)
{
    (void)unused;
#ifdef GIC_FLOAT
    const int ab3_steps = 60, rk4_steps = 8;
#else
    const int ab3_steps = 600, rk4_steps = 100;
#endif
    const double ab3 = log2(error_at(GIC_AB3, ab3_steps) / error_at(GIC_AB3, 2 * ab3_steps));
    const double rk4 = log2(error_at(GIC_RK4, rk4_steps) / error_at(GIC_RK4, 2 * rk4_steps));
    assert_true(fabs(ab3 - 3) < ORDER_TOLERANCE);
    assert_true(fabs(rk4 - 4) < ORDER_TOLERANCE);
}

static void test_ab3_starts_with_rk4(void **unused)
{
    (void)unused;
    Probe a = probe_new(), b = probe_new();
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(probe_step(&a, 0.01, GIC_AB3), GIC_OK);
        assert_int_equal(a.evaluation, k < 2 ? 4 : 1);
        assert_int_equal(a.head.history, k < 1 ? 1 : 2);
        assert_int_equal(probe_step(&b, 0.01, GIC_RK4), GIC_OK);
        assert_int_equal(b.head.history, 0);
        assert_int_equal(memcmp(a.state, b.state, sizeof a.state) == 0, k < 2);
    }
}

/* rate[] belongs to the start of the last step, input[] to its end. */
static void test_rate_and_input(void **unused)
{
    (void)unused;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method) {
        Probe probe = probe_new();
        for (int k = 0; k < 5; ++k) {
            const double before = (double)probe.state[0], velocity = (double)probe.state[1];
            const double t = (double)gic_time(&probe);
            assert_int_equal(probe_step(&probe, 0.25, method), GIC_OK);
            assert_true((double)probe.rate[0] == velocity);
            assert_true(fabs((double)probe.rate[1] - (-before + cos(2 * t) + t)) < 8 * EPSILON);
            assert_true(fabs((double)probe.input[0] - cos(2 * (t + 0.25))) < 8 * EPSILON);
        }
    }
}

static void assert_same(const Probe *a, const Probe *b)
{
    assert_memory_equal(a->state, b->state, sizeof a->state);
    assert_memory_equal(a->rate, b->rate, sizeof a->rate);
    assert_memory_equal(a->history, b->history, sizeof a->history);
    assert_memory_equal(a->input, b->input, sizeof a->input);
    assert_memory_equal(&a->head.start_time, &b->head.start_time, sizeof a->head.start_time);
    assert_memory_equal(&a->head.step, &b->head.step, sizeof a->head.step);
    assert_int_equal(a->head.steps, b->head.steps);
    assert_int_equal(a->head.method, b->head.method);
    assert_int_equal(a->head.history, b->head.history);
}

/* Whatever fails in a step, and whichever step it is, the instance stays as it was and can go on. */
static void test_failure_changes_nothing(void **unused)
{
    (void)unused;
    for (int32_t method = GIC_AB3; method <= GIC_RK4; ++method)
        for (int before = 0; before < 5; ++before)
            for (int fault = 0; fault < 10; ++fault) {
                Probe probe = probe_new();
                for (int k = 0; k < before; ++k)
                    assert_int_equal(probe_step(&probe, 0.01, method), GIC_OK);
                const Probe good = probe;
                int expected = GIC_ERROR_NEWTON, evaluations = method == GIC_AB3 && before >= 2 ? 1 : 4;
                /* a poisoned middle stage spoils the next rate as well, so every one of them is seen */
                if (fault < 4) {
                    probe.fail_at = fault;
                } else if (fault < 8) {
                    probe.poison_at = fault - 4;
                    expected = GIC_ERROR_UNSTABLE;
                } else if (fault == 8) {
                    probe.settle_status = expected = GIC_ERROR_ORIENTATION;
                }
                const int hit = fault == 8 || (fault < 8 && fault % 4 < evaluations);
                const double step = fault == 9 ? 0.02 : 0.01; /* 9: a failure while the step changes */
                if (fault == 9)
                    probe.fail_at = 0;
                assert_int_equal(probe_step(&probe, step, method), hit || fault == 9 ? expected : GIC_OK);
                if (!hit && fault != 9)
                    continue;
                assert_same(&probe, &good);
                assert_int_equal(probe.head.status, expected);
                assert_int_equal(probe.head.subset, expected == GIC_ERROR_NEWTON ? 3 : -1);
                assert_true((probe.head.grown >= 0) == (expected == GIC_ERROR_UNSTABLE));

                Probe undisturbed = good;
                probe.fail_at = probe.poison_at = -1;
                probe.settle_status = GIC_OK;
                for (int k = 0; k < 4; ++k) {
                    assert_int_equal(probe_step(&probe, 0.01, method), GIC_OK);
                    assert_int_equal(probe_step(&undisturbed, 0.01, method), GIC_OK);
                }
                assert_same(&probe, &undisturbed);
                assert_int_equal(probe.head.subset, -1);
            }
}

/* A state that RK4 itself made in the middle of a step is named, an input that is none is not laid to the step. */
static void test_failure_within_step(void **unused)
{
    (void)unused;
    for (int fault = 0; fault < 4; ++fault)
        for (int what = 0; what < 2; ++what) {
            Probe probe = probe_new();
            assert_int_equal(probe_step(&probe, 0.01, GIC_RK4), GIC_OK);
            const Probe good = probe;
            probe.looks = 1;
            probe.poison_at = what ? fault : -1;
            probe.refuse_at = what ? 0 : fault + 1;
            const int expected = what ? GIC_ERROR_UNSTABLE : GIC_ERROR_INPUT;
            assert_int_equal(probe_step(&probe, 0.01, GIC_RK4), expected);
            assert_int_equal(probe.head.status, expected);
            assert_int_equal(probe.head.grown, what ? 1 : -1);
            assert_same(&probe, &good);
            probe.poison_at = -1;
            probe.refuse_at = 0;
            assert_int_equal(probe_step(&probe, 0.01, GIC_RK4), GIC_OK);
            assert_int_equal(probe.head.grown, -1);
        }
}

static void test_snapshot(void **unused)
{
    (void)unused;
    Probe probe = probe_new();
    for (int k = 0; k < 7; ++k)
        probe_step(&probe, 0.01, GIC_AB3);
    Probe copy;
    memcpy(&copy, &probe, sizeof copy);
    for (int k = 0; k < 50; ++k)
        probe_step(&probe, 0.01, GIC_AB3);
    const Probe first = probe;
    memcpy(&probe, &copy, sizeof copy);
    for (int k = 0; k < 50; ++k) {
        probe_step(&probe, 0.01, GIC_AB3);
        probe_step(&copy, 0.01, GIC_AB3);
    }
    assert_same(&first, &probe);
    assert_same(&first, &copy);
}

static void test_time(void **unused)
{
    (void)unused;
    Probe probe = probe_new();
    /* an hour: the step, its multiple and the sum are rounded once each, however many steps there are */
    const int hour = 3600;
    for (int k = 0; k < 1000 * hour; ++k)
        probe_step(&probe, 0.001, GIC_AB3);
    assert_int_equal(probe.head.steps, 1000 * hour);
    assert_true(fabs((double)gic_time(&probe) - hour) <= hour * 1.5 * EPSILON);

    /* a new step: time goes on from where it is, the history starts again */
    const gic_real now = gic_time(&probe);
    assert_int_equal(probe_step(&probe, 0.5, GIC_AB3), GIC_OK);
    assert_true(probe.head.start_time == now && probe.head.steps == 1 && probe.head.history == 1);
    assert_true(fabs((double)gic_time(&probe) - (double)now - 0.5) <= hour * EPSILON);
    probe_step(&probe, 0.5, GIC_AB3);
    assert_int_equal(probe.head.history, 2);
    probe_step(&probe, 0.5, GIC_RK4);
    assert_true(probe.head.history == 0 && probe.head.steps == 1);

    gic_restart(&probe, GIC_R(-2.0));
    assert_true(gic_time(&probe) == GIC_R(-2.0) && probe.head.history == 0);
    probe_step(&probe, 0.5, GIC_RK4);
    assert_true(gic_time(&probe) == GIC_R(-1.5));
}

static void test_arguments(void **unused)
{
    (void)unused;
    const double bad[] = {0, -0.01, 1e-30, INFINITY, -INFINITY};
    Probe probe = probe_new();
    probe_step(&probe, 1, GIC_RK4);
    const Probe good = probe;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
#ifdef __FAST_MATH__
        if (bad[i] > 0 && bad[i] < 1) /* time + step <= time is reduced to step <= 0 there */
            continue;
#endif
        assert_int_equal(probe_step(&probe, bad[i], GIC_AB3), GIC_ERROR_ARGUMENT);
        assert_same(&probe, &good);
    }
    assert_int_equal(gic_step(&probe_model, &probe, not_a_number(), GIC_AB3), GIC_ERROR_ARGUMENT);
    assert_int_equal(probe_step(&probe, 0.01, 2), GIC_ERROR_ARGUMENT);
    assert_int_equal(probe_step(&probe, 0.01, -1), GIC_ERROR_ARGUMENT);
    assert_same(&probe, &good);

    gic_model other = probe_model;
    other.abi_version = GIC_ABI_VERSION + 1;
    assert_int_equal(gic_step(&other, &probe, GIC_R(0.01), GIC_AB3), GIC_ERROR_ABI);
    other = probe_model;
    other.real_size = 12 - (uint32_t)sizeof(gic_real); /* the other one of 4 and 8 */
    assert_int_equal(gic_step(&other, &probe, GIC_R(0.01), GIC_AB3), GIC_ERROR_ABI);
    assert_same(&probe, &good);
}

/* ---- numbers and texts ---------------------------------------------------------------------------------- */

static void test_finite(void **unused)
{
    (void)unused;
#ifdef GIC_FLOAT
    const uint32_t good[] = {0, 0x80000000, 1, 0x007fffff, 0x7f7fffff, 0xff7fffff, 0x3f800000};
    const uint32_t bad[] = {0x7f800000, 0xff800000, 0x7f800001, 0x7fc00000, 0xffffffff};
#else
    const uint64_t good[] = {0, 0x8000000000000000, 1, 0x000fffffffffffff, 0x7fefffffffffffff, 0xffefffffffffffff};
    const uint64_t bad[] = {0x7ff0000000000000, 0xfff0000000000000, 0x7ff0000000000001, 0x7ff8000000000000, UINT64_MAX};
#endif
    gic_real x[8];
    memcpy(x, good, sizeof good);
    const int32_t count = (int32_t)(sizeof good / sizeof *good);
    assert_true(gic_finite(x, count) && GIC_FINITE(x, count));
    assert_true(gic_finite(x, 0) && GIC_FINITE(x, 0));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        for (int32_t place = 0; place < count; ++place) {
            memcpy(x, good, sizeof good);
            memcpy(&x[place], &bad[i], sizeof *x);
            assert_false(gic_finite(x, count) || GIC_FINITE(x, count));
            assert_true(gic_finite(x, place) && GIC_FINITE(x, place));
            assert_true(gic_alike(x, x, count)); /* NaN, too: bit for bit */
        }
}

/* Numbers of a state are below 2^30, or 2^20. */
static void test_bounded(void **unused)
{
    (void)unused;
    const gic_real bound = (gic_real)(sizeof(gic_real) == 8 ? 0x1p30 : 0x1p20);
    const gic_real below = bound * (1 - (gic_real)EPSILON);
    const gic_real good[] = {0, 1, below, -below, (gic_real)1e-30};
    const gic_real bad[] = {bound, -bound, 2 * bound, bound * bound};
    assert_true(gic_bounded(good, 5) && GIC_BOUNDED(good, 5));
    for (int i = 0; i < 4; ++i)
        assert_false(gic_bounded(&bad[i], 1) || GIC_BOUNDED(&bad[i], 1));
}

/* One bit anywhere makes numbers different: the sign of zero, the last one of the mantissa. */
static void test_alike(void **unused)
{
    (void)unused;
    enum { COUNT = 5 };
    const gic_real x[COUNT] = {0, 1, -1, (gic_real)1e-30, (gic_real)1e30};
    assert_true(gic_alike(x, x, 0));
    for (int place = 0; place < COUNT; ++place)
        for (size_t bit = 0; bit < 8 * sizeof(gic_real); ++bit) {
            gic_real y[COUNT];
            unsigned char byte;
            memcpy(y, x, sizeof y);
            assert_true(gic_alike(x, y, COUNT));
            memcpy(&byte, (char *)&y[place] + bit / 8, 1);
            byte = (unsigned char)(byte ^ 1u << bit % 8);
            memcpy((char *)&y[place] + bit / 8, &byte, 1);
            assert_false(gic_alike(x, y, COUNT));
            assert_true(gic_alike(x, y, place));
        }
}

/* An angle's change is the same but for whole turns, and no more than half of one. */
static void test_unwound(void **unused)
{
    (void)unused;
    const gic_real turn = GIC_R(6.283185307179586);
    const gic_real small[] = {0, 1, -1, 3, -3, (gic_real)1e-30};
    for (int i = 0; i < 6; ++i)
        assert_true(gic_unwound(small[i]) == small[i]);
    /* (change - turns 2 pi): roundings of the change and of 2 pi, once a turn */
    for (int turns = -5000; turns <= 5000; turns += 500)
        for (int i = 0; i < 6; ++i)
            assert_true(fabs((double)(gic_unwound(small[i] + (gic_real)turns * turn) - small[i])) <=
                        2 * fabs(turns * 6.3) * (double)EPSILON);
    for (gic_real change = -100; change < 100; change += GIC_R(0.01))
        assert_true(fabs((double)gic_unwound(change)) < 3.1415927 + 100 * (double)EPSILON);
    /* what lies between two states is turned back; what is no angle of any state stays what it is */
    const gic_real bound = (gic_real)(sizeof(gic_real) == 8 ? 0x1p30 : 0x1p20);
    assert_true(fabs((double)gic_unwound(GIC_R(1.9) * bound)) < 4);
    assert_true(gic_unwound(2 * bound) == 2 * bound);
#ifndef __FAST_MATH__ /* which promises that there are no infinities */
    assert_true(gic_unwound((gic_real)-INFINITY) == (gic_real)-INFINITY);
#endif
}

/* What is to blame for a step that fails: 2 coordinates of a free base, the second of which is driven. */
static void test_blame(void **unused)
{
    (void)unused;
    static const gic_real low[] = {0, 0}, high[] = {GIC_R(0.4), GIC_R(1e-6)};
    static const int32_t place[] = {7, -1};
    static const gic_signal signal[] = {{"spring", "m"}, {"rack", "m"}};
    const gic_model model = {.free_base = 1,
                             .slow_count = 15,
                             .coordinate_count = 2,
                             .coordinate = signal,
                             .coordinate_low = low,
                             .coordinate_high = high,
                             .coordinate_state = place};
    const struct {
        int at; /* of the rate */
        double value;
        int grown; /* -1: nothing */
    } trial[] = {{7, 9, -1},  {7, -11, 7},  {14, 900, -1}, {14, -1100, 7}, {0, 1e6, -1},
                 {5, 49, -1}, {5, -51, 12}, {3, 1e3, -1},  {8, 1e6, -1},   {11, 1e6, -1}};
    for (size_t i = 0; i < sizeof trial / sizeof *trial; ++i) {
        gic_real rate[15] = {0};
        int32_t grown = -1;
        rate[trial[i].at] = (gic_real)trial[i].value;
        const int expected = trial[i].grown < 0 ? GIC_ERROR_NEWTON : GIC_ERROR_UNSTABLE;
        assert_int_equal(gic_blame(&model, GIC_R(0.01), rate, GIC_ERROR_NEWTON, &grown), expected);
        assert_int_equal(grown, trial[i].grown);
        grown = -1;
        assert_int_equal(gic_blame(&model, GIC_R(0.01), rate, GIC_ERROR_ROAD, &grown), GIC_ERROR_ROAD);
        assert_int_equal(grown, -1);
    }
}

static void test_status_text(void **unused)
{
    (void)unused;
    assert_string_equal(gic_status_text(0), "ok");
    for (int a = GIC_STATUS_LAST; a <= 0; ++a)
        for (int b = GIC_STATUS_LAST; b < a; ++b)
            assert_string_not_equal(gic_status_text(a), gic_status_text(b));
    assert_non_null(gic_status_text(1));
    assert_string_equal(gic_status_text(GIC_STATUS_LAST - 1), gic_status_text(1));
}

/* ---- orientation ---------------------------------------------------------------------------------------- */

static void test_orientation(void **unused)
{
    (void)unused;
    int64_t switches = 0;
    int32_t dependent = -1;
    gic_real e[4];
    const gic_real first[4] = {GIC_R(0.0), GIC_R(-0.6), GIC_R(0.0), GIC_R(0.8)};
    assert_int_equal(gic_orientation(first, &dependent, &switches, e), GIC_OK);
    assert_true(dependent == 3 && switches == 0);

    /* the dependent one is recovered with its sign, whatever small error it was given with; the others stay */
    for (int k = 0; k < 4; ++k)
        for (int sign = -1; sign <= 1; sign += 2) {
            gic_real given[4] = {GIC_R(0.1), GIC_R(-0.2), GIC_R(0.3), GIC_R(-0.1)}, kept[4];
            long double rest = 1;
            for (int i = 0; i < 4; ++i)
                rest -= i == k ? 0 : (long double)given[i] * (long double)given[i];
            given[k] = (gic_real)(1.002L * (long double)sign * sqrtl(rest));
            memcpy(kept, given, sizeof kept);
            dependent = -1;
            assert_int_equal(gic_orientation(given, &dependent, &switches, e), GIC_OK);
            assert_int_equal(dependent, k);
            assert_true(fabsl((long double)e[k] - (long double)sign * sqrtl(rest)) < 2 * (long double)EPSILON);
            for (int i = 0; i < 4; ++i)
                assert_true(i == k || e[i] == kept[i]);
        }

    /* two turns of yaw: e0 and e3 take turns, four times; recovered values never jump */
    dependent = 0;
    switches = 0;
    for (int i = 0; i <= 4000; ++i) {
        const double half = i * 6.283185307179586 / 4000;
        const gic_real given[4] = {(gic_real)cos(half), 0, 0, (gic_real)sin(half)};
        assert_int_equal(gic_orientation(given, &dependent, &switches, e), GIC_OK);
        for (int k = 0; k < 4; ++k)
            assert_true(fabs((double)e[k] - (double)given[k]) < 4 * EPSILON);
        assert_true(fabs((double)e[dependent]) > 0.45);
    }
    assert_int_equal(switches, 4);

    /* hysteresis: trembling about equal magnitudes changes nothing */
    dependent = 0;
    switches = 0;
    for (int i = 0; i < 100; ++i) {
        const double half = 0.7853981633974483 + (i % 2 ? 0.02 : -0.02);
        const gic_real given[4] = {(gic_real)cos(half), 0, 0, (gic_real)sin(half)};
        assert_int_equal(gic_orientation(given, &dependent, &switches, e), GIC_OK);
    }
    assert_true(switches == 0 && dependent == 0);

    const gic_real longer[4] = {GIC_R(1.01), 0, 0, 0}, shorter[4] = {GIC_R(0.99), 0, 0, 0}, zero[4] = {0, 0, 0, 0};
    const gic_real broken[4] = {GIC_R(1.0), not_a_number(), 0, 0};
    assert_int_equal(gic_orientation(longer, &dependent, &switches, e), GIC_ERROR_ORIENTATION);
    assert_int_equal(gic_orientation(shorter, &dependent, &switches, e), GIC_ERROR_ORIENTATION);
    assert_int_equal(gic_orientation(zero, &dependent, &switches, e), GIC_ERROR_ORIENTATION);
    assert_int_equal(gic_orientation(broken, &dependent, &switches, e), GIC_ERROR_ORIENTATION);
}

/* ---- inputs --------------------------------------------------------------------------------------------- */

static void test_quintic(void **unused)
{
    (void)unused;
    const double t0 = 0.5, t1 = 2.5, y0 = -1, y1 = 3;
    gic_real out[3], beside[3];
    for (int i = 0; i <= 300; ++i) {
        const double t = i / 100.0, s = fmin(fmax((t - t0) / (t1 - t0), 0), 1), d = 1e-2;
        gic_quintic((gic_real)t, (gic_real)t0, (gic_real)t1, (gic_real)y0, (gic_real)y1, out);
        const double expected = y0 + (y1 - y0) * (10 * pow(s, 3) - 15 * pow(s, 4) + 6 * pow(s, 5));
        assert_true(fabs((double)out[0] - expected) < 100 * EPSILON);
        double value[2], rate[2];
        for (int side = 0; side < 2; ++side) {
            const double near = t + (side ? d : -d);
            gic_quintic((gic_real)near, (gic_real)t0, (gic_real)t1, (gic_real)y0, (gic_real)y1, beside);
            value[side] = (double)beside[0];
            rate[side] = (double)beside[1];
            assert_true(fabs((double)beside[2] - (double)out[2]) < 0.7); /* largest third derivative is 60 * 4 / 2^3 */
        }
        assert_true(fabs((double)out[1] - (value[1] - value[0]) / (2 * d)) < 2e-3);
        assert_true(fabs((double)out[2] - (rate[1] - rate[0]) / (2 * d)) < 0.16); /* its derivative jumps at the ends */
    }
    for (int side = 0; side < 2; ++side) { /* at rest at both ends, from outside and from inside */
        const double end = side ? t1 : t0, inside = side ? -1e-4 : 1e-4, d[2] = {-inside, inside};
        for (int k = 0; k < 2; ++k) {
            gic_quintic((gic_real)(end + d[k]), (gic_real)t0, (gic_real)t1, (gic_real)y0, (gic_real)y1, out);
            assert_true(fabs((double)out[0] - (side ? y1 : y0)) < 1e-9 + 8 * EPSILON);
            assert_true(fabs((double)out[1]) < 1e-6);
            assert_true(fabs((double)out[2]) < 4e-3);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_ab3_starts_with_rk4),
        cmocka_unit_test(test_rate_and_input),
        cmocka_unit_test(test_failure_changes_nothing),
        cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_time),
        cmocka_unit_test(test_arguments),
        cmocka_unit_test(test_finite),
        cmocka_unit_test(test_failure_within_step),
        cmocka_unit_test(test_bounded),
        cmocka_unit_test(test_unwound),
        cmocka_unit_test(test_alike),
        cmocka_unit_test(test_blame),
        cmocka_unit_test(test_status_text),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_quintic),
    };
    return cmocka_run_group_tests_name("runtime", tests, NULL, NULL);
}
