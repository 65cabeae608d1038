/* SPDX-License-Identifier: MIT
 *
 * The generator's own expression graph interpreted: the same operations in the same order of every sum and product as
 * the generated code, so that results agree bit for bit, and no compiler is needed. */
#ifndef TAPE_RECORD_H
#define TAPE_RECORD_H

#include "expression/expression.h"
#include "gic_runtime.h"

/* Operations of a tape that graphs do not have: a product and a sum in one, each rounded. */
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
    int status;                   /* where the number is not above `least` */
    int condition, subset, state; /* that it is about, -1: none */
} TapeCheck;

/* A block ready to run. Its numbers live in a frame: constants, inputs, then results, in slots that are reused.
 * Operands are slots: the result, then the arguments; OP_TABLE has its index and OP_ROAD three results. */
typedef struct Tape {
    int slots, constants;
    double *constant; /* [members][constants] */
    int arrays, loads, runs, checks, stores;
    TapeMove *load, *store;
    TapeRun *run;
    uint32_t *operand;
    TapeCheck *check;
} Tape;

/* Tables, road and counters that a tape uses besides numbers. */
typedef struct TapeWorld {
    const gic_table *table;
    const gic_road *road; /* NULL: flat at z = 0 */
    int32_t lane;
    double time;
    gic_head *head; /* checks store their subset and number of the state here; NULL: no check has any */
    double near;    /* of tape_play_dual(): a kink counts as met where this share of the direction reaches it; below 0:
                       nowhere */
    int *kinks;     /* counts kinks that were met; NULL: not counted */
    struct TapeJournal *journal; /* of tape_play_dual(), which notes the tape in it and has no derivatives itself:
                                    journal.h; NULL: derivatives along a direction */
} TapeWorld;

/* record.c. `array`: an element of each array that the block reads and writes; tape_play() takes the addresses of the
 * arrays in the same order. */
const Tape *tape_record(Pool *pool, const Block *block, const Element *array, int arrays);

/* play.c: compute a block for one member of its class. Nothing is stored on another status than GIC_OK. frame: at
 * least `slots` numbers. */
int tape_play(const Tape *tape, int member, double *const *array, const TapeWorld *world, double *frame);

/* The same file, the parts of playing: inputs from the arrays, results to them, the status that the checks give; and
 * height and slopes of the road under a point, false when they are not finite numbers. */
void tape_load(const Tape *tape, double *const *array, double *frame);
void tape_store(const Tape *tape, double *const *array, const double *frame);
int tape_checked(const Tape *tape, const TapeWorld *world, const double *frame);
bool tape_road(const TapeWorld *world, double x, double y, double out[3]);
double tape_friction(const TapeWorld *world, double x, double y);

/* play_dual.c: the same with derivatives along one direction: `slope` has an array of derivatives for each array of
 * values, `rate` as many numbers as `frame`. Values are those of tape_play() to the bit where
 * no kink is met. A kink (of abs, min, max, conditions, linear tables) is met where the state is at it but for
 * world->near: the derivative is then the one-sided one along the direction, and a condition has the value of that
 * side. Elsewhere it is that of the branch that is taken. Constants and what no array holds have none. */
int tape_play_dual(const Tape *tape, int member, double *const *array, double *const *slope, const TapeWorld *world,
                   double *frame, double *rate);

#endif
