/* SPDX-License-Identifier: MIT
 * Sums added in the order in which their terms become ready, instead of the one in which formulas list them: no term
 * that is late waits for others to be added to it. As many operations as before, or fewer where constants meet. */
#include "expression/expression.h"
#include "expression/factorize.h"

#include <string.h>

/* Cycles until a result is there, roughly. */
static int latency_of(Op op)
{
    switch (op) {
    case OP_LITERAL:
    case OP_CONSTANT:
    case OP_INPUT:
    case OP_ROAD_PART: return 0;
    case OP_NEG:
    case OP_ABS: return 1;
    case OP_DIV: return 14;
    case OP_SQRT: return 20;
    case OP_SIN:
    case OP_COS:
    case OP_TAN:
    case OP_ASIN:
    case OP_ACOS:
    case OP_ATAN:
    case OP_ATAN2:
    case OP_EXP:
    case OP_LOG:
    case OP_TANH:
    case OP_POW:
    case OP_TABLE:
    case OP_ROAD:
    case OP_FRICTION: return 40;
    default: return 4;
    }
}

typedef struct Term {
    Ex e;
    bool minus;
} Term;

typedef struct Balance {
    Pool *pool;
    Dag *dag;
    bool *inner; /* [nodes before] part of a sum that is used nowhere else */
    Ex *image;   /* [nodes before] what stands for a node */
    int nodes;   /* known to `ready` */
    size_t room;
    int *ready; /* [nodes] when a node of the graph as it has become is there */
} Balance;

static bool is_sum(const Balance *b, Ex e)
{
    const Node *node = &b->dag->node[e];
    return node->level == LEVEL_VARIABLE && (node->op == OP_ADD || node->op == OP_SUB);
}

/* When the results of all nodes are there that have been made since the last time. */
static void measure(Balance *b)
{
    const size_t old = (size_t)b->nodes, now = (size_t)b->dag->nodes;
    if (now > b->room) {
        b->ready = pool_grow(b->pool, b->ready, old * sizeof *b->ready, 2 * now * sizeof *b->ready);
        b->room = 2 * now;
    }
    for (size_t e = old; e < now; ++e) {
        const Node *node = &b->dag->node[e];
        const bool varies = node->level == LEVEL_VARIABLE;
        int latest = 0;
        for (int i = 0; varies && i < ex_arity((Op)node->op); ++i)
            latest = b->ready[node->arg[i]] > latest ? b->ready[node->arg[i]] : latest;
        b->ready[e] = varies ? latest + latency_of((Op)node->op) : -1; /* constants meet first */
    }
    b->nodes = (int)now;
}

/* The terms of a sum in the order in which it lists them. Recursion is as deep as a sum has terms. */
static void collect(const Balance *b, Ex e, bool minus, Term **term, int *terms)
{
    for (int i = 0; i < 2; ++i) {
        const Ex argument = b->dag->node[e].arg[i];
        const bool negative = minus != (i == 1 && b->dag->node[e].op == OP_SUB);
        if (b->inner[argument])
            collect(b, argument, negative, term, terms);
        else
            *POOL_PUSH(b->pool, *term, *terms) = (Term){b->image[argument], negative};
    }
}

static Term add(Dag *dag, Term a, Term b)
{
    if (a.minus == b.minus)
        return (Term){ex_add(dag, a.e, b.e), a.minus};
    return a.minus ? (Term){ex_sub(dag, b.e, a.e), false} : (Term){ex_sub(dag, a.e, b.e), false};
}

/* The two that are ready first become one, until one is left. */
static Ex add_all(Balance *b, Term *term, int terms)
{
    while (terms > 1) {
        int at[2];
        for (int k = 0; k < 2; ++k) {
            at[k] = -1;
            for (int i = 0; i < terms; ++i)
                if (!(k && i == at[0]) && (at[k] < 0 || b->ready[term[i].e] < b->ready[term[at[k]].e]))
                    at[k] = i;
        }
        const int first = at[0] < at[1] ? at[0] : at[1], second = at[0] + at[1] - first;
        term[first] = add(b->dag, term[first], term[second]);
        memmove(term + second, term + second + 1, (size_t)(--terms - second) * sizeof *term);
        measure(b);
    }
    return term->minus ? ex_neg(b->dag, term->e) : term->e;
}

const Ex *balance_sums(Pool *pool, Dag *dag, const Ex *root, int roots)
{
    const int nodes = dag->nodes;
    const bool *needed = dag_needed(dag, root, roots);
    int *uses = pool_alloc(pool, (size_t)nodes * sizeof *uses);
    Ex *image = pool_alloc(pool, (size_t)nodes * sizeof *image);
    Balance b = {.pool = pool, .dag = dag, .inner = pool_alloc(pool, (size_t)nodes * sizeof(bool)), .image = image};
    for (int i = 0; i < roots; ++i)
        ++uses[root[i]];
    for (int e = 0; e < nodes; ++e)
        for (int i = 0; needed[e] && dag->node[e].level == LEVEL_VARIABLE && i < ex_arity((Op)dag->node[e].op); ++i)
            ++uses[dag->node[e].arg[i]];
    for (int e = 0; e < nodes; ++e)
        for (int i = 0; needed[e] && is_sum(&b, (Ex)e) && i < 2; ++i) {
            const Ex argument = dag->node[e].arg[i];
            b.inner[argument] = is_sum(&b, argument) && uses[argument] == 1;
        }
    measure(&b);
    for (int e = 0; e < nodes; ++e) {
        const Node node = dag->node[e];
        image[e] = (Ex)e;
        if (!needed[e] || b.inner[e] || node.level < LEVEL_VARIABLE || ex_arity((Op)node.op) == 0)
            continue;
        const int section = dag_section_of(dag, (Ex)e);
        dag_section(dag, section < 0 ? NULL : dag->section[section].title);
        if (is_sum(&b, (Ex)e)) {
            Term *term = NULL;
            int terms = 0;
            collect(&b, (Ex)e, false, &term, &terms);
            image[e] = add_all(&b, term, terms);
        } else {
            Ex arg[3] = {node.arg[0], node.arg[1], node.arg[2]};
            for (int i = 0; i < ex_arity((Op)node.op); ++i)
                arg[i] = image[arg[i]];
            image[e] = ex_again(dag, (Op)node.op, arg[0], arg[1], arg[2]);
        }
        measure(&b);
    }
    systems_replace(dag, image, nodes);
    return image;
}
