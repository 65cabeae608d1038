/* SPDX-License-Identifier: MIT
 * Straight-line factorizations of matrices of expressions. Pivots are chosen once, offline, so that the emitted code
 * has no search and no branch; each pivot's size is watched at run time instead. */
#include "gicgen.h"

#include <math.h>
#include <string.h>

/* An entry must reach this fraction of the largest one in its column, so that multipliers stay below ten. */
static const double pivot_threshold = 0.1;
/* Below this, relative to its row, an entry is rounding. */
static const double pivot_zero = 1e-9;

static bool varies(const Dag *dag, Ex e)
{
    return dag->node[e].level == LEVEL_VARIABLE;
}

/* Operations at run time when entry (i, j) of the rest of A becomes the next pivot. */
static int pivot_cost(const Dag *dag, int n, const Ex *A, const bool *row_done, const bool *column_done, int i, int j)
{
    int cost = varies(dag, A[n * i + j]) ? 8 : 0; /* a division */
    for (int r = 0; r < n; ++r) {
        if (row_done[r] || r == i || ex_is(dag, A[n * r + j], 0))
            continue;
        bool multiplier_varies = varies(dag, A[n * r + j]) || varies(dag, A[n * i + j]);
        cost += multiplier_varies && !ex_is(dag, A[n * i + j], 1) && !ex_is(dag, A[n * i + j], -1) ? 2 : 0;
        for (int c = 0; c < n; ++c)
            if (!column_done[c] && c != j && !ex_is(dag, A[n * i + c], 0)) {
                cost += multiplier_varies || varies(dag, A[n * i + c]) ? 2 : 0;
                cost += varies(dag, A[n * r + c])     ? 2
                        : ex_is(dag, A[n * r + c], 0) ? 1
                                                      : 0; /* fill spreads variation */
            }
    }
    return cost;
}

/* The smallest ratio over the usable samples of |A(i, j)| to the largest entry of its column in the rest, rows scaled.
 */
static double pivot_quality(const Dag *dag, int n, const Ex *A, const bool *row_done, const double *row_scale,
                            const bool *usable, int i, int j)
{
    double quality = 1;
    for (int s = 0; s < dag->samples; ++s) {
        if (!usable[s])
            continue;
        double largest = 0, own = fabs(ex_value(dag, A[n * i + j], s)) / row_scale[s * n + i];
        for (int r = 0; r < n; ++r)
            if (!row_done[r])
                largest = fmax(largest, fabs(ex_value(dag, A[n * r + j], s)) / row_scale[s * n + r]);
        double ratio = own > 0 ? own / largest : 0;
        quality = fmin(quality, ratio);
    }
    return quality;
}

/* Is there a usable sample at which the entry is nothing but rounding? */
static bool pivot_vanishes(const Dag *dag, int n, const Ex *A, const double *row_scale, const double *column_scale,
                           const bool *usable, int i, int j)
{
    for (int s = 0; s < dag->samples; ++s)
        if (usable[s] && !(fabs(ex_value(dag, A[n * i + j], s)) > pivot_zero * row_scale[s * n + i] * column_scale[j]))
            return true;
    return false;
}

static void eliminate(Dag *dag, int n, Ex *A, const bool *row_done, const bool *column_done, int i, int j,
                      Ex reciprocal)
{
    for (int r = 0; r < n; ++r) {
        if (row_done[r] || r == i || ex_is(dag, A[n * r + j], 0))
            continue;
        Ex multiplier = ex_mul(dag, A[n * r + j], reciprocal);
        A[n * r + j] = multiplier;
        for (int c = 0; c < n; ++c)
            if (!column_done[c] && c != j)
                A[n * r + c] = ex_sub(dag, A[n * r + c], ex_mul(dag, multiplier, A[n * i + c]));
    }
}

static Factors *factors_new(Dag *dag, int n, bool symmetric)
{
    Factors *f = pool_alloc(dag->pool, sizeof *f);
    size_t count = (size_t)n;
    *f = (Factors){.n = n,
                   .symmetric = symmetric,
                   .row = pool_alloc(dag->pool, count * sizeof *f->row),
                   .column = pool_alloc(dag->pool, count * sizeof *f->column),
                   .entry = pool_alloc(dag->pool, count * count * sizeof *f->entry),
                   .pivot = pool_alloc(dag->pool, count * sizeof *f->pivot)};
    return f;
}

static double *row_scales(const Dag *dag, int n, const Ex *A, const double *column_scale)
{
    double *scale = pool_alloc(dag->pool, (size_t)(dag->samples * n) * sizeof *scale);
    for (int s = 0; s < dag->samples; ++s)
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j)
                scale[s * n + i] = fmax(scale[s * n + i], fabs(ex_value(dag, A[n * i + j], s)) / column_scale[j]);
            if (!(scale[s * n + i] > 0))
                scale[s * n + i] = 1;
        }
    return scale;
}

Factors *linear_factor(Dag *dag, int n, const Ex *A0, const double *column_scale, const bool *usable, int *rank,
                       bool *row_left)
{
    Factors *f = factors_new(dag, n, false);
    Ex *A = pool_grow(dag->pool, (void *)A0, (size_t)(n * n) * sizeof *A0, (size_t)(n * n) * sizeof *A0);
    double *row_scale = row_scales(dag, n, A0, column_scale);
    bool row_done[n], column_done[n];
    memset(row_done, 0, sizeof row_done);
    memset(column_done, 0, sizeof column_done);
    for (int k = 0; k < n; ++k) {
        int best_i = -1, best_j = -1, best_cost = 0;
        double best_quality = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                if (row_done[i] || column_done[j] || ex_is(dag, A[n * i + j], 0) ||
                    pivot_vanishes(dag, n, A, row_scale, column_scale, usable, i, j))
                    continue;
                double quality = pivot_quality(dag, n, A, row_done, row_scale, usable, i, j);
                quality = fmin(quality, pivot_threshold); /* all that pass are equally good */
                int cost = pivot_cost(dag, n, A, row_done, column_done, i, j);
                if (best_i < 0 || quality > best_quality || (quality == best_quality && cost < best_cost)) {
                    best_i = i, best_j = j;
                    best_cost = cost;
                    best_quality = quality;
                }
            }
        if (best_i < 0) {
            *rank = k;
            for (int i = 0; i < n; ++i)
                row_left[i] = !row_done[i];
            return NULL;
        }
        row_done[best_i] = column_done[best_j] = true;
        f->row[k] = best_i;
        f->column[k] = best_j;
        f->pivot[k] = A[n * best_i + best_j];
        A[n * best_i + best_j] = ex_div(dag, ex_literal(dag, 1), f->pivot[k]);
        eliminate(dag, n, A, row_done, column_done, best_i, best_j, A[n * best_i + best_j]);
    }
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            f->entry[n * k + j] = A[n * f->row[k] + f->column[j]];
    *rank = n;
    return f;
}

/* Entries of the rest that row i touches: its elimination costs the square. */
static int degree(const Dag *dag, int n, const Ex *A, const bool *done, int i)
{
    int count = 0;
    for (int j = 0; j < n; ++j)
        count += !done[j] && !ex_is(dag, A[n * i + j], 0);
    return count;
}

Factors *linear_factor_symmetric(Dag *dag, int n, const Ex *A0, const int *order)
{
    Factors *f = factors_new(dag, n, true);
    Ex *A = pool_alloc(dag->pool, (size_t)(n * n) * sizeof *A);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            A[n * i + j] = i <= j ? A0[n * i + j] : A0[n * j + i];
    bool done[n];
    memset(done, 0, sizeof done);
    for (int k = 0; k < n; ++k) {
        int best = order ? order[k] : -1, best_cost = 0;
        for (int i = 0; i < n && !order; ++i) {
            int cost = done[i] ? 0 : degree(dag, n, A, done, i);
            if (!done[i] && (best < 0 || cost < best_cost))
                best = i, best_cost = cost;
        }
        done[best] = true;
        f->row[k] = f->column[k] = best;
        f->pivot[k] = A[n * best + best];
        Ex reciprocal = A[n * best + best] = ex_div(dag, ex_literal(dag, 1), f->pivot[k]);
        for (int r = 0; r < n; ++r) {
            if (done[r] || ex_is(dag, A[n * r + best], 0))
                continue;
            Ex multiplier = ex_mul(dag, A[n * r + best], reciprocal);
            for (int c = r; c < n; ++c)
                if (!done[c])
                    A[n * r + c] = A[n * c + r] = ex_sub(dag, A[n * r + c], ex_mul(dag, multiplier, A[n * best + c]));
            A[n * r + best] = multiplier;
        }
        for (int c = 0; c < n; ++c)
            if (!done[c])
                A[n * best + c] = A[n * c + best];
    }
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            f->entry[n * k + j] = A[n * f->row[k] + f->column[j]];
    return f;
}

void linear_solve(Dag *dag, const Factors *f, const Ex *b, Ex *x)
{
    int n = f->n;
    Ex y[n];
    for (int k = 0; k < n; ++k) {
        y[k] = b[f->row[k]];
        for (int j = 0; j < k; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
    }
    for (int k = n - 1; k >= 0; --k) {
        if (f->symmetric)
            y[k] = ex_mul(dag, y[k], f->entry[n * k + k]);
        for (int j = k + 1; j < n; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
        if (!f->symmetric)
            y[k] = ex_mul(dag, y[k], f->entry[n * k + k]);
    }
    for (int k = 0; k < n; ++k)
        x[f->column[k]] = y[k];
}

void linear_solve_transposed(Dag *dag, const Factors *f, const Ex *b, Ex *x)
{
    int n = f->n;
    Ex y[n];
    for (int k = 0; k < n; ++k) {
        y[k] = b[f->column[k]];
        for (int j = 0; j < k; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * j + k], y[j]));
        y[k] = ex_mul(dag, y[k], f->entry[n * k + k]);
    }
    for (int k = n - 1; k >= 0; --k)
        for (int j = k + 1; j < n; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * j + k], y[j]));
    for (int k = 0; k < n; ++k)
        x[f->row[k]] = y[k];
}

/* Rows scaled to 1, then eliminated with partial pivoting; b (or NULL) goes along. The product of the pivots with the
 * sign of the exchanges, 0 where one is rounding. */
static double eliminate_numeric(int n, double *A, double *b)
{
    double determinant = 1;
    for (int i = 0; i < n; ++i) {
        double largest = 0;
        for (int j = 0; j < n; ++j)
            largest = fmax(largest, fabs(A[n * i + j]));
        if (!(largest > 0))
            return 0;
        for (int j = 0; j < n; ++j)
            A[n * i + j] /= largest;
        if (b)
            b[i] /= largest;
    }
    for (int k = 0; k < n; ++k) {
        int pivot = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(A[n * i + k]) > fabs(A[n * pivot + k]))
                pivot = i;
        if (!(fabs(A[n * pivot + k]) > 1e-12))
            return 0;
        for (int j = 0; pivot != k && j < n; ++j) {
            double t = A[n * k + j];
            A[n * k + j] = A[n * pivot + j];
            A[n * pivot + j] = t;
        }
        if (pivot != k && b) {
            double t = b[k];
            b[k] = b[pivot];
            b[pivot] = t;
        }
        determinant *= pivot != k ? -A[n * k + k] : A[n * k + k];
        for (int i = k + 1; i < n; ++i) {
            double multiplier = A[n * i + k] / A[n * k + k];
            for (int j = k; multiplier != 0 && j < n; ++j)
                A[n * i + j] -= multiplier * A[n * k + j];
            if (b)
                b[i] -= multiplier * b[k];
        }
    }
    return determinant;
}

double linear_determinant(int n, double *A)
{
    return eliminate_numeric(n, A, NULL);
}

bool linear_solve_numeric(int n, double *A, double *b)
{
    if (eliminate_numeric(n, A, b) == 0)
        return false;
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j)
            b[k] -= A[n * k + j] * b[j];
        b[k] /= A[n * k + k];
    }
    return true;
}
