/* SPDX-License-Identifier: MIT
 * What the generated files say about a powertrain. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "vehicle/vehicle.h"

void write_ratios(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Powertrain *powertrain = g->model->powertrain;
    for (int gear = -powertrain->reverse; gear <= powertrain->forward; ++gear)
        line(out, indent, "%s, /* %d */", emit_number(g->pool, powertrain->gear[powertrain->reverse + gear]), gear);
}

void write_shift_times(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Powertrain *powertrain = g->model->powertrain;
    line(out, indent, "const gic_real duration = %s, latency = %s;", emit_number(g->pool, powertrain->duration),
         emit_number(g->pool, powertrain->latency));
}

void write_drive_unused(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->formulation->narrowing)
        line(out, indent, "(void)grip, (void)watch, (void)fast, (void)rate;");
}

void write_drive_lines(void *context, Text *out, int indent)
{
    const Generation *g = context;
    Constants none = {0};
    write_fast_block(g, out, &g->formulation->wheels->drive, SCOPE_FAST, &none, indent);
}

void write_shift_lines(void *context, Text *out, int indent)
{
    const Generation *g = context;
    Constants none = {0};
    write_fast_block(g, out, &g->formulation->wheels->shift, SCOPE_FAST, &none, indent);
}

static const Insertion powertrain_point[] = {{"ratios", write_ratios},           {"times", write_shift_times},
                                             {"unused", write_drive_unused},     {"drive block", write_drive_lines},
                                             {"shift block", write_shift_lines}, {NULL, NULL}};

const Insertions powertrain_points = {(const char *const[]){"powertrain.c.in", "shift.c.in", NULL}, powertrain_point,
                                      NULL};

static void expand(Generation *g, Text *out, const char *template)
{
    if (g->model->powertrain)
        template_expand(g->pool, out, g->templates, template, g->model->name, NULL, &powertrain_points, g);
}

void write_powertrain(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    expand(g, out, "powertrain.c.in");
}

void write_drive(void *context, Text *out, int indent)
{
    Generation *g = context;
    if (!g->model->powertrain)
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "status = %s_drive(self, time, link, fast, rate);", g->model->name);
}

void write_shift(Generation *g, Text *out)
{
    expand(g, out, "shift.c.in");
}

void write_start_gears(void *context, Text *out, int indent)
{
    Generation *g = context;
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
