/* SPDX-License-Identifier: MIT
 * One class of subsets while its formulas are made: shared by subset.c, follow.c and inertia.c alone. */
#ifndef GICGEN_SUBSET_H
#define GICGEN_SUBSET_H

#include "gicgen.h"

/* An end of a joint: what it is attached to. */
typedef struct End {
    int unknown; /* local index of an unknown body, or -1 */
    int known;   /* index among the knowns, or -1; both -1: the base */
} End;

/* One joint or dual coordinate of the class. */
typedef struct Connection {
    bool is_coordinate;
    int index; /* joint or coordinate of the first member */
    End end[2];
    Fixture fixture;
    int dep; /* coordinate: its place among the deps */
} Connection;

typedef struct Work {
    Pool *pool;
    const Model *model;
    const Sequence *sequence;
    const Class *class;
    const Subset *first; /* first member */
    const double (*origin)[3];
    Dag *dag;
    int n; /* 6 a body */
    int connections;
    Connection *connection;
    Ex *q;        /* [7 bodies] */
    Motion *pose; /* of the unknowns: c and A only, at q */
    Motion *known;
    Motion base;
    Ex *x, *rate, *change;
    double size;    /* see Formula */
    Row *row;       /* [n] equations with the unknowns at q and at rest */
    int *row_of;    /* [n] connection that a row belongs to */
    Ex *J;          /* [n][n] Jacobian by the unknown twists */
    int configurations;
    bool *alive;    /* [samples] reached the end of its path */
} Work;

/* Subset of the i-th member. */
const Subset *subset_member(const Work *w, int i);
/* A constant of the class from every member's number. */
Ex subset_constant(Work *w, double (*get)(const Work *, int member, int a, int b), int a, int b);

/* follow.c: take one member through its sample paths. Sets the graph's samples of that member to the ends of the paths, w->alive, and what
 * later subsets need of it in `sampling`. */
void subset_follow(Work *w, Sampling *sampling, int member);

/* inertia.c: store what the bodies, moving as given, add to the equations of motion. */
void subset_inertia(Work *w, const Layout *layout, const Motion *motion, Block *block);

#endif
