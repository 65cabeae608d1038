/* SPDX-License-Identifier: MIT
 * roads.c: gic_road_lanes.h against the functions of gic_road.c, in LANES lanes. With -DEXACT sines and cosines are
 * libm's, and heights and slopes have to be equal (0 and -0 are). Without, products may be contracted: phases of up to
 * 1,700 then have other roundings, and numbers may differ by twice 2^-53 (2^-24 of numbers of type float) of that;
 * places beyond 1,000 m are left out. Roads of every kind, of one kind and of all kinds side by side, with numbers that
 * people write and at the places where formulas change: nodes, edges, ends, no numbers. A road of one's own is asked
 * for its own lanes alone.
 */
#define GIC_LANES LANES
#include "gic_lanes.h"
#ifdef EXACT
#undef LANE_SIN
#undef LANE_COS
static gic_lane one_by_one(gic_real (*f)(gic_real), gic_lane x)
{
    int l;
    FOR_LANES(l)
    x[l] = f(x[l]);
    return x;
}
#define LANE_SIN(x) one_by_one(GIC_MATH(sin), x)
#define LANE_COS(x) one_by_one(GIC_MATH(cos), x)
#endif
#include "gic_road_lanes.h"

#include <stdio.h>
#include <stdlib.h>

enum { COUNT = 12, NX = 7, NY = 5, TRACKS = 400 };

static long asked, failed, compared, wrong_calls, beside;

/* Tells by its lane, its time and its place; anything else that calls it is counted. */
static void own_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road;
    ++asked;
    if (time != (gic_real)(lane + 1) / 8)
        ++wrong_calls;
    out[0] = x + 2 * y + time;
    out[1] = (gic_real)lane;
    out[2] = 2;
}

static gic_real own_friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    (void)road;
    ++asked;
    wrong_calls += time != (gic_real)(lane + 1) / 8;
    return x > y ? GIC_R(0.5) : (gic_real)(lane + 1);
}

static gic_real pick(void)
{
    static const gic_real nice[] = {0,
                                    -0.0,
                                    1,
                                    -1,
                                    GIC_R(0.5),
                                    2,
                                    3,
                                    4,
                                    6,
                                    GIC_ROAD_EDGE,
                                    -GIC_ROAD_EDGE,
                                    2 * GIC_ROAD_EDGE,
                                    GIC_R(0.75),
                                    10,
                                    100,
                                    1000,
                                    GIC_R(-1e30),
                                    GIC_R(1e30),
                                    NAN,
                                    INFINITY,
                                    -INFINITY};
    enum { NICE = sizeof nice / sizeof *nice };
    const int i = rand() % (2 * NICE);
    return i < NICE ? nice[i] : (gic_real)(rand() % 20001 - 8000) / 1000;
}

int main(void)
{
    static const gic_real table_x[COUNT] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    static const gic_real uneven_x[COUNT] = {-1, 0, GIC_R(0.125), GIC_R(0.25), 2, 3, 4, 4.5, 5, 6, 10, 100};
    static const gic_real left[COUNT] = {0, 1, 1, 0, 0, -1, 2, 2, 2, 1, 0, 0},
                          right[COUNT] = {1, 0, 0, 0, 3, 3, 3, 3, 1, 2, 3, 4};
    static gic_real slope[6][COUNT], field[NX * NY], tracks[2 * TRACKS];
    static const gic_bump bump[] = {{0, 2, GIC_R(0.1), -10, 0},
                                    {0, 2, GIC_R(0.1), GIC_R(1e-8), 10},
                                    {1, 2, GIC_R(0.2), -10, 10},
                                    {1, GIC_R(0.5), -1, 0, 1},
                                    {4, 1, 1, -1, 1}};
    static const gic_friction_patch patch[] = {
        {0, 1, 0, 1, GIC_R(0.5), GIC_R(0.5)}, {0, 10, -1, 1, GIC_R(0.25), 1}, {2, 3, 0, 4, 2, 1}};
    const gic_iso8608 profile = {'C', 1, 0, 6, 2, 1};
    const gic_road_plane plane = {{gic_plane_height, NULL, gic_plane_bend, NULL, GIC_ROAD_PLANE}, 1, GIC_R(0.5), -1};
    const gic_road_sine sine = {{gic_sine_height, NULL, gic_sine_bend, NULL, GIC_ROAD_SINE}, 1, 4, 0, 1};
    gic_road_bumps bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, bump, 5, 0};
    gic_road_bumps no_bumps = {{gic_bumps_height, NULL, gic_bumps_bend, NULL, GIC_ROAD_BUMPS}, NULL, 0, 0};
    gic_road_table table = {{gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE},
                            table_x,
                            left,
                            right,
                            slope[0],
                            slope[1],
                            COUNT};
    gic_road_table uneven = {{gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE},
                             uneven_x,
                             right,
                             left,
                             slope[2],
                             slope[3],
                             COUNT};
    gic_road_table two = {
        {gic_table_height, NULL, gic_table_bend, NULL, GIC_ROAD_TABLE}, table_x, left, left, slope[4], slope[5], 2};
    const gic_road_grid grid = {
        {gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID}, -1, -2, 1, 1, NX, NY, field};
    const gic_road_grid cell = {{gic_grid_height, NULL, gic_grid_bend, NULL, GIC_ROAD_GRID}, 0, 0, 2, 1, 2, 2, field};
    gic_road_grid random = {.x0 = 0};
    const gic_road own = {own_height, NULL, NULL, NULL, GIC_ROAD_OWN};
    const gic_road *const part[] = {&plane.head, &bumps.head, &sine.head, &own};
    const gic_road_sum sum = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, part, 4};
    const gic_road_sum nothing = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, NULL, 0};
    const gic_road *const parts[] = {&sum.head, &grid.head, &table.head};
    const gic_road_sum nested = {{gic_sum_height, NULL, gic_sum_bend, NULL, GIC_ROAD_SUM}, parts, 3};
    const gic_road_patched patched = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        &nested.head,
        1,
        patch,
        1};
    const gic_road_patched bare = {
        {gic_patched_height, gic_patched_friction, gic_patched_bend, gic_patched_friction_slope, GIC_ROAD_PATCHED},
        NULL,
        1,
        patch,
        3};
    /* with friction of its own */
    const gic_road_plane slippery = {{gic_plane_height, own_friction, gic_plane_bend, NULL, GIC_ROAD_PLANE}, 0, 0, 0};
    const gic_road *const road[] = {NULL,          &plane.head,  &sine.head,    &bumps.head,   &no_bumps.head,
                                    &table.head,   &uneven.head, &two.head,     &grid.head,    &cell.head,
                                    &random.head,  &own,         &sum.head,     &nothing.head, &nested.head,
                                    &patched.head, &bare.head,   &slippery.head};
    enum { ROADS = sizeof road / sizeof *road };
    int i, l, round;
    for (i = 0; i < NX * NY; ++i)
        field[i] = (gic_real)(i * i % 7) - 3;
    if (gic_road_bumps_setup(&bumps) || gic_road_bumps_setup(&no_bumps) || gic_road_table_setup(&table) ||
        gic_road_table_setup(&uneven) || gic_road_table_setup(&two) || gic_road_grid_check(&grid) ||
        gic_road_iso8608_setup(&random, &profile, tracks, TRACKS))
        return 1;
    srand(1);
    for (round = 0; round < 40000; ++round) {
        const gic_road *under[GIC_LANES];
        int32_t lane[GIC_LANES];
        gic_lane time, x, y, out[3];
        gic_real expected[GIC_LANES][3], friction[GIC_LANES];
        long calls;
        FOR_LANES(l)
        {
            /* one road under all, or each its own */
            under[l] = round % 2 ? road[(round / 2) % ROADS] : road[rand() % ROADS];
            lane[l] = l;
            time[l] = (gic_real)(l + 1) / 8;
            x[l] = pick();
            y[l] = pick();
        }
        asked = 0;
        FOR_LANES(l)
        {
            expected[l][0] = expected[l][1] = expected[l][2] = 0;
            if (under[l])
                under[l]->height(under[l], l, time[l], x[l], y[l], expected[l]);
        }
        FOR_LANES(l)
        friction[l] = under[l] && under[l]->friction ? under[l]->friction(under[l], l, time[l], x[l], y[l]) : 1;
        calls = asked;
        asked = 0;
        LANE_HEIGHTS(under, lane, &time, &x, &y, out);
        const gic_lane rubs = LANE_FRICTIONS(under, lane, &time, &x, &y);
        wrong_calls += asked != calls;
        /* one of them has the same bits with its likes beside it, also where products are contracted */
        if (calls == 0) {
            const int one = round % GIC_LANES;
            const gic_lane same_x = LANE(x[one]), same_y = LANE(y[one]);
            const gic_road *alike[GIC_LANES];
            gic_lane among[3];
            FOR_LANES(l)
            alike[l] = under[one];
            LANE_HEIGHTS(alike, lane, &time, &same_x, &same_y, among);
            const gic_lane rub = LANE_FRICTIONS(alike, lane, &time, &same_x, &same_y);
            for (i = 0; i < 3; ++i)
                beside += memcmp(&((const gic_real *)&among[i])[one], &((const gic_real *)&out[i])[one],
                                 sizeof(gic_real)) != 0 &&
                          !(among[i][one] != among[i][one] && out[i][one] != out[i][one]);
            beside += !(rub[one] == rubs[one]) && !(rub[one] != rub[one] && rubs[one] != rubs[one]);
        }
        FOR_LANES(l)
        {
            const gic_real apart = rubs[l] - friction[l];
            ++compared;
#ifdef EXACT
            const int good = apart == 0 || (rubs[l] != rubs[l] && friction[l] != friction[l]);
#else
            const int good = !(GIC_MATH(fabs)(apart) > (sizeof(gic_real) == 4 ? GIC_R(1e-5) : GIC_R(1e-14)));
#endif
            if (!good && ++failed < 10)
                printf("friction at x = %.17g y = %.17g: %.17g in lanes, %.17g alone\n", (double)x[l], (double)y[l],
                       (double)rubs[l], (double)friction[l]);
        }
        FOR_LANES(l)
        for (i = 0; i < 3; ++i) {
            const gic_real a = out[i][l], b = expected[l][i];
#ifdef EXACT
            const gic_real tolerance = 0;
#else
            const gic_real tolerance = (sizeof(gic_real) == 4 ? GIC_R(4e-4) : GIC_R(4e-13)) * (1 + GIC_MATH(fabs)(b));
            if ((x[l] - x[l] == 0 && GIC_MATH(fabs)(x[l]) > 1000) || (y[l] - y[l] == 0 && GIC_MATH(fabs)(y[l]) > 1000))
                continue;
#endif
            ++compared;
            if (a == b || (a != a && b != b) || GIC_MATH(fabs)(a - b) <= tolerance)
                continue;
            if (++failed < 10)
                printf("road %d at x = %.17g y = %.17g, number %d: %.17g in lanes, %.17g alone\n",
                       under[l] ? (int)under[l]->kind : -1, (double)x[l], (double)y[l], i, (double)a, (double)b);
        }
    }
    if (beside)
        printf("%ld numbers depend on the lanes beside them\n", beside);
    if (wrong_calls)
        printf("%ld calls of a road of one's own that were not due\n", wrong_calls);
    printf("%ld numbers, %ld wrong\n", compared, failed);
    return failed || wrong_calls || beside || compared < 100000;
}
