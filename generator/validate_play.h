/* SPDX-License-Identifier: MIT
 *
 * Blocks evaluated at several states side by side. */
#ifndef VALIDATE_PLAY_H
#define VALIDATE_PLAY_H

#include "gicgen.h"

#include "../runtime/gic_runtime.h"

/* So many states side by side, and one number of each. */
enum { STATES = 8 };
typedef double Values[STATES];

/* Arrays that blocks read and write, by their C names. Behind them m0, m1, ... and w0, w1, ... of a class. */
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
    X(lambda) \
    X(link) \
    X(fast) \
    X(torque) \
    X(hub) \
    X(force) \
    X(grip) \
    X(gear) \
    X(watch) \
    X(choice) \
    X(q) X(change) X(turn) X(ahead) X(s) X(f) X(start) X(motion) X(inertia) X(reach) X(step) X(worst) X(w) X(d) X(rest)
#define PLAY_ENUM(name) PLAY_##name,
enum { PLAY_ARRAYS(PLAY_ENUM) PLAY_DERIVED, PLAY_GRIP, PLAY_WATCH, PLAY_KNOWN };
#undef PLAY_ENUM

/* Where an array is: number i of it in row[stride * i]. */
typedef struct Binding {
    Values *row;
    int stride;
} Binding;

typedef struct Program Program;

/* A block made ready. knowns: how many m0, m1, ... there are at most; as many w0, w1, ... stand behind them. */
const Program *play_record(Pool *pool, const Block *block, int knowns);
/* How many rows it works in. */
int play_rows(const Program *program);

/* What it needs besides numbers; refused: where a check fails, what it returns, else NULL. */
typedef struct Scenery {
    const gic_table *table;
    const gic_road *road; /* NULL: flat */
    const double *time;   /* [STATES] of the road */
    const char *refused[STATES];
} Scenery;

/* Compute a block for one member of its class. Stores are made at all states, what is stored at refused ones means
 * nothing. frame: play_rows() rows. */
void play(const Program *program, int member, const Binding *array, Scenery *scenery, Values *frame);

#endif
