/* SPDX-License-Identifier: MIT
 * Blocks as C text. A node that is used once is written where it is used, up to a small size, so that a line says
 * something; everything else is a temporary. Statements come depth-first from the results, which keeps few values alive
 * at a time. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/curve.h"
#include "expression/expression.h"
#include "gic_runtime.h"

#include <math.h>
#include <string.h>

/* For people and optimizing compilers: expressions of about one line. */
const Style style_readable = {.leaves = 6, .doubles = false, .whole_self_test = true};
/* For a compiler that keeps no value in a register from one statement to the next, and whose own time counts. */
const Style style_direct = {.leaves = 30, .doubles = true, .whole_self_test = false};
/* For vector extensions of C, in which sums and products take numbers beside vectors, and functions do not. */
const Style style_lanes = {.leaves = 6, .doubles = false, .whole_self_test = false, .lanes = true};

/* Names of types and of functions for one number, for lanes of vehicles, for vectors of `width` lanes. */
static const struct {
    int width;
    const char *real, *function;
} width_name[] = {{2, "gic_lane_2", "LANE_2"},
                  {4, "gic_lane_4", "LANE_4"},
                  {8, "gic_lane_8", "LANE_8"},
                  {16, "gic_lane_16", "LANE_16"}};

/* For a style without width, or for vectors of `width` lanes. */
static const char *real_name(const Style *style, int width)
{
    for (size_t i = 0; i < sizeof width_name / sizeof *width_name; ++i)
        if (width_name[i].width == width)
            return width_name[i].real;
    return style->lanes ? "gic_lane" : "gic_real";
}

const char *style_real(const Style *style)
{
    return real_name(style, style->width);
}

/* Binding strength of a node's text. */
enum { STRENGTH_SUM = 1, STRENGTH_PRODUCT = 2, STRENGTH_UNARY = 3, STRENGTH_ATOM = 4 };

static const struct {
    int arity;
    const char *text;
} op_form[OP_COUNT] = {
#define OP_FORM(name, arity, text, counted) {arity, text},
    OP_LIST(OP_FORM)
#undef OP_FORM
};

typedef struct Emitter {
    Text *out;
    const Block *block;
    const Dag *dag;
    const Style *style;
    Constants *constants;
    int indent;
    int *uses;      /* [nodes] how often a needed node is used */
    int *leaves;    /* [nodes] size of its text; 0: it gets a temporary */
    int *temporary; /* [nodes] number of its temporary, 0: none yet */
    int temporaries;
    bool *planned; /* [nodes] is there a step that computes it? */
    int steps;
    Step *step;
    const char **name; /* [nodes] what its temporary is called; NULL: t12 */
    int titles;
    const char **title; /* of sections that have begun */
} Emitter;

/* Number of lanes of a node's value; 0: one number, or one of each vehicle. */
static int width_of(const Emitter *m, Ex e)
{
    return m->style->width ? m->style->width : m->dag->node[e].wide;
}

/* True for a vector of subsets or of vehicles. */
static bool is_vector(const Emitter *m, Ex e)
{
    return m->style->lanes || m->dag->node[e].wide;
}

/* Prefix of the functions for vectors of that width. */
static const char *function_name(int width)
{
    for (size_t i = 0; i < sizeof width_name / sizeof *width_name; ++i)
        if (width_name[i].width == width)
            return width_name[i].function;
    return "LANE";
}

/* A number within an expression, where a minus sign must not meet another one. */
static const char *literal_text(const Emitter *m, double value)
{
    if (!m->style->doubles)
        return emit_number(m->dag->pool, value);
    return signbit(value) ? emit_number_within(m->dag->pool, "(", value, ")")
                          : emit_number_within(m->dag->pool, "", value, "");
}

/* Count how often the roots use each node. */
static void mark_uses(Emitter *m, Ex root)
{
    Pool *pool = m->dag->pool;
    int depth = 0;
    Ex *stack = NULL;
    *POOL_PUSH(pool, stack, depth) = root;
    while (depth) {
        Ex e = stack[--depth];
        if (m->uses[e]++ || m->dag->node[e].level < LEVEL_VARIABLE)
            continue;
        for (int i = 0; i < op_form[m->dag->node[e].op].arity; ++i)
            *POOL_PUSH(pool, stack, depth) = m->dag->node[e].arg[i];
    }
}

/* Elementary functions of one vehicle a lane are long chains of operations, not calls. */
static bool are_chains(const Style *style)
{
    return style->lanes && !style->width;
}

/* Arguments have smaller numbers, so one sweep upwards sizes every text. */
static void size_texts(Emitter *m)
{
    for (int e = 0; e < m->dag->nodes; ++e) {
        const Node *node = &m->dag->node[e];
        if (!m->uses[e])
            continue;
        if (node->level < LEVEL_VARIABLE || node->op == OP_INPUT) {
            m->leaves[e] = 1;
            continue;
        }
        int sum = op_form[node->op].arity == 1;
        for (int i = 0; i < op_form[node->op].arity; ++i) {
            int own = m->leaves[node->arg[i]];
            sum += own ? own : 1;
        }
        bool again = m->uses[e] > 1 && node->op != OP_ROAD_PART;
        const bool function = (node->op >= OP_SIN && node->op <= OP_ATAN2) || node->op == OP_CURVE;
        const bool alone = m->block->scheduled && are_chains(m->style) && function;
        const bool whole = again || alone || node->op == OP_ROAD || node->op == OP_ROAD_CHANGE;
        m->leaves[e] = whole || sum > m->style->leaves ? 0 : sum;
    }
}

static int strength_of(const Node *node)
{
    switch (node->op) {
    case OP_ADD:
    case OP_SUB: return STRENGTH_SUM;
    case OP_MUL:
    case OP_DIV: return STRENGTH_PRODUCT;
    case OP_NEG: return STRENGTH_UNARY;
    default: return STRENGTH_ATOM;
    }
}

static const char *temporary_name(const Emitter *m, Ex e)
{
    return m->name[e] ? m->name[e] : pool_print(m->dag->pool, "t%d", m->temporary[e]);
}

static int constant_slot(Emitter *m, Ex e)
{
    Constants *k = m->constants;
    for (int i = 0; i < k->count; ++i)
        if (k->e[i] == e)
            return i;
    *POOL_PUSH(m->dag->pool, k->e, k->count) = e;
    return k->count - 1;
}

static void write_text(Emitter *m, Text *line, Ex e, int strength);

/* True if a node is one number that must be spread over the lanes of a vector. Constants of vectors have one number for
 * each lane already. */
static bool must_spread(const Emitter *m, Ex e)
{
    const Node *node = &m->dag->node[e];
    if (m->style->lane_constants && node->op != OP_LITERAL)
        return false;
    if (m->style->lanes)
        return node->level < LEVEL_VARIABLE && !(m->style->width && node->op == OP_CONSTANT);
    return !node->wide;
}

/* Text of a node where a vector of `width` lanes must stand, with `vector`; else one number. */
static void write_whole(Emitter *m, Text *line, Ex e, bool vector, int width)
{
    bool spread = vector && must_spread(m, e);
    if (spread)
        text_print(line, "%s(", function_name(width));
    write_text(m, line, e, 0);
    text_print(line, spread ? ")" : "");
}

/* In front of names that the generated file defines itself, so that two such files fit in one translation unit. */
static const char *own_prefix(const Emitter *m)
{
    return m->style->prefix ? m->style->prefix : "";
}

/* The functions of lanes are called as those of numbers are: LANE_SQRT for GIC_SQRT. */
static const char *form_text(const Emitter *m, Ex e, Text *line)
{
    const Op op = (Op)m->dag->node[e].op;
    const char *text = op_form[op].text;
    if (!is_vector(m, e)) {
        text_print(line, "%s", op == OP_FRICTION ? own_prefix(m) : "");
        return text;
    }
    if (op == OP_POSITIVE || op == OP_FRICTION) {
        text_print(line, "%s", function_name(width_of(m, e)));
        return op == OP_POSITIVE ? "_POSITIVE(%0, %1, %2)" : "_FRICTION(%0, %1)";
    }
    if (strncmp(text, "GIC_", 4) != 0)
        return text;
    text_print(line, "%s", function_name(width_of(m, e)));
    return text + 3;
}

/* One number. Of a known body where lanes are subsets: one for all, or a row of its vectors. */
static void write_element(const Emitter *m, Text *line, Element e)
{
    const int stride = m->style->known_stride && e.array == ARRAY_known ? m->style->known_stride[e.which] : 0;
    const int step = stride < 0 ? -stride : stride ? stride / m->style->width : 1;
    if (stride < 0)
        text_print(line, "%s(", function_name(m->style->width));
    text_print(line, "%s%s", element_row_text(m->dag->pool, m->style->naming, e, step), stride < 0 ? ")" : "");
}

/* Do `count` lanes from this one on stand one after another in an array? */
static bool stand_together(const Element *lane, int count)
{
    bool together = lane->array != ARRAY_number;
    for (int l = 1; l < count; ++l)
        together = together && lane[l].array == lane->array && lane[l].which == lane->which &&
                   lane[l].index == lane->index + l;
    return together;
}

/* A vector: all lanes of it at once where they stand together, or half of them. */
static void write_vector(const Emitter *m, Text *line, const Element *lane, int lanes)
{
    const int half = lanes / 2;
    Pool *pool = m->dag->pool;
    if (stand_together(lane, lanes)) {
        text_print(line, "lane_%d_at(%s)", lanes, element_address(pool, m->style->naming, lane[0]));
        return;
    }
    if (half > 1 && stand_together(lane, half) && stand_together(lane + half, half) &&
        lane[0].array == lane[half].array) {
        text_print(line, "lane_%d_halves(%s, %s)", lanes, element_address(pool, m->style->naming, lane[0]),
                   element_address(pool, m->style->naming, lane[half]));
        return;
    }
    text_print(line, "lane_%d_set(", lanes);
    for (int l = 0; l < lanes; ++l)
        text_print(line, "%s%s", l ? ", " : "", element_text(pool, m->style->naming, lane[l]));
    text_print(line, ")");
}

/* Arguments of a function, led by commas. */
static void write_arguments(Emitter *m, Text *line, const Ex *e, int count)
{
    for (int i = 0; i < count; ++i) {
        text_print(line, ", ");
        write_text(m, line, e[i], 0);
    }
}

/* How friction changes on the way of the point under which it is looked up. */
static void write_friction_change(Emitter *m, Text *line, const Node *node)
{
    text_print(line, "%sfriction_change(self, time", own_prefix(m));
    write_arguments(m, line, m->dag->node[node->arg[0]].arg, 2);
    write_arguments(m, line, node->arg + 1, 2);
    text_print(line, ")");
}

/* Text of a node within an expression that binds with `strength`. Recursion is as deep as one line's text. */
static void write_text(Emitter *m, Text *line, Ex e, int strength)
{
    const Node *node = &m->dag->node[e];
    if (node->op == OP_LITERAL) {
        text_print(line, "%s", literal_text(m, ex_value(m->dag, e, 0)));
        return;
    }
    if (node->level < LEVEL_VARIABLE) {
        text_print(line, "k[%d]", constant_slot(m, e));
        return;
    }
    if (m->temporary[e]) {
        text_print(line, "%s", temporary_name(m, e));
        return;
    }
    if (node->op == OP_INPUT) {
        if (node->wide)
            write_vector(m, line, node->element, node->wide);
        else
            write_element(m, line, *node->element);
        return;
    }
    if (node->op == OP_LANE) {
        write_text(m, line, node->arg[0], STRENGTH_ATOM);
        text_print(line, "[%d]", (int)node->arg[1]);
        return;
    }
    if (node->op == OP_LANE_SUM) {
        text_print(line, "%s_SUM(", function_name(width_of(m, node->arg[0])));
        write_text(m, line, node->arg[0], 0);
        text_print(line, ")");
        return;
    }
    if (node->op == OP_FOLD) {
        text_print(line, "%s_FOLD(", function_name(node->wide));
        write_whole(m, line, node->arg[0], true, node->wide);
        text_print(line, ", ");
        write_whole(m, line, node->arg[1], true, node->wide);
        text_print(line, ", %d)", (int)node->arg[2]);
        return;
    }
    if (node->op == OP_ROAD_PART) {
        text_print(line, "road%d[%d]", m->temporary[node->arg[0]], (int)node->arg[1]);
        return;
    }
    if (node->op == OP_FRICTION_CHANGE) {
        write_friction_change(m, line, node);
        return;
    }
    if (node->op == OP_CURVE && curve_is_short(&m->dag->curves->curve[node->arg[1]])) {
        const Curve *curve = &m->dag->curves->curve[node->arg[1]];
        text_print(line, "%s_SHORT_%s(", function_name(width_of(m, e)), short_curve_name(curve));
        if (curve->kind == CURVE_SHORT_SINE || curve->kind == CURVE_SHORT_COSINE)
            text_print(line, "%s, ", emit_number(m->dag->pool, curve->factor));
        write_whole(m, line, node->arg[0], true, width_of(m, e));
        text_print(line, ")");
        return;
    }
    if (node->op == OP_CURVE) {
        text_print(line, "%scurve_%d(", own_prefix(m), (int)node->arg[1]);
        write_text(m, line, node->arg[0], 0);
        text_print(line, ")");
        return;
    }
    if (node->op == OP_TABLE || node->op == OP_TABLE_SLOPE) {
        if (is_vector(m, e))
            text_print(line, "%s_TABLE(", function_name(width_of(m, e)));
        else if (node->op == OP_TABLE)
            text_print(line, "gic_table_value(");
        else
            text_print(line, "%stable_slope(", own_prefix(m));
        text_print(line, "&%stable[%d], ", own_prefix(m), (int)node->arg[1]);
        write_whole(m, line, node->arg[0], is_vector(m, e), width_of(m, e));
        text_print(line, ")");
        return;
    }
    int own = strength_of(node);
    if (own < strength)
        text_print(line, "(");
    for (const char *s = form_text(m, e, line); *s; ++s) {
        if (*s != '%') {
            text_add(line, s, 1);
            continue;
        }
        int which = *++s - '0';
        if (own == STRENGTH_ATOM) {
            write_whole(m, line, node->arg[which], is_vector(m, e), width_of(m, e));
            continue;
        }
        /* the right operand keeps its parentheses: a + (b + c) is not (a + b) + c */
        int inner = own == STRENGTH_UNARY ? STRENGTH_ATOM : own + (which == 1);
        write_text(m, line, node->arg[which], inner);
    }
    if (own < strength)
        text_print(line, ")");
}

static void write_statement(Emitter *m, Ex e)
{
    const Node *node = &m->dag->node[e];
    Text line = {.pool = m->dag->pool};
    int number = m->temporaries + 1;
    const int width = width_of(m, e);
    const char *real = real_name(m->style, width);
    if (node->op == OP_ROAD) {
        text_print(&line, "%s road%d[3];\n%*s", real, number, m->indent, "");
        if (width)
            text_print(&line, "if (!%s_ROAD(", function_name(width));
        else if (m->style->lanes && m->block->across)
            text_print(&line, "const gic_mask alike%d = LANE_ROAD(", number);
        else if (m->style->lanes)
            text_print(&line, "NEED(LANE_ROAD(");
        else
            text_print(&line, "if (!%sroad_height(self, time, ", own_prefix(m));
        write_whole(m, &line, node->arg[0], is_vector(m, e), width);
        text_print(&line, ", ");
        write_whole(m, &line, node->arg[1], is_vector(m, e), width);
        text_print(&line, ", road%d)", number);
        if (m->style->lanes && m->block->across)
            text_print(
                &line,
                ";\n%*sNEED(alike%d | ~(LANE_FINITE(road%d[0]) & LANE_FINITE(road%d[1]) & LANE_FINITE(road%d[2])),"
                "\n%*sGIC_ERROR_ASSUMPTION);\n%*sNEED(alike%d, GIC_ERROR_ROAD);",
                m->indent, "", number, number, number, number, m->indent + 4, "", m->indent, "", number);
        else if (m->style->lanes)
            text_print(&line, ", GIC_ERROR_ROAD);");
        else
            text_print(&line,
                       m->block->across ? ")\n%*sreturn GIC_FINITE(road%d, 3) ? GIC_ERROR_ASSUMPTION : GIC_ERROR_ROAD;"
                                        : ")\n%*sreturn GIC_ERROR_ROAD;",
                       m->indent + 4, "", number);
    } else if (node->op == OP_ROAD_CHANGE) {
        const Ex road = node->arg[0];
        text_print(&line, "%s road%d[3];\n%*sif (!%sroad_change(self, time", real, number, m->indent, "",
                   own_prefix(m));
        write_arguments(m, &line, m->dag->node[road].arg, 2);
        write_arguments(m, &line, node->arg + 1, 2);
        text_print(&line, ", road%d, road%d))\n%*sreturn GIC_ERROR_ROAD;", m->temporary[road], number, m->indent + 4,
                   "");
    } else {
        text_print(&line, "const %s %s = ", real, m->name[e] ? m->name[e] : pool_print(m->dag->pool, "t%d", number));
        write_text(m, &line, e, 0);
        text_print(&line, ";");
    }
    m->temporary[e] = m->temporaries = number;
    text_print(m->out, "%*s%s\n", m->indent, "", line.s);
}

/* Steps for all temporaries that `root` needs, deepest first. */
static void plan_temporaries(Emitter *m, Ex root)
{
    Pool *pool = m->dag->pool;
    int depth = 0;
    struct Frame {
        Ex e;
        int next;
    } *stack = NULL;
    *POOL_PUSH(pool, stack, depth) = (struct Frame){root, 0};
    while (depth) {
        struct Frame *top = &stack[depth - 1];
        const Node *node = &m->dag->node[top->e];
        bool leaf = node->level < LEVEL_VARIABLE || node->op == OP_INPUT || m->planned[top->e];
        if (!leaf && top->next < op_form[node->op].arity) {
            Ex argument = node->arg[top->next++];
            *POOL_PUSH(pool, stack, depth) = (struct Frame){argument, 0};
            continue;
        }
        if (!leaf && m->leaves[top->e] == 0) {
            *POOL_PUSH(pool, m->step, m->steps) = (Step){top->e, -1};
            m->planned[top->e] = true;
        }
        --depth;
    }
}

static bool is_about(const Check *check)
{
    return check->subset >= 0 || check->state >= 0;
}

void emit_abouts(Text *out, const Block *block, int indent)
{
    for (const Check *check = block->check; check < block->check + block->checks; ++check)
        if (is_about(check))
            text_print(out, "%*s{%s, %d, %d},\n", indent, "", status_name(check->status), check->subset, check->state);
}

/* The end of a function with a check's status. */
static void write_failure(const Emitter *m, const Check *check, int indent)
{
    if (is_about(check))
        text_print(m->out, "%*sreturn %s_about(self, %s, %s, %s);\n", indent, "", m->block->model,
                   status_name(check->status), subset_text(m->dag->pool, m->style->naming, check->subset),
                   state_text(m->dag->pool, m->style->naming, check->state));
    else if (check->condition >= 0)
        text_print(m->out, "%*sreturn %s_refuse(self, %d);\n", indent, "", m->block->model, check->condition);
    else
        text_print(m->out, "%*sreturn %s;\n", indent, "", status_name(check->status));
}

/* Find the lane of a vector that fails. */
static void write_failures(const Emitter *m, const Check *check, const char *vector)
{
    if (!check->lane || !is_about(check)) {
        write_failure(m, check, m->indent + 4);
        return;
    }
    for (int l = 0; l < m->dag->lanes; ++l) {
        if (l < m->dag->lanes - 1)
            text_print(m->out, "%*sif (!((%s)[%d] > %s))\n", m->indent + 4, "", vector, l,
                       literal_text(m, check->least));
        write_failure(m, check->lane[l], m->indent + (l < m->dag->lanes - 1 ? 8 : 4));
    }
}

/* Where the road must be the same on both sides, friction that is not comes as a number below 0: an assumption. */
static void write_uneven(const Emitter *m, const char *friction, int width)
{
    const char *status = status_name(GIC_ERROR_ASSUMPTION);
    if (width && m->style->width)
        text_print(m->out, "%*s%s_NEED(%s >= 0, %s);\n", m->indent, "", function_name(width), friction, status);
    else if (width)
        text_print(m->out, "%*sif (!%s_EVERY(%s >= 0))\n%*sreturn %s;\n", m->indent, "", function_name(width), friction,
                   m->indent + 4, "", status);
    else if (m->style->lanes)
        text_print(m->out, "%*sNEED(~(%s < LANE(R(0.0))), %s);\n", m->indent, "", friction, status);
    else
        text_print(m->out, "%*sif (%s < R(0.0))\n%*sreturn %s;\n", m->indent, "", friction, m->indent + 4, "", status);
}

static void write_check(Emitter *m, const Check *check)
{
    Text line = {.pool = m->dag->pool};
    const int width = width_of(m, check->value);
    write_whole(m, &line, check->value, is_vector(m, check->value), width);
    if (m->block->across && check->status == GIC_ERROR_ROAD)
        write_uneven(m, line.s, width);
    if (width) {
        const char *function = function_name(width);
        const char *value = check->magnitude ? pool_print(m->dag->pool, "%s_FABS(%s)", function, line.s) : line.s;
        const char *least = literal_text(m, check->least);
        if (m->style->width) {
            text_print(m->out, "%*s%s_NEED(%s > %s, %s);\n", m->indent, "", function, value, least,
                       status_name(check->status));
        } else {
            const bool several = check->lane && is_about(check);
            text_print(m->out, "%*sif (!%s_EVERY(%s > %s))%s\n", m->indent, "", function, value, least,
                       several ? " {" : "");
            write_failures(m, check, value);
            if (several)
                text_print(m->out, "%*s}\n", m->indent, "");
        }
        return;
    }
    if (m->style->lanes && is_about(check)) {
        int number = 0;
        for (const Check *other = m->block->check; other < check; ++other)
            number += is_about(other);
        text_print(m->out, "%*sNEED(%s > %s, ABOUT(%d));\n", m->indent, "", line.s, literal_text(m, check->least),
                   number);
        return;
    }
    if (m->style->lanes) {
        text_print(m->out, check->magnitude ? "%*sNEED(LANE_FABS(%s) > %s, %s);\n" : "%*sNEED(%s > %s, %s);\n",
                   m->indent, "", line.s, literal_text(m, check->least), status_name(check->status));
        return;
    }
    text_print(m->out, check->magnitude ? "%*sif (!(GIC_FABS(%s) > %s))\n" : "%*sif (!(%s > %s))\n", m->indent, "",
               line.s, literal_text(m, check->least));
    write_failure(m, check, m->indent + 4);
}

static void write_store(Emitter *m, const Store *store)
{
    text_print(m->out, "%*s%s = ", m->indent, "", element_text(m->dag->pool, m->style->naming, store->target));
    write_whole(m, m->out, store->value, m->style->lanes, m->style->width);
    text_print(m->out, ";\n");
}

/* Which stores may stand where their values are found, so that these need no register until the end: those of a
 * scheduled block to elements that it does not read. Others come after all values. */
static bool *find_early(Emitter *m)
{
    const Block *block = m->block;
    bool *early = pool_alloc(m->dag->pool, (size_t)block->stores + 1);
    for (int i = 0; i < block->stores; ++i)
        early[i] = (block->scheduled || block->eager) && m->planned[block->store[i].value];
    for (int e = 0; e < m->dag->nodes; ++e) {
        const Node *node = &m->dag->node[e];
        for (int i = 0; m->uses[e] && node->op == OP_INPUT && i < block->stores; ++i)
            for (int l = 0; l < (node->wide ? node->wide : 1); ++l)
                early[i] = early[i] && !element_same(node->element[l], block->store[i].target);
    }
    return early;
}

/* True if no other temporary has this name, nor anything that the file or its headers define. */
static bool is_free(const Emitter *m, const char *name)
{
    if (!strncmp(name, own_prefix(m), strlen(own_prefix(m))) || !strchr(name, '_') || strstr(name, "__"))
        return false;
    for (int i = 0; i < m->steps; ++i)
        if (m->name[m->step[i].value] && !strcmp(m->name[m->step[i].value], name))
            return false;
    return true;
}

static void give_name(Emitter *m, Ex e, const char *name)
{
    const Op op = (Op)m->dag->node[e].op;
    if (name && m->planned[e] && !m->name[e] && op != OP_ROAD && op != OP_ROAD_CHANGE && is_free(m, name))
        m->name[e] = name;
}

static void find_names(Emitter *m)
{
    Pool *pool = m->dag->pool;
    for (int i = 0; i < m->dag->labels; ++i)
        if (m->uses[m->dag->label[i].e])
            give_name(m, m->dag->label[i].e, variable_name(pool, m->dag->label[i].name));
    for (int i = 0; i < m->block->stores; ++i)
        give_name(m, m->block->store[i].value, element_variable(pool, m->style->naming, m->block->store[i].target));
}

/* A comment before the first statement of a section. Statements that belong to it may also stand later, beside what
 * needs them: their order is the one that keeps few values alive. */
static void write_title(Emitter *m, Ex e)
{
    const int section = m->style->naming ? dag_section_of(m->dag, e) : -1;
    const char *title = section < 0 ? NULL : m->dag->section[section].title;
    for (int i = 0; title && i < m->titles; ++i)
        if (!strcmp(m->title[i], title))
            return;
    if (!title)
        return;
    *POOL_PUSH(m->dag->pool, m->title, m->titles) = title;
    text_print(m->out, "%*s/* %s */\n", m->indent, "", title);
}

void block_emit(Text *out, const Block *block, const Style *style, Constants *constants, int indent)
{
    Pool *pool = block->dag->pool;
    size_t nodes = (size_t)block->dag->nodes;
    Emitter m = {.out = out,
                 .block = block,
                 .dag = block->dag,
                 .style = style,
                 .constants = constants,
                 .indent = indent,
                 .uses = pool_alloc(pool, nodes * sizeof(int)),
                 .leaves = pool_alloc(pool, nodes * sizeof(int)),
                 .temporary = pool_alloc(pool, nodes * sizeof(int)),
                 .planned = pool_alloc(pool, nodes * sizeof(bool)),
                 .name = pool_alloc(pool, nodes * sizeof(char *))};
    for (int i = 0; i < block->checks; ++i)
        mark_uses(&m, block->check[i].value);
    for (int i = 0; i < block->stores; ++i)
        mark_uses(&m, block->store[i].value);
    size_texts(&m);
    for (int i = 0; i < block->checks; ++i) {
        plan_temporaries(&m, block->check[i].value);
        *POOL_PUSH(pool, m.step, m.steps) = (Step){block->check[i].value, i};
    }
    for (int i = 0; i < block->stores; ++i)
        plan_temporaries(&m, block->store[i].value);
    /* a target may be an input of another store, so all values come before all targets */
    for (int i = 0; i < block->stores; ++i) {
        const Ex e = block->store[i].value;
        if (m.planned[e] || block->dag->node[e].level < LEVEL_VARIABLE)
            continue;
        m.leaves[e] = 0;
        m.planned[e] = true;
        *POOL_PUSH(pool, m.step, m.steps) = (Step){e, -1};
    }
    if (block->scheduled)
        schedule_steps(pool, block->dag, m.step, m.steps, are_chains(style));
    if (style->naming)
        find_names(&m);
    const bool *early = find_early(&m);
    for (int i = 0; i < m.steps; ++i) {
        write_title(&m, m.step[i].value);
        if (m.step[i].check >= 0) {
            write_check(&m, &block->check[m.step[i].check]);
        } else {
            write_statement(&m, m.step[i].value);
            for (int j = 0; j < block->stores; ++j)
                if (early[j] && block->store[j].value == m.step[i].value)
                    write_store(&m, &block->store[j]);
        }
    }
    for (int i = 0; i < block->stores; ++i)
        if (!early[i])
            write_store(&m, &block->store[i]);
}
