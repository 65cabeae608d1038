/* SPDX-License-Identifier: MIT
 * The expression graph: hash-consed nodes, folding and simplification on construction, sample values. */
#include "base/table.h"
#include "expression/curve.h"
#include "expression/expression.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int op_arity[OP_COUNT] = {
#define OP_ARITY(name, arity, text, counted) arity,
    OP_LIST(OP_ARITY)
#undef OP_ARITY
};

void dag_section(Dag *dag, const char *title)
{
    const DagSection *last = dag->sections ? &dag->section[dag->sections - 1] : NULL;
    if (last && (last->title == title || (last->title && title && !strcmp(last->title, title))))
        return;
    *POOL_PUSH(dag->pool, dag->section, dag->sections) = (DagSection){(Ex)dag->nodes, title};
}

int dag_section_of(const Dag *dag, Ex e)
{
    int low = 0, high = dag->sections; /* sections before `low` begin at e or before, those from `high` on after it */
    while (low < high) {
        const int middle = (low + high) / 2;
        if (dag->section[middle].first <= e)
            low = middle + 1;
        else
            high = middle;
    }
    return low - 1;
}

void ex_label(Dag *dag, Ex e, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    *POOL_PUSH(dag->pool, dag->label, dag->labels) = (DagLabel){e, pool_vprint(dag->pool, format, args)};
    va_end(args);
}

int ex_arity(Op op)
{
    return op_arity[op];
}

Dag *dag_new(Pool *pool, int members, int samples)
{
    Dag *dag = pool_alloc(pool, sizeof *dag);
    dag->pool = pool;
    dag->members = members;
    dag->samples = samples;
    dag->mask = 1023;
    dag->table = pool_alloc(pool, (dag->mask + 1) * sizeof *dag->table);
    /* node 0 is the literal 0, so that a zeroed Ex is a zero */
    ex_literal(dag, 0);
    return dag;
}

double ex_value(const Dag *dag, Ex e, int sample)
{
    return dag->value[(size_t)e * (size_t)dag->samples + (size_t)sample];
}

bool ex_is(const Dag *dag, Ex e, double value)
{
    return dag->node[e].op == OP_LITERAL && ex_value(dag, e, 0) == value;
}

int element_compare(Element a, Element b)
{
    if (a.array != b.array)
        return a.array < b.array ? -1 : 1;
    if (a.which != b.which)
        return a.which < b.which ? -1 : 1;
    if (a.index != b.index)
        return a.index < b.index ? -1 : 1;
    if (a.slope != b.slope)
        return a.slope ? 1 : -1;
    return memcmp(&a.number, &b.number, sizeof a.number);
}

static uint64_t mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

uint64_t element_hash(Element e)
{
    uint64_t bits;
    memcpy(&bits, &e.number, sizeof bits);
    return mix(mix(mix(mix(17, (uint64_t)e.array), (uint64_t)e.which), (uint64_t)e.index), bits) ^ (uint64_t)e.slope;
}

/* Literals and constants are what their samples are, inputs what they read, the rest what their arguments are. */
static uint64_t node_hash(const Dag *dag, const Node *node, const double *value)
{
    uint64_t hash = mix(17, node->op);
    for (int i = 0; i < 3; ++i)
        hash = mix(hash, node->arg[i]);
    for (int l = 0; node->op == OP_INPUT && l < (node->wide ? node->wide : 1); ++l)
        hash = mix(hash, element_hash(node->element[l]));
    if (node->op == OP_LITERAL || node->op == OP_CONSTANT)
        for (int s = 0; s < (node->op == OP_LITERAL ? 1 : dag->samples); ++s) {
            uint64_t bits;
            memcpy(&bits, value + s, sizeof bits);
            hash = mix(hash, bits);
        }
    return hash;
}

static bool node_same(const Dag *dag, const Node *node, const double *value, Ex other)
{
    const Node *o = &dag->node[other];
    if (o->op != node->op || memcmp(o->arg, node->arg, sizeof o->arg))
        return false;
    if (node->op == OP_INPUT) {
        bool same = o->wide == node->wide;
        for (int l = 0; same && l < (node->wide ? node->wide : 1); ++l)
            same = element_same(o->element[l], node->element[l]);
        return same;
    }
    if (node->op == OP_LITERAL || node->op == OP_CONSTANT)
        return !memcmp(dag->value + (size_t)other * (size_t)dag->samples, value,
                       (node->op == OP_LITERAL ? 1 : (size_t)dag->samples) * sizeof *value);
    return true;
}

static void dag_grow(Dag *dag)
{
    int room = dag->room ? 2 * dag->room : 256;
    size_t row = (size_t)dag->samples * sizeof *dag->value;
    dag->node =
        pool_grow(dag->pool, dag->node, (size_t)dag->nodes * sizeof *dag->node, (size_t)room * sizeof *dag->node);
    dag->value = pool_grow(dag->pool, dag->value, (size_t)dag->nodes * row, (size_t)room * row);
    dag->room = room;
}

static void table_grow(Dag *dag)
{
    dag->mask = 2 * dag->mask + 1;
    dag->table = pool_alloc(dag->pool, ((size_t)dag->mask + 1) * sizeof *dag->table);
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        uint64_t slot = node_hash(dag, &dag->node[e], dag->value + (size_t)e * (size_t)dag->samples);
        while (dag->table[slot & dag->mask])
            ++slot;
        dag->table[slot & dag->mask] = e + 1;
    }
}

Dag *dag_renamed(Pool *pool, const Dag *from, Element (*rename)(const void *context, Element input),
                 const void *context)
{
    Dag *dag = pool_alloc(pool, sizeof *dag);
    const size_t nodes = (size_t)from->nodes, row = (size_t)from->samples * sizeof *from->value;
    *dag = *from;
    dag->pool = pool;
    dag->room = from->nodes;
    dag->node = pool_alloc(pool, (nodes + 1) * sizeof *dag->node);
    dag->value = pool_alloc(pool, (nodes + 1) * row);
    memcpy(dag->node, from->node, nodes * sizeof *dag->node);
    memcpy(dag->value, from->value, nodes * row);
    for (size_t e = 0; e < nodes; ++e) {
        Node *node = &dag->node[e];
        if (node->op != OP_INPUT)
            continue;
        const int lanes = node->wide ? node->wide : 1;
        Element *element = pool_alloc(pool, (size_t)lanes * sizeof *element);
        for (int l = 0; l < lanes; ++l)
            element[l] = rename(context, node->element[l]);
        node->element = element;
    }
    dag->mask /= 2; /* doubled again */
    table_grow(dag);
    return dag;
}

/* The node equal to *node with these samples; it is made if it does not exist. */
static Ex intern(Dag *dag, const Node *node, const double *value)
{
    uint64_t slot = node_hash(dag, node, value);
    for (Ex e; (e = dag->table[slot & dag->mask]) != 0; ++slot)
        if (node_same(dag, node, value, e - 1))
            return e - 1;
    if (dag->nodes == dag->room)
        dag_grow(dag);
    Ex e = (Ex)dag->nodes++;
    dag->node[e] = *node;
    memcpy(dag->value + (size_t)e * (size_t)dag->samples, value, (size_t)dag->samples * sizeof *value);
    dag->table[slot & dag->mask] = e + 1;
    if ((uint32_t)dag->nodes > dag->mask / 2)
        table_grow(dag);
    return e;
}

/* x less `turns` quarter turns, where that many times the first part of pi / 2 is more than a double holds: products
 * are exact as two numbers, and three parts have 160 bits, so that 2^50 quarter turns leave an error of 1e-33. */
static double reduced_far(double x, double turns)
{
    const double half_pi[3] = {0x1.921fb54442d18p0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110};
    double rest = 0, high[3], low[3];
    for (int i = 0; i < 3; ++i) {
        high[i] = turns * half_pi[i];
        low[i] = fma(turns, half_pi[i], -high[i]);
    }
    for (int i = 2; i > 0; --i)
        rest += low[i] + high[i];
    return ((x - high[0]) - low[0]) - rest;
}

/* sin and cos by their Taylor series after reduction to [-pi/4, pi/4]: only exactly rounded operations. Beyond 2^50,
 * where neighbouring numbers are a quarter of a radian apart, these are the C library's. */
void portable_sincos(double x, double *sine, double *cosine)
{
    const double near = 0x1p22, far = 0x1p50;
    const double half_pi_high = 0x1.921fb54400000p0, half_pi_low = 0x1.0b4611a626331p-34;
    if (!(fabs(x) <= far)) {
        *sine = sin(x);
        *cosine = cos(x);
        return;
    }
    double turns = floor(x / (half_pi_high + half_pi_low) + 0.5);
    double y = fabs(x) <= near ? (x - turns * half_pi_high) - turns * half_pi_low : reduced_far(x, turns), y2 = y * y;
    double s = 0, c = 0;
    for (int n = 23; n >= 3; n -= 2)
        s = (1 - s) * y2 / ((double)n * (n - 1)); /* y (1 - s) = sin y */
    for (int n = 22; n >= 2; n -= 2)
        c = (1 - c) * y2 / ((double)n * (n - 1)); /* 1 - c = cos y */
    s = y * (1 - s);
    c = 1 - c;
    switch ((int)(turns - 4 * floor(turns / 4))) {
    case 0: *sine = s, *cosine = c; break;
    case 1: *sine = c, *cosine = -s; break;
    case 2: *sine = -s, *cosine = -c; break;
    default: *sine = -c, *cosine = s; break;
    }
}

double op_value(Op op, double a, double b, double c)
{
    double sine, cosine;
    switch (op) {
    case OP_NEG: return -a;
    case OP_ADD: return a + b;
    case OP_SUB: return a - b;
    case OP_MUL: return a * b;
    case OP_DIV: return a / b;
    case OP_SQRT: return sqrt(a);
    case OP_ABS: return fabs(a);
    case OP_SIN: portable_sincos(a, &sine, &cosine); return sine;
    case OP_COS: portable_sincos(a, &sine, &cosine); return cosine;
    case OP_TAN: return tan(a);
    case OP_ASIN: return asin(a);
    case OP_ACOS: return acos(a);
    case OP_ATAN: return atan(a);
    case OP_EXP: return exp(a);
    case OP_LOG: return log(a);
    case OP_TANH: return tanh(a);
    case OP_POW: return pow(a, b);
    case OP_ATAN2: return atan2(a, b);
    case OP_MIN: return a < b ? a : b;
    case OP_MAX: return a > b ? a : b;
    case OP_POSITIVE: return a > 0 ? b : c;
    case OP_FRICTION: return 1;
    default: return 0; /* roads and tables are not known to the graph: flat */
    }
}

/* Samples first .. first + count - 1 of a node; out points at its row of samples. */
static void node_evaluate(const Dag *dag, const Node *node, double *out, int first, int count)
{
    size_t samples = (size_t)dag->samples;
    const int last = op_arity[node->op] - 1; /* operands that are not nodes follow the arguments */
    const double *a = dag->value + node->arg[0] * samples, *b = dag->value + node->arg[last > 0 ? 1 : 0] * samples,
                 *c = dag->value + node->arg[last > 1 ? 2 : 0] * samples;
    for (int s = first; s < first + count; ++s)
        out[s] = node->op == OP_TABLE   ? table_value(&dag->tables[node->arg[1]], a[s])
                 : node->op == OP_CURVE ? curve_value(&dag->curves->curve[node->arg[1]], a[s])
                                        : op_value((Op)node->op, a[s], b[s], c[s]);
}

Ex ex_literal(Dag *dag, double value)
{
    double sample[dag->samples];
    sample[0] = value + 0.0; /* no negative zero: -0.0 and 0.0 are one node */
    for (int s = 1; s < dag->samples; ++s)
        sample[s] = sample[0];
    return intern(dag, &(Node){.op = OP_LITERAL, .level = LEVEL_LITERAL}, sample);
}

/* A constant that is the same for every member is a literal. */
static Ex constant_or_literal(Dag *dag, double *sample)
{
    bool same = true;
    for (int s = 0; s < dag->samples; ++s) {
        sample[s] += 0.0;
        same = same && sample[s] == sample[0];
    }
    if (same)
        return ex_literal(dag, sample[0]);
    return intern(dag, &(Node){.op = OP_CONSTANT, .level = LEVEL_CONSTANT, .wide = (uint8_t)dag->lanes}, sample);
}

Ex ex_constant(Dag *dag, const double *value)
{
    double sample[dag->samples];
    int each = dag->samples / dag->members;
    for (int s = 0; s < dag->samples; ++s)
        sample[s] = value[s / each];
    return constant_or_literal(dag, sample);
}

/* Elements that live as long as the graph. */
static const Element *kept_elements(Dag *dag, const Element *element, int count)
{
    Element *kept = pool_alloc(dag->pool, (size_t)count * sizeof *kept);
    memcpy(kept, element, (size_t)count * sizeof *kept);
    return kept;
}

Ex ex_input(Dag *dag, Element element, const double *sample)
{
    double zero[dag->samples];
    memset(zero, 0, sizeof zero);
    const Node node = {.op = OP_INPUT, .level = LEVEL_VARIABLE, .element = kept_elements(dag, &element, 1)};
    return intern(dag, &node, sample ? sample : zero);
}

Ex ex_number(Dag *dag, double value)
{
    return ex_input(dag, (Element){.array = ARRAY_number, .number = value}, &value);
}

bool ex_is_number(const Dag *dag, Ex e)
{
    const Node *node = &dag->node[e];
    return node->op == OP_INPUT && !node->wide && node->element->array == ARRAY_number;
}

Ex ex_vector(Dag *dag, const Element *lane)
{
    double zero[dag->samples];
    memset(zero, 0, sizeof zero);
    const Node node = {.op = OP_INPUT,
                       .level = LEVEL_VARIABLE,
                       .wide = (uint8_t)dag->lanes,
                       .element = kept_elements(dag, lane, dag->lanes)};
    return intern(dag, &node, zero);
}

/* From a vector to one number. */
static Ex narrow(Dag *dag, Op op, Ex vector, int lane)
{
    double zero[dag->samples];
    memset(zero, 0, sizeof zero);
    return intern(dag, &(Node){.op = (uint8_t)op, .level = LEVEL_VARIABLE, .arg = {vector, (Ex)lane}}, zero);
}

Ex ex_lane(Dag *dag, Ex vector, int lane)
{
    if (dag->node[vector].op == OP_CONSTANT)
        return ex_literal(dag, ex_value(dag, vector, lane * (dag->samples / dag->members)));
    return dag->node[vector].wide ? narrow(dag, OP_LANE, vector, lane) : vector;
}

Ex ex_lane_sum(Dag *dag, Ex vector)
{
    if (dag->node[vector].op == OP_CONSTANT) {
        double sum = 0;
        for (int l = 0; l < dag->lanes; ++l)
            sum += ex_value(dag, vector, l * (dag->samples / dag->members));
        return ex_literal(dag, sum);
    }
    if (dag->node[vector].wide)
        return narrow(dag, OP_LANE_SUM, vector, 0);
    return ex_mul(dag, ex_literal(dag, dag->lanes), vector);
}

Ex ex_fold(Dag *dag, Ex a, Ex b, int step)
{
    double zero[dag->samples];
    memset(zero, 0, sizeof zero);
    const Node node = {.op = OP_FOLD, .level = LEVEL_VARIABLE, .wide = (uint8_t)dag->lanes, .arg = {a, b, (Ex)step}};
    return intern(dag, &node, zero);
}

void ex_set_sample(Dag *dag, Ex input, int sample, double value)
{
    dag->value[(size_t)input * (size_t)dag->samples + (size_t)sample] = value;
}

static bool are_finite(const double *x, int count)
{
    for (int i = 0; i < count; ++i)
        if (!isfinite(x[i]))
            return false;
    return true;
}

/* Derivatives have no samples. */
static bool is_change(Op op)
{
    return op == OP_TABLE_SLOPE || op == OP_ROAD_CHANGE || op == OP_FRICTION_CHANGE;
}

Ex ex_op(Dag *dag, Op op, Ex a, Ex b, Ex c)
{
    Node node = {.op = (uint8_t)op, .arg = {a, b, c}};
    int arity = op_arity[op];
    for (int i = 0; i < arity; ++i) {
        if (dag->node[node.arg[i]].level > node.level)
            node.level = dag->node[node.arg[i]].level;
        if (dag->node[node.arg[i]].wide)
            node.wide = (uint8_t)dag->lanes;
        node.undefined |= dag->node[node.arg[i]].undefined;
    }
    if (op == OP_ROAD || op == OP_ROAD_PART || op == OP_FRICTION || op == OP_TABLE || is_change(op))
        node.level = LEVEL_VARIABLE;
    double sample[dag->samples];
    if (op == OP_ROAD_PART || is_change(op) || (op == OP_TABLE && !dag->tables)) {
        memset(sample, 0, sizeof sample);
        return intern(dag, &node, sample);
    }
    node_evaluate(dag, &node, sample, 0, dag->samples);
    /* what depends on constants alone is computed now and becomes an entry of the class's table */
    if (node.level < LEVEL_VARIABLE && are_finite(sample, dag->samples)) {
        const int before = dag->nodes;
        const Ex e = constant_or_literal(dag, sample);
        if (dag->nodes > before && dag->node[e].op == OP_CONSTANT)
            ex_describe_folded(dag, e, &node);
        return e;
    }
    node.undefined |= node.level < LEVEL_VARIABLE;
    node.level = LEVEL_VARIABLE;
    return intern(dag, &node, sample);
}

static bool is_neg(const Dag *dag, Ex e)
{
    return dag->node[e].op == OP_NEG;
}

static Ex ordered(Dag *dag, Op op, Ex a, Ex b)
{
    return a < b ? ex_op(dag, op, a, b, 0) : ex_op(dag, op, b, a, 0);
}

Ex ex_neg(Dag *dag, Ex a)
{
    const Node *node = &dag->node[a];
    if (node->op == OP_NEG)
        return node->arg[0];
    if (node->op == OP_SUB)
        return ex_sub(dag, node->arg[1], node->arg[0]);
    return ex_op(dag, OP_NEG, a, 0, 0);
}

Ex ex_add(Dag *dag, Ex a, Ex b)
{
    if (ex_is(dag, a, 0))
        return b;
    if (ex_is(dag, b, 0))
        return a;
    if (is_neg(dag, a) && is_neg(dag, b))
        return ex_neg(dag, ordered(dag, OP_ADD, dag->node[a].arg[0], dag->node[b].arg[0]));
    if (is_neg(dag, b))
        return ex_sub(dag, a, dag->node[b].arg[0]);
    if (is_neg(dag, a))
        return ex_sub(dag, b, dag->node[a].arg[0]);
    return ordered(dag, OP_ADD, a, b);
}

Ex ex_sub(Dag *dag, Ex a, Ex b)
{
    if (a == b && !dag->node[a].undefined)
        return ex_literal(dag, 0);
    if (ex_is(dag, b, 0))
        return a;
    if (ex_is(dag, a, 0))
        return ex_neg(dag, b);
    if (is_neg(dag, b))
        return ex_add(dag, a, dag->node[b].arg[0]);
    if (is_neg(dag, a))
        return ex_neg(dag, ex_add(dag, dag->node[a].arg[0], b));
    return ex_op(dag, OP_SUB, a, b, 0);
}

Ex ex_mul(Dag *dag, Ex a, Ex b)
{
    if ((ex_is(dag, a, 0) && !dag->node[b].undefined) || (ex_is(dag, b, 0) && !dag->node[a].undefined))
        return ex_literal(dag, 0);
    if (ex_is(dag, a, 1))
        return b;
    if (ex_is(dag, b, 1))
        return a;
    if (ex_is(dag, a, -1))
        return ex_neg(dag, b);
    if (ex_is(dag, b, -1))
        return ex_neg(dag, a);
    if (is_neg(dag, a) && is_neg(dag, b))
        return ex_mul(dag, dag->node[a].arg[0], dag->node[b].arg[0]);
    if (is_neg(dag, a))
        return ex_neg(dag, ex_mul(dag, dag->node[a].arg[0], b));
    if (is_neg(dag, b))
        return ex_neg(dag, ex_mul(dag, a, dag->node[b].arg[0]));
    /* constant factors gather in front, where they fold */
    for (int swap = 0; swap < 2; ++swap) {
        Ex k = swap ? b : a, x = swap ? a : b;
        const Node *node = &dag->node[x];
        if (dag->node[k].level < LEVEL_VARIABLE && node->op == OP_MUL && node->level == LEVEL_VARIABLE)
            for (int i = 0; i < 2; ++i)
                if (dag->node[node->arg[i]].level < LEVEL_VARIABLE)
                    return ex_mul(dag, ex_mul(dag, k, node->arg[i]), node->arg[1 - i]);
    }
    return ordered(dag, OP_MUL, a, b);
}

Ex ex_div(Dag *dag, Ex a, Ex b)
{
    if (ex_is(dag, a, 0) && !ex_is(dag, b, 0) && !dag->node[b].undefined)
        return a;
    if (dag->node[b].level < LEVEL_VARIABLE)
        return ex_mul(dag, ex_op(dag, OP_DIV, ex_literal(dag, 1), b, 0), a);
    if (is_neg(dag, a))
        return ex_neg(dag, ex_div(dag, dag->node[a].arg[0], b));
    return ex_op(dag, OP_DIV, a, b, 0);
}

Ex ex_sqrt(Dag *dag, Ex a)
{
    return ex_op(dag, OP_SQRT, a, 0, 0);
}

Ex ex_pow(Dag *dag, Ex a, Ex b)
{
    const int exponent_most = 8;
    double exponent = dag->node[b].op == OP_LITERAL ? ex_value(dag, b, 0) : 0.5;
    int n = fabs(exponent) <= exponent_most ? (int)exponent : 0;
    if (exponent != n || dag->node[b].op != OP_LITERAL)
        return ex_op(dag, OP_POW, a, b, 0);
    Ex product = ex_literal(dag, 1);
    for (int i = 0; i < abs(n); ++i)
        product = ex_mul(dag, product, a);
    return n < 0 ? ex_div(dag, ex_literal(dag, 1), product) : product;
}

Ex ex_dot(Dag *dag, const Ex a[3], const Ex b[3])
{
    return ex_add(dag, ex_add(dag, ex_mul(dag, a[0], b[0]), ex_mul(dag, a[1], b[1])), ex_mul(dag, a[2], b[2]));
}

void ex_cross(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = ex_sub(dag, ex_mul(dag, a[j], b[k]), ex_mul(dag, a[k], b[j]));
    }
}

void ex_add3(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_add(dag, a[i], b[i]);
}

void ex_sub3(Dag *dag, const Ex a[3], const Ex b[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_sub(dag, a[i], b[i]);
}

void ex_scale3(Dag *dag, Ex s, const Ex a[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_mul(dag, s, a[i]);
}

void ex_zero3(Dag *dag, Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_literal(dag, 0);
}

void ex_apply(Dag *dag, const Ex A[9], const Ex x[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_dot(dag, A + 3 * i, x);
}

void ex_apply_transposed(Dag *dag, const Ex A[9], const Ex x[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = ex_dot(dag, (Ex[]){A[i], A[3 + i], A[6 + i]}, x);
}

/* With d = 2 e: the diagonal as 1 - sums of squares, which needs no e0^2 and shares the products. */
void ex_rotation(Dag *dag, const Ex p[4], Ex A[9])
{
    Ex one = ex_literal(dag, 1), twice[3], square[3];
    for (int i = 0; i < 3; ++i) {
        twice[i] = ex_add(dag, p[1 + i], p[1 + i]);
        square[i] = ex_mul(dag, twice[i], p[1 + i]);
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        Ex product = ex_mul(dag, twice[j], p[1 + k]), turn = ex_mul(dag, twice[i], p[0]);
        A[4 * i] = ex_sub(dag, one, ex_add(dag, square[j], square[k]));
        A[3 * j + k] = ex_sub(dag, product, turn);
        A[3 * k + j] = ex_add(dag, product, turn);
    }
}

void dag_evaluate(Dag *dag, int first, int count)
{
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        if (node->level == LEVEL_VARIABLE && node->op != OP_INPUT && node->op != OP_ROAD_PART && !is_change(node->op) &&
            (node->op != OP_TABLE || dag->tables))
            node_evaluate(dag, node, dag->value + (size_t)e * (size_t)dag->samples, first, count);
        for (int s = first; dag->moved && dag->moved == e && s < first + count; ++s)
            dag->value[(size_t)e * (size_t)dag->samples + (size_t)s] += dag->moves;
    }
}

/* given: [nodes] what is there already, or NULL */
static bool *mark_needed(const Dag *dag, const Ex *root, int roots, const bool *given)
{
    /* arguments have smaller numbers than the nodes that use them: one backward sweep marks what is needed */
    bool *needed = pool_alloc(dag->pool, (size_t)dag->nodes * sizeof *needed);
    for (int i = 0; i < roots; ++i)
        needed[root[i]] = true;
    for (int e = dag->nodes - 1; e >= 0; --e) {
        const Node *node = &dag->node[e];
        needed[e] = needed[e] && !(given && given[e]);
        for (int i = 0; needed[e] && node->level == LEVEL_VARIABLE && i < op_arity[node->op]; ++i)
            needed[node->arg[i]] = true;
    }
    return needed;
}

const bool *dag_needed(const Dag *dag, const Ex *root, int roots)
{
    return mark_needed(dag, root, roots, NULL);
}

/* wide_alone: of the operations on vectors alone. */
static Count count_marked(const Dag *dag, const bool *needed, bool wide_alone)
{
    static const char kind[OP_COUNT] = {
#define OP_KIND(name, arity, text, counted) counted[0],
        OP_LIST(OP_KIND)
#undef OP_KIND
    };
    Count count = {0};
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        if (!needed[e] || node->level < LEVEL_VARIABLE || (wide_alone && !node->wide))
            continue;
        if (node->op == OP_LANE_SUM) /* by halves */
            for (int lanes = dag->lanes; lanes > 1; lanes /= 2)
                ++count.add;
        switch (kind[node->op]) {
        case 'a': ++count.add; break;
        case 'm': ++count.multiply; break;
        case 'd': ++count.divide; break;
        case 'r': ++count.root; break;
        case 'f': ++count.function; break;
        default: break;
        }
    }
    return count;
}

Count dag_count(const Dag *dag, const Ex *root, int roots)
{
    return count_marked(dag, dag_needed(dag, root, roots), false);
}

Count dag_count_wide(const Dag *dag, const Ex *root, int roots)
{
    return count_marked(dag, dag_needed(dag, root, roots), true);
}

Count dag_count_above(const Dag *dag, const Ex *root, int roots, const Ex *given, int givens)
{
    bool *there = pool_alloc(dag->pool, (size_t)dag->nodes * sizeof *there);
    for (int i = 0; i < givens; ++i) {
        const Node *node = &dag->node[given[i]];
        there[given[i]] = true;
        if (node->op == OP_NEG) /* a sum takes what is under the sign */
            there[node->arg[0]] = true;
    }
    return count_marked(dag, mark_needed(dag, root, roots, there), false);
}
