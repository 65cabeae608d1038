/* SPDX-License-Identifier: MIT
 * Rank of a matrix of numbers, by elimination with full pivoting. */
#include "sequence/rank.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static void swap_rows(int n, double *a, double *b)
{
    for (int j = 0; j < n; ++j) {
        const double t = a[j];
        a[j] = b[j], b[j] = t;
    }
}

int matrix_rank(int rows, int n, double zero, double *A, double *combination, double *least)
{
    bool used[n + 1];
    memset(used, 0, sizeof used);
    for (int i = 0; combination && i < rows * rows; ++i)
        combination[i] = i % (rows + 1) == 0;
    double smallest = 1;
    int rank = 0;
    for (; rank < rows && rank < n; ++rank) {
        int row = -1, column = -1;
        double largest = zero;
        for (int i = rank; i < rows; ++i)
            for (int j = 0; j < n; ++j)
                if (!used[j] && fabs(A[n * i + j]) > largest)
                    largest = fabs(A[n * i + j]), row = i, column = j;
        if (row < 0)
            break;
        smallest = fmin(smallest, largest);
        used[column] = true;
        swap_rows(n, A + n * rank, A + n * row);
        if (combination)
            swap_rows(rows, combination + rows * rank, combination + rows * row);
        for (int i = rank + 1; i < rows; ++i) {
            const double factor = A[n * i + column] / A[n * rank + column];
            for (int j = 0; factor != 0 && j < n; ++j)
                A[n * i + j] -= factor * A[n * rank + j];
            for (int j = 0; combination && factor != 0 && j < rows; ++j)
                combination[rows * i + j] -= factor * combination[rows * rank + j];
        }
    }
    if (least)
        *least = smallest;
    return rank;
}
