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

#endif
