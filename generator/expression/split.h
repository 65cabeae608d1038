/* SPDX-License-Identifier: MIT
 * A block in parts that are computed one after another, perhaps much later. */
#ifndef EXPRESSION_SPLIT_H
#define EXPRESSION_SPLIT_H

#include "expression/expression.h"

/* Work of a block, in additions. */
int block_work(const Block *block);
/* Parts of about `most` work each, in the order of the stores; returns how many, in *part. What one part computes and a
 * later one reads is stored in array[*kept], and *kept counts on. Without vectors and checks. */
int block_split(const Block *block, int most, Array array, int *kept, Block **part);

#endif
