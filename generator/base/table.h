/* SPDX-License-Identifier: MIT
 *
 * Tables of FORMAT.md section 7. */
#ifndef BASE_TABLE_H
#define BASE_TABLE_H

#include "base/message.h"

/* y over increasing x; with slopes, a monotone cubic (FORMAT.md section 6). */
typedef struct Table {
    const char *name;
    Place at;
    int count;
    double *x, *y, *slope;
    bool cubic;
    bool onward; /* beyond the ends: linear with the end's slope; else constant */
    bool read;   /* a formula or another entry names it */
} Table;

/* Slopes of the monotone cubic (Fritsch and Carlson), from x and y. */
void table_slopes(Table *table);
double table_value(const Table *table, double x);

#endif
