/* SPDX-License-Identifier: MIT
 * What the generated files say about a powertrain. */
#include "generate.h"
#include "powertrain.h"

#include <string.h>

static void insert_powertrain(void *context, const char *name, Text *out, int indent)
{
    Generation *g = context;
    const Powertrain *powertrain = g->model->powertrain;
    const Wheels *wheels = g->formulation->wheels;
    Constants none = {0};
    if (!strcmp(name, "ratios")) {
        for (int gear = -powertrain->reverse; gear <= powertrain->forward; ++gear)
            line(out, indent, "%s, /* %d */", emit_number(g->pool, powertrain->gear[powertrain->reverse + gear]), gear);
    } else if (!strcmp(name, "times")) {
        line(out, indent, "const gic_real duration = %s, latency = %s;", emit_number(g->pool, powertrain->duration),
             emit_number(g->pool, powertrain->latency));
    } else if (!strcmp(name, "unused")) {
        if (g->formulation->narrowing)
            line(out, indent, "(void)grip, (void)watch, (void)fast, (void)rate;");
    } else {
        block_emit(out, !strcmp(name, "shift block") ? &wheels->shift : &wheels->drive, g->style, &none, indent);
    }
}

static void expand(Generation *g, Text *out, const char *template)
{
    if (g->model->powertrain)
        template_expand(g->pool, out, g->templates, template, g->model->name, NULL, insert_powertrain, g);
}

void write_powertrain(Generation *g, Text *out)
{
    expand(g, out, "powertrain.c.in");
}

void write_drive(Generation *g, Text *out, int indent)
{
    if (!g->model->powertrain)
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "status = %s_drive(self, time, link, fast, rate);", g->model->name);
}

void write_shift(Generation *g, Text *out)
{
    expand(g, out, "shift.c.in");
}

void write_start_gears(Generation *g, Text *out, int indent)
{
    for (int i = 0; g->model->powertrain && i < POWERTRAIN_DISCRETE; ++i)
        line(out, indent, "self->discrete[%s_GEAR + %d] = %d; /* %s */", g->upper, i, g->model->powertrain->start_gear,
             powertrain_discrete_name[i]);
}

void write_powertrain_sizes(Generation *g, Text *out, int indent)
{
    const Powertrain *powertrain = g->model->powertrain;
    if (!powertrain)
        return;
    line(out, indent, "%s_FORWARD = %d,", g->upper, powertrain->forward);
    line(out, indent, "%s_REVERSE = %d,", g->upper, powertrain->reverse);
    line(out, indent, "%s_ENGINE = %d, /* engine.speed among the fast states */", g->upper, powertrain->fast);
    line(out, indent, "%s_GEAR = %d, /* transmission.gear in discrete[] */", g->upper, g->model->free_base);
}

void write_powertrain_members(Generation *g, Text *out, int indent)
{
    if (g->model->powertrain)
        line(out, indent, "gic_real watch[%d]; /* of the powertrain, as in its outputs */", WATCH_NUMBERS);
}
