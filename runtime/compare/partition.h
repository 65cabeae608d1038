/* SPDX-License-Identifier: MIT
 *
 * Generalized coordinate partitioning (Wehage and Haug 1982): independent coordinates picked from q by Gaussian
 * elimination of the constraint Jacobian with full pivoting, and the sparse factorization of the dependent block
 * Phi_u that goes with the choice (KLU: block triangular form, symbolic work once a choice, no allocation between
 * choices). */
#ifndef COMPARE_PARTITION_H
#define COMPARE_PARTITION_H

#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* Most coordinates in one equation: those of two bodies, or of ten that a gear or coupler has to do with. */
enum { PARTITION_WIDTH = 70 };

/* value: where the caller keeps the numbers; they are read whenever they are needed. */
typedef struct PartitionRow {
    int count, column[PARTITION_WIDTH];
    const double *value[PARTITION_WIDTH];
} PartitionRow;

typedef struct Partition {
    int rows, columns;       /* equations, coordinates; rows <= columns */
    const PartitionRow *row; /* Phi_q */
    int *dependent;          /* [rows] columns of the dependent coordinates, u */
    double *chosen;          /* [columns] 1: independent, 0: dependent, -1: no choice yet; an instance remembers it */
    double usual;            /* largest partition_amplification() when it was chosen, at least 1 */
    struct PartitionFactors *factors;
    double *dense; /* [rows][columns], and in the search for pivots the largest entry of each remaining row and its
                    * column */
    int *row_left, *column_left, *largest_at;
    double *largest;
} Partition;

/* No choice is made yet. `row` is kept. */
Partition *partition_new(Pool *pool, int rows, int columns, const PartitionRow *row);
/* Choose by the present values, analyse and factor. False where the equations are dependent; then nothing is chosen. */
bool partition_choose(Partition *partition);
/* Make the choice `chosen` [columns] of an earlier time, when `usual` was found. False where Phi_u is singular at the
 * present values; then nothing is chosen. */
bool partition_adopt(Partition *partition, const double *chosen, double usual);
/* Factor Phi_u of the present values with the pivots of the choice. False where it is singular. */
bool partition_factor(Partition *partition);
/* b [rows] becomes Phi_u^-1 b, in the order of `dependent`. */
void partition_solve(Partition *partition, double *b);
/* How much the dependent coordinates change with the i-th independent one (i counts on modulo their number): largest of
 * a column of Phi_u^-1 Phi_v, by the present values and the last factors. It grows as Phi_u degrades, long before a
 * pivot tells. */
double partition_amplification(Partition *partition, int64_t i);
/* As before the first choice. */
void partition_forget(Partition *partition);
/* Give back what doesn't come from the pool. */
void partition_close(Partition *partition);

#endif
