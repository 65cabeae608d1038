/* SPDX-License-Identifier: MIT
 * Tables (FORMAT.md section 7): a straight line stays one, whatever its slope; slopes where secants differ, by hand; no
 * bump where values rise all along, and none beside an extremum. */
#include "base/table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { POINTS = 5 };

static double place[POINTS] = {0, 1, 3, 4, 6};

static Table table_of(double y[POINTS], double slope[POINTS])
{
    Table table = {.count = POINTS, .x = place, .y = y, .slope = slope, .cubic = true, .onward = true};
    table_slopes(&table);
    return table;
}

static void test_line(void **unused)
{
    (void)unused;
    static const double slope[] = {0.01, 0.2, 1, -0.3, 5000, -1e-6, 0};
    for (size_t s = 0; s < sizeof slope / sizeof *slope; ++s) {
        double y[POINTS], found[POINTS];
        for (int i = 0; i < POINTS; ++i)
            y[i] = 2 + slope[s] * place[i];
        const Table table = table_of(y, found);
        for (double x = -2; x < 9; x += 0.125)
            assert_true(fabs(table_value(&table, x) - 2 - slope[s] * x) <= 1e-14 * (2 + fabs(9 * slope[s])));
    }
}

/* Secants 0.1, 0.1, 0.6, -0.05 over 1, 2, 1, 2: the mean of the two in the middle has the weights 4 / 9 and 5 / 9. */
static void test_slopes(void **unused)
{
    (void)unused;
    double y[POINTS] = {0, 0.1, 0.3, 0.9, 0.8}, found[POINTS];
    const double wanted[POINTS] = {0.1, 0.1, 1 / (4 / 0.9 + 5 / 5.4), 0, -0.05};
    const Table table = table_of(y, found);
    for (int i = 0; i < POINTS; ++i)
        assert_true(fabs(found[i] - wanted[i]) < 1e-15);
    for (double x = 0; x < 6; x += 0.01) {
        assert_true(table_value(&table, x) <= 0.9);
        assert_true(x > 3.985 || table_value(&table, x + 0.01) >= table_value(&table, x));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_line), cmocka_unit_test(test_slopes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
