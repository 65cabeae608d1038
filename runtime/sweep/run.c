/* SPDX-License-Identifier: MIT
 * The runs of a sweep: in batches, side by side in lanes, or one by one, in one process or several. */
#include "base/catch.h"
#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_batch.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/limits.h"
#include "model/model.h"
#include "run/knot.h"
#include "run/last_good.h"
#include "run/run.h"
#include "run/stability_watch.h"
#include "run/variable_step.h"
#include "scene/profile.h"
#include "scene/scene.h"
#include "sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 4096 /* steps between checks for a request to stop */ };

static const double refresh = 0.1; /* s between lines of progress */

/* End, least and greatest value of an output so far. */
typedef struct Range {
    double end, least, greatest;
} Range;

/* One run of a batch. */
typedef struct Slot {
    int64_t run;
    Scene scene; /* its own; `user` of the instance */
    int status;
    const char *reason;  /* why it failed */
    double time;         /* of its last values */
    gic_head *before;    /* in lanes: its vehicle at the last output time, */
    bool begun;          /* if there was one */
    Range *range;        /* [columns] */
    MetricState *metric; /* [metrics] */
    int64_t sample;      /* output times so far, */
    double *series;      /* and values at them, [series][samples]; NULL: not asked for */
    StepWatch *watch;    /* NULL: not watched */
} Slot;

typedef struct Runner {
    const Sweep *sweep;
    Pool *pool; /* of this batch */
    int slots, used;
    Slot *slot;
    gic_head *one, *copy;
    LastGood *good; /* of a run by itself */
    StepTheory *theory;
    void *batch;
    double begun, looked;
    int64_t before; /* runs finished by others */
    bool shown, stopped;
    bool silent; /* another process prints progress */
} Runner;

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
    Scene own = *sweep->scene;
    own.rest = NULL; /* vehicles in lanes do not sleep */
    own.steady = 0;
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

/* The same at an output time of its own, for series. */
static void record_sample(const Sweep *sweep, Slot *slot, double time, double (*value)(const void *of, int signal),
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

static void look_around(Runner *r)
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

/* The status of a slot, and if it is not GIC_OK what its instance knows of it. */
static void set_status(const Runner *r, Slot *slot, int status, const gic_head *self)
{
    slot->status = status;
    if (status != GIC_OK)
        slot->reason = pool_print(r->pool, "at t = %.6g s: %s", gic_time(self),
                                  instance_status(r->pool, r->sweep->engine->code, self, status));
}

/* A run begins, unless its parameters are such as the model's file may not have. */
static void start(const Runner *r, Slot *slot)
{
    BrokenLimit broken;
    if (!limit_broken(r->sweep->model, slot->scene.parameter, &broken)) {
        set_status(r, slot, begin(r->sweep, slot, r->one), r->one);
        return;
    }
    slot->status = GIC_ERROR_GEOMETRY;
    slot->reason = pool_print(r->pool, "with these parameters the model is impossible: %s", broken.text);
}

/* Judge a watched run: one that is unstable within bounds gets the status of unstable runs. */
static void judge(const Runner *r, Slot *slot)
{
    const char *remedy;
    const char *finding =
        slot->watch && slot->status == GIC_OK && !r->stopped ? step_watch_judge(slot->watch, &remedy) : NULL;
    if (!finding)
        return;
    slot->status = GIC_ERROR_UNSTABLE;
    slot->reason = pool_print(r->pool, "%s\n  remedy: %s", finding, remedy);
}

/* ---- the end of a run that fails ------------------------------------------------------------------------------ */

static double value_alone(const void *of, int signal)
{
    const Runner *r = of;
    return scene_value(r->sweep->engine->code, r->copy, signal);
}

/* The vehicle r->one can't go on: its last good state counts like an output time, if it is not at one. failed: an
 * instance that knows why. */
static void end_failed(Runner *r, Slot *slot, const gic_head *failed)
{
    const double last = gic_time(failed);
    if (!last_good_outputs(r->good, r->sweep->engine->code, r->one, failed, r->copy))
        return;
    if (gic_time(r->copy) < last)
        set_status(r, slot, slot->status, r->copy);
    if (gic_time(r->copy) > slot->time)
        record_all(r->sweep, slot, gic_time(r->copy), value_alone, r);
}

/* ---- batches -------------------------------------------------------------------------------------------------- */

/* A vehicle in lanes. */
typedef struct InLanes {
    const Runner *r;
    int place;
} InLanes;

/* Of a vehicle in lanes: instances don't take outputs with them, but inputs. */
static double value_in_lanes(const void *of, int signal)
{
    const InLanes *in = of;
    const Sweep *sweep = in->r->sweep;
    const bool input = signal >= sweep->engine->code->output_count;
    return input ? scene_value(sweep->engine->code, in->r->one, signal)
                 : sweep->many->output(in->r->batch, in->place, signal);
}

/* A vehicle in lanes, now in r->one, failed after its last output time: it goes from there once more, alone, which
 * makes the same numbers, to its last good state. */
static void end_in_lanes(Runner *r, Slot *slot)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    const gic_head failed = *r->one;
    int status = GIC_OK;
    memcpy(r->one, slot->before, code->size);
    last_good_forget(r->good);
    for (int64_t left = sweep->scene->per_output; left > 0 && status == GIC_OK; --left) {
        last_good_keep(r->good, code, r->one);
        status = scene_step(sweep->engine, code, &slot->scene, NULL, r->one, 0);
    }
    end_failed(r, slot, &failed);
}

/* Outputs of all slots that go on, at the present time. */
static void look_at_batch(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_batch_model *many = sweep->many;
    many->outputs(r->batch);
    for (int i = 0; i < r->used; ++i) {
        Slot *slot = &r->slot[i];
        if (slot->status != GIC_OK)
            continue;
        many->store(r->batch, i, r->one);
        set_status(r, slot, many->status(r->batch, i), r->one);
        if (slot->status == GIC_OK) {
            record_sample(sweep, slot, gic_time(r->one), value_in_lanes, &(InLanes){r, i});
            memcpy(slot->before, r->one, sweep->engine->code->size);
            slot->begun = true;
        } else if (slot->begun) {
            end_in_lanes(r, slot);
        }
    }
}

/* One step of all slots, in which knots may be. */
static void step_over_knots(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    double start[r->used];
    int32_t history[r->used];
    for (int i = 0; i < r->used; ++i) {
        sweep->many->store(r->batch, i, r->one);
        start[i] = gic_time(r->one);
        history[i] = r->one->history;
    }
    sweep->many->step(r->batch, sweep->scene->step, sweep->scene->method, 1);
    for (int i = 0; i < r->used; ++i) {
        Slot *slot = &r->slot[i];
        sweep->many->store(r->batch, i, r->one);
        if (slot->status != GIC_OK || sweep->many->status(r->batch, i) != GIC_OK ||
            scene_next_knot(&slot->scene, start[i]) > gic_time(r->one))
            continue;
        set_status(r, slot, knots_cross(code, &slot->scene, r->one, start[i], history[i]), r->one);
        sweep->many->load(r->batch, i, r->one);
    }
}

/* Steps of all slots until the next one with a knot, rather less than more, but at most `most`. */
static int64_t steps_to_knot(Runner *r, int64_t most)
{
    const Sweep *sweep = r->sweep;
    double steps = (double)most;
    for (int i = 0; i < r->used; ++i) {
        if (scene_next_knot(&r->slot[i].scene, 0) == (double)INFINITY)
            continue;
        sweep->many->store(r->batch, i, r->one);
        const double now = gic_time(r->one);
        steps = fmin(steps, (scene_next_knot(&r->slot[i].scene, now) - now) / sweep->scene->step - 1e-6);
    }
    return steps > 0 ? (int64_t)steps : 0;
}

/* Steps of all slots, at most `most`, up to the next sample of the watch. */
static int32_t step_lanes(Runner *r, int64_t most)
{
    const Sweep *sweep = r->sweep;
    const Scene *scene = sweep->scene;
    const StepWatch *watch = r->slot->watch; /* all watches sample the same steps */
    const bool look = watch && step_watch_idle(watch) < most;
    const int32_t steps = (int32_t)(look ? step_watch_idle(watch) + 1 : most);
    for (int64_t left = steps; left > 0;) {
        const int64_t smooth = steps_to_knot(r, left);
        if (smooth > 0)
            sweep->many->step(r->batch, scene->step, scene->method, (int32_t)smooth);
        else
            step_over_knots(r);
        left -= smooth > 0 ? smooth : 1;
    }
    for (int i = 0; i < r->used && watch; ++i) {
        step_watch_pass(r->slot[i].watch, steps - look);
        if (!look)
            continue;
        sweep->many->store(r->batch, i, r->one);
        step_watch_step(r->slot[i].watch, sweep->engine->code, r->one, r->copy);
    }
    return steps;
}

static void run_lanes(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const Scene *scene = sweep->scene;
    sweep->many->setup(r->batch);
    for (int i = 0; i < r->used; ++i) {
        start(r, &r->slot[i]);
        if (r->slot[i].status == GIC_OK)
            sweep->many->load(r->batch, i, r->one);
    }
    look_at_batch(r);
    for (int64_t k = 0; k < scene->outputs && !r->stopped; ++k) {
        for (int64_t left = scene->per_output; left > 0 && !r->stopped;) {
            left -= step_lanes(r, left < CHUNK ? left : CHUNK);
            look_around(r);
        }
        look_at_batch(r);
    }
    for (int i = 0; i < r->used; ++i)
        judge(r, &r->slot[i]);
}

/* The present outputs of the only slot. */
static void look_at_one(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    Slot *slot = r->slot;
    memcpy(r->copy, r->one, code->size); /* outputs are computed on a copy */
    set_status(r, slot, code->outputs(r->copy), r->copy);
    if (slot->status == GIC_OK)
        record_sample(sweep, slot, gic_time(r->one), value_alone, r);
    else
        end_failed(r, slot, r->copy);
}

static void run_one(Runner *r)
{
    const Sweep *sweep = r->sweep;
    const gic_model *code = sweep->engine->code;
    Slot *slot = r->slot;
    const Scene *scene = &slot->scene;
    Variable *variable = scene->method >= METHOD_ADAMS ? variable_open(code, scene->method, scene->tolerance) : NULL;
    last_good_forget(r->good);
    start(r, slot);
    if (slot->status == GIC_OK)
        look_at_one(r);
    for (int64_t k = 0; k < scene->outputs && slot->status == GIC_OK && !r->stopped; ++k) {
        const double end = (double)(k + 1) * scene->output_step;
        int64_t left = scene->per_output;
        while (slot->status == GIC_OK && !r->stopped && (variable ? gic_time(r->one) < end : left > 0)) {
            last_good_keep(r->good, code, r->one);
            set_status(r, slot, scene_step(sweep->engine, code, scene, variable, r->one, end), r->one);
            if (slot->watch && slot->status == GIC_OK)
                step_watch_step(slot->watch, code, r->one, r->copy);
            if (left-- % CHUNK == 0)
                look_around(r);
        }
        if (slot->status != GIC_OK)
            end_failed(r, slot, r->one);
        else if (!r->stopped)
            look_at_one(r);
    }
    variable_close(variable);
    judge(r, slot);
    look_around(r);
}

/* A run that has not begun. */
static void take_up(Runner *r, Slot *slot, int64_t run)
{
    const Sweep *sweep = r->sweep;
    slot->run = run;
    slot->scene = vary_scene(r->pool, sweep, run);
    slot->watch = step_watch_new(r->pool, r->theory, &slot->scene, sweep->engine, true);
    slot->time = 0;
    slot->begun = false;
    slot->reason = NULL;
    for (int c = 0; c < sweep->scene->columns; ++c)
        slot->range[c] = (Range){NAN, NAN, NAN};
    for (int m = 0; m < sweep->metrics; ++m)
        slot->metric[m] = (MetricState){0};
    slot->sample = 0;
    for (int64_t i = 0; slot->series && i < sweep->form->series * sweep->form->samples; ++i)
        slot->series[i] = NAN;
}

/* The result of a slot's run; its texts live as long as the journal. Its series are written. */
static RunResult result_of(const Runner *r, const Slot *slot)
{
    Pool *pool = r->sweep->journal->pool;
    if (r->sweep->journal->series)
        series_put(r->sweep->journal->series, slot->run, slot->series);
    return (RunResult){slot->run, slot->status, row_text(r->pool, r->sweep, slot),
                       slot->reason ? pool_print(pool, "%s", slot->reason) : NULL};
}

/* Runs side by side, as many as there are slots at most. False: someone asked to stop. */
static bool make_runs(void *context, const int64_t *run, int runs, RunResult *result)
{
    Runner *r = context;
    r->pool = pool_new(); /* memory of a batch's scenes is freed afterwards */
    for (r->used = 0; r->used < runs; ++r->used)
        take_up(r, &r->slot[r->used], run[r->used]);
    if (r->sweep->many)
        run_lanes(r);
    else
        run_one(r);
    for (int i = 0; i < runs && !r->stopped; ++i)
        result[i] = result_of(r, &r->slot[i]);
    pool_free(r->pool);
    return !r->stopped;
}

/* The same without progress. */
static bool make_silently(void *context, const int64_t *run, int runs, RunResult *result)
{
    Runner *r = context;
    r->silent = true;
    return make_runs(r, run, runs, result);
}

static bool take_results(void *context, const RunResult *result, int results)
{
    Runner *r = context;
    if (results)
        journal_add(r->sweep->journal, result, results);
    look_around(r);
    return !r->stopped;
}

/* In this process. */
static void run_alone(Runner *r, const int64_t *run, int64_t count)
{
    RunResult result[r->slots];
    for (int64_t next = 0; next < count && !r->stopped; next += r->slots) {
        const int runs = count - next < r->slots ? (int)(count - next) : r->slots;
        if (make_runs(r, run + next, runs, result))
            journal_add(r->sweep->journal, result, runs);
    }
}

static Runner runner_open(const Sweep *sweep)
{
    Pool *pool = sweep->pool;
    Runner r = {.sweep = sweep, .slots = sweep->many ? sweep->many->vehicles : 1, .before = sweep->journal->finished};
    r.slot = pool_alloc(pool, sizeof *r.slot * (size_t)r.slots);
    for (int i = 0; i < r.slots; ++i) {
        r.slot[i].range = pool_alloc(pool, sizeof(Range) * (size_t)(sweep->scene->columns + 1));
        r.slot[i].metric = pool_alloc(pool, sizeof(MetricState) * (size_t)(sweep->metrics + 1));
        const size_t numbers = (size_t)sweep->form->series * (size_t)sweep->form->samples;
        r.slot[i].series = numbers ? pool_alloc(pool, sizeof(double) * numbers) : NULL;
        r.slot[i].before = sweep->many ? instance_new(pool, sweep->engine) : NULL;
    }
    r.one = instance_new(pool, sweep->engine);
    r.copy = instance_new(pool, sweep->engine);
    r.good = last_good_new(pool, sweep->engine);
    r.theory = step_theory_new(pool, sweep->model);
    r.batch = sweep->many ? aligned_alloc(sweep->many->alignment, sweep->many->size) : NULL;
    if (sweep->many && !r.batch)
        diag_fail(program_place(), NULL, "no memory for %d vehicles", sweep->many->vehicles);
    if (r.batch)
        caught_own(free, r.batch);
    r.begun = clock_seconds(CLOCK_MONOTONIC);
    return r;
}

static void runner_close(const Runner *r)
{
    if (r->shown)
        diag_progress("");
    if (r->batch)
        caught_disown(r->batch);
    free(r->batch);
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
    int64_t run[count];
    RunResult result[count];
    double spent = 0;
    int64_t made = 0;
    for (int b = 0; b < BATCHES && spent < LONG_ENOUGH && !r.stopped; ++b) {
        for (int64_t i = 0; i < count; ++i) /* spread over all of them */
            run[i] = part_first(sweep->plan->runs, (int)(i * BATCHES + b + 1), (int)(count * BATCHES));
        if (make_runs(&r, run, (int)count, result))
            made += count;
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
    const int together = part < r.slots ? (int)part : r.slots;
    const int64_t batches = together ? (count + together - 1) / together : 0;
    const size_t processes = (size_t)(batches < sweep->processes ? batches : sweep->processes);
    const Share share = {count, run, sweep->journal->file, together, make_silently, take_results, &r};
    if (processes > 1)
        r.stopped = !share_runs(pool, &share, processes) || sweep->journal->finished < plan->count;
    else
        run_alone(&r, run, count);
    runner_close(&r);
    return !r.stopped;
}
