/* SPDX-License-Identifier: MIT
 * Backwards through the steps of a run. The trail has every right-hand side with its state and inputs; each of them is
 * played once more and then backwards (linear_pull()). What stands between them are sums, whose way back is written out
 * here for AB3, RK4, knots of driven inputs and the dependent Euler parameter. */
#include "run/adjoint_run.h"
#include "run/knot_cross.h"
#include "run/tangent_private.h"
#include "scene/profile.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

const double adjoint_most = 100e6;

enum { RK4_STAGES = 4 };

/* On the way back; all numbers are derivatives of the run's number. */
typedef struct Back {
    TangentRun *run;
    double *state;          /* [states] by the state where it has come to */
    double *rate[3];        /* [states] by the rates at the starts of this step and the two before it */
    double *sum, *stage[3]; /* [states] work */
    double *derivative;     /* [variables] of inputs */
    double *parameter;      /* [parameters] */
    double value;           /* the number itself */
} Back;

bool adjoint_fits(const Model *model, const Scene *scene)
{
    const double calls = (scene->method == GIC_RK4 ? RK4_STAGES : 1) * (double)(scene->outputs * scene->per_output);
    int numbers = model->inputs + model->fast_states + 2 * model->coordinates + (model->free_base ? BASE_STATES : 0);
    return calls * ((numbers + 4) * (double)sizeof(double) + 2 * (double)sizeof(TrailEvent)) <= adjoint_most;
}

/* A knot of the inputs within a step. */
typedef struct Knot {
    double time, step;
} Knot;

/* By the numbers of profiles, from those by the inputs at a time; knot: the inputs were bent there; NULL: they were
 * not. */
static void inputs_back(Back *back, double time, const double *by, const Knot *knot)
{
    const TangentRun *run = back->run;
    for (int k = 0; k < run->variables; ++k) {
        const RunVariable *v = &run->variable[k];
        double change[3], bent[3][3];
        if (v->kind != BY_INPUT)
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

/* Back through a right-hand side with derivatives by its rate, and through the output of its state with a weight:
 * linear->along.y are those by the state, the others are added to their sums. */
static int rate_back(Back *back, const TrailEvent *call, const double *by_rate, double weight, const Knot *knot)
{
    const TangentRun *run = back->run;
    const Linear *linear = run->linear;
    const gic_model *code = run->code;
    const size_t state = (size_t)run->states * sizeof(double);
    const int outputs = weight != 0;
    double e[4], *own = tape_array(run->self, code->state_offset);
    gic_head *head = &run->self->head;
    head->start_time = call->time;
    head->steps = 0;
    head->ahead = 0;
    memcpy(own, call->number, state);
    memcpy(tape_array(run->self, code->input_offset), call->number + run->states, (size_t)run->inputs * sizeof(double));
    if (code->free_base)
        memcpy((char *)run->self + code->discrete_offset, &call->dependent, sizeof call->dependent);
    int status = tape_locate(run->self, call->time, own, e);
    if (status != GIC_OK)
        return status;
    memcpy(linear->drate, by_rate, state);
    linear->drate[run->states] = weight;
    status = linear_pull(linear, run->self, outputs);
    if (status == GIC_OK &&
        !(gic_finite(linear->rate, run->states + outputs) && gic_finite(linear->along.y, run->states) &&
          gic_finite(linear->along.u, run->inputs) && gic_finite(linear->along.p, code->parameter_count)))
        status = GIC_ERROR_RESULT;
    if (status != GIC_OK)
        return status;
    if (outputs)
        back->value += weight * linear->rate[run->states];
    for (int i = 0; i < code->parameter_count; ++i)
        back->parameter[i] += linear->along.p[i];
    inputs_back(back, call->time, linear->along.u, knot);
    return GIC_OK;
}

/* to += factor * from */
static void add(int count, double factor, const double *from, double *to)
{
    for (int i = 0; i < count; ++i)
        to[i] += factor * from[i];
}

/* to = factor * from */
static void set(int count, double factor, const double *from, double *to)
{
    for (int i = 0; i < count; ++i)
        to[i] = factor * from[i];
}

/* The dependent Euler parameter followed from the others. */
static void settle_back(Back *back, const TrailEvent *settled)
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
static int knot_back(Back *back, int event, const Knot *knot)
{
    const TangentRun *run = back->run;
    const TrailEvent *straight = trail_event(run->trail, event), *bent = trail_event(run->trail, event + 1);
    const double share = (knot->time - (straight->time - knot->step)) / knot->step;
    const double weight = knot->step * knot_missing(run->scene->method, share);
    settle_back(back, trail_event(run->trail, event + 2));
    set(run->states, weight, back->state, back->sum);
    int status = rate_back(back, bent, back->sum, 0, knot);
    if (status != GIC_OK)
        return status;
    add(run->states, 1, run->linear->along.y, back->state);
    set(run->states, -1, back->sum, back->sum);
    status = rate_back(back, straight, back->sum, 0, NULL);
    add(run->states, 1, run->linear->along.y, back->state);
    return status;
}

/* y' = y + h / 12 (23 f - 16 f1 + 5 f2) */
static int ab3_back(Back *back, int event, double h, double weight)
{
    const int n = back->run->states;
    add(n, h * 23 / 12, back->state, back->rate[0]);
    add(n, -h * 16 / 12, back->state, back->rate[1]);
    add(n, h * 5 / 12, back->state, back->rate[2]);
    return rate_back(back, trail_event(back->run->trail, event), back->rate[0], weight, NULL);
}

/* y' = y + h / 6 (k1 + 2 k2 + 2 k3 + k4), each k at y + a share of the one before */
static int rk4_back(Back *back, int event, double h, double weight)
{
    const int n = back->run->states;
    const Trail *trail = back->run->trail;
    const double *by = back->run->linear->along.y, part[RK4_STAGES] = {h / 6, h / 3, h / 3, h / 6},
                 reach[RK4_STAGES] = {h / 2, h / 2, h, 0};
    double *stage = back->stage[0], *total = back->stage[1];
    memset(total, 0, (size_t)n * sizeof *total);
    for (int k = RK4_STAGES - 1; k >= 0; --k) {
        set(n, part[k], back->state, stage);
        if (k < RK4_STAGES - 1)
            add(n, reach[k], back->stage[2], stage);
        if (k == 0)
            add(n, 1, back->rate[0], stage);
        const int status = rate_back(back, trail_event(trail, event + k), stage, k == 0 ? weight : 0, NULL);
        if (status != GIC_OK)
            return status;
        if (k > 0) {
            memcpy(back->stage[2], by, (size_t)n * sizeof *by);
            add(n, 1, by, total);
        }
    }
    add(n, 1, total, back->state);
    return GIC_OK;
}

/* Events of the step: from first to end. */
static int step_back(Back *back, int first, int end, double weight)
{
    const TangentRun *run = back->run;
    const double h = run->scene->step;
    int calls = 1, status = GIC_OK;
    while (first + calls < end && calls < RK4_STAGES && !trail_event(run->trail, first + calls)->settled)
        ++calls;
    const TrailEvent *settled = trail_event(run->trail, first + calls);
    const int knots = (end - first - calls - 1) / 3;
    double knot[knots + 1];
    if (knots) {
        knot[0] = scene_next_knot(run->scene, trail_event(run->trail, first)->time);
        for (int k = 1; k < knots; ++k)
            knot[k] = scene_next_knot(run->scene, knot[k - 1]);
    }
    for (int k = knots - 1; k >= 0 && status == GIC_OK; --k)
        status = knot_back(back, first + calls + 1 + 3 * k, &(Knot){knot[k], h});
    if (status != GIC_OK)
        return status;
    settle_back(back, settled);
    status = (calls == 1 ? ab3_back : rk4_back)(back, first, h, weight);
    if (status != GIC_OK)
        return status;
    add(run->states, 1, run->linear->along.y, back->state);
    double *done = back->rate[0];
    back->rate[0] = back->rate[1];
    back->rate[1] = back->rate[2];
    back->rate[2] = done;
    memset(done, 0, (size_t)run->states * sizeof *done);
    return GIC_OK;
}

static Back back_new(TangentRun *run)
{
    const size_t state = ((size_t)run->states + 1) * sizeof(double);
    Back back = {.run = run,
                 .state = pool_alloc(run->pool, state),
                 .sum = pool_alloc(run->pool, state),
                 .derivative = pool_alloc(run->pool, ((size_t)run->variables + 1) * sizeof(double)),
                 .parameter = pool_alloc(run->pool, ((size_t)run->code->parameter_count + 1) * sizeof(double))};
    for (int i = 0; i < 3; ++i) {
        back.rate[i] = pool_alloc(run->pool, state);
        back.stage[i] = pool_alloc(run->pool, state);
    }
    return back;
}

/* The events with which steps begin, [steps + 1]; the first event is the state at time 0 that was settled. */
static int *find_steps(const TangentRun *run, int64_t *steps)
{
    const Trail *trail = run->trail;
    int *first = pool_alloc(run->pool, ((size_t)trail_events(trail) + 2) * sizeof *first);
    int64_t step = -1;
    *steps = 0;
    for (int i = 1; i < trail_events(trail); ++i)
        if (trail_event(trail, i)->step != step) {
            step = trail_event(trail, i)->step;
            first[(*steps)++] = i;
        }
    first[*steps] = trail_events(trail);
    return first;
}

int adjoint_find(TangentRun *run, AdjointWeight *weight, const void *context, double *value, double *derivative)
{
    Back back = back_new(run);
    int64_t steps;
    const int *first = find_steps(run, &steps);
    const double *state = (const double *)(const void *)((const char *)run->both + run->descriptor.state_offset);
    const double *input = (const double *)(const void *)((const char *)run->both + run->descriptor.input_offset);
    double last[run->states + run->inputs];
    memcpy(last, state, (size_t)run->states * sizeof *last);
    memcpy(last + run->states, input, (size_t)run->inputs * sizeof *last);
    TrailEvent end = {.time = tangent_time(run), .number = last};
    memcpy(&end.dependent, (const char *)run->self + run->code->discrete_offset, sizeof end.dependent);
    int status = GIC_OK;
    if (weight(context, steps) != 0) {
        status = rate_back(&back, &end, back.sum, weight(context, steps), NULL);
        memcpy(back.state, run->linear->along.y, (size_t)run->states * sizeof *back.state);
    }
    for (int64_t i = steps - 1; i >= 0 && status == GIC_OK; --i)
        status = step_back(&back, first[i], first[i + 1], weight(context, i));
    if (status != GIC_OK)
        return status;
    settle_back(&back, trail_event(run->trail, 0));
    *value = back.value;
    memcpy(tape_array(run->self, run->code->state_offset), trail_event(run->trail, 1)->number,
           (size_t)run->states * sizeof(double));
    for (int k = 0; k < run->variables; ++k) {
        const RunVariable *v = &run->variable[k];
        derivative[k] = v->kind == BY_PARAMETER ? back.parameter[v->index] : back.derivative[k];
        if (v->kind != BY_INITIAL)
            continue;
        linear_direction(run->linear, run->self, LINEAR_MOTION, v->index);
        for (int i = 0; i < run->states; ++i)
            derivative[k] += back.state[i] * run->linear->along.y[i];
    }
    return GIC_OK;
}
