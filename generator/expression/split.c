/* SPDX-License-Identifier: MIT
 * A block in parts that are computed one after another. */
#include "expression/split.h"

#include <string.h>

/* Nodes by the part that computes them first. */
typedef struct Split {
    Dag *dag;
    int *owner, *seen; /* [nodes] parts, from 1 on; 0: none. seen: the last part that needed the node */
    bool *kept;        /* [nodes] later parts read it */
} Split;

static int work_of(const Node *node)
{
    switch ((Op)node->op) {
    case OP_LITERAL:
    case OP_CONSTANT:
    case OP_INPUT:
    case OP_NEG:
    case OP_ROAD_PART: return 0;
    case OP_DIV:
    case OP_SQRT: return 4;
    case OP_ADD:
    case OP_SUB:
    case OP_MUL:
    case OP_ABS:
    case OP_MIN:
    case OP_MAX:
    case OP_POSITIVE: return 1;
    default: return 20; /* functions, tables, the road */
    }
}

/* Can a part read its value from memory? Of the road others read more than a number. */
static bool is_number(const Node *node)
{
    return node->op != OP_ROAD && node->op != OP_ROAD_CHANGE && node->op != OP_FRICTION;
}

/* Give what nothing has computed yet to a part; returns the work. */
static int take(Split *split, Ex e, int part)
{
    const Node *node = &split->dag->node[e];
    if (split->owner[e] || node->level != LEVEL_VARIABLE)
        return 0;
    split->owner[e] = part;
    int work = work_of(node);
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        work += take(split, node->arg[i], part);
    return work;
}

/* Mark what a part reads of earlier ones. */
static void need(Split *split, Ex e, int part)
{
    const Node *node = &split->dag->node[e];
    if (node->level != LEVEL_VARIABLE || node->op == OP_INPUT || split->seen[e] == part)
        return;
    split->seen[e] = part;
    if (split->owner[e] != part && is_number(node)) {
        split->kept[e] = true;
        return;
    }
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        need(split, node->arg[i], part);
}

static Split *split_new(Dag *dag)
{
    Split *split = pool_alloc(dag->pool, sizeof *split);
    const size_t room = (size_t)dag->nodes + 1;
    *split = (Split){.dag = dag,
                     .owner = pool_alloc(dag->pool, room * sizeof(int)),
                     .seen = pool_alloc(dag->pool, room * sizeof(int)),
                     .kept = pool_alloc(dag->pool, room)};
    return split;
}

int block_work(const Block *block)
{
    Split *split = split_new(block->dag);
    int work = 0;
    for (int i = 0; i < block->stores; ++i)
        work += take(split, block->store[i].value, 1);
    return work;
}

/* One part: its stores, and what it keeps, with what earlier ones kept read from memory. */
static void write_part(const Split *split, const Block *block, const int *part_of, int part, const Ex *kept,
                       const Ex *memory, int count, const Element *place, Block *out)
{
    Dag *dag = block->dag;
    Ex *root = pool_alloc(dag->pool, (size_t)(block->stores + count + 1) * sizeof *root);
    Ex *from = pool_alloc(dag->pool, ((size_t)count + 1) * sizeof *from),
       *to = pool_alloc(dag->pool, ((size_t)count + 1) * sizeof *to);
    int roots = 0, given = 0;
    for (int i = 0; i < count; ++i)
        if (split->owner[kept[i]] == part)
            root[roots++] = kept[i];
        else if (split->owner[kept[i]] < part) {
            from[given] = kept[i];
            to[given++] = memory[i];
        }
    for (int i = 0; i < block->stores; ++i)
        if (part_of[i] == part)
            root[roots++] = block->store[i].value;
    const Ex *image = dag_replace(dag, root, roots, from, to, given);
    *out = (Block){.dag = dag, .model = block->model, .eager = block->eager};
    for (int i = 0; i < count; ++i)
        if (split->owner[kept[i]] == part)
            block_store(out, image[kept[i]], place[i]);
    for (int i = 0; i < block->stores; ++i)
        if (part_of[i] == part)
            block_store(out, image[block->store[i].value], block->store[i].target);
}

int block_split(const Block *block, int most, Array array, int *kept, Block **part)
{
    Dag *dag = block->dag;
    Split *split = split_new(dag);
    const int nodes = dag->nodes;
    int *part_of = pool_alloc(dag->pool, ((size_t)block->stores + 1) * sizeof *part_of), parts = 1, work = 0, count = 0;
    for (int i = 0; i < block->stores; ++i) {
        if (work >= most) {
            ++parts;
            work = 0;
        }
        work += 1 + take(split, block->store[i].value, parts);
        part_of[i] = parts;
    }
    for (int i = 0; i < block->stores; ++i)
        need(split, block->store[i].value, part_of[i]);
    Ex *value = pool_alloc(dag->pool, ((size_t)nodes + 1) * sizeof *value),
       *memory = pool_alloc(dag->pool, ((size_t)nodes + 1) * sizeof *memory);
    Element *place = pool_alloc(dag->pool, ((size_t)nodes + 1) * sizeof *place);
    for (Ex e = 0; e < (Ex)nodes; ++e)
        if (split->kept[e]) {
            place[count] = element_at(array, (*kept)++);
            memory[count] = ex_input(dag, place[count], NULL);
            value[count++] = e;
        }
    *part = pool_alloc(dag->pool, (size_t)parts * sizeof **part);
    for (int p = 1; p <= parts; ++p)
        write_part(split, block, part_of, p, value, memory, count, place, *part + p - 1);
    return parts;
}
