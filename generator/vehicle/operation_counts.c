/* SPDX-License-Identifier: MIT
 * Operation counts of the emitted code, for the comment at its beginning and for the report. */
#include "expression/expression.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

void count_add(Count *sum, Count more, int times)
{
    sum->add += times * more.add;
    sum->multiply += times * more.multiply;
    sum->divide += times * more.divide;
    sum->root += times * more.root;
    sum->function += times * more.function;
}

int count_sum(Count c)
{
    return c.add + c.multiply + c.divide + c.root + c.function;
}

static void wheel_figures(Pool *pool, Figures *figures, const Formulation *f)
{
    const Wheels *wheels = f->wheels;
    figures->wheel_times = pool_alloc(pool, (size_t)wheels->classes * sizeof(int));
    figures->link = block_count(&wheels->link);
    figures->torque = block_count(&wheels->torque);
    figures->wheel = pool_alloc(pool, (size_t)wheels->classes * sizeof *figures->wheel);
    figures->fast = figures->torque;
    if (f->model->powertrain) {
        figures->drive = block_count(&wheels->drive);
        count_add(&figures->fast, figures->drive, 1);
    }
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        count_add(&figures->wheel[c], block_count(&class->contact), 1);
        count_add(&figures->wheel[c], block_count(&class->tire), 1);
        count_add(&figures->wheel[c], block_count(&class->balance), 1);
        for (int i = 0; i < class->members; ++i)
            figures->wheel_times[c] += !narrowing_wheel_image(f->narrowing, class->member[i]);
        count_add(&figures->fast, figures->wheel[c], figures->wheel_times[c]);
    }
}

const Figures *figures_new(Pool *pool, const Formulation *f)
{
    int classes = f->sequence->classes;
    Figures *figures = pool_alloc(pool, sizeof *figures);
    *figures = (Figures){.sequence = f->sequence,
                         .class = pool_alloc(pool, (size_t)(classes + 1) * sizeof *figures->class),
                         .times = pool_alloc(pool, (size_t)(classes + 1) * sizeof(int)),
                         .react = pool_alloc(pool, (size_t)(classes + 1) * sizeof(Count)),
                         .reacting = pool_alloc(pool, (size_t)(classes + 1) * sizeof(int)),
                         .dynamics = block_count(f->dynamics),
                         .loads = block_count(f->dynamics),
                         .outputs = block_count(f->outputs),
                         .contacts = f->contacts ? block_count(f->contacts) : (Count){0}};
    count_add(&figures->loads, block_count_above_loads(f->dynamics), -1);
    for (int c = 0; c < classes; ++c) {
        const Formula *formula = f->plan->formula[c];
        figures->class[c] = (ClassFigures){formula->closed, block_count(&formula->predict),
                                           block_count(&formula->chord), block_count(&formula->solve)};
    }
    for (int s = 0; s < f->sequence->subsets; ++s)
        if (f->sequence->subset[s].class >= 0)
            figures->times[f->sequence->subset[s].class] +=
                !narrowing_steady(f->narrowing, s) && !narrowing_image(f->narrowing, s);
    if (f->wheels)
        wheel_figures(pool, figures, f);
    if (!formulation_reacts(f))
        return figures;
    figures->wrenches = block_count(f->wrenches);
    const bool *needed = reactions_needed(pool, f->model, f->sequence);
    for (int s = 0; s < f->sequence->subsets; ++s)
        if (needed[s]) {
            int class = f->sequence->subset[s].class;
            figures->react[class] = block_count(&f->plan->formula[class]->react);
            ++figures->reacting[class];
        }
    return figures;
}

Count figures_subset(const Figures *figures, int class, int chords, int passes)
{
    const ClassFigures *one = &figures->class[class];
    Count sum = one->predict;
    count_add(&sum, one->chord, chords);
    count_add(&sum, one->solve, one->closed ? 1 : passes);
    return sum;
}

Count figures_recovery(const Figures *figures, int chords, int passes)
{
    const Sequence *sequence = figures->sequence;
    Count sum = {0};
    for (int c = 0; c < sequence->classes; ++c)
        count_add(&sum, figures_subset(figures, c, chords, passes), figures->times[c]);
    return sum;
}

Count figures_rhs(const Figures *figures, int chords, int passes)
{
    Count sum = figures_recovery(figures, chords, passes);
    count_add(&sum, figures->dynamics, 1);
    count_add(&sum, figures->link, 1);
    count_add(&sum, figures->fast, 1);
    return sum;
}

Count figures_outputs(const Figures *figures)
{
    Count sum = figures->outputs;
    count_add(&sum, figures->wrenches, 1);
    for (int c = 0; c < figures->sequence->classes; ++c)
        count_add(&sum, figures->react[c], figures->reacting[c]);
    return sum;
}

Count figures_look(const Figures *figures)
{
    Count sum = figures_recovery(figures, 1, 1);
    count_add(&sum, figures->link, 1);
    count_add(&sum, figures->fast, 1);
    count_add(&sum, figures->contacts, 1);
    return sum;
}

bool narrowing_steady(const Narrowing *narrowing, int subset)
{
    return narrowing && narrowing->steady[subset];
}

bool narrowing_image(const Narrowing *narrowing, int subset)
{
    return narrowing && narrowing->image && narrowing->image[subset] >= 0;
}

bool narrowing_wheel_image(const Narrowing *narrowing, int wheel)
{
    return narrowing && narrowing->wheel && narrowing->wheel[wheel] >= 0;
}

int wheel_class_lanes(const Formulation *formulation, const WheelClass *class)
{
    int members = 0, lanes = 1;
    for (int i = 0; i < class->members; ++i)
        members += !narrowing_wheel_image(formulation->narrowing, class->member[i]);
    while (lanes < members && 2 * lanes <= formulation->plan->lanes)
        lanes *= 2;
    return lanes;
}
