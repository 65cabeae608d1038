/* SPDX-License-Identifier: MIT
 * The functions of the descriptor: the second half of the template model.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "tape/engine_tape.h"
#include "tape/record.h"
#include "tape/tape.h"
#include "vehicle/vehicle.h"

#include "../../templates/bounds.c.in"

#include <math.h>
#include <string.h>

/* Where the rates of a free base stand in the state: v, omega. */
static int twist_place(const TapeEngine *engine)
{
    return 7 + engine->formulation->plan->free_coordinates;
}

static int32_t *dependent_parameter(Instance *self)
{
    return (int32_t *)(void *)tape_array(self, tape_of(self)->code.discrete_offset);
}

/* Euler parameters with the dependent one recovered from the other three, and the angular velocity of the base. */
static int orient(Instance *self, const double *y, double e[4], double turn[3])
{
    if (!tape_of(self)->code.free_base) {
        memcpy(e, (const double[4]){1, 0, 0, 0}, 4 * sizeof *e);
        memset(turn, 0, 3 * sizeof *turn);
        return GIC_OK;
    }
    int32_t dependent = *dependent_parameter(self);
    int64_t switches = 0;
    memcpy(turn, y + twist_place(tape_of(self)) + 3, 3 * sizeof *turn);
    return gic_orientation(y + 3, &dependent, &switches, e);
}

/* Coordinates and rates, from the state where they are free, from the inputs where they are driven. */
void tape_gather(Instance *self, const double *y)
{
    const TapeEngine *engine = tape_of(self);
    const Plan *plan = engine->formulation->plan;
    const double *u = tape_array(self, engine->code.input_offset);
    double *x = tape_array(self, engine->x_offset), *xd = tape_array(self, engine->xd_offset);
    for (int w = 0; w < plan->model->coordinates; ++w) {
        const Coordinate *c = &plan->model->coordinate[w];
        x[w] = c->driven ? u[c->input] : y[plan->coordinate_state[w]];
        xd[w] = c->driven ? u[c->input + 1] : y[plan->coordinate_rate[w]];
    }
}

void tape_arrays(Instance *self, const double *time, const double *y, const double *e, double *rate, double *acc,
                 double *out, double *array[WHOLE_COUNT])
{
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    double *const all[WHOLE_COUNT] = {
        [WHOLE_time] = (double *)time, /* blocks only read these three */
        [WHOLE_y] = (double *)y,
        [WHOLE_e] = (double *)e,
        [WHOLE_x] = tape_array(self, engine->x_offset),
        [WHOLE_xd] = tape_array(self, engine->xd_offset),
        [WHOLE_u] = tape_array(self, code->input_offset),
        [WHOLE_m] = tape_array(self, engine->motion_offset),
        [WHOLE_n] = tape_array(self, engine->inertia_offset),
        [WHOLE_p] = tape_array(self, code->parameter_offset),
        [WHOLE_port] = tape_array(self, code->port_offset),
        [WHOLE_rate] = rate,
        [WHOLE_acc] = acc,
        [WHOLE_out] = out,
        [WHOLE_pose] = out,
        [WHOLE_tau] = out,
        [WHOLE_size] = engine->size,
        [WHOLE_energy] = out,
        [WHOLE_press] = out,
        [WHOLE_DERIVED] = tape_array(self, engine->derived_offset),
        [WHOLE_GRIP] = tape_array(self, engine->grip_offset),
        [WHOLE_gear] = tape_array(self, engine->gear_offset),
        [WHOLE_WATCH] = tape_array(self, engine->watch_offset),
        [WHOLE_lambda] = tape_array(self, engine->multiplier_offset),
    };
    memcpy(array, all, sizeof all);
}

int tape_whole(Instance *self, const Tape *tape, double time, const double *y, const double *e, double *rate,
               double *acc, double *out)
{
    const TapeEngine *engine = tape_of(self);
    const TapeWorld world = {
        .table = engine->table, .road = self->head.road, .lane = self->head.lane, .time = time, .head = &self->head};
    double *array[WHOLE_COUNT];
    tape_arrays(self, &time, y, e, rate, acc, out, array);
    return tape_play(tape, 0, array, &world, engine->frame);
}

int tape_locate(Instance *self, double time, const double *y, double e[4])
{
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    double turn[3];
    self->head.subset = -1;
    if (!gic_bounded(y, code->slow_count) || !gic_finite(&time, 1) ||
        !gic_finite(tape_array(self, code->input_offset), code->input_count) ||
        !gic_finite(tape_array(self, code->parameter_offset), code->parameter_count) ||
        !gic_finite(tape_array(self, code->port_offset), code->port_count))
        return self->head.status = GIC_ERROR_INPUT;
    if (!tape_is_tuned(self))
        return self->head.status = GIC_ERROR_TUNED;
    const double begun = profile_clock(engine->profile);
    int status = orient(self, y, e, turn);
    if (status == GIC_OK) {
        tape_gather(self, y);
        status = engine->wheel ? tape_recover_once(self, turn) : tape_recover(self, turn, false);
    }
    engine->profile->recovery += profile_clock(engine->profile) - begun;
    return self->head.status = status;
}

/* The motions that were recovered last, against all constraints. */
static int check_constraints(Instance *self)
{
    double largest[2];
    const int bad = tape_residual(self, largest);
    self->head.residual = GIC_MAX(self->head.residual, largest[0]);
    if (bad < 0)
        return GIC_OK;
    self->head.subset = bad;
    tape_forget(self);
    return GIC_ERROR_RESIDUAL;
}

/* The same, and a rate against the equations of motion. */
static int check(Instance *self, double time, const double *y, const double *e, double *rate)
{
    const TapeEngine *engine = tape_of(self);
    int status = check_constraints(self);
    self->head.unchecked = 0;
    if (status == GIC_OK && !gic_rates_match(&engine->code, y, e, rate))
        status = GIC_ERROR_RESIDUAL;
    if (status == GIC_OK)
        status = tape_whole(self, engine->check, time, y, e, rate, NULL, engine->tau);
    for (int i = 0; status == GIC_OK && i < engine->formulation->plan->unknowns; ++i)
        if (!(fabs(engine->tau[i]) <= GIC_BALANCE_RESIDUAL * engine->size[i]))
            status = GIC_ERROR_RESIDUAL;
    if (status == GIC_OK)
        self->head.unchecked = GIC_CHECK_EVERY;
    return status;
}

static int evaluate(Instance *self, double time, const double *y, double e[4], double *rate)
{
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    const int count = code->slow_count + code->fast_count;
    const int32_t flip = self->head.flip;
    int status = tape_locate(self, time, y, e);
    self->head.rhs_count += status != GIC_ERROR_INPUT;
    const double recovered = profile_clock(engine->profile);
    if (status == GIC_OK && engine->wheel)
        status = tape_turn_wheels(self, time, y, e, engine->result + code->slow_count);
    if (status == GIC_OK)
        status = tape_whole(self, engine->dynamics, time, y, e, engine->result, NULL, NULL);
#ifdef GIC_PLANT_RATE /* an error that tests plant */
    engine->result[GIC_PLANT_RATE] += 1e-3 + 1e-3 * fabs(engine->result[GIC_PLANT_RATE]);
#endif
    engine->profile->acceleration += profile_clock(engine->profile) - recovered;
    engine->profile->evaluations += status != GIC_ERROR_INPUT;
    if (status == GIC_OK && !gic_finite(engine->result, count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK && --self->head.unchecked < 0) {
        status = check(self, time, y, e, engine->result);
        if (status != GIC_OK)
            self->head.flip = flip; /* go back to the start before this recovery */
    }
    if (status == GIC_OK)
        memcpy(rate, engine->result, (size_t)count * sizeof *rate);
    return self->head.status = status;
}

double tape_present(Instance *self)
{
    const double time = gic_time(self);
    self->head.ahead = 0;
    if (self->head.input_function)
        self->head.input_function(self->head.user, self->head.lane, time,
                                  tape_array(self, tape_of(self)->code.input_offset));
    return time;
}

int tape_refresh(Instance *self, double e[4])
{
    const gic_model *code = &tape_of(self)->code;
    const double time = tape_present(self);
    return evaluate(self, time, tape_array(self, code->state_offset), e, tape_array(self, code->rate_offset));
}

static int rhs(void *instance, double time, const double *state, double *rate)
{
    double e[4];
    return evaluate(instance, time, state, e, rate);
}

/* The dependent parameter takes its recovered value, and the largest one becomes the dependent one. */
static int settle(void *instance, double *y)
{
    Instance *self = instance;
    double e[4];
    const gic_model *code = &tape_of(self)->code;
    if (!gic_bounded(y, code->slow_count + code->fast_count))
        return GIC_ERROR_INPUT;
    if (!code->free_base)
        return GIC_OK;
    int status = gic_orientation(y + 3, dependent_parameter(self), &self->head.switch_count, e);
    if (status == GIC_OK)
        memcpy(y + 3, e, sizeof e);
    return status;
}

static int outputs(void *instance)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    double e[4];
    int status = tape_refresh(self, e);
    if (status == GIC_OK && engine->wrenches)
        status = tape_react(self, e);
    if (status == GIC_OK)
        status = tape_whole(self, engine->outputs, gic_time(self), tape_array(self, code->state_offset), e,
                            tape_array(self, code->rate_offset), NULL, engine->out);
    if (status == GIC_OK && !gic_finite(engine->out, code->output_count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK)
        memcpy(tape_array(self, code->output_offset), engine->out, (size_t)code->output_count * sizeof(double));
    return self->head.status = status;
}

static int poses(void *instance, double *pose)
{
    Instance *self = instance;
    double e[4];
    const double time = tape_present(self), *state = tape_array(self, tape_of(self)->code.state_offset);
    const int32_t flip = self->head.flip;
    int status = tape_locate(self, time, state, e);
    if (status == GIC_OK) {
        status = self->head.status = check_constraints(self);
        if (status != GIC_OK)
            self->head.flip = flip;
    }
    if (status == GIC_OK)
        tape_whole(self, tape_of(self)->poses, time, state, e, NULL, NULL, pose);
    return status;
}

static int contacts(void *instance, double time, const double *y, double *press)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    double e[4];
    int status = tape_locate(self, time, y, e);
    if (status == GIC_OK && engine->wheel)
        status = tape_turn_wheels(self, time, y, e, engine->result);
    if (status == GIC_OK)
        status = tape_whole(self, engine->contacts, time, y, e, NULL, NULL, press);
    if (status == GIC_OK && !gic_finite(press, engine->code.contact_count))
        status = GIC_ERROR_RESULT;
    return self->head.status = status;
}

static int setup_with(void *instance, const double *wanted)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    const Plan *plan = engine->formulation->plan;
    const Model *model = plan->model;
    double e[4], turn[3];
    memcpy(engine->wanted, wanted, (size_t)code->parameter_count * sizeof *wanted); /* may be the instance's own */
    memset(self, 0, code->size);
    self->context = engine;
    self->head.subset = self->head.condition = self->head.hold = self->head.grown = -1;
    double *state = tape_array(self, code->state_offset), *input = tape_array(self, code->input_offset);
    double *x = tape_array(self, engine->x_offset);
    double *start = tape_start(self);
    memcpy(state, engine->initial, (size_t)(code->slow_count + code->fast_count) * sizeof *state);
    for (int i = 0; i < model->inputs; ++i)
        input[i] = model->input[i].initial;
    memcpy(tape_array(self, code->parameter_offset), engine->wanted, (size_t)code->parameter_count * sizeof *wanted);
    tape_start_gears(self);
    if (!gic_finite(engine->wanted, code->parameter_count))
        return self->head.status = GIC_ERROR_INPUT;
    /* from the design poses alone, then on to the initial values of the coordinates */
    for (int i = 0; i < model->coordinates; ++i)
        start[i] = x[i] = model->coordinate[i].design;
    for (int s = 0; s < plan->sequence->subsets; ++s) {
        const Subset *subset = &plan->sequence->subset[s];
        for (int b = 0; plan_follows(plan, s) && b < subset->bodies; ++b)
            body_design(engine->formulation, subset_anchor(plan->model, plan->sequence, s), subset->body[b],
                        start + plan->start_offset[s] + 7 * b);
    }
    int status = orient(self, state, e, turn);
    if (status == GIC_OK)
        status = engine->draw ? tape_assemble(self, turn) : tape_recover(self, turn, true);
    tape_gather(self, state);
    if (status == GIC_OK)
        status = tape_recover(self, turn, false);
    if (status == GIC_OK)
        status = check_constraints(self);
    return self->head.status = status;
}

static int setup(void *instance)
{
    const TapeEngine *engine = tape_of(instance);
    return setup_with(instance, engine->standard);
}

const Engine *engine_tape(Pool *pool, const Model *model, const EngineOptions *options)
{
    TapeEngine *tape = tape_open(pool, model, options->solve, options->recovery);
    tape->code.setup = setup;
    tape->code.setup_with = setup_with;
    tape->code.rhs = rhs;
    tape->code.settle = settle;
    tape->code.outputs = outputs;
    tape->code.poses = poses;
    if (tape->contacts) {
        tape->code.contact_count = tape->formulation->contacts->stores;
        tape->code.contacts = descriptor_contacts(pool, model, &tape->code, contacts);
    }
    tape->code.self_test = tape_self_test;
    if (tape->wheel) {
        tape->code.link_count = tape->formulation->wheels->links;
        tape->code.link = tape_link_wheels;
        tape->code.fast = tape_fast;
        tape->code.roll = tape->formulation->wheels->count > 0 ? tape_roll : NULL;
    }
    if (model->powertrain)
        tape->code.shift = tape_shift;
    Engine *engine = pool_alloc(pool, sizeof *engine);
    *engine = (Engine){.name = "tape",
                       .code = &tape->code,
                       .context = tape,
                       .profile = tape->profile,
                       .standard = tape->code.state,
                       .standard_count = tape->code.slow_count + tape->code.fast_count};
    return engine;
}
