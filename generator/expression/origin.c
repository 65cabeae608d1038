/* SPDX-License-Identifier: MIT
 * What the constants of a class are, in words: quantities of the model by name, and what is computed from them when the
 * code is generated. For comments only. */
#include "base/text.h"
#include "expression/expression.h"

#include <string.h>

enum { ROOM = 84, DEEPEST = 12, NAMED = 6 }; /* characters and depth of an expression; quantities that are listed */

/* A constant: a quantity with a name, or an operation on others. */
struct DagOrigin {
    Ex e;
    const char *name;
    Op op;
    Ex arg[3];
};

void ex_describe(Dag *dag, Ex e, const char *format, ...)
{
    va_list args;
    if (dag->node[e].op != OP_CONSTANT)
        return;
    va_start(args, format);
    *POOL_PUSH(dag->pool, dag->origin, dag->origins) =
        (DagOrigin){.e = e, .name = pool_vprint(dag->pool, format, args)};
    va_end(args);
}

void ex_describe_folded(Dag *dag, Ex e, const Node *folded)
{
    *POOL_PUSH(dag->pool, dag->origin, dag->origins) =
        (DagOrigin){.e = e, .op = (Op)folded->op, .arg = {folded->arg[0], folded->arg[1], folded->arg[2]}};
}

/* The first one with a name, for a person knows that; else the operation that made it. */
static const DagOrigin *find(const Dag *dag, Ex e)
{
    const DagOrigin *found = NULL;
    for (const DagOrigin *origin = dag->origin; origin < dag->origin + dag->origins; ++origin)
        if (origin->e == e && (!found || (origin->name && !found->name)))
            found = origin;
    return found;
}

/* The expression; false: it is longer than a line, or some part is unknown. strength: 0 sum, 1 product, 2 factor. */
static bool write_expression(const Dag *dag, Text *out, Ex e, int strength, int depth)
{
    static const struct {
        Op op;
        const char *before, *between, *after;
        int own, inner[2];
    } form[] = {{OP_NEG, "-", "", "", 1, {2, 0}},      {OP_ADD, "", " + ", "", 0, {0, 0}},
                {OP_SUB, "", " - ", "", 0, {0, 1}},    {OP_MUL, "", " * ", "", 1, {1, 1}},
                {OP_DIV, "", " / ", "", 1, {1, 2}},    {OP_SQRT, "sqrt(", "", ")", 2, {0, 0}},
                {OP_ABS, "|", "", "|", 2, {0, 0}},     {OP_SIN, "sin(", "", ")", 2, {0, 0}},
                {OP_COS, "cos(", "", ")", 2, {0, 0}},  {OP_MAX, "max(", ", ", ")", 2, {0, 0}},
                {OP_MIN, "min(", ", ", ")", 2, {0, 0}}};
    if (dag->node[e].op == OP_LITERAL) {
        const char *number = pool_print(dag->pool, "%.6g", ex_value(dag, e, 0));
        text_print(out, *number == '-' ? "(%s)" : "%s", number);
        return true;
    }
    const DagOrigin *origin = find(dag, e);
    if (!origin || depth > DEEPEST || out->size > ROOM)
        return false;
    if (origin->name) {
        text_print(out, "%s", origin->name);
        return out->size <= ROOM;
    }
    for (size_t i = 0; i < sizeof form / sizeof *form; ++i) {
        if (form[i].op != origin->op)
            continue;
        text_print(out, "%s%s", form[i].own < strength ? "(" : "", form[i].before);
        for (int k = 0; k < ex_arity(origin->op); ++k) {
            text_print(out, "%s", k ? form[i].between : "");
            if (!write_expression(dag, out, origin->arg[k], form[i].inner[k], depth + 1))
                return false;
        }
        text_print(out, "%s%s", form[i].after, form[i].own < strength ? ")" : "");
        return out->size <= ROOM;
    }
    return false;
}

/* A name without its component: arm of arm_x. */
static const char *vector_name(const Dag *dag, const char *name)
{
    const size_t size = strlen(name);
    const bool component = size > 2 && name[size - 2] == '_' && strchr("xyz", name[size - 1]);
    return component ? pool_print(dag->pool, "%.*s", (int)size - 2, name) : name;
}

/* The names of quantities that it is computed from: [NAMED], or more. */
static void find_names(const Dag *dag, Ex e, const char **name, int *names, bool *seen)
{
    const DagOrigin *origin = seen[e] ? NULL : find(dag, e);
    const char *own = origin && origin->name ? vector_name(dag, origin->name) : NULL;
    seen[e] = true;
    if (!origin)
        return;
    for (int i = 0; own && i < *names && i < NAMED; ++i)
        if (!strcmp(name[i], own))
            return;
    if (own && (*names)++ < NAMED)
        name[*names - 1] = own;
    for (int i = 0; !origin->name && i < ex_arity(origin->op); ++i)
        find_names(dag, origin->arg[i], name, names, seen);
}

const char *ex_origin(const Dag *dag, Ex e)
{
    const char *name[NAMED];
    int names = 0;
    Text out = {.pool = dag->pool};
    if (write_expression(dag, &out, e, 0, 0))
        return out.s;
    find_names(dag, e, name, &names, pool_alloc(dag->pool, (size_t)dag->nodes));
    if (!names)
        return NULL;
    out = (Text){.pool = dag->pool};
    text_print(&out, "from ");
    for (int i = 0; i < names && i < NAMED; ++i)
        text_print(&out, "%s%s", i ? ", " : "", name[i]);
    text_print(&out, names > NAMED ? " and others" : "");
    return out.s;
}
