/* SPDX-License-Identifier: MIT
 * Lane packing, from packs to vectors. In the graph that is built here profitable packs become vectors and everything
 * else stays scalar; extract, reduce and insert nodes connect the two. */
#include "base/plant.h"
#include "expression/expression.h"
#include "expression/vectorize.h"
#include "expression/vectorize_private.h"

#include <stdio.h>
#include <string.h>

/* True if the node has the same value at all times, in its track or everywhere. */
static bool is_known(const Packing *p, Ex e)
{
    const Node *node = &p->dag->node[e];
    const LaneInput *input = node->op == OP_INPUT ? pack_input(p, node) : NULL;
    return pack_is_fixed(p, e) || (input && input->fixed);
}

/* What a lane reads. */
static Element lane_element(const Packing *p, Ex e)
{
    return is_known(p, e) ? (Element){.array = ARRAY_number, .number = ex_value(p->dag, e, 0)}
                          : *p->dag->node[e].element;
}

/* Numbers, one a lane; lanes without one get another's. */
static Ex vector_of(Packing *p, const Ex *e)
{
    bool same = true, literal = true;
    double value[p->lanes];
    Element lane[p->lanes];
    Ex any = 0;
    for (int l = 0; l < p->lanes; ++l)
        any = any ? any : e[l];
    for (int l = 0; l < p->lanes; ++l) {
        const Ex own = e[l] ? e[l] : any;
        same = same && own == any;
        literal = literal && is_known(p, own);
        value[l] = ex_value(p->dag, own, 0);
    }
    if (literal)
        return ex_constant(p->out, value);
    for (int l = 0; l < p->lanes; ++l)
        lane[l] = lane_element(p, e[l] ? e[l] : any);
    return same ? ex_input(p->out, lane[0], NULL) : ex_vector(p->out, lane);
}

/* What is still to be made: the vector of a group or the number of a node. */
typedef struct Wanted {
    bool vector;
    uint32_t which;
} Wanted;

typedef struct Stack {
    int depth;
    Wanted *wanted;
} Stack;

static bool have(Packing *p, Stack *stack, bool vector, uint32_t which)
{
    if ((vector ? p->vector_made : p->number_made)[which])
        return true;
    *POOL_PUSH(p->pool, stack->wanted, stack->depth) = (Wanted){vector, which};
    return false;
}

static void set_vector(Packing *p, int group, Ex e)
{
    p->vector[group] = e;
    p->vector_made[group] = true;
}

static void set_number(Packing *p, Ex node, Ex e)
{
    p->number[node] = e;
    p->number_made[node] = true;
}

static void make_vector(Packing *p, Stack *stack, int g)
{
    const Group *group = p->group_of[g];
    Ex operand[3] = {0};
    const Node *node = NULL;
    bool all = true;
    if (group->shape->op == OP_INPUT) {
        set_vector(p, g, vector_of(p, group->member));
        return;
    }
    for (int i = 0; i < 3; ++i) {
        const Operand *own = &group->shape->operand[i];
        if (own->kind == KIND_PACK || own->kind == KIND_NUMBER)
            all = have(p, stack, own->kind == KIND_PACK, own->which) && all;
    }
    if (!all)
        return;
    for (int i = 0; i < 3; ++i) {
        const Operand *own = &group->shape->operand[i];
        Ex free[p->lanes];
        for (int l = 0; l < p->lanes; ++l) {
            free[l] = 0;
            if (!group->member[l])
                continue;
            node = &p->dag->node[group->member[l]];
            if (own->kind == KIND_ANY)
                free[l] = node->arg[group->swapped[l] ? 1 - i : i];
        }
        operand[i] = own->kind == KIND_PACK     ? p->vector[own->which]
                     : own->kind == KIND_NUMBER ? p->number[own->which]
                     : own->kind == KIND_ANY    ? vector_of(p, free)
                                                : 0;
    }
    set_vector(p, g, pack_apply(p->out, node, operand[0], operand[1], operand[2]));
}

static const LaneSum *find_sum(const Packing *p, Ex e)
{
    const Element *own = p->dag->node[e].element;
    return own->array == ARRAY_sum ? &p->sum[own->index] : NULL;
}

/* The group whose members are exactly these, one in each lane, or -1. */
static int whole_group(const Packing *p, const Ex *part)
{
    const int group = p->group[part[0]];
    bool whole = part[0] && p->track[part[0]] >= 0 && p->group_of[group]->usable;
    for (int l = 0; l < p->lanes; ++l)
        whole = whole && part[l] && p->track[part[l]] >= 0 && p->group_of[group]->member[l] == part[l];
    return whole ? group : -1;
}

/* All sums of a group, a lane each, once their vectors are there. */
static void make_fold(Packing *p, Stack *stack, int group)
{
    Ex vector[p->lanes];
    int member[p->lanes], count = 0;
    bool all = true;
    for (int s = 0; s < p->sums; ++s)
        if (p->fold[s] == group) {
            const int whole = whole_group(p, p->sum[s].part);
            all = have(p, stack, true, (uint32_t)whole) && all;
            member[count] = s;
            vector[count++] = p->vector[whole];
        }
    if (!all)
        return;
    const Ex sums = fold(p->out, vector, count);
    for (int i = 0; i < count; ++i)
        set_number(p, p->sum[member[i]].node, ex_lane(p->out, sums, i));
}

static void make_lane_sum(Packing *p, Stack *stack, const LaneSum *over)
{
    const int group = whole_group(p, over->part), own = (int)(over - p->sum);
    bool all = true;
    Ex sum = 0;
    if (group >= 0 && p->fold && p->fold[own] >= 0) {
        make_fold(p, stack, p->fold[own]);
        return;
    }
    if (group >= 0) {
        if (have(p, stack, true, (uint32_t)group)) {
            set_number(p, over->node, ex_lane_sum(p->out, p->vector[group]));
            *POOL_PUSH(p->pool, p->whole, p->wholes) = own;
        }
        return;
    }
    for (int l = 0; l < p->lanes; ++l)
        all = (!over->part[l] || have(p, stack, false, over->part[l])) && all;
    for (int l = 0; all && l < p->lanes; ++l)
        if (over->part[l])
            sum = ex_add(p->out, sum, p->number[over->part[l]]);
    if (all)
        set_number(p, over->node, sum);
}

static void make_number(Packing *p, Stack *stack, Ex e)
{
    const Node *node = &p->dag->node[e];
    const int track = p->track[e];
    bool all = true;
    if (is_known(p, e)) {
        set_number(p, e, ex_literal(p->out, ex_value(p->dag, e, 0)));
    } else if (node->op == OP_INPUT) {
        const LaneSum *over = find_sum(p, e);
        if (over)
            make_lane_sum(p, stack, over);
        else
            set_number(p, e, ex_input(p->out, *node->element, NULL));
    } else if (track >= 0 && p->group_of[p->group[e]]->usable) {
        if (have(p, stack, true, (uint32_t)p->group[e]))
            set_number(p, e, ex_lane(p->out, p->vector[p->group[e]], planted("lane") ? 0 : track % p->lanes));
    } else {
        Ex arg[3] = {0};
        for (int i = 0; i < ex_arity((Op)node->op); ++i)
            all = have(p, stack, false, node->arg[i]) && all;
        for (int i = 0; all && i < ex_arity((Op)node->op); ++i)
            arg[i] = p->number[node->arg[i]];
        if (all)
            set_number(p, e, pack_apply(p->out, node, arg[0], arg[1], arg[2]));
    }
}

Ex pack_number(Packing *p, Ex from)
{
    const Ex e = p->same[from];
    Stack stack = {0};
    have(p, &stack, false, e);
    while (stack.depth) {
        const Wanted top = stack.wanted[stack.depth - 1];
        const int depth = stack.depth;
        if ((top.vector ? p->vector_made : p->number_made)[top.which]) {
            --stack.depth;
            continue;
        }
        if (top.vector)
            make_vector(p, &stack, (int)top.which);
        else
            make_number(p, &stack, top.which);
        if (stack.depth == depth)
            --stack.depth;
    }
    return p->number[e];
}

/* A graph for the result, in which nothing is yet. */
void pack_begin(Packing *p)
{
    p->out = dag_new(p->pool, p->lanes, p->lanes);
    p->out->lanes = p->lanes;
    p->number = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *p->number);
    p->number_made = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *p->number_made);
    p->vector = pool_alloc(p->pool, ((size_t)p->groups + 1) * sizeof *p->vector);
    p->vector_made = pool_alloc(p->pool, ((size_t)p->groups + 1) * sizeof *p->vector_made);
}

/* [sums] length of the chain of sums over lanes that a sum follows */
static int *sum_depths(const Packing *p)
{
    int *depth = pool_alloc(p->pool, ((size_t)p->dag->nodes + 1) * sizeof *depth);
    int *of = pool_alloc(p->pool, ((size_t)p->sums + 1) * sizeof *of);
    for (int e = 0; e < p->dag->nodes; ++e) {
        const Node *node = &p->dag->node[e];
        const LaneSum *over = node->op == OP_INPUT ? find_sum(p, (Ex)e) : NULL;
        for (int i = 0; i < ex_arity((Op)node->op); ++i)
            depth[e] = depth[node->arg[i]] > depth[e] ? depth[node->arg[i]] : depth[e];
        for (int l = 0; over && l < p->lanes; ++l)
            of[over - p->sum] = depth[over->part[l]] > of[over - p->sum] ? depth[over->part[l]] : of[over - p->sum];
        if (over)
            depth[e] = of[over - p->sum] + 1;
    }
    return of;
}

/* Sums are made together in the order in which they are needed, which is known once all is made without that. */
void pack_find_folds(Packing *p)
{
    pack_begin(p);
    for (int i = 0; i < p->block->checks; ++i)
        pack_number(p, p->block->check[i].value);
    for (int i = 0; i < p->block->stores; ++i)
        pack_number(p, p->block->store[i].value);
    p->fold = fold_groups(p->pool, p->sums, p->wholes, p->whole, sum_depths(p), p->lanes);
}
