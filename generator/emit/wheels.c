/* SPDX-License-Identifier: MIT
 * What the generated files say about wheels with tires. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

void write_fast_block(const Generation *g, Text *out, const Block *block, NamingScope scope, Constants *constants,
                      int indent)
{
    Style style = *g->style;
    Naming naming;
    if (style.naming) {
        naming = *style.naming;
        naming.scope = scope;
        style.naming = &naming;
    }
    block_emit(out, block, &style, constants, indent);
}

/* ---- one function a class */

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
    text_print(
        out,
        ".\n * torque: of drive and brake. rate: of spin, slips, brake. grip: force 0 and torque 3 on the "
        "carrier,\n * drive and brake 6 7, load, deflection, its rate, road height 8 to 11, Fx Fy Mx My Mz "
        "12, slips and camber 17\n * to 19, contact point 20, V_x V_y 23, rolling radius 25, power 26, press 27. */\n");
}

void write_contact_array(Text *out, int indent, const char *real)
{
    line(out, indent, "%s contact[%d]; /* Fz, kappa, tan alpha, camber, friction, V_x, deflection, loaded radius,",
         real, CONTACT_NUMBERS);
    line(out, indent, "                        * axes of the contact 8 11 14, centre to contact point 17 */");
}

static void write_comment(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    (void)indent;
    write_wheel_comment(x->g, out, x->class);
}

static void write_arrays(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    const char *upper = x->g->style->naming ? x->g->upper : NULL;
    if (upper)
        line(out, indent, "gic_real contact[%d]; /* %s_CONTACT_* */", CONTACT_NUMBERS, upper);
    else
        write_contact_array(out, indent, "gic_real");
    line(out, indent, "gic_real force[%d] = {R(0.0), R(0.0), R(0.0), R(0.0), R(0.0)}; /* %s */", TIRE_FORCES,
         upper ? pool_print(out->pool, "%s_TIRE_*", upper) : "Fx Fy Mx My Mz");
}

static void write_unused(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    if (x->g->formulation->narrowing)
        line(out, indent, "(void)self, (void)time;");
}

static void write_contact(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_fast_block(x->g, out, &x->class->contact, SCOPE_WHEEL, &x->constants, indent);
}

static void write_tire(void *context, Text *out, int indent)
{
    Expansion *x = context;
    const Block *tire = x->class->by_table.stores ? &x->class->by_table : &x->class->tire;
    write_fast_block(x->g, out, tire, SCOPE_WHEEL, &x->constants, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_fast_block(x->g, out, &x->class->balance, SCOPE_WHEEL, &x->constants, indent);
}

static const Insertion wheel_point[] = {{"comment", write_comment},
                                        {"arrays", write_arrays},
                                        {"unused", write_unused},
                                        {"contact", write_contact},
                                        {"tire", write_tire},
                                        {"balance", write_balance},
                                        {NULL, NULL}};

const Insertions wheel_points = {(const char *const[]){"wheel.c.in", NULL}, wheel_point, NULL};

static void write_wheel_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    const Wheels *wheels = g->formulation->wheels;
    write_wheel_vectors(g, out);
    if (has_table_curves(g))
        template_expand(g->pool, out, g->templates, "curves.c.in", g->model->name, NULL, &curve_points, g);
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
        template_expand(g->pool, &body, g->templates, "wheel.c.in", g->model->name, class->name, &wheel_points, &x);
        write_constants(g, out, pool_print(g->pool, "k_wheel_%s", class->name), class->contact.dag, &x.constants,
                        member); /* known now that all blocks are text */
        text_add(out, body.s, body.size);
    }
}

/* ---- all wheels */

static void write_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
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
            const int place = wheel_rolling(g->model, class->member[i]);
            const char *fast = wheel_place_text(g, "FAST", class->member[i], wheel->fast);
            line(out, indent, "if (status == GIC_OK) /* %s */", wheel->name);
            line(out, indent + 4,
                 "status = %s_wheel_%s(self, %s_k_wheel_%s[%d], time, link + %s, fast + %s, torque + %s, rate + %s, "
                 "grip + %s);",
                 name, class->name, name, class->name, i,
                 wheel_place_text(g, "LINK", class->member[i], LINK_NUMBERS * place), fast,
                 wheel_place_text(g, "TORQUE", class->member[i], 2 * place), fast,
                 wheel_place_text(g, "GRIP", class->member[i], GRIP_NUMBERS * place));
        }
    }
}

static void write_friction(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (!g->formulation->narrowing || g->formulation->narrowing->friction)
        template_expand(g->pool, out, g->templates, friction_template(g), g->model->name, NULL, &wheels_points, g);
}

void write_posts_input(const Generation *g, Text *out, int indent, const char *real)
{
    bool posts = false;
    for (int w = 0; w < g->model->wheels; ++w)
        posts = posts || g->model->wheel[w].post;
    if (posts)
        line(out, indent, "const %s *const u = self->input;", real);
}

static void write_link(void *context, Text *out, int indent)
{
    const Generation *g = context;
    Constants none = {0};
    write_posts_input(g, out, indent, "gic_real");
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
    write_assume(context, out, indent, ABOUT_FAST);
}

static const Insertion wheels_point[] = {{"friction", write_friction},
                                         {"condition", write_across},
                                         {"wheel classes", write_wheel_classes},
                                         {"link", write_link},
                                         {"powertrain", write_powertrain},
                                         {"assume fast", write_assume_fast},
                                         {"torque", write_torque},
                                         {"wheel calls", write_calls},
                                         {"drive", write_drive},
                                         {"images", write_images},
                                         {NULL, NULL}};

const Insertions wheels_points = {(const char *const[]){"wheels.c.in", "friction.c.in", "friction_across.c.in", NULL},
                                  wheels_point, NULL};

static const Insertion states_point[] = {{"link", write_link}, {"torque", write_torque}, {NULL, NULL}};

const Insertions states_points = {(const char *const[]){"states.c.in", NULL}, states_point, NULL};

bool wheels_roll(const Generation *g)
{
    return g->formulation->wheels && g->formulation->wheels->count > 0;
}

void write_wheels(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (wheels_roll(g))
        template_expand(g->pool, out, g->templates, "wheels.c.in", g->model->name, NULL, &wheels_points, g);
    else if (g->formulation->wheels)
        template_expand(g->pool, out, g->templates, "states.c.in", g->model->name, NULL, &states_points, g);
}

/* ---- dual rate */

/* Rows of the table of wheels that roll. */
static void write_rolling(void *context, Text *out, int indent)
{
    const Generation *g = context;
    for (int i = 0; i < g->model->wheels; ++i) {
        const Wheel *wheel = &g->model->wheel[i];
        if (wheel->tire >= 0)
            line(out, indent, "{%d, %d, %s}, /* %s */", wheel->fast, wheel_fast_states(wheel),
                 emit_number(g->pool, g->model->tire[wheel->tire].low_speed), wheel->name);
    }
}

static void write_assume_caller(void *context, Text *out, int indent)
{
    write_assume(context, out, indent, ABOUT_CALLER);
}

static void write_fast_step(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    template_expand(g->pool, out, g->templates, "fast_step.c.in", g->model->name, NULL, &states_rate_points, g);
}

static const Insertion dual_rate_point[] = {
    {"assume", write_assume_caller}, {"fast step", write_fast_step}, {"rolling", write_rolling}, {NULL, NULL}};

const Insertions dual_rate_points = {(const char *const[]){"dual_rate.c.in", "fast_step.c.in", NULL}, dual_rate_point,
                                     NULL};

static const Insertion states_rate_point[] = {
    {"assume", write_assume_caller}, {"fast step", write_fast_step}, {NULL, NULL}};

const Insertions states_rate_points = {(const char *const[]){"states_rate.c.in", "fast_step.c.in", NULL},
                                       states_rate_point, NULL};

void write_wheel_functions(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (wheels_roll(g))
        template_expand(g->pool, out, g->templates, "dual_rate.c.in", g->model->name, NULL, &dual_rate_points, g);
    else if (g->formulation->wheels)
        template_expand(g->pool, out, g->templates, "states_rate.c.in", g->model->name, NULL, &states_rate_points, g);
    write_shift(g, out);
}

void write_dual_rate(void *context, Text *out, int indent)
{
    Generation *g = context;
    const char *name = g->model->name;
    if (g->formulation->wheels) {
        line(out, indent, "%s_LINKS,", g->upper);
        line(out, indent, "offsetof(%s, link),", name);
        line(out, indent, "%s_any_link,", name);
        line(out, indent, "%s_any_fast,", name);
        line(out, indent, "%s_any_fast_step,", name);
        line(out, indent, wheels_roll(g) ? "%s_any_roll," : "NULL, /* %s has no wheels with tires */", name);
        line(out, indent, "%s", g->model->powertrain ? pool_print(g->pool, "%s_any_shift,", name) : "NULL,");
        return;
    }
    line(out, indent, "0,");
    line(out, indent, "0,");
    for (int i = 0; i < 5; ++i)
        line(out, indent, "NULL,");
}

void write_wheel_members(void *context, Text *out, int indent)
{
    Generation *g = context;
    if (!g->formulation->wheels)
        return;
    line(out, indent, "gic_real link[5 * %s_LINKS]; /* how the multibody system moves the wheels, at slow steps */",
         g->upper);
    if (!wheels_roll(g))
        return;
    line(out, indent, "gic_real grip[%s_GRIP * %s_ROLLING]; /* what the wheels do, %s_GRIP numbers each */", g->upper,
         g->upper, g->upper);
    write_powertrain_members(g, out, indent);
}

void write_wheel_sizes(Generation *g, Text *out, int indent)
{
    const Wheels *wheels = g->formulation->wheels;
    if (!wheels)
        return;
    if (!wheels_roll(g)) {
        line(out, indent, "%s_LINKS = %d,", g->upper, wheels->links);
        return;
    }
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
    if (!wheels_roll(g)) {
        count_line(out, "what rates of own states read", figures->link);
        count_line(out, "rates of own states", figures->torque);
        return;
    }
    count_line(out, "motion of the wheels", figures->link);
    count_line(out, g->model->states ? "drives, brakes, rates of own states" : "drives and brakes", figures->torque);
    for (int c = 0; c < wheels->classes; ++c)
        count_line(out, pool_print(g->pool, "wheel '%s' (%d times)", wheels->class[c].name, figures->wheel_times[c]),
                   figures->wheel[c]);
    if (g->model->powertrain)
        count_line(out, "powertrain", figures->drive);
    count_line(out, g->model->powertrain ? "a fast step: all of these" : "a fast step: all wheels", figures->fast);
}
