/* SPDX-License-Identifier: MIT
 * States at which the validation looks: the design at rest, each coordinate alone at the ends of its range, corners,
 * and others anywhere in it; the base in attitudes that people write (quarter and half turns about each axis) and in any
 * other; rates, inputs and ports of 0, 1 and -1 and of general numbers. */
#include "validate_work.h"

#include "powertrain.h"

#include <math.h>
#include <string.h>

/* Attitudes in turn; from ATTITUDES on general ones. */
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

/* A number of size `most`: 0, 1, -1 or a half of it as often as any. */
static double number(Random *random, double most)
{
    static const double nice[] = {0, 1, -1, 0.5};
    const double any = random_uniform(random, -1, 1);
    const uint64_t which = random_bits(random) % 8;
    return most * (which < 4 ? nice[which] : any);
}

/* A place within a range, which may be as wide as it likes: for an angle three quarter turns to each side. */
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

/* Every other one stands on its wheels or nearly so, where it is heavy and the road matters. */
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
        fast[wheel->fast + FAST_SPIN][k] = index ? number(random, 10 / model->tire[wheel->tire].radius) : 0;
        for (int s = FAST_SLIP_X; s < wheel_fast_states(wheel); ++s)
            fast[wheel->fast + s][k] = index ? number(random, s == FAST_BRAKE ? 0.01 : 0.3) : 0;
    }
    if (!model->powertrain)
        return;
    const Powertrain *powertrain = model->powertrain;
    for (int i = 0; i < POWERTRAIN_DISCRETE; ++i)
        run->gear[i][k] = index ? (double)(int)(random_bits(random) %
                                                (unsigned)(powertrain->reverse + 1 + powertrain->forward)) -
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
    run->time[k] = index ? random_uniform(random, 0, 10) : 0;
    for (int i = 0; i < model->inputs; ++i)
        run->u[i][k] = model->input[i].initial + (index ? number(random, 1) : 0);
    for (int i = 0; i < 6 * model->ports; ++i)
        run->port[i][k] = index ? number(random, 100) : 0;
    for (int i = 0; i < model->parameters; ++i) {
        const Parameter *own = &model->parameter[i];
        if (own->tunable)
            run->p[own->index][k] =
                own->geometric || index % 4 != 3 ? own->value : own->value * (1 + 0.1 * number(random, 1));
    }
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
}
