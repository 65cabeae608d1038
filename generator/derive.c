/* SPDX-License-Identifier: MIT
 * What emitted code computes from geometric parameters at set-up: the numbers of derived[], and where the bodies stand
 * in the drawing. */
#include "gicgen.h"

#include <stdio.h>
#include <string.h>

/* A share of nothing: what must not be negative may be this far below 0, which is no number that anyone writes. */
static const double not_negative = -1e-30;

/* Refuse parameters unless value > least. */
static void require(Block *block, const Plan *plan, Ex value, double least, int condition)
{
    const char *refusal = pool_print(block->dag->pool, "%s_refuse(self, %d)", plan->model->name, condition);
    if (block->dag->node[value].level == LEVEL_VARIABLE)
        block_check(block, value, false, least, refusal);
}

/* What augmented_block() and articulated_missing() demand of the masses in the file. */
static void require_like_masses(Block *block, const Plan *plan)
{
    const Model *model = plan->model;
    const double factor = plan->solve == SOLVE_AUGMENTED ? augmented_most_mass : articulated_most_mass;
    const int first = model->free_base ? BODY_BASE : BODY_BASE + 1;
    Dag *dag = block->dag;
    Ex light = 0, heavy = 0;
    for (int b = first; b < model->bodies; ++b) {
        const Ex mass = tuned_or_fixed(model, &model->body[b].mass);
        light = b == first ? mass : ex_op(dag, OP_MIN, light, mass, 0);
        heavy = b == first ? mass : ex_op(dag, OP_MAX, heavy, mass, 0);
    }
    const Ex most = ex_mul(dag, ex_literal(dag, factor), light);
    require(block, plan, ex_sub(dag, most, heavy), not_negative, model->tuning->late + LATE_MASSES);
}

const Block *derive_block(Pool *pool, const Plan *plan)
{
    const Tuning *tuning = plan->model->tuning;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = tuning->dag;
    for (int i = 0; i < tuning->late; ++i)
        require(block, plan, tuning->condition[i].value, tuning->condition[i].zero ? not_negative : 0, i);
    if (plan->solve != SOLVE_REDUCED)
        require_like_masses(block, plan);
    for (int i = 0; i < plan->derived->count; ++i)
        block_store(block, plan->derived->formula[i], "self->derived[%d]", i);
    return block;
}

/* Where a body's reference point is drawn. */
static void reference_drawn(const Model *model, const double (*from)[3], int body, Ex out[3])
{
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], origin[3], offset[3];
    mat_from_euler(model->drawn[body].euler, A);
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    for (int i = 0; i < 3; ++i)
        origin[i] = tuned_or_fixed(model, &from[body][i]);
    ex_apply(dag, turn, origin, offset);
    for (int i = 0; i < 3; ++i)
        out[i] = ex_add(dag, tuned_or_fixed(model, &model->drawn[body].position[i]), offset[i]);
}

void body_drawn(const Model *model, const double (*origin)[3], int anchor, int body, Ex c[3], double p[4])
{
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], own[3], from[3];
    reference_drawn(model, origin, body, own);
    reference_drawn(model, origin, anchor, from);
    ex_sub3(dag, own, from, own);
    mat_from_euler(model->drawn[anchor].euler, A);
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    ex_apply_transposed(dag, turn, own, c);
    euler_relative(model->drawn[anchor].euler, model->drawn[body].euler, p);
}

/* Only what follows parameters. */
static void store_tuned(Block *block, Ex formula, const char *array, int index)
{
    if (block->dag->node[formula].level == LEVEL_VARIABLE)
        block_store(block, formula, "%s[%d]", array, index);
}

const Block *draw_block(Pool *pool, const Plan *plan)
{
    const Model *model = plan->model;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = model->tuning->dag;
    for (int i = 0; model->free_base && i < 3; ++i)
        store_tuned(block, tuned_number(model, &model->drawn[BODY_BASE].position[i]), "self->state", i);
    for (int w = 0; w < model->coordinates; ++w) {
        const Coordinate *coordinate = &model->coordinate[w];
        store_tuned(block, tuned_number(model, &coordinate->design), "self->start[0]", w);
        store_tuned(block, tuned_number(model, &coordinate->initial),
                    coordinate->driven ? "self->input" : "self->state",
                    coordinate->driven ? coordinate->input : plan->coordinate_state[w]);
    }
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        for (int b = 0; plan_follows(plan, s) && b < subset->bodies; ++b) {
            Ex c[3];
            double p[4];
            body_drawn(model, plan->origin, subset_anchor(model, plan->sequence, s), subset->body[b], c, p);
            for (int i = 0; i < 3; ++i)
                store_tuned(block, c[i], "self->start[0]", plan->start_offset[s] + plan->stride[s] * (7 * b + i));
        }
    }
    return block;
}

/* Squared distance of a subset's bodies from their places in the drawing: differences of rotation matrices, and of
 * positions relative to the subset's size. Constants are in the drawing for any values of the parameters. */
static Ex strayed(const Plan *plan, int s)
{
    const Subset *subset = &plan->sequence->subset[s];
    const Formula *formula = plan->formula[subset->class];
    const int size = formula->layout.motion_size;
    Dag *dag = plan->model->tuning->dag;
    Ex sum = 0;
    for (int i = 0, at; i < formula->solve.stores; ++i) {
        const Store *store = &formula->solve.store[i];
        if (sscanf(store->target, "motion[%d]", &at) != 1 || at % size >= MOTION_OMEGA ||
            formula->solve.dag->node[store->value].level < LEVEL_VARIABLE)
            continue;
        Ex drawn[12];
        double p[4], A[9];
        body_drawn(plan->model, plan->origin, BODY_BASE, subset->body[at / size], drawn, p);
        mat_from_euler(p, A);
        for (int k = 0; k < 9; ++k)
            drawn[MOTION_A + k] = ex_literal(dag, A[k]);
        const int place = plan->motion_offset[subset->body[at / size]] + plan->stride[s] * (at % size);
        const Ex found = ex_input(dag, pool_print(dag->pool, "self->motion[%d]", place), NULL);
        const Ex difference = ex_sub(dag, found, drawn[at % size]);
        const double scale = at % size < MOTION_A ? 1 / (formula->size * formula->size) : 1;
        sum = ex_add(dag, sum, ex_mul(dag, ex_literal(dag, scale), ex_mul(dag, difference, difference)));
    }
    return sum;
}

const Block *design_block(Pool *pool, const Plan *plan)
{
    /* single precision and the nearest place where two modes meet, which is ten times as far (closed.c) */
    const double tolerance = 1e-3;
    Block *block = pool_alloc(pool, sizeof *block);
    Dag *dag = block->dag = plan->model->tuning->dag;
    for (int s = 0; s < plan->sequence->subsets; ++s)
        if (plan->sequence->subset[s].class >= 0 && !plan_follows(plan, s))
            require(block, plan, ex_sub(dag, ex_literal(dag, tolerance * tolerance), strayed(plan, s)), 0,
                    plan->model->tuning->late + LATE_MODE);
    return block;
}

int design_first_piece(Pool *pool, const Plan *plan)
{
    return plan->model->tuning && plan->model->tuning->assembles && design_block(pool, plan)->checks ? 0 : 1;
}
