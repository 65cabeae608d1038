/* SPDX-License-Identifier: MIT
 * Tables: the same interpolation as gic_table_value() of the runtime. */
#include "base/table.h"

#include <math.h>

/* Fritsch and Butland's mean of the neighbouring secants: 0 at an extremum, one-sided at the ends. */
void table_slopes(Table *table)
{
    int last = table->count - 1;
    for (int i = 0; i <= last; ++i) {
        double left = i > 0 ? (table->y[i] - table->y[i - 1]) / (table->x[i] - table->x[i - 1]) : 0;
        double right = i < last ? (table->y[i + 1] - table->y[i]) / (table->x[i + 1] - table->x[i]) : 0;
        if (i == 0) {
            table->slope[i] = right;
        } else if (i == last) {
            table->slope[i] = left;
        } else if (left * right <= 0) {
            table->slope[i] = 0;
        } else {
            double before = table->x[i] - table->x[i - 1], after = table->x[i + 1] - table->x[i];
            double first = 2 * after + before, second = after + 2 * before;
            table->slope[i] = (first + second) / (first / left + second / right);
        }
    }
}

double table_value(const Table *table, double x)
{
    int last = table->count - 1, i = 0;
    if (x <= table->x[0])
        return table->y[0] + (table->onward ? (x - table->x[0]) * table->slope[0] : 0);
    if (x >= table->x[last])
        return table->y[last] + (table->onward ? (x - table->x[last]) * table->slope[last] : 0);
    while (x >= table->x[i + 1])
        ++i;
    double h = table->x[i + 1] - table->x[i], t = (x - table->x[i]) / h, y0 = table->y[i], y1 = table->y[i + 1];
    if (!table->cubic)
        return y0 + t * (y1 - y0);
    double u = 1 - t;
    return (1 + 2 * t) * u * u * y0 + t * u * u * h * table->slope[i] + t * t * (3 - 2 * t) * y1 -
           t * t * u * h * table->slope[i + 1];
}
