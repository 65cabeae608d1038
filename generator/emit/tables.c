/* SPDX-License-Identifier: MIT
 * The constant tables that the descriptor of emitted code points to: names, units, places. */
#include "base/text.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "vehicle/vehicle.h"

static void open_table(Generation *g, Text *out, const char *type, const char *name, int count)
{
    line(out, 0, "static const %s%s_%s[%d] = {", type, g->model->name, name, room(count));
}

static void close_table(Text *out, int count, const char *empty)
{
    if (!count)
        line(out, 4, "%s", empty);
    line(out, 0, "};\n");
}

static void write_signal(Generation *g, Text *out, const char *name, const char *unit)
{
    line(out, 4, "{%s, %s},", quoted(g->pool, name), quoted(g->pool, unit));
}

static void write_signal_tables(Generation *g, Text *out)
{
    const Model *model = g->model;
    static const char none[] = "{NULL, NULL}";
    open_table(g, out, "gic_signal ", "state_signal", states(g));
    for (int i = 0; i < states(g); ++i) {
        const StateNumber number = state_number(g->pool, g->formulation, i);
        write_signal(g, out, number.name, number.unit);
    }
    close_table(out, states(g), none);
    open_table(g, out, "gic_signal ", "discrete_signal", room(model_discretes(model)));
    if (model->free_base || !model->powertrain)
        write_signal(g, out, "dependent_euler_parameter", "1");
    for (int i = 0; model->powertrain && i < POWERTRAIN_DISCRETE; ++i)
        write_signal(g, out, powertrain_discrete_name[i], "1");
    close_table(out, 1, none);
    open_table(g, out, "gic_signal ", "input_signal", model->inputs);
    for (int i = 0; i < model->inputs; ++i)
        write_signal(g, out, model->input[i].name, model->input[i].unit);
    close_table(out, model->inputs, none);
    open_table(g, out, "gic_signal ", "parameter_signal", model->tunables);
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            write_signal(g, out, model->parameter[i].name, model->parameter[i].unit);
    close_table(out, model->tunables, none);
    open_table(g, out, "gic_signal ", "port_signal", 6 * model->ports);
    for (int i = 0; i < 6 * model->ports; ++i) {
        static const char *const part[6] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
        write_signal(g, out, pool_print(g->pool, "%s.%s", model->port[i / 6].name, part[i % 6]),
                     i % 6 < 3 ? "N" : "N m");
    }
    close_table(out, 6 * model->ports, none);
    open_table(g, out, "gic_signal ", "output_signal", model->output_components);
    for (int i = 0; i < model->outputs; ++i)
        for (int c = 0; c < model->output[i].count; ++c)
            write_signal(g, out, model->output[i].component[c], model->output[i].unit[c]);
    close_table(out, model->output_components, none);
    open_table(g, out, "gic_signal ", "coordinate_signal", model->coordinates);
    for (int i = 0; i < model->coordinates; ++i)
        write_signal(g, out, model->coordinate[i].name, model->coordinate[i].type == COORDINATE_ANGLE ? "rad" : "m");
    close_table(out, model->coordinates, none);
}

static void write_coordinate_tables(Generation *g, Text *out)
{
    const Model *model = g->model;
    static const char *const number[] = {"coordinate_design", "coordinate_low", "coordinate_high"};
    for (int t = 0; t < 3; ++t) {
        open_table(g, out, "gic_real ", number[t], model->coordinates);
        for (int i = 0; i < model->coordinates; ++i) {
            const Coordinate *c = &model->coordinate[i];
            line(out, 4, "%s,", emit_number(g->pool, t == 0 ? c->design : c->range[t - 1]));
        }
        close_table(out, model->coordinates, "R(0.0)");
    }
    static const char *const place[] = {"coordinate_state", "coordinate_input"};
    for (int t = 0; t < 2; ++t) {
        open_table(g, out, "int32_t ", place[t], model->coordinates);
        for (int i = 0; i < model->coordinates; ++i) {
            const Coordinate *c = &model->coordinate[i];
            line(out, 4, "%d,", t == 0 ? g->plan->coordinate_state[i] : c->driven ? c->input : -1);
        }
        close_table(out, model->coordinates, "-1");
    }
}

static void write_controller_tables(Generation *g, Text *out)
{
    const Model *model = g->model;
    const int first = g->plan->states;
    int rules = 0;
    for (int i = 0; i < model->controllers; ++i)
        rules += model->controller[i].rules;
    if (!rules)
        return;
    open_table(g, out, "gic_rule ", "rule", rules);
    for (int i = 0; i < model->controllers; ++i)
        for (int k = 0; k < model->controller[i].rules; ++k) {
            const ControlRule *rule = &model->controller[i].rule[k];
            line(out, 4, "{%d, %d, %d, %d, %s, %s}, /* %s */", first + model->state[rule->state].fast,
                 rule_output(model, rule), rule->waiting,
                 rule->effects < 0 ? -1 : first + model->state[rule->effects].fast, emit_number(g->pool, rule->late),
                 emit_number(g->pool, rule->quantum), rule->name);
        }
    close_table(out, rules, "");
    open_table(g, out, "gic_controller ", "controller", model->controllers);
    for (int i = 0, at = 0; i < model->controllers; at += model->controller[i++].rules) {
        const Controller *controller = &model->controller[i];
        line(out, 4, "{%s, %s, %s, %d, %d, %s_rule + %d},", quoted(g->pool, controller->name),
             emit_number(g->pool, controller->period), emit_number(g->pool, controller->offset),
             first + model->state[controller->samples].fast, controller->rules, model->name, at);
    }
    close_table(out, model->controllers, "");
}

void write_controllers(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const int count = g->model->controllers;
    line(out, indent, "%d,", count);
    line(out, indent, "%s,", count ? pool_print(g->pool, "%s_controller", g->model->name) : "NULL");
}

static void write_contact_table(Generation *g, Text *out)
{
    const Block *contacts = g->formulation->contacts;
    ContactSite site;
    if (!contacts)
        return;
    open_table(g, out, "char *const ", "contact_name", contacts->stores);
    for (int i = 0; i < contacts->stores && model_contact(g->model, i, &site); ++i)
        line(out, 4, "%s,", quoted(g->pool, contact_text(g->pool, &site)));
    close_table(out, contacts->stores, "");
}

void write_contacts(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Block *contacts = g->formulation->contacts;
    line(out, indent, "%s,", contacts ? pool_print(g->pool, "%s_CONTACTS", g->upper) : "0");
    line(out, indent, "%s,", contacts ? pool_print(g->pool, "&%s_contacts", g->model->name) : "NULL");
}

void write_tables(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    write_signal_tables(g, out);
    write_coordinate_tables(g, out);
    open_table(g, out, "char *const ", "subset_name", g->sequence->subsets);
    for (int s = 0; s < g->sequence->subsets; ++s)
        line(out, 4, "%s,", quoted(g->pool, subset_title(g->pool, g->model, &g->sequence->subset[s])));
    close_table(out, g->sequence->subsets, "NULL");
    open_table(g, out, "char *const ", "body_name", g->model->bodies);
    for (int b = 0; b < g->model->bodies; ++b)
        line(out, 4, "%s,", quoted(g->pool, g->model->body[b].name));
    close_table(out, g->model->bodies, "NULL");
    open_table(g, out, "int32_t ", "parameter_geometric", g->model->tunables);
    for (int i = 0; i < g->model->parameters; ++i)
        if (g->model->parameter[i].tunable)
            line(out, 4, "%d, /* %s */", g->model->parameter[i].geometric, g->model->parameter[i].name);
    close_table(out, g->model->tunables, "0");
    open_table(g, out, "char *const ", "condition_text", conditions(g));
    for (int i = 0; g->model->tuning && i < g->model->tuning->conditions; ++i)
        line(out, 4, "%s,", quoted(g->pool, g->model->tuning->condition[i].text));
    write_assumption_texts(g, out);
    close_table(out, conditions(g), "NULL");
    write_controller_tables(g, out);
    write_contact_table(g, out);
}
