/* SPDX-License-Identifier: MIT
 * Dual rate: gic_step_dual on a hand-made model against the model's equations integrated in long double, and by bit
 * comparisons. Made to be built plain and with -DGIC_FLOAT. */
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
#include "run/variable_step.h"
#include "scene/scene.h"
#ifndef GIC_FLOAT
#endif

#ifdef GIC_FLOAT
#define EPSILON ((double)FLT_EPSILON)
#else
#define EPSILON DBL_EPSILON
#endif

/* ---- a hand-made model: a slow oscillator that carries a fast relaxation and a stiff oscillator -----------
 *
 *     x'' = -x - 0.1 x' + 2 (z0 - x) - z1^3 + u        state 0, 1; state 2 is x^2, which settling recovers
 *     z0' = 40 (x - z0)                                state 3
 *     z1'' = -900 z1 - 20 z1' + 90 (x' + u) + t        state 4, 5
 *
 * with the input u = cos 2t and the links x, x' + u. */

enum { SLOW = 3, FAST = 3, N = SLOW + FAST, LINKS = 2, RATIO = 5 };

typedef enum Call { CALL_RHS, CALL_SETTLE, CALL_LINK, CALL_FAST, CALLS } Call;

typedef struct Probe {
    gic_head head;
    gic_real state[N], rate[N], history[GIC_HISTORY(N, FAST)], input[1], link[5 * LINKS], scratch[GIC_SCRATCH(N, 1)];
    int cubic;                  /* links are a cubic of time and a constant instead */
    int calls[CALLS], all;      /* of the step so far */
    int fail_at, poison_at;     /* call of the step, from 0, that fails or gives what is no number; -1: none */
    gic_real at[SLOW], at_time; /* where links were evaluated last */
    double missed;              /* largest distance of an interpolated link from the cubic */
    double late;                /* largest distance of a time from what it should be */
    int surprised;              /* right-hand sides at the start of a step elsewhere than the links before */
} Probe;

static gic_real not_a_number(void)
{
    gic_real x;
    memset(&x, 0xff, sizeof x);
    return x;
}

/* Counts a call; what it gives is in out[0]. */
static int called(Probe *probe, Call call, gic_real *out)
{
    const int number = probe->all++;
    ++probe->calls[call];
    if (number == probe->poison_at)
        out[0] = not_a_number();
    if (number != probe->fail_at)
        return GIC_OK;
    probe->head.subset = 3;
    return GIC_ERROR_NEWTON;
}

static double cubic(double t)
{
    return 1 + t - 2 * t * t + 3 * t * t * t;
}

static void fast_rates(gic_real time, const gic_real *link, const gic_real *z, gic_real *rate)
{
    rate[0] = GIC_R(40.0) * (link[0] - z[0]);
    rate[1] = z[2];
    rate[2] = GIC_R(-900.0) * z[1] - GIC_R(20.0) * z[2] + GIC_R(90.0) * link[1] + time;
}

static void cosine_input(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user;
    (void)lane;
    input[0] = (gic_real)cos(2 * (double)time);
}

static int probe_rhs(void *self, gic_real time, const gic_real *y, gic_real *rate)
{
    Probe *probe = self;
    const gic_real *z = y + SLOW, x = y[0], v = y[1], u = probe->input[0];
    const gic_real link[LINKS] = {x, v + u};
    if (probe->all == 0 && (memcmp(y, probe->at, sizeof probe->at) || time != probe->at_time))
        ++probe->surprised;
    ++probe->head.rhs_count;
    rate[0] = v;
    rate[1] = -x - GIC_R(0.1) * v + GIC_R(2.0) * (z[0] - x) - z[1] * z[1] * z[1] + u;
    rate[2] = GIC_R(2.0) * x * v;
    fast_rates(time, link, z, rate + SLOW);
    return called(probe, CALL_RHS, rate + 1);
}

static int probe_settle(void *self, gic_real *y)
{
    if (!gic_bounded(y, N))
        return GIC_ERROR_INPUT;
    y[2] = y[0] * y[0];
    return called(self, CALL_SETTLE, y);
}

static int probe_link(void *self, gic_real time, const gic_real *slow, gic_real *link)
{
    Probe *probe = self;
    memcpy(probe->at, slow, sizeof probe->at);
    probe->at_time = time;
    link[0] = probe->cubic ? (gic_real)cubic((double)time) : slow[0];
    link[1] = probe->cubic ? GIC_R(0.1) : slow[1] + probe->input[0];
    return called(probe, CALL_LINK, link);
}

static int probe_fast(void *self, gic_real time, const gic_real *link, const gic_real *fast, gic_real *rate)
{
    Probe *probe = self;
    const gic_head *head = &probe->head;
    const double step = (double)(head->step / (gic_real)head->ratio);
    gic_real input;
    cosine_input(NULL, 0, time, &input);
    assert_true(probe->input[0] == input);
    const double steps = (double)(head->steps * head->ratio + probe->calls[CALL_FAST] + 1);
    probe->late = fmax(probe->late, fabs((double)time - steps * step) / (double)time);
    if (probe->cubic) {
        probe->missed = fmax(probe->missed, fabs((double)link[0] - cubic((double)time)));
        assert_true(link[1] == GIC_R(0.1));
        memset(rate, 0, sizeof *rate * FAST);
    } else {
        fast_rates(time, link, fast, rate);
    }
    return called(probe, CALL_FAST, rate);
}

static const gic_model probe_model = {
    .abi_version = GIC_ABI_VERSION,
    .real_size = sizeof(gic_real),
    .size = sizeof(Probe),
    .slow_count = SLOW,
    .fast_count = FAST,
    .input_count = 1,
    .state_offset = offsetof(Probe, state),
    .rate_offset = offsetof(Probe, rate),
    .history_offset = offsetof(Probe, history),
    .scratch_offset = offsetof(Probe, scratch),
    .input_offset = offsetof(Probe, input),
    .rhs = probe_rhs,
    .settle = probe_settle,
    .link_count = LINKS,
    .link_offset = offsetof(Probe, link),
    .link = probe_link,
    .fast = probe_fast,
};

/* Fast states at ease: what moves them otherwise asks for steps to follow it. */
static const double initial[N] = {1, 0, 1, 1, 0.1, 0};

static Probe probe_new(void)
{
    Probe probe;
    memset(&probe, 0, sizeof probe);
    for (int i = 0; i < N; ++i)
        probe.state[i] = (gic_real)initial[i];
    probe.fail_at = probe.poison_at = -1;
    probe.head.input_function = cosine_input;
    probe.input[0] = GIC_R(0.125);
    return probe;
}

static int dual_step(Probe *probe, double step, int32_t ratio)
{
    memset(probe->calls, 0, sizeof probe->calls);
    probe->all = 0;
    return gic_step_dual(&probe_model, probe, (gic_real)step, ratio);
}

static void dual_steps(Probe *probe, int count, double step, int32_t ratio)
{
    for (int k = 0; k < count; ++k)
        assert_int_equal(dual_step(probe, step, ratio), GIC_OK);
}

/* ---- order -------------------------------------------------------------------------------------------------- */

static const double end = 2;

static void exact_rates(long double t, const long double *y, long double *rate)
{
    const long double u = cosl(2 * t);
    rate[0] = y[1];
    rate[1] = -y[0] - 0.1L * y[1] + 2 * (y[3] - y[0]) - y[4] * y[4] * y[4] + u;
    rate[2] = 2 * y[0] * y[1];
    rate[3] = 40 * (y[0] - y[3]);
    rate[4] = y[5];
    rate[5] = -900 * y[4] - 20 * y[5] + 90 * (y[1] + u) + t;
}

/* The state at `end` by RK4 in long double: (30 * 1e-4)^4 leaves 1e-12 of what the coarsest error below is */
static void exact_end(double *out)
{
    enum { STEPS = 20000 };
    const long double h = end / (int)STEPS;
    long double y[N], stage[N], k[4][N];
    for (int i = 0; i < N; ++i)
        y[i] = initial[i];
    for (int s = 0; s < STEPS; ++s) {
        const long double t = s * h;
        exact_rates(t, y, k[0]);
        for (int j = 1; j < 4; ++j) {
            for (int i = 0; i < N; ++i)
                stage[i] = y[i] + (j < 3 ? h / 2 : h) * k[j - 1][i];
            exact_rates(t + (j < 3 ? h / 2 : h), stage, k[j]);
        }
        for (int i = 0; i < N; ++i)
            y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
    for (int i = 0; i < N; ++i)
        out[i] = (double)y[i];
}

/* Largest difference among slow and among fast states. */
typedef struct Difference {
    double slow, fast;
} Difference;

static Difference difference(const gic_real *a, const double *b)
{
    Difference out = {0, 0};
    for (int i = 0; i < N; ++i) {
        double *of = i < SLOW ? &out.slow : &out.fast;
        *of = fmax(*of, fabs((double)a[i] - b[i]));
    }
    return out;
}

static Probe run(int steps, int32_t ratio)
{
    Probe probe = probe_new();
    dual_steps(&probe, steps, end / steps, ratio);
    return probe;
}

/* The coarsest run must be in the range of h^3, the finest above rounding. */
#ifdef GIC_FLOAT
enum { COARSE = 80, FINER = 2 };
#else
enum { COARSE = 320, FINER = 4 };
#endif

static void assert_order_3(const Difference *coarse, const Difference *fine)
{
    const double slow = log(coarse->slow / fine->slow) / log(FINER), fast = log(coarse->fast / fine->fast) / log(FINER);
    if (!(slow > 2.8 && slow < 3.2 && fast > 2.8 && fast < 3.2))
        fail_msg("orders %.3f (slow) and %.3f (fast), from errors %g and %g", slow, fast, coarse->slow, coarse->fast);
}

static void test_order(void **unused)
{
    (void)unused;
    double exact[N];
    exact_end(exact);
    const int32_t ratio[] = {2, RATIO, 6};
    for (int i = 0; i < 3; ++i) {
        const Probe coarse = run(COARSE, ratio[i]), fine = run(FINER * COARSE, ratio[i]);
        const Difference errors[2] = {difference(coarse.state, exact), difference(fine.state, exact)};
        assert_order_3(&errors[0], &errors[1]);
    }
}

/* Towards the single rate of the same fast step, too: so that nothing but the slow step is what dual rate adds. */
static void test_single_rate(void **unused)
{
    (void)unused;
    Difference gap[2];
    for (int i = 0; i < 2; ++i) {
        const int steps = i ? FINER * COARSE : COARSE;
        const Probe dual = run(steps, RATIO), single = run(steps * RATIO, 1);
        double other[N];
        for (int k = 0; k < N; ++k)
            other[k] = (double)single.state[k];
        gap[i] = difference(dual.state, other);
    }
    assert_order_3(&gap[0], &gap[1]);
}

/* ---- momentum: v' = 30 (z - v), z' = 60 (v - z) ---------------------------------------------------------------
 *
 * 2 v + z stays, z - v dies out with 90 1/s. Slow v goes through long steps and fast z through short ones, so that each
 * sums its own force; with v = 1 and z = 0 first, v = z = 2/3 is due at the end. */

static const double decay = 90; /* 1/s */

typedef struct Pair {
    gic_head head;
    gic_real state[2], rate[2], history[GIC_HISTORY(2, 1)], link[5], scratch[GIC_SCRATCH(2, 0)];
} Pair;

static int pair_fast(void *self, gic_real time, const gic_real *link, const gic_real *fast, gic_real *rate)
{
    (void)self;
    (void)time;
    rate[0] = GIC_R(60.0) * (link[0] - fast[0]);
    return GIC_OK;
}

static int pair_rhs(void *self, gic_real time, const gic_real *y, gic_real *rate)
{
    rate[0] = GIC_R(30.0) * (y[1] - y[0]);
    return pair_fast(self, time, y, y + 1, rate + 1);
}

static int pair_link(void *self, gic_real time, const gic_real *slow, gic_real *link)
{
    (void)self;
    (void)time;
    link[0] = slow[0];
    return GIC_OK;
}

static int pair_settle(void *self, gic_real *y)
{
    (void)self;
    return gic_bounded(y, 2) ? GIC_OK : GIC_ERROR_INPUT;
}

static const gic_model pair_model = {
    .abi_version = GIC_ABI_VERSION,
    .real_size = sizeof(gic_real),
    .size = sizeof(Pair),
    .slow_count = 1,
    .fast_count = 1,
    .state_offset = offsetof(Pair, state),
    .rate_offset = offsetof(Pair, rate),
    .history_offset = offsetof(Pair, history),
    .scratch_offset = offsetof(Pair, scratch),
    .rhs = pair_rhs,
    .settle = pair_settle,
    .link_count = 1,
    .link_offset = offsetof(Pair, link),
    .link = pair_link,
    .fast = pair_fast,
};

/* AB3 begun with true rates would leave 3/8 step^3 v''' at its begin, of either side with its own step. That of the
 * short steps stays, a part 1 / ratio^3; of the long ones' no more than the next terms of the series may be left, a
 * step times the decay. */
static void test_momentum(void **unused)
{
    (void)unused;
    const int32_t ratio[] = {2, 3, RATIO, 12};
    for (double step = 1 / 512.0; step > 1 / 3000.0; step /= 2)
        for (int i = 0; i < 4; ++i) {
            Pair pair;
            memset(&pair, 0, sizeof pair);
            pair.state[0] = GIC_R(1.0);
            while (gic_time(&pair) < GIC_R(0.5)) /* exp(-45) is left of the motion */
                assert_int_equal(gic_step_dual(&pair_model, &pair, (gic_real)step, ratio[i]), GIC_OK);
            const double begun = 3.0 / 8 * pow(step * decay, 3) / 3 * exp(-2 * step * decay);
            const double share = 1 / pow(ratio[i], 3) + 0.1 * step * decay;
            for (int k = 0; k < 2; ++k)
                assert_true(fabs((double)pair.state[k] - 2.0 / 3) < share * begun + 0.5 / step * EPSILON);
        }
}

/* ---- what a step is made of ---------------------------------------------------------------------------------- */

static void test_ratio_one(void **unused)
{
    (void)unused;
    Probe dual = probe_new(), single = probe_new();
    for (int k = 0; k < 50; ++k) {
        assert_int_equal(dual_step(&dual, 0.01, 1), GIC_OK);
        assert_int_equal(gic_step(&probe_model, &single, GIC_R(0.01), GIC_AB3), GIC_OK);
        assert_memory_equal(dual.state, single.state, sizeof dual.state);
        assert_true(gic_time(&dual) == gic_time(&single));
    }
    assert_int_equal(dual.calls[CALL_FAST] + dual.calls[CALL_LINK], 0);

    /* without fast states every ratio is one */
    gic_model slow = probe_model;
    slow.fast_count = 0;
    slow.slow_count = N;
    Probe other = probe_new();
    for (int k = 0; k < 50; ++k)
        assert_int_equal(gic_step_dual(&slow, &other, GIC_R(0.01), 3 + k), GIC_OK);
    assert_memory_equal(other.state, single.state, sizeof other.state);
}

/* With steps that are powers of two times come out to the last bit. */
static void test_start(void **unused)
{
    (void)unused;
    const double step = 1 / 128.0;
    Probe dual = probe_new(), single = probe_new();
    for (int k = 0; k < 2; ++k) {
        assert_int_equal(dual_step(&dual, step, 4), GIC_OK);
        gic_restart(&single, gic_time(&single));
        for (int j = 0; j < 4; ++j) {
            assert_int_equal(gic_step(&probe_model, &single, (gic_real)(step / 4), GIC_AB3), GIC_OK);
            if (j == 0)
                assert_memory_equal(dual.history, single.rate, SLOW * sizeof *dual.history);
            if (j >= 2)
                assert_memory_equal(dual.history + SLOW + (3 - j) * N, single.rate + SLOW, FAST * sizeof *dual.history);
        }
        assert_memory_equal(dual.state, single.state, sizeof dual.state);
        assert_int_equal(dual.calls[CALL_RHS], k == 0 ? 10 : 11); /* and at the end of the second step */
        assert_int_equal(dual.calls[CALL_SETTLE], 4);
        assert_int_equal(dual.calls[CALL_LINK], k == 0 ? 2 : 1);
        assert_int_equal(dual.calls[CALL_FAST], 0);
    }
}

static void test_costs(void **unused)
{
    (void)unused;
    const double step = 0.01;
    Probe probe = probe_new();
    dual_steps(&probe, 2, step, RATIO);
    probe.surprised = 0;
    const int64_t rhs = probe.head.rhs_count;
    enum { STEPS = 20 };
    for (int k = 0; k < STEPS; ++k) {
        dual_steps(&probe, 1, step, RATIO);
        const int calls[CALLS] = {[CALL_RHS] = 1, [CALL_SETTLE] = 1, [CALL_LINK] = 1, [CALL_FAST] = RATIO - 1};
        assert_memory_equal(probe.calls, calls, sizeof calls);
        assert_true(probe.state[2] == probe.state[0] * probe.state[0]);
        /* inputs are those of the end, rates those of the start */
        gic_real input;
        cosine_input(NULL, 0, gic_time(&probe), &input);
        assert_true(probe.input[0] == input);
    }
    assert_int_equal(probe.head.rhs_count - rhs, STEPS);
    assert_int_equal(probe.head.fast_count, STEPS * (RATIO - 1));
    /* the right-hand side begins where links were evaluated last: recovering is done once */
    assert_int_equal(probe.surprised, 0);
}

/* Fast steps only while they are needed: with 0 always; else what is left out and what is not adds up, the right-hand
 * side is evaluated at every step, and the result differs by some of the bound. Over a step of 0.01 s that allows rates
 * to be off by 100 (1 + |x|) bounds a second, which z0 makes up for at 40 / s, z1' at 10 / s; it swings by up to 4. */
static void test_steady(void **unused)
{
    (void)unused;
    enum { STEPS = 400 };
    const gic_real step = GIC_R(0.01);
    Probe full = probe_new(), none = full;
    for (int k = 0; k < STEPS; ++k) {
        assert_int_equal(gic_step_dual(&probe_model, &full, step, RATIO), GIC_OK);
        assert_int_equal(gic_step_steady(&probe_model, &none, step, RATIO, 0), GIC_OK);
    }
    assert_memory_equal(full.state, none.state, sizeof full.state);
    assert_int_equal(none.head.steady_count, 0);
    int64_t before = 0;
    for (double bound = 1e-4; bound < 0.5; bound *= 10) {
        Probe eased = probe_new();
        for (int k = 0; k < STEPS; ++k)
            assert_int_equal(gic_step_steady(&probe_model, &eased, step, RATIO, (gic_real)bound), GIC_OK);
        assert_int_equal(eased.head.steady_count + eased.head.fast_count, full.head.fast_count);
        assert_int_equal(eased.head.rhs_count, full.head.rhs_count);
        assert_true(eased.head.steady_count >= before);
        before = eased.head.steady_count;
        for (int i = 0; i < N; ++i)
            assert_true(fabs((double)(eased.state[i] - full.state[i])) <
                        (i < N - 1 ? 10 : 50) * bound * (1 + fabs((double)full.state[i])));
    }
    assert_true(before > STEPS * (RATIO - 1) / 2);
    const Probe kept = full;
    assert_int_equal(gic_step_steady(&probe_model, &full, step, RATIO, -1), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step_steady(&probe_model, &full, step, RATIO, not_a_number()), GIC_ERROR_ARGUMENT);
    assert_memory_equal(full.state, kept.state, sizeof full.state);
}

static void test_links(void **unused)
{
    (void)unused;
    Probe probe = probe_new();
    probe.cubic = 1;
    dual_steps(&probe, 40, 1 / 64.0, RATIO);
    /* |cubic| stays below 2 until 0.625; times and results round */
    assert_int_equal(probe.head.fast_count, 38 * (RATIO - 1));
    assert_true(probe.missed < 20 * EPSILON);
}

/* An hour and a bit: a step's time is never more than the rounding of start + steps * step away. */
static void test_time(void **unused)
{
    (void)unused;
#ifdef GIC_FLOAT
    const double step = 1 / 128.0;
#else
    const double step = 0.005;
#endif
    const int steps = (int)(3700 / step);
    Probe probe = probe_new();
    dual_steps(&probe, steps, step, 3);
    assert_true(fabs((double)gic_time(&probe) - steps * (double)(gic_real)step) <= EPSILON * 3700);
    assert_true(probe.late < 2 * EPSILON);
    assert_int_equal(probe.head.steps, steps);
}

/* ---- states of the instance ---------------------------------------------------------------------------------- */

static void assert_untouched(const Probe *now, const Probe *before)
{
    assert_memory_equal(now->state, before->state, sizeof now->state);
    assert_memory_equal(now->rate, before->rate, sizeof now->rate);
    assert_memory_equal(now->history, before->history, sizeof now->history);
    assert_memory_equal(now->input, before->input, sizeof now->input);
    assert_memory_equal(now->link, before->link, 3 * LINKS * sizeof *now->link);
    assert_true(gic_time(now) == gic_time(before));
    assert_true(now->head.step == before->head.step);
    assert_int_equal(now->head.steps, before->head.steps);
    assert_int_equal(now->head.history, before->head.history);
    assert_int_equal(now->head.ratio, before->head.ratio);
    assert_int_equal(now->head.method, before->head.method);
}

/* Each call of the step after `done` steps fails, or gives what is no number. */
static void check_failures(int done, int32_t ratio, double step)
{
    Probe whole = probe_new();
    dual_steps(&whole, done, 0.01, RATIO);
    const Probe before = whole;
    dual_steps(&whole, 1, step, ratio);
    const int calls = whole.all;
    for (int i = 0; i < 2 * calls; ++i) {
        Probe probe = before;
        *(i < calls ? &probe.fail_at : &probe.poison_at) = i % calls;
        const int status = dual_step(&probe, step, ratio);
        /* of a link that is no number, and of a state that is to be */
        assert_true(i < calls ? status == GIC_ERROR_NEWTON
                              : status == GIC_ERROR_RESULT || status == GIC_ERROR_UNSTABLE);
        assert_true((probe.head.grown >= 0) == (status == GIC_ERROR_UNSTABLE));
        assert_int_equal(probe.head.status, status);
        assert_untouched(&probe, &before);
        /* and nothing stays behind that the next try would see */
        probe.fail_at = probe.poison_at = -1;
        dual_steps(&probe, 1, step, ratio);
        assert_memory_equal(probe.state, whole.state, sizeof probe.state);
        assert_memory_equal(probe.link, whole.link, 3 * LINKS * sizeof *probe.link);
    }
}

static void test_failure_changes_nothing(void **unused)
{
    (void)unused;
    for (int done = 0; done < 4; ++done)
        check_failures(done, RATIO, 0.01);
    check_failures(4, 2, 0.01);
    check_failures(4, RATIO, 0.02);
}

static void test_arguments(void **unused)
{
    (void)unused;
    Probe probe = probe_new();
    dual_steps(&probe, 3, 0.01, RATIO);
    const Probe before = probe;
    const gic_real bad_step[] = {0, GIC_R(-0.01), not_a_number(), (gic_real)(EPSILON * 1e-3)};
    for (int i = 0; i < 4; ++i)
        assert_int_equal(gic_step_dual(&probe_model, &probe, bad_step[i], RATIO), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step_dual(&probe_model, &probe, GIC_R(0.01), 0), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step_dual(&probe_model, &probe, GIC_R(0.01), -3), GIC_ERROR_ARGUMENT);
    /* so many that the step would not end */
    assert_int_equal(gic_step_dual(&probe_model, &probe, GIC_R(0.01), GIC_RATIOS + 1), GIC_ERROR_ARGUMENT);
    assert_int_equal(gic_step_dual(&probe_model, &probe, GIC_R(0.01), INT32_MAX), GIC_ERROR_ARGUMENT);
    /* fast steps that time can't count */
    assert_int_equal(gic_step_dual(&probe_model, &probe, (gic_real)(EPSILON / 4), 1000), GIC_ERROR_ARGUMENT);
    gic_model other = probe_model;
    other.abi_version = GIC_ABI_VERSION - 1;
    assert_int_equal(gic_step_dual(&other, &probe, GIC_R(0.01), RATIO), GIC_ERROR_ABI);
    assert_untouched(&probe, &before);
}

static void test_snapshot(void **unused)
{
    (void)unused;
    for (int done = 0; done < 8; ++done) {
        Probe probe = probe_new();
        dual_steps(&probe, done, 0.01, RATIO);
        Probe kept = probe;
        dual_steps(&probe, 20, 0.01, RATIO);
        dual_steps(&kept, 20, 0.01, RATIO);
        assert_memory_equal(&probe, &kept, sizeof probe);
    }
}

/* A step that restarts gives what it gives to an instance that never knew another. */
static void test_restart(void **unused)
{
    (void)unused;
    enum { NEW_RATIO, NEW_STEP, NEW_METHOD, ASKED, WAYS };
    for (int way = 0; way < WAYS; ++way) {
        const double step = way == NEW_STEP ? 0.007 : 0.01;
        const int32_t ratio = way == NEW_RATIO ? 3 : RATIO;
        Probe probe = probe_new();
        dual_steps(&probe, 6, 0.01, RATIO);
        if (way == NEW_METHOD)
            assert_int_equal(gic_step(&probe_model, &probe, GIC_R(0.01), GIC_AB3), GIC_OK);
        if (way == NEW_METHOD)
            assert_int_equal(probe.head.history, 1);
        if (way == ASKED)
            gic_restart(&probe, GIC_R(7.5));
        Probe fresh = probe_new();
        memcpy(fresh.state, probe.state, sizeof fresh.state);
        gic_restart(&fresh, gic_time(&probe));
        for (int k = 0; k < 5; ++k) {
            dual_steps(&probe, 1, step, ratio);
            dual_steps(&fresh, 1, step, ratio);
            assert_memory_equal(probe.state, fresh.state, sizeof fresh.state);
            /* rows that the steps so far have filled */
            assert_memory_equal(probe.link, fresh.link, (k == 0 ? 2U : 3U) * LINKS * sizeof *fresh.link);
            assert_int_equal(probe.head.history, k < 1 ? 1 : 2);
        }
    }
}

/* ---- the other integrators ----------------------------------------------------------------------------------- */

#ifndef GIC_FLOAT
/* Variable steps take slow and fast states as one. */
static void test_variable(void **unused)
{
    (void)unused;
    double exact[N];
    exact_end(exact);
    const int32_t method[] = {METHOD_ADAMS, METHOD_RKCK};
    for (int i = 0; i < 2; ++i) {
        Probe probe = probe_new();
        Variable *variable = variable_open(&probe_model, method[i], 1e-9);
        assert_non_null(variable);
        while (gic_time(&probe) < end) {
            probe.all = 0;
            assert_int_equal(variable_step(variable, &probe, end), GIC_OK);
        }
        variable_close(variable);
        const Difference error = difference(probe.state, exact);
        /* a thousand local errors, some of which this damped system forgets */
        assert_true(error.slow < 1e-7 && error.fast < 1e-7);
    }
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),     cmocka_unit_test(test_single_rate),
        cmocka_unit_test(test_momentum),  cmocka_unit_test(test_ratio_one),
        cmocka_unit_test(test_start),     cmocka_unit_test(test_costs),
        cmocka_unit_test(test_steady),    cmocka_unit_test(test_links),
        cmocka_unit_test(test_time),      cmocka_unit_test(test_failure_changes_nothing),
        cmocka_unit_test(test_arguments), cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_restart),
#ifndef GIC_FLOAT
        cmocka_unit_test(test_variable),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
