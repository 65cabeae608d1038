/* SPDX-License-Identifier: MIT
 * Response to steering by the linear model, in the channels of trials. */
#include "run/manoeuvre.h"

#include <math.h>

static const double pi = 3.141592653589793;

enum { SIDE = 1, ROLL = 3, YAW = 5 };

struct LinearResponse {
    const TestCar *car;
    const SheetMotion *motion;
    double speed, *re, *im;
};

const LinearResponse *linear_response(const TestCar *car, double speed)
{
    const size_t size = (size_t)car->sheet.found->linear->count * sizeof(double);
    LinearResponse *response = pool_alloc(car->pool, sizeof *response);
    *response = (LinearResponse){car, sheet_motion(&car->sheet, car->axle->steer, speed), speed,
                                 pool_alloc(car->pool, size), pool_alloc(car->pool, size)};
    return response->motion ? response : NULL;
}

/* Velocity of the centre of mass to the left, as the base carries it: that of the base's origin, and by its turns. */
static double aside(const LinearResponse *r, const double *z)
{
    const double *rate = z + r->car->sheet.found->linear->places, *com = r->car->com;
    return rate[SIDE] + com[0] * rate[YAW] - com[2] * rate[ROLL];
}

/* A channel of one part of z; turned: what that part of dz/dt / omega is, the other part or less it. */
static double channel_of(const LinearResponse *r, Channel channel, const double *z, const double *turned, double sign,
                         double omega)
{
    const double yaw_rate = z[r->car->sheet.found->linear->places + YAW];
    switch (channel) {
    case TRIAL_YAW_RATE: return yaw_rate;
    case TRIAL_ROLL: return z[ROLL];
    case TRIAL_SIDESLIP: return aside(r, z) / r->speed;
    default: /* TRIAL_AY */ return r->speed * yaw_rate + sign * omega * aside(r, turned);
    }
}

Response linear_response_at(const void *context, Channel channel, double frequency)
{
    const LinearResponse *r = context;
    const double omega = 2 * pi * frequency;
    if (!sheet_motion_at(r->motion, omega, r->re, r->im))
        return (Response){NAN, NAN, NAN};
    const double angle = r->car->angle;
    double is[2] = {channel_of(r, channel, r->re, r->im, -1, omega), channel_of(r, channel, r->im, r->re, 1, omega)};
    if (channel == TRIAL_LAST_AY || channel == TRIAL_LAST_YAW_RATE)
        sheet_motion_output(r->motion,
                            r->car->unit + (channel == TRIAL_LAST_AY ? UNIT_ACCELERATION + 1 : UNIT_TURN + 2), omega,
                            r->re, r->im, is);
    return (Response){hypot(is[0], is[1]) / fabs(angle), atan2(is[1] * angle, is[0] * angle), 1};
}
