/* SPDX-License-Identifier: MIT
 * Straight-line factorizations against dense elimination in extended precision, and their operations against counts by
 * hand. */
#include "base/pool.h"
#include "base/random.h"
#include "expression/expression.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N_MAX = 12 };

/* ---- the reference --------------------------------------------------------------------------------------- */

/* x = A^-1 b by elimination with full pivoting in extended precision. Returns the smallest pivot over the largest. */
static long double solve_long(int n, const double *A0, const double *b0, long double *x)
{
    long double A[N_MAX][N_MAX + 1], first = 0, least = INFINITY;
    int column[N_MAX];
    for (int i = 0; i < n; ++i) {
        column[i] = i;
        A[i][n] = b0[i];
        for (int j = 0; j < n; ++j)
            A[i][j] = A0[n * i + j];
    }
    for (int k = 0; k < n; ++k) {
        int row = k, where = k;
        for (int i = k; i < n; ++i)
            for (int j = k; j < n; ++j)
                if (fabsl(A[i][j]) > fabsl(A[row][where]))
                    row = i, where = j;
        for (int j = 0; j <= n; ++j) {
            long double t = A[k][j];
            A[k][j] = A[row][j], A[row][j] = t;
        }
        for (int i = 0; i < n; ++i) {
            long double t = A[i][k];
            A[i][k] = A[i][where], A[i][where] = t;
        }
        int t = column[k];
        column[k] = column[where], column[where] = t;
        first = k ? first : fabsl(A[k][k]);
        least = fminl(least, fabsl(A[k][k]));
        for (int i = k + 1; i < n; ++i) {
            long double factor = A[i][k] / A[k][k];
            for (int j = k; j <= n; ++j)
                A[i][j] -= factor * A[k][j];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        long double sum = A[k][n];
        for (int j = k + 1; j < n; ++j)
            sum -= A[k][j] * x[column[j]];
        x[column[k]] = sum / A[k][k];
    }
    return least / first;
}

/* Determinant by expansion along the first row: nothing but sums of products. */
static long double expand(int n, const double *A)
{
    if (n == 1)
        return A[0];
    long double sum = 0;
    for (int skip = 0; skip < n; ++skip) {
        double minor[N_MAX * N_MAX];
        int count = 0;
        for (int i = 1; i < n; ++i)
            for (int j = 0; j < n; ++j)
                if (j != skip)
                    minor[count++] = A[n * i + j];
        sum += (skip % 2 ? -1 : 1) * (long double)A[skip] * expand(n - 1, minor);
    }
    return sum;
}

/* ---- a system of expressions ----------------------------------------------------------------------------- */

typedef struct System {
    Pool *pool;
    Dag *dag;
    int n, samples;
    Ex A[N_MAX * N_MAX], b[N_MAX], x[N_MAX];
    double scale[N_MAX];
    bool usable[8];
    Factors *factors;
} System;

/* Entries value[samples][n][n] as inputs, those that are 0, 1 or -1 at every sample as literals. b is input. */
static System system_new(int n, int samples, const double *value, const double *right)
{
    Pool *pool = pool_new();
    System sys = {.pool = pool, .dag = dag_new(pool, 1, samples), .n = n, .samples = samples};
    for (int i = 0; i < n * n; ++i) {
        double sample[8];
        bool same = true;
        for (int s = 0; s < samples; ++s) {
            sample[s] = value[s * n * n + i];
            same = same && sample[s] == sample[0];
        }
        bool literal = same && (sample[0] == 0 || fabs(sample[0]) == 1);
        sys.A[i] = literal ? ex_literal(sys.dag, sample[0]) : ex_input(sys.dag, element_at(ARRAY_m, i), sample);
    }
    for (int i = 0; i < n; ++i) {
        double sample[8];
        for (int s = 0; s < samples; ++s)
            sample[s] = right[s * n + i];
        sys.b[i] = ex_input(sys.dag, element_at(ARRAY_e, i), sample);
        sys.scale[i] = 1;
    }
    for (int s = 0; s < samples; ++s)
        sys.usable[s] = true;
    return sys;
}

static bool system_solve(System *sys)
{
    sys->factors = linear_factor(sys->dag, sys->n, sys->A, sys->scale, sys->usable);
    if (sys->factors)
        linear_solve(sys->dag, sys->factors, sys->b, sys->x);
    return sys->factors != NULL;
}

/* x against the reference at the usable samples; every system is well conditioned once its rows and columns are scaled.
 */
static void assert_solution(const System *sys, const double *value, const double *right, double tolerance)
{
    int n = sys->n;
    for (int s = 0; s < sys->samples; ++s) {
        if (!sys->usable[s])
            continue;
        long double x[N_MAX], largest = 0;
        solve_long(n, value + s * n * n, right + s * n, x);
        for (int i = 0; i < n; ++i)
            largest = fmaxl(largest, fabsl(x[i]));
        for (int i = 0; i < n; ++i) {
            double found = ex_value(sys->dag, sys->x[i], s);
            if (!(fabsl(found - x[i]) <= tolerance * largest))
                fail_msg("n %d, sample %d, x[%d]: %.17g instead of %.21Lg", n, s, i, found, x[i]);
        }
    }
}

static void fill(Random *random, int count, double *out)
{
    for (int i = 0; i < count; ++i)
        out[i] = random_uniform(random, -1, 1);
}

static bool well_conditioned(int n, int samples, const double *value, const double *right)
{
    long double x[N_MAX];
    for (int s = 0; s < samples; ++s)
        if (!(solve_long(n, value + s * n * n, right + s * n, x) > 0.02L))
            return false;
    return true;
}

static void permute(Random *random, int n, int *order)
{
    for (int i = 0; i < n; ++i)
        order[i] = i;
    for (int i = n - 1; i > 0; --i) {
        int other = (int)(random_bits(random) % (uint64_t)(i + 1)), t = order[i];
        order[i] = order[other], order[other] = t;
    }
}

static Count count_of(const System *sys)
{
    return dag_count(sys->dag, sys->x, sys->n);
}

static void assert_count(Count count, int add, int multiply, int divide)
{
    assert_int_equal(count.add, add);
    assert_int_equal(count.multiply, multiply);
    assert_int_equal(count.divide, divide);
    assert_int_equal(count.root, 0);
    assert_int_equal(count.function, 0);
}

/* ---- solutions ------------------------------------------------------------------------------------------- */

enum { SAMPLES = 3 };

static void test_dense(void **state)
{
    (void)state;
    Random random = {1};
    int tried = 0;
    while (tried < 120) {
        int n = 1 + tried % 8;
        double A[SAMPLES * 64], b[SAMPLES * 8];
        fill(&random, SAMPLES * n * n, A);
        fill(&random, SAMPLES * n, b);
        if (!well_conditioned(n, SAMPLES, A, b))
            continue;
        System sys = system_new(n, SAMPLES, A, b);
        assert_true(system_solve(&sys));
        assert_solution(&sys, A, b, 2e-11);
        Ex transposed[8];
        linear_solve_transposed(sys.dag, sys.factors, sys.b, transposed);
        /* where the answer goes to the place of the right-hand side */
        linear_solve(sys.dag, sys.factors, sys.b, sys.b);
        assert_memory_equal(sys.b, sys.x, (size_t)n * sizeof(Ex));
        /* the numeric solver agrees */
        long double x[8];
        double dense[64], right[8];
        memcpy(dense, A, sizeof dense);
        memcpy(right, b, sizeof right);
        assert_true(linear_solve_numeric(n, dense, right));
        solve_long(n, A, b, x);
        for (int i = 0; i < n; ++i)
            assert_true(fabsl(right[i] - x[i]) < 1e-12L * (1 + fabsl(x[i])) / 0.02L);
        /* the same factors solve the transposed system */
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                dense[n * j + i] = A[n * i + j];
        solve_long(n, dense, b, x);
        for (int i = 0; i < n; ++i)
            assert_true(fabsl(ex_value(sys.dag, transposed[i], 0) - x[i]) < 2e-11L * (1 + fabsl(x[i])) / 0.02L);
        pool_free(sys.pool);
        ++tried;
    }
}

static void test_sparse(void **state)
{
    (void)state;
    Random random = {2};
    int tried = 0;
    while (tried < 60) {
        enum { N = 10 };
        double A[SAMPLES * N * N] = {0}, b[SAMPLES * N];
        for (int i = 0; i < N * N; ++i)
            if (i % (N + 1) == 0 || random_bits(&random) % 5 == 0)
                for (int s = 0; s < SAMPLES; ++s)
                    A[s * N * N + i] = random_uniform(&random, -1, 1);
        fill(&random, SAMPLES * N, b);
        if (!well_conditioned(N, SAMPLES, A, b))
            continue;
        System sys = system_new(N, SAMPLES, A, b);
        assert_true(system_solve(&sys));
        assert_solution(&sys, A, b, 1e-10);
        pool_free(sys.pool);
        ++tried;
    }
}

/* A triangular matrix with rows and columns shuffled needs substitution only, in the order that undoes the shuffling:
 * no product but one for each entry off the diagonal and one for each pivot's reciprocal. */
static void test_permuted_triangular(void **state)
{
    (void)state;
    Random random = {3};
    for (int trial = 0; trial < 40; ++trial) {
        enum { N = 8 };
        double A[SAMPLES * N * N] = {0}, b[SAMPLES * N];
        int row[N], column[N];
        permute(&random, N, row);
        permute(&random, N, column);
        for (int i = 0; i < N; ++i)
            for (int j = 0; j <= i; ++j)
                for (int s = 0; s < SAMPLES; ++s)
                    A[s * N * N + N * row[i] + column[j]] =
                        i == j ? random_uniform(&random, 1, 2) : random_uniform(&random, -0.5, 0.5);
        fill(&random, SAMPLES * N, b);
        System sys = system_new(N, SAMPLES, A, b);
        assert_true(system_solve(&sys));
        assert_solution(&sys, A, b, 1e-12);
        /* by L (a multiplier and an update for each entry) or by U (an update only) */
        Count count = count_of(&sys);
        assert_int_equal(count.divide, N);
        assert_int_equal(count.add, N * (N - 1) / 2);
        assert_true(count.multiply <= N * (N - 1) + N);
        pool_free(sys.pool);
    }
}

/* Rows and columns of very different size: pivots must be judged relative to both. */
static void test_badly_scaled(void **state)
{
    (void)state;
    Random random = {4};
    int tried = 0;
    while (tried < 40) {
        enum { N = 6 };
        double A[SAMPLES * N * N], b[SAMPLES * N], scaled[SAMPLES * N * N], scale[N];
        fill(&random, SAMPLES * N * N, A);
        fill(&random, SAMPLES * N, b);
        if (!well_conditioned(N, SAMPLES, A, b))
            continue;
        for (int j = 0; j < N; ++j)
            scale[j] = pow(10, random_uniform(&random, -6, 6));
        for (int i = 0; i < N; ++i) {
            double row = pow(10, random_uniform(&random, -12, 12));
            for (int s = 0; s < SAMPLES; ++s) {
                b[s * N + i] *= row;
                for (int j = 0; j < N; ++j)
                    scaled[(s * N + i) * N + j] = A[(s * N + i) * N + j] * row * scale[j];
            }
        }
        System sys = system_new(N, SAMPLES, scaled, b);
        memcpy(sys.scale, scale, sizeof scale);
        assert_true(system_solve(&sys));
        for (int s = 0; s < SAMPLES; ++s) {
            /* unknowns times their scale are those of the unscaled matrix */
            double unscaled[N];
            long double x[N], largest = 0;
            for (int i = 0; i < N; ++i)
                unscaled[i] = b[s * N + i] / (scaled[(s * N + i) * N] / (A[(s * N + i) * N] * scale[0]));
            solve_long(N, A + s * N * N, unscaled, x);
            for (int i = 0; i < N; ++i)
                largest = fmaxl(largest, fabsl(x[i]));
            for (int i = 0; i < N; ++i)
                assert_true(fabsl(ex_value(sys.dag, sys.x[i], s) * scale[i] - x[i]) < 2e-11L * largest);
        }
        pool_free(sys.pool);
        ++tried;
    }
}

/* Values of the system's inputs at a sample. */
static void system_set(System *sys, int sample, const double *A, const double *b)
{
    for (int i = 0; i < sys->n * sys->n; ++i)
        if (sys->dag->node[sys->A[i]].op == OP_INPUT)
            ex_set_sample(sys->dag, sys->A[i], sample, A[i]);
    for (int i = 0; i < sys->n; ++i)
        ex_set_sample(sys->dag, sys->b[i], sample, b[i]);
    dag_evaluate(sys->dag, sample, 1);
}

/* The order is chosen at general numbers; then every entry is 0 or 1 somewhere. A matrix that is not singular must have
 * its solution wherever its zeros are: no entry may have been needed as a pivot. Signed permutations, and these with
 * all of one triangle filled, or with noise. */
static void test_any_entry_may_vanish(void **state)
{
    (void)state;
    Random random = {8};
    for (int trial = 0; trial < 400; ++trial) {
        const int n = 2 + trial % 7;
        double general[SAMPLES * 64], right[SAMPLES * 8], A[SAMPLES * 64];
        int order[8];
        do {
            fill(&random, SAMPLES * n * n, general);
            fill(&random, SAMPLES * n, right);
        } while (!well_conditioned(n, SAMPLES, general, right));
        System sys = system_new(n, SAMPLES, general, right);
        assert_true(system_solve(&sys));
        for (int s = 0; s < SAMPLES; ++s) {
            double *own = A + s * n * n;
            permute(&random, n, order);
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const bool filled = trial % 3 == 1 && order[j] > order[i];
                    own[n * order[i] + j] = i == j ? random_bits(&random) % 2 ? 1 : -1 : filled ? 0.5 : 0;
                    own[n * order[i] + j] += trial % 3 == 2 ? random_uniform(&random, -1e-9, 1e-9) : 0;
                }
            system_set(&sys, s, own, right + s * n);
        }
        /* units of the last place of products of at most n entries, triangles of ones grow by 1.5 a row */
        assert_solution(&sys, A, right, 1e-13);
        pool_free(sys.pool);
    }
}

/* One order must serve all samples: here every entry of the first row is rounding at one of them. */
static void test_pivot_for_all_samples(void **state)
{
    (void)state;
    const double A[] = {1, 1e-13, 0.5, 0.7, /**/ 1e-13, 1, 0.6, -0.4}, b[] = {1, 2, 3, 4};
    System sys = system_new(2, 2, A, b);
    assert_true(system_solve(&sys));
    assert_solution(&sys, A, b, 1e-13);
    pool_free(sys.pool);
    /* singular at the second sample: only with that one out of use there is an order */
    const double one[] = {1, 1e-13, 0.5, 0.7, /**/ 1e-13, 1, 1e-13, 1};
    sys = system_new(2, 2, one, b);
    assert_false(system_solve(&sys));
    sys.usable[1] = false;
    assert_true(system_solve(&sys));
    assert_solution(&sys, one, b, 1e-13);
    pool_free(sys.pool);
    const double small[] = {1e-6, 1, 1, 0.5, /**/ 1, 0.3, 0.4, 1};
    sys = system_new(2, 2, small, b);
    assert_true(system_solve(&sys));
    assert_solution(&sys, small, b, 1e-14);
    pool_free(sys.pool);
    Random random = {6};
    int tried = 0;
    while (tried < 30) {
        enum { N = 5 };
        double many[SAMPLES * N * N], right[SAMPLES * N];
        fill(&random, SAMPLES * N * N, many);
        fill(&random, SAMPLES * N, right);
        for (int s = 0; s < SAMPLES; ++s)
            for (int i = 0; i < N; ++i)
                if (i != (s + 3) % N)
                    many[s * N * N + N * i + (i + s) % N] = 0;
        if (!well_conditioned(N, SAMPLES, many, right))
            continue;
        sys = system_new(N, SAMPLES, many, right);
        assert_true(system_solve(&sys));
        assert_solution(&sys, many, right, 1e-9);
        pool_free(sys.pool);
        ++tried;
    }
}

/* ---- rank ------------------------------------------------------------------------------------------------ */

static void test_rank(void **state)
{
    (void)state;
    Random random = {7};
    for (int trial = 0; trial < 60; ++trial) {
        enum { N = 7 };
        const int rank = trial % N;
        double A[SAMPLES * N * N] = {0}, b[SAMPLES * N], P[N * N], Q[N * N];
        for (int s = 0; s < SAMPLES; ++s) {
            fill(&random, N * N, P);
            fill(&random, N * N, Q);
            for (int i = 0; i < N; ++i)
                for (int j = 0; j < N; ++j)
                    for (int k = 0; k < rank; ++k)
                        A[(s * N + i) * N + j] += P[N * i + k] * Q[N * k + j];
        }
        fill(&random, SAMPLES * N, b);
        System sys = system_new(N, SAMPLES, A, b);
        assert_false(system_solve(&sys));
        pool_free(sys.pool);
    }
    /* one row is the sum of two others */
    const double A[] = {1, 2, 0, 0, /**/ 0, 1, 3, 0, /**/ 1, 3, 3, 0, /**/ 0, 0, 0, 5}, b[] = {1, 1, 1, 1};
    System sys = system_new(4, 1, A, b);
    assert_false(system_solve(&sys));
    pool_free(sys.pool);
    /* no value of its entries makes this one regular: two rows for one unknown */
    const double structure[] = {2, 3, 4, /**/ 0, 0, 5, /**/ 0, 0, 6}, right[] = {1, 1, 1};
    sys = system_new(3, 1, structure, right);
    assert_false(system_solve(&sys));
    pool_free(sys.pool);
}

/* Singular means less than 1e-9 of the row: just above it the matrix has an inverse, just below none. */
static void test_nearly_singular(void **state)
{
    (void)state;
    for (int below = 0; below < 2; ++below) {
        const double A[] = {1, 1, 1, 1 + (below ? 1e-10 : 1e-8)}, b[] = {1, 2};
        System sys = system_new(2, 1, A, b);
        assert_int_equal(system_solve(&sys), !below);
        pool_free(sys.pool);
    }
}

/* ---- operations ------------------------------------------------------------------------------------------ */

static void test_unit_rows(void **state)
{
    (void)state;
    /* a shuffled unit matrix with signs costs nothing */
    const double unit[] = {0, 0, 1, 0, /**/ -1, 0, 0, 0, /**/ 0, 0, 0, 1, /**/ 0, 1, 0, 0}, b[] = {3, 5, 7, 9};
    System sys = system_new(4, 1, unit, b);
    assert_true(system_solve(&sys));
    assert_count(count_of(&sys), 0, 0, 0);
    assert_solution(&sys, unit, b, 0);
    pool_free(sys.pool);
    /* three unit rows and a full one: x3 = (b3 - a0 b0 - a1 b1 - a2 b2) (1 / a3) */
    const double row[] = {1, 0, 0, 0, /**/ 0, 1, 0, 0, /**/ 0, 0, 1, 0, /**/ 2, 0.3, 0.4, 0.5};
    sys = system_new(4, 1, row, b);
    assert_true(system_solve(&sys));
    assert_count(count_of(&sys), 3, 4, 1);
    assert_solution(&sys, row, b, 1e-15);
    /* and where the right-hand sides of the unit rows are zero, one product is left */
    for (int i = 0; i < 3; ++i)
        sys.b[i] = ex_literal(sys.dag, 0);
    linear_solve(sys.dag, sys.factors, sys.b, sys.x);
    assert_count(count_of(&sys), 0, 1, 1);
    pool_free(sys.pool);
}

/* ---- symmetric ------------------------------------------------------------------------------------------- */

/* Cholesky in extended precision. */
static void solve_cholesky(int n, const double *A, const double *b, long double *x)
{
    long double L[N_MAX][N_MAX];
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            long double sum = A[n * j + i];
            for (int k = 0; k < j; ++k)
                sum -= L[i][k] * L[j][k];
            L[i][j] = i == j ? sqrtl(sum) : sum / L[j][j];
        }
    for (int i = 0; i < n; ++i) {
        x[i] = b[i];
        for (int k = 0; k < i; ++k)
            x[i] -= L[i][k] * x[k];
        x[i] /= L[i][i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k)
            x[i] -= L[k][i] * x[k];
        x[i] /= L[i][i];
    }
}

/* Pivots alone up to the first blocked one, then three at a time; of a block the determinant, 1 over it, and the
 * adjugate, whose entry on the diagonal over the determinant is at least 1 over that of the block: the matrix is
 * positive definite. */
static void check_blocks(const System *sys, const Factors *f, int first)
{
    int n = f->n;
    for (int k = 0; k < n; ++k) {
        const int own = k < first ? k : first + (k - first) / 3 * 3;
        const int end = own < first ? k + 1 : own + 3 < n ? own + 3 : n;
        assert_int_equal(f->block[k], own);
        if (own != k)
            continue;
        const double determinant = ex_value(sys->dag, f->determinant[k], 0);
        assert_true(fabs(determinant * ex_value(sys->dag, f->reciprocal[k], 0) - 1) < 1e-15);
        if (end - k == 1)
            assert_true(f->pivot[k] == f->determinant[k]);
        for (int i = k; i < end && end - k > 1; ++i)
            assert_true(ex_value(sys->dag, f->entry[n * i + i], 0) * ex_value(sys->dag, f->pivot[i], 0) >=
                        determinant * (1 - 1e-12));
    }
}

static void test_symmetric(void **state)
{
    (void)state;
    Random random = {8};
    for (int trial = 0; trial < 40; ++trial) {
        int n = 1 + trial % N_MAX;
        double A[N_MAX * N_MAX] = {0}, b[N_MAX], G[N_MAX * N_MAX];
        fill(&random, n * n, G);
        fill(&random, n, b);
        /* every third one sparse */
        for (int i = 0; i < n * n; ++i)
            if (trial % 3 == 0 && random_bits(&random) % 3)
                G[i] = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                A[n * i + j] = i == j ? 0.25 : 0;
                for (int k = 0; k < n; ++k)
                    A[n * i + j] += G[n * i + k] * G[n * j + k];
            }
        long double x[N_MAX], largest = 0;
        solve_cholesky(n, A, b, x);
        /* the lower triangle is not looked at */
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < i; ++j)
                A[n * i + j] = 1e3;
        System sys = system_new(n, 1, A, b);
        const int blocked = (int)(random_bits(&random) % (uint32_t)(n + 1));
        Factors *factors = linear_factor_symmetric(sys.dag, n, sys.A, NULL, blocked);
        check_blocks(&sys, factors, n - blocked);
        linear_solve(sys.dag, factors, sys.b, sys.x);
        for (int i = 0; i < n; ++i)
            largest = fmaxl(largest, fabsl(x[i]));
        for (int i = 0; i < n; ++i) {
            assert_true(fabsl(ex_value(sys.dag, sys.x[i], 0) - x[i]) < 1e-13L * largest);
            assert_true(ex_value(sys.dag, factors->pivot[i], 0) > 0);
            assert_int_equal(factors->row[i], factors->column[i]);
        }
        pool_free(sys.pool);
    }
}

/* In an order of one's own: the same solution, pivots in that order, and 1 + 3 + 2 of them: three divisions. */
static void test_order(void **state)
{
    (void)state;
    enum { N = 6, BLOCKED = 5 };
    static const int order[N] = {4, 0, 5, 2, 1, 3};
    Random random = {11};
    double A[N_MAX * N_MAX] = {0}, b[N_MAX], G[N * N];
    fill(&random, N * N, G);
    fill(&random, N, b);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j)
            for (int k = 0; k < N; ++k)
                A[N * i + j] += G[N * i + k] * G[N * j + k] + (i == j);
    System sys = system_new(N, 1, A, b);
    Factors *factors = linear_factor_symmetric(sys.dag, N, sys.A, order, BLOCKED);
    linear_solve(sys.dag, factors, sys.b, sys.x);
    long double x[N_MAX];
    solve_cholesky(N, A, b, x);
    assert_int_equal(count_of(&sys).divide, 3);
    for (int i = 0; i < N; ++i) {
        assert_int_equal(factors->row[i], order[i]);
        assert_true(fabsl(ex_value(sys.dag, sys.x[i], 0) - x[i]) < 1e-14L);
    }
    pool_free(sys.pool);
}

/* The arrow, its head first: taken in the given order it would fill up. Leaves first: for each of the m leaves a
 * reciprocal, a multiplier, the update of the head; forward one update, backward two products and one update; the head
 * a reciprocal and a product. */
static void test_arrow(void **state)
{
    (void)state;
    for (int m = 1; m <= 9; ++m) {
        int n = m + 1;
        double A[N_MAX * N_MAX] = {0}, b[N_MAX];
        Random random = {9};
        fill(&random, n, b);
        for (int i = 0; i < n; ++i) {
            A[n * i + i] = i ? 1 + 0.1 * i : 8;
            A[i] = A[n * i] = i ? random_uniform(&random, 0.1, 0.5) : A[0];
        }
        System sys = system_new(n, 1, A, b);
        Factors *factors = linear_factor_symmetric(sys.dag, n, sys.A, NULL, 0);
        linear_solve(sys.dag, factors, sys.b, sys.x);
        assert_count(count_of(&sys), 3 * m, 5 * m + 1, n);
        long double x[N_MAX];
        solve_cholesky(n, A, b, x);
        for (int i = 0; i < n; ++i)
            assert_true(fabsl(ex_value(sys.dag, sys.x[i], 0) - x[i]) < 1e-14L);
        pool_free(sys.pool);
    }
}

/* ---- numeric --------------------------------------------------------------------------------------------- */

static void test_determinant(void **state)
{
    (void)state;
    Random random = {10};
    int negative = 0;
    for (int trial = 0; trial < 300; ++trial) {
        int n = 1 + trial % 6;
        double A[36], copy[36];
        long double scale = 1;
        fill(&random, n * n, A);
        for (int i = 0; i < n; ++i) {
            double largest = 0, row = pow(10, random_uniform(&random, -9, 9));
            for (int j = 0; j < n; ++j)
                largest = fmax(largest, fabs(A[n * i + j] *= row));
            scale *= largest;
        }
        memcpy(copy, A, sizeof copy);
        long double expected = expand(n, A) / scale;
        double found = linear_determinant(n, copy);
        assert_true(fabsl(found - expected) < 1e-12L);
        negative += found < 0;
    }
    assert_in_range(negative, 60, 240);
    double swapped[] = {0, 1, 1, 0}, cycle[] = {0, 1, 0, 0, 0, 1, 1, 0, 0}, twins[] = {1, 2, 2, 4};
    assert_true(linear_determinant(2, swapped) == -1);
    assert_true(linear_determinant(3, cycle) == 1);
    assert_true(linear_determinant(2, twins) == 0);
}

static void test_numeric_singular(void **state)
{
    (void)state;
    double twins[] = {1, 2, 3, 2, 4, 6, 0, 0, 1}, empty[] = {1, 0, 0, 0}, b[] = {1, 1, 1};
    assert_false(linear_solve_numeric(3, twins, b));
    assert_false(linear_solve_numeric(2, empty, b));
    /* rows of very different size are no singularity */
    double tiny[] = {1e-200, 0, 0, 1e200}, right[] = {3e-200, 4e200};
    assert_true(linear_solve_numeric(2, tiny, right));
    assert_true(fabs(right[0] - 3) < 1e-15 && fabs(right[1] - 4) < 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dense),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_permuted_triangular),
        cmocka_unit_test(test_badly_scaled),
        cmocka_unit_test(test_any_entry_may_vanish),
        cmocka_unit_test(test_pivot_for_all_samples),
        cmocka_unit_test(test_rank),
        cmocka_unit_test(test_nearly_singular),
        cmocka_unit_test(test_unit_rows),
        cmocka_unit_test(test_symmetric),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_arrow),
        cmocka_unit_test(test_determinant),
        cmocka_unit_test(test_numeric_singular),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
