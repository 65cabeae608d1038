/* SPDX-License-Identifier: MIT
 *
 * Code for one scene: what is known about a whole run beforehand, and the formulas that are left of a model then. */
#ifndef NARROW_H
#define NARROW_H

#include "gicgen.h"

/* ---- partial.c: blocks with some of their inputs known ---------------------------------------------------------- */

/* What stands for an input of a graph, by its C name: numbers, one for each member of the graph's class; or another
 * input or its opposite. */
typedef struct Given {
    const char *name;
    const double *value; /* [members], or NULL: `other` */
    const char *other;
    bool negative;
} Given;

typedef struct Givens {
    Pool *pool;
    int count, room; /* room: a power of 2 */
    Given *given;    /* hash table */
} Givens;

Givens *givens_new(Pool *pool);
void givens_number(Givens *givens, double value, const char *format, ...) __attribute__((format(printf, 3, 4)));
void givens_numbers(Givens *givens, const double *value, const char *name); /* [members] */
void givens_other(Givens *givens, const char *name, const char *other, bool negative);
const Given *givens_find(const Givens *givens, const char *name);

/* A road that is a plane of constant friction. */
typedef struct Plane {
    double height, slope[2], friction; /* height at x = y = 0 */
} Plane;

/* A graph made anew from another one, node by node as blocks need them. */
typedef struct Partial {
    const Dag *from;
    Dag *to;
    const Givens *givens;
    const Plane *plane;   /* NULL: the road is looked up */
    const Table *table;   /* of the model */
    Ex *made;             /* [nodes of from] 1 + the node of `to`, 0: not yet */
} Partial;

Partial partial_new(Pool *pool, const Dag *from, const Givens *givens, const Plane *plane, const Model *model);
/* The block with what is given folded in. Checks that constants satisfy are dropped. */
Block partial_block(Partial *partial, const Block *block);
/* Does any value of the block need an operation of this kind? */
bool block_uses(const Block *block, Op op);

/* ---- narrow.c: a model's formulas for one scene ------------------------------------------------------------------ */

/* What is known about a whole run. Nothing of it is taken on trust: generated code checks at run time what inputs,
 * parameters, ports, road and state could break, and ends a call with GIC_ERROR_ASSUMPTION. */
typedef struct Facts {
    const char *scene;       /* its name */
    const bool *wanted;      /* [outputs] NULL: all */
    const bool *fixed;       /* [inputs] those that keep the value input[] */
    const double *input;     /* [inputs] */
    const double *parameter; /* [tunables] their values; NULL: they may change */
    bool idle;               /* nobody uses ports */
    bool neutral;            /* the transmission is in neutral all along */
    const Plane *plane;      /* the road; NULL: any */
} Facts;

/* What generated code checks: for people, and a condition in C that is true where it is broken. */
typedef struct Assumption {
    const char *text, *broken;
} Assumption;

struct Narrowing {
    const Facts *facts;
    int assumptions;
    Assumption *assumption;
    bool *steady; /* [subsets] nothing about it ever changes: recovered at set-up */
    bool road, friction, tables; /* are they still looked up? */
};

/* Is a subset recovered at set-up alone? narrowing may be NULL. */
bool narrowing_steady(const Narrowing *narrowing, int subset);

/* As formulate, of an assembled model and its sequence; facts NULL: the same. */
const Formulation *formulate_narrow(Pool *pool, const Model *model, const Sequence *sequence, Solve solve,
                                    Recovery recovery, const Facts *facts);

#endif
