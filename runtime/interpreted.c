/* SPDX-License-Identifier: MIT
 * The functions of gic_model for interpreted engines. State: FORMAT.md section 10. */
#include "interpreted.h"

#include "small.h"

#include <string.h>
#include <time.h>

double profile_clock(const EngineProfile *profile)
{
    struct timespec now;
    if (!profile->on)
        return 0;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- for the engines ------------------------------------------------------------------------------------- */

static double *array_of(const Instance *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

double *instance_own(const Instance *self)
{
    return array_of(self, self->context->own_offset);
}

static int32_t *dependent_of(const Instance *self)
{
    return (int32_t *)(void *)((char *)self + self->context->code.discrete_offset);
}

int interpreted_orient(const Instance *self, const double *state, double e[4])
{
    static const double level[4] = {1, 0, 0, 0};
    int32_t dependent = *dependent_of(self);
    int64_t switches = 0;
    if (self->context->code.free_base)
        return gic_orientation(state + 3, &dependent, &switches, e);
    memcpy(e, level, sizeof level);
    return GIC_OK;
}

void interpreted_gather(const Interpreted *context, const double *state)
{
    World *world = context->world;
    const int half = context->code.slow_count / 2; /* from a coordinate to its rate, past 7 and 6 numbers of the base */
    for (int c = 0; c < world->model->coordinates; ++c) {
        const int at = context->coordinate_state[c];
        const double *input = world->input + world->model->coordinate[c].input;
        world->x[c] = at < 0 ? input[0] : state[at];
        world->xd[c] = at < 0 ? input[1] : state[at + half];
        if (at < 0)
            world->xdd[c] = input[2];
    }
}

void interpreted_place_base(const Interpreted *context, const double *state, const double e[4])
{
    const int twist = context->code.slow_count / 2 + 1;
    if (context->code.free_base)
        world_set_base(context->world, state, e, state + twist, state + twist + 3);
}

/* Rates of r, e, v and omega. */
static void base_rates(const Interpreted *context, const double *state, const double e[4], double *rate)
{
    const World *world = context->world;
    const int twist = context->code.slow_count / 2 + 1;
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

int interpreted_accelerate(const Interpreted *context, const double *state, const double e[4], double *rate)
{
    World *world = context->world;
    EngineProfile *profile = context->profile;
    const double begun = profile_clock(profile);
    int status = world_forces(world);
    if (status != GIC_OK)
        return status;
    world_spread(world);
    for (int i = 0; i < world->ties; ++i)
        world_gamma(world, i);
    const double ready = profile_clock(profile);
    status = world_accelerate(world);
    const double solved = profile_clock(profile);
    if (status != GIC_OK)
        return status;
    const int half = context->code.slow_count / 2;
    for (int c = 0; c < world->model->coordinates; ++c) {
        const int at = context->coordinate_state[c];
        if (at >= 0) {
            rate[at] = state[at + half];
            rate[at + half] = world->xdd[c];
        }
    }
    if (context->code.free_base)
        base_rates(context, state, e, rate);
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
    World *world = self->context->world;
    const gic_model *code = &self->context->code;
    world->time = time;
    world->input = array_of(self, code->input_offset);
    world->parameter = array_of(self, code->parameter_offset);
    world->port = array_of(self, code->port_offset);
    world->road = self->head.road;
    world->lane = self->head.lane;
}

/* Interpreted engines have the geometry of the file. */
static bool same_geometry(const Instance *self)
{
    const Model *model = self->context->world->model;
    const double *value = array_of(self, self->context->code.parameter_offset);
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].geometric && value[model->parameter[i].index] != model->parameter[i].value)
            return false;
    return true;
}

static int any_rhs(void *instance, double time, const double *state, double *rate)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const gic_model *code = &context->code;
    double result[code->slow_count + 1];
    self->head.subset = -1;
    if (!gic_finite(state, code->slow_count) || !gic_finite(&time, 1) ||
        !finite(self, code->input_offset, code->input_count) ||
        !finite(self, code->parameter_offset, code->parameter_count) ||
        !finite(self, code->port_offset, code->port_count))
        return self->head.status = GIC_ERROR_INPUT;
    if (!same_geometry(self))
        return self->head.status = GIC_ERROR_TUNED;
    ++self->head.rhs_count;
    load(self, time);
    int status = context->evaluate(context, self, state, result);
    if (status == GIC_OK && !gic_finite(result, code->slow_count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK)
        memcpy(rate, result, sizeof *rate * (size_t)code->slow_count);
    return self->head.status = status;
}

/* The World at the present state, with the inputs of the present time. */
static int refresh(Instance *self)
{
    const gic_model *code = &self->context->code;
    const double time = gic_time(self);
    if (self->head.input_function)
        self->head.input_function(self->head.user, self->head.lane, time, array_of(self, code->input_offset));
    return any_rhs(self, time, array_of(self, code->state_offset), array_of(self, code->rate_offset));
}

static int any_outputs(void *instance)
{
    Instance *self = instance;
    const gic_model *code = &self->context->code;
    double out[code->output_count + 1];
    int status = refresh(self);
    if (status != GIC_OK)
        return status;
    world_outputs(self->context->world, out);
    if (!gic_finite(out, code->output_count))
        return self->head.status = GIC_ERROR_RESULT;
    memcpy(array_of(self, code->output_offset), out, sizeof *out * (size_t)code->output_count);
    return GIC_OK;
}

static int any_poses(void *instance, double *pose)
{
    Instance *self = instance;
    const int status = refresh(self);
    if (status == GIC_OK)
        world_poses(self->context->world, pose);
    return status;
}

static int any_self_test(void *instance, gic_self_test *result)
{
    Instance *self = instance;
    *result = (gic_self_test){.smallest_pivot = 1};
    const int status = refresh(self);
    if (status == GIC_OK)
        world_self_test(self->context->world, result);
    return status;
}

static int any_settle(void *instance, double *state)
{
    Instance *self = instance;
    double e[4];
    if (!self->context->code.free_base)
        return GIC_OK;
    const int status = gic_orientation(state + 3, dependent_of(self), &self->head.switch_count, e);
    if (status == GIC_OK)
        memcpy(state + 3, e, sizeof e);
    return status;
}

static int any_setup_with(void *instance, const double *parameter)
{
    Instance *self = instance;
    const Interpreted *context = self->context;
    const gic_model *code = &context->code;
    const Model *model = context->world->model;
    double wanted[code->parameter_count + 1]; /* they may be the instance's own */
    memcpy(wanted, parameter, sizeof *wanted * (size_t)code->parameter_count);
    memset(self, 0, code->size);
    self->context = context;
    self->head.subset = self->head.condition = -1;
    double *state = array_of(self, code->state_offset), *input = array_of(self, code->input_offset);
    if (code->free_base) {
        memcpy(state, model->body[BODY_BASE].position, sizeof model->body[BODY_BASE].position);
        memcpy(state + 3, model->body[BODY_BASE].euler, sizeof model->body[BODY_BASE].euler);
    }
    for (int c = 0; c < model->coordinates; ++c)
        if (context->coordinate_state[c] >= 0)
            state[context->coordinate_state[c]] = model->coordinate[c].initial;
    for (int i = 0; i < model->inputs; ++i)
        input[i] = model->input[i].initial;
    memcpy(array_of(self, code->parameter_offset), wanted, sizeof *wanted * (size_t)code->parameter_count);
    if (!same_geometry(self))
        return self->head.status = GIC_ERROR_TUNED;
    load(self, 0);
    return self->head.status = context->start(context, self);
}

static int any_setup(void *instance)
{
    const Model *model = ((Instance *)instance)->context->world->model;
    double value[model->tunables + 1];
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            value[model->parameter[i].index] = model->parameter[i].value;
    return any_setup_with(instance, value);
}

/* ---- the descriptor -----------------------------------------------------------------------------------------------
 */

static gic_signal *signals(Pool *pool, int count)
{
    return pool_alloc(pool, ((size_t)count + 1) * sizeof(gic_signal));
}

/* Names and units of the state. */
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
    static const gic_signal discrete = {"dependent_euler_parameter", "1"};
    gic_signal *input = signals(pool, model->inputs), *parameter = signals(pool, model->tunables),
               *output = signals(pool, model->output_components), *coordinate = signals(pool, model->coordinates);
    for (int i = 0; i < model->inputs; ++i)
        input[i] = (gic_signal){model->input[i].name, model->input[i].unit};
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            parameter[model->parameter[i].index] = (gic_signal){model->parameter[i].name, model->parameter[i].unit};
    int at = 0;
    for (int i = 0; i < model->outputs; ++i)
        for (int k = 0; k < model->output[i].count; ++k)
            output[at++] = (gic_signal){model->output[i].component[k], model->output[i].unit[k]};
    for (int i = 0; i < model->coordinates; ++i)
        coordinate[i] =
            (gic_signal){model->coordinate[i].name, model->coordinate[i].type == COORDINATE_ANGLE ? "rad" : "m"};
    code->state = state_signals(pool, model, code->slow_count);
    code->discrete = &discrete;
    code->input = input;
    code->parameter = parameter;
    code->output = output;
    code->port = port_signals(pool, model);
    code->coordinate = coordinate;
}

static void set_coordinates(Pool *pool, const Model *model, Interpreted *context)
{
    const size_t count = (size_t)model->coordinates + 1;
    double *number[3];
    for (int i = 0; i < 3; ++i)
        number[i] = pool_alloc(pool, count * sizeof(double));
    int32_t *place[2];
    for (int i = 0; i < 2; ++i)
        place[i] = pool_alloc(pool, count * sizeof(int32_t));
    int next = model->free_base ? 7 : 0;
    context->coordinate_state = pool_alloc(pool, count * sizeof(int));
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *w = &model->coordinate[c];
        number[0][c] = w->design;
        number[1][c] = w->range[0];
        number[2][c] = w->range[1];
        place[0][c] = context->coordinate_state[c] = w->driven ? -1 : next++;
        place[1][c] = w->driven ? w->input : -1;
    }
    context->code.coordinate_design = number[0];
    context->code.coordinate_low = number[1];
    context->code.coordinate_high = number[2];
    context->code.coordinate_state = place[0];
    context->code.coordinate_input = place[1];
}

static void set_names(Pool *pool, const Model *model, const Sequence *sequence, gic_model *code)
{
    const char **subset = pool_alloc(pool, ((size_t)sequence->subsets + 1) * sizeof *subset),
               **body = pool_alloc(pool, (size_t)model->bodies * sizeof *body);
    for (int s = 0; s < sequence->subsets; ++s)
        subset[s] = subset_title(pool, model, &sequence->subset[s]);
    for (int b = 0; b < model->bodies; ++b)
        body[b] = model->body[b].name;
    code->subset_name = subset;
    code->body_name = body;
}

/* Arrays one behind another, aligned for doubles. */
static size_t place_arrays(gic_model *code, size_t own)
{
    const size_t states = (size_t)code->slow_count, number = sizeof(double);
    const struct {
        size_t *offset, count;
    } array[] = {{&code->state_offset, states},
                 {&code->rate_offset, states},
                 {&code->history_offset, 2 * states},
                 {&code->scratch_offset, 4 * states + (size_t)code->input_count},
                 {&code->discrete_offset, 1},
                 {&code->input_offset, (size_t)code->input_count},
                 {&code->parameter_offset, (size_t)code->parameter_count},
                 {&code->output_offset, (size_t)code->output_count},
                 {&code->port_offset, (size_t)code->port_count}};
    size_t at = (sizeof(Instance) + number - 1) / number * number;
    for (size_t i = 0; i < sizeof array / sizeof *array; ++i) {
        *array[i].offset = at;
        at += array[i].count * number;
    }
    code->size = at + own * number;
    return at;
}

Interpreted *interpreted_new(Pool *pool, const Model *model, const Sequence *sequence, size_t own)
{
    Interpreted *context = pool_alloc(pool, sizeof *context);
    int states = model->free_base ? 13 : 0;
    for (int c = 0; c < model->coordinates; ++c)
        states += model->coordinate[c].driven ? 0 : 2;
    int32_t *geometric = pool_alloc(pool, ((size_t)model->tunables + 1) * sizeof *geometric);
    for (int i = 0; i < model->parameters; ++i)
        if (model->parameter[i].tunable)
            geometric[model->parameter[i].index] = model->parameter[i].geometric;
    context->world = world_new(pool, model, sequence);
    context->profile = pool_alloc(pool, sizeof *context->profile);
    context->code = (gic_model){.abi_version = GIC_ABI_VERSION,
                                .real_size = sizeof(gic_real),
                                .name = model->name,
                                .description = model->description,
                                .hash = "",
                                .generator = "gicrun " GICGEN_VERSION,
                                .free_base = model->free_base,
                                .slow_count = states,
                                .discrete_count = model->free_base,
                                .input_count = model->inputs,
                                .parameter_count = model->tunables,
                                .output_count = model->output_components,
                                .port_count = 6 * model->ports,
                                .coordinate_count = model->coordinates,
                                .subset_count = sequence->subsets,
                                .body_count = model->bodies,
                                .wheel_count = model->wheels,
                                .parameter_geometric = geometric,
                                .setup = any_setup,
                                .setup_with = any_setup_with,
                                .rhs = any_rhs,
                                .settle = any_settle,
                                .outputs = any_outputs,
                                .poses = any_poses,
                                .self_test = any_self_test};
    set_signals(pool, model, &context->code);
    set_coordinates(pool, model, context);
    set_names(pool, model, sequence, &context->code);
    context->own_offset = place_arrays(&context->code, own);
    return context;
}

const Engine *interpreted_engine(Pool *pool, const char *name, const Interpreted *context)
{
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = name, .code = &context->code, .context = context, .profile = context->profile};
    return engine;
}
