/* SPDX-License-Identifier: MIT
 * Lane packing, between vehicle/lanes.c and vectorize.c. */
#ifndef EXPRESSION_VECTORIZE_H
#define EXPRESSION_VECTORIZE_H

#include "base/base.h"
#include "expression/expression.h"

/* An input that belongs to one track, `lanes` tracks beside each other being the lanes of a vector. Inputs of the same
 * colour, which is not 0, are the same thing in different tracks. */
typedef struct LaneInput {
    Element element;
    uint64_t colour;
    int track;  /* -1: none */
    bool fixed; /* always this value, and not in memory */
    double value;
} LaneInput;

/* vectorize_sums.c: which sums over lanes are made together: [sums] groups, -1: alone. order [wanted]: those that may
 * be, in the order in which they are needed. depth [sums]: how many others, one behind the other, a sum comes after;
 * sums of one depth don't wait for each other. */
int *fold_groups(Pool *pool, int sums, int wanted, const int *order, const int *depth, int lanes);
/* The sums over the lanes of so many vectors, one in each lane; behind them the last one again. */
Ex fold(Dag *dag, const Ex *vector, int count);

/* The same block with vectors of so many lanes for what it does alike to several tracks. */
Block *block_pack(Pool *pool, const Block *block, const LaneInput *input, int inputs, int lanes);

#endif
