/* SPDX-License-Identifier: MIT
 * From a block to a tape: which operations are needed, in which order, and where their results live.
 *
 * The order is free as long as arguments come first. It gathers operations of one kind: of all that can be done now,
 * the most numerous kind is done until none of it is left, which makes more of it possible on the way. */
#include "expression/expression.h"
#include "tape/record.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int op_arity[OP_COUNT] = {
#define OP_ARITY(name, arity, text, counted) arity,
    OP_LIST(OP_ARITY)
#undef OP_ARITY
};

/* A node that gets computed, as the tape does it. */
typedef struct Task {
    int kind, arguments;
    Ex arg[3];
} Task;

typedef struct Recorder {
    Pool *pool;
    const Block *block;
    const Dag *dag;
    const Element *array;
    int arrays;
    int *uses;        /* [nodes] by tasks still to be done, checks and stores */
    Task *task;       /* [nodes] kind 0: the node is not a task of its own */
    int *slot;        /* [nodes] */
    int *free, frees; /* [nodes] slots to use again */
    Tape *tape;
    int operands;
} Recorder;

/* ---- what is needed --------------------------------------------------------------------------------------- */

static bool is_computed(const Node *node)
{
    return node->level == LEVEL_VARIABLE && node->op != OP_INPUT && node->op != OP_ROAD_PART;
}

/* The node whose slots hold a value: a part of a road's three numbers is in one of the road's slots. */
static Ex holder(const Dag *dag, Ex e)
{
    return dag->node[e].op == OP_ROAD_PART ? dag->node[e].arg[0] : e;
}

static int slot_of(const Recorder *r, Ex e)
{
    const Node *node = &r->dag->node[e];
    return r->slot[holder(r->dag, e)] + (node->op == OP_ROAD_PART ? (int)node->arg[1] : 0);
}

/* Arguments have smaller numbers than the nodes that use them: one backward sweep counts all uses. */
static void count_uses(Recorder *r)
{
    for (int i = 0; i < r->block->checks; ++i)
        ++r->uses[holder(r->dag, r->block->check[i].value)];
    for (int i = 0; i < r->block->stores; ++i)
        ++r->uses[holder(r->dag, r->block->store[i].value)];
    for (int e = r->dag->nodes - 1; e >= 0; --e) {
        const Node *node = &r->dag->node[e];
        for (int i = 0; r->uses[e] && node->level == LEVEL_VARIABLE && i < op_arity[node->op]; ++i)
            ++r->uses[holder(r->dag, node->arg[i])];
    }
}

/* A sum or difference takes in one product that nothing else uses. */
static void fold_product(Recorder *r, Ex e)
{
    const Node *node = &r->dag->node[e];
    for (int i = 1; i >= 0; --i) {
        Task *product = &r->task[node->arg[i]];
        if (product->kind != OP_MUL || r->uses[node->arg[i]] != 1)
            continue;
        int kind = node->op == OP_ADD ? TAPE_MUL_ADD : i == 0 ? TAPE_MUL_SUB : TAPE_SUB_MUL;
        r->task[e] = (Task){kind, 3, {product->arg[0], product->arg[1], node->arg[1 - i]}};
        product->kind = 0;
        return;
    }
}

static void make_tasks(Recorder *r)
{
    for (int e = 0; e < r->dag->nodes; ++e) {
        const Node *node = &r->dag->node[e];
        if (!r->uses[e] || !is_computed(node))
            continue;
        r->task[e] = (Task){.kind = node->op, .arguments = op_arity[node->op]};
        memcpy(r->task[e].arg, node->arg, sizeof node->arg);
        if (node->op == OP_ADD || node->op == OP_SUB)
            fold_product(r, (Ex)e);
    }
}

/* ---- constants, inputs, results --------------------------------------------------------------------------- */

static void place_constants(Recorder *r)
{
    const Dag *dag = r->dag;
    int count = 0, each = dag->samples / dag->members;
    for (int e = 0; e < dag->nodes; ++e)
        if (r->uses[e] && dag->node[e].level < LEVEL_VARIABLE)
            r->slot[e] = count++;
    r->tape->constants = r->tape->slots = count;
    r->tape->constant = pool_alloc(r->pool, (size_t)(count * dag->members + 1) * sizeof(double));
    for (int e = 0; e < dag->nodes; ++e)
        for (int m = 0; r->uses[e] && dag->node[e].level < LEVEL_VARIABLE && m < dag->members; ++m)
            r->tape->constant[m * count + r->slot[e]] = ex_value(dag, (Ex)e, m * each);
}

/* An element as one number of one of the arrays. */
static TapeMove place_of(const Recorder *r, Element e)
{
    for (int i = 0; i < r->arrays; ++i)
        if (r->array[i].array == e.array && r->array[i].which == e.which)
            return (TapeMove){.array = i, .offset = e.index, .count = 1};
    fprintf(stderr, "error: the tape knows no array %d\n", (int)e.array);
    abort();
}

static int by_place(const void *a, const void *b)
{
    const TapeMove *x = a, *y = b;
    return x->array != y->array ? x->array - y->array : x->offset - y->offset;
}

/* Inputs get slots in the order of their places, so that neighbours move together. */
static void place_inputs(Recorder *r)
{
    const Dag *dag = r->dag;
    TapeMove *input = NULL;
    int inputs = 0;
    for (int e = 0; e < dag->nodes; ++e)
        if (r->uses[e] && dag->node[e].op == OP_INPUT) {
            TapeMove place = place_of(r, *dag->node[e].element);
            place.slot = e; /* for now: whose place it is */
            *POOL_PUSH(r->pool, input, inputs) = place;
        }
    if (inputs)
        qsort(input, (size_t)inputs, sizeof *input, by_place);
    Tape *tape = r->tape;
    for (int i = 0; i < inputs; ++i) {
        TapeMove *last = tape->loads ? &tape->load[tape->loads - 1] : NULL;
        r->slot[input[i].slot] = tape->slots;
        input[i].slot = tape->slots++;
        if (last && last->array == input[i].array && last->offset + last->count == input[i].offset)
            ++last->count;
        else
            *POOL_PUSH(r->pool, tape->load, tape->loads) = input[i];
    }
}

static TapeCheck check_of(const Recorder *r, const Check *check)
{
    return (TapeCheck){.slot = slot_of(r, check->value),
                       .least = check->least,
                       .magnitude = check->magnitude,
                       .status = check->status,
                       .condition = check->condition,
                       .subset = check->subset,
                       .state = check->state};
}

static void place_results(Recorder *r)
{
    const Block *block = r->block;
    Tape *tape = r->tape;
    for (int i = 0; i < block->checks; ++i)
        *POOL_PUSH(r->pool, tape->check, tape->checks) = check_of(r, &block->check[i]);
    for (int i = 0; i < block->stores; ++i) {
        TapeMove place = place_of(r, block->store[i].target);
        place.slot = slot_of(r, block->store[i].value);
        *POOL_PUSH(r->pool, tape->store, tape->stores) = place;
    }
}

/* ---- order -------------------------------------------------------------------------------------------------- */

/* Tasks and what waits for them. */
typedef struct Order {
    int *waiting;          /* [nodes] arguments that are not there yet */
    int *first_user;       /* [nodes + 1] into user */
    Ex *user;              /* tasks that take a node as an argument, as often as they do */
    Ex *ready[TAPE_KINDS]; /* in the order in which they became so */
    int readies[TAPE_KINDS];
} Order;

static Order order_new(const Recorder *r)
{
    size_t nodes = (size_t)r->dag->nodes;
    Order order = {.waiting = pool_alloc(r->pool, nodes * sizeof(int)),
                   .first_user = pool_alloc(r->pool, (nodes + 2) * sizeof(int)),
                   .user = pool_alloc(r->pool, (3 * nodes + 1) * sizeof(Ex))};
    /* counted at [argument + 2], summed up, filled through [argument + 1]: afterwards [argument] is where they begin */
    for (int sweep = 0; sweep < 2; ++sweep) {
        for (size_t e = 0; e < nodes; ++e)
            for (int i = 0; r->task[e].kind && i < r->task[e].arguments; ++i) {
                Ex argument = holder(r->dag, r->task[e].arg[i]);
                if (!r->task[argument].kind)
                    continue;
                if (sweep == 0) {
                    ++order.waiting[e];
                    ++order.first_user[argument + 2];
                } else {
                    order.user[order.first_user[argument + 1]++] = (Ex)e;
                }
            }
        for (size_t e = 2; sweep == 0 && e < nodes + 2; ++e)
            order.first_user[e] += order.first_user[e - 1];
    }
    return order;
}

static void put_operand(Recorder *r, int number)
{
    *POOL_PUSH(r->pool, r->tape->operand, r->operands) = (uint32_t)number;
}

/* A road's three slots are not given back. */
static void release(Recorder *r, Ex e)
{
    if (--r->uses[e] == 0 && r->task[e].kind && r->task[e].kind != OP_ROAD)
        r->free[r->frees++] = r->slot[e];
}

static int new_slots(Recorder *r, int count)
{
    if (count == 1 && r->frees)
        return r->free[--r->frees];
    r->tape->slots += count;
    return r->tape->slots - count;
}

static void record_task(Recorder *r, Ex e)
{
    const Task *task = &r->task[e];
    int source[3];
    for (int i = 0; i < task->arguments; ++i)
        source[i] = slot_of(r, task->arg[i]);
    for (int i = 0; i < task->arguments; ++i)
        release(r, holder(r->dag, task->arg[i]));
    r->slot[e] = new_slots(r, task->kind == OP_ROAD ? 3 : 1);
    put_operand(r, r->slot[e]);
    for (int i = 0; i < task->arguments; ++i)
        put_operand(r, source[i]);
    if (task->kind == OP_TABLE)
        put_operand(r, (int)r->dag->node[e].arg[1]);
}

/* All tasks of a kind that can be done now, with those that it enables. */
static void record_run(Recorder *r, Order *order, int kind)
{
    int count = 0;
    for (; count < order->readies[kind]; ++count) {
        Ex e = order->ready[kind][count];
        record_task(r, e);
        for (int i = order->first_user[e]; i < order->first_user[e + 1]; ++i) {
            Ex user = order->user[i];
            int next = r->task[user].kind;
            if (--order->waiting[user] == 0)
                *POOL_PUSH(r->pool, order->ready[next], order->readies[next]) = user;
        }
    }
    *POOL_PUSH(r->pool, r->tape->run, r->tape->runs) = (TapeRun){kind, count};
    order->ready[kind] = NULL;
    order->readies[kind] = 0;
}

static void record_runs(Recorder *r)
{
    Order order = order_new(r);
    for (int e = 0; e < r->dag->nodes; ++e)
        if (r->task[e].kind && !order.waiting[e])
            *POOL_PUSH(r->pool, order.ready[r->task[e].kind], order.readies[r->task[e].kind]) = (Ex)e;
    for (;;) {
        int most = 0;
        for (int kind = 0; kind < TAPE_KINDS; ++kind)
            if (order.readies[kind] > order.readies[most])
                most = kind;
        if (!order.readies[most])
            return;
        record_run(r, &order, most);
    }
}

const Tape *tape_record(Pool *pool, const Block *block, const Element *array, int arrays)
{
    size_t nodes = (size_t)block->dag->nodes;
    Recorder r = {.pool = pool,
                  .block = block,
                  .dag = block->dag,
                  .array = array,
                  .arrays = arrays,
                  .uses = pool_alloc(pool, nodes * sizeof(int)),
                  .task = pool_alloc(pool, nodes * sizeof(Task)),
                  .slot = pool_alloc(pool, nodes * sizeof(int)),
                  .free = pool_alloc(pool, nodes * sizeof(int)),
                  .tape = pool_alloc(pool, sizeof(Tape))};
    r.tape->arrays = arrays;
    count_uses(&r);
    make_tasks(&r);
    place_constants(&r);
    place_inputs(&r);
    record_runs(&r);
    place_results(&r);
    return r.tape;
}
