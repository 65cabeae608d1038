/* SPDX-License-Identifier: MIT
 * The powertrain: POWERTRAIN.md section 1. */
#include "base/table.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <math.h>
#include <string.h>

enum { POWER_ENGINE, POWER_CONVERTER, POWER_TRANSMISSION, POWER_DIFFERENTIALS, POWER_KEYS };

static const Key powertrain_key[POWER_KEYS] = {
    [POWER_ENGINE] = {"engine", KEY_ENGINE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [POWER_CONVERTER] = {"converter", KEY_CONVERTER, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [POWER_TRANSMISSION] = {"transmission", KEY_TRANSMISSION, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [POWER_DIFFERENTIALS] = {"differentials", KEY_DIFFERENTIALS, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
};

static const char *const powertrain_about[POWER_KEYS] = {
    [POWER_ENGINE] = "what turns the converter",
    [POWER_CONVERTER] = "hydrodynamic torque converter between engine and transmission",
    [POWER_TRANSMISSION] = "automatic transmission",
    [POWER_DIFFERENTIALS] = "a tree of differentials from the transmission to the wheels, by names of their own",
};

const Section powertrain_section = {powertrain_key, POWER_KEYS, NULL, 0, NULL, NULL, powertrain_about};

enum { ENGINE_INERTIA, ENGINE_THROTTLE, ENGINE_TORQUE, ENGINE_IDLE, ENGINE_LIMIT, ENGINE_KEYS };

static const Key engine_key[ENGINE_KEYS] = {
    [ENGINE_INERTIA] = {"inertia", KEY_NUMBER, ALL_FORMS, ALL_FORMS, BOUND_POSITIVE, 0},
    [ENGINE_THROTTLE] = {"throttle", KEY_FORMULA, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ENGINE_TORQUE] = {"torque", KEY_FORMULA, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [ENGINE_IDLE] = {"idle", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0},
    [ENGINE_LIMIT] = {"limit", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0},
};

static const char *const engine_about[ENGINE_KEYS] = {
    [ENGINE_INERTIA] = "moment of inertia of all that turns with the crankshaft, converter pump included, kg m^2",
    [ENGINE_THROTTLE] = "what the driver demands, 0 to 1, any formula",
    [ENGINE_TORQUE] = "N m, any formula, also of speed (rad/s) and throttle (0 to 1)",
    [ENGINE_IDLE] = "speed below which the governor opens the throttle, rad/s; default: no governor",
    [ENGINE_LIMIT] = "speed at which the throttle is shut, rad/s; default: none",
};

const Section engine_section = {engine_key, ENGINE_KEYS, NULL, 0, NULL, NULL, engine_about};

enum { CONVERTER_CAPACITY, CONVERTER_TORQUE, CONVERTER_KEYS };

static const Key converter_key[CONVERTER_KEYS] = {
    [CONVERTER_CAPACITY] = {"capacity", KEY_TABLE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [CONVERTER_TORQUE] = {"torque", KEY_TABLE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
};

static const char *const converter_about[CONVERTER_KEYS] = {
    [CONVERTER_CAPACITY] = "table of pump speed over root of pump torque (rad/s / sqrt(N m)) over the speed ratio",
    [CONVERTER_TORQUE] = "table of turbine torque over pump torque over the speed ratio",
};

const Section converter_section = {converter_key, CONVERTER_KEYS, NULL, 0, NULL, NULL, converter_about};

enum {
    SHIFT_FORWARD,
    SHIFT_REVERSE,
    SHIFT_SELECTOR,
    SHIFT_UP,
    SHIFT_DOWN,
    SHIFT_LATENCY,
    SHIFT_DURATION,
    SHIFT_INERTIA,
    SHIFT_KEYS
};

static const Key transmission_key[SHIFT_KEYS] = {
    [SHIFT_FORWARD] = {"forward", KEY_SERIES, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [SHIFT_REVERSE] = {"reverse", KEY_SERIES, ALL_FORMS, 0, BOUND_NONE, 0},
    [SHIFT_SELECTOR] = {"selector", KEY_FORMULA, ALL_FORMS, 0, BOUND_NONE, 0},
    [SHIFT_UP] = {"up", KEY_SERIES, ALL_FORMS, 0, BOUND_NONE, 0},
    [SHIFT_DOWN] = {"down", KEY_SERIES, ALL_FORMS, 0, BOUND_NONE, 0},
    [SHIFT_LATENCY] = {"latency", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 1},
    [SHIFT_DURATION] = {"duration", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0.3},
    [SHIFT_INERTIA] = {"inertia", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 0},
};

static const char *const transmission_about[SHIFT_KEYS] = {
    [SHIFT_FORWARD] = "turbine speed over output speed of the gears 1, 2, ..., each > 0",
    [SHIFT_REVERSE] = "the same of the gears -1, -2, ..., each < 0; default: none",
    [SHIFT_SELECTOR] = "formula: above 0.5 forward, below -0.5 reverse, else neutral; default 1",
    [SHIFT_UP] = "turbine speeds above which gear 1, 2, ... becomes the next, rad/s, any formulas",
    [SHIFT_DOWN] = "turbine speeds below which gear 2, 3, ... becomes the one before, rad/s, any formulas",
    [SHIFT_LATENCY] = "least time from one shift to the next, s; default 1",
    [SHIFT_DURATION] = "time that a shift takes, s; default 0.3",
    [SHIFT_INERTIA] = "moment of inertia of what turns with the turbine, kg m^2; default 0",
};

const Section transmission_section = {transmission_key, SHIFT_KEYS, NULL, 0, NULL, NULL, transmission_about};

enum { SPLIT_OUTPUTS, SPLIT_RATIO, SPLIT_SPLIT, SPLIT_INERTIA, SPLIT_LOCK, SPLIT_KEYS };

static const Key differential_key[SPLIT_KEYS] = {
    [SPLIT_OUTPUTS] = {"outputs", KEY_OUTPUTS, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [SPLIT_RATIO] = {"ratio", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 1},
    [SPLIT_SPLIT] = {"split", KEY_NUMBER, ALL_FORMS, 0, BOUND_POSITIVE, 0.5},
    [SPLIT_INERTIA] = {"inertia", KEY_NUMBER, ALL_FORMS, 0, BOUND_NOT_NEGATIVE, 0},
    [SPLIT_LOCK] = {"lock", KEY_FORMULA, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const differential_about[SPLIT_KEYS] = {
    [SPLIT_OUTPUTS] = "one or two names of wheels with tires or of other differentials",
    [SPLIT_RATIO] = "input speed over mean output speed; default 1",
    [SPLIT_SPLIT] = "share of the torque that the first output gets; default 0.5",
    [SPLIT_INERTIA] = "moment of inertia of what turns with its input, kg m^2; default 0",
    [SPLIT_LOCK] = "torque up to which it resists a difference of speeds, N m, any formula; default 0",
};

const Section differential_section = {differential_key, SPLIT_KEYS, NULL, 0, NULL, NULL, differential_about};

/* ---- engine, converter, transmission ---------------------------------------------------------------------------- */

static const char *of(Reader *reader, const Key *key, const char *what)
{
    return pool_print(reader->pool, "%s of %s", key->name, what);
}

/* What formulas of the powertrain read. */
static LawNames law_names(Reader *reader)
{
    return (LawNames){.model = reader->model, .reads = &reader->reads, .early = "the powertrain"};
}

static void engine_read(Reader *reader, const Item *item, Powertrain *powertrain)
{
    static const char what[] = "the engine", *const local[] = {"speed", "throttle"};
    const LawNames plain = law_names(reader);
    LawNames names = law_names(reader);
    names.local = local;
    names.locals = 2;
    names.hide = true;
    Value value[ENGINE_KEYS];
    section_read(reader, &engine_section, 0, &(Entry){"engine", what, item->at, item}, value);
    powertrain->inertia = value[ENGINE_INERTIA].number[0];
    powertrain->idle = value[ENGINE_IDLE].number[0];
    powertrain->limit = value[ENGINE_LIMIT].number[0];
    if (value[ENGINE_LIMIT].item && powertrain->limit <= powertrain->idle)
        diag_fail(value[ENGINE_LIMIT].item->at, "write a speed above `idle`, rad/s",
                  "limit of the engine is not above its idle speed, so that it could not run");
    powertrain->throttle =
        law_parse(reader->pool, value[ENGINE_THROTTLE].item, of(reader, &engine_key[ENGINE_THROTTLE], what), &plain);
    powertrain->torque =
        law_parse(reader->pool, value[ENGINE_TORQUE].item, of(reader, &engine_key[ENGINE_TORQUE], what), &names);
}

static void converter_read(Reader *reader, const Item *item, Powertrain *powertrain)
{
    Value value[CONVERTER_KEYS];
    section_read(reader, &converter_section, 0, &(Entry){"converter", "the converter", item->at, item}, value);
    powertrain->capacity = value[CONVERTER_CAPACITY].index[0];
    powertrain->multiplication = value[CONVERTER_TORQUE].index[0];
    const Table *capacity = &reader->model->table[powertrain->capacity];
    /* a table is monotone between its points, so the points suffice */
    bool positive = table_value(capacity, 0) > 0 && table_value(capacity, 1) > 0;
    for (int i = 0; i < capacity->count; ++i)
        positive = positive && (capacity->y[i] > 0 || capacity->x[i] < 0 || capacity->x[i] > 1);
    if (!positive)
        diag_fail(value[CONVERTER_CAPACITY].item->at, "give the table values above 0",
                  "capacity of the converter: '%s' is not above 0 for all speed ratios from 0 to 1", capacity->name);
}

static const Item *series(const Item *item, const char *what)
{
    if (item->kind != ITEM_LIST)
        diag_fail(item->at, "write [first, ...]", "%s must be a list", what);
    return item;
}

static void gears_read(Reader *reader, const Value *value, Powertrain *powertrain)
{
    const Item *forward = series(value[SHIFT_FORWARD].item, "forward of the transmission");
    const Item *reverse = value[SHIFT_REVERSE].item;
    if (reverse)
        reverse = series(reverse, "reverse of the transmission");
    if (!forward->count)
        diag_fail(forward->at, "write the ratio of at least one gear", "the transmission has no forward gear");
    powertrain->forward = forward->count;
    powertrain->reverse = reverse ? reverse->count : 0;
    powertrain->gear =
        pool_alloc(reader->pool, (size_t)(powertrain->forward + powertrain->reverse + 1) * sizeof(double));
    for (int gear = -powertrain->reverse; gear <= powertrain->forward; ++gear) {
        if (gear == 0)
            continue;
        const Item *item = gear > 0 ? forward->value[gear - 1] : reverse->value[-gear - 1];
        const char *what = pool_print(reader->pool, "ratio of gear %d", gear);
        double ratio = number_read(reader, item, what, NULL);
        if (gear > 0 ? !(ratio > 0) : !(ratio < 0))
            diag_fail(item->at, gear > 0 ? "write a positive number" : "write a negative number",
                      "%s must be %s than zero, not %s", what, gear > 0 ? "greater" : "less", item->text);
        powertrain->gear[powertrain->reverse + gear] = ratio;
    }
}

/* A shift formula for each pair of neighbouring forward gears. */
static const Law **shifts_read(Reader *reader, const Item *map, const Value *value, int key, int count)
{
    const char *what = of(reader, &transmission_key[key], "the transmission");
    LawNames names = law_names(reader);
    names.barred = "formulas of gears"; /* which are evaluated after a step, without the bodies */
    const Law **law = pool_alloc(reader->pool, (size_t)(count + 1) * sizeof *law);
    const Item *item = value[key].item;
    if (!item && count)
        diag_fail(map->at,
                  pool_print(reader->pool, "add `%s: [...]`: turbine speeds, rad/s", transmission_key[key].name),
                  "the transmission lacks the key '%s', with which it changes gears", transmission_key[key].name);
    if (item && series(item, what)->count != count)
        diag_fail(item->at, "give one speed for every two neighbouring forward gears",
                  "%s has %d speeds, but there are %d forward gears", what, item->count, count + 1);
    for (int i = 0; i < count; ++i)
        law[i] = law_parse(reader->pool, item->value[i], what, &names);
    return law;
}

static int start_gear(const Model *model, const Powertrain *powertrain)
{
    const double engages = 0.5 + 1.5e-9; /* larger than 0.5 by more than rounding, as for the choice of gears at run
                                          * time */
    double selector = powertrain->selector ? law_number(powertrain->selector, model) : 1;
    return selector > engages ? 1 : selector < -engages && powertrain->reverse ? -1 : 0;
}

static void transmission_read(Reader *reader, const Item *item, Powertrain *powertrain)
{
    static const char what[] = "the transmission";
    LawNames names = law_names(reader);
    names.barred = "formulas of gears";
    Value value[SHIFT_KEYS];
    section_read(reader, &transmission_section, 0, &(Entry){"transmission", what, item->at, item}, value);
    gears_read(reader, value, powertrain);
    if (value[SHIFT_SELECTOR].item)
        powertrain->selector = law_parse(reader->pool, value[SHIFT_SELECTOR].item,
                                         of(reader, &transmission_key[SHIFT_SELECTOR], what), &names);
    powertrain->up = shifts_read(reader, item, value, SHIFT_UP, powertrain->forward - 1);
    powertrain->down = shifts_read(reader, item, value, SHIFT_DOWN, powertrain->forward - 1);
    powertrain->latency = value[SHIFT_LATENCY].number[0];
    powertrain->duration = value[SHIFT_DURATION].number[0];
    powertrain->turbine = value[SHIFT_INERTIA].number[0];
    powertrain->start_gear = start_gear(reader->model, powertrain);
}

/* ---- differentials ----------------------------------------------------------------------------------------------- */

/* The tree while it is built; indices are those of the file. */
typedef struct Tree {
    Reader *reader;
    Entry *entry;
    int count;
    Differential *differential;
    const Item **used_wheel, **used; /* [wheels], [count] the item that names it as an output; NULL: none so far */
} Tree;

static int wheel_named(const Model *model, const char *name)
{
    int i = 0;
    while (i < model->wheels && strcmp(model->wheel[i].name, name))
        ++i;
    return i < model->wheels ? i : -1;
}

static int differential_named(const Tree *tree, const char *name)
{
    int i = 0;
    while (i < tree->count && strcmp(tree->entry[i].name, name))
        ++i;
    return i < tree->count ? i : -1;
}

static _Noreturn void unknown_output(const Tree *tree, const Item *item, const char *what)
{
    const Model *model = tree->reader->model;
    Pool *pool = tree->reader->pool;
    const char **name = NULL;
    int names = 0;
    for (int i = 0; i < model->wheels; ++i)
        if (model->wheel[i].tire >= 0)
            *POOL_PUSH(pool, name, names) = model->wheel[i].name;
    for (int i = 0; i < tree->count; ++i)
        *POOL_PUSH(pool, name, names) = tree->entry[i].name;
    const char *nearest = diag_nearest(item->text, name, names);
    diag_fail(item->at,
              nearest ? pool_print(pool, "did you mean '%s'?", nearest)
                      : "name a wheel with a tire, or another differential",
              "%s: there is no wheel and no differential '%s'", what, item->text);
}

static void output_read(Tree *tree, const Item *item, const char *what, int index, int which)
{
    const Model *model = tree->reader->model;
    Differential *differential = &tree->differential[index];
    const char *name = doc_word(item, what);
    int wheel = wheel_named(model, name), other = differential_named(tree, name);
    if (wheel < 0 && other < 0)
        unknown_output(tree, item, what);
    if (wheel >= 0 && model->wheel[wheel].tire < 0)
        diag_fail(item->at, "give that wheel a tire", "%s: wheel '%s' has no tire, so it can't be driven", what, name);
    const Item **used = wheel >= 0 ? &tree->used_wheel[wheel] : &tree->used[other];
    if (*used)
        diag_fail(item->at, "take one of the two away", "%s: '%s' is an output already, in line %d", what, name,
                  (*used)->at.line);
    *used = item;
    differential->wheel[which] = wheel;
    differential->differential[which] = other;
}

static void differential_read(Tree *tree, int index)
{
    static const int of_two[] = {SPLIT_SPLIT, SPLIT_LOCK};
    Reader *reader = tree->reader;
    const Entry *entry = &tree->entry[index];
    const LawNames names = law_names(reader);
    Differential *differential = &tree->differential[index];
    Value value[SPLIT_KEYS];
    if (wheel_named(reader->model, entry->name) >= 0)
        diag_fail(entry->at, "rename one of the two: outputs name either", "%s has the name of a wheel", entry->what);
    section_read(reader, &differential_section, 0, entry, value);
    const Item *outputs = value[SPLIT_OUTPUTS].item;
    const char *what = of(reader, &differential_key[SPLIT_OUTPUTS], entry->what);
    if (outputs->kind != ITEM_LIST || outputs->count < 1 || outputs->count > 2)
        diag_fail(outputs->at, "write [first, second], or [one] for a final drive",
                  "%s must be a list of one or two names", what);
    *differential = (Differential){.name = entry->name,
                                   .at = entry->at,
                                   .outputs = outputs->count,
                                   .wheel = {-1, -1},
                                   .differential = {-1, -1},
                                   .ratio = value[SPLIT_RATIO].number[0],
                                   .split = outputs->count == 2 ? value[SPLIT_SPLIT].number[0] : 1,
                                   .inertia = value[SPLIT_INERTIA].number[0]};
    for (int i = 0; i < outputs->count; ++i)
        output_read(tree, outputs->value[i], what, index, i);
    for (int i = 0; i < 2 && outputs->count == 1; ++i)
        if (value[of_two[i]].item)
            diag_fail(value[of_two[i]].item->at, "take it away, or name two outputs", "%s says nothing with one output",
                      of(reader, &differential_key[of_two[i]], entry->what));
    if (outputs->count == 2 && !(differential->split < 1))
        diag_fail(value[SPLIT_SPLIT].item->at, "write a number between 0 and 1", "%s must be less than 1, not %s",
                  of(reader, &differential_key[SPLIT_SPLIT], entry->what), value[SPLIT_SPLIT].item->text);
    if (value[SPLIT_LOCK].item)
        differential->lock = law_parse(reader->pool, value[SPLIT_LOCK].item,
                                       of(reader, &differential_key[SPLIT_LOCK], entry->what), &names);
    if (differential->lock && differential->lock->op == LAW_NUMBER && differential->lock->number < 0)
        diag_fail(value[SPLIT_LOCK].item->at, "write the torque up to which it holds its outputs together",
                  "%s must not be negative, as %g is: it would drive them apart",
                  of(reader, &differential_key[SPLIT_LOCK], entry->what), differential->lock->number);
}

/* Append a differential after those that it drives; returns its index. The depth of the recursion is at most the
 * number of members. */
static int append(Tree *tree, int index, Powertrain *powertrain)
{
    Differential differential = tree->differential[index];
    for (int i = 0; i < differential.outputs; ++i)
        if (differential.differential[i] >= 0)
            differential.differential[i] = append(tree, differential.differential[i], powertrain);
    powertrain->differential[powertrain->differentials] = differential;
    return powertrain->differentials++;
}

static void differentials_read(Reader *reader, const Item *map, Powertrain *powertrain)
{
    Tree tree = {.reader = reader};
    tree.entry = section_entries(reader, map, "differential", &tree.count);
    const size_t count = (size_t)tree.count + 1;
    tree.differential = pool_alloc(reader->pool, count * sizeof *tree.differential);
    tree.used = pool_alloc(reader->pool, count * sizeof *tree.used);
    tree.used_wheel = pool_alloc(reader->pool, (size_t)(reader->model->wheels + 1) * sizeof *tree.used_wheel);
    powertrain->differential = pool_alloc(reader->pool, count * sizeof *powertrain->differential);
    if (!tree.count)
        diag_fail(map->at, "write `name: {outputs: [wheel, wheel]}`", "the powertrain has no differential");
    for (int i = 0; i < tree.count; ++i)
        differential_read(&tree, i);
    int root = -1;
    for (int i = 0; i < tree.count; ++i) {
        if (tree.used[i])
            continue;
        if (root >= 0)
            diag_fail(tree.entry[i].at, "make one of the two an output of another differential",
                      "%s is no output of another one, and neither is '%s': the transmission drives only one",
                      tree.entry[i].what, tree.entry[root].name);
        root = i;
    }
    if (root >= 0)
        append(&tree, root, powertrain);
    for (int i = 0; i < tree.count; ++i) {
        bool reached = false;
        for (int k = 0; k < powertrain->differentials; ++k)
            reached = reached || !strcmp(powertrain->differential[k].name, tree.entry[i].name);
        if (!reached)
            diag_fail(tree.entry[i].at, "let the transmission drive one of them, and that one the others",
                      "%s drives itself, in a circle of outputs", tree.entry[i].what);
    }
}

/* ---- all of it ----------------------------------------------------------------------------------------------------
 */

/* Names of the powertrain's states must differ from those of other states. */
static void states_check(Reader *reader, Place at)
{
    const Model *model = reader->model;
    const size_t count = (size_t)model->coordinates + POWERTRAIN_FAST;
    const char **name = pool_alloc(reader->pool, count * sizeof *name);
    Place *place = pool_alloc(reader->pool, count * sizeof *place);
    for (int i = 0; i < POWERTRAIN_FAST; ++i) {
        name[i] = powertrain_fast_name[i];
        place[i] = at;
    }
    for (int i = 0; i < model->coordinates; ++i) {
        name[POWERTRAIN_FAST + i] = model->coordinate[i].name;
        place[POWERTRAIN_FAST + i] = model->coordinate[i].at;
    }
    generated_names_check(reader, "state", name, place, (int)count);
}

/* The speed of a differential's input per unit spin of a wheel. */
static double geared(const Powertrain *powertrain, int index, int wheel)
{
    const Differential *differential = &powertrain->differential[index];
    double sum = 0;
    for (int k = 0; k < differential->outputs; ++k) {
        const double share = differential->ratio * (k ? 1 - differential->split : differential->split);
        const int other = differential->differential[k];
        sum += share * (other >= 0 ? geared(powertrain, other, wheel) : differential->wheel[k] == wheel);
    }
    return sum;
}

/* The inertia that turns with a wheel, felt at the wheel, may be a million times the wheel's own: the equations of
 * spins lose that many digits. */
static void inertias_check(const Model *model, const Powertrain *powertrain, Place transmission)
{
    const double most = 1e6;
    double gear = 0;
    for (int i = 0; i < powertrain->reverse + 1 + powertrain->forward; ++i)
        gear = fmax(gear, fabs(powertrain->gear[i]));
    for (int w = 0; w < model->wheels; ++w) {
        const Wheel *wheel = &model->wheel[w];
        for (int i = 0; i < powertrain->differentials; ++i) {
            const Differential *differential = &powertrain->differential[i];
            const double ratio = geared(powertrain, i, w), square = ratio * ratio;
            if (differential->inertia * square > most * wheel->spin_inertia)
                diag_fail(differential->at, "give it less inertia, or the wheel more spin_inertia",
                          "at wheel '%s' the inertia of differential '%s' counts as %g kg m^2, above %g times that of "
                          "the wheel's spin",
                          wheel->name, differential->name, differential->inertia * square, most);
            if (i == powertrain->differentials - 1 &&
                powertrain->turbine * gear * gear * square > most * wheel->spin_inertia)
                diag_fail(transmission, "give it less inertia, or the wheel more spin_inertia",
                          "at wheel '%s' the inertia of the transmission counts as %g kg m^2, above %g times that of "
                          "the wheel's spin",
                          wheel->name, powertrain->turbine * gear * gear * square, most);
        }
    }
}

void powertrain_read(Reader *reader, const Item *item)
{
    Value value[POWER_KEYS];
    if (!item)
        return;
    Powertrain *powertrain = pool_alloc(reader->pool, sizeof *powertrain);
    section_read(reader, &powertrain_section, 0, &(Entry){"powertrain", "the powertrain", item->at, item}, value);
    *powertrain = (Powertrain){.at = item->at, .fast = reader->model->fast_states};
    engine_read(reader, value[POWER_ENGINE].item, powertrain);
    converter_read(reader, value[POWER_CONVERTER].item, powertrain);
    transmission_read(reader, value[POWER_TRANSMISSION].item, powertrain);
    differentials_read(reader, value[POWER_DIFFERENTIALS].item, powertrain);
    inertias_check(reader->model, powertrain, value[POWER_TRANSMISSION].item->at);
    states_check(reader, item->at);
    reader->model->powertrain = powertrain;
    reader->model->fast_states += POWERTRAIN_FAST;
}
