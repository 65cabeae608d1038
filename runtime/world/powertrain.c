/* SPDX-License-Identifier: MIT
 * The powertrain, models/POWERTRAIN.md, in its notation. A tree is gone through in the order of the model, outputs
 * before what drives them, or back. */
#include "base/table.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "world/dense.h"
#include "world/wheel.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* S(s) */
static double smooth(double s)
{
    s = fmin(fmax(s, 0), 1);
    return s * s * (3 - 2 * s);
}

static double table_at(const World *world, int index, double x)
{
    const Table *table = &world->model->table[index];
    const gic_table t = {table->x, table->y, table->slope, table->count, table->cubic, table->onward};
    return gic_table_value(&t, x);
}

static double spin_of(const World *world, const double *fast, int wheel)
{
    return fast[world->model->wheel[wheel].fast + FAST_SPIN];
}

/* The part of an output in the mean speed of both, and in the torque. */
static double share(const Differential *d, int output)
{
    return d->outputs == 1 ? 1 : output == 0 ? d->split : 1 - d->split;
}

/* Input speeds of all differentials, rad/s; difference[]: omega_2 - omega_1. */
static void tree_speeds(const World *world, const double *fast, double *speed, double *difference)
{
    const Powertrain *p = world->model->powertrain;
    for (int k = 0; k < p->differentials; ++k) {
        const Differential *d = &p->differential[k];
        double out[2] = {0, 0}, mean = 0;
        for (int j = 0; j < d->outputs; ++j) {
            out[j] = d->wheel[j] >= 0 ? spin_of(world, fast, d->wheel[j]) : speed[d->differential[j]];
            mean += share(d, j) * out[j];
        }
        speed[k] = d->ratio * mean;
        difference[k] = out[1] - out[0];
    }
}

/* i, and e as the part of the torque that the transmission lets through. */
static double ratio_of(const World *world, double age, double *engaged)
{
    const Powertrain *p = world->model->powertrain;
    const double b = smooth(age / p->duration);
    double ratio[POWERTRAIN_DISCRETE], in_gear[POWERTRAIN_DISCRETE];
    for (int i = 0; i < POWERTRAIN_DISCRETE; ++i) {
        ratio[i] = p->gear[p->reverse + world->gear[i]];
        in_gear[i] = world->gear[i] != 0;
    }
    *engaged = in_gear[POWERTRAIN_BEFORE] + b * (in_gear[POWERTRAIN_GEAR] - in_gear[POWERTRAIN_BEFORE]);
    return ratio[POWERTRAIN_BEFORE] + b * (ratio[POWERTRAIN_GEAR] - ratio[POWERTRAIN_BEFORE]);
}

/* T_p and T_t of the converter. */
static void converter(const World *world, double engine, double turbine, double engaged, double *pump, double *driven)
{
    const Powertrain *p = world->model->powertrain;
    const bool overrun = engine < turbine;
    const double fast = overrun ? turbine : engine, slow = overrun ? engine : turbine;
    const double nu = fmax(slow, 0) / fmax(fast, 1), part = fast / table_at(world, p->capacity, nu);
    const double torque = engaged * part * part * fmin(1, (1 - nu) / 0.05);
    *pump = overrun ? -torque : torque;
    *driven = overrun ? -torque : torque * table_at(world, p->multiplication, nu);
}

/* Throttle and torque of the engine. */
static void run_engine(const World *world, double speed, Driveline *out)
{
    const Powertrain *p = world->model->powertrain;
    double throttle = fmax(0, world_law(world, p->throttle, NULL));
    if (p->idle > 0)
        throttle = fmax(throttle, (p->idle - speed) / (0.2 * p->idle));
    throttle = fmin(1, throttle);
    if (p->limit > 0)
        throttle *= smooth((p->limit - speed) / (0.05 * p->limit));
    out->throttle = throttle;
    out->engine_torque = world_law(world, p->torque, (const double[]){speed, throttle});
    if (out->engine_torque < 0)
        out->engine_torque *= smooth(speed);
}

/* What the tree, driven by `torque` at its root, passes to each of its wheels; lists them, and returns how many. */
static int pass_torque(const World *world, double torque, const double *difference, int *wheel, double *passed)
{
    const Powertrain *p = world->model->powertrain;
    double input[p->differentials];
    int wheels = 0;
    input[p->differentials - 1] = torque;
    for (int k = p->differentials - 1; k >= 0; --k) {
        const Differential *d = &p->differential[k];
        const double most = d->lock && d->outputs == 2 ? fmax(world_law(world, d->lock, NULL), 0) : 0;
        const double lock = most * tanh(difference[k]);
        for (int j = 0; j < d->outputs; ++j) {
            const double out = d->ratio * input[k] * share(d, j) + (j == 0 ? lock : -lock);
            if (d->wheel[j] < 0) {
                input[d->differential[j]] = out;
            } else {
                wheel[wheels] = d->wheel[j];
                passed[wheels++] = out;
            }
        }
    }
    return wheels;
}

/* d omega / d Omega of one inertia after the other by the listed wheels: of the differentials' inputs, then of the
 * turbine. */
static void find_slopes(const World *world, int wheels, const int *wheel, double *slope)
{
    const Powertrain *p = world->model->powertrain;
    for (int k = 0; k < p->differentials; ++k, slope += wheels) {
        const Differential *d = &p->differential[k];
        memset(slope, 0, sizeof *slope * (size_t)wheels);
        for (int j = 0; j < d->outputs; ++j) {
            const double part = d->ratio * share(d, j);
            const double *other = slope - (k - d->differential[j]) * wheels; /* if the output is not a wheel */
            for (int w = 0; w < wheels; ++w)
                slope[w] += d->wheel[j] < 0 ? part * other[w] : wheel[w] == d->wheel[j] ? part : 0;
        }
    }
    for (int w = 0; w < wheels; ++w)
        slope[w] = world->driveline.ratio * slope[w - wheels];
}

/* Spin accelerations of the wheels, which turn the driveline with them, and half shaft torques. */
static void turn_wheels(World *world, int wheels, const int *wheel, const double *passed, const double *fast,
                        double *rate)
{
    const Powertrain *p = world->model->powertrain;
    const int inertias = p->differentials + 1;
    double slope[inertias * wheels], A[wheels * wheels], spin_rate[wheels];
    int swap[wheels];
    find_slopes(world, wheels, wheel, slope);
    memset(A, 0, sizeof A);
    for (int w = 0; w < wheels; ++w) {
        const Rolling *rolling = &world->rolling[wheel[w]];
        A[w * wheels + w] = world->model->wheel[wheel[w]].spin_inertia;
        spin_rate[w] = rolling->about + rolling->drive - rolling->brake + passed[w];
    }
    for (int k = 0; k < inertias; ++k) {
        const double J = k < p->differentials ? p->differential[k].inertia : p->turbine, *c = slope + k * wheels;
        for (int v = 0; v < wheels; ++v)
            for (int w = 0; w < wheels; ++w)
                A[v * wheels + w] += J * c[v] * c[w];
    }
    dense_factor(wheels, A, swap); /* positive definite; what is not finite is found in the rates */
    dense_solve(wheels, A, swap, spin_rate);
    for (int w = 0; w < wheels; ++w) {
        const Wheel *of = &world->model->wheel[wheel[w]];
        Rolling *rolling = &world->rolling[wheel[w]];
        rate[of->fast + FAST_SPIN] = spin_rate[w];
        wheel_drive(&world->motion[wheel[w]], spin_of(world, fast, wheel[w]),
                    of->spin_inertia * spin_rate[w] - rolling->about + rolling->brake, rolling);
    }
}

void world_drive(World *world, const double *fast, double *rate)
{
    const Powertrain *p = world->model->powertrain;
    const double engine = fast[p->fast + POWERTRAIN_SPEED], age = fast[p->fast + POWERTRAIN_AGE];
    Driveline *out = &world->driveline;
    double speed[p->differentials], difference[p->differentials], passed[p->differentials + 1], engaged;
    int wheel[p->differentials + 1]; /* a tree with two outputs a node has one more end than nodes */
    tree_speeds(world, fast, speed, difference);
    out->ratio = ratio_of(world, age, &engaged);
    out->turbine_speed = out->ratio * speed[p->differentials - 1];
    run_engine(world, engine, out);
    converter(world, engine, out->turbine_speed, engaged, &out->pump_torque, &out->turbine_torque);
    rate[p->fast + POWERTRAIN_SPEED] = (out->engine_torque - out->pump_torque) / p->inertia;
    rate[p->fast + POWERTRAIN_AGE] = 1;
    const int wheels = pass_torque(world, out->ratio * out->turbine_torque, difference, wheel, passed);
    turn_wheels(world, wheels, wheel, passed, fast, rate);
}

/* ---- shifting -------------------------------------------------------------------------------------------- */

/* Rounding does not decide: a time is up by this share of itself early, numbers that are as near are equal. */
static const double tolerance = 1e-9;

static bool is_up(double age, double time)
{
    return time - age <= tolerance * time;
}

/* 1, -1: more or less than the limit; 0: equal. */
static int compare(double x, double limit)
{
    const double apart = (x - limit) / (1 + fabs(limit));
    return (apart > tolerance) - (apart < -tolerance);
}

/* The direction that the selector asks for. */
static int wanted_direction(const World *world)
{
    const Powertrain *p = world->model->powertrain;
    const double selector = p->selector ? world_law(world, p->selector, NULL) : 1;
    return (compare(selector, 0.5) > 0) - (p->reverse && compare(selector, -0.5) < 0);
}

bool world_shift(const World *world, const double *fast, int32_t gear[POWERTRAIN_DISCRETE])
{
    const Powertrain *p = world->model->powertrain;
    const double age = fast[p->fast + POWERTRAIN_AGE];
    const int32_t now = gear[POWERTRAIN_GEAR];
    int32_t next = now;
    double speed[p->differentials], difference[p->differentials], engaged;
    if (!is_up(age, p->duration))
        return false;
    const int wanted = wanted_direction(world);
    if (wanted != (now > 0) - (now < 0)) {
        next = wanted;
    } else if (is_up(age, p->latency) && now >= 1) {
        tree_speeds(world, fast, speed, difference);
        const double turbine = ratio_of(world, age, &engaged) * speed[p->differentials - 1];
        if (now < p->forward && compare(turbine, world_law(world, p->up[now - 1], NULL)) > 0)
            next = now + 1;
        else if (now > 1 && compare(turbine, world_law(world, p->down[now - 2], NULL)) < 0)
            next = now - 1;
    }
    if (next == now)
        return false;
    gear[POWERTRAIN_BEFORE] = now;
    gear[POWERTRAIN_GEAR] = next;
    return true;
}

static bool uses_coordinates(const Law *law)
{
    if (!law)
        return false;
    if (law->op == LAW_VALUE || law->op == LAW_RATE)
        return true;
    return uses_coordinates(law->arg[0]) || uses_coordinates(law->arg[1]) || uses_coordinates(law->arg[2]);
}

bool powertrain_watches_coordinates(const Powertrain *powertrain)
{
    bool any = uses_coordinates(powertrain->selector);
    for (int i = 0; i < powertrain->forward - 1; ++i)
        any |= uses_coordinates(powertrain->up[i]) || uses_coordinates(powertrain->down[i]);
    return any;
}
