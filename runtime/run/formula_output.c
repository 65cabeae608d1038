/* SPDX-License-Identifier: MIT
 * Formulas of a command line as outputs. */
#include "base/message.h"
#include "base/yaml.h"
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
static int find_signal(Pool *pool, Model *model, const Model *from, const char *name)
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
            *POOL_PUSH(pool, model->signal, model->signals) =
                (Signal){.name = name, .unit = output->unit[k], .at = output->at, .output = *output, .component = k};
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
            *POOL_PUSH(pool, known, count) = from->output[i].component[k];
    for (int i = 0; i < reads->count; ++i) {
        const SignalRead *read = &reads->read[i];
        read->law->index = find_signal(pool, model, from, read->name);
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
    model->signal = NULL;
    model->signals = 0;
    for (int i = 0; i < from->signals; ++i)
        *POOL_PUSH(pool, model->signal, model->signals) = from->signal[i];
    model->output = NULL;
    model->outputs = 0;
    for (int i = 0; i < from->outputs; ++i)
        *POOL_PUSH(pool, model->output, model->outputs) = from->output[i];
    const Source *source = source_text(pool, option, formula, strlen(formula));
    const Item item = {.kind = ITEM_SCALAR, .at = {source, 1, 1}, .text = formula};
    SignalReads reads = {0};
    const LawNames names = {.model = from, .reads = &reads};
    const Law *law = law_parse(pool, &item, what, &names);
    find_signals(pool, model, from, &reads, what);
    *POOL_PUSH(pool, model->signal, model->signals) = (Signal){.name = name, .unit = "1", .at = item.at, .law = law};
    *POOL_PUSH(pool, model->output, model->outputs) = (Output){.name = name,
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
