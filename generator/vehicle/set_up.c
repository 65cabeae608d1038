/* SPDX-License-Identifier: MIT
 * Blocks of set-up that depend on geometric parameters: the numbers of derived[], and the poses of the bodies in
 * the drawing. */
#include "base/vec3.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

/* Lower bound for numbers that must not be negative: below 0 by less than any number in a file. */
static const double not_negative = -1e-30;

/* Refuse parameters unless value > least. */
static void require(Block *block, Ex value, double least, int condition)
{
    if (block->dag->node[value].level == LEVEL_VARIABLE)
        block_require(block, value, least, condition);
}

/* The bounds on ratios of masses of augmented_block() and articulated_missing(), for tuned masses. */
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
    require(block, ex_sub(dag, most, heavy), not_negative, model->tuning->late + LATE_MASSES);
}

const Block *derive_block(Pool *pool, const Plan *plan)
{
    const Tuning *tuning = plan->model->tuning;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = tuning->dag;
    block->model = plan->model->name;
    for (int i = 0; i < tuning->late; ++i)
        require(block, tuning->condition[i].value, tuning->condition[i].zero ? not_negative : 0, i);
    if (plan->solve != SOLVE_REDUCED)
        require_like_masses(block, plan);
    for (int i = 0; i < plan->derived->count; ++i)
        block_store(block, plan->derived->formula[i], element_at(ARRAY_self_derived, i));
    return block;
}

/* Store a formula if it follows parameters. */
static void store_tuned(Block *block, Ex formula, Array array, int index)
{
    if (block->dag->node[formula].level == LEVEL_VARIABLE)
        block_store(block, formula, element_at(array, index));
}

const Block *draw_block(Pool *pool, const Plan *plan)
{
    const Model *model = plan->model;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = model->tuning->dag;
    for (int i = 0; model->free_base && i < 3; ++i)
        store_tuned(block, tuned_number(model, &model->drawn[BODY_BASE].position[i]), ARRAY_self_state, i);
    for (int w = 0; w < model->coordinates; ++w) {
        const Coordinate *coordinate = &model->coordinate[w];
        store_tuned(block, tuned_number(model, &coordinate->design), ARRAY_self_start, w);
        store_tuned(block, tuned_number(model, &coordinate->initial),
                    coordinate->driven ? ARRAY_self_input : ARRAY_self_state,
                    coordinate->driven ? coordinate->input : plan->coordinate_state[w]);
    }
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        for (int b = 0; plan_follows(plan, s) && b < subset->bodies; ++b) {
            Ex c[3];
            double p[4];
            body_drawn(model, plan->origin, subset_anchor(model, plan->sequence, s), subset->body[b], c, p);
            for (int i = 0; i < 3; ++i)
                store_tuned(block, c[i], ARRAY_self_start, plan->start_offset[s] + plan->stride[s] * (7 * b + i));
        }
    }
    return block;
}

/* Squared deviation of a subset's bodies from the drawing: differences of rotation matrices, and of positions relative
 * to the subset's size. Constant numbers agree for all values of the parameters. */
static Ex strayed(const Plan *plan, int s)
{
    const Subset *subset = &plan->sequence->subset[s];
    const Formula *formula = plan->formula[subset->class];
    const int size = formula->layout.motion_size;
    Dag *dag = plan->model->tuning->dag;
    Ex sum = 0;
    for (int i = 0; i < formula->solve.stores; ++i) {
        const Store *store = &formula->solve.store[i];
        const int at = element_index(store->target, ARRAY_motion);
        if (at < 0 || at % size >= MOTION_OMEGA || formula->solve.dag->node[store->value].level < LEVEL_VARIABLE)
            continue;
        Ex drawn[12];
        double p[4], A[9];
        body_drawn(plan->model, plan->origin, BODY_BASE, subset->body[at / size], drawn, p);
        mat_from_euler(p, A);
        for (int k = 0; k < 9; ++k)
            drawn[MOTION_A + k] = ex_literal(dag, A[k]);
        const int place = plan->motion_offset[subset->body[at / size]] + plan->stride[s] * (at % size);
        const Ex found = ex_input(dag, element_at(ARRAY_self_motion, place), NULL);
        const Ex difference = ex_sub(dag, found, drawn[at % size]);
        const double scale = at % size < MOTION_A ? 1 / (formula->size * formula->size) : 1;
        sum = ex_add(dag, sum, ex_mul(dag, ex_literal(dag, scale), ex_mul(dag, difference, difference)));
    }
    return sum;
}

const Block *design_block(Pool *pool, const Plan *plan)
{
    /* above rounding in single precision, and a tenth of the distance to the nearest other assembly mode
     * (subset/closed_form.c) */
    const double tolerance = 1e-3;
    Block *block = pool_alloc(pool, sizeof *block);
    Dag *dag = block->dag = plan->model->tuning->dag;
    block->model = plan->model->name;
    for (int s = 0; s < plan->sequence->subsets; ++s)
        if (plan->sequence->subset[s].class >= 0 && !plan_follows(plan, s))
            require(block, ex_sub(dag, ex_literal(dag, tolerance * tolerance), strayed(plan, s)), 0,
                    plan->model->tuning->late + LATE_MODE);
    return block;
}

int design_first_piece(Pool *pool, const Plan *plan)
{
    return plan->model->tuning && plan->model->tuning->assembles && design_block(pool, plan)->checks ? 0 : 1;
}
