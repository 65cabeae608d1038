/* SPDX-License-Identifier: MIT
 * The formulas of a model whose classes are solved in lanes. Where members of a class stand side by side, so do their
 * numbers in memory: the same number of all of them in one row, a lane a column. */
#include "gicgen.h"

/* Vectors of so many lanes hold that many members, or several of them do. Alone: 0. */
static int lanes_of(int members, int most)
{
    int lanes = 2;
    while (lanes < members && lanes < most)
        lanes *= 2;
    return members > 1 ? lanes : 0;
}

int class_rows(const Plan *plan, int class)
{
    int members = plan->sequence->class[class].members, lanes = plan->class_lanes[class];
    return lanes ? (members + lanes - 1) / lanes : members;
}

/* Where the numbers of one row of members stand, and of a member that stands alone. */
static void place_row(Plan *plan, const Class *class, int first, int lanes)
{
    const Layout *layout = &plan->formula[plan->sequence->subset[class->member[first]].class]->layout;
    for (int l = 0; l < (lanes ? lanes : 1) && first + l < class->members; ++l) {
        int s = class->member[first + l];
        const Subset *subset = &plan->sequence->subset[s];
        plan->stride[s] = lanes ? lanes : 1;
        plan->start_offset[s] = plan->start_size + l;
        plan->inertia_offset[s] = plan->inertia_size + l;
        for (int b = 0; b < subset->bodies; ++b)
            plan->motion_offset[subset->body[b]] = plan->motion_size + b * layout->motion_size * plan->stride[s] + l;
    }
    lanes = lanes ? lanes : 1;
    plan->start_size += layout->start_size * lanes;
    plan->inertia_size += layout->inertia_size * lanes;
    plan->motion_size += layout->bodies * layout->motion_size * lanes;
}

/* The same plan with its numbers in rows. */
static Plan *plan_lanes(Pool *pool, const Plan *plan, int most)
{
    const Sequence *sequence = plan->sequence;
    size_t subsets = (size_t)sequence->subsets + 1, bodies = (size_t)plan->model->bodies;
    Plan *rows = pool_alloc(pool, sizeof *rows);
    *rows = *plan;
    rows->lanes = most;
    rows->class_lanes = pool_alloc(pool, ((size_t)sequence->classes + 1) * sizeof(int));
    rows->start_offset = pool_alloc(pool, subsets * sizeof(int));
    rows->inertia_offset = pool_alloc(pool, subsets * sizeof(int));
    rows->motion_offset = pool_alloc(pool, bodies * sizeof(int));
    rows->stride = pool_alloc(pool, subsets * sizeof(int));
    rows->start_size = plan->model->coordinates;
    rows->inertia_size = rows->motion_size = 0;
    for (int c = 0; c < sequence->classes; ++c) {
        const Class *class = &sequence->class[c];
        int lanes = rows->class_lanes[c] = lanes_of(class->members, most);
        for (int first = 0; first < class->members; first += lanes ? lanes : 1)
            place_row(rows, class, first, lanes);
    }
    return rows;
}

const Formulation *formulation_lanes(Pool *pool, const Formulation *formulation, int most)
{
    Formulation *f = pool_alloc(pool, sizeof *f);
    *f = *formulation;
    f->plan = plan_lanes(pool, formulation->plan, most);
    formulation_blocks(pool, f);
    return f;
}
