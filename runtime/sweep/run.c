/* SPDX-License-Identifier: MIT
 * The runs of a sweep: side by side in lanes or one by one, in one process or several. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/limits.h"
#include "model/model.h"
#include "run/last_good.h"
#include "run/run.h"
#include "run/stability_watch.h"
#include "run/variable_step.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "sweep/run_private.h"
#include "sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double refresh = 0.1; /* s between lines of progress */

/* ---- one run ------------------------------------------------------------------------------------------------ */

static void set_input(Pool *pool, const Model *model, Scene *scene, int input, double value)
{
    Profile *profile = pool_alloc(pool, sizeof *profile * (size_t)(scene->profiles + 1));
    int kept = 0;
    bool driven = false;
    for (int i = 0; i < model->coordinates; ++i)
        driven |= model->coordinate[i].driven && model->coordinate[i].input == input;
    for (int i = 0; i < scene->profiles; ++i)
        if (scene->profile[i].input != input)
            profile[kept++] = scene->profile[i];
    Profile constant = {.input = input, .driven = driven, .count = 1};
    constant.time = pool_alloc(pool, sizeof(double));
    constant.value = pool_alloc(pool, sizeof(double));
    *constant.value = value;
    profile[kept++] = constant;
    scene->profile = profile;
    scene->profiles = kept;
}

/* The scene of a run. */
static Scene vary_scene(Pool *pool, const Sweep *sweep, int64_t run)
{
    Scene own = rest_varies(sweep) ? *sweep->drawn : *sweep->scene;
    own.rest = NULL; /* vehicles in lanes do not sleep */
    if (own.driver) {
        own.driver = pool_alloc(pool, sizeof *own.driver);
        *own.driver = *sweep->scene->driver;
    }
    const size_t parameters = sizeof(double) * (size_t)sweep->model->tunables;
    own.parameter = pool_alloc(pool, parameters + 1);
    memcpy(own.parameter, sweep->scene->parameter, parameters);
    for (int v = 0; v < sweep->plan->varied; ++v) {
        const Vary *vary = &sweep->plan->vary[v];
        const double value = plan_value(sweep->plan, v, run);
        if (vary->kind == VARY_PARAMETER) {
            own.parameter[vary->index] = value;
        } else if (vary->kind == VARY_INPUT) {
            set_input(pool, sweep->model, &own, vary->index, value);
        } else if (vary->kind == VARY_SPEED) {
            own.speed = value;
            own.along = true;
            scene_along(&own);
        }
    }
    return own;
}

/* Bring the instance to the beginning of a run. */
static int begin(const Sweep *sweep, const Slot *slot, gic_head *self)
{
    int status = scene_start(sweep->engine, &slot->scene, self);
    double state[sweep->engine->standard_count + 1];
    bool changed = false;
    if (status == GIC_OK)
        status = engine_look(sweep->engine, self, state, NULL);
    for (int v = 0; v < sweep->plan->varied; ++v)
        if (sweep->plan->vary[v].kind == VARY_STATE) {
            state[sweep->plan->vary[v].index] = plan_value(sweep->plan, v, slot->run);
            changed = true;
        }
    return status == GIC_OK && changed ? engine_enter(sweep->engine, self, state) : status;
}

static void record(Slot *slot, int column, double value)
{
    Range *range = &slot->range[column];
    const bool first = isnan(range->end);
    range->end = value;
    range->least = first ? value : fmin(range->least, value);
    range->greatest = first ? value : fmax(range->greatest, value);
}

/* All of a slot at an output time. value: of a signal of a vehicle. */
static void record_all(const Sweep *sweep, Slot *slot, double time, double (*value)(const void *of, int signal),
                       const void *of)
{
    slot->time = time;
    for (int c = 0; c < sweep->scene->columns; ++c)
        record(slot, c, value(of, sweep->scene->column[c]));
    for (int m = 0; m < sweep->metrics; ++m) {
        const Metric *metric = &sweep->metric[m];
        metric_see(metric, &slot->metric[m], time, value(of, metric->signal),
                   metric->other >= 0 ? value(of, metric->other) : 1);
    }
}

void run_sample(const Sweep *sweep, Slot *slot, double time, double (*value)(const void *of, int signal),
                const void *of)
{
    record_all(sweep, slot, time, value, of);
    for (int c = 0; slot->series && c < sweep->form->series; ++c)
        slot->series[c * sweep->form->samples + slot->sample] = value(of, sweep->scene->column[c]);
    ++slot->sample;
}

static void add_number(Text *row, double value)
{
    char digits[CSV_DIGITS];
    text_print(row, "%s%s", row->size ? "," : "", csv_digits(value, digits));
}

/* Its row of the results as one text for the journal. */
static const char *row_text(Pool *pool, const Sweep *sweep, const Slot *slot)
{
    Text row = {.pool = pool};
    add_number(&row, (double)slot->run);
    for (int v = 0; v < sweep->plan->varied; ++v)
        add_number(&row, plan_value(sweep->plan, v, slot->run));
    add_number(&row, slot->status);
    text_print(&row, ",%.15g", slot->time);
    for (int c = 0; c < sweep->scene->columns; ++c) {
        add_number(&row, slot->range[c].end);
        add_number(&row, slot->range[c].least);
        add_number(&row, slot->range[c].greatest);
    }
    for (int m = 0; m < sweep->metrics; ++m)
        add_number(&row, metric_value(&sweep->metric[m], &slot->metric[m]));
    return pool_print(sweep->journal->pool, "%s", row.s);
}

/* ---- for the person who waits --------------------------------------------------------------------------------- */

void run_look_around(Runner *r)
{
    const Journal *journal = r->sweep->journal;
    const double now = clock_seconds(CLOCK_MONOTONIC);
    if (now - r->looked < refresh)
        return;
    r->looked = now;
    r->stopped = interrupt_arrived();
    if (r->silent || r->sweep->quiet)
        return;
    char text[200];
    snprintf(text, sizeof text, "%5.1f %%  %lld of %lld runs, %lld failed, %.4g runs/s",
             100 * (double)journal->finished / (double)journal->runs, (long long)journal->finished,
             (long long)journal->runs, (long long)journal->failed,
             (double)(journal->finished - r->before) / fmax(now - r->begun, 1e-9));
    diag_progress(text);
    r->shown = true;
}

/* ---- what goes wrong --------------------------------------------------------------------------------------- */

void run_set_status(const Runner *r, Slot *slot, int status, const gic_head *self)
{
    slot->status = status;
    if (status != GIC_OK)
        slot->reason = pool_print(slot->pool, "at t = %.6g s: %s", gic_time(self),
                                  instance_status(slot->pool, r->sweep->engine->code, self, status));
}

/* A run begins, unless its parameters are such as the model's file may not have. */
static void start(const Runner *r, Slot *slot)
{
    BrokenLimit broken;
    if (!limit_broken(r->sweep->model, slot->scene.parameter, &broken)) {
        if (rest_varies(r->sweep) && !rest_find(slot->pool, r->sweep, &slot->scene, &slot->reason)) {
            slot->status = GIC_ERROR_INPUT;
            return;
        }
        run_set_status(r, slot, begin(r->sweep, slot, r->one), r->one);
        return;
    }
    slot->status = GIC_ERROR_GEOMETRY;
    slot->reason = pool_print(slot->pool, "with these parameters the model is impossible: %s", broken.text);
}

/* Judge a watched run: one that is unstable within bounds, or in which a contact gives back more than it may, gets the
 * status of unstable runs. */
static void judge(const Runner *r, Slot *slot)
{
    const char *remedy;
    const bool good = slot->status == GIC_OK && !r->stopped;
    const char *finding = slot->watch && good ? step_watch_judge(slot->watch, &remedy) : NULL;
    if (!finding && slot->bounces && good)
        finding = bounce_watch_judge(slot->bounces, &remedy);
    if (!finding)
        return;
    slot->status = GIC_ERROR_UNSTABLE;
    slot->reason = pool_print(slot->pool, "%s\n  remedy: %s", finding, remedy);
}

/* ---- the end of a run that fails ------------------------------------------------------------------------------ */

static double value_alone(const void *of, int signal)
{
    const Runner *r = of;
    return scene_value(r->sweep->engine->code, r->copy, signal);
}

void run_end_failed(Runner *r, Slot *slot, const gic_head *failed)
{
    const double last = gic_time(failed);
    if (!last_good_outputs(r->good, r->sweep->engine->code, r->one, failed, r->copy))
        return;
    if (gic_time(r->copy) < last)
        run_set_status(r, slot, slot->status, r->copy);
    if (gic_time(r->copy) > slot->time)
        record_all(r->sweep, slot, gic_time(r->copy), value_alone, r);
}

/* The present outputs of the only slot. */
static void look_at_one(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    Slot *slot = r->slot;
    memcpy(r->copy, r->one, code->size); /* outputs are computed on a copy */
    run_set_status(r, slot, code->outputs(r->copy), r->copy);
    if (slot->status == GIC_OK)
        run_sample(sweep, slot, gic_time(r->one), value_alone, r);
    else
        run_end_failed(r, slot, r->copy);
}

/* The run of the only slot, which has begun. */
static void run_one(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    Slot *slot = r->slot;
    const Scene *scene = &slot->scene;
    Variable *variable = scene->method >= METHOD_ADAMS ? variable_open(code, scene->method, scene->tolerance) : NULL;
    last_good_forget(r->good);
    if (slot->status == GIC_OK)
        look_at_one(r);
    for (int64_t k = 0; k < scene->outputs && slot->status == GIC_OK && !r->stopped; ++k) {
        const double end = (double)(k + 1) * scene->output_step;
        int64_t left = scene->per_output;
        while (slot->status == GIC_OK && !r->stopped && (variable ? gic_time(r->one) < end : left > 0)) {
            last_good_keep(r->good, code, r->one);
            run_set_status(r, slot, scene_step(sweep->engine, code, scene, variable, r->one, end), r->one);
            if (slot->watch && slot->status == GIC_OK)
                step_watch_step(slot->watch, code, r->one, r->copy);
            if (slot->bounces && slot->status == GIC_OK)
                bounce_watch_step(slot->bounces, code, r->one);
            if (left-- % CHUNK == 0)
                run_look_around(r);
        }
        if (slot->status != GIC_OK)
            run_end_failed(r, slot, r->one);
        else if (!r->stopped)
            look_at_one(r);
    }
    variable_close(variable);
    run_look_around(r);
}

bool run_begin(Runner *r, Slot *slot, const Supply *supply)
{
    const Sweep *sweep = r->sweep;
    const int64_t run = r->stopped ? -1 : supply->next(supply->context);
    if (run < 0)
        return false;
    slot->pool = pool_new();
    slot->run = run;
    slot->scene = vary_scene(slot->pool, sweep, run);
    slot->watch = step_watch_new(slot->pool, r->theory, &slot->scene, sweep->engine, true);
    slot->bounces = bounce_watch_new(slot->pool, r->theory, &slot->scene, sweep->engine);
    slot->time = 0;
    slot->reason = NULL;
    for (int c = 0; c < sweep->scene->columns; ++c)
        slot->range[c] = (Range){NAN, NAN, NAN};
    for (int m = 0; m < sweep->metrics; ++m)
        slot->metric[m] = (MetricState){0};
    slot->sample = 0;
    for (int64_t i = 0; slot->series && i < sweep->form->series * sweep->form->samples; ++i)
        slot->series[i] = NAN;
    start(r, slot);
    if (slot->bounces && slot->status == GIC_OK)
        bounce_watch_step(slot->bounces, sweep->engine->code, r->one);
    return true;
}

/* The result of a slot's run; its texts live as long as the journal. Its series are written. */
static RunResult result_of(const Runner *r, const Slot *slot)
{
    Pool *pool = r->sweep->journal->pool;
    if (r->sweep->journal->series)
        series_put(r->sweep->journal->series, slot->run, slot->series);
    return (RunResult){slot->run, slot->status, row_text(slot->pool, r->sweep, slot),
                       slot->reason ? pool_print(pool, "%s", slot->reason) : NULL};
}

void run_end(const Runner *r, Slot *slot, const Supply *supply)
{
    judge(r, slot);
    if (!r->stopped) {
        const RunResult result = result_of(r, slot);
        supply->done(supply->context, &result);
    }
    slot->run = -1;
    pool_free(slot->pool);
}

/* Runs until the supply ends. False: someone asked to stop. */
static bool make_runs(void *context, const Supply *supply)
{
    Runner *r = context;
    if (r->sweep->many)
        lanes_run(r, supply);
    else
        while (run_begin(r, r->slot, supply)) {
            run_one(r);
            run_end(r, r->slot, supply);
        }
    return !r->stopped;
}

/* The same without progress. */
static bool make_silently(void *context, const Supply *supply)
{
    Runner *r = context;
    r->silent = true;
    return make_runs(r, supply);
}

static bool take_results(void *context, const RunResult *result, int results)
{
    Runner *r = context;
    if (results)
        journal_add(r->sweep->journal, result, results);
    run_look_around(r);
    return !r->stopped;
}

/* ---- in this process --------------------------------------------------------------------------------------------- */

/* Runs in their order; their results go into a journal, or are counted alone. */
typedef struct List {
    const int64_t *run;
    int64_t count, taken, made;
    Journal *journal; /* NULL: none */
} List;

static int64_t next_of(void *context)
{
    List *list = context;
    return list->taken < list->count ? list->run[list->taken++] : -1;
}

static void note_done(void *context, const RunResult *result)
{
    List *list = context;
    ++list->made;
    if (list->journal)
        journal_add(list->journal, result, 1);
}

static void *batch_new(const gic_batch_model *many)
{
    void *batch = many ? aligned_alloc(many->alignment, many->size) : NULL;
    if (many && !batch)
        diag_fail(program_place(), NULL, "no memory for %d vehicles", many->vehicles);
    if (batch)
        caught_own(free, batch);
    return batch;
}

static void batch_free(void *batch)
{
    if (batch)
        caught_disown(batch);
    free(batch);
}

static Runner runner_open(const Sweep *sweep)
{
    Pool *pool = sweep->pool;
    Runner r = {.sweep = sweep, .slots = sweep->many ? sweep->many->vehicles : 1, .before = sweep->journal->finished};
    r.slot = pool_alloc(pool, sizeof *r.slot * (size_t)r.slots);
    for (int i = 0; i < r.slots; ++i) {
        r.slot[i].run = -1;
        r.slot[i].range = pool_alloc(pool, sizeof(Range) * (size_t)(sweep->scene->columns + 1));
        r.slot[i].metric = pool_alloc(pool, sizeof(MetricState) * (size_t)(sweep->metrics + 1));
        const size_t numbers = (size_t)sweep->form->series * (size_t)sweep->form->samples;
        r.slot[i].series = numbers ? pool_alloc(pool, sizeof(double) * numbers) : NULL;
        r.slot[i].before = sweep->many ? instance_new(pool, sweep->engine) : NULL;
        r.slot[i].driver = sweep->scene->driver ? pool_alloc(pool, sizeof(Driver)) : NULL;
    }
    r.one = instance_new(pool, sweep->engine);
    r.copy = instance_new(pool, sweep->engine);
    r.good = last_good_new(pool, sweep->engine);
    r.theory = step_theory_new(pool, sweep->model);
    r.batch = batch_new(sweep->many);
    r.spare = batch_new(sweep->many);
    r.begun = clock_seconds(CLOCK_MONOTONIC);
    return r;
}

static void runner_close(const Runner *r)
{
    if (r->shown)
        diag_progress("");
    batch_free(r->batch);
    batch_free(r->spare);
}

double sweep_seconds(const Sweep *sweep)
{
    enum { BATCHES = 16, LONG_ENOUGH = 2 /* s */ };
    Journal nothing = {.pool = sweep->pool, .runs = sweep->plan->runs};
    Sweep trial = *sweep;
    trial.journal = &nothing;
    trial.quiet = true;
    Runner r = runner_open(&trial);
    const int64_t count = sweep->plan->runs < r.slots ? sweep->plan->runs : r.slots;
    int64_t run[count], made = 0;
    double spent = 0;
    for (int b = 0; b < BATCHES && spent < LONG_ENOUGH && !r.stopped; ++b) {
        for (int64_t i = 0; i < count; ++i) /* spread over all of them */
            run[i] = part_first(sweep->plan->runs, (int)(i * BATCHES + b + 1), (int)(count * BATCHES));
        List list = {.run = run, .count = count};
        make_runs(&r, &(Supply){next_of, note_done, &list});
        made += list.made;
        spent = clock_seconds(CLOCK_MONOTONIC) - r.begun;
    }
    runner_close(&r);
    return made && !r.stopped ? spent / (double)made : -1;
}

bool sweep_run(const Sweep *sweep)
{
    Pool *pool = sweep->pool;
    const SweepPlan *plan = sweep->plan;
    Runner r = runner_open(sweep);
    int64_t *run = pool_alloc(pool, sizeof *run * (size_t)(plan->count + 1)), count = 0;
    for (int64_t i = 0; i < plan->count; ++i)
        if (!sweep->journal->row[i])
            run[count++] = plan->first + i;
    /* equal parts if there are few runs for many processes */
    const int64_t part = (count + sweep->processes - 1) / sweep->processes;
    r.slots = part < r.slots ? (int)part : r.slots;
    const int64_t batches = r.slots ? (count + r.slots - 1) / r.slots : 0;
    const size_t processes = (size_t)(batches < sweep->processes ? batches : sweep->processes);
    const Share share = {count, run, sweep->journal->file, make_silently, take_results, &r};
    List list = {.run = run, .count = count, .journal = sweep->journal};
    if (processes > 1)
        r.stopped = !share_runs(pool, &share, processes) || sweep->journal->finished < plan->count;
    else if (count)
        make_runs(&r, &(Supply){next_of, note_done, &list});
    runner_close(&r);
    return !r.stopped;
}
