/* SPDX-License-Identifier: MIT
 * Runs of engines with integrators: error against a reference, CPU time over repetitions. */
#include "base/message.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/run.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool setting_constant(Setting setting)
{
    return setting.method < METHOD_ADAMS;
}

const char *setting_text(Pool *pool, Setting setting)
{
    return setting_constant(setting) ? pool_print(pool, "%g ms", 1e3 * setting.value)
                                     : pool_print(pool, "%g", setting.value);
}

int bench_samples(const Scene *scene)
{
    return (int)floor(scene->duration / bench_sample * (1 + 1e-12) + 1e-9) + 1;
}

Scene bench_scene(const Scene *scene, Setting setting)
{
    Scene changed = *scene;
    changed.method = setting.method;
    if (setting_constant(setting))
        changed.step = setting.value;
    else
        changed.tolerance = setting.value;
    return changed;
}

/* ---- statistics ------------------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_ascending(double *value, int count)
{
    qsort(value, (size_t)count, sizeof *value, ascending);
}

Spread spread_of(Pool *pool, const double *value, int count)
{
    double *sorted = pool_alloc(pool, sizeof *sorted * (size_t)count);
    memcpy(sorted, value, sizeof *sorted * (size_t)count);
    sort_ascending(sorted, count);
    return (Spread){(sorted[(count - 1) / 2] + sorted[count / 2]) / 2, sorted[0], sorted[count - 1]};
}

Spread spread_of_ratio(Pool *pool, const double *over, const double *under, int count)
{
    double *ratio = pool_alloc(pool, sizeof *ratio * (size_t)count);
    for (int i = 0; i < count; ++i)
        ratio[i] = over[i] / under[i];
    return spread_of(pool, ratio, count);
}

double bench_look(Pool *pool)
{
    enum { LOOKS = 1001 };
    double *seconds = pool_alloc(pool, sizeof *seconds * LOOKS);
    for (int i = 0; i < LOOKS; ++i) {
        const double before = clock_seconds(CLOCK_MONOTONIC);
        seconds[i] = clock_seconds(CLOCK_MONOTONIC) - before;
    }
    return spread_of(pool, seconds, LOOKS).median;
}

/* ---- trajectories ----------------------------------------------------------------------------------------- */

static Trajectory trajectory_new(Pool *pool, const Scene *scene, const gic_model *code)
{
    Trajectory out = {bench_samples(scene), 7 * code->body_count, NULL};
    out.pose = pool_alloc(pool, sizeof(double) * (size_t)(out.samples * out.numbers));
    for (int i = 0; i < out.samples * out.numbers; ++i)
        out.pose[i] = NAN;
    return out;
}

/* Distance of two poses: of origins, and of orientations, twice the angle between +-e_a and e_b. */
static double pose_distance(const double a[7], const double b[7])
{
    double distance = 0, same = 0, opposite = 0;
    for (int i = 0; i < 3; ++i)
        distance += (a[i] - b[i]) * (a[i] - b[i]);
    for (int i = 3; i < 7; ++i) {
        same += (a[i] - b[i]) * (a[i] - b[i]);
        opposite += (a[i] + b[i]) * (a[i] + b[i]);
    }
    const double turned = 4 * asin(fmin(1, sqrt(same < opposite ? same : opposite) / 2));
    distance = sqrt(distance);
    return isnan(distance) || isnan(turned) ? INFINITY : fmax(distance, turned);
}

double trajectory_error(const Trajectory *a, const Trajectory *b)
{
    double largest = 0;
    for (int i = 0; i < a->samples * a->numbers; i += 7)
        largest = fmax(largest, pose_distance(a->pose + i, b->pose + i));
    return largest;
}

/* ---- runs --------------------------------------------------------------------------------------------------- */

/* Up to the next sample. Returns the status of the last step. */
static int to_sample(const Engine *engine, const Scene *scene, Variable *variable, gic_head *self, int sample,
                     int64_t *steps)
{
    const gic_model *code = engine->code;
    const double end = sample * bench_sample;
    int status = GIC_OK;
    if (variable) {
        while (status == GIC_OK && gic_time(self) < end) {
            status = scene_step(engine, code, scene, variable, self, end);
            ++*steps;
        }
        return status;
    }
    const int64_t count = llround(bench_sample / scene->step);
    for (int64_t i = 0; i < count && status == GIC_OK; ++i) {
        status = scene_step(engine, code, scene, NULL, self, end);
        ++*steps;
    }
    return status;
}

static int record(Pool *pool, const Engine *engine, const gic_head *self, double *pose)
{
    gic_head *copy = pool_alloc(pool, engine->code->size);
    memcpy(copy, self, engine->code->size); /* looking leaves no trace */
    return engine->code->poses(copy, pose);
}

/* One run. Fills status, end, steps and evaluations of the trial, its trajectory unless that is NULL, and returns its
 * CPU time in seconds. */
static double run(const Engine *engine, gic_head *self, const Scene *scene, Trial *trial, Trajectory *trajectory)
{
    const gic_model *code = engine->code;
    const Scene changed = bench_scene(scene, trial->setting);
    const int samples = bench_samples(scene);
    Pool *pool = pool_new();
    trial->steps = 0;
    trial->status = scene_start(engine, &changed, self);
    Variable *variable =
        setting_constant(trial->setting) ? NULL : variable_open(code, changed.method, changed.tolerance);
    if (trajectory && trial->status == GIC_OK)
        trial->status = record(pool, engine, self, trajectory->pose);
    const double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int k = 1; k < samples && trial->status == GIC_OK; ++k) {
        trial->status = to_sample(engine, &changed, variable, self, k, &trial->steps);
        if (trajectory && trial->status == GIC_OK)
            trial->status = record(pool, engine, self, trajectory->pose + k * trajectory->numbers);
    }
    const double seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
    trial->end = gic_time(self);
    trial->evaluations = self->rhs_count;
    variable_close(variable);
    pool_free(pool);
    return seconds;
}

Trajectory reference_run(const Bench *bench, const Scene *scene, double *uncertainty)
{
    const Engine *engine = bench->engine[0];
    const Setting setting[2] = {{METHOD_RKCK, 1e-12}, {METHOD_ADAMS, 1e-12}};
    Trajectory trajectory[2];
    for (int i = 0; i < 2; ++i) {
        Trial trial = {.engine = engine, .setting = setting[i]};
        trajectory[i] = trajectory_new(bench->pool, scene, engine->code);
        bench_progress(bench, "reference with %s", integrator_name(setting[i].method));
        run(engine, bench->instance[0], scene, &trial, &trajectory[i]);
        if (trial.status != GIC_OK)
            diag_fail((Place){scene->source, 0, 0}, "a benchmark needs a scene that runs to its end",
                      "the reference solution ends at t = %.6g s: %s", trial.end,
                      instance_status(bench->pool, engine->code, bench->instance[0], trial.status));
    }
    *uncertainty = trajectory_error(&trajectory[0], &trajectory[1]);
    return trajectory[0];
}

int64_t trial_evaluations(const Bench *bench, const Scene *scene, Setting setting)
{
    Trial trial = {.engine = bench->engine[0], .setting = setting};
    run(bench->engine[0], bench->instance[0], scene, &trial, NULL);
    return trial.evaluations;
}

void trials_run(const Bench *bench, const Scene *scene, Setting setting, const Trajectory *reference, Trial *trial)
{
    for (int e = 0; e < bench->engines; ++e) {
        const Engine *engine = bench->engine[e];
        Trajectory trajectory = trajectory_new(bench->pool, scene, engine->code);
        trial[e] = (Trial){.engine = engine, .setting = setting};
        trial[e].second = pool_alloc(bench->pool, sizeof(double) * (size_t)bench->repetitions);
        bench_progress(bench, "%s %s: error of %s", integrator_name(setting.method), setting_text(bench->pool, setting),
                       engine->name);
        run(engine, bench->instance[e], scene, &trial[e], &trajectory);
        trial[e].error = trajectory_error(&trajectory, reference);
        trial[e].unstable = trial[e].status != GIC_OK || trial[e].error > bench_unstable;
    }
    for (int r = 0; r < bench->repetitions; ++r)
        for (int e = 0; e < bench->engines; ++e) {
            bench_progress(bench, "%s %s: repetition %d of %d, %s", integrator_name(setting.method),
                           setting_text(bench->pool, setting), r + 1, bench->repetitions, bench->engine[e]->name);
            trial[e].second[r] = run(bench->engine[e], bench->instance[e], scene, &trial[e], NULL);
        }
}
