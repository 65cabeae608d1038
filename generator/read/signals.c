/* SPDX-License-Identifier: MIT
 * Signals (FORMAT.md section 7.1): the entries of `signals`, and the outputs that formulas read. Formulas stand before
 * outputs, which may name force elements; so names are noted while formulas are read and found at the end. */
#include "base/text.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <string.h>

enum { SIGNAL_VALUE, SIGNAL_UNIT, SIGNAL_KEYS };

static const Key signal_key[SIGNAL_KEYS] = {
    [SIGNAL_VALUE] = {"value", KEY_FORMULA, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [SIGNAL_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const signal_about[SIGNAL_KEYS] = {
    [SIGNAL_VALUE] = "formula, which may read outputs and other signals",
    [SIGNAL_UNIT] = "for people; default 1",
};

const Section signal_section = {signal_key, SIGNAL_KEYS, NULL, 0, NULL, NULL, signal_about};

bool is_formula_word(const char *name)
{
    static const char *const word[] = {"time",  "pi",    "not",  "and",      "or",    "if",
                                       "speed", "angle", "spin", "throttle", "length"};
    for (size_t i = 0; i < sizeof word / sizeof *word; ++i)
        if (!strcmp(name, word[i]))
            return true;
    return false;
}

void formula_name_check(const Reader *reader, const Entry *entry, const char *thing)
{
    const Model *model = reader->model;
    const char *other = is_formula_word(entry->name) ? "word of formulas" : NULL;
    for (int i = 0; i < model->parameters; ++i)
        other = strcmp(entry->name, model->parameter[i].name) ? other : "parameter";
    for (int i = 0; i < model->coordinates; ++i)
        other = strcmp(entry->name, model->coordinate[i].name) ? other : "coordinate";
    for (int i = 0; i < model->inputs; ++i)
        other = strcmp(entry->name, model->input[i].name) ? other : "input";
    for (int i = 0; i < model->states; ++i)
        other = strcmp(entry->name, model->state[i].name) ? other : "state";
    if (other)
        diag_fail(entry->at, pool_print(reader->pool, "give the %s another name", thing), "%s has the name of a%s %s",
                  entry->what, *other == 'i' ? "n" : "", other);
}

void signals_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "signal", &model->signals);
    model->signal = pool_alloc(reader->pool, sizeof *model->signal * (size_t)(model->signals + 1));
    const LawNames names = {.model = model, .reads = &reader->reads};
    for (int i = 0; i < model->signals; ++i) {
        Value value[SIGNAL_KEYS] = {{0}};
        if (entry[i].item->kind == ITEM_MAP)
            section_read(reader, &signal_section, 0, entry + i, value);
        formula_name_check(reader, entry + i, "signal");
        const Item *formula = entry[i].item->kind == ITEM_MAP ? value[SIGNAL_VALUE].item : entry[i].item;
        model->signal[i] = (Signal){
            .name = entry[i].name,
            .unit = value[SIGNAL_UNIT].item ? value[SIGNAL_UNIT].text : "1",
            .at = entry[i].at,
            .law = law_parse(reader->pool, formula, pool_print(reader->pool, "value of %s", entry[i].what), &names),
        };
    }
}

/* ---- names ---------------------------------------------------------------------------------------------------------
 */

/* Index of the signal with that name; an output's component that no formula has read yet becomes a signal. -1: there
 * is no such output. *odd: the mirror image changes its sign. */
static int signal_find(Reader *reader, const char *name, bool *odd)
{
    Model *model = reader->model;
    *odd = false;
    for (int i = 0; i < model->signals; ++i)
        if (!strcmp(model->signal[i].name, name)) {
            *odd = !model->signal[i].law && output_is_odd(model->signal[i].output.type, model->signal[i].component);
            return i;
        }
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            if (!strcmp(model->output[i].component[k], name)) {
                const Output *output = &model->output[i];
                *odd = output_is_odd(output->type, k);
                if (output->type == OUTPUT_SIGNAL)
                    return output->index;
                model->signal[model->signals] = (Signal){
                    .name = name, .unit = output->unit[k], .at = output->at, .output = *output, .component = k};
                return model->signals++;
            }
    return -1;
}

static void names_find(Reader *reader)
{
    Model *model = reader->model;
    const char **known = NULL;
    int count = 0;
    const size_t signals = (size_t)model->signals, room = signals + (size_t)reader->reads.count + 1;
    model->signal =
        pool_grow(reader->pool, model->signal, signals * sizeof *model->signal, room * sizeof *model->signal);
    for (int i = 0; i < model->signals; ++i)
        *POOL_PUSH(reader->pool, known, count) = model->signal[i].name;
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            *POOL_PUSH(reader->pool, known, count) = model->output[i].component[k];
    for (int i = 0; i < reader->reads.count; ++i) {
        SignalRead *read = &reader->reads.read[i];
        bool odd;
        read->law->index = signal_find(reader, read->name, &odd);
        if (read->law->index < 0)
            law_name_unknown(reader->pool, &read->names, read->what, read->name, read->at, known,
                             read->names.barred ? 0 : count);
        if (read->names.barred)
            diag_fail(read->at,
                      "read coordinates, rate(coordinate), inputs, parameters, tables or time here, or compute it in a "
                      "force element, whose formulas read outputs",
                      "%s: '%s' is an output or a signal, which %s do not read", read->what, read->name,
                      read->names.barred);
        read->law->number = odd && read->mirrored ? -1 : 1;
    }
}

/* ---- the order in which signals and force elements follow each other ------------------------------------------------
 */

enum { SIZE_MOST = 10000 /* operations of a formula with those of the signals that it reads, counted at each use */ };

typedef enum Visit { NEW, OPEN, DONE } Visit;

/* A signal or a force element. */
typedef struct Thing {
    Visit visit;
    int size;            /* operations, with those of all that it reads */
    const char *follows; /* an acceleration or the like that it follows; NULL: none */
} Thing;

typedef struct Order {
    Reader *reader;
    Thing *signal, *force;
    const SignalRead **way; /* the readings that lead to the present one */
    int ways;
    int size; /* sums over the readings of one formula */
    const char *follows;
} Order;

static const SignalRead *read_of(const Reader *reader, const Law *law)
{
    int i = 0;
    while (reader->reads.read[i].law != law)
        ++i;
    return &reader->reads.read[i];
}

/* "value of force 'a' reads 'b', which follows 'c'", from the reading `first` on. */
static const char *way_text(const Order *order, int first)
{
    Text text = {.pool = order->reader->pool};
    for (int i = first; i < order->ways; ++i)
        text_print(&text, "%s%s reads '%s'", i > first ? ", " : "", order->way[i]->what, order->way[i]->name);
    return text.s;
}

static void signal_visit(void *user, const Law *law);

/* All that the formulas of something read. */
static void laws_visit(Order *order, Thing *thing, const Law *const *law, int laws)
{
    const int size = order->size;
    const char *const follows = order->follows;
    order->size = 0;
    order->follows = NULL;
    for (int i = 0; i < laws; ++i) {
        order->size += law[i] ? law[i]->size : 0;
        law_signals(law[i], signal_visit, order);
    }
    thing->size = order->size;
    thing->follows = order->follows;
    order->size = size;
    order->follows = follows;
}

static void closed_circle(const Order *order)
{
    int first = order->ways - 1;
    const int last = order->way[first]->law->index;
    while (first > 0 && order->way[first - 1]->law->index != last)
        --first;
    const SignalRead *read = order->way[order->ways - 1];
    const size_t length = strlen(read->name);
    const bool of_rule = length > 5 && !strcmp(read->name + length - 5, ".next");
    diag_fail(read->at,
              of_rule ? "read the rule without `.next`, which is what it holds"
                      : "let one of them read positions, velocities, coordinates or their rates instead",
              "%s: '%s' follows itself: %s", read->what, read->name, way_text(order, first));
}

static bool law_contains(const Law *law, const Law *part)
{
    return law && (law == part || law_contains(law->arg[0], part) || law_contains(law->arg[1], part) ||
                   law_contains(law->arg[2], part));
}

/* Formulas of wheels, of the powertrain and of states: the motion of bodies is known there, forces are not. */
static void early_visit(Order *order, const SignalRead *read)
{
    const Signal *signal = &order->reader->model->signal[read->law->index];
    *POOL_PUSH(order->reader->pool, order->way, order->ways) = read;
    if (signal->law) {
        const Reader *reader = order->reader;
        for (int i = 0; i < reader->reads.count; ++i)
            if (law_contains(signal->law, reader->reads.read[i].law))
                early_visit(order, &reader->reads.read[i]);
    } else if (!output_is_motion(signal->output.type, signal->component)) {
        diag_fail(order->way[0]->at,
                  "read positions, velocities, attitude, coordinates and their rates or spins of wheels",
                  "formulas of %s are evaluated before forces are known: %s, an output of type %s",
                  order->way[0]->names.early, way_text(order, 0), output_type_name[signal->output.type]);
    }
    --order->ways;
}

static void force_visit(Order *order, int index)
{
    Thing *thing = &order->force[index];
    const Force *force = &order->reader->model->force[index];
    if (thing->visit == OPEN)
        closed_circle(order);
    if (thing->visit == DONE)
        return;
    thing->visit = OPEN;
    laws_visit(order, thing, force->law, FORCE_MOST_LAWS);
    thing->visit = DONE;
    if (thing->follows)
        diag_fail(
            force->at,
            "let it read positions, velocities, coordinates, their rates or forces of other elements; a signal that "
            "follows accelerations can be an output",
            "force '%s' would follow accelerations, which follow from forces: %s", force->name, thing->follows);
}

static void signal_visit(void *user, const Law *law)
{
    Order *order = user;
    const Model *model = order->reader->model;
    const Signal *signal = &model->signal[law->index];
    Thing *thing = &order->signal[law->index];
    const SignalRead *read = read_of(order->reader, law);
    *POOL_PUSH(order->reader->pool, order->way, order->ways) = read;
    if (thing->visit == OPEN)
        closed_circle(order);
    if (thing->visit == NEW) {
        thing->visit = OPEN;
        if (signal->law)
            laws_visit(order, thing, &signal->law, 1);
        else if (signal->output.type == OUTPUT_FORCE)
            force_visit(order, signal->output.index);
        thing->visit = DONE;
    }
    if (!signal->law && output_follows_accelerations(signal->output.type, signal->component))
        order->follows = way_text(order, 0);
    else if (thing->follows)
        order->follows = thing->follows;
    order->size += thing->size;
    if (order->size > SIZE_MOST)
        diag_fail(read->at, "read fewer signals, or split the formula into several force elements",
                  "%s has more than %d operations and numbers, with those of the signals that it reads", read->what,
                  SIZE_MOST);
    --order->ways;
}

void signals_close(Reader *reader)
{
    Model *model = reader->model;
    const int named = model->signals;
    names_find(reader);
    Order order = {.reader = reader,
                   .signal = pool_alloc(reader->pool, sizeof *order.signal * (size_t)(model->signals + 1)),
                   .force = pool_alloc(reader->pool, sizeof *order.force * (size_t)(model->forces + 1))};
    for (int i = 0; i < model->forces; ++i)
        force_visit(&order, i);
    for (int i = 0; i < named; ++i)
        if (order.signal[i].visit == NEW) {
            order.signal[i].visit = OPEN;
            laws_visit(&order, &order.signal[i], &model->signal[i].law, 1);
            order.signal[i].visit = DONE;
        }
    for (int i = 0; i < reader->reads.count; ++i)
        if (reader->reads.read[i].names.early)
            early_visit(&order, &reader->reads.read[i]);
}
