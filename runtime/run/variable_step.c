/* SPDX-License-Identifier: MIT
 * Variable-step integration: steppers (stepper.h) drive a model's right-hand side.
 *
 * All four Euler parameters of the base are integrated. The right-hand side recovers the dependent one from the other
 * three and the stepper never sees the recovered value, so that a change of the dependent parameter, settled between
 * steps, leaves the history of all four as smooth as it was. What the instance shows is the settled state.
 *
 * No step goes over the beginning or the end of a contact: one that meets it is taken back, and shorter ones by
 * Runge-Kutta go near; the last bit, too short for a force that begins in it to count, goes across. */
#include "base/catch.h"
#include "gic_runtime.h"
#include "run/contact_watch.h"
#include "run/road_resolution.h"
#include "run/stepper.h"
#include "run/variable_step.h"
#include "scene/scene.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct Variable {
    const gic_model *model;
    gic_head *self;    /* during a step */
    int status;        /* of the right-hand side that failed last in this step */
    int32_t lost;      /* the subset that it named */
    int32_t creeping;  /* steps so far, one after the other, that are too short to come anywhere */
    double first_step; /* s, after a restart, when nothing is known yet */
    double step;       /* s, proposed by the error control */
    bool jumped;       /* the last step ended with a change of the integrated numbers */
    double tolerance;
    bool fresh; /* the history is empty: continue from the instance's state */
    StepperSystem system;
    Stepper *stepper, *towards; /* of all other steps; of those towards contacts */
    double *jacobian;           /* [states][gic_implicit.columns]; NULL: the code has none */
    int64_t jacobians;          /* evaluated so far */
    ContactWatch *contacts;
    double hunted;                /* s, up to where a contact changes that has been met */
    double since;                 /* s, when contacts began to be crossed one soon after the other */
    int32_t crossings;            /* since then */
    double *integrated, *settled; /* states */
    void *before;                 /* the instance at the start of the stepper's step */
    void *whole;                  /* the instance at the start of all tries of a step */
    void *start, *trial;          /* the instance at the start of a step, and within it, while a change is located */
    Probe *probe;                 /* records where the road is evaluated */
    const gic_road *road;         /* behind the probe, during a step */
    bool begun;                   /* a step has been made */
};

static double *array_of(void *self, size_t offset)
{
    return (double *)(void *)((char *)self + offset);
}

static size_t states(const gic_model *model)
{
    return (size_t)(model->slow_count + model->fast_count);
}

/* Numbers that are integrated: where all coordinates are driven there is no state, and 0 is, for GSL wants some. */
static size_t dimension(const gic_model *model)
{
    return states(model) ? states(model) : 1;
}

static void refresh_inputs(const gic_model *model, gic_head *self, double time)
{
    if (self->input_function)
        self->input_function(self->user, self->lane, time, array_of(self, model->input_offset));
}

/* A stage that reached too far may have spoilt the Newton start: restore the one at the begin of the step. */
static void find_back(const Variable *variable)
{
    const gic_head done = *variable->self;
    memcpy(variable->self, variable->before, variable->model->size);
    variable->self->rhs_count = done.rhs_count;
    variable->self->newton_count = done.newton_count;
    variable->self->correction_count = done.correction_count;
    variable->self->subset = done.subset;
}

/* Look at the contacts where a right-hand side was evaluated. */
static int look_at_contacts(const Variable *variable, double time, const double *state)
{
    gic_head *self = variable->self;
    const gic_road *const probe = self->road;
    if (!variable->model->contact_count)
        return GIC_OK;
    self->road = variable->road;
    const int status = contact_watch_look(variable->contacts, variable->model, self, time, state);
    self->road = probe;
    return status;
}

/* On failure the stepper tries a shorter step. */
static int right_hand_side(void *user, double time, const double *state, double *rate)
{
    Variable *variable = user;
    refresh_inputs(variable->model, variable->self, time);
    probe_begin(variable->probe, time);
    if (!states(variable->model))
        *rate = 0;
    int status = variable->model->rhs(variable->self, time, state, rate);
    if (status == GIC_OK)
        status = look_at_contacts(variable, time, state);
    if (status == GIC_OK)
        return 0;
    variable->status = status;
    variable->lost = variable->self->subset;
    find_back(variable);
    return -1;
}

/* ---- derivatives, for BDF ------------------------------------------------------------------------------------ */

/* The Jacobian of generated code, exact. */
static int exact_jacobian(Variable *variable, double time, const double *state, double *matrix)
{
    const gic_implicit *implicit = variable->model->implicit;
    const size_t n = states(variable->model), columns = (size_t)implicit->columns;
    const int status = implicit->jacobian(variable->self, time, state, variable->jacobian);
    for (size_t i = 0; i < n && status == GIC_OK; ++i)
        for (size_t j = 0; j < n; ++j)
            matrix[i + n * j] = variable->jacobian[columns * i + j];
    return status;
}

/* By differences, for engines that have no derivatives. */
static int difference_jacobian(Variable *variable, double time, const double *state, const double *rate, double *matrix)
{
    const size_t n = states(variable->model);
    double moved[n + 1];
    int status = GIC_OK;
    memcpy(moved, state, n * sizeof *moved);
    for (size_t j = 0; j < n && status == GIC_OK; ++j) {
        double *column = matrix + n * j;
        moved[j] = state[j] + 1e-8 * (1 + fabs(state[j]));
        status = variable->model->rhs(variable->self, time, moved, column);
        for (size_t i = 0; i < n; ++i)
            column[i] = (column[i] - rate[i]) / (moved[j] - state[j]);
        moved[j] = state[j];
    }
    return status;
}

static int jacobian(void *user, double time, const double *state, const double *rate, double *matrix)
{
    Variable *variable = user;
    gic_head *self = variable->self;
    const gic_road *const probe = self->road;
    self->road = variable->road; /* these evaluations are no step's */
    refresh_inputs(variable->model, self, time);
    const int status = variable->jacobian ? exact_jacobian(variable, time, state, matrix)
                                          : difference_jacobian(variable, time, state, rate, matrix);
    if (status != GIC_OK)
        find_back(variable);
    self->road = probe;
    variable->jacobians += status == GIC_OK;
    variable->status = status == GIC_OK ? variable->status : status;
    return status == GIC_OK ? 0 : -1;
}

/* The count that the summary tells. */
static void tell_jacobians(const Variable *variable, gic_head *self)
{
    if (variable->jacobian)
        ((gic_implicit_head *)(void *)((char *)self + variable->model->implicit->head_offset))->jacobian_count =
            variable->jacobians;
}

static void release(void *variable)
{
    variable_close(variable);
}

Variable *variable_open(const gic_model *model, int32_t method, double tolerance)
{
    const gic_implicit *implicit = model->implicit;
    const bool exact = method == METHOD_BDF && implicit && !implicit->mass_count;
    stepper_need(method);
    Variable *variable = calloc(1, sizeof *variable);
    if (!variable)
        return NULL;
    variable->model = model;
    /* the first step is of first order: its error is half its square times the second derivative, about 1e3 here */
    variable->tolerance = tolerance;
    variable->first_step = 0.03 * sqrt(tolerance);
    variable->system = (StepperSystem){dimension(model), right_hand_side, jacobian, variable};
    variable->integrated = calloc(dimension(model), sizeof(double));
    variable->settled = calloc(dimension(model), sizeof(double));
    variable->before = malloc(model->size);
    variable->whole = malloc(model->size);
    variable->start = malloc(model->size);
    variable->trial = malloc(model->size);
    variable->probe = probe_new();
    variable->contacts = contact_watch_new();
    variable->stepper = stepper_open(method, &variable->system, tolerance, variable->first_step);
    variable->towards = stepper_open(METHOD_RKCK, &variable->system, tolerance, variable->first_step);
    if (exact)
        variable->jacobian = calloc(dimension(model) * (size_t)implicit->columns + 1, sizeof(double));
    variable->fresh = true;
    variable->hunted = -INFINITY;
    if (variable->integrated && variable->settled && variable->before && variable->whole && variable->start &&
        variable->trial && variable->probe && variable->contacts && variable->stepper && variable->towards &&
        (variable->jacobian || !exact)) {
        caught_own(release, variable);
        return variable;
    }
    variable_close(variable);
    return NULL;
}

void variable_close(Variable *variable)
{
    if (!variable)
        return;
    caught_disown(variable);
    stepper_close(variable->stepper);
    stepper_close(variable->towards);
    free(variable->jacobian);
    contact_watch_free(variable->contacts);
    free(variable->integrated);
    free(variable->settled);
    free(variable->before);
    free(variable->whole);
    free(variable->start);
    free(variable->trial);
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
    variable->hunted = -INFINITY;
    contact_watch_forget(variable->contacts);
}

/* True if an integrated number that the right-hand side did not use has drifted from the recovered one by more than the
 * tolerance when it comes into use: the history is then not valid. */
static bool jumps(const Variable *variable)
{
    for (size_t i = 0; i < states(variable->model); ++i)
        if (!(fabs(variable->settled[i] - variable->integrated[i]) <=
              variable->tolerance * (1 + fabs(variable->settled[i]))))
            return true;
    return false;
}

/* One step of a stepper from the instance's time to *time. */
static int advance(Variable *variable, Stepper *stepper, double *time, double end)
{
    variable->status = GIC_OK;
    variable->self->ahead = variable->step;
    contact_watch_try(variable->contacts);
    if (stepper_step(stepper, time, end, &variable->step, variable->integrated))
        return variable->status == GIC_OK ? GIC_ERROR_ARGUMENT : variable->status;
    /* contacts and the road's probe look at the rates of both ends, the last one last */
    if ((variable->road || variable->model->contact_count) && !(stepper_rate(stepper) && stepper_rate_there(stepper)))
        return variable->status;
    const size_t size = sizeof(double) * states(variable->model);
    memcpy(variable->settled, variable->integrated, size);
    variable->self->subset = -1;
    const int64_t switches = variable->self->switch_count;
    const int status = variable->model->settle(variable->self, variable->settled);
    variable->jumped = variable->self->switch_count != switches && jumps(variable);
    return status;
}

/* The longest next step that skips no detail of the road; unlimited if the code asks for no road. */
static double longest(const Variable *variable)
{
    return variable->begun && !probe_asked(variable->probe) ? INFINITY : probe_longest(variable->probe);
}

/* One step by `stepper` that does not care for contacts or discrete states; without a history it tries `first` s. */
static int smooth_step(Variable *variable, gic_head *self, Stepper *stepper, double first, double end)
{
    const gic_model *model = variable->model;
    const size_t size = sizeof(double) * states(model);
    double time = gic_time(self), *state = array_of(self, model->state_offset);
    if (variable->fresh) {
        memcpy(variable->integrated, state, size);
        stepper_restart(stepper);
        variable->step = first;
    }
    const gic_road *const road = variable->road = self->road;
    self->road = probe_road(variable->probe, road);
    variable->self = self;
    memcpy(variable->before, self, model->size);
    const int status = advance(variable, stepper, &time, road ? fmin(end, time + longest(variable)) : end);
    self->road = road;
    self->status = status;
    variable->fresh = status != GIC_OK || variable->jumped;
    if (status == GIC_OK) {
        memcpy(state, variable->settled, size);
        gic_restart(self, time);
    }
    refresh_inputs(model, self, gic_time(self));
    tell_jacobians(variable, self);
    return status;
}

/* What an instance has counted. */
static void carry_counts(const gic_head *from, gic_head *to)
{
    to->rhs_count = from->rhs_count;
    to->newton_count = from->newton_count;
    to->correction_count = from->correction_count;
}

/* ---- contacts ------------------------------------------------------------------------------------------------ */

/* So short (s) that a force that begins or ends within it does not count: stiffness over mass, times speed, times its
 * square. */
static double crossing(double time)
{
    return fmax(1e-11, 16 * DBL_EPSILON * fabs(time));
}

/* The longest step that stays on this side of all contacts. */
static double longest_towards(const Variable *variable, double time)
{
    const double ahead = contact_watch_ahead(variable->contacts), least = crossing(time);
    /* the less that is left, the better it is known */
    return fmax(fmin(0.999 * ahead - 0.5 * least, variable->hunted - time), 2 * least);
}

/* A step across a change has been made: another number of them within a microsecond than contacts can have would not
 * end. */
static int count_crossing(Variable *variable, double time)
{
    const double soon = 1e-6;
    if (!(time - variable->since < soon && time >= variable->since)) {
        variable->since = time;
        variable->crossings = 0;
    }
    variable->fresh = true;
    variable->hunted = -INFINITY;
    if (++variable->crossings <= GIC_CHANGES * (1 + variable->model->contact_count))
        return GIC_OK;
    variable->self->event = 1 + contact_watch_changed(variable->contacts);
    return GIC_ERROR_EVENTS;
}

/* A step that meets the beginning or end of no contact, or goes across one. On a failure `self` is anywhere in it. */
static int careful_step(Variable *variable, gic_head *self, double end)
{
    const gic_model *model = variable->model;
    const double start = gic_time(self);
    int status = variable->fresh ? contact_watch_start(variable->contacts, model, self) : GIC_OK;
    bool towards = variable->hunted > start;
    double most = towards ? longest_towards(variable, start) : INFINITY;
    while (status == GIC_OK) {
        ContactFinding finding;
        Stepper *stepper = towards ? variable->towards : variable->stepper;
        status = smooth_step(variable, self, stepper, fmin(most, towards ? most : variable->first_step),
                             fmin(end, start + most));
        if (status != GIC_OK)
            break;
        const double now = gic_time(self), length = now - start;
        const bool fresh = variable->fresh;
        const ContactStep done = {length, array_of(variable->whole, model->state_offset), stepper_rate(stepper),
                                  stepper_rate_there(stepper)};
        status = contact_watch_end(variable->contacts, model, self, &done, &finding);
        if (status != GIC_OK)
            break;
        if (finding == CONTACTS_KEPT) {
            contact_watch_keep(variable->contacts, length);
            /* the steps towards have come by: no change after all */
            variable->fresh = fresh || (towards && now >= variable->hunted);
            return GIC_OK;
        }
        if (finding == CONTACTS_REACHED || length <= 2.5 * crossing(start))
            return count_crossing(variable, start);
        const gic_head counted = *self;
        memcpy(self, variable->whole, model->size);
        carry_counts(&counted, self);
        self->contact_count = counted.contact_count; /* of its start */
        variable->fresh = true;
        double low, high;
        contact_watch_place(variable->contacts, &low, &high);
        variable->hunted = start + high;
        const double known = longest_towards(variable, start);
        most = finding == CONTACTS_CHANGE && !towards && known < 0.9 * high ? known : 0.5 * high;
        most = fmax(low > 0 ? low : most, 2 * crossing(start));
        towards = true;
    }
    return status;
}

/* What stops a right-hand side a little further on in the direction of the rates, if anything does: as in
 * right_hand_side(). */
static void look_ahead(Variable *variable, gic_head *self)
{
    const gic_model *model = variable->model;
    const size_t n = states(model);
    const double *state = array_of(self, model->state_offset);
    double rate[n + 1], place[n + 1], none[n + 1];
    memcpy(variable->before, self, model->size);
    int status = model->rhs(variable->before, gic_time(self), state, rate);
    for (double ahead = 1e-9; status == GIC_OK && ahead < 1e-2; ahead *= 10) {
        for (size_t i = 0; i < n; ++i)
            place[i] = state[i] + ahead * rate[i];
        memcpy(variable->before, self, model->size);
        status = model->rhs(variable->before, gic_time(self) + ahead, place, none);
    }
    variable->status = status;
    variable->lost = ((const gic_head *)variable->before)->subset;
}

/* Towards a state that can't be passed, such as a dead centre, the error control takes ever shorter steps, at last of
 * some units of the last place of the time, which would not end. Many of them, one after the other, end with the status
 * of what stopped them. */
static int creep(Variable *variable, gic_head *self, double end)
{
    enum { MANY = 200 };
    const double start = gic_time(variable->whole), time = gic_time(self);
    const double short_step = 64 * DBL_EPSILON * fmax(fabs(time), 1e-3);
    variable->creeping = time - start <= short_step && time < end ? variable->creeping + 1 : 0;
    if (variable->creeping < MANY)
        return GIC_OK;
    variable->creeping = 0;
    if (variable->status == GIC_OK)
        look_ahead(variable, self);
    self->subset = variable->status == GIC_OK ? -1 : variable->lost;
    return variable->status == GIC_OK ? GIC_ERROR_UNSTABLE : variable->status;
}

/* variable_step() without changes of discrete states. On a failure `self` is as it was. */
static int step(Variable *variable, gic_head *self, double end)
{
    memcpy(variable->whole, self, variable->model->size);
    int status = variable->model->contact_count
                     ? careful_step(variable, self, end)
                     : smooth_step(variable, self, variable->stepper, variable->first_step, end);
    if (status == GIC_OK)
        status = creep(variable, self, end);
    if (status == GIC_OK) {
        probe_end(variable->probe);
        variable->begun = true;
        return GIC_OK;
    }
    const gic_head failed = *self;
    memcpy(self, variable->whole, variable->model->size);
    carry_counts(&failed, self);
    self->status = status;
    self->subset = failed.subset;
    self->grown = failed.grown;
    self->event = failed.event;
    self->condition = failed.condition;
    variable_restart(variable);
    return status;
}

/* ---- changes of discrete states ----------------------------------------------------------------------------- */

/* Continue `self` from the start of the step, without a history, to `time` within it. */
static int repeat_until(Variable *variable, gic_head *self, double time)
{
    int status = GIC_OK;
    gic_head *start = variable->start;
    memcpy(self, start, variable->model->size);
    variable_restart(variable);
    while (status == GIC_OK && gic_time(self) < time)
        status = step(variable, self, time);
    carry_counts(self, start);
    return status;
}

/* A discrete state changes within the step that led to `self`: end the step there. The time is the least one at which
 * the change is due, to 1/100 of what the tolerance makes of a second; bisected, for the model only says whether it is
 * due. On failure `self` is as it was at the start of the step. */
static int return_to_change(Variable *variable, gic_head *self)
{
    gic_head *start = variable->start, *trial = variable->trial;
    double low = gic_time(start), high = gic_time(self);
    int status = GIC_OK;
    carry_counts(self, start);
    for (double middle; status == GIC_OK && high - low > 0.01 * variable->tolerance &&
                        low < (middle = 0.5 * (low + high)) && middle < high;) {
        status = repeat_until(variable, trial, middle);
        if (status == GIC_OK && variable->model->shift(trial))
            high = middle;
        else
            low = middle;
    }
    if (status == GIC_OK)
        status = repeat_until(variable, self, high);
    variable_restart(variable);
    if (status == GIC_OK) {
        (void)variable->model->shift(self); /* 0: rounding; then it is due in the next step */
        return GIC_OK;
    }
    memcpy(self, start, variable->model->size);
    self->status = status;
    return status;
}

/* Times that differ by less (s) are the same to all controllers. */
static double same_time(const gic_model *model, double time)
{
    double period = INFINITY;
    for (int32_t c = 0; c < model->controller_count; ++c)
        period = fmin(period, model->controller[c].period);
    return 1e-9 * period + 1e-15 * fabs(time);
}

/* What controllers hold changes now; *end: not beyond the next time of theirs, but at it, where that is the same. */
static int sample(Variable *variable, gic_head *self, double *end)
{
    const gic_model *model = variable->model;
    const size_t size = sizeof(double) * states(model);
    double next, *state = array_of(self, model->state_offset);
    memcpy(variable->settled, state, size);
    const int status = gic_sample(model, self, &next);
    if (next < *end - same_time(model, *end))
        *end = next;
    variable->fresh = variable->fresh || memcmp(variable->settled, state, size);
    return status;
}

int variable_step(Variable *variable, void *instance, double end)
{
    const gic_model *model = variable->model;
    gic_head *self = instance;
    const int sampled = model->controller_count > 0 ? sample(variable, self, &end) : GIC_OK;
    if (sampled != GIC_OK)
        return sampled;
    if (!model->shift)
        return step(variable, self, end);
    memcpy(variable->start, self, model->size);
    const int status = step(variable, self, end);
    if (status != GIC_OK)
        return status;
    memcpy(variable->trial, self, model->size);
    return model->shift(variable->trial) ? return_to_change(variable, self) : GIC_OK;
}
