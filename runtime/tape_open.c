/* SPDX-License-Identifier: MIT
 * Opening the engine `tape` for a model: record its formulas, lay out instances, describe them. */
#include "tape_engine.h"

#include "../templates/bounds.c.in"

static double *numbers(Pool *pool, int count)
{
    return pool_alloc(pool, (size_t)(count + 1) * sizeof(double));
}

/* ---- tapes ------------------------------------------------------------------------------------------------- */

static void record_classes(Pool *pool, TapeEngine *engine)
{
    const Formulation *f = engine->formulation;
    const int arrays = CLASS_KNOWN + 2 * f->known_most;
    const char **array = pool_alloc(pool, (size_t)arrays * sizeof *array);
#define NAME(name) array[CLASS_##name] = #name;
    CLASS_ARRAYS(NAME)
#undef NAME
    for (int i = 0; i < f->known_most; ++i) {
        array[CLASS_KNOWN + i] = pool_print(pool, "m%d", i);
        array[CLASS_KNOWN + f->known_most + i] = pool_print(pool, "w%d", i);
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
                                       .enough = GIC_ENOUGH(far)};
        for (int i = 0; i < f->sequence->class[c].members; ++i)
            engine->member[f->sequence->class[c].member[i]] = i;
    }
}

static void record_whole(Pool *pool, TapeEngine *engine)
{
    static const char *const array[] = {
#define NAME(name) #name,
        WHOLE_ARRAYS(NAME)
#undef NAME
    };
    const Formulation *f = engine->formulation;
    engine->dynamics = tape_record(pool, f->dynamics, array, WHOLE_COUNT);
    engine->outputs = tape_record(pool, f->outputs, array, WHOLE_COUNT);
    engine->poses = tape_record(pool, f->poses, array, WHOLE_COUNT);
    engine->inverse = tape_record(pool, f->inverse, array, WHOLE_COUNT);
    engine->energy = tape_record(pool, f->energy, array, WHOLE_COUNT);
    if (f->wrenches && f->plan->multipliers) {
        engine->wrenches = tape_record(pool, f->wrenches, array, WHOLE_COUNT);
        engine->reacts = reactions_needed(pool, f->model, f->sequence);
    }
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

static void make_scratch(Pool *pool, TapeEngine *engine)
{
    const Formulation *f = engine->formulation;
    const Tape *const whole[] = {engine->dynamics, engine->outputs, engine->poses, engine->inverse, engine->energy};
    int slots = engine->wrenches ? engine->wrenches->slots : 0, bodies = 0, unknowns = f->plan->unknowns;
    for (size_t i = 0; i < sizeof whole / sizeof *whole; ++i)
        slots = GIC_MAX(slots, whole[i]->slots);
    for (int c = 0; c < f->sequence->classes; ++c) {
        const TapeClass *class = &engine->class[c];
        const Tape *const part[] = {class->predict, class->chord, class->solve, class->residual, class->react};
        for (size_t i = 0; i < sizeof part / sizeof *part; ++i)
            slots = GIC_MAX(slots, part[i]->slots);
        bodies = GIC_MAX(bodies, class->layout->bodies);
    }
    engine->frame = numbers(pool, slots);
    engine->q = numbers(pool, 7 * bodies);
    engine->first = numbers(pool, f->model->coordinates);
    engine->result = numbers(pool, f->plan->states);
    engine->out = numbers(pool, f->model->output_components);
    engine->acc = numbers(pool, unknowns);
    engine->unit = numbers(pool, unknowns);
    engine->tau0 = numbers(pool, unknowns);
    engine->tau = numbers(pool, unknowns);
    engine->mass = numbers(pool, unknowns * unknowns);
    engine->links = (TapeLinks){.array = pool_alloc(pool, (size_t)(CLASS_KNOWN + 2 * f->known_most) * sizeof(double *)),
                                .x = numbers(pool, f->dependence_most),
                                .rate = numbers(pool, f->dependence_most),
                                .change = numbers(pool, f->dependence_most)};
}

/* ---- instance and descriptor ----------------------------------------------------------------------------------- */

/* The place of `count` more numbers. */
static size_t put_array(gic_model *code, int count)
{
    size_t offset = code->size;
    code->size += (size_t)count * sizeof(double);
    return offset;
}

static void lay_out(TapeEngine *engine)
{
    gic_model *code = &engine->code;
    const Plan *plan = engine->formulation->plan;
    const int states = code->slow_count;
    code->size = sizeof(TapeInstance);
    code->state_offset = put_array(code, states);
    code->input_offset = put_array(code, code->input_count);
    code->output_offset = put_array(code, code->output_count);
    code->parameter_offset = put_array(code, code->parameter_count);
    code->port_offset = put_array(code, code->port_count);
    code->discrete_offset = put_array(code, 1);
    code->rate_offset = put_array(code, states);
    code->history_offset = put_array(code, 2 * states);
    code->scratch_offset = put_array(code, 4 * states + code->input_count);
    engine->x_offset = put_array(code, code->coordinate_count);
    engine->xd_offset = put_array(code, code->coordinate_count);
    engine->start_offset[0] = put_array(code, plan->start_size);
    engine->start_offset[1] = put_array(code, plan->start_size);
    engine->motion_offset = put_array(code, plan->motion_size);
    engine->inertia_offset = put_array(code, plan->inertia_size);
    engine->multiplier_offset = put_array(code, plan->multipliers);
}

static gic_signal *signals(Pool *pool, int count)
{
    return pool_alloc(pool, (size_t)(count + 1) * sizeof(gic_signal));
}

static void describe_signals(Pool *pool, TapeEngine *engine)
{
    static const gic_signal discrete[] = {{"dependent_euler_parameter", "1"}};
    static const char *const port_part[6] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
    gic_model *code = &engine->code;
    const Model *model = engine->formulation->model;
    gic_signal *state = signals(pool, code->slow_count), *input = signals(pool, model->inputs);
    gic_signal *parameter = signals(pool, model->tunables), *port = signals(pool, 6 * model->ports);
    gic_signal *output = signals(pool, model->output_components), *coordinate = signals(pool, model->coordinates);
    engine->initial = numbers(pool, code->slow_count);
    for (int i = 0; i < code->slow_count; ++i) {
        const StateNumber number = state_number(pool, engine->formulation, i);
        state[i] = (gic_signal){number.name, number.unit};
        engine->initial[i] = number.initial;
    }
    for (int i = 0; i < model->inputs; ++i)
        input[i] = (gic_signal){model->input[i].name, model->input[i].unit};
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            parameter[model->parameter[i].index] = (gic_signal){model->parameter[i].name, model->parameter[i].unit};
    for (int i = 0; i < 6 * model->ports; ++i)
        port[i] =
            (gic_signal){pool_print(pool, "%s.%s", model->port[i / 6].name, port_part[i % 6]), i % 6 < 3 ? "N" : "N m"};
    for (int i = 0, index = 0; i < model->outputs; ++i)
        for (int c = 0; c < model->output[i].count; ++c)
            output[index++] = (gic_signal){model->output[i].component[c], model->output[i].unit[c]};
    for (int i = 0; i < model->coordinates; ++i)
        coordinate[i] =
            (gic_signal){model->coordinate[i].name, model->coordinate[i].type == COORDINATE_ANGLE ? "rad" : "m"};
    code->state = state;
    code->discrete = discrete;
    code->input = input;
    code->parameter = parameter;
    code->port = port;
    code->output = output;
    code->coordinate = coordinate;
}

static void describe_coordinates(Pool *pool, TapeEngine *engine)
{
    gic_model *code = &engine->code;
    const Model *model = engine->formulation->model;
    const int count = model->coordinates;
    double *design = numbers(pool, count), *low = numbers(pool, count), *high = numbers(pool, count);
    int32_t *state = pool_alloc(pool, (size_t)(count + 1) * sizeof *state);
    int32_t *input = pool_alloc(pool, (size_t)(count + 1) * sizeof *input);
    engine->piece = numbers(pool, count);
    for (int i = 0; i < count; ++i) {
        const Coordinate *c = &model->coordinate[i];
        design[i] = c->design;
        low[i] = c->range[0];
        high[i] = c->range[1];
        state[i] = engine->formulation->plan->coordinate_state[i];
        input[i] = c->driven ? c->input : -1;
        engine->piece[i] = coordinate_piece(engine->formulation, i);
    }
    code->coordinate_design = design;
    code->coordinate_low = low;
    code->coordinate_high = high;
    code->coordinate_state = state;
    code->coordinate_input = input;
}

static void describe_names(Pool *pool, TapeEngine *engine)
{
    gic_model *code = &engine->code;
    const Model *model = engine->formulation->model;
    const Sequence *sequence = engine->formulation->sequence;
    const char **subset = pool_alloc(pool, (size_t)(sequence->subsets + 1) * sizeof *subset);
    const char **body = pool_alloc(pool, (size_t)model->bodies * sizeof *body);
    for (int s = 0; s < sequence->subsets; ++s)
        subset[s] = subset_title(pool, model, &sequence->subset[s]);
    for (int b = 0; b < model->bodies; ++b)
        body[b] = model->body[b].name;
    code->subset_name = subset;
    code->body_name = body;
}

TapeEngine *tape_open(Pool *pool, const Model *model, Solve solve)
{
    const Sequence *sequence = sequence_find(pool, model);
    const Formulation *f = formulate(pool, model_assemble(pool, model, sequence), sequence, solve);
    TapeEngine *engine = pool_alloc(pool, sizeof *engine);
    model = f->model;
    *engine = (TapeEngine){.formulation = f,
                           .member = pool_alloc(pool, (size_t)(f->sequence->subsets + 1) * sizeof(int)),
                           .code = {.abi_version = GIC_ABI_VERSION,
                                    .real_size = sizeof(gic_real),
                                    .name = model->name,
                                    .description = model->description,
                                    .hash = f->hash,
                                    .generator = "gicgen " GICGEN_VERSION,
                                    .free_base = model->free_base,
                                    .slow_count = f->plan->states,
                                    .discrete_count = model->free_base,
                                    .input_count = model->inputs,
                                    .parameter_count = model->tunables,
                                    .output_count = model->output_components,
                                    .port_count = 6 * model->ports,
                                    .coordinate_count = model->coordinates,
                                    .subset_count = f->sequence->subsets,
                                    .body_count = model->bodies,
                                    .wheel_count = model->wheels}};
    record_classes(pool, engine);
    record_whole(pool, engine);
    make_tables(pool, engine);
    make_scratch(pool, engine);
    lay_out(engine);
    describe_signals(pool, engine);
    describe_coordinates(pool, engine);
    describe_names(pool, engine);
    return engine;
}
