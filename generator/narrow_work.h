/* SPDX-License-Identifier: MIT
 *
 * A model while it is narrowed to a scene: shared by the files that do that, and by no other. */
#ifndef NARROW_WORK_H
#define NARROW_WORK_H

#include "mirror.h"
#include "narrow.h"

typedef struct Narrower {
    Pool *pool;
    const Facts *facts;
    const Model *model;
    const Formulation *general;
    Formulation *out;
    Plan *plan;
    Narrowing *narrowing;
    const Mirror *mirror;               /* NULL: both sides are computed */
    Givens *whole, *fast;               /* of the graphs of the whole; of those of torques and powertrain */
    bool *steady;                       /* [coordinates] that keep `at` */
    double *at;                         /* [coordinates] */
    bool *known_motion, *known_inertia; /* [plan's sizes] constant, with these values: */
    double *motion, *inertia;
} Narrower;

void *narrow_copy(Pool *pool, const void *array, size_t count, size_t size);
void narrow_assume(Narrower *n, AssumptionAbout about, const char *text, const char *broken);
/* Index of a target of that array, -1: it is of another. */
int narrow_target(const char *target, const char *array);

/* ---- narrow_mirror.c: one side for both ---------------------------------------------------------------------------
 */

/* What is taken for granted, and which numbers are images of which. */
void narrow_mirror(Narrower *n);
/* The equations of motion in the unknowns of one side and the middle. */
const Block *narrow_dynamics(Narrower *n);
/* Do they, and the torques of wheels, treat both sides alike, whatever forces there are? By random numbers. */
bool narrow_is_even(Narrower *n);

#endif
