/* SPDX-License-Identifier: MIT
 * The functions of gic_model for interpreted engines. State: FORMAT.md section 10. */
#include "base/vec3.h"
#include "compare/interpreted.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* ---- for the engines ------------------------------------------------------------------------------------- */

static const Interpreted *context_of(const Instance *self)
{
    return self->context;
}

static double *array_of(const Instance *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

double *instance_own(const Instance *self)
{
    return array_of(self, context_of(self)->own_offset);
}

static int32_t *dependent_of(const Instance *self)
{
    return (int32_t *)(void *)((char *)self + context_of(self)->code.discrete_offset);
}

/* Discrete states of the powertrain. */
static int32_t *gear_of(const Instance *self)
{
    return dependent_of(self) + context_of(self)->code.free_base;
}

int interpreted_orient(const Instance *self, const double *state, double e[4])
{
    static const double level[4] = {1, 0, 0, 0};
    int32_t dependent = *dependent_of(self);
    int64_t switches = 0;
    if (context_of(self)->code.free_base)
        return gic_orientation(state + 3, &dependent, &switches, e);
    memcpy(e, level, sizeof level);
    return GIC_OK;
}

void interpreted_gather(const Interpreted *context, const double *state)
{
    World *world = context->world;
    const int half = context->standard_count / 2; /* from a coordinate to its rate, past 7 and 6 numbers of the base */
    for (int c = 0; c < world->model->coordinates; ++c) {
        const int at = context->code.coordinate_state[c];
        const double *input = world->input + world->model->coordinate[c].input;
        world->x[c] = at < 0 ? input[0] : state[at];
        world->xd[c] = at < 0 ? input[1] : state[at + half];
        if (at < 0)
            world->xdd[c] = input[2];
    }
}

void interpreted_place_base(const Interpreted *context, const double *state, const double e[4])
{
    const int twist = context->standard_count / 2 + 1;
    if (context->code.free_base)
        world_set_base(context->world, state, e, state + twist, state + twist + 3);
}

/* Rates of r, e, v and omega. */
static void base_rates(const Interpreted *context, const double *state, const double e[4], double *rate)
{
    const World *world = context->world;
    const int twist = context->standard_count / 2 + 1;
    const double *A = world->A[BODY_BASE], *omega = world->omega[BODY_BASE];
    double arm[3], swing[3], back[3], turn[3];
    copy3(state + twist, rate);
    euler_rate(e, omega, rate + 3);
    for (int i = 3; i < 7; ++i)
        rate[i] *= 0.5;
    apply3(A, world->model->body[BODY_BASE].com, arm);
    cross3(omega, arm, turn);
    cross3(omega, turn, swing);
    cross3(world->alpha[BODY_BASE], arm, turn);
    add3(swing, turn, back);
    sub3(world->qdd[BODY_BASE], back, rate + twist);
    apply3_transposed(A, world->alpha[BODY_BASE], rate + twist + 3);
}

void interpreted_standard(const Interpreted *context, double *standard, double *rate)
{
    const World *world = context->world;
    const int half = context->standard_count / 2;
    for (int c = 0; c < world->model->coordinates; ++c) {
        const int at = context->code.coordinate_state[c];
        if (at < 0)
            continue;
        standard[at] = world->x[c];
        standard[at + half] = rate[at] = world->xd[c];
        rate[at + half] = world->xdd[c];
    }
    if (!context->code.free_base)
        return;
    const double *A = world->A[BODY_BASE], *omega = world->omega[BODY_BASE], *q = world->q[BODY_BASE];
    double arm[3], turn[3];
    apply3(A, world->model->body[BODY_BASE].com, arm);
    sub3(q, arm, standard);
    memcpy(standard + 3, q + 3, 4 * sizeof *q);
    cross3(omega, arm, turn);
    sub3(world->qd[BODY_BASE], turn, standard + half + 1);
    apply3_transposed(A, omega, standard + half + 4);
    base_rates(context, standard, q + 3, rate);
}

void interpreted_name_lost(const Interpreted *context, Instance *self, int status)
{
    if (status != GIC_ERROR_MASS)
        return;
    self->head.subset = context->world->lost;
    self->head.grown = -1;
}

int interpreted_accelerate(const Interpreted *context, Instance *self, const double *state, double *rate)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    const double begun = profile_clock(profile);
    int status = world_forces(world);
    if (status != GIC_OK)
        return status;
    contact_pieces_note(context->pieces, false);
    world_spread(world);
    for (int i = 0; i < world->ties; ++i)
        world_gamma(world, i);
    const double ready = profile_clock(profile);
    status = world_accelerate(world);
    interpreted_name_lost(context, self, status);
    const double solved = profile_clock(profile);
    if (status != GIC_OK)
        return status;
    const int half = context->standard_count / 2;
    for (int c = 0; c < world->model->coordinates; ++c) {
        const int at = context->code.coordinate_state[c];
        if (at >= 0) {
            rate[at] = state[at + half];
            rate[at + half] = world->xdd[c];
        }
    }
    if (context->code.free_base)
        base_rates(context, state, world->q[BODY_BASE] + 3, rate);
    const double ended = profile_clock(profile);
    profile->acceleration += ended - begun;
    profile->acceleration_solver += solved - ready;
    profile->acceleration_functions += ready - begun + (ended - solved);
    ++profile->evaluations;
    return GIC_OK;
}

/* ---- descriptor functions -------------------------------------------------------------------------------- */

static int finite(const Instance *self, size_t offset, int32_t count)
{
    return gic_finite(array_of(self, offset), count);
}

static void load(const Instance *self, double time)
{
    World *world = context_of(self)->world;
    const gic_model *code = &context_of(self)->code;
    world->time = time;
    world->input = array_of(self, code->input_offset);
    world->parameter = array_of(self, code->parameter_offset);
    world->port = array_of(self, code->port_offset);
    world->road = self->head.road;
    world->lane = self->head.lane;
    world->gear = gear_of(self);
}

/* True if the transmission has these gears. */
static bool gears_exist(const Instance *self)
{
    const Powertrain *powertrain = context_of(self)->world->model->powertrain;
    const int32_t *gear = gear_of(self);
    for (int i = 0; i < POWERTRAIN_DISCRETE && powertrain; ++i)
        if (gear[i] < -powertrain->reverse || gear[i] > powertrain->forward)
            return false;
    return true;
}

/* The parameters that set-up was given: geometric ones must stay so. */
static double *setup_parameter(const Instance *self)
{
    return array_of(self, context_of(self)->setup_offset);
}

/* The World gets this instance's numbers, if it has another's. */
static int match_geometry(Instance *self)
{
    const Interpreted *context = self->context;
    const double *parameter = array_of(self, context->code.parameter_offset), *was = setup_parameter(self);
    if (!context->geometry)
        return GIC_OK;
    for (int i = 0; i < context->code.parameter_count; ++i)
        if (context->code.parameter_geometric[i] && parameter[i] != was[i])
            return GIC_ERROR_TUNED;
    return geometry_adopted(context, parameter) ? GIC_OK : geometry_adopt(context, self, parameter);
}

int interpreted_load(Instance *self, double time)
{
    const gic_model *code = &context_of(self)->code;
    self->head.subset = -1;
    if (!gic_finite(&time, 1) || !finite(self, code->input_offset, code->input_count) ||
        !finite(self, code->parameter_offset, code->parameter_count) ||
        !finite(self, code->port_offset, code->port_count) || !gears_exist(self))
        return GIC_ERROR_INPUT;
    load(self, time);
    return match_geometry(self);
}

/* What an evaluation found, against constraints and equations of motion. Bounds of the residuals are these engines'
 * own; generated code checks with those of templates/bounds.c.in. */
static int check(Instance *self)
{
    const double pose_residual = 1e-8, balance_residual = 1e-8;
    const int32_t every = 200;
    gic_self_test found;
    world_self_test(context_of(self)->world, &found);
    self->head.residual = fmax(self->head.residual, found.constraint);
    self->head.unchecked = 0;
    if (!(found.constraint <= pose_residual && found.balance <= balance_residual))
        return GIC_ERROR_RESIDUAL;
    self->head.unchecked = every;
    return GIC_OK;
}

static int any_rhs(void *instance, double time, const double *state, double *rate)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const gic_model *code = &context->code;
    const int32_t count = code->slow_count + code->fast_count;
    double result[count + 1];
    self->head.subset = -1;
    if (!gic_bounded(state, count))
        return self->head.status = GIC_ERROR_INPUT;
    int status = interpreted_load(self, time);
    if (status == GIC_ERROR_INPUT)
        return self->head.status = status;
    ++self->head.rhs_count;
    context->world->fast = state + code->slow_count;
    if (status == GIC_OK)
        status = context->evaluate(context, self, state, result);
    memcpy(result + code->slow_count, context->world->fast_rate, sizeof *result * (size_t)code->fast_count);
    if (status == GIC_OK && !gic_finite(result, count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK && --self->head.unchecked < 0)
        status = check(self);
    if (status == GIC_OK)
        memcpy(rate, result, sizeof *rate * (size_t)count);
    return self->head.status = status;
}

int interpreted_refresh(Instance *self)
{
    const gic_model *code = &context_of(self)->code;
    const double time = gic_time(self);
    if (self->head.input_function)
        self->head.input_function(self->head.user, self->head.lane, time, array_of(self, code->input_offset));
    self->head.unchecked = 0; /* what someone looks at is checked */
    return any_rhs(self, time, array_of(self, code->state_offset), array_of(self, code->rate_offset));
}

static int any_outputs(void *instance)
{
    Instance *self = instance;
    const gic_model *code = &context_of(self)->code;
    double out[code->output_count + 1];
    int status = interpreted_refresh(self);
    if (status != GIC_OK)
        return status;
    world_outputs(context_of(self)->world, out);
    if (!gic_finite(out, code->output_count))
        return self->head.status = GIC_ERROR_RESULT;
    memcpy(array_of(self, code->output_offset), out, sizeof *out * (size_t)code->output_count);
    return GIC_OK;
}

static int any_poses(void *instance, double *pose)
{
    Instance *self = instance;
    const int status = interpreted_refresh(self);
    if (status == GIC_OK)
        world_poses(context_of(self)->world, pose);
    return status;
}

static int any_self_test(void *instance, gic_self_test *result)
{
    Instance *self = instance;
    *result = (gic_self_test){.smallest_pivot = 1};
    const int status = interpreted_refresh(self);
    if (status == GIC_OK || status == GIC_ERROR_RESIDUAL)
        world_self_test(context_of(self)->world, result);
    return status;
}

static int any_settle(void *instance, double *state)
{
    Instance *self = instance;
    const gic_model *code = &context_of(self)->code;
    double e[4];
    if (!gic_bounded(state, code->slow_count + code->fast_count))
        return GIC_ERROR_INPUT;
    if (!code->free_base)
        return GIC_OK;
    const int status = gic_orientation(state + 3, dependent_of(self), &self->head.switch_count, e);
    if (status == GIC_OK)
        memcpy(state + 3, e, sizeof e);
    return status;
}

/* Gears at the present state. */
static int any_shift(void *instance)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const Powertrain *powertrain = context->world->model->powertrain;
    double *state = array_of(self, context->code.state_offset), *fast = state + context->code.slow_count;
    int status = interpreted_load(self, gic_time(self));
    if (status == GIC_OK && powertrain_watches_coordinates(powertrain))
        status = context->place(context, self, state);
    if (status != GIC_OK || !world_shift(context->world, fast, gear_of(self)))
        return 0;
    fast[powertrain->fast + POWERTRAIN_AGE] = 0;
    return 1;
}

/* Everything stands still, but an engine that idles. */
static void set_powertrain(const Instance *self, const Powertrain *powertrain)
{
    const gic_model *code = &context_of(self)->code;
    double *fast = array_of(self, code->state_offset) + code->slow_count + powertrain->fast;
    fast[POWERTRAIN_SPEED] = powertrain->idle;
    fast[POWERTRAIN_AGE] = POWERTRAIN_FIRST_AGE;
    for (int i = 0; i < POWERTRAIN_DISCRETE; ++i)
        gear_of(self)[i] = powertrain->start_gear;
}

static void set_states(const Instance *self, const Model *model)
{
    const gic_model *code = &context_of(self)->code;
    double *fast = array_of(self, code->state_offset) + code->slow_count;
    for (int i = 0; i < model->states; ++i)
        fast[model->state[i].fast] = model->state[i].initial;
}

/* State and inputs at their initial values. */
static void set_initial(Instance *self)
{
    const Interpreted *context = self->context;
    const Model *model = context->world->model;
    const Body *base = &model->drawn[BODY_BASE];
    double *state = array_of(self, context->code.state_offset), *input = array_of(self, context->code.input_offset);
    if (context->code.free_base) {
        memcpy(state, base->position, sizeof base->position);
        memcpy(state + 3, base->euler, sizeof base->euler);
    }
    for (int i = 0; i < model->inputs; ++i)
        input[i] = model->input[i].initial;
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *w = &model->coordinate[c];
        *(w->driven ? &input[w->input] : &state[context->code.coordinate_state[c]]) = w->initial;
    }
    if (model->powertrain)
        set_powertrain(self, model->powertrain);
    set_states(self, model);
}

static int any_setup_with(void *instance, const double *parameter)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const gic_model *code = &context->code;
    const size_t size = sizeof *parameter * (size_t)code->parameter_count;
    double wanted[code->parameter_count + 1];
    memcpy(wanted, parameter, size); /* they may be the instance's own */
    memset(self, 0, code->size);
    self->context = context;
    self->head.subset = self->head.condition = self->head.hold = self->head.grown = -1;
    memcpy(array_of(self, code->parameter_offset), wanted, size);
    memcpy(setup_parameter(self), wanted, size);
    if (!gic_finite(wanted, code->parameter_count))
        return self->head.status = GIC_ERROR_INPUT;
    int status = match_geometry(self);
    set_initial(self);
    load(self, 0);
    if (status == GIC_OK)
        status = context->start(context, self);
    return self->head.status = status;
}

static int any_setup(void *instance)
{
    const Model *model = context_of(instance)->world->model;
    double value[model->tunables + 1];
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            value[model->parameter[i].index] = model->parameter[i].value;
    return any_setup_with(instance, value);
}

Interpreted *interpreted_new(Pool *pool, const Model *model, const Sequence *sequence, size_t own)
{
    Interpreted *context = pool_alloc(pool, sizeof *context);
    context->world = world_new(pool, model, sequence);
    context->profile = pool_alloc(pool, sizeof *context->profile);
    context->code = descriptor_new(pool, model, sequence);
    context->standard_count = context->code.slow_count;
    context->code.setup = any_setup;
    context->code.setup_with = any_setup_with;
    context->code.rhs = any_rhs;
    context->code.settle = any_settle;
    context->code.outputs = any_outputs;
    context->code.poses = any_poses;
    context->code.self_test = any_self_test;
    if (model->fast_states) {
        context->code.link_count = interpreted_link_count(model);
        context->code.link_offset = descriptor_place(&context->code, 5 * (size_t)context->code.link_count);
        context->code.link = interpreted_link;
        context->code.fast = interpreted_fast;
        context->code.roll = interpreted_roll;
    }
    if (model->powertrain)
        context->code.shift = any_shift;
    context->geometry = geometry_new(pool, model);
    context->setup_offset = descriptor_place(&context->code, (size_t)model->tunables + own);
    context->own_offset = context->setup_offset + sizeof(double) * (size_t)model->tunables;
    context->pieces = contact_pieces_new(pool, context->world);
    return context;
}

Engine *interpreted_engine(Pool *pool, const char *name, const Interpreted *context)
{
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = name,
                       .code = &context->code,
                       .context = context,
                       .profile = context->profile,
                       .pieces = context->world->touches ? context->pieces : NULL,
                       .standard = context->code.state,
                       .standard_count = context->standard_count + context->code.fast_count};
    return engine;
}
