/* SPDX-License-Identifier: MIT
 * For the tests of the reference: small vectors, rotation and force laws of FORMAT.md in long double, written apart
 * from the reference's own. */
#ifndef REFERENCE_CHECK_H
#define REFERENCE_CHECK_H

#include "solve.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

typedef long double real;

static inline void near_to(quad actual, real expected, real scale)
{
    if (!(fabsl((real)actual - expected) <= 1e-15L * scale))
        fail_msg("%.20Lg instead of %.20Lg", (real)actual, expected);
}

static inline void cross(const real a[3], const real b[3], real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static inline real inner(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A(p) exactly as FORMAT.md section 1 prints it */
static inline void rotation(const real p[4], real A[3][3])
{
    const real *e = p + 1;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int l = 0; l < 3; ++l)
            A[i][l] = 2 * e[i] * e[l];
        A[i][i] += 2 * p[0] * p[0] - 1;
        A[i][j] -= 2 * p[0] * e[k];
        A[i][k] += 2 * p[0] * e[j];
    }
}

static inline void apply(real A[3][3], const real x[3], real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = inner(A[i], x);
}

static inline void apply_back(real A[3][3], const real x[3], real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = A[0][i] * x[0] + A[1][i] * x[1] + A[2][i] * x[2];
}

static const Road flat = {0};

static inline void solve(Solver *solver, State *state, const Road *road)
{
    assert_true(recover_largest(state->e));
    assert_true(solve_positions(solver, state));
    solve_velocities(solver, state);
    assert_true(solve_accelerations(solver, state, road));
    assert_true(solver->sum_error < 1e-25);
}

/* Force of a spring-damper between two points on the second of them. */
static inline void spring_force(const Force *spring, real x[2][3], real x_rate[2][3], real F[3])
{
    real d[3], d_rate[3];
    for (int i = 0; i < 3; ++i) {
        d[i] = x[1][i] - x[0][i];
        d_rate[i] = x_rate[1][i] - x_rate[0][i];
    }
    real length = sqrtl(inner(d, d));
    real tension = spring->stiffness * (length - spring->free) + spring->damping * inner(d, d_rate) / length;
    for (int i = 0; i < 3; ++i)
        F[i] = -tension * d[i] / length;
}

/* Force of a wheel that is deflected beyond the fade and doesn't lift off. */
static inline void tire_force(const Wheel *wheel, const Road *road, const real x[3], const real x_rate[3], real F[3])
{
    real wave = 2 * acosl(-1) / road->wavelength, phase = wave * (x[0] - road->x0) + road->phase_per_y * x[1];
    real h = road->amplitude * sinl(phase), slope = road->amplitude * cosl(phase);
    real deflection = wheel->radius + h - x[2];
    real rate = slope * (wave * x_rate[0] + road->phase_per_y * x_rate[1]) - x_rate[2];
    F[0] = F[1] = 0;
    F[2] = wheel->stiffness * deflection + wheel->damping * rate;
    assert_true(deflection > wheel->fade && F[2] > 0);
}

#endif
