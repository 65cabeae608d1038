/* SPDX-License-Identifier: MIT
 * One period of a sine of the steering: how much the vehicle follows at both peaks, and how far behind. */
#include "run/manoeuvre.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double begin = 4, after = 3, spacing = 0.01; /* s */
static const double swinging = 10;                        /* s after it, of an articulated vehicle */

/* Of a sine of *context, Hz. */
static double wave(const void *context, double time)
{
    const double t = (time - begin) * *(const double *)context;
    return t > 0 && t < 1 ? sin(2 * pi * t) : 0;
}

static const Trial *drive(Manoeuvre *m, double angle, const char *name)
{
    TestCar *car = m->car;
    const double *frequency = &m->value[2], end = begin + 1 / *frequency;
    const double still = car->units ? swinging : after;
    const char *more = manoeuvre_steering(m, begin, end, fmin(spacing, 0.02 / *frequency), angle, wave, frequency);
    return trial_run(car, name, car_scene(car, end + still, m->value[0], true, more), NULL, NULL);
}

static double first_peak(const Trial *trial)
{
    return trial->row[trial_peak(trial, TRIAL_AY, begin, INFINITY, 1)][TRIAL_AY];
}

/* The peaks of a channel, which follow those of the steering: sign times the first is positive, and the second comes
 * after it on the other side. */
static void add_channel(Manoeuvre *m, const Trial *trial, double sign, Channel channel, const char *title,
                        const char *unit)
{
    static const char *const nth[] = {"first", "second"};
    const double quarter = 0.25 / m->value[2];
    double from = begin;
    /* the side slip of a fast vehicle is outwards, of a slow one inwards: where its first peak within half a period is
     */
    const double half = begin + 3 * quarter;
    const double *up = trial->row[trial_peak(trial, channel, begin, half, 1)];
    const double *down = trial->row[trial_peak(trial, channel, begin, half, -1)];
    double way = fabs(up[channel]) >= fabs(down[channel]) ? 1 : -1;
    for (int k = 0; k < 2; ++k, way = -way) {
        const double *peak = trial->row[trial_peak(trial, channel, from, k ? INFINITY : half, way)];
        const double steered = begin + (2 * k + 1) * quarter;
        const double *angle = trial->row[trial_peak(trial, TRIAL_ANGLE, begin, INFINITY, k ? -sign : sign)];
        const char *name = pool_print(m->pool, "%s.%s.%s", trial->name, trial_signal[channel].name, nth[k]);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.gain", name),
                  pool_print(m->pool, "%s by the steer angle, %s peak", title, nth[k]), unit,
                  peak[channel] / angle[TRIAL_ANGLE]);
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.lag", name),
                  pool_print(m->pool, "%s, lag of the %s peak", title, nth[k]), "s", peak[TRIAL_TIME] - steered);
        from = peak[TRIAL_TIME];
    }
}

void manoeuvre_sine(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_YAW_RATE, TRIAL_AY, TRIAL_ROLL, TRIAL_SIDESLIP, TRIAL_Y};
    static const Channel of_units[] = {TRIAL_LAST_AY, TRIAL_LAST_YAW_RATE, TRIAL_ARTICULATION};
    manoeuvre_begin(m);
    const double angle =
        manoeuvre_find_angle(m, m->value[1], &(AngleSearch){drive, first_peak, "a sine of the steering", "reaches"});
    for (int side = 1; side >= -1; side -= 2) {
        const Trial *trial = drive(m, side * angle, side > 0 ? "left" : "right");
        manoeuvre_whole(m, trial, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]));
        manoeuvre_keep(m, trial);
        sheet_add(m->result, side > 0 ? "To the left first" : "To the right first",
                  pool_print(m->pool, "%s.steer_angle", trial->name), "Amplitude of the steer angle", "rad", angle);
        add_channel(m, trial, side, TRIAL_YAW_RATE, "Yaw rate", "1/s");
        add_channel(m, trial, side, TRIAL_AY, "Lateral acceleration", "m/(s^2 rad)");
        add_channel(m, trial, side, TRIAL_ROLL, "Roll angle", "1");
        add_channel(m, trial, side, TRIAL_SIDESLIP, "Side slip", "1");
        sheet_add_way(m->result, NULL, pool_print(m->pool, "%s.aside", trial->name), "Aside at the end",
                      side * (trial->row[trial->rows - 1][TRIAL_Y] - trial_at(trial, TRIAL_Y, begin)));
        if (m->car->units)
            manoeuvre_rearward(m, trial, begin, begin + 1 / m->value[2]);
    }
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
    if (manoeuvre_has_units(m))
        manoeuvre_draw(m, sizeof of_units / sizeof *of_units, of_units);
}
