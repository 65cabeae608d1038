/* SPDX-License-Identifier: MIT
 * What manoeuvres by steering share: the angle of an acceleration, steering as samples, the beginning. */
#include "run/manoeuvre.h"

#include <math.h>

static const double gravity = 9.80665;
static const double begin = 1; /* s straight ahead */

void manoeuvre_begin(Manoeuvre *m)
{
    TestCar *car = m->car;
    car_need_steering(car);
    car_need_drive(car);
    car_need_brake(car);
    car_settle(car, m->value[0]);
}

void manoeuvre_whole(Manoeuvre *m, const Trial *trial, const char *remedy)
{
    if (trial->tipped || trial->end)
        car_refuse(m->car, remedy,
                   trial->end ? trial->end : pool_print(m->pool, "the vehicle tips over (%s)", trial->name));
}

void manoeuvre_draw(Manoeuvre *m, size_t count, const Channel *over)
{
    for (size_t i = 0; i < count; ++i)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_TIME, over[i]};
}

const char *manoeuvre_steering(Manoeuvre *m, double from, double to, double spacing, double angle,
                               double (*wave)(const void *context, double time), const void *context)
{
    const TestCar *car = m->car;
    Text times = {.pool = m->pool}, values = {.pool = m->pool};
    for (int k = -2; from + k * spacing < to + 2.5 * spacing; ++k) {
        const double t = from + k * spacing;
        text_print(&times, "%s%.9g", times.size ? ", " : "", t);
        text_print(&values, "%s%.12g", values.size ? ", " : "", car_steering(car, angle * wave(context, t)));
    }
    return pool_print(m->pool, "inputs:\n  %s: {samples: {times: [%s], values: [%s]}}\n",
                      car->model->input[car->steering].name, times.s, values.s);
}

double manoeuvre_find_angle(Manoeuvre *m, double wanted, const AngleSearch *search)
{
    enum { TRIES = 8 };
    static const double near_enough = 5e-3; /* of the lateral acceleration that is wanted */
    TestCar *car = m->car;
    const double v = m->value[0], most = 0.999 * fmin(-car->range[0], car->range[1]);
    const double by_ay = manoeuvre_angle_by_acceleration(m);
    double angle = wanted * by_ay, before[2] = {0, 0}, ay = 0;
    for (int k = 0; k < TRIES; ++k) {
        if (!(angle > 0 && angle <= most))
            break;
        const Trial *trial = search->drive(m, angle, "search");
        if (trial->tipped || trial->end)
            car_refuse(car, pool_print(m->pool, "ask for less: ay=%.2g", 0.7 * wanted),
                       trial->end
                           ? trial->end
                           : pool_print(m->pool, "the vehicle tips over by %s of %.3g deg of the wheels at %.4g m/s",
                                        search->what, 57.29577951308232 * angle, v));
        ay = search->acceleration(trial);
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
               pool_print(m->pool, "no %s %s %.4g m/s^2 at %.4g m/s: the vehicle reached %.4g m/s^2", search->what + 2,
                          search->verb, wanted, v, ay));
}

static bool is_enough(void *context, const Trial *trial)
{
    const double *row = trial->row[trial->rows - 1];
    (void)context;
    return row[TRIAL_TIME] > begin && row[TRIAL_AY] > 0.375 * gravity;
}

double manoeuvre_find_amplitude(Manoeuvre *m)
{
    TestCar *car = m->car;
    double by_ay = car_angle_by_acceleration(car, m->value[0]);
    if (isnan(by_ay))
        by_ay = car->sheet.wheelbase / (m->value[0] * m->value[0]);
    const double to = fmin(6 * by_ay, 0.999 * car->range[1]), slow = 0.5, duration = to / by_ay / slow;
    const char *more =
        pool_print(m->pool, "inputs:\n  %s: {ramp: {to: %.17g, duration: %.9g, start: %g, blend: 0.5}}\n",
                   car->model->input[car->steering].name, car_steering(car, to), duration, begin);
    const Trial *trial = trial_run(car, "slowly increasing steer",
                                   car_scene(car, begin + duration, m->value[0], true, more), is_enough, NULL);
    double *x = pool_alloc(m->pool, (size_t)trial->rows * sizeof *x), mean[2] = {0};
    double *y = pool_alloc(m->pool, (size_t)trial->rows * sizeof *y);
    int n = 0;
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_AY] >= 0.1 * gravity && trial->row[i][TRIAL_AY] <= 0.375 * gravity) {
            x[n] = trial->row[i][TRIAL_AY];
            y[n++] = trial->row[i][TRIAL_ANGLE];
        }
    if (n < 3 || x[n - 1] < 0.3 * gravity)
        car_refuse(car, "choose a lower speed: speed=15",
                   pool_print(m->pool, "steering that grows slowly does not end in 0.3 g at %.4g m/s", m->value[0]));
    for (int i = 0; i < n; ++i) {
        mean[0] += x[i] / n;
        mean[1] += y[i] / n;
    }
    const double A = mean[1] + fit_slope(n, x, y) * (0.3 * gravity - mean[0]);
    sheet_add(m->result, "Steering", "amplitude", "A: steer angle of 0.3 g", "rad", A);
    return A;
}
