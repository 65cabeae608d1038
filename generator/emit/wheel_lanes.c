/* SPDX-License-Identifier: MIT
 * Wheels with the same tire side by side in the lanes of vectors. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "model/model.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

static const Style style_wheels = {.leaves = 6, .lanes = true, .lane_constants = true};

/* Places in the class of the wheels that are computed: the others' numbers are copied from their mirror images. Returns
 * how many; member [members], NULL: not asked for. */
static int find_computed(const Generation *g, const WheelClass *class, int *member)
{
    int count = 0;
    for (int i = 0; i < class->members; ++i) {
        if (narrowing_wheel_image(g->formulation->narrowing, class->member[i]))
            continue;
        if (member)
            member[count] = i;
        ++count;
    }
    return count;
}

int wheel_lanes(const Generation *g, const WheelClass *class)
{
    return wheel_class_lanes(g->formulation, class);
}

/* ---- types, and what wheels look up -------------------------------------------------------------------------------
 */

typedef struct Vectors {
    const Generation *g;
    const char *lanes; /* how many, as text */
} Vectors;

/* The parts of the vectors' template that code for one scene may not need. */
static void write_vectors_road(void *context, Text *out, int indent)
{
    const Vectors *v = context;
    const Narrowing *narrowing = v->g->formulation->narrowing;
    (void)indent;
    if (!narrowing || narrowing->road)
        template_expand(v->g->pool, out, v->g->templates, vectors_road_template(v->g), v->g->model->name, v->lanes,
                        &wheel_vector_points, context);
}

static void write_vectors_friction(void *context, Text *out, int indent)
{
    const Vectors *v = context;
    const Narrowing *narrowing = v->g->formulation->narrowing;
    (void)indent;
    if (!narrowing || narrowing->friction)
        template_expand(v->g->pool, out, v->g->templates, "wheel_vectors_friction.c.in", v->g->model->name, v->lanes,
                        &wheel_vector_points, context);
}

static const Insertion vectors_point[] = {
    {"road", write_vectors_road}, {"friction", write_vectors_friction}, {NULL, NULL}};

const Insertions wheel_vector_points = {(const char *const[]){"wheel_vectors.c.in", "wheel_vectors_road.c.in",
                                                              "wheel_vectors_road_across.c.in",
                                                              "wheel_vectors_friction.c.in", "wheel_places.c.in", NULL},
                                        vectors_point, NULL};

void write_wheel_vectors(Generation *g, Text *out)
{
    const Wheels *wheels = g->formulation->wheels;
    Vectors v = {.g = g};
    for (int lanes = 2; lanes <= g->plan->lanes; lanes *= 2) {
        bool used = false;
        for (int c = 0; c < wheels->classes; ++c)
            used = used || wheel_lanes(g, &wheels->class[c]) == lanes;
        if (used && !v.lanes)
            template_expand(g->pool, out, g->templates, "wheel_places.c.in", g->model->name, NULL, &wheel_vector_points,
                            &v);
        if (used) {
            v.lanes = pool_print(g->pool, "%d", lanes);
            template_expand(g->pool, out, g->templates, "wheel_vectors.c.in", g->model->name, v.lanes,
                            &wheel_vector_points, &v);
        }
    }
}

/* ---- one function a class ---------------------------------------------------------------------------------------- */

typedef struct Expansion {
    Generation *g;
    const WheelClass *class;
    int lanes;
    int members, *member; /* find_computed */
    Constants constants;
} Expansion;

static Expansion expansion_of(Generation *g, const WheelClass *class)
{
    Expansion x = {.g = g,
                   .class = class,
                   .lanes = wheel_lanes(g, class),
                   .member = pool_alloc(g->pool, (size_t) class->members * sizeof *x.member)};
    x.members = find_computed(g, class, x.member);
    return x;
}

/* The wheel of a lane; lanes after the last wheel repeat the row's first one. */
static int lane_member(const Expansion *x, int row, int lane)
{
    const int at = x->lanes * row + lane;
    return x->member[at < x->members ? at : x->lanes * row];
}

static int wheel_rows(const Expansion *x)
{
    return (x->members + x->lanes - 1) / x->lanes;
}

/* A vector of numbers that stand apart, lane by lane, at `array`0[i], `array`1[i], ... */
static void write_gather(const Expansion *x, Text *out, int indent, const char *array, int count)
{
    for (int l = 0; l < x->lanes; ++l)
        line(out, indent, "const gic_real *const %s%d = %ss + at[%d].%s;", array, l, array, l, array);
    line(out, indent, "gic_lane %s[%d];", array, count);
}

static void write_gathering(const Expansion *x, Text *out, int indent, const char *array, int count)
{
    line(out, indent, "for (i = 0; i < %d; ++i) {", count);
    text_print(out, "%*sconst gic_lane all = {", indent + 4, "");
    for (int l = 0; l < x->lanes; ++l)
        text_print(out, "%s%s%d[i]", l ? ", " : "", array, l);
    text_print(out, "};\n");
    line(out, indent + 4, "%s[i] = all;", array);
    line(out, indent, "}");
}

static void write_scattering(const Expansion *x, Text *out, int indent, const char *array, const char *place, int count)
{
    line(out, indent, "for (i = 0; i < %d; ++i) {", count);
    for (int l = 0; l < x->lanes; ++l)
        line(out, indent + 4, "%ss[at[%d].%s + i] = %s[i][%d];", array, l, place, array, l);
    line(out, indent, "}");
}

static int fast_states(const Expansion *x)
{
    return wheel_fast_states(&x->g->model->wheel[x->class->member[0]]);
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
    const int states = fast_states(x);
    write_gather(x, out, indent, "link", LINK_NUMBERS);
    write_gather(x, out, indent, "fast", states);
    write_gather(x, out, indent, "torque", 2);
    line(out, indent, "gic_lane rate[%d], grip[%d], force[%d];", states, GRIP_NUMBERS, TIRE_FORCES);
    write_contact_array(out, indent, "gic_lane");
}

static void write_gathered_numbers(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    write_gathering(x, out, indent, "link", LINK_NUMBERS);
    write_gathering(x, out, indent, "fast", fast_states(x));
    write_gathering(x, out, indent, "torque", 2);
}

static void write_scattered_numbers(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    write_scattering(x, out, indent, "rate", "fast", fast_states(x));
    write_scattering(x, out, indent, "grip", "grip", GRIP_NUMBERS);
}

static void write_alone(void *context, Text *out, int indent)
{
    (void)context;
    line(out, indent, "for (i = 0; i < %d; ++i)", TIRE_FORCES);
    line(out, indent + 4, "force[i] = LANE_WHERE(loaded, force[i]);");
}

static void write_none(void *context, Text *out, int indent)
{
    (void)context;
    line(out, indent, "for (i = 0; i < %d; ++i)", TIRE_FORCES);
    line(out, indent + 4, "force[i] = LANE(R(0.0));");
}

static void write_block(Expansion *x, const Block *block, Text *out, int indent)
{
    Style style = style_wheels;
    Naming naming;
    style.prefix = x->g->style->prefix;
    if (x->g->style->naming) {
        naming = *x->g->style->naming;
        naming.scope = SCOPE_WHEEL;
        style.naming = &naming;
    }
    Block scheduled = *block; /* long chains of operations: those that do not wait for each other stand side by side */
    scheduled.scheduled = true;
    block_emit(out, &scheduled, &style, &x->constants, indent);
}

static void write_contact(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_block(x, &x->class->contact, out, indent);
}

static void write_tire(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_block(x, x->class->by_table.stores ? &x->class->by_table : &x->class->tire, out, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    Expansion *x = context;
    write_block(x, &x->class->balance, out, indent);
}

static const Insertion wheel_lanes_point[] = {{"comment", write_comment},
                                              {"arrays", write_arrays},
                                              {"gather", write_gathered_numbers},
                                              {"contact", write_contact},
                                              {"tire", write_tire},
                                              {"alone", write_alone},
                                              {"none", write_none},
                                              {"balance", write_balance},
                                              {"scatter", write_scattered_numbers},
                                              {NULL, NULL}};

const Insertions wheel_lanes_points = {(const char *const[]){"wheel_lanes.c.in", NULL}, wheel_lanes_point, NULL};

/* Rows of vectors of the members' constants, and where the members' numbers stand. */
static void write_rows(const Expansion *x, Text *out)
{
    const Generation *g = x->g;
    const WheelClass *class = x->class;
    const Dag *dag = class->contact.dag;
    const int each = dag->samples / dag->members, count = room(x->constants.count);
    line(out, 0, "static const gic_lane%d %s_k_wheel_%s[%d][%d] = {", x->lanes, g->model->name, class->name,
         wheel_rows(x), count);
    for (int r = 0; r < wheel_rows(x); ++r) {
        line(out, 4, "{");
        for (int k = 0; k < count; ++k) {
            text_print(out, "        {");
            for (int l = 0; l < x->lanes; ++l)
                text_print(out, "%s%s", l ? ", " : "",
                           emit_number(g->pool, x->constants.count
                                                    ? ex_value(dag, x->constants.e[k], lane_member(x, r, l) * each)
                                                    : 0));
            text_print(out, "},\n");
        }
        line(out, 4, "},");
    }
    line(out, 0, "};\n");
    line(out, 0, "static const %s_wheel_place %s_at_%s[%d][%d] = {", g->model->name, g->model->name, class->name,
         wheel_rows(x), x->lanes);
    for (int r = 0; r < wheel_rows(x); ++r) {
        line(out, 4, "{");
        for (int l = 0; l < x->lanes; ++l) {
            const int index = class->member[lane_member(x, r, l)], place = wheel_rolling(g->model, index);
            const Wheel *wheel = &g->model->wheel[index];
            line(out, 8, "{%d, %d, %d, %d}, /* %s */", LINK_NUMBERS * place, wheel->fast, 2 * place,
                 GRIP_NUMBERS * place, wheel->name);
        }
        line(out, 4, "},");
    }
    line(out, 0, "};\n");
}

void write_wheel_class_lanes(Generation *g, Text *out, const WheelClass *class)
{
    Expansion x = expansion_of(g, class);
    Text body = {.pool = g->pool};
    template_expand(g->pool, &body, g->templates, "wheel_lanes.c.in", g->model->name, class->name, &wheel_lanes_points,
                    &x);
    line(out, 0, "#undef GIC_LANES");
    line(out, 0, "#define GIC_LANES %d\n", x.lanes);
    write_rows(&x, out); /* known now that all blocks are text */
    text_add(out, body.s, body.size);
}

void write_wheel_lane_calls(Generation *g, Text *out, int indent, const WheelClass *class)
{
    const char *name = g->model->name;
    const Expansion x = expansion_of(g, class);
    for (int r = 0; r < wheel_rows(&x); ++r) {
        const int rest = x.members - x.lanes * r, count = rest < x.lanes ? rest : x.lanes;
        text_print(out, "%*sif (status == GIC_OK) /*", indent, "");
        for (int l = 0; l < count; ++l)
            text_print(out, "%s %s", l ? "," : "", g->model->wheel[class->member[lane_member(&x, r, l)]].name);
        text_print(out, " */\n");
        line(out, indent + 4,
             "status = %s_wheels_%s(self, %d, %s_k_wheel_%s[%d], %s_at_%s[%d], time, link, fast, torque, rate, grip);",
             name, class->name, count, name, class->name, r, name, class->name, r);
    }
}
