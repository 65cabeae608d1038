/* SPDX-License-Identifier: MIT
 * Steering that makes vehicles lift wheels: a J-turn, and a fishhook, which steers back when the vehicle has rolled.
 * From speed to speed, until both wheels of each axle on one side are without load, or the fastest has been driven. */
#include "base/vec3.h"
#include "run/manoeuvre.h"

#include <math.h>
#include <string.h>

static const double begin = 1, hold = 4, back = 3;   /* s: straight ahead; held; held after steering back */
static const double faster = 2.2352;                 /* m/s from speed to speed: 5 mph */
static const double rolled = 0.026179938779914945;   /* rad/s, 1.5 deg/s: it has */
static const double spacing = 0.01, lifted = 0.0199; /* s between samples; without load */
static const double latest = 2;                      /* s after which it steers back in any case */

/* Straight ahead, at a rate, 1/s, to 1; from `turns` on at that rate to -1. */
typedef struct Hook {
    double rate, turns;
} Hook;

static double wave(const void *context, double time)
{
    const Hook *hook = context;
    const double there = fmin(fmax((time - begin) * hook->rate, 0), 1);
    return time > hook->turns ? fmax(there - (time - hook->turns) * hook->rate, -1) : there;
}

/* 1: the wheel is on the left, -1: on the right, 0: in the middle. */
static int side_of(const TestCar *car, const Wheel *wheel)
{
    const Body *body = &car->model->body[wheel->body];
    double A[9], at[3];
    mat_from_euler(body->euler, A);
    apply3(A, wheel->center, at);
    return kc_side(car->sheet.kc, at[1] + body->position[1]);
}

/* The wheels of a side have no load in a row; false for a side without wheels. */
static bool lifts(const TestCar *car, const Trial *trial, int row, int side)
{
    const Model *model = car->model;
    double load = 0;
    int wheels = 0;
    for (int w = 0; w < model->wheels; ++w)
        if (side_of(car, &model->wheel[w]) == side && ++wheels)
            load += trial->wheel[(row * model->wheels + w) * TRIAL_OF_WHEEL + TRIAL_WHEEL_LOAD];
    return wheels && !(load > 0);
}

bool manoeuvre_side_lifts(const TestCar *car, const Trial *trial, int row)
{
    return lifts(car, trial, row, 1) || lifts(car, trial, row, -1);
}

/* What happened: seconds during which one side had no load, in one piece. */
static double without_load(const Manoeuvre *m, const Trial *trial)
{
    double most = 0;
    for (int side = 1; side >= -1; side -= 2) {
        double since = NAN;
        for (int i = 0; i < trial->rows; ++i) {
            if (trial->row[i][TRIAL_TIME] < begin || !lifts(m->car, trial, i, side))
                since = NAN;
            else
                since = isnan(since) ? trial->row[i][TRIAL_TIME] : since;
            if (!isnan(since))
                most = fmax(most, trial->row[i][TRIAL_TIME] - since);
        }
    }
    return most;
}

static const Trial *drive(Manoeuvre *m, const char *name, double speed, double angle, const Hook *hook)
{
    TestCar *car = m->car;
    const double end = isfinite(hook->turns) ? hook->turns + 2 / hook->rate + back : begin + 1 / hook->rate + hold;
    const char *more = manoeuvre_steering(m, begin, end, spacing, angle, wave, hook);
    return trial_run(car, name, car_scene(car, end, speed, false, more), NULL, NULL);
}

/* When the vehicle has rolled after the first steering. */
static double when_rolled(const Trial *trial, double from)
{
    for (int i = 1; i + 1 < trial->rows; ++i) {
        const double *row = trial->row[i], *next = trial->row[i + 1], *last = trial->row[i - 1];
        const double rate = (next[TRIAL_ROLL] - last[TRIAL_ROLL]) / (next[TRIAL_TIME] - last[TRIAL_TIME]);
        if (row[TRIAL_TIME] >= from && (fabs(rate) < rolled || row[TRIAL_TIME] > from + latest))
            return row[TRIAL_TIME];
    }
    return from + latest;
}

typedef enum Outcome { KEEPS, LIFTS, BREAKS_OFF } Outcome;

/* One speed and side; *run: as it was driven. */
static Outcome drive_one(Manoeuvre *m, double speed, double sign, double angle, bool hooks, const Trial **run)
{
    const char *name = pool_print(m->pool, "%s %.4g m/s", sign > 0 ? "left" : "right", speed);
    Hook hook = {.rate = m->value[3] / angle, .turns = INFINITY};
    const Trial *trial = drive(m, name, speed, sign * angle, &hook);
    if (hooks && !trial->tipped && !trial->end) {
        hook.turns = when_rolled(trial, begin + 1 / hook.rate);
        trial = drive(m, name, speed, sign * angle, &hook);
    }
    manoeuvre_keep(m, trial);
    *run = trial;
    if (trial->tipped || without_load(m, trial) >= lifted)
        return LIFTS;
    if (!trial->end)
        return KEEPS;
    sheet_note(m->result,
               pool_print(m->pool, "%s: %s; so it is not known at which speed it lifts a side", name, trial->end));
    return BREAKS_OFF;
}

/* True: there is a number. False: a run broke off before, a note tells. */
static bool add_side(Manoeuvre *m, double sign, double angle, bool hooks)
{
    Sheet *s = m->result;
    const double from = m->value[1], most = m->value[0];
    const char *side = sign > 0 ? "left" : "right";
    double passed = NAN, fails = NAN;
    const Trial *last = NULL; /* the fastest that keeps its wheels on the road */
    Outcome outcome = KEEPS;
    for (double speed = fmin(from, most); outcome == KEEPS; speed = fmin(speed + faster, most)) {
        const Trial *trial;
        const char *why;
        if (!car_keeps(m->car, speed, &why)) {
            sheet_note(s, pool_print(m->pool, "%s: %s", side, why));
            break;
        }
        outcome = drive_one(m, speed, sign, angle, hooks, &trial);
        if (outcome == KEEPS) {
            passed = speed;
            last = trial;
        }
        if (outcome == LIFTS)
            fails = speed;
        if (speed >= most)
            break;
    }
    const char *section = sign > 0 ? hooks ? "To the left first" : "To the left"
                          : hooks  ? "To the right first"
                                   : "To the right";
    if (!isnan(passed)) {
        sheet_add(s, section, pool_print(m->pool, "%s.passed", side), "Largest speed without lifting a side", "m/s",
                  passed);
        section = NULL;
    }
    if (!isnan(fails)) {
        sheet_add(s, section, pool_print(m->pool, "%s.lifts", side), "Speed at which it lifts a side", "m/s", fails);
        section = NULL;
    }
    if (!last)
        return !isnan(fails);
    const double *roll[2] = {last->row[trial_peak(last, TRIAL_ROLL, begin, INFINITY, 1)],
                             last->row[trial_peak(last, TRIAL_ROLL, begin, INFINITY, -1)]};
    const double *ay[2] = {last->row[trial_peak(last, TRIAL_AY, begin, INFINITY, 1)],
                           last->row[trial_peak(last, TRIAL_AY, begin, INFINITY, -1)]};
    sheet_add(s, section, pool_print(m->pool, "%s.roll", side), "Largest roll at the speed that it passes", "rad",
              fmax(roll[0][TRIAL_ROLL], -roll[1][TRIAL_ROLL]));
    sheet_add(s, NULL, pool_print(m->pool, "%s.ay", side), "Its largest lateral acceleration", "m/s^2",
              fmax(ay[0][TRIAL_AY], -ay[1][TRIAL_AY]));
    return true;
}

static void drive_sides(Manoeuvre *m, bool hooks)
{
    static const Channel over[] = {TRIAL_ANGLE, TRIAL_ROLL, TRIAL_AY, TRIAL_YAW_RATE, TRIAL_LOAD, TRIAL_SPEED};
    TestCar *car = m->car;
    manoeuvre_begin(m);
    const double A = manoeuvre_find_amplitude(m), most = 0.999 * fmin(-car->range[0], car->range[1]);
    const double angle = fmin(m->value[2] * A, most);
    if (angle < m->value[2] * A)
        sheet_note(m->result, pool_print(m->pool, "the steering ends at %.3g A", angle / A));
    sheet_add(m->result, NULL, "steer_angle", "Steer angle that is driven", "rad", angle);
    const bool left = add_side(m, 1, angle, hooks), right = add_side(m, -1, angle, hooks);
    if (!left && !right)
        car_refuse(car, "let stops of its suspension act before that, or ask for less: from, angle",
                   m->result->notes ? m->result->note[m->result->notes - 1] : "no run was evaluated");
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}

void manoeuvre_j_turn(Manoeuvre *m)
{
    drive_sides(m, false);
}

void manoeuvre_fishhook(Manoeuvre *m)
{
    drive_sides(m, true);
}
