/* SPDX-License-Identifier: MIT
 * All formulas of a model and their numbers: the input of emission and of the tape. */
#include "base/message.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/tunable.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/plant_stores.h"
#include "vehicle/vehicle.h"

#include <string.h>

static const char *model_hash(Pool *pool, const Model *model, const Sequence *sequence)
{
    Text dump = {.pool = pool};
    model_dump(&dump, model, sequence);
    return pool_print(pool, "%016llx", (unsigned long long)text_hash(dump.s, dump.size));
}

const char *const solve_name[SOLVES] = {[SOLVE_AUTO] = "auto",
                                        [SOLVE_REDUCED] = "reduced",
                                        [SOLVE_ARTICULATED] = "articulated",
                                        [SOLVE_AUGMENTED] = "augmented"};

Solve solve_of(const char *name)
{
    int i = 0;
    while (i < SOLVES && strcmp(solve_name[i], name))
        ++i;
    return (Solve)i;
}

const char *const recovery_name[RECOVERIES] = {[RECOVERY_AUTO] = "auto",
                                               [RECOVERY_NEWTON] = "newton",
                                               [RECOVERY_CLOSED] = "closed",
                                               [RECOVERY_POLYNOMIAL] = "polynomial"};

Recovery recovery_of(const char *name)
{
    int i = 0;
    while (i < RECOVERIES && strcmp(recovery_name[i], name))
        ++i;
    return (Recovery)i;
}

void formulation_blocks(Pool *pool, Formulation *f)
{
    const Plan *plan = f->plan;
    Block *(*const dynamics[SOLVES])(Whole *) = {
        [SOLVE_REDUCED] = dynamics_block, [SOLVE_ARTICULATED] = articulated_block, [SOLVE_AUGMENTED] = augmented_block};
    f->dynamics = dynamics[plan->solve](whole_open(pool, plan, plan->pack));
    f->outputs = outputs_block(whole_new(pool, plan));
    f->contacts = contacts_block(whole_new(pool, plan));
    f->poses = poses_block(whole_new(pool, plan));
    f->inverse = inverse_block(whole_new(pool, plan));
    f->energy = energy_block(whole_new(pool, plan));
    f->check = check_block(whole_new(pool, plan));
    f->wrenches = plan->solve == SOLVE_AUGMENTED ? NULL : wrenches_block(whole_new(pool, plan));
    f->wheels = f->model->fast_states ? wheels_formulate(pool, plan) : NULL;
}

static Formulation *formulate_as(Pool *pool, const Model *model, const Sequence *sequence, Solve solve,
                                 Recovery recovery)
{
    double(*origin)[3] = reference_points(pool, model, sequence);
    const double(*fixed)[3] = (const double(*)[3])origin;
    Sampling *sampling = sampling_new(pool, model, sequence, fixed);
    Formula **formula = subsets_formulate(pool, model, &sequence, fixed, sampling, solve, recovery);
    Plan *plan = plan_new(pool, model, sequence, solve, formula, fixed);
    Formulation *f = pool_alloc(pool, sizeof *f);
    *f = (Formulation){.model = model,
                       .sequence = sequence,
                       .sampling = sampling,
                       .plan = plan,
                       .hash = model_hash(pool, model, sequence)};
    formulation_blocks(pool, f);
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        f->known_most = subset->knowns > f->known_most ? subset->knowns : f->known_most;
        f->dependence_most = subset->deps > f->dependence_most ? subset->deps : f->dependence_most;
    }
    plant_stores(f, "all");
    return f;
}

/* Operations of a right-hand side, with one correction of Newton's iteration. */
static int operations(Pool *pool, const Formulation *f)
{
    return count_sum(figures_rhs(figures_new(pool, f), 1, 1));
}

/* Largest number of coordinates that a subset's motion relative to the base depends on. */
static int deepest(const Sequence *sequence)
{
    int most = 0;
    for (int s = 0; s < sequence->subsets; ++s)
        most = sequence->subset[s].deps > most ? sequence->subset[s].deps : most;
    return most;
}

/* The chained sequence of the articulated form; NULL: the form can't be used for this model, or is not asked for. */
static const Sequence *chain_for(Pool *pool, const Model *model, const Sequence *sequence, Solve solve)
{
    const char *missing = articulated_missing(model);
    if (solve != SOLVE_ARTICULATED && (solve != SOLVE_AUTO || missing))
        return NULL;
    if (missing)
        diag_fail((Place){model->source, 0, 0}, "use the reduced form, which looks at what is left of every inertia",
                  "the articulated form of the equations of motion %s", missing);
    const Sequence *chained = sequence_chain(pool, model, sequence);
    if (!chained && solve == SOLVE_ARTICULATED)
        diag_fail(
            (Place){model->source, 0, 0}, "use the reduced form, which takes the same operations then",
            "the articulated form needs a chain: every subset of this model hangs on the base or on several bodies");
    return chained;
}

/* Work in the reduced form grows with the cube of the number of coordinates that a subset depends on: beyond this
 * number the articulated form is taken without counting. */
static bool is_long(const Sequence *sequence, Solve solve)
{
    const int most = 12;
    return solve == SOLVE_ARTICULATED || deepest(sequence) > most;
}

bool formulation_chains(Pool *pool, const Model *model, const Sequence *sequence, Solve solve)
{
    return is_long(sequence, solve) && chain_for(pool, model, sequence, solve);
}

/* True if set-up can make masses so unequal that only the reduced form is accurate. */
static bool masses_tuned(const Model *model)
{
    for (int b = 0; model->tuning && b < model->bodies; ++b)
        if (tuned_number(model, &model->body[b].mass))
            return true;
    return false;
}

const Formulation *formulate(Pool *pool, const Model *model, const Sequence *sequence, Solve solve, Recovery recovery)
{
    const Sequence *chained = chain_for(pool, model, sequence, solve);
    if (!chained || (!is_long(sequence, solve) && masses_tuned(model)))
        return formulate_as(pool, model, sequence, solve == SOLVE_AUGMENTED ? solve : SOLVE_REDUCED, recovery);
    const Formulation *articulated = formulate_as(pool, model, chained, SOLVE_ARTICULATED, recovery);
    if (is_long(sequence, solve))
        return articulated;
    const Formulation *reduced = formulate_as(pool, model, sequence, SOLVE_REDUCED, recovery);
    return operations(pool, articulated) < operations(pool, reduced) ? articulated : reduced;
}

double formulation_numbers(Pool *pool, const Model *model, const Sequence *sequence, Solve solve)
{
    const Sequence *chained = chain_for(pool, model, sequence, solve);
    const Sequence *used = chained && is_long(sequence, solve) ? chained : sequence;
    double numbers = 0;
    for (int s = 0; s < used->subsets; ++s) {
        const Subset *subset = &used->subset[s];
        numbers += (double)subset->bodies * ((double)MOTION_S + 6.0 * subset->deps);
        numbers += subset->class < 0 ? 0 : inertia_mass(subset->deps, subset->deps, subset->deps);
    }
    return numbers;
}

bool formulation_reacts(const Formulation *f)
{
    return f->plan->solve != SOLVE_AUGMENTED && f->plan->multipliers;
}

static StateNumber fast_number(Pool *pool, const Model *model, int index)
{
    const Powertrain *powertrain = model->powertrain;
    if (powertrain && index >= powertrain->fast && index < powertrain->fast + POWERTRAIN_FAST) {
        bool speed = index - powertrain->fast == POWERTRAIN_SPEED;
        return (StateNumber){powertrain_fast_name[index - powertrain->fast], speed ? "rad/s" : "s",
                             speed ? powertrain->idle : POWERTRAIN_FIRST_AGE};
    }
    for (int i = 0; i < model->states; ++i)
        if (model->state[i].fast == index)
            return (StateNumber){model->state[i].name, model->state[i].unit, model->state[i].initial};
    const Wheel *wheel = model->wheel;
    while (index >= wheel->fast + wheel_fast_states(wheel) || wheel->tire < 0)
        ++wheel;
    int which = index - wheel->fast;
    return (StateNumber){pool_print(pool, "%s.%s", wheel->name, wheel_fast_name[which]),
                         which == FAST_SPIN ? "rad/s" : "1", 0};
}

StateNumber state_number(Pool *pool, const Formulation *f, int index)
{
    const Model *model = f->model;
    if (index >= f->plan->states)
        return fast_number(pool, model, index - f->plan->states);
    for (int w = 0; w < model->coordinates; ++w) {
        const Coordinate *c = &model->coordinate[w];
        bool angle = c->type == COORDINATE_ANGLE;
        if (f->plan->coordinate_state[w] == index)
            return (StateNumber){c->name, angle ? "rad" : "m", c->initial};
        if (f->plan->coordinate_rate[w] == index)
            return (StateNumber){pool_print(pool, "%s.rate", c->name), angle ? "rad/s" : "m/s", 0};
    }
    const Body *body = &model->body[BODY_BASE];
    int which = index < 7 ? index : index - f->plan->free_coordinates;
    double initial = which < 3 ? body->position[which] : which < 7 ? body->euler[which - 3] : 0;
    const char *unit = which < 3 ? "m" : which < 7 ? "1" : which < 10 ? "m/s" : "rad/s";
    return (StateNumber){base_state_name[which], unit, initial};
}

double coordinate_piece(const Formulation *f, int coordinate)
{
    const double swing = 0.1; /* rad, or relative to the subset's size */
    const Coordinate *c = &f->model->coordinate[coordinate];
    double most = f->sampling->swing[coordinate];
    return most > 0 ? swing / most : c->range[1] - c->range[0];
}

bool coordinate_unwinds(const Formulation *f, int coordinate)
{
    return !model_counts_turns(f->model) && f->model->coordinate[coordinate].type == COORDINATE_ANGLE &&
           coordinate_piece(f, coordinate) < 3;
}

void body_design(const Formulation *f, int anchor, int body, double q[7])
{
    if (f->model->tuning) {
        Ex c[3];
        body_drawn(f->model, f->plan->origin, anchor, body, c, q + 3);
        for (int i = 0; i < 3; ++i)
            q[i] = ex_value(f->model->tuning->dag, c[i], 0);
        return;
    }
    sampling_design(f->sampling, f->model, f->plan->origin, anchor, body, q);
}

const char *subset_title(Pool *pool, const Model *model, const Subset *subset)
{
    Text title = {.pool = pool};
    for (int b = 0; b < subset->bodies; ++b)
        text_print(&title, "%s%s", b ? " + " : "", model->body[subset->body[b]].name);
    return title.s;
}
