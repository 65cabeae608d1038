/* SPDX-License-Identifier: MIT
 * Formulas and tables of the dumped model (FORMAT.md sections 6 and 11), evaluated in quad precision. */
#ifndef REFERENCE_FORMULA_H
#define REFERENCE_FORMULA_H

#include "json.h"
#include "quad.h"

/* A component of an output that a formula reads. */
typedef struct SignalSource {
    char *type;
    int component, body, in, index; /* GROUND possible; index: of a coordinate or force element */
    double point[3];
} SignalSource;

typedef struct Formula {
    SignalSource *source; /* of the op `signal` */
    char *op;             /* NULL: a number */
    double number;
    int index; /* of a coordinate, input or table */
    int arguments;
    struct Formula *argument[3];
} Formula;

typedef struct Lookup {
    int count;
    double *x, *y;
    bool cubic, onward;
} Lookup;

/* What the place of a formula adds to what formulas know: length (or angle) of a force element and its rate, spin of a
 * wheel, speed and throttle of an engine, how a body moves through the air, how a bushing is strained. */
typedef struct Locals {
    quad length, speed, spin, throttle, incidence, sideslip, airspeed;
    quad bushing[12]; /* displacements and rotations, and their rates */
} Locals;

/* What a formula's names stand for. */
typedef struct Surroundings {
    const quad *w, *w_rate; /* of the coordinates */
    const quad *input;
    const double *state; /* the model's own */
    const Lookup *table;
    quad time;
    Locals local;
    const void *model, *configuration; /* of signals */
} Surroundings;

/* signal.c: its value at the configuration. */
quad signal_value(const SignalSource *source, const Surroundings *around);

Formula *formula_read(const Json *json);
void formula_free(Formula *formula);
/* series.c: a formula of coordinates alone, c[0] + c[1] t + c[2] t^2, where these are w + way t. */
typedef struct Series {
    quad c[3];
} Series;
Series formula_series(const Formula *formula, const quad *w, const quad *way);
quad formula_value(const Formula *formula, const Surroundings *around);
/* The sum of magnitudes of its terms, of which the value may be next to nothing. */
quad formula_size(const Formula *formula, const Surroundings *around);

void lookup_read(Lookup *table, const Json *json);
void lookup_free(Lookup *table);
quad lookup_at(const Lookup *table, quad x);

#endif
