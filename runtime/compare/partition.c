/* SPDX-License-Identifier: MIT
 * Generalized coordinate partitioning: see partition.h. */
#include "compare/partition.h"

#include <math.h>
#include <string.h>
#include <suitesparse/klu.h>

/* Part of Phi_q by columns: where the numbers are. */
typedef struct Columns {
    int *start, *row; /* [columns + 1], [entries] */
    const double **value;
} Columns;

/* All of Phi_q; and Phi_u, as KLU wants it. */
typedef struct PartitionFactors {
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
    Columns all, dependent;
    double *value; /* [entries] of `dependent` */
} PartitionFactors;

static Columns columns_new(Pool *pool, int columns, size_t entries)
{
    return (Columns){pool_alloc(pool, ((size_t)columns + 1) * sizeof(int)), pool_alloc(pool, entries * sizeof(int)),
                     pool_alloc(pool, entries * sizeof(double *))};
}

static void gather_all(const Partition *partition, Columns *all)
{
    int entries = 0;
    for (int j = 0; j < partition->columns; ++j) {
        all->start[j] = entries;
        for (int i = 0; i < partition->rows; ++i)
            for (int k = 0; k < partition->row[i].count; ++k)
                if (partition->row[i].column[k] == j) {
                    all->row[entries] = i;
                    all->value[entries++] = partition->row[i].value[k];
                }
    }
    all->start[partition->columns] = entries;
}

Partition *partition_new(Pool *pool, int rows, int columns, const PartitionRow *row)
{
    Partition *partition = pool_alloc(pool, sizeof *partition);
    PartitionFactors *factors = pool_alloc(pool, sizeof *factors);
    const size_t m = (size_t)rows + 1, n = (size_t)columns + 1;
    size_t entries = 1;
    for (int i = 0; i < rows; ++i)
        entries += (size_t)row[i].count;
    *partition = (Partition){.rows = rows,
                             .columns = columns,
                             .row = row,
                             .dependent = pool_alloc(pool, m * sizeof(int)),
                             .chosen = pool_alloc(pool, n * sizeof(double)),
                             .factors = factors,
                             .dense = pool_alloc(pool, m * n * sizeof(double)),
                             .row_left = pool_alloc(pool, m * sizeof(int)),
                             .column_left = pool_alloc(pool, n * sizeof(int)),
                             .largest_at = pool_alloc(pool, m * sizeof(int)),
                             .largest = pool_alloc(pool, m * sizeof(double))};
    factors->all = columns_new(pool, columns, entries);
    factors->dependent = columns_new(pool, rows, entries);
    factors->value = pool_alloc(pool, entries * sizeof(double));
    gather_all(partition, &factors->all);
    partition_forget(partition);
    klu_defaults(&factors->common);
    factors->common.scale = -1; /* rows are lengths and directions of about the same size */
    factors->common.tol = 0.5;  /* pivots must stay good while the mechanism moves */
    return partition;
}

/* ---- the choice ---------------------------------------------------------------------------------------------------
 */

/* The largest entry of a row among the columns not yet chosen. */
static void search_row(Partition *partition, int row, int done)
{
    const double *a = partition->dense + row * partition->columns;
    partition->largest[row] = 0;
    for (int j = done; j < partition->columns; ++j) {
        const double size = fabs(a[partition->column_left[j]]);
        if (size > partition->largest[row]) {
            partition->largest[row] = size;
            partition->largest_at[row] = partition->column_left[j];
        }
    }
}

/* Which of the rows left has the largest entry: its place in row_left. */
static int largest_left(const Partition *partition, int done)
{
    int best = done;
    for (int i = done + 1; i < partition->rows; ++i)
        if (partition->largest[partition->row_left[i]] > partition->largest[partition->row_left[best]])
            best = i;
    return best;
}

static void swap(int *list, int i, int j)
{
    const int kept = list[i];
    list[i] = list[j];
    list[j] = kept;
}

/* Take the pivot's row from the others; only those that change are searched again. */
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
        search_row(partition, partition->row_left[i], done + 1);
    }
}

/* Full pivoting: the pivots' columns are the dependent coordinates. */
static bool choose_columns(Partition *partition)
{
    const double least = 1e-10; /* of the first pivot: the equations say nothing new */
    double first = 0;
    memset(partition->dense, 0, (size_t)(partition->rows * partition->columns) * sizeof(double));
    for (int j = 0; j < partition->columns; ++j) {
        partition->column_left[j] = j;
        partition->chosen[j] = 1;
    }
    for (int i = 0; i < partition->rows; ++i) {
        const PartitionRow *row = &partition->row[i];
        partition->row_left[i] = i;
        for (int k = 0; k < row->count; ++k)
            partition->dense[i * partition->columns + row->column[k]] = *row->value[k];
        search_row(partition, i, 0);
    }
    for (int done = 0; done < partition->rows; ++done) {
        swap(partition->row_left, done, largest_left(partition, done));
        const int row = partition->row_left[done], column = partition->largest_at[row];
        if (!done)
            first = partition->largest[row];
        if (!(partition->largest[row] > least * first))
            return false;
        int place = done;
        while (partition->column_left[place] != column)
            ++place;
        swap(partition->column_left, done, place);
        partition->chosen[column] = 0;
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

static void gather_dependent(Partition *partition)
{
    const Columns *all = &partition->factors->all, *dependent = &partition->factors->dependent;
    int count = 0, entries = 0;
    for (int j = 0; j < partition->columns; ++j) {
        if (partition->chosen[j] > 0)
            continue;
        partition->dependent[count] = j;
        dependent->start[count++] = entries;
        for (int i = all->start[j]; i < all->start[j + 1]; ++i) {
            dependent->row[entries] = all->row[i];
            dependent->value[entries++] = all->value[i];
        }
    }
    dependent->start[count] = entries;
}

static void load(PartitionFactors *factors, int rows)
{
    const int entries = factors->dependent.start[rows];
    for (int i = 0; i < entries; ++i)
        factors->value[i] = *factors->dependent.value[i];
}

static bool analyse(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    int *start = factors->dependent.start, *row = factors->dependent.row;
    forget(factors);
    gather_dependent(partition);
    load(factors, partition->rows);
    factors->symbolic = klu_analyze(partition->rows, start, row, &factors->common);
    if (factors->symbolic)
        factors->numeric = klu_factor(start, row, factors->value, factors->symbolic, &factors->common);
    if (factors->common.status == KLU_OUT_OF_MEMORY)
        out_of_memory();
    if (!factors->numeric) {
        partition_forget(partition); /* or the choice would look as if there were factors */
        return false;
    }
    return true;
}

static void find_usual(Partition *partition)
{
    partition->usual = 1;
    for (int i = 0; i < partition->columns - partition->rows; ++i)
        partition->usual = fmax(partition->usual, partition_amplification(partition, i));
}

bool partition_choose(Partition *partition)
{
    if (!choose_columns(partition)) {
        partition_forget(partition);
        return false;
    }
    if (!analyse(partition))
        return false;
    find_usual(partition);
    return true;
}

bool partition_adopt(Partition *partition, const double *chosen, double usual)
{
    memmove(partition->chosen, chosen, (size_t)partition->columns * sizeof *chosen);
    partition->usual = usual;
    return analyse(partition);
}

bool partition_factor(Partition *partition)
{
    PartitionFactors *factors = partition->factors;
    load(factors, partition->rows);
    return klu_refactor(factors->dependent.start, factors->dependent.row, factors->value, factors->symbolic,
                        factors->numeric, &factors->common);
}

void partition_solve(Partition *partition, double *b)
{
    PartitionFactors *factors = partition->factors;
    klu_solve(factors->symbolic, factors->numeric, partition->rows, 1, b, &factors->common);
}

double partition_amplification(Partition *partition, int64_t i)
{
    const Columns *all = &partition->factors->all;
    double *b = partition->dense, largest = 0;
    int64_t left = i % (partition->columns - partition->rows);
    int column = 0;
    while (partition->chosen[column] == 0 || left-- > 0)
        ++column;
    memset(b, 0, (size_t)partition->rows * sizeof *b);
    for (int k = all->start[column]; k < all->start[column + 1]; ++k)
        b[all->row[k]] = *all->value[k];
    partition_solve(partition, b);
    for (int r = 0; r < partition->rows; ++r)
        largest = fmax(largest, fabs(b[r]));
    return largest;
}

void partition_forget(Partition *partition)
{
    const double neither = -1; /* no choice looks like that */
    for (int j = 0; j < partition->columns; ++j)
        partition->chosen[j] = neither;
}

void partition_close(Partition *partition)
{
    forget(partition->factors);
}
