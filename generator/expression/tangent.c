/* SPDX-License-Identifier: MIT
 * Forward differentiation: the derivative of every node along one direction, as nodes of the same graph. */
#include "expression/expression.h"

#include <string.h>

/* `then` where x is positive, else 0. */
static Ex where_positive(Dag *dag, Ex x, Ex then)
{
    return ex_op(dag, OP_POSITIVE, x, then, ex_literal(dag, 0));
}

/* `then` where there is a change, else 0: `then` may be no number there. */
static Ex where_moves(Dag *dag, Ex change, Ex then)
{
    return where_positive(dag, ex_op(dag, OP_ABS, change, 0, 0), then);
}

/* factor times change; 0 where the change is 0, whatever the factor, but if it is smooth. */
static Ex chain(Dag *dag, Ex factor, Ex change, bool smooth)
{
    if (ex_is(dag, change, 0))
        return ex_literal(dag, 0);
    const Ex slope = ex_mul(dag, factor, change);
    return smooth ? slope : where_moves(dag, change, slope);
}

static Ex sqrt_slope(Dag *dag, Ex root, Ex da, bool positive)
{
    const Ex slope = ex_mul(dag, ex_literal(dag, 0.5), ex_div(dag, da, root));
    return positive ? slope : where_moves(dag, da, slope);
}

/* 1 / sqrt(1 - a^2) */
static Ex arc_factor(Dag *dag, Ex a)
{
    const Ex one = ex_literal(dag, 1);
    return ex_div(dag, one, ex_sqrt(dag, ex_sub(dag, one, ex_mul(dag, a, a))));
}

/* An exponent that may be tuned to 0 makes a constant, at a base of 0 too, whose power of -1 has no value. */
static Ex pow_slope(Dag *dag, Ex e, Ex a, Ex b, Ex da, Ex db, bool smooth)
{
    Ex factor = ex_mul(dag, b, ex_pow(dag, a, ex_sub(dag, b, ex_literal(dag, 1))));
    if (dag->node[b].level == LEVEL_VARIABLE)
        factor = where_moves(dag, b, factor);
    const Ex base = chain(dag, factor, da, smooth);
    if (ex_is(dag, db, 0))
        return base;
    return ex_add(dag, base, where_positive(dag, a, ex_mul(dag, ex_mul(dag, e, ex_op(dag, OP_LOG, a, 0, 0)), db)));
}

static Ex div_slope(Dag *dag, Ex e, Ex a, Ex b, Ex da, Ex db)
{
    if (ex_is(dag, a, 1)) /* no second division */
        return ex_neg(dag, ex_mul(dag, ex_mul(dag, e, e), db));
    return ex_div(dag, ex_sub(dag, da, ex_mul(dag, e, db)), b);
}

static Ex atan2_slope(Dag *dag, Ex a, Ex b, Ex da, Ex db)
{
    const Ex square = ex_add(dag, ex_mul(dag, a, a), ex_mul(dag, b, b));
    return where_positive(dag, square, ex_div(dag, ex_sub(dag, ex_mul(dag, b, da), ex_mul(dag, a, db)), square));
}

/* Height and slopes of a road move with the point under which they are looked up. `several`: there are several
 * directions, so that the slopes' changes along x and y serve all of them. */
static Ex road_part_slope(Dag *dag, const Node *part, const Ex *slope, bool several)
{
    const Ex road = part->arg[0], *at = dag->node[road].arg;
    const Ex dx = slope[at[0]], dy = slope[at[1]], zero = ex_literal(dag, 0), one = ex_literal(dag, 1);
    const Ex number = part->arg[1];
    Ex along[2];
    if (ex_is(dag, dx, 0) && ex_is(dag, dy, 0))
        return zero;
    if (!several)
        return ex_op(dag, OP_ROAD_PART, ex_op(dag, OP_ROAD_CHANGE, road, dx, dy), number, 0);
    for (int i = 0; i < 2; ++i)
        along[i] = number == 0 ? ex_op(dag, OP_ROAD_PART, road, (Ex)(1 + i), 0)
                               : ex_op(dag, OP_ROAD_PART,
                                       ex_op(dag, OP_ROAD_CHANGE, road, i ? zero : one, i ? one : zero), number, 0);
    return ex_add(dag, ex_mul(dag, along[0], dx), ex_mul(dag, along[1], dy));
}

/* Friction moves likewise. */
static Ex friction_slope(Dag *dag, Ex friction, Ex dx, Ex dy, bool several)
{
    const Ex one = ex_literal(dag, 1), zero = ex_literal(dag, 0);
    if (!several)
        return ex_op(dag, OP_FRICTION_CHANGE, friction, dx, dy);
    return ex_add(dag, ex_mul(dag, ex_op(dag, OP_FRICTION_CHANGE, friction, one, zero), dx),
                  ex_mul(dag, ex_op(dag, OP_FRICTION_CHANGE, friction, zero, one), dy));
}

/* Of a node whose arguments have derivatives. positive: [nodes] checked to be above 0; several: see above; smooth: see
 * Seeds. */
static Ex slope_of(Dag *dag, Ex e, const Ex *slope, const bool *positive, bool several, bool smooth)
{
    const Node node = dag->node[e]; /* a copy: nodes move when there are more */
    const int arity = ex_arity((Op)node.op);
    const Ex a = node.arg[0], b = node.arg[1], c = node.arg[2], one = ex_literal(dag, 1), zero = ex_literal(dag, 0);
    const Ex da = arity > 0 ? slope[a] : zero, db = arity > 1 ? slope[b] : zero, dc = arity > 2 ? slope[c] : zero;
    if (node.op == OP_ROAD_PART)
        return road_part_slope(dag, &node, slope, several);
    if (ex_is(dag, da, 0) && ex_is(dag, db, 0) && ex_is(dag, dc, 0))
        return zero;
    switch ((Op)node.op) {
    case OP_NEG: return ex_neg(dag, da);
    case OP_ADD: return ex_add(dag, da, db);
    case OP_SUB: return ex_sub(dag, da, db);
    case OP_MUL:
        if (a == b)
            return ex_mul(dag, ex_add(dag, a, a), da);
        return ex_add(dag, ex_mul(dag, a, db), ex_mul(dag, da, b));
    case OP_DIV: return div_slope(dag, e, a, b, da, db);
    case OP_SQRT: return sqrt_slope(dag, e, da, smooth || positive[a]);
    case OP_ABS: return ex_op(dag, OP_POSITIVE, a, da, where_positive(dag, ex_neg(dag, a), ex_neg(dag, da)));
    case OP_SIN: return ex_mul(dag, ex_op(dag, OP_COS, a, 0, 0), da);
    case OP_COS: return ex_neg(dag, ex_mul(dag, ex_op(dag, OP_SIN, a, 0, 0), da));
    case OP_TAN: return ex_mul(dag, ex_add(dag, one, ex_mul(dag, e, e)), da);
    case OP_ASIN: return chain(dag, arc_factor(dag, a), da, smooth);
    case OP_ACOS: return ex_neg(dag, chain(dag, arc_factor(dag, a), da, smooth));
    case OP_ATAN: return ex_div(dag, da, ex_add(dag, one, ex_mul(dag, a, a)));
    case OP_EXP: return ex_mul(dag, e, da);
    case OP_LOG: return ex_div(dag, da, a);
    case OP_TANH: return ex_mul(dag, ex_sub(dag, one, ex_mul(dag, e, e)), da);
    case OP_POW: return pow_slope(dag, e, a, b, da, db, smooth);
    case OP_ATAN2: return atan2_slope(dag, a, b, da, db);
    case OP_MIN: return ex_op(dag, OP_POSITIVE, ex_sub(dag, b, a), da, db);
    case OP_MAX: return ex_op(dag, OP_POSITIVE, ex_sub(dag, a, b), da, db);
    case OP_POSITIVE: return db == dc ? db : ex_op(dag, OP_POSITIVE, a, db, dc);
    case OP_TABLE: return ex_mul(dag, ex_op(dag, OP_TABLE_SLOPE, a, b, 0), da);
    case OP_FRICTION: return friction_slope(dag, e, da, db, several);
    default: return zero;
    }
}

/* [nodes] arguments that a check of the block holds above 0, so that their roots are not 0. */
static const bool *checked(const Dag *dag, const Block *block)
{
    bool *positive = pool_alloc(dag->pool, (size_t)dag->nodes);
    for (int i = 0; block && i < block->checks; ++i)
        positive[block->check[i].value] = !block->check[i].magnitude && block->check[i].least >= 0;
    return positive;
}

/* ---- systems of equations -------------------------------------------------------------------------------------- */

/* The order in which nodes are differentiated. */
typedef struct Order {
    const Dag *dag;
    int *solved; /* [nodes] the system, by its number, whose solution a node is; -1: of none */
    Ex *node;    /* [count] */
    int count;
    char *state; /* [nodes] 0: not yet looked at, 1: waits for others, 2: in node[] */
    bool circle; /* a system depends on its own solution */
} Order;

/* Solutions of systems of several equations. */
static void find_solutions(Order *o, int nodes)
{
    for (int e = 0; e < nodes; ++e)
        o->solved[e] = -1;
    for (int s = 0; s < o->dag->systems; ++s) {
        const DagSystem *system = &o->dag->system[s];
        for (int i = 0; i < system->factors->n && system->factors->n > 1; ++i)
            if (system->found[i] && o->solved[system->x[i]] < 0)
                o->solved[system->x[i]] = s;
    }
}

/* After all that its derivative follows. Recursion is as deep as systems depend on each other, and what is between
 * them. */
static void put(Order *o, Ex e)
{
    const Node *node = &o->dag->node[e];
    o->circle = o->circle || o->state[e] == 1;
    if (o->state[e])
        return;
    o->state[e] = 1;
    for (int i = 0; node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i)
        put(o, node->arg[i]);
    if (node->level == LEVEL_VARIABLE && o->solved[e] >= 0) {
        const DagSystem *system = &o->dag->system[o->solved[e]];
        const int n = system->factors->n;
        for (int i = 0; i < n * n; ++i)
            put(o, system->factors->matrix[i]);
        for (int i = 0; i < n; ++i)
            put(o, system->b[i]);
    }
    o->state[e] = 2;
    o->node[o->count++] = e;
}

/* Of the nodes that the roots need, those before others first where they may be. */
static Order order_of(const Dag *dag, const Ex *root, int roots, bool systems)
{
    const int nodes = dag->nodes;
    const bool *needed = dag_needed(dag, root, roots);
    Order o = {.dag = dag,
               .solved = pool_alloc(dag->pool, (size_t)nodes * sizeof *o.solved),
               .node = pool_alloc(dag->pool, (size_t)nodes * sizeof *o.node),
               .state = pool_alloc(dag->pool, (size_t)nodes)};
    memset(o.solved, -1, (size_t)nodes * sizeof *o.solved);
    if (systems)
        find_solutions(&o, nodes);
    for (Ex e = 0; e < (Ex)nodes; ++e)
        if (needed[e])
            put(&o, e);
    return o.circle ? order_of(dag, root, roots, false) : o;
}

/* A dx = db - dA x, with the factors that are there: [n] dx. */
static const Ex *system_slopes(Dag *dag, const DagSystem *system, const Ex *slope)
{
    const int n = system->factors->n;
    Ex *dx = pool_alloc(dag->pool, (size_t)n * sizeof *dx);
    for (int i = 0; i < n; ++i) {
        Ex sum = 0;
        for (int j = 0; j < n; ++j)
            sum = ex_add(dag, sum, ex_mul(dag, slope[system->factors->matrix[n * i + j]], system->x[j]));
        dx[i] = ex_sub(dag, slope[system->b[i]], sum);
    }
    linear_solve(dag, system->factors, dx, dx);
    return dx;
}

static Ex solution_slope(Dag *dag, const DagSystem *system, Ex e, const Ex *slope, const Ex **dx)
{
    int i = 0;
    if (!*dx)
        *dx = system_slopes(dag, system, slope);
    while (system->x[i] != e)
        ++i;
    return (*dx)[i];
}

/* The slope of a node that is given, and of what it is the negative or a constant multiple of: where the node is a
 * factor or a summand, the graph has these in its place. */
static void give(Dag *dag, int nodes, Ex e, Ex slope_of_e, Ex *slope, bool *given)
{
    for (;;) {
        const Ex opposite = dag->node[e].op == OP_SUB ? ex_neg(dag, e) : e; /* of a difference: the other way round */
        if (opposite != e && (int)opposite < nodes) {
            slope[opposite] = ex_neg(dag, slope_of_e);
            given[opposite] = true;
        }
        const Node *node = &dag->node[e];
        slope[e] = slope_of_e;
        given[e] = true;
        const int constant = node->op != OP_MUL                               ? -1
                             : dag->node[node->arg[0]].level < LEVEL_VARIABLE ? 0
                             : dag->node[node->arg[1]].level < LEVEL_VARIABLE ? 1
                                                                              : -1;
        if (node->op != OP_NEG && constant < 0)
            return;
        const Ex inner = node->op == OP_NEG ? node->arg[0] : node->arg[1 - constant];
        if (given[inner])
            return;
        slope_of_e = node->op == OP_NEG ? ex_neg(dag, slope_of_e) : ex_div(dag, slope_of_e, node->arg[constant]);
        e = inner;
    }
}

const Ex *dag_slopes(Dag *dag, const Block *block, const Ex *root, int roots, const Seeds *seeds)
{
    const int nodes = dag->nodes;
    dag->own = dag->own ? dag->own : nodes;
    Ex *slope = pool_alloc(dag->pool, (size_t)nodes * sizeof *slope);
    bool *given = pool_alloc(dag->pool, (size_t)nodes);
    const Order order = order_of(dag, root, roots, true);
    const bool *positive = checked(dag, block);
    const Ex **dx = pool_alloc(dag->pool, ((size_t)dag->systems + 1) * sizeof *dx);
    for (int i = 0; i < seeds->givens; ++i)
        give(dag, nodes, seeds->given[i], seeds->slope[i], slope, given);
    for (int k = 0; k < order.count; ++k) {
        const Ex e = order.node[k];
        if (given[e] || dag->node[e].level < LEVEL_VARIABLE)
            continue;
        const int solved = order.solved[e];
        if (dag->node[e].op == OP_INPUT) {
            Element element = *dag->node[e].element;
            if (seeds->seed != NULL)
                slope[e] = seeds->seed(seeds->context, dag, element);
            if (seeds->seed || element.array == ARRAY_number || !seeds->moves(seeds->context, element))
                continue;
            element.slope = true;
            slope[e] = ex_input(dag, element, NULL);
        } else if (solved >= 0) {
            slope[e] = solution_slope(dag, &dag->system[solved], e, slope, &dx[solved]);
        } else {
            slope[e] = slope_of(dag, e, slope, positive, seeds->seed, seeds->smooth);
        }
    }
    return slope;
}

Block *block_tangent(const Block *block, const Seeds *seeds, bool both,
                     bool (*wanted)(const void *context, Element target))
{
    Dag *dag = block->dag;
    Block *tangent = pool_alloc(dag->pool, sizeof *tangent);
    Ex *root = pool_alloc(dag->pool, ((size_t)block->stores + 1) * sizeof *root);
    *tangent = (Block){.dag = dag, .model = block->model};
    dag_section(dag, "derivatives");
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    const Ex *slope = dag_slopes(dag, block, root, block->stores, seeds);
    for (int i = 0; both && i < block->checks; ++i)
        block_check_like(tangent, block->check[i].value, &block->check[i]);
    for (int i = 0; i < block->stores; ++i) {
        Element target = block->store[i].target;
        if (wanted && !wanted(seeds->context, target))
            continue;
        if (both)
            block_store(tangent, root[i], target);
        target.slope = true;
        block_store(tangent, slope[root[i]], target);
    }
    return tangent;
}
