/* SPDX-License-Identifier: MIT
 * Sampled controllers (FORMAT.md section 7.4): what they hold are states without a rate, the last ones of the model;
 * the formulas of their rules are signals with an output each, so that every engine has their values. */
#include "base/text.h"
#include "base/yaml.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

enum { CONTROLLER_PERIOD, CONTROLLER_OFFSET, CONTROLLER_RULES, CONTROLLER_KEYS };
enum { RULE_VALUE, RULE_UNIT, RULE_INITIAL, RULE_DELAY, RULE_QUANTUM, RULE_KEYS };

static const Key controller_key[CONTROLLER_KEYS] = {
    [CONTROLLER_PERIOD] = {"period", KEY_NUMBER, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [CONTROLLER_OFFSET] = {"offset", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 0},
    [CONTROLLER_RULES] = {"rules", KEY_RULES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
};

static const char *const controller_about[CONTROLLER_KEYS] = {
    [CONTROLLER_PERIOD] = "s from sample to sample, at least 1e-6",
    [CONTROLLER_OFFSET] = "time of the first sample, s; default 0",
    [CONTROLLER_RULES] = "what it holds: a formula each, or a map",
};

const Section controller_section = {controller_key, CONTROLLER_KEYS, NULL, 0, NULL, NULL, controller_about};

static const Key rule_key[RULE_KEYS] = {
    [RULE_VALUE] = {"value", KEY_FORMULA, ALL_FORMS, 0, BOUND_NONE, 0},
    [RULE_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
    [RULE_INITIAL] = {"initial", KEY_NUMBER, ALL_FORMS, 0, BOUND_NONE, 0},
    [RULE_DELAY] = {"delay", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 0},
    [RULE_QUANTUM] = {"quantum", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0},
};

static const char *const rule_about[RULE_KEYS] = {
    [RULE_VALUE] = "formula of the value; without it a function of the program supplies it",
    [RULE_UNIT] = "for people; default 1",
    [RULE_INITIAL] = "what is held before the first sample takes effect; default 0",
    [RULE_DELAY] = "s from a sample to when its value takes effect; default 0",
    [RULE_QUANTUM] = "values are rounded to multiples of it; default: not rounded",
};

const Section rule_section = {rule_key, RULE_KEYS, NULL, 0, NULL, NULL, rule_about};

static const double shortest_period = 1e-6, same = 1e-9 /* of a period */;
enum { WAITING_MOST = 100, NAME_MOST = 58 /* "name.next" is read by formulas */ };

/* A copy of an array that was not made by POOL_PUSH, and can grow by it. */
static void *room_to_push(Pool *pool, void *array, int count, size_t size)
{
    size_t room = 1;
    while (room < (size_t)count)
        room *= 2;
    return pool_grow(pool, array, (size_t)count * size, room * size);
}

static int state_add(Reader *reader, const char *name, const char *unit, Place at, double initial, bool read)
{
    Model *model = reader->model;
    *POOL_PUSH(reader->pool, model->state, model->states) =
        (State){.name = name, .unit = unit, .at = at, .initial = initial, .read = read};
    return model->states - 1;
}

static void rule_declare(Reader *reader, Controller *controller, const Entry *entry)
{
    Pool *pool = reader->pool;
    Value value[RULE_KEYS] = {{0}};
    const Entry named = {pool_print(pool, "%s.%s", controller->name, entry->name),
                         pool_print(pool, "rule '%s.%s'", controller->name, entry->name), entry->at, entry->item};
    if (strlen(named.name) > NAME_MOST)
        diag_fail(entry->at, "give the controller or the rule a shorter name", "'%s' has more than %d characters",
                  named.name, NAME_MOST);
    if (entry->item->kind != ITEM_SCALAR)
        section_read(reader, &rule_section, 0, &named, value);
    const double initial = value[RULE_INITIAL].number[0], delay = value[RULE_DELAY].number[0];
    initial_check(value[RULE_INITIAL].item, pool_print(pool, "initial of %s", named.what), initial);
    const double whole = floor(delay / controller->period + same);
    const double late = delay - whole * controller->period;
    ControlRule rule = {.name = named.name,
                        .signal = -1,
                        .waiting = (int)fmin(whole, WAITING_MOST + 1),
                        .late = late > same * controller->period ? late : 0,
                        .effects = -1,
                        .quantum = value[RULE_QUANTUM].number[0]};
    rule.waiting += rule.late > 0;
    if (rule.waiting > WAITING_MOST)
        diag_fail(value[RULE_DELAY].item->at, "shorten the delay or lengthen the period",
                  "%s: its delay is longer than %d periods", named.what, WAITING_MOST);
    const char *unit = value[RULE_UNIT].item ? value[RULE_UNIT].text : "1";
    rule.state = state_add(reader, rule.name, unit, entry->at, initial, false);
    for (int i = 0; i < rule.waiting; ++i)
        state_add(reader, pool_print(pool, "%s.%d", rule.name, i + 1), unit, entry->at, initial, true);
    if (rule.late > 0)
        rule.effects = state_add(reader, pool_print(pool, "%s.effects", rule.name), "1", entry->at, 0, true);
    *POOL_PUSH(pool, controller->rule, controller->rules) = rule;
}

/* The map of rules of a controller; mistakes in the rest of the entry end in diag_fail. */
static Entry *rules_of(Reader *reader, const Entry *entry, int *count)
{
    const Item *map = doc_find(entry->item, controller_key[CONTROLLER_RULES].name);
    Entry *rule = section_entries(reader, map, "rule", count);
    if (!*count)
        diag_fail(map->at, "write `rules: {name: formula}`", "%s holds nothing", entry->what);
    return rule;
}

void controllers_declare(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count, rules;
    Entry *entry = section_entries(reader, map, "controller", &count);
    model->controller = pool_alloc(reader->pool, sizeof *model->controller * (size_t)(count + 1));
    if (count) /* states grow by POOL_PUSH from here on */
        model->state = room_to_push(reader->pool, model->state, model->states, sizeof *model->state);
    for (int i = 0; i < count; ++i) {
        Controller *controller = &model->controller[i];
        Value value[CONTROLLER_KEYS];
        section_read(reader, &controller_section, 0, entry + i, value);
        formula_name_check(reader, entry + i, "controller");
        *controller = (Controller){.name = entry[i].name,
                                   .at = entry[i].at,
                                   .period = value[CONTROLLER_PERIOD].number[0],
                                   .offset = value[CONTROLLER_OFFSET].number[0]};
        if (controller->period < shortest_period)
            diag_fail(value[CONTROLLER_PERIOD].item->at, "write the period in seconds; what is quicker is a state",
                      "%s: its period is below 1e-6 s", entry[i].what);
        const Entry *rule = rules_of(reader, entry + i, &rules);
        for (int k = 0; k < rules; ++k)
            rule_declare(reader, controller, rule + k);
        controller->samples =
            state_add(reader, pool_print(reader->pool, "%s.samples", controller->name), "1", entry[i].at, 0, true);
    }
    model->controllers = count;
}

void controllers_place(Reader *reader)
{
    Model *model = reader->model;
    for (int i = model->states - model_held(model); i < model->states && model->controllers; ++i)
        model->state[i].fast = model->fast_states++;
}

/* An output with the name that a rule has in formulas would never be read. */
static void name_alone(const Model *model, const ControlRule *rule, Place at)
{
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            if (!strcmp(model->output[i].component[k], rule->name))
                diag_fail(at, "give the rule, the controller or the output another name",
                          "rule '%s' has the name of a component of output '%s'", rule->name, model->output[i].name);
}

static void rule_read(Reader *reader, ControlRule *rule, const Entry *entry)
{
    Model *model = reader->model;
    const char *name = pool_print(reader->pool, "%s.next", rule->name);
    const Item *formula =
        entry->item->kind == ITEM_SCALAR ? entry->item : doc_find(entry->item, rule_key[RULE_VALUE].name);
    const LawNames names = {.model = model, .reads = &reader->reads};
    name_alone(model, rule, entry->at);
    if (!formula)
        return;
    State *state = &model->state[rule->state];
    const bool read = state->read; /* by others: its own formula does not count */
    const Law *law =
        law_parse(reader->pool, formula, pool_print(reader->pool, "value of rule '%s'", rule->name), &names);
    state->read = read;
    rule->signal = model->signals;
    *POOL_PUSH(reader->pool, model->signal, model->signals) =
        (Signal){.name = name, .unit = state->unit, .at = entry->at, .law = law};
    *POOL_PUSH(reader->pool, model->output, model->outputs) = (Output){.name = name,
                                                                       .at = entry->at,
                                                                       .type = OUTPUT_SIGNAL,
                                                                       .body = BODY_GROUND,
                                                                       .in = BODY_GROUND,
                                                                       .index = rule->signal,
                                                                       .count = 1,
                                                                       .component = {name},
                                                                       .unit = {state->unit},
                                                                       .hidden = true,
                                                                       .sampled = true};
    ++model->output_components;
}

void controllers_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count, rules;
    Entry *entry = section_entries(reader, map, "controller", &count);
    if (!count)
        return;
    model->signal = room_to_push(reader->pool, model->signal, model->signals, sizeof *model->signal);
    const Output *before = model->output;
    model->output = room_to_push(reader->pool, model->output, model->outputs, sizeof *model->output);
    const int outputs = model->outputs;
    for (int i = 0; i < count; ++i) {
        const Entry *rule = rules_of(reader, entry + i, &rules);
        for (int k = 0; k < rules; ++k)
            rule_read(reader, &model->controller[i].rule[k], rule + k);
    }
    for (int i = 0; i < outputs; ++i) /* their place is another one by now */
        output_copy(model, &model->output[i], &before[i]);
    outputs_names_check(reader);
}
