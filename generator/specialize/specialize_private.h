/* SPDX-License-Identifier: MIT
 *
 * A model while it is narrowed to a scene: shared by the files that do that, and by no other. */
#ifndef SPECIALIZE_SPECIALIZE_PRIVATE_H
#define SPECIALIZE_SPECIALIZE_PRIVATE_H

#include "expression/expression.h"
#include "model/model.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "vehicle/vehicle.h"

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

/* ---- specialize_mirror.c: one side for both */

/* Why subsets and reference points of one side are not the images of the other's; NULL: they are. */
const char *narrow_unpaired(const Narrower *n);
/* Add the assumptions of mirror symmetry, and the relations between the numbers of paired subsets. */
void narrow_mirror(Narrower *n);
/* Let number `at` of an array be sign times number `of`; with of == at and a negative sign it is 0. */
void narrow_give(Givens *givens, Array array, int at, int of, double sign);
/* The accelerations that are mirror images of others. */
Reduction *narrow_reduction(Narrower *n);
/* The equations of motion in the unknowns of one side and the middle. */
const Block *narrow_dynamics(Narrower *n);

/* ---- specialize_even.c: proof that both sides have the same formulas */

/* Why a symmetric state may not stay one: forces, tires or torques that are not proved to be mirror images at every
 * symmetric state and time; NULL: they are. */
const char *narrow_uneven(Narrower *n);

#endif
