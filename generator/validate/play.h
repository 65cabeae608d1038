/* SPDX-License-Identifier: MIT
 *
 * Blocks evaluated at several states side by side. */
#ifndef VALIDATE_PLAY_H
#define VALIDATE_PLAY_H

#include "expression/expression.h"
#include "gic_runtime.h"

/* The number of states side by side; one number of each. */
enum { STATES = 8 };
typedef double Values[STATES];

/* Arrays that blocks read and write, by their C names. After them m0, m1, ... and w0, w1, ... of a class. */
#define PLAY_ARRAYS(X) \
    X(time) \
    X(y) \
    X(e) \
    X(x) \
    X(xd) \
    X(u) \
    X(m) \
    X(n) \
    X(p) \
    X(port) \
    X(rate) \
    X(acc) \
    X(out) \
    X(pose) \
    X(tau) \
    X(energy) \
    X(press) \
    X(lambda) \
    X(link) \
    X(fast) \
    X(torque) \
    X(contact) \
    X(force) \
    X(grip) \
    X(gear) \
    X(watch) \
    X(choice) \
    X(q) X(change) X(turn) X(ahead) X(s) X(f) X(start) X(motion) X(inertia) X(reach) X(step) X(worst) X(w) X(d) X(rest)
#define PLAY_ENUM(name) PLAY_##name,
enum { PLAY_ARRAYS(PLAY_ENUM) PLAY_DERIVED, PLAY_GRIP, PLAY_WATCH, PLAY_KNOWN };
#undef PLAY_ENUM

/* Place of an array: its number i is row[stride * i]. */
typedef struct Binding {
    Values *row;
    int stride;
} Binding;

typedef struct Program Program;

/* Translate a block. knowns: largest number of m0, m1, ...; as many w0, w1, ... follow. */
const Program *play_record(Pool *pool, const Block *block, int knowns);
/* The number of rows of its frame. */
int play_rows(const Program *program);

/* Inputs besides numbers, and refused[]: the status of a check that failed, else NULL. */
typedef struct Scenery {
    const gic_table *table;
    const gic_road *road; /* NULL: flat */
    const double *time;   /* [STATES] time of the road */
    const char *refused[STATES];
} Scenery;

/* Evaluate a block for one member of its class. It stores at all states; results at refused ones have no meaning.
 * frame: play_rows() rows. */
void play(const Program *program, int member, const Binding *array, Scenery *scenery, Values *frame);

#endif
