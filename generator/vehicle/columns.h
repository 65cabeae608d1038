/* SPDX-License-Identifier: MIT
 * All columns of the jacobian in one block. */
#ifndef VEHICLE_COLUMNS_H
#define VEHICLE_COLUMNS_H

#include "vehicle/vehicle.h"
#include "vehicle/wheel_columns.h"

/* column[] has the derivatives of all motions (subset/subset.h) one subset after another; jacobian[] of `block` has the
 * derivatives of the rates, `columns` a row, those that are 0 left out. The block reads rate[], share[] (of each Euler
 * parameter over the dependent one; 1 for this one) and which[]. */
typedef struct RateColumns {
    MotionColumns **motion; /* [classes] */
    int *offset;            /* [subsets] where the subset's part of column[] begins */
    int size;               /* of column[] */
    int lanes, factors;     /* right-hand sides; numbers of factor[] */
    WheelColumns *wheels;   /* NULL: no fast states */
    Block accelerations;    /* acc[] [unknowns] from rate[] */
    Block residuals;        /* right[], by columns, and factor[] */
    Block solution;         /* the solution of one column c of right[], in its place; with wheels the rates of fast
                             * states in part[], from what moves them there and local[] */
    Block block;            /* jacobian[] from these */
} RateColumns;

/* apart [columns]: columns that are not among them. NULL: the model has something that this is not made for: another
 * form of the equations of motion than the reduced one, or knowns of several classes. */
const RateColumns *rate_columns(Pool *pool, const Formulation *f, const bool *apart, int columns);

#endif
