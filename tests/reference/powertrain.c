/* SPDX-License-Identifier: MIT */
#include "powertrain.h"

#include "support.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

const char *const line_column[LINE_RESULTS] = {"engine.speed.rate",  "transmission.age.rate", "line.engine_speed",
                                               "line.engine_torque", "line.throttle",         "line.gear",
                                               "line.ratio",         "line.turbine_speed",    "line.turbine_torque",
                                               "line.pump_torque"};

bool line_drives(const Model *model, int wheel)
{
    const Powertrain *p = model->powertrain;
    for (int k = 0; p && k < p->differentials; ++k)
        for (int j = 0; j < p->differential[k].outputs; ++j)
            if (p->differential[k].wheel[j] == wheel)
                return true;
    return false;
}

static quad smooth(quad s)
{
    return s <= 0 ? 0 : s >= 1 ? 1 : s * s * (3 - 2 * s);
}

/* All that results follow from, but for formulas: engine speed, age, then of each wheel Omega, the torque that turns it
 * (formula of its drive included), and that formula. What a row of results holds behind the line's own: of each wheel
 * its spin acceleration and half shaft torque. */
enum { OF_WHEEL_IN = 3, OF_WHEEL_OUT = 2, LINE_IN = 2 };

typedef struct Drive {
    const Model *model;
    const Configuration *configuration;
    const Line *line;
    const quad *in;
    quad *out;
    quad *speed, *locked; /* [differentials] omega, T_l */
} Drive;

static quad part_of(const Differential *d, int output)
{
    if (d->outputs == 1)
        return 1;
    return output ? 1 - (quad)d->split : (quad)d->split;
}

static void find_speeds(Drive *of)
{
    const Powertrain *p = of->model->powertrain;
    for (int k = 0; k < p->differentials; ++k) {
        const Differential *d = &p->differential[k];
        quad omega[2] = {0, 0};
        for (int j = 0; j < d->outputs; ++j)
            omega[j] = d->wheel[j] < 0 ? of->speed[d->differential[j]] : of->in[LINE_IN + OF_WHEEL_IN * d->wheel[j]];
        of->speed[k] = 0;
        for (int j = 0; j < d->outputs; ++j)
            of->speed[k] += d->ratio * part_of(d, j) * omega[j];
        of->locked[k] = 0;
        if (d->lock && d->outputs == 2)
            of->locked[k] = law_value(of->model, of->configuration, d->lock, (Locals){0}) * tanhq(omega[1] - omega[0]);
    }
}

/* theta and T_e */
static void find_engine(Drive *of)
{
    const Powertrain *p = of->model->powertrain;
    quad omega = of->in[0], theta = law_value(of->model, of->configuration, p->throttle, (Locals){0});
    if (theta < 0)
        theta = 0;
    if (p->idle > 0 && 5 * (p->idle - omega) / p->idle > theta)
        theta = 5 * (p->idle - omega) / p->idle;
    if (theta > 1)
        theta = 1;
    if (p->limit > 0)
        theta *= smooth(20 * (p->limit - omega) / p->limit);
    quad torque = law_value(of->model, of->configuration, p->torque, (Locals){.speed = omega, .throttle = theta});
    of->out[THROTTLE] = theta;
    of->out[ENGINE_TORQUE] = torque < 0 ? torque * smooth(omega) : torque;
}

/* i; e by itself */
static quad find_ratio(const Drive *of, quad *e)
{
    const Powertrain *p = of->model->powertrain;
    quad b = smooth(of->in[1] / p->duration), weight[2] = {b, 1 - b}, i = 0;
    *e = 0;
    for (int k = 0; k < 2; ++k) {
        int g = of->line->gear[k];
        i += weight[k] * (quad)p->gear[p->reverse + g];
        *e += weight[k] * (g != 0);
    }
    return i;
}

/* T_p and T_t */
static void find_converter(Drive *of, quad e)
{
    const Powertrain *p = of->model->powertrain;
    quad omega_e = of->in[0], omega_t = of->out[TURBINE_SPEED];
    if (omega_e >= omega_t) {
        quad nu = (omega_t > 0 ? omega_t : 0) / (omega_e > 1 ? omega_e : 1);
        quad root = omega_e / lookup_at(&of->model->table[p->capacity], nu);
        of->out[PUMP_TORQUE] = e * root * root * fminq(1, (1 - nu) * 20);
        of->out[TURBINE_TORQUE] = lookup_at(&of->model->table[p->multiplication], nu) * of->out[PUMP_TORQUE];
    } else {
        quad nu = (omega_e > 0 ? omega_e : 0) / (omega_t > 1 ? omega_t : 1);
        quad root = omega_t / lookup_at(&of->model->table[p->capacity], nu);
        of->out[PUMP_TORQUE] = of->out[TURBINE_TORQUE] = -e * root * root * fminq(1, (1 - nu) * 20);
    }
}

/* The differential that an output belongs to; `wheel` or `differential` is -1. */
static int parent_of(const Powertrain *p, int wheel, int differential, int *output)
{
    for (int k = 0; k < p->differentials; ++k)
        for (*output = 0; *output < p->differential[k].outputs; ++*output)
            if (wheel >= 0 ? p->differential[k].wheel[*output] == wheel
                           : p->differential[k].differential[*output] == differential)
                return k;
    return -1;
}

/* Unknowns: spin accelerations of wheels, accelerations of inputs of differentials, torques behind the latter's
 * inertias. */
static void find_accelerations(Drive *of)
{
    const Powertrain *p = of->model->powertrain;
    int W = of->model->wheels, D = p->differentials, n = W + 2 * D, j;
    Factors *factors = factors_new(n);
    quad *a = factors->a, *x = grab((size_t)n, sizeof *x), i = of->out[RATIO];
    factors_clear(factors);
    for (int w = 0; w < W; ++w) {
        const Wheel *wheel = &of->model->wheel[w];
        int k = parent_of(p, w, -1, &j);
        a[w * n + w] = wheel->tire ? wheel->spin_inertia : 1;
        x[w] = of->in[LINE_IN + OF_WHEEL_IN * w + 1];
        if (k < 0)
            continue;
        a[w * n + W + D + k] = -(p->differential[k].ratio * part_of(&p->differential[k], j));
        x[w] += j ? -of->locked[k] : of->locked[k];
    }
    for (int k = 0; k < D; ++k) {
        const Differential *d = &p->differential[k];
        int motion = W + k, torque = W + D + k, parent = parent_of(p, -1, k, &j);
        a[motion * n + W + k] = 1;
        for (int o = 0; o < d->outputs; ++o)
            a[motion * n + (d->wheel[o] < 0 ? W + d->differential[o] : d->wheel[o])] = -d->ratio * part_of(d, o);
        a[torque * n + W + k] = d->inertia + (parent < 0 ? p->turbine * i * i : 0);
        a[torque * n + W + D + k] = 1;
        if (parent < 0) {
            x[torque] = i * of->out[TURBINE_TORQUE];
        } else {
            a[torque * n + W + D + parent] = -(p->differential[parent].ratio * part_of(&p->differential[parent], j));
            x[torque] = j ? -of->locked[parent] : of->locked[parent];
        }
    }
    if (!quad_factor(factors))
        fail("the powertrain's equations are singular");
    quad_solve(factors, x);
    for (int w = 0; w < W; ++w) {
        const quad *in = &of->in[LINE_IN + OF_WHEEL_IN * w];
        quad *out = &of->out[LINE_RESULTS + OF_WHEEL_OUT * w];
        out[0] = x[w];
        out[1] = of->model->wheel[w].spin_inertia * x[w] - in[1] + in[2];
    }
    free(x);
    factors_free(factors);
}

static void evaluate(Drive *of, const quad *in, quad *out)
{
    const Powertrain *p = of->model->powertrain;
    quad e;
    of->in = in;
    of->out = out;
    find_speeds(of);
    find_engine(of);
    out[RATIO] = find_ratio(of, &e);
    out[TURBINE_SPEED] = out[RATIO] * of->speed[p->differentials - 1];
    find_converter(of, e);
    find_accelerations(of);
    out[SPEED_RATE] = (out[ENGINE_TORQUE] - out[PUMP_TORQUE]) / p->inertia;
    out[AGE_RATE] = 1;
    out[ENGINE_SPEED] = in[0];
    out[GEAR] = of->line->gear[0];
}

void line_evaluate(const Model *model, const Configuration *configuration, const Line *line, WheelState *wheel,
                   LineState *state)
{
    const quad step = 1e-15, nothing = 1e-12; /* step: as in wheel.c */
    size_t W = (size_t)model->wheels, D = (size_t)model->powertrain->differentials;
    size_t ins = LINE_IN + OF_WHEEL_IN * W, outs = LINE_RESULTS + OF_WHEEL_OUT * W;
    quad *in = grab(2 * ins, sizeof *in), *size = in + ins, *out = grab(3 * outs, sizeof *out);
    quad *moved = out + outs, *scale = moved + outs;
    Drive of = {.model = model, .configuration = configuration, .line = line, .speed = grab(2 * D, sizeof *of.speed)};
    of.locked = of.speed + D;
    in[0] = line->speed;
    in[1] = line->age;
    size[0] = fabsq(in[0]);
    size[1] = fabsq(in[1]);
    for (size_t w = 0; w < W; ++w) {
        quad *own = in + LINE_IN + OF_WHEEL_IN * w, *own_size = size + LINE_IN + OF_WHEEL_IN * w;
        quad I = model->wheel[w].spin_inertia;
        own[0] = wheel[w].value[SPIN];
        own[1] = I * wheel[w].value[SPIN_RATE];
        own[2] = wheel[w].value[DRIVE];
        own_size[0] = wheel[w].scale[SPIN];
        own_size[1] = I * wheel[w].scale[SPIN_RATE];
        own_size[2] = wheel[w].scale[DRIVE];
    }
    evaluate(&of, in, out);
    for (size_t i = 0; i < outs; ++i)
        scale[i] = fabsq(out[i]);
    for (size_t k = 0; k < ins; ++k) {
        quad kept = in[k];
        in[k] += step * size[k];
        evaluate(&of, in, moved);
        in[k] = kept;
        for (size_t i = 0; i < outs; ++i)
            scale[i] += fabsq(moved[i] - out[i]) / step;
    }
    /* neither does it show terms of the engine's torque that cancel */
    const quad terms =
        law_size(model, configuration, model->powertrain->torque, (Locals){.speed = in[0], .throttle = out[THROTTLE]});
    scale[ENGINE_TORQUE] += terms;
    scale[SPEED_RATE] += terms / model->powertrain->inertia;
    /* A half shaft's torque is what is left of moments on the wheel that may cancel, which no change of one shows. In
     * neutral it may be nothing, but for what quad precision leaves of the moments on all wheels. */
    quad all = 0;
    for (size_t w = 0; w < W; ++w)
        all += size[LINE_IN + OF_WHEEL_IN * w + 1];
    for (size_t w = 0; w < W; ++w) {
        quad *own = &scale[LINE_RESULTS + OF_WHEEL_OUT * w];
        own[0] += nothing * all / model->wheel[w].spin_inertia;
        own[1] += nothing * all + size[LINE_IN + OF_WHEEL_IN * w + 1];
    }
    memcpy(state->value, out, sizeof state->value);
    memcpy(state->scale, scale, sizeof state->scale);
    for (int w = 0; w < model->wheels; ++w) {
        const quad *own = out + LINE_RESULTS + OF_WHEEL_OUT * w, *own_scale = scale + LINE_RESULTS + OF_WHEEL_OUT * w;
        if (!line_drives(model, w))
            continue;
        wheel_drive(model, configuration, w, own[1], own_scale[1], &wheel[w]);
        wheel[w].value[SPIN_RATE] = own[0];
        wheel[w].scale[SPIN_RATE] = own_scale[0];
    }
    free(in);
    free(out);
    free(of.speed);
}
