/* SPDX-License-Identifier: MIT
 * Straight ahead: braking to rest, coasting down, accelerating from rest and from a speed. */
#include "run/manoeuvre.h"

#include <math.h>

static const double begin = 0.5, rise = 0.1; /* s: when pedals are pressed, and how long that takes */
static const double standing = 0.02;         /* m/s */
static const double aside = 1;               /* m off the straight line that are told */
static const double rolling = 10;            /* m/s at which a vehicle that begins at rest has to run straight */

/* A run that ends where the acceleration has gone. */
typedef struct Ending {
    int quiet;
} Ending;

bool manoeuvre_is_slow(void *context, const Trial *trial)
{
    return trial->row[trial->rows - 1][TRIAL_SPEED] <= *(const double *)context;
}

bool manoeuvre_is_over(void *context, const Trial *trial)
{
    return trial_spins(trial) || manoeuvre_is_slow(context, trial);
}

static bool is_fast(void *context, const Trial *trial)
{
    enum { ROWS = 200 };
    const double little = 0.01; /* m/s^2 */
    Ending *ending = context;
    const double *row = trial->row[trial->rows - 1];
    ending->quiet = row[TRIAL_TIME] > begin + 2 && fabs(row[TRIAL_AX]) < little ? ending->quiet + 1 : 0;
    return ending->quiet >= ROWS;
}

double manoeuvre_way(const Trial *trial, double from, double to)
{
    double x = trial_at(trial, TRIAL_X, from), y = trial_at(trial, TRIAL_Y, from), way = 0;
    for (int i = 0; i < trial->rows && trial->row[i][TRIAL_TIME] < to; ++i)
        if (trial->row[i][TRIAL_TIME] > from) {
            way += hypot(trial->row[i][TRIAL_X] - x, trial->row[i][TRIAL_Y] - y);
            x = trial->row[i][TRIAL_X];
            y = trial->row[i][TRIAL_Y];
        }
    return way + hypot(trial_at(trial, TRIAL_X, to) - x, trial_at(trial, TRIAL_Y, to) - y);
}

/* Keep the trial, which has to be whole; tell how far it went aside. */
static void keep(Manoeuvre *m, const Trial *trial, bool may_tip)
{
    static const Channel over[] = {TRIAL_SPEED, TRIAL_AX, TRIAL_PITCH, TRIAL_LOAD, TRIAL_Y};
    const double *last = trial->row[trial->rows - 1];
    if (trial->end || (trial->tipped && !may_tip))
        car_refuse(m->car, "gicrun with the scene of a lower speed shows more",
                   trial->end ? trial->end : "the vehicle tips over");
    manoeuvre_keep(m, trial);
    if (fabs(last[TRIAL_Y] - trial->row[0][TRIAL_Y]) > aside)
        sheet_note(m->result, pool_print(m->pool, "the vehicle ends %.3g m aside and turned by %.3g deg",
                                         last[TRIAL_Y] - trial->row[0][TRIAL_Y], 57.29577951308232 * last[TRIAL_YAW]));
    for (size_t i = 0; i < sizeof over / sizeof *over; ++i)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_TIME, over[i]};
}

double manoeuvre_speed_before(TestCar *car, double speed, double *when)
{
    enum { TRIES = 6 };
    static const double near_enough = 1e-5; /* of the speed */
    double from = speed;
    *when = begin;
    for (int k = 0; k < TRIES; ++k) {
        const Trial *trial = trial_run(car, "coasting", car_scene(car, begin, from, false, NULL), NULL, NULL);
        const double lost = speed - trial->row[trial->rows - 1][TRIAL_SPEED];
        if (trial->end || fabs(lost) <= near_enough * speed) /* the manoeuvre tells an end */
            break;
        from += lost;
    }
    return from;
}

void manoeuvre_braked(Manoeuvre *m, const Trial *trial, double start, double speed)
{
    Sheet *s = m->result;
    const double *last = trial->row[trial->rows - 1], from = trial_at(trial, TRIAL_SPEED, start);
    if (trial_spins(trial)) { /* the speed along its heading is not that over the road */
        sheet_note(s,
                   pool_print(m->pool, "the vehicle spins, by %.3g s after the pedal moved: it does not stop straight",
                              last[TRIAL_TIME] - start));
        sheet_add(s, "Braking", "initial_speed", "Speed where the pedal begins to move", "m/s", from);
        return;
    }
    if (last[TRIAL_SPEED] > standing)
        car_refuse(m->car, "brake=1 is the whole pedal; does the torque of `brake` follow it?",
                   pool_print(m->pool, "the vehicle does not stop within %g s: it still has %.3g m/s", last[TRIAL_TIME],
                              last[TRIAL_SPEED]));
    const double upper = trial_passes(trial, TRIAL_SPEED, start, 0.8 * from, -1);
    const double lower = trial_passes(trial, TRIAL_SPEED, start, 0.1 * from, -1);
    const double distance = manoeuvre_way(trial, start, last[TRIAL_TIME]);
    sheet_add(s, "Braking", "initial_speed", "Speed where the pedal begins to move", "m/s", from);
    sheet_add_way(s, NULL, "stopping_distance", "Stopping distance from there", distance);
    sheet_add_way(s, NULL, "stopping_distance_nominal", "Stopping distance from the speed asked for",
                  distance * (speed / from) * (speed / from));
    sheet_add(s, NULL, "stopping_time", "Stopping time", "s", last[TRIAL_TIME] - start);
    sheet_add(s, NULL, "mfdd", "Mean fully developed deceleration", "m/s^2",
              (0.64 - 0.01) * from * from / (2 * manoeuvre_way(trial, upper, lower)));
    const double *peak = trial->row[trial_peak(trial, TRIAL_AX, start, INFINITY, -1)];
    sheet_add(s, NULL, "peak_deceleration", "Largest deceleration", "m/s^2", -peak[TRIAL_AX]);
    sheet_add_way(s, NULL, "aside", "Off the straight line at the end",
                  last[TRIAL_Y] - trial_at(trial, TRIAL_Y, start));
    sheet_add(s, NULL, "turned", "Turned at the end", "rad", last[TRIAL_YAW]);
}

void manoeuvre_braking(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double speed = m->value[0], level = m->value[1], most = 60;
    double below = standing, start;
    car_need_brake(car);
    car_settle(car, speed);
    const double from = manoeuvre_speed_before(car, speed, &start);
    const char *more =
        pool_print(m->pool, "inputs:\n  brake: {step: {to: %.17g, rise: %g, start: %g}}\n", level, rise, start);
    const Trial *trial = trial_run(car, "braking", car_scene(car, most, from, false, more), manoeuvre_is_over, &below);
    keep(m, trial, false);
    manoeuvre_braked(m, trial, start, speed);
}

/* a = c0 + c2 v^2 by least squares over a time. */
static void fit_resistance(Manoeuvre *m, const Trial *trial)
{
    double *v2 = pool_alloc(m->pool, (size_t)trial->rows * sizeof *v2), mean[2] = {0};
    double *a = pool_alloc(m->pool, (size_t)trial->rows * sizeof *a);
    int n = 0;
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_TIME] >= begin) {
            v2[n] = trial->row[i][TRIAL_SPEED] * trial->row[i][TRIAL_SPEED];
            a[n++] = -trial->row[i][TRIAL_AX];
        }
    const double c2 = fit_slope(n, v2, a);
    for (int i = 0; i < n; ++i) {
        mean[0] += v2[i] / n;
        mean[1] += a[i] / n;
    }
    sheet_add(m->result, NULL, "c0", "Deceleration c0 + c2 v^2: c0", "m/s^2", mean[1] - c2 * mean[0]);
    sheet_add(m->result, NULL, "c2", "c2", "1/m", c2);
}

void manoeuvre_coast(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double speed = m->value[0], most = 600;
    double below = m->value[1];
    car_settle(car, speed);
    const Trial *trial =
        trial_run(car, "coast-down", car_scene(car, most, speed, false, NULL), manoeuvre_is_slow, &below);
    keep(m, trial, false);
    const double *last = trial->row[trial->rows - 1];
    if (last[TRIAL_SPEED] > below)
        car_refuse(car, "a tire with rolling resistance, or a force of type `aero`",
                   pool_print(m->pool, "hardly anything resists the vehicle: after %g s it still has %.4g m/s", most,
                              last[TRIAL_SPEED]));
    sheet_add(m->result, "Coast-down", "time", "Time", "s", last[TRIAL_TIME]);
    sheet_add_way(m->result, NULL, "distance", "Distance", manoeuvre_way(trial, 0, last[TRIAL_TIME]));
    fit_resistance(m, trial);
}

/* From rest by a pedal, until the speed no longer grows (ending->quiet > 0), or for `most`, s. */
static const Trial *accelerate(TestCar *car, double level, double most, Ending *ending)
{
    const char *more =
        pool_print(car->pool, "inputs:\n  accelerator: {step: {to: %.17g, rise: %g, start: %g}}\n", level, rise, begin);
    return trial_run(car, "acceleration", car_scene(car, most, 0, false, more), is_fast, ending);
}

double manoeuvre_top_speed(TestCar *car, const char **why)
{
    const double most = 120;
    Ending ending = {0};
    if (car->accelerator < 0) {
        *why = "the model has no input 'accelerator' of unit 1";
        return NAN;
    }
    const Trial *trial = accelerate(car, 1, most, &ending);
    const double last = trial->row[trial->rows - 1][TRIAL_SPEED];
    *why = trial->end      ? trial->end
           : trial->tipped ? "the vehicle tips over"
           : last < 1      ? "the vehicle does not move off"
           : !ending.quiet ? pool_print(car->pool, "after %g s it still grows, at %.4g m/s", most, last)
                           : NULL;
    return *why ? NAN : last;
}

void manoeuvre_acceleration(Manoeuvre *m)
{
    static const double speeds[] = {50, 80, 100}, ways[] = {100, 400, 1000}; /* km/h, m */
    TestCar *car = m->car;
    const double level = m->value[0], most = m->value[1];
    Ending ending = {0};
    car_need_drive(car);
    const char *why;
    if (!car_runs_straight(car, rolling, &why))
        car_refuse(car, car->remedy, why);
    const Trial *trial = accelerate(car, level, most, &ending);
    keep(m, trial, true);
    Sheet *s = m->result;
    const double *last = trial->row[trial->rows - 1];
    const double *peak = trial->row[trial_peak(trial, TRIAL_AX, begin, INFINITY, 1)];
    if (last[TRIAL_SPEED] < 1)
        car_refuse(car, "does the torque of `drive`, or the powertrain, follow the accelerator?",
                   pool_print(m->pool, "the vehicle does not move off: after %.3g s it has %.3g m/s", last[TRIAL_TIME],
                              last[TRIAL_SPEED]));
    sheet_add(s, "Acceleration from rest", "peak_acceleration", "Largest acceleration", "m/s^2", peak[TRIAL_AX]);
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; ++i) {
        const double at = trial_passes(trial, TRIAL_SPEED, begin, speeds[i] / 3.6, 1);
        if (!isnan(at))
            sheet_add(s, NULL, pool_print(m->pool, "to_%g", speeds[i]), pool_print(m->pool, "0 to %g km/h", speeds[i]),
                      "s", at - begin);
    }
    for (size_t i = 0; i < sizeof ways / sizeof *ways; ++i) {
        const double at = trial_passes(trial, TRIAL_X, begin, trial_at(trial, TRIAL_X, begin) + ways[i], 1);
        if (isnan(at))
            continue;
        sheet_add(s, NULL, pool_print(m->pool, "time_%g_m", ways[i]), pool_print(m->pool, "Time for %g m", ways[i]),
                  "s", at - begin);
        sheet_add(s, NULL, pool_print(m->pool, "speed_%g_m", ways[i]), pool_print(m->pool, "Speed there"), "m/s",
                  trial_at(trial, TRIAL_SPEED, at));
    }
    if (trial->tipped)
        sheet_note(s, pool_print(m->pool, "the vehicle tips over at %.4g m/s, after %.3g s: there is no top speed",
                                 last[TRIAL_SPEED], last[TRIAL_TIME] - begin));
    else if (ending.quiet)
        sheet_add(s, NULL, "top_speed", "Top speed", "m/s", last[TRIAL_SPEED]);
    else
        sheet_note(s,
                   pool_print(m->pool, "top speed: after %g s it still grows, at %.4g m/s", most, last[TRIAL_SPEED]));
}

/* True above a speed, *context. */
static bool is_past(void *context, const Trial *trial)
{
    return trial->row[trial->rows - 1][TRIAL_SPEED] > *(const double *)context;
}

void manoeuvre_elasticity(Manoeuvre *m)
{
    TestCar *car = m->car;
    double low = m->value[0], high = m->value[1];
    const double level = m->value[2], most = 120;
    car_need_drive(car);
    car_settle(car, low);
    const char *more =
        pool_print(m->pool, "inputs:\n  accelerator: {step: {to: %.17g, rise: %g, start: 0}}\n", level, rise);
    const Trial *trial = trial_run(car, "elasticity", car_scene(car, most, low, false, more), is_past, &high);
    keep(m, trial, true);
    const double there = trial_passes(trial, TRIAL_SPEED, 0, high, 1);
    if (isnan(there))
        car_refuse(car, "a lower speed `high`, or accelerator=1",
                   pool_print(m->pool, "the vehicle does not reach %.4g m/s from %.4g m/s within %g s: it has %.4g m/s",
                              high, low, most, trial->row[trial->rows - 1][TRIAL_SPEED]));
    Sheet *s = m->result;
    sheet_add(s, "Elasticity", "time", pool_print(m->pool, "Time from %.4g to %.4g m/s", low, high), "s", there);
    sheet_add_way(s, NULL, "distance", "Distance", manoeuvre_way(trial, 0, there));
    const double *peak = trial->row[trial_peak(trial, TRIAL_AX, 0, INFINITY, 1)];
    sheet_add(s, NULL, "peak_acceleration", "Largest acceleration", "m/s^2", peak[TRIAL_AX]);
    if (car->model->powertrain)
        sheet_add(s, NULL, "gear", "Gear at its end", "1", trial->gear);
}
