/* SPDX-License-Identifier: MIT
 * Straight-line factorizations L D L^T of symmetric matrices of expressions, which need no search for pivots. */
#include "expression/expression.h"
#include "expression/factorize.h"

#include <string.h>

/* Entries of the rest that row i touches: its elimination costs the square. */
static int degree(const Dag *dag, int n, const Ex *A, const bool *done, int i)
{
    int count = 0;
    for (int j = 0; j < n; ++j)
        count += !done[j] && !ex_is(dag, A[n * i + j], 0);
    return count;
}

/* Pivots first .. first + size - 1 as one block B of the rest A: adj(B) into A. */
static void adjugate_block(Dag *dag, int n, Ex *A, Factors *f, int first, int size)
{
    Ex B[3][3], adj[3][3];
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            B[i][j] = A[n * f->row[first + i] + f->row[first + j]];
    for (int i = 0; i < 3; ++i)
        for (int j = i; size == 3 && j < 3; ++j) {
            const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            adj[i][j] = adj[j][i] = ex_sub(dag, ex_mul(dag, B[r][c], B[s][d]), ex_mul(dag, B[r][d], B[s][c]));
        }
    if (size == 2) {
        adj[0][0] = B[1][1];
        adj[1][1] = B[0][0];
        adj[0][1] = adj[1][0] = ex_neg(dag, B[0][1]);
    }
    f->determinant[first] = size == 3 ? ex_dot(dag, B[0], adj[0])
                                      : ex_sub(dag, ex_mul(dag, B[0][0], B[1][1]), ex_mul(dag, B[0][1], B[0][1]));
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            A[n * f->row[first + i] + f->row[first + j]] = adj[i][j];
}

/* The rest less what a block takes from it, A - U^T (adj B / det B) U; adj(B) U into the block's rows and, transposed,
 * columns. The quotient comes last, so that it is there when the products are. */
static void eliminate_block(Dag *dag, int n, Ex *A, const Factors *f, const bool *done, int first, int size)
{
    Ex scaled[3][n];
    for (int c = 0; c < n; ++c)
        for (int i = 0; !done[c] && i < size; ++i) {
            scaled[i][c] = 0;
            for (int j = 0; j < size; ++j)
                scaled[i][c] =
                    ex_add(dag, scaled[i][c],
                           ex_mul(dag, A[n * f->row[first + i] + f->row[first + j]], A[n * f->row[first + j] + c]));
        }
    for (int r = 0; r < n; ++r)
        for (int c = r; !done[r] && c < n; ++c) {
            Ex sum = 0;
            for (int j = 0; !done[c] && j < size; ++j)
                sum = ex_add(dag, sum, ex_mul(dag, A[n * f->row[first + j] + r], scaled[j][c]));
            if (!done[c])
                A[n * r + c] = A[n * c + r] = ex_sub(dag, A[n * r + c], ex_mul(dag, f->reciprocal[first], sum));
        }
    for (int c = 0; c < n; ++c)
        for (int i = 0; !done[c] && i < size; ++i)
            A[n * f->row[first + i] + c] = A[n * c + f->row[first + i]] = scaled[i][c];
}

static void eliminate_symmetric(Dag *dag, int n, Ex *A, const Factors *f, const bool *done, int k)
{
    const int own = f->row[k];
    for (int r = 0; r < n; ++r) {
        if (done[r] || ex_is(dag, A[n * r + own], 0))
            continue;
        Ex multiplier = ex_mul(dag, A[n * r + own], f->reciprocal[k]);
        for (int c = r; c < n; ++c)
            if (!done[c])
                A[n * r + c] = A[n * c + r] = ex_sub(dag, A[n * r + c], ex_mul(dag, multiplier, A[n * own + c]));
        A[n * r + own] = multiplier;
    }
    for (int c = 0; c < n; ++c)
        if (!done[c])
            A[n * own + c] = A[n * c + own];
}

Factors *linear_factor_symmetric(Dag *dag, int n, const Ex *A0, const int *order, int blocked)
{
    Factors *f = factors_new(dag, n, true);
    Ex *A = pool_alloc(dag->pool, (size_t)(n * n) * sizeof *A);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            A[n * i + j] = i <= j ? A0[n * i + j] : A0[n * j + i];
    f->matrix = pool_grow(dag->pool, A, (size_t)(n * n) * sizeof *A, (size_t)(n * n) * sizeof *A);
    bool done[n];
    memset(done, 0, sizeof done);
    for (int k = 0, size; k < n; k += size) {
        const int left = blocked - (n - blocked < k ? k - (n - blocked) : 0);
        size = k < n - blocked || left == 1 ? 1 : left < 3 ? left : 3;
        for (int own = k; own < k + size; ++own) {
            int best = order ? order[own] : -1, best_cost = 0;
            for (int i = 0; i < n && !order; ++i) {
                int cost = done[i] ? 0 : degree(dag, n, A, done, i);
                if (!done[i] && (best < 0 || cost < best_cost))
                    best = i, best_cost = cost;
            }
            done[best] = true;
            f->row[own] = f->column[own] = best;
            f->block[own] = k;
        }
        for (int own = k; own < k + size; ++own)
            f->pivot[own] = A[n * f->row[own] + f->row[own]];
        f->determinant[k] = f->pivot[k];
        if (size > 1)
            adjugate_block(dag, n, A, f, k, size);
        f->reciprocal[k] = ex_div(dag, ex_literal(dag, 1), f->determinant[k]);
        if (size > 1) {
            eliminate_block(dag, n, A, f, done, k, size);
        } else {
            A[n * f->row[k] + f->row[k]] = f->reciprocal[k];
            eliminate_symmetric(dag, n, A, f, done, k);
        }
    }
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            f->entry[n * k + j] = A[n * f->row[k] + f->column[j]];
    return f;
}

/* y[k] less what the pivots first .. end - 1, a block, take from it. */
static Ex less_block(Dag *dag, const Factors *f, const Ex *y, int k, int first, int end)
{
    Ex sum = 0;
    for (int j = first; j < end; ++j)
        sum = ex_add(dag, sum, ex_mul(dag, f->entry[f->n * k + j], y[j]));
    return ex_sub(dag, y[k], end - first > 1 ? ex_mul(dag, f->reciprocal[first], sum) : sum);
}

void factors_solve_symmetric(Dag *dag, const Factors *f, Ex *y)
{
    const int n = f->n;
    for (int k = 0; k < n; ++k)
        for (int first = 0, end; first < f->block[k]; first = end) {
            end = factors_block_end(f, first);
            y[k] = less_block(dag, f, y, k, first, end);
        }
    for (int first = n > 0 ? f->block[n - 1] : -1; first >= 0; first = first ? f->block[first - 1] : -1) {
        const int end = factors_block_end(f, first);
        const bool alone = end - first == 1;
        Ex x[3] = {0};
        for (int k = first; k < end; ++k) {
            for (int j = first; j < end; ++j)
                x[k - first] = ex_add(dag, x[k - first], ex_mul(dag, y[j], f->entry[n * k + j]));
            for (int j = end; j < n; ++j)
                x[k - first] = ex_sub(dag, x[k - first], ex_mul(dag, f->entry[n * k + j], y[j]));
        }
        for (int k = first; k < end; ++k)
            y[k] = alone ? x[k - first] : ex_mul(dag, f->reciprocal[first], x[k - first]);
    }
}
