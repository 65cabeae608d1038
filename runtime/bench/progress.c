/* SPDX-License-Identifier: MIT
 * The estimated time of a benchmark, and its progress. */
#include "base/message.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <stdarg.h>

/* A time in minutes and seconds. */
static const char *minutes(Pool *pool, double seconds)
{
    const long whole = lround(seconds);
    return pool_print(pool, "%ld:%02ld", whole / 60, whole % 60);
}

void bench_progress(const Bench *bench, const char *format, ...)
{
    const Progress *progress = bench->progress;
    const double elapsed = clock_seconds(CLOCK_MONOTONIC) - progress->begun;
    va_list arguments;
    va_start(arguments, format);
    Pool *pool = pool_new();
    const char *text = pool_vprint(pool, format, arguments);
    if (progress->expected > 0)
        text = pool_print(pool, "%s of about %s: %s", minutes(pool, elapsed),
                          minutes(pool, fmax(progress->expected, elapsed)), text);
    diag_progress(text);
    pool_free(pool);
    va_end(arguments);
}

void bench_expect(const Bench *bench, double seconds)
{
    Pool *pool = pool_new();
    const double elapsed = clock_seconds(CLOCK_MONOTONIC) - bench->progress->begun;
    if (!(bench->progress->expected > 0)) {
        diag_progress("");
        diag_note(pool_print(pool, "this will take about %s\n", minutes(pool, seconds)));
    }
    bench->progress->expected = elapsed + seconds;
    pool_free(pool);
}

void bench_extrapolate(const Bench *bench, int done, int all)
{
    const double elapsed = clock_seconds(CLOCK_MONOTONIC) - bench->progress->begun;
    bench_expect(bench, elapsed * (all - done) / done);
}

double bench_step_seconds(const Engine *engine, gic_head *self, const Scene *scene, double *evaluation)
{
    enum { STEPS = 40 };
    int status = scene_start(engine, scene, self), steps = 0;
    const int64_t evaluations = self->rhs_count;
    const double before = clock_seconds(CLOCK_MONOTONIC);
    for (; steps < STEPS && status == GIC_OK; ++steps)
        status = scene_step(engine, engine->code, scene, NULL, self, 0);
    const double seconds = clock_seconds(CLOCK_MONOTONIC) - before;
    if (evaluation)
        *evaluation = seconds / fmax(1, (double)(self->rhs_count - evaluations));
    return seconds / fmax(1, steps);
}
