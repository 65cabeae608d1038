/* SPDX-License-Identifier: MIT
 *
 * specialize: code for one scene: what is known about a whole run beforehand, and the formulas that are left of a
 * model then; models as a scene has them. */
#ifndef SPECIALIZE_SPECIALIZE_H
#define SPECIALIZE_SPECIALIZE_H

#include "expression/expression.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "specialize/normal_form.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

/* ---- rig.c: models as on a rig; without a tuning */

/* The model with its base held where its body frame is at `position` and `euler`, world. */
const Model *model_hold(Pool *pool, const Model *model, const double position[3], const double euler[4]);
/* The model with these free coordinates driven, by inputs that follow its own. */
const Model *model_drive(Pool *pool, const Model *model, const int *coordinate, int count);

/* The model with a post under each of these wheels: inputs that follow its own raise the road under it. Slopes do not
 * change by that. */
const Model *model_post(Pool *pool, const Model *model, const int *wheel, int count);

/* ---- massless.c: light bodies without mass, an approximation */

/* The model in which bodies of less than `below` kg in `numbers`, the same model or one without a tuning, have neither
 * mass nor inertia. *names: their names as a text for messages; NULL: there are no such bodies. */
const Model *model_lighten(Pool *pool, const Model *model, const Model *numbers, double below, const char **names);
/* The largest part of its kinetic energy that a motion of the free coordinates loses by that, base and driven
 * coordinates held, at the design and some configurations in the coordinates' ranges. 1: a motion is left without
 * inertia, so that the equations of motion have no solution. */
double model_lost(Pool *pool, const Model *model, double below);

/* ---- partial_evaluation.c: blocks with some of their inputs known */

/* Replacement of an input of a graph: numbers, one for each member of the graph's class; or another input or its
 * opposite. */
typedef struct Given {
    Element input;       /* ARRAY_none: the slot is free */
    const double *value; /* [members], or one where `alike`; NULL: `other` */
    bool alike;          /* all members have that number */
    Element other;
    bool negative;
} Given;

typedef struct Givens {
    Pool *pool;
    int count, room; /* room: a power of 2 */
    Given *given;    /* hash table */
} Givens;

Givens *givens_new(Pool *pool);
void givens_number(Givens *givens, double value, Element input);
void givens_numbers(Givens *givens, const double *value, Element input); /* [members] */
void givens_other(Givens *givens, Element input, Element other, bool negative);
const Given *givens_find(const Givens *givens, Element input);

/* A graph made anew from another one, node by node as blocks need them. */
typedef struct Partial {
    const Dag *from;
    Dag *to;
    const Givens *givens;
    const Plane *plane; /* NULL: the road is looked up */
    bool across;        /* the road is looked up once for both sides, and has no slope from one to the other */
    const Model *model;
    Normal *normal; /* of `to`, NULL: not needed yet */
    Ex *made;       /* [nodes of from] 1 + the node of `to`, 0: not yet */
} Partial;

Partial partial_new(Pool *pool, const Dag *from, const Givens *givens, const Plane *plane, bool across,
                    const Model *model);
/* The block with what is given folded in. Checks that constants satisfy are dropped. */
Block partial_block(Partial *partial, const Block *block);
/* True if a value of the block needs an operation of this kind. */
bool block_uses(const Block *block, Op op);

/* ---- specialize.c: a model's formulas for one scene */

/* specialize_mirror.c: sign, 1 or -1, that the mirror gives a wheel's fast state or a number of its grip[] (except the
 * contact point's y). */
double wheel_fast_sign(int state);
double wheel_grip_sign(int number);

/* As formulate, of an assembled model and its sequence; facts NULL: the same. */
const Formulation *formulate_narrow(Pool *pool, const Model *model, const Sequence *sequence, Solve solve,
                                    Recovery recovery, const Facts *facts);

/* ---- specialize_account.c */

/* The same with its account. drawn: the model before a scene made it one of a rig, or `model` as it was read. */
const Formulation *formulate_explained(Pool *pool, const Model *drawn, const Model *model, const Sequence *sequence,
                                       Solve solve, Recovery recovery, const Facts *facts);

/* What a scene does, of a formulation for one: inputs at a time, its road, its duration, times at which inputs begin to
 * move or stop [moments], and inputs that may have any value at any time [inputs]. */
typedef struct Validation {
    void (*inputs)(void *context, int32_t unused, double time, double *input);
    void *context;
    const gic_road *road; /* NULL: flat */
    double duration;
    const double *moment;
    int moments;
    const bool *free;
} Validation;

#endif
