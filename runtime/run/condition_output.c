/* SPDX-License-Identifier: MIT
 * Conditions of scenes as outputs. */
#include "run/condition_output.h"
#include "model/tunable.h"
#include "scene/action.h"

#include <string.h>

static const char *const name = "a condition of the scene"; /* no name of a model has a blank */

int condition_count(const Scene *scene)
{
    return scene && scene->actions ? scene->actions->count : 0;
}

int condition_has(const Model *model)
{
    int count = 0;
    for (int i = 0; i < model->outputs; ++i)
        count += !strcmp(model->output[i].name, name);
    return count;
}

/* A component of an output of the base: speed, roll, pitch, yaw. */
static Signal of_base(int which)
{
    static const char *const of[] = {"speed", "roll", "pitch", "yaw"};
    const bool speed = which == 0;
    Signal signal = {.name = of[which], .unit = speed ? "m/s" : "rad", .component = speed ? 0 : which - 1};
    signal.output = (Output){.name = of[which],
                             .type = speed ? OUTPUT_VELOCITY : OUTPUT_ROLL_PITCH_YAW,
                             .body = BODY_BASE,
                             .in = speed ? BODY_BASE : BODY_GROUND,
                             .count = 3,
                             .component = {of[which], of[which], of[which]},
                             .unit = {signal.unit, signal.unit, signal.unit}};
    return signal;
}

/* A component of an output, or an input, as a signal; local: its number among the signals of a scene. */
static Signal of_model(Pool *pool, const Model *from, int local)
{
    if (local >= from->output_components) {
        const int input = local - from->output_components;
        Law *law = pool_alloc(pool, sizeof *law);
        *law = (Law){.op = LAW_INPUT, .index = input, .name = from->input[input].name, .size = 1};
        return (Signal){.name = from->input[input].name, .unit = from->input[input].unit, .law = law};
    }
    int output = 0;
    while (local >= from->output[output].count)
        local -= from->output[output++].count;
    Signal signal = {.name = from->output[output].component[local],
                     .unit = from->output[output].unit[local],
                     .at = from->output[output].at,
                     .component = local};
    if (from->output[output].type == OUTPUT_SIGNAL)
        signal.law = from->signal[from->output[output].index].law;
    else
        output_copy(from, &signal.output, &from->output[output]);
    return signal;
}

/* The law with signals of the model in place of its local names. */
static const Law *with_signals(Pool *pool, Model *model, const Model *from, const Actions *actions, const Law *law)
{
    Law *copy = pool_alloc(pool, sizeof *copy);
    *copy = *law;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        copy->arg[i] = with_signals(pool, model, from, actions, law->arg[i]);
    if (law->op != LAW_LOCAL)
        return copy;
    copy->op = LAW_SIGNAL;
    copy->number = 1;
    copy->index = model->signals;
    model->signal[model->signals++] =
        law->index < actions->signals ? of_model(pool, from, law->index) : of_base(law->index - actions->signals);
    return copy;
}

static int locals_of(const Law *law)
{
    int count = law->op == LAW_LOCAL;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        count += locals_of(law->arg[i]);
    return count;
}

Model *condition_outputs(Pool *pool, Model *from, const Scene *scene)
{
    const int count = condition_count(scene);
    if (!count)
        return from;
    const Actions *actions = scene->actions;
    int locals = 0;
    for (int i = 0; i < count; ++i)
        locals += locals_of(actions->action[i].law);
    Model *model = pool_alloc(pool, sizeof *model);
    *model = *from;
    /* where they stay: tunable numbers are found by their addresses */
    model->signal = pool_alloc(pool, (size_t)(from->signals + count + locals + 1) * sizeof *model->signal);
    for (int i = 0; i < from->signals; ++i) {
        model->signal[i] = from->signal[i];
        output_copy(from, &model->signal[i].output, &from->signal[i].output);
    }
    model->output = pool_alloc(pool, (size_t)(from->outputs + count + 1) * sizeof *model->output);
    for (int i = 0; i < from->outputs; ++i)
        output_copy(from, &model->output[i], &from->output[i]);
    for (int i = 0; i < count; ++i) {
        const Action *action = &actions->action[i];
        const Law *law = with_signals(pool, model, from, actions, action->law);
        model->signal[model->signals++] = (Signal){.name = action->text, .unit = "1", .at = action->at, .law = law};
        model->output[model->outputs++] = (Output){.name = name,
                                                   .at = action->at,
                                                   .type = OUTPUT_SIGNAL,
                                                   .index = model->signals - 1,
                                                   .count = 1,
                                                   .component = {name},
                                                   .unit = {"1"},
                                                   .hidden = true};
        ++model->output_components;
    }
    return model;
}
