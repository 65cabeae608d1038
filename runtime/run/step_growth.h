/* SPDX-License-Identifier: MIT
 *
 * The amplification of a small motion by a method with constant steps: theory, independent of any model. */
#ifndef RUN_STEP_GROWTH_H
#define RUN_STEP_GROWTH_H

#include <stdbool.h>
#include <stdint.h>

/* For y' = lambda y in steps h of a gic_method; z: h lambda, real and imaginary part. Amplification factor per step
 * after start-up transients; below 1 the motion decays. */
double step_growth(int32_t method, double real, double imaginary);
/* True if the factor is larger than `growth`; without a search for its value. */
bool step_grows(int32_t method, double real, double imaginary, double growth);
/* Relative error of the eigenvalue that a motion has in steps of a method, implicit ones with an exact Jacobian
 * among them: |log r - z| / |z|, with the factor r of the root that is exp(z) in the limit of short steps. */
double step_error(int32_t method, double real, double imaginary);
/* The longest step, s, with which a motion of eigenvalue lambda, 1/s, does not grow; and with which step_error() is at
 * most `error`, between 1e-6 and 0.1. INFINITY: any step, as with implicit ones, with a motion that grows by itself,
 * and with lambda = 0. */
double step_stable(int32_t method, double real, double imaginary);
double step_accurate(int32_t method, double real, double imaginary, double error);

#endif
