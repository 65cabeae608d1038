/* SPDX-License-Identifier: MIT
 * Opening the engine `tape` for a model: record its formulas, lay out instances, describe them. */
#include "base/table.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "tape/engine_tape.h"
#include "tape/record.h"
#include "validate/validate.h"
#include "vehicle/vehicle.h"

#include "../../templates/bounds.c.in"

static double *numbers(Pool *pool, int count)
{
    return pool_alloc(pool, (size_t)(count + 1) * sizeof(double));
}

/* ---- tapes ------------------------------------------------------------------------------------------------- */

static void record_classes(Pool *pool, TapeEngine *engine)
{
    const Formulation *f = engine->formulation;
    const int arrays = CLASS_KNOWN + 2 * f->known_most;
    Element *array = pool_alloc(pool, (size_t)arrays * sizeof *array);
#define NAME(name) array[CLASS_##name] = element_at(ARRAY_##name, 0);
    CLASS_ARRAYS(NAME)
#undef NAME
    for (int i = 0; i < f->known_most; ++i) {
        array[CLASS_KNOWN + i] = element_of(ARRAY_known, i, 0);
        array[CLASS_KNOWN + f->known_most + i] = element_of(ARRAY_onto, i, 0);
    }
    engine->class = pool_alloc(pool, (size_t)(f->sequence->classes + 1) * sizeof *engine->class);
    for (int c = 0; c < f->sequence->classes; ++c) {
        const Formula *formula = f->plan->formula[c];
        const double far = formula->distance * formula->distance;
        engine->class[c] = (TapeClass){.predict = tape_record(pool, &formula->predict, array, arrays),
                                       .chord = tape_record(pool, &formula->chord, array, arrays),
                                       .solve = tape_record(pool, &formula->solve, array, arrays),
                                       .residual = tape_record(pool, &formula->residual, array, arrays),
                                       .react = tape_record(pool, &formula->react, array, arrays),
                                       .layout = &formula->layout,
                                       .closed = formula->closed,
                                       .enough = GIC_ENOUGH(far)};
        for (int i = 0; i < f->sequence->class[c].members; ++i)
            engine->member[f->sequence->class[c].member[i]] = i;
    }
}

static void record_whole(Pool *pool, TapeEngine *engine)
{
    static const Element array[WHOLE_COUNT] = {
    /* clang-format off */
#define NAME(name) [WHOLE_##name] = {.array = ARRAY_##name},
        WHOLE_ARRAYS(NAME)
#undef NAME
            /* clang-format on */
            [WHOLE_DERIVED] = {.array = ARRAY_self_derived},
        [WHOLE_GRIP] = {.array = ARRAY_self_grip},
        [WHOLE_WATCH] = {.array = ARRAY_self_watch},
    };
    const Formulation *f = engine->formulation;
    engine->dynamics = tape_record(pool, f->dynamics, array, WHOLE_COUNT);
    engine->outputs = tape_record(pool, f->outputs, array, WHOLE_COUNT);
    engine->contacts = f->contacts ? tape_record(pool, f->contacts, array, WHOLE_COUNT) : NULL;
    engine->poses = tape_record(pool, f->poses, array, WHOLE_COUNT);
    engine->inverse = tape_record(pool, f->inverse, array, WHOLE_COUNT);
    engine->energy = tape_record(pool, f->energy, array, WHOLE_COUNT);
    engine->check = tape_record(pool, f->check, array, WHOLE_COUNT);
    if (f->wrenches && f->plan->multipliers) {
        engine->wrenches = tape_record(pool, f->wrenches, array, WHOLE_COUNT);
        engine->reacts = reactions_needed(pool, f->model, f->sequence);
    }
    if (f->wheels)
        tape_record_wheels(pool, engine, array);
}

static void make_tables(Pool *pool, TapeEngine *engine)
{
    const Model *model = engine->formulation->model;
    engine->table = pool_alloc(pool, (size_t)(model->tables + 1) * sizeof *engine->table);
    for (int i = 0; i < model->tables; ++i) {
        const Table *table = &model->table[i];
        engine->table[i] = (gic_table){table->x, table->y, table->slope, table->count, table->cubic, table->onward};
    }
}

TapeLinks tape_links_new(Pool *pool, const Formulation *f)
{
    return (TapeLinks){.array = pool_alloc(pool, (size_t)(CLASS_KNOWN + 2 * f->known_most) * sizeof(double *)),
                       .x = numbers(pool, f->dependence_most),
                       .rate = numbers(pool, f->dependence_most),
                       .change = numbers(pool, f->dependence_most),
                       .same = pool_alloc(pool, (size_t)(f->model->coordinates + 1) * sizeof(bool))};
}

static void make_scratch(Pool *pool, TapeEngine *engine)
{
    const Formulation *f = engine->formulation;
    const Tape *const whole[] = {engine->dynamics, engine->outputs, engine->poses,
                                 engine->inverse,  engine->energy,  engine->check};
    int slots = GIC_MAX(engine->wrenches ? engine->wrenches->slots : 0, engine->contacts ? engine->contacts->slots : 0),
        bodies = 0, unknowns = f->plan->unknowns;
    if (engine->derive)
        slots = GIC_MAX(slots, GIC_MAX(engine->derive->slots, GIC_MAX(engine->draw->slots, engine->design->slots)));
    for (size_t i = 0; i < sizeof whole / sizeof *whole; ++i)
        slots = GIC_MAX(slots, whole[i]->slots);
    for (int c = 0; c < f->sequence->classes; ++c) {
        const TapeClass *class = &engine->class[c];
        const Tape *const part[] = {class->predict, class->chord, class->solve, class->residual, class->react};
        for (size_t i = 0; i < sizeof part / sizeof *part; ++i)
            slots = GIC_MAX(slots, part[i]->slots);
        bodies = GIC_MAX(bodies, class->layout->bodies);
    }
    for (int c = 0; f->wheels && c < f->wheels->classes; ++c) {
        const TapeWheel *wheel = &engine->wheel[c];
        slots = GIC_MAX(slots, GIC_MAX(wheel->contact->slots, GIC_MAX(wheel->tire->slots, wheel->balance->slots)));
    }
    if (f->wheels) {
        slots = GIC_MAX(slots, GIC_MAX(engine->link->slots, engine->torque->slots));
        if (engine->drive) {
            slots = GIC_MAX(slots, GIC_MAX(engine->drive->slots, engine->shift->slots));
            engine->choice = numbers(pool, 2 * f->model->powertrain->forward);
        }
        engine->link_row = numbers(pool, f->wheels->links);
        engine->torques = numbers(pool, 2 * f->wheels->count);
    }
    engine->slots = slots;
    engine->frame = numbers(pool, slots);
    engine->q = numbers(pool, 7 * bodies);
    engine->result = numbers(pool, f->plan->states + f->model->fast_states);
    engine->out = numbers(pool, f->model->output_components);
    engine->wanted = numbers(pool, f->model->tunables);
    engine->acc = numbers(pool, unknowns);
    engine->unit = numbers(pool, unknowns);
    engine->tau0 = numbers(pool, unknowns);
    engine->tau = numbers(pool, unknowns);
    engine->size = numbers(pool, unknowns);
    engine->mass = numbers(pool, unknowns * unknowns);
    engine->links = tape_links_new(pool, f);
}

/* ---- instances --------------------------------------------------------------------------------------------------- */

/* Arrays after those of the descriptor. */
static void lay_out(TapeEngine *engine)
{
    gic_model *code = &engine->code;
    const Plan *plan = engine->formulation->plan;
    const size_t coordinates = (size_t)code->coordinate_count;
    engine->x_offset = descriptor_place(code, coordinates);
    engine->xd_offset = descriptor_place(code, coordinates);
    for (int i = 0; i < GIC_STARTS; ++i)
        engine->start_offset[i] = descriptor_place(code, (size_t)plan->start_size);
    engine->motion_offset = descriptor_place(code, (size_t)plan->motion_size);
    engine->inertia_offset = descriptor_place(code, (size_t)plan->inertia_size);
    engine->derived_offset = descriptor_place(code, (size_t)plan->derived->count);
    engine->multiplier_offset = descriptor_place(code, (size_t)plan->multipliers);
    engine->recovered_offset = descriptor_place(code, 2 * coordinates + 5);
    const Wheels *wheels = engine->formulation->wheels;
    if (wheels) {
        code->link_offset = descriptor_place(code, 5 * (size_t)wheels->links);
        engine->grip_offset = descriptor_place(code, GRIP_NUMBERS * (size_t)wheels->count);
        engine->gear_offset = descriptor_place(code, engine->drive ? GEAR_NUMBERS : 0);
        engine->watch_offset = descriptor_place(code, engine->drive ? WATCH_NUMBERS : 0);
    }
}

TapeEngine *tape_open(Pool *pool, const Model *model, Solve solve, Recovery recovery)
{
    const Sequence *sequence = sequence_find(pool, model);
    const Formulation *f = formulate(pool, model_assemble(pool, model, sequence), sequence, solve, recovery);
    formulation_validate(pool, f, NULL);
    TapeEngine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (TapeEngine){.formulation = f,
                           .code = descriptor_new(pool, f->model, f->sequence),
                           .profile = pool_alloc(pool, sizeof *engine->profile),
                           .keeps = pool_alloc(pool, (size_t)(f->sequence->subsets + 1) * sizeof(bool)),
                           .member = pool_alloc(pool, (size_t)(f->sequence->subsets + 1) * sizeof(int)),
                           .piece = numbers(pool, f->model->coordinates),
                           .initial = numbers(pool, f->plan->states + f->model->fast_states)};
    engine->code.hash = f->hash;
    for (int s = 0; s < f->sequence->subsets; ++s) {
        engine->keeps[s] = plan_keeps(f->plan, s);
        engine->follows = engine->follows || plan_follows(f->plan, s);
    }
    for (int i = 0; i < f->model->coordinates; ++i)
        engine->piece[i] = coordinate_piece(f, i);
    for (int i = 0; i < f->plan->states + f->model->fast_states; ++i)
        engine->initial[i] = state_number(pool, f, i).initial;
    engine->standard = numbers(pool, f->model->tunables);
    for (int i = 0; i < f->model->parameters; ++i)
        if (f->model->parameter[i].tunable)
            engine->standard[f->model->parameter[i].index] = f->model->parameter[i].value;
    record_classes(pool, engine);
    record_whole(pool, engine);
    if (f->model->tuning)
        tape_record_derived(pool, engine);
    make_tables(pool, engine);
    make_scratch(pool, engine);
    lay_out(engine);
    return engine;
}
