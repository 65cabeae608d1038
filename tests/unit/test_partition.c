/* SPDX-License-Identifier: MIT
 * When equations count as dependent: Phi_q = U diag(1, .., 1, s) V with reflections U and V has the singular value s,
 * and the last pivot of elimination with full pivoting lies between s over and s times some factor of the size, 30
 * here. Well above the limit of 1e-10 a choice is made and solves to the digits that are left; well below there is
 * none. */
#include "base/pool.h"
#include "compare/partition.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { ROWS = 4, COLUMNS = 6 };

/* y = (1 - 2 v v^T) x for |v| = 1 */
static void reflect(int n, const double *v, double *x, int stride)
{
    double along = 0;
    for (int i = 0; i < n; ++i)
        along += v[i] * x[i * stride];
    for (int i = 0; i < n; ++i)
        x[i * stride] -= 2 * along * v[i];
}

static void normalize(int n, double *v)
{
    double square = 0;
    for (int i = 0; i < n; ++i)
        square += v[i] * v[i];
    for (int i = 0; i < n; ++i)
        v[i] /= sqrt(square);
}

/* A matrix whose least singular value is `least`, the others 1. */
static void make(double least, double A[ROWS][COLUMNS])
{
    double u[ROWS] = {0.3, -0.7, 0.45, 0.6}, v[COLUMNS] = {0.5, 0.2, -0.8, 0.35, 0.6, -0.4};
    normalize(ROWS, u);
    normalize(COLUMNS, v);
    for (int i = 0; i < ROWS; ++i)
        for (int j = 0; j < COLUMNS; ++j)
            A[i][j] = i != j ? 0 : i == ROWS - 1 ? least : 1;
    for (int j = 0; j < COLUMNS; ++j)
        reflect(ROWS, u, &A[0][j], COLUMNS);
    for (int i = 0; i < ROWS; ++i)
        reflect(COLUMNS, v, A[i], 1);
}

static void test_rank(void **unused)
{
    (void)unused;
    static const struct {
        double least;
        bool good;
    } trial[] = {{1, true}, {1e-4, true}, {1e-6, true}, {1e-8, true}, {1e-12, false}, {1e-14, false}, {0, false}};
    for (size_t t = 0; t < sizeof trial / sizeof *trial; ++t) {
        Pool *pool = pool_new();
        double A[ROWS][COLUMNS];
        PartitionRow row[ROWS];
        make(trial[t].least, A);
        for (int i = 0; i < ROWS; ++i) {
            row[i].count = COLUMNS;
            for (int j = 0; j < COLUMNS; ++j) {
                row[i].column[j] = j;
                row[i].value[j] = &A[i][j];
            }
        }
        Partition *partition = partition_new(pool, ROWS, COLUMNS, row);
        assert_true(partition_choose(partition) == trial[t].good);
        if (trial[t].good) {
            double x[ROWS], b[ROWS];
            for (int i = 0; i < ROWS; ++i) {
                b[i] = 0;
                for (int j = 0; j < ROWS; ++j)
                    b[i] += A[i][partition->dependent[j]] * (x[j] = 1 + j);
            }
            partition_solve(partition, b);
            for (int i = 0; i < ROWS; ++i)
                assert_true(fabs(b[i] - x[i]) < 1e-13 / trial[t].least);
        }
        partition_close(partition);
        pool_free(pool);
    }
}

/* The coordinates that depend are those of the largest entries, whatever signs equations and coordinates have. */
static void test_signs(void **unused)
{
    (void)unused;
    static const double size[ROWS][COLUMNS] = {
        {0.1, 0.2, 9, 0.3, 0, 0.1}, {7, 0.1, 0.2, 0, 0.3, 0.2}, {0, 0.3, 0.1, 0.2, 8, 0.1}, {0.2, 6, 0, 0.1, 0.1, 0.3}};
    for (int signs = 0; signs < 1 << (ROWS + COLUMNS); ++signs) {
        Pool *pool = pool_new();
        double A[ROWS][COLUMNS];
        PartitionRow row[ROWS];
        for (int i = 0; i < ROWS; ++i) {
            row[i].count = COLUMNS;
            for (int j = 0; j < COLUMNS; ++j) {
                A[i][j] = (signs >> i & 1) == (signs >> (ROWS + j) & 1) ? size[i][j] : -size[i][j];
                row[i].column[j] = j;
                row[i].value[j] = &A[i][j];
            }
        }
        Partition *partition = partition_new(pool, ROWS, COLUMNS, row);
        assert_true(partition_choose(partition));
        int seen = 0;
        for (int i = 0; i < ROWS; ++i)
            seen |= 1 << partition->dependent[i];
        assert_int_equal(seen, 1 << 0 | 1 << 1 | 1 << 2 | 1 << 4);
        partition_close(partition);
        pool_free(pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rank), cmocka_unit_test(test_signs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
