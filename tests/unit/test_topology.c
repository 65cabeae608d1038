/* SPDX-License-Identifier: MIT
 * The solvers of world/equations.h, topology-based and MUMPS: results, fill, what they refuse and what they call. The
 * Makefile links this program so that it sees every call of malloc, calloc, realloc and dmumps_c. */
#include "equations.h"
#include "base/pool.h"
#include "base/random.h"
#include "base/vec3.h"
#include "compare/mumps.h"
#include "world/equations.h"
#include "world/topology.h"

#include <dmumps_c.h>
#include <setjmp.h>
#include <stdlib.h>

#include <cmocka.h>

/* ---- watching calls ----------------------------------------------------------------------------------------- */

static long allocations, analyses, factorizations;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_dmumps_c(DMUMPS_STRUC_C *mumps);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_dmumps_c(DMUMPS_STRUC_C *mumps);

void *__wrap_malloc(size_t size)
{
    ++allocations;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    ++allocations;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    ++allocations;
    return __real_realloc(old, size);
}

void __wrap_dmumps_c(DMUMPS_STRUC_C *mumps)
{
    analyses += mumps->job == 1 || mumps->job == 4 || mumps->job == 6;
    factorizations += mumps->job == 2 || mumps->job == 4 || mumps->job == 5 || mumps->job == 6;
    __real_dmumps_c(mumps);
}

/* Instead of the function that loads the plug-in: it is linked here. */
const MumpsPlugin *mumps_load(Pool *pool, const char **why)
{
    (void)pool, (void)why;
    return &gicrun_mumps_1;
}

/* ---- the reference ------------------------------------------------------------------------------------------- */

/* x = A^-1 x by elimination with full pivoting. */
static void solve_dense(int n, long double *A, long double *x)
{
    int *column = calloc((size_t)n, sizeof *column);
    long double *y = calloc((size_t)n, sizeof *y);
    for (int i = 0; i < n; ++i)
        column[i] = i;
    for (int k = 0; k < n; ++k) {
        int row = k, where = k;
        for (int i = k; i < n; ++i)
            for (int j = k; j < n; ++j)
                if (fabsl(A[i * n + j]) > fabsl(A[row * n + where]))
                    row = i, where = j;
        for (int j = 0; j < n; ++j) {
            long double t = A[k * n + j];
            A[k * n + j] = A[row * n + j], A[row * n + j] = t;
        }
        for (int i = 0; i < n; ++i) {
            long double t = A[i * n + k];
            A[i * n + k] = A[i * n + where], A[i * n + where] = t;
        }
        long double t = x[k];
        x[k] = x[row], x[row] = t;
        int c = column[k];
        column[k] = column[where], column[where] = c;
        for (int i = k + 1; i < n; ++i) {
            long double factor = A[i * n + k] / A[k * n + k];
            for (int j = k + 1; j < n; ++j)
                A[i * n + j] -= factor * A[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        long double sum = x[k];
        for (int j = k + 1; j < n; ++j)
            sum -= A[k * n + j] * y[column[j]];
        y[column[k]] = sum / A[k * n + k];
    }
    memcpy(x, y, (size_t)n * sizeof *x);
    free(column);
    free(y);
}

/* The matrix L(p) with (0, omega) = 2 L p', omega in body axes, from the product of quaternions conj(p) x. */
static void left(const double p[4], double L[4][4])
{
    const double conj[4] = {p[0], -p[1], -p[2], -p[3]};
    for (int j = 0; j < 4; ++j) {
        double x[4] = {0}, cross[3];
        x[j] = 1;
        cross3(conj + 1, x + 1, cross);
        L[0][j] = conj[0] * x[0] - dot3(conj + 1, x + 1);
        for (int i = 0; i < 3; ++i)
            L[1 + i][j] = conj[0] * x[1 + i] + x[0] * conj[1 + i] + cross[i];
    }
}

/* [M Phi_q^T; Phi_q 0] [q''; lambda] = [Q; gamma] in all 7 coordinates a body, normalizations as constraints. The
 * rotation is written with T = 1/2 omega^T J omega, omega = 2 G p': M = 4 G^T J G, Q = 2 G^T (moment - omega x J omega)
 * - 4 G^T J G' p', and G' p' = 0. out: q'' [bodies][7], lambda [rows]. */
static void reference(const Case *c, long double *out)
{
    const Equations *e = c->equations;
    const int all = 7 * e->bodies, n = all + e->bodies + e->rows;
    long double *A = calloc((size_t)n * (size_t)n, sizeof *A), *x = calloc((size_t)n, sizeof *x);
    for (int b = 0; b < e->bodies; ++b) {
        const double *J = c->inertia + 6 * b, *p = c->q + 7 * b + 3, *rate = c->rate + 7 * b + 3;
        const double *force = c->force + 6 * b;
        const double inertia[9] = {J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2]};
        double L[4][4], omega[3] = {0}, momentum[3], gyroscopic[3], R[9], moment[3];
        long double *at = A + (7 * b) * n + 7 * b;
        bool moves = b > 0 || e->free_base;
        for (int i = 0; i < 3; ++i) {
            at[i * n + i] = moves ? c->mass[b] : 1;
            x[7 * b + i] = moves ? force[i] : 0;
        }
        at += 3 * n + 3;
        for (int i = 0; i < 4; ++i) {
            A[(all + b) * n + 7 * b + 3 + i] = p[i];
            A[(7 * b + 3 + i) * n + all + b] = p[i];
            x[all + b] -= (long double)rate[i] * rate[i];
        }
        left(p, L);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j)
                omega[i] += 2 * L[1 + i][j] * rate[j];
        apply3(inertia, omega, momentum);
        cross3(omega, momentum, gyroscopic);
        mat_from_euler(p, R);
        apply3_transposed(R, force + 3, moment);
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 3; ++k) {
                x[7 * b + 3 + i] += moves ? 2 * L[1 + k][i] * (moment[k] - gyroscopic[k]) : 0;
                for (int j = 0; j < 4; ++j)
                    for (int l = 0; l < 3; ++l)
                        at[i * n + j] +=
                            4 * (long double)L[1 + k][i] * (moves ? inertia[3 * k + l] : k == l) * L[1 + l][j];
            }
    }
    for (int i = 0, row = all + e->bodies; i < e->constraints; ++i)
        for (int r = 0; r < e->constraint[i].rows; ++r, ++row) {
            x[row] = c->gamma[e->first[i] + r];
            for (int end = 0; end < 2; ++end) {
                int b = e->constraint[i].body[end], rows = e->constraint[i].rows;
                for (int k = 0; k < 7 && (b > 0 || (b == 0 && e->free_base)); ++k)
                    A[row * n + 7 * b + k] = A[(7 * b + k) * n + row] =
                        c->jacobian[14 * e->first[i] + 7 * (end * rows + r) + k];
            }
        }
    solve_dense(n, A, x);
    memcpy(out, x, (size_t)all * sizeof *out);
    memcpy(out + all, x + all + e->bodies, (size_t)e->rows * sizeof *out);
    free(A);
    free(x);
}

/* ---- random mechanisms ---------------------------------------------------------------------------------------- */

/* A tree of `bodies` (joints of 1 to `most` rows) and `loops` constraints of one row closing it. */
static Case mechanism(Pool *pool, Random *random, bool free_base, int bodies, int most, int loops)
{
    int count = bodies - 1 + loops;
    Constraint *constraint = pool_alloc(pool, (size_t)(count + 1) * sizeof *constraint);
    for (int i = 0; i < bodies - 1; ++i)
        constraint[i] = (Constraint){{(int)(random_bits(random) % (unsigned)(i + 1)), i + 1},
                                     1 + (int)(random_bits(random) % (unsigned)most)};
    for (int i = bodies - 1; i < count; ++i) {
        int a = (int)(random_bits(random) % (unsigned)bodies),
            step = 1 + (int)(random_bits(random) % (unsigned)(bodies - 1));
        constraint[i] = (Constraint){{a, (a + step) % bodies}, 1};
    }
    /* the order of the file says nothing about the tree */
    for (int i = count - 1; i > 0; --i) {
        int k = (int)(random_bits(random) % (unsigned)(i + 1));
        Constraint t = constraint[i];
        constraint[i] = constraint[k], constraint[k] = t;
    }
    return case_new(pool, bodies, free_base, count, constraint);
}

/* Largest difference from the reference, relative to the largest acceleration and the largest multiplier. */
static double error(const Case *c, const long double *expected)
{
    const int all = 7 * c->equations->bodies, rows = c->equations->rows;
    long double worst[2] = {0}, size[2] = {0};
    for (int i = 0; i < all + rows; ++i) {
        double got = i < all ? c->numbers.acceleration[i] : c->numbers.multiplier[i - all];
        assert_true(isfinite(got));
        worst[i >= all] = fmaxl(worst[i >= all], fabsl(got - expected[i]));
        size[i >= all] = fmaxl(size[i >= all], fabsl(expected[i]));
    }
    return (double)fmaxl(worst[0] / size[0], rows ? worst[1] / size[1] : 0);
}

enum { MECHANISMS = 40, SHAKES = 3 };

/* Accelerations and multipliers of free and fixed, open and closed mechanisms. The tolerance leaves 1e5 for the
 * condition of Y Y^T: random masses differ by 400 and random rows can be near each other's span. */
static void check_solver(const Solver *solver)
{
    Random random = {1};
    double worst = 0;
    for (int m = 0; m < MECHANISMS; ++m) {
        Pool *pool = pool_new();
        int bodies = 2 + m % 9;
        Case c = mechanism(pool, &random, m % 2, bodies, 5, m % 3 ? 0 : bodies / 2);
        long double *expected = pool_alloc(pool, (size_t)(7 * bodies + c.equations->rows) * sizeof *expected);
        void *opened = solver->open(pool, c.equations);
        for (int k = 0; k < SHAKES; ++k) {
            case_shake(&c, &random);
            reference(&c, expected);
            assert_int_equal(solver->solve(opened, &c.numbers), -1);
            worst = fmax(worst, error(&c, expected));
        }
        solver->close(opened);
        pool_free(pool);
    }
    print_message("%s: largest relative error %.1e\n", solver->name, worst);
    assert_true(worst < 1e-10);
}

static void topology_against_dense_elimination(void **state)
{
    (void)state;
    check_solver(&topology_solver);
}

static void mumps_against_dense_elimination(void **state)
{
    (void)state;
    check_solver(&mumps_solver);
}

/* No constraint at all: every body falls by itself. */
static void bodies_without_constraints(void **state)
{
    (void)state;
    Random random = {2};
    Pool *pool = pool_new();
    Case c = case_new(pool, 3, true, 0, NULL);
    long double expected[21];
    case_shake(&c, &random);
    reference(&c, expected);
    const Solver *const both[] = {&topology_solver, &mumps_solver};
    for (int i = 0; i < 2; ++i) {
        void *opened = both[i]->open(pool, c.equations);
        memset(c.numbers.acceleration, 0, 21 * sizeof(double));
        assert_int_equal(both[i]->solve(opened, &c.numbers), -1);
        assert_true(error(&c, expected) < 1e-13);
        both[i]->close(opened);
    }
    pool_free(pool);
}

/* ---- fill ------------------------------------------------------------------------------------------------------- */

/* nonzero[a][b] (a, b: places in the elimination): is block (a, b) of the Cholesky factor of a matrix nonzero that
 * couples the constraints which share a body other than the base? Random positive definite numbers, so that nothing
 * cancels by chance. Returns how many of them are zero in the matrix itself. */
static int fill_in(const Equations *e, const int *place, Random *random, bool *nonzero)
{
    const int n = e->constraints;
    double *S = calloc((size_t)n * (size_t)n, sizeof *S);
    int fill = 0;
    for (int i = 0; i < n; ++i) {
        S[place[i] * n + place[i]] = n;
        for (int k = 0; k < i; ++k) {
            const int *a = e->constraint[i].body, *b = e->constraint[k].body;
            bool share = (a[0] > 0 && (a[0] == b[0] || a[0] == b[1])) || (a[1] > 0 && (a[1] == b[0] || a[1] == b[1]));
            if (share)
                S[place[i] * n + place[k]] = S[place[k] * n + place[i]] = random_uniform(random, 0.5, 1);
        }
    }
    for (int i = 0; i < n * n; ++i)
        nonzero[i] = fabs(S[i]) > 0; /* of the matrix, for now */
    for (int k = 0; k < n; ++k)
        for (int i = k + 1; i < n; ++i) {
            double factor = S[i * n + k] / S[k * n + k];
            for (int j = k + 1; j < n; ++j)
                S[i * n + j] -= factor * S[k * n + j];
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            /* U^T has the pattern of the lower triangle; what elimination zeroed is above the diagonal as U */
            bool now = i >= j && fabs(S[j * n + i]) > 0;
            fill += now && !nonzero[i * n + j];
            nonzero[i * n + j] = now;
        }
    free(S);
    return fill;
}

/* The solver has room for the blocks that the numbers need and no others; a tree fills in nothing, whatever the order
 * of the file. */
static void no_fill_but_the_predicted(void **state)
{
    (void)state;
    Random random = {3};
    int closed_fill = 0;
    for (int m = 0; m < 60; ++m) {
        Pool *pool = pool_new();
        int bodies = 2 + m % 13, loops = m % 2 ? bodies : 0;
        Case c = mechanism(pool, &random, m % 3, bodies, 3, loops);
        int n = c.equations->constraints;
        int *place = pool_alloc(pool, (size_t)n * sizeof *place);
        bool *stored = pool_alloc(pool, (size_t)(n * n)), *actual = pool_alloc(pool, (size_t)(n * n));
        void *opened = topology_solver.open(pool, c.equations);
        topology_pattern(opened, place, stored);
        int fill = fill_in(c.equations, place, &random, actual);
        assert_memory_equal(stored, actual, (size_t)(n * n));
        assert_true(loops || fill == 0);
        closed_fill += fill;
        pool_free(pool);
    }
    assert_true(closed_fill > 0); /* or the comparison shows nothing */
}

/* ---- what is refused ----------------------------------------------------------------------------------------------
 */

/* A constraint given twice: one of the two is named. */
static void redundant_constraints_are_named(void **state)
{
    (void)state;
    Random random = {4};
    const Solver *const both[] = {&topology_solver, &mumps_solver};
    Constraint constraint[] = {{{0, 1}, 3}, {{1, 2}, 5}, {{2, 3}, 2}, {{1, 2}, 1}};
    for (int i = 0; i < 2; ++i) {
        Pool *pool = pool_new();
        Case c = case_new(pool, 4, true, 4, constraint);
        void *opened = both[i]->open(pool, c.equations);
        case_shake(&c, &random);
        double *row[2] = {c.jacobian + 14 * c.equations->first[1], c.jacobian + 14 * c.equations->first[3]};
        memcpy(row[1], row[0] + 7 * 2, 7 * sizeof(double));
        memcpy(row[1] + 7, row[0] + 7 * (5 + 2), 7 * sizeof(double));
        int named = both[i]->solve(opened, &c.numbers);
        if (named != 1 && named != 3)
            fail_msg("%s: says constraint %d", both[i]->name, named);
        /* and the next solution is good again */
        long double expected[4 * 7 + 11];
        case_shake(&c, &random);
        reference(&c, expected);
        assert_int_equal(both[i]->solve(opened, &c.numbers), -1);
        assert_true(error(&c, expected) < 1e-10);
        both[i]->close(opened);
        pool_free(pool);
    }
}

/* A result of numbers that aren't finite shows it. */
static void nan_is_not_hidden(void **state)
{
    (void)state;
    Random random = {5};
    const Solver *const both[] = {&topology_solver, &mumps_solver};
    for (int i = 0; i < 2; ++i) {
        Pool *pool = pool_new();
        Case c = case_new(pool, HMMWV_BODIES, true, HMMWV_JOINTS, hmmwv_constraint);
        void *opened = both[i]->open(pool, c.equations);
        for (int k = 0; k < 3; ++k) {
            case_shake(&c, &random);
            *(k == 0 ? &c.jacobian[100] : k == 1 ? &c.force[3] : &c.gamma[20]) = NAN;
            assert_true(both[i]->solve(opened, &c.numbers) >= 0 || isnan(c.numbers.acceleration[0]));
        }
        both[i]->close(opened);
        pool_free(pool);
    }
}

/* ---- work done once -------------------------------------------------------------------------------------------------
 */

static void nothing_is_allocated_after_open(void **state)
{
    (void)state;
    Random random = {6};
    Pool *pool = pool_new();
    long before = allocations;
    Case c = case_new(pool, HMMWV_BODIES, true, HMMWV_JOINTS, hmmwv_constraint);
    void *opened = topology_solver.open(pool, c.equations);
    assert_true(allocations > before);
    before = allocations;
    for (int i = 0; i < 100; ++i) {
        case_shake(&c, &random);
        assert_int_equal(topology_solver.solve(opened, &c.numbers), -1);
    }
    assert_int_equal(allocations, before);
    pool_free(pool);
}

static void mumps_is_called(void **state)
{
    (void)state;
    enum { CALLS = 10 };
    Random random = {7};
    Pool *pool = pool_new();
    Case c = case_new(pool, HMMWV_BODIES, true, HMMWV_JOINTS, hmmwv_constraint);
    analyses = factorizations = 0;
    void *opened = mumps_solver.open(pool, c.equations);
    for (int i = 0; i < CALLS; ++i) {
        case_shake(&c, &random);
        assert_int_equal(mumps_solver.solve(opened, &c.numbers), -1);
    }
    assert_int_equal(analyses, 1);
    assert_int_equal(factorizations, CALLS);
    mumps_solver.close(opened);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(topology_against_dense_elimination), cmocka_unit_test(mumps_against_dense_elimination),
        cmocka_unit_test(bodies_without_constraints),         cmocka_unit_test(no_fill_but_the_predicted),
        cmocka_unit_test(redundant_constraints_are_named),    cmocka_unit_test(nan_is_not_hidden),
        cmocka_unit_test(nothing_is_allocated_after_open),    cmocka_unit_test(mumps_is_called),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
