/* SPDX-License-Identifier: MIT
 * Factors of accelerations for people, against the table of ISO 2631-1 (thirds of octaves, thousandths). */
#include "run/ride_filter.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { THIRDS = 23 };
static const double k[THIRDS] = {418,  459, 477, 482, 484, 494, 531, 631, 804, 967, 1039, 1054,
                                 1036, 988, 902, 768, 636, 513, 405, 314, 246, 186, 132};
static const double d[THIRDS] = {853, 944, 992, 1011, 1008, 968, 890,  776,  642,  512,  409, 323,
                                 253, 212, 161, 125,  100,  80,  63.2, 49.4, 38.8, 29.5, 21.1};

static void test_table(void **state)
{
    (void)state;
    for (int i = 0; i < THIRDS; ++i) {
        const double f = pow(10, (i - 3) / 10.0);
        const double printed = i == 13 ? 0.05 : 0.015; /* 0.212 at 10 Hz is printed so and off its own filter */
        assert_true(fabs(1e3 * ride_weight(RIDE_K, f) / k[i] - 1) < 0.015);
        assert_true(fabs(1e3 * ride_weight(RIDE_D, f) / d[i] - 1) < printed);
    }
}

static void test_ends(void **state)
{
    (void)state;
    assert_true(ride_weight(RIDE_K, 0) == 0 && ride_weight(RIDE_D, 0) == 0);
    assert_true(ride_weight(RIDE_K, 1e4) < 1e-4 && ride_weight(RIDE_D, 1e4) < 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_table), cmocka_unit_test(test_ends)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
