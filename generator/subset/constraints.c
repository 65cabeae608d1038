/* SPDX-License-Identifier: MIT
 * Constraint equations of joints and dual coordinates (FORMAT.md sections 4 and 5): value, Jacobian with respect to the
 * twists of both ends, and the quadratic-velocity term. Every equation is a sum of scalar products of body-fixed points
 * and axes. */
#include "base/plant.h"
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "subset/constraints.h"
#include "subset/subset.h"

#include <math.h>
#include <string.h>

/* Members of Fixture as numbers. */
enum {
    NUMBER_POINT = 0,
    NUMBER_AXIS = 6,
    NUMBER_SIDE = 12, /* [which][end] */
    NUMBER_SQUARE = 24,
    NUMBER_OFFSET = 25
};
_Static_assert(FIXTURE_NUMBERS == 26, "Fixture and its numbers go together");

const int joint_parts[JOINT_TYPES] = {
    [JOINT_REVOLUTE] = PART_POINT | PART_PARALLEL,
    [JOINT_SPHERICAL] = PART_POINT,
    [JOINT_PRISMATIC] = PART_PARALLEL | PART_LOCK | PART_LINE,
    [JOINT_CYLINDRICAL] = PART_PARALLEL | PART_LINE,
    [JOINT_UNIVERSAL] = PART_POINT | PART_CROSS,
    [JOINT_FIXED] = PART_POINT | PART_PARALLEL | PART_LOCK,
    [JOINT_DISTANCE] = PART_LENGTH,
    [JOINT_REVOLUTE_SPHERICAL] = PART_LENGTH | PART_ALONG,
    [JOINT_POINT_ON_LINE] = PART_LINE,
    [JOINT_POINT_IN_PLANE] = PART_ALONG,
    [JOINT_PARALLEL] = PART_PARALLEL,
    [JOINT_PERPENDICULAR] = PART_CROSS,
    [JOINT_SCREW] = PART_GEAR,
    [JOINT_RACK_AND_PINION] = PART_GEAR,
    [JOINT_GEAR] = PART_HELD,
    [JOINT_COUPLER] = PART_HELD,
};

/* Parts that need points. */
static const int parts_with_points = PART_POINT | PART_LINE | PART_LENGTH | PART_ALONG | PART_GEAR;

static bool joint_has_points(JointType type)
{
    return joint_parts[type] & parts_with_points || type == JOINT_COUPLER;
}

/* Differences and unit vectors carry the rounding of their computation: values this near to 0 or 1 are taken as 0 or 1.
 */
static const double few_roundings = 1e-15;

static void subtract_clean(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; ++i) {
        out[i] = a[i] - b[i];
        if (fabs(out[i]) <= few_roundings * norm3(a))
            out[i] = 0;
    }
}

static void clean_unit(double u[3])
{
    for (int i = 0; i < 3; ++i)
        if (fabs(u[i] - round(u[i])) <= few_roundings)
            u[i] = round(u[i]);
}

static void relative_points(const int body[2], const double point[2][3], const double (*origin)[3],
                            double number[FIXTURE_NUMBERS])
{
    for (int end = 0; end < 2; ++end)
        subtract_clean(point[end], origin[body[end]], number + NUMBER_POINT + 3 * end);
}

void fixture_of_joint(const Joint *joint, const double (*origin)[3], double number[FIXTURE_NUMBERS])
{
    memset(number, 0, FIXTURE_NUMBERS * sizeof number[0]);
    if (joint_has_points(joint->type))
        relative_points(joint->body, joint->point, origin, number);
    memcpy(number + NUMBER_AXIS, joint->axis, sizeof joint->axis);
    for (int end = 0; end < 2; ++end) {
        memcpy(number + NUMBER_SIDE + 3 * end, joint->side[end], sizeof joint->side[end]);
        cross3(joint->axis[end], joint->side[end], number + NUMBER_SIDE + 6 + 3 * end);
        clean_unit(number + NUMBER_AXIS + 3 * end);
        clean_unit(number + NUMBER_SIDE + 3 * end);
        clean_unit(number + NUMBER_SIDE + 6 + 3 * end);
    }
    number[NUMBER_SQUARE] = joint->length * joint->length;
    number[NUMBER_OFFSET] = joint->offset;
}

void fixture_of_coordinate(const Coordinate *coordinate, const double (*origin)[3], double number[FIXTURE_NUMBERS])
{
    memset(number, 0, FIXTURE_NUMBERS * sizeof number[0]);
    if (coordinate->type != COORDINATE_ANGLE)
        relative_points(coordinate->body, coordinate->point, origin, number);
    memcpy(number + NUMBER_AXIS, coordinate->axis, sizeof coordinate->axis);
    /* angle: e_1 and e_2 in body a, f_1 in body b */
    memcpy(number + NUMBER_SIDE, coordinate->reference[0], sizeof coordinate->reference[0]);
    memcpy(number + NUMBER_SIDE + 3, coordinate->reference[1], sizeof coordinate->reference[1]);
    cross3(coordinate->axis, coordinate->reference[0], number + NUMBER_SIDE + 6);
    clean_unit(number + NUMBER_AXIS);
    clean_unit(number + NUMBER_SIDE);
    clean_unit(number + NUMBER_SIDE + 3);
    clean_unit(number + NUMBER_SIDE + 6);
    /* subtracted from w: its value at design, less the geometric offset */
    number[NUMBER_OFFSET] = coordinate->design - (coordinate->type == COORDINATE_TRANSLATION ? coordinate->offset : 0);
}

const char *fixture_name(int i)
{
    static const char *const name[FIXTURE_NUMBERS] = {
        "point_a_x", "point_a_y", "point_a_z", "point_b_x", "point_b_y", "point_b_z", "axis_a_x",
        "axis_a_y",  "axis_a_z",  "axis_b_x",  "axis_b_y",  "axis_b_z",  "side_a_x",  "side_a_y",
        "side_a_z",  "side_b_x",  "side_b_y",  "side_b_z",  "third_a_x", "third_a_y", "third_a_z",
        "third_b_x", "third_b_y", "third_b_z", "length^2",  "offset"};
    return name[i];
}

/* Formulas [count] that follow no parameter become 0. */
static void drop_fixed(const Dag *dag, Ex *formula, int count)
{
    for (int i = 0; i < count; ++i)
        if (dag->node[formula[i]].level < LEVEL_VARIABLE)
            formula[i] = 0;
}

static void tuned_or_fixed3(const Model *model, const double at[3], Ex out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = tuned_or_fixed(model, &at[i]);
}

static void tuned_points(const Model *model, const int body[2], const double point[2][3], const double (*origin)[3],
                         Ex formula[FIXTURE_NUMBERS])
{
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < 3; ++i)
            formula[NUMBER_POINT + 3 * end + i] = tuned_difference(model, &point[end][i], &origin[body[end]][i]);
}

void fixture_tuned_joint(const Model *model, const Joint *joint, const double (*origin)[3], Ex formula[FIXTURE_NUMBERS])
{
    memset(formula, 0, FIXTURE_NUMBERS * sizeof formula[0]);
    if (!model->tuning)
        return;
    Dag *dag = model->tuning->dag;
    for (int end = 0; end < 2; ++end) {
        Ex *side = formula + NUMBER_SIDE + 3 * end;
        tuned_or_fixed3(model, joint->axis[end], formula + NUMBER_AXIS + 3 * end);
        tuned_or_fixed3(model, joint->side[end], side);
        ex_cross(dag, formula + NUMBER_AXIS + 3 * end, side, side + 6);
    }
    Ex length = tuned_or_fixed(model, &joint->length);
    formula[NUMBER_SQUARE] = ex_mul(dag, length, length);
    formula[NUMBER_OFFSET] = tuned_or_fixed(model, &joint->offset);
    drop_fixed(dag, formula, FIXTURE_NUMBERS);
    if (joint_has_points(joint->type))
        tuned_points(model, joint->body, joint->point, origin, formula);
}

void fixture_tuned_coordinate(const Model *model, const Coordinate *coordinate, const double (*origin)[3],
                              Ex formula[FIXTURE_NUMBERS])
{
    memset(formula, 0, FIXTURE_NUMBERS * sizeof formula[0]);
    if (!model->tuning)
        return;
    Dag *dag = model->tuning->dag;
    tuned_or_fixed3(model, coordinate->axis, formula + NUMBER_AXIS);
    tuned_or_fixed3(model, coordinate->reference[0], formula + NUMBER_SIDE);
    tuned_or_fixed3(model, coordinate->reference[1], formula + NUMBER_SIDE + 3);
    ex_cross(dag, formula + NUMBER_AXIS, formula + NUMBER_SIDE, formula + NUMBER_SIDE + 6);
    if (coordinate->type == COORDINATE_TRANSLATION)
        formula[NUMBER_OFFSET] = tuned_difference(model, &coordinate->design, &coordinate->offset);
    else if (coordinate->type == COORDINATE_ANGLE)
        formula[NUMBER_OFFSET] = tuned_or_fixed(model, &coordinate->design);
    drop_fixed(dag, formula, FIXTURE_NUMBERS);
    if (coordinate->type != COORDINATE_ANGLE)
        tuned_points(model, coordinate->body, coordinate->point, origin, formula);
}

/* Add f . (rate of the vector) to a row's derivative at one end. */
static void add_rate(Dag *dag, Row *row, int end, const Vector *vector, const Ex f[3], bool negative)
{
    Ex angular[3];
    ex_cross(dag, vector->arm, f, angular);
    for (int i = 0; i < 3; ++i) {
        Ex *a = &row->J[end][i], *l = &row->J[end][3 + i];
        *a = negative ? ex_sub(dag, *a, angular[i]) : ex_add(dag, *a, angular[i]);
        if (vector->point)
            *l = negative ? ex_sub(dag, *l, f[i]) : ex_add(dag, *l, f[i]);
    }
}

/* The vector from the first end's point to the second's. */
typedef struct Link {
    Vector end[2];
    Ex d[3], rate[3], bias[3];
} Link;

static Link link_between(Dag *dag, const Fixture *fixture, const Motion *const end[2])
{
    Link link;
    for (int i = 0; i < 2; ++i)
        link.end[i] = vector_point(dag, end[i], fixture->point[i]);
    ex_sub3(dag, link.end[1].v, link.end[0].v, link.d);
    ex_sub3(dag, link.end[1].rate, link.end[0].rate, link.rate);
    ex_sub3(dag, link.end[1].bias, link.end[0].bias, link.bias);
    return link;
}

/* Component of a link along a fixed direction of the base frame. */
static Row row_component(Dag *dag, const Link *link, int axis)
{
    Row row = {.value = link->d[axis], .bias = link->bias[axis]};
    Ex unit[3] = {0};
    unit[axis] = ex_literal(dag, 1);
    add_rate(dag, &row, 1, &link->end[1], unit, false);
    add_rate(dag, &row, 0, &link->end[0], unit, true);
    return row;
}

/* u . link, u an axis of one end. */
static Row row_along(Dag *dag, const Link *link, int end, const Vector *u)
{
    Row row = {.value = ex_dot(dag, u->v, link->d)};
    add_rate(dag, &row, 1, &link->end[1], u->v, false);
    add_rate(dag, &row, 0, &link->end[0], u->v, true);
    add_rate(dag, &row, end, u, link->d, false);
    Ex cross = ex_dot(dag, u->rate, link->rate);
    row.bias = ex_add(dag, ex_add(dag, ex_dot(dag, u->v, link->bias), ex_dot(dag, u->bias, link->d)),
                      ex_add(dag, cross, cross));
    return row;
}

/* a . b, axes of the first and second end. */
static Row row_angle(Dag *dag, const Vector *a, const Vector *b)
{
    Row row = {.value = ex_dot(dag, a->v, b->v)};
    add_rate(dag, &row, 0, a, b->v, false);
    add_rate(dag, &row, 1, b, a->v, false);
    Ex cross = ex_dot(dag, a->rate, b->rate);
    row.bias =
        ex_add(dag, ex_add(dag, ex_dot(dag, a->v, b->bias), ex_dot(dag, a->bias, b->v)), ex_add(dag, cross, cross));
    return row;
}

/* (|link|^2 - square) / 2: no root. */
static Row row_length(Dag *dag, const Link *link, Ex square)
{
    Row row = {.value = ex_mul(dag, ex_literal(dag, 0.5), ex_sub(dag, ex_dot(dag, link->d, link->d), square))};
    add_rate(dag, &row, 1, &link->end[1], link->d, false);
    add_rate(dag, &row, 0, &link->end[0], link->d, !planted("row"));
    row.bias =
        ex_add(dag, ex_dot(dag, link->d, link->bias), ex_dot(dag, link->rate, planted("bias") ? link->d : link->rate));
    return row;
}

/* cos(w) e_2 . f_1 - sin(w) e_1 . f_1 = 0; its other root, half a turn away, has the guard's sign reversed. */
static Row row_turn(Dag *dag, const Fixture *fixture, const Motion *const end[2], Ex angle, Ex rate)
{
    Vector e1 = vector_axis(dag, end[0], fixture->side[0][0]), e2 = vector_axis(dag, end[0], fixture->side[1][0]);
    Vector f1 = vector_axis(dag, end[1], fixture->side[0][1]);
    Row x = row_angle(dag, &e1, &f1), y = row_angle(dag, &e2, &f1), row = {0};
    Ex s = ex_op(dag, OP_SIN, angle, 0, 0), c = ex_op(dag, OP_COS, angle, 0, 0);
    row.value = ex_sub(dag, ex_mul(dag, c, y.value), ex_mul(dag, s, x.value));
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 6; ++j)
            row.J[i][j] = ex_sub(dag, ex_mul(dag, c, y.J[i][j]), ex_mul(dag, s, x.J[i][j]));
    row.guard = ex_add(dag, ex_mul(dag, s, y.value), ex_mul(dag, c, x.value));
    row.dual = ex_neg(dag, row.guard);
    /* -2 w' (s y' + c x'), the rates of the products e . f_1 */
    Ex y_rate = ex_add(dag, ex_dot(dag, e2.rate, f1.v), ex_dot(dag, e2.v, f1.rate));
    Ex x_rate = ex_add(dag, ex_dot(dag, e1.rate, f1.v), ex_dot(dag, e1.v, f1.rate));
    Ex cross = ex_mul(dag, rate, ex_add(dag, ex_mul(dag, s, y_rate), ex_mul(dag, c, x_rate)));
    row.bias = ex_sub(dag, ex_sub(dag, ex_mul(dag, c, y.bias), ex_mul(dag, s, x.bias)), ex_add(dag, cross, cross));
    return row;
}

/* The turn by row_turn() for the angle s / offset, s = v . link: v the axis, or its side. */
static Row row_gear(Dag *dag, const Fixture *fixture, const Motion *const end[2], const Link *link, const Vector *v)
{
    const Ex share = ex_div(dag, ex_literal(dag, 1), fixture->offset);
    const Row way = row_along(dag, link, 0, v);
    const Ex speed = ex_add(dag, ex_dot(dag, v->rate, link->d), ex_dot(dag, v->v, link->rate));
    Row row = row_turn(dag, fixture, end, ex_mul(dag, share, way.value), ex_mul(dag, share, speed));
    const Ex slope = ex_mul(dag, row.dual, share);
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 6; ++j)
            row.J[i][j] = ex_add(dag, row.J[i][j], ex_mul(dag, slope, way.J[i][j]));
    row.bias = ex_add(dag, row.bias, ex_mul(dag, slope, way.bias));
    row.dual = 0;
    return row;
}

/* The same joint with first and second body exchanged. */
static int exchanged_rows(Dag *dag, JointType type, const Fixture *fixture, const Motion *const end[2],
                          Row row[ROWS_MAX])
{
    const Motion *const other[2] = {end[1], end[0]};
    Fixture exchanged = *fixture;
    for (int i = 0; i < 2; ++i) {
        memcpy(exchanged.point[i], fixture->point[1 - i], sizeof exchanged.point[i]);
        memcpy(exchanged.axis[i], fixture->axis[1 - i], sizeof exchanged.axis[i]);
        for (int j = 0; j < 2; ++j)
            memcpy(exchanged.side[j][i], fixture->side[j][1 - i], sizeof exchanged.side[j][i]);
    }
    const int rows = joint_rows(dag, type, &exchanged, other, 0, row);
    for (int r = 0; r < rows; ++r)
        for (int i = 0; i < 6; ++i) {
            const Ex first = row[r].J[0][i];
            row[r].J[0][i] = row[r].J[1][i];
            row[r].J[1][i] = first;
        }
    return rows;
}

int joint_rows(Dag *dag, JointType type, const Fixture *fixture, const Motion *const end[2], int across,
               Row row[ROWS_MAX])
{
    int rows = 0, parts = joint_parts[type];
    if (across == 1 && parts & PART_PARALLEL)
        return exchanged_rows(dag, type, fixture, end, row);
    Link link = link_between(dag, fixture, end);
    Vector axis[2], side[2], other;
    for (int i = 0; i < 2; ++i) {
        axis[i] = vector_axis(dag, end[i], fixture->axis[i]);
        side[i] = vector_axis(dag, end[0], fixture->side[i][0]);
    }
    other = vector_axis(dag, end[1], fixture->side[1][1]);
    for (int i = 0; parts & PART_POINT && i < 3; ++i)
        row[rows++] = row_component(dag, &link, i);
    for (int i = 0; parts & PART_PARALLEL && i < 2; ++i) {
        row[rows] = row_angle(dag, &side[i], &axis[1]);
        row[rows++].guard = ex_dot(dag, axis[0].v, axis[1].v); /* positive on the right branch: the axes are not half a
                                                                * turn apart */
    }
    if (parts & PART_LOCK) {
        row[rows] = row_angle(dag, &side[0], &other);
        row[rows++].guard = ex_dot(dag, side[1].v, other.v);
    }
    for (int i = 0; parts & PART_LINE && i < 2; ++i)
        row[rows++] = row_along(dag, &link, 0, &side[i]);
    if (parts & PART_LENGTH)
        row[rows++] = row_length(dag, &link, fixture->square);
    if (parts & PART_ALONG) {
        row[rows] = row_along(dag, &link, 0, &axis[0]);
        row[rows].value = ex_sub(dag, row[rows].value, fixture->offset);
        ++rows;
    }
    if (parts & PART_CROSS)
        row[rows++] = row_angle(dag, &axis[0], &axis[1]);
    if (parts & PART_GEAR)
        row[rows++] = row_gear(dag, fixture, end, &link, type == JOINT_SCREW ? &axis[0] : &side[0]);
    return rows;
}

Row coordinate_row(Dag *dag, CoordinateType type, const Fixture *fixture, const Motion *const end[2], Ex x, Ex rate)
{
    if (type == COORDINATE_ANGLE)
        return row_turn(dag, fixture, end, ex_sub(dag, x, fixture->offset), rate);
    Link link = link_between(dag, fixture, end);
    Row row;
    if (type == COORDINATE_LENGTH) {
        row = row_length(dag, &link, ex_mul(dag, x, x));
        row.dual = ex_neg(dag, x);
        row.bias = ex_sub(dag, row.bias, ex_mul(dag, rate, rate));
    } else {
        Vector axis = vector_axis(dag, end[0], fixture->axis[0]);
        row = row_along(dag, &link, 0, &axis);
        row.value = ex_sub(dag, row.value, ex_sub(dag, x, fixture->offset));
        row.dual = ex_literal(dag, -1);
    }
    return row;
}
