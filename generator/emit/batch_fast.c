/* SPDX-License-Identifier: MIT
 * Fast states of many vehicles at once: wheels with tires, powertrain and own states, with one vehicle a lane. */
#include "base/text.h"
#include "emit/batch_private.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

/* ---- one function a class of wheels ------------------------------------------------------------------------------ */

typedef struct Expansion {
    Generation *g;
    const WheelClass *class;
    Constants constants;
} Expansion;

static void write_comment(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    (void)indent;
    write_wheel_comment(x->g, out, x->class);
}

static void write_wheel_arrays(void *context, Text *out, int indent)
{
    (void)context;
    line(out, indent, "gic_lane force[%d]; /* Fx Fy Mx My Mz */", TIRE_FORCES);
    write_contact_array(out, indent, "gic_lane");
}

static void write_alone(void *context, Text *out, int indent)
{
    (void)context;
    line(out, indent, "for (i = 0; i < %d; ++i)", TIRE_FORCES);
    line(out, indent + 4, "force[i] = LANE_WHERE(loaded, force[i]);");
}

/* A part of a wheel. Functions of vectors are long chains of operations: those that do not wait for each other stand
 * side by side. */
static void write_part(Expansion *x, Text *out, const Block *part, int indent)
{
    Block block = *part;
    block.scheduled = true;
    write_fast_block(x->g, out, &block, SCOPE_WHEEL, &x->constants, indent);
}

static void write_contact(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_part(x, out, &x->class->contact, indent);
}

static void write_tire(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_part(x, out, x->class->by_table.stores ? &x->class->by_table : &x->class->tire, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_part(x, out, &x->class->balance, indent);
}

static const Insertion wheel_point[] = {{"comment", write_comment},
                                        {"arrays", write_wheel_arrays},
                                        {"contact", write_contact},
                                        {"tire", write_tire},
                                        {"alone", write_alone},
                                        {"balance", write_balance},
                                        {NULL, NULL}};

const Insertions batch_wheel_points = {(const char *const[]){"batch_wheel.c.in", NULL}, wheel_point, NULL};

static void write_wheel_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    const Wheels *wheels = g->formulation->wheels;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        Expansion x = {.g = g, .class = class};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->wheel[class->member[i]].name;
        template_expand(g->pool, &body, g->templates, "batch_wheel.c.in", g->model->name, class->name,
                        &batch_wheel_points, &x);
        write_constants(g, out, pool_print(g->pool, "k_wheel_%s", class->name), class->contact.dag, &x.constants,
                        member); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
}

static void write_wheel_calls(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    const char *name = g->model->name;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        for (int i = 0; i < class->members; ++i) {
            if (narrowing_wheel_image(g->formulation->narrowing, class->member[i]))
                continue;
            const int wheel = class->member[i], place = wheel_rolling(g->model, wheel);
            const char *fast = wheel_place_text(g, "FAST", wheel, g->model->wheel[wheel].fast);
            line(out, indent,
                 "%s_wheel_%s(self, work, %s_k_wheel_%s[%d], link + %s, fast + %s, torque + %s, rate + %s, grip + %s);",
                 name, class->name, name, class->name, i, wheel_place_text(g, "LINK", wheel, LINK_NUMBERS * place),
                 fast, wheel_place_text(g, "TORQUE", wheel, 2 * place), fast,
                 wheel_place_text(g, "GRIP", wheel, GRIP_NUMBERS * place));
        }
    }
}

/* ---- powertrain -------------------------------------------------------------------------------------------------- */

static const Insertion drive_point[] = {{"ratios", write_ratios},           {"times", write_shift_times},
                                        {"unused", write_drive_unused},     {"drive block", write_drive_lines},
                                        {"shift block", write_shift_lines}, {NULL, NULL}};

const Insertions batch_drive_points = {(const char *const[]){"batch_drive.c.in", NULL}, drive_point, NULL};

static void write_batch_powertrain(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->powertrain)
        template_expand(g->pool, out, g->templates, "batch_drive.c.in", g->model->name, NULL, &batch_drive_points, g);
}

static void write_batch_drive(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->model->powertrain)
        line(out, indent, "%s_drive(self, work, link, fast, rate);", g->model->name);
}

/* ---- all fast states --------------------------------------------------------------------------------------------- */

static void write_friction(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (wheels_roll(g) && (!g->formulation->narrowing || g->formulation->narrowing->friction))
        template_expand(g->pool, out, g->templates, batch_friction_template(g), g->model->name, NULL,
                        &batch_fast_points, g);
}

static void write_arrays(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (wheels_roll(g))
        line(out, indent, "gic_lane *const grip = self->grip, torque[2 * %s_ROLLING];", g->upper);
    else
        line(out, indent, "(void)fast;");
}

static void write_link(void *context, Text *out, int indent)
{
    const Generation *g = context;
    Constants none = {0};
    write_posts_input(g, out, indent, "gic_lane");
    write_fast_block(g, out, &g->formulation->wheels->link, SCOPE_FAST, &none, indent);
}

static void write_torque(void *context, Text *out, int indent)
{
    const Generation *g = context;
    Constants none = {0};
    write_fast_block(g, out, &g->formulation->wheels->torque, SCOPE_FAST, &none, indent);
}

static void write_assume_fast(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_batch_assume(g, out, indent, ABOUT_FAST);
}

static const Insertion fast_point[] = {
    {"friction", write_friction},       {"wheel classes", write_wheel_classes}, {"link", write_link},
    {"condition", write_across_lane},   {"powertrain", write_batch_powertrain}, {"arrays", write_arrays},
    {"torque", write_torque},           {"wheel calls", write_wheel_calls},     {"drive", write_batch_drive},
    {"assume fast", write_assume_fast}, {"images", write_batch_images},         {NULL, NULL}};

const Insertions batch_fast_points = {
    (const char *const[]){"batch_fast.c.in", "batch_friction.c.in", "batch_friction_across.c.in", NULL}, fast_point,
    NULL};

void write_batch_fast(Generation *g, Text *out)
{
    template_expand(g->pool, out, g->templates, "batch_fast.c.in", g->model->name, NULL, &batch_fast_points, g);
}
