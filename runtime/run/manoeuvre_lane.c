/* SPDX-License-Identifier: MIT
 * Double lane change by the geometry of ISO 3888-1 or 3888-2: the largest speed at which the vehicle enters and touches
 * no cone.
 */
#include "run/manoeuvre.h"

#include <math.h>
#include <string.h>

static const double before = 12;                                         /* m from the start to the first lane */
static const double begin[] = {10, 8, 6, 13}, fastest = 60, close = 0.1; /* m/s; begin: tried until one does */
/* What the driver tries, one after the other: how far he looks ahead, by the preview found for him; m within a lane
 * where his line leaves it; and then all of it again steering as for a vehicle without slip, gain 1. Last with that
 * gain previews, s, that serve many cars: near the limit of grip the linear model does not always know best. */
enum { LOOKS = 4, TURNS = 3, GAINS = 2, FOUND = LOOKS * TURNS * GAINS, USUAL = 4, WAYS = FOUND + USUAL * TURNS };
static const double looks[LOOKS] = {1, 2 / 3.0, 4 / 3.0, 5 / 3.0}, turns[TURNS] = {1.5, 0, 3};
static const double usual[USUAL] = {0.45, 0.3, 0.6, 0.75};

enum { LANES = 3 };

typedef struct Lane {
    double from, to, low, high; /* m */
} Lane;

/* The vehicle as a rectangle: half its width, and its axles from the centre of mass. tried: the order in which the
 * driver tries; what led through last is first, as `driver`, with what he looked ahead in `used`, s, and
 * steered by in `used_gain`. */
typedef struct Course {
    Lane lane[LANES];
    double half, axle[2];
    int tried[WAYS];
    PathDriver driver;
    double used, used_gain;
} Course;

static Course course_of(const Manoeuvre *m)
{
    const Sheet *s = &m->car->sheet;
    const Kc *kc = s->kc;
    Course c;
    double aside[2];
    c.axle[0] = sheet_axle_place(s, &kc->axle[kc_foremost(kc)], &aside[0]) - s->com[0];
    c.axle[1] = sheet_axle_place(s, &kc->axle[kc_last(kc)], &aside[1]) - s->com[0];
    const double tire = 0.25, width = m->value[0] > 0 ? m->value[0] : 2 * fmax(aside[0], aside[1]) + tire;
    const bool first = m->value[1] < 1.5; /* part 1 */
    const double wide[LANES] = {1.1 * width + 0.25, first ? 1.2 * width + 0.25 : width + 1,
                                first ? 1.3 * width + 0.25 : fmax(1.3 * width + 0.25, 3)};
    const double right = -wide[0] / 2;
    c.half = width / 2;
    if (first) {
        c.lane[0] = (Lane){before, before + 15, right, right + wide[0]};
        c.lane[1] = (Lane){before + 45, before + 70, right + 3.5, right + 3.5 + wide[1]};
        c.lane[2] = (Lane){before + 95, before + 125, right, right + wide[2]};
    } else {
        c.lane[0] = (Lane){before, before + 12, right, right + wide[0]};
        c.lane[1] = (Lane){before + 25.5, before + 36.5, c.lane[0].high + 1, c.lane[0].high + 1 + wide[1]};
        c.lane[2] = (Lane){before + 49, before + 61, right, right + wide[2]};
    }
    for (int i = 0; i < WAYS; ++i)
        c.tried[i] = i;
    return c;
}

static double middle(const Lane *lane)
{
    return (lane->low + lane->high) / 2;
}

/* The line that the driver follows: quintics from lane to lane, begun and ended within them. */
static double line(const Course *c, double turn, double x)
{
    double y = middle(&c->lane[0]);
    for (int k = 0; k + 1 < LANES; ++k) {
        const double from = c->lane[k].to - turn, to = c->lane[k + 1].from + turn;
        const double s = fmin(fmax((x - from) / (to - from), 0), 1);
        y += (middle(&c->lane[k + 1]) - middle(&c->lane[k])) * s * s * s * (10 - 15 * s + 6 * s * s);
    }
    return y;
}

/* keeps: the speed that the driver keeps; 0: pedals are free. */
static const char *course_text(const Manoeuvre *m, const Course *c, const PathDriver *driver, double turn, double keeps)
{
    const TestCar *car = m->car;
    Text text = {.pool = m->pool};
    const char *pedals = "";
    if (keeps > 0 && car->accelerator >= 0 && car->brake >= 0)
        pedals = car_pedals(m->car, pool_print(m->pool, "%.17g", keeps));
    text_print(&text, "{points: [");
    for (double x = -15; x <= c->lane[LANES - 1].to + 90; x += x < c->lane[LANES - 1].to + 9 ? 1.5 : 10)
        text_print(&text, "%s[%g, %.9g]", x > -15 ? ", " : "", x, line(c, turn, x));
    text_print(&text, "]}");
    const char *steers = manoeuvre_driver_text(m, driver, pedals, text.s);
    text = (Text){.pool = m->pool};
    text_print(&text, "%scourse:\n  lanes:\n", steers);
    for (int k = 0; k < LANES; ++k)
        text_print(&text, "    - {points: [[%g, %.9g], [%g, %.9g]], width: %.9g, cones: 5}\n", c->lane[k].from,
                   middle(&c->lane[k]), c->lane[k].to, middle(&c->lane[k]), c->lane[k].high - c->lane[k].low);
    return text.s;
}

/* The lane, from 1, at whose edge the vehicle in a row touches cones; 0: none. */
static int touched(const Course *c, const double *row)
{
    const double cosine = cos(row[TRIAL_YAW]), sine = sin(row[TRIAL_YAW]);
    for (int i = 0; i < 4; ++i) {
        const double ahead = c->axle[i / 2], left = i % 2 ? -c->half : c->half;
        const double x = row[TRIAL_X] + ahead * cosine - left * sine, y = row[TRIAL_Y] + ahead * sine + left * cosine;
        for (int k = 0; k < LANES; ++k)
            if (x >= c->lane[k].from && x <= c->lane[k].to && (y < c->lane[k].low || y > c->lane[k].high))
                return k + 1;
    }
    return 0;
}

static bool is_through(void *context, const Trial *trial)
{
    const Course *c = context;
    return trial->row[trial->rows - 1][TRIAL_X] > c->lane[LANES - 1].to - c->axle[1] + 1 ||
           touched(c, trial->row[trial->rows - 1]);
}

/* The speed at which the centre of mass passes the begin of the first lane. */
static double entry(const Course *c, const Trial *trial)
{
    return trial_at(trial, TRIAL_SPEED, trial_passes(trial, TRIAL_X, 0, c->lane[0].from, 1));
}

/* m within a lane where the line of a way leaves it. */
static double turn_of(int way)
{
    return way < FOUND ? turns[way / LOOKS % TURNS] : turns[(way - FOUND) / USUAL];
}

/* The driver that was found, as he tries it in a way. False: errors would not die out. */
static bool take_way(int way, PathDriver *driver)
{
    if (way >= FOUND) {
        driver->preview = usual[(way - FOUND) % USUAL];
        driver->gain = 1;
        return true;
    }
    driver->preview *= looks[way % LOOKS];
    if (way / (LOOKS * TURNS))
        driver->gain = 1;
    return driver->preview >= driver->stable[0] && driver->preview <= driver->stable[1];
}

/* A run at a speed that touches no cone; NULL: there is none, *why. */
static const Trial *drive(Manoeuvre *m, Course *c, double speed, const char **why)
{
    TestCar *car = m->car;
    if (!car_keeps(car, speed, why))
        return NULL;
    PathDriver driver;
    const char *none;
    const bool found = manoeuvre_find_driver(m, speed, 0, &driver, &none);
    const bool drives = m->value[1] < 1.5; /* part 1: the speed is kept */
    for (int k = 0; k < WAYS; ++k) {
        const int i = c->tried[k];
        const double duration = (c->lane[LANES - 1].to + 20) / speed * 2;
        PathDriver tries = driver;
        if ((i < FOUND && !found) || !take_way(i, &tries))
            continue;
        const Trial *trial =
            trial_run(car, pool_print(m->pool, "at %.4g m/s", speed),
                      car_scene(car, duration, speed, false, course_text(m, c, &tries, turn_of(i), drives ? speed : 0)),
                      is_through, c);
        const double *last = trial->row[trial->rows - 1];
        const int lane = touched(c, last);
        *why = trial->tipped                           ? "the vehicle tips over"
               : trial->end                            ? trial->end
               : lane                                  ? pool_print(m->pool, "cones of lane %d are hit", lane)
               : last[TRIAL_X] < c->lane[LANES - 1].to ? "the vehicle does not get through"
                                                       : NULL;
        if (!*why) {
            memmove(c->tried + 1, c->tried, (size_t)k * sizeof *c->tried);
            c->tried[0] = i;
            c->driver = driver;
            c->used = tries.preview;
            c->used_gain = tries.gain;
            return trial;
        }
    }
    if (!found)
        *why = none;
    return NULL;
}

void manoeuvre_lane_change(Manoeuvre *m)
{
    TestCar *car = m->car;
    car_need_steering(car);
    Course c = course_of(m);
    const char *why;
    double low = begin[0], high = fastest;
    const Trial *best = NULL;
    for (size_t i = 0; i < sizeof begin / sizeof *begin && !best; ++i)
        best = drive(m, &c, low = begin[i], &why);
    if (!best)
        car_refuse(
            car, car->remedy ? car->remedy : "a narrower vehicle, `width`, or more steering",
            pool_print(m->pool, "the double lane change can't be driven at %g to %g m/s: %s", begin[2], begin[3], why));
    const char *limit = NULL;
    while (high - low > close) {
        const double speed = high > fastest - close ? fmin(1.5 * low, (low + high) / 2) : (low + high) / 2;
        const Trial *trial = drive(m, &c, speed, &why);
        if (trial) {
            best = trial;
            low = speed;
        } else {
            high = speed;
            limit = why;
        }
    }
    Sheet *s = m->result;
    const double *most = best->row[trial_peak(best, TRIAL_AY, 0, INFINITY, 1)];
    const double *least = best->row[trial_peak(best, TRIAL_AY, 0, INFINITY, -1)];
    manoeuvre_keep(m, best);
    sheet_add(s, "Double lane change", "entry_speed", "Largest entry speed without a cone touched", "m/s",
              entry(&c, best));
    sheet_add(s, NULL, "exit_speed", "Speed at its end", "m/s", best->row[best->rows - 1][TRIAL_SPEED]);
    sheet_add(s, NULL, "ay_left", "Largest lateral acceleration to the left", "m/s^2", most[TRIAL_AY]);
    sheet_add(s, NULL, "ay_right", "To the right", "m/s^2", -least[TRIAL_AY]);
    sheet_add_way(s, NULL, "width", "Width of the vehicle", 2 * c.half);
    if (c.driver.preview > 0)
        manoeuvre_driver_rows(m, &c.driver, "");
    sheet_add(s, c.driver.preview > 0 ? NULL : "Driver", "driver.used", "Preview that led through", "s", c.used);
    sheet_add(s, NULL, "driver.used_gain", "Gain that led through", "1", c.used_gain);
    sheet_note(s, pool_print(m->pool, "at %.4g m/s: %s", high, limit ? limit : "not tried"));
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_Y, TRIAL_AY, TRIAL_YAW_RATE, TRIAL_ROLL, TRIAL_SPEED};
    for (size_t i = 0; i < sizeof over / sizeof *over; ++i)
        *POOL_PUSH(m->pool, m->curve, m->curves) = (ManoeuvreCurve){i == 1 ? TRIAL_X : TRIAL_TIME, over[i]};
}
