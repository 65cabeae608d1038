/* SPDX-License-Identifier: MIT
 * A scene as it stands, with its step and ratio: the third experiment of Serban and Haug 2000, section 5, the complete
 * vehicle for 30 s. CPU time, and what of a step goes into multibody system, tires and powertrain; beside the engine cc
 * as it stands its code at fast flags, one by one and with wheels in lanes. */
#include "base/message.h"
#include "base/text.h"
#include "bench/bench.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "run/engines.h"
#include "run/run.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* AB3 starts with steps of RK4, which are left out. */
enum { START = 2 };

/* The parts of a step that are measured, and the step. */
enum { MULTIBODY, TIRES, POWERTRAIN, REST, STEP, PARTS };

/* An engine, the same for the model without its powertrain (NULL: it has none, or its rates can't be compared), and
 * [repetitions] of each part: shares of a step, of STEP the seconds of CPU time of the run. */
typedef struct Driven {
    const char *name;
    const Engine *engine, *plain;
    gic_head *self;
    double *measured[PARTS];
    double *state; /* at the end of the run: FORMAT.md section 10 */
} Driven;

/* Further ways to compile for the engine cc. */
typedef struct Way {
    const char *name, *compiler, *flags; /* compiler: NULL: that of the command line */
    int lanes;
} Way;

#define FASTEST "-O3 -march=native -ffp-contract=fast"
static const Way way[] = {
    {"cc fast", NULL, FASTEST, 0},
    {"cc fast 4 lanes", NULL, FASTEST, 4},
    {"clang fast", "clang", FASTEST, 0},
    {"clang fast 4 lanes", "clang", FASTEST, 4},
};
enum { WAYS = sizeof way / sizeof *way };

/* The model without its powertrain. */
static const Model *without_powertrain(Pool *pool, const Model *model)
{
    Model *plain = pool_alloc(pool, sizeof *plain);
    *plain = *model;
    plain->powertrain = NULL;
    plain->fast_states -= POWERTRAIN_FAST;
    plain->output = pool_alloc(pool, sizeof *plain->output * (size_t)(model->outputs + 1));
    plain->outputs = plain->output_components = 0;
    for (int i = 0; i < model->outputs; ++i)
        if (model->output[i].type != OUTPUT_POWERTRAIN) {
            plain->output[plain->outputs++] = model->output[i];
            plain->output_components += model->output[i].count;
        }
    return plain;
}

static int64_t steps_of(const Scene *scene)
{
    return scene->outputs * scene->per_output;
}

/* CPU seconds of the run; *status: how it ended. */
static double run(const Engine *engine, gic_head *self, const Scene *scene, int *status)
{
    *status = scene_start(engine, scene, self);
    const double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int64_t i = 0; i < steps_of(scene) && *status == GIC_OK; ++i)
        *status = scene_step(engine, engine->code, scene, NULL, self, 0);
    return clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
}

/* Calls within a step that are timed. */
enum { SETTLE, LINK, RHS, FAST, CALLS };

/* A run with timed calls; `user` of the instance points to it. */
typedef struct Timed {
    const gic_model *code;
    const Scene *scene;
    double second[CALLS]; /* of the present step, with the looks at the clock */
    int calls[CALLS];
} Timed;

static Timed *timed_of(void *self)
{
    return ((gic_head *)self)->user;
}

static int tally(Timed *timed, int call, double before, int status)
{
    timed->second[call] += clock_seconds(CLOCK_MONOTONIC) - before;
    ++timed->calls[call];
    return status;
}

static int timed_settle(void *self, double *state)
{
    Timed *timed = timed_of(self);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    return tally(timed, SETTLE, before, timed->code->settle(self, state));
}

static int timed_link(void *self, double time, const double *slow, double *link)
{
    Timed *timed = timed_of(self);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    return tally(timed, LINK, before, timed->code->link(self, time, slow, link));
}

static int timed_rhs(void *self, double time, const double *state, double *rate)
{
    Timed *timed = timed_of(self);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    return tally(timed, RHS, before, timed->code->rhs(self, time, state, rate));
}

static int timed_fast(void *self, double time, const double *link, const double *fast, double *rate)
{
    Timed *timed = timed_of(self);
    const double before = clock_seconds(CLOCK_MONOTONIC);
    return tally(timed, FAST, before, timed->code->fast(self, time, link, fast, rate));
}

static void timed_inputs(void *user, int32_t lane, double time, double *input)
{
    const Timed *timed = user;
    scene_inputs((void *)(uintptr_t)timed->scene, lane, time, input);
}

/* The code with its calls timed, for instances whose `user` is a Timed. */
static gic_model timed_code(const gic_model *code)
{
    gic_model out = *code;
    out.settle = timed_settle;
    out.link = code->link ? timed_link : NULL;
    out.rhs = timed_rhs;
    out.fast = code->fast ? timed_fast : NULL;
    out.march = NULL; /* steps are then made of the calls above */
    out.fast_step = NULL;
    return out;
}

/* Seconds of one evaluation of the fast rates at the instance's state, and of the same without the powertrain (0: the
 * model has none, or it can't be compared), by turns, on other instances. */
static void time_fast(const Driven *driven, gic_head *self, gic_head *copy, gic_head *other, double seconds[2])
{
    const gic_model *code = driven->engine->code, *plain = driven->plain ? driven->plain->code : NULL;
    double state[code->slow_count + code->fast_count], rate[code->slow_count + code->fast_count];
    double link[code->link_count + 1], *fast = state + code->slow_count;
    const double time = gic_time(self);
    memcpy(copy, self, code->size);
    memcpy(state, instance_array(self, code->state_offset), sizeof state);
    code->rhs(copy, time, state, rate);
    code->link(copy, time, state, link);
    double before = clock_seconds(CLOCK_MONOTONIC);
    code->fast(copy, time, link, fast, rate);
    seconds[0] = clock_seconds(CLOCK_MONOTONIC) - before;
    if (!plain)
        return;
    other->road = copy->road;
    memcpy(instance_array(other, plain->input_offset), instance_array(copy, code->input_offset),
           sizeof(double) * (size_t)code->input_count);
    before = clock_seconds(CLOCK_MONOTONIC);
    plain->fast(other, time, link, fast, rate);
    seconds[1] = clock_seconds(CLOCK_MONOTONIC) - before;
}

/* Measurements of each step of a run, s: calls, the remainder, and time_fast(). */
enum { REMAINDER = CALLS, ONE_FAST, ONE_PLAIN, MEASURED };

/* Shares of a step, which add up to 1, from medians over the steps of a run. */
static void shares_of(const double median[MEASURED], bool plain, double share[PARTS])
{
    const double in_rhs = fmin(median[ONE_FAST], median[RHS]); /* a right-hand side evaluates the fast rates too */
    const double fast = median[FAST] + in_rhs;
    const double beyond = plain && median[ONE_FAST] > 0 ? fmax(0, 1 - median[ONE_PLAIN] / median[ONE_FAST]) : 0;
    share[MULTIBODY] = median[SETTLE] + median[LINK] + median[RHS] - in_rhs;
    share[POWERTRAIN] = fast * beyond;
    share[TIRES] = fast - share[POWERTRAIN];
    share[REST] = median[REMAINDER];
    double sum = 0;
    for (int k = 0; k < STEP; ++k)
        sum += share[k];
    for (int k = 0; k < STEP; ++k)
        share[k] /= sum;
}

/* Shares of a step of the run. Each call is timed where it happens, so that the remainder belongs to the same steps.
 * The time of looking at the clock is taken off: one look within a call's time, two outside of it. */
static void time_parts(const Driven *driven, gic_head *self, const Scene *scene, double share[PARTS])
{
    Pool *pool = pool_new();
    const Engine *engine = driven->engine;
    const gic_model code = timed_code(engine->code);
    const int steps = (int)steps_of(scene) - START;
    const double look = bench_look(pool);
    gic_head *copy = instance_new(pool, engine), *other = driven->plain ? instance_new(pool, driven->plain) : NULL;
    double *second[MEASURED], median[MEASURED] = {0}, one[2] = {0};
    for (int k = 0; k < MEASURED; ++k)
        second[k] = pool_alloc(pool, sizeof *second[k] * (size_t)(steps + 1));
    if (other)
        driven->plain->code->setup_with(other, scene->parameter);
    int status = scene_start(engine, scene, self);
    Timed timed = {.code = engine->code, .scene = scene};
    for (int i = -START; i < steps && status == GIC_OK; ++i) {
        timed = (Timed){.code = engine->code, .scene = scene};
        self->input_function = timed_inputs;
        self->user = &timed;
        const double before = clock_seconds(CLOCK_MONOTONIC);
        status = scene_step(engine, &code, scene, NULL, self, 0);
        double rest = clock_seconds(CLOCK_MONOTONIC) - before - look;
        self->input_function = scene_inputs;
        self->user = (void *)(uintptr_t)scene;
        if (engine->code->fast)
            time_fast(driven, self, copy, other, one);
        for (int k = 0; k < CALLS && i >= 0; ++k) {
            rest -= timed.second[k] + timed.calls[k] * look;
            second[k][i] = fmax(0, timed.second[k] - timed.calls[k] * look);
        }
        if (i >= 0) {
            second[REMAINDER][i] = fmax(0, rest);
            second[ONE_FAST][i] = fmax(0, one[0] - look);
            second[ONE_PLAIN][i] = fmax(0, one[1] - look);
        }
    }
    for (int k = 0; k < MEASURED; ++k)
        median[k] = spread_of(pool, second[k], steps).median;
    if (!engine->code->fast)
        median[ONE_FAST] = 0;
    shares_of(median, driven->plain, share);
    pool_free(pool);
}

static Driven driven_by(const Bench *bench, const char *name, const Engine *engine, const EngineOptions *options)
{
    Pool *pool = bench->pool;
    Driven driven = {.name = name, .engine = engine, .self = instance_new(pool, engine)};
    for (int k = 0; k < PARTS; ++k)
        driven.measured[k] = pool_alloc(pool, sizeof(double) * (size_t)bench->repetitions);
    driven.state = pool_alloc(pool, sizeof(double) * (size_t)(engine->standard_count + 1));
    if (!bench->model->powertrain)
        return driven;
    driven.plain = engine_open(pool, engine->name, without_powertrain(pool, bench->model), options);
    if (driven.plain->code->link_count != engine->code->link_count) {
        engine_close(driven.plain);
        driven.plain = NULL;
    }
    return driven;
}

/* The engine cc in other ways. */
static Driven driven_way(const Bench *bench, const Way *w)
{
    EngineOptions options = bench->options;
    options.flags = pool_print(bench->pool, "%s %s", w->flags, options.flags);
    options.compiler = w->compiler ? w->compiler : options.compiler;
    options.lanes = w->lanes;
    options.quiet = true;
    return driven_by(bench, w->name, engine_open(bench->pool, "cc", bench->model, &options), &options);
}

/* Largest difference of two numbers of the states in which runs end, relative to 1 + |x|. */
static double difference(const Driven *a, const Driven *b)
{
    double largest = 0;
    for (int i = 0; i < a->engine->standard_count; ++i)
        largest = fmax(largest, fabs(a->state[i] - b->state[i]) / (1 + fabs(a->state[i])));
    return largest;
}

/* The first engine's run in a sentence, and how much longer the other engines take. */
static void drive_headline(const Bench *bench, const Driven *driven)
{
    Pool *pool = bench->pool;
    const double time = (double)steps_of(bench->scene) * bench->scene->step;
    const double seconds = spread_of(pool, driven->measured[STEP], bench->repetitions).median;
    Text others = {.pool = pool};
    for (const Driven *d = driven + 1; d < driven + bench->engines; ++d)
        text_print(&others, d > driven + 1 ? ", %s %.3g times" : "; %s takes %.3g times as long", d->name,
                   spread_of_ratio(pool, d->measured[STEP], driven->measured[STEP], bench->repetitions).median);
    text_print(&others, ".");
    report_headline(bench->report, "%s computes %.4g s of the scene in %.3g s, %.3g times faster than real time%s",
                    driven->name, time, seconds, time / seconds, others.s);
}

static void drive_row(const Bench *bench, Sheet *table, const Driven *driven, const Driven *first)
{
    Pool *pool = bench->pool;
    const double steps = (double)steps_of(bench->scene);
    const Spread all = spread_of(pool, driven->measured[STEP], bench->repetitions);
    double part[STEP], sum = 0;
    for (int k = 0; k < STEP; ++k)
        sum += part[k] = spread_of(pool, driven->measured[k], bench->repetitions).median;
    for (int k = 0; k < STEP; ++k)
        part[k] *= all.median / steps / sum; /* medians of shares add up to 1 only up to their scatter */
    table_cell(pool, table, "%s", driven->name);
    spread_cells(pool, table, all, 1);
    table_cell(pool, table, "%.4g", steps * bench->scene->step / all.median);
    table_cell(pool, table, "%.3g", 1e6 * all.median / steps);
    table_cell(pool, table, "%.3g", 1e6 * part[MULTIBODY]);
    table_cell(pool, table, "%.3g", 1e6 * part[TIRES]);
    table_cell(pool, table, driven->plain || !bench->model->powertrain ? "%.2g" : "with tires", 1e6 * part[POWERTRAIN]);
    table_cell(pool, table, "%.2g", 1e6 * part[REST]);
    table_cell(pool, table, "%.0f", 100 * steps * (part[TIRES] + part[POWERTRAIN]) / all.median);
    spread_cells(pool, table, spread_of_ratio(pool, first->measured[STEP], driven->measured[STEP], bench->repetitions),
                 1);
    table_cell(pool, table, "%.1g", difference(first, driven));
}

void bench_drive(const Bench *bench)
{
    Pool *pool = bench->pool;
    const Scene *scene = bench->scene;
    const Place at = {scene->source, 0, 0};
    if (!scene->per_output || steps_of(scene) <= START)
        diag_fail(at, "write `integrator: ab3` and a step",
                  "a scene is timed with constant steps, and more than %d of them", START);
    Driven *driven = pool_alloc(pool, sizeof *driven * (size_t)(bench->engines + WAYS));
    int subjects = 0;
    bool compiled = false;
    for (int e = 0; e < bench->engines; ++e) {
        const Engine *engine = bench->engine[e];
        driven[subjects++] = driven_by(bench, engine->name, engine, &bench->options);
        compiled = compiled || !strcmp(engine->name, "cc");
    }
    for (int w = 0; compiled && w < WAYS; ++w)
        if (!way[w].compiler || bench_installed(pool, way[w].compiler))
            driven[subjects++] = driven_way(bench, &way[w]);
    double seconds = 0;
    /* a run for its CPU time, and one for its parts, in which all is computed about twice */
    for (const Driven *d = driven; d < driven + subjects; ++d)
        seconds += 3 * (double)steps_of(scene) * bench_step_seconds(d->engine, d->self, scene, NULL);
    bench_expect(bench, bench->repetitions * seconds);
    for (int r = 0; r < bench->repetitions; ++r)
        for (Driven *d = driven; d < driven + subjects; ++d) {
            int status;
            bench_progress(bench, "repetition %d of %d, %s", r + 1, bench->repetitions, d->name);
            d->measured[STEP][r] = run(d->engine, d->self, scene, &status);
            if (status == GIC_OK)
                status = engine_look(d->engine, d->self, d->state, NULL);
            if (status != GIC_OK)
                diag_fail(at, "a benchmark needs a scene that runs to its end",
                          "with %s the run ends at t = %.6g s: %s", d->name, gic_time(d->self),
                          instance_status(pool, d->engine->code, d->self, status));
            double share[PARTS];
            time_parts(d, d->self, scene, share);
            for (int k = 0; k < STEP; ++k)
                d->measured[k][r] = share[k];
        }
    report_heading(bench->report, "The scene as it stands");
    drive_headline(bench, driven);
    report_text(bench->report,
                "%.6g s with %s at steps of %g ms, %d fast ones in each: CPU time without outputs, median of %d runs "
                "and extremes, engines alternating. The paper's third experiment, 30 s of the complete vehicle, took "
                "26.23 s at 200 MHz.",
                (double)steps_of(scene) * scene->step, integrator_name(scene->method), 1e3 * scene->step, scene->ratio,
                bench->repetitions);
    report_text(
        bench->report,
        "Parts of a step add up to it. In a second run after each timed one, the calls of every step are timed where "
        "they happen, the clock's own time taken off; parts are medians over the steps, scaled to the step of the "
        "timed run. Multibody is the recovery of dependent coordinates, a right-hand side without the rates of the "
        "fast states, and the motion of wheels at the step's end; tires and powertrain are those rates, once for each "
        "fast step, the powertrain being the share of them that the same model without it does not take. The rest of "
        "the step is the integrator's, the inputs' and the driver's. Ratio: of the first row's CPU time to this one's, "
        "repetition by "
        "repetition; difference: of a number x of the state at the end from the first row's, relative to 1 + |x|. "
        "Fast: "
        "flags " FASTEST "; lanes: all wheels with the same tire in one vector (--lanes 4).");
    Sheet *table =
        report_table(bench->report, "drive", "Where the time of a step goes [us]",
                     "engine|CPU time [s]|lowest|highest|times real time|step [us]|multibody [us]|tires [us]|"
                     "powertrain [us]|rest [us]|tires and powertrain [%]|ratio|lowest|highest|difference");
    for (Driven *d = driven; d < driven + subjects; ++d) {
        drive_row(bench, table, d, driven);
        if (d->plain)
            engine_close(d->plain);
    }
}
