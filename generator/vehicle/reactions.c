/* SPDX-License-Identifier: MIT
 * Reaction forces of joints (FORMAT.md section 9): the multipliers that they need, the wrenches that determine
 * these in the reduced form, and force and torque from the multipliers in either form. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <string.h>

Block *wrenches_block(Whole *whole)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    const bool *needed = reactions_needed(dag->pool, whole->model, plan->sequence);
    const Loads *loads = loads_make(whole);
    Ex alpha[3], a[3], *w2;
    Block *block = pool_alloc(dag->pool, sizeof *block);
    block->dag = dag;
    whole_accelerations(whole, alpha, a, &w2);
    for (int b = 1; b < whole->model->bodies; ++b) {
        Ex wrench[6];
        if (!needed[plan->sequence->body_subset[b]])
            continue;
        whole_inertial_wrench(whole, b, alpha, a, w2, wrench);
        for (int i = 0; i < 6; ++i)
            block_store(block, ex_sub(dag, wrench[i], loads->wrench[b][i]),
                        element_at(ARRAY_lambda, plan->multiplier_offset[b] + i));
    }
    return block;
}

/* Place of the first multiplier of a joint or of a coordinate: a subset's joints come first. */
static int multiplier_place(const Plan *plan, bool is_coordinate, int index)
{
    const Sequence *sequence = plan->sequence;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        int place = plan->multiplier_offset[subset->body[0]];
        for (int i = 0; i < subset->joints; ++i) {
            if (!is_coordinate && subset->joint[i] == index)
                return place;
            place += joint_equations[plan->model->joint[subset->joint[i]].type];
        }
        for (int i = 0; i < subset->coordinates; ++i)
            if (is_coordinate && subset->coordinate[i] == index)
                return place + i;
    }
    return -1;
}

/* What a joint that follows a coordinate takes from its drive: its dual times slope times its multiplier. */
static Ex coupler_share(Whole *whole, int index, int coordinate)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    const Joint *joint = &whole->model->joint[index];
    const Motion *const end[2] = {&whole->motion[joint->body[0]], &whole->motion[joint->body[1]]};
    Fixture fixture = whole_joint_fixture(whole, joint, plan->origin);
    const Coupling f = whole_coupling(whole, joint);
    const Row row = coordinate_row(dag, (CoordinateType)joint_measure(joint->type), &fixture, end, f.x, f.rate);
    const Ex lambda = ex_input(dag, element_at(ARRAY_lambda, multiplier_place(plan, false, index)), NULL);
    return ex_mul(dag, ex_mul(dag, row.dual, f.slope[coordinate]), lambda);
}

Ex whole_drive_reaction(Whole *whole, int index)
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    const Coordinate *coordinate = &whole->model->coordinate[index];
    const Motion *const end[2] = {&whole->motion[coordinate->body[0]], &whole->motion[coordinate->body[1]]};
    Fixture fixture = whole_coordinate_fixture(whole, coordinate, plan->origin);
    Row row = coordinate_row(dag, coordinate->type, &fixture, end, whole->x[index], whole->xd[index]);
    Ex lambda = ex_input(dag, element_at(ARRAY_lambda, multiplier_place(plan, true, index)), NULL);
    /* J^T lambda acts on the bodies; J twist = -dual w' */
    Ex force = ex_mul(dag, row.dual, lambda);
    for (int i = 0; i < whole->model->joints; ++i)
        if (joint_follows(&whole->model->joint[i], index))
            force = ex_add(dag, force, coupler_share(whole, i, index));
    return ex_neg(dag, force);
}

/* Forces along the directions that the recovery used across the first body's axis. */
static void add_across(Whole *whole, int index, const Fixture *fixture, Motion *first)
{
    const Sequence *sequence = whole->plan->sequence;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        for (int i = 0; i < subset->joints; ++i) {
            if (subset->joint[i] != index)
                continue;
            const Formula *formula = whole->plan->formula[subset->class];
            const int member = class_place(&sequence->class[subset->class], s);
            for (int j = 0; j < 2; ++j) {
                Ex side[3];
                for (int k = 0; k < 3; ++k)
                    side[k] = ex_literal(whole->dag, formula_value(formula, formula->across[i][j][k], member));
                if (side[0] || side[1] || side[2])
                    motion_side(whole->dag, first, fixture->side[j][0], side);
            }
        }
    }
}

void whole_reaction(Whole *whole, int index, Ex force[3], Ex torque[3])
{
    Dag *dag = whole->dag;
    const Plan *plan = whole->plan;
    const Joint *joint = &whole->model->joint[index];
    /* with the joint's point as the second body's reference point, the torque is about that */
    Motion second = whole->motion[joint->body[1]];
    Motion first = whole->motion[joint->body[0]];
    const Motion *const end[2] = {&first, &second};
    Vector point = whole_point(whole, joint->body[1], joint->point[1]);
    memcpy(second.c, point.v, sizeof second.c);
    double(*origin)[3] = pool_alloc(dag->pool, (size_t)whole->model->bodies * sizeof *origin);
    memcpy(origin, plan->origin, (size_t)whole->model->bodies * sizeof *origin);
    memcpy(origin[joint->body[1]], joint->point[1], sizeof *origin);
    tuning_copy(whole->model, origin[joint->body[0]], plan->origin[joint->body[0]], 3);
    tuning_copy(whole->model, origin[joint->body[1]], joint->point[1], 3);
    Fixture fixture = whole_joint_fixture(whole, joint, (const double(*)[3])origin);
    if (plan->solve != SOLVE_AUGMENTED)
        add_across(whole, index, &fixture, &first);
    Row row[ROWS_MAX];
    int rows = 1, place = multiplier_place(plan, false, index);
    if (joint->value)
        row[0] = coordinate_row(dag, (CoordinateType)joint_measure(joint->type), &fixture, end,
                                whole_coupling(whole, joint).x, ex_literal(dag, 0));
    else
        rows = joint_rows(dag, joint->type, &fixture, end, sequence_known_end(plan->sequence, joint), row);
    ex_zero3(dag, force);
    ex_zero3(dag, torque);
    for (int r = 0; r < rows; ++r) {
        Ex t[3], lambda = ex_input(dag, element_at(ARRAY_lambda, place + r), NULL);
        ex_scale3(dag, lambda, row[r].J[1], t);
        ex_add3(dag, torque, t, torque);
        ex_scale3(dag, lambda, row[r].J[1] + 3, t);
        ex_add3(dag, force, t, force);
    }
}
