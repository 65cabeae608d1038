/* SPDX-License-Identifier: MIT
 * Tables in lanes (BATCH: code for many vehicles, which has lane_table) against gic_table_value(), to the last bit: at
 * points, beside and between them, at and beyond the ends, of increasing, equal and changing values; at infinity and
 * NaN. Exit status 1, and the first that differs, where they do. */
#include BATCH

#include <stdio.h>
#include <stdlib.h>

enum { POINTS_MOST = 60 };

static uint64_t seed = 20000912;

/* From -1 to 1. */
static gic_real random_number(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (gic_real)((double)(seed >> 11) * 0x1p-52 - 1);
}

static int is_same(gic_real a, gic_real b)
{
    return (a != a && b != b) || memcmp(&a, &b, sizeof a) == 0;
}

/* Ask for some arguments at once, in each lane another one of them first. */
static void ask(const gic_table *table, const gic_real *argument, int count, long *asked)
{
    int first, l;
    for (first = 0; first < count; ++first) {
        gic_lane x, y;
        FOR_LANES(l)
        x[l] = argument[(first + 7 * l) % count];
        y = lane_table(table, x);
        FOR_LANES(l)
        {
            const gic_real expected = gic_table_value(table, x[l]);
            ++*asked;
            if (is_same(y[l], expected))
                continue;
            printf("%d points, cubic %d, onward %d, at %.17g in lane %d: %.17g, not %.17g\n", (int)table->count,
                   (int)table->cubic, (int)table->onward, (double)x[l], l, (double)y[l], (double)expected);
            exit(1);
        }
    }
}

int main(void)
{
    static const int points[] = {1, 2, 3, 4, 7, 24, 25, 26, POINTS_MOST};
    gic_real x[POINTS_MOST], y[POINTS_MOST], slope[POINTS_MOST], argument[8 * POINTS_MOST];
    long asked = 0;
    size_t p;
    int kind, way, i;
    for (p = 0; p < sizeof points / sizeof *points; ++p)
        for (kind = 0; kind < 4; ++kind)
            for (way = 0; way < 4; ++way) {
                const gic_table table = {x, y, slope, points[p], way % 2, way / 2};
                const int last = points[p] - 1;
                int count = 0;
                for (i = 0; i <= last; ++i) {
                    /* whole numbers from 0 on, all values equal; whole numbers about 0; any; far away and close
                     * together */
                    const gic_real step = kind < 2 ? (gic_real)1 : (gic_real)1.5 + random_number();
                    x[i] = i           ? x[i - 1] + (kind == 3 ? (gic_real)0.0625 * step : step)
                           : kind == 0 ? (gic_real)0
                           : kind == 3 ? (gic_real)4000
                                       : -(gic_real)(last / 2);
                    y[i] = kind == 0 ? (gic_real)3 : kind == 1 ? (gic_real)(i % 3) : random_number() * random_number();
                    slope[i] = kind == 0 ? (gic_real)0 : random_number();
                }
                for (i = 0; i <= last; ++i) {
                    argument[count++] = x[i];
                    argument[count++] = MATH(nextafter)(x[i], -(gic_real)INFINITY);
                    argument[count++] = MATH(nextafter)(x[i], (gic_real)INFINITY);
                    argument[count++] = i < last ? (x[i] + x[i + 1]) / 2 : x[i] + 1;
                    argument[count++] = i < last ? x[i] + (x[i + 1] - x[i]) * (1 + random_number()) / 2 : x[i] + 100;
                }
                argument[count++] = x[0] - 1;
                argument[count++] = (gic_real)INFINITY;
                argument[count++] = -(gic_real)INFINITY;
                argument[count++] = (gic_real)NAN;
                argument[count++] = -(gic_real)0;
                ask(&table, argument, count, &asked);
            }
    printf("%ld\n", asked);
    return asked < 10000;
}
