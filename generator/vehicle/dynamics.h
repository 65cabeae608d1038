/* SPDX-License-Identifier: MIT
 * Parts of the equations of motion in the reduced form. Private to dynamics_reduced.c and dynamics_articulated.c. */
#ifndef VEHICLE_DYNAMICS_H
#define VEHICLE_DYNAMICS_H

#include "expression/expression.h"
#include "vehicle/vehicle.h"

/* Sums over all subsets that the base carries. */
typedef struct Composite {
    Ex mass, first[3], second[6]; /* about the base origin */
    Ex force[3], moment[3];       /* quadratic-velocity terms */
    Ex (*coupling)[7];            /* [coordinates] force and moment of a unit acceleration, quadratic-velocity force */
    Ex *M;                        /* [coordinates][coordinates] upper triangle */
} Composite;

/* Add up numbers of the subsets' inertias. */
typedef struct Summation {
    const Whole *whole;
    bool settled; /* numbers that are the same in every configuration, else those in memory */
} Summation;

/* Add numbers of a subset's inertia, from `offset` on, to sum [count]. */
void dynamics_add(const Summation *now, Ex *sum, int subset, int offset, int count);
Composite dynamics_compose(Whole *whole);
/* Upper triangle of the reduced mass matrix M [n][n], n being Plan.unknowns. */
void dynamics_matrix(Whole *whole, const Composite *c, Ex *M, int n);
/* Applied less quadratic-velocity forces less those of the driven accelerations, [unknowns]. */
void dynamics_right(Whole *whole, const Composite *c, const Loads *loads, const Ex *driven, Ex *b);
/* Check that the inertia that is left exceeds the share of the former one below which accelerations have lost too many
 * digits. Both may have a common factor. */
void dynamics_check(Whole *whole, Block *block, int unknown, Ex left, Ex whole_of_it);

/* The equations of motion M z = b in the reduced form, without a reduction: upper triangle of M [unknowns][unknowns]
 * and b [unknowns]. Then the factors of M. */
const Ex *dynamics_system(Whole *whole, Ex *b);
const Factors *dynamics_factors(Whole *whole, const Ex *M);

#endif
