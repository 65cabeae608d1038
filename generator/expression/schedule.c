/* SPDX-License-Identifier: MIT
 * The order of the statements of a block, by when their operands are there and by how long the way is from them to the
 * end: what long chains wait for begins early, and what nothing waits for fills the gaps. Processors look ahead by a
 * few hundred operations alone, and compilers leave such statements more or less as they stand. */
#include "expression/expression.h"

#include <limits.h>
#include <string.h>

/* Time is counted in additions, of which two can begin in a cycle. */
typedef struct Cost {
    int latency; /* until the result is there */
    int busy;    /* until the next operation can begin */
} Cost;

/* Of processors of today, roughly: an order that is good for one is good for its neighbours. */
static Cost cost_of(Op op, bool chains)
{
    switch (op) {
    case OP_LITERAL:
    case OP_CONSTANT:
    case OP_INPUT:
    case OP_ROAD_PART: return (Cost){0, 0};
    case OP_NEG:
    case OP_ABS: return (Cost){2, 1};
    case OP_LANE:
    case OP_ADD:
    case OP_SUB:
    case OP_MUL:
    case OP_MIN:
    case OP_MAX:
    case OP_POSITIVE: return (Cost){8, 1};
    case OP_LANE_SUM: return (Cost){24, 3};
    case OP_DIV: return (Cost){28, 8};
    case OP_SQRT: return (Cost){40, 8};
    default: return chains ? (Cost){140, 46} : (Cost){80, 60};
    }
}

typedef struct Task {
    int way;      /* from its operands to the end of the block, the longest */
    int operands; /* steps that it waits for */
    int *operand;
    int busy;  /* of all its operations */
    int ready; /* when its operands are there */
    bool done;
} Task;

typedef struct Planner {
    Pool *pool;
    const Dag *dag;
    bool chains;  /* of schedule_steps() */
    int *step_of; /* [nodes] 1 + the step that computes it; 0: it is part of another one, or a leaf */
    int *height;  /* [nodes] from its result to the end, the longest way */
    int *there;   /* [nodes] when its result is there */
    int now;
} Planner;

static const Node *node_of(const Planner *p, Ex e)
{
    return &p->dag->node[e];
}

static Cost cost(const Planner *p, Ex e)
{
    return cost_of((Op)node_of(p, e)->op, p->chains);
}

static int arguments(const Planner *p, Ex e)
{
    return node_of(p, e)->level < LEVEL_VARIABLE ? 0 : ex_arity((Op)node_of(p, e)->op);
}

/* Arguments have smaller numbers, so one sweep downwards finds the longest ways. Derivatives do not change the order of
 * what is no derivative. */
static void measure_heights(Planner *p, const Step *step, int steps)
{
    int nodes = p->dag->own ? p->dag->own : p->dag->nodes;
    for (int i = 0; i < steps; ++i)
        nodes = (int)step[i].value < nodes ? nodes : p->dag->nodes;
    for (int e = nodes - 1; e >= 0; --e)
        for (int i = 0; i < arguments(p, (Ex)e); ++i) {
            const Ex argument = node_of(p, (Ex)e)->arg[i];
            const int way = p->height[e] + cost(p, (Ex)e).latency;
            p->height[argument] = way > p->height[argument] ? way : p->height[argument];
        }
}

/* What a step computes beside what other steps compute. Recursion is as deep as one line's text. */
static void collect(Planner *p, Task *task, Ex e, bool *guarded)
{
    const int way = p->height[e] + cost(p, e).latency;
    task->way = way > task->way ? way : task->way;
    task->busy += cost(p, e).busy;
    *guarded = *guarded || node_of(p, e)->op == OP_SQRT || node_of(p, e)->op == OP_DIV;
    for (int i = 0; i < arguments(p, e); ++i) {
        const Ex argument = node_of(p, e)->arg[i];
        const bool leaf = node_of(p, argument)->level < LEVEL_VARIABLE || node_of(p, argument)->op == OP_INPUT;
        if (p->step_of[argument])
            *POOL_PUSH(p->pool, task->operand, task->operands) = p->step_of[argument] - 1;
        else if (!leaf) /* the other uses of a leaf do not matter in this step */
            collect(p, task, argument, guarded);
    }
}

/* When the result of a node is there that is computed from now on. */
static int finish(Planner *p, Ex e, bool top)
{
    int latest = p->now;
    if (!top && p->step_of[e])
        return p->there[e];
    for (int i = 0; i < arguments(p, e); ++i) {
        const int there = finish(p, node_of(p, e)->arg[i], false);
        latest = there > latest ? there : latest;
    }
    return p->there[e] = latest + cost(p, e).latency;
}

/* The task to begin next: of those that can begin now the one with the longest way, else the one that can begin first.
 */
static int choose(const Planner *p, const Task *task, int tasks)
{
    int best = -1;
    for (int i = 0; i < tasks; ++i) {
        if (task[i].done)
            continue;
        int ready = task[i].ready;
        for (int j = 0; j < task[i].operands && ready < INT_MAX; ++j)
            ready = task[task[i].operand[j]].done ? ready : INT_MAX;
        if (ready == INT_MAX)
            continue;
        ready = ready > p->now ? ready : p->now;
        const int best_ready = best < 0 ? INT_MAX : task[best].ready > p->now ? task[best].ready : p->now;
        if (ready < best_ready || (ready == best_ready && task[i].way > task[best].way))
            best = i;
    }
    return best;
}

void schedule_steps(Pool *pool, const Dag *dag, Step *step, int steps, bool chains)
{
    const size_t nodes = (size_t)dag->nodes, count = (size_t)(steps ? steps : 1);
    Planner p = {.pool = pool,
                 .dag = dag,
                 .chains = chains,
                 .step_of = pool_alloc(pool, nodes * sizeof(int)),
                 .height = pool_alloc(pool, nodes * sizeof(int)),
                 .there = pool_alloc(pool, nodes * sizeof(int))};
    Task *task = pool_alloc(pool, count * sizeof *task);
    Step *ordered = pool_alloc(pool, count * sizeof *ordered);
    int check = -1;
    for (int i = 0; i < steps; ++i)
        if (step[i].check < 0)
            p.step_of[step[i].value] = 1 + i;
    measure_heights(&p, step, steps);
    for (int i = 0; i < steps; ++i) {
        const bool computed = step[i].check >= 0 && p.step_of[step[i].value];
        bool guarded = step[i].check >= 0;
        if (computed)
            *POOL_PUSH(pool, task[i].operand, task[i].operands) = p.step_of[step[i].value] - 1;
        else
            collect(&p, &task[i], step[i].value, &guarded);
        if (guarded && check >= 0)
            *POOL_PUSH(pool, task[i].operand, task[i].operands) = check;
        if (step[i].check >= 0) {
            check = i;
            task[i].way = INT_MAX;
        }
    }
    for (int i = 0; i < steps; ++i) {
        const int next = choose(&p, task, steps);
        Task *t = &task[next];
        p.now = t->ready > p.now ? t->ready : p.now;
        if (step[next].check < 0)
            finish(&p, step[next].value, true);
        p.now += t->busy;
        t->done = true;
        ordered[i] = step[next];
        for (int j = 0; j < steps && step[next].check < 0; ++j)
            for (int k = 0; k < task[j].operands; ++k)
                if (task[j].operand[k] == next && p.there[step[next].value] > task[j].ready)
                    task[j].ready = p.there[step[next].value];
    }
    memcpy(step, ordered, (size_t)steps * sizeof *step);
}
