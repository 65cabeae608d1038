/* SPDX-License-Identifier: MIT
 * A run with derivatives, forwards: the state y and its derivatives dy by all variables are one state, whose
 * rate is that of y and its derivatives along each dy. The integrators of the runtime core make steps of it as of any
 * other. Since steps are sums of rates, what comes out is the derivative of the steps themselves, not that of the
 * motion that they approximate.
 *
 * Derivatives are those of the branches that the run takes. Gears that change: tangent_gear.c; controllers between
 * steps: tangent_sample.c; drivers: tangent_drive.c. */
#include "run/tangent_private.h"
#include "base/message.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "run/condition_output.h"
#include "run/engines.h"
#include "run/formula_blame.h"
#include "run/knot.h"
#include "run/start_change.h"
#include "scene/action.h"
#include "scene/profile.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

double *tangent_array(const TangentRun *run, size_t offset)
{
    return (double *)(void *)((char *)run->both + offset);
}

/* ---- variables ------------------------------------------------------------------------------------------- */

static bool is_wanted(const RunVariable *v, const char *const *wanted, int count)
{
    static const char *const kind[] = {[BY_INITIAL] = "initial", [BY_PARAMETER] = "parameter", [BY_INPUT] = "input"};
    for (int i = 0; i < count; ++i)
        if (!strcmp(wanted[i], v->name) || !strcmp(wanted[i], kind[v->kind]))
            return true;
    return count == 0;
}

static void add(TangentRun *run, RunVariable variable, const char *const *wanted, int count)
{
    if (is_wanted(&variable, wanted, count))
        *POOL_PUSH(run->pool, run->variable, run->variables) = variable;
}

/* A unit of number k of a profile: values enter linearly. NULL: there is no such number. */
static const Profile *unit_of(Pool *pool, const Profile *profile, int k)
{
    Profile *unit = pool_alloc(pool, sizeof *unit);
    *unit = *profile;
    if (profile->form == PROFILE_SINE || profile->form == PROFILE_CHIRP) {
        unit->amplitude = k == 0;
        unit->offset = k == 1;
        return k < 2 ? unit : NULL;
    }
    if (profile->form != PROFILE_KNOTS || k >= profile->count)
        return NULL;
    unit->value = pool_alloc(pool, (size_t)profile->count * sizeof(double));
    memset(unit->value, 0, (size_t)profile->count * sizeof(double));
    unit->value[k] = 1;
    return unit;
}

static double number_of(const Profile *profile, int k)
{
    return profile->form == PROFILE_KNOTS ? profile->value[k] : k ? profile->offset : profile->amplitude;
}

/* Numbers of an input: those of its profile, or its constant value. */
static void add_input(TangentRun *run, int input, const char *const *wanted, int count)
{
    static const char *const wave[] = {"amplitude", "offset"};
    const gic_signal *signal = &run->code->input[input];
    const Profile *profile = NULL;
    for (int i = 0; i < run->scene->profiles; ++i)
        profile = run->scene->profile[i].input == input ? &run->scene->profile[i] : profile;
    const bool knots = profile && profile->form == PROFILE_KNOTS;
    if (!profile || (knots && profile->count == 1)) {
        add(run,
            (RunVariable){.name = pool_print(run->pool, "input/%s", signal->name),
                          .unit = signal->unit,
                          .kind = BY_INPUT,
                          .index = input,
                          .value = tape_array(run->self, run->code->input_offset)[input]},
            wanted, count);
        return;
    }
    const Profile *unit;
    for (int k = 0; (unit = unit_of(run->pool, profile, k)); ++k)
        add(run,
            (RunVariable){.name = knots ? pool_print(run->pool, "input/%s[%d]", signal->name, k)
                                        : pool_print(run->pool, "input/%s.%s", signal->name, wave[k]),
                          .unit = signal->unit,
                          .kind = BY_INPUT,
                          .index = input,
                          .number = k,
                          .profile = unit,
                          .value = number_of(profile, k)},
            wanted, count);
}

/* Small motions at time 0, with values as linear models have them. */
static void add_initial(TangentRun *run, const double *f, const char *const *wanted, int count)
{
    const Linear *linear = run->linear;
    const int places = linear->places, base = run->code->free_base ? 6 : 0;
    const double *y = tape_array(run->self, run->code->state_offset);
    for (int i = 0; i < linear->count; ++i) {
        const bool rate = i >= places && i < 2 * places;
        const double value = i < base     ? 0
                             : i < places ? y[i + run->code->free_base]
                             : rate       ? f[i - places]
                                          : y[i + run->code->free_base];
        add(run,
            (RunVariable){.name = pool_print(run->pool, "initial/%s%s", linear->name[i], rate ? ".rate" : ""),
                          .unit = linear_unit(run->pool, linear, i),
                          .kind = BY_INITIAL,
                          .index = i,
                          .value = value},
            wanted, count);
    }
}

static void add_variables(TangentRun *run, const double *f, const char *const *wanted, int count)
{
    const gic_model *code = run->code;
    add_initial(run, f, wanted, count);
    for (int i = 0; i < code->parameter_count; ++i)
        add(run,
            (RunVariable){.name = pool_print(run->pool, "parameter/%s", code->parameter[i].name),
                          .unit = code->parameter[i].unit,
                          .kind = BY_PARAMETER,
                          .index = i,
                          .value = tape_array(run->self, code->parameter_offset)[i]},
            wanted, count);
    bool own[code->input_count + 1]; /* which the driver does not move */
    memset(own, true, sizeof own);
    if (run->scene->driver)
        driver_moves(run->scene->driver, own);
    for (int i = 0; i < code->input_count; ++i) {
        bool is_rate = !own[i];
        for (int k = 0; k < code->coordinate_count; ++k)
            is_rate = is_rate || (code->coordinate_input[k] >= 0 &&
                                  (i == code->coordinate_input[k] + 1 || i == code->coordinate_input[k] + 2));
        if (!is_rate)
            add_input(run, i, wanted, count);
    }
}

/* ---- the model of both ------------------------------------------------------------------------------------ */

int tangent_input(const RunVariable *v, double time, double change[3])
{
    const bool driven = v->profile && v->profile->driven;
    change[0] = 1;
    change[1] = change[2] = 0;
    if (v->profile)
        profile_at(v->profile, time, change);
    return driven ? 3 : 1;
}

/* The third derivative of a profile, by its second one, which is a polynomial of degree 3 between kinks: exact there.
 */
static double jerk_of(const Profile *profile, double time)
{
    const double apart = 1e-4, next = profile_next_kink(profile, time - 4 * apart);
    const double side = next > time ? -apart : apart; /* away from a kink, if one is near */
    double at[4][3];
    for (int i = 0; i < 4; ++i)
        profile_at(profile, time + i * side, at[i]);
    return (-11 * at[0][2] + 18 * at[1][2] - 9 * at[2][2] + 2 * at[3][2]) / (6 * side);
}

void tangent_profile_rates(const Profile *profile, double time, double rate[3])
{
    double at[3];
    profile_at(profile, time, at);
    rate[0] = at[1];
    rate[1] = at[2];
    rate[2] = profile->driven ? jerk_of(profile, time) : 0;
}

void tangent_input_rates(const TangentRun *run, double time, double *rate)
{
    memset(rate, 0, (size_t)run->inputs * sizeof *rate);
    for (int i = 0; i < run->scene->profiles; ++i) {
        const Profile *profile = &run->scene->profile[i];
        double at[3];
        tangent_profile_rates(profile, time, at);
        memcpy(rate + profile->input, at, (size_t)profile_orders(profile) * sizeof *rate);
    }
    if (!run->scene->driver)
        return;
    Movement *movement[DRIVE_MOVEMENTS];
    int input[DRIVE_MOVEMENTS];
    tangent_drive(run, movement, input);
    for (int m = 0; m < DRIVE_MOVEMENTS; ++m) {
        double at[4];
        movement_at(movement[m], time, at);
        if (input[m] >= 0)
            memcpy(rate + input[m], at + 1, (size_t)tangent_drive_orders(run, m) * sizeof *at);
    }
}

/* Inputs at a time, and how they change by each variable. A gic_input_function. */
static void inputs_of_both(void *user, int32_t lane, double time, double *input)
{
    const TangentRun *run = user;
    scene_inputs((void *)(uintptr_t)run->scene, lane, time, input);
    for (int k = 0; k < run->carried; ++k) {
        const RunVariable *v = &run->variable[k];
        double *change = input + run->inputs * (1 + k), at[3];
        memset(change, 0, (size_t)run->inputs * sizeof *change);
        if (run->scene->driver)
            tangent_drive_inputs(run, k, time, change);
        tangent_begun_inputs(run, k, time, change);
        if (v->kind != BY_INPUT || tangent_has_begun(run, v->index))
            continue;
        const int count = tangent_input(v, time, at);
        memcpy(change + v->index, at, (size_t)count * sizeof *at);
    }
}

/* The state of both has slow states, of the vehicle and by each variable, then fast ones. Part k of it, 0: of the
 * vehicle, to own[states] and back. */
void tangent_take(const TangentRun *run, const double *both, int k, double *own)
{
    const int slow = run->code->slow_count, fast = run->code->fast_count;
    memcpy(own, both + slow * k, (size_t)slow * sizeof *own);
    memcpy(own + slow, both + slow * (1 + run->carried) + fast * k, (size_t)fast * sizeof *own);
}

void tangent_put(const TangentRun *run, const double *own, int k, double *both)
{
    const int slow = run->code->slow_count, fast = run->code->fast_count;
    memcpy(both + slow * k, own, (size_t)slow * sizeof *own);
    memcpy(both + slow * (1 + run->carried) + fast * k, own + slow, (size_t)fast * sizeof *own);
}

void tangent_inputs_of(const TangentRun *run, double time)
{
    gic_head *head = &run->self->head;
    head->start_time = time;
    head->steps = 0;
    head->ahead = run->both->head.ahead;
    memcpy(tape_array(run->self, run->code->input_offset), tangent_array(run, run->descriptor.input_offset),
           (size_t)run->inputs * sizeof(double));
}

/* linear->along by variable k, but for the state. */
void tangent_point(const TangentRun *run, int k)
{
    const Direction *along = &run->linear->along;
    const RunVariable *v = &run->variable[k];
    memset(along->y, 0, (size_t)run->states * sizeof *along->y);
    memcpy(along->u, tangent_array(run, run->descriptor.input_offset) + run->inputs * (1 + k),
           (size_t)run->inputs * sizeof *along->u);
    memset(along->port, 0, (size_t)run->code->port_count * sizeof *along->port);
    memset(along->p, 0, (size_t)run->code->parameter_count * sizeof *along->p);
    *along->time = 0;
    if (v->kind == BY_PARAMETER)
        along->p[v->index] = 1;
}

void tangent_go(const TangentRun *run, const TrailEvent *event)
{
    int32_t *discrete = (int32_t *)(void *)((char *)run->self + run->code->discrete_offset);
    const int base = run->code->free_base;
    if (base)
        discrete[0] = event->dependent;
    for (int i = 0; i < 2 && base + i < run->code->discrete_count; ++i)
        discrete[base + i] = event->gear[i];
}

/* Where the ends of a piece come later, so does a time within it. */
static void point_later(const TangentRun *run, int k, double time)
{
    const Rest *rest = &run->rest;
    const double share = (time - rest->start) / (rest->end - rest->start);
    const double late = (1 - share) * (rest->late ? rest->late[k] : 0) + share * (rest->later ? rest->later[k] : 0);
    double rate[run->inputs + 1];
    tangent_input_rates(run, time, rate);
    for (int i = 0; i < run->inputs; ++i)
        run->linear->along.u[i] += late * rate[i];
    *run->linear->along.time = late;
}

int tangent_slope(const TangentRun *run, const double *state, int k, int outputs)
{
    tangent_point(run, k);
    tangent_take(run, state, 1 + k, run->linear->along.y);
    if (run->rest.going)
        point_later(run, k, gic_time(run->self));
    const int status = linear_slope(run->linear, run->self, LINEAR_RATE, outputs);
    return status != GIC_OK || gic_finite(run->linear->drate, run->states + outputs) ? status : GIC_ERROR_RESULT;
}

static int32_t dependent_of(const TangentRun *run)
{
    int32_t dependent;
    memcpy(&dependent, (const char *)run->self + run->code->discrete_offset, sizeof dependent);
    return dependent;
}

void tangent_discrete(const TangentRun *run, TrailEvent *event)
{
    const int32_t *discrete = (const int32_t *)(const void *)((const char *)run->self + run->code->discrete_offset);
    const int base = run->code->free_base;
    event->dependent = base ? discrete[0] : 0;
    for (int i = 0; i < 2 && base + i < run->code->discrete_count; ++i)
        event->gear[i] = discrete[base + i];
}

/* An event of the trail: up to two arrays of numbers, and the inputs. */
void tangent_note(const TangentRun *run, TrailKind kind, double time, const double *first, int firsts,
                  const double *second, int seconds)
{
    if (!run->trail || run->plain)
        return;
    const int inputs = kind == TRAIL_SETTLED ? 0 : run->inputs;
    TrailEvent *event = trail_add(run->trail, firsts + seconds + inputs);
    double *number = event->number;
    *event = (TrailEvent){.time = time, .number = number, .between = seconds, .kind = kind};
    tangent_discrete(run, event);
    memcpy(number, first, (size_t)firsts * sizeof *number);
    memcpy(number + firsts, second, (size_t)seconds * sizeof *number);
    memcpy(number + firsts + seconds, tangent_array(run, run->descriptor.input_offset),
           (size_t)inputs * sizeof *number);
}

/* Variables whose derivatives are wanted now. */
static int carried_now(const TangentRun *run)
{
    return run->plain ? 0 : run->carried;
}

/* By which share of itself a piece is longer, by variable k. */
static double longer_by(const Rest *rest, int k)
{
    return ((rest->later ? rest->later[k] : 0) - (rest->late ? rest->late[k] : 0)) / (rest->end - rest->start);
}

static int rate_of_both(void *self, double time, const double *state, double *rate)
{
    const TangentRun *run = ((Both *)self)->run;
    double *own = tape_array(run->self, run->code->state_offset), found[run->states + 1];
    tangent_inputs_of(run, time);
    tangent_take(run, state, 0, own);
    tangent_contacts_see(run, time);
    tangent_note(run, TRAIL_RATE, time, own, run->states, own, 0);
    int status = run->code->rhs(run->self, time, own, found);
    if (run->plain)
        memset(rate, 0, (size_t)(run->descriptor.slow_count + run->descriptor.fast_count) * sizeof *rate);
    tangent_put(run, found, 0, rate);
    for (int k = 0; k < carried_now(run) && status == GIC_OK; ++k) {
        status = tangent_slope(run, state, k, 0);
        const double longer = longer_by(&run->rest, k);
        for (int i = 0; i < run->states && run->rest.going; ++i)
            run->linear->drate[i] += longer * found[i];
        tangent_put(run, run->linear->drate, 1 + k, rate);
    }
    return status;
}

/* Links of both are those of the vehicle, then those by each variable. */
static int links_of_both(void *self, double time, const double *slow, double *link)
{
    const TangentRun *run = ((Both *)self)->run;
    const gic_model *code = run->code;
    double *own = tape_array(run->self, code->state_offset);
    tangent_inputs_of(run, time);
    memcpy(own, slow, (size_t)code->slow_count * sizeof *own);
    tangent_note(run, TRAIL_LINKS, time, own, run->states, own, 0);
    int status = code->link(run->self, time, own, link);
    for (int k = 0; k < carried_now(run) && status == GIC_OK; ++k) {
        tangent_point(run, k);
        memcpy(run->linear->along.y, slow + code->slow_count * (1 + k), (size_t)code->slow_count * sizeof *slow);
        status = linear_slope(run->linear, run->self, LINEAR_LINKS, 0);
        memcpy(link + code->link_count * (1 + k), run->linear->link[1], (size_t)code->link_count * sizeof *link);
    }
    return status;
}

static int fast_of_both(void *self, double time, const double *link, const double *fast, double *rate)
{
    const TangentRun *run = ((Both *)self)->run;
    const gic_model *code = run->code;
    const Linear *linear = run->linear;
    const size_t links = (size_t)code->link_count * sizeof *link, states = (size_t)code->fast_count * sizeof *fast;
    double *own = tape_array(run->self, code->state_offset) + code->slow_count;
    tangent_inputs_of(run, time);
    memcpy(own, fast, states);
    tangent_note(run, TRAIL_FAST, time, fast, code->fast_count, link, code->link_count);
    int status = code->fast(run->self, time, link, fast, rate);
    for (int k = 0; k < carried_now(run) && status == GIC_OK; ++k) {
        tangent_point(run, k);
        memcpy(linear->along.y + code->slow_count, fast + code->fast_count * (1 + k), states);
        memcpy(linear->link[0], link, links);
        memcpy(linear->link[1], link + code->link_count * (1 + k), links);
        status = linear_slope(linear, run->self, LINEAR_FAST, 0);
        memcpy(rate + code->fast_count * (1 + k), linear->drate + code->slow_count, states);
    }
    return status != GIC_OK || gic_finite(rate, code->fast_count * (1 + run->carried)) ? status : GIC_ERROR_RESULT;
}

/* The dependent Euler parameter follows from the others, and so does its change. */
static int settle_both(void *self, double *state)
{
    const TangentRun *run = ((Both *)self)->run;
    double own[run->states + 1];
    tangent_take(run, state, 0, own);
    const int status = run->code->settle(run->self, own);
    if (status != GIC_OK)
        return status;
    tangent_put(run, own, 0, state);
    tangent_note(run, TRAIL_SETTLED, 0, own + 3, run->code->free_base ? 4 : 0, own, 0);
    const int dependent = run->code->free_base ? dependent_of(run) : 0;
    for (int k = 0; k < run->carried && run->code->free_base; ++k) {
        double *change = state + run->code->slow_count * (1 + k) + 3, sum = 0;
        for (int i = 0; i < 4; ++i)
            sum += i == dependent ? 0 : own[3 + i] * change[i];
        change[dependent] = -sum / own[3 + dependent];
    }
    return GIC_OK;
}

static void make_both(TangentRun *run)
{
    const gic_model *code = run->code;
    const int parts = 1 + run->carried;
    const size_t all = (size_t)(run->states * parts), inputs = (size_t)(run->inputs * parts);
    const size_t fast = (size_t)(code->fast_count * parts);
    size_t at = sizeof(Both);
    gic_model *model = &run->descriptor;
    *model = (gic_model){.abi_version = GIC_ABI_VERSION,
                         .real_size = sizeof(double),
                         .name = code->name,
                         .slow_count = code->slow_count * parts,
                         .fast_count = code->fast_count * parts,
                         .link_count = code->link_count * parts,
                         .input_count = (int32_t)inputs,
                         .rhs = rate_of_both,
                         .link = links_of_both,
                         .fast = fast_of_both,
                         .settle = settle_both};
    const struct {
        size_t *offset, count;
    } array[] = {{&model->state_offset, all},
                 {&model->rate_offset, all},
                 {&model->history_offset, GIC_HISTORY(all, fast)},
                 {&model->scratch_offset, GIC_SCRATCH(all, inputs)},
                 {&model->link_offset, 5 * (size_t)model->link_count},
                 {&model->input_offset, inputs},
                 {&model->discrete_offset, 1}};
    for (size_t i = 0; i < sizeof array / sizeof *array; ++i) {
        *array[i].offset = at;
        at += (array[i].count + 1) * sizeof(double);
    }
    tangent_contacts_make(run, model, &at);
    model->size = at;
    run->both = pool_alloc(run->pool, at);
    run->from = pool_alloc(run->pool, (all + 1) * sizeof(double));
    run->shift = pool_alloc(run->pool, (size_t)parts * sizeof(double));
    memset(run->both, 0, at);
    run->both->run = run;
    run->both->head.subset = run->both->head.condition = run->both->head.grown = -1;
    run->both->head.hold = -1;
    run->both->head.input_function = inputs_of_both;
    run->both->head.user = run;
}

/* ---- the run ------------------------------------------------------------------------------------------------ */

/* Refuse what steps alone do not make. */
static void check_scene(Pool *pool, const Model *model, const Scene *scene)
{
    const Place at = {scene->source, 0, 0};
    const struct {
        bool is;
        const char *what, *remedy;
    } refused[] = {
        {scene->method >= METHOD_ADAMS, "steps vary", "choose `integrator: rk4` or `ab3` and a `step`"},
        {scene_implicit(scene), "steps are implicit or exponential",
         "choose `integrator: rk4` or `ab3`, with a shorter `step`"},
        {scene->steady > 0, "fast states take longer steps where they are steady", "leave `steady` out"},
        {condition_count(scene) != condition_has(model), "conditions change the run", "leave `until` and `when` out"},
        {scene->rest, "the vehicle may sleep", "leave `sleep` out"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; ++i)
        if (refused[i].is)
            diag_fail(at, refused[i].remedy, "no gradient of a run in which %s",
                      pool_print(pool, "%s", refused[i].what));
}

/* Names that are no variables. */
static void check_names(const TangentRun *run, const char *const *wanted, int count)
{
    for (int i = 0; i < count; ++i) {
        bool found = false;
        for (int k = 0; k < run->variables; ++k)
            found = found || is_wanted(&run->variable[k], wanted + i, 1);
        if (!found)
            diag_fail_call(program_place(),
                           "there are initial/NAME, parameter/NAME and input/NAME, as --gradient lists them without "
                           "names, or `initial`, `parameter` and `input`",
                           "there is no '%s'", wanted[i]);
    }
}

void tangent_fail(const TangentRun *run, int status)
{
    if (run->happened.failed)
        diag_fail(run->happened.blamed ? run->happened.blamed->at : (Place){run->scene->source, 0, 0},
                  "another threshold or `step`, or take it out of the scene", "%s at t = %.6g s has no derivative",
                  run->happened.failed, tangent_time(run));
    if (run->shifted)
        diag_fail((Place){run->scene->source, 0, 0}, "other speeds of `up` and `down`, or another `step`",
                  "two changes of gear in the step to t = %.6g s, or one right at its end, have no derivatives",
                  tangent_time(run));
    Blame blame;
    if (status == GIC_ERROR_RESULT &&
        formula_blame(run->pool, run->model, run->solve, run->self, &run->linear->along, &blame))
        diag_fail(blame.at,
                  blame.has_value
                      ? "keep away from ends of roots and powers: sqrt(abs(x) + 1e-6) for sqrt(abs(x)), for one"
                      : "keep what is under a root or logarithm above 0, by max(x, 0.001) for one, and what "
                        "is divided by away from 0",
                  "%s has no finite %s at t = %.6g s", blame.what, blame.has_value ? "derivative" : "value",
                  gic_time(run->self));
    diag_fail((Place){run->scene->source, 0, 0}, "run the scene by itself: the message at its end says more",
              "the run with its derivatives ends at t = %.6g s: %s", tangent_time(run),
              instance_status(run->pool, run->code, &run->self->head, status));
}

/* Components of outputs but for those that controllers alone read, which come last. */
static int own_outputs(const Model *model)
{
    int own = 0;
    for (int i = 0, at = 0; i < model->outputs; ++i) {
        at += model->output[i].count;
        own = model->output[i].sampled ? own : at;
    }
    return own;
}

static TangentRun *open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const char *const *wanted,
                        int count, bool backwards)
{
    check_scene(pool, model, scene);
    TangentRun *run = pool_alloc(pool, sizeof *run);
    const Engine *engine = engine_open(pool, "tape", model, &(EngineOptions){.solve = solve, .quiet = true});
    *run = (TangentRun){.pool = pool,
                        .model = model,
                        .solve = solve,
                        .engine = engine,
                        .scene = scene,
                        .linear = linear_open(pool, engine),
                        .code = engine->code,
                        .self = (Instance *)(void *)instance_new(pool, engine),
                        .copy = (Instance *)(void *)instance_new(pool, engine),
                        .outputs = own_outputs(model) - 2 * condition_has(model),
                        .states = engine->code->slow_count + engine->code->fast_count,
                        .inputs = engine->code->input_count};
    double f[run->linear->count + 1];
    int status = scene_start(engine, scene, &run->self->head);
    run->self->head.input_function = NULL;
    if (status == GIC_OK)
        status = linear_start(run->linear, run->self, f);
    if (status != GIC_OK)
        tangent_fail(run, status);
    add_variables(run, f, wanted, count);
    check_names(run, wanted, count);
    run->carried = backwards ? 0 : run->variables;
    run->trail = backwards ? trail_new(pool) : NULL;
    run->live = pool_alloc(pool, (size_t)run->states + 1);
    run->drive = pool_alloc(pool, ((size_t)run->carried + 1) * sizeof *run->drive);
    run->begins = pool_alloc(pool, (size_t)(run->variables * run->states + 1) * sizeof *run->begins);
    make_both(run);
    tangent_events_open(run, condition_has(model));
    return run;
}

TangentRun *tangent_open(Pool *pool, const Model *model, const Scene *scene, Solve solve, const char *const *wanted,
                         int count)
{
    return open(pool, model, scene, solve, wanted, count, false);
}

TangentRun *tangent_open_backwards(Pool *pool, const Model *model, const Scene *scene, Solve solve,
                                   const char *const *wanted, int count)
{
    return open(pool, model, scene, solve, wanted, count, true);
}

int tangent_variables(const TangentRun *run, const RunVariable **variable)
{
    *variable = run->variable;
    return run->variables;
}

bool tangent_ended(const TangentRun *run, const double **late)
{
    *late = tangent_clock(run, run->happened.end);
    return run->happened.ended;
}

double tangent_time(const TangentRun *run)
{
    return run->both ? gic_time(run->both) : 0;
}

void tangent_rests(TangentRun *run, const Equilibrium *found)
{
    run->rests = found;
}

int tangent_begin(TangentRun *run, const Scene *scene)
{
    double *state = tangent_array(run, run->descriptor.state_offset);
    double *input = tangent_array(run, run->descriptor.input_offset);
    run->scene = scene;
    run->shifted = run->rest.going = run->plain = false;
    run->steps = 0;
    memset(run->live, 0, (size_t)run->states);
    memset(run->drive, 0, (size_t)run->carried * sizeof *run->drive);
    gic_restart(run->both, 0);
    if (run->trail)
        trail_begin(run->trail);
    memset(state, 0, (size_t)run->descriptor.slow_count * sizeof *state);
    int status = scene_start(run->engine, scene, &run->self->head);
    run->self->head.input_function = NULL;
    if (status != GIC_OK)
        return status;
    tangent_put(run, tape_array(run->self, run->code->state_offset), 0, state);
    status = start_changes(run, run->begins);
    if (status != GIC_OK)
        return status;
    for (int k = 0; k < run->carried; ++k)
        tangent_put(run, run->begins + k * run->states, 1 + k, state);
    status = settle_both(run->both, state);
    memcpy(input, tape_array(run->self, run->code->input_offset),
           (size_t)run->inputs * sizeof *input); /* profiles set those that they are of */
    inputs_of_both(run, 0, 0, input);
    tangent_contacts_begin(run);
    return status == GIC_OK ? tangent_events_begin(run) : status;
}

int tangent_look(TangentRun *run, double *value, double *slope)
{
    const double *state = tangent_array(run, run->descriptor.state_offset);
    tangent_inputs_of(run, gic_time(run->both));
    tangent_take(run, state, 0, tape_array(run->self, run->code->state_offset));
    int status = run->code->outputs(run->self);
    memcpy(value, tape_array(run->self, run->code->output_offset), (size_t)run->outputs * sizeof *value);
    if (run->happened.ended && run->happened.end >= 0) {
        const double *late = tangent_clock(run, run->happened.end), end = gic_time(run->both);
        run->rest = (Rest){.going = true, .start = end - 1, .end = end, .late = late, .later = late};
    }
    for (int k = 0; k < run->carried && status == GIC_OK; ++k) {
        status = tangent_slope(run, state, k, run->outputs);
        for (int i = 0; i < run->outputs; ++i)
            slope[i * run->variables + k] = run->linear->drate[run->states + i];
    }
    run->rest.going = false;
    return status;
}

void tangent_state(const TangentRun *run, double *own)
{
    tangent_take(run, tangent_array(run, run->descriptor.state_offset), 0, own);
    memcpy(own + run->states, tangent_array(run, run->descriptor.input_offset), (size_t)run->inputs * sizeof *own);
}

bool tangent_dual(const TangentRun *run)
{
    return run->scene->method == GIC_AB3 && run->scene->ratio > 1 && run->code->fast_count;
}

/* A step, or a part of one. next: of the trail, what was before it and whether a step of the run begins with it. */
static int advance(TangentRun *run, double h, int32_t method, bool dual, const TrailStep *next)
{
    gic_head *head = &run->both->head;
    const double start = gic_time(head);
    TrailStep *step = run->trail && !run->plain ? trail_add_step(run->trail) : NULL;
    if (step) {
        *step = *next;
        step->start = start;
        step->length = h;
        step->dual = dual;
        step->history = head->history;
        step->first = trail_events(run->trail);
    }
    memcpy(run->from, tangent_array(run, run->descriptor.state_offset),
           (size_t)(run->descriptor.slow_count + run->descriptor.fast_count) * sizeof *run->from);
    tangent_contacts_before(run, next);
    int status = dual ? gic_step_dual(&run->descriptor, run->both, h, run->scene->ratio)
                      : gic_step(&run->descriptor, run->both, h, method);
    if (status == GIC_OK)
        status = tangent_contacts_after(run, &run->remade);
    if (run->remade && step)
        step = trail_last(run->trail);
    else if (step)
        step->gear = trail_events(run->trail);
    if (status == GIC_OK && run->code->shift)
        status = tangent_shift(run, start, dual, step);
    if (step && !run->remade)
        step->knots = step->end = trail_events(run->trail);
    return status;
}

void tangent_set_inputs(TangentRun *run, double time)
{
    inputs_of_both(run, 0, time, tangent_array(run, run->descriptor.input_offset));
}

int tangent_parts_to(TangentRun *run, double time, int parts, TrailStep *next)
{
    const double length = time - gic_time(run->both);
    int status = GIC_OK;
    for (int i = 0; i < parts && status == GIC_OK; ++i) {
        TrailStep after = trail_part;
        after.piece_start = next->piece_start;
        after.piece_end = next->piece_end;
        after.late = next->late;
        after.later = next->later;
        after.piece = next->piece;
        status = advance(run, length / parts, GIC_RK4, false, next);
        *next = after;
    }
    *next = trail_part;
    gic_restart(run->both, time);
    tangent_set_inputs(run, time);
    return status;
}

/* To a time within a step, as the runtime core goes to samples. */
static int part_to(TangentRun *run, double time, TrailStep *next)
{
    const double length = time - gic_time(run->both),
                 fast_step = run->scene->step / tangent_parts(run, tangent_dual(run));
    return tangent_parts_to(run, time, 1 + (int)(0.999 * length / fast_step), next);
}

bool tangent_is_before(const TangentRun *run, double at, double end)
{
    double same = 0;
    for (int c = 0; c < run->code->controller_count; ++c)
        same = fmax(same, GIC_LIMIT_ROUNDING * run->code->controller[c].period);
    return at + same + 1e-15 * fabs(at) < end;
}

int tangent_step(TangentRun *run)
{
    gic_head *head = &run->both->head;
    const double h = run->scene->step;
    const bool dual = tangent_dual(run), goes_on = head->step == h && head->steps > 0;
    const double first = goes_on ? head->start_time : gic_time(head);
    const int64_t steps = (goes_on ? head->steps : 0) + 1;
    const double start = gic_time(head), end = first + (double)steps * h;
    const int history = head->history;
    const bool samples = run->code->controller_count > 0;
    TrailStep next = trail_part;
    next.number = run->steps++;
    next.look = tangent_drive_look(run);
    double at = INFINITY;
    int status = samples ? tangent_sample(run, &next.sample, &at) : GIC_OK, count = 0;
    head->parted = 0;
    tangent_events_before(run, &next);
    while (status == GIC_OK && tangent_is_before(run, at, end)) {
        head->parted = 1;
        status = count++ < GIC_SAMPLES ? part_to(run, at, &next) : GIC_ERROR_EVENTS;
        if (status == GIC_OK)
            status = tangent_sample(run, &next.sample, &at);
    }
    if (status != GIC_OK)
        return status;
    if (!head->parted) {
        status = advance(run, h, run->scene->method, dual, &next);
    } else {
        status = part_to(run, end, &next);
        head->start_time = first;
        head->steps = steps;
        head->step = h;
        head->method = run->scene->method;
        head->ratio = tangent_parts(run, dual);
    }
    const int noted = run->trail ? trail_events(run->trail) : 0;
    if (status == GIC_OK && !tangent_knots_move(run) && !run->remade)
        status = knots_cross(&run->descriptor, run->scene, head, start, history);
    if (run->trail)
        trail_last(run->trail)->end += trail_events(run->trail) - noted;
    return status == GIC_OK ? tangent_events_after(run) : status;
}
