/* SPDX-License-Identifier: MIT
 * Generalized coordinate partitioning: see partition.h. */
#include "partition.h"

#include <math.h>
#include <string.h>
#include <suitesparse/klu.h>

/* Phi_u by columns, as KLU wants it; `from` tells which entry of which row each number is. */
typedef struct PartitionFactors {
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
    int *start, *index; /* [rows + 1], [entries] */
    double *value;      /* [entries] */
    const double **from;
    int *place; /* [columns] of a coordinate among the dependent ones, or -1 */
} PartitionFactors;

Partition *partition_new(Pool *pool, int rows, int columns, PartitionRow *row)
{
    Partition *partition = pool_alloc(pool, sizeof *partition);
    PartitionFactors *factors = pool_alloc(pool, sizeof *factors);
    const size_t m = (size_t)rows + 1, n = (size_t)columns + 1, entries = m * PARTITION_WIDTH;
    *partition = (Partition){.rows = rows,
                             .columns = columns,
                             .row = row,
                             .dependent = pool_alloc(pool, m * sizeof(int)),
                             .chosen = pool_alloc(pool, n * sizeof(double)),
                             .factors = factors,
                             .dense = pool_alloc(pool, m * n * sizeof(double)),
                             .row_left = pool_alloc(pool, m * sizeof(int)),
                             .column_left = pool_alloc(pool, n * sizeof(int))};
    factors->start = pool_alloc(pool, m * sizeof(int));
    factors->index = pool_alloc(pool, entries * sizeof(int));
    factors->value = pool_alloc(pool, entries * sizeof(double));
    factors->from = pool_alloc(pool, entries * sizeof(double *));
    factors->place = pool_alloc(pool, n * sizeof(int));
    klu_defaults(&factors->common);
    factors->common.scale = -1; /* rows are lengths and directions of about the same size */
    factors->common.tol = 0.5;  /* pivots must stay good while the mechanism moves */
    return partition;
}

/* ---- the choice ---------------------------------------------------------------------------------------------------
 */

/* Largest entry of what is left; its place in row_left and column_left. */
static double largest_left(const Partition *partition, int done, int *row, int *column)
{
    double largest = 0;
    for (int i = done; i < partition->rows; ++i) {
        const double *a = partition->dense + partition->row_left[i] * partition->columns;
        for (int j = done; j < partition->columns; ++j)
            if (fabs(a[partition->column_left[j]]) > largest) {
                largest = fabs(a[partition->column_left[j]]);
                *row = i;
                *column = j;
            }
    }
    return largest;
}

static void swap(int *list, int i, int j)
{
    const int kept = list[i];
    list[i] = list[j];
    list[j] = kept;
}

static void eliminate(Partition *partition, int done)
{
    const double *pivot_row = partition->dense + partition->row_left[done] * partition->columns;
    const int pivot_column = partition->column_left[done];
    for (int i = done + 1; i < partition->rows; ++i) {
        double *a = partition->dense + partition->row_left[i] * partition->columns;
        if (a[pivot_column] == 0)
            continue;
        const double factor = a[pivot_column] / pivot_row[pivot_column];
        for (int j = done + 1; j < partition->columns; ++j)
            a[partition->column_left[j]] -= factor * pivot_row[partition->column_left[j]];
    }
}

/* Full pivoting: the pivots' columns are the dependent coordinates. */
static bool choose_columns(Partition *partition)
{
    const double least = 1e-10; /* of the first pivot: the equations say nothing new */
    double first = 0;
    memset(partition->dense, 0, (size_t)(partition->rows * partition->columns) * sizeof(double));
    for (int i = 0; i < partition->rows; ++i) {
        const PartitionRow *row = &partition->row[i];
        partition->row_left[i] = i;
        for (int k = 0; k < row->count; ++k)
            partition->dense[i * partition->columns + row->column[k]] = row->value[k];
    }
    for (int j = 0; j < partition->columns; ++j) {
        partition->column_left[j] = j;
        partition->chosen[j] = 1;
    }
    for (int done = 0; done < partition->rows; ++done) {
        int row = done, column = done;
        const double pivot = largest_left(partition, done, &row, &column);
        if (!done)
            first = pivot;
        if (!(pivot > least * first))
            return false;
        swap(partition->row_left, done, row);
        swap(partition->column_left, done, column);
        partition->chosen[partition->column_left[done]] = 0;
        eliminate(partition, done);
    }
    return true;
}

/* ---- factors of Phi_u ---------------------------------------------------------------------------------------------
 */

static void forget(PartitionFactors *factors)
{
    klu_free_numeric(&factors->numeric, &factors->common);
    klu_free_symbolic(&factors->symbolic, &factors->common);
}

static void gather_columns(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    int count = 0, entries = 0;
    for (int j = 0; j < partition->columns; ++j) {
        factors->place[j] = partition->chosen[j] > 0 ? -1 : count;
        if (factors->place[j] >= 0)
            partition->dependent[count++] = j;
    }
    for (int u = 0; u < count; ++u) {
        factors->start[u] = entries;
        for (int i = 0; i < partition->rows; ++i)
            for (int k = 0; k < partition->row[i].count; ++k)
                if (partition->row[i].column[k] == partition->dependent[u]) {
                    factors->index[entries] = i;
                    factors->from[entries++] = &partition->row[i].value[k];
                }
    }
    factors->start[count] = entries;
}

static void load(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    const int entries = factors->start[partition->rows];
    for (int i = 0; i < entries; ++i)
        factors->value[i] = *factors->from[i];
}

static bool analyse(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    forget(factors);
    gather_columns(partition);
    load(partition);
    factors->symbolic = klu_analyze(partition->rows, factors->start, factors->index, &factors->common);
    if (!factors->symbolic)
        return false;
    factors->numeric = klu_factor(factors->start, factors->index, factors->value, factors->symbolic, &factors->common);
    if (!factors->numeric)
        return false;
    partition->usual = 1;
    for (int i = 0; i < partition->columns - partition->rows; ++i)
        partition->usual = fmax(partition->usual, partition_amplification(partition, i));
    return true;
}

bool partition_choose(Partition *partition)
{
    return choose_columns(partition) && analyse(partition);
}

bool partition_adopt(Partition *partition, const double *chosen)
{
    memmove(partition->chosen, chosen, (size_t)partition->columns * sizeof *chosen);
    return analyse(partition);
}

bool partition_factor(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    load(partition);
    return klu_refactor(factors->start, factors->index, factors->value, factors->symbolic, factors->numeric,
                        &factors->common);
}

void partition_solve(Partition *partition, double *b)
{
    PartitionFactors *factors = partition->factors;
    klu_solve(factors->symbolic, factors->numeric, partition->rows, 1, b, &factors->common);
}

double partition_amplification(Partition *partition, int64_t i)
{
    double *b = partition->dense, largest = 0;
    int64_t left = i % (partition->columns - partition->rows);
    int column = 0;
    while (partition->chosen[column] == 0 || left-- > 0)
        ++column;
    for (int r = 0; r < partition->rows; ++r) {
        const PartitionRow *row = &partition->row[r];
        b[r] = 0;
        for (int k = 0; k < row->count; ++k)
            if (row->column[k] == column)
                b[r] = row->value[k];
    }
    partition_solve(partition, b);
    for (int r = 0; r < partition->rows; ++r)
        largest = fmax(largest, fabs(b[r]));
    return largest;
}

void partition_forget(Partition *partition)
{
    memset(partition->chosen, 0, (size_t)partition->columns * sizeof *partition->chosen);
}

void partition_close(Partition *partition)
{
    forget(partition->factors);
}
