/* SPDX-License-Identifier: MIT
 * Other nodes in the place of some: what depends on these is made again. */
#include "expression/expression.h"

Ex ex_again(Dag *dag, Op op, Ex a, Ex b, Ex c)
{
    switch (op) {
    case OP_NEG: return ex_neg(dag, a);
    case OP_ADD: return ex_add(dag, a, b);
    case OP_SUB: return ex_sub(dag, a, b);
    case OP_MUL: return ex_mul(dag, a, b);
    case OP_DIV: return ex_div(dag, a, b);
    default: return ex_op(dag, op, a, b, c);
    }
}

const Ex *dag_replace(Dag *dag, const Ex *root, int roots, const Ex *from, const Ex *to, int count)
{
    const int nodes = dag->nodes;
    const bool *needed = dag_needed(dag, root, roots);
    Ex *image = pool_alloc(dag->pool, (size_t)nodes * sizeof *image);
    bool *given = pool_alloc(dag->pool, (size_t)nodes);
    for (int i = 0; i < count; ++i) {
        image[from[i]] = to[i];
        given[from[i]] = true;
    }
    for (Ex e = 0; e < (Ex)nodes; ++e) {
        const Node node = dag->node[e]; /* a copy: nodes move when there are more */
        const int arity = node.level < LEVEL_VARIABLE ? 0 : ex_arity((Op)node.op);
        bool same = true;
        if (given[e])
            continue;
        image[e] = e;
        Ex arg[3] = {node.arg[0], node.arg[1], node.arg[2]};
        for (int i = 0; needed[e] && i < arity; ++i) {
            arg[i] = image[node.arg[i]];
            same = same && arg[i] == node.arg[i];
        }
        if (!same)
            image[e] = ex_again(dag, (Op)node.op, arg[0], arg[1], arg[2]);
    }
    return image;
}
