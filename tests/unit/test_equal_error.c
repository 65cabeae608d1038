/* SPDX-License-Identifier: MIT
 * equal_error_second(): times that go as a power of the error are found exactly between rows; what no row keeps has
 * none, and the longest step's time is that of all larger errors. */
#include "bench/precision.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Rows of a method of an order: four steps, each half of the one before. */
typedef struct Method {
    double error[4], time[4][2];
    const double *second[4];
    WayRows rows;
} Method;

static void fill(Method *m, double order, double cost)
{
    for (int i = 0; i < 4; ++i) {
        const double step = 0.01 / (1 << i);
        m->error[i] = 3 * pow(step, order);
        m->time[i][0] = cost / step;
        m->time[i][1] = 2 * cost / step;
        m->second[i] = m->time[i];
    }
    m->rows = (WayRows){"a method", 4, m->error, m->second};
}

static void test_powers(void **unused)
{
    (void)unused;
    for (int order = 1; order <= 5; ++order) {
        Method m;
        fill(&m, order, 0.25);
        for (double step = 0.01; step > 0.01 / 8; step *= 0.93)
            for (int r = 0; r < 2; ++r) {
                const double is = equal_error_second(&m.rows, 3 * pow(step, order) * (1 + 1e-12), r);
                assert_true(fabs(is * step / (0.25 * (1 + r)) - 1) < 1e-9);
            }
        assert_true(equal_error_second(&m.rows, 100, 0) == m.time[0][0]);
        assert_true(equal_error_second(&m.rows, m.error[0], 0) == m.time[0][0]);
        assert_true(equal_error_second(&m.rows, m.error[2], 1) == m.time[2][1]);
        assert_true(isnan(equal_error_second(&m.rows, 0.99 * m.error[3], 0)));
    }
}

/* One row, and a row that is worse than the one before. */
static void test_odd_rows(void **unused)
{
    (void)unused;
    Method m;
    fill(&m, 2, 1);
    m.rows.rows = 1;
    assert_true(equal_error_second(&m.rows, m.error[0], 0) == m.time[0][0]);
    assert_true(isnan(equal_error_second(&m.rows, m.error[0] / 2, 0)));
    m.rows.rows = 3;
    m.error[1] = 2 * m.error[0];
    const double error = sqrt(m.error[1] * m.error[2]);
    assert_true(fabs(equal_error_second(&m.rows, error, 0) - sqrt(m.time[1][0] * m.time[2][0])) < 1e-9);
    assert_true(equal_error_second(&m.rows, m.error[1], 0) == m.time[0][0]);
    m.rows.rows = 0;
    assert_true(isnan(equal_error_second(&m.rows, 1, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_powers), cmocka_unit_test(test_odd_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
