/* SPDX-License-Identifier: MIT
 * Straight-line factorizations of matrices of expressions: the order is chosen once, offline, so that the emitted code
 * has no search and no branch. Only entries that are constants serve as pivots by themselves; the rest is solved in the
 * irreducible diagonal blocks of its structure (factorize_block.c), whose determinants vanish where the matrix is
 * singular and nowhere else. Samples choose between orders that are all valid. */
#include "expression/expression.h"
#include "expression/factorize.h"

#include <math.h>
#include <string.h>

/* A constant must reach this fraction of the largest entry in its column, so that multipliers stay below twenty. */
static const double pivot_threshold = 0.05;
/* Below this, relative to its row, a pivot is rounding. */
static const double pivot_zero = 1e-9;

Factors *factors_new(Dag *dag, int n, bool symmetric)
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
                   .row_scale = pool_alloc(dag->pool, count * sizeof *f->row_scale),
                   .beta = pool_alloc(dag->pool, count * sizeof *f->beta),
                   .block = pool_alloc(dag->pool, count * sizeof *f->block)};
    for (int k = 0; k < n; ++k)
        f->block[k] = k;
    return f;
}

int factors_block_end(const Factors *f, int first)
{
    int end = first + 1;
    while (end < f->n && f->block[end] == first)
        ++end;
    return end;
}

/* ---- constants as pivots ------------------------------------------------------------------------------------- */

/* A matrix while pivots are taken out of it. */
typedef struct Elimination {
    Dag *dag;
    int n;
    Ex *A;
    bool *row_done, *column_done;
    const double *column_scale;
    double *row_scale; /* [samples][n] largest entry of the row, columns scaled */
    const bool *usable;
} Elimination;

static bool varies(const Dag *dag, Ex e)
{
    return dag->node[e].level == LEVEL_VARIABLE;
}

static double *row_scales(const Dag *dag, int n, const Ex *A, const double *column_scale)
{
    double *scale = pool_alloc(dag->pool, (size_t)(dag->samples * n) * sizeof *scale);
    for (int s = 0; s < dag->samples; ++s)
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j)
                scale[s * n + i] = fmax(scale[s * n + i], fabs(ex_value(dag, A[n * i + j], s)) * column_scale[j]);
            if (!(scale[s * n + i] > 0))
                scale[s * n + i] = 1;
        }
    return scale;
}

/* Operations at run time when entry (i, j) of the rest of A becomes the next pivot. */
static int pivot_cost(const Elimination *z, int i, int j)
{
    const Dag *dag = z->dag;
    const int n = z->n;
    int cost = 0;
    for (int r = 0; r < n; ++r) {
        if (z->row_done[r] || r == i || ex_is(dag, z->A[n * r + j], 0))
            continue;
        bool multiplier_varies = varies(dag, z->A[n * r + j]);
        cost += multiplier_varies && !ex_is(dag, z->A[n * i + j], 1) && !ex_is(dag, z->A[n * i + j], -1) ? 2 : 0;
        for (int c = 0; c < n; ++c)
            if (!z->column_done[c] && c != j && !ex_is(dag, z->A[n * i + c], 0)) {
                cost += multiplier_varies || varies(dag, z->A[n * i + c]) ? 2 : 0;
                cost += varies(dag, z->A[n * r + c])     ? 2
                        : ex_is(dag, z->A[n * r + c], 0) ? 1
                                                         : 0; /* fill spreads variation */
            }
    }
    return cost;
}

/* Is the constant (i, j) large enough at every usable sample, for its column in the rest, rows scaled? */
static bool is_good(const Elimination *z, int i, int j)
{
    const int n = z->n;
    for (int s = 0; s < z->dag->samples; ++s) {
        if (!z->usable[s])
            continue;
        double largest = 0, own = fabs(ex_value(z->dag, z->A[n * i + j], s)) / z->row_scale[s * n + i];
        for (int r = 0; r < n; ++r)
            if (!z->row_done[r])
                largest = fmax(largest, fabs(ex_value(z->dag, z->A[n * r + j], s)) / z->row_scale[s * n + r]);
        if (!(own >= pivot_threshold * largest && own * z->column_scale[j] > pivot_zero))
            return false;
    }
    return true;
}

static void eliminate(Elimination *z, int i, int j, Ex reciprocal)
{
    const int n = z->n;
    for (int r = 0; r < n; ++r) {
        if (z->row_done[r] || r == i || ex_is(z->dag, z->A[n * r + j], 0))
            continue;
        Ex multiplier = ex_mul(z->dag, z->A[n * r + j], reciprocal);
        z->A[n * r + j] = multiplier;
        for (int c = 0; c < n; ++c)
            if (!z->column_done[c] && c != j)
                z->A[n * r + c] = ex_sub(z->dag, z->A[n * r + c], ex_mul(z->dag, multiplier, z->A[n * i + c]));
    }
}

/* Take the constants that are cheapest first; returns how many there were. */
static int eliminate_constants(Elimination *z, Factors *f)
{
    const int n = z->n;
    for (int k = 0; k < n; ++k) {
        int best_i = -1, best_j = -1, best_cost = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Ex e = z->A[n * i + j];
                if (z->row_done[i] || z->column_done[j] || varies(z->dag, e) || ex_is(z->dag, e, 0) ||
                    !is_good(z, i, j))
                    continue;
                const int cost = pivot_cost(z, i, j);
                if (best_i < 0 || cost < best_cost)
                    best_i = i, best_j = j, best_cost = cost;
            }
        if (best_i < 0)
            return k;
        z->row_done[best_i] = z->column_done[best_j] = true;
        f->row[k] = best_i;
        f->column[k] = best_j;
        f->determinant[k] = z->A[n * best_i + best_j];
        f->reciprocal[k] = z->A[n * best_i + best_j] = ex_div(z->dag, ex_literal(z->dag, 1), f->determinant[k]);
        eliminate(z, best_i, best_j, f->reciprocal[k]);
    }
    return n;
}

/* ---- the irreducible blocks of the rest ----------------------------------------------------------------------- */

/* Structure of the rest of a matrix, `count` rows and columns. */
typedef struct Structure {
    int count;
    int *row, *column; /* [count] */
    bool *entry;       /* [count][count] is it not zero? */
    int *matched;      /* [count] column of a row; its row is in place of the column's number then */
    int *owner;        /* [count] row of a column, -1: none */
    bool *reaches;     /* [count][count] */
} Structure;

static bool find_column(Structure *t, int row, bool *seen)
{
    for (int j = 0; j < t->count; ++j) {
        if (!t->entry[t->count * row + j] || seen[j])
            continue;
        seen[j] = true;
        if (t->owner[j] < 0 || find_column(t, t->owner[j], seen)) {
            t->owner[j] = row;
            t->matched[row] = j;
            return true;
        }
    }
    return false;
}

/* False: no permutation puts entries on all of the diagonal. */
static bool match(Structure *t)
{
    bool seen[t->count + 1];
    for (int i = 0; i < t->count; ++i) {
        memset(seen, 0, sizeof seen);
        if (!find_column(t, i, seen))
            return false;
    }
    return true;
}

/* Which rows need the unknowns of which others, directly or by way of others? */
static void close(Structure *t)
{
    const int m = t->count;
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j)
            t->reaches[m * i + j] = i == j || t->entry[m * i + t->matched[j]];
    for (int k = 0; k < m; ++k)
        for (int i = 0; i < m; ++i)
            for (int j = 0; t->reaches[m * i + k] && j < m; ++j)
                t->reaches[m * i + j] = t->reaches[m * i + j] || t->reaches[m * k + j];
}

static Structure structure_of(const Elimination *z, int count)
{
    Pool *pool = z->dag->pool;
    const size_t room = (size_t)count + 1;
    Structure t = {.row = pool_alloc(pool, room * sizeof *t.row),
                   .column = pool_alloc(pool, room * sizeof *t.column),
                   .entry = pool_alloc(pool, room * room * sizeof *t.entry),
                   .matched = pool_alloc(pool, room * sizeof *t.matched),
                   .owner = pool_alloc(pool, room * sizeof *t.owner),
                   .reaches = pool_alloc(pool, room * room * sizeof *t.reaches)};
    int columns = 0;
    for (int i = 0; i < z->n; ++i) {
        if (!z->row_done[i])
            t.row[t.count++] = i;
        if (!z->column_done[i])
            t.column[columns++] = i;
    }
    for (int i = 0; i < count; ++i) {
        t.owner[i] = -1;
        for (int j = 0; j < count; ++j)
            t.entry[count * i + j] = !ex_is(z->dag, z->A[z->n * t.row[i] + t.column[j]], 0);
    }
    return t;
}

/* How many rows a row reaches: blocks in descending order of that are upper triangular. */
static int reach(const Structure *t, int row)
{
    int count = 0;
    for (int j = 0; j < t->count; ++j)
        count += t->reaches[t->count * row + j];
    return count;
}

/* Power of two that makes a row's largest entry about 1. */
static double row_scale(const Elimination *z, const int *column, int size, int row)
{
    double largest = 0;
    int exponent = 0;
    for (int s = 0; s < z->dag->samples; ++s)
        for (int j = 0; z->usable[s] && j < size; ++j)
            largest =
                fmax(largest, fabs(ex_value(z->dag, z->A[z->n * row + column[j]], s)) * z->column_scale[column[j]]);
    frexp(largest > 0 ? largest : 1, &exponent);
    return ldexp(1, -exponent);
}

static void add_block(Elimination *z, Factors *f, int first, int size)
{
    Ex B[size * size];
    double scale[size];
    for (int i = 0; i < size; ++i) {
        scale[i] = row_scale(z, f->column + first, size, f->row[first + i]);
        for (int j = 0; j < size; ++j)
            B[size * i + j] = z->A[z->n * f->row[first + i] + f->column[first + j]];
    }
    factors_add_block(z->dag, f, first, size, B, scale);
}

/* False where the structure alone makes the matrix singular. */
static bool add_blocks(Elimination *z, Factors *f, int first)
{
    Structure t = structure_of(z, z->n - first);
    bool placed[t.count + 1];
    memset(placed, 0, sizeof placed);
    if (!match(&t))
        return false;
    close(&t);
    for (int size; first < z->n; first += size) {
        int best = -1;
        for (int i = 0; i < t.count; ++i)
            if (!placed[i] && (best < 0 || reach(&t, i) > reach(&t, best)))
                best = i;
        size = 0;
        for (int i = 0; i < t.count; ++i)
            if (t.reaches[t.count * best + i] && t.reaches[t.count * i + best]) {
                placed[i] = true;
                f->row[first + size] = t.row[i];
                f->column[first + size++] = t.column[t.matched[i]];
            }
        add_block(z, f, first, size);
    }
    return true;
}

/* ---- factorization -------------------------------------------------------------------------------------------- */

static bool is_singular(const Dag *dag, int n, const Ex *A, const double *column_scale, const bool *usable)
{
    double value[n * n];
    for (int s = 0; s < dag->samples; ++s) {
        for (int i = 0; usable[s] && i < n * n; ++i)
            value[i] = ex_value(dag, A[i], s) * column_scale[i % n];
        if (usable[s] && !(linear_least_pivot(n, value) > pivot_zero))
            return true;
    }
    return false;
}

Factors *linear_factor(Dag *dag, int n, const Ex *A, const double *unknown_scale, const bool *usable)
{
    const size_t count = (size_t)n;
    double column_scale[n];
    for (int j = 0; j < n; ++j)
        column_scale[j] = 1 / unknown_scale[j];
    if (is_singular(dag, n, A, column_scale, usable))
        return NULL;
    Factors *f = factors_new(dag, n, false);
    f->matrix = pool_grow(dag->pool, (void *)A, count * count * sizeof *A, count * count * sizeof *A);
    Elimination z = {.dag = dag,
                     .n = n,
                     .A = pool_grow(dag->pool, (void *)A, count * count * sizeof *A, count * count * sizeof *A),
                     .row_done = pool_alloc(dag->pool, count * sizeof *z.row_done),
                     .column_done = pool_alloc(dag->pool, count * sizeof *z.column_done),
                     .column_scale = column_scale,
                     .row_scale = row_scales(dag, n, A, column_scale),
                     .usable = usable};
    f->constants = eliminate_constants(&z, f);
    if (!add_blocks(&z, f, f->constants))
        return NULL;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            if (k < f->constants || j < f->constants || f->block[k] != f->block[j])
                f->entry[n * k + j] = z.A[n * f->row[k] + f->column[j]];
    return f;
}

/* For dag_slopes(), which need not differentiate the elimination. */
static void remember_system(Dag *dag, const Factors *f, const Ex *b, const Ex *x)
{
    const size_t size = (size_t)f->n * sizeof *b;
    DagSystem *system = POOL_PUSH(dag->pool, dag->system, dag->systems);
    Ex last = 0; /* what was there before */
    *system = (DagSystem){f, pool_alloc(dag->pool, size), pool_alloc(dag->pool, size),
                          pool_alloc(dag->pool, (size_t)f->n * sizeof(bool))};
    memcpy(system->b, b, size);
    memcpy(system->x, x, size);
    for (int i = 0; i < f->n * f->n; ++i)
        last = f->matrix[i] > last ? f->matrix[i] : last;
    for (int i = 0; i < f->n; ++i)
        last = b[i] > last ? b[i] : last;
    for (int i = 0; i < f->n; ++i)
        system->found[i] = x[i] > last;
}

/* Numbers of a system, all of them. */
static void list_system(Pool *pool, const DagSystem *system, Ex **root, int *roots)
{
    const Factors *f = system->factors;
    const struct {
        const Ex *e;
        int count;
    } part[] = {{f->matrix, f->n * f->n}, {f->entry, f->n * f->n}, {f->determinant, f->n}, {f->reciprocal, f->n},
                {f->row_scale, f->n},     {f->beta, f->n},         {system->b, f->n},      {system->x, f->n}};
    for (size_t k = 0; k < sizeof part / sizeof *part; ++k)
        for (int i = 0; i < part[k].count; ++i)
            *POOL_PUSH(pool, *root, *roots) = part[k].e[i];
}

static Ex *images(Pool *pool, const Ex *image, const Ex *e, int count)
{
    Ex *out = pool_alloc(pool, ((size_t)count + 1) * sizeof *out);
    for (int i = 0; i < count; ++i)
        out[i] = image[e[i]];
    return out;
}

void systems_replace(Dag *dag, const Ex *image, int nodes)
{
    Ex *root = NULL, *from = NULL, *to = NULL;
    int roots = 0, count = 0, counted = 0;
    for (int s = 0; s < dag->systems; ++s)
        list_system(dag->pool, &dag->system[s], &root, &roots);
    for (int e = 0; e < nodes && roots; ++e)
        if (image[e] != (Ex)e) {
            *POOL_PUSH(dag->pool, from, count) = (Ex)e;
            *POOL_PUSH(dag->pool, to, counted) = image[e];
        }
    const Ex *all = roots ? dag_replace(dag, root, roots, from, to, count) : NULL;
    for (int s = 0; s < dag->systems; ++s) {
        const DagSystem before = dag->system[s];
        const int n = before.factors->n;
        Factors *f = pool_alloc(dag->pool, sizeof *f);
        *f = *before.factors;
        f->matrix = images(dag->pool, all, f->matrix, n * n);
        f->entry = images(dag->pool, all, f->entry, n * n);
        f->determinant = images(dag->pool, all, f->determinant, n);
        f->reciprocal = images(dag->pool, all, f->reciprocal, n);
        f->row_scale = images(dag->pool, all, f->row_scale, n);
        f->beta = images(dag->pool, all, f->beta, n);
        dag->system[s].factors = f;
        dag->system[s].b = images(dag->pool, all, before.b, n);
        dag->system[s].x = images(dag->pool, all, before.x, n);
    }
}

void linear_solve(Dag *dag, const Factors *f, const Ex *b, Ex *x)
{
    const int n = f->n;
    Ex y[n], right[n];
    memcpy(right, b, sizeof right); /* x may alias b */
    for (int k = 0; k < n; ++k) {
        y[k] = b[f->row[k]];
        for (int j = 0; j < k && j < f->constants && !f->symmetric; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
    }
    if (f->symmetric)
        factors_solve_symmetric(dag, f, y);
    for (int end = f->symmetric ? 0 : n, first; end > 0; end = first) {
        first = f->block[end - 1];
        for (int k = first; k < end; ++k)
            for (int j = end; j < n; ++j)
                y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * k + j], y[j]));
        factors_solve_block(dag, f, first, end, y);
    }
    for (int k = 0; k < n; ++k)
        x[f->column[k]] = y[k];
    if (f->matrix && !dag->own)
        remember_system(dag, f, right, x);
}

void linear_solve_transposed(Dag *dag, const Factors *f, const Ex *b, Ex *x)
{
    const int n = f->n;
    Ex y[n];
    for (int k = 0; k < n; ++k)
        y[k] = b[f->column[k]];
    for (int first = 0, end; first < n; first = end) {
        end = factors_block_end(f, first);
        for (int k = first; k < end; ++k)
            for (int j = 0; j < first; ++j)
                y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * j + k], y[j]));
        factors_solve_block_transposed(dag, f, first, end, y);
    }
    for (int k = f->constants - 1; k >= 0; --k)
        for (int j = k + 1; j < n; ++j)
            y[k] = ex_sub(dag, y[k], ex_mul(dag, f->entry[n * j + k], y[j]));
    for (int k = 0; k < n; ++k)
        x[f->row[k]] = y[k];
}
