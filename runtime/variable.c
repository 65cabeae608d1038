/* SPDX-License-Identifier: MIT
 * Variable-step integration: GSL's steppers drive a model's right-hand side.
 *
 * All four Euler parameters of the base are integrated. The right-hand side recovers the dependent one from the other
 * three and the stepper never sees the recovered value, so that a change of the dependent parameter, settled between
 * steps, leaves the history of all four as smooth as it was. What the instance shows is the settled state. */
#include "variable.h"

#include "gsl_errors.h"
#include "resolve.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct Variable {
    const gic_model *model;
    gic_head *self;    /* during a step */
    int status;        /* of the right-hand side that failed last in this step */
    double first_step; /* s, after a restart, when nothing is known yet */
    double step;       /* s, that the error control suggests */
    bool jumped;       /* the last step ended with a change of what is integrated */
    double tolerance;
    bool fresh; /* the history is empty: go on from the instance's state */
    gsl_odeiv2_system system;
    gsl_odeiv2_driver *driver;
    double *integrated, *settled; /* states */
    void *before;                 /* the instance at the start of the step */
    Probe *probe;                 /* sees where the road is looked up */
    bool begun;                   /* has there been a step? */
};

static double *array_of(void *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

static size_t states(const gic_model *model)
{
    return (size_t)(model->slow_count + model->fast_count);
}

static void refresh_inputs(const gic_model *model, gic_head *self, double time)
{
    if (self->input_function)
        self->input_function(self->user, self->lane, time, array_of(self, model->input_offset));
}

/* A stage that reached too far may have led the start of Newton's method astray: back to where the step began. */
static void find_back(const Variable *variable)
{
    const gic_head done = *variable->self;
    memcpy(variable->self, variable->before, variable->model->size);
    variable->self->rhs_count = done.rhs_count;
    variable->self->newton_count = done.newton_count;
    variable->self->correction_count = done.correction_count;
    variable->self->subset = done.subset;
}

/* A failure makes the stepper try half the step. */
static int right_hand_side(double time, const double *state, double *rate, void *user)
{
    Variable *variable = user;
    refresh_inputs(variable->model, variable->self, time);
    probe_begin(variable->probe, time);
    const int status = variable->model->rhs(variable->self, time, state, rate);
    if (status == GIC_OK)
        return GSL_SUCCESS;
    variable->status = status;
    find_back(variable);
    return GSL_FAILURE;
}

Variable *variable_open(const gic_model *model, int32_t method, double tolerance)
{
    const gsl_odeiv2_step_type *type = method == METHOD_ADAMS ? gsl_odeiv2_step_msadams : gsl_odeiv2_step_rkck;
    Variable *variable = calloc(1, sizeof *variable);
    if (!variable)
        return NULL;
    gsl_errors_return();
    variable->model = model;
    /* the first step is of first order: its error is half its square times the second derivative, about 1e3 here */
    variable->tolerance = tolerance;
    variable->first_step = 0.03 * sqrt(tolerance);
    variable->system = (gsl_odeiv2_system){right_hand_side, NULL, states(model), variable};
    variable->integrated = calloc(states(model), sizeof(double));
    variable->settled = calloc(states(model), sizeof(double));
    variable->before = malloc(model->size);
    variable->probe = probe_new();
    variable->driver =
        gsl_odeiv2_driver_alloc_standard_new(&variable->system, type, variable->first_step, tolerance, tolerance, 1, 0);
    variable_restart(variable);
    if (variable->integrated && variable->settled && variable->before && variable->probe && variable->driver)
        return variable;
    variable_close(variable);
    return NULL;
}

void variable_close(Variable *variable)
{
    if (!variable)
        return;
    if (variable->driver)
        gsl_odeiv2_driver_free(variable->driver);
    free(variable->integrated);
    free(variable->settled);
    free(variable->before);
    probe_free(variable->probe);
    free(variable);
}

void variable_change(Variable *variable, const gic_model *model)
{
    variable->model = model;
}

void variable_restart(Variable *variable)
{
    variable->fresh = true;
}

/* Numbers that the right-hand side does not use drift from those that they depend on. Where they come into use by more
 * than the tolerance, the history is not theirs. */
static bool jumps(const Variable *variable)
{
    for (size_t i = 0; i < states(variable->model); ++i)
        if (!(fabs(variable->settled[i] - variable->integrated[i]) <=
              variable->tolerance * (1 + fabs(variable->settled[i]))))
            return true;
    return false;
}

/* One step of the stepper from the instance's time to *time. */
static int advance(Variable *variable, double *time, double end)
{
    gsl_odeiv2_driver *driver = variable->driver;
    variable->status = GIC_OK;
    variable->self->ahead = variable->step;
    const int result = gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, &variable->system, time, end,
                                               &variable->step, variable->integrated);
    if (result != GSL_SUCCESS)
        return variable->status == GIC_OK ? GIC_ERROR_ARGUMENT : variable->status;
    const size_t size = sizeof(double) * states(variable->model);
    memcpy(variable->settled, variable->integrated, size);
    variable->self->subset = -1;
    const int64_t switches = variable->self->switch_count;
    const int status = variable->model->settle(variable->self, variable->settled);
    variable->jumped = variable->self->switch_count != switches && jumps(variable);
    return status;
}

/* How far the next step may go at most: over no detail of the road. Where code looks no road up there is none. */
static double longest(const Variable *variable)
{
    return variable->begun && !probe_asked(variable->probe) ? INFINITY : probe_longest(variable->probe);
}

int variable_step(Variable *variable, void *instance, double end)
{
    const gic_model *model = variable->model;
    gic_head *self = instance;
    const size_t size = sizeof(double) * states(model);
    double time = gic_time(self), *state = array_of(self, model->state_offset);
    if (variable->fresh) {
        memcpy(variable->integrated, state, size);
        gsl_odeiv2_step_reset(variable->driver->s);
        variable->step = variable->first_step;
    }
    const gic_road *const road = self->road;
    self->road = probe_road(variable->probe, road);
    variable->self = self;
    memcpy(variable->before, self, model->size);
    const int status = advance(variable, &time, road ? fmin(end, time + longest(variable)) : end);
    self->road = road;
    self->status = status;
    if (status == GIC_OK)
        probe_end(variable->probe);
    variable->begun = variable->begun || status == GIC_OK;
    variable->fresh = status != GIC_OK || variable->jumped;
    if (status == GIC_OK) {
        memcpy(state, variable->settled, size);
        gic_restart(self, time);
    }
    refresh_inputs(model, self, gic_time(self));
    if (status == GIC_OK && model->shift && model->shift(self))
        variable->fresh = true;
    return status;
}
