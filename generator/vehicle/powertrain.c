/* SPDX-License-Identifier: MIT
 * The powertrain (models/POWERTRAIN.md sections 3 and 4): its part in the equations of the wheels' spins, and the
 * numbers that decide on a change of gear. */
#include "expression/expression.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

/* Values that both blocks share. */
typedef struct Shafts {
    const Model *model;
    const Powertrain *powertrain;
    Dag *dag;
    int wheels, *wheel;   /* the driven wheels, in the order of the model */
    Ex *spin;             /* [wheels] */
    Ex *speed;            /* [differentials] of the input */
    double **coefficient; /* [differentials][wheels] speed of the input per unit spin */
    Ex ratio, engaged;    /* i, e */
    Ex turbine;           /* omega_t */
} Shafts;

/* ---- speeds -------------------------------------------------------------------------------------------------- */

static Ex input(Dag *dag, Array array, int index)
{
    return ex_input(dag, element_at(array, index), NULL);
}

static bool in_tree(const Powertrain *powertrain, int wheel)
{
    for (int i = 0; i < powertrain->differentials; ++i)
        if (powertrain->differential[i].wheel[0] == wheel || powertrain->differential[i].wheel[1] == wheel)
            return true;
    return false;
}

static int place_of(const Shafts *shafts, int wheel)
{
    int i = 0;
    while (shafts->wheel[i] != wheel)
        ++i;
    return i;
}

/* Speed of an output of a differential. */
static Ex output_speed(const Shafts *shafts, const Differential *differential, int which)
{
    int wheel = differential->wheel[which];
    return wheel >= 0 ? shafts->spin[place_of(shafts, wheel)] : shafts->speed[differential->differential[which]];
}

static void differential_speed(Shafts *shafts, int index)
{
    Dag *dag = shafts->dag;
    const Differential *differential = &shafts->powertrain->differential[index];
    shafts->speed[index] = 0;
    for (int k = 0; k < differential->outputs; ++k) {
        const double weight = differential->ratio * (k ? 1 - differential->split : differential->split);
        const int other = differential->differential[k];
        Ex part = ex_mul(dag, ex_literal(dag, weight), output_speed(shafts, differential, k));
        shafts->speed[index] = ex_add(dag, shafts->speed[index], part);
        for (int i = 0; i < shafts->wheels; ++i)
            shafts->coefficient[index][i] +=
                weight * (other >= 0 ? shafts->coefficient[other][i] : shafts->wheel[i] == differential->wheel[k]);
    }
}

/* before + share (now - before) */
static Ex between(Dag *dag, Ex before, Ex now, Ex share)
{
    return ex_add(dag, before, ex_mul(dag, share, ex_sub(dag, now, before)));
}

static Shafts shafts_new(Whole *whole)
{
    Dag *dag = whole->dag;
    const Powertrain *powertrain = whole->model->powertrain;
    const size_t wheels = (size_t)whole->model->wheels, differentials = (size_t)powertrain->differentials;
    Shafts shafts = {.model = whole->model,
                     .powertrain = powertrain,
                     .dag = dag,
                     .wheel = pool_alloc(dag->pool, wheels * sizeof *shafts.wheel),
                     .spin = pool_alloc(dag->pool, wheels * sizeof *shafts.spin),
                     .speed = pool_alloc(dag->pool, differentials * sizeof *shafts.speed),
                     .coefficient = pool_alloc(dag->pool, differentials * sizeof *shafts.coefficient)};
    for (int i = 0; i < whole->model->wheels; ++i)
        if (in_tree(powertrain, i)) {
            shafts.spin[shafts.wheels] = input(dag, ARRAY_fast, whole->model->wheel[i].fast + FAST_SPIN);
            shafts.wheel[shafts.wheels++] = i;
        }
    for (int i = 0; i < powertrain->differentials; ++i) {
        shafts.coefficient[i] = pool_alloc(dag->pool, wheels * sizeof **shafts.coefficient);
        differential_speed(&shafts, i);
    }
    Ex age = input(dag, ARRAY_fast, powertrain->fast + POWERTRAIN_AGE);
    Ex share = smooth_step(dag, ex_mul(dag, ex_literal(dag, 1 / powertrain->duration), age));
    shafts.ratio = between(dag, input(dag, ARRAY_gear, GEAR_RATIO + 1), input(dag, ARRAY_gear, GEAR_RATIO), share);
    shafts.engaged =
        between(dag, input(dag, ARRAY_gear, GEAR_ENGAGED + 1), input(dag, ARRAY_gear, GEAR_ENGAGED), share);
    shafts.turbine = ex_mul(dag, shafts.ratio, shafts.speed[powertrain->differentials - 1]);
    return shafts;
}

/* ---- engine and converter ------------------------------------------------------------------------------------ */

static Ex throttle(const Linking *l, const Powertrain *powertrain, Ex demand, Ex speed)
{
    const double governed = 0.2, fading = 0.05; /* width of the bands below idle and limit, relative to these */
    Dag *dag = l->formulas->dag;
    const double idle = powertrain->idle, limit = powertrain->limit;
    if (idle > 0) {
        Ex below = ex_sub(dag, ex_literal(dag, idle), speed);
        demand = ex_op(dag, OP_MAX, demand, ex_mul(dag, ex_literal(dag, 1 / (governed * idle)), below), 0);
    }
    Ex theta = ex_op(dag, OP_MIN, positive_part(dag, demand), ex_literal(dag, 1), 0);
    if (limit > 0) {
        Ex below = ex_sub(dag, ex_literal(dag, limit), speed);
        theta = ex_mul(dag, theta, smooth_step(dag, ex_mul(dag, ex_literal(dag, 1 / (fading * limit)), below)));
    }
    return theta;
}

/* Torques of pump and turbine. In overrun the turbine drives the pump. */
static void converter(const Shafts *shafts, Ex speed, Ex *pump, Ex *turbine)
{
    const double coupled = 0.05; /* relative difference of speeds below which the torque fades */
    Dag *dag = shafts->dag;
    Ex one = ex_literal(dag, 1), over = ex_sub(dag, shafts->turbine, speed);
    Ex driving = ex_op(dag, OP_POSITIVE, over, shafts->turbine, speed);
    Ex driven = ex_op(dag, OP_POSITIVE, over, speed, shafts->turbine);
    Ex nu = ex_div(dag, positive_part(dag, driven), ex_op(dag, OP_MAX, driving, one, 0));
    Ex slip = ex_mul(dag, ex_literal(dag, 1 / coupled), ex_sub(dag, one, nu));
    Ex root = ex_div(dag, driving, ex_op(dag, OP_TABLE, nu, (Ex)shafts->powertrain->capacity, 0));
    Ex torque = ex_mul(dag, shafts->engaged, ex_mul(dag, root, root));
    torque = ex_mul(dag, torque, ex_op(dag, OP_MIN, one, slip, 0));
    Ex multiplied = ex_mul(dag, ex_op(dag, OP_TABLE, nu, (Ex)shafts->powertrain->multiplication, 0), torque);
    *pump = ex_op(dag, OP_POSITIVE, over, ex_neg(dag, torque), torque);
    *turbine = ex_op(dag, OP_POSITIVE, over, ex_neg(dag, torque), multiplied);
}

/* ---- torques of the tree, and the wheels' accelerations ------------------------------------------------------- */

/* The torque that the tree passes to each wheel, from the torque at the root's input. */
static void pass(Linking *l, const Shafts *shafts, Ex torque, Ex *onto)
{
    Dag *dag = shafts->dag;
    const int count = shafts->powertrain->differentials;
    Ex at[count];
    at[count - 1] = torque;
    for (int i = count - 1; i >= 0; --i) {
        const Differential *differential = &shafts->powertrain->differential[i];
        Ex lock = 0;
        if (differential->lock) {
            Ex apart = ex_sub(dag, output_speed(shafts, differential, 1), output_speed(shafts, differential, 0));
            const Ex most = ex_op(dag, OP_MAX, fast_law(l, differential->lock, NULL), 0, 0);
            lock = ex_mul(dag, most, ex_op(dag, OP_TANH, apart, 0, 0));
        }
        for (int k = 0; k < differential->outputs; ++k) {
            const double weight = differential->ratio * (k ? 1 - differential->split : differential->split);
            Ex out = ex_mul(dag, ex_literal(dag, weight), at[i]);
            out = k ? ex_sub(dag, out, lock) : ex_add(dag, out, lock);
            if (differential->differential[k] >= 0)
                at[differential->differential[k]] = out;
            else
                onto[place_of(shafts, differential->wheel[k])] = out;
        }
    }
}

/* The equations A s' = b of the wheels' spins with all inertias that turn with them. */
typedef struct Spins {
    Ex *A, *b;           /* [wheels][wheels], [wheels] */
    Ex *inertia, *alone; /* [wheels] of the wheel itself; s' without the powertrain */
} Spins;

static Spins spins_new(Linking *l, const Shafts *shafts, Ex torque)
{
    Dag *dag = shafts->dag;
    const int n = shafts->wheels, differentials = shafts->powertrain->differentials;
    const size_t wheels = (size_t)n;
    Spins spins = {.A = pool_alloc(dag->pool, (wheels * wheels + 1) * sizeof(Ex)),
                   .b = pool_alloc(dag->pool, (wheels + 1) * sizeof(Ex)),
                   .inertia = pool_alloc(dag->pool, (wheels + 1) * sizeof(Ex)),
                   .alone = pool_alloc(dag->pool, (wheels + 1) * sizeof(Ex))};
    Ex onto[n];
    Ex turbine = ex_mul(dag, ex_literal(dag, shafts->powertrain->turbine), ex_mul(dag, shafts->ratio, shafts->ratio));
    pass(l, shafts, torque, onto);
    for (int i = 0; i < n; ++i) {
        const Wheel *wheel = &shafts->model->wheel[shafts->wheel[i]];
        spins.inertia[i] = ex_literal(dag, wheel->spin_inertia);
        spins.alone[i] = input(dag, ARRAY_rate, wheel->fast + FAST_SPIN);
        spins.b[i] = ex_add(dag, ex_mul(dag, spins.inertia[i], spins.alone[i]), onto[i]);
        for (int j = 0; j < n; ++j) {
            double sum = i == j ? wheel->spin_inertia : 0;
            for (int k = 0; k < differentials; ++k)
                sum +=
                    shafts->powertrain->differential[k].inertia * shafts->coefficient[k][i] * shafts->coefficient[k][j];
            const double *root = shafts->coefficient[differentials - 1];
            spins.A[n * i + j] =
                ex_add(dag, ex_literal(dag, sum), ex_mul(dag, turbine, ex_literal(dag, root[i] * root[j])));
        }
    }
    return spins;
}

/* Store the rates s' of the spins and the resulting torques of the half shafts. */
static void store_spins(const Shafts *shafts, const Spins *spins, const Ex *rate, Block *block)
{
    Dag *dag = shafts->dag;
    for (int i = 0; i < shafts->wheels; ++i) {
        const int index = shafts->wheel[i], grip = GRIP_NUMBERS * wheel_rolling(shafts->model, index);
        const Wheel *wheel = &shafts->model->wheel[index];
        Ex drive = wheel->drive ? input(dag, ARRAY_grip, grip + GRIP_DRIVE) : 0;
        Ex more = ex_mul(dag, spins->inertia[i], ex_sub(dag, rate[i], spins->alone[i]));
        block_store(block, rate[i], element_at(ARRAY_rate, wheel->fast + FAST_SPIN));
        block_store(block, ex_add(dag, drive, more), element_at(ARRAY_grip, grip + GRIP_DRIVE));
        Ex power = ex_mul(dag, ex_mul(dag, spins->inertia[i], rate[i]), shafts->spin[i]);
        block_store(block, power, element_at(ARRAY_grip, grip + GRIP_POWER));
    }
}

/* For rates of the spins given as acc[], by index among the fast states: store the residual of their equations in
 * left[], and all results as the block that solves the equations does. */
static void store_left(const Shafts *shafts, const Spins *spins, Block *block)
{
    Dag *dag = shafts->dag;
    const int n = shafts->wheels;
    Ex rate[n];
    for (int i = 0; i < n; ++i)
        rate[i] = input(dag, ARRAY_acc, shafts->model->wheel[shafts->wheel[i]].fast + FAST_SPIN);
    for (int i = 0; i < n; ++i) {
        Ex left = 0;
        for (int j = 0; j < n; ++j)
            left = ex_add(dag, left, ex_mul(dag, spins->A[n * i + j], rate[j]));
        left = ex_sub(dag, left, spins->b[i]);
        block_store(block, left, element_at(ARRAY_left, shafts->model->wheel[shafts->wheel[i]].fast + FAST_SPIN));
    }
    store_spins(shafts, spins, rate, block);
}

/* ---- the blocks ---------------------------------------------------------------------------------------------------
 */

static void drive_block(Linking *l, const Powertrain *powertrain, Block *block)
{
    Dag *dag = block->dag = l->formulas->dag;
    const Shafts shafts = shafts_new(l->formulas);
    Ex pump, turbine, speed = input(dag, ARRAY_fast, powertrain->fast + POWERTRAIN_SPEED);
    Ex theta = throttle(l, powertrain, fast_law(l, powertrain->throttle, NULL), speed);
    Ex torque = fast_law(l, powertrain->torque, (const Ex[]){speed, theta});
    /* nothing turns an engine backwards: a negative torque fades out as the engine stops */
    Ex holds = ex_mul(dag, ex_op(dag, OP_MIN, torque, 0, 0), smooth_step(dag, speed));
    torque = ex_add(dag, positive_part(dag, torque), holds);
    converter(&shafts, speed, &pump, &turbine);
    const Spins spins = spins_new(l, &shafts, ex_mul(dag, shafts.ratio, turbine));
    Ex rates[shafts.wheels];
    linear_solve(dag, linear_factor_symmetric(dag, shafts.wheels, spins.A, NULL, 0), spins.b, rates);
    store_spins(&shafts, &spins, rates, block);
    Ex rate = ex_div(dag, ex_sub(dag, torque, pump), ex_literal(dag, powertrain->inertia));
    block_store(block, rate, element_at(ARRAY_rate, powertrain->fast + POWERTRAIN_SPEED));
    block_store(block, ex_literal(dag, 1), element_at(ARRAY_rate, powertrain->fast + POWERTRAIN_AGE));
    const Ex watch[WATCH_NUMBERS] = {
        [WATCH_ENGINE_SPEED] = speed,     [WATCH_ENGINE_TORQUE] = torque,
        [WATCH_THROTTLE] = theta,         [WATCH_GEAR] = input(dag, ARRAY_gear, GEAR_NUMBER),
        [WATCH_RATIO] = shafts.ratio,     [WATCH_TURBINE_SPEED] = shafts.turbine,
        [WATCH_TURBINE_TORQUE] = turbine, [WATCH_PUMP_TORQUE] = pump};
    for (int i = 0; i < WATCH_NUMBERS; ++i)
        block_store(block, watch[i], element_at(ARRAY_watch, i));
    l->wheels->spins.dag = dag;
    store_left(&shafts, &spins, &l->wheels->spins);
}

static void shift_block(Whole *whole, const Powertrain *powertrain, Block *block)
{
    Dag *dag = block->dag = whole->dag;
    const Ex always = ex_literal(dag, 1);
    block_store(block, powertrain->selector ? whole_law(whole, powertrain->selector, NULL) : always,
                element_at(ARRAY_choice, CHOICE_SELECTOR));
    block_store(block, shafts_new(whole).turbine, element_at(ARRAY_choice, CHOICE_TURBINE));
    for (int i = 0; i < powertrain->forward - 1; ++i) {
        block_store(block, whole_law(whole, powertrain->up[i], NULL), element_at(ARRAY_choice, CHOICE_UP + i));
        block_store(block, whole_law(whole, powertrain->down[i], NULL),
                    element_at(ARRAY_choice, CHOICE_UP + powertrain->forward - 1 + i));
    }
}

void powertrain_formulate(Pool *pool, Linking *l)
{
    const Powertrain *powertrain = l->whole->model->powertrain;
    drive_block(l, powertrain, &l->wheels->drive);
    Whole *shift = whole_new(pool, l->whole->plan);
    for (int i = 0; i < shift->model->states; ++i)
        shift->z[i] = ex_input(shift->dag, element_at(ARRAY_fast, shift->model->state[i].fast), NULL);
    shift_block(shift, powertrain, &l->wheels->shift);
}
