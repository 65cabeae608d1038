/* SPDX-License-Identifier: MIT
 * What the generated files say about wheels with tires. */
#include "generate.h"
#include "wheel.h"

#include <string.h>

/* ---- one function a class
 * -------------------------------------------------------------------------------------------- */

/* A class whose template is being expanded. */
typedef struct Expansion {
    Generation *g;
    const WheelClass *class;
    Constants constants;
} Expansion;

void write_wheel_comment(const Generation *g, Text *out, const WheelClass *class)
{
    const Model *model = g->model;
    const int first = model->wheel[class->member[0]].tire;
    text_print(out, "/* Wheels with the tire '%s':", model->tire[first].name);
    for (int i = 0; i < class->members; ++i) {
        const Wheel *wheel = &model->wheel[class->member[i]];
        text_print(out, "%s %s", i ? "," : "", wheel->name);
        if (wheel->tire != first)
            text_print(out, " ('%s')", model->tire[wheel->tire].name);
    }
    text_print(out,
               ".\n * torque: of drive and brake. rate: of spin, slips, brake. grip: force 0 and torque 3 on the "
               "carrier,\n * drive and brake 6 7, load, deflection, its rate, road height 8 to 11, Fx Fy Mx My Mz "
               "12, slips and camber 17\n * to 19, contact point 20, V_x V_y 23, rolling radius 25, power 26. */\n");
}

static void insert_class(void *context, const char *name, Text *out, int indent)
{
    Expansion *x = context;
    const WheelClass *class = x->class;
    const Block *block = !strcmp(name, "contact") ? &class->contact
                         : !strcmp(name, "tire")  ? &class->tire
                                                  : &class->balance;
    if (!strcmp(name, "comment")) {
        write_wheel_comment(x->g, out, class);
    } else if (!strcmp(name, "arrays")) {
        line(out, indent,
             "gic_real hub[%d]; /* Fz, kappa, tan alpha, camber, friction, V_x, deflection, loaded radius,",
             HUB_NUMBERS);
        line(out, indent, "                    * axes of the contact 8 11 14, centre to contact point 17 */");
        line(out, indent, "gic_real force[%d] = {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)}; /* Fx Fy Mx My Mz */",
             TIRE_FORCES);
    } else if (!strcmp(name, "unused")) {
        if (x->g->formulation->narrowing)
            line(out, indent, "(void)self, (void)time;");
    } else {
        block_emit(out, block, x->g->style, &x->constants, indent);
    }
}

static void write_classes(Generation *g, Text *out)
{
    const Wheels *wheels = g->formulation->wheels;
    write_wheel_vectors(g, out);
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        if (wheel_lanes(g, class) > 1) {
            write_wheel_class_lanes(g, out, class);
            continue;
        }
        Expansion x = {.g = g, .class = class};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->wheel[class->member[i]].name;
        template_expand(g->pool, &body, g->templates, "wheel.c.in", g->model->name, class->name, insert_class, &x);
        write_constants(g, out, pool_print(g->pool, "k_wheel_%s", class->name), class->contact.dag, &x.constants,
                        member); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
}

/* ---- all wheels
 * ---------------------------------------------------------------------------------------------------------- */

static void write_calls(Generation *g, Text *out, int indent)
{
    const Wheels *wheels = g->formulation->wheels;
    const char *name = g->model->name;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        if (wheel_lanes(g, class) > 1) {
            write_wheel_lane_calls(g, out, indent, class);
            continue;
        }
        for (int i = 0; i < class->members; ++i) {
            const Wheel *wheel = &g->model->wheel[class->member[i]];
            if (narrowing_wheel_image(g->formulation->narrowing, class->member[i]))
                continue;
            int place = wheel_rolling(g->model, class->member[i]);
            line(out, indent, "if (status == GIC_OK) /* %s */", wheel->name);
            line(out, indent + 4,
                 "status = %s_wheel_%s(self, %s_k_wheel_%s[%d], time, link + %d, fast + %d, torque + %d, rate + %d, "
                 "grip + %d);",
                 name, class->name, name, class->name, i, LINK_NUMBERS * place, wheel->fast, 2 * place, wheel->fast,
                 GRIP_NUMBERS * place);
        }
    }
}

static void insert_wheels(void *context, const char *name, Text *out, int indent)
{
    Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    Constants none = {0};
    if (!strcmp(name, "friction")) {
        if (!g->formulation->narrowing || g->formulation->narrowing->friction)
            template_expand(g->pool, out, g->templates, friction_template(g), g->model->name, NULL, insert_wheels, g);
    } else if (!strcmp(name, "wheel classes"))
        write_classes(g, out);
    else if (!strcmp(name, "powertrain"))
        write_powertrain(g, out);
    else if (!strcmp(name, "wheel calls"))
        write_calls(g, out, indent);
    else if (!strcmp(name, "drive"))
        write_drive(g, out, indent);
    else if (!strcmp(name, "images"))
        write_images(g, out, indent);
    else if (!strcmp(name, "assume fast"))
        write_assume(g, out, indent, ABOUT_FAST);
    else
        block_emit(out, !strcmp(name, "link") ? &wheels->link : &wheels->torque, g->style, &none, indent);
}

void write_wheels(Generation *g, Text *out)
{
    if (g->formulation->wheels)
        template_expand(g->pool, out, g->templates, "wheels.c.in", g->model->name, NULL, insert_wheels, g);
}

/* ---- dual rate
 * ------------------------------------------------------------------------------------------------------------ */

/* Rows of the table of wheels that roll. */
static void insert_rolling(void *context, const char *name, Text *out, int indent)
{
    Generation *g = context;
    if (!strcmp(name, "assume")) {
        write_assume(g, out, indent, ABOUT_CALLER);
        return;
    }
    for (int i = 0; i < g->model->wheels; ++i) {
        const Wheel *wheel = &g->model->wheel[i];
        if (wheel->tire >= 0)
            line(out, indent, "{%d, %d, %s}, /* %s */", wheel->fast, wheel_fast_states(wheel),
                 emit_number(g->pool, g->model->tire[wheel->tire].low_speed), wheel->name);
    }
}

void write_wheel_functions(Generation *g, Text *out)
{
    if (g->formulation->wheels)
        template_expand(g->pool, out, g->templates, "dual_rate.c.in", g->model->name, NULL, insert_rolling, g);
    write_shift(g, out);
}

void write_dual_rate(Generation *g, Text *out, int indent)
{
    const char *name = g->model->name;
    if (g->formulation->wheels) {
        line(out, indent, "%s_LINKS,", g->upper);
        line(out, indent, "offsetof(%s, link),", name);
        line(out, indent, "%s_any_link,", name);
        line(out, indent, "%s_any_fast,", name);
        line(out, indent, "%s_any_roll,", name);
        line(out, indent, "%s", g->model->powertrain ? pool_print(g->pool, "%s_any_shift,", name) : "NULL,");
        return;
    }
    line(out, indent, "0,");
    line(out, indent, "0,");
    for (int i = 0; i < 4; ++i)
        line(out, indent, "NULL,");
}

void write_wheel_members(Generation *g, Text *out, int indent)
{
    if (!g->formulation->wheels)
        return;
    line(out, indent, "gic_real link[5 * %s_LINKS]; /* how the multibody system moves the wheels, at slow steps */",
         g->upper);
    line(out, indent, "gic_real grip[%s_GRIP * %s_ROLLING]; /* what the wheels do, %s_GRIP numbers each */", g->upper,
         g->upper, g->upper);
    write_powertrain_members(g, out, indent);
}

void write_wheel_sizes(Generation *g, Text *out, int indent)
{
    const Wheels *wheels = g->formulation->wheels;
    if (!wheels)
        return;
    line(out, indent, "%s_ROLLING = %d,", g->upper, wheels->count);
    line(out, indent, "%s_LINKS = %d,", g->upper, wheels->links);
    line(out, indent, "%s_GRIP = %d,", g->upper, GRIP_NUMBERS);
    write_powertrain_sizes(g, out, indent);
}

void wheel_counts(Generation *g, Text *out, const Figures *figures)
{
    const Wheels *wheels = g->formulation->wheels;
    if (!wheels)
        return;
    count_line(out, "motion of the wheels", figures->link);
    count_line(out, "drives and brakes", figures->torque);
    for (int c = 0; c < wheels->classes; ++c)
        count_line(out, pool_print(g->pool, "wheel '%s' (%d times)", wheels->class[c].name, figures->wheel_times[c]),
                   figures->wheel[c]);
    if (g->model->powertrain)
        count_line(out, "powertrain", figures->drive);
    count_line(out, g->model->powertrain ? "a fast step: all of these" : "a fast step: all wheels", figures->fast);
}
