/* SPDX-License-Identifier: MIT
 * A scene as fast as time passes: at each deadline inputs are taken, a step is made, and outputs go out. */
#define _GNU_SOURCE /* RUSAGE_THREAD */
#include "run/live.h"

#include "base/message.h"
#include "base/text.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "run/engines.h"
#include "run/variable_step.h"
#include "run/run_remedy.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>

typedef struct Live {
    Pool *pool;
    const Engine *engine;
    const gic_model *model; /* the engine's code, or faster one */
    const Scene *scene;
    const Request *request;
    LivePort *port;
    LiveJoystick *joystick; /* NULL: there is none */
    LiveRecord *record;
    gic_head *self, *copy;  /* copy: for outputs */
    const gic_head *failed; /* which of the two has what went wrong */
    double *row;            /* [1 + columns] */
    double *value;          /* [inputs] of the last good packet */
    HoldBy by;
    LiveClock clock;
    LiveRank rank;
    LiveBare bare;
    bool compared; /* is there a bare thread */
    /* what came of it */
    int64_t steps, last, taken, missed, own, reset;
    int64_t over, back; /* to who sends, and back to the scene */
    int64_t slumber;
    double recorded; /* time of the last row of inputs */
    bool interrupted;
    Spread late, work, cpu;
    struct rusage before, after;
} Live;

/* ---- a step -------------------------------------------------------------------------------------------------------
 */

static double *inputs_of(const Live *l)
{
    return instance_array(l->self, l->model->input_offset);
}

static void record_inputs(Live *l)
{
    l->recorded = gic_time(l->self);
    live_record_inputs(l->record, l->recorded, l->scene->hold->by, l->scene->hold->value);
}

/* What packets or the joystick say, for the step that begins. */
static void take_inputs(Live *l)
{
    const HoldBy before = l->scene->hold->by;
    const bool had = live_joystick_has(l->joystick);
    if (l->joystick)
        live_joystick_take(l->joystick, gic_time(l->self), &l->by, l->value);
    if (had || live_joystick_has(l->joystick))
        live_port_keep(l->port, live_joystick_has(l->joystick), l->steps);
    live_port_take(l->port, l->steps, &l->by, l->value);
    const bool changed = hold_take(l->scene, gic_time(l->self), l->by, l->value, inputs_of(l));
    l->taken += changed;
    if (changed || l->steps == 0) /* a recording begins where the run does */
        record_inputs(l);
    l->over += before == HOLD_SCENE && l->by != HOLD_SCENE;
    l->back += before != HOLD_SCENE && l->by == HOLD_SCENE;
}

/* Outputs at the present time, into the row. Returns a status. */
static int find_outputs(Live *l)
{
    const int status = scene_outputs(l->model, l->scene, l->self, l->copy, &l->slumber);
    l->row[0] = gic_time(l->self);
    for (int i = 0; i < l->scene->columns; ++i)
        l->row[1 + i] = scene_value(l->model, l->copy, l->scene->column[i]);
    return status;
}

/* One step and, where they are due, its outputs. Returns a status. */
static int make_step(Live *l, bool *outputs)
{
    int status = scene_step(l->engine, l->model, l->scene, NULL, l->self, 0);
    l->failed = l->self;
    *outputs = (l->steps + 1) % l->scene->per_output == 0;
    if (status != GIC_OK || !*outputs)
        return status;
    l->failed = l->copy;
    return find_outputs(l);
}

static void measure(Live *l, int64_t due, int64_t began, int64_t worked, bool missed)
{
    const double cpu = 1e-9 * (double)worked;
    spread_add(&l->late, 1e-9 * (double)(began - due));
    spread_add(&l->work, 1e-9 * (double)(live_now(CLOCK_MONOTONIC) - began));
    spread_add(&l->cpu, cpu);
    atomic_store(&l->bare.leaves, l->scene->step - l->work.sum / (double)l->work.count);
    l->missed += missed;
    l->own += missed && cpu > l->scene->step;
}

static int run_steps(Live *l)
{
    int status = GIC_OK;
    while (status == GIC_OK && l->steps != l->last && !l->interrupted) {
        const int64_t due = live_due(&l->clock, l->steps);
        bool outputs;
        live_wait(due);
        const int64_t began = live_now(CLOCK_MONOTONIC), cpu = live_now(CLOCK_THREAD_CPUTIME_ID);
        take_inputs(l);
        status = make_step(l, &outputs);
        if (status != GIC_OK)
            break;
        const bool missed = live_now(CLOCK_MONOTONIC) > live_due(&l->clock, l->steps + 1);
        if (outputs)
            live_port_send(l->port, l->steps + 1, missed ? GIC_LIVE_MISSED : 0, l->row);
        if (outputs)
            live_record_results(l->record, l->row);
        measure(l, due, began, live_now(CLOCK_THREAD_CPUTIME_ID) - cpu, missed);
        l->reset += live_behind(&l->clock, live_now(CLOCK_MONOTONIC) - live_due(&l->clock, l->steps + 1));
        ++l->steps;
        l->interrupted = interrupt_arrived();
    }
    return status;
}

/* ---- what is told -------------------------------------------------------------------------------------------------
 */

static void tell_spreads(Text *out, const Live *l)
{
    const Spread *const column[] = {&l->late, &l->bare.late, &l->work, &l->cpu};
    enum { COLUMNS = sizeof column / sizeof *column };
    text_print(out, "  %-20s %12s %12s %12s %12s\n", "us, up to", "steps late", "bare thread", "step", "its CPU time");
    for (int bin = 0; bin < SPREAD_BINS; ++bin) {
        bool any = false;
        for (int i = 0; i < COLUMNS; ++i)
            any = any || column[i]->bin[bin];
        if (!any)
            continue;
        text_print(out, "  %-20s",
                   isinf(spread_end(bin)) ? "more" : pool_print(out->pool, "%.0f", 1e6 * spread_end(bin)));
        for (int i = 0; i < COLUMNS; ++i)
            text_print(out, " %12lld", (long long)column[i]->bin[bin]);
        text_print(out, "\n");
    }
    text_print(out, "  %-20s", "all");
    for (int i = 0; i < COLUMNS; ++i)
        text_print(out, " %12lld", (long long)column[i]->count);
    text_print(out, "\n  %-20s", "mean, us");
    for (int i = 0; i < COLUMNS; ++i)
        text_print(out, " %12.1f", 1e6 * column[i]->sum / fmax((double)column[i]->count, 1));
    text_print(out, "\n  %-20s", "most, us");
    for (int i = 0; i < COLUMNS; ++i)
        text_print(out, " %12.1f", 1e6 * column[i]->most);
    text_print(out, "\n");
}

static void summary(const Live *l)
{
    Text text = {.pool = l->pool}, *out = &text;
    const Scene *scene = l->scene;
    const LivePort *port = l->port;
    text_print(out, "%s: %.6g s in %lld steps of %.6g s (%s%s), as fast as time passes\n", l->model->name,
               gic_time(l->self), (long long)l->steps, scene->step, integrator_name(scene->method),
               l->self->ratio > 1 ? pool_print(l->pool, ", ratio %d", l->self->ratio) : "");
    text_print(out, "  inputs               %lld packets good, changes at %lld steps; %s\n", (long long)port->good,
               (long long)l->taken, live_port_dropped(l->pool, port));
    text_print(out, "  taken over           %lld times, given back %lld times\n", (long long)l->over,
               (long long)l->back);
    text_print(out, "  packets sent         %lld, not sent %lld%s%s\n", (long long)port->sent, (long long)port->unsent,
               port->unsent ? ": " : "", port->unsent ? strerror(port->unsent_reason) : "");
    text_print(out, "  scheduling           %s, memory %s\n", l->rank.raised ? "SCHED_FIFO" : "as other programs have",
               l->rank.locked ? "locked" : "not locked");
    tell_spreads(out, l);
    text_print(out, "  missed deadlines     %lld of %lld, %lld of them by computing longer than a step\n",
               (long long)l->missed, (long long)l->steps, (long long)l->own);
    if (l->compared)
        text_print(out, "  bare thread          %lld of %lld times later than the %.3g us that a step leaves\n",
                   (long long)l->bare.misses, (long long)l->bare.late.count, 1e6 * atomic_load(&l->bare.leaves));
    if (l->reset)
        text_print(out, "  clock set anew       %lld times, where steps were more than 1 s behind\n",
                   (long long)l->reset);
    text_print(out, "  interrupted steps    %lld times by other programs; %lld pages fetched\n",
               (long long)(l->after.ru_nivcsw - l->before.ru_nivcsw),
               (long long)(l->after.ru_majflt + l->after.ru_minflt - l->before.ru_majflt - l->before.ru_minflt));
    if (engine_remark(l->engine))
        text_print(out, "  compiled code        %s\n", engine_remark(l->engine));
    diag_note(text.s);
}

/* ---- begin and end ------------------------------------------------------------------------------------------------
 */

const Scene *live_scene(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Scene *out = pool_alloc(pool, sizeof *out);
    if (scene->method >= METHOD_ADAMS)
        diag_fail((Place){scene->source, 0, 0}, "write `integrator: ab3` and a step",
                  "only constant steps keep a clock");
    *out = *scene;
    out->hold = hold_new(pool, model, request->inputs);
    out->actions = NULL;
    out->rest = NULL;
    return out;
}

static void begin_clock(Live *l)
{
    enum { SOON = 20 * 1000 * 1000 }; /* ns until the first step */
    l->clock = (LiveClock){live_now(CLOCK_MONOTONIC) + SOON, l->scene->step};
    l->bare.clock = l->clock;
    atomic_store(&l->bare.leaves, l->scene->step);
    l->compared = live_bare_start(&l->bare, &l->rank);
    getrusage(RUSAGE_THREAD, &l->before);
}

static void end_clock(Live *l)
{
    getrusage(RUSAGE_THREAD, &l->after);
    if (l->compared)
        live_bare_stop(&l->bare);
}

static void start(Live *l)
{
    const Place at = {l->scene->source, 0, 0};
    int status = scene_start(l->engine, l->scene, l->self);
    if (status != GIC_OK)
        diag_fail(at, NULL, "the model can't be set up: %s", instance_status(l->pool, l->model, l->self, status));
    status = find_outputs(l);
    if (status != GIC_OK)
        diag_fail(at, "is the initial state one that the mechanism can reach from its design?",
                  "the run can't start: %s", instance_status(l->pool, l->model, l->copy, status));
    const gic_model *faster = engine_settle(l->engine, l->self);
    l->model = faster ? faster : l->model;
}

/* The run ended with a status; a step that failed left the instance at the last good state. */
static _Noreturn void fail(Live *l, const Model *model, int status)
{
    const char *said = instance_status(l->pool, l->model, l->failed, status);
    const int subset = l->failed->subset;
    DeadCentre found = {0};
    if (l->failed == l->self && find_outputs(l) == GIC_OK)
        found = run_dead_centre(l->pool, model, l->model, l->copy, status, subset);
    diag_fail((Place){l->scene->source, 0, 0}, found.finding ? found.remedy : run_remedy(status),
              "the run ends at t = %.6g s: %s", gic_time(l->self), found.finding ? found.finding : said);
}

void live(Pool *pool, const Engine *engine, const Model *model, const Scene *scene, LivePort *port,
          const Request *request)
{
    Live l = {.pool = pool,
              .engine = engine,
              .model = engine->code,
              .scene = scene,
              .request = request,
              .port = port,
              .last = request->seconds > 0 ? (int64_t)floor(request->seconds / scene->step + 1e-9) : -1};
    l.self = instance_new(pool, engine);
    l.copy = instance_new(pool, engine);
    l.row = pool_alloc(pool, sizeof(double) * (size_t)(1 + scene->columns));
    l.value = pool_alloc(pool, sizeof(double) * (size_t)(1 + scene->hold->inputs));
    memcpy(l.value, port->begin, sizeof(double) * (size_t)scene->hold->inputs);
    if (request->joystick)
        l.joystick = live_joystick_open(pool, port, model, scene, request->joystick, request->axes);
    interrupt_hold(); /* else temporary files of tables would remain */
    start(&l);
    l.record = live_record_open(pool, model, scene, request->results, request->record);
    l.rank = live_rank_raise(request->quiet);
    if (!request->quiet)
        diag_note(pool_print(pool, "%s: takes inputs and gives outputs at port %d of 127.0.0.1%s\n", model->name,
                             port->port, l.last < 0 ? ", until it is interrupted" : ""));
    live_record_results(l.record, l.row);
    begin_clock(&l);
    const int status = run_steps(&l);
    end_clock(&l);
    live_port_send(port, l.steps, GIC_LIVE_OVER, l.row);
    live_rank_restore(&l.rank);
    engine_rest(engine);
    if (status != GIC_OK) /* a recording ends where the run did, so that a step that fails is made again */
        live_record_inputs(l.record, (double)(l.steps + 1) * scene->step, scene->hold->by, scene->hold->value);
    else if (gic_time(l.self) > l.recorded)
        record_inputs(&l);
    live_record_close(l.record);
    interrupt_take();
    interrupt_release();
    live_port_close(port);
    live_joystick_close(l.joystick);
    if (!request->quiet)
        summary(&l);
    if (status != GIC_OK)
        fail(&l, model, status);
}
