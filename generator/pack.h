/* SPDX-License-Identifier: MIT
 * Lane packing, between lanes.c and pack.c. */
#ifndef GICGEN_PACK_H
#define GICGEN_PACK_H

#include "gicgen.h"

/* An input that belongs to one track, `lanes` tracks beside each other being the lanes of a vector. Inputs of the same
 * colour, which is not 0, are the same thing in different tracks. */
typedef struct LaneInput {
    const char *name;
    uint64_t colour;
    int track;  /* -1: none */
    bool fixed; /* always this value, and not in memory */
    double value;
} LaneInput;

/* The same block with vectors of so many lanes for what it does alike to several tracks. */
Block *block_pack(Pool *pool, const Block *block, const LaneInput *input, int inputs, int lanes);

#endif
