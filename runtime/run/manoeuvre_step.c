/* SPDX-License-Identifier: MIT
 * A step of the steering at constant speed: response times, overshoots, steady values. */
#include "run/manoeuvre.h"

#include <math.h>

static const double gravity = 9.80665;
static const double begin = 4, rise = 0.2, duration = 6; /* s; duration: from the step on */
static const double steady = 1;                          /* s at the end over which values are steady */
static const double near_enough = 5e-3;                  /* of the lateral acceleration that is wanted */
enum { TRIES = 8 };

static const Trial *step(Manoeuvre *m, double angle, const char *name)
{
    TestCar *car = m->car;
    const char *more = pool_print(m->pool, "inputs:\n  %s: {step: {to: %.17g, rise: %g, start: %g}}\n",
                                  car->model->input[car->steering].name, car_steering(car, angle), rise, begin);
    return trial_run(car, name, car_scene(car, begin + duration, m->value[0], true, more), NULL, NULL);
}

static double steady_of(const Trial *trial, Channel channel)
{
    return trial_mean(trial, channel, begin + duration - steady, begin + duration);
}

/* The road-wheel angle that ends in the wanted lateral acceleration, to the left: secants. */
static double find_angle(Manoeuvre *m)
{
    TestCar *car = m->car;
    const double wanted = m->value[1], v = m->value[0], most = 0.999 * fmin(-car->range[0], car->range[1]);
    double by_ay = car_angle_by_acceleration(car, v), angle, before[2] = {0, 0}, ay = 0;
    if (isnan(by_ay))
        by_ay = car->sheet.wheelbase / (v * v);
    angle = wanted * by_ay;
    for (int k = 0; k < TRIES; ++k) {
        if (!(angle > 0 && angle <= most))
            break;
        const Trial *trial = step(m, angle, "search");
        if (trial->tipped || trial->end)
            car_refuse(car, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * wanted),
                       trial->end ? trial->end
                                  : pool_print(m->pool,
                                               "the vehicle tips over by a step of %.3g deg of the wheels at "
                                               "%.4g m/s",
                                               57.29577951308232 * angle, v));
        ay = steady_of(trial, TRIAL_AY);
        if (fabs(ay - wanted) <= near_enough * wanted)
            return angle;
        const double slope = (ay - before[1]) / (angle - before[0]);
        before[0] = angle;
        before[1] = ay;
        if (!(slope * by_ay > 0.05)) /* hardly more by more steering */
            break;
        angle += (wanted - ay) / slope;
    }
    car_refuse(car, pool_print(m->pool, "ask for less: ay=%.2g", 0.8 * fmax(ay, 0.1)),
               pool_print(m->pool,
                          "no step of the steering ends in %.4g m/s^2 at %.4g m/s: the vehicle reached %.4g m/s^2",
                          wanted, v, ay));
}

/* Response of a channel: steady value, response time, time and size of the peak. */
static void add_response(Manoeuvre *m, const Trial *trial, double sign, double from, Channel channel, const char *title)
{
    Sheet *s = m->result;
    const char *name = pool_print(m->pool, "%s.%s", trial->name, trial_signal[channel].name);
    const double last = steady_of(trial, channel), way = last < 0 ? -1 : 1;
    const double there = trial_passes(trial, channel, begin, 0.9 * last, way);
    const double *peak = trial->row[trial_peak(trial, channel, begin, begin + duration, way)];
    const bool peaks = peak[TRIAL_TIME] < begin + duration - steady; /* else it comes from below */
    sheet_add(s, NULL, pool_print(m->pool, "%s.steady", name), pool_print(m->pool, "%s, steady", title),
              trial_signal[channel].unit, sign * last);
    if (!isnan(there))
        sheet_add(s, NULL, pool_print(m->pool, "%s.response_time", name),
                  pool_print(m->pool, "%s, response time", title), "s", there - from);
    if (!peaks || last == 0)
        return;
    sheet_add(s, NULL, pool_print(m->pool, "%s.peak_time", name), pool_print(m->pool, "%s, peak response time", title),
              "s", peak[TRIAL_TIME] - from);
    sheet_add(s, NULL, pool_print(m->pool, "%s.overshoot", name), pool_print(m->pool, "%s, overshoot", title), "1",
              peak[channel] / last - 1);
}

static void add_results(Manoeuvre *m, const Trial *trial, double sign, double angle)
{
    Sheet *s = m->result;
    const double from = trial_passes(trial, TRIAL_ANGLE, 0, sign * angle / 2, sign);
    const double delta = steady_of(trial, TRIAL_ANGLE), yaw = steady_of(trial, TRIAL_YAW_RATE);
    const double *peak = trial->row[trial_peak(trial, TRIAL_YAW_RATE, begin, INFINITY, sign)];
    sheet_add(s, sign > 0 ? "To the left" : "To the right", pool_print(m->pool, "%s.steer_angle", trial->name),
              "Steer angle", "rad", sign * delta);
    sheet_add(s, NULL, pool_print(m->pool, "%s.yaw_gain", trial->name), "Yaw rate gain, steady", "1/s", yaw / delta);
    sheet_add(s, NULL, pool_print(m->pool, "%s.ay_gain", trial->name), "Lateral acceleration gain, steady",
              "m/(s^2 rad)", steady_of(trial, TRIAL_AY) / delta);
    add_response(m, trial, sign, from, TRIAL_YAW_RATE, "Yaw rate");
    add_response(m, trial, sign, from, TRIAL_AY, "Lateral acceleration");
    add_response(m, trial, sign, from, TRIAL_ROLL, "Roll angle");
    add_response(m, trial, sign, from, TRIAL_SIDESLIP, "Side slip");
    if (peak[TRIAL_TIME] < begin + duration - steady)
        sheet_add(s, NULL, pool_print(m->pool, "%s.tb", trial->name), "TB factor", "s rad",
                  (peak[TRIAL_TIME] - from) * fabs(steady_of(trial, TRIAL_SIDESLIP)));
}

void manoeuvre_step_steer(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_YAW_RATE, TRIAL_AY, TRIAL_ROLL, TRIAL_SIDESLIP, TRIAL_SPEED};
    TestCar *car = m->car;
    car_need_steering(car);
    car_need_drive(car);
    car_need_brake(car);
    car_settle(car, m->value[0]);
    const double angle = find_angle(m);
    for (int side = 1; side >= -1; side -= 2) {
        const Trial *trial = step(m, side * angle, side > 0 ? "left" : "right");
        const double last = trial->row[trial->rows - 1][TRIAL_SPEED];
        if (trial->tipped || trial->end)
            car_refuse(car, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]),
                       trial->end ? trial->end : pool_print(m->pool, "the vehicle tips over to the %s", trial->name));
        manoeuvre_keep(m, trial);
        add_results(m, trial, side, angle);
        if (fabs(last / m->value[0] - 1) > 0.03)
            sheet_note(m->result,
                       pool_print(m->pool, "%s: the speed is not kept, at the end it is %.4g m/s", trial->name, last));
    }
    for (size_t i = 0; i < sizeof over / sizeof *over; ++i)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_TIME, over[i]};
    sheet_note(m->result, pool_print(m->pool, "found: %.4g deg at the wheels for %.3g m/s^2 (%.2f g)",
                                     57.29577951308232 * angle, m->value[1], m->value[1] / gravity));
}
