/* SPDX-License-Identifier: MIT
 * A scene as it stands, with its step and ratio: the third experiment of Serban and Haug 2000, section 5, the complete
 * vehicle for 30 s. CPU time, and what of a step goes into multibody system, tires and powertrain; beside the engine cc
 * as it stands its code at fast flags, one by one and with wheels in lanes. */
#include "bench.h"

#include <math.h>
#include <string.h>

/* AB3 begins with steps of RK4, which are no part of steady operation. */
enum { START = 2 };

/* What of a step is told apart, and all of it. */
enum { MULTIBODY, TIRES, POWERTRAIN, STEP, PARTS };

/* An engine, the same for the model without its powertrain (NULL: it has none, or its rates can't be compared), and
 * seconds by part: [repetitions] each; of STEP CPU time, of the others elapsed time. */
typedef struct Driven {
    const char *name;
    const Engine *engine, *plain;
    gic_head *self;
    double *second[PARTS];
    double *state; /* in which a run ends: FORMAT.md section 10 */
} Driven;

/* More ways to make the engine cc. */
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

/* Calls that are timed, in the order of a step's end and the next one's beginning; the first that comes to a new state
 * recovers dependent coordinates, the others find them known. PLAIN: fast rates without the powertrain. */
enum { SETTLE, LINK, RHS, FAST, PLAIN, CALLS };

/* Instances beside that of a run. */
typedef struct Aside {
    gic_head *before, *other; /* as it was before the step; of the model without its powertrain */
    double look;              /* s that a look at the clock takes */
} Aside;

static double since(const Aside *aside, double before)
{
    return clock_seconds(CLOCK_MONOTONIC) - before - aside->look;
}

/* Elapsed seconds of the calls at an instance's state. dual: are there links at the end of a step? */
static void time_calls(const Driven *driven, gic_head *self, const Aside *aside, bool dual, double second[CALLS])
{
    const gic_model *code = driven->engine->code;
    gic_head *copy = aside->before;
    double state[code->slow_count + code->fast_count], rate[code->slow_count + code->fast_count];
    double link[code->link_count + 1], *fast = state + code->slow_count;
    const double time = gic_time(self);
    memcpy(state, instance_array(self, code->state_offset), sizeof state);
    memcpy(instance_array(copy, code->input_offset), instance_array(self, code->input_offset),
           sizeof(double) * (size_t)code->input_count);
    double before = clock_seconds(CLOCK_MONOTONIC);
    code->settle(copy, state);
    second[SETTLE] = since(aside, before);
    before = clock_seconds(CLOCK_MONOTONIC);
    if (dual)
        code->link(copy, time, state, link);
    second[LINK] = dual ? since(aside, before) : 0;
    before = clock_seconds(CLOCK_MONOTONIC);
    code->rhs(copy, time, state, rate);
    second[RHS] = since(aside, before);
    if (!code->fast)
        return;
    if (!dual)
        code->link(copy, time, state, link);
    before = clock_seconds(CLOCK_MONOTONIC);
    code->fast(copy, time, link, fast, rate);
    second[FAST] = since(aside, before);
    if (!driven->plain)
        return;
    const gic_model *plain = driven->plain->code;
    aside->other->road = copy->road;
    memcpy(instance_array(aside->other, plain->input_offset), instance_array(copy, code->input_offset),
           sizeof(double) * (size_t)code->input_count);
    before = clock_seconds(CLOCK_MONOTONIC);
    plain->fast(aside->other, time, link, fast, rate);
    second[PLAIN] = since(aside, before);
}

/* Medians over the steps of a run, s. */
static void time_parts(const Driven *driven, gic_head *self, const Scene *scene, double part[STEP])
{
    Pool *pool = pool_new();
    const Engine *engine = driven->engine;
    const int steps = (int)steps_of(scene) - START;
    const double ratio = engine->code->fast ? scene->ratio : 0;
    Aside aside = {.before = instance_new(pool, engine), .look = bench_look(pool)};
    double *second[CALLS], call[CALLS] = {0}, median[CALLS];
    for (int k = 0; k < CALLS; ++k)
        second[k] = pool_alloc(pool, sizeof *second[k] * (size_t)(steps + 1));
    if (driven->plain) {
        aside.other = instance_new(pool, driven->plain);
        driven->plain->code->setup_with(aside.other, scene->parameter);
    }
    int status = scene_start(engine, scene, self);
    for (int i = -START; i < steps && status == GIC_OK; ++i) {
        memcpy(aside.before, self, engine->code->size);
        status = scene_step(engine, engine->code, scene, NULL, self, 0);
        time_calls(driven, self, &aside, ratio > 1, call);
        for (int k = 0; k < CALLS && i >= 0; ++k)
            second[k][i] = call[k];
    }
    for (int k = 0; k < CALLS; ++k)
        median[k] = spread_of(pool, second[k], steps).median;
    part[MULTIBODY] = median[SETTLE] + median[LINK] + median[RHS] - median[FAST];
    part[TIRES] = ratio * (driven->plain ? median[PLAIN] : median[FAST]);
    part[POWERTRAIN] = driven->plain ? ratio * (median[FAST] - median[PLAIN]) : 0;
    pool_free(pool);
}

static Driven driven_by(const Bench *bench, const char *name, const Engine *engine, const EngineOptions *options)
{
    Pool *pool = bench->pool;
    Driven driven = {.name = name, .engine = engine, .self = instance_new(pool, engine)};
    for (int k = 0; k < PARTS; ++k)
        driven.second[k] = pool_alloc(pool, sizeof(double) * (size_t)bench->repetitions);
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
    const double seconds = spread_of(pool, driven->second[STEP], bench->repetitions).median;
    Text others = {.pool = pool};
    for (const Driven *d = driven + 1; d < driven + bench->engines; ++d)
        text_print(&others, d > driven + 1 ? ", %s %.3g times" : "; %s takes %.3g times as long", d->name,
                   spread_of_ratio(pool, d->second[STEP], driven->second[STEP], bench->repetitions).median);
    text_print(&others, ".");
    report_headline(bench->report, "%s computes %.4g s of the scene in %.3g s, %.3g times faster than real time%s",
                    driven->name, time, seconds, time / seconds, others.s);
}

static void drive_row(const Bench *bench, Sheet *table, const Driven *driven, const Driven *first)
{
    Pool *pool = bench->pool;
    const double steps = (double)steps_of(bench->scene);
    const Spread all = spread_of(pool, driven->second[STEP], bench->repetitions);
    double part[STEP], rest = all.median / steps;
    for (int k = 0; k < STEP; ++k) {
        part[k] = spread_of(pool, driven->second[k], bench->repetitions).median;
        rest -= part[k];
    }
    table_cell(pool, table, "%s", driven->name);
    spread_cells(pool, table, all, 1);
    table_cell(pool, table, "%.4g", steps * bench->scene->step / all.median);
    table_cell(pool, table, "%.3g", 1e6 * all.median / steps);
    table_cell(pool, table, "%.3g", 1e6 * part[MULTIBODY]);
    table_cell(pool, table, "%.3g", 1e6 * part[TIRES]);
    table_cell(pool, table, driven->plain || !bench->model->powertrain ? "%.2g" : "with tires", 1e6 * part[POWERTRAIN]);
    table_cell(pool, table, "%.2g", 1e6 * rest);
    table_cell(pool, table, "%.0f", 100 * steps * (part[TIRES] + part[POWERTRAIN]) / all.median);
    spread_cells(pool, table, spread_of_ratio(pool, first->second[STEP], driven->second[STEP], bench->repetitions), 1);
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
    for (int r = 0; r < bench->repetitions; ++r)
        for (Driven *d = driven; d < driven + subjects; ++d) {
            int status;
            bench_progress("repetition %d of %d, %s", r + 1, bench->repetitions, d->name);
            d->second[STEP][r] = run(d->engine, d->self, scene, &status);
            if (status == GIC_OK)
                status = engine_look(d->engine, d->self, d->state, NULL);
            if (status != GIC_OK)
                diag_fail(at, "a benchmark needs a scene that runs to its end",
                          "with %s the run ends at t = %.6g s: %s", d->name, gic_time(d->self),
                          instance_status(pool, d->engine->code, d->self, status));
            double part[STEP];
            time_parts(d, d->self, scene, part);
            for (int k = 0; k < STEP; ++k)
                d->second[k][r] = part[k];
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
        "Parts of a step are medians of single calls at the states of the run, timed from outside: multibody "
        "is the recovery of dependent coordinates, a right-hand side without the rates of the fast states, and "
        "the motion of wheels at the step's end; tires and powertrain are those rates, once for each fast step, "
        "the powertrain being what they take beyond those of the same model without it. The rest of the step "
        "is the integrator's, the inputs' and the driver's. Ratio: of the first row's CPU time to this one's, "
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
