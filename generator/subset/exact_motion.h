/* SPDX-License-Identifier: MIT
 *
 * Motions of subsets of one coordinate in extended precision (long double), from the formulas that become code. */
#ifndef SUBSET_EXACT_MOTION_H
#define SUBSET_EXACT_MOTION_H

#include "subset/subset_private.h"

typedef struct Exact Exact;

/* For the subsets of one class, whose formula is `own`, and those that they refer to, of which `made` [classes] has the
 * formulas. */
Exact *exact_new(Work *w, Formula *const *made, const Formula *own, const Sampling *sampling);
/* True: a tunable parameter moves one of these motions. */
bool exact_is_tuned(const Exact *exact);
/* Begin again at the design. */
void exact_reset(Exact *exact);
/* Solve a subset, and before it those that it refers to, with the coordinate at x and at unit rate, the base at rest,
 * from the last solution on. NULL, or what is wrong as text for people. */
const char *exact_solve(Exact *exact, int subset, long double x);
/* Its motion, in the order of `motion[]` of generated code, and the pose that Newton's iteration found (NULL: closed).
 */
const long double *exact_numbers(const Exact *exact, int subset);
const long double *exact_pose(const Exact *exact, int subset);

#endif
