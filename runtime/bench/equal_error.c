/* SPDX-License-Identifier: MIT
 * CPU time of ways to integrate at equal errors. */
#include "bench/bench.h"
#include "bench/precision.h"

#include <math.h>
#include <stdbool.h>

double equal_error_second(const WayRows *rows, double error, int repetition)
{
    for (int i = 0; i < rows->rows; ++i) {
        const double second = rows->second[i][repetition];
        if (!(rows->error[i] <= error))
            continue;
        if (i == 0 || !(rows->error[i - 1] > error))
            return second;
        const double before = rows->second[i - 1][repetition];
        const double part = log(rows->error[i - 1] / error) / log(rows->error[i - 1] / rows->error[i]);
        return before * pow(second / before, part);
    }
    return NAN;
}

/* Does a tenth of the error take another time of any way? */
static bool says_more(const WayRows *way, int ways, double error)
{
    bool more = false;
    for (int w = 0; w < ways && !more; ++w) {
        const double now = equal_error_second(&way[w], error, 0);
        more = !isnan(now) && now != equal_error_second(&way[w], error / 10, 0);
    }
    return more;
}

void equal_error_tell(Report *report, const char *name, const char *model, const char *scene, const WayRows *way,
                      int ways, int repetitions)
{
    Pool *pool = report->pool;
    double *time = pool_alloc(pool, sizeof *time * (size_t)(2 * repetitions)), *first = time + repetitions;
    Sheet *table = report_table(report, name, "CPU time within an error, over that of the first way",
                                "model|scene|error [m]|way|CPU [ms]|lowest|highest|ratio|least|most");
    table->note = "Between two rows along a straight line in logarithms; where the longest step that is told keeps the "
                  "error, its time. The ratio is of each repetition's own times.";
    for (int power = -2; power >= -9; --power)
        for (int w = 0; w < ways && says_more(way, ways, pow(10, power)); ++w) {
            const double error = pow(10, power);
            for (int r = 0; r < repetitions; ++r) {
                time[r] = equal_error_second(&way[w], error, r);
                first[r] = equal_error_second(&way[0], error, r);
            }
            if (isnan(time[0]))
                continue;
            table_cell(pool, table, "%s", model);
            table_cell(pool, table, "%s", scene);
            table_cell(pool, table, "1e%d", power);
            table_cell(pool, table, "%s", way[w].way);
            spread_cells(pool, table, spread_of(pool, time, repetitions), 1e3);
            if (!isnan(first[0]))
                spread_cells(pool, table, spread_of_ratio(pool, time, first, repetitions), 1);
            while (table->cells % table->columns)
                table_cell(pool, table, "-");
        }
}
