/* SPDX-License-Identifier: MIT
 * Warnings about entries that nothing reads: tunable parameters, tables, inputs, states and signals (FORMAT.md section
 * 6). */
#include "base/message.h"
#include "base/pool.h"
#include "base/table.h"
#include "model/model.h"
#include "read/reader.h"

/* No warning for a mirror image: it is not written in the file, so it can't be removed alone. */
static bool is_image(Place at)
{
    return at.source && at.source->mirrored;
}

static void tell(Place at, const char *thing, const char *name)
{
    if (!is_image(at))
        diag_warn(at, "take it away, unless a scene reads it", "nothing in the model reads %s '%s'", thing, name);
}

static bool signal_is_read(const Reader *reader, int signal)
{
    const Model *model = reader->model;
    for (int i = 0; i < reader->reads.count; ++i)
        if (reader->reads.read[i].law->index == signal)
            return true;
    for (int i = 0; i < model->outputs; ++i)
        if (model->output[i].type == OUTPUT_SIGNAL && model->output[i].index == signal)
            return true;
    return false;
}

/* True if a formula reads what the rule that holds this state would give: by that it remembers. */
static bool next_is_read(const Reader *reader, int state)
{
    const Model *model = reader->model;
    for (int c = 0; c < model->controllers; ++c)
        for (int k = 0; k < model->controller[c].rules; ++k)
            for (int i = 0; model->controller[c].rule[k].state == state && i < reader->reads.count; ++i)
                if (reader->reads.read[i].law->index == model->controller[c].rule[k].signal)
                    return true;
    return false;
}

/* True if a program supplies what the state holds, which it may have for itself alone. */
static bool is_program_s(const Model *model, int state)
{
    bool is = false;
    for (int c = 0; c < model->controllers; ++c)
        for (int k = 0; k < model->controller[c].rules; ++k)
            is = is || (model->controller[c].rule[k].state == state && model->controller[c].rule[k].signal < 0);
    return is;
}

void unread_tell(const Reader *reader)
{
    const Model *model = reader->model;
    for (int i = 0; i < model->inputs; ++i)
        if (!model->input[i].read)
            tell(model->input[i].at, "input", model->input[i].name);
    for (int i = 0; i < model->parameters; ++i)
        if (!model->parameter[i].read && (model->parameter[i].tunable || model->parameter[i].law))
            tell(model->parameter[i].at, "tunable parameter", model->parameter[i].name);
    for (int i = 0; i < model->tables; ++i)
        if (!model->table[i].read)
            tell(model->table[i].at, "table", model->table[i].name);
    for (int i = 0; i < model->states; ++i)
        if (!model->state[i].read && !next_is_read(reader, i) && !is_program_s(model, i))
            tell(model->state[i].at, model->state[i].rate ? "state" : "rule", model->state[i].name);
    for (int i = 0; i < model->signals; ++i) {
        const Signal *signal = &model->signal[i];
        if (signal->law && !is_image(signal->at) && !signal_is_read(reader, i))
            diag_warn(signal->at,
                      pool_print(reader->pool,
                                 "take it away, unless a scene or a metric reads it, or show it: "
                                 "`outputs: {%s: {type: signal, signal: %s}}`",
                                 signal->name, signal->name),
                      "nothing in the model reads signal '%s'", signal->name);
    }
}
