/* SPDX-License-Identifier: MIT
 * Partial evaluation of blocks: their graphs made anew, with numbers or other inputs in place of some inputs. The rules
 * of construction of expression/graph.c do the rest. */
#include "base/table.h"
#include "expression/expression.h"
#include "model/model.h"
#include "specialize/normal_form.h"
#include "specialize/specialize.h"
#include "vehicle/vehicle.h"

#include <math.h>

/* ---- what is given ------------------------------------------------------------------------------------------------
 */

static Given *slot_of(const Givens *givens, Element input)
{
    for (uint64_t i = element_hash(input);; ++i) {
        Given *slot = &givens->given[i & (uint64_t)(givens->room - 1)];
        if (slot->input.array == ARRAY_none || element_same(slot->input, input))
            return slot;
    }
}

Givens *givens_new(Pool *pool)
{
    Givens *givens = pool_alloc(pool, sizeof *givens);
    givens->pool = pool;
    givens->room = 64;
    givens->given = pool_alloc(pool, (size_t)givens->room * sizeof *givens->given);
    return givens;
}

static void put(Givens *givens, Given given)
{
    if (2 * (givens->count + 1) > givens->room) {
        const Givens old = *givens;
        givens->room *= 2;
        givens->given = pool_alloc(givens->pool, (size_t)givens->room * sizeof *givens->given);
        for (int i = 0; i < old.room; ++i)
            if (old.given[i].input.array != ARRAY_none)
                *slot_of(givens, old.given[i].input) = old.given[i];
    }
    Given *slot = slot_of(givens, given.input);
    givens->count += slot->input.array == ARRAY_none;
    *slot = given;
}

void givens_number(Givens *givens, double value, Element input)
{
    double *one = pool_alloc(givens->pool, sizeof *one);
    *one = value;
    put(givens, (Given){.input = input, .value = one, .alike = true});
}

void givens_numbers(Givens *givens, const double *value, Element input)
{
    put(givens, (Given){.input = input, .value = value});
}

void givens_other(Givens *givens, Element input, Element other, bool negative)
{
    put(givens, (Given){.input = input, .other = other, .negative = negative});
}

const Given *givens_find(const Givens *givens, Element input)
{
    const Given *slot = slot_of(givens, input);
    return slot->input.array != ARRAY_none ? slot : NULL;
}

/* ---- nodes ----------------------------------------------------------------------------------------------------------
 */

Partial partial_new(Pool *pool, const Dag *from, const Givens *givens, const Plane *plane, bool across,
                    const Model *model)
{
    return (Partial){.from = from,
                     .to = dag_new(pool, from->members, from->samples),
                     .givens = givens,
                     .plane = plane,
                     .across = across,
                     .model = model,
                     .made = pool_alloc(pool, (size_t)from->nodes * sizeof(Ex))};
}

static Ex of(const Partial *p, Ex e)
{
    return p->made[e] - 1;
}

static Ex given_number(Dag *to, const Given *given)
{
    return given->alike ? ex_literal(to, *given->value) : ex_constant(to, given->value);
}

static Ex make_input(Partial *p, Ex e)
{
    const Dag *from = p->from;
    const Node *node = &from->node[e];
    const Given *given = givens_find(p->givens, *node->element);
    const double *sample = from->value + (size_t)e * (size_t)from->samples;
    if (!given)
        return ex_input(p->to, *node->element, sample);
    if (given->value)
        return given_number(p->to, given);
    double own[from->samples];
    for (int s = 0; s < from->samples; ++s)
        own[s] = given->negative ? -sample[s] : sample[s];
    const Given *further = givens_find(p->givens, given->other);
    const Ex other = further && further->value ? given_number(p->to, further) : ex_input(p->to, given->other, own);
    return given->negative ? ex_neg(p->to, other) : other;
}

static Ex make_constant(Partial *p, Ex e)
{
    const int members = p->from->members, each = p->from->samples / members;
    double value[members];
    for (int i = 0; i < members; ++i)
        value[i] = ex_value(p->from, e, i * each);
    return ex_constant(p->to, value);
}

/* Height or slope of a plane at the place that the node `road` of the old graph is about. */
static Ex make_road_part(Partial *p, Ex road, Ex part)
{
    Dag *to = p->to;
    if (p->across && part == 2)
        return ex_literal(to, 0);
    if (!p->plane)
        return ex_op(to, OP_ROAD_PART, of(p, road), part, 0);
    Ex height = ex_literal(to, p->plane->height);
    for (int i = 0; i < 2; ++i)
        height = ex_add(to, height, ex_mul(to, ex_literal(to, p->plane->slope[i]), of(p, p->from->node[road].arg[i])));
    return part ? ex_literal(to, p->plane->slope[part - 1]) : height;
}

/* Are the places at a and at b across from the plane that a vehicle stays in, y = y[1], mirror images? */
static bool are_images(Partial *p, Ex a, Ex b)
{
    const Ex root[2] = {a, b};
    Form form[2];
    if (!p->normal)
        p->normal = normal_new(p->to->pool, p->model, p->across);
    normal_forms(p->normal, p->to, 0, NULL, NULL, root, 2, form);
    const Form middle = normal_middle(p->normal);
    return normal_sum(p->normal, form[0], -middle) == -normal_sum(p->normal, form[1], -middle);
}

/* Of places that are mirror images the first one that is asked for stands for both, where the road is the same on both
 * sides: code compares it at these two places. */
static Ex make_road(Partial *p, Ex x, Ex y)
{
    for (Ex e = 0; p->across && p->to->members == 1 && e < (Ex)p->to->nodes; ++e)
        if (p->to->node[e].op == OP_ROAD && p->to->node[e].arg[0] == x && are_images(p, p->to->node[e].arg[1], y))
            return e;
    return ex_op(p->to, OP_ROAD, x, y, 0);
}

static Ex make_table(Partial *p, Ex x, Ex index)
{
    if (p->to->node[x].op == OP_LITERAL)
        return ex_literal(p->to, table_value(&p->model->table[index], ex_value(p->to, x, 0)));
    return ex_op(p->to, OP_TABLE, x, index, 0);
}

/* Without its sign, which goes into *sign. */
static Ex unsigned_of(Dag *dag, Ex e, int *sign)
{
    const Node *node = &dag->node[e];
    const bool negative = node->op == OP_NEG || (node->op == OP_LITERAL && ex_value(dag, e, 0) < 0);
    *sign = negative ? -*sign : *sign;
    return !negative ? e : node->op == OP_NEG ? node->arg[0] : ex_literal(dag, -ex_value(dag, e, 0));
}

/* Signs in front, so that products of both sides of a vehicle are the same nodes. */
static Ex make_product(Dag *dag, Ex a, Ex b)
{
    int sign = 1;
    a = unsigned_of(dag, a, &sign);
    b = unsigned_of(dag, b, &sign);
    const Ex product = ex_mul(dag, a, b);
    return sign < 0 ? ex_neg(dag, product) : product;
}

static Ex make_positive(Dag *to, Ex condition, Ex yes, Ex no)
{
    if (to->node[condition].op == OP_LITERAL)
        return ex_value(to, condition, 0) > 0 ? yes : no;
    return yes == no ? yes : ex_op(to, OP_POSITIVE, condition, yes, no);
}

/* A node whose arguments are made. */
static Ex make_node(Partial *p, Ex e)
{
    const Node *node = &p->from->node[e];
    Dag *to = p->to;
    Ex arg[3] = {0};
    if (node->op == OP_INPUT)
        return make_input(p, e);
    if (node->level < LEVEL_VARIABLE)
        return make_constant(p, e);
    if (node->op == OP_ROAD_PART)
        return make_road_part(p, node->arg[0], node->arg[1]);
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        arg[i] = of(p, node->arg[i]);
    switch (node->op) {
    case OP_NEG: return ex_neg(to, arg[0]);
    case OP_ADD: return ex_add(to, arg[0], arg[1]);
    case OP_SUB: return ex_sub(to, arg[0], arg[1]);
    case OP_MUL: return make_product(to, arg[0], arg[1]);
    case OP_DIV: return ex_div(to, arg[0], arg[1]);
    case OP_ABS: return ex_op(to, OP_ABS, to->node[arg[0]].op == OP_NEG ? to->node[arg[0]].arg[0] : arg[0], 0, 0);
    case OP_POW: return ex_pow(to, arg[0], arg[1]);
    case OP_POSITIVE: return make_positive(to, arg[0], arg[1], arg[2]);
    case OP_TABLE: return make_table(p, arg[0], node->arg[1]);
    case OP_FRICTION: return p->plane ? ex_literal(to, p->plane->friction) : ex_op(to, OP_FRICTION, arg[0], arg[1], 0);
    case OP_ROAD: return p->plane ? 0 : make_road(p, arg[0], arg[1]);
    default: return ex_op(to, (Op)node->op, arg[0], arg[1], arg[2]);
    }
}

/* ---- blocks ---------------------------------------------------------------------------------------------------------
 */

static bool holds(const Dag *dag, Ex value, const Check *check)
{
    bool good = dag->node[value].level < LEVEL_VARIABLE;
    for (int s = 0; good && s < dag->samples; ++s) {
        const double x = ex_value(dag, value, s);
        good = (check->magnitude ? fabs(x) : x) > check->least;
    }
    return good;
}

static Ex *roots_of(const Block *block, int *count)
{
    Ex *root = pool_alloc(block->dag->pool, (size_t)(block->stores + block->checks + block->loads + 1) * sizeof *root);
    *count = 0;
    for (int i = 0; i < block->stores; ++i)
        root[(*count)++] = block->store[i].value;
    for (int i = 0; i < block->checks; ++i)
        root[(*count)++] = block->check[i].value;
    for (int i = 0; i < block->loads; ++i)
        root[(*count)++] = block->load[i];
    return root;
}

Block partial_block(Partial *p, const Block *block)
{
    Block out = {.dag = p->to, .model = block->model, .scheduled = block->scheduled, .across = p->across};
    int roots;
    const Ex *root = roots_of(block, &roots);
    const bool *needed = dag_needed(p->from, root, roots);
    for (Ex e = 0; e < (Ex)p->from->nodes; ++e) { /* arguments have smaller numbers */
        const int section = dag_section_of(p->from, e);
        if (!needed[e] || p->made[e])
            continue;
        dag_section(p->to, section < 0 ? NULL : p->from->section[section].title);
        p->made[e] = make_node(p, e) + 1;
    }
    for (int i = 0; i < block->checks; ++i) {
        const Check *check = &block->check[i];
        if (!holds(p->to, of(p, check->value), check))
            block_check_like(&out, of(p, check->value), check);
    }
    for (int i = 0; i < block->stores; ++i)
        block_store(&out, of(p, block->store[i].value), block->store[i].target);
    for (int i = 0; i < block->loads; ++i)
        block_loads(&out, (const Ex[]){of(p, block->load[i])}, 1);
    return out;
}

bool block_uses(const Block *block, Op op)
{
    int roots;
    const Ex *root = roots_of(block, &roots);
    const bool *needed = dag_needed(block->dag, root, roots);
    for (int e = 0; e < block->dag->nodes; ++e)
        if (needed[e] && block->dag->node[e].op == op)
            return true;
    return false;
}
