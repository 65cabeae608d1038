/* SPDX-License-Identifier: MIT
 * The descriptor of an interpreted model: what emission prints as tables, made at run time. */
#include "base/version.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "vehicle/vehicle.h"

#include <string.h>

static gic_signal *signals(Pool *pool, int count)
{
    return pool_alloc(pool, ((size_t)count + 1) * sizeof(gic_signal));
}

const gic_signal *descriptor_fast_states(Pool *pool, const Model *model)
{
    static const gic_signal part[FAST_MOST] = {[FAST_SPIN] = {"spin", "rad/s"},
                                               [FAST_SLIP_X] = {"slip_x", "1"},
                                               [FAST_SLIP_Y] = {"slip_y", "1"},
                                               [FAST_BRAKE] = {"brake", "1"}};
    gic_signal *signal = signals(pool, model->fast_states), *next = signal;
    for (int i = 0; i < model->wheels; ++i)
        for (int k = 0; k < wheel_fast_states(&model->wheel[i]); ++k)
            *next++ = (gic_signal){pool_print(pool, "%s.%s", model->wheel[i].name, part[k].name), part[k].unit};
    const int own = model->states - model_held(model);
    for (int i = 0; i < own; ++i)
        *next++ = (gic_signal){model->state[i].name, model->state[i].unit};
    for (int i = 0; model->powertrain && i < POWERTRAIN_FAST; ++i)
        *next++ = (gic_signal){powertrain_fast_name[i], i == POWERTRAIN_SPEED ? "rad/s" : "s"};
    for (int i = own; i < model->states; ++i)
        *next++ = (gic_signal){model->state[i].name, model->state[i].unit};
    return signal;
}

/* Names and units of the state: FORMAT.md section 10. */
static const gic_signal *state_signals(Pool *pool, const Model *model, int states)
{
    static const gic_signal pose[7] = {{"r.x", "m"}, {"r.y", "m"}, {"r.z", "m"}, {"e0", "1"},
                                       {"e1", "1"},  {"e2", "1"},  {"e3", "1"}};
    static const gic_signal twist[6] = {{"v.x", "m/s"},       {"v.y", "m/s"},       {"v.z", "m/s"},
                                        {"omega.x", "rad/s"}, {"omega.y", "rad/s"}, {"omega.z", "rad/s"}};
    gic_signal *signal = signals(pool, states), *next = signal;
    for (int part = 0; part < 2; ++part) {
        const gic_signal *base = part ? twist : pose;
        for (int i = 0; model->free_base && i < (part ? 6 : 7); ++i)
            *next++ = base[i];
        for (int c = 0; c < model->coordinates; ++c) {
            const Coordinate *w = &model->coordinate[c];
            const bool angle = w->type == COORDINATE_ANGLE;
            if (w->driven)
                continue;
            *next++ = part ? (gic_signal){pool_print(pool, "%s.rate", w->name), angle ? "rad/s" : "m/s"}
                           : (gic_signal){w->name, angle ? "rad" : "m"};
        }
    }
    memcpy(next, descriptor_fast_states(pool, model), sizeof *next * (size_t)model->fast_states);
    return signal;
}

static const gic_signal *port_signals(Pool *pool, const Model *model)
{
    static const char *const part[6] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
    gic_signal *signal = signals(pool, 6 * model->ports);
    for (int i = 0; i < 6 * model->ports; ++i)
        signal[i] =
            (gic_signal){pool_print(pool, "%s.%s", model->port[i / 6].name, part[i % 6]), i % 6 < 3 ? "N" : "N m"};
    return signal;
}

static void set_signals(Pool *pool, const Model *model, gic_model *code)
{
    gic_signal *discrete = signals(pool, 1 + POWERTRAIN_DISCRETE);
    discrete[0] = (gic_signal){"dependent_euler_parameter", "1"};
    for (int i = 0; model->powertrain && i < POWERTRAIN_DISCRETE; ++i)
        discrete[model->free_base + i] = (gic_signal){powertrain_discrete_name[i], "1"};
    gic_signal *input = signals(pool, model->inputs), *parameter = signals(pool, model->tunables);
    gic_signal *output = signals(pool, model->output_components), *coordinate = signals(pool, model->coordinates);
    for (int i = 0; i < model->inputs; ++i)
        input[i] = (gic_signal){model->input[i].name, model->input[i].unit};
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            parameter[model->parameter[i].index] = (gic_signal){model->parameter[i].name, model->parameter[i].unit};
    for (int i = 0, at = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            output[at++] = (gic_signal){model->output[i].component[k], model->output[i].unit[k]};
    for (int i = 0; i < model->coordinates; ++i)
        coordinate[i] =
            (gic_signal){model->coordinate[i].name, model->coordinate[i].type == COORDINATE_ANGLE ? "rad" : "m"};
    code->state = state_signals(pool, model, code->slow_count + code->fast_count);
    code->discrete = discrete;
    code->input = input;
    code->parameter = parameter;
    code->output = output;
    code->port = port_signals(pool, model);
    code->coordinate = coordinate;
}

static gic_rule rule_of(const gic_model *code, const Model *model, const ControlRule *rule)
{
    const int32_t first = code->slow_count;
    return (gic_rule){.state = first + model->state[rule->state].fast,
                      .output = rule_output(model, rule),
                      .waiting = rule->waiting,
                      .effects = rule->effects < 0 ? -1 : first + model->state[rule->effects].fast,
                      .late = rule->late,
                      .quantum = rule->quantum};
}

const gic_contacts *descriptor_contacts(Pool *pool, const Model *model, gic_model *code, DescriptorPress *press)
{
    const char **name = pool_alloc(pool, (size_t)code->contact_count * sizeof *name);
    gic_contacts *contacts = pool_alloc(pool, sizeof *contacts);
    ContactSite site;
    for (int i = 0; i < code->contact_count && model_contact(model, i, &site); ++i)
        name[i] = contact_text(pool, &site);
    *contacts = (gic_contacts){name, descriptor_place(code, 2 * (size_t)code->contact_count), press};
    return contacts;
}

void descriptor_controllers(Pool *pool, const Model *model, gic_model *code)
{
    gic_controller *controller = pool_alloc(pool, ((size_t)model->controllers + 1) * sizeof *controller);
    for (int i = 0; i < model->controllers; ++i) {
        const Controller *from = &model->controller[i];
        gic_rule *rule = pool_alloc(pool, (size_t)from->rules * sizeof *rule);
        for (int k = 0; k < from->rules; ++k)
            rule[k] = rule_of(code, model, &from->rule[k]);
        controller[i] = (gic_controller){from->name,   from->period,
                                         from->offset, code->slow_count + model->state[from->samples].fast,
                                         from->rules,  rule};
    }
    code->controller_count = model->controllers;
    code->controller = controller;
}

static void set_coordinates(Pool *pool, const Model *model, gic_model *code)
{
    const size_t count = (size_t)model->coordinates + 1;
    double *design = pool_alloc(pool, count * sizeof *design), *low = pool_alloc(pool, count * sizeof *low);
    double *high = pool_alloc(pool, count * sizeof *high);
    int32_t *state = pool_alloc(pool, count * sizeof *state), *input = pool_alloc(pool, count * sizeof *input);
    int32_t next = model->free_base ? 7 : 0;
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *w = &model->coordinate[c];
        design[c] = w->design;
        low[c] = w->range[0];
        high[c] = w->range[1];
        state[c] = w->driven ? -1 : next++;
        input[c] = w->driven ? w->input : -1;
    }
    code->coordinate_design = design;
    code->coordinate_low = low;
    code->coordinate_high = high;
    code->coordinate_state = state;
    code->coordinate_input = input;
}

static void set_names(Pool *pool, const Model *model, const Sequence *sequence, gic_model *code)
{
    const char **subset = pool_alloc(pool, ((size_t)sequence->subsets + 1) * sizeof *subset);
    const char **body = pool_alloc(pool, (size_t)model->bodies * sizeof *body);
    for (int s = 0; s < sequence->subsets; ++s)
        subset[s] = subset_title(pool, model, &sequence->subset[s]);
    for (int b = 0; b < model->bodies; ++b)
        body[b] = model->body[b].name;
    const int conditions = model->tuning ? model->tuning->conditions : 0;
    const char **condition = pool_alloc(pool, ((size_t)conditions + 1) * sizeof *condition);
    int32_t *geometric = pool_alloc(pool, ((size_t)model->tunables + 1) * sizeof *geometric);
    for (int i = 0; i < conditions; ++i)
        condition[i] = model->tuning->condition[i].text;
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            geometric[model->parameter[i].index] = model->parameter[i].geometric;
    code->condition_count = conditions;
    code->condition_text = condition;
    code->parameter_geometric = geometric;
    code->subset_name = subset;
    code->body_name = body;
}

size_t descriptor_scratch(const gic_model *code, size_t states)
{
    const size_t inputs = (size_t)code->input_count;
    return GIC_SCRATCH(states, inputs) +
           (code->controller_count > 0 ? GIC_WHOLE(states, inputs, (size_t)code->output_count) : 0);
}

/* Arrays one after another. */
static void place_arrays(gic_model *code)
{
    const size_t states = (size_t)(code->slow_count + code->fast_count);
    const struct {
        size_t *offset, count;
    } array[] = {{&code->state_offset, states},
                 {&code->rate_offset, states},
                 {&code->history_offset, GIC_HISTORY(states, (size_t)code->fast_count)},
                 {&code->scratch_offset, descriptor_scratch(code, states)},
                 {&code->discrete_offset, 1 + POWERTRAIN_DISCRETE},
                 {&code->input_offset, (size_t)code->input_count},
                 {&code->parameter_offset, (size_t)code->parameter_count},
                 {&code->output_offset, (size_t)code->output_count},
                 {&code->port_offset, (size_t)code->port_count}};
    code->size = sizeof(Instance);
    for (size_t i = 0; i < sizeof array / sizeof *array; ++i)
        *array[i].offset = descriptor_place(code, array[i].count);
}

size_t descriptor_place(gic_model *code, size_t count)
{
    size_t offset = code->size;
    code->size += count * sizeof(double);
    return offset;
}

gic_model descriptor_new(Pool *pool, const Model *model, const Sequence *sequence)
{
    gic_model code = {.abi_version = GIC_ABI_VERSION,
                      .real_size = sizeof(gic_real),
                      .name = model->name,
                      .description = model->description,
                      .hash = "",
                      .generator = "gicrun " GICGEN_VERSION,
                      .free_base = model->free_base,
                      .slow_count = model->free_base ? 13 : 0,
                      .fast_count = model->fast_states,
                      .discrete_count = model_discretes(model),
                      .input_count = model->inputs,
                      .parameter_count = model->tunables,
                      .output_count = model->output_components,
                      .port_count = 6 * model->ports,
                      .coordinate_count = model->coordinates,
                      .subset_count = sequence->subsets,
                      .body_count = model->bodies,
                      .wheel_count = model->wheels};
    for (int c = 0; c < model->coordinates; ++c)
        code.slow_count += model->coordinate[c].driven ? 0 : 2;
    set_signals(pool, model, &code);
    descriptor_controllers(pool, model, &code);
    set_coordinates(pool, model, &code);
    set_names(pool, model, sequence, &code);
    place_arrays(&code);
    return code;
}
