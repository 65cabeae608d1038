/* SPDX-License-Identifier: MIT
 * How the state at time 0 follows numbers of the model and of inputs.
 *
 * Places of an equilibrium solve f(z, p) = 0, so they change by -(df/dz)^-1 df/dp (implicit function theorem), with
 * steps of least norm as the search takes them. Velocities are numbers of the scene and stay. Wheels that roll have the
 * spin v / R and the slip of their drift (TIRES.md section 2), by which these are differentiated. */
#include "run/start_change.h"
#include "run/tangent_private.h"
#include "run/run.h"
#include "tape/engine_tape.h"
#include "vehicle/wheel.h"

#include <math.h>
#include <string.h>

/* row: that of the places in equilibrium, and of the fast states where wheels are not locked. */
static int places_change(const TangentRun *run, const RunVariable *v, double *row)
{
    const Linear *linear = run->linear;
    const int base = run->code->free_base, positions = linear->places + base;
    double z[linear->count + 1], input[3] = {1};
    const int status =
        equilibrium_change(run->rests, v->kind == BY_INPUT ? LINEAR_INPUT : LINEAR_PARAMETER, v->index, z);
    if (status != GIC_OK)
        return status;
    if (v->kind == BY_INPUT)
        tangent_input(v, 0, input);
    for (int i = 0; i < linear->places; ++i) {
        linear_direction(linear, run->self, LINEAR_MOTION, i);
        for (int k = 0; k < positions && z[i] != 0; ++k)
            row[k] += input[0] * z[i] * linear->along.y[k];
    }
    for (int i = 2 * linear->places; i < linear->count && !run->rests->locked; ++i)
        row[i + base] += input[0] * z[i];
    return GIC_OK;
}

/* Coordinates at time 0 with another value of a parameter. */
static int initial_at(const TangentRun *run, int parameter, double p, double *value)
{
    const gic_model *code = run->code;
    double number[code->parameter_count + 1];
    Scene other = *run->scene;
    memcpy(number, other.parameter, (size_t)code->parameter_count * sizeof *number);
    number[parameter] = p;
    other.parameter = number;
    const int status = scene_start(run->engine, &other, &run->copy->head);
    for (int c = 0; c < code->coordinate_count && status == GIC_OK; ++c)
        value[c] =
            code->coordinate_state[c] < 0 ? 0 : tape_array(run->copy, code->state_offset)[code->coordinate_state[c]];
    return status;
}

/* row: that of coordinates whose value at time 0 is the model's, where a geometric parameter gives it. Set-up has no
 * derivatives: a central difference of fourth order, exact to 1e-12 for what is no steeper than a cubic, since values
 * are formulas of the parameter or lengths of the drawing. A value that nothing can be set up with counts only where
 * others show that something follows. */
static int initial_change(const TangentRun *run, const RunVariable *v, double *row)
{
    const gic_model *code = run->code;
    const int count = code->coordinate_count;
    const double p = run->scene->parameter[v->index], step = 1e-3 * fmax(fabs(p), 1e-3);
    double value[5][count + 1];
    bool follows = false;
    int failed = GIC_OK;
    for (int i = 0; i < 5; ++i) { /* the last one: as it is */
        const double apart = i == 4 ? 0 : (i < 2 ? i - 2 : i - 1) * step;
        const int status = initial_at(run, v->index, p + apart, value[i]);
        if (status != GIC_OK) {
            memset(value[i], 0, sizeof value[i]);
            failed = status;
        }
    }
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < count; ++c)
            follows = follows || (!run->scene->given[c] && value[i][c] != 0 && value[i][c] != value[4][c]);
    if (!follows || failed != GIC_OK)
        return follows ? failed : GIC_OK;
    for (int c = 0; c < count; ++c)
        if (code->coordinate_state[c] >= 0 && !run->scene->given[c])
            row[code->coordinate_state[c]] +=
                (value[0][c] - value[3][c] + 8 * (value[2][c] - value[1][c])) / (12 * step);
    return GIC_OK;
}

/* Derivative of the share of the drift that a wheel at s times the low speed has as slip: s (3 - 2 s) below it. */
static double share_change(double s)
{
    return s < 1 ? 3 - 4 * s : -1 / (s * s);
}

static double share_of(double s)
{
    return s < 1 ? s * (3 - 2 * s) : 1 / s;
}

/* row: that of spins and slips which the scene does not give. */
static int rolling_change(const TangentRun *run, const RunVariable *v, double *row)
{
    const TapeEngine *engine = run->linear->engine;
    const Direction *along = &run->linear->along;
    double rate[run->states + 1];
    const double *fast = run->scene->fast;
    int status = run->code->rhs(run->self, 0, tape_array(run->self, run->code->state_offset), rate);
    memcpy(along->y, row, (size_t)run->states * sizeof *row);
    memset(along->u, 0, (size_t)run->inputs * sizeof *along->u);
    memset(along->port, 0, (size_t)run->code->port_count * sizeof *along->port);
    memset(along->p, 0, (size_t)run->code->parameter_count * sizeof *along->p);
    *along->time = 0;
    if (v->kind == BY_PARAMETER) {
        along->p[v->index] = 1;
    } else {
        double input[3];
        const int count = tangent_input(v, 0, input);
        memcpy(along->u + v->index, input, (size_t)count * sizeof *input);
    }
    if (status == GIC_OK)
        status = linear_slope(run->linear, run->self, LINEAR_RATE, 0);
    const double *now = tape_array(run->linear->value, engine->grip_offset);
    const double *change = tape_array(run->linear->slope, engine->grip_offset);
    for (int i = 0; i < run->model->wheels && status == GIC_OK; ++i) {
        const Wheel *wheel = &run->model->wheel[i];
        if (wheel->tire < 0)
            continue;
        const double low = run->model->tire[wheel->tire].low_speed, s = fabs(now[GRIP_SPEED_X]) / low;
        const double ds = (now[GRIP_SPEED_X] < 0 ? -1 : 1) * change[GRIP_SPEED_X] / low, R = now[GRIP_RADIUS];
        double *own = row + run->code->slow_count + wheel->fast;
        if (isnan(fast[wheel->fast + FAST_SPIN]))
            own[FAST_SPIN] = change[GRIP_SPEED_X] / R - now[GRIP_SPEED_X] * change[GRIP_RADIUS] / (R * R);
        if (isnan(fast[wheel->fast + FAST_SLIP_Y]))
            own[FAST_SLIP_Y] = (change[GRIP_SPEED_Y] * share_of(s) + now[GRIP_SPEED_Y] * share_change(s) * ds) / low;
        now += GRIP_NUMBERS;
        change += GRIP_NUMBERS;
    }
    return status;
}

/* Are there wheels that roll as the state has it? */
static bool has_rolling(const TangentRun *run)
{
    bool rolls = false;
    for (int i = 0; i < run->model->wheels; ++i) {
        const Wheel *wheel = &run->model->wheel[i];
        const double *fast = run->scene->fast + (wheel->tire >= 0 ? wheel->fast : 0);
        rolls = rolls || (wheel->tire >= 0 && (isnan(fast[FAST_SPIN]) || isnan(fast[FAST_SLIP_Y])));
    }
    return rolls;
}

int start_changes(TangentRun *run, double *change)
{
    const bool rolls = has_rolling(run);
    int status = GIC_OK;
    memset(change, 0, (size_t)(run->variables * run->states) * sizeof *change);
    for (int k = 0; k < run->variables && status == GIC_OK; ++k) {
        const RunVariable *v = &run->variable[k];
        double *row = change + k * run->states;
        if (v->kind == BY_INITIAL) {
            linear_direction(run->linear, run->self, LINEAR_MOTION, v->index);
            memcpy(row, run->linear->along.y, (size_t)run->states * sizeof *row);
            continue;
        }
        if (run->rests)
            status = places_change(run, v, row);
        else if (run->model->tuning && v->kind == BY_PARAMETER)
            status = initial_change(run, v, row);
        if (status == GIC_OK && rolls)
            status = rolling_change(run, v, row);
    }
    return status == GIC_OK && !gic_finite(change, run->variables * run->states) ? GIC_ERROR_RESULT : status;
}
