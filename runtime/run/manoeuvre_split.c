/* SPDX-License-Identifier: MIT
 * Braking on a road whose left side is slippery, with the steering held or by a driver who keeps straight ahead. */
#include "run/manoeuvre.h"

#include <math.h>

static const double standing = 0.02, far = 2000, rise = 0.1; /* m/s, m, s */
static const double learns = 0.5;                            /* 1/s, how fast the driver does */
static const double beside = 0.1;                            /* m about the middle in which the friction changes */

static const char *straight_line(const Manoeuvre *m, const PathDriver *driver)
{
    return manoeuvre_driver_text(m, driver, "",
                                 pool_print(m->pool, "{points: [[%.9g, 0], [0, 0], [%g, 0]]}", -far / 10, far));
}

void manoeuvre_split_braking(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_YAW_RATE, TRIAL_SIDESLIP};
    TestCar *car = m->car;
    const double speed = m->value[0], level = m->value[1], low = m->value[2], most = 60;
    const bool steered = m->value[3] > 0.5;
    double below = standing, start;
    car_need_brake(car);
    if (steered)
        car_need_steering(car);
    car_settle(car, speed);
    const PathDriver driver = steered ? manoeuvre_driver(m, speed, learns) : (PathDriver){0};
    const double from = manoeuvre_speed_before(car, speed, &start);
    const char *more =
        pool_print(m->pool,
                   "road: {type: flat, friction: {patches: [{x: [%g, %g], y: [0, %g], value: %.17g, "
                   "fade: %g}]}}\n%sinputs:\n  brake: {step: {to: %.17g, rise: %g, start: %g}}\n",
                   -far, far, far, low, beside, steered ? straight_line(m, &driver) : "", level, rise, start);
    const Trial *trial = trial_run(car, "braking", car_scene(car, most, from, false, more), manoeuvre_is_over, &below);
    manoeuvre_whole(m, trial, "a lower speed or less brake: speed=10, brake=0.3");
    manoeuvre_keep(m, trial);
    manoeuvre_braked(m, trial, start, speed);
    const int turning =
        trial_peak(trial, TRIAL_YAW_RATE, start, INFINITY, trial_at(trial, TRIAL_YAW, start + 1) < 0 ? -1 : 1);
    Sheet *s = m->result;
    sheet_add(s, "Turning", "yaw_rate", "Largest yaw rate to the grippy side", "rad/s",
              fabs(trial->row[turning][TRIAL_YAW_RATE]));
    if (trial->row[trial->rows - 1][TRIAL_TIME] > start + 1) {
        sheet_add(s, NULL, "turned_1", "Turned after 1 s", "rad", trial_at(trial, TRIAL_YAW, start + 1));
        sheet_add_way(s, NULL, "aside_1", "Off the straight line after 1 s",
                      trial_at(trial, TRIAL_Y, start + 1) - trial_at(trial, TRIAL_Y, start));
    }
    if (steered) {
        double angle = 0;
        for (int i = 0; i < trial->rows; ++i)
            angle = fmax(angle, fabs(trial->row[i][TRIAL_ANGLE]));
        sheet_add(s, NULL, "steer_angle", "Largest steer angle of the driver", "rad", angle);
        manoeuvre_driver_rows(m, &driver, "");
    }
    static const Channel along[] = {TRIAL_SPEED, TRIAL_AX, TRIAL_YAW, TRIAL_Y};
    manoeuvre_draw(m, sizeof along / sizeof *along, along);
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}
