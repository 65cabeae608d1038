/* SPDX-License-Identifier: MIT
 * Lane packing, between vehicle/lanes.c and vectorize.c. */
#ifndef EXPRESSION_VECTORIZE_H
#define EXPRESSION_VECTORIZE_H

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

/* vectorize_sums.c: group the sums over lanes that are added together. Returns [sums] group of each, -1: alone. order
 * [wanted]: sums that may be grouped, in the order in which they are needed. depth [sums]: length of the longest chain
 * of sums that a sum depends on; sums of one depth do not depend on each other. */
int *fold_groups(Pool *pool, int sums, int wanted, const int *order, const int *depth, int lanes);
/* The sums over the lanes of `count` vectors, one sum in each lane; further lanes repeat the last one. */
Ex fold(Dag *dag, const Ex *vector, int count);

/* The block with operations that are alike in several tracks packed into vectors of `lanes` lanes. */
Block *block_pack(Pool *pool, const Block *block, const LaneInput *input, int inputs, int lanes);

#endif
