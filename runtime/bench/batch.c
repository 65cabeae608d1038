/* SPDX-License-Identifier: MIT
 * Many vehicles at once against one after another (gicbench --batch): time of a step of one vehicle. */
#include "base/message.h"
#include "bench/bench.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 20, FIRST = 2 /* timed steps, and untimed ones with which AB3 starts */ };

/* A way to simulate many vehicles. */
typedef struct Way {
    const char *name, *flags; /* flags: of the compiler, after the default ones */
    int lanes;                /* 0: one vehicle after another */
} Way;

static const Way way[] = {
    {"one after another, -O2", "", 0},   {"one after another, -O3 -march=native", "-O3 -march=native", 0},
    {"2 lanes", "-O3 -march=native", 2}, {"4 lanes", "-O3 -march=native", 4},
    {"8 lanes", "-O3 -march=native", 8}, {"4 lanes, threads", "-O3 -march=native -fopenmp", 4},
};
enum { WAYS = sizeof way / sizeof *way, COMPARED = 1 };

/* One way, with its vehicles. */
typedef struct Batched {
    const Engine *engine; /* NULL: not available */
    const gic_batch_model *many;
    void *batch;
    gic_head **car; /* [vehicles] at the scene's start; without lanes they advance */
    double best;    /* s, of all steps */
} Batched;

/* Vehicles begin at speeds between 0.9 and 1.1 times the scene's, so that lanes differ. */
static void start(const Bench *bench, const Scene *scene, int vehicles, Batched *b)
{
    for (int i = 0; i < vehicles; ++i) {
        Scene own = *scene;
        for (int k = 0; k < 3; ++k)
            own.velocity[k] *= 0.9 + 0.2 * i / vehicles;
        int status = scene_start(b->engine, &own, b->car[i]);
        b->car[i]->user = (void *)scene;
        if (status != GIC_OK)
            diag_fail((Place){scene->source, 0, 0}, NULL, "the model can't be set up: %s",
                      instance_status(bench->pool, b->engine->code, b->car[i], status));
    }
    if (b->many) {
        b->many->setup(b->batch);
        for (int i = 0; i < vehicles; ++i)
            b->many->load(b->batch, i, b->car[i]);
    }
}

static void steps(const Scene *scene, int vehicles, const Batched *b, int count)
{
    const bool dual = scene->method == GIC_AB3 && b->engine->code->fast_count > 0;
    if (b->many && dual)
        b->many->step_dual(b->batch, scene->step, scene->ratio, scene->steady, count);
    else if (b->many)
        b->many->step(b->batch, scene->step, scene->method, count);
    for (int i = 0; i < vehicles && !b->many; ++i)
        for (int k = 0; k < count; ++k) {
            if (dual)
                gic_step_steady(b->engine->code, b->car[i], scene->step, scene->ratio, scene->steady);
            else
                gic_step(b->engine->code, b->car[i], scene->step, scene->method);
        }
}

/* A single thread is timed by its CPU time, several threads by the wall clock. */
static void run(const Scene *scene, int vehicles, const Way *w, Batched *b)
{
    const clockid_t clock = strstr(w->flags, "openmp") ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID;
    steps(scene, vehicles, b, FIRST);
    const double before = clock_seconds(clock);
    steps(scene, vehicles, b, STEPS);
    b->best = fmin(b->best, clock_seconds(clock) - before);
    for (int i = 0; i < vehicles && b->many; ++i)
        b->many->store(b->batch, i, b->car[i]);
}

/* Largest difference of the states of two ways, relative to 1 + |x|; INFINITY where a vehicle failed. */
static double difference(int vehicles, const Batched *a, const Batched *b)
{
    const gic_model *code = a->engine->code;
    double largest = 0;
    for (int i = 0; i < vehicles; ++i) {
        const double *x = instance_array(a->car[i], code->state_offset);
        const double *y = instance_array(b->car[i], code->state_offset);
        if (b->car[i]->status != GIC_OK)
            return INFINITY;
        for (int s = 0; s < code->slow_count + code->fast_count; ++s)
            largest = fmax(largest, fabs(x[s] - y[s]) / (1 + fabs(x[s])));
    }
    return largest;
}

static Batched open_way(const Bench *bench, const Way *w, int vehicles)
{
    Batched b = {.best = INFINITY};
    EngineOptions options = bench->options;
    const char *why = NULL;
    if (w->lanes) {
        const Batch batch = {vehicles, w->lanes};
        b.engine = engine_batch(bench->pool, bench->model, &options, &batch, w->flags, &b.many, &why);
    } else {
        options.flags = pool_print(bench->pool, "%s %s", w->flags, options.flags);
        b.engine = engine_cc(bench->pool, bench->model, &options);
    }
    if (!b.engine) {
        diag_note(
            pool_print(bench->pool, "%s: note: no times for %s: %s\n", program_place().source->path, w->name, why));
        return b;
    }
    if (b.many) {
        b.batch = aligned_alloc(b.many->alignment, b.many->size);
        if (!b.batch)
            diag_fail(program_place(), "ask for fewer vehicles", "no memory for %d vehicles", vehicles);
    }
    b.car = pool_alloc(bench->pool, sizeof *b.car * (size_t)vehicles);
    for (int i = 0; i < vehicles; ++i)
        b.car[i] = instance_new(bench->pool, b.engine);
    return b;
}

void bench_batch(const Bench *bench)
{
    const int vehicles = bench->vehicles;
    const Scene *scene = bench->scene;
    const int runs = 30 * bench->repetitions;
    Batched all[WAYS];
    if (scene->method > GIC_RK4 || scene->driver)
        diag_fail((Place){scene->source, 0, 0}, "another scene", "lanes take constant steps and no driver");
    for (int w = 0; w < WAYS; ++w) {
        bench_progress(bench, "compiling for %s", way[w].name);
        all[w] = open_way(bench, &way[w], vehicles);
    }
    for (int r = 0; r < runs; ++r) {
        const double begun = clock_seconds(CLOCK_MONOTONIC);
        for (int w = 0; w < WAYS; ++w)
            if (all[w].engine) {
                start(bench, scene, vehicles, &all[w]);
                run(scene, vehicles, &way[w], &all[w]);
            }
        if (r == 0)
            bench_expect(bench, (runs - 1) * (clock_seconds(CLOCK_MONOTONIC) - begun));
        if (r % 30 == 0)
            bench_progress(bench, "run %d of %d", r + 1, runs);
    }
    const Batched *compared = &all[COMPARED];
    report_heading(bench->report, "Many vehicles at once");
    report_text(
        bench->report,
        "%s, %d vehicles at speeds around the scene's, %d steps of %g s (%s). Time: the best of %d runs, of one "
        "thread its CPU time, of several the wall clock's. Throughput and the largest difference of a number x "
        "of the states, relative to 1 + |x|: against the second row. No multiplication is contracted.",
        bench->model->name, vehicles, STEPS, scene->step, integrator_name(scene->method), runs);
    Sheet *table = report_table(bench->report, "batch", "A step of one vehicle",
                                "way|time, us|throughput|largest difference of states");
    for (int w = 0; w < WAYS; ++w)
        if (all[w].engine) {
            table_cell(bench->pool, table, "%s", way[w].name);
            table_cell(bench->pool, table, "%.3f", 1e6 * all[w].best / vehicles / (int)STEPS);
            table_cell(bench->pool, table, "%.2f", compared->best / all[w].best);
            table_cell(bench->pool, table, "%.2g", difference(vehicles, compared, &all[w]));
        }
    for (int w = 0; w < WAYS; ++w)
        free(all[w].engine ? all[w].batch : NULL);
}
