/* SPDX-License-Identifier: MIT
 * Derivatives of a class's motions by every coordinate that they depend on and by the rates of these, in one block: what
 * several of them have in common is computed once, and numbers that `solve` has stored are read. */
#include "expression/expression.h"
#include "sequence/sequence.h"
#include "subset/subset.h"

int subset_column(const Subset *subset, int coordinate, bool rate)
{
    for (int j = 0; j < subset->deps; ++j)
        if (subset->dep[j] == coordinate)
            return rate ? subset->deps + j : j;
    return -1;
}

/* One column of a class that is being differentiated. */
typedef struct Column {
    const Sequence *sequence;
    Formula *const *formula;
    MotionColumns *const *made; /* of earlier classes */
    const Class *class;
    int coordinate; /* by its place among the deps */
    bool rate;
} Column;

/* A derivative that a class made, as a later one reads it. */
static Ex read_known(const Column *c, Dag *dag, Element element, int column)
{
    const int body = c->sequence->subset[c->class->member[0]].known[element.which];
    const int s = c->sequence->body_subset[body];
    const Subset *subset = &c->sequence->subset[s];
    const Formula *formula = c->formula[subset->class];
    const MotionColumns *m = c->made[subset->class];
    const int number = formula->layout.motion_size * subset_place(subset, body) + element.index;
    const int at = m->numbers * column + number;
    const Ex e = m->slope[at];
    double value[c->class->members];
    if (m->place[at] >= 0)
        return ex_input(dag, element_of(ARRAY_column_known, element.which, m->place[at]), NULL);
    if (formula->dag->node[e].op == OP_INPUT) {
        const int own = formula->dag->node[e].element->index % formula->layout.motion_size;
        return ex_input(dag, element_of(ARRAY_known, element.which, own), NULL);
    }
    for (int i = 0; i < c->class->members; ++i) {
        const int known = c->sequence->body_subset[c->sequence->subset[c->class->member[i]].known[element.which]];
        value[i] = formula_value(formula, e, class_place(&c->sequence->class[subset->class], known));
    }
    return ex_constant(dag, value);
}

static Ex seed(const void *context, Dag *dag, Element element)
{
    const Column *c = context;
    const Subset *first = &c->sequence->subset[c->class->member[0]];
    if (element.array == (c->rate ? ARRAY_rate : ARRAY_x))
        return ex_literal(dag, element.index == c->coordinate);
    if (element.array != ARRAY_known)
        return 0;
    const int known = first->known[element.which];
    const Subset *subset = &c->sequence->subset[c->sequence->body_subset[known]];
    const int column = subset_column(subset, first->dep[c->coordinate], c->rate);
    return column < 0 ? 0 : read_known(c, dag, element, column);
}

/* Is it a number of the motion of the body that has this number? */
static bool is_own(const Dag *dag, Ex e, int number, int size)
{
    const Node *node = &dag->node[e];
    return node->op == OP_INPUT && node->element->array == ARRAY_motion && node->element->index / size == number / size;
}

static MotionColumns *columns_of(const Sequence *sequence, const Formula *formula, Column *column)
{
    Dag *dag = formula->dag;
    Pool *pool = dag->pool;
    const Block *solve = &formula->solve;
    const int size = formula->layout.motion_size, numbers = size * formula->layout.bodies;
    const int deps = sequence->subset[column->class->member[0]].deps, all = 2 * deps * numbers;
    MotionColumns *m = pool_alloc(pool, sizeof *m);
    Ex root[numbers], from[numbers + 1], to[numbers + 1];
    int stored = 0;
    *m = (MotionColumns){.columns = 2 * deps,
                         .numbers = numbers,
                         .slope = pool_alloc(pool, ((size_t)all + 1) * sizeof(Ex)),
                         .place = pool_alloc(pool, ((size_t)all + 1) * sizeof(int)),
                         .block = {.dag = dag, .eager = true}};
    for (int i = 0; i < numbers; ++i)
        root[i] = *motion_number(&formula->motion[i / size], i % size);
    dag_section(dag, "derivatives by coordinates and their rates");
    for (int c = 0; c < 2 * deps; ++c) {
        column->rate = c >= deps;
        column->coordinate = c % deps;
        const Seeds seeds = {.seed = seed, .context = column};
        const Ex *slope = subset_slopes(formula, &seeds, root, numbers);
        for (int i = 0; i < numbers; ++i)
            m->slope[numbers * c + i] = slope[root[i]];
    }
    for (int i = 0; i < solve->stores && formula->closed; ++i) /* others are found at poses that differ by roundings */
        if (solve->store[i].target.array == ARRAY_motion && dag->node[solve->store[i].value].level == LEVEL_VARIABLE &&
            dag->node[solve->store[i].value].op != OP_INPUT) {
            from[stored] = solve->store[i].value;
            to[stored++] = ex_input(dag, element_at(ARRAY_motion, solve->store[i].target.index), NULL);
        }
    const Ex *image = dag_replace(dag, m->slope, all, from, to, stored);
    for (int i = 0; i < all; ++i) {
        const Ex e = m->slope[i] = image[m->slope[i]];
        m->place[i] = -1;
        if (dag->node[e].level < LEVEL_VARIABLE || is_own(dag, e, i % numbers, size))
            continue;
        m->place[i] = m->size++;
        block_store(&m->block, e, element_at(ARRAY_column, m->place[i]));
    }
    return m;
}

/* Does each known of a class stand for bodies of one class, all at one place in their subsets? */
static bool is_uniform(const Sequence *sequence, const Class *class)
{
    const Subset *first = &sequence->subset[class->member[0]];
    bool same = true;
    for (int i = 1; i < class->members; ++i)
        for (int k = 0; k < first->knowns; ++k) {
            const int body[2] = {first->known[k], sequence->subset[class->member[i]].known[k]};
            const Subset *of[2];
            for (int j = 0; j < 2; ++j)
                of[j] = &sequence->subset[sequence->body_subset[body[j]]];
            same = same && of[0]->class == of[1]->class &&
                   subset_place(of[0], body[0]) == subset_place(of[1], body[1]);
            for (int j = 0; same && j < first->deps; ++j)
                same = subset_column(of[0], first->dep[j], false) ==
                       subset_column(of[1], sequence->subset[class->member[i]].dep[j], false);
        }
    return same;
}

MotionColumns **subsets_columns(Pool *pool, const Sequence *sequence, Formula *const *formula)
{
    MotionColumns **made = pool_alloc(pool, ((size_t)sequence->classes + 1) * sizeof *made);
    if (sequence->chained)
        return NULL;
    for (int s = 0; s < sequence->subsets; ++s) {
        const int c = sequence->subset[s].class;
        if (c < 0 || made[c])
            continue;
        if (!is_uniform(sequence, &sequence->class[c]))
            return NULL;
        Column column = {.sequence = sequence, .formula = formula, .made = made, .class = &sequence->class[c]};
        made[c] = columns_of(sequence, formula[c], &column);
    }
    return made;
}
