/* SPDX-License-Identifier: MIT
 * Columns of the jacobian through wheels with tires, own states and the powertrain: each block by its own few inputs,
 * then products of these along all columns. */
#ifndef VEHICLE_WHEEL_COLUMNS_H
#define VEHICLE_WHEEL_COLUMNS_H

#include "vehicle/vehicle.h"

/* The derivative of one result of a block by one of its inputs: local[place], or `value` where place is -1. */
typedef struct Local {
    Element target, by;
    int place;
    double value;
} Local;

typedef struct Locals {
    int count, size; /* entries; where what follows in local[] begins */
    Local *local;
    Block block; /* stores local[], and results that other blocks read */
} Locals;

/* Of a class of wheels; places from the wheel's own local[] on, elements as in blocks of one wheel. */
typedef struct WheelClassColumns {
    Locals contact; /* contact[]; half[] of it; local[] */
    Block tire;     /* force[] of a wheel with load, and half[] of it, which are 0 without load */
    Locals balance; /* the rest of local[] */
    int size, halves;
} WheelClassColumns;

typedef struct WheelColumns {
    const Model *model;
    const Wheels *wheels;
    Locals torque;            /* torque[], rate[] of own states */
    WheelClassColumns *class; /* [classes] */
    int *class_of, *offset;   /* [wheels] class, -1: no tire; where its local[] begins */
    Locals drive;
    int locals;        /* of all local[] */
    int parts, moving; /* rows of part[]; of these the ones that move wheels come first, then fast rates */
    Element *part;     /* [parts] */
    Block link;        /* link[], and part[] of all columns */
} WheelColumns;

/* b [n]: what reads grip[] and watch[] of the wheels, in `dag`. */
WheelColumns *wheel_columns_new(Pool *pool, const Formulation *f, const Dag *dag, const Ex *b, int n);
/* The row of an element in part[]; -1: it moves nothing. */
int wheel_columns_part(const WheelColumns *w, Element e);
/* The derivative in column c of a result of all blocks: rate[] of fast states, grip[], watch[]. */
Ex wheel_columns_change(const WheelColumns *w, Dag *dag, Element e);
/* Can it be other than 0 where these rows of part[] are? */
bool wheel_columns_moves(const WheelColumns *w, Element e, const bool *moved);

#endif
