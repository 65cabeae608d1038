/* SPDX-License-Identifier: MIT
 * Geometry that follows tunable parameters: the steps that the reader takes with numbers, as formulas for set-up. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "read/reader.h"

#include <math.h>

bool any_tuned(const Ex *tuned, int count)
{
    for (int i = 0; i < count; ++i)
        if (tuned[i])
            return true;
    return false;
}

void formulas(const Reader *reader, const double *number, const Ex *tuned, int count, Ex *out)
{
    for (int i = 0; i < count; ++i)
        out[i] = tuned[i] ? tuned[i] : ex_literal(reader->model->tuning->dag, number[i]);
}

void tuned_reduce(const Reader *reader, Ex *formula, int count)
{
    for (int i = 0; i < count; ++i)
        if (reader->model->tuning->dag->node[formula[i]].level < LEVEL_VARIABLE)
            formula[i] = 0;
}

static void normalize(Dag *dag, Ex vector[3])
{
    Ex norm = ex_sqrt(dag, ex_dot(dag, vector, vector));
    for (int i = 0; i < 3; ++i)
        vector[i] = ex_div(dag, vector[i], norm);
}

void axis_tune(const Reader *reader, const double u[3], Ex tuned[3], const char *what)
{
    Tuning *tuning = reader->model->tuning;
    if (!any_tuned(tuned, 3))
        return;
    formulas(reader, u, tuned, 3, tuned);
    tuning_require(tuning, ex_dot(tuning->dag, tuned, tuned), false,
                   pool_print(reader->pool, "%s must not be zero", what));
    normalize(tuning->dag, tuned);
    tuned_reduce(reader, tuned, 3);
}

/* condition > 0 ? a : b; without a choice if a and b are the same. */
static Ex choose(Dag *dag, Ex condition, Ex a, Ex b)
{
    if (dag->node[condition].op == OP_LITERAL)
        return ex_value(dag, condition, 0) > 0 ? a : b;
    return a == b ? a : ex_op(dag, OP_POSITIVE, condition, a, b);
}

void perpendicular_tune(const Reader *reader, const double axis[3], const Ex tuned[3], Ex out[3])
{
    Dag *dag = reader->model->tuning->dag;
    Ex u[3], size[3], least, along, is_least[3] = {0};
    for (int i = 0; i < 3; ++i)
        out[i] = 0;
    if (!any_tuned(tuned, 3))
        return;
    formulas(reader, axis, tuned, 3, u);
    for (int i = 0; i < 3; ++i)
        size[i] = ex_op(dag, OP_ABS, u[i], 0, 0);
    /* the smallest of three, the first of equal ones; a component that is always 0 is the smallest */
    least = size[0];
    along = u[0];
    is_least[0] = ex_literal(dag, 1);
    for (int i = 1; i < 3; ++i) {
        Ex less = ex_is(dag, least, 0) ? least : ex_sub(dag, least, size[i]);
        for (int j = 0; j < 3; ++j)
            is_least[j] = choose(dag, less, ex_literal(dag, j == i), is_least[j]);
        along = choose(dag, less, u[i], along);
        least = choose(dag, less, size[i], least);
    }
    for (int i = 0; i < 3; ++i)
        out[i] = ex_sub(dag, is_least[i], ex_mul(dag, along, u[i]));
    normalize(dag, out);
    tuned_reduce(reader, out, 3);
}

void side_tune(const Reader *reader, const double axis[3], const Ex tuned[3], const double side[3], const char *what,
               Ex out[3])
{
    const double least = 0.1; /* squared sine of the least angle between axis and side: 18 degrees */
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    Ex u[3], drawn[3], part[3];
    for (int i = 0; i < 3; ++i) {
        out[i] = 0;
        drawn[i] = ex_literal(dag, side[i]);
    }
    if (!any_tuned(tuned, 3))
        return;
    formulas(reader, axis, tuned, 3, u);
    ex_scale3(dag, ex_dot(dag, u, drawn), u, part);
    ex_sub3(dag, drawn, part, out);
    tuning_require(tuning, ex_sub(dag, ex_dot(dag, out, out), ex_literal(dag, least)), false,
                   pool_print(reader->pool, "the axis of %s must not turn so far from where the file has it", what));
    normalize(dag, out);
    tuned_reduce(reader, out, 3);
}

void square_tune(const Reader *reader, const double axes[6], Ex tuned[6], double tolerance, const char *what)
{
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    Ex u[6], part[3];
    if (!any_tuned(tuned, 6))
        return;
    formulas(reader, axes, tuned, 6, u);
    Ex along = ex_dot(dag, u, u + 3);
    tuning_require(tuning, ex_sub(dag, ex_literal(dag, tolerance), ex_op(dag, OP_ABS, along, 0, 0)), false,
                   pool_print(reader->pool, "%s must be near perpendicular", what));
    ex_scale3(dag, along, u, part);
    ex_sub3(dag, u + 3, part, tuned + 3);
    normalize(dag, tuned + 3);
    tuned_reduce(reader, tuned + 3, 3);
}

void points_formula(const Reader *reader, const Value *points, Ex d[3])
{
    Ex end[6];
    formulas(reader, points->number, points->tuned, 6, end);
    ex_sub3(reader->model->tuning->dag, end + 3, end, d);
}

Ex distance_tune(const Reader *reader, const Value *points, const char *what)
{
    Tuning *tuning = reader->model->tuning;
    Ex d[3];
    points_formula(reader, points, d);
    Ex square = ex_dot(tuning->dag, d, d), distance = ex_sqrt(tuning->dag, square);
    tuning_require(tuning, square, false, pool_print(reader->pool, "the two points of %s must differ", what));
    tuned_reduce(reader, &distance, 1);
    return distance;
}

/* A given length or offset on the way from the drawing's. */
static Ex link_formula(const Reader *reader, const Value *given, Ex drawn)
{
    Dag *dag = reader->model->tuning->dag;
    Ex wanted, rest = ex_input(dag, element_at(ARRAY_rest, 0), NULL);
    if (!given->item)
        return drawn;
    formulas(reader, given->number, given->tuned, 1, &wanted);
    return ex_sub(dag, wanted, ex_mul(dag, rest, ex_sub(dag, wanted, drawn)));
}

void link_tune(const Reader *reader, const Value *points, const Value *axis, const Value *length, const Value *offset,
               double tolerance, const char *what, Joint *joint)
{
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    Ex d[3], u[3], wanted[2];
    points_formula(reader, points, d);
    Ex drawn = ex_sqrt(dag, ex_dot(dag, d, d)), formula = link_formula(reader, length, drawn);
    /* length and offset are those of the drawing: no assembly is needed */
    if (joint->drawn && !any_tuned(points->tuned, 6) && !any_tuned(length->tuned, 1))
        formula = ex_literal(dag, joint->length);
    tuning_set(tuning, &joint->length, &formula, 1);
    if (joint->type != JOINT_REVOLUTE_SPHERICAL)
        return;
    formulas(reader, axis->number, axis->tuned, 3, u);
    Ex along = ex_dot(dag, u, d);
    formula = link_formula(reader, offset, along);
    if (joint->drawn && !any_tuned(points->tuned, 6) && !any_tuned(axis->tuned, 3) && !any_tuned(offset->tuned, 1))
        formula = ex_literal(dag, joint->offset);
    tuning_set(tuning, &joint->offset, &formula, 1);
    wanted[0] = drawn;
    wanted[1] = along;
    if (length->item)
        formulas(reader, length->number, length->tuned, 1, &wanted[0]);
    if (offset->item)
        formulas(reader, offset->number, offset->tuned, 1, &wanted[1]);
    Ex reach = ex_mul(dag, wanted[0], ex_literal(dag, 1 - tolerance));
    tuning_require(tuning, ex_sub(dag, reach, ex_op(dag, OP_ABS, wanted[1], 0, 0)), false,
                   pool_print(reader->pool, "the length of %s must be greater than its offset", what));
}

void range_tune(const Reader *reader, const Value *range, const char *what, const Coordinate *coordinate)
{
    Tuning *tuning = reader->model->tuning;
    Dag *dag = tuning->dag;
    const Model *model = reader->model;
    Ex design = tuned_or_fixed(model, &coordinate->design), initial = tuned_or_fixed(model, &coordinate->initial);
    const char *text = pool_print(reader->pool, "design and initial value of %s must lie inside its range", what);
    for (int end = 0; end < 2; ++end) {
        /* the default range moves with the design value */
        double bound = coordinate->range[end];
        Ex limit = range->item ? ex_literal(dag, bound)
                   : coordinate->type == COORDINATE_LENGTH
                       ? ex_mul(dag, ex_literal(dag, bound / coordinate->design), design)
                       : ex_add(dag, ex_literal(dag, bound - coordinate->design), design);
        Ex inside[2] = {ex_sub(dag, initial, limit), ex_sub(dag, design, limit)};
        for (int i = 0; i < (range->item ? 2 : 1); ++i)
            tuning_require(tuning, end ? ex_neg(dag, inside[i]) : inside[i], true, text);
    }
}
