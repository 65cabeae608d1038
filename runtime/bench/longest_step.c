/* SPDX-License-Identifier: MIT
 * The longest step, which limits hardware in the loop. */
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>

static const Setting setting = {GIC_AB3, 0.005};

/* AB3 begins with steps of RK4, which evaluate four times: they are no part of steady operation. On a busy machine one
 * step or another is interrupted in each of a few repetitions; these take little time. */
enum { START = 2, REPETITIONS = 9 };

/* Elapsed seconds of each step after the first ones, [steps]. Returns how many there are. */
static int time_steps(const Engine *engine, gic_head *self, const Scene *scene, double *seconds, int steps)
{
    if (scene_start(engine, scene, self) != GIC_OK)
        return 0;
    for (int i = 0; i < START + steps; ++i) {
        const double before = clock_seconds(CLOCK_MONOTONIC);
        const int status = scene_step(engine, engine->code, scene, NULL, self, 0);
        if (i >= START)
            seconds[i - START] = clock_seconds(CLOCK_MONOTONIC) - before;
        if (status != GIC_OK)
            return i < START ? 0 : i - START;
    }
    return steps;
}

/* The largest over steps of the smallest over repetitions: interruptions by the system are left out. */
static double undisturbed(const double *seconds, int repetitions, int room, int steps)
{
    double worst = 0;
    for (int i = 0; i < steps; ++i) {
        double best = INFINITY;
        for (int r = 0; r < repetitions; ++r)
            best = fmin(best, seconds[r * room + i]);
        worst = fmax(worst, best);
    }
    return worst;
}

static void worst_row(const Bench *bench, Sheet *table, const Engine *engine, double *seconds, int room, int steps)
{
    Pool *pool = bench->pool;
    table_cell(pool, table, "%s", engine->name);
    if (steps < room) {
        for (int column = 1; column < table->columns; ++column)
            table_cell(pool, table, "unstable");
        return;
    }
    const double best = undisturbed(seconds, REPETITIONS, room, steps);
    const int count = room * REPETITIONS;
    sort_ascending(seconds, count);
    table_cell(pool, table, "%d", count);
    table_cell(pool, table, "%.4g", 1e6 * seconds[count / 2]);
    table_cell(pool, table, "%.4g", 1e6 * seconds[(int)ceil(0.999 * count) - 1]);
    table_cell(pool, table, "%.4g", 1e6 * seconds[count - 1]);
    table_cell(pool, table, "%.4g", 1e6 * best);
    table_cell(pool, table, "%.4g", best / seconds[count / 2]);
}

void bench_worst(const Bench *bench)
{
    const Scene scene = bench_scene(bench->scene, setting);
    const int steps = (int)(scene.duration / setting.value) - START;
    if (steps < 1)
        return;
    double **seconds = pool_alloc(bench->pool, sizeof *seconds * (size_t)bench->engines);
    int *done = pool_alloc(bench->pool, sizeof *done * (size_t)bench->engines);
    for (int e = 0; e < bench->engines; ++e)
        seconds[e] = pool_alloc(bench->pool, sizeof(double) * (size_t)(steps * REPETITIONS));
    for (int r = 0; r < REPETITIONS; ++r)
        for (int e = 0; e < bench->engines; ++e) {
            bench_progress(bench, "longest step: repetition %d, %s", r + 1, bench->engine[e]->name);
            done[e] = time_steps(bench->engine[e], bench->instance[e], &scene, seconds[e] + r * steps, steps);
        }

    report_heading(bench->report, "The longest step");
    report_text(bench->report,
                "Elapsed time of single steps of AB3 with %s, the first two (RK4) left out. The maximum contains "
                "whatever else the machine did. A step does the same in every repetition, so the largest over steps "
                "of the shortest over %d repetitions, the last but one column, is the longest step of the engine "
                "itself; the last column divides it by the median.",
                setting_text(bench->pool, setting), REPETITIONS);
    Sheet *table = report_table(bench->report, "worst", "Time of a step",
                                "engine|steps|median [us]|99.9 % [us]|maximum [us]|undisturbed maximum [us]|"
                                "over median");
    for (int e = 0; e < bench->engines; ++e)
        worst_row(bench, table, bench->engine[e], seconds[e], steps, done[e]);
}
