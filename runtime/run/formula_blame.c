/* SPDX-License-Identifier: MIT
 * The formula that has no value or derivative: all formulas as outputs of a model, played in dual numbers. This is done
 * after a run has failed, so it may take its time. */
#include "run/formula_blame.h"
#include "engine/engine.h"
#include "run/engines.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

/* A formula becomes an output. */
static void show(Pool *pool, Model *model, int signal)
{
    const Signal *of = &model->signal[signal];
    *POOL_PUSH(pool, model->output, model->outputs) = (Output){.name = of->name,
                                                               .at = of->at,
                                                               .type = OUTPUT_SIGNAL,
                                                               .index = signal,
                                                               .count = 1,
                                                               .component = {of->name},
                                                               .unit = {of->unit}};
    ++model->output_components;
}

/* The model with its formulas as outputs: of forces and states first, which become signals, then signals. *own: how
 * many outputs are of forces and states. */
static const Model *show_formulas(Pool *pool, const Model *from, int *own)
{
    Model *model = pool_alloc(pool, sizeof *model);
    *model = *from;
    model->signal = NULL;
    model->output = NULL;
    model->signals = model->outputs = model->output_components = 0;
    for (int i = 0; i < from->signals; ++i)
        *POOL_PUSH(pool, model->signal, model->signals) = from->signal[i];
    for (int i = 0; i < from->forces; ++i)
        if (from->force[i].type == FORCE_COORDINATE_LAW) /* others read numbers of their own, which signals can not */
            *POOL_PUSH(pool, model->signal, model->signals) =
                (Signal){.name = pool_print(pool, "force '%s'", from->force[i].name),
                         .unit = "1",
                         .at = from->force[i].at,
                         .law = from->force[i].law[0]};
    for (int i = 0; i < from->states; ++i)
        if (from->state[i].rate)
            *POOL_PUSH(pool, model->signal, model->signals) =
                (Signal){.name = pool_print(pool, "the rate of state '%s'", from->state[i].name),
                         .unit = "1",
                         .at = from->state[i].at,
                         .law = from->state[i].rate};
    for (int i = from->signals; i < model->signals; ++i)
        show(pool, model, i);
    *own = model->outputs;
    for (int i = 0; i < from->signals; ++i)
        if (model->signal[i].law)
            show(pool, model, i);
    return model;
}

/* Does the model show a signal in its outputs? */
static bool is_shown(const Model *model, int signal)
{
    for (int i = 0; i < model->outputs; ++i)
        if (model->output[i].type == OUTPUT_SIGNAL && model->output[i].index == signal)
            return true;
    return false;
}

/* An instance of the other engine where the first one is. False: that is not possible. */
static bool go_there(const Engine *engine, Instance *to, Instance *from)
{
    const gic_model *code = engine->code, *old = &tape_of(from)->code;
    const size_t number = sizeof(double);
    if (code->setup_with(to, tape_array(from, old->parameter_offset)) != GIC_OK)
        return false;
    to->head.road = from->head.road;
    to->head.lane = from->head.lane;
    to->head.start_time = gic_time(&from->head);
    memcpy(tape_array(to, code->input_offset), tape_array(from, old->input_offset), (size_t)code->input_count * number);
    memcpy(tape_array(to, code->port_offset), tape_array(from, old->port_offset), (size_t)code->port_count * number);
    memcpy(tape_array(to, code->state_offset), tape_array(from, old->state_offset),
           (size_t)(code->slow_count + code->fast_count) * number);
    memcpy((char *)to + code->discrete_offset, (const char *)from + old->discrete_offset,
           (size_t)code->discrete_count * sizeof(int32_t));
    const double *state = tape_array(to, code->state_offset);
    double rate[code->slow_count + code->fast_count + 1];
    const int status = code->rhs(to, gic_time(&to->head), state, rate);
    return status == GIC_OK || status == GIC_ERROR_RESULT;
}

/* Outputs that are bad. */
typedef struct Bad {
    const Model *model;
    const double *value, *slope;
    int found; /* output; -1: none */
} Bad;

static bool is_bad(const Bad *bad, int output)
{
    return !isfinite(bad->value[output]) || !isfinite(bad->slope[output]);
}

static void find_read(void *user, const Law *signal)
{
    Bad *bad = user;
    for (int i = 0; i < bad->model->outputs; ++i)
        if (bad->model->output[i].index == signal->index && is_bad(bad, i))
            bad->found = i;
}

bool formula_blame(Pool *pool, const Model *from, Solve solve, const Instance *self, const Direction *along,
                   Blame *blame)
{
    int own;
    const Model *model = show_formulas(pool, from, &own);
    if (!model->outputs)
        return false;
    const Engine *engine = engine_open(pool, "tape", model, &(EngineOptions){.solve = solve, .quiet = true});
    const gic_model *code = engine->code;
    const Linear *linear = linear_open(pool, engine);
    Instance *there = (Instance *)(void *)instance_new(pool, engine);
    const int states = code->slow_count + code->fast_count;
    if (!go_there(engine, there, (Instance *)(uintptr_t)self))
        return false;
    memcpy(linear->along.y, along->y, (size_t)states * sizeof *along->y);
    memcpy(linear->along.u, along->u, (size_t)code->input_count * sizeof *along->u);
    memcpy(linear->along.p, along->p, (size_t)code->parameter_count * sizeof *along->p);
    if (linear_slope(linear, there, LINEAR_RATE, model->outputs) != GIC_OK)
        return false;
    Bad bad = {model, linear->rate + states, linear->drate + states, -1};
    for (int i = 0; i < model->outputs && bad.found < 0; ++i)
        if ((i < own || is_shown(from, model->output[i].index)) && is_bad(&bad, i))
            bad.found = i;
    if (bad.found < 0)
        return false;
    for (int before = -1; before != bad.found;) {
        before = bad.found;
        law_signals(model->signal[model->output[before].index].law, find_read, &bad);
    }
    const Signal *signal = &model->signal[model->output[bad.found].index];
    *blame = (Blame){bad.found < own ? signal->name : pool_print(pool, "signal '%s'", signal->name), signal->at,
                     isfinite(bad.value[bad.found])};
    return true;
}
