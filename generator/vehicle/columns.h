/* SPDX-License-Identifier: MIT
 * All columns of the jacobian in one block. */
#ifndef VEHICLE_COLUMNS_H
#define VEHICLE_COLUMNS_H

#include "vehicle/vehicle.h"
#include "vehicle/wheel_columns.h"

/* column[] has the derivatives of all motions (subset/subset.h) one subset after another; jacobian[] of `block` has the
 * derivatives of the rates, `columns` a row, those that are 0 left out. The block reads rate[], share[] (of each Euler
 * parameter over the dependent one; 1 for this one) and which[].
 *
 * Weighed columns are those of forces: the rows of velocities are multiplied by the mass matrix M, which is positive
 * definite, so that a row follows what touches its bodies, and not all bodies. They are derivatives of applied forces
 * alone, along straight lines: how inertia, and the directions in which bodies move, change with the configuration is
 * left out. Behind the rows jacobian[] then has the entries of M. */
typedef struct RateColumns {
    MotionColumns **motion; /* [classes] */
    int *offset;            /* [subsets] where the subset's part of column[] begins */
    int size;               /* of column[] */
    int lanes, factors;     /* right-hand sides; numbers of factor[] */
    WheelColumns *wheels;   /* NULL: no fast states */
    Block accelerations;    /* acc[] [unknowns] from rate[] */
    Block residuals;        /* right[], by columns, and factor[] */
    Block solution;         /* the solution of one column c of right[], in its place (weighed: right[] with what wheels
                             * add); with wheels the rates of fast states in part[], from what moves them there and
                             * local[] */
    Block block;            /* jacobian[] from these */
    int masses;             /* entries of M, 0 if not weighed */
    int *mass_row, *mass_column; /* [masses] their velocities, as states */
} RateColumns;

/* apart [columns]: columns that are not among them; of Euler parameters all four are, or none. kept [states]: rows of
 * weighed columns that are wanted; NULL: all. NULL: the model has something that this is not made for: another form of
 * the equations of motion than the reduced one, or knowns of several classes. */
const RateColumns *rate_columns(Pool *pool, const Formulation *f, const bool *apart, int columns, bool weighed,
                                const bool *kept);
/* Does code of the formulation have weighed columns? */
bool rate_columns_weigh(Pool *pool, const Formulation *f);

#endif
