/* SPDX-License-Identifier: MIT
 * Backwards through the steps of a run. The trail has every right-hand side with its state and inputs; each of them is
 * played once more and then backwards (linear_pull()). What stands between them are sums, whose way back is written out
 * here for AB3, RK4, knots of driven inputs and the dependent Euler parameter. */
#include "run/adjoint_run.h"
#include "run/adjoint_private.h"
#include "run/knot_cross.h"
#include "scene/profile.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

const double adjoint_most = 100e6;

/* True if a time is a multiple of the step, but for rounding. */
static bool is_whole(double time, double step)
{
    const double steps = time / step;
    return fabs(steps - round(steps)) < GIC_LIMIT_ROUNDING * (1 + steps);
}

/* Times in a step at which controllers do something; *within: some are not at its ends. */
static double instants_of(const Model *model, double step, bool *within)
{
    double instants = 0;
    *within = false;
    for (int c = 0; c < model->controllers; ++c) {
        const Controller *controller = &model->controller[c];
        instants += step / controller->period;
        *within = *within || !is_whole(controller->period, step) || !is_whole(controller->offset, step);
        for (int i = 0; i < controller->rules; ++i) {
            const ControlRule *rule = &controller->rule[i];
            instants += rule->effects < 0 ? 0 : step / controller->period;
            *within = *within || !is_whole(rule->late, step);
        }
    }
    return instants;
}

bool adjoint_fits(const Model *model, const Scene *scene)
{
    const int base = model->free_base ? BASE_STATES : 0, links = LINK_NUMBERS * model->wheels;
    const int numbers = model->inputs + model->fast_states + 2 * model->coordinates + base;
    const bool dual = scene->method == GIC_AB3 && scene->ratio > 1 && model->fast_states;
    const double around = 4 * (double)sizeof(double) + sizeof(TrailEvent), settled = sizeof(TrailEvent);
    const double rate = numbers * (double)sizeof(double) + around;
    const double fast = (model->inputs + model->fast_states + links) * (double)sizeof(double) + around;
    bool within;
    const double instants = instants_of(model, scene->step, &within), part = RK4_STAGES * rate + settled;
    const double looks = scene->driver ? fmin(1, scene->step / scene->driver->period) : 0;
    const double seen = rate + DRIVE_RESULTS * (DRIVE_SEEN + DRIVE_SUMS) * (double)sizeof(double) +
                        DRIVE_MOVEMENTS * (double)sizeof(Movement);
    const double between = looks * seen + instants * 2 * rate;
    const double whole = dual ? 2 * rate + settled + (scene->ratio - 1) * fast
                              : (scene->method == GIC_RK4 ? RK4_STAGES : 1) * rate + settled;
    const double step = between + (within ? fmax(whole, (instants + (dual ? scene->ratio : 1)) * part) : whole);
    return (step + 2 * (1 + instants) * sizeof(TrailStep)) * (double)(scene->outputs * scene->per_output) <=
           adjoint_most;
}

void inputs_back(Back *back, double time, const double *by, const Knot *knot)
{
    const TangentRun *run = back->run;
    if (run->scene->driver)
        drive_inputs_back(back, time, by, knot);
    begun_inputs_back(back, time, by);
    for (int k = 0; k < run->variables; ++k) {
        const RunVariable *v = &run->variable[k];
        double change[3], bent[3][3];
        if (v->kind != BY_INPUT || tangent_has_begun(run, v->index))
            continue;
        const int count = tangent_input(v, time, change);
        const double near = knot ? knot->step / 16 : 0;
        for (int i = 0; knot && i < 3; ++i)
            tangent_input(v, knot->time + (i - 1) * near, bent[i]);
        for (int i = 0; i < count; ++i) {
            if (knot)
                change[i] += knot->step / near * (bent[0][i] - 2 * bent[1][i] + bent[2][i]);
            back->derivative[k] += change[i] * by[v->index + i];
        }
    }
}

/* The vehicle as it was evaluated. */
static int go_to(const Back *back, const TrailEvent *event)
{
    const TangentRun *run = back->run;
    const gic_model *code = run->code;
    const bool fast = event->kind == TRAIL_FAST;
    const int first = fast ? code->slow_count : 0, states = run->states - first, links = fast ? code->link_count : 0;
    double e[4], *own = tape_array(run->self, code->state_offset);
    gic_head *head = &run->self->head;
    head->start_time = event->time;
    head->steps = 0;
    head->ahead = 0;
    memcpy(own + first, event->number, (size_t)states * sizeof *own);
    memcpy(run->linear->link[0], event->number + states, (size_t)links * sizeof *own);
    memcpy(tape_array(run->self, code->input_offset), event->number + states + event->between,
           (size_t)run->inputs * sizeof(double));
    tangent_go(run, event);
    if (code->shift && tape_engage(run->self) != GIC_OK)
        return GIC_ERROR_INPUT;
    return fast ? GIC_OK : tape_locate(run->self, event->time, own, e);
}

/* Derivatives by state, inputs and parameters have been found: whether they are numbers, and those of all but the
 * state. */
static int pulled(Back *back, const TrailEvent *event, int status, const Knot *knot)
{
    const TangentRun *run = back->run;
    const Direction *along = &run->linear->along;
    const int parameters = run->code->parameter_count;
    if (status == GIC_OK &&
        !(gic_finite(along->y, run->states) && gic_finite(along->u, run->inputs) && gic_finite(along->p, parameters)))
        status = GIC_ERROR_RESULT;
    if (status != GIC_OK)
        return status;
    for (int i = 0; i < parameters; ++i)
        back->parameter[i] += along->p[i];
    inputs_back(back, event->time, along->u, knot);
    return GIC_OK;
}

int outputs_back(Back *back, const TrailEvent *event, const double *by_output)
{
    const TangentRun *run = back->run;
    const Linear *linear = run->linear;
    const int outputs = run->code->output_count, status = go_to(back, event);
    if (status != GIC_OK)
        return status;
    memset(linear->drate, 0, (size_t)run->states * sizeof *by_output);
    memcpy(linear->drate + run->states, by_output, (size_t)outputs * sizeof *by_output);
    return pulled(back, event, linear_pull(linear, run->self, LINEAR_RATE, outputs), NULL);
}

int press_back(Back *back, const TrailEvent *event, int contact, double weight)
{
    const TangentRun *run = back->run;
    const Linear *linear = run->linear;
    const int status = go_to(back, event);
    if (status != GIC_OK)
        return status;
    memset(linear->drate, 0, (size_t)(run->states + run->code->contact_count) * sizeof weight);
    linear->drate[run->states + contact] = weight;
    return pulled(back, event, linear_pull(linear, run->self, LINEAR_PRESS, 0), NULL);
}

int event_back(Back *back, const TrailEvent *event, double weight, const Knot *knot)
{
    static const LinearPart part[] = {
        [TRAIL_RATE] = LINEAR_RATE, [TRAIL_LINKS] = LINEAR_LINKS, [TRAIL_FAST] = LINEAR_FAST};
    const TangentRun *run = back->run;
    const Linear *linear = run->linear;
    const int outputs = weight != 0;
    int status = go_to(back, event);
    if (status != GIC_OK)
        return status;
    linear->drate[run->states] = weight;
    status = linear_pull(linear, run->self, part[event->kind], outputs);
    if (status == GIC_OK && event->kind == TRAIL_RATE && !gic_finite(linear->rate, run->states + outputs))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK && outputs)
        back->value += weight * linear->rate[run->states];
    return pulled(back, event, status, knot);
}

void adjoint_add(int count, double factor, const double *from, double *to)
{
    for (int i = 0; i < count; ++i)
        to[i] += factor * from[i];
}

void adjoint_set(int count, double factor, const double *from, double *to)
{
    for (int i = 0; i < count; ++i)
        to[i] = factor * from[i];
}

/* By the time at which was evaluated what has just been pulled. */
static double by_time_of(const TangentRun *run, double time)
{
    const Direction *along = &run->linear->along;
    double rate[run->inputs + 1], by_time = *along->time;
    tangent_input_rates(run, time, rate);
    for (int i = 0; i < run->inputs; ++i)
        by_time += along->u[i] * rate[i];
    return by_time;
}

void clock_back(Back *back, int clock, double time)
{
    if (clock >= 0)
        back->clock[clock] += by_time_of(back->run, time);
}

/* In a piece whose ends move: by their times. */
static void late_back(Back *back, double time, const double *by_rate)
{
    const TangentRun *run = back->run;
    const Rest *rest = &back->rest;
    const double length = rest->end - rest->start, share = (time - rest->start) / length;
    const double by_time = by_time_of(run, time);
    double by_length = 0;
    for (int i = 0; i < run->states; ++i)
        by_length += by_rate[i] * run->linear->rate[i] / length;
    if (rest->by_late)
        *rest->by_late += (1 - share) * by_time - by_length;
    if (rest->by_later)
        *rest->by_later += share * by_time + by_length;
}

int rate_back(Back *back, const TrailEvent *call, const double *by_rate, double weight, const Knot *knot)
{
    memcpy(back->run->linear->drate, by_rate, (size_t)back->run->states * sizeof *by_rate);
    const int status = event_back(back, call, weight, knot);
    if (status == GIC_OK && back->rest.going)
        late_back(back, call->time, by_rate);
    return status;
}

void settle_back(Back *back, const TrailEvent *settled)
{
    const int dependent = settled->dependent;
    if (!back->run->code->free_base)
        return;
    double *by = back->state + 3;
    for (int i = 0; i < 4; ++i)
        if (i != dependent)
            by[i] -= settled->number[i] / settled->number[dependent] * by[dependent];
    by[dependent] = 0;
}

/* A knot, by three events: the rates with straight and with bent inputs, and the state settled. */
static int knot_back(Back *back, int event, const Knot *knot, double start)
{
    const TangentRun *run = back->run;
    const int slow = run->code->slow_count, ratio = tangent_dual(run) ? run->scene->ratio : 1;
    const TrailEvent *straight = trail_event(run->trail, event), *bent = trail_event(run->trail, event + 1);
    const double share = (knot->time - start) / (straight->time - start), part = share * ratio - floor(share * ratio);
    const double of_slow = knot->step * knot_missing(run->scene->method, share);
    const double of_fast = knot->step * knot_missing(run->scene->method, part) / (ratio * ratio);
    settle_back(back, trail_event(run->trail, event + 2));
    adjoint_set(slow, of_slow, back->state, back->sum);
    adjoint_set(run->states - slow, of_fast, back->state + slow, back->sum + slow);
    int status = rate_back(back, bent, back->sum, 0, knot);
    if (status != GIC_OK)
        return status;
    adjoint_add(run->states, 1, run->linear->along.y, back->state);
    adjoint_set(run->states, -1, back->sum, back->sum);
    status = rate_back(back, straight, back->sum, 0, NULL);
    adjoint_add(run->states, 1, run->linear->along.y, back->state);
    return status;
}

/* y' = y + h / 12 (23 f - 16 f1 + 5 f2) */
static int ab3_back(Back *back, int event, double h, double weight)
{
    const int n = back->run->states;
    adjoint_add(n, h * 23 / 12, back->state, back->rate[0]);
    adjoint_add(n, -h * 16 / 12, back->state, back->rate[1]);
    adjoint_add(n, h * 5 / 12, back->state, back->rate[2]);
    const int status = rate_back(back, trail_event(back->run->trail, event), back->rate[0], weight, NULL);
    adjoint_add(n, 1, back->run->linear->along.y, back->state);
    return status;
}

/* y' = y + h / 6 (k1 + 2 k2 + 2 k3 + k4), each k at y + a share of the one before */
int rk4_back(Back *back, int event, double h, const double *by_rate, double weight)
{
    const int n = back->run->states;
    const Trail *trail = back->run->trail;
    const double *by = back->run->linear->along.y, part[RK4_STAGES] = {h / 6, h / 3, h / 3, h / 6},
                 reach[RK4_STAGES] = {h / 2, h / 2, h, 0};
    double *stage = back->stage[0], *total = back->stage[1];
    memset(total, 0, (size_t)n * sizeof *total);
    for (int k = RK4_STAGES - 1; k >= 0; --k) {
        adjoint_set(n, part[k], back->state, stage);
        if (k < RK4_STAGES - 1)
            adjoint_add(n, reach[k], back->stage[2], stage);
        if (k == 0)
            adjoint_add(n, 1, by_rate, stage);
        const int status = rate_back(back, trail_event(trail, event + k), stage, k == 0 ? weight : 0, NULL);
        if (status != GIC_OK)
            return status;
        memcpy(back->stage[2], by, (size_t)n * sizeof *by);
        adjoint_add(n, 1, by, total);
    }
    adjoint_add(n, 1, total, back->state);
    return GIC_OK;
}

/* One rate for the whole state. */
static int single_back(Back *back, const TrailStep *step, double weight)
{
    const TangentRun *run = back->run;
    const double h = step->length;
    const int calls = step->gear - step->first - 1;
    adjoint_add(run->states, 1, back->start_rate, back->rate[0]);
    settle_back(back, trail_event(run->trail, step->first + calls));
    const int status =
        calls == 1 ? ab3_back(back, step->first, h, weight) : rk4_back(back, step->first, h, back->rate[0], weight);
    double *done = back->rate[0];
    back->rate[0] = back->rate[1];
    back->rate[1] = back->rate[2];
    back->rate[2] = done;
    memset(done, 0, (size_t)run->states * sizeof *done);
    return status;
}

int part_back(Back *back, const TrailStep *step, double weight)
{
    const TangentRun *run = back->run;
    const int knots = (step->end - step->knots) / 3;
    int status = GIC_OK;
    double knot[knots + 1];
    for (int k = 0; k < knots; ++k)
        knot[k] = scene_next_knot(run->scene, k ? knot[k - 1] : step->start);
    for (int k = knots - 1; k >= 0 && status == GIC_OK; --k)
        status = knot_back(back, step->knots + 3 * k, &(Knot){knot[k], run->scene->step}, step->start);
    memset(back->from, 0, (size_t)run->states * sizeof *back->from);
    memset(back->start_rate, 0, (size_t)run->states * sizeof *back->start_rate);
    if (status == GIC_OK && step->knots > step->gear)
        status = gear_back(back, step);
    back->rest = (Rest){.going = step->late >= 0 || step->later >= 0,
                        .start = step->piece_start,
                        .end = step->piece_end,
                        .by_late = step->late < 0 ? NULL : &back->clock[step->late],
                        .by_later = step->later < 0 ? NULL : &back->clock[step->later]};
    if (status == GIC_OK)
        status = (step->dual ? dual_back : single_back)(back, step, weight);
    back->rest.going = false;
    adjoint_add(run->states, 1, back->from, back->state);
    return status;
}

/* Back through step *i of the trail, or the piece that it ends, whose first one is *i then. */
static int step_back(Back *back, int64_t *i, AdjointWeight *weigh, const void *context)
{
    const TangentRun *run = back->run;
    const TrailStep *last = trail_step(run->trail, *i);
    const int64_t at = *i;
    *i = last->guard >= 0 ? last->piece : at;
    const TrailStep *step = trail_step(run->trail, *i);
    const double weight = step->number < 0 ? 0 : weigh(context, step->number), own = step->sample < 0 ? weight : 0;
    int status = last->guard >= 0            ? located_back(back, at, own)
                 : last->gear == last->first ? GIC_OK
                                             : part_back(back, last, own);
    if (status == GIC_OK)
        happenings_back(back, step);
    if (status == GIC_OK && step->sample >= 0)
        status = sample_back(back, step->sample, weight);
    if (step->look >= 0)
        drive_look_back(back, trail_event(run->trail, step->look));
    return status;
}

static Back back_new(TangentRun *run)
{
    const size_t state = ((size_t)run->states + 1) * sizeof(double);
    Back back = {.run = run,
                 .state = pool_alloc(run->pool, state),
                 .sum = pool_alloc(run->pool, state),
                 .from = pool_alloc(run->pool, state),
                 .start_rate = pool_alloc(run->pool, state),
                 .all_sums = run->variables + run->code->parameter_count + run->happened.clocks + run->scene->profiles};
    back.sums = pool_alloc(run->pool, ((size_t)back.all_sums + 1) * sizeof(double));
    back.derivative = back.sums;
    back.parameter = back.derivative + run->variables;
    back.clock = back.parameter + run->code->parameter_count;
    back.present = back.clock + run->happened.clocks;
    const int fast_steps = run->scene->ratio;
    back.moment = pool_alloc(run->pool, ((size_t)fast_steps + 2) * state);
    for (int i = 0; i < 4; ++i)
        back.link[i] = pool_alloc(run->pool, ((size_t)run->code->link_count + 1) * sizeof(double));
    for (int i = 0; i < 3; ++i) {
        back.rate[i] = pool_alloc(run->pool, state);
        back.stage[i] = pool_alloc(run->pool, state);
    }
    return back;
}

int adjoint_find(TangentRun *run, AdjointWeight *weight, const void *context, double by_end, double *value,
                 double *derivative)
{
    Back back = back_new(run);
    const int64_t steps = trail_steps(run->trail), all = run->steps;
    double last[run->states + run->inputs];
    tangent_state(run, last);
    TrailEvent end = {.time = tangent_time(run), .number = last, .kind = TRAIL_RATE}; /* nothing between */
    tangent_discrete(run, &end);
    int status = GIC_OK;
    if (weight(context, all) != 0) {
        status = rate_back(&back, &end, back.sum, weight(context, all), NULL);
        memcpy(back.state, run->linear->along.y, (size_t)run->states * sizeof *back.state);
        clock_back(&back, run->happened.ended ? run->happened.end : -1, end.time);
    }
    if (run->happened.ended && run->happened.end >= 0)
        back.clock[run->happened.end] += by_end;
    for (int64_t i = steps - 1; i >= 0 && status == GIC_OK; --i)
        status = step_back(&back, &i, weight, context);
    if (status != GIC_OK)
        return status;
    settle_back(&back, trail_event(run->trail, 0));
    *value = back.value;
    for (int k = 0; k < run->variables; ++k) {
        const RunVariable *v = &run->variable[k];
        derivative[k] = v->kind == BY_PARAMETER ? back.parameter[v->index] : back.derivative[k];
        for (int i = 0; i < run->states; ++i)
            derivative[k] += back.state[i] * run->begins[k * run->states + i];
    }
    return GIC_OK;
}
