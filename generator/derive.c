/* SPDX-License-Identifier: MIT
 * What emitted code computes from geometric parameters at set-up: the numbers of derived[], and where the bodies stand
 * in the drawing. */
#include "gicgen.h"

#include <string.h>

/* A share of nothing: what must not be negative may be this far below 0, which is no number that anyone writes. */
static const double not_negative = -1e-30;

const Block *derive_block(Pool *pool, const Plan *plan)
{
    const Tuning *tuning = plan->model->tuning;
    Block *block = pool_alloc(pool, sizeof *block);
    block->dag = tuning->dag;
    for (int i = 0; i < tuning->conditions; ++i) {
        const Condition *condition = &tuning->condition[i];
        block_check(block, condition->value, false, condition->zero ? not_negative : 0,
                    pool_print(pool, "%s_refuse(self, %d)", plan->model->name, i));
    }
    for (int i = 0; i < plan->derived->count; ++i)
        block_store(block, plan->derived->formula[i], "self->derived[%d]", i);
    return block;
}

/* Where a body's reference point is drawn. */
static void reference_drawn(const Plan *plan, int body, Ex out[3])
{
    const Model *model = plan->model;
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], origin[3], offset[3];
    mat_from_euler(model->drawn[body].euler, A);
    for (int i = 0; i < 9; ++i)
        turn[i] = ex_literal(dag, A[i]);
    for (int i = 0; i < 3; ++i)
        origin[i] = tuned_or_fixed(model, &plan->origin[body][i]);
    ex_apply(dag, turn, origin, offset);
    for (int i = 0; i < 3; ++i)
        out[i] = ex_add(dag, tuned_or_fixed(model, &model->drawn[body].position[i]), offset[i]);
}

void body_drawn(const Plan *plan, int anchor, int body, Ex c[3], double p[4])
{
    const Model *model = plan->model;
    Dag *dag = model->tuning->dag;
    double A[9];
    Ex turn[9], own[3], from[3];
    reference_drawn(plan, body, own);
    reference_drawn(plan, anchor, from);
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
            body_drawn(plan, subset_anchor(model, plan->sequence, s), subset->body[b], c, p);
            for (int i = 0; i < 3; ++i)
                store_tuned(block, c[i], "self->start[0]", plan->start_offset[s] + plan->stride[s] * (7 * b + i));
        }
    }
    return block;
}
