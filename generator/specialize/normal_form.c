/* SPDX-License-Identifier: MIT
 * Normal forms of expressions. Sums and products are flattened, their terms and factors ordered, equal terms counted
 * and opposite ones cancelled; signs are pulled out of products, odd functions and conditional values. Equal forms are
 * one form, so comparing two numbers compares expressions. Constants stay apart: nothing is computed with them. */
#include "base/table.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "specialize/normal_form.h"

#include <stdlib.h>
#include <string.h>

enum { FORM_SIGN = OP_COUNT }; /* after the operations of graphs: -1, 0 or 1 */

/* Larger sums and products are not flattened into others: a power of a power of ... stays short. */
static const int most_equal = 1 << 10, most_factors = 64;

/* OP_LITERAL: number, above 0. OP_INPUT: the element. OP_ADD: pairs of a form and how often it occurs. OP_MUL: factors.
 * Others: arguments, then what tells operations of one kind apart. */
typedef struct Shape {
    int op, words;
    const int *word;
    double number;
    Element input;
} Shape;

struct Normal {
    Pool *pool;
    const Model *model;
    bool even;
    int shapes;
    Shape *shape;
    int *slot; /* hash table */
    uint32_t mask;
};

typedef struct Term {
    Form form;
    int count;
} Term;

/* One run through a graph. */
typedef struct Run {
    Normal *normal;
    const Dag *dag;
    int sample;
    NormalInput *input;
    void *context;
    Form *form;         /* [nodes] of those that are done */
    const bool *needed; /* [nodes] */
    bool *inner;        /* [nodes] part of one sum alone, which takes its terms directly */
    Term *term;         /* of the sum at hand */
    int terms;
} Run;

/* ---- forms ------------------------------------------------------------------------------------------------------ */

static uint64_t shape_hash(const Shape *shape)
{
    uint64_t hash = text_hash((const char *)shape->word, (size_t)shape->words * sizeof *shape->word);
    hash ^= text_hash((const char *)&shape->number, sizeof shape->number) * 3;
    if (shape->op == OP_INPUT)
        hash ^= element_hash(shape->input);
    return hash ^ (hash >> 29) ^ (uint64_t)shape->op * 0x9e3779b97f4a7c15u;
}

static bool shape_same(const Shape *a, const Shape *b)
{
    if (a->op != b->op || a->words != b->words || memcmp(&a->number, &b->number, sizeof a->number))
        return false;
    if (a->words && memcmp(a->word, b->word, (size_t)a->words * sizeof *a->word))
        return false;
    return element_same(a->input, b->input);
}

static void slots_grow(Normal *normal)
{
    normal->mask = 2 * normal->mask + 1;
    normal->slot = pool_alloc(normal->pool, ((size_t)normal->mask + 1) * sizeof *normal->slot);
    for (int f = 1; f < normal->shapes; ++f) {
        uint64_t slot = shape_hash(&normal->shape[f]);
        while (normal->slot[slot & normal->mask])
            ++slot;
        normal->slot[slot & normal->mask] = f;
    }
}

/* The form of that shape; its words are copied. */
static Form intern(Normal *normal, Shape shape)
{
    uint64_t slot = shape_hash(&shape);
    for (int f; (f = normal->slot[slot & normal->mask]) != 0; ++slot)
        if (shape_same(&normal->shape[f], &shape))
            return f;
    const size_t size = (size_t)shape.words * sizeof *shape.word;
    if (shape.words)
        shape.word = pool_grow(normal->pool, (void *)shape.word, size, size);
    const Form f = normal->shapes;
    normal->slot[slot & normal->mask] = f;
    *POOL_PUSH(normal->pool, normal->shape, normal->shapes) = shape;
    if ((uint32_t)normal->shapes > normal->mask / 2)
        slots_grow(normal);
    return f;
}

Normal *normal_new(Pool *pool, const Model *model, bool even)
{
    Normal *normal = pool_alloc(pool, sizeof *normal);
    *normal = (Normal){.pool = pool, .model = model, .even = even, .mask = 1023};
    normal->slot = pool_alloc(pool, ((size_t)normal->mask + 1) * sizeof *normal->slot);
    *POOL_PUSH(pool, normal->shape, normal->shapes) = (Shape){.op = OP_LITERAL}; /* zero, in no slot */
    return normal;
}

Form normal_input(Normal *normal, Element input)
{
    return intern(normal, (Shape){.op = OP_INPUT, .input = input});
}

static Form literal(Normal *normal, double value)
{
    if (value == 0)
        return 0;
    const Form f = intern(normal, (Shape){.op = OP_LITERAL, .number = value < 0 ? -value : value});
    return value < 0 ? -f : f;
}

static const Shape *shape_of(const Normal *normal, Form f)
{
    return &normal->shape[abs(f)];
}

static Form operation(Normal *normal, int op, int words, const int *word)
{
    return intern(normal, (Shape){.op = op, .words = words, .word = word});
}

static int sign_of(Form f)
{
    return f < 0 ? -1 : 1;
}

/* ---- sums ------------------------------------------------------------------------------------------------------- */

static void add_term(Pool *pool, Term **term, int *terms, const Normal *normal, Form f, int sign)
{
    const Shape *shape = shape_of(normal, f);
    bool flat = f && shape->op == OP_ADD;
    for (int i = 0; flat && i < shape->words; i += 2)
        flat = abs(shape->word[i + 1]) <= most_equal;
    sign *= sign_of(f);
    for (int i = 0; flat && i < shape->words; i += 2)
        *POOL_PUSH(pool, *term, *terms) = (Term){shape->word[i], sign * shape->word[i + 1]};
    if (!flat && f)
        *POOL_PUSH(pool, *term, *terms) = (Term){abs(f), sign};
}

static int term_compare(const void *a, const void *b)
{
    const Form x = ((const Term *)a)->form, y = ((const Term *)b)->form;
    return (x > y) - (x < y);
}

/* Terms are reordered. */
static Form sum_of(Normal *normal, Term *term, int terms)
{
    int *word = pool_alloc(normal->pool, (2 * (size_t)terms + 1) * sizeof *word), words = 0;
    if (terms)
        qsort(term, (size_t)terms, sizeof *term, term_compare);
    for (int i = 0, next; i < terms; i = next) {
        int count = 0;
        for (next = i; next < terms && term[next].form == term[i].form; ++next)
            count += term[next].count;
        if (count) {
            word[words++] = term[i].form;
            word[words++] = count;
        }
    }
    if (!words)
        return 0;
    const int sign = word[1] < 0 ? -1 : 1;
    if (words == 2 && word[1] == sign)
        return sign * word[0];
    for (int i = 1; i < words; i += 2)
        word[i] *= sign;
    return sign * operation(normal, OP_ADD, words, word);
}

Form normal_sum(Normal *normal, Form a, Form b)
{
    Term *term = NULL;
    int terms = 0;
    add_term(normal->pool, &term, &terms, normal, a, 1);
    add_term(normal->pool, &term, &terms, normal, b, 1);
    return sum_of(normal, term, terms);
}

/* ---- products --------------------------------------------------------------------------------------------------- */

static int add_factors(const Normal *normal, Form f, int *factor, int factors)
{
    const Shape *shape = shape_of(normal, f);
    if (shape->op == OP_LITERAL && shape->number == 1)
        return factors;
    if (shape->op != OP_MUL || shape->words > most_factors) {
        factor[factors++] = abs(f);
        return factors;
    }
    memcpy(factor + factors, shape->word, (size_t)shape->words * sizeof *factor);
    return factors + shape->words;
}

static int int_compare(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

static Form product(Normal *normal, Form a, Form b)
{
    if (!a || !b)
        return 0;
    int factor[2 * 64 + 2], sign = sign_of(a) * sign_of(b);
    int factors = add_factors(normal, a, factor, 0);
    factors = add_factors(normal, b, factor, factors);
    if (factors < 2)
        return sign * (factors ? factor[0] : literal(normal, 1));
    qsort(factor, (size_t)factors, sizeof *factor, int_compare);
    return sign * operation(normal, OP_MUL, factors, factor);
}

/* ---- other operations --------------------------------------------------------------------------------------------
 */

/* min(-a, -b) = -max(a, b). The order of arguments stays, for that decides where one is no number. The smaller of a
 * limit and the larger of another one and x is x within limits, in either order. */
static Form least(Normal *normal, Op op, Form a, Form b)
{
    if (a == b)
        return a;
    const Op other = op == OP_MIN ? OP_MAX : OP_MIN;
    const bool constant = !a || shape_of(normal, a)->op == OP_LITERAL;
    const int sign = sign_of(constant ? b : a);
    a *= sign;
    b *= sign;
    if (sign < 0)
        return -least(normal, other, a, b);
    const Shape *inside = shape_of(normal, a), *low = shape_of(normal, b);
    if (op == OP_MAX && a > 0 && inside->op == OP_MIN && low->op == OP_LITERAL) {
        const Form x = inside->word[0], high = inside->word[1];
        const double bottom = sign_of(b) * low->number, top = sign_of(high) * shape_of(normal, high)->number;
        if (shape_of(normal, high)->op == OP_LITERAL && bottom <= top)
            return least(normal, OP_MIN, least(normal, OP_MAX, x, b), high);
    }
    return operation(normal, (int)op, 2, (const int[]){a, b});
}

static Form conditional(Normal *normal, Form condition, Form yes, Form no)
{
    if (yes == no)
        return yes;
    if (!condition || shape_of(normal, condition)->op == OP_LITERAL)
        return condition > 0 ? yes : no;
    if (yes < 0 || (!yes && no < 0))
        return -conditional(normal, condition, -yes, -no);
    if (yes && no && no == -conditional(normal, -condition, yes, 0)) {
        const Form sign = operation(normal, FORM_SIGN, 1, (const int[]){abs(condition)});
        return product(normal, yes, sign_of(condition) * sign);
    }
    return operation(normal, OP_POSITIVE, 3, (const int[]){condition, yes, no});
}

static bool tables_same(const Table *a, const Table *b)
{
    const size_t size = (size_t)a->count * sizeof *a->x;
    return a->count == b->count && a->cubic == b->cubic && a->onward == b->onward && !memcmp(a->x, b->x, size) &&
           !memcmp(a->y, b->y, size) && ((!a->cubic && !a->onward) || !memcmp(a->slope, b->slope, size));
}

/* The first table with the same numbers. */
static int table_of(const Normal *normal, int index)
{
    int first = 0;
    while (!tables_same(&normal->model->table[first], &normal->model->table[index]))
        ++first;
    return first;
}

/* As written, with nothing known about it; raw: what is not a node. */
static Form opaque(Normal *normal, const Node *node, const Form arg[3])
{
    const int arity = ex_arity((Op)node->op);
    int word[6];
    for (int i = 0; i < 3; ++i) {
        word[i] = i < arity ? arg[i] : 0;
        word[3 + i] = i < arity ? 0 : (int)node->arg[i];
    }
    return operation(normal, node->op, 6, word);
}

static Form quotient(Normal *normal, Form a, Form b)
{
    if (!a && b)
        return 0;
    return sign_of(a) * sign_of(b) * operation(normal, OP_DIV, 2, (const int[]){abs(a), abs(b)});
}

Form normal_middle(Normal *normal)
{
    return normal_input(normal, element_at(ARRAY_y, 1));
}

/* What the road is at a place. */
static Form place(Normal *normal, Op op, Form x, Form y)
{
    if (normal->even)
        y = abs(normal_sum(normal, y, -normal_middle(normal)));
    return operation(normal, (int)op, 2, (const int[]){x, y});
}

static Form function(Normal *normal, const Node *node, const Form arg[3])
{
    const Form a = arg[0], size = abs(a);
    switch (node->op) {
    case OP_SIN:
    case OP_TAN:
    case OP_ASIN:
    case OP_ATAN:
    case OP_TANH: return a ? sign_of(a) * operation(normal, node->op, 1, &size) : 0;
    case OP_ABS: return a ? operation(normal, OP_ABS, 1, &size) : 0;
    case OP_COS: return operation(normal, OP_COS, 1, &size);
    case OP_MIN:
    case OP_MAX: return least(normal, (Op)node->op, a, arg[1]);
    case OP_POSITIVE: return conditional(normal, a, arg[1], arg[2]);
    case OP_TABLE: return operation(normal, OP_TABLE, 2, (const int[]){a, table_of(normal, (int)node->arg[1])});
    case OP_ROAD:
    case OP_FRICTION: return place(normal, (Op)node->op, a, arg[1]);
    default: return opaque(normal, node, arg);
    }
}

/* ---- graphs -----------------------------------------------------------------------------------------------------
 */

static bool is_sum(const Run *run, Ex e)
{
    const Node *node = &run->dag->node[e];
    return node->level == LEVEL_VARIABLE && !node->undefined && (node->op == OP_ADD || node->op == OP_SUB);
}

/* Recursion is as deep as a sum has terms. */
static void collect(Run *run, Ex e, int sign)
{
    const Node *node = &run->dag->node[e];
    for (int i = 0; i < 2; ++i) {
        const int own = i && node->op == OP_SUB ? -sign : sign;
        if (run->inner[node->arg[i]])
            collect(run, node->arg[i], own);
        else
            add_term(run->normal->pool, &run->term, &run->terms, run->normal, run->form[node->arg[i]], own);
    }
}

static Form sum_form(Run *run, Ex e)
{
    run->terms = 0;
    run->term = NULL;
    collect(run, e, 1);
    return sum_of(run->normal, run->term, run->terms);
}

static Form node_form(Run *run, Ex e)
{
    const Node *node = &run->dag->node[e];
    Normal *normal = run->normal;
    Form arg[3] = {0};
    if (node->level < LEVEL_VARIABLE)
        return literal(normal, ex_value(run->dag, e, run->sample));
    if (node->op == OP_INPUT)
        return run->input ? run->input(run->context, normal, *node->element) : normal_input(normal, *node->element);
    if (is_sum(run, e))
        return sum_form(run, e);
    for (int i = 0; i < ex_arity((Op)node->op); ++i)
        arg[i] = run->form[node->arg[i]];
    if (node->undefined)
        return opaque(normal, node, arg);
    switch (node->op) {
    case OP_NEG: return -arg[0];
    case OP_MUL: return product(normal, arg[0], arg[1]);
    case OP_DIV: return quotient(normal, arg[0], arg[1]);
    default: return function(normal, node, arg);
    }
}

/* Sums that one other sum alone uses have no form of their own. */
static void find_inner(Run *run, const Ex *root, int roots)
{
    const Dag *dag = run->dag;
    int *uses = pool_alloc(dag->pool, (size_t)dag->nodes * sizeof *uses);
    for (int i = 0; i < roots; ++i)
        uses[root[i]] += 2;
    for (int pass = 0; pass < 2; ++pass)
        for (Ex e = 0; e < (Ex)dag->nodes; ++e) {
            const Node *node = &dag->node[e];
            for (int i = 0; run->needed[e] && node->level == LEVEL_VARIABLE && i < ex_arity((Op)node->op); ++i)
                if (pass == 0)
                    ++uses[node->arg[i]];
                else if (is_sum(run, e) && is_sum(run, node->arg[i]))
                    run->inner[node->arg[i]] = uses[node->arg[i]] == 1;
        }
}

void normal_forms(Normal *normal, const Dag *dag, int member, NormalInput *input, void *context, const Ex *root,
                  int roots, Form *out)
{
    const size_t nodes = (size_t)dag->nodes;
    Run run = {.normal = normal,
               .dag = dag,
               .sample = member * (dag->samples / dag->members),
               .input = input,
               .context = context,
               .form = pool_alloc(normal->pool, nodes * sizeof(Form)),
               .needed = dag_needed(dag, root, roots),
               .inner = pool_alloc(normal->pool, nodes * sizeof(bool))};
    find_inner(&run, root, roots);
    for (Ex e = 0; e < (Ex)dag->nodes; ++e) /* arguments have smaller numbers */
        if (run.needed[e] && !run.inner[e])
            run.form[e] = node_form(&run, e);
    for (int i = 0; i < roots; ++i)
        out[i] = run.form[root[i]];
}
