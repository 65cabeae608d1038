/* SPDX-License-Identifier: MIT
 * Derivatives of a class's motions, and of what its bodies lack in the equations of motion at accelerations that stand
 * still, by every coordinate that they depend on, by the rates of these and by the base's angular velocity, in one
 * block: what several of them have in common is computed once, and numbers that `solve` has stored are read. */
#include "expression/expression.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/tangent.h"

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
    Array array; /* x, rate or turn, and which of them */
    int index;
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
    if (element.array == c->array)
        return ex_literal(dag, element.index == c->index);
    if (element.array != ARRAY_known || c->array == ARRAY_turn)
        return 0;
    const int known = first->known[element.which];
    const Subset *subset = &c->sequence->subset[c->sequence->body_subset[known]];
    const int column = subset_column(subset, first->dep[c->index], c->array == ARRAY_rate);
    return column < 0 ? 0 : read_known(c, dag, element, column);
}

/* Is it a number of the motion of the body that has this number? */
static bool is_own(const Dag *dag, Ex e, int number, int size)
{
    const Node *node = &dag->node[e];
    return node->op == OP_INPUT && node->element->array == ARRAY_motion && node->element->index / size == number / size;
}

/* Along a coordinate bodies move by S. */
static GivenSlopes moved_along(const Formula *f, int coordinate)
{
    GivenSlopes g = {0};
    for (int b = 0; b < f->layout.bodies; ++b)
        give_twist(f, b, f->motion[b].S + 6 * coordinate, &g);
    return g;
}

/* Does the derivative of a number of a body's motion tell how far, or how fast, bodies move along the column, and not
 * how the directions in which they move change? */
static bool moves_along(Array column, int number)
{
    return column == ARRAY_x ? number < MOTION_OMEGA : number >= MOTION_OMEGA && number < MOTION_ALPHA;
}

static MotionColumns *columns_of(const Sequence *sequence, const Formula *formula, bool free_base, bool straight,
                                 Column *column)
{
    static const Array kind[3] = {ARRAY_x, ARRAY_rate, ARRAY_turn};
    Dag *dag = formula->dag;
    Pool *pool = dag->pool;
    const int size = formula->layout.motion_size, numbers = size * formula->layout.bodies;
    const int deps = sequence->subset[column->class->member[0]].deps, rows = 6 + deps;
    const int columns = 2 * deps + (free_base ? 3 : 0), motions = 2 * deps * numbers, all = motions + columns * rows;
    MotionColumns *m = pool_alloc(pool, sizeof *m);
    Ex root[numbers + rows];
    *m = (MotionColumns){.columns = columns,
                         .numbers = numbers,
                         .rows = rows,
                         .slope = pool_alloc(pool, ((size_t)all + 1) * sizeof(Ex)),
                         .place = pool_alloc(pool, ((size_t)all + 1) * sizeof(int)),
                         .block = {.dag = dag, .eager = true}};
    for (int i = 0; i < numbers; ++i)
        root[i] = *motion_number(&formula->motion[i / size], i % size);
    dag_section(dag, "derivatives by coordinates and their rates");
    subset_residuals(formula, free_base, deps, root + numbers);
    for (int c = 0; c < columns; ++c) {
        column->array = kind[deps ? (c < 2 * deps ? c / deps : 2) : 2];
        column->index = column->array == ARRAY_turn ? c - 2 * deps : c % deps;
        const GivenSlopes g = column->array == ARRAY_x ? moved_along(formula, column->index) : (GivenSlopes){0};
        const Seeds seeds = {.seed = seed, .context = column, .givens = g.count, .given = g.node, .slope = g.slope};
        const Ex *slope = subset_slopes(formula, &seeds, root, numbers + rows);
        for (int i = 0; i < numbers && c < 2 * deps; ++i)
            m->slope[numbers * c + i] = straight && !moves_along(column->array, i % size) ? 0 : slope[root[i]];
        for (int i = 0; i < rows && !straight; ++i)
            m->slope[motions + rows * c + i] = slope[root[numbers + i]];
    }
    const Ex *image = subset_read_stored(formula, m->slope, all);
    for (int i = 0; i < all; ++i) {
        const Ex e = m->slope[i] = image[m->slope[i]];
        m->place[i] = -1;
        if (i < motions ? dag->node[e].level < LEVEL_VARIABLE || is_own(dag, e, i % numbers, size) : ex_is(dag, e, 0))
            continue;
        m->place[i] = m->size++;
        block_store(&m->block, e, element_at(ARRAY_column, m->place[i]));
    }
    return m;
}

int motion_columns_residual(const MotionColumns *m, int column, int row)
{
    const int deps = m->rows - 6;
    return m->place[2 * deps * m->numbers + m->rows * column + row];
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
            same = same && of[0]->class == of[1]->class && subset_place(of[0], body[0]) == subset_place(of[1], body[1]);
            for (int j = 0; same && j < first->deps; ++j)
                same = subset_column(of[0], first->dep[j], false) ==
                       subset_column(of[1], sequence->subset[class->member[i]].dep[j], false);
        }
    return same;
}

MotionColumns **subsets_columns(Pool *pool, const Sequence *sequence, Formula *const *formula, bool free_base,
                                bool straight)
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
        made[c] =
            columns_of(sequence, straight ? formula[c] : formula_from_parts(formula[c]), free_base, straight, &column);
    }
    return made;
}
