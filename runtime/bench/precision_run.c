/* SPDX-License-Identifier: MIT
 * Ways to integrate a scene with events, and the solution that they are compared with. */
#include "base/message.h"
#include "bench/bench.h"
#include "bench/precision.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/run.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* ---- tracks ----------------------------------------------------------------------------------------------- */

Track track_new(Pool *pool, const Scene *scene, const gic_model *code)
{
    Track track = {(int)scene->outputs + 1, code->free_base ? 1 : code->body_count, NULL};
    const int numbers = 3 * track.rows * track.bodies;
    track.point = pool_alloc(pool, sizeof *track.point * (size_t)numbers);
    for (int i = 0; i < numbers; ++i)
        track.point[i] = NAN;
    return track;
}

double track_distance(const Track *a, const Track *b)
{
    double largest = 0;
    for (int i = 0; i < 3 * a->rows * a->bodies; i += 3) {
        const double *x = a->point + i, *y = b->point + i;
        const double distance =
            sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
        largest = isnan(distance) ? INFINITY : fmax(largest, distance);
    }
    return largest;
}

/* ---- runs ------------------------------------------------------------------------------------------------- */

/* A run under way. */
typedef struct Going {
    const Engine *engine;
    gic_model code; /* without `shift` where the runtime does not change gears */
    GearChange change;
    Scene scene;
    Variable *variable; /* NULL: constant steps */
    gic_head *self;
    gic_head *copy, *before, *trial; /* copy: for looks; the others: for GEAR_BISECTED */
    int changes;                     /* of gear, which are not the runtime's */
} Going;

static bool gear_is_due(const Going *going, const gic_head *at)
{
    memcpy(going->copy, at, going->code.size);
    return going->engine->code->shift(going->copy);
}

/* The instance `self` at `time`, within the last step, from the start of that step without a history. */
static int repeat_until(const Going *going, double time, gic_head *self)
{
    int status = GIC_OK;
    memcpy(self, going->before, going->code.size);
    variable_restart(going->variable);
    while (status == GIC_OK && gic_time(self) < time)
        status = scene_step_awake(going->engine, &going->code, &going->scene, going->variable, self, time);
    return status;
}

/* Go back within the last step to the time at which the gear changes, and change it. */
static int return_to_change(Going *going)
{
    double low = gic_time(going->before), high = gic_time(going->self);
    int status = GIC_OK;
    for (double middle; status == GIC_OK && low < (middle = 0.5 * (low + high)) && middle < high;) {
        status = repeat_until(going, middle, going->trial);
        if (gear_is_due(going, going->trial))
            high = middle;
        else
            low = middle;
    }
    if (status == GIC_OK)
        status = repeat_until(going, high, going->self);
    variable_restart(going->variable);
    if (status == GIC_OK)
        going->changes += going->engine->code->shift(going->self); /* 0: this time the step ends just before it */
    return status;
}

static int going_step(Going *going, double end)
{
    if (going->change == GEAR_BISECTED)
        memcpy(going->before, going->self, going->code.size);
    const int status = scene_step(going->engine, &going->code, &going->scene, going->variable, going->self, end);
    if (status != GIC_OK || going->change == GEAR_BY_RUNTIME)
        return status;
    if (going->change == GEAR_BISECTED)
        return gear_is_due(going, going->self) ? return_to_change(going) : status;
    const int changed = going->engine->code->shift(going->self);
    going->changes += changed;
    if (changed && going->variable)
        variable_restart(going->variable);
    return status;
}

/* Up to the k-th output time. */
static int going_output(Going *going, int64_t k)
{
    const double end = (double)k * going->scene.output_step;
    int status = GIC_OK;
    if (going->variable) {
        while (status == GIC_OK && gic_time(going->self) < end)
            status = going_step(going, end);
        return status;
    }
    const int64_t steps = llround(going->scene.output_step / going->scene.step);
    for (int64_t i = 0; i < steps && status == GIC_OK; ++i)
        status = going_step(going, end);
    return status;
}

/* Positions at the present time, computed on a copy. */
static int track_point(const Going *going, const Track *track, int64_t row, double *pose)
{
    memcpy(going->copy, going->self, going->code.size);
    const int status = going->code.poses(going->copy, pose);
    for (int i = 0; i < track->bodies && status == GIC_OK; ++i)
        memcpy(track->point + 3 * (row * track->bodies + i), pose + 7 * i, 3 * sizeof *pose);
    return status;
}

/* The scene by the ride; nothing is left out at run time. */
static Going going_begin(Pool *pool, const Engine *engine, gic_head *self, const Scene *scene, const Ride *ride)
{
    Going going = {.engine = engine, .code = *engine->code, .self = self, .change = ride->change};
    if (!going.code.shift)
        going.change = GEAR_BY_RUNTIME;
    if (going.change != GEAR_BY_RUNTIME)
        going.code.shift = NULL;
    going.scene = bench_scene(scene, ride->setting);
    going.scene.ratio = ride->ratio;
    going.scene.locate = ride->locate;
    going.scene.keep = ride->keep > 0 ? ride->keep : 1;
    going.scene.rest = NULL;
    going.scene.steady = 0;
    gic_head **const place[] = {&going.copy, &going.before, &going.trial};
    for (int i = 0; i < 3; ++i)
        *place[i] = instance_new(pool, engine);
    return going;
}

RideEnd ride_run(const Engine *engine, gic_head *self, const Scene *scene, const Ride *ride, Track *track)
{
    Pool *pool = pool_new();
    Going going = going_begin(pool, engine, self, scene, ride);
    double *pose = pool_alloc(pool, sizeof *pose * (size_t)(7 * engine->code->body_count + 1));
    int status = scene_start(engine, &going.scene, self);
    if (!setting_constant(ride->setting) &&
        !(going.variable = variable_open(&going.code, going.scene.method, going.scene.tolerance)))
        diag_fail(program_place(), NULL, "no memory for the integrator");
    if (status == GIC_OK && track)
        status = track_point(&going, track, 0, pose);
    const double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int64_t k = 1; k <= scene->outputs && status == GIC_OK; ++k) {
        status = going_output(&going, k);
        if (status == GIC_OK && track)
            status = track_point(&going, track, k, pose);
    }
    const RideEnd end = {.status = status,
                         .time = gic_time(self),
                         .second = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before,
                         .rhs = self->rhs_count,
                         .fast = self->fast_count,
                         .changes = going.changes,
                         .contacts = self->contact_count};
    variable_close(going.variable);
    self->user = (void *)(uintptr_t)scene; /* the other one ends here */
    pool_free(pool);
    return end;
}

/* ---- the reference ---------------------------------------------------------------------------------------- */

/* A solution with variable steps at the tightest tolerance that works. Returns that, 0: none does. */
static double tightest(const Bench *bench, const Engine *engine, gic_head *self, const Scene *scene, int32_t method,
                       Track *track, RideEnd *end)
{
    static const double tolerance[] = {1e-13, 1e-12, 1e-11, 1e-10, 1e-9};
    for (size_t i = 0; i < sizeof tolerance / sizeof *tolerance; ++i) {
        const Ride ride = {{method, tolerance[i]}, 1, GEAR_BISECTED, false, 1};
        bench_progress(bench, "reference with %s, tolerance %g", integrator_name(method), tolerance[i]);
        *end = ride_run(engine, self, scene, &ride, track);
        if (end->status == GIC_OK)
            return tolerance[i];
    }
    return 0;
}

Reference precision_reference(const Bench *bench, const Engine *engine, gic_head *self, const Scene *scene)
{
    static const int32_t method[2] = {METHOD_RKCK, METHOD_ADAMS};
    Pool *pool = bench->pool;
    const char *name[2];
    Track track[3];
    RideEnd end;
    int changes = 0;
    int64_t contacts = 0;
    for (int i = 0; i < 2; ++i) {
        track[i] = track_new(pool, scene, engine->code);
        const double tolerance = tightest(bench, engine, self, scene, method[i], &track[i], &end);
        changes += end.changes;
        contacts += end.contacts;
        name[i] = pool_print(pool, "%s with a tolerance of %g", integrator_name(method[i]), tolerance);
        if (!(tolerance > 0))
            diag_fail((Place){scene->source, 0, 0}, "a benchmark needs a scene that runs to its end",
                      "the reference solution with %s ends at t = %.6g s: %s", integrator_name(method[i]), end.time,
                      instance_status(pool, engine->code, self, end.status));
    }
    bench_progress(bench, "reference with rk4, a sixteenth of the step");
    const Ride fine = {{GIC_RK4, scene->step / 16}, 1, GEAR_BY_RUNTIME, true, 1};
    track[2] = track_new(pool, scene, engine->code);
    ride_run(engine, self, scene, &fine, &track[2]);
    Reference reference = {.track = track[0],
                           .name = name[0],
                           .check = {name[1], "rk4 with a sixteenth of the step"},
                           .shifts = changes > 0,
                           .touches = contacts > 0};
    for (int i = 0; i < 2; ++i)
        reference.distance[i] = track_distance(&track[0], &track[1 + i]);
    reference.uncertainty = fmin(reference.distance[0], reference.distance[1]);
    return reference;
}
