/* SPDX-License-Identifier: MIT
 * Merges classes of wheels whose formulas differ in numbers only: wheels with other data of the same kind of tire.
 * For code in lanes only, where more wheels then share a vector; in scalar code literal numbers are faster. */
#include "expression/expression.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* The merged node of a pair of nodes, one of each class. */
typedef struct Pair {
    Ex second, merged;
    struct Pair *next;
} Pair;

typedef struct Merge {
    Pool *pool;
    const Dag *from[2];
    Dag *dag;
    Pair **pair; /* [nodes of the first] */
    bool failed; /* their formulas differ */
} Merge;

/* Values of both nodes, member by member. */
static void values_of(const Merge *m, Ex a, Ex b, double *value)
{
    int count = 0;
    for (int i = 0; i < m->from[0]->samples; ++i)
        value[count++] = ex_value(m->from[0], a, i);
    for (int i = 0; i < m->from[1]->samples; ++i)
        value[count++] = ex_value(m->from[1], b, i);
}

static Ex merge(Merge *m, Ex a, Ex b);

static Ex merge_variables(Merge *m, Ex a, Ex b)
{
    const Node *x = &m->from[0]->node[a], *y = &m->from[1]->node[b];
    Ex arg[3] = {0, 0, 0};
    if (x->op == OP_INPUT) {
        double value[m->dag->samples];
        m->failed = m->failed || !element_same(*x->element, *y->element);
        values_of(m, a, b, value);
        return ex_input(m->dag, *x->element, value);
    }
    const bool indexed = x->op == OP_ROAD_PART || x->op == OP_TABLE; /* the second operand is not a node */
    m->failed = m->failed || (indexed && x->arg[1] != y->arg[1]);
    for (int i = 0; i < 3 && !m->failed; ++i)
        arg[i] = indexed && i == 1 ? x->arg[1] : indexed && i ? 0 : merge(m, x->arg[i], y->arg[i]);
    return m->failed ? 0 : ex_op(m->dag, (Op)x->op, arg[0], arg[1], arg[2]);
}

/* The merged node; constants of either class become numbers of each member. */
static Ex merge(Merge *m, Ex a, Ex b)
{
    const Node *x = &m->from[0]->node[a], *y = &m->from[1]->node[b];
    if (m->failed)
        return 0;
    if (x->level < LEVEL_VARIABLE && y->level < LEVEL_VARIABLE) {
        double value[m->dag->samples];
        values_of(m, a, b, value);
        return ex_constant(m->dag, value);
    }
    if (x->op != y->op || x->level != y->level) {
        m->failed = true;
        return 0;
    }
    for (const Pair *pair = m->pair[a]; pair; pair = pair->next)
        if (pair->second == b)
            return pair->merged;
    Pair *pair = pool_alloc(m->pool, sizeof *pair);
    *pair = (Pair){b, merge_variables(m, a, b), m->pair[a]};
    m->pair[a] = pair;
    return pair->merged;
}

static Block merge_block(Merge *m, const Block *a, const Block *b)
{
    Block out = {.dag = m->dag, .model = a->model, .across = a->across};
    m->failed = m->failed || a->across != b->across || a->stores != b->stores || a->checks != b->checks;
    for (int i = 0; i < a->checks && !m->failed; ++i) {
        const Check *x = &a->check[i], *y = &b->check[i];
        m->failed = x->magnitude != y->magnitude || x->least != y->least || x->status != y->status;
        block_check_like(&out, merge(m, x->value, y->value), x);
    }
    for (int i = 0; i < a->stores && !m->failed; ++i) {
        m->failed = !element_same(a->store[i].target, b->store[i].target);
        block_store(&out, merge(m, a->store[i].value, b->store[i].value), a->store[i].target);
    }
    return out;
}

/* Add the members of `more` to *into; false: their formulas differ. */
static bool merge_class(Pool *pool, WheelClass *into, const WheelClass *more)
{
    const int members = into->members + more->members;
    Merge m = {.pool = pool, .from = {into->contact.dag, more->contact.dag}, .dag = dag_new(pool, members, members)};
    m.pair = pool_alloc(pool, sizeof *m.pair * (size_t)m.from[0]->nodes);
    WheelClass out = {.name = into->name};
    out.contact = merge_block(&m, &into->contact, &more->contact);
    out.tire = merge_block(&m, &into->tire, &more->tire);
    out.balance = merge_block(&m, &into->balance, &more->balance);
    if (m.failed)
        return false;
    for (int i = 0; i < members; ++i)
        *POOL_PUSH(pool, out.member, out.members) =
            i < into->members ? into->member[i] : more->member[i - into->members];
    *into = out;
    return true;
}

const Wheels *wheels_merge(Pool *pool, const Wheels *wheels)
{
    Wheels *out = pool_alloc(pool, sizeof *out);
    *out = *wheels;
    out->class = NULL;
    out->classes = 0;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *from = wheels->class + c;
        int into = 0;
        while (into < out->classes && !merge_class(pool, &out->class[into], from))
            ++into;
        if (into == out->classes)
            *POOL_PUSH(pool, out->class, out->classes) = wheels->class[c];
    }
    return out;
}
