/* SPDX-License-Identifier: MIT
 * What formulas refer to: parameters, tables, ports (FORMAT.md section 6). */
#include "base/table.h"
#include "base/yaml.h"
#include "model/model.h"
#include "read/reader.h"

#include <string.h>

enum { PARAMETER_VALUE, PARAMETER_UNIT, PARAMETER_TUNABLE, PARAMETER_KEYS };

static const Key parameter_key[PARAMETER_KEYS] = {
    [PARAMETER_VALUE] = {"value", KEY_MEASURE, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [PARAMETER_UNIT] = {"unit", KEY_TEXT, ALL_FORMS, 0, BOUND_NONE, 0},
    [PARAMETER_TUNABLE] = {"tunable", KEY_FLAG, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const parameter_about[PARAMETER_KEYS] = {
    [PARAMETER_VALUE] = "the number, in the unit that is stated",
    [PARAMETER_UNIT] = "for people; default 1",
    [PARAMETER_TUNABLE] = "true: may be changed at run time",
};

const Section parameter_section = {parameter_key, PARAMETER_KEYS, NULL, 0, NULL, NULL, parameter_about};

enum { TABLE_X, TABLE_Y, TABLE_INTERPOLATION, TABLE_BEYOND, TABLE_KEYS };

static const Key table_key[TABLE_KEYS] = {
    [TABLE_X] = {"x", KEY_LIST, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [TABLE_Y] = {"y", KEY_LIST, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [TABLE_INTERPOLATION] = {"interpolation", KEY_INTERPOLATION, ALL_FORMS, 0, BOUND_NONE, 0},
    [TABLE_BEYOND] = {"beyond", KEY_BEYOND, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const table_about[TABLE_KEYS] = {
    [TABLE_X] = "rising numbers, at least two",
    [TABLE_Y] = "values, one for each x",
    [TABLE_INTERPOLATION] = "between the points: `linear` (default) or `cubic`, which is monotone where the points are",
    [TABLE_BEYOND] = "beyond the ends: `constant` (default), or `linear` on along the slope at the end",
};

const Section table_section = {table_key, TABLE_KEYS, NULL, 0, NULL, NULL, table_about};

enum { PORT_BODY, PORT_POINT, PORT_IN, PORT_KEYS };

static const Key port_key[PORT_KEYS] = {
    [PORT_BODY] = {"body", KEY_BODY, ALL_FORMS, ALL_FORMS, BOUND_NONE, 0},
    [PORT_POINT] = {"point", KEY_POINT, ALL_FORMS, 0, BOUND_NONE, 0},
    [PORT_IN] = {"in", KEY_FRAME, ALL_FORMS, 0, BOUND_NONE, 0},
};

static const char *const port_about[PORT_KEYS] = {
    [PORT_BODY] = "the body that the force and the torque act on",
    [PORT_POINT] = "where the force acts, at design, m, model frame; default: origin of the body frame",
    [PORT_IN] = "the body in whose frame force (N) and torque (N m) are given; default `world`",
};

const Section port_section = {port_key, PORT_KEYS, NULL, 0, NULL, NULL, port_about};

/* A parameter is `name: number` or `name: {value: number, ...}`. */
void parameters_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int count;
    Entry *entry = section_entries(reader, map, "parameter", &count);
    model->parameter = pool_alloc(reader->pool, sizeof *model->parameter * (size_t)(count + 1));
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(count + 1));
    Place *at = pool_alloc(reader->pool, sizeof *at * (size_t)(count + 1));
    const LawNames names = {.model = model, .constant = true};
    /* a parameter may use those before it */
    for (int i = 0; i < count; model->parameters = ++i) {
        Value value[PARAMETER_KEYS] = {{0}};
        if (entry[i].item->kind == ITEM_MAP)
            section_read(reader, &parameter_section, 0, entry + i, value);
        else
            value[PARAMETER_VALUE].number[0] =
                number_read(reader, entry[i].item, entry[i].what, value[PARAMETER_VALUE].tuned);
        const Item *item = value[PARAMETER_VALUE].item ? value[PARAMETER_VALUE].item : entry[i].item;
        bool tuned = value[PARAMETER_VALUE].tuned[0], tunable = value[PARAMETER_TUNABLE].flag;
        if (tuned && tunable)
            diag_fail(item->at, "leave out `tunable: true`: it changes with those it is made of",
                      "%s follows other tunable parameters, so it has no value of its own", entry[i].what);
        model->parameter[i] = (Parameter){
            .name = entry[i].name,
            .at = entry[i].at,
            .unit = value[PARAMETER_UNIT].item ? value[PARAMETER_UNIT].text : "1",
            .value = value[PARAMETER_VALUE].number[0],
            .tunable = tunable,
            .index = tunable ? model->tunables++ : -1,
            .law = tuned ? law_parse(reader->pool, item, entry[i].what, &names) : NULL,
        };
        name[i] = entry[i].name;
        at[i] = entry[i].at;
    }
    generated_names_check(reader, "parameter", name, at, model->parameters);
}

static double *numbers(Reader *reader, const Value *value, const char *what, int *count)
{
    const Item *item = value->item;
    if (item->kind != ITEM_LIST || item->count < 2)
        diag_fail(item->at, "write [first, second, ...], at least two numbers", "%s must be a list of numbers", what);
    double *out = pool_alloc(reader->pool, sizeof *out * (size_t)item->count);
    vector_read(reader, item, what, out, item->count, NULL);
    *count = item->count;
    return out;
}

void tables_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    int tables;
    Entry *entry = section_entries(reader, map, "table", &tables);
    model->table = pool_alloc(reader->pool, sizeof *model->table * (size_t)(tables + 1));
    /* numbers of a table may be formulas of parameters */
    for (int i = 0; i < tables; model->tables = ++i) {
        Value value[TABLE_KEYS];
        Table *table = &model->table[i];
        int count;
        section_read(reader, &table_section, 0, entry + i, value);
        *table = (Table){.name = entry[i].name, .at = entry[i].at};
        table->x = numbers(reader, &value[TABLE_X], pool_print(reader->pool, "x of %s", entry[i].what), &table->count);
        table->y = numbers(reader, &value[TABLE_Y], pool_print(reader->pool, "y of %s", entry[i].what), &count);
        if (count != table->count)
            diag_fail(value[TABLE_Y].item->at, "give one y for every x", "%s has %d x but %d y", entry[i].what,
                      table->count, count);
        for (int k = 1; k < count; ++k)
            if (!(table->x[k] > table->x[k - 1]))
                diag_fail(value[TABLE_X].item->value[k]->at, "sort the table by x, without repetitions",
                          "x of %s must rise", entry[i].what);
        table->cubic = value[TABLE_INTERPOLATION].flag;
        table->onward = value[TABLE_BEYOND].flag;
        table->slope = pool_alloc(reader->pool, sizeof *table->slope * (size_t)count);
        table_slopes(table);
    }
}

void ports_read(Reader *reader, const Item *map)
{
    Model *model = reader->model;
    Entry *entry = section_entries(reader, map, "port", &model->ports);
    model->port = pool_alloc(reader->pool, sizeof *model->port * (size_t)(model->ports + 1));
    const char **name = pool_alloc(reader->pool, sizeof *name * (size_t)(model->ports + 1));
    Place *at = pool_alloc(reader->pool, sizeof *at * (size_t)(model->ports + 1));
    for (int i = 0; i < model->ports; ++i) {
        Value value[PORT_KEYS];
        section_read(reader, &port_section, 0, entry + i, value);
        Port *port = &model->port[i];
        *port = (Port){.name = entry[i].name,
                       .at = entry[i].at,
                       .body = value[PORT_BODY].index[0],
                       .in = value[PORT_IN].item ? value[PORT_IN].index[0] : BODY_GROUND};
        if (!model->free_base && port->body == BODY_BASE)
            diag_fail(value[PORT_BODY].item->at, "name a body that can move", "%s: a force on ground moves nothing",
                      entry[i].what);
        if (value[PORT_POINT].item)
            body_point(reader, port->body, value[PORT_POINT].number, value[PORT_POINT].tuned,
                       value[PORT_POINT].item->at, port->point);
        name[i] = port->name;
        at[i] = port->at;
    }
    generated_names_check(reader, "port", name, at, model->ports);
}
