/* SPDX-License-Identifier: MIT
 *
 * Code for one scene: what is known about a whole run beforehand, and the formulas that are left of a model then. */
#ifndef NARROW_H
#define NARROW_H

#include "normal.h"

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
    const Plane *plane; /* NULL: the road is looked up */
    bool across;        /* it is looked up once for both sides, and level from one to the other */
    const Model *model;
    Normal *normal; /* of `to`, NULL: not needed yet */
    Ex *made;       /* [nodes of from] 1 + the node of `to`, 0: not yet */
} Partial;

Partial partial_new(Pool *pool, const Dag *from, const Givens *givens, const Plane *plane, bool across,
                    const Model *model);
/* The block with what is given folded in. Checks that constants satisfy are dropped. */
Block partial_block(Partial *partial, const Block *block);
/* Does any value of the block need an operation of this kind? */
bool block_uses(const Block *block, Op op);

/* ---- narrow.c: a model's formulas for one scene ------------------------------------------------------------------ */

/* What is known about a whole run. Nothing of it is taken on trust: generated code checks at run time what inputs,
 * parameters, ports, road and state could break, and ends a call with GIC_ERROR_ASSUMPTION. */
typedef struct Facts {
    const char *scene;     /* its name */
    double massless, lost; /* bodies below so many kg have lost their mass, see model_lost(); 0: none has */
    const char *massless_names;
    const bool *wanted;      /* [outputs] NULL: all */
    const bool *fixed;       /* [inputs] those that keep the value input[] */
    const double *input;     /* [inputs] */
    const double *parameter; /* [tunables] their values; NULL: they may change */
    bool idle;               /* nobody uses ports */
    bool neutral;            /* the transmission is in neutral all along */
    const Plane *plane;      /* the road; NULL: any, */
    bool across;             /* but this: height and friction don't depend on y */
    const char *asymmetry;   /* what is not the same to both sides; NULL: the base's motion and the road are */
    const double *value, *rate, *state; /* [coordinates] [fast states] at the beginning; state NAN: as wheels roll */
} Facts;

/* What the condition of an assumption reads: what belongs to the caller, the slow state `y`, the fast one `fast`; the
 * road is seen where it is looked up. */
typedef enum AssumptionAbout { ABOUT_CALLER, ABOUT_STATE, ABOUT_FAST, ABOUT_ROAD } AssumptionAbout;

/* What generated code checks: for people, and a condition in C that is true where it is broken. */
typedef struct Assumption {
    AssumptionAbout about;
    const char *text, *broken;
} Assumption;

/* What is known or refused, why, and the operations that are left with it and all before it. */
typedef struct AccountRow {
    const char *what, *why;
    Count rhs, outputs;
} AccountRow;

typedef struct Account {
    int rows;
    AccountRow *row;
} Account;

struct Narrowing {
    const Facts *facts;
    int assumptions;
    Assumption *assumption;
    const int *image;      /* [subsets] the one whose mirror image it is, -1: none's; NULL: both sides are computed */
    const int *wheel;      /* [wheels] the same */
    const char *asymmetry; /* why both are; NULL: they are not */
    bool *steady;          /* [subsets] nothing about it ever changes: recovered at set-up */
    bool road, friction, tables; /* are they still looked up? */
    const Account *account;      /* NULL: nobody asked */
};

/* Is a subset recovered at set-up alone; is it, or a wheel, the image of another? narrowing may be NULL. */
bool narrowing_steady(const Narrowing *narrowing, int subset);
bool narrowing_image(const Narrowing *narrowing, int subset);
bool narrowing_wheel_image(const Narrowing *narrowing, int wheel);

/* narrow_mirror.c: what a mirror makes of a wheel's fast state, of a number of its grip[] (but the contact point's y):
 * its sign. */
double wheel_fast_sign(int state);
double wheel_grip_sign(int number);

/* As formulate, of an assembled model and its sequence; facts NULL: the same. */
const Formulation *formulate_narrow(Pool *pool, const Model *model, const Sequence *sequence, Solve solve,
                                    Recovery recovery, const Facts *facts);

/* ---- narrow_account.c ----------------------------------------------------------------------------------------------
 */

/* The same with its account. drawn: the model before a scene made it one of a rig, or `model` as it was read. */
const Formulation *formulate_explained(Pool *pool, const Model *drawn, const Model *model, const Sequence *sequence,
                                       Solve solve, Recovery recovery, const Facts *facts);

#endif
