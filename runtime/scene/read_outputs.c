/* SPDX-License-Identifier: MIT
 * Signals that a scene writes and draws: models/SCENE.md sections 1 and 6. */
#include "base/yaml.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "scene/scene.h"

#include <string.h>

/* Names that may stand in a list, and their signals. */
typedef struct Names {
    Pool *pool;
    const gic_signal *signal;
    int count, *first, *size; /* size: of signals, from the first one on */
    const char **name;
} Names;

/* An input with the name of an output gets a prefix. */
gic_signal *scene_signals(Pool *pool, const Model *model)
{
    gic_signal *signal = pool_alloc(pool, sizeof *signal * (size_t)(model->output_components + model->inputs + 1));
    gic_signal *next = signal;
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            *next++ = (gic_signal){model->output[i].component[k], model->output[i].unit[k]};
    for (int i = 0; i < model->inputs; ++i)
        *next++ = (gic_signal){pool_print(pool, "input.%s", model->input[i].name), model->input[i].unit};
    return signal;
}

static void add_name(Names *names, const char *name, int first, int size)
{
    names->name[names->count] = name;
    names->first[names->count] = first;
    names->size[names->count++] = size;
}

static Names all_names(Pool *pool, const Model *model, const gic_signal *signal)
{
    const size_t most = (size_t)(model->outputs + model->output_components + model->inputs + 1);
    Names names = {.pool = pool, .signal = signal};
    names.first = pool_alloc(pool, sizeof *names.first * most);
    names.size = pool_alloc(pool, sizeof *names.size * most);
    names.name = pool_alloc(pool, sizeof *names.name * most);
    int at = 0;
    for (int i = 0; i < model->outputs; at += model->output[i++].count) {
        const Output *output = &model->output[i];
        if (output->hidden)
            continue;
        add_name(&names, output->name, at, output->count);
        for (int k = 0; k < output->count; ++k)
            add_name(&names, signal[at + k].name, at + k, 1);
    }
    for (int i = 0; i < model->inputs; ++i, ++at)
        add_name(&names, signal[at].name, at, 1);
    return names;
}

static int name_find(const Names *names, const Item *item)
{
    return scene_name_index(names->pool, item, doc_word(item, "name of an output"), "output", names->name,
                            names->count);
}

/* Signals by their names, each once. */
static void add_signals(const Names *names, const Item *item, int **out, int *count)
{
    const int found = name_find(names, item);
    for (int k = names->first[found]; k < names->first[found] + names->size[found]; ++k) {
        int i = 0;
        while (i < *count && (*out)[i] != k)
            ++i;
        if (i == *count)
            *POOL_PUSH(names->pool, *out, *count) = k;
    }
}

static void check_list(const Item *list, const char *what)
{
    if (list->kind != ITEM_LIST || !list->count)
        diag_fail(list->at, "write [name, name, ...]", "%s must be a list of names of outputs", what);
}

/* One signal over another. */
static void read_panel(const Names *names, const Item *item, Scene *scene)
{
    static const char *const axis[2] = {"x", "y"};
    CHECK_KEYS(item, "a panel of the plot", "x", "y");
    int(*panel)[2] = POOL_PUSH(names->pool, scene->panel, scene->panels);
    for (int k = 0; k < 2; ++k) {
        const Item *name = scene_need(item, axis[k], "a panel of the plot");
        const int found = name_find(names, name);
        if (names->size[found] != 1)
            diag_fail(name->at, pool_print(names->pool, "write %s", names->name[found + 1]),
                      "output '%s' has %d components, and an axis shows one", names->name[found], names->size[found]);
        (*panel)[k] = names->first[found];
    }
}

/* All components of the model's own outputs. */
static void add_all(Pool *pool, const Model *model, int **out, int *count)
{
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        for (int k = 0; k < model->output[i].count && !model->output[i].hidden; ++k)
            *POOL_PUSH(pool, *out, *count) = at + k;
}

/* The default curves: heights, as in the paper; without these values of coordinates; without these all. */
static void default_curves(Pool *pool, const Model *model, Scene *scene)
{
    for (int pass = 0; pass < 2 && !scene->curves; ++pass)
        for (int i = 0, component = 0; i < model->outputs; component += model->output[i++].count)
            if (!pass && model->output[i].type == OUTPUT_POSITION)
                *POOL_PUSH(pool, scene->curve, scene->curves) = component + 2;
            else if (pass && model->output[i].type == OUTPUT_COORDINATE)
                *POOL_PUSH(pool, scene->curve, scene->curves) = component;
    if (!scene->curves)
        add_all(pool, model, &scene->curve, &scene->curves);
}

void scene_read_outputs(Pool *pool, const Item *root, const Model *model, Scene *scene)
{
    const Item *outputs = doc_find(root, "outputs"), *plot = doc_find(root, "plot");
    scene->signal = scene_signals(pool, model);
    const Names names = all_names(pool, model, scene->signal);
    if (outputs)
        check_list(outputs, "outputs");
    for (int i = 0; outputs && i < outputs->count; ++i)
        add_signals(&names, outputs->value[i], &scene->column, &scene->columns);
    if (!outputs)
        add_all(pool, model, &scene->column, &scene->columns);
    scene->plotted = plot;
    if (plot)
        check_list(plot, "plot");
    for (int i = 0; plot && i < plot->count; ++i)
        if (plot->value[i]->kind == ITEM_MAP)
            read_panel(&names, plot->value[i], scene);
        else
            add_signals(&names, plot->value[i], &scene->curve, &scene->curves);
    if (!plot)
        default_curves(pool, model, scene);
}
