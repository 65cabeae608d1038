/* SPDX-License-Identifier: MIT
 * Formulas of a model for one scene: what the scene doesn't need is taken out of the model, what is known is folded
 * into the blocks, and what generated code must check is written down. */
#include "base/plant.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "specialize/mirror_model.h"
#include "specialize/specialize.h"
#include "specialize/specialize_private.h"
#include "subset/subset.h"
#include "vehicle/plant_stores.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void *narrow_copy(Pool *pool, const void *array, size_t count, size_t size)
{
    return pool_grow(pool, (void *)array, count * size, (count + 1) * size);
}

/* ---- the model ------------------------------------------------------------------------------------------------------
 */

static void keep_wanted(Pool *pool, Model *model, const bool *wanted)
{
    Output *kept = pool_alloc(pool, ((size_t)model->outputs + 1) * sizeof *kept);
    int outputs = 0;
    model->output_components = 0;
    for (int i = 0; i < model->outputs; ++i)
        if (wanted[i] || model->output[i].sampled) {
            output_copy(model, &kept[outputs++], &model->output[i]);
            model->output_components += model->output[i].count;
        }
    model->output = kept;
    model->outputs = outputs;
}

/* True if geometric parameters have the values of the file, which the model's numbers are for. */
static bool keeps_geometry(const Model *model, const double *parameter)
{
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].geometric && parameter[model->parameter[i].index] != model->parameter[i].value)
            return false;
    return true;
}

static const Model *narrow_model(Pool *pool, const Model *model, const Facts *facts)
{
    Model *narrow = narrow_copy(pool, model, 1, sizeof *narrow);
    narrow->input = narrow_copy(pool, model->input, (size_t)model->inputs, sizeof *model->input);
    narrow->parameter = narrow_copy(pool, model->parameter, (size_t)model->parameters, sizeof *model->parameter);
    if (facts->wanted)
        keep_wanted(pool, narrow, facts->wanted);
    for (int i = 0; i < model->inputs; ++i)
        if (facts->fixed[i])
            narrow->input[i].initial = facts->input[i];
    const bool rigid = facts->parameter && model->tuning && keeps_geometry(model, facts->parameter);
    if (rigid)
        narrow->tuning = NULL;
    for (int i = 0; facts->parameter && i < model->parameters; ++i) {
        Parameter *parameter = &narrow->parameter[i];
        if (parameter->tunable && (rigid || !parameter->geometric)) {
            parameter->value = facts->parameter[parameter->index];
            parameter->geometric = false;
        }
    }
    if (facts->neutral) {
        narrow->powertrain = narrow_copy(pool, model->powertrain, 1, sizeof *model->powertrain);
        narrow->powertrain->start_gear = 0;
    }
    return narrow;
}

/* ---- classes: members alike in what is known ------------------------------------------------------------------------
 */

/* Driven coordinates whose inputs stand still. */
static void find_steady(Narrower *n)
{
    const Model *model = n->model;
    bool *steady = pool_alloc(n->pool, (size_t)model->coordinates + 1);
    double *at = pool_alloc(n->pool, ((size_t)model->coordinates + 1) * sizeof *at);
    for (int w = 0; w < model->coordinates; ++w) {
        const int input = model->coordinate[w].input;
        if (!model->coordinate[w].driven)
            continue;
        const bool *fixed = n->facts->fixed + input;
        const double *value = n->facts->input + input;
        steady[w] = fixed[0] && fixed[1] && fixed[2] && value[1] == 0 && value[2] == 0;
        at[w] = value[0];
    }
    n->steady = steady;
    n->at = at;
}

/* Free coordinates that are odd stay where their image is. */
static void hold_odd(Narrower *n)
{
    for (int w = 0; w < n->model->coordinates; ++w)
        if (n->mirror->coordinate[w] == w && n->mirror->sign[w] < 0) {
            n->steady[w] = true;
            n->at[w] = n->model->coordinate[w].design;
        }
}

static bool alike(const Narrower *n, const Subset *a, const Subset *b)
{
    for (int j = 0; j < a->deps; ++j)
        if (n->steady[a->dep[j]] != n->steady[b->dep[j]])
            return false;
    return true;
}

static const char *split_name(Pool *pool, const Sequence *sequence, const char *name)
{
    for (int number = 2;; ++number) {
        const char *candidate = pool_print(pool, "%.36s_%d", name, number);
        int c = 0;
        while (c < sequence->classes && strcmp(sequence->class[c].name, candidate))
            ++c;
        if (c == sequence->classes)
            return candidate;
    }
}

/* Keep in class c the members that are like its first one; the others become a new class after all others. */
static void split_class(Narrower *n, Sequence *sequence, int c)
{
    Class *class = &sequence->class[c];
    const int members = class->members;
    Class rest = {.member = pool_alloc(n->pool, (size_t)members * sizeof(int))};
    int kept = 0, *member = pool_alloc(n->pool, (size_t)members * sizeof *member);
    for (int i = 0; i < members; ++i) {
        const int subset = class->member[i];
        if (alike(n, &sequence->subset[class->member[0]], &sequence->subset[subset]))
            member[kept++] = subset;
        else
            rest.member[rest.members++] = subset;
    }
    class->member = member;
    class->members = kept;
    if (!rest.members)
        return;
    for (int i = 0; i < rest.members; ++i)
        sequence->subset[rest.member[i]].class = sequence->classes;
    rest.name = split_name(n->pool, sequence, class->name);
    sequence->class[sequence->classes++] = rest;
}

static const Sequence *split_classes(Narrower *n, const Sequence *sequence)
{
    Sequence *split = narrow_copy(n->pool, sequence, 1, sizeof *split);
    split->subset = narrow_copy(n->pool, sequence->subset, (size_t)sequence->subsets, sizeof *split->subset);
    split->class = pool_grow(n->pool, sequence->class, (size_t)sequence->classes * sizeof *split->class,
                             ((size_t)sequence->subsets + 1) * sizeof *split->class);
    for (int c = 0; c < split->classes; ++c)
        split_class(n, split, c);
    return split;
}

/* ---- subsets --------------------------------------------------------------------------------------------------------
 */

/* A number of each member, where all have one: get(n, member's subset, a, b, &value). */
typedef bool MemberNumber(const Narrower *n, const Subset *subset, int a, int b, double *value);

static void give_members(Narrower *n, Givens *givens, const Class *class, MemberNumber *get, int a, int b,
                         Element input)
{
    const int members = class->members;
    double *value = pool_alloc(n->pool, (size_t)members * sizeof *value);
    for (int i = 0; i < members; ++i)
        if (!get(n, &n->plan->sequence->subset[class->member[i]], a, b, &value[i]))
            return;
    givens_numbers(givens, value, input);
}

static bool steady_value(const Narrower *n, const Subset *subset, int dep, int unused, double *value)
{
    (void)unused;
    *value = n->at[subset->dep[dep]];
    return n->steady[subset->dep[dep]];
}

static bool steady_rate(const Narrower *n, const Subset *subset, int dep, int unused, double *value)
{
    (void)unused;
    *value = 0;
    return n->steady[subset->dep[dep]];
}

static bool steady_motion(const Narrower *n, const Subset *subset, int known, int k, double *value)
{
    const int at = n->plan->motion_offset[subset->known[known]] + k;
    *value = n->motion[at];
    return n->known_motion[at];
}

/* What is known about the surroundings of the members of a class. */
static Givens *class_givens(Narrower *n, const Class *class, const Formula *formula)
{
    const Sequence *sequence = n->plan->sequence;
    const Subset *first = &sequence->subset[class->member[0]];
    Givens *givens = givens_new(n->pool);
    for (int i = 0; n->mirror && i < 3; i += 2) /* it pitches, and no more */
        givens_number(givens, 0, element_at(ARRAY_turn, i));
    for (int j = 0; j < first->deps; ++j) {
        give_members(n, givens, class, steady_rate, j, 0, element_at(ARRAY_rate, j));
        /* others follow the coordinate from the design, as set-up does with other geometry than the file's */
        if (formula->closed && !n->model->tuning)
            give_members(n, givens, class, steady_value, j, 0, element_at(ARRAY_x, j));
    }
    for (int i = 0; i < first->knowns; ++i) {
        const Subset *own = &sequence->subset[sequence->body_subset[first->known[i]]];
        for (int k = 0; k < n->plan->formula[own->class]->layout.motion_size; ++k)
            give_members(n, givens, class, steady_motion, i, k, element_of(ARRAY_known, i, k));
    }
    return givens;
}

/* Constants that a class stores are known to all that reads them. */
static void remember(Narrower *n, const Class *class, const Formula *formula)
{
    const Dag *dag = formula->dag;
    bool *steady = n->narrowing->steady, all = formula->closed && !formula->solve.checks && !formula->layout.start_size;
    for (int i = 0; i < formula->solve.stores; ++i) {
        const Store *store = &formula->solve.store[i];
        const int motion = element_index(store->target, ARRAY_motion),
                  inertia = element_index(store->target, ARRAY_inertia);
        all = all && dag->node[store->value].level < LEVEL_VARIABLE;
        if (dag->node[store->value].level == LEVEL_VARIABLE)
            continue;
        for (int m = 0; m < class->members; ++m) {
            const int subset = class->member[m], body = n->plan->sequence->subset[subset].body[0];
            const double value = ex_value(dag, store->value, m * (dag->samples / dag->members));
            if (motion >= 0) {
                n->known_motion[n->plan->motion_offset[body] + motion] = true;
                n->motion[n->plan->motion_offset[body] + motion] = value;
            } else if (inertia >= 0) {
                n->known_inertia[n->plan->inertia_offset[subset] + inertia] = true;
                n->inertia[n->plan->inertia_offset[subset] + inertia] = value;
            }
        }
    }
    for (int m = 0; m < class->members; ++m)
        steady[class->member[m]] = all;
}

static void narrow_class(Narrower *n, int c)
{
    const Class *class = &n->plan->sequence->class[c];
    const Formula *general = n->general->plan->formula[c];
    Formula *formula = narrow_copy(n->pool, general, 1, sizeof *formula);
    Partial p = partial_new(n->pool, general->dag, class_givens(n, class, general), NULL, false, n->model);
    formula->dag = p.to;
    formula->predict = partial_block(&p, &general->predict);
    formula->chord = partial_block(&p, &general->chord);
    formula->solve = partial_block(&p, &general->solve);
    formula->residual = partial_block(&p, &general->residual);
    formula->react = partial_block(&p, &general->react);
    if (general->polynomial) {
        Polynomial *polynomial = narrow_copy(n->pool, general->polynomial, 1, sizeof *polynomial);
        polynomial->within = partial_block(&p, &general->polynomial->within);
        polynomial->solve = partial_block(&p, &general->polynomial->solve);
        polynomial->edge = partial_block(&p, &general->polynomial->edge);
        formula->polynomial = polynomial;
    }
    n->plan->formula[c] = formula;
    remember(n, class, formula);
}

/* In computational order, so that the constants of a class are known before another class reads them. */
static void narrow_subsets(Narrower *n)
{
    const Sequence *sequence = n->plan->sequence;
    bool *done = pool_alloc(n->pool, (size_t)sequence->classes + 1);
    for (int s = 0; s < sequence->subsets; ++s) {
        const int c = sequence->subset[s].class;
        if (c < 0 || done[c])
            continue;
        done[c] = true;
        narrow_class(n, c);
    }
}

/* ---- the rest -------------------------------------------------------------------------------------------------------
 */

void narrow_assume(Narrower *n, AssumptionAbout about, const char *text, const char *broken)
{
    *POOL_PUSH(n->pool, n->narrowing->assumption, n->narrowing->assumptions) = (Assumption){about, text, broken};
}

/* About what belongs to the caller. */
static void assume(Narrower *n, const char *text, const char *broken)
{
    narrow_assume(n, ABOUT_CALLER, text, broken);
}

static const char *number_text(Pool *pool, double value)
{
    const char *text = pool_print(pool, "%.15g", value);
    return strtod(text, NULL) == value ? text : pool_print(pool, "%.17g", value);
}

/* One that keeps a value, in an array of the instance. */
static void give_fixed(Narrower *n, const char *kind, const char *name, Array array, const char *member, int index,
                       double value)
{
    givens_number(n->whole, value, element_at(array, index));
    givens_number(n->fast, value, element_at(array, index));
    assume(n, pool_print(n->pool, "%s '%s' is %s", kind, name, number_text(n->pool, value)),
           pool_print(n->pool, "self->%s[%d] != %s", member, index, emit_number(n->pool, value)));
}

static void give_ports(Narrower *n)
{
    const Model *model = n->model;
    for (int i = 0; i < model->ports; ++i) {
        Text broken = {.pool = n->pool};
        for (int k = 6 * i; k < 6 * i + 6; ++k) {
            givens_number(n->whole, 0, element_at(ARRAY_port, k));
            text_print(&broken, "%sself->port[%d] != R(0.0)", k % 6 ? " || " : "", k);
        }
        assume(n, pool_print(n->pool, "nothing acts on port '%s'", model->port[i].name), broken.s);
    }
}

/* Known numbers of the whole model, as graphs of the whole vehicle read them. */
static void give_whole(Narrower *n)
{
    const Model *model = n->model;
    const Facts *facts = n->facts;
    for (int i = 0; i < model->inputs; ++i)
        if (facts->fixed[i])
            give_fixed(n, "input", model->input[i].name, ARRAY_u, "input", i, facts->input[i]);
    for (int w = 0; w < model->coordinates; ++w)
        if (n->steady[w]) {
            givens_number(n->whole, n->at[w], element_at(ARRAY_x, w));
            givens_number(n->whole, 0, element_at(ARRAY_xd, w));
            givens_number(n->fast, n->at[w], element_at(ARRAY_x, w));
            givens_number(n->fast, 0, element_at(ARRAY_xd, w));
        }
    for (int i = 0; facts->parameter && i < model->parameters; ++i)
        if (model->parameter[i].tunable && !model->parameter[i].geometric)
            give_fixed(n, "parameter", model->parameter[i].name, ARRAY_p, "parameter", model->parameter[i].index,
                       model->parameter[i].value);
    if (facts->idle)
        give_ports(n);
    for (int i = 0; facts->neutral && i < GEAR_NUMBERS; ++i)
        givens_number(n->fast, 0, element_at(ARRAY_gear, i));
    if (facts->neutral) {
        const int gear = model->free_base;
        assume(n, "the transmission is in neutral",
               pool_print(n->pool, "self->discrete[%d] != 0 || self->discrete[%d] != 0", gear, gear + 1));
    }
    if (facts->plane && model->wheels)
        assume(n,
               pool_print(n->pool,
                          "the road is z = %s + %s x + %s y with friction %s, which is part of the code: leave "
                          "`road` NULL",
                          number_text(n->pool, facts->plane->height), number_text(n->pool, facts->plane->slope[0]),
                          number_text(n->pool, facts->plane->slope[1]), number_text(n->pool, facts->plane->friction)),
               "self->head.road != NULL");
}

/* Known constants among the results of subsets. */
static void give_subsets(Narrower *n)
{
    for (int i = 0; i < n->plan->motion_size; ++i)
        if (n->known_motion[i])
            givens_number(n->whole, n->motion[i], element_at(ARRAY_m, i));
    for (int i = 0; i < n->plan->inertia_size; ++i)
        if (n->known_inertia[i])
            givens_number(n->whole, n->inertia[i], element_at(ARRAY_n, i));
}

static const Block *narrow_block(Narrower *n, const Givens *givens, const Block *block)
{
    Block *out = pool_alloc(n->pool, sizeof *out);
    if (!block)
        return NULL;
    Partial p = partial_new(n->pool, block->dag, givens, n->facts->plane, n->mirror && n->facts->across, n->model);
    *out = partial_block(&p, block);
    return out;
}

/* ---- wheels with tires, powertrain */

static const Store *store_of(const Block *block, Element target)
{
    for (int i = 0; i < block->stores; ++i)
        if (element_same(block->store[i].target, target))
            return &block->store[i];
    return NULL;
}

/* Torques of drive and brake that are the same all along. */
static Givens *wheel_givens(Narrower *n, const Block *torque, const WheelClass *class)
{
    Givens *givens = givens_new(n->pool);
    const int members = class->members;
    for (int which = 0; which < 2; ++which) {
        double *value = pool_alloc(n->pool, (size_t)members * sizeof *value);
        int known = 0;
        for (int i = 0; i < class->members; ++i) {
            const int place = 2 * wheel_rolling(n->model, class->member[i]) + which;
            const Store *store = store_of(torque, element_at(ARRAY_torque, place));
            known += torque->dag->node[store->value].level < LEVEL_VARIABLE;
            value[i] = ex_value(torque->dag, store->value, 0);
        }
        if (known == class->members)
            givens_numbers(givens, value, element_at(ARRAY_torque, which));
    }
    return givens;
}

static void narrow_wheel_class(Narrower *n, const Block *torque, WheelClass *class)
{
    Partial p = partial_new(n->pool, class->contact.dag, wheel_givens(n, torque, class), n->facts->plane,
                            n->mirror && n->facts->across, n->model);
    class->contact = partial_block(&p, &class->contact);
    class->tire = partial_block(&p, &class->tire);
    class->balance = partial_block(&p, &class->balance);
}

/* Drop the powertrain's stores for wheels whose numbers are copied from their mirror images. */
static void drop_images(Narrower *n, Block *drive)
{
    int stores = 0;
    for (int i = 0; i < drive->stores; ++i) {
        bool image = false;
        for (int w = 0; n->mirror && w < n->model->wheels; ++w) {
            const Wheel *wheel = &n->model->wheel[w];
            const int rate = element_index(drive->store[i].target, ARRAY_rate) - wheel->fast;
            const int grip =
                element_index(drive->store[i].target, ARRAY_grip) - GRIP_NUMBERS * wheel_rolling(n->model, w);
            image = image || (n->narrowing->wheel[w] >= 0 &&
                              ((rate >= 0 && rate < wheel_fast_states(wheel)) || (grip >= 0 && grip < GRIP_NUMBERS)));
        }
        if (!image)
            drive->store[stores++] = drive->store[i];
    }
    drive->stores = stores;
}

/* In neutral, powertrain states that no output shows are frozen. */
static void rest_powertrain(Narrower *n, Block *drive)
{
    const int speed = n->model->powertrain->fast + POWERTRAIN_SPEED;
    int stores = 0;
    for (int i = 0; i < drive->stores; ++i) {
        Store store = drive->store[i];
        if (element_index(store.target, ARRAY_watch) >= 0)
            continue;
        if (n->facts->neutral && element_index(store.target, ARRAY_rate) == speed)
            store.value = ex_literal(drive->dag, 0);
        drive->store[stores++] = store;
    }
    drive->stores = stores;
}

static const Wheels *narrow_wheels(Narrower *n)
{
    if (!n->general->wheels)
        return NULL;
    Wheels *wheels = narrow_copy(n->pool, n->general->wheels, 1, sizeof *wheels);
    wheels->link = *narrow_block(n, n->whole, &wheels->link);
    wheels->torque = *narrow_block(n, n->fast, &wheels->torque);
    wheels->class = narrow_copy(n->pool, wheels->class, (size_t)wheels->classes, sizeof *wheels->class);
    for (int c = 0; c < wheels->classes; ++c)
        narrow_wheel_class(n, &wheels->torque, &wheels->class[c]);
    if (n->model->powertrain) {
        wheels->drive = *narrow_block(n, n->fast, &wheels->drive);
        wheels->shift = *narrow_block(n, n->fast, &wheels->shift);
        drop_images(n, &wheels->drive);
        if (!model_reads(n->model, OUTPUT_POWERTRAIN))
            rest_powertrain(n, &wheels->drive);
    }
    return wheels;
}

static void narrow_rest(Narrower *n)
{
    const Formulation *f = n->general;
    n->out->dynamics = narrow_block(n, n->whole, n->mirror ? narrow_dynamics(n) : f->dynamics);
    n->out->outputs = narrow_block(n, n->whole, f->outputs);
    n->out->contacts = narrow_block(n, n->whole, f->contacts);
    n->out->poses = narrow_block(n, n->whole, f->poses);
    n->out->inverse = narrow_block(n, n->whole, f->inverse);
    n->out->energy = narrow_block(n, n->whole, f->energy);
    n->out->check = narrow_block(n, n->whole, f->check);
    n->out->wrenches = narrow_block(n, n->whole, f->wrenches);
    n->out->wheels = narrow_wheels(n);
}

/* Mark the numbers of n[] that a block reads. */
static void mark_inertia(const Block *block, bool *read)
{
    Ex root[block->stores + block->checks + 1];
    int roots = 0;
    for (int i = 0; i < block->stores; ++i)
        root[roots++] = block->store[i].value;
    for (int i = 0; i < block->checks; ++i)
        root[roots++] = block->check[i].value;
    const bool *needed = dag_needed(block->dag, root, roots);
    for (int e = 0; e < block->dag->nodes; ++e) {
        const Node *node = &block->dag->node[e];
        const int index = needed[e] && node->op == OP_INPUT ? element_index(*node->element, ARRAY_n) : -1;
        if (index >= 0)
            read[index] = true;
    }
}

/* Stores of a class's inertia that no member's is read of. */
static void drop_stores(const Narrower *n, const Class *class, const bool *read, Block *solve)
{
    int stores = 0;
    for (int i = 0; i < solve->stores; ++i) {
        const int index = element_index(solve->store[i].target, ARRAY_inertia);
        bool wanted = index < 0;
        for (int m = 0; m < class->members; ++m)
            wanted = wanted || read[n->plan->inertia_offset[class->member[m]] + index];
        if (wanted)
            solve->store[stores++] = solve->store[i];
    }
    solve->stores = stores;
}

/* Drop the terms of subsets in equations that were removed: those of odd unknowns and of coordinates that stand
 * still. */
static void drop_inertia(Narrower *n)
{
    const Formulation *f = n->out;
    const Sequence *sequence = n->plan->sequence;
    const Block *const block[] = {f->dynamics, f->outputs, f->poses,    f->inverse,
                                  f->energy,   f->check,   f->wrenches, f->contacts};
    bool *read = pool_alloc(n->pool, (size_t)n->plan->inertia_size + 1);
    for (size_t i = 0; i < sizeof block / sizeof *block; ++i)
        if (block[i])
            mark_inertia(block[i], read);
    for (int c = 0; c < sequence->classes; ++c) {
        const Class *class = &sequence->class[c];
        Formula *formula = n->plan->formula[c];
        Block *solve = &formula->solve;
        drop_stores(n, class, read, solve);
        if (formula->polynomial) {
            solve = &formula->polynomial->solve;
            drop_stores(n, class, read, solve);
        }
    }
}

/* Find the functions and tables that emitted code still needs. */
static void find_uses(Pool *pool, const Formulation *f, Narrowing *narrowing)
{
    const Wheels none = {0}, *wheels = f->wheels ? f->wheels : &none;
    const Block *const block[] = {f->dynamics,     f->outputs,     f->poses,       f->inverse,
                                  f->energy,       f->check,       f->wrenches,    &wheels->link,
                                  &wheels->torque, &wheels->drive, &wheels->shift, f->contacts};
    for (size_t i = 0; i < sizeof block / sizeof *block; ++i) {
        if (!block[i] || !block[i]->dag)
            continue;
        narrowing->road = narrowing->road || block_uses(block[i], OP_ROAD);
        narrowing->tables = narrowing->tables || block_uses(block[i], OP_TABLE);
    }
    if (f->plan->model->tuning)
        narrowing->tables = narrowing->tables || block_uses(derive_block(pool, f->plan), OP_TABLE) ||
                            block_uses(draw_block(pool, f->plan), OP_TABLE) ||
                            block_uses(design_block(pool, f->plan), OP_TABLE);
    for (int c = 0; c < wheels->classes; ++c) {
        narrowing->road = narrowing->road || block_uses(&wheels->class[c].contact, OP_ROAD);
        narrowing->friction = narrowing->friction || block_uses(&wheels->class[c].contact, OP_FRICTION);
    }
}

/* To the bit, as the code checks it. */
static bool starts_even(const Narrower *n, const Mirror *mirror)
{
    const Model *model = n->model;
    const Facts *facts = n->facts;
    for (int w = 0; w < model->coordinates; ++w) {
        const int image = mirror->coordinate[w];
        const double sign = mirror->sign[w];
        if (!model->coordinate[w].driven &&
            (facts->value[image] != sign * facts->value[w] || facts->rate[image] != sign * facts->rate[w]))
            return false;
    }
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *wheel = &model->wheel[i];
        for (int k = 0; k < wheel_fast_states(wheel); ++k) {
            const double own = facts->state[wheel->fast + k],
                         other = facts->state[model->wheel[mirror->wheel[i]].fast + k];
            if (!(isnan(own) && isnan(other)) && other != wheel_fast_sign(k) * own)
                return false;
        }
    }
    return true;
}

/* Both sides of the same kind, and known to be, as far as bodies and joints go. */
static const Mirror *find_mirror(Narrower *n, Solve solve)
{
    const char **why = &n->narrowing->asymmetry;
    *why = n->facts->asymmetry;
    if (!*why && !n->model->free_base)
        *why = "the base is fixed";
    if (!*why && n->model->tuning)
        *why = "geometric parameters are not those of the file";
    if (!*why && solve == SOLVE_AUGMENTED)
        *why = "the equations of motion are in the augmented form";
    if (!*why && model_reads(n->model, OUTPUT_REACTION))
        *why = "reaction forces of joints are asked for";
    const Mirror *mirror = *why ? NULL : mirror_find(n->pool, n->model, why);
    for (int w = 0; mirror && w < n->model->coordinates; ++w)
        if (n->model->coordinate[w].driven &&
            (!n->steady[w] || n->at[mirror->coordinate[w]] != mirror->sign[w] * n->at[w])) {
            *why = pool_print(n->pool, "the driven coordinate '%s' moves, or not as its image does",
                              n->model->coordinate[w].name);
            return NULL;
        }
    if (mirror && !starts_even(n, mirror))
        *why = "the initial state is not the same on both sides";
    return *why ? NULL : mirror;
}

/* NULL: the sides are not mirror images. */
static const Formulation *narrow(Narrower *n, const Sequence *sequence, Solve solve, Recovery recovery)
{
    n->whole = givens_new(n->pool);
    n->fast = givens_new(n->pool);
    /* constant motions are found from all coordinates between a body and the base, which the reduced form has */
    n->general = formulate(n->pool, n->model, split_classes(n, sequence),
                           solve == SOLVE_AUGMENTED ? solve : SOLVE_REDUCED, recovery);
    const Plan *plan = n->general->plan;
    n->plan = narrow_copy(n->pool, plan, 1, sizeof *n->plan);
    n->plan->formula =
        narrow_copy(n->pool, plan->formula, (size_t)n->general->sequence->classes, sizeof *plan->formula);
    n->known_motion = pool_alloc(n->pool, (size_t)plan->motion_size + 1);
    n->known_inertia = pool_alloc(n->pool, (size_t)plan->inertia_size + 1);
    n->motion = pool_alloc(n->pool, ((size_t)plan->motion_size + 1) * sizeof *n->motion);
    n->inertia = pool_alloc(n->pool, ((size_t)plan->inertia_size + 1) * sizeof *n->inertia);
    n->narrowing->steady = pool_alloc(n->pool, (size_t)plan->sequence->subsets + 1);
    n->out = narrow_copy(n->pool, n->general, 1, sizeof *n->out);
    n->out->plan = n->plan;
    n->out->narrowing = n->narrowing;
    n->out->general = n->general;
    narrow_subsets(n);
    give_whole(n);
    give_subsets(n);
    if (n->mirror && narrow_unpaired(n))
        return NULL;
    if (n->mirror)
        narrow_mirror(n);
    narrow_rest(n);
    drop_inertia(n);
    find_uses(n->pool, n->out, n->narrowing);
    plant_stores(n->out, "scene");
    return n->out;
}

const Formulation *formulate_narrow(Pool *pool, const Model *model, const Sequence *sequence, Solve solve,
                                    Recovery recovery, const Facts *facts)
{
    /* for a chain the articulated form saves more than a scene does */
    if (!facts || formulation_chains(pool, model, sequence, solve))
        return formulate(pool, model, sequence, solve, recovery);
    Narrower n = {.pool = pool, .facts = facts, .model = narrow_model(pool, model, facts)};
    n.narrowing = pool_alloc(pool, sizeof *n.narrowing);
    n.narrowing->facts = facts;
    find_steady(&n);
    n.mirror = find_mirror(&n, solve);
    if (n.mirror)
        hold_odd(&n);
    const Formulation *out = narrow(&n, sequence, solve, recovery);
    const char *uneven = !n.mirror || planted("mirror") ? NULL : out ? narrow_uneven(&n) : narrow_unpaired(&n);
    if (!uneven)
        return out;
    n.mirror = NULL;
    find_steady(&n);
    *n.narrowing = (Narrowing){.facts = facts, .asymmetry = uneven};
    return narrow(&n, sequence, solve, recovery);
}
