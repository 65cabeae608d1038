/* SPDX-License-Identifier: MIT
 * Straight-line factorizations of matrices of expressions. Pivots are chosen once, offline, so that the emitted code
 * has no search and no branch; each pivot's size is watched at run time instead. */
#include "gicgen.h"

#include <math.h>
#include <string.h>

/* An entry must reach this fraction of the largest one in its column, so that multipliers stay below ten. */
static const double pivot_threshold = 0.1;
/* One that changes by more than this over the samples may change its sign not far from them. */
static const double pivot_steady = 0.3;
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

/* The smallest magnitude among the usable samples of a member over the largest one; 0 where the sign differs: there is
 * a configuration between them at which it vanishes. */
static double steadiness(const Dag *dag, Ex e, const bool *usable)
{
    const int configurations = dag->samples / dag->members;
    double steady = 1;
    for (int m = 0; m < dag->members; ++m) {
        double least = INFINITY, most = -INFINITY;
        for (int s = m * configurations; s < (m + 1) * configurations; ++s)
            if (usable[s]) {
                least = fmin(least, ex_value(dag, e, s));
                most = fmax(most, ex_value(dag, e, s));
            }
        if (least < 0 && most > 0)
            return 0;
        if (least <= most && most != least)
            steady = fmin(steady, fmin(fabs(least), fabs(most)) / fmax(fabs(least), fabs(most)));
    }
    return steady;
}

/* The smallest ratio over the usable samples of |A(i, j)| to the largest entry of its column in the rest, rows scaled;
 * less where it is much smaller at some samples than at others, and may vanish at configurations that are none. */
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
    const double steady = steadiness(dag, A[n * i + j], usable);
    return steady < pivot_steady ? fmin(quality, pivot_threshold) * fmax(steady, pivot_zero) : quality;
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
                   .pivot = pool_alloc(dag->pool, count * sizeof *f->pivot),
                   .determinant = pool_alloc(dag->pool, count * sizeof *f->determinant),
                   .reciprocal = pool_alloc(dag->pool, count * sizeof *f->reciprocal),
                   .block = pool_alloc(dag->pool, count * sizeof *f->block)};
    for (int k = 0; k < n; ++k)
        f->block[k] = k;
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

/* Behind the block that begins with pivot `first`. */
static int block_end(const Factors *f, int first)
{
    int end = first + 1;
    while (end < f->n && f->block[end] == first)
        ++end;
    return end;
}

/* y[k] less what the pivots first .. end - 1, a block, take from it. */
static Ex less_block(Dag *dag, const Factors *f, const Ex *y, int k, int first, int end)
{
    Ex sum = 0;
    for (int j = first; j < end; ++j)
        sum = ex_add(dag, sum, ex_mul(dag, f->entry[f->n * k + j], y[j]));
    return ex_sub(dag, y[k], end - first > 1 ? ex_mul(dag, f->reciprocal[first], sum) : sum);
}

static void solve_symmetric(Dag *dag, const Factors *f, Ex *y)
{
    const int n = f->n;
    for (int k = 0; k < n; ++k)
        for (int first = 0, end; first < f->block[k]; first = end) {
            end = block_end(f, first);
            y[k] = less_block(dag, f, y, k, first, end);
        }
    for (int first = n > 0 ? f->block[n - 1] : -1; first >= 0; first = first ? f->block[first - 1] : -1) {
        const int end = block_end(f, first);
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

void linear_solve(Dag *dag, const Factors *f, const Ex *b, Ex *x)
{
    int n = f->n;
    Ex y[n];
    for (int k = 0; k < n; ++k) {
        y[k] = b[f->row[k]];
        for (int j = 0; j < k && !f->symmetric; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
    }
    if (f->symmetric)
        solve_symmetric(dag, f, y);
    for (int k = n - 1; k >= 0 && !f->symmetric; --k) {
        for (int j = k + 1; j < n; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
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
