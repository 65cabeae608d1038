/* SPDX-License-Identifier: MIT
 * Sine with dwell: a sine of the steering of 0.7 Hz that waits at its second peak, with growing amplitude. The vehicle
 * has to come to rest in yaw, and to get out of the way. */
#include "run/manoeuvre.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double begin = 1, frequency = 0.7, dwell = 0.5, spacing = 0.01; /* s, Hz */
static const double first = 1.5, step = 0.5, displaced = 5;                  /* amplitudes, in A */
static const double heavy = 3500;                                            /* kg */

static double complete(void)
{
    return begin + 1 / frequency + dwell;
}

static double wave(const void *context, double time)
{
    (void)context;
    const double quarter = 0.75 / frequency;
    double t = time - begin;
    if (t <= 0 || time >= complete())
        return 0;
    t = t < quarter ? t : t < quarter + dwell ? quarter : t - dwell;
    return sin(2 * pi * frequency * t);
}

static const Trial *drive(Manoeuvre *m, const char *name, double angle)
{
    TestCar *car = m->car;
    const char *more = manoeuvre_steering(m, begin, complete(), spacing, angle, wave, NULL);
    return trial_run(car, name, car_scene(car, complete() + 2, m->value[0], false, more), NULL, NULL);
}

/* What the criteria look at. */
typedef struct Result {
    double after[2], displacement; /* shares of the peak yaw rate 1 s and 1.75 s after the steering's end */
} Result;

static Result result_of(const Trial *trial, double sign)
{
    static const double at[] = {1, 1.75};
    const double half = begin + 0.5 / frequency, stopped = trial->tipped || trial->end ? INFINITY : 0;
    const double *peak = trial->row[trial_peak(trial, TRIAL_YAW_RATE, half, complete() + 1, -sign)];
    Result result = {.displacement = sign * (trial_at(trial, TRIAL_Y, begin + 1.07) - trial_at(trial, TRIAL_Y, begin))};
    for (int k = 0; k < 2; ++k)
        result.after[k] =
            stopped > 0 ? stopped : trial_at(trial, TRIAL_YAW_RATE, complete() + at[k]) / peak[TRIAL_YAW_RATE];
    return result;
}

static void drive_side(Manoeuvre *m, double sign, double A)
{
    TestCar *car = m->car;
    Sheet *s = m->result;
    const char *side = sign > 0 ? "left" : "right", *fault = NULL;
    const double wanted = car->sheet.mass > heavy ? 1.52 : 1.83, range = fmin(-car->range[0], car->range[1]);
    double passed = 0, worst[2] = {0}, least = INFINITY;
    for (double factor = first; factor <= m->value[1] + 1e-9 && !fault; factor += step) {
        if (factor * A > 0.999 * range) {
            sheet_note(s, pool_print(m->pool, "%s: the steering is at its end at %g A", side, factor));
            break;
        }
        const Trial *trial = drive(m, pool_print(m->pool, "%s %g A", side, factor), sign * factor * A);
        const Result r = result_of(trial, sign);
        manoeuvre_keep(m, trial);
        if (factor >= displaced - 1e-9)
            least = fmin(least, r.displacement);
        fault = trial->tipped       ? "the vehicle tips over"
                : trial->end        ? trial->end
                : r.after[0] > 0.35 ? "it still turns by more than 35 % of the peak yaw rate after 1 s"
                : r.after[1] > 0.2  ? "it still turns by more than 20 % of the peak yaw rate after 1.75 s"
                : least < wanted && isfinite(least) ? "it has not got out of the way within 1.07 s"
                                                    : NULL;
        for (int k = 0; k < 2 && !fault; ++k)
            worst[k] = fmax(worst[k], r.after[k]);
        passed = fault ? passed : factor;
        if (fault)
            sheet_note(s, pool_print(m->pool, "%s, %g A: %s", side, factor, fault));
    }
    sheet_add(s, sign > 0 ? "To the left first" : "To the right first", pool_print(m->pool, "%s.passed", side),
              "Largest amplitude with all criteria kept, in A", "1", passed);
    sheet_add(s, NULL, pool_print(m->pool, "%s.yaw_after_1", side), "Yaw rate over its peak 1 s after the steering",
              "1", worst[0]);
    sheet_add(s, NULL, pool_print(m->pool, "%s.yaw_after_1_75", side), "1.75 s after it", "1", worst[1]);
    if (isfinite(least))
        sheet_add_way(s, NULL, pool_print(m->pool, "%s.displacement", side),
                      "Least displacement after 1.07 s from 5 A on", least);
}

void manoeuvre_sine_dwell(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_YAW_RATE, TRIAL_AY, TRIAL_ROLL, TRIAL_Y, TRIAL_SPEED, TRIAL_LOAD};
    manoeuvre_begin(m);
    const double A = manoeuvre_find_amplitude(m);
    drive_side(m, 1, A);
    drive_side(m, -1, A);
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}
