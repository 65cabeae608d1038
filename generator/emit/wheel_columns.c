/* SPDX-License-Identifier: MIT
 * Of the function for all columns of the jacobian: what goes through wheels, own states and the powertrain. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/columns.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

/* A class whose template is being expanded. */
typedef struct Expansion {
    Generation *g;
    const WheelClassColumns *columns;
    Constants constants;
} Expansion;

static void write_arrays(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    line(out, indent, "gic_real contact[%d] = {R(0.0)}, force[%d] = {R(0.0)}, half[%d] = {R(0.0)};", CONTACT_NUMBERS,
         TIRE_FORCES, room(x->columns->halves));
    line(out, indent, "(void)force, (void)half;");
}

static void write_contact(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_fast_block(x->g, out, &x->columns->contact.block, SCOPE_WHEEL, &x->constants, indent);
}

static void write_tire(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_fast_block(x->g, out, &x->columns->tire, SCOPE_WHEEL, &x->constants, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_fast_block(x->g, out, &x->columns->balance.block, SCOPE_WHEEL, &x->constants, indent);
}

static const Insertion wheel_point[] = {{"columns arrays", write_arrays},
                                        {"columns contact", write_contact},
                                        {"columns tire", write_tire},
                                        {"columns balance", write_balance},
                                        {NULL, NULL}};

const Insertions columns_wheel_points = {(const char *const[]){"columns_wheel.c.in", NULL}, wheel_point, NULL};

void write_wheel_column_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    (void)indent;
    if (!columns_of(g)->wheels)
        return;
    const bool written = g->weighing && has_tangents(g); /* one function serves both */
    for (int c = 0; c < wheels->classes && !written; ++c) {
        const WheelClass *class = &wheels->class[c];
        Expansion x = {.g = g, .columns = &columns_of(g)->wheels->class[c]};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->wheel[class->member[i]].name;
        template_expand(g->pool, &body, g->templates, "columns_wheel.c.in", g->model->name, class->name,
                        &columns_wheel_points, &x);
        write_constants(g, out, pool_print(g->pool, "k_columns_wheel_%s", class->name), class->contact.dag,
                        &x.constants, member);
        text_add(out, body.s, body.size);
    }
}

void write_wheel_columns_call(Generation *g, Text *out, int indent, int class, int member)
{
    const Wheels *wheels = g->formulation->wheels;
    const int wheel = wheels->class[class].member[member], place = wheel_rolling(g->model, wheel);
    const char *fast = wheel_place_text(g, "FAST", wheel, g->model->wheel[wheel].fast), *name = g->model->name;
    line(out, indent, "if (status == GIC_OK) /* %s */", g->model->wheel[wheel].name);
    line(out, indent + 4, "status = %s_columns_wheel_%s(self, %s_k_columns_wheel_%s[%d], time,", name,
         wheels->class[class].name, name, wheels->class[class].name, member);
    line(out, indent + 8, "link + %s, fast + %s, torque + %s, rate + %s, grip + %s, local + %d);",
         wheel_place_text(g, "LINK", wheel, LINK_NUMBERS * place), fast,
         wheel_place_text(g, "TORQUE", wheel, 2 * place), fast,
         wheel_place_text(g, "GRIP", wheel, GRIP_NUMBERS * place), columns_of(g)->wheels->offset[wheel]);
}

static void write_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    for (int c = 0; c < wheels->classes; ++c)
        for (int i = 0; i < wheels->class[c].members; ++i)
            write_wheel_columns_call(g, out, indent, c, i);
}

static void write_torques(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const int count = g->formulation->wheels->count;
    line(out, indent, "gic_real torque[%d], grip[%d];", room(2 * count), room(GRIP_NUMBERS * count));
}

Block wheel_columns_link(Generation *g)
{
    const Block *link = &g->formulation->wheels->link;
    Block both = {.dag = link->dag, .eager = true};
    for (int i = 0; i < link->stores; ++i)
        block_store(&both, link->store[i].value, link->store[i].target);
    const Block *part = &columns_of(g)->wheels->link;
    for (int i = 0; i < part->stores; ++i)
        block_store(&both, part->store[i].value, part->store[i].target);
    return *placed_block(g, &both);
}

static void write_link(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    const Block both = wheel_columns_link(g);
    write_fast_block(g, out, &both, SCOPE_FAST, &none, indent);
}

static void write_torque(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    write_fast_block(g, out, &columns_of(g)->wheels->torque.block, SCOPE_FAST, &none, indent);
}

static void write_drive_block(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    write_fast_block(g, out, &columns_of(g)->wheels->drive.block, SCOPE_FAST, &none, indent);
}

void write_drive_columns(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->powertrain)
        template_expand(g->pool, out, g->templates, "columns_drive.c.in", g->model->name, NULL, &columns_wheels_points,
                        g);
}

static const Insertion wheels_point[] = {{"columns wheel classes", write_wheel_column_classes},
                                         {"columns found motions", write_found_motions},
                                         {"columns torques", write_torques},
                                         {"columns link", write_link},
                                         {"columns torque", write_torque},
                                         {"columns wheel calls", write_calls},
                                         {"columns drive", write_drive_columns},
                                         {"columns drive block", write_drive_block},
                                         {NULL, NULL}};

const Insertions columns_wheels_points = {(const char *const[]){"columns_wheels.c.in", "columns_drive.c.in", NULL},
                                          wheels_point, NULL};

void write_wheel_columns(Generation *g, Text *out)
{
    if (columns_of(g)->wheels)
        template_expand(g->pool, out, g->templates, "columns_wheels.c.in", g->model->name, columns_name(g),
                        &columns_wheels_points, g);
}
