/* SPDX-License-Identifier: MIT
 * Straight-line code before it is text. */
#include "expression/expression.h"
#include "gic_runtime.h"

void block_store(Block *block, Ex value, Element target)
{
    *POOL_PUSH(block->dag->pool, block->store, block->stores) = (Store){target, value};
}

void block_check_like(Block *block, Ex value, const Check *check)
{
    if (check->magnitude && block->dag->node[value].op == OP_NEG)
        value = block->dag->node[value].arg[0];
    for (int i = 0; i < block->checks; ++i)
        if (block->check[i].value == value && block->check[i].magnitude == check->magnitude &&
            block->check[i].least >= check->least)
            return;
    Check *own = POOL_PUSH(block->dag->pool, block->check, block->checks);
    *own = *check;
    own->value = value;
}

void block_check(Block *block, Ex value, bool magnitude, double least, int status)
{
    const Check check = {
        .least = least, .magnitude = magnitude, .status = status, .condition = -1, .subset = -1, .state = -1};
    block_check_like(block, value, &check);
}

void block_require(Block *block, Ex value, double least, int condition)
{
    const Check check = {
        .least = least, .status = GIC_ERROR_GEOMETRY, .condition = condition, .subset = -1, .state = -1};
    block_check_like(block, value, &check);
}

void block_check_about(Block *block, Ex value, int status, int subset, int state)
{
    const Check check = {.status = status, .condition = -1, .subset = subset, .state = state};
    block_check_like(block, value, &check);
}

const char *status_name(int status)
{
    switch (status) {
#define STATUS_NAME(name, code, text) \
    case name: return #name;
        GIC_STATUS_LIST(STATUS_NAME)
#undef STATUS_NAME
    default: return "?";
    }
}

bool block_is_about(const Block *block)
{
    for (int i = 0; i < block->checks; ++i)
        if (block->check[i].subset >= 0 || block->check[i].state >= 0)
            return true;
    return false;
}

void block_loads(Block *block, const Ex *load, int count)
{
    for (int i = 0; i < count; ++i)
        *POOL_PUSH(block->dag->pool, block->load, block->loads) = load[i];
}

static Ex *block_roots(const Block *block, int *count)
{
    *count = block->stores + block->checks;
    Ex *root = pool_alloc(block->dag->pool, (size_t)(*count + 1) * sizeof *root);
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    for (int i = 0; i < block->checks; ++i)
        root[block->stores + i] = block->check[i].value;
    return root;
}

Count block_count(const Block *block)
{
    int roots;
    const Ex *root = block_roots(block, &roots);
    return dag_count(block->dag, root, roots);
}

Count block_count_wide(const Block *block)
{
    int roots;
    const Ex *root = block_roots(block, &roots);
    return dag_count_wide(block->dag, root, roots);
}

Count block_count_above_loads(const Block *block)
{
    int roots;
    const Ex *root = block_roots(block, &roots);
    return dag_count_above(block->dag, root, roots, block->load, block->loads);
}

void block_inputs(const Block *block, void (*visit)(void *context, Element element), void *context)
{
    int roots;
    const Dag *dag = block->dag;
    const Ex *root = block_roots(block, &roots);
    const bool *needed = dag_needed(dag, root, roots);
    for (int e = 0; e < dag->nodes; ++e) {
        const Node *node = &dag->node[e];
        for (int l = 0; needed[e] && node->op == OP_INPUT && l < (node->wide ? node->wide : 1); ++l)
            visit(context, node->element[l]);
    }
}

/* What block_reads() looks for. */
typedef struct Reader {
    Array array;
    int which;
    bool slope, reads;
} Reader;

static void look(void *context, Element element)
{
    Reader *reader = context;
    reader->reads = reader->reads || (element.array == reader->array && element.which == reader->which &&
                                      element.slope == reader->slope);
}

bool block_reads(const Block *block, Array array, int which)
{
    Reader reader = {.array = array, .which = which};
    block_inputs(block, look, &reader);
    return reader.reads;
}

bool block_reads_slope(const Block *block, Array array, int which)
{
    Reader reader = {.array = array, .which = which, .slope = true};
    block_inputs(block, look, &reader);
    return reader.reads;
}
