/* SPDX-License-Identifier: MIT
 * The value of a class's expression at the drawn configuration, as a formula of tunable parameters. Signs and
 * scales taken at the design are then right for all values of the parameters. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

/* Nodes of one graph in another one. */
typedef struct Transfer {
    const Dag *from;
    Dag *to;
    Ex *made; /* [nodes of from] 1 + the node in the other graph; 0: not copied yet */
} Transfer;

static Transfer transfer_new(Pool *pool, const Dag *from, Dag *to)
{
    return (Transfer){from, to, pool_alloc(pool, (size_t)from->nodes * sizeof(Ex))};
}

static Ex transferred(const Transfer *t, Ex e)
{
    const Node *node = &t->from->node[e];
    Ex arg[3] = {0};
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        arg[i] = t->made[node->arg[i]] - 1;
    switch (node->op) {
    case OP_NEG: return ex_neg(t->to, arg[0]);
    case OP_ADD: return ex_add(t->to, arg[0], arg[1]);
    case OP_SUB: return ex_sub(t->to, arg[0], arg[1]);
    case OP_MUL: return ex_mul(t->to, arg[0], arg[1]);
    case OP_DIV: return ex_div(t->to, arg[0], arg[1]);
    case OP_TABLE: return ex_op(t->to, OP_TABLE, arg[0], node->arg[1], 0);
    default: return ex_op(t->to, (Op)node->op, arg[0], arg[1], arg[2]);
    }
}

/* A formula of the tuning with the drawing's lengths (`rest` is 1). */
static Ex with_drawn_lengths(Pool *pool, Dag *dag, Ex formula)
{
    const bool *needed = dag_needed(dag, &formula, 1);
    Transfer t = transfer_new(pool, dag, dag);
    const int nodes = dag->nodes;
    for (Ex e = 0; e < (Ex)nodes; ++e) {
        const Node *node = &dag->node[e];
        if (!needed[e])
            continue;
        const bool rest = node->op == OP_INPUT && node->element->array == ARRAY_rest;
        t.made[e] = 1 + (rest                                                   ? ex_literal(dag, 1)
                         : node->op == OP_INPUT || node->level < LEVEL_VARIABLE ? e
                                                                                : transferred(&t, e));
    }
    return t.made[formula] - 1;
}

/* Number `place` of the drawn pose of a body: reference point, then rotation matrix. */
static Ex drawn_pose(const Work *w, int anchor, int body, int place)
{
    Ex c[3];
    double p[4], A[9];
    body_drawn(w->model, w->origin, anchor, body, c, p);
    mat_from_euler(p, A);
    return place < MOTION_A ? c[place] : ex_literal(w->model->tuning->dag, A[place - MOTION_A]);
}

/* The drawn value of an input of the class's graph. */
static Ex drawn_input(const Work *w, int member, Element input)
{
    const Subset *subset = subset_member(w, member);
    Dag *dag = w->model->tuning->dag;
    const int anchor = w->anchored ? subset->known[0] : BODY_BASE;
    const int i = input.index;
    Ex c[3];
    double p[4];
    switch (input.array) {
    case ARRAY_d: return w->derived_of[i * w->class->members + member];
    case ARRAY_x: return tuned_or_fixed(w->model, &w->model->coordinate[subset->dep[i]].design);
    case ARRAY_known: return i < MOTION_OMEGA ? drawn_pose(w, BODY_BASE, subset->known[input.which], i) : 0;
    case ARRAY_q:
        if (i % 7 < 3)
            return drawn_pose(w, anchor, subset->body[i / 7], i % 7);
        body_drawn(w->model, w->origin, anchor, subset->body[i / 7], c, p);
        return ex_literal(dag, p[i % 7 - 3]);
    default: return 0; /* rates are zero */
    }
}

Ex subset_at_drawing(const Work *w, int member, Ex e)
{
    Dag *to = w->model->tuning->dag;
    const int each = w->dag->samples / w->dag->members;
    const bool *needed = dag_needed(w->dag, &e, 1);
    Transfer t = transfer_new(w->pool, w->dag, to);
    for (Ex i = 0; i <= e; ++i) {
        const Node *node = &w->dag->node[i];
        if (needed[i])
            t.made[i] = 1 + (node->level < LEVEL_VARIABLE ? ex_literal(to, ex_value(w->dag, i, member * each))
                             : node->op == OP_INPUT       ? drawn_input(w, member, *node->element)
                                                          : transferred(&t, i));
    }
    return with_drawn_lengths(w->pool, to, t.made[e] - 1);
}
