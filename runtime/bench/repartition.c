/* SPDX-License-Identifier: MIT
 * A vehicle that turns: coordinate partitioning must choose other independent coordinates from time to time,
 * globally independent coordinates only another Euler parameter of the base. */
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

static const Setting setting = {GIC_AB3, 0.005};

/* Steps of one run, sorted by whether the partition changed in them. */
typedef struct Spin {
    int status;
    int64_t steps, changes, changing, switches; /* changing: steps with changes */
    double *quiet, *busy;                       /* s, of steps without and with changes */
    Trajectory end;                             /* its last poses */
    int quiets, busies;
} Spin;

static void spin_run(Pool *pool, const Engine *engine, gic_head *self, const Scene *scene, Spin *spin)
{
    EngineProfile *profile = engine->profile;
    const int64_t steps = (int64_t)(scene->duration / scene->step * (1 + 1e-12));
    if (profile)
        memset(profile, 0, sizeof *profile);
    spin->status = scene_start(engine, scene, self);
    spin->changes = spin->changing = spin->steps = 0;
    for (int64_t i = 0; i < steps && spin->status == GIC_OK; ++i, ++spin->steps) {
        const int64_t changes = profile ? profile->repartitions : 0;
        const double before = clock_seconds(CLOCK_MONOTONIC);
        spin->status = scene_step(engine, engine->code, scene, NULL, self, 0);
        const double seconds = clock_seconds(CLOCK_MONOTONIC) - before;
        if (profile && profile->repartitions > changes) {
            spin->changes += profile->repartitions - changes;
            ++spin->changing;
            *POOL_PUSH(pool, spin->busy, spin->busies) = seconds;
        } else if (i > 1) { /* the first two are of RK4 */
            *POOL_PUSH(pool, spin->quiet, spin->quiets) = seconds;
        }
    }
    spin->switches = self->switch_count;
    spin->end = (Trajectory){1, 7 * engine->code->body_count, NULL};
    spin->end.pose = pool_alloc(pool, sizeof(double) * (size_t)spin->end.numbers);
    if (spin->status == GIC_OK)
        spin->status = engine->code->poses(self, spin->end.pose);
}

/* first: the engine that others are compared with */
static void spin_row(const Bench *bench, Sheet *table, const Engine *engine, const Spin *spin, const Spin *first)
{
    Pool *pool = bench->pool;
    table_cell(pool, table, "%s", engine->name);
    if (spin->status != GIC_OK || !spin->quiets) {
        for (int column = 1; column < table->columns; ++column)
            table_cell(pool, table, "unstable");
        return;
    }
    const double quiet = spread_of(pool, spin->quiet, spin->quiets).median;
    table_cell(pool, table, "%lld", (long long)spin->steps);
    table_cell(pool, table, "%.1e", first->status == GIC_OK ? trajectory_error(&spin->end, &first->end) : INFINITY);
    table_cell(pool, table, "%lld", (long long)spin->switches);
    table_cell(pool, table, "%lld", (long long)spin->changes);
    table_cell(pool, table, "%.4g", 1e6 * quiet);
    if (!spin->busies) {
        for (int column = 6; column < table->columns; ++column)
            table_cell(pool, table, "-");
        return;
    }
    const double busy = spread_of(pool, spin->busy, spin->busies).median;
    table_cell(pool, table, "%.4g", 1e6 * busy);
    table_cell(pool, table, "%.4g", 1e6 * (busy - quiet) * (double)spin->changing / (double)spin->changes);
    table_cell(pool, table, "%.2g", 100 * (busy - quiet) * (double)spin->changing / (quiet * (double)spin->steps));
}

/* Ends of runs with ever smaller steps, against the first engine's with a still smaller one: a difference that does
 * not decrease with the step would be an engine's own error. */
static void convergence(const Bench *bench)
{
    static const double step[] = {0.004, 0.002, 0.001};
    enum { STEPS = sizeof step / sizeof *step };
    Pool *pool = bench->pool;
    Spin finest = {.status = GIC_OK};
    const Scene fine = bench_scene(bench->spin, (Setting){GIC_RK4, step[STEPS - 1] / 4});
    bench_progress(bench, "turning vehicle: reference");
    spin_run(pool, bench->engine[0], bench->instance[0], &fine, &finest);
    Sheet *table = report_table(bench->report, "spin_order", "Distance at the end from a run with RK4 and 0.25 ms",
                                "engine|4 ms|2 ms|1 ms|2 ms over 1 ms");
    for (int e = 0; e < bench->engines; ++e) {
        double error[STEPS];
        for (int i = 0; i < STEPS; ++i) {
            const Scene scene = bench_scene(bench->spin, (Setting){GIC_RK4, step[i]});
            Spin spin = {.status = GIC_OK};
            bench_progress(bench, "turning vehicle: RK4 with %g ms, %s", 1e3 * step[i], bench->engine[e]->name);
            spin_run(pool, bench->engine[e], bench->instance[e], &scene, &spin);
            error[i] =
                spin.status == GIC_OK && finest.status == GIC_OK ? trajectory_error(&spin.end, &finest.end) : INFINITY;
        }
        table_cell(pool, table, "%s", bench->engine[e]->name);
        for (int i = 0; i < STEPS; ++i)
            table_cell(pool, table, error[i] < INFINITY ? "%.1e" : "unstable", error[i]);
        const double shrinks = error[STEPS - 2] / error[STEPS - 1];
        table_cell(pool, table, isfinite(shrinks) ? "%.3g" : "-", shrinks);
    }
    table->note =
        "RK4 is of fourth order: half the step, a sixteenth of the error. Coordinate partitioning integrates Cartesian "
        "coordinates of bodies that turn with the vehicle, where dual coordinates hardly change: for the same step its "
        "errors are larger, and every change of partition adds one. They vanish with the step all the same.";
}

void bench_spin(const Bench *bench)
{
    if (!bench->spin)
        return;
    const Scene scene = bench_scene(bench->spin, setting);
    Spin *spin = pool_alloc(bench->pool, sizeof *spin * (size_t)bench->engines);
    for (int r = 0; r < bench->repetitions; ++r)
        for (int e = 0; e < bench->engines; ++e) {
            bench_progress(bench, "turning vehicle: repetition %d, %s", r + 1, bench->engine[e]->name);
            spin_run(bench->pool, bench->engine[e], bench->instance[e], &scene, &spin[e]);
        }
    report_heading(bench->report, "A vehicle that turns");
    report_text(
        bench->report,
        "%s, AB3 with %s. An engine of generalized coordinate partitioning chooses its independent coordinates "
        "anew where the dependent ones have become ill-conditioned; globally independent coordinates stay, "
        "and only the dependent "
        "Euler parameter of the base changes, at no cost. Switches: what the engine counts of either. The third "
        "column is the distance of any body from where the first engine leaves it: of partitioning it is the error of "
        "the integrator in other coordinates, as the second table shows, which nothing damps here.",
        bench->spin_path, setting_text(bench->pool, setting));
    Sheet *table =
        report_table(bench->report, "spin", "Changes of coordinates",
                     "engine|steps|away at the end [m or rad]|switches|changes of partition|step without [us]|"
                     "step with [us]|cost of a change [us]|cost in the run [%]");
    for (int e = 0; e < bench->engines; ++e)
        spin_row(bench, table, bench->engine[e], &spin[e], &spin[0]);
    convergence(bench);
}
