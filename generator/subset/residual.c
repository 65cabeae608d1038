/* SPDX-License-Identifier: MIT
 * The check of a recovery in generated code: the constraints of a class and their two derivatives at the motions in
 * memory. It shares no simplification with the solution: rotations are nine numbers that must form a rotation,
 * without images of vectors. */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

/* Added to sums of magnitudes before division; squares of relevant speeds are far larger. */
static const double tiny = 1e-30;

/* A class while its block is made. row, scale: [n] equations at the motions in memory, and factors so that a move of
 * the subset's size, or a turn of one radian, changes a row by about 1. */
typedef struct Residual {
    Work *w;
    Dag *dag;
    Motion *found; /* [bodies] */
    Row *row;
    int *row_of;
    Ex *scale;
    Ex per_size; /* 1 / the subset's size */
} Residual;

static Ex magnitude(Dag *dag, Ex e)
{
    return ex_op(dag, OP_ABS, e, 0, 0);
}

static Ex sum_of_magnitudes(Dag *dag, const Ex *e, int count)
{
    Ex sum = 0;
    for (int i = 0; i < count; ++i)
        sum = ex_add(dag, sum, magnitude(dag, e[i]));
    return sum;
}

/* Errors are added, since a sum keeps a NaN. */
static Ex plus(Dag *dag, Ex error, Ex value)
{
    return ex_add(dag, error, magnitude(dag, value));
}

static Ex ratio(Dag *dag, Ex error, Ex norm)
{
    return ex_div(dag, error, ex_add(dag, norm, ex_literal(dag, tiny)));
}

/* The sum of the magnitudes of the terms that e adds up: what its rounding is relative to. size: [nodes] those that are
 * known. */
static Ex size_of_terms(Dag *dag, Ex e, Ex *size)
{
    if (size[e])
        return size[e];
    const Node node = dag->node[e]; /* a copy: nodes move when there are more */
    const Ex a = node.arg[0], b = node.arg[1];
    Ex found;
    switch ((Op)node.op) {
    case OP_NEG: found = size_of_terms(dag, a, size); break;
    case OP_ADD:
    case OP_SUB: found = ex_add(dag, size_of_terms(dag, a, size), size_of_terms(dag, b, size)); break;
    case OP_MUL: found = ex_mul(dag, size_of_terms(dag, a, size), size_of_terms(dag, b, size)); break;
    case OP_DIV: found = ex_div(dag, size_of_terms(dag, a, size), magnitude(dag, b)); break;
    default: found = magnitude(dag, e);
    }
    return size[e] = found;
}

/* Size of a row's terms from the formula of a gear or coupler, of which e is a derivative. */
static Ex size_of_formula(const Residual *r, int row, Ex e)
{
    Ex *size = pool_alloc(r->dag->pool, (size_t)r->dag->nodes * sizeof *size);
    const Ex terms = size_of_terms(r->dag, e, size);
    return ex_mul(r->dag, magnitude(r->dag, ex_mul(r->dag, r->scale[row], r->row[row].dual)), terms);
}

/* Size of a twist or of its rate: angular part, linear part relative to the subset's size. */
static Ex twist_size(const Residual *r, const Ex angular[3], const Ex linear[3])
{
    return ex_add(r->dag, sum_of_magnitudes(r->dag, angular, 3),
                  ex_mul(r->dag, r->per_size, sum_of_magnitudes(r->dag, linear, 3)));
}

/* The motions in memory; numbers that are the same in every configuration are constants. */
static Motion *motions_from_memory(Work *w, const Formula *formula)
{
    Motion *found = pool_alloc(w->pool, (size_t)w->first->bodies * sizeof *found);
    for (int b = 0; b < w->first->bodies; ++b) {
        motion_input(w->dag, &found[b], ARRAY_motion, 0, b * formula->layout.motion_size, 1, w->first->deps);
        for (int i = 0; i < MOTION_S + 6 * w->first->deps; ++i) {
            const Ex e = *motion_number(&formula->motion[b], i);
            if (formula_is_constant(formula, e))
                *motion_number(&found[b], i) = e;
        }
    }
    return found;
}

/* The class's equations with the directions of the model, not with those that the solution uses in their place. */
static void make_rows(Residual *r)
{
    Work *w = r->w;
    w->plain = true;
    subset_rows(w, r->found, r->row, r->row_of);
    w->plain = false;
}

static bool is_length(const Work *w, const Connection *tie)
{
    return tie->measure >= 0 ? tie->measure == COORDINATE_LENGTH
                             : (joint_parts[w->model->joint[tie->index].type] & PART_LENGTH) != 0;
}

/* From the row's derivatives at the design; for a length also its present value, which may be much larger than there.
 */
static Ex row_scale(const Residual *r, int row)
{
    const Work *w = r->w;
    Dag *dag = r->dag;
    double largest[w->class->members], scale[w->class->members];
    for (int i = 0; i < w->class->members; ++i) {
        largest[i] = 0;
        for (int j = 0; j < w->n; ++j)
            largest[i] = fmax(largest[i], fabs(ex_value(dag, w->J[w->n * row + j], i * w->configurations)) /
                                              (j % 6 < 3 ? w->size : 1));
        largest[i] *= w->size;
        scale[i] = 1 / largest[i];
    }
    const Connection *tie = &w->connection[r->row_of[row]];
    const bool length = is_length(w, tie);
    const int end = tie->end[1].unknown >= 0 ? 1 : 0;
    const Ex now =
        length ? ex_mul(dag, ex_literal(dag, w->size), sum_of_magnitudes(dag, r->row[row].J[end] + 3, 3)) : 0;
    const Ex constant = ex_constant(dag, length ? largest : scale);
    ex_describe(dag, constant, "scale of %s", connection_name(w, tie));
    return length ? ex_div(dag, ex_literal(dag, 2), ex_add(dag, now, constant)) : constant;
}

/* Deviation of nine numbers from a rotation: lengths and angle of two columns, the third as their cross product. */
static Ex rotation_error(Dag *dag, const Ex A[9], Ex error)
{
    Ex column[3][3], third[3];
    for (int i = 0; i < 9; ++i)
        column[i % 3][i / 3] = A[i];
    ex_cross(dag, column[0], column[1], third);
    ex_sub3(dag, third, column[2], third);
    for (int i = 0; i < 2; ++i)
        error = plus(dag, error, ex_sub(dag, ex_dot(dag, column[i], column[i]), ex_literal(dag, 1)));
    error = plus(dag, error, ex_dot(dag, column[0], column[1]));
    for (int i = 0; i < 3; ++i)
        error = plus(dag, error, third[i]);
    return error;
}

static Ex pose_error(const Residual *r)
{
    Ex error = 0;
    for (int i = 0; i < r->w->n; ++i) {
        error = plus(r->dag, error, ex_mul(r->dag, r->scale[i], r->row[i].value));
        /* negative at the other solution of the same equation, half a turn away */
        Ex guard = r->row[i].guard;
        error = ex_add(r->dag, error, ex_sub(r->dag, magnitude(r->dag, guard), guard));
    }
    for (int b = 0; b < r->w->first->bodies; ++b)
        error = rotation_error(r->dag, r->found[b].A, error);
    return error;
}

/* The motion of the body at an end; NULL: the base. */
static const Motion *motion_at(const Residual *r, End end)
{
    return end.unknown >= 0 ? &r->found[end.unknown] : end.known >= 0 ? &r->w->known[end.known] : NULL;
}

/* J S + dual of a row for coordinate j: 0 if S is the twist of its unit rate. */
static Ex unit_rate(const Residual *r, int row, int j)
{
    const Connection *tie = &r->w->connection[r->row_of[row]];
    Ex sum = subset_dual(r->w, tie, &r->row[row], j);
    for (int end = 0; end < 2; ++end) {
        const Motion *motion = motion_at(r, tie->end[end]);
        for (int i = 0; motion && i < 6; ++i)
            sum = ex_add(r->dag, sum, ex_mul(r->dag, r->row[row].J[end][i], motion->S[6 * j + i]));
    }
    return sum;
}

/* Error of the unit velocities of coordinate j; *norm: the magnitude to compare it with. */
static Ex unit_error(const Residual *r, int j, Ex *norm)
{
    Dag *dag = r->dag;
    Ex error = 0;
    *norm = 0;
    for (int b = 0; b < r->w->first->bodies; ++b)
        *norm = ex_add(dag, *norm, twist_size(r, r->found[b].S + 6 * j, r->found[b].S + 6 * j + 3));
    for (int k = 0; k < r->w->first->knowns; ++k)
        *norm = ex_add(dag, *norm, twist_size(r, r->w->known[k].S + 6 * j, r->w->known[k].S + 6 * j + 3));
    for (int i = 0; i < r->w->n; ++i) {
        const Connection *tie = &r->w->connection[r->row_of[i]];
        error = plus(dag, error, ex_mul(dag, r->scale[i], unit_rate(r, i, j)));
        const Ex dual = subset_dual(r->w, tie, &r->row[i], j);
        if (tie->slope)
            *norm = ex_add(dag, *norm, size_of_formula(r, i, tie->slope[j]));
        else if (dual)
            *norm = ex_add(dag, *norm, magnitude(dag, ex_mul(dag, r->scale[i], dual)));
    }
    return error;
}

/* Velocity of a body if it moved with the subset's carrier: angular, linear. */
static void carried_velocity(const Residual *r, const Motion *motion, Ex out[6])
{
    Dag *dag = r->dag;
    const Motion *carrier = &r->w->known[0];
    Ex arm[3];
    if (r->w->first->carrier == BODY_BASE)
        return;
    ex_sub3(dag, motion->c, carrier->c, arm);
    ex_cross(dag, carrier->omega, arm, out + 3);
    ex_add3(dag, out + 3, carrier->velocity, out + 3);
    memcpy(out, carrier->omega, sizeof carrier->omega);
}

/* Error of velocities against unit velocities times rates. */
static Ex velocity_error(const Residual *r)
{
    Dag *dag = r->dag;
    Ex error = 0;
    for (int b = 0; b < r->w->first->bodies; ++b) {
        const Motion *motion = &r->found[b];
        Ex carried[6] = {0};
        carried_velocity(r, motion, carried);
        for (int i = 0; i < 6; ++i) {
            Ex excess = ex_sub(dag, i < 3 ? motion->omega[i] : motion->velocity[i - 3], carried[i]);
            for (int j = 0; j < r->w->first->deps; ++j)
                excess = ex_sub(dag, excess, ex_mul(dag, motion->S[6 * j + i], r->w->rate[j]));
            error = plus(dag, error, i < 3 ? excess : ex_mul(dag, r->per_size, excess));
        }
    }
    return error;
}

/* Magnitude of accelerations and of the terms of velocities. */
static Ex acceleration_size(const Residual *r, const Motion *motion)
{
    Dag *dag = r->dag;
    Ex turn = sum_of_magnitudes(dag, motion->omega, 3);
    Ex move = ex_mul(dag, r->per_size, sum_of_magnitudes(dag, motion->velocity, 3));
    return ex_add(dag, twist_size(r, motion->alpha, motion->acceleration),
                  ex_add(dag, ex_mul(dag, turn, turn), ex_mul(dag, move, move)));
}

/* Error of accelerations at w'' = 0: the constraints' second derivatives. */
static Ex acceleration_error(const Residual *r)
{
    Ex error = 0;
    for (int i = 0; i < r->w->n; ++i)
        error = plus(r->dag, error, ex_mul(r->dag, r->scale[i], r->row[i].bias));
    return error;
}

static Ex motion_error(const Residual *r)
{
    Dag *dag = r->dag;
    const Subset *first = r->w->first;
    Ex sum = 0, speed = 0, growth = 0;
    for (int b = 0; b < first->bodies; ++b) {
        Ex carried[6] = {0};
        carried_velocity(r, &r->found[b], carried);
        speed = ex_add(dag, speed, twist_size(r, r->found[b].omega, r->found[b].velocity));
        speed = ex_add(dag, speed, twist_size(r, carried, carried + 3));
        growth = ex_add(dag, growth, acceleration_size(r, &r->found[b]));
    }
    for (int k = 0; k < first->knowns; ++k)
        growth = ex_add(dag, growth, acceleration_size(r, &r->w->known[k]));
    for (int j = 0; j < first->deps; ++j) {
        Ex norm, error = unit_error(r, j, &norm);
        Ex part = ex_mul(dag, norm, magnitude(dag, r->w->rate[j]));
        sum = ex_add(dag, sum, ratio(dag, error, norm));
        speed = ex_add(dag, speed, part);
        growth = ex_add(dag, growth, ex_mul(dag, part, part));
    }
    for (int i = 0; i < r->w->n; ++i) {
        const Connection *tie = &r->w->connection[r->row_of[i]];
        if (tie->second)
            growth = ex_add(dag, growth, size_of_formula(r, i, tie->second));
    }
    sum = ex_add(dag, sum, ratio(dag, velocity_error(r), speed));
    return ex_add(dag, sum, ratio(dag, acceleration_error(r), growth));
}

void subset_residual(Work *w, Formula *formula)
{
    const size_t n = (size_t)w->n;
    Residual r = {.w = w,
                  .dag = w->dag,
                  .found = motions_from_memory(w, formula),
                  .row = pool_alloc(w->pool, n * sizeof(Row)),
                  .row_of = pool_alloc(w->pool, n * sizeof(int)),
                  .scale = pool_alloc(w->pool, n * sizeof(Ex)),
                  .per_size = ex_literal(w->dag, 1 / w->size)};
    make_rows(&r);
    for (int i = 0; i < w->n; ++i)
        r.scale[i] = row_scale(&r, i);
    block_store(&formula->residual, pose_error(&r), element_at(ARRAY_worst, 0));
    block_store(&formula->residual, motion_error(&r), element_at(ARRAY_worst, 1));
}
