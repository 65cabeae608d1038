/* SPDX-License-Identifier: MIT
 * States at which the validation looks: the design at rest, each coordinate alone at the ends of its range, corners,
 * and others anywhere in it; the base in attitudes that people write (quarter and half turns about each axis) and in
 * any other; rates, inputs and ports of 0, 1 and -1 and of general numbers; to both sides of numbers at which formulas
 * may bend. Code for a scene is looked at at states, times and inputs that the scene can have. */
#include "base/random.h"
#include "base/table.h"
#include "model/model.h"
#include "specialize/specialize.h"
#include "validate/play.h"
#include "validate/run.h"
#include "validate/validate_private.h"
#include "vehicle/vehicle.h"

#include <math.h>
#include <string.h>

/* The special attitudes; indices from ATTITUDES on are general ones. */
enum { ATTITUDES = 11 };
static const double attitude[ATTITUDES][4] = {
    {1, 0, 0, 0},
    {0, 1, 0, 0},
    {0, 0, 1, 0},
    {0, 0, 0, 1},
    {0.70710678118654757, 0.70710678118654757, 0, 0},
    {0.70710678118654757, 0, 0.70710678118654757, 0},
    {0.70710678118654757, 0, 0, 0.70710678118654757},
    {0.70710678118654757, -0.70710678118654757, 0, 0},
    {0.70710678118654757, 0, 0, -0.70710678118654757},
    {0.5, 0.5, 0.5, 0.5},
    {0, 0.70710678118654757, 0.70710678118654757, 0},
};

/* ---- kinks ----------------------------------------------------------------------------------------------------------
 */

enum { KINK_TIME, KINK_VALUE, KINK_RATE, KINK_INPUT, KINK_SPIN, KINK_SORTS };

/* Numbers compared with a variable: at[from of it .. to of it - 1], ordered by sort and index. */
typedef struct Kink {
    int sort, index;
    double at;
} Kink;

struct Kinks {
    int count;
    Kink *kink;
};

/* The variables that a law reads, and its numbers. */
typedef struct LawParts {
    Pool *pool;
    const Model *model;
    int variables, numbers;
    Kink *variable;
    double *number;
} LawParts;

static void add_parts(LawParts *parts, const Law *law, int wheel)
{
    static const int sort[] = {
        [LAW_INPUT] = KINK_INPUT, [LAW_VALUE] = KINK_VALUE, [LAW_RATE] = KINK_RATE, [LAW_TIME] = KINK_TIME};
    switch (law->op) {
    case LAW_NUMBER: *POOL_PUSH(parts->pool, parts->number, parts->numbers) = law->number; break;
    case LAW_PARAMETER:
        *POOL_PUSH(parts->pool, parts->number, parts->numbers) = parts->model->parameter[law->index].value;
        break;
    case LAW_INPUT:
    case LAW_VALUE:
    case LAW_RATE:
    case LAW_TIME:
        *POOL_PUSH(parts->pool, parts->variable, parts->variables) =
            (Kink){sort[law->op], law->op == LAW_TIME ? 0 : law->index, 0};
        break;
    case LAW_LOCAL:
        if (wheel >= 0)
            *POOL_PUSH(parts->pool, parts->variable, parts->variables) = (Kink){KINK_SPIN, wheel, 0};
        break;
    case LAW_SIGNAL:
        if (parts->model->signal[law->index].law)
            add_parts(parts, parts->model->signal[law->index].law, wheel);
        break;
    case LAW_TABLE: {
        const Table *table = &parts->model->table[law->index];
        for (int i = 0; i < table->count; ++i)
            *POOL_PUSH(parts->pool, parts->number, parts->numbers) = table->x[i];
        break;
    }
    default: break;
    }
    for (int i = 0; i < 3 && law->arg[i]; ++i)
        add_parts(parts, law->arg[i], wheel);
}

static void add_kinks(Validator *v, const Law *law, int coordinate, int wheel)
{
    LawParts parts = {.pool = v->pool, .model = v->model};
    if (!law)
        return;
    add_parts(&parts, law, wheel);
    if (coordinate >= 0)
        *POOL_PUSH(v->pool, parts.variable, parts.variables) = (Kink){KINK_VALUE, coordinate, 0};
    for (int i = 0; i < parts.variables; ++i)
        for (int j = 0; j < parts.numbers; ++j) {
            parts.variable[i].at = parts.number[j];
            *POOL_PUSH(v->pool, v->kinks->kink, v->kinks->count) = parts.variable[i];
        }
}

void kinks_find(Validator *v)
{
    const Model *model = v->model;
    v->kinks = pool_alloc(v->pool, sizeof *v->kinks);
    for (int i = 0; i < model->forces; ++i) {
        const Force *force = &model->force[i];
        for (int j = 0; j < FORCE_MOST_LAWS; ++j)
            add_kinks(v, force->law[j], -1, -1);
        add_kinks(v, force->low, force->coordinate, -1);
        add_kinks(v, force->high, force->coordinate, -1);
    }
    for (int i = 0; i < model->wheels; ++i) {
        add_kinks(v, model->wheel[i].drive, -1, i);
        add_kinks(v, model->wheel[i].brake, -1, i);
    }
    if (model->powertrain) {
        add_kinks(v, model->powertrain->throttle, -1, -1);
        for (int i = 0; i < model->powertrain->differentials; ++i)
            add_kinks(v, model->powertrain->differential[i].lock, -1, -1);
    }
    for (int i = 0; v->scene && i < v->scene->moments; ++i)
        *POOL_PUSH(v->pool, v->kinks->kink, v->kinks->count) = (Kink){KINK_TIME, 0, v->scene->moment[i]};
}

/* A number slightly to one side of a kink of that variable, or `otherwise`. */
static double near_kink(const Validator *v, Random *random, int sort, int index, double otherwise)
{
    int count = 0;
    for (int i = 0; i < v->kinks->count; ++i)
        count += v->kinks->kink[i].sort == sort && v->kinks->kink[i].index == index;
    if (!count || random_bits(random) % 2)
        return otherwise;
    int which = (int)(random_bits(random) % (unsigned)count);
    for (int i = 0;; ++i)
        if (v->kinks->kink[i].sort == sort && v->kinks->kink[i].index == index && !which--) {
            const double at = v->kinks->kink[i].at, share = random_bits(random) % 2 ? 0.05 : -0.05;
            return at + share * (at == 0 ? 1 : at) * random_uniform(random, 0, 1);
        }
}

/* ---- numbers --------------------------------------------------------------------------------------------------------
 */

/* A number of magnitude up to `most`: 0, 1, -1 or a half of it as often as a general one. */
static double number(Random *random, double most)
{
    static const double nice[] = {0, 1, -1, 0.5};
    const double any = random_uniform(random, -1, 1);
    const uint64_t which = random_bits(random) % 8;
    return most * (which < 4 ? nice[which] : any);
}

/* A value within a range; of an angle at most three quarter turns to each side. */
static double place(Random *random, const Coordinate *c, int how)
{
    const double most = 4.7123889803846899, pi = 3.1415926535897931;
    double low = c->range[0], high = c->range[1];
    if (c->type == COORDINATE_ANGLE) {
        low = fmax(low, c->design - most);
        high = fmin(high, c->design + most);
    }
    if (how <= 1)
        return how ? high : low;
    if (c->type == COORDINATE_ANGLE && high - low > pi && random_bits(random) % 2)
        return fmin(fmax(c->design + pi / 2 * ((double)(random_bits(random) % 7) - 3), low), high);
    return random_uniform(random, low, high);
}

static void place_coordinates(const Validator *v, Random *random, int index, int k)
{
    const Model *model = v->model;
    Run *run = v->run;
    const int alone = index - 1, corner = alone - 2 * model->coordinates;
    for (int c = 0; c < model->coordinates; ++c) {
        const Coordinate *own = &model->coordinate[c];
        double x = own->design, rate = number(random, 2);
        if (alone >= 0 && corner < 0 && alone / 2 == c)
            x = place(random, own, alone % 2);
        else if (corner >= 0 && corner % 2 == 0)
            x = place(random, own, (int)(random_bits(random) % 2));
        else if (corner >= 0)
            x = place(random, own, 2);
        if (!index)
            rate = 0;
        if (index % 4 == 2) {
            x = fmin(fmax(near_kink(v, random, KINK_VALUE, c, x), own->range[0]), own->range[1]);
            rate = near_kink(v, random, KINK_RATE, c, rate);
        }
        if (own->driven) {
            run->u[own->input][k] = x;
            run->u[own->input + 1][k] = rate;
            run->u[own->input + 2][k] = index ? number(random, 3) : 0;
        } else {
            run->y[run->plan->coordinate_state[c]][k] = x;
            run->y[run->plan->coordinate_rate[c]][k] = rate;
        }
    }
}

/* Every other state has a heavy base about on its wheels, so that the road matters. */
static void place_base(const Validator *v, Random *random, int index, int k)
{
    const Body *base = &v->model->body[BODY_BASE];
    Run *run = v->run;
    const int twist = 7 + run->plan->free_coordinates, which = index / 2 % (ATTITUDES + 5);
    double e[4], norm = 0;
    for (int i = 0; i < 4; ++i) {
        e[i] = index % 2 && which < ATTITUDES ? attitude[which][i]
               : index % 2                    ? random_uniform(random, -1, 1)
               : index                        ? base->euler[i] + 0.02 * random_uniform(random, -1, 1)
                                              : base->euler[i];
        norm += e[i] * e[i];
    }
    for (int i = 0; i < 4; ++i)
        run->y[3 + i][k] = e[i] / sqrt(norm);
    for (int i = 0; i < 3; ++i) {
        run->y[i][k] = base->position[i] + (index ? (i == 2 ? 0.05 : 3) * number(random, 1) : 0);
        run->y[twist + i][k] = index ? number(random, 10) : 0;
        run->y[twist + 3 + i][k] = index ? number(random, 1) : 0;
    }
}

static void place_fast(const Validator *v, Random *random, int index, int k)
{
    const Model *model = v->model;
    Run *run = v->run;
    Values *fast = run->y + run->plan->states;
    for (int i = 0; i < model->wheels; ++i) {
        const Wheel *wheel = &model->wheel[i];
        if (wheel->tire < 0)
            continue;
        fast[wheel->fast + FAST_SPIN][k] =
            index ? near_kink(v, random, KINK_SPIN, i, number(random, 10 / model->tire[wheel->tire].radius)) : 0;
        for (int s = FAST_SLIP_X; s < wheel_fast_states(wheel); ++s)
            fast[wheel->fast + s][k] = index ? number(random, s == FAST_BRAKE ? 0.01 : 0.3) : 0;
    }
    for (int i = 0; i < model->states; ++i)
        fast[model->state[i].fast][k] =
            index ? number(random, 1 + fabs(model->state[i].initial)) : model->state[i].initial;
    if (!model->powertrain)
        return;
    const Powertrain *powertrain = model->powertrain;
    for (int i = 0; i < POWERTRAIN_DISCRETE; ++i)
        run->gear[i][k] =
            index ? (double)(int)(random_bits(random) % (unsigned)(powertrain->reverse + 1 + powertrain->forward)) -
                        powertrain->reverse
                  : powertrain->start_gear;
    fast[powertrain->fast + POWERTRAIN_SPEED][k] =
        powertrain->idle + (index ? random_uniform(random, 0, 3 * powertrain->idle + 10) : 0);
    fast[powertrain->fast + POWERTRAIN_AGE][k] =
        index % 3 == 1 ? random_uniform(random, 0, powertrain->duration) : POWERTRAIN_FIRST_AGE;
}

static void place_inputs(const Validator *v, Random *random, int index, int k)
{
    const Model *model = v->model;
    Run *run = v->run;
    run->time[k] = index ? near_kink(v, random, KINK_TIME, 0, random_uniform(random, 0, 10)) : 0;
    for (int i = 0; i < model->inputs; ++i) {
        const double any = model->input[i].initial + number(random, 1);
        run->u[i][k] = index ? near_kink(v, random, KINK_INPUT, i, any) : model->input[i].initial;
    }
    for (int i = 0; i < 6 * model->ports; ++i)
        run->port[i][k] = index ? number(random, 100) : 0;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *own = &model->parameter[i];
        if (own->tunable && own->geometric)
            run->p[own->index][k] = v->geometry ? v->geometry[own->index] : own->value;
        else if (own->tunable)
            run->p[own->index][k] = index % 4 == 3 ? own->value * (1 + 0.1 * number(random, 1)) : own->value;
    }
}

/* ---- states of a scene */

static void place_scene_inputs(const Validator *v, Random *random, int index, int k)
{
    const Facts *facts = v->facts;
    const Model *model = v->model;
    double input[model->inputs + 1];
    double time = near_kink(v, random, KINK_TIME, 0, random_uniform(random, 0, v->scene->duration));
    time = index ? fmin(fmax(time, 0), v->scene->duration) : 0;
    for (int i = 0; i < model->inputs; ++i)
        input[i] = facts->input[i];
    v->scene->inputs(v->scene->context, 0, time, input);
    v->run->time[k] = time;
    for (int i = 0; i < model->inputs; ++i)
        if (facts->fixed[i] || !v->scene->free[i])
            v->run->u[i][k] = input[i];
    for (int i = 0; i < 6 * model->ports && facts->idle; ++i)
        v->run->port[i][k] = 0;
    for (int i = 0; i < model->parameters && facts->parameter; ++i)
        if (model->parameter[i].tunable)
            v->run->p[model->parameter[i].index][k] = model->parameter[i].value;
    for (int i = 0; i < POWERTRAIN_DISCRETE && facts->neutral; ++i)
        v->run->gear[i][k] = 0;
}

/* The base moves in its own plane y = 0; both sides are mirror images of each other. */
static void place_even(const Validator *v, int k)
{
    const Model *model = v->model;
    Run *run = v->run;
    const Plan *plan = run->plan;
    const int twist = 7 + plan->free_coordinates;
    double *const odd[] = {run->y[4], run->y[6], run->y[twist + 1], run->y[twist + 3], run->y[twist + 5]};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; ++i)
        odd[i][k] = 0;
    const double norm = hypot(run->y[3][k], run->y[5][k]);
    run->y[3][k] = norm > 0.1 ? run->y[3][k] / norm : 1;
    run->y[5][k] = norm > 0.1 ? run->y[5][k] / norm : 0;
    for (int c = 0; c < model->coordinates; ++c) {
        const int image = v->mirror->coordinate[c], state = plan->coordinate_state[c], rate = plan->coordinate_rate[c];
        const double sign = v->mirror->sign[c];
        if (state < 0)
            continue;
        if (image == c && sign < 0) {
            run->y[state][k] = model->coordinate[c].design;
            run->y[rate][k] = 0;
        } else if (image < c) {
            run->y[state][k] = sign * run->y[plan->coordinate_state[image]][k];
            run->y[rate][k] = sign * run->y[plan->coordinate_rate[image]][k];
        }
    }
    for (int i = 0; i < model->wheels; ++i)
        for (int s = 0; model->wheel[i].tire >= 0 && v->mirror->wheel[i] < i && s < wheel_fast_states(&model->wheel[i]);
             ++s)
            run->y[plan->states + model->wheel[i].fast + s][k] =
                wheel_fast_sign(s) * run->y[plan->states + model->wheel[v->mirror->wheel[i]].fast + s][k];
}

void state_place(const Validator *v, int index, int k)
{
    Random random = {.state = (uint64_t)index * 7919u + 1};
    place_inputs(v, &random, index, k);
    place_coordinates(v, &random, index, k);
    if (v->model->free_base)
        place_base(v, &random, index, k);
    if (v->model->fast_states)
        place_fast(v, &random, index, k);
    if (v->facts)
        place_scene_inputs(v, &random, index, k);
    if (v->mirror)
        place_even(v, k);
}
