/* SPDX-License-Identifier: MIT
 * Conditions of scenes as outputs. */
#include "run/condition_output.h"
#include "base/message.h"
#include "expression/expression.h"
#include "model/tunable.h"
#include "scene/action.h"

#include <string.h>

static const char *const name = "a condition of the scene"; /* no name of a model has a blank */
static const char *const guard_name = "the guard of a condition";

int condition_count(const Scene *scene)
{
    return scene && scene->actions ? scene->actions->count : 0;
}

void condition_no_end(const Scene *scene, const char *option)
{
    for (int i = 0; i < condition_count(scene); ++i)
        if (scene->actions->action[i].ends)
            diag_fail(scene->actions->action[i].at,
                      "leave `until` out, so that runs end with `duration`; `when` may stay",
                      "%s looks at all times of a run, and '%s' ends it", option, scene->actions->action[i].text);
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

static const Law *call(Pool *pool, Op op, const Law *a, const Law *b)
{
    Law *law = pool_alloc(pool, sizeof *law);
    *law = (Law){.op = LAW_CALL, .call = (int)op, .arg = {a, b}, .size = 1 + a->size + (b ? b->size : 0)};
    return law;
}

static bool is_call(const Law *law, Op op)
{
    return law->op == LAW_CALL && law->call == (int)op;
}

/* A law that is above 0 where this one is: of if(c, p, q) where c and p are, or q is and c is not. */
static const Law *guard_of(Pool *pool, const Law *law)
{
    if (is_call(law, OP_MIN) || is_call(law, OP_MAX))
        return call(pool, (Op)law->call, guard_of(pool, law->arg[0]), guard_of(pool, law->arg[1]));
    if (is_call(law, OP_NEG) && is_call(law->arg[0], OP_POSITIVE)) {
        const Law *jump = law->arg[0];
        Law turned = *jump;
        for (int i = 1; i < 3; ++i)
            turned.arg[i] = call(pool, OP_NEG, jump->arg[i], NULL);
        return guard_of(pool, &turned);
    }
    if (!is_call(law, OP_POSITIVE))
        return law;
    const Law *choice = guard_of(pool, law->arg[0]), *yes = guard_of(pool, law->arg[1]);
    const Law *no = guard_of(pool, law->arg[2]);
    return call(pool, OP_MAX, call(pool, OP_MIN, choice, yes),
                call(pool, OP_MIN, call(pool, OP_NEG, choice, NULL), no));
}

/* True if the law follows from more than numbers and the time. */
static bool has_state(const Law *law)
{
    if (!law->arg[0])
        return law->op != LAW_NUMBER && law->op != LAW_TIME;
    bool has = false;
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        has = has || has_state(law->arg[i]);
    return has;
}

/* True if there is an `if` in the law or in signals that it reads. */
static bool has_jump(const Model *model, const Law *law)
{
    if (is_call(law, OP_POSITIVE) && has_state(law->arg[0]))
        return true;
    bool has = law->op == LAW_SIGNAL && model->signal[law->index].law && has_jump(model, model->signal[law->index].law);
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        has = has || has_jump(model, law->arg[i]);
    return has;
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
    const Law *law[2][count];
    int locals = 0;
    for (int i = 0; i < count; ++i) {
        law[0][i] = actions->action[i].law;
        law[1][i] = guard_of(pool, law[0][i]);
        locals += locals_of(law[0][i]) + locals_of(law[1][i]);
    }
    Model *model = pool_alloc(pool, sizeof *model);
    *model = *from;
    /* where they stay: tunable numbers are found by their addresses */
    model->signal = pool_alloc(pool, (size_t)(from->signals + 2 * count + locals + 1) * sizeof *model->signal);
    for (int i = 0; i < from->signals; ++i) {
        model->signal[i] = from->signal[i];
        output_copy(from, &model->signal[i].output, &from->signal[i].output);
    }
    model->output = pool_alloc(pool, (size_t)(from->outputs + 2 * count + 1) * sizeof *model->output);
    int before = from->outputs;
    while (before > 0 && from->output[before - 1].sampled)
        --before;
    for (int i = 0; i < from->outputs; ++i)
        output_copy(from, &model->output[i < before ? i : i + 2 * count], &from->output[i]);
    model->outputs = before;
    for (int i = 0; i < 2 * count; ++i) {
        const Action *action = &actions->action[i % count];
        const char *const called = i < count ? name : guard_name;
        const Law *own = with_signals(pool, model, from, actions, law[i / count][i % count]);
        model->signal[model->signals++] = (Signal){.name = action->text, .unit = "1", .at = action->at, .law = own};
        model->output[model->outputs++] = (Output){.name = called,
                                                   .at = action->at,
                                                   .type = OUTPUT_SIGNAL,
                                                   .index = model->signals - 1,
                                                   .count = 1,
                                                   .component = {called},
                                                   .unit = {"1"},
                                                   .hidden = true};
        ++model->output_components;
    }
    model->outputs = from->outputs + 2 * count;
    return model;
}

bool condition_jumps(const Model *model, int c)
{
    for (int i = 0; i < model->outputs; ++i)
        if (!strcmp(model->output[i].name, guard_name) && c-- == 0)
            return has_jump(model, model->signal[model->output[i].index].law);
    return false;
}
