/* SPDX-License-Identifier: MIT
 *
 * Motions of subsets of one coordinate in quad precision, from the formulas that become code. */
#ifndef SUBSET_EXACT_MOTION_H
#define SUBSET_EXACT_MOTION_H

#include "base/quad.h"
#include "subset/subset_private.h"

/* One subset at a value of the coordinate. */
typedef struct Solved {
    const Formula *formula; /* NULL: not needed */
    int member;
    const bool *pose_needed, *motion_needed; /* [nodes] */
    Quad *node;                              /* [nodes] */
    Quad *q;                                 /* [7 bodies] the pose that Newton's iteration found; NULL: closed form */
    Quad *motion;                            /* [bodies][motion_size] */
} Solved;

typedef struct Exact {
    Work *w;
    const Sampling *sampling;
    Solved *solved; /* [subsets] */
    int *order;     /* subsets in the order in which they are solved */
    int subsets;
} Exact;

/* For the subsets of one class, whose formula is `own`, and those that they refer to, of which `made` [classes] has the
 * formulas. */
Exact *exact_new(Work *w, Formula *const *made, const Formula *own, const Sampling *sampling);
/* True: a tunable parameter moves one of these motions. */
bool exact_is_tuned(const Exact *exact);
/* Begin again at the design. */
void exact_reset(Exact *exact);
/* Solve a subset, and before it those that it refers to, with the coordinate at x and at unit rate, the base at rest,
 * from the last solution on. NULL, or what is wrong as text for people. */
const char *exact_solve(Exact *exact, int subset, Quad x);
/* True for this subset and those that it refers to which move with its coordinate, or not at all. */
bool exact_concerns(const Exact *exact, int subset, int other);
/* Its motion, in the order of `motion[]` of generated code, and the pose that Newton's iteration found (NULL: closed).
 */
const Quad *exact_numbers(const Exact *exact, int subset);
const Quad *exact_pose(const Exact *exact, int subset);

#endif
