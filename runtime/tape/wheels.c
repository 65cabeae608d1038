/* SPDX-License-Identifier: MIT
 * Wheels with tires: the templates wheels.c.in, wheel.c.in and dual_rate.c.in, over tapes. */
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "tape/engine_tape.h"
#include "tape/journal.h"
#include "tape/record.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

#include <math.h>
#include <string.h>

void tape_record_wheels(Pool *pool, TapeEngine *engine, const Element *array)
{
    const Wheels *wheels = engine->formulation->wheels;
    engine->link = tape_record(pool, &wheels->link, array, WHOLE_COUNT);
    engine->torque = tape_record(pool, &wheels->torque, array, WHOLE_COUNT);
    if (engine->formulation->model->powertrain) {
        engine->drive = tape_record(pool, &wheels->drive, array, WHOLE_COUNT);
        engine->shift = tape_record(pool, &wheels->shift, array, WHOLE_COUNT);
    }
    engine->wheel = pool_alloc(pool, ((size_t)wheels->classes + 1) * sizeof *engine->wheel);
    for (int c = 0; c < wheels->classes; ++c)
        engine->wheel[c] = (TapeWheel){.contact = tape_record(pool, &wheels->class[c].contact, array, WHOLE_COUNT),
                                       .tire = tape_record(pool, &wheels->class[c].tire, array, WHOLE_COUNT),
                                       .balance = tape_record(pool, &wheels->class[c].balance, array, WHOLE_COUNT)};
}

/* Arrays that blocks about wheels read and write: numbers and, if slope_frame is not NULL, their derivatives along one
 * direction. */
typedef struct Turning {
    const TapeEngine *engine;
    TapeWorld world;
    double *array[2][WHOLE_COUNT]; /* of numbers, of derivatives */
    double *slope_frame;
    int64_t *in_air; /* counts wheels in the air; NULL: not counted */
} Turning;

static int play(const Turning *t, const Tape *tape, int member)
{
    double *frame = t->engine->frame;
    if (!t->slope_frame)
        return tape_play(tape, member, t->array[0], &t->world, frame);
    return tape_play_dual(tape, member, t->array[0], t->array[1], &t->world, frame, t->slope_frame);
}

/* How the multibody system moves the wheels. */
static void links_of(Instance *self, const double *y, const double *e, double *link)
{
    const TapeEngine *engine = tape_of(self);
    const TapeWorld none = {.table = NULL};
    double *const array[WHOLE_COUNT] = {
        [WHOLE_y] = (double *)y, /* blocks only read these two */
        [WHOLE_e] = (double *)e,
        [WHOLE_x] = tape_array(self, engine->x_offset),
        [WHOLE_xd] = tape_array(self, engine->xd_offset),
        [WHOLE_m] = tape_array(self, engine->motion_offset),
        [WHOLE_u] = tape_array(self, engine->code.input_offset),
        [WHOLE_DERIVED] = tape_array(self, engine->derived_offset),
        [WHOLE_link] = link,
    };
    tape_play(engine->link, 0, array, &none, engine->frame);
}

/* One wheel; t->array[] has what belongs to it. */
static int wheel_of(Turning *t, const TapeWheel *wheel, int member)
{
    double contact[2][CONTACT_NUMBERS] = {{0}}, force[2][TIRE_FORCES] = {{0}};
    t->array[0][WHOLE_contact] = contact[0];
    t->array[0][WHOLE_force] = force[0];
    t->array[1][WHOLE_contact] = journal_numbers(&t->world, contact[1], CONTACT_NUMBERS);
    t->array[1][WHOLE_force] = journal_numbers(&t->world, force[1], TIRE_FORCES);
    int status = play(t, wheel->contact, member);
    if (status != GIC_OK)
        return status;
    /* a wheel in the air has no tire forces; one that is put down begins to have them */
    if (contact[0][CONTACT_LOAD] > 0 || (t->slope_frame && contact[1][CONTACT_LOAD] > 0))
        play(t, wheel->tire, member);
    else if (t->in_air)
        ++*t->in_air;
    return play(t, wheel->balance, member);
}

/* All wheels at their links: rates of the fast states, and the instance's grip. */
static int turn(const Turning *all)
{
    const TapeEngine *engine = all->engine;
    const Wheels *wheels = engine->formulation->wheels;
    const Model *model = engine->formulation->model;
    int status = play(all, engine->torque, 0);
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        for (int i = 0; i < class->members && status == GIC_OK; ++i) {
            const int place = wheel_rolling(model, class->member[i]), first = model->wheel[class->member[i]].fast;
            Turning one = *all;
            for (int side = 0; side < (all->slope_frame ? 2 : 1); ++side) {
                double **array = one.array[side];
                array[WHOLE_link] += LINK_NUMBERS * place;
                array[WHOLE_fast] += first;
                array[WHOLE_torque] += 2 * place;
                array[WHOLE_rate] += first;
                array[WHOLE_grip] += GRIP_NUMBERS * place;
            }
            status = wheel_of(&one, &engine->wheel[c], i);
        }
    }
    return status == GIC_OK && engine->drive ? play(all, engine->drive, 0) : status;
}

/* The same of an instance: rate[] of the fast states. */
static int grip(Instance *self, double time, const double *link, const double *fast, double *rate)
{
    const TapeEngine *engine = tape_of(self);
    const Turning all = {
        .engine = engine,
        .world = {.table = engine->table, .road = self->head.road, .lane = self->head.lane, .time = time},
        .in_air = &self->head.air_count,
        .array = {{
            [WHOLE_time] = &time,
            [WHOLE_link] = (double *)link, /* blocks only read these two */
            [WHOLE_fast] = (double *)fast,
            [WHOLE_u] = tape_array(self, engine->code.input_offset),
            [WHOLE_p] = tape_array(self, engine->code.parameter_offset),
            [WHOLE_DERIVED] = tape_array(self, engine->derived_offset),
            [WHOLE_torque] = engine->torques,
            [WHOLE_rate] = rate,
            [WHOLE_grip] = tape_array(self, engine->grip_offset),
            [WHOLE_gear] = tape_array(self, engine->gear_offset),
            [WHOLE_watch] = tape_array(self, engine->watch_offset),
        }},
    };
    const int status = engine->drive ? tape_engage(self) : GIC_OK;
    return status == GIC_OK ? turn(&all) : status;
}

int tape_turn_wheels(Instance *self, double time, const double *y, const double *e, double *rate)
{
    const TapeEngine *engine = tape_of(self);
    if (!gic_bounded(y + engine->code.slow_count, engine->code.fast_count))
        return GIC_ERROR_INPUT;
    links_of(self, y, e, engine->link_row);
    return grip(self, time, engine->link_row, y + engine->code.slow_count, rate);
}

/* Arrays of the wheels among those of the whole mechanism, in dual numbers, at given links. torque: room for what turns
 * the wheels. */
static Turning in_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                       double *const link[2], double *torque, double *slope_frame)
{
    const int torques = 2 * engine->formulation->wheels->count;
    Turning all = {.engine = engine, .world = *world, .slope_frame = slope_frame};
    for (int side = 0; side < 2; ++side) {
        double **own = all.array[side];
        memcpy(own, side ? slope : array, sizeof all.array[side]);
        own[WHOLE_link] = link[side];
        own[WHOLE_fast] = own[WHOLE_y] + engine->code.slow_count;
        own[WHOLE_torque] = side ? journal_numbers(world, torque + torques, torques) : torque;
        own[WHOLE_rate] += engine->code.slow_count;
        own[WHOLE_grip] = own[WHOLE_GRIP];
        own[WHOLE_watch] = own[WHOLE_WATCH];
    }
    return all;
}

int tape_link_wheels_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                          double *const link[2], double *slope_frame)
{
    double torque[4 * engine->formulation->wheels->count + 1];
    const Turning all = in_dual(engine, world, array, slope, link, torque, slope_frame);
    return play(&all, engine->link, 0);
}

int tape_turn_wheels_dual(const TapeEngine *engine, const TapeWorld *world, double *const *array, double *const *slope,
                          double *const link[2], double *slope_frame)
{
    double torque[4 * engine->formulation->wheels->count + 1];
    const Turning all = in_dual(engine, world, array, slope, link, torque, slope_frame);
    return turn(&all);
}

int tape_recover_once(Instance *self, const double turn[3])
{
    const TapeEngine *engine = tape_of(self);
    const int coordinates = engine->code.coordinate_count;
    const size_t size = (size_t)coordinates * sizeof(double);
    const double *x = tape_array(self, engine->x_offset), *xd = tape_array(self, engine->xd_offset);
    const double *at = tape_array(self, engine->recovered_offset), *recovered = at + 2 * coordinates + 4;
    if (*recovered == 1 + self->head.flip && !memcmp(at, x, size) && !memcmp(at + coordinates, xd, size) &&
        !memcmp(at + 2 * coordinates, turn, 3 * sizeof *turn) && self->head.ahead <= recovered[-1]) {
        for (int s = 0; s < engine->code.subset_count; ++s)
            self->head.kept_count += engine->formulation->sequence->subset[s].class >= 0;
        return GIC_OK;
    }
    return tape_recover(self, turn, false);
}

/* ---- dual rate ------------------------------------------------------------------------------------------------- */

int tape_link_wheels(void *instance, double time, const double *slow, double *link)
{
    Instance *self = instance;
    const int32_t count = tape_of(self)->code.link_count;
    double e[4], found[count];
    const int status = tape_locate(self, time, slow, e);
    if (status != GIC_OK)
        return status;
    links_of(self, slow, e, found);
    if (!gic_finite(found, count))
        return self->head.status = GIC_ERROR_RESULT;
    memcpy(link, found, sizeof found);
    return GIC_OK;
}

int tape_fast(void *instance, double time, const double *link, const double *fast, double *rate)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    if (!gic_finite(link, code->link_count) || !gic_bounded(fast, code->fast_count) || !gic_finite(&time, 1) ||
        !gic_finite(tape_array(self, code->input_offset), code->input_count) ||
        !gic_finite(tape_array(self, code->parameter_offset), code->parameter_count))
        return self->head.status = GIC_ERROR_INPUT;
    int status = grip(self, time, link, fast, engine->result);
    if (status == GIC_OK && !gic_finite(engine->result, code->fast_count))
        status = GIC_ERROR_RESULT;
    if (status == GIC_OK)
        memcpy(rate, engine->result, (size_t)code->fast_count * sizeof *rate);
    return self->head.status = status;
}

/* As in dual_rate.c.in. */
static double rolling_share(double s)
{
    return s < 1 ? s * (3 - 2 * s) : 1 / s;
}

int tape_roll(void *instance)
{
    Instance *self = instance;
    const TapeEngine *engine = tape_of(self);
    const gic_model *code = &engine->code;
    const Model *model = engine->formulation->model;
    const double *number = tape_array(self, engine->grip_offset);
    double *state = tape_array(self, code->state_offset), e[4];
    const double time = tape_present(self);
    int status = tape_locate(self, time, state, e);
    if (status == GIC_OK)
        status = tape_turn_wheels(self, time, state, e, engine->result);
    for (int i = 0; i < model->wheels && status == GIC_OK; ++i) {
        const Wheel *wheel = &model->wheel[i];
        if (wheel->tire < 0)
            continue;
        double *own = state + code->slow_count + wheel->fast, speed = fabs(number[GRIP_SPEED_X]);
        const double low = model->tire[wheel->tire].low_speed;
        memset(own, 0, (size_t)wheel_fast_states(wheel) * sizeof *own);
        own[FAST_SPIN] = number[GRIP_SPEED_X] / number[GRIP_RADIUS];
        own[FAST_SLIP_Y] = number[GRIP_SPEED_Y] * rolling_share(speed / low) / low;
        number += GRIP_NUMBERS;
    }
    if (status == GIC_OK)
        gic_restart(self, time);
    return self->head.status = status;
}
