/* SPDX-License-Identifier: MIT
 * What the files that factor matrices of expressions share. */
#ifndef EXPRESSION_FACTORIZE_H
#define EXPRESSION_FACTORIZE_H

#include "expression/expression.h"

/* Factors of an n x n matrix, all zero, every pivot a block of its own. */
Factors *factors_new(Dag *dag, int n, bool symmetric);
/* Index after the block that begins with pivot `first`. */
int factors_block_end(const Factors *f, int first);
/* y [n], in pivot order, becomes the solution. */
void factors_solve_symmetric(Dag *dag, const Factors *f, Ex *y);

/* Other nodes stand for those of the systems that are remembered: image [nodes]; a node that is its own image follows
 * from the images of its arguments. */
void systems_replace(Dag *dag, const Ex *image, int nodes);

/* factorize_block.c: B [size][size], with nonzero determinant, as a block of pivots from `first` on: its inverse into
 * `entry` (sizes 2 and 3), or a QR factorization (more). row_scale [size]: powers of two that make rows comparable. */
void factors_add_block(Dag *dag, Factors *f, int first, int size, const Ex *B, const double *row_scale);
/* y[first .. end - 1] becomes B^-1 y or, transposed, B^-T y. */
void factors_solve_block(Dag *dag, const Factors *f, int first, int end, Ex *y);
void factors_solve_block_transposed(Dag *dag, const Factors *f, int first, int end, Ex *y);

#endif
