/* SPDX-License-Identifier: MIT
 * Multipliers of a class of subsets: the transposed system J^T lambda = w of the recovery's own equations, w being the
 * wrenches that the joints of the bodies must add up to. What they put on bodies solved before is then known too, so
 * that going through the subsets against the computational order yields all of them. */
#include "rows.h"
#include "subset.h"

#include <string.h>

/* Does some member have a reaction to tell of this joint? */
static bool is_wanted(const Work *w, int position)
{
    bool wanted = false;
    for (int i = 0; i < w->class->members; ++i)
        wanted = wanted || reaction_wanted(w->model, subset_member(w, i)->joint[position]);
    return wanted;
}

/* Does some member pass on what it puts on this known body? */
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

/* Wrenches in the base's axes, torque and force, into those of the subset's frame. */
static void turn_wrenches(Work *w, Ex *wrench)
{
    for (int i = 0; w->anchored && i < w->n; i += 3) {
        const Ex given[3] = {wrench[i], wrench[i + 1], wrench[i + 2]};
        ex_apply_transposed(w->dag, w->known[0].A, given, wrench + i);
    }
}

/* Multipliers of common points are forces with components in the subset's frame; into the base's axes. */
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
        lambda[i] = ex_input(dag, pool_print(w->pool, "w[%d]", i), NULL);
    turn_wrenches(w, lambda);
    linear_solve_transposed(dag, factors, lambda, lambda);
    turn_forces(w, lambda);
    for (int r = 0; r < w->n; ++r)
        if (w->row_of[r] < w->first->joints && is_wanted(w, w->row_of[r]))
            block_store(block, lambda[r], "w[%d]", r);
    for (int known = 0; known < w->first->knowns; ++known)
        for (int i = 0; i < 6 && is_passed_on(w, needed, known); ++i) {
            const char *place = pool_print(w->pool, "w%d[%d]", known, i);
            Ex rest = ex_input(dag, place, NULL);
            for (int r = 0; r < w->n; ++r)
                for (int end = 0; end < 2; ++end)
                    if (w->connection[w->row_of[r]].end[end].known == known)
                        rest = ex_sub(dag, rest, ex_mul(dag, row[r].J[end][i], lambda[r]));
            block_store(block, rest, "%s", place);
        }
}
