/* SPDX-License-Identifier: MIT
 * Second derivatives of roads, and slopes of friction, against differences of their slopes on one side of a place, and
 * against closed forms at points that people write. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "gic_road.h"
#include "gic_runtime.h"

static const double pi = 3.14159265358979323846;

/* Ahead of a place by `reach`, three points: second order, so an error of reach^2 times the next derivatives. side: -1
 * where the road takes the place to be on a piece that ends there. */
static void check_place(const gic_road *road, double x, double y, double side)
{
    const double reach = 1e-5 * side;
    double bend[3], at[3][3];
    gic_road_bend(road, 0, 0, x, y, bend);
    for (int axis = 0; axis < 2; ++axis) {
        for (int i = 0; i < 3; ++i)
            road->height(road, 0, 0, x + (axis ? 0 : i * reach), y + (axis ? i * reach : 0), at[i]);
        for (int k = 1; k < 3; ++k) {
            const double change = (4 * at[1][k] - 3 * at[0][k] - at[2][k]) / (2 * reach);
            /* 1e-10 times a third derivative of 1e2, and roundings of slopes of 1 over 1e-5 */
            assert_true(fabs(change - bend[axis + k - 1]) < 1e-7);
        }
    }
}

static void check_places(const gic_road *road)
{
    for (int i = -8; i < 33; ++i)
        for (int j = -6; j < 7; ++j) {
            check_place(road, 0.25 * i + 0.0171, 0.25 * j + 0.0113, 1);
            check_place(road, 0.25 * i + 0.0171, 0.25 * j + 0.0113, -1);
        }
}

static const double table_x[] = {0, 1, 2, 4, 5}, table_left[] = {0, 1, 1, 0, 0.5}, table_right[] = {0, 0.5, 1, 2, 2.5};
static double slope_left[5], slope_right[5];
static gic_road_table table = {{gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE},
                               table_x,
                               table_left,
                               table_right,
                               slope_left,
                               slope_right,
                               5};

static const double field[] = {0, 0, 1, 0, 0, 1, 0, 2, 0.5, 0, 0, 1, 0, 0, 0, 2, 1, 0, 1, 0};
static const gic_road_grid grid = {
    {gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID}, 0, -1, 1, 0.5, 5, 4, field};
static const gic_bump bump[] = {{0, 2, 0.1, 0, 9}, {1, 2, 0.2, -9, 9}, {4, 1, 0.1, -9, 0}};
static gic_road_bumps bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, bump, 3, 0};
static const gic_road_sine sine = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 0.1, 2, 0, 1};
static const gic_road_plane plane = {{gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE}, 1, 0.5, -0.5};

static int set_up(void **state)
{
    (void)state;
    return gic_road_table_setup(&table) || gic_road_bumps_setup(&bumps);
}

static void test_everywhere(void **state)
{
    (void)state;
    const gic_road *const part[] = {&plane.head, &sine.head, &table.head, &bumps.head, &grid.head};
    const gic_road_sum sum = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, part, 5};
    const gic_road_patched patched = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &sum.head,
        1,
        NULL,
        0};
    for (int i = 0; i < 5; ++i)
        check_places(part[i]);
    check_places(&sum.head);
    check_places(&patched.head);
}

/* At points of tables, nodes of grids and ends of bumps: of the piece that begins there. */
static void test_points(void **state)
{
    (void)state;
    for (int i = 0; i < 5; ++i) {
        if (i)
            check_place(&table.head, table_x[i], 1, 1);
        check_place(&grid.head, i, -0.25, 1);
        for (int j = 0; j < 3; ++j)
            check_place(&grid.head, i, -1 + 0.5 * j, 1);
    }
    check_place(&table.head, 0, 1, -1); /* level up to and with the first point */
    check_place(&grid.head, 9, 9, 1);
    check_place(&bumps.head, 0, 1, 1);
    check_place(&bumps.head, 1, 1, 1);
    check_place(&bumps.head, 2, 1, 1);
    check_place(&bumps.head, 3, 1, 1);
    check_place(&bumps.head, 5, -1, 1);
}

static void test_closed(void **state)
{
    (void)state;
    double out[3];
    /* 0.1 sin(pi x + y): at its crest -0.1 (pi^2, pi, 1) */
    gic_road_bend(&sine.head, 0, 0, 0.5, 0, out);
    assert_true(fabs(out[0] + 0.1 * pi * pi) < 1e-15 && fabs(out[1] + 0.1 * pi) < 1e-15 && fabs(out[2] + 0.1) < 1e-15);
    /* a bump of 2 m and 0.1 m, 0.05 (1 - cos(pi x)): at its foot 0.05 pi^2 */
    gic_road_bend(&bumps.head, 0, 0, 0, 1, out);
    assert_true(fabs(out[0] - 0.05 * pi * pi) < 1e-15 && out[1] == 0 && out[2] == 0);
    /* from 0 to 1 level at both ends: 3 s^2 - 2 s^3, so 6 - 12 s; of the road that falls from 1 to 0 over 2 m, a
     * quarter of that */
    static const double x[] = {0, 1, 2, 4, 5}, h[] = {0, 1, 1, 0, 0};
    double slope[2][5];
    gic_road_table steps = {
        {gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE}, x, h, h, slope[0], slope[1], 5};
    assert_int_equal(gic_road_table_setup(&steps), GIC_OK);
    /* where one bump of 1 m and 0.1 m ends and the next begins: 2 pi^2 0.1 on both sides */
    static const gic_bump pair[] = {{-1, 1, 0.1, -9, 9}, {0, 1, 0.1, -9, 9}};
    gic_road_bumps chain = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, pair, 2, 0};
    assert_int_equal(gic_road_bumps_setup(&chain), GIC_OK);
    gic_road_bend(&chain.head, 0, 0, 0, 0.3, out);
    assert_true(fabs(out[0] - 0.2 * pi * pi) < 1e-14);
    const double place[] = {0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 4.5, 5, 6},
                 bend[] = {3, 0, -3, 0, 0, -1.5, 0, 0, 0, 0, 0};
    for (int i = 0; i < 11; ++i) {
        gic_road_bend(&steps.head, 0, 0, place[i], 0, out);
        assert_true(fabs(out[0] - bend[i]) < 1e-13); /* a hundred roundings of slopes of 1 */
    }
    gic_road_bend(&plane.head, 0, 0, 1, 2, out);
    assert_true(out[0] == 0 && out[1] == 0 && out[2] == 0);
}

static void other_height(const gic_road *road, int32_t lane, double time, double x, double y, double out[3])
{
    (void)road, (void)lane, (void)time;
    out[0] = x * x * x * y + 2 * y * y;
    out[1] = 3 * x * x * y;
    out[2] = x * x * x + 4 * y;
}

static double other_friction(const gic_road *road, int32_t lane, double time, double x, double y)
{
    (void)road, (void)lane, (void)time;
    return 1 + x * x * y;
}

/* Roads that tell neither, as they are and as a part: differences of fourth order have a rounding of 1e-16 over 1 mm.
 */
static void test_others(void **state)
{
    (void)state;
    double out[3];
    const gic_road other = {other_height, other_friction, NULL, NULL, GIC_ROAD_OWN};
    const gic_road *const part[] = {&plane.head, &other};
    const gic_road_sum sum = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, part, 2};
    const gic_road_patched patched = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &sum.head,
        1,
        NULL,
        0};
    const gic_road *const road[] = {&other, &sum.head, &patched.head};
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 9; ++k) {
            const double x = k % 3, y = k / 3;
            gic_road_bend(road[i], 0, 0, x, y, out);
            assert_true(fabs(out[0] - 6 * x * y) < 1e-11 && fabs(out[1] - 3 * x * x) < 1e-11 &&
                        fabs(out[2] - 4) < 1e-11);
        }
    gic_road_friction_slope(&other, 0, 0, 1, 2, out);
    assert_true(fabs(out[0] - 4) < 1e-11 && fabs(out[1] - 1) < 1e-11);
    out[0] = out[1] = 1; /* friction that is 1 everywhere, no road at all */
    gic_road_friction_slope(&plane.head, 0, 0, 1, 1, out);
    assert_true(out[0] == 0 && out[1] == 0);
    gic_road_bend(NULL, 0, 0, 1, 1, out);
    assert_true(out[0] == 0 && out[1] == 0 && out[2] == 0);
}

static void test_friction(void **state)
{
    (void)state;
    static const gic_friction_patch patch[] = {{0, 2, 0, 2, 0.5, 1}, {1, 3, -1, 1, 0.2, 0.5}};
    const gic_road_patched road = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        NULL,
        1,
        patch,
        2};
    double slope[2];
    const double reach = 1e-5;
    for (int i = -8; i < 33; ++i)
        for (int j = -16; j < 17; ++j) {
            const double x = 0.125 * i + 0.003, y = 0.125 * j + 0.001;
            gic_road_friction_slope(&road.head, 0, 0, x, y, slope);
            for (int axis = 0; axis < 2; ++axis) {
                const double dx = axis ? 0 : reach, dy = axis ? reach : 0;
                const double change = (gic_patched_friction(&road.head, 0, 0, x + dx, y + dy) -
                                       gic_patched_friction(&road.head, 0, 0, x - dx, y - dy)) /
                                      (2 * reach);
                /* 1e-10 times a third derivative of 50, and roundings of 1 over 1e-5 */
                assert_true(fabs(change - slope[axis]) < 1e-8);
            }
        }
    /* in the middle of an edge of 1 m from 1 to 0.5: 1.5 of the rise a metre */
    gic_road_friction_slope(&road.head, 0, 0, 0, 1.5, slope);
    assert_true(fabs(slope[0] + 0.75) < 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_everywhere), cmocka_unit_test(test_points),   cmocka_unit_test(test_closed),
        cmocka_unit_test(test_others),     cmocka_unit_test(test_friction),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
