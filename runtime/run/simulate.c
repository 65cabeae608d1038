/* SPDX-License-Identifier: MIT
 * Run a scene: steps, results, progress, summary. */
#include "base/message.h"
#include "base/text.h"
#include "compare/contact_pieces.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "run/bounce_watch.h"
#include "run/run_remedy.h"
#include "run/engines.h"
#include "run/knot.h"
#include "run/last_good.h"
#include "run/page_vehicle.h"
#include "run/range_watch.h"
#include "run/run.h"
#include "run/sampling.h"
#include "run/scene_events.h"
#include "run/stability_watch.h"
#include "run/variable_step.h"
#include "scene/action.h"
#include "scene/driver.h"
#include "scene/profile.h"
#include "scene/hold.h"
#include "scene/replay.h"
#include "scene/scene.h"
#include "scene/sleep.h"

#include <math.h>
#include <string.h>

enum {
    BATCH = 256,        /* steps between looks at the clock */
    MOST_POINTS = 4000, /* of a curve in a picture */
};

static const double refresh = 0.1; /* s between lines of progress */

/* A run in progress. Outputs are computed on a copy of the instance, so that how often someone looks leaves no trace in
 * the results. */
typedef struct Run {
    Pool *pool;
    const Engine *engine;
    const gic_model *model; /* the engine's code, later maybe faster code */
    const Scene *scene;
    const Request *request;
    gic_head *self, *copy;
    Variable *variable; /* NULL: constant steps */
    int64_t steps;
    Csv csv;
    Plot plot;
    const int *drawn;     /* indices of the picture's signals among the scene's */
    Animation *animation; /* NULL: none */
    StepWatch *watch;     /* NULL: none */
    BounceWatch *bounces; /* NULL: none */
    RangeWatch *ranges;
    SceneEvents *events; /* NULL: the scene has no conditions */
    LastGood *good;
    Outcome outcome;
    bool ended;             /* by `until` */
    int64_t samples, every; /* output times so far; one in `every` goes into the picture */
    double constraint;      /* largest residual so far */
    double integrating;     /* CPU seconds in steps */
    int64_t most_work;      /* the most evaluations of a constant step */
    double recorded;        /* time of the last row */
    double looked;          /* clock at the last look */
    int64_t slumber;        /* of scene_outputs */
    bool shown, interrupted;
} Run;

/* Set the base and the free coordinates in the state: FORMAT.md section 10. Numbers that the scene does not give stay
 * as set-up made them, since geometric parameters may have moved them. */
static int set_state(const Engine *engine, const Scene *scene, gic_head *self)
{
    const gic_model *model = engine->code;
    double state[engine->standard_count + 1];
    const int status = engine_look(engine, self, state, NULL);
    if (status != GIC_OK)
        return status;
    /* from a coordinate to its rate, past 7 and 6 numbers of the base */
    const int half = (engine->standard_count - model->fast_count) / 2;
    if (model->free_base) {
        if (scene->placed)
            memcpy(state, scene->position, sizeof scene->position);
        memcpy(state + 3, scene->euler, sizeof scene->euler);
        memcpy(state + half + 1, scene->velocity, sizeof scene->velocity);
        memcpy(state + half + 4, scene->angular_velocity, sizeof scene->angular_velocity);
    }
    for (int i = 0; i < model->coordinate_count; ++i) {
        int at = model->coordinate_state[i];
        if (at < 0)
            continue;
        if (scene->given[i])
            state[at] = scene->value[i];
        state[at + half] = scene->rate[i];
    }
    return engine_enter(engine, self, state);
}

int scene_set_fast(const gic_model *model, const Scene *scene, gic_head *self)
{
    const int status = model->roll ? model->roll(self) : GIC_OK;
    double *fast = instance_array(self, model->state_offset) + model->slow_count;
    for (int i = 0; i < model->fast_count && scene; ++i)
        if (!isnan(scene->fast[i]))
            fast[i] = scene->fast[i];
    int32_t *discrete = (int32_t *)(void *)((char *)self + model->discrete_offset);
    for (int i = model->free_base; i < model->discrete_count && scene; ++i)
        discrete[i] = scene->gear;
    return status;
}

/* ---- output times --------------------------------------------------------------------------------------- */

double scene_value(const gic_model *code, gic_head *self, int i)
{
    const bool input = i >= code->output_count;
    return instance_array(self, input ? code->input_offset : code->output_offset)[input ? i - code->output_count : i];
}

/* How many marks a scene sets. */
static int scene_marks(const Scene *scene)
{
    return scene->actions ? scene->actions->marks : 0;
}

/* Names and units of the results: the time, the scene's columns, its marks. */
static gic_signal *result_signals(Pool *pool, const Scene *scene, int *count)
{
    const int most = 1 + scene->columns + (scene_marks(scene) ? scene->actions->count : 0);
    gic_signal *signal = pool_alloc(pool, sizeof *signal * (size_t)most), *next = signal;
    *next++ = (gic_signal){"time", "s"};
    for (int i = 0; i < scene->columns; ++i)
        *next++ = scene->signal[scene->column[i]];
    for (int i = 0; scene_marks(scene) && i < scene->actions->count; ++i)
        if (scene->actions->action[i].mark)
            *next++ = (gic_signal){pool_print(pool, "mark.%s", scene->actions->action[i].mark), "1"};
    *count = (int)(next - signal);
    return signal;
}

static void write_header(Run *run)
{
    int count;
    const gic_signal *signal = result_signals(run->pool, run->scene, &count);
    for (int i = 0; i < count; ++i)
        csv_name(&run->csv, signal[i].name, signal[i].unit);
    csv_end_row(&run->csv);
}

/* A row of the results into memory. */
static void keep_row(const Run *run, RunColumns *kept)
{
    const Scene *scene = run->scene;
    if (!kept->signal) { /* names that outlive the code */
        kept->signal = result_signals(kept->pool, scene, &kept->columns);
        for (int i = 0; i < kept->columns; ++i)
            kept->signal[i] = (gic_signal){pool_print(kept->pool, "%s", kept->signal[i].name),
                                           pool_print(kept->pool, "%s", kept->signal[i].unit)};
    }
    const size_t row = sizeof(double) * (size_t)kept->columns;
    if (kept->rows == kept->room) {
        const int64_t room = 2 * kept->room + 64;
        kept->value = pool_grow(kept->pool, kept->value, row * (size_t)kept->rows, row * (size_t)room);
        kept->room = room;
    }
    double *value = kept->value + kept->columns * kept->rows++;
    *value++ = run->recorded;
    for (int i = 0; i < scene->columns; ++i)
        *value++ = scene_value(run->model, run->copy, scene->column[i]);
    for (int i = 0; scene_marks(scene) && i < scene->actions->count; ++i)
        if (scene->actions->action[i].mark)
            *value++ = scene->actions->action[i].done;
}

/* The signals of a row of the picture, after the time. */
static const int *drawn_signals(Pool *pool, const Scene *scene)
{
    int *drawn = pool_alloc(pool, sizeof *drawn * (size_t)(scene->curves + 2 * scene->panels + 1)), *next = drawn;
    for (int i = 0; i < scene->curves; ++i)
        *next++ = scene->curve[i];
    for (int i = 0; i < 2 * scene->panels; ++i)
        *next++ = scene->panel[i / 2][i % 2];
    return drawn;
}

/* Of a path, without its folders. */
static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The other run must have something that is drawn. */
static void check_other(const Run *run)
{
    const Plot *plot = &run->plot;
    for (int i = 0; i < plot->curves + 2 * plot->panels; ++i)
        if (plot_column(run->pool, plot->other, &plot->signal[i]) > 0)
            return;
    diag_fail((Place){plot->other->source, 1, 1},
              "give it results of a run with the same `plot`, or with these among its `outputs`",
              "the table has none of the columns that are drawn, such as '%s'", plot->signal[0].name);
}

static void prepare_plot(Run *run)
{
    const Scene *scene = run->scene;
    run->plot.title = pool_print(run->pool, "%s: %s", run->model->name, name_of(run->request->scene));
    run->plot.curves = scene->curves;
    run->plot.panels = scene->panels;
    run->drawn = drawn_signals(run->pool, scene);
    run->plot.other = run->request->other;
    run->plot.other_name = run->plot.other ? name_of(run->request->with) : NULL;
    const int drawn = scene->curves + 2 * scene->panels;
    gic_signal *signal = pool_alloc(run->pool, sizeof *signal * (size_t)(drawn + 1));
    double *factor = pool_alloc(run->pool, sizeof *factor * (size_t)(drawn + 1));
    run->plot.shown = pool_alloc(run->pool, sizeof *run->plot.shown * (size_t)(drawn + 1));
    for (int i = 0; i < drawn; ++i) {
        signal[i] = scene->signal[run->drawn[i]];
        const ShownUnit *unit = scene_unit(scene, signal[i].unit);
        run->plot.shown[i] = unit ? unit->name : signal[i].unit;
        factor[i] = unit ? unit->factor : 1;
    }
    run->plot.signal = signal;
    run->plot.factor = factor;
    if (run->plot.other)
        check_other(run);
    run->every = (scene->outputs + MOST_POINTS) / MOST_POINTS;
    int64_t rows = scene->outputs / run->every + 1;
    run->plot.sample = pool_alloc(run->pool, sizeof(double) * (size_t)rows * (size_t)(drawn + 1));
}

int scene_outputs(const gic_model *model, const Scene *scene, const gic_head *self, gic_head *copy, int64_t *slumber)
{
    if (scene->page)
        return page_vehicle_outputs(scene, model, self, copy);
    const Sleep *rest = scene->rest;
    const int64_t now = rest && rest->asleep ? rest->slumbers : 0;
    const bool stay = now && now == *slumber;
    *slumber = now;
    if (stay)
        return GIC_OK;
    memcpy(copy, self, model->size);
    copy->grown = -1;
    copy->unchecked = 0; /* check the results that are shown */
    return model->outputs(copy);
}

/* Compute outputs at an output time. */
static int compute_outputs(Run *run)
{
    const int status = scene_outputs(run->model, run->scene, run->self, run->copy, &run->slumber);
    return status == GIC_OK && run->animation ? animation_frame(run->animation, run->model, run->copy) : status;
}

/* Update what is known about the vehicle (beyond ranges, tipped over, off the road, at rest) where the base's state is
 * directly available. */
static void look_at_vehicle(Run *run, const gic_head *at)
{
    if (run->engine->leave)
        return;
    range_watch_look(run->ranges, run->model, at);
    if (run->model->free_base && run->model->wheel_count)
        outcome_look(&run->outcome, run->model, run->scene->road, gic_time(at),
                     instance_array((gic_head *)at, run->model->state_offset));
}

/* A row: the time of an instance, and the outputs of the copy. */
static void record(Run *run, const gic_head *at)
{
    const Scene *scene = run->scene;
    const double time = gic_time(at);
    run->recorded = time;
    look_at_vehicle(run, at);
    if (run->request->columns)
        keep_row(run, run->request->columns);
    if (run->csv.file) {
        csv_time(&run->csv, time);
        for (int i = 0; i < scene->columns; ++i)
            csv_number(&run->csv, scene_value(run->model, run->copy, scene->column[i]));
        for (int i = 0; scene_marks(scene) && i < scene->actions->count; ++i)
            if (scene->actions->action[i].mark)
                csv_number(&run->csv, scene->actions->action[i].done);
        csv_end_row(&run->csv);
    }
    if (run->samples++ % run->every == 0) {
        const int drawn = scene->curves + 2 * scene->panels;
        double *sample = run->plot.sample + run->plot.rows++ * (drawn + 1);
        *sample++ = time;
        for (int i = 0; i < drawn; ++i)
            *sample++ = scene_value(run->model, run->copy, run->drawn[i]) * run->plot.factor[i];
    }
    run->constraint = fmax(run->constraint, run->copy->residual);
}

/* ---- for the person who waits --------------------------------------------------------------------------- */

static void show_progress(Run *run)
{
    char text[100];
    const double time = gic_time(run->self);
    if (run->request->quiet)
        return;
    snprintf(text, sizeof text, "%5.1f %%  t = %.3f s  %.0f times real time", 100 * time / run->scene->duration, time,
             time / fmax(run->integrating, 1e-9));
    diag_progress(text);
    run->shown = true;
}

static void clear_progress(const Run *run)
{
    if (run->shown)
        diag_progress("");
}

/* Print the work that was skipped, each kind if there was any. */
static void summary_of_skips(Text *out, const gic_head *head)
{
    const struct {
        int64_t count;
        const char *name, *what;
    } skip[] = {
        {head->kept_count, "recoveries reused", "subset solutions whose inputs had not changed"},
        {head->air_count, "tires skipped", "evaluations of wheels in the air"},
        {head->steady_count, "fast rates skipped", "evaluations while fast states changed steadily"},
        {head->contact_count, "contacts located", "made or lost within steps"},
        {head->passed_count, "events gone over", "contacts and gears for which `most_work` left no room"},
        {head->held_count, "values held", "changes of what controllers hold"},
        {head->sleep_count, "steps asleep", "steps while the vehicle was at rest"},
    };
    for (size_t i = 0; i < sizeof skip / sizeof *skip; ++i)
        if (skip[i].count)
            text_print(out, "  %-20s %lld %s\n", skip[i].name, (long long)skip[i].count, skip[i].what);
}

/* Print ranges and rates of inputs by their profiles: the demands on driven coordinates. */
static void summary_of_inputs(Text *out, const Run *run)
{
    const Scene *scene = run->scene;
    for (int i = 0; i < scene->profiles; ++i) {
        const Profile *profile = &scene->profile[i];
        if (profile_is_constant(profile) || profile->begin != 0)
            continue;
        const ProfilePeaks peaks = profile_peaks(profile, scene->duration);
        const bool none = !strcmp(profile->unit, "1");
        const char *unit = none ? "1" : profile->unit;
        text_print(out, "  %-20s %.4g to %.4g%s%s, rate up to %.4g %s/s, acceleration up to %.4g %s/s^2\n",
                   pool_print(run->pool, "input %s", run->engine->code->input[profile->input].name), peaks.low,
                   peaks.high, none ? "" : " ", none ? "" : unit, peaks.rate, unit, peaks.acceleration, unit);
    }
}

/* What happened on the way, and what became of the vehicle. */
static void summary_of_events(Text *out, const Run *run)
{
    const Actions *actions = run->scene->actions;
    const Outcome *o = &run->outcome;
    for (int i = 0; actions && i < actions->count; ++i) {
        const Action *action = &actions->action[i];
        if (action->done)
            text_print(out, "  %-20s %s at t = %.9g s%s%s\n", action->ends ? "ended" : "happened", action->text,
                       action->time, action->mark ? ": " : "", action->mark ? action->mark : "");
        else
            text_print(out, "  %-20s %s\n", "did not happen", action->text);
    }
    if (run->scene->driver && driver_is_crossed(run->scene->driver))
        text_print(out,
                   "  %-20s the vehicle turns to the other side than the driver steers for: is the sign of its "
                   "`per_angle` the other one?\n",
                   "driver");
    if (!isnan(o->tipped))
        text_print(out, "  %-20s leans by more than 60 degrees at t = %.6g s\n", "vehicle tips over", o->tipped);
    if (!isnan(o->left))
        text_print(out, "  %-20s beyond the road's data from t = %.6g s on\n", "vehicle leaves road", o->left);
    range_watch_print(run->ranges, out);
    if (!isnan(o->rest) && o->moved)
        text_print(out, "  %-20s from t = %.6g s on\n", "vehicle at rest", o->rest);
}

/* Evaluations and solutions of the engine. */
static void summary_of_work(Text *out, const Run *run)
{
    const gic_head *head = run->self;
    const double solutions = (double)head->newton_count;
    text_print(out, "  right-hand sides     %lld\n", (long long)head->rhs_count);
    if (run->model->implicit)
        text_print(out, "  Jacobians            %lld\n",
                   (long long)((const gic_implicit_head *)(const void *)((const char *)head +
                                                                         run->model->implicit->head_offset))
                       ->jacobian_count);
    if (head->fast_count)
        text_print(out, "  fast rates           %lld\n", (long long)head->fast_count);
    text_print(out, "  Newton corrections   %lld in %lld subset solutions (%.3f each), %lld after the first check\n",
               (long long)head->correction_count, (long long)head->newton_count,
               solutions > 0 ? (double)head->correction_count / solutions : 0.0, (long long)head->late_count);
}

static void summary(const Run *run, double total)
{
    Text text = {.pool = run->pool}, *out = &text;
    const gic_head *head = run->self;
    const Scene *scene = run->scene;
    const double time = gic_time(head);
    const char *results = run->request->results;
    const char *integrator = integrator_name(scene->method);
    const char *ratio = head->ratio > 1 ? pool_print(run->pool, ", ratio %d", head->ratio) : "";
    const char *how = run->variable ? pool_print(run->pool, "of %s, tolerance %.6g", integrator, scene->tolerance)
                                    : pool_print(run->pool, "of %.6g s (%s%s)", scene->step, integrator, ratio);
    text_print(out, "%s: %.6g s in %lld steps %s, %lld rows%s%s\n", run->model->name, time, (long long)run->steps, how,
               (long long)run->samples, results ? " in " : "",
               !results               ? ""
               : strcmp(results, "-") ? results
                                      : "standard output");
    if (scene->page)
        text_print(out, "  digits               those of the page of --drive: its WebAssembly, interpreted\n");
    else
        summary_of_work(out, run);
    if (!run->variable && !scene->page && (scene->locate || scene->most_work))
        text_print(out, "  work of a step       at most %lld right-hand sides and looks at contacts and gears\n",
                   (long long)run->most_work);
    summary_of_skips(out, head);
    const double output_step = scene->per_output > 1 ? scene->output_step : 0;
    const char *parts = run->variable ? NULL : sampling_note(run->pool, run->engine->code, scene->step, output_step);
    if (parts)
        text_print(out, "  steps in parts       %s\n", parts);
    summary_of_inputs(out, run);
    text_print(out, "  parameter switches   %lld\n", (long long)head->switch_count);
    text_print(out, "  constraint residual  %.2g at most, relative to the subset's size\n", run->constraint);
    summary_of_events(out, run);
    if (engine_remark(run->engine))
        text_print(out, "  compiled code        %s\n", engine_remark(run->engine));
    text_print(out, "  CPU time             %.3g s in steps, %.0f times real time; %.3g s with outputs\n",
               run->integrating, time / fmax(run->integrating, 1e-9), total);
    diag_note(text.s);
}

/* ---- the run -------------------------------------------------------------------------------------------- */

int scene_start(const Engine *engine, const Scene *scene, gic_head *self)
{
    const gic_model *model = engine->code;
    int status = model->setup_with(self, scene->parameter);
    if (status != GIC_OK)
        return status;
    self->road = scene->road;
    self->locate = scene->locate;
    self->most = scene->most_work;
    if (model->implicit) {
        gic_implicit_head *implicit = (gic_implicit_head *)(void *)((char *)self + model->implicit->head_offset);
        implicit->keep = scene->keep;
        implicit->spread = scene->spread && model->implicit->share_count > 0;
    }
    self->input_function = scene_inputs;
    self->user = (void *)scene; /* only read */
    if (scene->driver)
        driver_start(scene->driver);
    if (scene->replay)
        replay_start(scene->replay);
    if (scene->hold)
        hold_start(scene->hold);
    scene_inputs(self->user, 0, 0, instance_array(self, model->input_offset));
    status = set_state(engine, scene, self);
    if (status == GIC_OK)
        status = scene_set_fast(model, scene, self);
    if (scene->rest)
        sleep_start(scene->rest, model, self);
    if (scene->page && status == GIC_OK)
        status = page_vehicle_start(scene, model, self);
    return status;
}

static void change_code(Run *run)
{
    const gic_model *faster = engine_faster(run->engine, run->self);
    if (!faster)
        return;
    run->model = faster;
    if (run->variable)
        variable_change(run->variable, faster);
}

/* From time to time: check for a request to stop and for faster code, and print progress. */
static void look_around(Run *run)
{
    double now = clock_seconds(CLOCK_MONOTONIC);
    if (now - run->looked < refresh)
        return;
    run->looked = now;
    run->interrupted = interrupt_arrived();
    change_code(run);
    show_progress(run);
}

int scene_look(const Engine *engine, const Scene *scene, gic_head *self)
{
    if (!scene->driver || !driver_is_due(scene->driver, gic_time(self)))
        return GIC_OK;
    double state[engine->standard_count + 1];
    const double *own = instance_array(self, engine->code->state_offset);
    const int status = engine->leave ? engine_look(engine, self, state, NULL) : GIC_OK;
    if (status != GIC_OK)
        return status;
    const int half = (engine->standard_count - engine->code->fast_count) / 2;
    const Sight sight = sight_of(engine->leave ? state : own, half);
    driver_look(scene->driver, gic_time(self), &sight);
    return GIC_OK;
}

/* A step under way. */
typedef struct Step {
    const gic_model *model;
    const Scene *scene;
    Variable *variable; /* NULL: constant steps */
    double end;
} Step;

static int constant_step(const Step *step, gic_head *self)
{
    const gic_model *model = step->model;
    const Scene *scene = step->scene;
    const double start = gic_time(self);
    const int history = self->history;
    const int32_t ratio = scene->method == GIC_RK4 ? 1 : scene->ratio; /* it has one rate */
    const int status = gic_step_dual_by(model, self, scene->step, scene->method, ratio, scene->steady);
    return status == GIC_OK ? knots_cross(model, scene, self, start, history) : status;
}

static int any_step(void *caller, gic_head *self)
{
    const Step *step = caller;
    if (!step->variable)
        return constant_step(step, self);
    const double kink = scene_next_kink(step->scene, gic_time(self));
    const double most = gic_time(self) + scene_longest_step(step->scene, gic_time(self));
    const int status = variable_step(step->variable, self, fmin(fmin(kink, step->end), most));
    if (status == GIC_OK && gic_time(self) >= kink)
        variable_restart(step->variable);
    return status;
}

/* To `end` within a step: by variable steps, or by RK4 in parts no longer than fast ones. */
static int piece_of_step(void *caller, gic_head *self, double end)
{
    Step part = *(const Step *)caller;
    const double length = end - gic_time(self);
    const int parts = (int)ceil(0.999 * length * part.scene->ratio / part.scene->step);
    int status = GIC_OK;
    part.end = end;
    while (part.variable && status == GIC_OK && gic_time(self) < end)
        status = any_step(&part, self);
    for (int i = 0; !part.variable && i < parts && status == GIC_OK; ++i)
        status = gic_step(part.model, self, length / parts, scene_method_of_parts(part.scene));
    if (status == GIC_OK && !part.variable) {
        gic_restart(self, end); /* the time as it is, not as a sum */
        if (self->input_function)
            self->input_function(self->user, self->lane, end, instance_array(self, part.model->input_offset));
    }
    return status;
}

static void step_again(void *caller)
{
    const Step *step = caller;
    if (step->variable)
        variable_restart(step->variable);
}

int scene_step_awake(const Engine *engine, const gic_model *model, const Scene *scene, Variable *variable,
                     gic_head *self, double end)
{
    Step step = {model, scene, variable, end};
    if (!engine->pieces || !(variable || self->locate))
        return any_step(&step, self);
    const ContactWays ways = {any_step, piece_of_step, step_again, &step};
    return contact_pieces_step(engine->pieces, engine->code, self, &ways);
}

int scene_step(const Engine *engine, const gic_model *model, const Scene *scene, Variable *variable, gic_head *self,
               double end)
{
    if (scene->page)
        return page_vehicle_step(scene, model, self);
    if (scene->replay)
        replay_look(scene, gic_time(self), instance_array(self, model->input_offset));
    if (scene->hold)
        hold_look(scene, gic_time(self), instance_array(self, model->input_offset));
    int status = scene_look(engine, scene, self);
    if (status != GIC_OK)
        return status;
    if (scene->rest && sleep_step(scene->rest, model, scene, self))
        return GIC_OK;
    status = scene_step_awake(engine, model, scene, variable, self, end);
    if (scene->rest && status == GIC_OK)
        sleep_watch(scene->rest, model, self);
    return status;
}

/* Right-hand sides and looks at contacts and gears so far. */
static int64_t work_of(const gic_head *self)
{
    return self->rhs_count + self->look_count;
}

/* Steps up to the output time `end`. Returns the status of the last one. */
static int advance(Run *run, double end)
{
    int status = GIC_OK;
    int64_t left = run->scene->per_output; /* constant steps are counted, since their times differ from `end` by
                                            * rounding */
    while (status == GIC_OK && !run->interrupted && !run->ended &&
           (run->variable ? gic_time(run->self) < end : left > 0)) {
        double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
        for (int i = 0;
             i < BATCH && status == GIC_OK && !run->ended && (run->variable ? gic_time(run->self) < end : left > 0);
             ++i) {
            const int64_t work = work_of(run->self);
            last_good_keep(run->good, run->model, run->self);
            status = run->events
                         ? scene_events_step(run->events, run->model, run->variable, run->self, end, &run->ended)
                         : scene_step(run->engine, run->model, run->scene, run->variable, run->self, end);
            run->steps += status == GIC_OK;
            run->most_work = work_of(run->self) - work > run->most_work ? work_of(run->self) - work : run->most_work;
            if (run->watch && status == GIC_OK)
                step_watch_step(run->watch, run->model, run->self, run->copy);
            if (run->bounces && status == GIC_OK)
                bounce_watch_step(run->bounces, run->model, run->self);
            --left;
        }
        run->integrating += clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
        look_around(run);
    }
    return status;
}

/* Returns the status that ended the run; *failed: the instance that has it. */
static int run_all(Run *run, const gic_head **failed)
{
    record(run, run->self);
    for (int64_t k = 0; k < run->scene->outputs && !run->ended; ++k) {
        int status = advance(run, (double)(k + 1) * run->scene->output_step);
        *failed = run->self;
        if (status != GIC_OK || run->interrupted)
            return status;
        status = compute_outputs(run);
        *failed = run->copy;
        if (status != GIC_OK) {
            /* a step from there fails too; its status tells whether it was too long */
            const int next = run->variable ? status
                                           : scene_step(run->engine, run->model, run->scene, NULL, run->self,
                                                        (double)(k + 2) * run->scene->output_step);
            if (next != GIC_ERROR_UNSTABLE)
                return status;
            *failed = run->self;
            return next;
        }
        record(run, run->self);
    }
    return GIC_OK;
}

/* Text about the end of the run, and the remedy. The last good state is recorded if it is not at an output time, and
 * stays in the copy; *end: its time. */
static const char *explain(Run *run, const Model *mechanism, const gic_head *failed, int status, const char **remedy,
                           double *end)
{
    const gic_model *code = run->engine->code;
    const char *said = instance_status(run->pool, code, failed, status);
    const int subset = failed->subset;
    const double last = gic_time(failed);
    *remedy = run_remedy(status);
    *end = last;
    if (last_good_outputs(run->good, run->model, run->self, failed, run->copy)) {
        *end = gic_time(run->copy);
        if (*end < last)
            said = instance_status(run->pool, code, run->copy, status);
        if (*end > run->recorded)
            record(run, run->copy);
    }
    const DeadCentre found = run_dead_centre(run->pool, mechanism, run->model, run->copy, status, subset);
    if (!found.finding)
        return said;
    *remedy = pool_print(run->pool, "%s; the last row of the results is the last state", found.remedy);
    return found.finding;
}

void simulate(Pool *pool, const Engine *engine, const Model *mechanism, const Scene *whole, Animation *animation,
              const Request *request)
{
    const Scene *scene = scene_narrow(pool, whole, mechanism, engine);
    const gic_model *model = engine->code;
    const Place at = {scene->source, 0, 0};
    StepTheory *theory = step_theory_new(pool, mechanism);
    Run run = {.pool = pool,
               .engine = engine,
               .model = model,
               .scene = scene,
               .request = request,
               .animation = animation,
               .watch = scene->page ? NULL /* it would look at steps of the engine */
                                    : step_watch_new(pool, theory, whole, engine, false)};
    run.self = instance_new(pool, engine);
    run.copy = instance_new(pool, engine);
    int status = scene_start(engine, scene, run.self);
    if (status != GIC_OK)
        diag_fail(at, NULL, "the model can't be set up: %s", instance_status(pool, model, run.self, status));
    if (scene->method >= METHOD_ADAMS && !(run.variable = variable_open(model, scene->method, scene->tolerance)))
        diag_fail(program_place(), NULL, "no memory for the integrator");
    status = compute_outputs(&run);
    if (status != GIC_OK)
        diag_fail(at, run_remedy_at_start(status), "the run can't start: %s",
                  instance_status(pool, model, run.copy, status));
    run.good = last_good_new(pool, engine);
    run.bounces = scene->page ? NULL : bounce_watch_new(pool, theory, whole, engine);
    run.ranges = range_watch_new(pool, mechanism);
    run.outcome = outcome_new();
    run.events = scene_events_new(pool, engine, scene, run.self, &status);
    if (status != GIC_OK)
        diag_fail(at, run_remedy_at_start(status), "the run can't start: %s",
                  instance_status(pool, model, run.self, status));
    prepare_plot(&run);
    interrupt_hold(); /* else the temporary file of the results would remain */
    if (request->results) {
        run.csv = csv_open(pool, request->results);
        write_header(&run);
    }

    const double before = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    run.looked = clock_seconds(CLOCK_MONOTONIC);
    const gic_head *failed = run.self;
    if (run.bounces)
        bounce_watch_step(run.bounces, model, run.self);
    status = run_all(&run, &failed);
    double last = 0; /* the time of the last good state */
    const char *remedy = NULL,
               *end = status != GIC_OK ? explain(&run, mechanism, failed, status, &remedy, &last) : NULL;
    engine_rest(engine);
    clear_progress(&run);
    if (request->results)
        csv_close(&run.csv);
    if (run.interrupted)
        diag_note(pool_print(pool, "%s: interrupted at t = %.6g s; results up to there are kept\n",
                             program_place().source->path, gic_time(run.self)));
    interrupt_release();
    variable_close(run.variable);
    if (!request->quiet)
        summary(&run, clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before);
    if (animation)
        animation_write(animation, request->page);
    if (request->picture)
        plot_write(pool, &run.plot, request->picture);
    if (end)
        diag_fail(at, remedy, "the run ends at t = %.6g s: %s", last, end);
    const char *finding = run.watch && !run.interrupted ? step_watch_judge(run.watch, &remedy) : NULL;
    if (!finding && run.bounces && !run.interrupted)
        finding = bounce_watch_judge(run.bounces, &remedy);
    if (finding)
        diag_fail(at, remedy, "%s", finding);
}
