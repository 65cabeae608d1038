/* SPDX-License-Identifier: MIT
 *
 * The generator's own expression graph interpreted: the same operations in the same order of every sum and product as
 * the generated code, so that results agree bit for bit, and no compiler is needed. */
#ifndef TAPE_H
#define TAPE_H

#include "../generator/gicgen.h"
#include "gic_runtime.h"

/* What a tape can do beyond the graph's own operations: a product and a sum in one, each rounded. */
enum { TAPE_MUL_ADD = OP_COUNT, TAPE_MUL_SUB, TAPE_SUB_MUL, TAPE_KINDS };

/* So many operations of one kind, one after the other. */
typedef struct TapeRun {
    int kind, count;
} TapeRun;

/* `count` numbers between place `offset` of an array and the frame. */
typedef struct TapeMove {
    int array, offset, slot, count;
} TapeMove;

typedef struct TapeCheck {
    int slot;
    double least;
    bool magnitude;
    int status, condition; /* where the number is not above `least`; GIC_ERROR_GEOMETRY: about which condition */
} TapeCheck;

/* A block ready to run. Its numbers live in a frame: constants, inputs, then what is computed, in slots that are used
 * again. Operands are slots: the result, then the arguments; OP_TABLE has its index and OP_ROAD three results. */
typedef struct Tape {
    int slots, constants;
    double *constant; /* [members][constants] */
    int loads, runs, checks, stores;
    TapeMove *load, *store;
    TapeRun *run;
    uint32_t *operand;
    TapeCheck *check;
} Tape;

/* What a tape needs besides numbers. */
typedef struct TapeWorld {
    const gic_table *table;
    const gic_road *road; /* NULL: flat at z = 0 */
    int32_t lane;
    double time;
    int32_t *condition; /* where a check that is about a condition says which; only blocks at set-up have such */
} TapeWorld;

/* tape.c. `array` names what the block reads and writes as in `array[i]`, or `array` alone; tape_play() takes their
 * addresses in the same order. */
const Tape *tape_record(Pool *pool, const Block *block, const char *const *array, int arrays);

/* tape_play.c: compute a block for one member of its class. Nothing is stored on another status than GIC_OK. frame: at
 * least `slots` numbers. */
int tape_play(const Tape *tape, int member, double *const *array, const TapeWorld *world, double *frame);

#endif
