/* SPDX-License-Identifier: MIT
 * Rank of a matrix of numbers, by elimination with full pivoting. */
#ifndef SEQUENCE_RANK_H
#define SEQUENCE_RANK_H

/* Rank of A [rows][n], whose entries are about 1 at most: the number of pivots above `zero`. A is overwritten; its rows
 * from the rank on are below `zero`. combination [rows][rows]: each of the resulting rows as a combination of the rows
 * of A; NULL: not wanted. *least: the smallest pivot, 1 if there is none; NULL: not wanted. */
int matrix_rank(int rows, int n, double zero, double *A, double *combination, double *least);

#endif
