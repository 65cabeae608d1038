/* SPDX-License-Identifier: MIT
 * Formulas of a command line as outputs. */
#include "base/message.h"
#include "base/yaml.h"
#include "model/tunable.h"
#include "run/formula_output.h"

#include <string.h>

const char *formula_inside(Pool *pool, const char *text, const char *name)
{
    const size_t head = strlen(name), size = strlen(text);
    int depth = 1;
    if (strncmp(text, name, head) != 0 || text[head] != '(' || text[size - 1] != ')')
        return NULL;
    for (const char *c = text + head + 1; c < text + size - 1; ++c) {
        depth += (*c == '(') - (*c == ')');
        if (depth == 0)
            return NULL;
    }
    return pool_print(pool, "%.*s", (int)(size - head - 2), text + head + 1);
}

/* The signal of a name: an entry of `signals`, or a component of an output, which becomes one. -1: there is none. */
static int find_signal(Model *model, const Model *from, const char *name)
{
    for (int i = 0; i < model->signals; ++i)
        if (!strcmp(model->signal[i].name, name))
            return i;
    for (int i = 0; i < from->outputs; ++i)
        for (int k = 0; k < from->output[i].count; ++k) {
            const Output *output = &from->output[i];
            if (strcmp(output->component[k], name) != 0)
                continue;
            if (output->type == OUTPUT_SIGNAL)
                return output->index;
            Signal *signal = &model->signal[model->signals++];
            *signal = (Signal){.name = name, .unit = output->unit[k], .at = output->at, .component = k};
            output_copy(from, &signal->output, output);
            return model->signals - 1;
        }
    return -1;
}

/* Signals that the formula names. */
static void find_signals(Pool *pool, Model *model, const Model *from, const SignalReads *reads, const char *what)
{
    const char **known = NULL;
    int count = 0;
    for (int i = 0; i < from->signals; ++i)
        *POOL_PUSH(pool, known, count) = from->signal[i].name;
    for (int i = 0; i < from->outputs; ++i)
        for (int k = 0; k < from->output[i].count; ++k)
            if (!from->output[i].hidden && from->output[i].type != OUTPUT_SIGNAL) /* which stand there already */
                *POOL_PUSH(pool, known, count) = from->output[i].component[k];
    for (int i = 0; i < reads->count; ++i) {
        const SignalRead *read = &reads->read[i];
        read->law->index = find_signal(model, from, read->name);
        read->law->number = 1;
        if (read->law->index < 0)
            law_name_unknown(pool, &read->names, what, read->name, read->at, known, count);
    }
}

Model *formula_output(Pool *pool, const Model *from, const char *option, const char *name, const char *formula)
{
    const char *what = pool_print(pool, "the formula of %s", option);
    Model *model = pool_alloc(pool, sizeof *model);
    *model = *from;
    /* where they stay: tunable numbers are found by their addresses */
    model->signal = pool_alloc(pool, (size_t)(from->signals + from->output_components + 1) * sizeof *model->signal);
    for (int i = 0; i < from->signals; ++i) {
        model->signal[i] = from->signal[i];
        output_copy(from, &model->signal[i].output, &from->signal[i].output);
    }
    model->output = pool_alloc(pool, ((size_t)from->outputs + 1) * sizeof *model->output);
    for (int i = 0; i < from->outputs; ++i)
        output_copy(from, &model->output[i], &from->output[i]);
    const Source *source = source_text(pool, option, formula, strlen(formula));
    const Item item = {.kind = ITEM_SCALAR, .at = {source, 1, 1}, .text = formula};
    SignalReads reads = {0};
    const LawNames names = {.model = from, .reads = &reads};
    const Law *law = law_parse(pool, &item, what, &names);
    find_signals(pool, model, from, &reads, what);
    model->signal[model->signals++] = (Signal){.name = name, .unit = "1", .at = item.at, .law = law};
    model->output[model->outputs++] = (Output){.name = name,
                                               .at = item.at,
                                               .type = OUTPUT_SIGNAL,
                                               .index = model->signals - 1,
                                               .count = 1,
                                               .component = {name},
                                               .unit = {"1"},
                                               .hidden = true};
    ++model->output_components;
    return model;
}

void formula_alone(Pool *pool, Model *model, int count)
{
    Output *output = NULL;
    const Output *from = model->output + model->outputs - count;
    const int others = model->outputs - count, room = model->outputs;
    output = pool_alloc(pool, ((size_t)room + 1) * sizeof *output);
    int outputs = 0, components = 0;
    for (int i = 0; i < count; ++i) {
        output[outputs] = from[i];
        output[outputs].hidden = false;
        components += output[outputs++].count;
    }
    for (int i = 0; i < others; ++i)
        if (model->output[i].sampled) {
            output[outputs] = model->output[i];
            components += output[outputs++].count;
        }
    model->output = output;
    model->outputs = outputs;
    model->output_components = components;
}
