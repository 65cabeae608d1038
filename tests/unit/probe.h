/* SPDX-License-Identifier: MIT
 * Functions as models of the runtime core, for steps that need derivatives: an instance for any problem of a few
 * states, and problems. Included behind gic_runtime.c. */
#ifndef PROBE_H
#define PROBE_H

#include <complex.h>
#include <math.h>
#include <string.h>

enum { MOST = 4, INPUTS = 2, COLUMNS = MOST + INPUTS + 1 };

typedef struct Problem Problem;

/* An instance for any problem. */
typedef struct Probe {
    gic_head head;
    gic_real state[MOST], rate[MOST], history[2 * MOST], input[INPUTS], scratch[GIC_SCRATCH(MOST, INPUTS)];
    gic_implicit_head implicit;
    gic_real number[GIC_IMPLICIT(MOST, COLUMNS)], exponential[GIC_EXPONENTIAL(MOST)];
    int32_t pivot[MOST];
    const Problem *problem;
} Probe;

struct Problem {
    int states;
    void (*rates)(double time, const double *y, const double *u, double *rate);
    void (*slopes)(double time, const double *y, const double *u, double (*by)[COLUMNS]); /* NULL: none, A = 0 */
    int jacobian_status;
};

static int probe_rhs(void *self, gic_real time, const gic_real *state, gic_real *rate)
{
    Probe *probe = self;
    ++probe->head.rhs_count;
    if (!gic_bounded(state, probe->problem->states))
        return GIC_ERROR_INPUT;
    probe->problem->rates(time, state, probe->input, rate);
    return gic_finite(rate, probe->problem->states) ? GIC_OK : GIC_ERROR_RESULT;
}

static int probe_settle(void *self, gic_real *state)
{
    return gic_bounded(state, ((Probe *)self)->problem->states) ? GIC_OK : GIC_ERROR_INPUT;
}

static int probe_jacobian(void *self, gic_real time, const gic_real *state, gic_real *jacobian)
{
    Probe *probe = self;
    double by[MOST][COLUMNS] = {{0}};
    if (probe->problem->slopes)
        probe->problem->slopes(time, state, probe->input, by);
    for (int i = 0; i < probe->problem->states; ++i) { /* by states, then by inputs */
        double *row = jacobian + COLUMNS * i;
        memset(row, 0, COLUMNS * sizeof *row);
        memcpy(row, by[i], (size_t)probe->problem->states * sizeof *row);
        memcpy(row + probe->problem->states, by[i] + MOST, INPUTS * sizeof *row);
    }
    return probe->problem->jacobian_status;
}

static const int32_t all[MOST] = {0, 1, 2, 3}, none[MOST] = {-1, -1, -1, -1};

static gic_implicit whole = {COLUMNS,
                             0,
                             all,
                             none,
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
                             offsetof(Probe, exponential)};

static gic_model model_of(const Problem *problem)
{
    whole.unknown_count = problem->states;
    return (gic_model){.abi_version = GIC_ABI_VERSION,
                       .real_size = sizeof(gic_real),
                       .size = sizeof(Probe),
                       .fast_count = problem->states,
                       .input_count = INPUTS,
                       .state_offset = offsetof(Probe, state),
                       .rate_offset = offsetof(Probe, rate),
                       .history_offset = offsetof(Probe, history),
                       .scratch_offset = offsetof(Probe, scratch),
                       .input_offset = offsetof(Probe, input),
                       .rhs = probe_rhs,
                       .settle = probe_settle,
                       .implicit = &whole};
}

static Probe probe_new(const Problem *problem, const double *start, int keep)
{
    Probe probe;
    memset(&probe, 0, sizeof probe);
    memcpy(probe.state, start, (size_t)problem->states * sizeof *start);
    probe.problem = problem;
    probe.implicit.keep = keep;
    return probe;
}

/* van der Pol's oscillator, driven: mu = 3 */
static void pol_rates(double time, const double *y, const double *u, double *rate)
{
    (void)time;
    rate[0] = y[1];
    rate[1] = 3 * (1 - y[0] * y[0]) * y[1] - y[0] + u[0];
}

static void pol_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)u;
    by[0][1] = 1;
    by[1][0] = -6 * y[0] * y[1] - 1;
    by[1][1] = 3 * (1 - y[0] * y[0]);
    by[1][MOST] = 1;
}

/* A matrix that has nothing to do with it. */
static void wrong_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)y, (void)u;
    by[0][0] = -1;
    by[0][1] = 2;
    by[1][0] = 0.5;
    by[1][1] = -3;
    by[0][MOST] = 1;
    by[1][MOST + 1] = -2;
}

static void waves(void *user, int32_t lane, gic_real time, gic_real *input)
{
    (void)user, (void)lane;
    input[0] = sin(time);
    input[1] = cos(time);
}

static const double pol_start[2] = {2, 0.5}, pol_end = 1.5;

/* z' = lambda z in complex numbers, as two states. */
static double complex lambda;

static void spiral_rates(double time, const double *y, const double *u, double *rate)
{
    const double complex r = lambda * (y[0] + y[1] * I);
    (void)time, (void)u;
    rate[0] = creal(r);
    rate[1] = cimag(r);
}

static void spiral_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)y, (void)u;
    by[0][0] = by[1][1] = creal(lambda);
    by[0][1] = -cimag(lambda);
    by[1][0] = cimag(lambda);
}

static const Problem spiral = {2, spiral_rates, spiral_slopes, 0};

/* RK4 in long double. */
static void pol_reference(long double y[2])
{
    const int steps = 20000;
    const long double h = pol_end / (long double)steps;
    y[0] = pol_start[0], y[1] = pol_start[1];
    for (int k = 0; k < steps; ++k) {
        long double slope[2] = {0, 0}, sum[2] = {0, 0};
        for (int i = 0; i < 4; ++i) {
            const long double reach = i == 0 ? 0 : i < 3 ? h / 2 : h, t = k * h + reach;
            const long double at[2] = {y[0] + reach * slope[0], y[1] + reach * slope[1]};
            slope[0] = at[1];
            slope[1] = 3 * (1 - at[0] * at[0]) * at[1] - at[0] + sinl(t);
            for (int j = 0; j < 2; ++j)
                sum[j] += slope[j] * (i == 0 || i == 3 ? 1 : 2);
        }
        for (int j = 0; j < 2; ++j)
            y[j] += h / 6 * sum[j];
    }
}

/* Prothero and Robinson: y' = stiff (y - sin t) + cos t, whose solution is sin t. */
static double stiff;

static void robinson_rates(double time, const double *y, const double *u, double *rate)
{
    (void)time;
    rate[0] = stiff * (y[0] - u[0]) + u[1];
}

static void robinson_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)y, (void)u;
    by[0][0] = stiff;
    by[0][MOST] = -stiff;
    by[0][MOST + 1] = 1;
}

static void swing_rates(double time, const double *y, const double *u, double *rate)
{
    (void)time;
    rate[0] = y[2];
    rate[1] = y[3];
    rate[2] = -4e4 * y[0] + 1e4 * sin(y[1]) - 30 * y[2] + u[0];
    rate[3] = 2e3 * y[0] - 7e3 * y[1] * y[1] * y[1] - 20 * y[3] + y[2];
}

static void swing_slopes(double time, const double *y, const double *u, double (*by)[COLUMNS])
{
    (void)time, (void)u;
    by[0][2] = by[1][3] = by[3][2] = by[2][MOST] = 1;
    by[2][0] = -4e4, by[2][1] = 1e4 * cos(y[1]), by[2][2] = -30;
    by[3][0] = 2e3, by[3][1] = -2.1e4 * y[1] * y[1], by[3][3] = -20;
}

#endif
