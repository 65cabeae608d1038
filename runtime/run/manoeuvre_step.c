/* SPDX-License-Identifier: MIT
 * A step of the steering at constant speed, or a ramp: response times, overshoots, steady values. */
#include "run/manoeuvre.h"

#include <math.h>

static const double gravity = 9.80665;
static const double begin = 4, rise = 0.2, duration = 6; /* s; duration: from the step on */
static const double steady = 1;                          /* s at the end over which values are steady */

const char *manoeuvre_step_profile(Manoeuvre *m, double angle)
{
    const TestCar *car = m->car;
    return pool_print(m->pool, "inputs:\n  %s: {step: {to: %.17g, rise: %g, start: %g}}\n",
                      car->model->input[car->steering].name, car_steering(car, angle), rise, begin);
}

static const Trial *step(Manoeuvre *m, double angle, const char *name)
{
    TestCar *car = m->car;
    const char *more = manoeuvre_step_profile(m, angle);
    return trial_run(car, name, car_scene(car, begin + duration, m->value[0], true, more), NULL, NULL);
}

const Trial *manoeuvre_step_trial(Manoeuvre *m, double angle, const char *name)
{
    return step(m, angle, name);
}

/* From straight ahead to an angle at a constant rate, and held. */
static const Trial *ramp(Manoeuvre *m, double angle, const char *name)
{
    TestCar *car = m->car;
    const double blend = 0.1; /* of the time it takes, each corner */
    const double time = fabs(angle) / m->value[2] / (1 - blend);
    const char *more =
        pool_print(m->pool, "inputs:\n  %s: {ramp: {to: %.17g, duration: %.17g, start: %g, blend: %.17g}}\n",
                   car->model->input[car->steering].name, car_steering(car, angle), time, begin, blend * time);
    return trial_run(car, name, car_scene(car, begin + time + duration, m->value[0], true, more), NULL, NULL);
}

static double steady_of(const Trial *trial, Channel channel)
{
    const double end = trial->row[trial->rows - 1][TRIAL_TIME];
    return trial_mean(trial, channel, end - steady, end);
}

static double ends_in(const Trial *trial)
{
    return steady_of(trial, TRIAL_AY);
}

double manoeuvre_steady_angle(Manoeuvre *m)
{
    return manoeuvre_find_angle(m, m->value[1], &(AngleSearch){step, ends_in, "a step of the steering", "ends in"});
}

/* Response of a channel: steady value, response time, time and size of the peak. */
static void add_response(Manoeuvre *m, const Trial *trial, double sign, double from, Channel channel, const char *title)
{
    Sheet *s = m->result;
    const char *name = pool_print(m->pool, "%s.%s", trial->name, trial_signal[channel].name);
    const double last = steady_of(trial, channel), way = last < 0 ? -1 : 1;
    const double there = trial_passes(trial, channel, begin, 0.9 * last, way);
    const double *peak = trial->row[trial_peak(trial, channel, begin, INFINITY, way)];
    const bool peaks = peak[TRIAL_TIME] < trial->row[trial->rows - 1][TRIAL_TIME] - steady; /* else from below */
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

/* What a ramp is looked at for: how far behind the steering the vehicle is at half the way. */
static void add_lags(Manoeuvre *m, const Trial *trial, double sign, double angle)
{
    static const struct {
        Channel channel;
        const char *title;
    } of[] = {{TRIAL_YAW_RATE, "Yaw rate"},
              {TRIAL_AY, "Lateral acceleration"},
              {TRIAL_ROLL, "Roll angle"},
              {TRIAL_SIDESLIP, "Side slip"}};
    Sheet *s = m->result;
    const double half = trial_passes(trial, TRIAL_ANGLE, 0, sign * angle / 2, sign);
    sheet_add(s, sign > 0 ? "To the left" : "To the right", pool_print(m->pool, "%s.steer_angle", trial->name),
              "Steer angle in the end", "rad", sign * steady_of(trial, TRIAL_ANGLE));
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        const char *name = pool_print(m->pool, "%s.%s", trial->name, trial_signal[of[i].channel].name);
        const double last = steady_of(trial, of[i].channel), way = last < 0 ? -1 : 1;
        const double there = trial_passes(trial, of[i].channel, begin, last / 2, way);
        const double *peak = trial->row[trial_peak(trial, of[i].channel, begin, INFINITY, way)];
        sheet_add(s, NULL, pool_print(m->pool, "%s.steady", name), pool_print(m->pool, "%s, steady", of[i].title),
                  trial_signal[of[i].channel].unit, sign * last);
        if (!isnan(there))
            sheet_add(s, NULL, pool_print(m->pool, "%s.lag", name), pool_print(m->pool, "%s, lag", of[i].title), "s",
                      there - half);
        if (last != 0)
            sheet_add(s, NULL, pool_print(m->pool, "%s.overshoot", name),
                      pool_print(m->pool, "%s, overshoot", of[i].title), "1", peak[of[i].channel] / last - 1);
    }
}

/* Both sides with an angle that was found. */
static void drive_sides(Manoeuvre *m, double angle, const Trial *(*steer)(Manoeuvre *, double, const char *),
                        void (*results)(Manoeuvre *, const Trial *, double, double))
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_YAW_RATE, TRIAL_AY, TRIAL_ROLL, TRIAL_SIDESLIP, TRIAL_SPEED};
    for (int side = 1; side >= -1; side -= 2) {
        const Trial *trial = steer(m, side * angle, side > 0 ? "left" : "right");
        const double last = trial->row[trial->rows - 1][TRIAL_SPEED];
        manoeuvre_whole(m, trial, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * m->value[1]));
        manoeuvre_keep(m, trial);
        results(m, trial, side, angle);
        if (fabs(last / m->value[0] - 1) > 0.03)
            sheet_note(m->result,
                       pool_print(m->pool, "%s: the speed is not kept, at the end it is %.4g m/s", trial->name, last));
    }
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
    sheet_note(m->result, pool_print(m->pool, "found: %.4g deg at the wheels for %.3g m/s^2 (%.2f g)",
                                     57.29577951308232 * angle, m->value[1], m->value[1] / gravity));
}

void manoeuvre_step_steer(Manoeuvre *m)
{
    manoeuvre_begin(m);
    drive_sides(m, manoeuvre_steady_angle(m), step, add_results);
}

void manoeuvre_ramp_steer(Manoeuvre *m)
{
    manoeuvre_begin(m);
    drive_sides(
        m, manoeuvre_find_angle(m, m->value[1], &(AngleSearch){ramp, ends_in, "a ramp of the steering", "ends in"}),
        ramp, add_lags);
}
