/* SPDX-License-Identifier: MIT
 * Blocks of pivots that vanish nowhere but where the block's determinant does. A single entry of a matrix may be zero
 * in a configuration that is not singular at all (a direction that turns by a quarter loses a component); adjugates and
 * reflections need no entry to be anything. */
#include "expression/expression.h"
#include "expression/factorize.h"

#include <string.h>

/* The inverse of B, 2 x 2 or 3 x 3, is its adjugate over its determinant. */
static void add_adjugate(Dag *dag, Factors *f, int first, int size, const Ex *B)
{
    Ex adj[9];
    for (int i = 0; i < 3 && size == 3; ++i)
        for (int j = 0; j < 3; ++j) {
            /* entry (i, j) is the cofactor of (j, i) */
            const int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            adj[3 * i + j] =
                ex_sub(dag, ex_mul(dag, B[3 * r + c], B[3 * s + d]), ex_mul(dag, B[3 * r + d], B[3 * s + c]));
        }
    if (size == 2) {
        adj[0] = B[3];
        adj[1] = ex_neg(dag, B[1]);
        adj[2] = ex_neg(dag, B[2]);
        adj[3] = B[0];
    }
    Ex determinant = 0;
    for (int j = 0; j < size; ++j)
        determinant = ex_add(dag, determinant, ex_mul(dag, B[j], adj[size * j]));
    f->determinant[first] = determinant;
    f->reciprocal[first] = ex_div(dag, ex_literal(dag, 1), determinant);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            f->entry[f->n * (first + i) + first + j] = ex_mul(dag, f->reciprocal[first], adj[size * i + j]);
}

/* The reflection 1 - beta v v^T that takes x to a multiple of the first axis; v goes into x. Returns that multiple with
 * its sign reversed: the norm of x with the sign of x[0], so that v does not cancel. */
static Ex reflection(Dag *dag, int count, Ex *x, Ex *beta)
{
    Ex square = 0;
    for (int i = 0; i < count; ++i)
        square = ex_add(dag, square, ex_mul(dag, x[i], x[i]));
    const Ex norm = ex_sqrt(dag, square);
    const Ex length = ex_op(dag, OP_POSITIVE, x[0], norm, ex_neg(dag, norm));
    x[0] = ex_add(dag, x[0], length);
    *beta = ex_div(dag, ex_literal(dag, 1), ex_mul(dag, length, x[0]));
    return length;
}

static void reflect(Dag *dag, int count, const Ex *v, Ex beta, Ex *y, int stride)
{
    Ex along = 0;
    for (int i = 0; i < count; ++i)
        along = ex_add(dag, along, ex_mul(dag, v[i], y[i * stride]));
    along = ex_mul(dag, beta, along);
    for (int i = 0; i < count; ++i)
        y[i * stride] = ex_sub(dag, y[i * stride], ex_mul(dag, along, v[i]));
}

/* Householder's: reflections and, above the diagonal, R. Their determinants are -1, so that the sign of the block's
 * comes out. */
static void add_reflections(Dag *dag, Factors *f, int first, int size, const Ex *B, const double *row_scale)
{
    const int n = f->n;
    Ex A[size * size], v[size], determinant = ex_literal(dag, 1);
    for (int i = 0; i < size; ++i) {
        f->row_scale[first + i] = ex_literal(dag, row_scale[i]);
        for (int j = 0; j < size; ++j)
            A[size * i + j] = ex_mul(dag, f->row_scale[first + i], B[size * i + j]);
    }
    for (int k = 0; k < size; ++k) {
        const int count = size - k;
        Ex diagonal = A[size * k + k];
        for (int i = 0; i < count; ++i)
            v[i] = A[size * (k + i) + k];
        if (count > 1) {
            const Ex length = reflection(dag, count, v, &f->beta[first + k]);
            diagonal = ex_neg(dag, length);
            determinant = ex_mul(dag, determinant, length);
            for (int j = k + 1; j < size; ++j)
                reflect(dag, count, v, f->beta[first + k], &A[size * k + j], size);
        } else {
            determinant = ex_mul(dag, determinant, diagonal);
        }
        f->reciprocal[first + k] = ex_div(dag, ex_literal(dag, 1), diagonal);
        for (int i = 0; i < count && count > 1; ++i)
            f->entry[n * (first + k + i) + first + k] = v[i];
        for (int j = k + 1; j < size; ++j)
            f->entry[n * (first + k) + first + j] = A[size * k + j];
    }
    f->determinant[first] = determinant;
}

void factors_add_block(Dag *dag, Factors *f, int first, int size, const Ex *B, const double *row_scale)
{
    for (int i = 0; i < size; ++i)
        f->block[first + i] = first;
    if (size > 3) {
        add_reflections(dag, f, first, size, B, row_scale);
    } else if (size > 1) {
        add_adjugate(dag, f, first, size, B);
    } else {
        f->determinant[first] = B[0];
        f->reciprocal[first] = f->entry[f->n * first + first] = ex_div(dag, ex_literal(dag, 1), B[0]);
    }
}

static void solve_inverse(Dag *dag, const Factors *f, int first, int end, bool transposed, Ex *y)
{
    Ex x[3] = {0};
    for (int i = first; i < end; ++i)
        for (int j = first; j < end; ++j)
            x[i - first] =
                ex_add(dag, x[i - first], ex_mul(dag, f->entry[transposed ? f->n * j + i : f->n * i + j], y[j]));
    memcpy(y + first, x, (size_t)(end - first) * sizeof *x);
}

/* y becomes Q^T y (backward: Q y) */
static void apply_reflections(Dag *dag, const Factors *f, int first, int end, bool backward, Ex *y)
{
    Ex v[end - first];
    for (int step = first; step < end - 1; ++step) {
        const int k = backward ? first + end - 2 - step : step;
        for (int i = k; i < end; ++i)
            v[i - k] = f->entry[f->n * i + k];
        reflect(dag, end - k, v, f->beta[k], y + k, 1);
    }
}

void factors_solve_block(Dag *dag, const Factors *f, int first, int end, Ex *y)
{
    if (end - first <= 3) {
        solve_inverse(dag, f, first, end, false, y);
        return;
    }
    for (int k = first; k < end; ++k)
        y[k] = ex_mul(dag, f->row_scale[k], y[k]);
    apply_reflections(dag, f, first, end, false, y);
    for (int k = end - 1; k >= first; --k) {
        for (int j = k + 1; j < end; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[f->n * k + j], y[j]));
        y[k] = ex_mul(dag, y[k], f->reciprocal[k]);
    }
}

void factors_solve_block_transposed(Dag *dag, const Factors *f, int first, int end, Ex *y)
{
    if (end - first <= 3) {
        solve_inverse(dag, f, first, end, true, y);
        return;
    }
    for (int k = first; k < end; ++k) {
        for (int j = first; j < k; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[f->n * j + k], y[j]));
        y[k] = ex_mul(dag, y[k], f->reciprocal[k]);
    }
    apply_reflections(dag, f, first, end, true, y);
    for (int k = first; k < end; ++k)
        y[k] = ex_mul(dag, f->row_scale[k], y[k]);
}
