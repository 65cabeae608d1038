/* SPDX-License-Identifier: MIT
 *
 * Results of the library while they are made. */
#ifndef LIBRARY_RESULT_PRIVATE_H
#define LIBRARY_RESULT_PRIVATE_H

#include "base/pool.h"
#include "gic_runtime.h"
#include "host/gic.h"

typedef struct Result {
    Pool *pool; /* everything is in it */
    int count;
    gicl_array *array;
} Result;

/* Add an array that stays: data: [rows][columns]; row, column: names and units, NULL: none. */
void result_add(Result *result, const char *name, int64_t rows, int columns, const double *data, const gic_signal *row,
                const gic_signal *column);

#endif
