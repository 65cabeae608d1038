/* SPDX-License-Identifier: MIT
 *
 * What a method of constant steps makes of a small motion: theory, apart from any model. */
#ifndef STEP_GROWTH_H
#define STEP_GROWTH_H

#include <stdbool.h>
#include <stdint.h>

/* A motion y' = lambda y in steps h of a gic_method. z: h lambda, its real and its imaginary part. By how much it grows
 * in a step, once what the start has left behind is over: below 1 it dies out. */
double step_growth(int32_t method, double real, double imaginary);
/* Does it grow by more than `growth` a step? The same without a search. */
bool step_grows(int32_t method, double real, double imaginary, double growth);

#endif
