/* SPDX-License-Identifier: MIT
 * Splits classes whose members need different pivots, so that numbers which are 0 or 1 in one member can be so in
 * its code. An unsplit class is correct as well: its factorization depends on no single pivot
 * (expression/factorize_block.c). */
#include "expression/expression.h"
#include "sequence/sequence.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

/* J of the members at the design, rows scaled to largest entries of 1: [members][n][n]. */
static double *design_jacobians(const Work *w)
{
    const size_t n = (size_t)w->n, members = (size_t)w->class->members;
    double *J = pool_alloc(w->pool, members * n * n * sizeof *J), *row = J;
    for (size_t m = 0; m < members; ++m)
        for (size_t i = 0; i < n; ++i, row += n) {
            double largest = 0;
            for (size_t j = 0; j < n; ++j) {
                row[j] = ex_value(w->dag, w->J[n * i + j], (int)m * w->configurations) / (j % 6 < 3 ? w->size : 1);
                largest = fmax(largest, fabs(row[j]));
            }
            for (size_t j = 0; j < n; ++j)
                row[j] /= largest > 0 ? largest : 1;
        }
    return J;
}

static void eliminate(int n, double *A, int row, int column, const bool *row_done)
{
    for (int i = 0; i < n; ++i) {
        const double multiplier = A[n * i + column] / A[n * row + column];
        for (int j = 0; i != row && !row_done[i] && multiplier != 0 && j < n; ++j)
            A[n * i + j] -= multiplier * A[n * row + j];
    }
}

/* True if one order of pivots serves these members of a class: entries that are 0 or 1 in one are so in all. */
static bool share_pivots(Work *w, const bool *with)
{
    const double rounding = 1e-9;
    const int n = w->n;
    bool row_done[n], column_done[n];
    double *J = design_jacobians(w);
    memset(row_done, 0, sizeof row_done);
    memset(column_done, 0, sizeof column_done);
    for (int k = 0; k < n; ++k) {
        int row = -1, column = -1;
        double best = rounding;
        for (int i = 0; i < n * n; ++i) {
            double least = row_done[i / n] || column_done[i % n] ? 0 : 1;
            for (int m = 0; m < w->class->members; ++m)
                least = with[m] ? fmin(least, fabs(J[n * n * m + i])) : least;
            if (least > best)
                best = least, row = i / n, column = i % n;
        }
        if (row < 0)
            return false;
        row_done[row] = column_done[column] = true;
        for (int m = 0; m < w->class->members; ++m)
            if (with[m])
                eliminate(n, J + n * n * m, row, column, row_done);
    }
    return true;
}

static const char *split_name(Pool *pool, const Sequence *sequence, const char *name)
{
    for (int number = 2;; ++number) {
        const char *candidate = pool_print(pool, "%.36s_%d", name, number);
        bool taken = false;
        for (int c = 0; c < sequence->classes; ++c)
            taken = taken || !strcmp(sequence->class[c].name, candidate);
        if (!taken)
            return candidate;
    }
}

bool class_split(Pool *pool, Sequence *sequence, int c, Work *w)
{
    Class *class = &sequence->class[c];
    bool with[class->members];
    for (int i = 0; i < class->members; ++i)
        with[i] = true;
    if (class->members == 1 || share_pivots(w, with))
        return false;
    memset(with, 0, sizeof with);
    for (int i = 0; i < class->members; ++i) {
        with[i] = true;
        with[i] = i == 0 || share_pivots(w, with);
    }
    Class *other = &sequence->class[sequence->classes];
    const int members = class->members;
    *other = (Class){.name = split_name(pool, sequence, class->name),
                     .member = pool_alloc(pool, (size_t)members * sizeof(int))};
    int kept = 0, *member = pool_alloc(pool, (size_t)members * sizeof *member);
    for (int i = 0; i < members; ++i) {
        if (with[i]) {
            member[kept++] = class->member[i];
        } else {
            other->member[other->members++] = class->member[i];
            sequence->subset[class->member[i]].class = sequence->classes;
        }
    }
    class->member = member;
    class->members = kept;
    ++sequence->classes;
    return true;
}
