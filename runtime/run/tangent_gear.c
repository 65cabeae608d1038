/* SPDX-License-Identifier: MIT
 * Changes of gear in a run with derivatives, as gic_runtime.c makes them: the cubic through both ends of the step is
 * searched for the first share s of it at which the gear changes, and the state there goes on in the new gear through
 * the rest of the step, by RK4, or in parts, from the third one by AB3. A number g that decides on it, the guard, is 0
 * there, so that s changes by -dg / (dg/ds), where dg is the change at a share that stays, and with it the state at the
 * change and how long the rest is. Where an input that jumps changes the gear, or it changes at the start of a step, s
 * stays. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/powertrain_numbers.h"
#include "run/tangent_private.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

Cubic tangent_between(double share, double step)
{
    const double rest = 1 - share, blend = share * share * (3 - 2 * share);
    return (Cubic){1 - blend, blend, step * share * rest * rest, -step * share * share * rest};
}

Cubic tangent_between_slope(double share, double step)
{
    const double rest = 1 - share, blend = 6 * share * rest;
    return (Cubic){-blend, blend, step * rest * (1 - 3 * share), -step * share * (2 - 3 * share)};
}

int tangent_parts(const TangentRun *run, bool dual)
{
    return dual ? run->scene->ratio : 1;
}

/* Both ends of a step of both. */
typedef struct Ends {
    double start, step; /* s */
    const double *from, *rate;
    double *to, *rate_there;
} Ends;

/* Part k of the state between. */
static void between(const TangentRun *run, const Ends *ends, const Cubic *by, int k, double *own)
{
    const double *const row[] = {ends->from, ends->to, ends->rate, ends->rate_there};
    const double weight[] = {by->from, by->to, by->rate, by->rate_there};
    double part[run->states + 1];
    memset(own, 0, (size_t)run->states * sizeof *own);
    for (int i = 0; i < 4; ++i) {
        tangent_take(run, row[i], k, part);
        for (int j = 0; j < run->states; ++j)
            own[j] += weight[i] * part[j];
    }
}

static int32_t *gears_of(const TangentRun *run, Instance *self)
{
    return (int32_t *)(void *)((char *)self + run->code->discrete_offset) + run->code->free_base;
}

double *tangent_age(const TangentRun *run, double *state)
{
    return state + run->code->slow_count + run->model->powertrain->fast + POWERTRAIN_AGE;
}

/* Put the copy at a share of the step: 1 if its gears change there, 0, or a status. */
static int changes_at(const TangentRun *run, const Ends *ends, double share)
{
    Instance *copy = run->copy;
    double *state = tape_array(copy, run->code->state_offset);
    const Cubic by = tangent_between(share, ends->step);
    memcpy(copy, run->self, run->code->size);
    between(run, ends, &by, 0, state);
    copy->head.start_time = ends->start + share * ends->step;
    copy->head.steps = 0;
    scene_inputs((void *)(uintptr_t)run->scene, 0, copy->head.start_time, tape_array(copy, run->code->input_offset));
    const int status = run->code->settle(copy, state);
    return status == GIC_OK ? run->code->shift(copy) : status;
}

/* The first share at which gears change, where the copy is then. Returns a status. */
static int locate(const TangentRun *run, const Ends *ends, double *share)
{
    const int halvings = 45;
    double low = 0, high = 1;
    int found = changes_at(run, ends, low);
    if (found == 1)
        high = low;
    for (int i = 0; i < halvings && found >= 0 && low < high; ++i) {
        const double middle = (low + high) / 2;
        found = changes_at(run, ends, middle);
        *(found == 1 ? &high : &low) = middle;
    }
    *share = high;
    if (found >= 0)
        found = changes_at(run, ends, high);
    return found == 1 ? GIC_OK : found == 0 ? GIC_ERROR_EVENTS : found;
}

/* ---- the guard ---------------------------------------------------------------------------------------------- */

enum { MOST_GUARDS = 3 };

/* A number that is above 0 once the gear may change: weights of choice[], and of the time since the last change. */
typedef struct Guard {
    double *of_choice, of_age, value;
} Guard;

/* x - limit as gic_above() has it: sign * choice[i] above sign * choice[limit], or with limit -1 above `bound`. */
static void above(const Linear *linear, Guard *guard, int i, double sign, int limit, double bound)
{
    const double *choice = linear->choice[0], end = limit < 0 ? bound : sign * choice[limit];
    guard->of_choice[i] = sign;
    guard->value = sign * choice[i] - end - GIC_LIMIT_ROUNDING * (1 + fabs(end));
    if (limit >= 0)
        guard->of_choice[limit] = -sign * (1 + (end < 0 ? -1 : 1) * GIC_LIMIT_ROUNDING);
}

static void aged(Guard *guard, double age, double limit)
{
    guard->of_age = 1;
    guard->value = age - (1 - GIC_LIMIT_ROUNDING) * limit;
}

/* All that have to be above 0 for a change from one gear to another; linear->choice[0] is of that state. */
static int guards_of(const TangentRun *run, int32_t gear, int32_t next, double age, Guard guard[MOST_GUARDS])
{
    const Linear *linear = run->linear;
    const Powertrain *powertrain = run->model->powertrain;
    const int up = CHOICE_UP, down = up + powertrain->forward - 1, sign = (next > 0) - (next < 0);
    aged(&guard[0], age, powertrain->duration);
    if (sign != (gear > 0) - (gear < 0)) {
        above(linear, &guard[1], CHOICE_SELECTOR, sign ? sign : gear > 0 ? -1 : 1, -1, sign ? 0.5 : -0.5);
        return 2;
    }
    aged(&guard[1], age, powertrain->latency);
    if (next > gear)
        above(linear, &guard[2], CHOICE_TURBINE, 1, up + gear - 1, 0);
    else
        above(linear, &guard[2], CHOICE_TURBINE, -1, down + gear - 2, 0);
    return 3;
}

/* The change of a guard along linear->along. */
static int guard_slope(const TangentRun *run, const Guard *guard, double *slope)
{
    const Linear *linear = run->linear;
    const int status = linear_slope(linear, run->self, LINEAR_SHIFT, 0);
    *slope = guard->of_age * *tangent_age(run, linear->along.y);
    for (int i = 0; i < linear->choices; ++i)
        *slope += guard->of_choice[i] * linear->choice[1][i];
    return status;
}

/* Along the share. bend: how the state moves on. */
static void point_on(const TangentRun *run, const Ends *ends, const double *bend)
{
    const Direction *along = &run->linear->along;
    tangent_input_rates(run, gic_time(run->self), along->u);
    for (int i = 0; i < run->inputs; ++i)
        along->u[i] *= ends->step;
    memcpy(along->y, bend, (size_t)run->states * sizeof *bend);
    memset(along->port, 0, (size_t)run->code->port_count * sizeof *along->port);
    memset(along->p, 0, (size_t)run->code->parameter_count * sizeof *along->p);
    *along->time = ends->step;
}

/* The one of them that is just above 0, all 0: none is. slope: of it along the share. */
static int find_guard(const TangentRun *run, const Ends *ends, const int32_t gear[2], const double *bend, Guard *guard,
                      double *slope)
{
    const Linear *linear = run->linear;
    const double near = 1e-6; /* of the share: the search ends within 1e-13 */
    const int choices = linear->choices;
    double weights[MOST_GUARDS][choices + 1], least = near;
    Guard each[MOST_GUARDS];
    memset(weights, 0, sizeof weights);
    for (int i = 0; i < MOST_GUARDS; ++i)
        each[i] = (Guard){.of_choice = weights[i]};
    *slope = 0;
    point_on(run, ends, bend);
    int status = linear_slope(linear, run->self, LINEAR_SHIFT, 0); /* for choice[0] */
    const int count =
        guards_of(run, gear[0], gear[1], *tangent_age(run, tape_array(run->self, run->code->state_offset)), each);
    for (int i = 0; i < count && status == GIC_OK; ++i) {
        double own;
        status = guard_slope(run, &each[i], &own);
        if (!(own > 0 && fabs(each[i].value) / own < least))
            continue;
        least = fabs(each[i].value) / own;
        *slope = own;
        memcpy(guard->of_choice, each[i].of_choice, (size_t)choices * sizeof *guard->of_choice);
        guard->of_age = each[i].of_age;
    }
    return status;
}

/* ---- the change --------------------------------------------------------------------------------------------- */

/* What follows the dependent Euler parameter, in a change of the state. */
static void settle_change(const TangentRun *run, const double *state, double *change)
{
    int32_t dependent;
    double sum = 0;
    if (!run->code->free_base)
        return;
    memcpy(&dependent, (const char *)run->copy + run->code->discrete_offset, sizeof dependent);
    for (int i = 0; i < 4; ++i)
        sum += i == dependent ? 0 : state[3 + i] * change[3 + i];
    change[3 + dependent] = -sum / state[3 + dependent];
}

/* The changes of the state at the change of gear, and run->shift. */
static int change_parts(TangentRun *run, const Ends *ends, double share, const double *bend, const Guard *guard,
                        double slope)
{
    const Cubic by = tangent_between(share, ends->step);
    const double *state = tape_array(run->self, run->code->state_offset);
    double *both = tangent_array(run, run->descriptor.state_offset);
    int status = GIC_OK;
    for (int k = 0; k < run->carried && status == GIC_OK; ++k) {
        double change[run->states + 1], own = 0;
        between(run, ends, &by, 1 + k, change);
        settle_change(run, state, change);
        tangent_point(run, k);
        memcpy(run->linear->along.y, change, (size_t)run->states * sizeof *change);
        if (slope > 0)
            status = guard_slope(run, guard, &own);
        const double later = slope > 0 ? -own / slope : 0;
        run->shift[k] = later * ends->step;
        for (int i = 0; i < run->states; ++i)
            change[i] += later * bend[i];
        *tangent_age(run, change) = 0;
        tangent_put(run, change, 1 + k, both);
    }
    return status;
}

/* From the copy, which is right after the change, on: the rest of the step. */
static int finish(TangentRun *run, const Ends *ends, int parts)
{
    gic_head *head = &run->both->head;
    const gic_head kept = *head;
    int status = GIC_OK;
    memcpy(gears_of(run, run->self), gears_of(run, run->copy), 2 * sizeof(int32_t));
    tangent_put(run, tape_array(run->copy, run->code->state_offset), 0,
                tangent_array(run, run->descriptor.state_offset));
    run->rest =
        (Rest){.going = true, .start = gic_time(run->copy), .end = ends->start + ends->step, .late = run->shift};
    gic_restart(head, gic_time(run->copy));
    head->locate = 0; /* the step has been looked at */
    for (int k = 0; k < parts && status == GIC_OK; ++k)
        status = gic_step(&run->descriptor, run->both, (run->rest.end - run->rest.start) / parts, run->scene->method);
    run->rest.going = false;
    head->locate = kept.locate;
    head->start_time = kept.start_time;
    head->steps = kept.steps;
    head->step = kept.step;
    head->method = kept.method;
    head->ratio = kept.ratio;
    head->history = 0;
    head->input_function(head->user, head->lane, gic_time(head), tangent_array(run, run->descriptor.input_offset));
    return status;
}

/* The vehicle, right before the change, in the old gear. */
static int go_before(const TangentRun *run, const Ends *ends, double share)
{
    const double time = ends->start + share * ends->step;
    const Cubic by = tangent_between(share, ends->step);
    double *state = tape_array(run->self, run->code->state_offset);
    double *input = tangent_array(run, run->descriptor.input_offset);
    between(run, ends, &by, 0, state);
    run->both->head.input_function(run->both->head.user, 0, time, input);
    memcpy(tape_array(run->self, run->code->input_offset), input, (size_t)run->inputs * sizeof *input);
    run->self->head.start_time = time;
    run->self->head.steps = 0;
    int status = run->code->settle(run->self, state);
    tape_gather(run->self, state);
    if (status == GIC_OK)
        status = tape_engage(run->self);
    if (status == GIC_OK)
        tangent_note(run, TRAIL_SETTLED, 0, state + 3, run->code->free_base ? 4 : 0, state, 0);
    return status;
}

int tangent_shift(TangentRun *run, double start, bool dual, TrailStep *step)
{
    const int all = run->descriptor.slow_count + run->descriptor.fast_count, choices = run->linear->choices;
    const double now = gic_time(run->both);
    double to[all + 1], rate_there[all + 1], bend[run->states + choices + 2], weights[choices + 1];
    const Ends ends = {start,     run->both->head.step, run->from, tangent_array(run, run->descriptor.rate_offset), to,
                       rate_there};
    double slope, share;
    if (run->plain) /* conditions are searched in the gear of the step's start */
        return GIC_OK;
    memcpy(to, tangent_array(run, run->descriptor.state_offset), (size_t)all * sizeof *to);
    memset(rate_there, 0, sizeof rate_there);
    if (changes_at(run, &ends, 1) != 1)
        return GIC_OK;
    if (run->rest.going || run->remade) {
        run->happened.failed = run->remade ? "a change of gear in a step in which a contact begins or ends"
                                           : "a change of gear before a condition becomes true in the same step";
        return GIC_ERROR_EVENTS;
    }
    int status = run->descriptor.rhs(run->both, now, to, rate_there);
    if (status == GIC_OK)
        status = locate(run, &ends, &share);
    if (status == GIC_OK && share == 1) {
        run->shifted = true;
        return GIC_ERROR_EVENTS;
    }
    if (status == GIC_OK)
        status = go_before(run, &ends, share);
    if (status != GIC_OK)
        return status;
    const Cubic by = tangent_between_slope(share, ends.step);
    const int32_t gear[] = {gears_of(run, run->self)[0], gears_of(run, run->copy)[0]};
    Guard guard = {.of_choice = weights};
    memset(weights, 0, sizeof weights);
    between(run, &ends, &by, 0, bend);
    settle_change(run, tape_array(run->self, run->code->state_offset), bend);
    status = share > 0 ? find_guard(run, &ends, gear, bend, &guard, &slope) : GIC_OK;
    slope = share > 0 ? slope : 0;
    if (status == GIC_OK)
        status = change_parts(run, &ends, share, bend, &guard, slope);
    if (status != GIC_OK)
        return status;
    if (step) {
        step->share = share;
        memcpy(bend + run->states, weights, (size_t)choices * sizeof *bend);
        bend[run->states + choices] = guard.of_age;
        bend[run->states + choices + 1] = slope;
        tangent_note(run, TRAIL_SHIFT, gic_time(run->self), tape_array(run->self, run->code->state_offset), run->states,
                     bend, run->states + choices + 2);
    }
    status = finish(run, &ends, tangent_parts(run, dual));
    memcpy(to, tangent_array(run, run->descriptor.state_offset), (size_t)all * sizeof *to);
    if (status == GIC_OK && changes_at(run, &ends, 1) == 1) {
        run->shifted = true;
        return GIC_ERROR_EVENTS;
    }
    return status;
}
