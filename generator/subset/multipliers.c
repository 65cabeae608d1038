/* SPDX-License-Identifier: MIT
 * Multipliers of a class of subsets: J^T lambda = w, the transpose of the equations of recovery, w being the
 * wrenches that the joints must exert on the bodies. These joints load bodies of earlier subsets, so subsets are
 * solved in reverse order. */
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/constraints.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <string.h>

/* True if some member has an output that needs the reaction of this joint. */
static bool is_wanted(const Work *w, int position)
{
    bool wanted = false;
    for (int i = 0; i < w->class->members; ++i)
        wanted = wanted || reaction_wanted(w->model, subset_member(w, i)->joint[position]);
    return wanted;
}

/* True if some member loads this known body and an output needs it. */
static bool is_passed_on(const Work *w, const bool *needed, int known)
{
    bool passed = false;
    for (int i = 0; i < w->class->members; ++i)
        passed = passed || needed[w->sequence->body_subset[subset_member(w, i)->known[known]]];
    return passed;
}

static bool is_needed(const Work *w, const bool *needed)
{
    bool any = false;
    for (int i = 0; i < w->class->members; ++i)
        any = any || needed[w->class->member[i]];
    return any;
}

/* Wrenches in base axes, torque and force, into the axes of the subset's frame. */
static void turn_wrenches(Work *w, Ex *wrench)
{
    for (int i = 0; w->anchored && i < w->n; i += 3) {
        const Ex given[3] = {wrench[i], wrench[i + 1], wrench[i + 2]};
        ex_apply_transposed(w->dag, w->known[0].A, given, wrench + i);
    }
}

/* Multipliers of common points are forces with components in the subset's frame; turn them into base axes. */
static void turn_forces(Work *w, Ex *lambda)
{
    for (int r = 0; w->anchored && r < w->n; ++r) {
        const Connection *tie = &w->connection[w->row_of[r]];
        const bool first = r == 0 || w->row_of[r] != w->row_of[r - 1];
        if (!first || tie->is_coordinate || !(joint_parts[w->model->joint[tie->index].type] & PART_POINT))
            continue;
        const Ex own[3] = {lambda[r], lambda[r + 1], lambda[r + 2]};
        ex_apply(w->dag, w->known[0].A, own, lambda + r);
    }
}

void subset_react(Work *w, const Factors *factors, const Row *row, Block *block)
{
    Dag *dag = w->dag;
    const bool *needed = reactions_needed(w->pool, w->model, w->sequence);
    if (!is_needed(w, needed))
        return;
    Ex lambda[w->n];
    for (int i = 0; i < w->n; ++i)
        lambda[i] = ex_input(dag, element_at(ARRAY_w, i), NULL);
    turn_wrenches(w, lambda);
    linear_solve_transposed(dag, factors, lambda, lambda);
    turn_forces(w, lambda);
    for (int r = 0; r < w->n; ++r)
        if (w->row_of[r] < w->first->joints && is_wanted(w, w->row_of[r]))
            block_store(block, lambda[r], element_at(ARRAY_w, r));
    for (int known = 0; known < w->first->knowns; ++known)
        for (int i = 0; i < 6 && is_passed_on(w, needed, known); ++i) {
            const Element place = element_of(ARRAY_onto, known, i);
            Ex rest = ex_input(dag, place, NULL);
            for (int r = 0; r < w->n; ++r)
                for (int end = 0; end < 2; ++end)
                    if (w->connection[w->row_of[r]].end[end].known == known)
                        rest = ex_sub(dag, rest, ex_mul(dag, row[r].J[end][i], lambda[r]));
            block_store(block, rest, place);
        }
}

const bool *reactions_needed(Pool *pool, const Model *model, const Sequence *sequence)
{
    bool *needed = pool_alloc(pool, (size_t)(sequence->subsets + 1) * sizeof *needed);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        for (int i = 0; i < subset->joints; ++i)
            needed[s] = needed[s] || reaction_wanted(model, subset->joint[i]);
        for (int i = 0; i < subset->knowns; ++i) /* bodies of earlier subsets */
            needed[s] = needed[s] || needed[sequence->body_subset[subset->known[i]]];
    }
    return needed;
}
