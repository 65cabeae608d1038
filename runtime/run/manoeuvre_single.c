/* SPDX-License-Identifier: MIT
 * Single lane change: a driver follows a path whose lateral acceleration is a period of a sine; how much the last unit
 * of an articulated vehicle amplifies that, and how far beside the path of the first unit it goes. */
#include "run/manoeuvre.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double begin = 4, after = 10; /* s straight ahead before it and after it */
static const double learns = 0;            /* the path is soon over */
enum { POINTS = 40 };                      /* of the path in the change */

/* The place aside on the path at a distance along it, of a change to the side of the sign of `ay`. */
static double aside_at(const Manoeuvre *m, double ay, double x)
{
    const double omega = 2 * pi * m->value[2], turn = omega * (x / m->value[0] - begin);
    const double on = fmin(fmax(turn, 0), 2 * pi);
    return ay / (omega * omega) * (on - sin(on));
}

static const Trial *drive(Manoeuvre *m, const PathDriver *driver, double ay, const char *name)
{
    TestCar *car = m->car;
    const double speed = m->value[0], change = 1 / m->value[2], from = speed * begin, to = from + speed * change;
    const double end = to + speed * (after + 5);
    Text path = {.pool = m->pool};
    text_print(&path, "{points: [[-20, 0]");
    for (double x = 0; x < end; x += x < from - 20 || x > to + 20 ? 10 : speed * change / POINTS)
        text_print(&path, ", [%.9g, %.9g]", x, aside_at(m, ay, x));
    text_print(&path, "]}");
    const char *pedals = "";
    if (car->accelerator >= 0 && car->brake >= 0)
        pedals = car_pedals(car, pool_print(m->pool, "%.17g", speed));
    return trial_run(
        car, name,
        car_scene(car, begin + change + after, speed, false, manoeuvre_driver_text(m, driver, pedals, path.s)), NULL,
        NULL);
}

/* The place aside of the first unit's centre of mass where it passed x; NAN: it did not. */
static double first_aside(const Trial *trial, double x, int *row)
{
    while (*row + 1 < trial->rows && trial->row[*row + 1][TRIAL_X] < x)
        ++*row;
    const double *a = trial->row[*row];
    if (*row + 1 >= trial->rows || x < a[TRIAL_X])
        return NAN;
    const double *b = trial->row[*row + 1];
    return a[TRIAL_Y] + (x - a[TRIAL_X]) / (b[TRIAL_X] - a[TRIAL_X]) * (b[TRIAL_Y] - a[TRIAL_Y]);
}

/* Rows of how far the last unit goes beside the path of the first one, and beyond the new lane. */
static void add_offtracking(Manoeuvre *m, const Trial *trial, double sign, double lane)
{
    double most = 0, beyond = 0;
    for (int i = 0, row = 0; i < trial->rows; ++i) {
        const double *at = trial->row[i], first = first_aside(trial, at[TRIAL_LAST_X], &row);
        if (at[TRIAL_TIME] < begin || isnan(first))
            continue;
        most = fmax(most, fabs(at[TRIAL_LAST_Y] - first));
        beyond = fmax(beyond, sign * at[TRIAL_LAST_Y] - lane);
    }
    sheet_add_way(m->result, NULL, pool_print(m->pool, "%s.offtracking", trial->name),
                  "Last unit beside the path of the first", most);
    sheet_add_way(m->result, NULL, pool_print(m->pool, "%s.beyond", trial->name), "Last unit beyond the new lane",
                  beyond);
}

static double largest(const Trial *trial, Channel channel, double sign)
{
    return sign * trial->row[trial_peak(trial, channel, begin, INFINITY, sign)][channel];
}

void manoeuvre_single_lane_change(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_AY, TRIAL_YAW_RATE, TRIAL_ROLL};
    static const Channel of_units[] = {TRIAL_LAST_AY, TRIAL_LAST_YAW_RATE, TRIAL_ARTICULATION};
    const double ay = m->value[1], omega = 2 * pi * m->value[2], lane = 2 * pi * ay / (omega * omega);
    manoeuvre_begin(m);
    const PathDriver driver = manoeuvre_driver(m, m->value[0], learns);
    for (int side = 1; side >= -1; side -= 2) {
        const Trial *trial = drive(m, &driver, side * ay, side > 0 ? "left" : "right");
        const double *last = trial->row[trial->rows - 1];
        const char *less = pool_print(m->pool, "ask for less: ay=%.2g, or frequency=%.2g", 0.7 * ay, 0.7 * m->value[2]);
        manoeuvre_whole(m, trial, less);
        if (trial_spins(trial) || !(fabs(side * last[TRIAL_Y] - lane) < 0.5))
            car_refuse(m->car, less,
                       pool_print(m->pool, "%s: the driver does not reach the new lane, %.3g m aside, but %.3g m",
                                  trial->name, lane, side * last[TRIAL_Y]));
        manoeuvre_keep(m, trial);
        double off = 0;
        for (int i = 0; i < trial->rows; ++i)
            off = fmax(off, fabs(trial->row[i][TRIAL_Y] - aside_at(m, side * ay, trial->row[i][TRIAL_X])));
        sheet_add(m->result, side > 0 ? "To the left" : "To the right",
                  pool_print(m->pool, "%s.steer_angle", trial->name), "Largest steer angle", "rad",
                  fmax(largest(trial, TRIAL_ANGLE, 1), largest(trial, TRIAL_ANGLE, -1)));
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.ay.first", trial->name),
                  "Lateral acceleration, peak to the new lane", "m/s^2", largest(trial, TRIAL_AY, side));
        sheet_add(m->result, NULL, pool_print(m->pool, "%s.ay.second", trial->name), "And back", "m/s^2",
                  largest(trial, TRIAL_AY, -side));
        sheet_add_way(m->result, NULL, pool_print(m->pool, "%s.off", trial->name), "Off the path at most", off);
        if (m->car->units) {
            manoeuvre_rearward(m, trial, begin, begin + 1 / m->value[2]);
            add_offtracking(m, trial, side, lane);
        }
    }
    sheet_add_way(m->result, "Lane", "lane", "The new lane is aside", lane);
    manoeuvre_driver_rows(m, &driver, "");
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
    *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_X, TRIAL_Y};
    if (!manoeuvre_has_units(m))
        return;
    manoeuvre_draw(m, sizeof of_units / sizeof *of_units, of_units);
    *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){TRIAL_LAST_X, TRIAL_LAST_Y};
}
